//! Any text is answered with messages: no panic, no overflow, no long wait.

use super::{TORNADO, read, read_all};
use crate::ast::ItemKind;
use crate::diag::apply_all;
use crate::diag::render::human;
use crate::parse::{MAX_DEPTH, MAX_NESTING};
use crate::source::SourceFile;
use std::time::{Duration, Instant};

fn codes(text: &str) -> Vec<&'static str> {
    read(text).1.into_iter().map(|d| d.code).collect()
}

fn nested(open: &str, inner: &str, close: &str, levels: usize) -> String {
    format!("let a = {}{inner}{}", open.repeat(levels), close.repeat(levels))
}

#[test]
fn ten_thousand_brackets_are_one_error() {
    for (open, close) in [("(", ")"), ("[", "]"), ("{", "}"), ("f(", ")"), ("[(", ")]")] {
        assert_eq!(codes(&nested(open, "1", close, 10_000)), ["E0100"], "{open}");
        assert_eq!(codes(&format!("let a = {}\nlet b = 1", open.repeat(10_000))), ["E0100"], "{open}");
    }
    assert!(!codes(&")".repeat(10_000)).is_empty());
    assert!(!codes(&"(]".repeat(10_000)).is_empty());
}

#[test]
fn a_file_full_of_stray_brackets_is_read_quickly() {
    let start = Instant::now();
    for strays in [")", "(]", ") (]", "( ] )"] {
        let text = format!("let a = {{ {} }}", strays.repeat(200_000));
        assert!(codes(&text).len() > 1, "{strays}");
    }
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
}

#[test]
fn the_deepest_nests_are_read() {
    assert_eq!(read_all(&nested("(", "1", ")", MAX_NESTING)).len(), 1);
    assert_eq!(codes(&nested("(", "1", ")", MAX_NESTING + 1)), ["E0100"]);
    for (open, close) in [("[", "]"), ("f(", ")"), ("{ let a = ", "\n a }"), ("(x => ", ")"), ("-(1 + ", ")")]
    {
        let levels = MAX_NESTING - 1;
        assert_eq!(read_all(&nested(open, "1", close, levels)).len(), 1, "{open}");
    }
}

#[test]
fn nests_without_brackets_are_bounded() {
    for repeated in
        ["if a then b else ", "if ", "if a then ", "x => ", "() => ", "-", "!", "- -a.b(", "a => -"]
    {
        assert_eq!(
            codes(&format!("let a = {}1", repeated.repeat(50_000))).first(),
            Some(&"E0100"),
            "{repeated}"
        );
    }
    let run = "-".repeat(100);
    for repeated in [format!("{run}a.f("), format!("{run}if a + b then "), format!("f({run}a => ")] {
        assert_eq!(
            codes(&format!("let a = {}1", repeated.repeat(100))).first(),
            Some(&"E0100"),
            "{repeated}"
        );
    }
    let types = format!("fn f(a: {}int) -> int {{ 1 }}", "() -> ".repeat(50_000));
    assert_eq!(codes(&types), ["E0100"]);
}

#[test]
fn long_chains_are_bounded() {
    for (repeated, last) in [("a+", "a"), ("a | ", "a"), ("a.b.", "c"), ("f().g().", "h()"), ("a == ", "a")] {
        assert_eq!(codes(&format!("let a = {}{last}", repeated.repeat(1_000_000))), ["E0100"], "{repeated}");
        assert_eq!(codes(&format!("let a = {}{last}", repeated.repeat(1000))), ["E0100"], "{repeated}");
        read_all(&format!("let a = {}{last}", repeated.repeat(60)));
    }
    read_all(&format!("let a = {}a", "a + ".repeat(MAX_DEPTH - 1)));
    assert_eq!(codes(&format!("let a = {}a", "a + ".repeat(MAX_DEPTH))), ["E0100"]);
    assert_eq!(codes(&format!("let a = f{}", "()".repeat(100_000))), ["E0100"]);
    assert_eq!(codes(&format!("let a = f{}", "(1)".repeat(1000))), ["E0100"]);
}

#[test]
fn an_error_in_a_deep_nest_is_found_quickly() {
    let start = Instant::now();
    for (open, close) in
        [("(", ")"), ("[", "]"), ("f(a, ", ")"), ("{ a: ", "}"), ("{ let a = ", " a }"), ("{", "}")]
    {
        for inner in ["1", "+", "1 2", ""] {
            read(&nested(open, inner, close, 120));
        }
    }
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
}

#[test]
fn nests_of_depth_64_take_less_than_50_ms() {
    for (open, close) in
        [("(", ")"), ("[", "]"), ("f((a, ", "))"), ("{ a: ", "}"), ("{ let a = ", " a }"), ("(x => ", ")")]
    {
        let text = nested(open, "1", close, if open == "f((a, " { 32 } else { 64 });
        let start = Instant::now();
        read_all(&text);
        assert!(start.elapsed() < Duration::from_millis(50), "{open}: {:?}", start.elapsed());
    }
}

#[test]
fn a_small_stack_is_enough() {
    // Threads get 2 MiB by default; the parser needs to leave most of it to the walks after it.
    let deepest = || {
        for open in ["(", "[", "f(a, b: ", "{ let a = ", "-(1 + 2 * ", "{ a: ", "(x => "] {
            let close = match open {
                "[" => "]",
                "{ let a = " => " a }",
                "{ a: " => "}",
                _ => ")",
            };
            let ifs = "if a then ".repeat(MAX_DEPTH - 2 * MAX_NESTING + 60);
            read(&nested(&format!("{ifs}{open}"), "1", close, MAX_NESTING));
            read(&nested(open, "1", close, MAX_NESTING));
        }
        read(&format!("let a = {}b{}", "if a then ".repeat(MAX_DEPTH - 1), " else c".repeat(MAX_DEPTH - 1)));
        read(&format!("let a = {}b", "-".repeat(MAX_DEPTH - 1)));
    };
    let thread = std::thread::Builder::new().stack_size(1 << 20).spawn(deepest);
    thread.expect("a thread can be started").join().expect("no panic");
}

