//! A small library, and scenes and diagnostics as short texts.

use crate::check::check;
use crate::diag::{Diagnostic, Severity};
use crate::hir::{self, ExprId, ExprKind, Over, Scene};
use crate::library::{DefaultValue, Library, Parameter, Signature};
use crate::module::{self, NoFiles};
use crate::source::SourceFile;
use crate::ty::Type;

const REQUIRED: DefaultValue = DefaultValue::Required;

fn param(name: &'static str, ty: Type, default: DefaultValue) -> Parameter {
    Parameter { name, ty, default, rest: false }
}

fn function(name: &'static str, params: Vec<Parameter>, result: Type) -> Signature {
    Signature { name, params, result, doc: "" }
}

fn plain(name: &'static str, params: &[(&'static str, Type)], result: Type) -> Signature {
    let params = params.iter().map(|(name, ty)| param(name, ty.clone(), REQUIRED)).collect();
    function(name, params, result)
}

fn along(result: Type) -> Type {
    Type::function(vec![Type::Float, Type::Float], result)
}

/// What the tests can call.
pub(super) fn library() -> Library {
    let rest = Parameter { name: "shapes", ty: Type::Shape, default: REQUIRED, rest: true };
    let number = DefaultValue::Number;
    let mix = |ty: Type| plain("mix", &[("a", ty.clone()), ("b", ty.clone()), ("t", Type::Float)], ty);
    let max = |ty: Type| plain("max", &[("a", ty.clone()), ("b", ty.clone())], ty);
    let field = Type::function(vec![Type::Vec3], Type::Float);
    Library {
        signatures: vec![
            plain("sin", &[("x", Type::Float)], Type::Float),
            plain("sin", &[("x", Type::Angle)], Type::Float),
            plain("cos", &[("x", Type::Float)], Type::Float),
            plain("cos", &[("x", Type::Angle)], Type::Float),
            mix(Type::Float),
            mix(Type::Vec3),
            mix(Type::Color),
            max(Type::Float),
            max(Type::Vec3),
            plain("length", &[("v", Type::Vec3)], Type::Float),
            function(
                "fbm",
                vec![
                    param("p", Type::Vec3, REQUIRED),
                    param("octaves", Type::Int, number(4.0)),
                    param("lacunarity", Type::Float, number(2.0)),
                ],
                Type::Float,
            ),
            plain("sphere", &[("radius", Type::Float)], Type::Shape),
            plain("box", &[("size", Type::Vec3)], Type::Shape),
            plain("rotate_y", &[("shape", Type::Shape), ("angle", Type::Angle)], Type::Shape),
            plain("translate", &[("shape", Type::Shape), ("by", Type::Vec3)], Type::Shape),
            plain("displace", &[("shape", Type::Shape), ("amount", field)], Type::Shape),
            function("union", vec![rest, param("smooth", Type::Float, number(0.0))], Type::Shape),
            plain("bezier", &[("a", Type::Vec3), ("b", Type::Vec3), ("c", Type::Vec3)], Type::Curve),
            function("path", vec![param("segments", Type::list(Type::Curve), REQUIRED)], Type::Curve),
            plain("knots", &[("at", Type::list(Type::Float))], Type::Curve),
            function(
                "tube",
                vec![
                    param("curve", Type::Curve, REQUIRED),
                    param("radius", along(Type::Float), REQUIRED),
                    param("twist", along(Type::Angle), number(0.0)),
                    param("stretch", Type::Bool, DefaultValue::Bool(true)),
                ],
                Type::Shape,
            ),
            plain("diffuse", &[("albedo", Type::Color)], Type::Material),
            function("tint", vec![param("color", Type::Color, number(1.0))], Type::Material),
            plain("henyey_greenstein", &[("g", Type::Float)], Type::Phase),
        ],
    }
}

/// Scene and diagnostics of a source without syntax errors.
pub(super) fn checked(source: &str) -> (Scene, Vec<Diagnostic>) {
    let loaded = module::load(SourceFile::new("test.vol", source), &NoFiles);
    assert!(loaded.diagnostics.is_empty(), "{:?}", loaded.diagnostics);
    check(&loaded.modules, &library())
}

/// Items with an object beside them, so that the scene draws something.
fn with_object(items: &str) -> String {
    format!("{items}\nobject _ball {{ shape: sphere(1) }}")
}

