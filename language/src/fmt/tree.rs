//! Tokens to a tree of brackets, with the part that each token plays.

use super::pieces::{Gap, Piece};
use crate::parse::scan::Kind;
use std::collections::HashSet;

/// What a node does among its neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    /// A word, literal or bracket that an expression can end with.
    Operand,
    /// `-` or `!` before its operand.
    Prefix,
    /// An operator between its operands; the higher the tighter.
    Infix(u8),
    /// A word that stands between expressions: `if`, `in`, `from` …
    Keyword,
    /// `.`
    Dot,
    /// `..`
    Range,
    /// `:`
    Colon,
    /// `=`
    Equals,
    /// `->`
    Arrow,
    /// `=>`
    FatArrow,
}

/// A token, or a pair of brackets with its content.
#[derive(Debug)]
pub(super) struct Node {
    /// The token, for brackets the one that opens.
    pub(super) piece: usize,
    pub(super) role: Role,
    /// Whether a blank stands before it on a line.
    pub(super) space: bool,
    pub(super) group: Option<Box<Group>>,
}

/// What stands between brackets.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) kind: GroupKind,
    /// What commas or the ends of lines separate.
    pub(super) parts: Vec<Vec<Node>>,
    /// The token that closes.
    pub(super) close: usize,
    /// Whether its parts were written on lines of their own and have to stay so.
    pub(super) is_spread: bool,
    /// Whether a comma follows the last part where each part has its line.
    pub(super) ends_with_comma: bool,
}

/// The kinds of brackets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GroupKind {
    /// `(a + b)` to say what belongs together.
    Paren,
    /// Other round or square brackets.
    List,
    /// Braces with `key: value`.
    Record,
    /// Braces with `let`s and a value.
    Block,
}

impl Group {
    pub(super) fn has_let(&self, pieces: &[Piece<'_>]) -> bool {
        self.kind == GroupKind::Block && self.parts.iter().any(|part| pieces[part[0].piece].text == "let")
    }
}

/// A file as a tree.
pub(super) struct Tree<'a> {
    pub(super) pieces: Vec<Piece<'a>>,
    /// The gap at the end of the file.
    pub(super) end: Gap<'a>,
    pub(super) items: Vec<Vec<Node>>,
}

/// Builds the tree of a text without syntax errors. `part_starts` holds the offsets of keys and of
/// values of blocks.
pub(super) fn tree<'a>(pieces: Vec<Piece<'a>>, end: Gap<'a>, part_starts: &HashSet<u32>) -> Tree<'a> {
    let mut builder = Builder { pieces, part_starts, at: 0 };
    let mut items = Vec::new();
    while builder.at < builder.pieces.len() {
        let mut item = Vec::new();
        while item.is_empty() || builder.peek().is_some_and(|piece| !piece.starts_item) {
            builder.node(&mut item);
        }
        items.push(item);
    }
    Tree { pieces: builder.pieces, end, items }
}

struct Builder<'a, 's> {
    pieces: Vec<Piece<'a>>,
    part_starts: &'s HashSet<u32>,
    at: usize,
}

