//! Who uses whom: a walk over the untyped tree that resolves names, before any type is known.
//!
//! Out come the uses between top-level items, from which [`super::order`] makes the order of
//! checking, and the warnings for bindings that nobody uses. The walk is a loop over a stack of
//! steps, so a deep tree does no harm.

use super::order::Use;
use crate::ast::{Argument, Entry, Expr, ExprKind, Function, ItemKind, Iterate, Keys, Name};
use crate::diag::{Diagnostic, Fix};
use crate::module::{Module, ModuleId};
use crate::source::Span;
use std::collections::{HashMap, HashSet};

/// What the walk finds.
pub(super) struct Uses {
    /// For each item the items it uses, each once, with the first place.
    pub(super) edges: Vec<Vec<Use>>,
    /// Whether anything uses the item.
    pub(super) used: Vec<bool>,
    /// All names that stand anywhere: those of the library's functions among them.
    pub(super) mentioned: HashSet<String>,
    /// Parameters and block-local `let`s of the scene's own file that nobody uses.
    pub(super) warnings: Vec<Diagnostic>,
}

/// Walks all items; `globals` says for each file which name is which of the `count` items.
pub(super) fn uses(modules: &[Module], globals: &[HashMap<&str, usize>], count: usize) -> Uses {
    let mut found = Uses {
        edges: Vec::with_capacity(count),
        used: vec![false; count],
        mentioned: HashSet::new(),
        warnings: Vec::new(),
    };
    let items = modules.iter().enumerate();
    for (module, item) in items.flat_map(|(i, module)| module.file.items.iter().map(move |item| (i, item))) {
        let mut walker = Walker::new(&modules[module], module, globals);
        match &item.kind {
            ItemKind::Import(_) => {}
            // Blocks of imported files do not count.
            ItemKind::Block(_) if module > 0 => {}
            ItemKind::Param(param) => {
                walker.walk(vec![Step::Visit(&param.default)]);
                if let Some((low, high)) = &param.range {
                    walker.walk(vec![Step::Visit(low), Step::Visit(high)]);
                }
            }
            ItemKind::Let(binding) => walker.walk(vec![Step::Visit(&binding.value)]),
            ItemKind::Function(function) => walker.walk(function_steps(function)),
            ItemKind::Block(block) => walker.walk(entry_steps(&block.entries)),
        }
        if module == 0 {
            found.warnings.append(&mut walker.warnings);
        }
        found.mentioned.extend(walker.mentioned.iter().map(|name| (*name).to_owned()));
        for &(target, _) in &walker.uses {
            found.used[target] = true;
        }
        if !matches!(item.kind, ItemKind::Block(_) | ItemKind::Import(_)) {
            found.edges.push(walker.uses);
        }
    }
    found
}

/// The names that stand in the body of a function.
pub(super) fn mentioned(function: &Function) -> HashSet<&str> {
    let mut walker = Walker::alone();
    walker.walk(function_steps(function));
    walker.mentioned
}

/// What a binding is called in a warning; bindings without a kind may stay unused.
#[derive(Clone, Copy)]
enum Kind {
    Parameter,
    Let,
}

/// One step of the walk; steps are taken from the end of a stack.
enum Step<'a> {
    Visit(&'a Expr),
    Bind(&'a Name, Option<Kind>),
    /// Ends the newest bindings.
    Leave(usize),
}

struct Binding<'a> {
    name: &'a Name,
    kind: Option<Kind>,
    used: bool,
}

struct Walker<'a, 'g> {
    /// Its imports are known by name.
    imports: &'g [(Name, Option<ModuleId>)],
    globals: &'g [HashMap<&'a str, usize>],
    /// Index of the file.
    module: usize,
    /// Indices into `bindings` by name, innermost last.
    scope: HashMap<&'a str, Vec<usize>>,
    bindings: Vec<Binding<'a>>,
    seen: HashSet<usize>,
    uses: Vec<Use>,
    mentioned: HashSet<&'a str>,
    warnings: Vec<Diagnostic>,
}

