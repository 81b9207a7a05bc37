//! Which argument goes to which parameter, without looking at types.

use super::Checker;
use super::call::Arg;
use crate::diag::{Diagnostic, Fix};
use crate::source::Span;

/// A parameter as far as binding cares.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot<'s> {
    /// Its name.
    pub(super) name: &'s str,
    /// Whether a call may leave it out.
    pub(super) optional: bool,
    /// Whether it takes all remaining positional arguments.
    pub(super) rest: bool,
}

/// What a parameter gets; numbers are indices of arguments.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Given {
    /// Nothing: its default.
    Default,
    /// One argument.
    One(usize),
    /// The arguments of a `rest` parameter.
    Rest(Vec<usize>),
}

/// Why arguments do not fit; numbers are indices of arguments.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Misfit {
    /// An argument without a name after one with a name.
    Unnamed(usize),
    /// One more than there are parameters.
    TooMany(usize),
    /// No parameter has this name.
    Unknown(usize),
    /// The second was given by the first already.
    Twice(usize, usize),
    /// These parameters need a value.
    Missing(Vec<String>),
}

/// Gives each parameter its arguments: positional ones in order, then named ones.
pub(super) fn bind(slots: &[Slot<'_>], args: &[Arg<'_>]) -> Result<Vec<Given>, Misfit> {
    let mut given = vec![Given::Default; slots.len()];
    let mut next = 0;
    let mut named = false;
    for (i, arg) in args.iter().enumerate() {
        let Some(name) = arg.name else {
            if named {
                return Err(Misfit::Unnamed(i));
            }
            match slots.get(next) {
                None => return Err(Misfit::TooMany(i)),
                Some(slot) if slot.rest => match &mut given[next] {
                    Given::Rest(indices) => indices.push(i),
                    Given::Default | Given::One(_) => given[next] = Given::Rest(vec![i]),
                },
                Some(_) => {
                    given[next] = Given::One(i);
                    next += 1;
                }
            }
            continue;
        };
        named = true;
        let Some(index) = slots.iter().position(|slot| slot.name == name.text) else {
            return Err(Misfit::Unknown(i));
        };
        match &given[index] {
            Given::Default if slots[index].rest => given[index] = Given::Rest(vec![i]),
            Given::Default => given[index] = Given::One(i),
            Given::One(first) => return Err(Misfit::Twice(i, *first)),
            Given::Rest(indices) => return Err(Misfit::Twice(i, indices.first().copied().unwrap_or(0))),
        }
    }
    let missing =
        slots.iter().zip(&given).filter(|(slot, given)| !slot.optional && **given == Given::Default);
    let missing: Vec<String> = missing.map(|(slot, _)| slot.name.to_owned()).collect();
    if missing.is_empty() { Ok(given) } else { Err(Misfit::Missing(missing)) }
}

/// Brackets around the components of a vector.
fn bracketed(components: Span) -> Fix {
    let Span { start, end } = components;
    let edits = [(Span { start, end: start }, "("), (Span { start: end, end }, ")")];
    Fix::new("put the vector into brackets", edits)
}

impl<'a> Checker<'a> {
    /// Reports arguments that do not fit `form`, the way in which `callee` is called.
    pub(super) fn report_misfit(
        &mut self,
        misfit: Misfit,
        args: &[Arg<'a>],
        slots: &[Slot<'_>],
        callee: &str,
        name_span: Span,
        form: &str,
    ) {
        let place = |index: usize| args[index].name.map_or(args[index].span, |name| name.span);
        let text = |index: usize| args[index].name.map_or("", |name| &name.text);
        let error = match misfit {
            Misfit::Unnamed(i) => {
                let message = "arguments without a name must come before those with one";
                Diagnostic::error("E0215", message, place(i), "this one has no name")
            }
            Misfit::TooMany(i) => {
                let given = args.iter().filter(|arg| arg.name.is_none()).count();
                let most = slots.len();
                let noun = if most == 1 { "argument" } else { "arguments" };
                let message = format!("`{callee}` takes {most} {noun}, found {given}");
                let error = Diagnostic::error("E0212", message, place(i), "one too many");
                if form.contains("vec3") {
                    // The components of a vector given one by one.
                    let help = format!("the form is `{form}`; a vector takes brackets: `(x, y, z)`");
                    let is_last = form.contains(": vec3)") && given == args.len() && given == most + 2;
                    let fix = is_last.then(|| bracketed(args[most - 1].span.to(args[given - 1].span)));
                    self.report(error.with_help(help).with_fix(fix));
                    return;
                }
                error
            }
            Misfit::Unknown(i) => {
                let name = text(i);
                let message = format!("`{callee}` has no argument `{name}`");
                let error = Diagnostic::error("E0213", message, place(i), "this name is not known here");
                if let Some(near) = self.suggest(name, |_| slots.iter().map(|slot| slot.name).collect()) {
                    let help = format!("did you mean `{near}:`; the form is `{form}`");
                    self.report(error.with_help(help).with_fix(Fix::replace(place(i), near)));
                    return;
                }
                error
            }
            Misfit::Twice(i, first) => {
                let message = format!("`{callee}` is given `{}` twice", text(i));
                let error = Diagnostic::error("E0214", message, place(i), "given again here");
                error.with_label(place(first), "first given here")
            }
            Misfit::Missing(names) => {
                let list = format!("`{}`", names.join("` and `"));
                let label = format!("{list} {} missing", if names.len() == 1 { "is" } else { "are" });
                Diagnostic::error("E0211", format!("`{callee}` needs {list}"), name_span, label)
            }
        };
        self.report(error.with_help(format!("the form is `{form}`")));
    }
}
