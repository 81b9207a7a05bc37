//! Params: types that can be set from outside, constant defaults, ranges.

use super::Checker;
use super::convert::Role;
use super::words::a;
use crate::ast::{Expr, Param};
use crate::diag::{Diagnostic, Fix};
use crate::hir::{self, ParamId};
use crate::source::Span;
use crate::ty::Type;

impl<'a> Checker<'a> {
    /// Gives a param its place and type; its default comes later.
    pub(super) fn declare_param(&mut self, param: &'a Param, doc: &str) -> ParamId {
        let mut ty = self.written_type(&param.ty);
        if ty != Type::Error && ty.components().is_none() {
            let message =
                format!("a param must be a number, a vector, a color or a truth value, not {}", a(&ty));
            let error = Diagnostic::error("E0230", message, param.ty.span, "cannot be set from outside");
            let help = format!("write `let {} = …`", param.name.text);
            self.report(error.with_help(help));
            ty = Type::Error;
        }
        let id = ParamId(self.scene.params.len() as u32);
        self.scene.params.push(hir::Param {
            name: format!("{}{}", self.modules[self.module.0 as usize].prefix, param.name.text),
            default: vec![0.0; ty.components().unwrap_or(1)],
            ty,
            range: None,
            doc: doc.to_owned(),
            span: param.name.span,
        });
        id
    }

    /// Checks default and range.
    pub(super) fn check_param(&mut self, param: &'a Param, id: ParamId) {
        let ty = self.scene.params[id.index()].ty.clone();
        let name = param.name.text.as_str();
        let default = self.constant_of(&param.default, &ty, Role::Default(name));
        let range = param.range.as_ref().and_then(|(low, high)| self.range(param, &ty, low, high));
        if let (Some(range), Some(&[value])) = (range, default.as_deref().and_then(|d| d.first_chunk::<1>()))
        {
            self.check_within(param, value, range);
        }
        let place = &mut self.scene.params[id.index()];
        place.range = range;
        if let Some(default) = default {
            place.default = default;
        }
    }

    fn range(&mut self, param: &'a Param, ty: &Type, low: &'a Expr, high: &'a Expr) -> Option<(f64, f64)> {
        let span = low.span.to(high.span);
        if *ty == Type::Bool || ty.is_vector() {
            let message = format!("{} has no range", a(ty));
            let error = Diagnostic::error("E0230", message, span, "a range stands here");
            let fix = Fix::remove(Span { start: param.default.span.end, end: span.end });
            let help = "remove `in` and the range; numbers and angles have one";
            self.report(error.with_help(help).with_fix(fix));
            return None;
        }
        let role = Role::RangeOf(&param.name.text);
        let first = self.constant_of(low, ty, role);
        let last = self.constant_of(high, ty, role);
        let (first, last) = (*first?.first()?, *last?.first()?);
        if first > last {
            let error =
                Diagnostic::error("E0229", "the range is empty", span, "the first end is above the second");
            self.report(error.with_help("write the smaller end first"));
            return None;
        }
        Some((first, last))
    }

    fn check_within(&mut self, param: &'a Param, value: f64, (first, last): (f64, f64)) {
        if (first..=last).contains(&value) {
            return;
        }
        let message = format!("the default of `{}` is outside its range", param.name.text);
        let label = if value < first { "below the range" } else { "above the range" };
        let error = Diagnostic::error("E0229", message, param.default.span, label);
        let error = match &param.range {
            Some((low, high)) => error.with_label(low.span.to(high.span), "this is the range"),
            None => error,
        };
        self.report(error.with_help("change the default, or widen the range"));
    }

    /// The components of a constant expression; reports others.
    fn constant_of(&mut self, expr: &'a Expr, ty: &Type, role: Role<'a>) -> Option<Vec<f64>> {
        let value = self.expect(expr, ty, role);
        if self.is_wrong(value) {
            return None;
        }
        let constant = self.constant(value);
        let count = ty.components()?;
        let numbers = constant.map(|value| value[..count].to_vec());
        match numbers {
            Some(numbers) if numbers.iter().all(|x| x.abs() <= f64::from(f32::MAX)) => Some(numbers),
            Some(_) => {
                self.too_large("numbers go from -3.4e38 to 3.4e38", expr.span);
                None
            }
            None => {
                let message = format!("the value used{role} must be known at compile time");
                let error = Diagnostic::error("E0228", message, expr.span, "not a constant");
                self.report(error.with_help("write numbers and arithmetic of them, such as `2 * pi`"));
                None
            }
        }
    }
}
