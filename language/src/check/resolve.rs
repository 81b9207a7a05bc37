//! Names: what they stand for, and making new ones.

use super::constant::Constant;
use super::item::Kind;
use super::{BUILT_IN_VALUES, Checker, construct};
use crate::ast::{self, Expr, Name};
use crate::diag::{Diagnostic, Fix};
use crate::hir::{self, ExprId, LocalId};
use crate::module::ModuleId;
use crate::source::Span;
use crate::ty::Type;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

impl<'a> Checker<'a> {
    /// A name used as a value.
    pub(super) fn name(&mut self, name: &'a str, span: Span) -> ExprId {
        if let Some(local) = self.scope.find(name) {
            let ty = self.scope.local(local).ty.clone();
            return if ty == Type::Error {
                self.wrong(span)
            } else {
                self.push(hir::ExprKind::Local(local), ty, span)
            };
        }
        if let Some(index) = self.item_named(name) {
            return self.global(name, index, span);
        }
        if self.import_named(name).is_some() {
            return self.stray_import(name, span);
        }
        match name {
            "time" => self.push(hir::ExprKind::Time, Type::Float, span),
            "frame" => self.push(hir::ExprKind::Frame, Type::Int, span),
            "pi" => self.push(hir::ExprKind::Number(PI), Type::Float, span),
            "tau" => self.push(hir::ExprKind::Number(TAU), Type::Float, span),
            // `phase: rayleigh` is as good as `rayleigh()`.
            _ if self.needs_no_argument(name) => self.call_library(name, span, Vec::new(), span),
            _ if self.builtins.contains_key(name) || construct::is_constructor(name) => {
                self.uncalled(name, span)
            }
            _ => self.unknown_name(name, span),
        }
    }

    /// The import of the visible file with this name: the file behind it, if that could be read.
    fn import_named(&self, name: &str) -> Option<Option<ModuleId>> {
        let imports = &self.modules.get(self.module.0 as usize)?.imports;
        imports.iter().find(|(alias, _)| alias.text == name).map(|(_, module)| *module)
    }

    /// The import that an expression names, as in `clouds` of `clouds.puff(…)`.
    pub(super) fn import(&self, expr: &Expr) -> Option<Option<ModuleId>> {
        let ast::ExprKind::Name(name) = &expr.kind else { return None };
        if self.scope.find(name).is_some() || self.item_named(name).is_some() {
            return None;
        }
        self.import_named(name)
    }

    /// The item `name` of an imported file, by index; reports it if there is none.
    pub(super) fn imported_item(&mut self, module: ModuleId, name: &Name) -> Option<usize> {
        let found = self.globals[module.0 as usize].get(name.text.as_str()).copied();
        if found.is_none() {
            let text = &name.text;
            let file = &self.modules[module.0 as usize].prefix;
            let message = format!("the import `{}` has no item `{text}`", file.trim_end_matches('.'));
            let error = Diagnostic::error("E0605", message, name.span, "no such item");
            let known = |checker: &Self| checker.globals[module.0 as usize].keys().copied().collect();
            let help = match self.suggest(text, known) {
                Some(near) => format!("did you mean `{near}`"),
                None => "its functions, `let`s and params can be used".to_owned(),
            };
            self.report(error.with_help(help));
        }
        found
    }

    /// `clouds.base`
    pub(super) fn imported_value(&mut self, module: Option<ModuleId>, name: &Name, span: Span) -> ExprId {
        match module.and_then(|module| self.imported_item(module, name)) {
            Some(index) => self.global(&name.text, index, span),
            None => self.wrong(span),
        }
    }

    fn stray_import(&mut self, name: &str, span: Span) -> ExprId {
        let message = format!("`{name}` is an import, not a value");
        let error = Diagnostic::error("E0606", message, span, "an import");
        self.report(error.with_help(format!("name one of its items: `{name}.item`")));
        self.wrong(span)
    }

