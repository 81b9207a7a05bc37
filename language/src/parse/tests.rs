//! Tests of the parser: what each construct becomes.

mod errors;
mod robust;

use super::parse;
use crate::ast::{BinaryOp, Block, Expr, ExprKind, ItemKind, TypeExprKind, UnaryOp};
use crate::diag::Diagnostic;
use crate::source::SourceFile;

pub(super) const TORNADO: &str = "\
// A tornado: one bent, twisting tube of cloud.  (Moinet 2022, section 5.1)
param spin: angle = 70deg in 0deg..240deg   // per second; a slider: changing it recompiles nothing
param octaves: int = 5 in 1..8

let spine = bezier((0.3 * sin(time), 0, 0), (0.4 * cos(0.7 * time), 1.1, 0.2), (0, 2.2, 0))

medium cloud {
  region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  scatter: #e6ebff
  absorb:  0.15
  phase:   henyey_greenstein(0.3)
}

light sun  { from: (-0.4, 0.8, 0.3), color: 12 }
camera     { from: (0, 1.1, 4.5), at: (0, 1.1, 0), fov: 40deg }
render     { size: (960, 540), background: #0b1020, duration: 10s, fps: 30 }
";

/// Kinds of the items and the messages of a text.
fn read(text: &str) -> (Vec<ItemKind>, Vec<Diagnostic>) {
    let (file, diagnostics) = parse(&SourceFile::new("test.vol", text));
    (file.items.into_iter().map(|item| item.kind).collect(), diagnostics)
}

fn read_all(text: &str) -> Vec<ItemKind> {
    let (items, diagnostics) = read(text);
    assert!(diagnostics.is_empty(), "{text}: {diagnostics:?}");
    items
}

fn block(text: &str) -> Block {
    match read_all(text).pop() {
        Some(ItemKind::Block(block)) => block,
        other => panic!("{text}: {other:?}"),
    }
}

fn expr(text: &str) -> Expr {
    match read_all(&format!("let value = {text}")).pop() {
        Some(ItemKind::Let(item)) => item.value,
        other => panic!("{text}: {other:?}"),
    }
}

/// The shape of an expression, fully bracketed.
fn shape(expr: &Expr) -> String {
    let all = |exprs: &[Expr]| exprs.iter().map(shape).collect::<Vec<_>>().join(" ");
    let arguments = |arguments: &[crate::ast::Argument]| {
        let one = |a: &crate::ast::Argument| {
            let name = a.name.as_ref().map_or(String::new(), |name| format!("{}:", name.text));
            format!(" {name}{}", shape(&a.value))
        };
        arguments.iter().map(one).collect::<String>()
    };
    match &expr.kind {
        ExprKind::Bool(value) => value.to_string(),
        ExprKind::Int(value) => value.to_string(),
        ExprKind::Float(value) => format!("{value:?}"),
        ExprKind::Angle(value) => format!("{value:.3}rad"),
        ExprKind::Color([r, g, b]) => format!("#{r:02x}{g:02x}{b:02x}"),
        ExprKind::String(value) => format!("{value:?}"),
        ExprKind::Name(name) => name.clone(),
        ExprKind::Tuple(parts) => format!("<{}>", all(parts)),
        ExprKind::List(parts) => format!("[{}]", all(parts)),
        ExprKind::Comprehension { variable, range, body } => {
            format!("[for {} in {}: {}]", variable.text, shape(range), shape(body))
        }
        ExprKind::Range(a, b) => format!("{}..{}", shape(a), shape(b)),
        ExprKind::Unary(UnaryOp::Negate, a) => format!("(- {})", shape(a)),
        ExprKind::Unary(UnaryOp::Not, a) => format!("(! {})", shape(a)),
        ExprKind::Binary(op, a, b) => format!("({} {} {})", op.symbol(), shape(a), shape(b)),
        ExprKind::If(c, a, b) => format!("(if {} {} {})", shape(c), shape(a), shape(b)),
        ExprKind::Block(lets, value) => {
            let lets: String = lets.iter().map(|l| format!("{}={} ", l.name.text, shape(&l.value))).collect();
            format!("{{{lets}{}}}", shape(value))
        }
        ExprKind::Lambda(params, body) => {
            let params: Vec<&str> = params.iter().map(|p| p.text.as_str()).collect();
            format!("(\\{} {})", params.join(" "), shape(body))
        }
        ExprKind::Call(callee, a) => format!("({}{})", shape(callee), arguments(a)),
        ExprKind::MethodCall(object, name, a) => format!("({}.{}{})", shape(object), name.text, arguments(a)),
        ExprKind::Field(object, name) => format!("{}.{}", shape(object), name.text),
        ExprKind::Record(entries) => {
            let entries = entries.iter().map(|e| format!(" {}:{}", e.key.text, shape(&e.value)));
            format!("{{record{}}}", entries.collect::<String>())
        }
        ExprKind::NamedTuple(a) => format!("<{}>", arguments(a)),
        ExprKind::Iterate(iterate) => {
            let states = |states: &[crate::ast::Let]| {
                states.iter().map(|s| format!(" {}={}", s.name.text, shape(&s.value))).collect::<String>()
            };
            let condition =
                iterate.condition.as_ref().map_or(String::new(), |c| format!(" while {}", shape(c)));
            let (state, next) = (states(&iterate.state), states(&iterate.next));
            format!("(iterate {} from{state}{condition} :{next})", shape(&iterate.count))
        }
        ExprKind::Keys(keys) => {
            let list = keys.keys.iter().map(|(place, value)| format!(" {}:{}", shape(place), shape(value)));
            let ease = keys.ease.as_ref().map_or(String::new(), |ease| format!(" ease:{}", shape(ease)));
            format!("(keys {}{}{ease})", shape(&keys.at), list.collect::<String>())
        }
    }
}

#[track_caller]
fn check(text: &str, expected: &str) {
    assert_eq!(shape(&expr(text)), expected, "{text}");
}

#[test]
fn the_tornado_has_its_seven_items() {
    let items = read_all(TORNADO);
    let kinds: Vec<String> = items
        .iter()
        .map(|item| match item {
            ItemKind::Import(import) => format!("import {}", import.alias.text),
            ItemKind::Param(param) => format!("param {}", param.name.text),
            ItemKind::Let(item) => format!("let {}", item.name.text),
            ItemKind::Function(function) => format!("fn {}", function.name.text),
            ItemKind::Block(block) => {
                let keys: Vec<&str> = block.entries.iter().map(|entry| entry.key.text.as_str()).collect();
                let name = block.name.as_ref().map_or("-", |name| name.text.as_str());
                format!("{} {name} {}", block.keyword.text, keys.join(" "))
            }
        })
        .collect();
    let expected = [
        "param spin",
        "param octaves",
        "let spine",
        "medium cloud region density scatter absorb phase",
        "light sun from color",
        "camera - from at fov",
        "render - size background duration fps",
    ];
    assert_eq!(kinds, expected);
}

#[test]
fn the_tornados_values() {
    let items = read_all(TORNADO);
    let ItemKind::Block(cloud) = &items[3] else { panic!("{items:?}") };
    assert_eq!(
        shape(&cloud.entries[0].value),
        "(tube spine radius:(\\t (mix 0.08 0.6 (* t t))) twist:(\\t (- (* 5.027rad t) (* spin time))))"
    );
    assert_eq!(shape(&cloud.entries[2].value), "#e6ebff");
    let ItemKind::Param(spin) = &items[0] else { panic!("{items:?}") };
    assert_eq!(spin.ty.kind, TypeExprKind::Named("angle".to_owned()));
    let (low, high) = spin.range.as_ref().expect("has a range");
    assert_eq!((shape(low).as_str(), shape(high).as_str()), ("0.000rad", "4.189rad"));
}

#[test]
fn literals() {
    check("12", "12");
    check("1.5", "1.5");
    check(".5", "0.5");
    check("2e-3", "0.002");
    check("1.5e+2", "150.0");
    check("90deg", "1.571rad");
    check("0.5rad", "0.500rad");
    check(".25turn", "1.571rad");
    check("2s", "2.0");
    check("500ms", "0.5");
    check("2e1ms", "0.02");
    check("true", "true");
    check("#0b1020", "#0b1020");
    check("#f80", "#ff8800");
    check(r#""a \"b\" \\ \n \u{e9} é""#, r#""a \"b\" \\ \n é é""#);
}

#[test]
fn precedence() {
    check("a || b && c == d | e & f + g * h", "(|| a (&& b (== c (| d (& e (+ f (* g h)))))))");
    check("a - b - c", "(- (- a b) c)");
    check("a / b * c % d", "(% (* (/ a b) c) d)");
    check("-a * b", "(* (- a) b)");
    check("-a.x", "(- a.x)");
    check("!a && !!b", "(&& (! a) (! (! b)))");
    check("a < b == c >= d", "(>= (== (< a b) c) d)");
    check("(a + b) * c", "(* (+ a b) c)");
    check("a != b", "(!= a b)");
    assert_eq!(BinaryOp::Union.symbol(), "|");
}

#[test]
fn calls_members_and_lambdas() {
    check("f(a, smooth: 0.1,)", "(f a smooth:0.1)");
    check("f()(a)", "((f) a)");
    check(
        "box((1, 1, 1)).round(0.1)\n  .translate((0, 1, 0))",
        "(((box <1 1 1>).round 0.1).translate <0 1 0>)",
    );
    check("q.local.x", "q.local.x");
    check("1.abs()", "(1.abs)");
    check("t => t * 2", "(\\t (* t 2))");
    check("(t, l) => t => l", "(\\t l (\\t l))");
    check("() => 1", "(\\ 1)");
    check("(a) => a", "(\\a a)");
    check("(a, b, c, d, e) => a", "(\\a b c d e a)");
    check("f(x => x + 1, y)", "(f (\\x (+ x 1)) y)");
}

#[test]
fn tuples_lists_and_records() {
    check("(1)", "1");
    check("(1, 2)", "<1 2>");
    check("(1, 2, 3, 4,)", "<1 2 3 4>");
    check("[]", "[]");
    check("[1, 2,\n 3,]", "[1 2 3]");
    check("[for i in 0..12: i * 2]", "[for i in 0..12: (* i 2)]");
    check("[for p in list: p]", "[for p in list: p]");
    check("[for t in 1.0..2.0: t]", "[for t in 1.0..2.0: t]");
    check("{}", "{record}");
    check("{ a: 1, b: [x]\n c: { d: 2 } }", "{record a:1 b:[x] c:{record d:2}}");
}

#[test]
fn choices_and_blocks() {
    check("if a then b else if c then d else e + 1", "(if a b (if c d (+ e 1)))");
    check("1 + if a then b else c", "(+ 1 (if a b c))");
    check("{ let a = 1  let b = 2  a + b }", "{a=1 b=2 (+ a b)}");
    check("{ a }", "{a}");
    check("{ let iffy = 1 iffy }", "{iffy=1 iffy}");
}

#[test]
fn line_ends_in_blocks() {
    check("{ let a = b\n -a }", "{a=b (- a)}");
    check("{ let a = b // (\n (a, 1) }", "{a=b <a 1>}");
    check("{ let a = b -\n c\n a }", "{a=(- b c) a}");
    check("{ let a = b\n + c\n a }", "{a=(+ b c) a}");
    check("{ let a = (b\n - c)\n a }", "{a=(- b c) a}");
    let camera = block("camera { from: a\n - b\n at: c\n | d\n fov: e }");
    assert_eq!(shape(&camera.entries[0].value), "(- a b)");
    assert_eq!(shape(&camera.entries[1].value), "(| c d)");
}

#[test]
fn functions_and_types() {
    let items =
        read_all("fn f(a: [vec3], g: (float, int) -> [float] = t => [t],) -> shape { let b = a\n b }");
    let [ItemKind::Function(function)] = items.as_slice() else { panic!("{items:?}") };
    assert_eq!(function.params.len(), 2);
    assert!(matches!(function.params[0].ty.kind, TypeExprKind::List(_)));
    let TypeExprKind::Function(params, result) = &function.params[1].ty.kind else { panic!() };
    assert_eq!(params.len(), 2);
    assert!(matches!(result.kind, TypeExprKind::List(_)));
    assert!(function.params[1].default.is_some());
    assert_eq!(shape(&function.body), "{b=a b}");
}

#[test]
fn doc_comments_belong_to_the_next_item() {
    let text = "/// Turns per second.\n///  Two lines.\n// plain\n\nparam a: int = 1\nlet b = [ /// lost\n 1]\n/// last\nlet c = 2";
    let (file, _) = parse(&SourceFile::new("test.vol", text));
    let docs: Vec<&str> = file.items.iter().map(|item| item.doc.as_str()).collect();
    assert_eq!(docs, ["Turns per second.\n Two lines.", "", "last"]);
}

#[test]
fn spans_are_bytes_of_the_file() {
    let text = "#vol 1\n// é\nlet a = \"é\"  // x\nlet b = f( 1 , 2 ).x  + 3\n";
    let (file, diagnostics) = parse(&SourceFile::new("test.vol", text));
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    let cut = |span: crate::source::Span| &text[span.start as usize..span.end as usize];
    assert_eq!(cut(file.items[0].span), "let a = \"é\"");
    let ItemKind::Let(b) = &file.items[1].kind else { panic!() };
    assert_eq!((cut(b.name.span), cut(b.value.span)), ("b", "f( 1 , 2 ).x  + 3"));
    let ExprKind::Binary(_, left, _) = &b.value.kind else { panic!() };
    assert_eq!(cut(left.span), "f( 1 , 2 ).x");
}

#[test]
fn items_share_lines_and_names_look_like_item_words() {
    assert_eq!(
        read_all("object a { shape: sphere(1) } object b { shape: sphere(2) } let c = 1 let d = 2").len(),
        4
    );
    assert_eq!(
        read_all("light light { from: (0, 1, 0) }\nlet camera = 1\nlet x = camera\n  + camera").len(),
        3
    );
    assert_eq!(read_all("param style: float = 1\n  in 0..2\nlet b = if a\n then b\n else c").len(), 2);
    assert!(read_all("").is_empty());
    assert!(read_all("// only a comment").is_empty());
}
