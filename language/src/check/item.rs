//! Top-level items: declaring them, and checking `let`s and functions.

use super::Checker;
use super::convert::Role;
use super::names::mentioned;
use super::{BUILT_IN_VALUES, construct};
use crate::ast::{self, ItemKind, Name, TypeExpr, TypeExprKind};
use crate::blocks::BLOCK_KINDS;
use crate::diag::{Diagnostic, Fix};
use crate::hir::{self, ExprId, FunctionId, LetId, ParamId};
use crate::module::ModuleId;
use crate::source::Span;
use crate::standard;
use crate::ty::Type;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

/// Deepest nesting of a written type.
const MAX_TYPE_DEPTH: u32 = 64;

/// Most parameters of a user's function; a call costs as many values.
const MAX_PARAMETERS: usize = 64;

/// A param, `let` or function.
pub(super) struct Global<'a> {
    pub(super) name: &'a Name,
    /// The file that declares it.
    pub(super) module: ModuleId,
    pub(super) kind: Kind<'a>,
}

/// What an item is, and what is known of it once it is checked.
pub(super) enum Kind<'a> {
    /// Params have their places from the beginning.
    Param { param: &'a ast::Param, id: ParamId },
    /// `id` is missing until the `let` is checked.
    Let { binding: &'a ast::Let, id: Option<LetId> },
    /// `head` is missing until the function is checked, and if it cannot be called.
    Function { function: &'a ast::Function, head: Option<Rc<Head<'a>>> },
}

/// What a call of a user's function needs to know.
pub(super) struct Head<'a> {
    pub(super) name: &'a str,
    pub(super) params: Vec<HeadParam<'a>>,
    pub(super) result: Type,
    pub(super) id: FunctionId,
}

/// A parameter of a user's function.
pub(super) struct HeadParam<'a> {
    pub(super) name: &'a str,
    pub(super) ty: Type,
    pub(super) default: Option<ExprId>,
}

impl<'a> Checker<'a> {
    /// Enters the names of all items of a file; params get their places in source order.
    pub(super) fn declare(&mut self, index: usize) {
        self.module = ModuleId(index as u32);
        self.globals.push(HashMap::new());
        let modules = self.modules;
        let mut imports: HashMap<&'a str, Span> = HashMap::new();
        for item in &modules[index].file.items {
            let (name, kind) = match &item.kind {
                ItemKind::Import(import) => {
                    self.declare_import(&import.alias, &mut imports);
                    continue;
                }
                ItemKind::Param(param) => {
                    let id = self.declare_param(param, &item.doc);
                    (&param.name, Kind::Param { param, id })
                }
                ItemKind::Let(binding) => (&binding.name, Kind::Let { binding, id: None }),
                ItemKind::Function(function) => (&function.name, Kind::Function { function, head: None }),
                ItemKind::Block(block) => {
                    self.declare_block(block);
                    continue;
                }
            };
            let text = name.text.as_str();
            // A value may be called like a function of the library, which it does not hide.
            let is_library = construct::is_constructor(text) || self.builtins.contains_key(text);
            let is_function = matches!(kind, Kind::Function { .. });
            if BUILT_IN_VALUES.contains(&text) || (is_library && is_function) {
                self.report_taken(name);
            } else if let Some(first) = self.item_named(text) {
                let first = self.items[first].name.span;
                self.report_twice(name, first);
            } else if let Some(&first) = imports.get(text) {
                self.report_twice(name, first);
            } else {
                self.globals[index].insert(text, self.items.len());
            }
            self.items.push(Global { name, module: self.module, kind });
        }
    }

    fn declare_import(&mut self, alias: &'a Name, imports: &mut HashMap<&'a str, Span>) {
        let text = alias.text.as_str();
        if BUILT_IN_VALUES.contains(&text) {
            self.report_taken(alias);
        } else if let Some(&first) = imports.get(text) {
            self.report_twice(alias, first);
        } else if let Some(first) = self.item_named(text) {
            let first = self.items[first].name.span;
            self.report_twice(alias, first);
        } else {
            imports.insert(text, alias.span);
        }
    }

