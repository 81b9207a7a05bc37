//! How messages name types, functions and simple expressions.

use super::Checker;
use super::item::Head;
use crate::ast::UnaryOp;
use crate::hir::{ExprId, ExprKind};
use crate::library::{DefaultValue, Parameter, Signature};
use crate::ty::Type;
use std::f64::consts::{PI, TAU};

/// A type with its article: `an angle`, `a vec3`, `a list [shape]`.
pub(super) fn a(ty: &Type) -> String {
    match ty {
        Type::Int | Type::Angle => format!("an {ty}"),
        Type::List(_) => format!("a list {ty}"),
        Type::Function(_) => format!("a function {ty}"),
        Type::Local => "a local point".to_owned(),
        Type::Phase => "a phase function".to_owned(),
        Type::Record(_) => format!("a record {ty}"),
        Type::Image => "an image".to_owned(),
        Type::Block(kind) => format!("the name of {}", article(kind.keyword())),
        Type::Choice(kind) => article(kind.name()),
        Type::Settings(kind) => kind.name().to_owned(),
        Type::Bool
        | Type::Float
        | Type::Vec2
        | Type::Vec3
        | Type::Vec4
        | Type::Color
        | Type::String
        | Type::Shape
        | Type::Curve
        | Type::Material => format!("a {ty}"),
        Type::Error => "a value of unknown type".to_owned(),
    }
}

/// A noun with its article.
pub(super) fn article(noun: &str) -> String {
    let article = if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" };
    format!("{article} {noun}")
}

/// A library function as a call form: `fbm(p: vec3, octaves: int = 4) -> float`.
pub(super) fn signature(signature: &Signature) -> String {
    let params: Vec<String> = signature.params.iter().map(parameter).collect();
    format!("{}({}) -> {}", signature.name, params.join(", "), signature.result)
}

fn parameter(parameter: &Parameter) -> String {
    let Parameter { name, ty, default, rest } = parameter;
    if *rest {
        return format!("{name}: {ty}, …");
    }
    match default {
        DefaultValue::Required => format!("{name}: {ty}"),
        DefaultValue::Number(value) if *result_of(ty) == Type::Angle => format!("{name}: {ty} = {value}rad"),
        DefaultValue::Number(value) => format!("{name}: {ty} = {value}"),
        DefaultValue::Bool(value) => format!("{name}: {ty} = {value}"),
        DefaultValue::Word(word) => format!("{name}: {ty} = {word}"),
    }
}

/// A function of so many parameters as it could be written.
fn lambda(params: &[Type]) -> &'static str {
    match params {
        [] => "() => …",
        [Type::Local] => "q => …",
        [_] => "x => …",
        _ => "(x, y) => …",
    }
}

/// Whether only functions make values of this type.
fn is_made(ty: &Type) -> bool {
    matches!(
        ty,
        Type::Shape
            | Type::Curve
            | Type::Material
            | Type::Phase
            | Type::Local
            | Type::Record(_)
            | Type::Image
            | Type::Block(_)
            | Type::Choice(_)
            | Type::Settings(_)
            | Type::Error
    )
}

/// What a function gives; other types are themselves.
fn result_of(ty: &Type) -> &Type {
    if let Type::Function(function) = ty { &function.result } else { ty }
}

/// A user's function as a call form; `…` stands for a default.
pub(super) fn head(head: &Head<'_>) -> String {
    let params = head.params.iter().map(|param| match param.default {
        Some(_) => format!("{}: {} = …", param.name, param.ty),
        None => format!("{}: {}", param.name, param.ty),
    });
    format!("{}({}) -> {}", head.name, params.collect::<Vec<_>>().join(", "), head.result)
}

