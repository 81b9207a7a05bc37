//! What the parser says about mistakes.

use super::{read, read_all};
use crate::diag::render::human;
use crate::parse::explain::CODES;
use crate::source::SourceFile;

/// Code, message and help of each error, and the text that its first label marks.
fn errors(text: &str) -> Vec<(String, String, String)> {
    let (_, diagnostics) = read(text);
    let rendered = human(&SourceFile::new("test.vol", text).into(), &diagnostics, false);
    assert!(!rendered.is_empty() || diagnostics.is_empty());
    let all = diagnostics.into_iter().map(|d| {
        assert!(CODES.iter().any(|(code, _)| *code == d.code), "{} is not listed", d.code);
        let span = d.labels[0].span;
        let marked = text[span.start as usize..span.end as usize].to_owned();
        (format!("{} {}", d.code, d.message), marked, d.help.unwrap_or_default())
    });
    all.collect()
}

/// There is one error, with this message at this text.
#[track_caller]
fn one(text: &str, message: &str, marked: &str) -> String {
    let errors = errors(text);
    assert_eq!(errors.len(), 1, "{text}: {errors:?}");
    assert_eq!((errors[0].0.as_str(), errors[0].1.as_str()), (message, marked), "{text}");
    errors[0].2.clone()
}

#[test]
fn three_errors_are_three_messages() {
    let text = "let a = 1 +\nlet b = (1, 2\nlet c = 3m\nlet d = 4";
    let found: Vec<String> = errors(text).into_iter().map(|error| error.0).collect();
    assert_eq!(
        found,
        ["E0102 expected an expression after `+`", "E0101 `)` is missing", "E0106 `m` is not a unit"]
    );
    assert_eq!(read(text).0.len(), 1);
}

#[test]
fn entries_of_one_block_err_apart() {
    let text = "camera {\n  from: (1, 2,, 3)\n  at:\n  fov: 40 deg\n  up: (0, 1, 0)\n}\nlet a = ?\nlet b = 1";
    let found: Vec<String> = errors(text).into_iter().map(|error| error.0).collect();
    assert_eq!(
        found,
        [
            "E0102 expected an expression, found `,`",
            "E0102 expected an expression after `:`",
            "E0102 expected a new line or `,`, found `deg`",
            "E0104 the character `?` has no meaning here",
        ]
    );
    assert_eq!(read(text).0.len(), 1);
}

#[test]
fn unexpected_text() {
    one("let = 1", "E0102 expected a name, found `=`", "=");
    one("let a 1", "E0102 expected `=`, found `1`", "1");
    one("let a = f(1 2)", "E0102 expected `,` or `)`, found `2`", "2");
    one("let a = [1 2]", "E0102 expected `,` or `]`, found `2`", "2");
    one("let a = { x: 1, y }", "E0102 expected `:`, found `}`", "}");
    one("let a = (1, 2, 3", "E0101 `)` is missing", "(");
    one("let a = ()", "E0102 expected an expression between `(` and `)`", "()");
    one("let a = (1, b) => 2", "E0102 expected a name before `=>`", "1");
    one("let a = f(b.c: 2)", "E0102 expected a name before `:`", "b.c");
    one("let a = if b c", "E0102 expected `then`, found `c`", "c");
    one("let a = if b then c", "E0102 expected `else` after `c`", "c");
    one("let a = [for i in 0..3 i]", "E0102 expected `:`, found `i`", "i");
    one("param a = 1", "E0102 expected `:`, found `=`", "=");
    one("param a: int = 1 in 5", "E0102 expected a range after `in`", "5");
    one("fn f(a: ) -> int { 1 }", "E0102 expected a type, found `)`", ")");
    one("fn f() { 1 }", "E0102 expected `->`, found `{`", "{");
    one("fn f() -> int { let a = 1 }", "E0102 expected an expression, found `}`", "}");
    one("light sun from: 1", "E0102 expected `{`", "from");
    one("camera { fov: 40deg } + 1", "E0102 expected an item, found `+`", "+");
    one("camera { , fov: 40deg }", "E0102 expected an entry before `,`", ",");
    one("let a = 0..5", "E0102 expected the next item, found `..`", "..");
    one(
        "let a = (1, 2, 3, 4, 5)",
        "E0112 a vector has two to four components, this one has 5",
        "(1, 2, 3, 4, 5)",
    );
}