impl<'a> Builder<'a, '_> {
    fn peek(&self) -> Option<&Piece<'a>> {
        self.pieces.get(self.at)
    }

    /// Reads one token, or a pair of brackets.
    fn node(&mut self, before: &mut Vec<Node>) {
        let piece = self.at;
        let role = self.role(before);
        let space = has_space(before.last(), role, self.pieces[piece].text);
        self.at += 1;
        let is_open = self.pieces[piece].kind == Kind::Open;
        let group = is_open.then(|| Box::new(self.group(piece, before.last())));
        before.push(Node { piece, role, space, group });
    }

    fn group(&mut self, open: usize, before: Option<&Node>) -> Group {
        let is_curly = self.pieces[open].text == "{";
        let mut parts: Vec<Vec<Node>> = Vec::new();
        let mut part = Vec::new();
        let mut has_comma = false;
        while let Some(piece) = self.peek()
            && piece.kind != Kind::Close
        {
            let starts_part = is_curly && (piece.text == "let" || self.part_starts.contains(&piece.start));
            let is_comma = piece.text == ",";
            if is_comma {
                self.skip_comma();
                has_comma = true;
            }
            if (starts_part || is_comma) && !part.is_empty() {
                parts.push(std::mem::take(&mut part));
            }
            if !is_comma {
                self.node(&mut part);
            }
        }
        if !part.is_empty() {
            parts.push(part);
        }
        let close = self.at;
        self.at += 1;
        let kind = self.group_kind(open, before, &parts, has_comma);
        let starts_line = |piece: usize| self.pieces[piece].gap.has_line_end;
        let is_spread = is_curly
            && !parts.is_empty()
            && (starts_line(close) || parts.iter().any(|part| starts_line(part[0].piece)));
        let is_comprehension = parts.len() == 1 && self.pieces[parts[0][0].piece].text == "for";
        let is_function_type = self.peek().is_some_and(|piece| piece.text == "->")
            && before.is_none_or(|before| before.role != Role::Operand);
        let ends_with_comma = parts.len() > 1 && !is_comprehension && !is_function_type;
        Group { kind, parts, close, is_spread, ends_with_comma }
    }

    /// Leaves out a comma; what stands before it moves behind it.
    fn skip_comma(&mut self) {
        let gap = std::mem::take(&mut self.pieces[self.at].gap);
        self.at += 1;
        if let Some(next) = self.pieces.get_mut(self.at) {
            next.gap.has_line_end |= gap.has_line_end;
            next.gap.comments.splice(0..0, gap.comments);
        }
    }

    fn group_kind(
        &self,
        open: usize,
        before: Option<&Node>,
        parts: &[Vec<Node>],
        has_comma: bool,
    ) -> GroupKind {
        let is_call = before.is_some_and(|before| before.role == Role::Operand);
        match self.pieces[open].text {
            "{" => {
                let is_record = parts.first().is_none_or(|part| {
                    part[0].group.is_none() && part.get(1).is_some_and(|node| node.role == Role::Colon)
                });
                if is_record { GroupKind::Record } else { GroupKind::Block }
            }
            "(" if parts.len() == 1 && !is_call && !has_comma => GroupKind::Paren,
            _ => GroupKind::List,
        }
    }

    fn role(&self, before: &[Node]) -> Role {
        let piece = &self.pieces[self.at];
        let after_operand = before.last().is_some_and(|node| node.role == Role::Operand);
        match (piece.kind, piece.text) {
            (Kind::Word, word) => {
                // `from`, `while`, `as` are words like any other unless they stand behind an operand.
                if is_reserved(word) || after_operand { Role::Keyword } else { Role::Operand }
            }
            (Kind::Symbol, "!" | "-") if !after_operand => Role::Prefix,
            (Kind::Symbol, symbol) => symbol_role(symbol),
            (Kind::Number | Kind::Text | Kind::Color | Kind::Open | Kind::Close, _) => Role::Operand,
        }
    }
}

fn is_reserved(word: &str) -> bool {
    matches!(word, "let" | "if" | "then" | "else" | "for" | "in" | "fn" | "param" | "import" | "iterate")
}

fn symbol_role(symbol: &str) -> Role {
    match symbol {
        "." => Role::Dot,
        ".." => Role::Range,
        ":" => Role::Colon,
        "=" => Role::Equals,
        "->" => Role::Arrow,
        "=>" => Role::FatArrow,
        "||" => Role::Infix(1),
        "&&" => Role::Infix(2),
        "|" => Role::Infix(4),
        "&" => Role::Infix(5),
        "+" | "-" => Role::Infix(6),
        "*" | "/" | "%" => Role::Infix(7),
        // The comparisons.
        _ => Role::Infix(3),
    }
}

/// Whether a blank stands between two nodes on a line.
fn has_space(before: Option<&Node>, role: Role, text: &str) -> bool {
    let Some(before) = before else { return false };
    match (before.role, role) {
        // `0...5` would be hard to read.
        (Role::Range, _) if text.starts_with('.') => true,
        (Role::Dot | Role::Range | Role::Prefix, _) | (_, Role::Dot | Role::Range | Role::Colon) => false,
        (Role::Operand, Role::Operand) => text != "(",
        _ => true,
    }
}
