//! Every scene compiles, and together the scenes say everything that the language can.

use crate::{bytes, scene};
use std::collections::BTreeSet;
use vol_language::ast::BinaryOp;
use vol_language::blocks::BLOCK_KINDS;
use vol_language::diag::render::human;
use vol_language::hir::{Conversion, ExprKind, LocalField, Over, Scene};
use vol_language::module::ModuleId;
use vol_language::source::SourceFile;
use vol_language::standard;

/// Scenes tried.
const SCENES: u64 = 1000;

/// Scenes that say everything together, rare things included.
const ALL_SAID: u64 = 4000;

/// Bytes of the scene of a seed: small ones and large ones.
fn of_seed(seed: u64) -> String {
    scene(&bytes(seed, [60, 200, 500, 1200][seed as usize % 4]))
}

fn checked(text: &str) -> Scene {
    let file = SourceFile::new("generated.vol", text);
    let (scene, diagnostics) = vol_language::analyse(&file, &vol_compiler::library::library());
    let (compiled, more) = match &scene {
        Some(scene) => vol_compiler::lower::compile(scene),
        None => (None, diagnostics),
    };
    if let (Some(scene), Some(_)) = (scene, compiled) {
        return scene;
    }
    panic!("{text}\n{}", human(&file.into(), &more, false))
}

#[test]
fn every_scene_compiles() {
    for seed in 0..SCENES {
        checked(&of_seed(seed));
    }
}

#[test]
fn no_bytes_are_a_scene_too() {
    checked(&scene(&[]));
    for byte in 0..=255 {
        checked(&scene(&[byte; 40]));
    }
}

#[test]
fn everything_is_said() {
    let mut said = BTreeSet::new();
    for seed in 0..ALL_SAID {
        said.extend(words(&checked(&of_seed(seed))));
    }
    let missing: Vec<String> = wanted().into_iter().filter(|word| !said.contains(word)).collect();
    assert!(missing.is_empty(), "never said in {ALL_SAID} scenes: {missing:?}");
}

/// What a scene says.
fn words(scene: &Scene) -> Vec<String> {
    let library = vol_compiler::library::library();
    let mut words: Vec<String> = Vec::new();
    for block in &scene.blocks {
        words.extend(block.entries.iter().map(|(key, _)| format!("{}.{key}", block.kind.keyword())));
    }
    for expr in &scene.exprs {
        words.push(match &expr.kind {
            ExprKind::Bool(_) => "bool".into(),
            ExprKind::Number(_) => "number".into(),
            ExprKind::Color(_) => "color".into(),
            ExprKind::String(_) => "string".into(),
            ExprKind::Local(_) => "local".into(),
            ExprKind::Let(_) => "let".into(),
            ExprKind::Param(_) => "param".into(),
            ExprKind::Time => "time".into(),
            ExprKind::Frame => "frame".into(),
            ExprKind::Vector(_) => format!("vector {}", expr.ty),
            ExprKind::Swizzle(..) => format!("swizzle {}", expr.ty),
            ExprKind::LocalField(_, field) => format!("field {field:?}"),
            ExprKind::Unary(op, _) => format!("unary {op:?}"),
            ExprKind::Binary(op, ..) => format!("binary {op:?}"),
            ExprKind::If(..) => "if".into(),
            ExprKind::Block(..) => "block".into(),
            ExprKind::Lambda(..) => "lambda".into(),
            ExprKind::CallFunction(id, _) => match scene.functions[id.index()].module {
                ModuleId::LIBRARY => format!("builtin {}", scene.functions[id.index()].name),
                _ => "call of a function".into(),
            },
            ExprKind::CallBuiltin(id, _) => format!("builtin {}", library.signature(*id).name),
            ExprKind::CallValue(..) => "call of a value".into(),
            ExprKind::List(_) => "list".into(),
            ExprKind::Comprehension { over: Over::Range(..), .. } => "walk of a range".into(),
            ExprKind::Comprehension { over: Over::List(_), .. } => "walk of a list".into(),
            ExprKind::Convert(conversion, _) => format!("convert {conversion:?}"),
            ExprKind::Iterate(_) => "loop".into(),
            ExprKind::RecordField(..) => "field of a record".into(),
            ExprKind::Keys(_) => "keys".into(),
            ExprKind::Choice(word, _) => format!("word {word}"),
            ExprKind::BlockName(_) => "name of a block".into(),
            ExprKind::Settings(_) => "settings".into(),
            ExprKind::Error => "error".into(),
        });
    }
    words
}

fn wanted() -> Vec<String> {
    let mut wanted: Vec<String> = [
        "loop",
        "field of a record",
        "keys",
        "word round",
        "name of a block",
        "settings",
        "bool",
        "number",
        "color",
        "string",
        "local",
        "let",
        "param",
        "time",
        "frame",
        "if",
        "block",
        "lambda",
        "call of a function",
        "call of a value",
        "list",
        "walk of a range",
        "walk of a list",
        "unary Negate",
        "unary Not",
    ]
    .map(str::to_owned)
    .to_vec();
    for ty in ["vec2", "vec3", "vec4", "color"] {
        wanted.extend([format!("vector {ty}"), format!("swizzle {ty}")]);
    }
    wanted.push("swizzle float".to_owned());
    for kind in BLOCK_KINDS {
        wanted.extend(kind.keys().iter().map(|key| format!("{}.{}", kind.keyword(), key.name)));
    }
    for signature in &standard::extended(&vol_compiler::library::library()).signatures {
        wanted.push(format!("builtin {}", signature.name));
    }
    wanted.extend(LocalField::ALL.iter().map(|(field, ..)| format!("field {field:?}")));
    let conversions = [Conversion::Retype, Conversion::Broadcast, Conversion::Constant];
    wanted.extend(conversions.iter().map(|conversion| format!("convert {conversion:?}")));
    let operators = [
        BinaryOp::Or,
        BinaryOp::And,
        BinaryOp::Equal,
        BinaryOp::NotEqual,
        BinaryOp::Less,
        BinaryOp::LessEqual,
        BinaryOp::Greater,
        BinaryOp::GreaterEqual,
        BinaryOp::Union,
        BinaryOp::Intersection,
        BinaryOp::Add,
        BinaryOp::Subtract,
        BinaryOp::Multiply,
        BinaryOp::Divide,
        BinaryOp::Modulo,
    ];
    wanted.extend(operators.iter().map(|op| format!("binary {op:?}")));
    wanted
}
