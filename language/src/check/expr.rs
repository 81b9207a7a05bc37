//! Typing of expressions: [`Checker::infer`] finds a type, [`Checker::expect`] is given one.

use super::call::Arg;
use super::convert::{Role, join, linear_from_srgb};
use super::words::a;
use super::{Checker, MAX_INT};
use crate::ast::{Argument, BinaryOp, Expr, ExprKind, Let, Name};
use crate::diag::{Diagnostic, Fix};
use crate::hir::{self, ExprId, LocalId, Over};
use crate::source::Span;
use crate::ty::Type;

/// Most lists inside each other.
const MAX_LIST_DEPTH: u32 = 32;

/// What is done to the value on the left of a chain.
#[derive(Clone, Copy)]
enum Link<'a> {
    Binary(BinaryOp, &'a Expr),
    Method(&'a Name, &'a [Argument]),
    Field(&'a Name),
    Call(&'a [Argument]),
}

/// Splits the outermost link off a chain of operators, methods, fields and calls.
fn split(expr: &Expr) -> Option<(&Expr, Link<'_>)> {
    match &expr.kind {
        ExprKind::Binary(op, left, right) => Some((left, Link::Binary(*op, right))),
        ExprKind::MethodCall(receiver, name, arguments) => Some((receiver, Link::Method(name, arguments))),
        ExprKind::Field(of, name) => Some((of, Link::Field(name))),
        ExprKind::Call(callee, arguments) if !matches!(callee.kind, ExprKind::Name(_)) => {
            Some((callee, Link::Call(arguments)))
        }
        ExprKind::Bool(_)
        | ExprKind::Int(_)
        | ExprKind::Float(_)
        | ExprKind::Angle(_)
        | ExprKind::Color(_)
        | ExprKind::String(_)
        | ExprKind::Name(_)
        | ExprKind::Tuple(_)
        | ExprKind::List(_)
        | ExprKind::Comprehension { .. }
        | ExprKind::Range(..)
        | ExprKind::Unary(..)
        | ExprKind::If(..)
        | ExprKind::Block(..)
        | ExprKind::Lambda(..)
        | ExprKind::Call(..)
        | ExprKind::NamedTuple(_)
        | ExprKind::Record(_)
        | ExprKind::Iterate(_)
        | ExprKind::Keys(_) => None,
    }
}

impl<'a> Checker<'a> {
    /// Types an expression that stands by itself.
    pub(super) fn infer(&mut self, expr: &'a Expr) -> ExprId {
        if !self.descend(expr.span) {
            return self.wrong(expr.span);
        }
        // Walk down the left side, then type from the inside out.
        let mut chain = Vec::new();
        let mut head = expr;
        while let Some((left, link)) = split(head)
            && self.import(left).is_none()
        {
            chain.push((head.span, link));
            head = left;
        }
        let mut value = self.infer_head(head);
        while let Some((span, link)) = chain.pop() {
            value = match link {
                Link::Binary(op, right) => {
                    let right = self.infer(right);
                    self.binary(op, value, right, span)
                }
                Link::Method(name, arguments) => self.method_call(value, name, arguments, span),
                Link::Field(name) => self.field(value, name, span),
                Link::Call(arguments) => self.call_value(value, Arg::list(arguments), span),
            };
        }
        self.depth -= 1;
        value
    }

    /// Types an expression whose place asks for `ty`, and converts it.
    pub(super) fn expect(&mut self, expr: &'a Expr, ty: &Type, role: Role<'a>) -> ExprId {
        if *ty == Type::Error && self.is_deferred(expr) {
            return self.wrong(expr.span);
        }
        if !self.is_shaped_by(expr, ty) {
            let value = self.infer(expr);
            return self.convert(value, ty, role);
        }
        if !self.descend(expr.span) {
            return self.wrong(expr.span);
        }
        let value = match (&expr.kind, ty) {
            (ExprKind::Lambda(params, body), _) => self.lambda(params, body, expr.span, ty, role),
            (ExprKind::Name(name), Type::Function(function)) => {
                self.function_name(name, function, expr.span, role)
            }
            (ExprKind::Field(..), Type::Function(function)) => match self.imported_function(expr) {
                Some(index) => self.imported_function_value(index, function, expr.span, role),
                None => self.wrong(expr.span),
            },
            (_, Type::Choice(kind)) if self.is_worded(expr, *kind) => self.choice(expr, *kind),
            (ExprKind::Record(entries), Type::Settings(kind)) => self.settings(entries, *kind, expr.span),
            (ExprKind::Name(name), Type::Block(kind)) => self.block_name(name, *kind, expr.span),
            (ExprKind::Keys(keys), _) => self.keys(keys, Some((ty, role)), expr.span),
            (ExprKind::List(items), Type::List(element)) => {
                let items = items.iter().map(|item| self.expect(item, element, role)).collect();
                self.push(hir::ExprKind::List(items), ty.clone(), expr.span)
            }
            (ExprKind::Comprehension { variable, range, body }, Type::List(element)) => {
                self.comprehension(variable, range, body, Some((element, role)), expr.span)
            }
            (ExprKind::If(condition, yes, no), _) => {
                let condition = self.expect(condition, &Type::Bool, Role::Condition);
                let (yes, no) = (self.expect(yes, ty, role), self.expect(no, ty, role));
                self.push(hir::ExprKind::If(condition, yes, no), ty.clone(), expr.span)
            }
            (ExprKind::Block(lets, value), _) => self.block(lets, value, Some((ty, role)), expr.span),
            _ => self.wrong(expr.span),
        };
        self.depth -= 1;
        value
    }

    /// Whether the expected type reaches inside the expression.
    fn is_shaped_by(&self, expr: &Expr, ty: &Type) -> bool {
        match &expr.kind {
            ExprKind::Lambda(..) => true,
            _ if matches!(ty, Type::Choice(kind) if self.is_worded(expr, *kind)) => true,
            ExprKind::Name(name) => match ty {
                Type::Function(_) => self.is_function_name(name),
                Type::Block(_) => self.scope.find(name).is_none() && self.item_named(name).is_none(),
                _ => false,
            },
            ExprKind::Field(..) => matches!(ty, Type::Function(_)) && self.imported_function(expr).is_some(),
            ExprKind::Record(_) => matches!(ty, Type::Settings(_)),
            ExprKind::Keys(_) => !matches!(ty, Type::Function(_) | Type::Error),
            ExprKind::List(_) | ExprKind::Comprehension { .. } => matches!(ty, Type::List(_)),
            ExprKind::If(..) | ExprKind::Block(..) => {
                !matches!(ty, Type::Function(_) | Type::Error) || self.is_deferred(expr)
            }
            ExprKind::Bool(_)
            | ExprKind::Int(_)
            | ExprKind::Float(_)
            | ExprKind::Angle(_)
            | ExprKind::Color(_)
            | ExprKind::String(_)
            | ExprKind::Tuple(_)
            | ExprKind::Range(..)
            | ExprKind::Unary(..)
            | ExprKind::Binary(..)
            | ExprKind::Call(..)
            | ExprKind::MethodCall(..)
            | ExprKind::NamedTuple(_)
            | ExprKind::Iterate(_) => false,
        }
    }

    /// Types what stands at the left end of a chain.
    fn infer_head(&mut self, expr: &'a Expr) -> ExprId {
        let span = expr.span;
        match &expr.kind {
            ExprKind::Bool(value) => self.push(hir::ExprKind::Bool(*value), Type::Bool, span),
            ExprKind::Int(value) => self.int(*value, span),
            ExprKind::Float(value) => self.real(*value, Type::Float, span),
            ExprKind::Angle(value) => self.real(*value, Type::Angle, span),
            ExprKind::Color(encoded) => {
                self.push(hir::ExprKind::Color(linear_from_srgb(*encoded)), Type::Color, span)
            }
            ExprKind::String(text) => self.push(hir::ExprKind::String(text.clone()), Type::String, span),
            ExprKind::Name(name) => self.name(name, span),
            ExprKind::Tuple(parts) => self.tuple(parts, span),
            ExprKind::List(items) => self.list(items, span),
            ExprKind::Comprehension { variable, range, body } => {
                self.comprehension(variable, range, body, None, span)
            }
            ExprKind::Range(..) => self.stray_range(span),
            ExprKind::Unary(op, inner) => {
                let inner = self.infer(inner);
                self.unary(*op, inner, span)
            }
            ExprKind::If(condition, yes, no) => self.branch(condition, yes, no, span),
            ExprKind::Block(lets, value) => self.block(lets, value, None, span),
            ExprKind::Lambda(..) => self.stray_function("a function", None, span),
            ExprKind::Call(callee, arguments) => match &callee.kind {
                ExprKind::Name(name) => self.call(name, callee.span, Arg::list(arguments), span),
                _ => self.wrong(span),
            },
            ExprKind::Record(_) => self.stray_record(span),
            ExprKind::NamedTuple(arguments) => self.stray_names(arguments, span),
            ExprKind::Iterate(iterate) => self.iterate(iterate, span),
            ExprKind::Keys(keys) => self.keys(keys, None, span),
            ExprKind::MethodCall(of, name, arguments) => match self.import(of) {
                Some(module) => self.imported_call(module, name, arguments, span),
                None => self.wrong(span),
            },
            ExprKind::Field(of, name) => match self.import(of) {
                Some(module) => self.imported_value(module, name, span),
                None => self.wrong(span),
            },
            // `infer` has split these off.
            ExprKind::Binary(..) => self.wrong(span),
        }
    }

    fn int(&mut self, value: i64, span: Span) -> ExprId {
        if value.unsigned_abs() > MAX_INT.unsigned_abs() {
            return self.too_large("whole numbers go from -16777216 to 16777216", span);
        }
        self.push(hir::ExprKind::Number(value as f64), Type::Int, span)
    }

    fn real(&mut self, value: f64, ty: Type, span: Span) -> ExprId {
        // Written so that NaN is refused, too.
        if value.abs() <= f64::from(f32::MAX) {
            return self.push(hir::ExprKind::Number(value), ty, span);
        }
        self.too_large("numbers go from -3.4e38 to 3.4e38", span)
    }

    /// Reports a number that backends cannot hold.
    pub(super) fn too_large(&mut self, help: &str, span: Span) -> ExprId {
        let error = Diagnostic::error("E0224", "the number is too large", span, "too large");
        self.report(error.with_help(help));
        self.wrong(span)
    }

    fn list(&mut self, items: &'a [Expr], span: Span) -> ExprId {
        let ids: Vec<ExprId> = items.iter().map(|item| self.infer(item)).collect();
        let Some(&first) = ids.first() else {
            let error =
                Diagnostic::error("E0220", "the type of an empty list cannot be told", span, "empty list");
            self.report(error.with_help("write at least one element"));
            return self.wrong(span);
        };
        let mut element = self.ty(first).clone();
        for &id in &ids {
            let ty = self.ty(id).clone();
            let Some(joined) = join(&element, &ty) else {
                let message = format!("the elements of a list must have one type, not {element} and {ty}");
                let error = Diagnostic::error("E0219", message, self.span(id), format!("this is {}", a(&ty)));
                let error = error.with_label(self.span(first), format!("this is {}", a(&element)));
                self.report(error.with_help(self.example(&element)));
                return self.wrong(span);
            };
            element = joined;
        }
        if element == Type::Error {
            return self.wrong(span);
        }
        if self.is_too_deep(&element, span) {
            return self.wrong(span);
        }
        let ids = ids.iter().map(|&id| self.convert(id, &element, Role::Internal)).collect();
        self.push(hir::ExprKind::List(ids), Type::list(element), span)
    }

    /// Whether lists of these elements nest too deeply (reported): names can hide how deep they are.
    fn is_too_deep(&mut self, element: &Type, span: Span) -> bool {
        let mut rest = element;
        let mut depth = 1;
        while let Type::List(inner) = rest {
            rest = inner;
            depth += 1;
        }
        if depth > MAX_LIST_DEPTH {
            let error = Diagnostic::error("E0226", "the list is nested too deeply", span, "too deep here");
            self.report(error.with_help("build a list of fewer levels"));
        }
        depth > MAX_LIST_DEPTH
    }

    /// `[for variable in range: body]`; the element's type comes from the body or from outside.
    fn comprehension(
        &mut self,
        variable: &'a Name,
        range: &'a Expr,
        body: &'a Expr,
        element: Option<(&Type, Role<'a>)>,
        span: Span,
    ) -> ExprId {
        let (over, ty) = self.walked(range);
        let mark = self.scope.mark();
        let variable = self.bind(variable, ty, None);
        let body = match element {
            Some((element, role)) => self.expect(body, element, role),
            None => self.infer(body),
        };
        self.scope.leave(mark);
        let element = self.ty(body).clone();
        if element == Type::Error || self.is_too_deep(&element, span) {
            return self.wrong(span);
        }
        self.push(hir::ExprKind::Comprehension { variable, over, body }, Type::list(element), span)
    }

    /// What a comprehension walks, and the type of its elements.
    fn walked(&mut self, range: &'a Expr) -> (Over, Type) {
        if let ExprKind::Range(low, high) = &range.kind {
            let low = self.expect(low, &Type::Int, Role::RangeEnd);
            let high = self.expect(high, &Type::Int, Role::RangeEnd);
            return (Over::Range(low, high), Type::Int);
        }
        let list = self.infer(range);
        match self.ty(list).clone() {
            Type::List(element) => (Over::List(list), *element),
            Type::Error => (Over::List(list), Type::Error),
            ty => {
                let message = format!("`for … in` walks a range or a list, not {}", a(&ty));
                let error = Diagnostic::error("E0231", message, range.span, format!("this is {}", a(&ty)));
                let text = self.source_text(list).unwrap_or_else(|| "12".to_owned());
                self.report(if matches!(ty, Type::Int | Type::Float) {
                    error
                        .with_help(format!("write `0..{text}`"))
                        .with_fix(Fix::insert(range.span.start, "0.."))
                } else {
                    error.with_help("write a range, such as `0..8`, or a list, such as `[1, 2, 3]`")
                });
                (Over::List(list), Type::Error)
            }
        }
    }

    /// `if` whose type comes from its branches.
    fn branch(&mut self, condition: &'a Expr, yes: &'a Expr, no: &'a Expr, span: Span) -> ExprId {
        let condition = self.expect(condition, &Type::Bool, Role::Condition);
        let (yes, no) = (self.infer(yes), self.infer(no));
        let (yes_ty, no_ty) = (self.ty(yes).clone(), self.ty(no).clone());
        let Some(ty) = join(&yes_ty, &no_ty) else {
            let message = format!("both branches of an `if` must have one type, not {yes_ty} and {no_ty}");
            let error = Diagnostic::error("E0219", message, self.span(no), format!("this is {}", a(&no_ty)));
            let error = error.with_label(self.span(yes), format!("this is {}", a(&yes_ty)));
            self.report(error.with_help(self.example(&yes_ty)));
            return self.wrong(span);
        };
        if ty == Type::Error {
            return self.wrong(span);
        }
        let yes = self.convert(yes, &ty, Role::Internal);
        let no = self.convert(no, &ty, Role::Internal);
        self.push(hir::ExprKind::If(condition, yes, no), ty, span)
    }

    /// `{ let …  value }`; the value's type comes from itself or from outside.
    fn block(
        &mut self,
        lets: &'a [Let],
        value: &'a Expr,
        ty: Option<(&Type, Role<'a>)>,
        span: Span,
    ) -> ExprId {
        let mark = self.scope.mark();
        self.report_repeats(lets.iter().map(|binding| &binding.name));
        let mut bindings: Vec<(LocalId, ExprId)> = Vec::with_capacity(lets.len());
        for binding in lets {
            let bound = self.infer(&binding.value);
            let local = self.bind(&binding.name, self.ty(bound).clone(), self.constant(bound));
            bindings.push((local, bound));
        }
        let value = match ty {
            Some((ty, role)) => self.expect(value, ty, role),
            None => self.infer(value),
        };
        self.scope.leave(mark);
        if bindings.is_empty() {
            return value;
        }
        let ty = self.ty(value).clone();
        self.push(hir::ExprKind::Block(bindings, value), ty, span)
    }

    fn stray_range(&mut self, span: Span) -> ExprId {
        let error =
            Diagnostic::error("E0221", "a range is no value", span, "a range outside `[for … in …: …]`");
        self.report(error.with_help("write a list: `[for i in 0..4: i]`"));
        self.wrong(span)
    }

    fn stray_record(&mut self, span: Span) -> ExprId {
        let message = "settings in braces are no value";
        let error = Diagnostic::error("E0222", message, span, "no value");
        self.report(error.with_help("write one value, or `{ let a = 1  a }` for steps"));
        self.wrong(span)
    }
}