impl Checker<'_> {
    /// What could be written where a type is expected.
    pub(super) fn example(&self, ty: &Type) -> String {
        match (self.sample(ty), ty) {
            // Where a function is expected a plain value of its result does, too.
            (Some(sample), Type::Function(function)) => {
                format!(
                    "write {}, such as `{sample}`, or a function: `{}`",
                    a(&function.result),
                    lambda(&function.params)
                )
            }
            (Some(sample), _) => format!("write {}, such as `{sample}`", a(ty)),
            (None, _) => format!("write {} here", a(ty)),
        }
    }

    /// A value of a type as it could be written.
    pub(super) fn sample(&self, ty: &Type) -> Option<String> {
        let sample = match ty {
            Type::Bool => "true",
            Type::Int => "3",
            Type::Float => "1.5",
            Type::Angle => "45deg",
            Type::Vec2 => "(1, 2)",
            Type::Vec3 => "(1, 2, 3)",
            Type::Vec4 => "(1, 2, 3, 4)",
            Type::Color => "#ff8800",
            Type::String => "\"text\"",
            Type::List(_) => "[…]",
            Type::Function(function) => return self.sample(&function.result),
            Type::Shape | Type::Curve | Type::Material | Type::Phase => {
                // The first function whose arguments can be written without another function.
                let simple = |param: &Parameter| !is_made(result_of(&param.ty)) && !param.rest;
                let known = self
                    .library
                    .signatures
                    .iter()
                    .find(|signature| signature.result == *ty && signature.params.iter().all(simple))?;
                let required = known.params.iter().filter(|param| param.default == DefaultValue::Required);
                let args: Option<Vec<String>> = required.map(|param| self.sample(&param.ty)).collect();
                return Some(format!("{}({})", known.name, args?.join(", ")));
            }
            Type::Choice(kind) => {
                let words = kind.words();
                let bare: Vec<&str> =
                    words.iter().filter(|word| word.params.is_empty()).map(|word| word.name).collect();
                return Some(match bare[..] {
                    [] => format!("{}(…)", words.first()?.name),
                    [first, ..] => first.to_owned(),
                });
            }
            Type::Settings(_) => "{ … }",
            Type::Image => "\"picture.png\"",
            Type::Local | Type::Record(_) | Type::Block(_) | Type::Error => return None,
        };
        Some(sample.to_owned())
    }

    /// The source text of a name or number; `None` for longer expressions.
    pub(super) fn source_text(&self, id: ExprId) -> Option<String> {
        match &self.scene.expr(id).kind {
            ExprKind::Number(value) => Some(self.number_text(id, *value)),
            ExprKind::Unary(UnaryOp::Negate, inner) => {
                self.source_text(*inner).filter(|text| !text.starts_with('-')).map(|text| format!("-{text}"))
            }
            ExprKind::Local(local) => {
                Some(self.scope.local(*local).name).filter(|name| !name.is_empty()).map(str::to_owned)
            }
            ExprKind::Let(id) => Some(self.scene.lets[id.index()].name.clone()),
            ExprKind::Param(id) => Some(self.scene.params[id.index()].name.clone()),
            ExprKind::Time => Some("time".to_owned()),
            ExprKind::Frame => Some("frame".to_owned()),
            ExprKind::Bool(_)
            | ExprKind::Color(_)
            | ExprKind::String(_)
            | ExprKind::Vector(_)
            | ExprKind::Swizzle(..)
            | ExprKind::LocalField(..)
            | ExprKind::Unary(UnaryOp::Not, _)
            | ExprKind::Binary(..)
            | ExprKind::If(..)
            | ExprKind::Block(..)
            | ExprKind::Lambda(..)
            | ExprKind::CallFunction(..)
            | ExprKind::CallBuiltin(..)
            | ExprKind::CallValue(..)
            | ExprKind::List(_)
            | ExprKind::Comprehension { .. }
            | ExprKind::Iterate(_)
            | ExprKind::RecordField(..)
            | ExprKind::Keys(_)
            | ExprKind::Choice(..)
            | ExprKind::BlockName(_)
            | ExprKind::Settings(_)
            | ExprKind::Convert(..)
            | ExprKind::Error => None,
        }
    }

    /// Whether an expression is a number as written, perhaps with a minus.
    pub(super) fn is_literal(&self, id: ExprId) -> bool {
        let negated = if let ExprKind::Unary(UnaryOp::Negate, inner) = self.scene.expr(id).kind {
            Some(inner)
        } else {
            None
        };
        let inner = negated.unwrap_or(id);
        let ExprKind::Number(value) = self.scene.expr(inner).kind else { return false };
        self.number_text(inner, value).ends_with(|c: char| c.is_ascii_digit())
    }

    fn number_text(&self, id: ExprId, value: f64) -> String {
        if *self.ty(id) == Type::Angle {
            return "(…)".to_owned();
        }
        if value == PI {
            return "pi".to_owned();
        }
        if value == TAU {
            return "tau".to_owned();
        }
        value.to_string()
    }
}
