//! Calls: finding what is called, and calls of users' functions and function values.

use super::Checker;
use super::arguments::{Given, Slot, bind};
use super::construct;
use super::convert::Role;
use super::item::{Head, Kind};
use super::words;
use crate::ast::{Argument, Expr, Name};
use crate::diag::{Diagnostic, Fix};
use crate::hir::{ExprId, ExprKind};
use crate::library::BuiltinId;
use crate::module::ModuleId;
use crate::source::Span;
use crate::ty::Type;
use std::rc::Rc;

/// An argument of a call, typed or not yet.
#[derive(Clone, Copy)]
pub(super) struct Arg<'a> {
    /// Its name if the call gives it.
    pub(super) name: Option<&'a Name>,
    /// Its value.
    pub(super) value: Value<'a>,
    /// The value's place.
    pub(super) span: Span,
}

/// The value of an argument.
#[derive(Clone, Copy)]
pub(super) enum Value<'a> {
    /// Typed already.
    Typed(ExprId),
    /// As written.
    Written(&'a Expr),
}

impl<'a> Arg<'a> {
    /// An argument without a name.
    pub(super) fn unnamed(value: &'a Expr) -> Self {
        Self { name: None, value: Value::Written(value), span: value.span }
    }

    /// The arguments as written.
    pub(super) fn list(arguments: &'a [Argument]) -> Vec<Self> {
        let arg = |argument: &'a Argument| Self {
            name: argument.name.as_ref(),
            value: Value::Written(&argument.value),
            span: argument.value.span,
        };
        arguments.iter().map(arg).collect()
    }
}

impl<'a> Checker<'a> {
    /// `receiver.name(arguments)`, the same as `name(receiver, arguments)`.
    pub(super) fn method_call(
        &mut self,
        receiver: ExprId,
        name: &'a Name,
        arguments: &'a [Argument],
        span: Span,
    ) -> ExprId {
        let first = Arg { name: None, value: Value::Typed(receiver), span: self.span(receiver) };
        let mut args = vec![first];
        args.extend(Arg::list(arguments));
        self.call(&name.text, name.span, args, span)
    }

    /// A call of what a name stands for.
    pub(super) fn call(&mut self, name: &'a str, name_span: Span, args: Vec<Arg<'a>>, span: Span) -> ExprId {
        let is_library = self.builtins.contains_key(name) || construct::is_constructor(name);
        if let Some(local) = self.scope.find(name) {
            // A value that happens to be called like a library function does not hide it.
            let is_value = matches!(self.scope.local(local).ty, Type::Function(_) | Type::Error);
            if is_value || !is_library {
                let callee = self.name(name, name_span);
                return self.call_value(callee, args, span);
            }
        } else if let Some(index) = self.item_named(name)
            && (!is_library || self.can_be_called(index))
        {
            return self.call_item(name, index, name_span, args, span);
        }
        if construct::is_constructor(name) {
            return self.construct(name, name_span, args, span);
        }
        if is_library {
            return self.call_library(name, name_span, args, span);
        }
        if super::BUILT_IN_VALUES.contains(&name) {
            let callee = self.name(name, name_span);
            return self.call_value(callee, args, span);
        }
        self.unknown_function(name, name_span);
        self.abandon(&args, span)
    }

    /// Whether an item is a function or holds one; true for what was reported.
    fn can_be_called(&self, index: usize) -> bool {
        match &self.items[index].kind {
            Kind::Param { .. } => false,
            Kind::Let { id, .. } => id.is_none_or(|id| {
                matches!(self.ty(self.scene.lets[id.index()].value), Type::Function(_) | Type::Error)
            }),
            Kind::Function { .. } => true,
        }
    }

    /// A call of an item of this or an imported file.
    fn call_item(
        &mut self,
        name: &str,
        index: usize,
        name_span: Span,
        args: Vec<Arg<'a>>,
        span: Span,
    ) -> ExprId {
        let Kind::Function { head, .. } = &self.items[index].kind else {
            let callee = self.global(name, index, name_span);
            return self.call_value(callee, args, span);
        };
        match head.clone() {
            Some(head) => self.call_function(&head, name_span, args, span),
            // Part of a cycle; reported.
            None => self.abandon(&args, span),
        }
    }

    /// `clouds.puff(arguments)`
    pub(super) fn imported_call(
        &mut self,
        module: Option<ModuleId>,
        name: &Name,
        arguments: &'a [Argument],
        span: Span,
    ) -> ExprId {
        let args = Arg::list(arguments);
        match module.and_then(|module| self.imported_item(module, name)) {
            Some(index) => self.call_item(&name.text, index, name.span, args, span),
            None => self.abandon(&args, span),
        }
    }