    /// Remembers the block's name; blocks of imported files do not count.
    fn declare_block(&mut self, block: &'a ast::Block) {
        let kind = BLOCK_KINDS.into_iter().find(|kind| kind.keyword() == block.keyword.text);
        if let (Some(name), Some(kind), ModuleId::ROOT) = (&block.name, kind, self.module) {
            self.block_names.insert(&name.text, kind);
        }
    }

    /// The item of the visible file with this name, by index.
    pub(super) fn item_named(&self, name: &str) -> Option<usize> {
        self.globals.get(self.module.0 as usize)?.get(name).copied()
    }

    /// Checks the functions of the standard library that `names` or each other use.
    pub(super) fn check_library(&mut self, names: &HashSet<String>) {
        let functions: Vec<&'static ast::Function> =
            standard::functions().map(|(function, _)| function).collect();
        let mut wanted: HashSet<&str> = names.iter().map(String::as_str).collect();
        let mut used: Vec<usize> = Vec::new();
        // A function only uses earlier ones, so that from the end all its users are known.
        for (index, function) in functions.iter().enumerate().rev() {
            if wanted.contains(function.name.text.as_str()) {
                wanted.extend(mentioned(function));
                used.push(index);
            }
        }
        self.module = ModuleId::LIBRARY;
        for index in used.into_iter().rev() {
            self.standard[index] = self.check_function(functions[index]).map(|head| head.id);
        }
    }

    /// Warns of `let`s and params that nothing uses.
    pub(super) fn warn_unused(&mut self, used: &[bool]) {
        for (index, item) in self.items.iter().enumerate() {
            let name = item.name;
            let is_known = self.globals[0].get(name.text.as_str()) == Some(&index);
            if used[index] || !is_known || name.text.starts_with('_') || item.module != ModuleId::ROOT {
                continue;
            }
            let (code, what) = match item.kind {
                Kind::Let { .. } => ("W0101", "name"),
                Kind::Param { .. } => ("W0102", "param"),
                Kind::Function { .. } => continue,
            };
            let text = &name.text;
            let warning = Diagnostic::warning(
                code,
                format!("the {what} `{text}` is never used"),
                name.span,
                "never used",
            );
            let warning = warning.with_help(format!("remove it, or call it `_{text}`"));
            self.diagnostics.push(warning.with_fix(Fix::insert(name.span.start, "_")));
        }
    }

    /// Reports items that depend on themselves; the place is where each uses the next.
    pub(super) fn report_cycle(&mut self, cycle: &[super::order::Use]) {
        let Some(&(first, span)) = cycle.first() else { return };
        let name = &self.items[first].name.text;
        let is_function = matches!(self.items[first].kind, Kind::Function { .. });
        let verb = if is_function { "calls" } else { "uses" };
        let message = match (cycle.len(), is_function) {
            (1, true) => format!("the function `{name}` calls itself"),
            (1, false) => format!("`{name}` is defined by itself"),
            (_, _) => format!("`{name}` depends on itself"),
        };
        let label = |i: usize| {
            let next = cycle[(i + 1) % cycle.len()].0;
            format!("`{}` {verb} `{}` here", self.items[cycle[i].0].name.text, self.items[next].name.text)
        };
        let mut error = Diagnostic::error("E0223", message, span, label(0));
        for (i, &(_, span)) in cycle.iter().enumerate().skip(1).take(7) {
            error = error.with_label(span, label(i));
        }
        let help = if let ([_], false) = (cycle, is_function) {
            &format!("give `{name}` a value that does not use it")
        } else if is_function {
            "a function cannot call itself; write the steps out, or build a list with `[for i in 0..8: …]`"
        } else {
            "define one of them without the other"
        };
        self.report(error.with_help(help));
    }

