//! Operators: which operands they take, and what comes out.

use super::convert::{Role, cost, join};
use super::words::a;
use super::{Checker, MAX_INT};
use crate::ast::{BinaryOp, UnaryOp};
use crate::diag::Diagnostic;
use crate::hir::{ExprId, ExprKind};
use crate::source::Span;
use crate::ty::Type;

/// What an operator makes of its operands.
#[derive(Debug, PartialEq)]
struct Rule {
    left: Type,
    right: Type,
    result: Type,
}

impl Rule {
    fn new(left: Type, right: Type, result: Type) -> Self {
        Self { left, right, result }
    }

    /// Both operands and the result are of one type.
    fn all(ty: Type) -> Self {
        Self::new(ty.clone(), ty.clone(), ty)
    }
}

fn rule(op: BinaryOp, a: &Type, b: &Type) -> Option<Rule> {
    match op {
        BinaryOp::Or | BinaryOp::And => (*a == Type::Bool && *b == Type::Bool).then(|| Rule::all(Type::Bool)),
        BinaryOp::Equal | BinaryOp::NotEqual if *a == Type::Bool && *b == Type::Bool => {
            Some(Rule::all(Type::Bool))
        }
        BinaryOp::Equal
        | BinaryOp::NotEqual
        | BinaryOp::Less
        | BinaryOp::LessEqual
        | BinaryOp::Greater
        | BinaryOp::GreaterEqual => {
            let ty = join(a, b).filter(is_scalar)?;
            Some(Rule::new(ty.clone(), ty, Type::Bool))
        }
        BinaryOp::Union | BinaryOp::Intersection => shapes(a, b),
        BinaryOp::Subtract if *a == Type::Shape => shapes(a, b),
        BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Multiply | BinaryOp::Divide | BinaryOp::Modulo => {
            arithmetic(op, a, b)
        }
    }
}

fn shapes(a: &Type, b: &Type) -> Option<Rule> {
    (*a == Type::Shape && *b == Type::Shape).then(|| Rule::all(Type::Shape))
}

fn arithmetic(op: BinaryOp, a: &Type, b: &Type) -> Option<Rule> {
    let number = |ty: &Type| matches!(ty, Type::Int | Type::Float);
    match (op, a, b) {
        (BinaryOp::Divide, Type::Angle, Type::Angle) => {
            Some(Rule::new(Type::Angle, Type::Angle, Type::Float))
        }
        (BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Modulo, Type::Angle, Type::Angle) => {
            Some(Rule::all(Type::Angle))
        }
        (BinaryOp::Multiply | BinaryOp::Divide, Type::Angle, b) if number(b) => {
            Some(Rule::new(Type::Angle, Type::Float, Type::Angle))
        }
        (BinaryOp::Multiply, a, Type::Angle) if number(a) => {
            Some(Rule::new(Type::Float, Type::Angle, Type::Angle))
        }
        (BinaryOp::Divide, Type::Int, Type::Int) => Some(Rule::all(Type::Float)),
        _ => join(a, b).filter(|ty| number(ty) || ty.is_vector()).map(Rule::all),
    }
}

fn is_arithmetic(op: BinaryOp) -> bool {
    matches!(
        op,
        BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Multiply | BinaryOp::Divide | BinaryOp::Modulo
    )
}

fn is_comparison(op: BinaryOp) -> bool {
    matches!(
        op,
        BinaryOp::Equal
            | BinaryOp::NotEqual
            | BinaryOp::Less
            | BinaryOp::LessEqual
            | BinaryOp::Greater
            | BinaryOp::GreaterEqual
    )
}

fn is_scalar(ty: &Type) -> bool {
    matches!(ty, Type::Int | Type::Float | Type::Angle)
}

/// What an operator takes, for help lines.
fn operands(op: BinaryOp) -> &'static str {
    match op {
        BinaryOp::Or | BinaryOp::And => "both sides must be truth values, such as `a > 0 && b > 0`",
        BinaryOp::Equal | BinaryOp::NotEqual => "both sides must be numbers, angles or truth values",
        BinaryOp::Less | BinaryOp::LessEqual | BinaryOp::Greater | BinaryOp::GreaterEqual => {
            "both sides must be numbers or angles; compare components: `a.x < b.x`"
        }
        BinaryOp::Union | BinaryOp::Intersection => "both sides must be shapes",
        BinaryOp::Add | BinaryOp::Subtract | BinaryOp::Multiply | BinaryOp::Divide | BinaryOp::Modulo => {
            "both sides must be numbers, or vectors of one length; take components of the longer: `a.xy`"
        }
    }
}

impl<'a> Checker<'a> {
    /// An infix operator on typed operands.
    pub(super) fn binary(&mut self, op: BinaryOp, left: ExprId, right: ExprId, span: Span) -> ExprId {
        if matches!(op, BinaryOp::Divide | BinaryOp::Modulo) {
            self.refuse_zero(op, right);
        }
        if self.is_wrong(left) || self.is_wrong(right) {
            return self.wrong(span);
        }
        let Some(rule) = rule(op, self.ty(left), self.ty(right)) else {
            let error = self.operator_error(op, left, right);
            self.report(error);
            return self.wrong(span);
        };
        let left = self.convert(left, &rule.left, Role::Internal);
        let right = self.convert(right, &rule.right, Role::Internal);
        let is_int = rule.result == Type::Int;
        let id = self.push(ExprKind::Binary(op, left, right), rule.result, span);
        match self.constant(id) {
            Some([value, ..]) if is_int && value.abs() > MAX_INT as f64 => self
                .too_large("whole numbers go from -16777216 to 16777216; write `.0` for real numbers", span),
            Some(_) | None => id,
        }
    }