#[test]
fn a_megabyte_of_scene_is_read_in_seconds() {
    let text = big_scene(1 << 20);
    let start = Instant::now();
    assert!(read_all(&text).len() > 1000);
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
}

/// Valid items until the text has at least this size.
fn big_scene(bytes: usize) -> String {
    let mut text = String::new();
    while text.len() < bytes {
        text += TORNADO;
    }
    text
}

#[test]
fn non_ascii_text_is_fine_in_comments_and_strings() {
    let text = "// Ünïcödé 雲 🌪\n/// Größe\nlet a = \"雲 🌪 \\u{1F32A}\" // é\nlet b = [\"é\", \"ü\"]";
    assert_eq!(read_all(text).len(), 2);
    assert_eq!(codes("let é = 1\nlet b = 雲"), ["E0104", "E0104"]);
    assert_eq!(codes("\u{feff}let a = 1\u{a0}"), ["E0104", "E0104"]);
    assert_eq!(codes("let a = \"🌪\nlet b = 1"), ["E0103"]);
}

#[test]
fn line_ends_of_windows_are_fine() {
    assert_eq!(read_all(&TORNADO.replace('\n', "\r\n")).len(), 7);
    let text = "/// Doc.\r\nlet a = { let b = \"x\"\r\n (b, 1) }\r\n";
    let (file, diagnostics) = crate::parse::parse(&SourceFile::new("crlf.vol", text));
    assert!(diagnostics.is_empty(), "{diagnostics:?}");
    assert_eq!(file.items[0].doc, "Doc.");
    assert_eq!(codes("let a = \"x\r\nlet b = 1"), ["E0103"]);
}

struct Lcg(u64);

impl Lcg {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % limit.max(1)
    }
}

#[test]
fn mutated_scenes_never_panic() {
    let seeds = [
        TORNADO,
        "#vol 1\n/// doc\nfn f(a: [vec3], g: (float) -> float = t => t,) -> shape { let b = -a.x\n (b, 1) }\n",
        "let a = { b: 1, c: [for i in 0..3: if i < 2 then \"x\\n\" else \"é\"] }\nlet k = keys(time, 0s: 1)",
    ];
    let pieces = [
        "(", ")", "[", "]", "{", "}", "\"", "\\", "//", "///", "#", "\n", ":", ",", "=>", "->", "..", ".",
        "let ", "if ", "then ", "else ", "for ", " in ", "fn ", "param ", "camera ", "é", "🌪", "-", "!", "=",
        "1e", "9", "deg", "\r", "\0", "/*", "#vol 2", "import ", "style ",
    ];
    let mut random = Lcg(42);
    for case in 0..6000 {
        let mut bytes = seeds[case % seeds.len()].as_bytes().to_vec();
        for _ in 0..1 + random.below(8) {
            let at = random.below(bytes.len());
            match random.below(5) {
                0 => drop(bytes.splice(at..at, pieces[random.below(pieces.len())].bytes())),
                1 => bytes.truncate(at.max(1)),
                2 => drop(bytes.drain(at..(at + random.below(12)).min(bytes.len()))),
                3 => {
                    let part = bytes[at..(at + random.below(40)).min(bytes.len())].to_vec();
                    let to = random.below(bytes.len());
                    drop(bytes.splice(to..to, part));
                }
                _ if !bytes.is_empty() => bytes[at] = random.below(256) as u8,
                _ => {}
            }
        }
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let (_, diagnostics) = read(&text);
        for fix in diagnostics.iter().flat_map(|diagnostic| &diagnostic.fixes) {
            assert_eq!(apply_all(&text, [fix]).1, 1, "{fix:?} is no repair of {text:?}");
            let _ = read(&fix.apply(&text));
        }
        let _ = human(&SourceFile::new("fuzz.vol", text).into(), &diagnostics, case % 2 == 0);
    }
}

#[test]
fn random_bytes_never_panic() {
    let mut random = Lcg(7);
    for _ in 0..2000 {
        let bytes: Vec<u8> =
            (0..random.below(80)).map(|_| b" \n(){}[]\"#/.,:=->!ailet1"[random.below(24)]).collect();
        let (items, _) = read(&String::from_utf8_lossy(&bytes));
        assert!(items.iter().all(|item| !matches!(item, ItemKind::Function(_))));
    }
}

#[test]
#[ignore = "prints timings; run it in release"]
fn timings() {
    let text = big_scene(1 << 20);
    let start = Instant::now();
    read_all(&text);
    println!("{} bytes of scene: {:?}", text.len(), start.elapsed());
    let list = format!("let a = [{}]", "(0.5, 1, 2), ".repeat(80_000));
    let start = Instant::now();
    read_all(&list);
    println!("{} bytes of list: {:?}", list.len(), start.elapsed());
    for (open, close) in [("(", ")"), ("f(a, ", ")"), ("{ a: ", "}"), ("{ let a = ", " a }"), ("(x => ", ")")]
    {
        let text = nested(open, "1", close, 64);
        let start = Instant::now();
        read_all(&text);
        println!("64 × {open}: {:?}", start.elapsed());
    }
}
