//! Fields: components of vectors and colours, and the fields of the local point.

use super::Checker;
use super::words::a;
use crate::ast::Name;
use crate::diag::{Diagnostic, Fix};
use crate::hir::{ExprId, ExprKind, LocalField};
use crate::source::Span;
use crate::ty::Type;

impl<'a> Checker<'a> {
    /// `of.name`
    pub(super) fn field(&mut self, of: ExprId, name: &'a Name, span: Span) -> ExprId {
        let ty = self.ty(of).clone();
        if ty == Type::Error {
            return self.wrong(span);
        }
        if ty == Type::Local {
            let found = LocalField::ALL.into_iter().find(|(_, known, _)| *known == name.text);
            if let Some((field, _, ty)) = found {
                return self.push(ExprKind::LocalField(of, field), ty, span);
            }
        }
        if let Type::Record(record) = &ty
            && let Some(index) = record.fields.iter().position(|(known, _)| *known == name.text)
        {
            let field = record.fields[index].1.clone();
            return self.push(ExprKind::RecordField(of, index as u32), field, span);
        }
        if let Some(indices) = components(&ty, &name.text) {
            let ty = picked(&ty, indices.len());
            return self.push(ExprKind::Swizzle(of, indices), ty, span);
        }
        self.report_field(&ty, name);
        self.wrong(span)
    }

    fn report_field(&mut self, ty: &Type, name: &Name) {
        let text = name.text.as_str();
        let message = format!("{} has no field `{text}`", a(ty));
        let error = Diagnostic::error("E0209", message, name.span, "no such field");
        let error = if self.builtins.contains_key(text) {
            error.with_help(format!("call it: `.{text}(…)`"))
        } else if *ty == Type::Local && components(&Type::Vec3, text).is_some() {
            let through = |field| Fix::insert(name.span.start, field);
            let help = format!("write `.local.{text}`, or `.world.{text}`");
            error.with_help(help).with_fix(through("local.")).with_fix(through("world."))
        } else if *ty == Type::Local {
            let fields: Vec<&str> = LocalField::ALL.iter().map(|(_, known, _)| *known).collect();
            match self.suggest(text, |_| fields.clone()) {
                Some(near) => error.did_you_mean(&near, name.span),
                None => error.with_help(format!("it has `.{}`", fields.join("`, `."))),
            }
        } else if let Type::Record(record) = ty {
            let fields: Vec<&str> = record.fields.iter().map(|(known, _)| known.as_str()).collect();
            match self.suggest(text, |_| fields.clone()) {
                Some(near) => error.did_you_mean(&near, name.span),
                None => error.with_help(format!("it has `.{}`", fields.join("`, `."))),
            }
        } else if let Some(letters) = letters(ty) {
            let letters: Vec<String> = letters.chars().map(|letter| format!("`.{letter}`")).collect();
            let help = format!("it has {}, and up to four of these letters together", letters.join(", "));
            error.with_help(help)
        } else {
            let message = format!("{} has no fields", a(ty));
            let error = Diagnostic::error("E0209", message, name.span, "no such field");
            self.report(error.with_help(format!("remove `.{text}`")));
            return;
        };
        self.report(error);
    }
}

/// The letters of a vector's components.
fn letters(ty: &Type) -> Option<&'static str> {
    match ty {
        Type::Vec2 => Some("xy"),
        Type::Vec3 => Some("xyz"),
        Type::Vec4 => Some("xyzw"),
        Type::Color => Some("rgb"),
        Type::Bool
        | Type::Int
        | Type::Float
        | Type::Angle
        | Type::String
        | Type::List(_)
        | Type::Function(_)
        | Type::Shape
        | Type::Curve
        | Type::Material
        | Type::Phase
        | Type::Local
        | Type::Record(_)
        | Type::Image
        | Type::Block(_)
        | Type::Choice(_)
        | Type::Settings(_)
        | Type::Error => None,
    }
}

/// The components that a field names; colours take `xyz`, too, but not mixed with `rgb`.
fn components(ty: &Type, field: &str) -> Option<Vec<u8>> {
    if !(1..=4).contains(&field.len()) {
        return None;
    }
    let own = indices(letters(ty)?, field);
    if *ty == Type::Color { own.or_else(|| indices("xyz", field)) } else { own }
}

fn indices(letters: &str, field: &str) -> Option<Vec<u8>> {
    field.chars().map(|letter| letters.find(letter).map(|index| index as u8)).collect()
}

/// The type of so many components of a vector or colour.
fn picked(of: &Type, count: usize) -> Type {
    match count {
        1 => Type::Float,
        2 => Type::Vec2,
        3 if *of == Type::Color => Type::Color,
        3 => Type::Vec3,
        _ => Type::Vec4,
    }
}