/// The diagnostics of one severity: code, marked text and label.
fn found(source: &str, severity: Severity) -> Vec<String> {
    let (_, diagnostics) = checked(source);
    let found = diagnostics.iter().filter(|diagnostic| diagnostic.severity == severity);
    let line = |diagnostic: &Diagnostic| {
        let label = &diagnostic.labels[0];
        let marked = &source[label.span.start as usize..label.span.end as usize];
        format!("{} `{marked}`: {}", diagnostic.code, label.text)
    };
    found.map(line).collect()
}

/// The errors of a whole scene.
pub(super) fn scene_errors(source: &str) -> Vec<String> {
    found(source, Severity::Error)
}

/// The errors of items.
pub(super) fn errors(items: &str) -> Vec<String> {
    scene_errors(&with_object(items))
}

/// The warnings of items.
pub(super) fn warnings(items: &str) -> Vec<String> {
    let source = with_object(items);
    assert_eq!(scene_errors(&source), [""; 0]);
    found(&source, Severity::Warning)
}

/// The help line of the first error.
pub(super) fn help(items: &str) -> String {
    let (_, diagnostics) = checked(&with_object(items));
    let error = diagnostics.into_iter().find(Diagnostic::is_error).expect("an error");
    error.help.unwrap_or_default()
}

/// The message of the first error.
pub(super) fn message(items: &str) -> String {
    let (_, diagnostics) = checked(&with_object(items));
    diagnostics.into_iter().find(Diagnostic::is_error).expect("an error").message
}

