//! Checks on the tokens that keep the grammar safe, and marks that make it simple.
//!
//! One walk over the tokens
//! * matches brackets and reports those that don't;
//! * bounds how deep the grammar can recurse: brackets, and what nests without one (`if`, `iterate`,
//!   `=>`, `->`, a run of prefix operators);
//! * marks where items begin;
//! * writes `;` into the mask for a line end that must not be skipped: before a `(`, which would
//!   turn the line above into a call, and in a block with `let`s before a `-`, which would
//!   subtract from it.

use super::scan::{Kind, Scan, Token};
use super::{MAX_DEPTH, MAX_NESTING, Report, explain};
use crate::blocks::BLOCK_KINDS;
use crate::source::Span;

/// Most operators in one expression without brackets; keeps the grammar's memory small where
/// [`MAX_DEPTH`] will refuse the expression anyway.
const MAX_OPERATORS: u32 = 4096;

/// Most tokens that are read ahead to tell a stray bracket from a wrong one.
const MAX_LOOKAHEAD: usize = 10_000;

/// Words that begin an item.
pub(super) fn is_item_word(word: &str) -> bool {
    matches!(word, "param" | "let" | "fn" | "import") || is_block_word(word)
}

/// Words that begin a scene block.
pub(super) fn is_block_word(word: &str) -> bool {
    BLOCK_KINDS.iter().any(|kind| kind.keyword() == word)
}

/// Whether an expression can end with this token.
fn ends_operand(token: &Token, text: &str) -> bool {
    match token.kind {
        Kind::Word => !matches!(
            token.text(text),
            "let" | "if" | "then" | "else" | "for" | "in" | "fn" | "param" | "import" | "iterate" | "as"
        ),
        Kind::Number | Kind::Text | Kind::Color | Kind::Close => true,
        Kind::Open | Kind::Symbol => false,
    }
}

/// Walks over the tokens of `text`, completes them and reports what is wrong with brackets.
pub(super) fn guard(text: &str, scan: &mut Scan, report: &mut Report) {
    // A bracket that is never closed swallows all items after it, unless an item's word at the
    // start of a line may end it. That rule is a guess, so it holds in unbalanced files only.
    let guess_items = !is_balanced(text, &scan.tokens);
    let mut walk = Walk {
        text,
        report,
        guess_items,
        frames: Vec::new(),
        base: Frame::default(),
        extra: 0,
        too_deep: false,
        item_start: 0,
    };
    for i in 0..scan.tokens.len() {
        walk.token(i, scan);
    }
    walk.finish(&scan.tokens);
}

fn is_balanced(text: &str, tokens: &[Token]) -> bool {
    let mut open = Vec::new();
    for token in tokens {
        match token.kind {
            Kind::Open => open.push(closer(token.text(text))),
            Kind::Close if open.pop() != Some(token.text(text)) => return false,
            _ => {}
        }
    }
    open.is_empty()
}

fn closer(open: &str) -> &'static str {
    match open {
        "(" => ")",
        "[" => "]",
        _ => "}",
    }
}

/// An open bracket, or the file itself.
#[derive(Default)]
struct Frame {
    span: Span,
    closer: &'static str,
    /// `if`, `=>` and `->` since the last separator: each nests what follows.
    nested: u32,
    /// Prefix operators directly before this place.
    prefixes: u32,
    /// Operators since the last separator.
    operators: u32,
    has_let: bool,
}

struct Walk<'a> {
    text: &'a str,
    report: &'a mut Report,
    guess_items: bool,
    frames: Vec<Frame>,
    base: Frame,
    /// Sum of `nested` and `prefixes` over all frames.
    extra: u32,
    /// Whether the item was refused as too deep: its brackets are not worth a word any more.
    too_deep: bool,
    /// Index of the token that began the item.
    item_start: usize,
}

