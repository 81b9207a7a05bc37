//! Deep, long and odd trees: no panic, no overflow, no hang. Trees that the parser refuses are
//! built by hand.

use super::support::{checked, library};
use crate::ast::{
    BinaryOp, Expr, ExprKind, File, Item, ItemKind, Let, Name, TypeExpr, TypeExprKind, UnaryOp,
};
use crate::check::{CODES, check};
use crate::diag::Diagnostic;
use crate::module::Module;
use crate::source::Span;
use std::collections::HashSet;
use std::fmt::Write;

fn expr(kind: ExprKind) -> Expr {
    Expr { kind, span: Span::default() }
}

fn name(text: &str) -> Name {
    Name { text: text.to_owned(), span: Span::default() }
}

fn file(value: Expr) -> File {
    let kind = ItemKind::Let(Let { name: name("a"), value });
    File { items: vec![Item { kind, span: Span::default(), doc: String::new() }] }
}

/// Codes of the errors of `let a = value`, of a scene that has nothing to draw.
fn codes(value: Expr) -> Vec<&'static str> {
    let (_, diagnostics) = check(&[Module::root(file(value), "test.vol")], &library());
    diagnostics.iter().filter(|d| d.is_error() && d.code != "E0313").map(|d| d.code).collect()
}

#[test]
fn long_chains_are_fine() {
    let mut chain = expr(ExprKind::Int(1));
    for i in 0..5000 {
        chain = match i % 3 {
            0 => {
                expr(ExprKind::Binary(BinaryOp::Multiply, Box::new(chain), Box::new(expr(ExprKind::Int(1)))))
            }
            1 => expr(ExprKind::MethodCall(Box::new(chain), name("box"), vec![])),
            _ => expr(ExprKind::Field(Box::new(chain), name("x"))),
        };
    }
    assert_eq!(codes(chain)[0], "E0209");
}

#[test]
fn long_sum_is_typed() {
    let source = format!("let a = 1{}\nobject o {{ shape: sphere(a) }}", " + 1".repeat(200));
    let (_, diagnostics) = checked(&source);
    assert_eq!(diagnostics, []);
}

#[test]
fn deep_nesting_is_an_error() {
    let mut deep = expr(ExprKind::Int(1));
    for _ in 0..3000 {
        deep = expr(ExprKind::Unary(UnaryOp::Negate, Box::new(deep)));
    }
    assert_eq!(codes(deep), ["E0226"]);
}

#[test]
fn deepest_trees_of_the_parser_fit_the_stack() {
    let depth = crate::parse::MAX_NESTING - 2;
    for (open, close) in [("max(1, ", ")"), ("[", "].union()"), ("(1 + ", ")"), ("{ let b = ", "  b }")] {
        let source = format!("let a = {}1{}", open.repeat(depth), close.repeat(depth));
        let (file, _) = crate::parse::parse(&crate::source::SourceFile::new("deep.vol", source));
        let (_, diagnostics) = check(&[Module::root(file, "test.vol")], &library());
        assert!(diagnostics.iter().all(|d| d.code != "E0226"), "{open}");
    }
}

#[test]
fn every_kind_of_deep_tree_is_survived() {
    let wrap: [fn(Expr) -> ExprKind; 7] = [
        |e| ExprKind::List(vec![e]),
        |e| ExprKind::If(Box::new(expr(ExprKind::Bool(true))), Box::new(expr(ExprKind::Int(1))), Box::new(e)),
        |e| ExprKind::Block(vec![], Box::new(e)),
        |e| ExprKind::Lambda(vec![], Box::new(e)),
        |e| {
            let argument = crate::ast::Argument { name: None, value: e };
            ExprKind::Call(Box::new(expr(ExprKind::Name("sphere".to_owned()))), vec![argument])
        },
        |e| ExprKind::Comprehension {
            variable: name("i"),
            range: Box::new(e),
            body: Box::new(expr(ExprKind::Int(1))),
        },
        |e| ExprKind::Binary(BinaryOp::Add, Box::new(expr(ExprKind::Int(1))), Box::new(e)),
    ];
    for wrap in wrap {
        let mut deep = expr(ExprKind::Int(1));
        for _ in 0..2000 {
            deep = expr(wrap(deep));
        }
        assert!(!codes(deep).is_empty());
    }
}

