//! Nodes that don't fit on one line: where lines end.
//!
//! What fits on the rest of the line stays on it. What doesn't is cut at its loosest place: the
//! branches of an `if`, the loosest operators, the calls of a chain, and else within its brackets,
//! the first that don't fit first.
//!
//! A line never begins with what would then mean something else (see `parse/guard.rs`): a `(` only
//! begins a line at the start of a part, and where a `-` would not continue the line above, the
//! operators stand at the ends of lines.

mod brackets;

use super::flat::{flat, least_width};
use super::lines::{Blank, Lines};
use super::tree::{Node, Role, Tree};
use super::{INDENT, LINE_WIDTH};

pub(super) struct Layout<'t, 'a> {
    pub(super) tree: &'t Tree<'a>,
    pub(super) lines: Lines<'a>,
    /// Where lines continue the value that began on the current line, if not one step further than
    /// that line.
    pub(super) hang: Option<usize>,
    /// Whether a `-` at the start of a line is no operator here.
    pub(super) is_minus_bound: bool,
}

/// How nodes can be cut.
enum Cut {
    /// Only behind the first few.
    Head(usize),
    If,
    /// Before operators of this precedence, among the first few nodes.
    Infix(u8, usize),
    /// Before these dots.
    Chain(Vec<usize>),
    Brackets,
}

impl<'t, 'a> Layout<'t, 'a> {
    /// Writes nodes, with `tail` characters behind them on the last line. The first begins where
    /// the line has got to.
    pub(super) fn nodes(&mut self, nodes: &[Node], tail: usize) {
        if nodes.is_empty() {
            return;
        }
        if let Some(text) = self.fitting(nodes, tail) {
            return self.lines.push(&text);
        }
        match self.cut(nodes) {
            Cut::Head(length) => {
                self.in_brackets(&nodes[..length], 0);
                self.advance(&nodes[length]);
                self.nodes(&nodes[length..], tail);
            }
            Cut::If => self.branches(nodes, tail),
            Cut::Infix(precedence, limit) => self.operands(nodes, precedence, limit, tail),
            Cut::Chain(dots) => self.chain(nodes, &dots, tail),
            Cut::Brackets => self.in_brackets(nodes, tail),
        }
    }

    fn cut(&self, nodes: &[Node]) -> Cut {
        let is_word = |i: usize, word: &str| {
            nodes[i].role == Role::Keyword && self.tree.pieces[nodes[i].piece].text == word
        };
        let opens = |i: &usize| {
            matches!(nodes[*i].role, Role::Equals | Role::Colon | Role::FatArrow)
                || is_word(*i, "if")
                || is_word(*i, "iterate")
        };
        let opening = (0..nodes.len()).find(opens);
        // Where what reaches to the end begins; operators before it are looser.
        let mut limit = opening.unwrap_or(nodes.len());
        if let Some(i) = opening {
            let is_last = i + 1 == nodes.len();
            match nodes[i].role {
                Role::Equals | Role::Colon if !is_last => return Cut::Head(i + 1),
                Role::FatArrow if i == 1 && !is_last => return Cut::Head(2),
                Role::FatArrow => limit = i - 1,
                _ if i == 0 && is_word(0, "if") => return Cut::If,
                _ if i == 0 => {
                    let colon = nodes.iter().position(|node| node.role == Role::Colon);
                    return colon
                        .filter(|at| at + 1 < nodes.len())
                        .map_or(Cut::Brackets, |at| Cut::Head(at + 1));
                }
                _ => {}
            }
        }
        let loosest = nodes[..limit].iter().filter_map(|node| match node.role {
            Role::Infix(precedence) => Some(precedence),
            _ => None,
        });
        if let Some(precedence) = loosest.min() {
            return Cut::Infix(precedence, limit);
        }
        if nodes.len() > 1 && (nodes[0].role == Role::Prefix || is_word(0, "else") || is_word(0, "then")) {
            return Cut::Head(1);
        }
        let is_operand = |node: &Node| matches!(node.role, Role::Operand | Role::Dot);
        let dots = if nodes.iter().all(is_operand) { self.method_calls(nodes) } else { Vec::new() };
        if dots.is_empty() { Cut::Brackets } else { Cut::Chain(dots) }
    }

