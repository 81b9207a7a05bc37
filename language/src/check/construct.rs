//! Vectors and colours from parts, and the conversions that are written as calls.

use super::Checker;
use super::call::Arg;
use super::convert::Role;
use super::words::a;
use crate::ast::Expr;
use crate::diag::Diagnostic;
use crate::hir::{Conversion, ExprId, ExprKind};
use crate::source::Span;
use crate::ty::Type;

/// The functions that the checker knows by itself.
pub(super) const NAMES: [&str; 5] = ["vec2", "vec3", "vec4", "rgb", "float"];

/// Whether a name is one of [`NAMES`].
pub(super) fn is_constructor(name: &str) -> bool {
    NAMES.contains(&name)
}

/// How a constructor is called.
pub(super) fn form(name: &str) -> Option<&'static str> {
    match name {
        "vec2" => Some("vec2(x, y)"),
        "vec3" => Some("vec3(x, y, z)"),
        "vec4" => Some("vec4(x, y, z, w)"),
        "rgb" => Some("rgb(red, green, blue)"),
        "float" => Some("float(whole)"),
        _ => None,
    }
}

impl<'a> Checker<'a> {
    /// A call of one of [`NAMES`].
    pub(super) fn construct(
        &mut self,
        name: &'a str,
        name_span: Span,
        args: Vec<Arg<'a>>,
        span: Span,
    ) -> ExprId {
        let parts: Vec<ExprId> = args.iter().map(|arg| self.typed(arg)).collect();
        if let Some(named) = args.iter().find_map(|arg| arg.name) {
            let message = format!("`{name}` has no argument `{}`", named.text);
            let error = Diagnostic::error("E0213", message, named.span, "this name is not known here");
            self.report(error.with_help(format!("leave the names out: `{}`", form(name).unwrap_or(name))));
            return self.wrong(span);
        }
        let ty = match name {
            "vec2" => Type::Vec2,
            "vec3" => Type::Vec3,
            "vec4" => Type::Vec4,
            "rgb" => Type::Color,
            _ => Type::Float,
        };
        match parts[..] {
            // A single value is widened, repeated or seen as the other kind of triple.
            [part] if self.is_scalar_number(part) || ty == Type::Float || *self.ty(part) == Type::Error => {
                let role = Role::Argument { name: "x", of: name };
                let value = self.convert(part, &ty, role);
                self.respan(value, span)
            }
            [part] if self.ty(part).components() == ty.components() && self.ty(part).is_vector() => {
                let value = self.convert(part, &ty, Role::Internal);
                self.respan(value, span)
            }
            _ if ty == Type::Float => {
                let count = parts.len();
                self.wrong_count("float", 1, count, name_span, span)
            }
            _ => self.vector(name, parts, ty, name_span, span),
        }
    }

    /// `(x, y)`, `(x, y, z)`, `(x, y, z, w)`
    pub(super) fn tuple(&mut self, parts: &'a [Expr], span: Span) -> ExprId {
        let parts: Vec<ExprId> = parts.iter().map(|part| self.infer(part)).collect();
        let ty = match parts.len() {
            2 => Type::Vec2,
            3 => Type::Vec3,
            4 => Type::Vec4,
            count => {
                let message = format!("a vector has 2 to 4 components, not {count}");
                self.report(Diagnostic::error("E0227", message, span, format!("{count} components")));
                return self.wrong(span);
            }
        };
        if let Some(&part) = parts.iter().find(|&&part| self.ty(part).is_vector()) {
            let found = a(self.ty(part));
            let message = format!("the components of `(…)` must be numbers, found {found}");
            let error = Diagnostic::error("E0205", message, self.span(part), format!("this is {found}"));
            let count: usize = parts.iter().map(|&part| self.ty(part).components().unwrap_or(1)).sum();
            let ty = if count <= 4 { format!("vec{count}") } else { ty.to_string() };
            self.report(error.with_help(format!("write `{ty}(…)`, which takes vectors as parts")));
            return self.wrong(span);
        }
        let name = ty.to_string();
        let form: &'static str = form(&name).unwrap_or("(…)");
        self.vector(form.split('(').next().unwrap_or(form), parts, ty, span, span)
    }

    /// A vector from scalars and shorter vectors whose components add up.
    fn vector(&mut self, name: &'a str, parts: Vec<ExprId>, ty: Type, name_span: Span, span: Span) -> ExprId {
        let wanted = ty.components().unwrap_or(0);
        let mut count = 0;
        let mut wrong = false;
        let mut converted = Vec::with_capacity(parts.len());
        for part in parts {
            let part = if self.ty(part).is_vector() {
                part
            } else {
                self.convert(part, &Type::Float, Role::Component)
            };
            wrong |= self.is_wrong(part);
            count += self.ty(part).components().unwrap_or(1);
            converted.push(part);
        }
        if count != wanted && !wrong {
            return self.wrong_count(name, wanted, count, name_span, span);
        }
        if wrong {
            return self.wrong(span);
        }
        self.push(ExprKind::Vector(converted), ty, span)
    }

    fn wrong_count(
        &mut self,
        name: &str,
        wanted: usize,
        count: usize,
        name_span: Span,
        span: Span,
    ) -> ExprId {
        let message = format!(
            "`{name}` takes {wanted} {}, found {count}",
            if wanted == 1 { "number" } else { "components" }
        );
        let label = format!("{count} {}", if count == 1 { "component" } else { "components" });
        let error = Diagnostic::error("E0227", message, name_span, label);
        self.report(match form(name) {
            Some(form) => error.with_help(format!("write `{form}`")),
            None => error,
        });
        self.wrong(span)
    }

    fn is_scalar_number(&self, id: ExprId) -> bool {
        matches!(self.ty(id), Type::Int | Type::Float)
    }

    /// A conversion stands where its call stands.
    fn respan(&mut self, id: ExprId, span: Span) -> ExprId {
        let expr = &mut self.scene.exprs[id.index()];
        if matches!(expr.kind, ExprKind::Convert(Conversion::Retype | Conversion::Broadcast, _)) {
            expr.span = span;
        }
        id
    }
}
