//! Words and settings against the tables of [`crate::settings`], and blocks by their names.

use super::Checker;
use super::arguments::{Given, Slot, bind};
use super::call::Arg;
use super::convert::Role;
use super::words::article;
use crate::ast::{Argument, Entry, Expr, ExprKind, Name};
use crate::blocks::{BlockKind, Key};
use crate::diag::Diagnostic;
use crate::hir::{self, ExprId};
use crate::settings::{ChoiceKind, SettingsKind, Word};
use crate::source::Span;
use crate::ty::Type;
use std::collections::HashMap;

impl<'a> Checker<'a> {
    /// Whether an expression is written as one of a choice's words: a name, a call, a text, or for a
    /// constraint a pair. A name that stands for something else may still hold such a value.
    pub(super) fn is_worded(&self, expr: &Expr, kind: ChoiceKind) -> bool {
        match &expr.kind {
            _ if kind == ChoiceKind::Enhancement => true,
            ExprKind::Name(name) => {
                let is_other = self.scope.find(name).is_some() || self.item_named(name).is_some();
                !is_other || self.word(kind, name).is_some()
            }
            ExprKind::Call(callee, _) => matches!(callee.kind, ExprKind::Name(_)),
            ExprKind::String(_) => true,
            ExprKind::Tuple(_) | ExprKind::NamedTuple(_) => kind == ChoiceKind::Constraint,
            _ => false,
        }
    }

    fn word(&self, kind: ChoiceKind, name: &str) -> Option<Word> {
        kind.words().into_iter().find(|word| word.name == name)
    }

    /// Whether an expression is a call of one of a choice's words.
    fn calls_word(&self, expr: &Expr, kind: ChoiceKind) -> bool {
        let ExprKind::Call(callee, _) = &expr.kind else { return false };
        matches!(&callee.kind, ExprKind::Name(name) if self.word(kind, name).is_some())
    }

    /// A word of a choice; [`Self::is_worded`] holds.
    pub(super) fn choice(&mut self, expr: &'a Expr, kind: ChoiceKind) -> ExprId {
        let span = expr.span;
        let (name, name_span, args) = match &expr.kind {
            _ if kind == ChoiceKind::Enhancement && !self.calls_word(expr, kind) => {
                ("extrude", span, vec![Arg::unnamed(expr)])
            }
            ExprKind::Name(name) | ExprKind::String(name) => (name.as_str(), span, Vec::new()),
            ExprKind::Call(callee, arguments) => match &callee.kind {
                ExprKind::Name(name) => (name.as_str(), callee.span, Arg::list(arguments)),
                _ => return self.wrong(span),
            },
            ExprKind::Tuple(parts) => ("place", span, parts.iter().map(Arg::unnamed).collect()),
            ExprKind::NamedTuple(arguments) => {
                // `(at: position, color)`: the colour has no name but follows one that has.
                let mut args = Arg::list(arguments);
                args.sort_by_key(|arg| arg.name.is_some());
                ("point", span, args)
            }
            _ => return self.wrong(span),
        };
        let Some(word) = self.word(kind, name) else {
            self.report_word(kind, name, name_span);
            return self.abandon(&args, span);
        };
        let slots: Vec<Slot<'_>> = word
            .params
            .iter()
            .map(|param| Slot { name: param.name, optional: !param.required, rest: false })
            .collect();
        let given = match bind(&slots, &args) {
            Ok(given) => given,
            Err(misfit) => {
                self.report_misfit(misfit, &args, &slots, name, name_span, &form(&word));
                return self.abandon(&args, span);
            }
        };
        let values = word.params.iter().zip(given).map(|(param, given)| match given {
            Given::One(index) => {
                Some(self.give(&args[index], &param.ty, Role::Argument { name: param.name, of: word.name }))
            }
            Given::Default | Given::Rest(_) => None,
        });
        let values = values.collect();
        self.push(hir::ExprKind::Choice(word.name, values), Type::Choice(kind), span)
    }

