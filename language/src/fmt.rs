//! The formatter: the one way in which a scene is laid out.
//!
//! ```text
//! text ──parse──► ast ─┐
//!   └──► tokens, gaps ─┴─tree──► brackets and parts ──layout──► lines ──► text
//! ```
//!
//! It moves blanks, the ends of lines, and commas at the ends of lines. Every other token and every
//! comment stays as it was written, in the same order. The layout depends on the tokens, the
//! comments, blank lines and on whether the content of braces was written on one line; so a
//! formatted text stays as it is.
//!
//! The result is parsed again: a text that would mean something else is never handed out.

mod flat;
mod items;
mod layout;
mod lines;
mod pieces;
#[cfg(test)]
mod tests;
mod tree;

use crate::ast::spans::{Role, each_span};
use crate::diag::Diagnostic;
use crate::parse::{self, parse};
use crate::source::{SourceFile, Span};
use std::collections::HashSet;
use std::fmt;

/// Most characters on a line, but for comments, long words and what cannot be cut.
pub const LINE_WIDTH: usize = 100;

/// Blanks by which a line stands further in than the one that it belongs to.
const INDENT: usize = 2;

/// Why a text cannot be formatted.
#[derive(Clone, Debug, PartialEq)]
pub enum FormatError {
    /// It has syntax errors, and these are they.
    Syntax(Vec<Diagnostic>),
    /// The formatted text would mean something else or lose a comment: a mistake of the formatter.
    Damaged,
}

impl fmt::Display for FormatError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax(_) => write!(f, "the scene has syntax errors"),
            Self::Damaged => write!(f, "the formatted scene would not be the same scene"),
        }
    }
}

impl std::error::Error for FormatError {}

/// Lays out a scene text.
///
/// Lines end with `\n`, also the last one; indents are two blanks. A line has at most
/// [`LINE_WIDTH`] characters where it can be cut. Of several blank lines one stays.
///
/// # Errors
/// [`FormatError`]; there is no formatted text then.
pub fn format(file: &SourceFile) -> Result<String, FormatError> {
    let (mut ast, diagnostics) = parse(file);
    if diagnostics.iter().any(Diagnostic::is_error) {
        return Err(FormatError::Syntax(diagnostics));
    }
    let mut part_starts = HashSet::new();
    each_span(&mut ast, &mut |role, span| {
        if role == Role::Part {
            part_starts.insert(span.start);
        }
    });
    let (pieces, end) = pieces::pieces(&file.text, &parse::tokens(&file.text));
    let tree = tree::tree(pieces, end, &part_starts);
    let formatted = SourceFile::new(file.name.clone(), items::file(&tree));
    if is_faithful(file, &formatted) { Ok(formatted.text) } else { Err(FormatError::Damaged) }
}

/// Whether both texts are free of syntax errors and have the same tree, but for places, and the
/// same comments.
fn is_faithful(file: &SourceFile, formatted: &SourceFile) -> bool {
    let meaning = |file: &SourceFile| {
        let (mut ast, diagnostics) = parse(file);
        each_span(&mut ast, &mut |_, span| *span = Span::default());
        (!diagnostics.iter().any(Diagnostic::is_error)).then_some(ast)
    };
    let comments = |file: &SourceFile| {
        let (pieces, end) = pieces::pieces(&file.text, &parse::tokens(&file.text));
        pieces::comments(&pieces, &end).map(str::to_owned).collect::<Vec<_>>()
    };
    comments(file) == comments(formatted) && meaning(file).is_some_and(|ast| meaning(formatted) == Some(ast))
}
