//! Reports of values whose type does not fit their place, with the fix where one is known.

use super::Checker;
use super::convert::Role;
use super::words::a;
use crate::diag::{Diagnostic, Fix};
use crate::hir::{ExprId, ExprKind};
use crate::source::Span;
use crate::ty::Type;

impl<'a> Checker<'a> {
    /// Reports that a value cannot be turned into `to`.
    pub(super) fn report_mismatch(&mut self, id: ExprId, to: &Type, role: Role<'a>) {
        let from = self.ty(id).clone();
        let error = match (&from, to) {
            (Type::Int | Type::Float, Type::Function(function)) if function.result == Type::Angle => {
                self.bare_number(id, role)
            }
            (Type::Int | Type::Float, Type::Angle) => self.bare_number(id, role),
            (Type::Angle, Type::Function(function)) if is_number(&function.result) => {
                self.unwanted_angle(id, &function.result, role)
            }
            (Type::Angle, to) if is_number(to) => self.unwanted_angle(id, to, role),
            _ => {
                let message = format!("expected {}{role}, found {}", wanted(to, &from), a(&from));
                let error =
                    Diagnostic::error("E0205", message, self.span(id), format!("this is {}", a(&from)));
                let error =
                    error.with_help(self.mismatch_help(id, &from, to).unwrap_or_else(|| self.example(to)));
                self.mismatch_fixes(id, &from, to).into_iter().fold(error, Diagnostic::with_fix)
            }
        };
        self.report(error);
    }

    /// A number where an angle is expected.
    pub(super) fn bare_number(&self, id: ExprId, role: Role<'_>) -> Diagnostic {
        let message = format!("expected an angle{role}, found a bare number");
        let error = Diagnostic::error("E0206", message, self.span(id), "this number has no unit");
        error
            .with_help(match self.source_text(id) {
                Some(text) if self.is_literal(id) => format!("write `{text}deg`, or `{text}rad` for radians"),
                Some(text) => format!("write `{text} * 1deg`, or `{text} * 1rad` for radians"),
                None => "multiply by a unit: `(…) * 1deg`, or `(…) * 1rad` for radians".to_owned(),
            })
            .with_fix(match self.is_literal(id) {
                true => Fix::insert(self.span(id).end, "deg"),
                false => self.appended(id, " * 1deg"),
            })
    }

    /// An angle where a number is expected.
    fn unwanted_angle(&self, id: ExprId, to: &Type, role: Role<'_>) -> Diagnostic {
        let message = format!("expected {}{role}, found an angle", a(to));
        let error = Diagnostic::error("E0207", message, self.span(id), "this is an angle");
        let units = [self.appended(id, " / 1rad"), self.appended(id, " / 1deg")];
        units.into_iter().fold(error.with_help(self.unit_help(id)), Diagnostic::with_fix)
    }

    /// Writes something after a value, which gets brackets unless it is a single word.
    fn appended(&self, id: ExprId, suffix: &str) -> Fix {
        let span = self.span(id);
        match self.source_text(id) {
            Some(_) => Fix::insert(span.end, suffix),
            None => self.wrapped(id, "(", &format!("){suffix}")),
        }
    }

    fn wrapped(&self, id: ExprId, before: &str, after: &str) -> Fix {
        let Span { start, end } = self.span(id);
        let edits = [(Span { start, end: start }, before), (Span { start: end, end }, after)];
        Fix::new(format!("write `{before}…{after}`"), edits)
    }

