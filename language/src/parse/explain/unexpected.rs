//! "expected …, found …": the grammar's dead ends in words.

use super::quoted;
use crate::diag::{Diagnostic, Fix};
use crate::parse::scan::{Kind, Token};
use crate::source::Span;

/// Stands for anything that may follow a complete expression.
pub(in crate::parse) const OPERATOR: &str = "an operator";

/// Where the grammar got stuck.
pub(in crate::parse) struct Place<'a> {
    /// The whole text.
    pub(in crate::parse) text: &'a str,
    /// The tokens that the grammar read.
    pub(in crate::parse) tokens: &'a [Token],
    /// `entry` or `item`.
    pub(in crate::parse) unit: &'static str,
    /// Byte in the file.
    pub(in crate::parse) offset: usize,
    /// What would have fitted, in words; see `lower/words.rs`.
    pub(in crate::parse) expected: Vec<&'static str>,
}

/// The message about text that the grammar does not take.
pub(in crate::parse) fn unexpected(place: &Place<'_>) -> Diagnostic {
    let index = place.tokens.partition_point(|token| token.end as usize <= place.offset);
    let expected = place.expected(index);
    let list = join(&expected);
    let diagnostic = match (place.tokens.get(index), index.checked_sub(1).map(|i| &place.tokens[i])) {
        (Some(found), _) => {
            let message = format!("expected {list}, found {}", describe(found, place.text));
            Diagnostic::error("E0102", message, found.span(), "not expected here")
        }
        (None, Some(last)) => {
            let message = format!("expected {list} after {}", describe(last, place.text));
            Diagnostic::error("E0102", message, last.span(), format!("the {} ends here", place.unit))
        }
        (None, None) => {
            Diagnostic::error("E0102", format!("expected {list}"), Span::new(place.offset, place.offset), "")
        }
    };
    if let Some((help, fix)) = place.repair(index, &expected) {
        return diagnostic.with_help(help).with_fix(fix);
    }
    match place.help(index, &expected) {
        Some(help) => diagnostic.with_help(help),
        None => diagnostic,
    }
}

fn describe(token: &Token, text: &str) -> String {
    match token.kind {
        Kind::Text => "a string".to_owned(),
        _ => quoted(token.text(text)),
    }
}

