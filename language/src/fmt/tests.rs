//! Tests of the formatter: each rule before and after, and what holds for every scene.

mod programs;
mod rules;

use super::{FormatError, format};
use crate::parse::parse;
use crate::source::SourceFile;

fn source(text: &str) -> SourceFile {
    SourceFile::new("test.vol", text)
}

/// Whether the text has no syntax errors. Then its formatted text must have the same tree and
/// comments and be formatted already.
#[track_caller]
fn check(text: &str) -> bool {
    let formatted = match format(&source(text)) {
        Ok(formatted) => formatted,
        Err(FormatError::Syntax(diagnostics)) => {
            assert!(!diagnostics.is_empty());
            return false;
        }
        Err(FormatError::Damaged) => panic!("damaged:\n{text}"),
    };
    assert_eq!(printed(text), printed(&formatted), "{text}\n→\n{formatted}");
    assert_eq!(comments(text), comments(&formatted), "{text}\n→\n{formatted}");
    let again = format(&source(&formatted));
    assert_eq!(
        again.as_deref(),
        Ok(formatted.as_str()),
        "{text}\n→\n{formatted}\n→\n{}",
        again.as_deref().unwrap_or("error")
    );
    assert!(
        formatted.lines().all(|line| line.trim_end() == line) && !formatted.contains('\r'),
        "{formatted:?}"
    );
    true
}

/// The tree as text without the numbers in its spans.
fn printed(text: &str) -> String {
    let (file, diagnostics) = parse(&source(text));
    assert!(diagnostics.is_empty(), "{text}: {diagnostics:?}");
    let printed = format!("{file:?}");
    let mut rest = printed.as_str();
    let mut without = String::new();
    while let Some((before, after)) = rest.split_once("Span {") {
        without += before;
        rest = after.split_once('}').map_or("", |(_, after)| after);
    }
    without + rest
}

/// The comments, found by looking for slashes outside of strings.
fn comments(text: &str) -> Vec<&str> {
    let comment = |line: &'_ str| {
        let (mut in_string, mut escaped) = (false, false);
        line.bytes().enumerate().position(|(i, byte)| {
            let is_quote = byte == b'"' && !escaped;
            escaped = in_string && byte == b'\\' && !escaped;
            in_string ^= is_quote;
            !in_string && line.as_bytes()[i..].starts_with(b"//")
        })
    };
    text.lines().filter_map(|line| comment(line).map(|at| line[at..].trim_end())).collect()
}