    /// A call of a function of the library: the compiler's, or the standard library's.
    pub(super) fn library_call(&self, id: BuiltinId, values: Vec<ExprId>) -> ExprKind {
        let place = (id.0 as usize).checked_sub(self.own);
        match place.map(|place| self.standard[place]) {
            None => ExprKind::CallBuiltin(id, values),
            Some(Some(function)) => ExprKind::CallFunction(function, values),
            // Only where the library itself is wrong, which was then reported.
            Some(None) => ExprKind::Error,
        }
    }

    /// A call of a function value.
    pub(super) fn call_value(&mut self, callee: ExprId, args: Vec<Arg<'a>>, span: Span) -> ExprId {
        let function = match self.ty(callee).clone() {
            Type::Function(function) => function,
            Type::Error => return self.abandon(&args, span),
            ty => {
                let text = self.source_text(callee).unwrap_or_else(|| "(…)".to_owned());
                let message = format!("`{text}` is {}, not a function", words::a(&ty));
                let error = Diagnostic::error("E0210", message, self.span(callee), "called here");
                self.report(error.with_help(format!("remove the arguments, or multiply: `{text} * (…)`")));
                return self.abandon(&args, span);
            }
        };
        let form = Type::Function(function.clone()).to_string();
        if let Some((name, value)) = args.iter().find_map(|arg| Some((arg.name?, arg.span))) {
            let message = "the arguments of a function value have no names";
            let error = Diagnostic::error("E0213", message, name.span, "a name is given here");
            let fix = Fix::remove(Span { start: name.span.start, end: value.start });
            let help = format!("remove `{}:`; the function is `{form}`", name.text);
            self.report(error.with_help(help).with_fix(fix));
            return self.abandon(&args, span);
        }
        if args.len() != function.params.len() {
            let wanted = function.params.len();
            let code = if args.len() < wanted { "E0211" } else { "E0212" };
            let message = format!("this function takes {wanted} arguments, found {}", args.len());
            let error = Diagnostic::error(code, message, self.span(callee), "called here");
            self.report(error.with_help(format!("the function is `{form}`")));
            return self.abandon(&args, span);
        }
        let values = args.iter().zip(&function.params).map(|(arg, ty)| self.give(arg, ty, Role::Call));
        let values = values.collect();
        self.push(ExprKind::CallValue(callee, values), function.result, span)
    }

    fn call_function(
        &mut self,
        head: &Rc<Head<'a>>,
        name_span: Span,
        args: Vec<Arg<'a>>,
        span: Span,
    ) -> ExprId {
        let slots = head.params.iter().map(|param| Slot {
            name: param.name,
            optional: param.default.is_some(),
            rest: false,
        });
        let slots: Vec<Slot<'_>> = slots.collect();
        let given = match bind(&slots, &args) {
            Ok(given) => given,
            Err(misfit) => {
                self.report_misfit(misfit, &args, &slots, head.name, name_span, &words::head(head));
                self.abandon(&args, span);
                return self.result_of(head, span);
            }
        };
        let mut values = Vec::with_capacity(given.len());
        for (param, given) in head.params.iter().zip(given) {
            let role = Role::Argument { name: param.name, of: head.name };
            values.push(match (given, param.default) {
                (Given::One(index), _) => self.give(&args[index], &param.ty, role),
                (Given::Default, Some(default)) => default,
                (Given::Default | Given::Rest(_), _) => self.wrong(span),
            });
        }
        if head.result == Type::Error {
            return self.wrong(span);
        }
        self.push(ExprKind::CallFunction(head.id, values), head.result.clone(), span)
    }

    /// Stands for a call that went wrong but whose type is known.
    fn result_of(&mut self, head: &Head<'a>, span: Span) -> ExprId {
        self.push(ExprKind::Error, head.result.clone(), span)
    }

    /// An argument as the type of its parameter.
    pub(super) fn give(&mut self, arg: &Arg<'a>, ty: &Type, role: Role<'a>) -> ExprId {
        match arg.value {
            Value::Typed(id) => self.convert(id, ty, role),
            Value::Written(expr) => self.expect(expr, ty, role),
        }
    }

    /// An argument by itself.
    pub(super) fn typed(&mut self, arg: &Arg<'a>) -> ExprId {
        match arg.value {
            Value::Typed(id) => id,
            Value::Written(expr) => self.infer(expr),
        }
    }

    /// Checks the arguments of a call that was reported.
    pub(super) fn abandon(&mut self, args: &[Arg<'a>], span: Span) -> ExprId {
        for arg in args {
            if let Value::Written(expr) = arg.value
                && !self.is_deferred(expr)
            {
                self.infer(expr);
            }
        }
        self.wrong(span)
    }

    /// How a function is called, for help lines.
    pub(super) fn form_of(&self, name: &str) -> Option<String> {
        if let Some(index) = self.item_named(name) {
            let Kind::Function { head, .. } = &self.items[index].kind else { return None };
            return head.as_ref().map(|head| words::head(head));
        }
        if let Some(form) = construct::form(name) {
            return Some(form.to_owned());
        }
        let id = *self.builtins.get(name)?.first()?;
        Some(words::signature(self.library.signature(id)))
    }
}