    /// The dots before the methods of a chain, if it is to be cut there.
    fn method_calls(&self, nodes: &[Node]) -> Vec<usize> {
        let is_call = |i: &usize| {
            nodes[*i].role == Role::Dot && nodes.get(i + 2).is_some_and(|node| node.group.is_some())
        };
        let dots: Vec<usize> = (1..nodes.len()).filter(is_call).collect();
        let Some(&first) = dots.first() else { return dots };
        let ends = dots.iter().skip(1).copied().chain([nodes.len()]);
        let width = LINE_WIDTH.saturating_sub(self.hang() + 2);
        let fits = |(start, end): (usize, usize)| flat(self.tree, &nodes[start..end], width).is_some();
        let is_worth_it = if dots.len() < 3 {
            // `q.f(…)` would leave a lone `q` on its line.
            (dots.len() > 1 || first > 1) && dots.iter().copied().zip(ends).all(fits)
        } else {
            true
        };
        if is_worth_it && self.fitting(&nodes[..first], 0).is_some() { dots } else { Vec::new() }
    }

    /// The nodes as text, if the line takes them.
    pub(super) fn fitting(&self, nodes: &[Node], tail: usize) -> Option<String> {
        flat(self.tree, nodes, LINE_WIDTH.checked_sub(self.lines.column() + tail)?)
    }

    /// Where the next line of the value on the current line begins.
    fn hang(&self) -> usize {
        self.hang.unwrap_or(self.lines.indent() + INDENT)
    }

    /// Goes on to a node: a blank, or a new line if there are comments before it.
    pub(super) fn advance(&mut self, node: &Node) {
        if self.tree.pieces[node.piece].has_comments() {
            self.break_before(node, self.hang());
        } else if node.space {
            self.lines.push(" ");
        }
    }

    /// Begins a line within a value.
    fn break_before(&mut self, node: &Node, indent: usize) {
        self.begin_line(node.piece, indent, indent, Blank::Drop);
    }

    pub(super) fn begin_line(&mut self, piece: usize, comments: usize, indent: usize, blank: Blank) {
        self.lines.begin(&self.tree.pieces[piece].gap, comments, indent, blank);
        self.hang = None;
    }

    pub(super) fn token(&mut self, piece: usize) {
        self.lines.push(self.tree.pieces[piece].text);
    }

    /// Writes operands and operators of one precedence, as many on a line as it takes.
    fn operands(&mut self, nodes: &[Node], precedence: u8, limit: usize, tail: usize) {
        let operators: Vec<usize> =
            (0..limit).filter(|&i| nodes[i].role == Role::Infix(precedence)).collect();
        let is_minus = |&i: &usize| self.tree.pieces[nodes[i].piece].text == "-";
        let at_line_end = self.is_minus_bound && operators.iter().any(is_minus);
        let mut indent = None;
        self.nodes(&nodes[..operators[0]], if at_line_end { 2 } else { 0 });
        for (i, &operator) in operators.iter().enumerate() {
            let is_last = i + 1 == operators.len();
            let end = operators.get(i + 1).copied().unwrap_or(nodes.len());
            let tail = match (is_last, at_line_end) {
                (true, _) => tail,
                (false, true) => 2,
                (false, false) => 0,
            };
            let mut rest = &nodes[operator..end];
            if at_line_end {
                self.advance(&rest[0]);
                self.token(rest[0].piece);
                rest = &rest[1..];
            }
            let indent = *indent.get_or_insert_with(|| self.hang());
            if self.stays_on_line(rest, indent, tail) {
                self.advance(&rest[0]);
            } else {
                self.break_before(&rest[0], indent);
            }
            if at_line_end {
                self.nodes(rest, tail);
            } else {
                self.token(rest[0].piece);
                self.advance(&rest[1]);
                self.nodes(&rest[1..], tail);
            }
        }
    }