    pub(super) fn global(&mut self, name: &str, index: usize, span: Span) -> ExprId {
        match &self.items[index].kind {
            Kind::Param { id, .. } => {
                let (id, ty) = (*id, self.scene.params[id.index()].ty.clone());
                if ty == Type::Error {
                    self.wrong(span)
                } else {
                    self.push(hir::ExprKind::Param(id), ty, span)
                }
            }
            Kind::Let { id: Some(id), .. } => {
                let id = *id;
                let ty = self.ty(self.scene.lets[id.index()].value).clone();
                if ty == Type::Error { self.wrong(span) } else { self.push(hir::ExprKind::Let(id), ty, span) }
            }
            // Part of a cycle; reported.
            Kind::Let { id: None, .. } => self.wrong(span),
            Kind::Function { .. } => self.uncalled(name, span),
        }
    }

    /// Whether a function of the library takes no argument at all.
    fn needs_no_argument(&self, name: &str) -> bool {
        let forms = self.builtins.get(name).map_or(&[][..], |forms| forms);
        forms.iter().any(|&id| self.library.signature(id).params.is_empty())
    }

    fn uncalled(&mut self, name: &str, span: Span) -> ExprId {
        let message = format!("the function `{name}` stands where a value is expected");
        let error = Diagnostic::error("E0217", message, span, "not called");
        let form = self.form_of(name).unwrap_or_else(|| format!("{name}(…)"));
        let fix = form.starts_with(&format!("{name}()")).then(|| Fix::insert(span.end, "()"));
        self.report(error.with_help(format!("call it; its form is `{form}`")).with_fix(fix));
        self.wrong(span)
    }

    fn unknown_name(&mut self, name: &str, span: Span) -> ExprId {
        let known = |checker: &Self| {
            let items = checker.globals.get(checker.module.0 as usize).into_iter().flat_map(HashMap::keys);
            checker.scope.names().chain(items.copied()).chain(BUILT_IN_VALUES).collect()
        };
        let error = Diagnostic::error("E0201", format!("`{name}` is not defined"), span, "no such name");
        let error = match self.suggest(name, known) {
            Some(near) => error.did_you_mean(&near, span),
            None => error.with_help(format!("define it: `let {name} = …`")),
        };
        self.report(error);
        self.wrong(span)
    }

    /// Reports a call of something that does not exist.
    pub(super) fn unknown_function(&mut self, name: &str, span: Span) {
        let known = |checker: &Self| {
            let users = checker
                .items
                .iter()
                .filter(|item| item.module == checker.module && matches!(item.kind, Kind::Function { .. }));
            let users = users.map(|item| item.name.text.as_str());
            users.chain(checker.builtins.keys().copied()).chain(construct::NAMES).collect()
        };
        let error =
            Diagnostic::error("E0201", format!("there is no function `{name}`"), span, "no such function");
        let error = match self.suggest(name, known) {
            Some(near) => error.did_you_mean(&near, span),
            None => error.with_help(format!("define it: `fn {name}(x: float) -> float {{ … }}`")),
        };
        self.report(error);
    }

    /// Makes a visible binding; the names of built-in values stay theirs.
    pub(super) fn bind(&mut self, name: &'a Name, ty: Type, constant: Option<Constant>) -> LocalId {
        if BUILT_IN_VALUES.contains(&name.text.as_str()) {
            self.report_taken(name);
        }
        self.scope.bind(&name.text, ty, constant)
    }

    /// Reports a definition of a name that the language or its library has.
    pub(super) fn report_taken(&mut self, name: &Name) {
        let text = &name.text;
        let what = if BUILT_IN_VALUES.contains(&text.as_str()) { "value" } else { "function" };
        let message = format!("`{text}` is a built-in {what} and cannot be defined anew");
        let error = Diagnostic::error("E0203", message, name.span, "this name is taken");
        self.report(error.with_help(format!("choose another name, such as `my_{text}`")));
    }

    /// Reports names that stand twice in one list of bindings.
    pub(super) fn report_repeats(&mut self, names: impl Iterator<Item = &'a Name>) {
        let mut seen: HashMap<&str, Span> = HashMap::new();
        for name in names {
            match seen.get(name.text.as_str()) {
                Some(&first) => self.report_twice(name, first),
                None => {
                    seen.insert(&name.text, name.span);
                }
            }
        }
    }

    /// Reports the second definition of a name.
    pub(super) fn report_twice(&mut self, name: &Name, first: Span) {
        let text = &name.text;
        let error =
            Diagnostic::error("E0202", format!("`{text}` is defined twice"), name.span, "defined again here");
        let error = error.with_label(first, "first defined here");
        self.report(error.with_help(format!("choose another name, such as `{text}2`")));
    }
}