    fn report_word(&mut self, kind: ChoiceKind, found: &str, span: Span) {
        let words = kind.words();
        let names: Vec<&str> = words.iter().map(|word| word.name).collect();
        let message = format!("there is no {} `{found}`", kind.name());
        let error = Diagnostic::error("E0310", message, span, format!("no such {}", kind.name()));
        let error = match self.suggest(found, |_| names.clone()) {
            Some(near) => error.did_you_mean(&near, span),
            None => {
                let forms: Vec<String> = words.iter().map(|word| format!("`{}`", form(word))).collect();
                error.with_help(format!("write {}", forms.join(" or ")))
            }
        };
        self.report(error);
    }

    /// `{ key: value, … }` where settings are asked for.
    pub(super) fn settings(&mut self, entries: &'a [Entry], kind: SettingsKind, span: Span) -> ExprId {
        let keys = kind.keys();
        let mut seen: HashMap<&str, usize> = HashMap::new();
        let mut given = Vec::with_capacity(entries.len());
        for (i, entry) in entries.iter().enumerate() {
            let Some(key) = keys.iter().find(|key| key.name == entry.key.text) else {
                self.report_key(entry, &format!("{} have", kind.name()), &keys);
                continue;
            };
            let value = self.expect(&entry.value, &key.ty, Role::Key(key.name));
            match seen.get(key.name) {
                Some(&first) => self.report_key_twice(entries, first, i),
                None => {
                    seen.insert(key.name, i);
                    given.push((key.name, value));
                }
            }
        }
        self.push(hir::ExprKind::Settings(given), Type::Settings(kind), span)
    }

    /// The name of a block where one is asked for; `camera` is the camera.
    pub(super) fn block_name(&mut self, name: &str, kind: BlockKind, span: Span) -> ExprId {
        let is_known = match self.block_names.get(name) {
            Some(found) => *found == kind,
            None => !kind.is_named() && name == kind.keyword(),
        };
        if is_known {
            return self.push(hir::ExprKind::BlockName(name.to_owned()), Type::Block(kind), span);
        }
        let keyword = kind.keyword();
        let (message, label) = match self.block_names.get(name) {
            Some(found) => (
                format!("`{name}` is {}, not {}", article(found.keyword()), article(keyword)),
                "another kind",
            ),
            None => (format!("there is no {keyword} `{name}`"), "no such block"),
        };
        let error = Diagnostic::error("E0316", message, span, label);
        let known = |checker: &Self| {
            let mut names: Vec<&'a str> =
                checker.block_names.iter().filter(|(_, k)| **k == kind).map(|(name, _)| *name).collect();
            names.sort_unstable();
            names
        };
        let error = match (self.suggest(name, known), &known(self)[..]) {
            (Some(near), _) => error.did_you_mean(&near, span),
            (None, []) if self.block_names.contains_key(name) => {
                error.with_help(format!("the scene has no {keyword} with a name"))
            }
            (None, []) => error.with_help(format!("add a block: `{keyword} {name} {{ … }}`")),
            (None, names) => error.with_help(format!("the scene has `{}`", names.join("`, `"))),
        };
        self.report(error);
        self.wrong(span)
    }

    /// Names between round brackets where nothing asks for them.
    pub(super) fn stray_names(&mut self, arguments: &'a [Argument], span: Span) -> ExprId {
        let names: Vec<&Name> = arguments.iter().filter_map(|argument| argument.name.as_ref()).collect();
        let place = names.first().map_or(span, |name| name.span);
        let message = "the components of a vector have no names";
        let error = Diagnostic::error("E0213", message, place, "a name is given here");
        self.report(error.with_help("write a vector as `(x, y, z)`"));
        let args = Arg::list(arguments);
        self.abandon(&args, span)
    }
}

/// How a word is written.
fn form(word: &Word) -> String {
    if word.params.is_empty() {
        return word.name.to_owned();
    }
    let param = |param: &Key| match param.required {
        true => format!("{}: {}", param.name, param.ty),
        false => format!("{}: {} = …", param.name, param.ty),
    };
    format!("{}({})", word.name, word.params.iter().map(param).collect::<Vec<_>>().join(", "))
}
