//! Function values: lambdas, and names of functions used as values.

use super::Checker;
use super::convert::{Role, cost};
use super::item::{Head, Kind};
use super::scope::Mark;
use crate::ast::{Expr, ExprKind, Name};
use crate::diag::Diagnostic;
use crate::hir::{self, ExprId};
use crate::library::{BuiltinId, DefaultValue};
use crate::source::Span;
use crate::ty::{FunctionType, Type};
use std::rc::Rc;

/// What a made-up lambda calls.
enum Callee<'a> {
    User(Rc<Head<'a>>),
    Library(BuiltinId),
    Value(ExprId),
}

impl<'a> Checker<'a> {
    /// A lambda where `ty` is expected.
    pub(super) fn lambda(
        &mut self,
        params: &'a [Name],
        body: &'a Expr,
        span: Span,
        ty: &Type,
        role: Role<'a>,
    ) -> ExprId {
        let Type::Function(function) = ty else {
            return self.stray_function("a function", Some((ty, role)), span);
        };
        if let Some(extra) = params.get(function.params.len()) {
            let wanted = function.params.len();
            let message =
                format!("expected {}{role}, found one with {} parameters", super::words::a(ty), params.len());
            let label = if wanted == 1 {
                "only one value comes in".to_owned()
            } else {
                format!("only {wanted} values come in")
            };
            self.report(
                Diagnostic::error("E0218", message, extra.span, label)
                    .with_help(format!("remove `{}`", extra.text)),
            );
        }
        self.report_repeats(params.iter());
        let mark: Mark = self.scope.mark();
        let locals = params.iter().enumerate().map(|(i, name)| {
            let ty = function.params.get(i).cloned().unwrap_or(Type::Error);
            self.bind(name, ty, None)
        });
        let locals: Vec<_> = locals.collect();
        let body = self.expect(body, &function.result, role);
        self.scope.leave(mark);
        if params.len() > function.params.len() {
            return self.wrong(span);
        }
        self.push(hir::ExprKind::Lambda(locals, body), ty.clone(), span)
    }

