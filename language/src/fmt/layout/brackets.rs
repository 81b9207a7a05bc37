//! Brackets whose content does not fit on the line.

use super::Layout;
use crate::fmt::flat::{flat, flat_group};
use crate::fmt::lines::Blank;
use crate::fmt::tree::{Group, GroupKind, Node, Role};
use crate::fmt::{INDENT, LINE_WIDTH};

impl Layout<'_, '_> {
    /// Writes the content of brackets and the bracket that closes; the other is written.
    pub(super) fn group(&mut self, group: &Group, tail: usize) {
        let left = LINE_WIDTH.checked_sub(self.lines.column() + tail);
        if let Some(text) = left.and_then(|left| flat_group(self.tree, group, left)) {
            return self.lines.push(&text);
        }
        // In a block with `let`s a `-` at the start of a line is no operator.
        let is_minus_bound = group.has_let(&self.tree.pieces);
        let outside = std::mem::replace(&mut self.is_minus_bound, is_minus_bound);
        let indent = self.lines.indent();
        match group.kind {
            GroupKind::Paren if !self.has_inner_comments(group) => {
                self.nodes(&group.parts[0], 1 + tail);
                self.token(group.close);
            }
            GroupKind::List if self.can_hug(group) => self.hug(group, tail),
            GroupKind::Paren | GroupKind::List | GroupKind::Block => self.spread(group, indent),
            GroupKind::Record => self.record(group, indent),
        }
        self.is_minus_bound = outside;
    }

    /// Whether there are comments directly behind the opening or before the closing bracket.
    fn has_inner_comments(&self, group: &Group) -> bool {
        let has_comments = |piece: usize| self.tree.pieces[piece].has_comments();
        has_comments(group.close) || group.parts.first().is_some_and(|part| has_comments(part[0].piece))
    }

    /// Whether the last part ends in brackets of its own, whose content alone may get lines:
    /// `displace(p => {`, `union([`.
    fn can_hug(&self, group: &Group) -> bool {
        let pieces = &self.tree.pieces;
        let Some((last, others)) = group.parts.split_last() else { return false };
        let Some((braces, before)) = last.split_last() else { return false };
        let Some(inner) = &braces.group else { return false };
        let is_braces = matches!(inner.kind, GroupKind::Record | GroupKind::Block);
        let has_comments = |part: &Vec<Node>| pieces[part[0].piece].has_comments();
        if inner.parts.is_empty()
            || !(is_braces || others.is_empty() && before.is_empty())
            || group.parts.iter().any(has_comments)
            || pieces[braces.piece].has_comments()
            || pieces[group.close].has_comments()
        {
            return false;
        }
        let mut left = LINE_WIDTH.saturating_sub(self.lines.column() + " {".len());
        for nodes in others.iter().map(Vec::as_slice).chain([before]) {
            let Some(text) = flat(self.tree, nodes, left) else { return false };
            left = left.saturating_sub(text.chars().count() + ", ".len());
        }
        true
    }

    fn hug(&mut self, group: &Group, tail: usize) {
        for (i, part) in group.parts.iter().enumerate() {
            if i > 0 {
                self.lines.push(", ");
            }
            self.in_brackets(part, 1 + tail);
        }
        self.token(group.close);
    }

    /// Writes each part on a line.
    fn spread(&mut self, group: &Group, indent: usize) {
        let mut blank = Blank::KeepInside;
        for (i, part) in group.parts.iter().enumerate() {
            self.begin_line(part[0].piece, indent + INDENT, indent + INDENT, blank);
            let is_last = i + 1 == group.parts.len();
            let comma =
                if group.kind != GroupKind::Block && (!is_last || group.ends_with_comma) { "," } else { "" };
            self.nodes(part, comma.len());
            self.lines.push(comma);
            blank = Blank::Keep;
        }
        self.close(group, indent);
    }

    fn close(&mut self, group: &Group, indent: usize) {
        let blank = if group.parts.is_empty() { Blank::KeepInside } else { Blank::Drop };
        self.begin_line(group.close, indent + INDENT, indent, blank);
        self.token(group.close);
    }

    /// Writes each entry on a line, the values in a column as far as no blank line comes between.
    fn record(&mut self, group: &Group, indent: usize) {
        let mut blank = Blank::KeepInside;
        let mut rest = group.parts.as_slice();
        while !rest.is_empty() {
            let length = 1 + rest[1..].iter().take_while(|part| !self.follows_blank(&part[0])).count();
            let (section, after) = rest.split_at(length);
            rest = after;
            let key_width = |part: &Vec<Node>| self.tree.pieces[part[0].piece].text.chars().count();
            let widest = section.iter().map(key_width).max().unwrap_or(0);
            for part in section {
                self.begin_line(part[0].piece, indent + INDENT, indent + INDENT, blank);
                self.entry(part, widest - key_width(part));
                blank = Blank::Keep;
            }
        }
        self.close(group, indent);
    }

    /// Whether a blank line stands before the node or before a comment that belongs to it.
    fn follows_blank(&self, node: &Node) -> bool {
        let gap = &self.tree.pieces[node.piece].gap;
        gap.ends_blank || gap.comments.iter().any(|comment| comment.own_line && comment.after_blank)
    }

    /// Writes `key: value` with blanks between.
    fn entry(&mut self, part: &[Node], padding: usize) {
        let Some(value) = part.iter().position(|node| node.role == Role::Colon).map(|colon| colon + 1) else {
            return self.nodes(part, 0);
        };
        self.in_brackets(&part[..value], 0);
        let Some(first) = part.get(value) else { return };
        if !self.tree.pieces[first.piece].has_comments() {
            self.lines.push_blanks(padding);
        }
        self.advance(first);
        self.hang = Some(self.lines.column() + INDENT);
        self.nodes(&part[value..], 0);
        self.hang = None;
    }
}
