//! Text to tokens: a quick walk that knows comments, strings, words, numbers and brackets.
//!
//! Comes in: the text. Goes out: the tokens, the places of `///` lines, and the *mask*, a copy of
//! the text of the same length in which comments, the `#vol` line and characters without a
//! meaning are blanks. The grammar reads the mask, so that its byte offsets are those of the file.

use super::{Report, explain};
use crate::source::Span;

/// The version of the language that this parser reads.
pub(super) const LANGUAGE_VERSION: &str = "1";

/// What a token is; the text says the rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Word,
    Number,
    Text,
    Color,
    /// `(`, `[` or `{`
    Open,
    /// `)`, `]` or `}`
    Close,
    /// Operators and other signs, one or two characters.
    Symbol,
}

/// One token.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Token {
    pub(crate) start: u32,
    pub(crate) end: u32,
    pub(crate) kind: Kind,
    /// Whether a line ends between the token before and this one.
    pub(super) starts_line: bool,
    /// Whether an item begins here; set by the guard.
    pub(crate) starts_item: bool,
    /// Number of brackets around it, for a bracket those around the pair; set by the guard.
    pub(super) depth: u16,
}

impl Token {
    pub(super) fn span(&self) -> Span {
        Span { start: self.start, end: self.end }
    }

    pub(crate) fn text<'a>(&self, text: &'a str) -> &'a str {
        &text[self.start as usize..self.end as usize]
    }
}

/// What the walk found.
pub(super) struct Scan {
    pub(super) tokens: Vec<Token>,
    /// UTF-8, as long as the text.
    pub(super) mask: Vec<u8>,
    /// `///` lines, in order, without the line end.
    pub(super) docs: Vec<Span>,
}

/// Takes a text apart.
pub(super) fn scan(text: &str, report: &mut Report) -> Scan {
    let scan = Scan { tokens: Vec::new(), mask: text.as_bytes().to_vec(), docs: Vec::new() };
    let mut scanner = Scanner { text, at: 0, starts_line: true, scan, report };
    while scanner.at < text.len() {
        scanner.step();
    }
    scanner.scan
}

struct Scanner<'a> {
    text: &'a str,
    at: usize,
    starts_line: bool,
    scan: Scan,
    report: &'a mut Report,
}