    /// The repairs that [`Self::mismatch_help`] speaks of; several where it offers a choice.
    fn mismatch_fixes(&self, id: ExprId, from: &Type, to: &Type) -> Vec<Fix> {
        match (from, to) {
            (Type::Function(_), _) => vec![],
            (from, Type::Function(function)) => self.mismatch_fixes(id, from, &function.result),
            (Type::Float, Type::Int) => match self.constant(id) {
                Some([value, ..]) if value.fract() == 0.0 && self.is_literal(id) => {
                    vec![Fix::replace(self.span(id), value.to_string())]
                }
                Some(_) | None => vec![],
            },
            (Type::Vec3 | Type::Vec4 | Type::Color, Type::Vec2) => vec![self.appended(id, ".xy")],
            (Type::Vec4, Type::Vec3 | Type::Color) => vec![self.appended(id, ".xyz")],
            (Type::Vec2, Type::Vec3) => vec![self.wrapped(id, "vec3(", ", 0)")],
            (Type::Vec3 | Type::Color, Type::Vec4) => vec![self.wrapped(id, "vec4(", ", 0)")],
            (Type::Local, Type::Vec3) => vec![self.appended(id, ".local"), self.appended(id, ".world")],
            (Type::Int | Type::Float, Type::Bool) if !self.is_literal(id) => {
                vec![self.appended(id, " > 0")]
            }
            (Type::Int | Type::Float, Type::String) if self.is_literal(id) => {
                vec![self.wrapped(id, "\"", "\"")]
            }
            (from, Type::List(element)) if from == &**element => vec![self.wrapped(id, "[", "]")],
            _ => vec![],
        }
    }

    /// How to turn an angle into a number.
    pub(super) fn unit_help(&self, id: ExprId) -> String {
        let text = self.source_text(id).unwrap_or_else(|| "(…)".to_owned());
        format!("write `{text} / 1rad` for radians, or `{text} / 1deg` for degrees")
    }

    fn mismatch_help(&self, id: ExprId, from: &Type, to: &Type) -> Option<String> {
        if let (false, Type::Function(function)) = (matches!(from, Type::Function(_)), to) {
            return self.mismatch_help(id, from, &function.result);
        }
        let text = self.source_text(id).unwrap_or_else(|| "(…)".to_owned());
        match (from, to) {
            (Type::Float, Type::Int) => Some(match self.constant(id) {
                Some([value, ..]) if value.fract() == 0.0 => format!("write `{value}`"),
                Some([value, ..]) => format!("write a whole number, such as `{}`", value.round()),
                None => "write a whole number, without a decimal point".to_owned(),
            }),
            (from, Type::Float | Type::Int) if from.is_vector() => {
                Some(format!("take one component: `{text}.x`"))
            }
            (Type::Vec3 | Type::Vec4 | Type::Color, Type::Vec2) => Some(format!("write `{text}.xy`")),
            (Type::Vec4, Type::Vec3 | Type::Color) => Some(format!("write `{text}.xyz`")),
            (Type::Vec2, Type::Vec3) => Some(format!("write `vec3({text}, 0)`")),
            (Type::Vec3 | Type::Color, Type::Vec4) => Some(format!("write `vec4({text}, 0)`")),
            (Type::Record(record), to) => {
                let fits = record.fields.iter().find(|(_, ty)| super::convert::cost(ty, to).is_some());
                let (name, _) = fits.or(record.fields.first())?;
                Some(format!("name a part of the loop's last state: `{text}.{name}`"))
            }
            (Type::Local, Type::Vec3) => Some(format!("write `{text}.local`, or `{text}.world`")),
            (Type::Int | Type::Float, Type::Bool) if self.is_literal(id) => {
                Some("write `true` or `false`".to_owned())
            }
            (Type::Int | Type::Float, Type::Bool) => Some(format!("compare it: `{text} > 0`")),
            (Type::Int, Type::String) | (Type::Float, Type::String) => Some(format!("write `\"{text}\"`")),
            (from, Type::List(element)) if from == &**element => Some(format!("write `[{text}]`")),
            (Type::Function(_), to) if matches!(self.scene.expr(id).kind, ExprKind::Local(_)) => {
                Some(format!("call it: `{text}(…)` gives {}", a(to)))
            }
            _ => None,
        }
    }
}

/// What a place asks for; where a function is expected a plain value of its result does, too.
fn wanted(to: &Type, from: &Type) -> String {
    match (to, from) {
        (Type::Function(function), from) if !matches!(from, Type::Function(_)) => {
            format!("{} or {}", a(&function.result), a(to))
        }
        _ => a(to),
    }
}

fn is_number(ty: &Type) -> bool {
    matches!(ty, Type::Int | Type::Float) || ty.is_vector()
}