/// The scene of items without errors.
pub(super) fn scene(items: &str) -> Scene {
    let (scene, diagnostics) = checked(&with_object(items));
    let errors: Vec<_> = diagnostics.iter().filter(|d| d.is_error()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    assert_order(&scene);
    scene
}

/// The last `let` of items, typed.
pub(super) fn value(items: &str) -> String {
    let scene = scene(items);
    show(&scene, scene.lets.last().expect("a let").value)
}

/// Operands stand before their users, and nothing uses a wrong one.
fn assert_order(scene: &Scene) {
    for (i, expr) in scene.exprs.iter().enumerate() {
        for operand in operands(&expr.kind) {
            assert!(operand.index() < i, "{expr:?}");
            let ty = &scene.expr(operand).ty;
            assert_ne!(*ty, Type::Error);
        }
        if let ExprKind::Binary(_, a, b) = expr.kind {
            let (a, b) = (&scene.expr(a).ty, &scene.expr(b).ty);
            assert!(a == b || *a == Type::Angle || *b == Type::Angle, "{a} {b}");
        }
    }
}

fn operands(kind: &ExprKind) -> Vec<ExprId> {
    match kind {
        ExprKind::Vector(parts)
        | ExprKind::List(parts)
        | ExprKind::CallFunction(_, parts)
        | ExprKind::CallBuiltin(_, parts) => parts.clone(),
        ExprKind::Swizzle(a, _)
        | ExprKind::LocalField(a, _)
        | ExprKind::Unary(_, a)
        | ExprKind::Lambda(_, a)
        | ExprKind::Convert(_, a) => vec![*a],
        ExprKind::Binary(_, a, b) => vec![*a, *b],
        ExprKind::If(a, b, c) => vec![*a, *b, *c],
        ExprKind::Block(lets, value) => lets.iter().map(|(_, id)| *id).chain([*value]).collect(),
        ExprKind::CallValue(callee, args) => args.iter().copied().chain([*callee]).collect(),
        ExprKind::Comprehension { over: Over::Range(a, b), body, .. } => vec![*a, *b, *body],
        ExprKind::Comprehension { over: Over::List(a), body, .. } => vec![*a, *body],
        ExprKind::Iterate(iterate) => {
            let first = iterate.state.iter().map(|(_, id)| *id);
            first
                .chain([iterate.count])
                .chain(iterate.condition)
                .chain(iterate.next.iter().copied())
                .collect()
        }
        ExprKind::RecordField(of, _) => vec![*of],
        ExprKind::Keys(keys) => keys.keys.iter().map(|(_, id)| *id).chain([keys.at]).collect(),
        ExprKind::Choice(_, args) => args.iter().flatten().copied().collect(),
        ExprKind::Settings(entries) => entries.iter().map(|(_, id)| *id).collect(),
        _ => vec![],
    }
}

/// An expression as a short text; conversions are `type!kind(…)`.
pub(super) fn show(scene: &Scene, id: ExprId) -> String {
    let expr = scene.expr(id);
    let all = |ids: &[ExprId]| ids.iter().map(|&id| show(scene, id)).collect::<Vec<_>>().join(", ");
    match &expr.kind {
        ExprKind::Bool(value) => value.to_string(),
        ExprKind::Number(value) if expr.ty == Type::Angle => format!("{value:.3}rad"),
        ExprKind::Number(value) if expr.ty == Type::Float => format!("{value:?}"),
        ExprKind::Number(value) => value.to_string(),
        ExprKind::Color([r, g, b]) => format!("rgb({r:.4}, {g:.4}, {b:.4})"),
        ExprKind::String(text) => format!("{text:?}"),
        ExprKind::Local(local) => format!("%{}", local.0),
        ExprKind::Let(id) => scene.lets[id.index()].name.clone(),
        ExprKind::Param(id) => scene.params[id.index()].name.clone(),
        ExprKind::Time => "time".to_owned(),
        ExprKind::Frame => "frame".to_owned(),
        ExprKind::Vector(parts) => format!("{}({})", expr.ty, all(parts)),
        ExprKind::Swizzle(of, indices) => format!("{}.{indices:?}:{}", show(scene, *of), expr.ty),
        ExprKind::LocalField(of, field) => format!("{}.{field:?}", show(scene, *of)),
        ExprKind::Unary(op, inner) => format!("{op:?}({})", show(scene, *inner)),
        ExprKind::Binary(op, a, b) => {
            format!("({} {} {}):{}", show(scene, *a), op.symbol(), show(scene, *b), expr.ty)
        }
        ExprKind::If(c, a, b) => {
            format!("if {} then {} else {}", show(scene, *c), show(scene, *a), show(scene, *b))
        }
        ExprKind::Block(lets, value) => {
            let lets = lets.iter().map(|(local, id)| format!("%{} = {}; ", local.0, show(scene, *id)));
            format!("{{ {}{} }}", lets.collect::<String>(), show(scene, *value))
        }
        ExprKind::Lambda(params, body) => {
            let params: Vec<String> = params.iter().map(|p| format!("%{}", p.0)).collect();
            format!("({}) => {}", params.join(", "), show(scene, *body))
        }
        ExprKind::CallFunction(id, args) => format!("{}({})", scene.functions[id.index()].name, all(args)),
        ExprKind::CallBuiltin(id, args) => {
            format!("{}#{}({})", library().signature(*id).name, id.0, all(args))
        }
        ExprKind::CallValue(callee, args) => format!("{}({})", show(scene, *callee), all(args)),
        ExprKind::List(items) => format!("[{}]", all(items)),
        ExprKind::Comprehension { variable, over, body } => {
            let over = match over {
                Over::Range(a, b) => format!("{}..{}", show(scene, *a), show(scene, *b)),
                Over::List(list) => show(scene, *list),
            };
            format!("[for %{} in {over}: {}]", variable.0, show(scene, *body))
        }
        ExprKind::Convert(conversion, inner) => {
            format!("{}!{conversion:?}({})", expr.ty, show(scene, *inner)).to_lowercase()
        }
        ExprKind::Iterate(iterate) => {
            let first: Vec<String> = iterate
                .state
                .iter()
                .map(|(local, id)| format!("%{} = {}", local.0, show(scene, *id)))
                .collect();
            let condition =
                iterate.condition.map_or(String::new(), |id| format!(" while {}", show(scene, id)));
            let count = show(scene, iterate.count);
            format!("iterate {count} from ({}){condition}: ({})", first.join(", "), all(&iterate.next))
        }
        ExprKind::RecordField(of, index) => format!("{}.{index}:{}", show(scene, *of), expr.ty),
        ExprKind::Keys(keys) => {
            let shown = keys.keys.iter().map(|(place, id)| format!(", {place}: {}", show(scene, *id)));
            let ease = match keys.ease {
                hir::Ease::Curve(id) => show(scene, id),
                word => format!("{word:?}"),
            };
            format!("keys({}{}, {ease})", show(scene, keys.at), shown.collect::<String>())
        }
        ExprKind::Choice(word, args) => {
            let args = args.iter().map(|arg| arg.map_or("-".to_owned(), |id| show(scene, id)));
            format!("`{word}`({})", args.collect::<Vec<_>>().join(", "))
        }
        ExprKind::BlockName(name) => format!("block {name}"),
        ExprKind::Settings(entries) => {
            let entries = entries.iter().map(|(key, id)| format!("{key}: {}", show(scene, *id)));
            format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
        }
        ExprKind::Error => "error".to_owned(),
    }
}