    /// Checks one item; the items that it uses are checked already, unless they use it.
    pub(super) fn check_item(&mut self, index: usize) {
        self.module = self.items[index].module;
        match self.items[index].kind {
            Kind::Param { param, id } => self.check_param(param, id),
            Kind::Let { binding, .. } => {
                let value = self.infer(&binding.value);
                let new = LetId(self.scene.lets.len() as u32);
                let name = &binding.name;
                self.scene.lets.push(hir::Let { name: name.text.clone(), value, span: name.span });
                if let Kind::Let { id, .. } = &mut self.items[index].kind {
                    *id = Some(new);
                }
            }
            Kind::Function { function, .. } => {
                let new = self.check_function(function).map(Rc::new);
                if let Kind::Function { head, .. } = &mut self.items[index].kind {
                    *head = new;
                }
            }
        }
    }

    /// Checks a function; `None` if nothing can call it.
    fn check_function(&mut self, function: &'a ast::Function) -> Option<Head<'a>> {
        if let Some(extra) = function.params.get(MAX_PARAMETERS) {
            let message = format!("a function has at most {MAX_PARAMETERS} parameters");
            let error = Diagnostic::error("E0232", message, extra.name.span, "one too many");
            self.report(error.with_help("take a vector or a list instead"));
            return None;
        }
        self.report_repeats(function.params.iter().map(|param| &param.name));
        let result = self.written_type(&function.result);
        let mut params = Vec::with_capacity(function.params.len());
        for param in &function.params {
            let name = param.name.text.as_str();
            let ty = self.written_type(&param.ty);
            let default = param.default.as_ref().map(|value| self.expect(value, &ty, Role::Default(name)));
            params.push(HeadParam { name, ty, default });
        }
        let mark = self.scope.mark();
        let mut locals = Vec::with_capacity(params.len());
        for (written, param) in function.params.iter().zip(&params) {
            locals.push((self.bind(&written.name, param.ty.clone(), None), param.ty.clone()));
        }
        let name = &function.name;
        let body = self.expect(&function.body, &result, Role::Result(&name.text));
        self.scope.leave(mark);
        let id = FunctionId(self.scene.functions.len() as u32);
        self.scene.functions.push(hir::Function {
            name: name.text.clone(),
            params: locals,
            result: result.clone(),
            body,
            span: name.span,
            module: self.module,
        });
        Some(Head { name: &name.text, params, result, id })
    }

    /// The type that is written; reports unknown ones.
    pub(super) fn written_type(&mut self, ty: &TypeExpr) -> Type {
        self.nested_type(ty, 0)
    }

    fn nested_type(&mut self, ty: &TypeExpr, depth: u32) -> Type {
        if depth > MAX_TYPE_DEPTH {
            let error = Diagnostic::error("E0226", "the type is nested too deeply", ty.span, "too deep here");
            self.report(error.with_help("write a type with fewer brackets"));
            return Type::Error;
        }
        match &ty.kind {
            TypeExprKind::Named(name) => self.named_type(name, ty),
            TypeExprKind::List(element) => match self.nested_type(element, depth + 1) {
                Type::Error => Type::Error,
                element => Type::list(element),
            },
            TypeExprKind::Function(params, result) => {
                let params: Vec<Type> =
                    params.iter().map(|param| self.nested_type(param, depth + 1)).collect();
                let result = self.nested_type(result, depth + 1);
                let is_wrong = result == Type::Error || params.contains(&Type::Error);
                if is_wrong { Type::Error } else { Type::function(params, result) }
            }
        }
    }

    fn named_type(&mut self, name: &str, ty: &TypeExpr) -> Type {
        if let Some(known) = Type::named(name) {
            return known;
        }
        let names: Vec<String> = Type::all_named().iter().map(Type::to_string).collect();
        let error = Diagnostic::error("E0204", format!("there is no type `{name}`"), ty.span, "no such type");
        let error = match self.suggest(name, |_| names.iter().map(String::as_str).collect()) {
            Some(near) => error.did_you_mean(&near, ty.span),
            None => error.with_help(format!("the types are `{}`", names.join("`, `"))),
        };
        self.report(error);
        Type::Error
    }
}