impl<'a, 'g> Walker<'a, 'g> {
    fn new(file: &'g Module, module: usize, globals: &'g [HashMap<&'a str, usize>]) -> Self {
        Self { imports: &file.imports, globals, module, ..Walker::alone() }
    }

    /// For a function outside of any file.
    fn alone() -> Self {
        Self {
            imports: &[],
            globals: &[],
            module: 0,
            scope: HashMap::new(),
            bindings: Vec::new(),
            seen: HashSet::new(),
            uses: Vec::new(),
            mentioned: HashSet::new(),
            warnings: Vec::new(),
        }
    }

    fn walk(&mut self, mut steps: Vec<Step<'a>>) {
        while let Some(step) = steps.pop() {
            match step {
                Step::Visit(expr) => self.visit(expr, &mut steps),
                Step::Bind(name, kind) => {
                    self.scope.entry(&name.text).or_default().push(self.bindings.len());
                    self.bindings.push(Binding { name, kind, used: false });
                }
                Step::Leave(count) => {
                    for _ in 0..count {
                        self.leave();
                    }
                }
            }
        }
    }

    /// Resolves the names of one expression and pushes the steps for what is inside, last first.
    fn visit(&mut self, expr: &'a Expr, steps: &mut Vec<Step<'a>>) {
        match &expr.kind {
            ExprKind::Bool(_)
            | ExprKind::Int(_)
            | ExprKind::Float(_)
            | ExprKind::Angle(_)
            | ExprKind::Color(_)
            | ExprKind::String(_) => {}
            ExprKind::Name(name) => self.resolve(name, expr.span),
            ExprKind::Tuple(parts) | ExprKind::List(parts) => steps.extend(parts.iter().map(Step::Visit)),
            ExprKind::Comprehension { variable, range, body } => steps.extend([
                Step::Leave(1),
                Step::Visit(body),
                Step::Bind(variable, None),
                Step::Visit(range),
            ]),
            ExprKind::Range(a, b) | ExprKind::Binary(_, a, b) => {
                steps.extend([Step::Visit(b), Step::Visit(a)]);
            }
            ExprKind::NamedTuple(arguments) => steps.extend(argument_steps(arguments)),
            ExprKind::Field(of, name) => match self.import(of) {
                Some(module) => self.resolve_in(module, &name.text, name.span),
                None => steps.push(Step::Visit(of)),
            },
            ExprKind::Unary(_, inner) => steps.push(Step::Visit(inner)),
            ExprKind::If(condition, yes, no) => {
                steps.extend([Step::Visit(no), Step::Visit(yes), Step::Visit(condition)]);
            }
            ExprKind::Block(lets, value) => {
                steps.extend([Step::Leave(lets.len()), Step::Visit(value)]);
                for binding in lets.iter().rev() {
                    steps.extend([Step::Bind(&binding.name, Some(Kind::Let)), Step::Visit(&binding.value)]);
                }
            }
            ExprKind::Lambda(params, body) => {
                steps.extend([Step::Leave(params.len()), Step::Visit(body)]);
                steps.extend(params.iter().map(|name| Step::Bind(name, None)));
            }
            ExprKind::Call(callee, arguments) => {
                steps.extend(argument_steps(arguments));
                steps.push(Step::Visit(callee));
            }
            ExprKind::MethodCall(receiver, name, arguments) => {
                steps.extend(argument_steps(arguments));
                match self.import(receiver) {
                    Some(module) => self.resolve_in(module, &name.text, name.span),
                    None => {
                        self.resolve(&name.text, name.span);
                        steps.push(Step::Visit(receiver));
                    }
                }
            }
            ExprKind::Record(entries) => steps.extend(entry_steps(entries)),
            ExprKind::Iterate(iterate) => steps.extend(iterate_steps(iterate)),
            ExprKind::Keys(keys) => steps.extend(keys_steps(keys)),
        }
    }

    fn resolve(&mut self, name: &'a str, span: Span) {
        // Also where something else has the name: a value does not hide a function of the library.
        self.mentioned.insert(name);
        if let Some(&index) = self.scope.get(name).and_then(|indices| indices.last()) {
            self.bindings[index].used = true;
        } else if self.globals.get(self.module).is_some_and(|names| names.contains_key(name)) {
            self.resolve_in(ModuleId(self.module as u32), name, span);
        }
    }

    fn resolve_in(&mut self, module: ModuleId, name: &str, span: Span) {
        if let Some(&item) = self.globals[module.0 as usize].get(name)
            && self.seen.insert(item)
        {
            self.uses.push((item, span));
        }
    }

    /// The file that an expression names.
    fn import(&self, expr: &Expr) -> Option<ModuleId> {
        let ExprKind::Name(name) = &expr.kind else { return None };
        if self.scope.get(name.as_str()).is_some_and(|indices| !indices.is_empty()) {
            return None;
        }
        self.imports.iter().find(|(alias, _)| alias.text == *name).and_then(|(_, module)| *module)
    }

    fn leave(&mut self) {
        let Some(binding) = self.bindings.pop() else { return };
        let name = binding.name.text.as_str();
        if let Some(indices) = self.scope.get_mut(name) {
            indices.pop();
        }
        if binding.used || name.starts_with('_') {
            return;
        }
        let (code, what) = match binding.kind {
            None => return,
            Some(Kind::Parameter) => ("W0103", "parameter"),
            Some(Kind::Let) => ("W0104", "name"),
        };
        let warning = Diagnostic::warning(
            code,
            format!("the {what} `{name}` is never used"),
            binding.name.span,
            "never used",
        );
        let warning = warning.with_help(format!("remove it, or call it `_{name}`"));
        self.warnings.push(warning.with_fix(Fix::insert(binding.name.span.start, "_")));
    }
}

/// Defaults see no parameters; the body sees all of them.
fn function_steps(function: &Function) -> Vec<Step<'_>> {
    let mut steps = vec![Step::Leave(function.params.len()), Step::Visit(&function.body)];
    steps.extend(function.params.iter().rev().map(|param| Step::Bind(&param.name, Some(Kind::Parameter))));
    steps.extend(function.params.iter().rev().filter_map(|param| param.default.as_ref()).map(Step::Visit));
    steps
}

fn entry_steps(entries: &[Entry]) -> Vec<Step<'_>> {
    entries.iter().rev().map(|entry| Step::Visit(&entry.value)).collect()
}

/// First values and the number of steps see no state.
fn iterate_steps(iterate: &Iterate) -> Vec<Step<'_>> {
    let mut steps = vec![Step::Leave(iterate.state.len())];
    steps.extend(iterate.next.iter().map(|next| Step::Visit(&next.value)));
    steps.extend(iterate.condition.iter().map(Step::Visit));
    steps.extend(iterate.state.iter().map(|state| Step::Bind(&state.name, None)));
    steps.extend(iterate.state.iter().map(|state| Step::Visit(&state.value)));
    steps.push(Step::Visit(&iterate.count));
    steps
}

fn keys_steps(keys: &Keys) -> Vec<Step<'_>> {
    let mut steps: Vec<Step<'_>> = keys.ease.iter().map(Step::Visit).collect();
    steps.extend(keys.keys.iter().flat_map(|(place, value)| [Step::Visit(place), Step::Visit(value)]));
    steps.push(Step::Visit(&keys.at));
    steps
}

fn argument_steps(arguments: &[Argument]) -> impl Iterator<Item = Step<'_>> {
    arguments.iter().rev().map(|argument| Step::Visit(&argument.value))
}
