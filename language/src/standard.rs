//! The standard library: what can be said in the language itself.
//!
//! `standard/library.vol` holds functions only, each after those it uses. Scenes see them like built-in
//! functions; several functions of one name are its forms, chosen by the types of the arguments. Only
//! the functions that a scene uses are checked and compiled with it.

use crate::ast::{self, Expr, ExprKind, Function, ItemKind, TypeExpr, TypeExprKind};
use crate::library::{DefaultValue, Library, Parameter, Signature};
use crate::parse;
use crate::source::SourceFile;
use crate::ty::Type;
use std::sync::LazyLock;

/// Offset of the library's first byte among the spans of a scene; scenes never reach so far.
pub const START: u32 = 0xF000_0000;

static FILE: LazyLock<SourceFile> =
    LazyLock::new(|| SourceFile::new("standard library", include_str!("standard/library.vol")));

static TREE: LazyLock<ast::File> = LazyLock::new(|| {
    let (mut tree, diagnostics) = parse::parse(&FILE);
    debug_assert!(diagnostics.is_empty(), "{diagnostics:?}");
    ast::spans::shift(&mut tree, START);
    tree
});

static SIGNATURES: LazyLock<Vec<Signature>> =
    LazyLock::new(|| functions().map(|(function, doc)| signature(function, doc)).collect());

/// The library's text.
#[must_use]
pub fn file() -> &'static SourceFile {
    &FILE
}

/// Its functions in order with their doc comments; a function only uses earlier ones.
pub(crate) fn functions() -> impl Iterator<Item = (&'static Function, &'static str)> {
    TREE.items.iter().filter_map(|item| match &item.kind {
        ItemKind::Function(function) => Some((function, item.doc.as_str())),
        ItemKind::Import(_) | ItemKind::Param(_) | ItemKind::Let(_) | ItemKind::Block(_) => None,
    })
}

/// The signatures of its functions, in order.
#[must_use]
pub fn signatures() -> &'static [Signature] {
    &SIGNATURES
}

/// A compiler's functions, then those of the standard library.
#[must_use]
pub fn extended(library: &Library) -> Library {
    Library { signatures: library.signatures.iter().chain(signatures()).cloned().collect() }
}

fn signature(function: &'static Function, doc: &'static str) -> Signature {
    let params = function.params.iter().map(|param| Parameter {
        name: &param.name.text,
        ty: ty(&param.ty),
        default: param.default.as_ref().map_or(DefaultValue::Required, default),
        rest: false,
    });
    Signature { name: &function.name.text, params: params.collect(), result: ty(&function.result), doc }
}

/// The type that is written; a test sees to it that the library names only types that there are.
fn ty(written: &TypeExpr) -> Type {
    match &written.kind {
        TypeExprKind::Named(name) => Type::named(name).unwrap_or(Type::Error),
        TypeExprKind::List(element) => Type::list(ty(element)),
        TypeExprKind::Function(params, result) => Type::function(params.iter().map(ty).collect(), ty(result)),
    }
}

/// Defaults of the library's parameters are literals.
fn default(value: &Expr) -> DefaultValue {
    match value.kind {
        ExprKind::Int(number) => DefaultValue::Number(number as f64),
        ExprKind::Float(number) | ExprKind::Angle(number) => DefaultValue::Number(number),
        ExprKind::Bool(truth) => DefaultValue::Bool(truth),
        _ => DefaultValue::Required,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_library_is_well_formed() {
        let (tree, diagnostics) = parse::parse(file());
        assert_eq!(diagnostics, []);
        assert_eq!(tree.items.len(), functions().count(), "functions only");
        for (function, doc) in functions() {
            assert!(!doc.is_empty(), "{} has no doc comment", function.name.text);
        }
        for signature in signatures() {
            let mut types = signature.params.iter().map(|param| &param.ty).chain([&signature.result]);
            assert!(types.all(|ty| *ty != Type::Error), "{} has an unknown type", signature.name);
        }
        let given = functions().flat_map(|(function, _)| &function.params).filter(|p| p.default.is_some());
        let kept =
            signatures().iter().flat_map(|s| &s.params).filter(|p| p.default != DefaultValue::Required);
        assert_eq!(given.count(), kept.count(), "defaults are literals");
    }
}