impl Scanner<'_> {
    fn step(&mut self) {
        let rest = &self.text.as_bytes()[self.at..];
        let next = rest.get(1).copied().unwrap_or(0);
        match rest[0] {
            b'\n' => {
                self.starts_line = true;
                self.at += 1;
            }
            b' ' | b'\t' | b'\r' => self.at += 1,
            b'/' if next == b'/' => self.comment(),
            b'/' if next == b'*' => self.block_comment(),
            b'"' => self.string(),
            b'#' if self.scan.tokens.is_empty() && is_version(rest) => self.version(),
            b'#' => self.token(Kind::Color, 1 + run(&rest[1..], is_word)),
            b'0'..=b'9' => self.token(Kind::Number, number_length(rest)),
            b'.' if next.is_ascii_digit() => self.token(Kind::Number, number_length(rest)),
            byte if is_word(byte) => self.token(Kind::Word, run(rest, is_word)),
            b'(' | b'[' | b'{' => self.token(Kind::Open, 1),
            b')' | b']' | b'}' => self.token(Kind::Close, 1),
            byte => match symbol_length(byte, next) {
                Some(length) => self.token(Kind::Symbol, length),
                None => self.bad_character(),
            },
        }
    }

    fn token(&mut self, kind: Kind, length: usize) {
        let span = Span::new(self.at, self.at + length);
        let starts_line = std::mem::take(&mut self.starts_line);
        let (start, end) = (span.start, span.end);
        self.scan.tokens.push(Token { start, end, kind, starts_line, starts_item: false, depth: 0 });
        self.at += length;
    }

    fn blank(&mut self, length: usize) {
        for byte in &mut self.scan.mask[self.at..self.at + length] {
            if *byte != b'\n' {
                *byte = b' ';
            }
        }
        self.at += length;
    }

    /// Length of the rest of the line, without the line end.
    fn line_length(&self) -> usize {
        let line = run(&self.text.as_bytes()[self.at..], |byte| byte != b'\n');
        self.text[self.at..self.at + line].trim_end_matches('\r').len()
    }

    fn comment(&mut self) {
        let length = self.line_length();
        let line = &self.text[self.at..self.at + length];
        if line.starts_with("///") && !line.starts_with("////") {
            self.scan.docs.push(Span::new(self.at, self.at + length));
        }
        self.blank(length);
    }

    fn block_comment(&mut self) {
        let rest = &self.text[self.at..];
        let length = rest.find("*/").map_or(rest.len(), |end| end + 2);
        self.report.add(explain::block_comment(self.text, self.at, length));
        self.blank(length);
    }

    /// A string ends on its line; one that doesn't is closed at the end of the line.
    fn string(&mut self) {
        let rest = self.text.as_bytes();
        let mut end = self.at + 1;
        while end < rest.len() && rest[end] != b'"' && rest[end] != b'\n' {
            let escaped = rest[end] == b'\\' && end + 1 < rest.len() && rest[end + 1] != b'\n';
            end += 1 + usize::from(escaped);
        }
        if end < rest.len() && rest[end] == b'"' {
            self.token(Kind::Text, end + 1 - self.at);
            return;
        }
        let length = self.line_length();
        let span = Span::new(self.at, self.at + length);
        let text = &self.text[self.at..self.at + length];
        self.report.add_breaking(span, || explain::unterminated_string(span, text));
        self.token(Kind::Text, length);
    }

    fn version(&mut self) {
        let length = self.line_length();
        let line = &self.text[self.at..self.at + length];
        let line = line.split("//").next().unwrap_or_default().trim_end();
        let version = line["#vol".len()..].trim();
        if version != LANGUAGE_VERSION {
            let span = Span::new(self.at, self.at + line.len());
            self.report.add(explain::wrong_version(span, version));
        }
        self.blank(length);
    }

    fn bad_character(&mut self) {
        let character = self.text[self.at..].chars().next().unwrap_or(' ');
        let length = character.len_utf8();
        let span = Span::new(self.at, self.at + length);
        let (text, at) = (self.text, self.at);
        self.report.add_breaking(span, || explain::bad_character(text, at, character));
        self.blank(length);
    }
}

fn run(bytes: &[u8], accept: impl Fn(u8) -> bool) -> usize {
    bytes.iter().position(|&byte| !accept(byte)).unwrap_or(bytes.len())
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

fn is_version(rest: &[u8]) -> bool {
    rest.starts_with(b"#vol") && rest.get(4).is_none_or(|&byte| !is_word(byte))
}

/// Length of a number with its unit; `1..2` and `1.abs()` begin with the number `1`.
fn number_length(rest: &[u8]) -> usize {
    let digits = |from: usize| run(rest.get(from..).unwrap_or_default(), |byte| byte.is_ascii_digit());
    let mut end = digits(0);
    if rest.get(end) == Some(&b'.') && digits(end + 1) > 0 {
        end += 1 + digits(end + 1);
    }
    if matches!(rest.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(rest.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end + run(&rest[end..], is_word)
}

fn symbol_length(byte: u8, next: u8) -> Option<usize> {
    match (byte, next) {
        (b'|', b'|')
        | (b'&', b'&')
        | (b'=' | b'!' | b'<' | b'>', b'=')
        | (b'=' | b'-', b'>')
        | (b'.', b'.') => Some(2),
        (
            b'+' | b'-' | b'*' | b'/' | b'%' | b'<' | b'>' | b'=' | b'!' | b'|' | b'&' | b'.' | b',' | b':',
            _,
        ) => Some(1),
        _ => None,
    }
}