    /// Reports a divisor of which a component is constant zero.
    fn refuse_zero(&mut self, op: BinaryOp, divisor: ExprId) {
        let (Some(value), Some(count)) = (self.constant(divisor), self.ty(divisor).components()) else {
            return;
        };
        if *self.ty(divisor) == Type::Bool || !value[..count].contains(&0.0) {
            return;
        }
        let what = if op == BinaryOp::Divide { "a division" } else { "a remainder of a division" };
        let label = if count == 1 { "this is 0" } else { "a component of this is 0" };
        let error = Diagnostic::error("E0225", format!("{what} by zero"), self.span(divisor), label);
        self.report(error.with_help("write a divisor that is not 0"));
    }

    fn operator_error(&self, op: BinaryOp, left: ExprId, right: ExprId) -> Diagnostic {
        let (a_ty, b_ty) = (self.ty(left), self.ty(right));
        let number = |ty: &Type| matches!(ty, Type::Int | Type::Float);
        let mixes = op != BinaryOp::Divide && (is_arithmetic(op) || is_comparison(op));
        if mixes && *a_ty == Type::Angle && number(b_ty) {
            return self.bare_number(right, Role::Internal).with_label(self.span(left), "this is an angle");
        }
        if mixes && *b_ty == Type::Angle && number(a_ty) {
            return self.bare_number(left, Role::Internal).with_label(self.span(right), "this is an angle");
        }
        let message = format!("`{}` does not take {} and {}", op.symbol(), a(a_ty), a(b_ty));
        let error = Diagnostic::error("E0208", message, self.span(left), format!("this is {}", a(a_ty)));
        let error = error.with_label(self.span(right), format!("this is {}", a(b_ty)));
        error.with_help(self.operator_help(op, left, right).unwrap_or_else(|| operands(op).to_owned()))
    }

    fn operator_help(&self, op: BinaryOp, left: ExprId, right: ExprId) -> Option<String> {
        let (a_ty, b_ty) = (self.ty(left), self.ty(right));
        let both = |ty: Type| *a_ty == ty && *b_ty == ty;
        let instead = |symbol: &str| Some(format!("write `a {symbol} b`"));
        if both(Type::Shape) {
            return match op {
                BinaryOp::Or | BinaryOp::Add => instead("|"),
                BinaryOp::And | BinaryOp::Multiply => instead("&"),
                _ => None,
            };
        }
        if both(Type::Bool) {
            return match op {
                BinaryOp::Union | BinaryOp::Add => instead("||"),
                BinaryOp::Intersection | BinaryOp::Multiply => instead("&&"),
                _ => None,
            };
        }
        let counts = |ty: &Type| matches!(ty, Type::Int | Type::Float | Type::Angle) || ty.is_vector();
        if *b_ty == Type::Angle && counts(a_ty) {
            return Some(self.unit_help(right));
        }
        if *a_ty == Type::Angle && counts(b_ty) {
            return Some(self.unit_help(left));
        }
        if is_comparison(op) && (*a_ty == Type::Bool || *b_ty == Type::Bool) {
            return Some("compare twice: `a < b && b < c`".to_owned());
        }
        match (a_ty, b_ty) {
            (Type::Shape, b) | (b, Type::Shape) if is_arithmetic(op) && cost(b, &Type::Vec3).is_some() => {
                Some("move, turn or scale a shape by calling a function on it: `shape.f(…)`".to_owned())
            }
            (Type::Local, _) => self.source_text(left).map(|q| format!("write `{q}.local`, or `{q}.world`")),
            (_, Type::Local) => self.source_text(right).map(|q| format!("write `{q}.local`, or `{q}.world`")),
            _ => None,
        }
    }

    /// A prefix operator on a typed operand.
    pub(super) fn unary(&mut self, op: UnaryOp, inner: ExprId, span: Span) -> ExprId {
        let ty = self.ty(inner).clone();
        let fits = match op {
            UnaryOp::Negate => is_scalar(&ty) || ty.is_vector(),
            UnaryOp::Not => ty == Type::Bool,
        };
        if fits {
            return self.push(ExprKind::Unary(op, inner), ty, span);
        }
        if ty != Type::Error {
            let symbol = match op {
                UnaryOp::Negate => "-",
                UnaryOp::Not => "!",
            };
            let message = format!("`{symbol}` does not take {}", a(&ty));
            let error = Diagnostic::error("E0208", message, self.span(inner), format!("this is {}", a(&ty)));
            self.report(match (op, ty) {
                (UnaryOp::Not, Type::Int | Type::Float) => {
                    let text = self.source_text(inner).unwrap_or_else(|| "(…)".to_owned());
                    error.with_help(format!("compare it: `{text} == 0`"))
                }
                (UnaryOp::Negate, Type::Bool) => error.with_help("write `!`"),
                (UnaryOp::Not, _) => error.with_help("`!` takes a truth value, such as `!true`"),
                (UnaryOp::Negate, _) => error.with_help("`-` takes a number, an angle or a vector"),
            });
        }
        self.wrong(span)
    }
}