fn join(words: &[&str]) -> String {
    match words {
        [] => "something else".to_owned(),
        [word] => (*word).to_owned(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

impl Place<'_> {
    /// What the user could write before token `index`, most telling words only.
    fn expected(&self, index: usize) -> Vec<&'static str> {
        let mut words: Vec<&'static str> = Vec::new();
        for &word in &self.expected {
            if !word.is_empty() && !words.contains(&word) {
                words.push(word);
            }
        }
        if let Some(whole) = words.iter().find(|word| matches!(**word, "an expression" | "a type")) {
            return vec![*whole];
        }
        if index == 0 && self.unit == "entry" {
            return vec!["a key"];
        }
        let follows_expression = words.contains(&OPERATOR);
        words.retain(|word| *word != OPERATOR);
        if follows_expression && words.is_empty() {
            words.extend(self.closers(index));
        }
        words
    }

    /// The bracket around the place before token `index`.
    fn open_bracket(&self, index: usize) -> Option<usize> {
        let depth = match self.tokens.get(index) {
            Some(token) => token.depth + u16::from(token.kind == Kind::Close),
            None => return None,
        };
        let before = self.tokens[..index].iter();
        before
            .rev()
            .position(|token| token.kind == Kind::Open && token.depth + 1 == depth)
            .map(|i| index - 1 - i)
    }

    /// What may follow a complete expression, besides operators.
    fn closers(&self, index: usize) -> &'static [&'static str] {
        let Some(open) = self.open_bracket(index) else {
            return match self.unit {
                "entry" => &["a new line", "`,`"],
                _ => &["the next item"],
            };
        };
        match self.tokens[open].text(self.text) {
            "(" => &["`,`", "`)`"],
            "[" => &["`,`", "`]`"],
            _ if self.word_at(open + 2) == ":" => &["`,`", "`}`"],
            _ => &["`}`"],
        }
    }

    /// Whether the place lies directly in `{ let … }`.
    fn is_in_block(&self, index: usize) -> bool {
        self.open_bracket(index).is_some_and(|open| self.word_at(open + 1) == "let")
    }

    /// Whether the place lies directly in `{ … }`.
    fn is_in_braces(&self, index: usize) -> bool {
        self.open_bracket(index).is_some_and(|open| self.word_at(open) == "{")
    }

    /// Whether the place lies directly in `[ … ]`.
    fn is_in_list(&self, index: usize) -> bool {
        self.open_bracket(index).is_some_and(|open| self.word_at(open) == "[")
    }

    /// Whether `(name` or `, name` stands directly before the place, inside round brackets.
    fn names_argument(&self, index: usize) -> bool {
        index >= 2
            && self.tokens[index - 1].kind == Kind::Word
            && matches!(self.word_at(index - 2), "(" | ",")
            && self.open_bracket(index).is_some_and(|open| self.word_at(open) == "(")
    }

    /// The bracket around the place if it follows the number of steps of a loop.
    fn state_without_from(&self, index: usize) -> Option<usize> {
        let open = self.open_bracket(index)?;
        (self.word_at(open) == "(" && self.word_at(open.checked_sub(2)?) == "iterate").then_some(open)
    }

    fn is_number(&self, index: usize) -> bool {
        self.tokens.get(index).is_some_and(|token| token.kind == Kind::Number)
    }

    /// Whether a value, not an operator, stands at token `index`.
    fn begins_value(&self, index: usize) -> bool {
        self.tokens
            .get(index)
            .is_some_and(|token| matches!(token.kind, Kind::Number | Kind::Text | Kind::Color | Kind::Word))
    }

    fn word_before(&self, index: usize) -> &str {
        index.checked_sub(1).map_or("", |before| self.word_at(before))
    }

    fn word_at(&self, index: usize) -> &str {
        self.tokens.get(index).map_or("", |token| token.text(self.text))
    }

    /// What to type and the repair that types it, for mistakes with one.
    fn repair(&self, index: usize, expected: &[&str]) -> Option<(&'static str, Fix)> {
        let token = self.tokens.get(index)?;
        let (found, span) = (self.word_at(index), token.span());
        let wants = |word: &str| expected.contains(&word);
        // `.5` after a value is a second point in a number, or an index.
        let begins_value = self.begins_value(index) && !found.starts_with('.');
        let begins_vector = found == "(" && !token.starts_line;
        let after_operand = self.expected.contains(&OPERATOR);
        let before = self.tokens[..index].last().map_or(span.start, |token| token.end);
        let insert = |text: &str| Fix::insert(before, text);
        if let Some(open) = self.state_without_from(index).filter(|_| found == "=") {
            let fix = Fix::insert(self.tokens[open - 1].end, " from");
            return Some(("write `from` before the first values: `iterate 8 from (z = 1): …`", fix));
        }
        Some(match found {
            "=" if wants("`:`") && self.word_at(0) != "param" => {
                ("write `:` instead of `=`", Fix::replace(span, ":"))
            }
            "=" if self.names_argument(index) => {
                ("write `:` after the name of an argument, or `==` to compare", Fix::replace(span, ":"))
            }
            "=" if after_operand && !self.is_in_block(index) => {
                ("write `==` to compare", Fix::replace(span, "=="))
            }
            "=" if wants("`in`") => ("write `[for i in 0..8: …]`", Fix::replace(span, "in")),
            "," if wants("an expression") && !self.is_in_block(index) => {
                ("remove the `,`, or write a value before it", Fix::remove(span))
            }
            ":" if wants("`=`") && self.word_at(0) == "let" => {
                let equals = (index..self.tokens.len()).find(|&i| self.word_at(i) == "=")?;
                let ty = Span { start: before, end: self.tokens[equals - 1].end };
                ("a `let` states no type: write `let name = value`", Fix::remove(ty))
            }
            "->" if after_operand => ("write a function as `x => …`", Fix::replace(span, "=>")),
            _ if self.word_before(index) == "return" && self.is_in_braces(index) => {
                let word = Span { start: self.tokens[index - 1].start, end: span.start };
                ("remove `return`: the last expression is the result", Fix::remove(word))
            }
            _ if wants("`then`") && begins_value => ("write `if condition then a else b`", insert(" then")),
            _ if wants("`=`") && self.word_at(0) == "let" && begins_value => {
                ("write `let name = value`", insert(" ="))
            }
            _ if wants("`:`") && self.is_in_list(index) && begins_value => {
                ("write `:` before what each element is: `[for i in 0..8: …]`", insert(":"))
            }
            _ if wants("`:`") && self.unit == "entry" && index == 1 && (begins_value || begins_vector) => {
                ("write an entry as `key: value`", insert(":"))
            }
            _ if wants("`,`") && begins_value => ("write `,` before it, or an operator", insert(",")),
            _ => return None,
        })
    }

    /// What to type, for the other mistakes that people make.
    fn help(&self, index: usize, expected: &[&str]) -> Option<String> {
        let found = self.word_at(index);
        let starts_line = self.tokens.get(index).is_some_and(|token| token.starts_line);
        let is_number = self.tokens.get(index).is_some_and(|token| token.kind == Kind::Number);
        let wants = |word: &str| expected.contains(&word);
        let help = match found {
            "(" if starts_line => "write `(` on the line above to call, or `,` before it",
            "-" if starts_line => "write `-` at the end of the line above to subtract",
            "=" if self.is_in_block(index) => {
                "a name keeps its value: write `let` and another name, or `==` to compare"
            }
            "," if wants("an expression") && self.is_in_block(index) => "separate `let`s by new lines",
            ":" if wants("`=`") => "write `name: type = value`",
            "=" if wants("`->`") => "write the type of the result: `-> float`",
            ".." => "write a range only after `in`: `[for i in 0..10: …]`",
            "[" if self.expected.contains(&OPERATOR) => {
                "there is no index: write the parts of a vector as `v.x`, walk a list with `[for x in list: …]`"
            }
            "*" if wants("an expression") && self.word_before(index) == "*" => "write a power as `pow(a, b)`",
            _ if is_number && found.starts_with('.') && self.is_number(index.wrapping_sub(1)) => {
                "a number has one `.`"
            }
            _ if is_number && found.starts_with('.') => {
                "write the parts of a vector as `v.x`, `v.y` and `v.z`"
            }
            "let" | "if" | "then" | "else" | "for" | "in" | "true" | "false" | "fn" | "param" | "import"
                if wants("a name") || wants("a key") =>
            {
                return Some(format!("`{found}` is a word of the language: choose another name"));
            }
            "for" if wants("an expression") => "write a list in brackets: `[for i in 0..8: …]`",
            "in" if wants("an expression") => "`in` is a word of the language: choose another name",
            "{" if wants("`->`") => "write the type of the result: `-> float {`",
            _ if wants("`else`") => "write both branches: `if condition then a else b`",
            _ if wants("`then`") => "write `if condition then a else b`",
            _ if wants("`=`") && self.word_at(0) == "param" => "write `param name: float = 1 in 0..2`",
            _ if wants("`:`") && self.word_at(0) == "param" => "write `param name: float = 1 in 0..2`",
            _ if wants("`:`") && self.unit == "entry" => "write an entry as `key: value`",
            _ if wants("`=`") && self.word_at(0) == "let" => "write `let name = value`",
            _ if wants("`in`") => "write `[for i in 0..8: …]`",
            _ if wants("`:`") && self.is_in_list(index) => {
                "write `:` before what each element is: `[for i in 0..8: …]`"
            }
            _ if wants("`:`") && self.word_at(0) == "fn" => "write the type of the parameter: `name: float`",
            ")" | "]" | "}" if wants("an expression") => {
                return Some(format!("write a value before the `{found}`"));
            }
            "" if wants("an expression") => {
                return Some(format!("write a value after the `{}`", self.word_before(index)));
            }
            _ if index == 0 && is_number => "write a vector in brackets: `(1, 2, 3)`",
            _ => return None,
        };
        Some(help.to_owned())
    }
}