    /// Whether nodes go on on the current line: if they fit, or if a line of their own would not
    /// be enough for them either.
    fn stays_on_line(&self, nodes: &[Node], indent: usize, tail: usize) -> bool {
        if self.tree.pieces[nodes[0].piece].has_comments() {
            return false;
        }
        let left = LINE_WIDTH.saturating_sub(self.lines.column() + 1);
        let on_this = left.checked_sub(tail).and_then(|left| flat(self.tree, nodes, left));
        let on_next = || flat(self.tree, nodes, LINE_WIDTH.saturating_sub(indent + tail));
        on_this.is_some() || least_width(self.tree, nodes, tail) <= left && on_next().is_none()
    }

    /// Writes a chain of calls, each method on a line.
    fn chain(&mut self, nodes: &[Node], dots: &[usize], tail: usize) {
        let indent = self.hang();
        self.in_brackets(&nodes[..dots[0]], 0);
        for (i, &dot) in dots.iter().enumerate() {
            let end = dots.get(i + 1).copied().unwrap_or(nodes.len());
            self.break_before(&nodes[dot], indent);
            self.in_brackets(&nodes[dot..end], if end == nodes.len() { tail } else { 0 });
        }
    }

    /// Writes `if c then a else if d then b else e`, each `else` on a line.
    fn branches(&mut self, nodes: &[Node], tail: usize) {
        let indent = if self.lines.is_at_indent() { self.lines.indent() } else { self.hang() };
        let (thens, elses) = self.branch_words(nodes);
        let mut start = 0;
        for (i, &then) in thens.iter().enumerate() {
            let end = elses.get(i).copied().unwrap_or(nodes.len());
            // `if`, or `else if`
            let words = if i == 0 { 1 } else { 2 };
            self.in_brackets(&nodes[start..start + words], 0);
            self.advance(&nodes[start + words]);
            self.nodes(&nodes[start + words..then], 0);
            if self.stays_on_line(&nodes[then..end], indent + INDENT, 0) {
                self.advance(&nodes[then]);
            } else {
                self.break_before(&nodes[then], indent + INDENT);
            }
            self.nodes(&nodes[then..end], 0);
            if let Some(node) = nodes.get(end) {
                self.break_before(node, indent);
            }
            start = end;
        }
        self.nodes(&nodes[start..], tail);
    }

    /// Where the `then`s and `else`s of an `if` and of the `if`s behind its `else`s stand.
    fn branch_words(&self, nodes: &[Node]) -> (Vec<usize>, Vec<usize>) {
        let (mut thens, mut elses) = (Vec::new(), Vec::new());
        let mut open = 0_usize;
        for (i, node) in nodes.iter().enumerate().filter(|(_, node)| node.role == Role::Keyword) {
            match self.tree.pieces[node.piece].text {
                "if" => open += 1,
                "then" if open == 1 => thens.push(i),
                "else" => {
                    open = open.saturating_sub(1);
                    if open == 0 {
                        elses.push(i);
                    }
                    let next = nodes.get(i + 1).map(|next| self.tree.pieces[next.piece].text);
                    if open == 0 && next != Some("if") {
                        break;
                    }
                }
                _ => {}
            }
        }
        (thens, elses)
    }

    /// Writes nodes one after the other, so that lines only end within brackets.
    pub(super) fn in_brackets(&mut self, nodes: &[Node], tail: usize) {
        for (i, node) in nodes.iter().enumerate() {
            if i > 0 {
                self.advance(node);
            }
            self.token(node.piece);
            if let Some(group) = &node.group {
                let behind = least_width(self.tree, &nodes[i + 1..], tail);
                self.group(group, behind);
            }
        }
    }
}
