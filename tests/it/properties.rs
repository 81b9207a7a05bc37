//! Properties that hold for any input.

use crate::support::compile_with_messages;
use libtest_mimic::{Failed, Trial};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use vol_compiler::ir::text;
use vol_compiler::ir::verify::random::{Shape, function};

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("properties::any_text_is_answered", any_text_is_answered),
        Trial::test("properties::any_tokens_are_answered", any_tokens_are_answered),
        Trial::test("properties::ir_text_reads_back", ir_text_reads_back),
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

/// Texts of real tokens get further than random characters.
fn any_tokens_are_answered() -> Result<(), Failed> {
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
    let tokens = proptest::collection::vec(proptest::sample::select(TOKENS), 0..60);
    check(runner(600).run(&tokens, |tokens| answered(&tokens.join(" "))))
}

fn ir_text_reads_back() -> Result<(), Failed> {
    check(runner(200).run(&any::<u64>(), |seed| {
        let written = function(seed, &Shape::default());
        let read = text::parse_function(&text::print_function(&written));
        prop_assert_eq!(read.ok(), Some(written));
        Ok(())
    }))
}