    /// Reports a function in a place that asks for something else.
    pub(super) fn stray_function(
        &mut self,
        what: &str,
        wanted: Option<(&Type, Role<'a>)>,
        span: Span,
    ) -> ExprId {
        match wanted {
            Some((Type::Error, _)) => {}
            Some((ty, role)) => {
                let message = format!("expected {}{role}, found {what}", super::words::a(ty));
                let error = Diagnostic::error("E0217", message, span, format!("this is {what}"));
                self.report(error.with_help(self.example(ty)));
            }
            None => {
                let message = format!("{what} stands where nothing asks for one");
                let error =
                    Diagnostic::error("E0217", message, span, "the types of its parameters are unknown");
                self.report(
                    error.with_help("write `fn name(x: float) -> float { … }` at the top of the file"),
                );
            }
        }
        self.wrong(span)
    }

    /// Whether a name stands for a function of the user or the library.
    pub(super) fn is_function_name(&self, name: &str) -> bool {
        if self.scope.find(name).is_some() {
            return false;
        }
        match self.item_named(name) {
            Some(index) => matches!(self.items[index].kind, Kind::Function { .. }),
            None => self.builtins.contains_key(name),
        }
    }

    /// The function of an imported file that `clouds.puff` names, by the index of its item.
    pub(super) fn imported_function(&self, expr: &Expr) -> Option<usize> {
        let ExprKind::Field(of, name) = &expr.kind else { return None };
        let module = self.import(of)??;
        let index = *self.globals[module.0 as usize].get(name.text.as_str())?;
        matches!(self.items[index].kind, Kind::Function { .. }).then_some(index)
    }

    /// Whether only the expected type can say what an expression is: lambdas, names of functions,
    /// empty lists, and what ends in one of these.
    pub(super) fn is_deferred(&self, expr: &Expr) -> bool {
        let mut rest = vec![(expr, true)];
        while let Some((expr, names)) = rest.pop() {
            match &expr.kind {
                ExprKind::Lambda(..) => return true,
                // Inside a block the name may be bound to something else.
                ExprKind::Name(name) if names && self.is_function_name(name) => return true,
                ExprKind::Field(..) if self.imported_function(expr).is_some() => return true,
                ExprKind::Field(..) => {}
                ExprKind::List(items) if items.is_empty() => return true,
                ExprKind::List(items) => rest.extend(items.iter().map(|item| (item, names))),
                ExprKind::Comprehension { body, .. } => rest.push((body, false)),
                ExprKind::Block(_, value) => rest.push((value, false)),
                ExprKind::If(_, yes, no) => rest.extend([(&**no, names), (&**yes, names)]),
                ExprKind::Bool(_)
                | ExprKind::Int(_)
                | ExprKind::Float(_)
                | ExprKind::Angle(_)
                | ExprKind::Color(_)
                | ExprKind::String(_)
                | ExprKind::Name(_)
                | ExprKind::Tuple(_)
                | ExprKind::Range(..)
                | ExprKind::Unary(..)
                | ExprKind::Binary(..)
                | ExprKind::Call(..)
                | ExprKind::MethodCall(..)
                | ExprKind::NamedTuple(_)
                | ExprKind::Record(_)
                | ExprKind::Iterate(_)
                | ExprKind::Keys(_) => {}
            }
        }
        false
    }

    /// What it costs to use an expression for which [`Self::is_deferred`] holds as `to`.
    pub(super) fn deferred_cost(&self, expr: &Expr, to: &Type) -> Option<u32> {
        match (&expr.kind, to) {
            (_, Type::Error) => Some(0),
            (ExprKind::Lambda(params, _), Type::Function(to)) => {
                (params.len() <= to.params.len()).then_some(0)
            }
            (ExprKind::Name(name), Type::Function(to)) => self.named_callee(name, to).map(|(_, cost)| cost),
            (ExprKind::Field(..), Type::Function(to)) => {
                let index = self.imported_function(expr)?;
                self.item_callee(index, to).map(|(_, cost)| cost)
            }
            // A word; whether it is one of the choice's is said where it is taken.
            (_, Type::Choice(_)) => Some(0),
            (ExprKind::List(items), Type::List(element)) => {
                let deferred = items.iter().filter(|item| self.is_deferred(item));
                deferred.map(|item| self.deferred_cost(item, element)).sum()
            }
            (ExprKind::Comprehension { .. }, Type::List(_)) => Some(0),
            (ExprKind::If(..) | ExprKind::Block(..), Type::Function(_) | Type::List(_)) => Some(0),
            _ => None,
        }
    }

    /// The name of a function where a function value is expected.
    pub(super) fn function_name(
        &mut self,
        name: &'a str,
        to: &FunctionType,
        span: Span,
        role: Role<'a>,
    ) -> ExprId {
        match self.named_callee(name, to) {
            Some((callee, _)) => {
                let from = self.callee_type(&callee);
                self.adapt(callee, &from, to, span)
            }
            None => {
                let form = self.form_of(name);
                self.unfitting_function(name, form, to, span, role)
            }
        }
    }

    /// `clouds.puff` where a function value is expected.
    pub(super) fn imported_function_value(
        &mut self,
        index: usize,
        to: &FunctionType,
        span: Span,
        role: Role<'a>,
    ) -> ExprId {
        if let Some((callee, _)) = self.item_callee(index, to) {
            let from = self.callee_type(&callee);
            return self.adapt(callee, &from, to, span);
        }
        let form = match &self.items[index].kind {
            Kind::Function { head: Some(head), .. } => Some(super::words::head(head)),
            Kind::Function { head: None, .. } | Kind::Let { .. } | Kind::Param { .. } => None,
        };
        let name = &self.items[index].name.text;
        self.unfitting_function(name, form, to, span, role)
    }

    fn unfitting_function(
        &mut self,
        name: &str,
        form: Option<String>,
        to: &FunctionType,
        span: Span,
        role: Role<'a>,
    ) -> ExprId {
        let Some(form) = form else {
            // A function that depends on itself; reported.
            return self.wrong(span);
        };
        let wanted = Type::function(to.params.clone(), to.result.clone());
        let message = format!("expected {}{role}, found `{name}`", super::words::a(&wanted));
        let error = Diagnostic::error("E0205", message, span, "this function does not fit");
        self.report(
            error.with_help(format!("it is `{form}`; write a function that calls it: `x => {name}(x)`")),
        );
        self.wrong(span)
    }

    /// The function behind a name that fits best, with its cost.
    fn named_callee(&self, name: &str, to: &FunctionType) -> Option<(Callee<'a>, u32)> {
        let target = Type::function(to.params.clone(), to.result.clone());
        if let Some(index) = self.item_named(name) {
            return self.item_callee(index, to);
        }
        let fitting = self.builtins.get(name)?.iter().filter_map(|&id| {
            let from = self.callee_type(&Callee::Library(id));
            let has_rest = self.library.signature(id).params.iter().any(|param| param.rest);
            let cost = cost(&Type::Function(Box::new(from)), &target)?;
            (!has_rest).then_some((id, cost))
        });
        fitting.min_by_key(|&(_, cost)| cost).map(|(id, cost)| (Callee::Library(id), cost))
    }

    /// The function of an item, with its cost.
    fn item_callee(&self, index: usize, to: &FunctionType) -> Option<(Callee<'a>, u32)> {
        let Kind::Function { head: Some(head), .. } = &self.items[index].kind else { return None };
        let callee = Callee::User(head.clone());
        let from = self.callee_type(&callee);
        let target = Type::Function(Box::new(to.clone()));
        let cost = cost(&Type::Function(Box::new(from)), &target)?;
        Some((callee, cost))
    }

    /// The type of a function without its parameters that have defaults.
    fn callee_type(&self, callee: &Callee<'a>) -> FunctionType {
        match callee {
            Callee::User(head) => FunctionType {
                params: head.params.iter().filter(|p| p.default.is_none()).map(|p| p.ty.clone()).collect(),
                result: head.result.clone(),
            },
            Callee::Library(id) => {
                let signature = self.library.signature(*id);
                let required = signature.params.iter().filter(|p| p.default == DefaultValue::Required);
                FunctionType {
                    params: required.map(|p| p.ty.clone()).collect(),
                    result: signature.result.clone(),
                }
            }
            Callee::Value(id) => match self.ty(*id) {
                Type::Function(function) => (**function).clone(),
                _ => FunctionType { params: Vec::new(), result: Type::Error },
            },
        }
    }

    /// A function value as one of another type that [`cost`] allows.
    pub(super) fn adapt_value(
        &mut self,
        value: ExprId,
        from: &FunctionType,
        to: &FunctionType,
        span: Span,
    ) -> ExprId {
        self.adapt(Callee::Value(value), from, to, span)
    }

    /// `(a, b) => callee(a)`, with all conversions.
    fn adapt(&mut self, callee: Callee<'a>, from: &FunctionType, to: &FunctionType, span: Span) -> ExprId {
        let mut locals = Vec::new();
        let mut given = Vec::new();
        for (wanted, ty) in from.params.iter().zip(&to.params) {
            let local = self.scope.fresh(ty.clone());
            let value = self.push(hir::ExprKind::Local(local), ty.clone(), span);
            locals.push(local);
            given.push(self.pass(value, wanted));
        }
        let mut given = given.into_iter();
        let call = match callee {
            Callee::User(head) => {
                let args = head.params.iter().filter_map(|p| p.default.or_else(|| given.next())).collect();
                hir::ExprKind::CallFunction(head.id, args)
            }
            Callee::Library(id) => {
                let signature = self.library.signature(id);
                let args = signature.params.iter().filter_map(|p| match p.default {
                    DefaultValue::Required => given.next(),
                    DefaultValue::Number(_) | DefaultValue::Bool(_) | DefaultValue::Word(_) => {
                        Some(self.default_value(p, span))
                    }
                });
                let args = args.collect();
                self.library_call(id, args)
            }
            Callee::Value(value) => hir::ExprKind::CallValue(value, given.collect()),
        };
        let body = self.push(call, from.result.clone(), span);
        let body = self.convert(body, &to.result, Role::Internal);
        let ty = Type::function(to.params.clone(), to.result.clone());
        self.push(hir::ExprKind::Lambda(locals, body), ty, span)
    }
}
