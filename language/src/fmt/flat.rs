//! Nodes on one line.

use super::tree::{Group, GroupKind, Node, Tree};

/// The nodes on one line of at most `limit` characters; none if that is too short, or if something
/// among them needs lines of its own. Comments before the first node are not its business.
pub(super) fn flat(tree: &Tree<'_>, nodes: &[Node], limit: usize) -> Option<String> {
    let mut line = Line { tree, text: String::new(), left: limit };
    line.nodes(nodes, true).then_some(line.text)
}

/// The content of brackets and the bracket that closes, as [`flat`].
pub(super) fn flat_group(tree: &Tree<'_>, group: &Group, limit: usize) -> Option<String> {
    let mut line = Line { tree, text: String::new(), left: limit };
    line.group(group).then_some(line.text)
}

/// Fewest characters that the nodes take on the line where they begin: up to the first bracket that
/// can end the line, or `tail` more than all of them.
pub(super) fn least_width(tree: &Tree<'_>, nodes: &[Node], tail: usize) -> usize {
    let mut width = 0;
    for node in nodes {
        width += usize::from(node.space) + tree.pieces[node.piece].text.chars().count();
        match &node.group {
            Some(group) if group.parts.is_empty() => width += 1,
            Some(_) => return width,
            None => {}
        }
    }
    width + tail
}

struct Line<'t, 'a> {
    tree: &'t Tree<'a>,
    text: String,
    /// Characters that the line still takes.
    left: usize,
}

/// All methods return whether the line took it.
impl Line<'_, '_> {
    fn push(&mut self, text: &str) -> bool {
        let count = text.chars().count();
        self.text.push_str(text);
        let fits = count <= self.left;
        self.left = self.left.saturating_sub(count);
        fits
    }

    fn nodes(&mut self, nodes: &[Node], at_start: bool) -> bool {
        nodes.iter().enumerate().all(|(i, node)| self.node(node, at_start && i == 0))
    }

    fn node(&mut self, node: &Node, at_start: bool) -> bool {
        let piece = &self.tree.pieces[node.piece];
        (at_start || !piece.has_comments() && (!node.space || self.push(" ")))
            && self.push(piece.text)
            && node.group.as_ref().is_none_or(|group| self.group(group))
    }

    fn group(&mut self, group: &Group) -> bool {
        let close = &self.tree.pieces[group.close];
        if group.is_spread || close.has_comments() {
            return false;
        }
        let (inner, separator) = match group.kind {
            GroupKind::Paren | GroupKind::List => ("", ", "),
            GroupKind::Record => (" ", ", "),
            GroupKind::Block => (" ", "  "),
        };
        let inner = if group.parts.is_empty() { "" } else { inner };
        let parts = group.parts.iter().enumerate().all(|(i, part)| {
            let has_comments = self.tree.pieces[part[0].piece].has_comments();
            !has_comments && self.push(if i == 0 { inner } else { separator }) && self.nodes(part, true)
        });
        parts && self.push(inner) && self.push(close.text)
    }
}
