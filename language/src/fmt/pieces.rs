//! A text as tokens with what stands between them.

use crate::parse::scan::{Kind, Token};

/// A comment, or the `#vol` line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Comment<'a> {
    /// With its slashes, without blanks around it.
    pub(super) text: &'a str,
    /// Whether nothing but blanks stands before it on its line.
    pub(super) own_line: bool,
    /// Whether a blank line stands before it.
    pub(super) after_blank: bool,
}

/// What stands between two tokens.
#[derive(Clone, Debug, Default)]
pub(super) struct Gap<'a> {
    pub(super) comments: Vec<Comment<'a>>,
    /// Whether a line ends in it.
    pub(super) has_line_end: bool,
    /// Whether it ends with a blank line.
    pub(super) ends_blank: bool,
}

/// A token and the gap before it.
#[derive(Clone, Debug)]
pub(super) struct Piece<'a> {
    pub(super) gap: Gap<'a>,
    pub(super) text: &'a str,
    pub(super) kind: Kind,
    /// Offset in the text.
    pub(super) start: u32,
    pub(super) starts_item: bool,
}

impl Piece<'_> {
    pub(super) fn has_comments(&self) -> bool {
        !self.gap.comments.is_empty()
    }
}

/// The tokens of a text and the gap after the last one.
pub(super) fn pieces<'a>(text: &'a str, tokens: &[Token]) -> (Vec<Piece<'a>>, Gap<'a>) {
    let mut end = 0;
    let mut pieces = Vec::with_capacity(tokens.len());
    for token in tokens {
        pieces.push(Piece {
            gap: gap(&text[end..token.start as usize], end == 0),
            text: token.text(text),
            kind: token.kind,
            start: token.start,
            starts_item: token.starts_item,
        });
        end = token.end as usize;
    }
    (pieces, gap(&text[end..], end == 0))
}

/// Reads a text of blanks and comments.
fn gap(text: &str, starts_file: bool) -> Gap<'_> {
    let mut gap = Gap { has_line_end: text.contains('\n'), ..Gap::default() };
    let mut line_ends = usize::from(starts_file);
    for (i, line) in text.split('\n').enumerate() {
        line_ends += usize::from(i > 0);
        let text = line.trim();
        if !text.is_empty() {
            gap.comments.push(Comment { text, own_line: line_ends > 0, after_blank: line_ends > 1 });
            line_ends = 0;
        }
    }
    gap.ends_blank = line_ends > 1;
    gap
}

/// The comments of a text, in order.
pub(super) fn comments<'p>(pieces: &'p [Piece<'_>], end: &'p Gap<'_>) -> impl Iterator<Item = &'p str> {
    let gaps = pieces.iter().map(|piece| &piece.gap).chain([end]);
    gaps.flat_map(|gap| gap.comments.iter().map(|comment| comment.text))
}
