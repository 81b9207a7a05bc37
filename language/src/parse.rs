//! The parser: text in, untyped tree out.
//!
//! ```text
//! text ──scan──► tokens, mask ──guard──► checked ──split──► items, entries ──lower──► ast::File
//! ```
//!
//! Items, and the entries of scene blocks, are read one by one, so that one run reports the syntax
//! errors of all of them. Any text gives a tree and messages: the guard bounds how deep the
//! grammar and every later walk over the tree can recurse.

pub mod explain;
mod guard;
mod lower;
pub(crate) mod scan;
mod split;
#[cfg(test)]
mod tests;

use crate::ast;
use crate::diag::Diagnostic;
use crate::source::{MAX_SOURCE_BYTES, SourceFile, Span};

/// Most brackets inside each other.
pub const MAX_NESTING: usize = 128;

/// Height of the highest tree that stands for an expression, counted in operators, calls, lists
/// and whatever else holds expressions. Walks over the tree may recurse this deep.
pub const MAX_DEPTH: usize = 256;

/// Syntax errors after which the parser gives up; a person reads fewer.
const MAX_ERRORS: usize = 100;

/// Reads a file.
///
/// The tree holds the items without syntax errors. Never panics, on any text.
#[must_use]
pub fn parse(file: &SourceFile) -> (ast::File, Vec<Diagnostic>) {
    let text = file.text.as_str();
    if text.len() > MAX_SOURCE_BYTES {
        return (ast::File::default(), vec![explain::file_too_large(text.len())]);
    }
    let mut report = Report::default();
    let mut scan = scan::scan(text, &mut report);
    guard::guard(text, &mut scan, &mut report);
    report.broken.sort_unstable();
    let mask = String::from_utf8(scan.mask).expect("the scanner replaces whole characters by ASCII");
    let source = Source { text, mask: &mask, tokens: &scan.tokens, docs: &scan.docs };
    let mut items = Vec::new();
    for raw in split::items(&source) {
        if report.is_full() {
            break;
        }
        let before = report.errors;
        let kind = lower::item(&source, raw.tokens, &mut report);
        if let Some(kind) = kind.filter(|_| report.errors == before) {
            items.push(ast::Item { kind, span: raw.span(), doc: raw.doc });
        }
    }
    report
        .diagnostics
        .sort_by_key(|diagnostic| diagnostic.labels.first().map_or(0, |label| label.span.start));
    (ast::File { items }, report.diagnostics)
}

/// The tokens of a text, with the marks of the guard; what is wrong with it is not said.
pub(crate) fn tokens(text: &str) -> Vec<scan::Token> {
    let mut report = Report::default();
    let mut scan = scan::scan(text, &mut report);
    guard::guard(text, &mut scan, &mut report);
    scan.tokens
}

/// What all parts of the parser read.
struct Source<'a> {
    text: &'a str,
    /// The text as the grammar sees it; see [`scan`].
    mask: &'a str,
    tokens: &'a [scan::Token],
    docs: &'a [Span],
}

/// Errors found so far.
#[derive(Default)]
struct Report {
    diagnostics: Vec<Diagnostic>,
    /// How many of them are errors, those past the limit included.
    errors: usize,
    /// Offsets of errors that make the grammar's opinion on their surroundings worthless.
    broken: Vec<u32>,
}

impl Report {
    fn is_full(&self) -> bool {
        self.diagnostics.len() > MAX_ERRORS
    }

    fn add(&mut self, diagnostic: Diagnostic) {
        self.errors += usize::from(diagnostic.is_error());
        if self.diagnostics.len() < MAX_ERRORS {
            self.diagnostics.push(diagnostic);
        } else if !self.is_full() {
            let end = diagnostic.labels.first().map_or(Span::default(), |label| label.span);
            self.diagnostics.push(explain::too_many_errors(end, MAX_ERRORS));
        }
    }

    /// Adds an error that spoils the item or entry around `span`.
    fn add_breaking(&mut self, span: Span, explain: impl FnOnce() -> Diagnostic) {
        self.break_at(span);
        if !self.is_full() {
            self.add(explain());
        }
    }

    fn break_at(&mut self, span: Span) {
        self.broken.push(span.start);
    }

    /// Whether an error spoils the text in `span`.
    fn is_broken(&self, span: Span) -> bool {
        let next = self.broken.partition_point(|&at| at < span.start);
        self.broken.get(next).is_some_and(|&at| at < span.end)
    }
}
