//! The text that is being written, line by line.

use super::pieces::Gap;

/// What becomes of blank lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Blank {
    /// One is kept.
    Keep,
    /// One is kept, but not before the first line.
    KeepInside,
    /// None is kept before the token, one between comments.
    Drop,
}

#[derive(Default)]
struct Line<'a> {
    indent: usize,
    code: String,
    comment: Option<&'a str>,
}

/// Blanks between code and the longest line's comment.
const COMMENT_DISTANCE: usize = 2;

/// The lines so far; the last one is being written.
#[derive(Default)]
pub(super) struct Lines<'a> {
    done: Vec<Line<'a>>,
    current: Line<'a>,
    width: usize,
}

impl<'a> Lines<'a> {
    /// Characters on the current line.
    pub(super) fn column(&self) -> usize {
        self.width
    }

    /// Blanks that the current line begins with.
    pub(super) fn indent(&self) -> usize {
        self.current.indent
    }

    /// Whether nothing is on the current line yet.
    pub(super) fn is_at_indent(&self) -> bool {
        self.width == self.current.indent
    }

    pub(super) fn push(&mut self, text: &str) {
        self.current.code.push_str(text);
        self.width += text.chars().count();
    }

    pub(super) fn push_blanks(&mut self, count: usize) {
        self.current.code.extend(std::iter::repeat_n(' ', count));
        self.width += count;
    }

    /// Begins a new line for the token behind `gap`, after the comments in it.
    pub(super) fn begin(&mut self, gap: &Gap<'a>, comment_indent: usize, indent: usize, blank: Blank) {
        let mut is_first = blank == Blank::KeepInside || self.is_empty();
        for (i, comment) in gap.comments.iter().enumerate() {
            if i == 0 && !comment.own_line && !self.is_empty() {
                self.current.comment = Some(comment.text);
                continue;
            }
            self.next(comment_indent, comment.after_blank && !is_first);
            self.current.code.push_str(comment.text);
            is_first = false;
        }
        self.next(indent, gap.ends_blank && blank != Blank::Drop && !is_first);
    }

    fn is_empty(&self) -> bool {
        self.done.is_empty() && self.current.code.is_empty()
    }

    fn next(&mut self, indent: usize, after_blank: bool) {
        if !self.is_empty() {
            self.done.push(std::mem::take(&mut self.current));
        }
        if after_blank {
            self.done.push(Line::default());
        }
        self.current.indent = indent;
        self.width = indent;
    }

    /// The whole text; comments behind code on lines one after the other stand in a column.
    pub(super) fn finish(mut self, end: &Gap<'a>) -> String {
        self.begin(end, 0, 0, Blank::Drop);
        let mut text = String::new();
        let mut rest = self.done.as_slice();
        while let Some(first) = rest.first() {
            let in_column = |line: &&Line<'_>| line.comment.is_some() && line.indent == first.indent;
            let length = rest.iter().take_while(in_column).count().max(1);
            let (column, after) = rest.split_at(length);
            rest = after;
            let width = |line: &Line<'_>| line.code.chars().count();
            let widest = column.iter().map(width).max().unwrap_or(0);
            for line in column {
                if !line.code.is_empty() {
                    text.extend(std::iter::repeat_n(' ', line.indent));
                    text.push_str(&line.code);
                }
                if let Some(comment) = line.comment {
                    text.extend(std::iter::repeat_n(' ', widest - width(line) + COMMENT_DISTANCE));
                    text.push_str(comment);
                }
                text.push('\n');
            }
        }
        text
    }
}
