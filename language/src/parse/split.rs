//! Cuts a file into items, and scene blocks into entries, along the guard's tokens.

use super::Source;
use super::scan::{Kind, Token};
use crate::source::Span;

/// One item: its tokens (at least one) and the doc comment before it.
pub(super) struct RawItem<'a> {
    pub(super) tokens: &'a [Token],
    pub(super) doc: String,
}

impl RawItem<'_> {
    pub(super) fn span(&self) -> Span {
        cover(self.tokens)
    }
}

/// From the first token to the last; there is at least one.
pub(super) fn cover(tokens: &[Token]) -> Span {
    match (tokens.first(), tokens.last()) {
        (Some(first), Some(last)) => first.span().to(last.span()),
        _ => Span::default(),
    }
}

/// The items of a file, in order.
pub(super) fn items<'a>(source: &'a Source<'a>) -> impl Iterator<Item = RawItem<'a>> {
    let mut rest = source.tokens;
    let mut docs = source.docs;
    std::iter::from_fn(move || {
        let first = rest.first()?;
        let length = 1 + rest[1..].iter().take_while(|token| !token.starts_item).count();
        let (tokens, after) = rest.split_at(length);
        rest = after;
        let (before, others) = docs.split_at(docs.partition_point(|doc| doc.start < first.start));
        let end = cover(tokens).end;
        docs = &others[others.partition_point(|doc| doc.start < end)..];
        Some(RawItem { tokens, doc: doc_text(source.text, before) })
    })
}

fn doc_text(text: &str, lines: &[Span]) -> String {
    let lines = lines.iter().map(|line| {
        let line = &text[line.start as usize + "///".len()..line.end as usize];
        line.strip_prefix(' ').unwrap_or(line).trim_end()
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// A stretch of a block's inside between separators.
pub(super) struct RawEntry<'a> {
    /// Its tokens; empty if there are two commas in a row.
    pub(super) tokens: &'a [Token],
    /// What separates it from the entry before.
    pub(super) separator: Separator,
    /// Where to point if it is empty: the comma after it.
    pub(super) end: Span,
}

/// What stands between two entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Separator {
    /// Nothing but the bracket that opens the block.
    Start,
    Comma,
    Line,
    /// They share a line without a comma.
    Missing,
}

/// The entries between the brackets of a scene block.
pub(super) fn entries<'a>(text: &str, inside: &'a [Token]) -> Vec<RawEntry<'a>> {
    let mut entries = Vec::new();
    let depth = 1;
    let is = |token: &Token, symbol: &str| token.depth == depth && token.text(text) == symbol;
    let mut start = 0;
    let mut separator = Separator::Start;
    // Loops whose `:` is still to come: `iterate 9 from (a = 1) while a < limit: (a = 2 * a)`.
    let mut loops = 0;
    for (i, token) in inside.iter().enumerate() {
        if is(token, "iterate") {
            loops += 1;
        } else if is(token, ":") && loops > 0 {
            loops -= 1;
        }
        let key = i > start
            && token.kind == Kind::Word
            && token.depth == depth
            && (loops == 0 || token.starts_line)
            && inside.get(i + 1).is_some_and(|next| is(next, ":"));
        if key {
            loops = 0;
        }
        let comma = is(token, ",");
        if key || comma {
            entries.push(RawEntry { tokens: &inside[start..i], separator, end: token.span() });
            start = i + usize::from(comma);
            separator = match (comma, token.starts_line) {
                (true, _) => Separator::Comma,
                (false, true) => Separator::Line,
                (false, false) => Separator::Missing,
            };
        }
    }
    if start < inside.len() {
        let tokens = &inside[start..];
        entries.push(RawEntry { tokens, separator, end: cover(tokens) });
    }
    entries
}