#[test]
fn deep_type_is_an_error() {
    let mut ty = TypeExpr { kind: TypeExprKind::Named("float".to_owned()), span: Span::default() };
    for _ in 0..1000 {
        ty = TypeExpr { kind: TypeExprKind::Function(vec![], Box::new(ty)), span: Span::default() };
    }
    let function =
        crate::ast::Function { name: name("f"), params: vec![], result: ty, body: expr(ExprKind::Int(1)) };
    let item = Item { kind: ItemKind::Function(function), span: Span::default(), doc: String::new() };
    let (_, diagnostics) = check(&[Module::root(File { items: vec![item] }, "test.vol")], &library());
    assert_eq!(diagnostics[0].code, "E0226");
}

#[test]
fn many_items_and_mistakes_are_quick() {
    let mut source = String::new();
    for i in 0..5_000 {
        writeln!(source, "let a{i} = a{} + 1", i + 1).expect("writing to a string");
    }
    let (_, diagnostics) = checked(&source);
    assert_eq!(diagnostics.iter().filter(|d| d.code == "E0201").count(), 1);
    let file =
        file(expr(ExprKind::List((0..20_000).map(|i| expr(ExprKind::Name(format!("name{i}")))).collect())));
    let (_, diagnostics) = check(&[Module::root(file, "test.vol")], &library());
    assert_eq!(diagnostics.iter().filter(|d| d.code == "E0201").count(), 20_000);
}

#[test]
fn lists_nested_by_names_are_limited() {
    let mut source = "let a0 = [1]\n".to_owned();
    for i in 1..2_000 {
        writeln!(source, "let a{i} = [a{}]", i - 1).expect("writing to a string");
    }
    let (_, diagnostics) = checked(&source);
    let errors: Vec<&str> = diagnostics.iter().filter(|d| d.is_error()).map(|d| d.code).collect();
    assert_eq!(errors, ["E0226", "E0313"]);
}

#[test]
fn tangled_cycles_are_quick() {
    let mut source = String::new();
    for i in 0..5_000 {
        writeln!(source, "let a{i} = a0 + a{}", (i + 1) % 5_000).expect("writing to a string");
    }
    let (_, diagnostics) = checked(&source);
    assert_eq!(diagnostics.iter().filter(|d| d.code == "E0223").count(), 32);
}

#[test]
fn functions_have_few_parameters() {
    let mut source = "fn f(".to_owned();
    for i in 0..65 {
        write!(source, "_a{i}: int = 1, ").expect("writing to a string");
    }
    source.push_str(") -> int { 1 }\nlet a = f()");
    let (_, diagnostics) = checked(&source);
    let errors: Vec<&str> = diagnostics.iter().filter(|d| d.is_error()).map(|d| d.code).collect();
    assert_eq!(errors, ["E0232", "E0313"]);
}

#[test]
fn each_code_is_listed_once() {
    let codes: HashSet<&str> = CODES.iter().map(|(code, _)| *code).collect();
    assert_eq!(codes.len(), CODES.len());
    assert!(CODES.iter().all(|(_, meaning)| !meaning.ends_with('.')));
}

/// Style of every message that a scene full of mistakes gets.
#[test]
fn messages_follow_the_house_style() {
    let source = "let a = nix + 1\nlet b = sphere(45deg)\nlet c = sphere(1).rotate_y(3)\nlet d = [1, true]\nlet e = 1 / 0\nlight l {}\nrender { sze: 1 }\ncamera { fov: 3 }";
    let (_, diagnostics) = checked(source);
    assert!(diagnostics.len() > 8);
    for Diagnostic { code, message, labels, help, .. } in &diagnostics {
        assert!(CODES.iter().any(|(known, _)| known == code), "{code}");
        for text in [message, &labels[0].text, help.as_ref().expect("a help line")] {
            assert!(!text.ends_with('.') && !text.starts_with(|c: char| c.is_ascii_uppercase()), "{text}");
        }
    }
}
