//! Properties that hold for any input.

use crate::spec;
use crate::support::{compile_with_messages, ensure, scenes_in};
use libtest_mimic::{Failed, Trial};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use vol_compiler::ir::text;
use vol_compiler::ir::verify::random::{Shape, function};
use vol_language::fmt::{self, FormatError};
use vol_language::source::SourceFile;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("properties::any_text_is_answered", any_text_is_answered),
        Trial::test("properties::any_tokens_are_answered", any_tokens_are_answered),
        Trial::test("properties::ir_text_reads_back", ir_text_reads_back),
        Trial::test("properties::formatted_scenes_are_the_same_scenes", formatted_scenes),
        Trial::test("properties::any_tokens_are_formatted_or_refused", any_tokens_are_formatted),
    ]
}

fn runner(cases: u32) -> TestRunner {
    // The same cases each time; a failure is shrunk and shown, not stored.
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    TestRunner::new_with_rng(
        config,
        proptest::test_runner::TestRng::deterministic_rng(proptest::test_runner::RngAlgorithm::ChaCha),
    )
}

fn check<T>(result: Result<(), T>) -> Result<(), Failed>
where
    T: std::fmt::Display,
{
    result.map_err(|error| error.to_string().into())
}

/// Whatever the text, there is a program or a message.
fn answered(source: &str) -> Result<(), TestCaseError> {
    let (program, messages) = compile_with_messages("any.vol", source);
    prop_assert!(program.is_some() || !messages.is_empty(), "neither a program nor a message");
    Ok(())
}

fn any_text_is_answered() -> Result<(), Failed> {
    check(runner(300).run(&"\\PC{0,200}", |source| answered(&source)))
}

/// Real tokens get further than random characters.
const TOKENS: &[&str] = &[
    "param",
    "let",
    "fn",
    "object",
    "medium",
    "light",
    "camera",
    "render",
    "a",
    "b",
    "q",
    "=>",
    "->",
    "=",
    ":",
    ",",
    "(",
    ")",
    "{",
    "}",
    "[",
    "]",
    "+",
    "-",
    "*",
    "/",
    "|",
    "&",
    "<",
    "if",
    "then",
    "else",
    "for",
    "in",
    "..",
    "1",
    "0.5",
    "45deg",
    "#fff",
    "\"x\"",
    "float",
    "vec3",
    "shape",
    "sphere",
    "fbm",
    "q.local",
    ".x",
    "time",
    "\n",
    "shape:",
    "region:",
    "density:",
    "(0, 1, 0)",
    "sphere(1)",
    "a =>",
    "true",
];

fn any_tokens_are_answered() -> Result<(), Failed> {
    let tokens = proptest::collection::vec(proptest::sample::select(TOKENS), 0..60);
    check(runner(600).run(&tokens, |tokens| answered(&tokens.join(" "))))
}

/// A text without syntax errors is formatted, and stays as it is when it is formatted again. Whether
/// it was formatted. That the tree is the same is checked by the formatter, and again in its own tests.
fn is_formatted(source: &str) -> Result<bool, String> {
    let format = |text: &str| fmt::format(&SourceFile::new("any.vol", text));
    let once = match format(source) {
        Ok(text) => text,
        Err(FormatError::Syntax(_)) => return Ok(false),
        Err(error @ FormatError::Damaged) => return Err(format!("{error}:\n{source}")),
    };
    match format(&once) {
        Ok(twice) if twice == once => Ok(true),
        other => Err(format!("not stable:\n{source}\n→\n{once}\n→\n{other:?}")),
    }
}

/// The scenes of the repository and of its pages, which are written by hand.
fn formatted_scenes() -> Result<(), Failed> {
    let mut formatted = 0;
    for (name, path) in scenes_in("examples").into_iter().chain(scenes_in("tests/ui")) {
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{name}: {error}"))?;
        // Also with other line ends, and more of them.
        for variant in [text.clone(), text.replace('\n', "\r\n"), text.replace(", ", ",\n")] {
            formatted += usize::from(is_formatted(&variant).map_err(|error| format!("{name}: {error}"))?);
        }
    }
    for (page, line, block) in spec::all_blocks() {
        let found = is_formatted(&block).map_err(|error| format!("{page}:{line}: {error}"))?;
        ensure(found, || format!("{page}:{line} has syntax errors"))?;
        formatted += 1;
    }
    ensure(formatted > 300, || format!("only {formatted} scenes were formatted"))
}

fn any_tokens_are_formatted() -> Result<(), Failed> {
    let tokens = proptest::collection::vec(proptest::sample::select(TOKENS), 0..30);
    check(runner(3000).run(&tokens, |tokens| {
        let formatted = is_formatted(&format!("let a = {}", tokens.join(" ")));
        formatted.map(drop).map_err(TestCaseError::fail)
    }))
}

fn ir_text_reads_back() -> Result<(), Failed> {
    check(runner(200).run(&any::<u64>(), |seed| {
        let written = function(seed, &Shape::default());
        let read = text::parse_function(&text::print_function(&written));
        prop_assert_eq!(read.ok(), Some(written));
        Ok(())
    }))
}
