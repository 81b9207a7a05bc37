//! Conversions between types: which there are, what they cost, and writing them out.

use super::Checker;
use crate::hir::{Conversion, ExprId, ExprKind, Over};
use crate::ty::{FunctionType, Type};
use std::fmt;

/// What a value is wanted for; part of messages.
#[derive(Clone, Copy, Debug)]
pub(super) enum Role<'a> {
    /// An argument of a call.
    Argument {
        /// Name of the parameter.
        name: &'a str,
        /// Name of the function.
        of: &'a str,
    },
    /// The value of a block's key.
    Key(&'a str),
    /// The body of this function.
    Result(&'a str),
    /// The default of this param or parameter.
    Default(&'a str),
    /// An end of the range of this param.
    RangeOf(&'a str),
    /// An end of a range that is walked.
    RangeEnd,
    /// The condition of an `if` or a loop.
    Condition,
    /// The most steps of a loop.
    Steps,
    /// The next value of this part of a loop's state.
    State(&'a str),
    /// What runs along keys, or the place of a key.
    Place,
    /// The value of a key.
    KeyValue,
    /// A component of a vector.
    Component,
    /// An argument of a function value.
    Call,
    /// The checker converts by itself, after asking for the cost.
    Internal,
}

impl fmt::Display for Role<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Argument { name, of } => write!(f, " for `{name}` of `{of}`"),
            Self::Key(name) => write!(f, " for `{name}`"),
            Self::Result(name) => write!(f, " as the result of `{name}`"),
            Self::Default(name) => write!(f, " as the default of `{name}`"),
            Self::RangeOf(name) => write!(f, " in the range of `{name}`"),
            Self::RangeEnd => write!(f, " as an end of the range"),
            Self::Condition => write!(f, " as the condition"),
            Self::Steps => write!(f, " as the number of steps"),
            Self::State(name) => write!(f, " as the next value of `{name}`"),
            Self::Place => write!(f, " as the place of a key"),
            Self::KeyValue => write!(f, " as the value of a key"),
            Self::Component => write!(f, " as a component"),
            Self::Call => write!(f, " as an argument"),
            Self::Internal => Ok(()),
        }
    }
}

const WIDEN: u32 = 1;
const RECOLOR: u32 = 1;
const BROADCAST: u32 = 2;
const CONSTANT: u32 = 3;

/// What turning a value of one type into another costs; `None` if that is impossible.
///
/// A wrong value fits everywhere, so that it is not reported twice.
pub(super) fn cost(from: &Type, to: &Type) -> Option<u32> {
    if from == to || *from == Type::Error || *to == Type::Error {
        return Some(0);
    }
    match (from, to) {
        (Type::Int, Type::Float) | (Type::String, Type::Image) => Some(WIDEN),
        (Type::Vec3, Type::Color) | (Type::Color, Type::Vec3) => Some(RECOLOR),
        (Type::Float, to) if to.is_vector() => Some(BROADCAST),
        (Type::Int, to) if to.is_vector() => Some(WIDEN + BROADCAST),
        (Type::List(from), Type::List(to)) => cost(from, to),
        (Type::Function(from), Type::Function(to)) => function_cost(from, to),
        (from, Type::Function(to)) => Some(CONSTANT + cost(from, &to.result)?),
        _ => None,
    }
}

/// The cost of using one function where another is wanted: it may have fewer parameters.
fn function_cost(from: &FunctionType, to: &FunctionType) -> Option<u32> {
    if from.params.len() > to.params.len() {
        return None;
    }
    let mut total = cost(&from.result, &to.result)?;
    for (wanted, given) in from.params.iter().zip(&to.params) {
        total += pass_cost(given, wanted)?;
    }
    Some(total)
}

/// The cost of passing a function's parameter on: the local point serves as its own coordinates.
fn pass_cost(given: &Type, wanted: &Type) -> Option<u32> {
    if (given, wanted) == (&Type::Local, &Type::Vec3) { Some(WIDEN) } else { cost(given, wanted) }
}

/// The type that values of both types turn into: the more general of the two.
pub(super) fn join(a: &Type, b: &Type) -> Option<Type> {
    match (a, b) {
        (Type::Error, _) | (_, Type::Error) => Some(Type::Error),
        (Type::Vec3 | Type::Color, Type::Color) | (Type::Color, Type::Vec3) => Some(Type::Color),
        (Type::List(a), Type::List(b)) => join(a, b).map(Type::list),
        (Type::Function(_), _) | (_, Type::Function(_)) => (a == b).then(|| a.clone()),
        _ if cost(a, b).is_some() => Some(b.clone()),
        _ => cost(b, a).map(|_| a.clone()),
    }
}

impl<'a> Checker<'a> {
    /// The value as `to`; reports it if that is impossible.
    pub(super) fn convert(&mut self, id: ExprId, to: &Type, role: Role<'a>) -> ExprId {
        let from = self.ty(id).clone();
        if from == *to {
            return id;
        }
        let span = self.span(id);
        if from == Type::Error || *to == Type::Error {
            return self.wrong(span);
        }
        if cost(&from, to).is_none() {
            self.report_mismatch(id, to, role);
            return self.wrong(span);
        }
        self.write_conversion(id, &from, to)
    }

    /// Writes a conversion out that [`cost`] allows.
    fn write_conversion(&mut self, id: ExprId, from: &Type, to: &Type) -> ExprId {
        let span = self.span(id);
        match (from, to) {
            (Type::Int, to) if to.is_vector() => {
                let number = self.retype(id, &Type::Float);
                self.push(ExprKind::Convert(Conversion::Broadcast, number), to.clone(), span)
            }
            (Type::Float, to) if to.is_vector() => {
                self.push(ExprKind::Convert(Conversion::Broadcast, id), to.clone(), span)
            }
            (Type::List(_), Type::List(element)) => self.convert_list(id, element),
            (Type::Function(from), Type::Function(to)) => self.adapt_value(id, from, to, span),
            (_, Type::Function(function)) => {
                let value = self.convert(id, &function.result, Role::Internal);
                self.push(ExprKind::Convert(Conversion::Constant, value), to.clone(), span)
            }
            _ => self.retype(id, to),
        }
    }

    /// The same number, seen as another type.
    pub(super) fn retype(&mut self, id: ExprId, to: &Type) -> ExprId {
        let span = self.span(id);
        self.push(ExprKind::Convert(Conversion::Retype, id), to.clone(), span)
    }

    /// Converts a list element by element: in place where the elements are written out, else by
    /// walking the list.
    fn convert_list(&mut self, id: ExprId, element: &Type) -> ExprId {
        let span = self.span(id);
        let kind = match self.scene.expr(id).kind.clone() {
            ExprKind::List(items) => {
                let items = items.iter().map(|&item| self.convert(item, element, Role::Internal));
                ExprKind::List(items.collect())
            }
            ExprKind::Comprehension { variable, over, body } => {
                let body = self.convert(body, element, Role::Internal);
                ExprKind::Comprehension { variable, over, body }
            }
            _ => {
                let from = match self.ty(id) {
                    Type::List(from) => (**from).clone(),
                    _ => Type::Error,
                };
                let variable = self.scope.fresh(from.clone());
                let item = self.push(ExprKind::Local(variable), from, span);
                let body = self.convert(item, element, Role::Internal);
                ExprKind::Comprehension { variable, over: Over::List(id), body }
            }
        };
        self.push(kind, Type::list(element.clone()), span)
    }

    /// A value that a function parameter passes on; see [`pass_cost`].
    pub(super) fn pass(&mut self, id: ExprId, wanted: &Type) -> ExprId {
        if (self.ty(id), wanted) == (&Type::Local, &Type::Vec3) {
            let span = self.span(id);
            return self.push(ExprKind::LocalField(id, crate::hir::LocalField::Local), Type::Vec3, span);
        }
        self.convert(id, wanted, Role::Internal)
    }
}

/// `#rrggbb` as scene-linear light (IEC 61966-2-1, exact piecewise form).
pub(super) fn linear_from_srgb(encoded: [u8; 3]) -> [f64; 3] {
    encoded.map(|byte| {
        let value = f64::from(byte) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    })
}