#[test]
fn helps_can_be_typed() {
    assert_eq!(one("camera { from = 1 }", "E0102 expected `:`, found `=`", "="), "write `:` instead of `=`");
    assert_eq!(
        one("camera { at: 1, 2, }", "E0102 expected a key, found `2`", "2"),
        "write a vector in brackets: `(1, 2)`"
    );
    assert_eq!(
        one("let a: int = 1", "E0102 expected `=`, found `:`", ":"),
        "a `let` states no type: write `let name = value`"
    );
    assert_eq!(
        one("let a = [(0, 0)\n (1, 1)]", "E0102 expected `,` or `]`, found `(`", "("),
        "write `(` on the line above to call, or `,` before it"
    );
    assert_eq!(
        one("let in = 1", "E0102 expected a name, found `in`", "in"),
        "`in` is a word of the language: choose another name"
    );
    assert_eq!(
        one("let a = 2 ^ 3", "E0104 the character `^` has no meaning here", "^"),
        "write a power as `pow(a, b)`"
    );
    assert_eq!(
        one("let a = b.1", "E0102 expected a name, found `.1`", ".1"),
        "write the parts of a vector as `v.x`, `v.y` and `v.z`"
    );
    assert_eq!(
        one("let a = { let b = 1, b }", "E0102 expected an expression, found `,`", ","),
        "separate `let`s by new lines"
    );
    assert_eq!(
        one("let a = if b = 1 then 2 else 3", "E0102 expected `then`, found `=`", "="),
        "write `==` to compare"
    );
    assert_eq!(one("let a = 12degrees", "E0106 `degrees` is not a unit", "degrees"), "write `12deg`");
}

#[test]
fn brackets() {
    one("let a = (1, 2]", "E0101 expected `)`, found `]`", "]");
    one("let a = 1)", "E0101 `)` closes nothing", ")");
    one("camera { from: (0, 1)) }", "E0101 `)` closes nothing", ")");
    one("let a = [f(1)), 2]", "E0101 `)` closes nothing", ")");
    one("let a = [f(1))\nlet b = 1", "E0101 expected `]`, found `)`", ")");
    one("camera { from: (0, 1\n}\nlet b = 1", "E0101 expected `)`, found `}`", "}");
    one("camera {\n  fov: 40deg\n\nlight sun { color: 1 }\nlet b = 1", "E0101 `}` is missing", "{");
    assert_eq!(read("camera {\n  fov: 40deg\n\nlight sun { color: 1 }\nlet b = 1").0.len(), 2);
    assert_eq!(read("camera {\n  fov: 40deg\n\nlet a = 1\nlet b = (1").0.len(), 1);
    assert_eq!(read_all("fn f() -> int {\nlet a = 1\na }").len(), 1);
}

#[test]
fn literals() {
    one("let a = 3m", "E0106 `m` is not a unit", "m");
    one("let a = 0x10", "E0106 `x10` is not a unit", "x10");
    one("let a = 99999999999999999999", "E0107 the number is too large", "99999999999999999999");
    one("let a = 1e999", "E0107 the number is too large", "1e999");
    one("let a = #12345", "E0108 `#12345` is not a colour", "#12345");
    one("let a = \"x\\qy\"", "E0109 `\\q` is not an escape", "\\q");
    one("let a = \"x\\u{110000}y\"", "E0109 `\\u{110000}` is not an escape", "\\u{110000}");
    one("let a = \"x\\é\"", "E0109 `\\é` is not an escape", "\\é");
    one("let a = \"x\\\nlet b = 1", "E0103 the string has no closing quote", "\"x\\");
    one("let a = “x", "E0104 the character `“` has no meaning here", "“");
}

#[test]
fn items() {
    assert_eq!(
        one("objct a { shape: 1 }", "E0113 `objct` does not begin an item", "objct"),
        "did you mean `object`"
    );
    assert_eq!(one("a = 5", "E0113 `a` does not begin an item", "a"), "write `let a = …`");
    one("5 + 3", "E0113 `5` does not begin an item", "5");
    assert_eq!(errors("let a = 1\nball b { c: 1 }\nlet d = 2").len(), 1);
    one("import \"a.vol\"", "E0102 expected `as` after a string", "\"a.vol\"");
    one("import a as b", "E0102 expected a string, found `a`", "a");
    one("let a = keys(time, 1)", "E0102 expected `:` after the place of a key", "1");
    one("let a = keys()", "E0102 expected what runs along the keys", "()");
    one("let a = iterate 8 from z: (z = 1)", "E0102 expected `(`, found `z`", "z");
    one("let a = iterate 8 from (z = 1)", "E0102 expected `while` or `:` after `)`", ")");
    one("camera { fov: 40deg, at: a up: b }", "E0105 two entries share a line without a comma", "up");
    one("let a = { b: 1 c: 2 }", "E0105 two entries share a line without a comma", "c");
}

#[test]
fn versions() {
    assert_eq!(read_all("#vol 1 // first\nlet a = 1").len(), 1);
    assert_eq!(
        one("#vol 2\nlet a = 1", "E0110 this program does not read version `2` of the language", "#vol 2"),
        "write `#vol 1`"
    );
    one("#vol", "E0110 the version of the language is missing", "#vol");
    one("/* no */ let a = 1", "E0104 comments have no `/*` form", "/*");
}

#[test]
fn errors_end_at_a_hundred() {
    let found = errors(&"; ".repeat(10_000));
    assert_eq!(found.len(), 101);
    assert!(found.iter().any(|error| error.0 == "E0115 more than 100 syntax errors, the rest is not shown"));
}