impl Walk<'_> {
    fn token(&mut self, i: usize, scan: &mut Scan) {
        if self.guess_items && self.is_swallowed_item(i, &scan.tokens) {
            self.close_all(scan.tokens[i].span());
        }
        if self.frames.is_empty() && self.begins_item(i, &scan.tokens) {
            scan.tokens[i].starts_item = true;
            self.item_start = i;
            self.too_deep = false;
            self.separate();
        }
        scan.tokens[i].depth = depth(&self.frames);
        if let Some(at) = self.hard_line_end(i, scan) {
            scan.mask[at] = b';';
        }
        let token = scan.tokens[i];
        match token.kind {
            Kind::Open => self.open(&token),
            Kind::Close => {
                self.close(i, &scan.tokens);
                scan.tokens[i].depth = depth(&self.frames);
            }
            Kind::Word => self.word(token.text(self.text)),
            Kind::Symbol => {
                let operand = i > 0 && ends_operand(&scan.tokens[i - 1], self.text);
                self.symbol(token.text(self.text), operand);
            }
            Kind::Number | Kind::Text | Kind::Color => {}
        }
        self.check_depth(&token);
    }

    fn frame(&mut self) -> &mut Frame {
        self.frames.last_mut().unwrap_or(&mut self.base)
    }

    /// What stood before a separator is over and nests nothing that follows.
    fn separate(&mut self) {
        let frame = self.frame();
        let over = frame.nested + frame.prefixes;
        (frame.nested, frame.prefixes, frame.operators) = (0, 0, 0);
        self.extra -= over;
    }

    fn nest(&mut self) {
        let frame = self.frame();
        frame.nested += frame.prefixes + 1;
        frame.prefixes = 0;
        self.extra += 1;
    }

    fn word(&mut self, word: &str) {
        match word {
            "let" => {
                self.separate();
                self.frame().has_let = true;
            }
            "if" | "iterate" => self.nest(),
            _ => {}
        }
    }

    fn symbol(&mut self, symbol: &str, after_operand: bool) {
        match symbol {
            "," | ":" => return self.separate(),
            "=>" | "->" => self.nest(),
            "-" | "!" if !after_operand => {
                self.frame().prefixes += 1;
                self.extra += 1;
            }
            // In `-a.f(…)` the prefix waits for the end of the chain.
            "." => {}
            _ => {
                let over = std::mem::take(&mut self.frame().prefixes);
                self.extra -= over;
            }
        }
        self.frame().operators += 1;
    }

    fn open(&mut self, token: &Token) {
        let closer = closer(token.text(self.text));
        self.frames.push(Frame { span: token.span(), closer, ..Frame::default() });
    }

    fn close(&mut self, i: usize, tokens: &[Token]) {
        let (found, span) = (tokens[i].text(self.text), tokens[i].span());
        let Some(frame) = self.frames.last() else {
            return self.report.add_breaking(span, || explain::stray_bracket(span, found));
        };
        let (opened, expected) = (frame.span, frame.closer);
        if expected == found {
            return self.pop();
        }
        let mut near = self.frames.iter().rev().take(MAX_NESTING);
        match near.position(|frame| frame.closer == found) {
            // The closing bracket of an outer pair also ends the pairs inside it.
            Some(inner) => {
                self.report.break_at(span);
                self.break_bracket(opened, || explain::crossed_bracket(opened, expected, span, found));
                (0..=inner).for_each(|_| self.pop());
            }
            None if self.closes_later(expected, &tokens[i + 1..]) => {
                self.report.add_breaking(span, || explain::stray_bracket(span, found));
            }
            None => {
                self.report.break_at(span);
                self.break_bracket(opened, || explain::wrong_bracket(opened, expected, span, found));
                self.pop();
            }
        }
    }

    /// Whether the first bracket that closes nothing among the next tokens is the given one. Looks only
    /// as long as the answer shows in a message, so a file full of strays is read in linear time.
    fn closes_later(&self, closer: &str, tokens: &[Token]) -> bool {
        if self.too_deep || self.report.is_full() {
            return false;
        }
        let mut depth = 0_usize;
        for token in tokens.iter().take(MAX_LOOKAHEAD) {
            match token.kind {
                Kind::Open => depth += 1,
                Kind::Close if depth == 0 => return token.text(self.text) == closer,
                Kind::Close => depth -= 1,
                Kind::Word | Kind::Number | Kind::Text | Kind::Color | Kind::Symbol => {}
            }
        }
        false
    }

    fn pop(&mut self) {
        if let Some(frame) = self.frames.pop() {
            self.extra -= frame.nested + frame.prefixes;
        }
    }

    fn close_all(&mut self, end: Span) {
        if let Some(frame) = self.frames.last() {
            let (opened, expected) = (frame.span, frame.closer);
            self.break_bracket(opened, || explain::unclosed_bracket(opened, expected, end));
        }
        while !self.frames.is_empty() {
            self.pop();
        }
    }

    fn break_bracket(&mut self, opened: Span, explain: impl FnOnce() -> super::Diagnostic) {
        self.report.break_at(opened);
        if !self.too_deep {
            self.report.add(explain());
        }
    }

    fn check_depth(&mut self, token: &Token) {
        let brackets = self.frames.len();
        let deep = brackets > MAX_NESTING || brackets + self.extra as usize > MAX_DEPTH;
        if !deep && self.frame().operators <= MAX_OPERATORS {
            return;
        }
        self.report.break_at(token.span());
        if !self.too_deep {
            let diagnostic = match (brackets > MAX_NESTING, deep) {
                (true, _) => explain::too_many_brackets(token.span()),
                (false, true) => explain::too_deep(token.span()),
                (false, false) => explain::too_long(token.span()),
            };
            self.report.add(diagnostic);
        }
        self.too_deep = true;
    }

    /// Whether an item begins inside brackets, as far as one can guess from its looks.
    fn is_swallowed_item(&self, i: usize, tokens: &[Token]) -> bool {
        let Some(frame) = self.frames.last() else { return false };
        let word = tokens[i].text(self.text);
        // A `let` may well stand unindented in a function's body, but not in a scene block.
        let in_scene_block = self.frames.len() == 1 && is_block_word(tokens[self.item_start].text(self.text));
        self.is_flush_item_word(&tokens[i]) && (word != "let" || frame.closer != "}" || in_scene_block)
    }

    /// Whether an item's word stands at the very start of a line.
    fn is_flush_item_word(&self, token: &Token) -> bool {
        let start = token.start as usize;
        token.kind == Kind::Word
            && (start == 0 || self.text.as_bytes()[start - 1] == b'\n')
            && is_item_word(token.text(self.text))
    }

    fn begins_item(&self, i: usize, tokens: &[Token]) -> bool {
        let token = &tokens[i];
        let Some(before) = i.checked_sub(1).map(|i| &tokens[i]) else { return true };
        if token.kind != Kind::Word {
            return false;
        }
        let word = token.text(self.text);
        if i == self.item_start + 1 && is_item_word(before.text(self.text)) {
            // `light camera { … }`: the word after an item's word is a name, if on its line.
            return token.starts_line && is_item_word(word);
        }
        if !ends_operand(before, self.text) {
            return self.is_flush_item_word(token);
        }
        let after_block = before.kind == Kind::Close && before.text(self.text) == "}";
        let continues = matches!(word, "if" | "then" | "else" | "for" | "in" | "as" | "from" | "while");
        is_item_word(word) || ((token.starts_line || after_block) && !continues)
    }

    /// The place of a line end before token `i` that the grammar must see.
    fn hard_line_end(&mut self, i: usize, scan: &Scan) -> Option<usize> {
        let token = &scan.tokens[i];
        let before = &scan.tokens[i.checked_sub(1)?];
        let is_hard = match token.text(self.text) {
            "(" => true,
            "-" => self.frame().has_let,
            _ => false,
        };
        if !is_hard || !token.starts_line || !ends_operand(before, self.text) {
            return None;
        }
        let gap = before.end as usize..token.start as usize;
        scan.mask[gap.clone()].iter().rposition(|&byte| byte == b'\n').map(|at| gap.start + at)
    }

    fn finish(mut self, tokens: &[Token]) {
        if let Some(last) = tokens.last() {
            self.close_all(Span { start: last.end, end: last.end });
        }
    }
}

fn depth(frames: &[Frame]) -> u16 {
    // Deeper tokens lie in an item that was refused.
    frames.len().min(usize::from(u16::MAX)) as u16
}
