//! The items of a file, one after the other.

use super::LINE_WIDTH;
use super::flat::flat;
use super::layout::Layout;
use super::lines::{Blank, Lines};
use super::tree::{GroupKind, Node, Role, Tree};

/// Writes a file.
pub(super) fn file(tree: &Tree<'_>) -> String {
    // Items are not in brackets; a `-` at the start of a line continues none.
    let mut layout = Layout { tree, lines: Lines::default(), hang: None, is_minus_bound: true };
    for (item, header) in tree.items.iter().zip(header_widths(tree)) {
        layout.begin_line(item[0].piece, 0, 0, Blank::Keep);
        match (header, item.split_last()) {
            (Some(width), Some((_, head))) => {
                layout.in_brackets(head, 0);
                let padding = width.saturating_sub(layout.lines.column());
                layout.lines.push_blanks(padding);
                layout.advance(&item[head.len()]);
                layout.nodes(&item[head.len()..], 0);
            }
            _ => layout.nodes(item, 0),
        }
    }
    layout.lines.finish(&tree.end)
}

/// For each item the column at which its braces begin, less one: blocks of one line each that
/// follow each other have them in a column.
fn header_widths(tree: &Tree<'_>) -> Vec<Option<usize>> {
    let mut widths = vec![None; tree.items.len()];
    let mut start = 0;
    while start < tree.items.len() {
        let is_neighbour = |item: &&Vec<Node>| follows_directly(tree, item) && one_line(tree, item).is_some();
        let length = 1 + tree.items[start + 1..].iter().take_while(is_neighbour).count();
        let run = &tree.items[start..start + length];
        let parts: Option<Vec<(usize, usize)>> = run.iter().map(|item| one_line(tree, item)).collect();
        if let Some(parts) = parts {
            let widest = parts.iter().map(|(header, _)| *header).max().unwrap_or(0);
            if parts.iter().all(|(header, whole)| whole + (widest - header) <= LINE_WIDTH) {
                widths[start..start + length].fill(Some(widest));
            }
        }
        start += length;
    }
    widths
}

/// Whether an item begins on the line after the one before it.
fn follows_directly(tree: &Tree<'_>, item: &[Node]) -> bool {
    let gap = &tree.pieces[item[0].piece].gap;
    !gap.ends_blank && gap.comments.len() < 2 && !gap.comments.iter().any(|comment| comment.own_line)
}

/// Width of the header and of the whole, if an item is a scene block that fits on one line.
fn one_line(tree: &Tree<'_>, item: &[Node]) -> Option<(usize, usize)> {
    let (braces, head) = item.split_last()?;
    let is_record = braces.group.as_ref().is_some_and(|group| group.kind == GroupKind::Record);
    let is_head = |node: &Node| matches!(node.role, Role::Operand | Role::Keyword) && node.group.is_none();
    if !is_record || head.len() > 2 || !head.iter().all(is_head) {
        return None;
    }
    let width = |nodes: &[Node]| flat(tree, nodes, LINE_WIDTH).map(|text| text.chars().count());
    Some((width(head)?, width(item)?))
}
