//! The parser's messages: all wording about syntax is here and in `explain/unexpected.rs`.

mod repair;
mod unexpected;

use super::{MAX_DEPTH, MAX_NESTING};
use crate::blocks::BLOCK_KINDS;
use crate::diag::{Diagnostic, Fix};
use crate::nearest::nearest;
use crate::source::{MAX_SOURCE_BYTES, Span};
pub(super) use unexpected::{OPERATOR, Place, unexpected};

/// Codes of the parser's messages with their meaning in one line.
pub const CODES: &[(&str, &str)] = &[
    ("E0100", "brackets or operators nest too deeply, or an expression has too many operators"),
    ("E0101", "a bracket is not closed, is closed by another kind, or closes nothing"),
    ("E0102", "the text does not continue as the grammar asks for"),
    ("E0103", "a string has no closing quote on its line"),
    ("E0104", "a character has no meaning outside strings and comments"),
    ("E0105", "two entries share a line without a comma"),
    ("E0106", "a number has an unknown unit"),
    ("E0107", "a number is too large"),
    ("E0108", "a `#` is not followed by three or six hexadecimal digits"),
    ("E0109", "a string has an unknown escape after `\\`"),
    ("E0110", "the first line names a version of the language that this program does not read"),
    ("E0111", "the file is too large"),
    ("E0112", "a vector has more than four components"),
    ("E0113", "an item begins with an unknown word"),
    ("E0115", "too many syntax errors; the rest is not shown"),
    ("W0110", "an angle was probably meant in another unit"),
];

/// Units of numbers, as messages list them.
const UNITS: &str = "`deg`, `rad`, `turn`, `s` and `ms`";

/// A text in message quotes, shortened.
fn quoted(text: &str) -> String {
    const MOST: usize = 24;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("`{}…`", &text[..end]),
        None => format!("`{text}`"),
    }
}

pub(super) fn file_too_large(bytes: usize) -> Diagnostic {
    let message = format!("the file has {bytes} bytes, a scene may have at most {MAX_SOURCE_BYTES}");
    Diagnostic::error("E0111", message, Span::default(), "")
}

pub(super) fn too_many_errors(at: Span, shown: usize) -> Diagnostic {
    let message = format!("more than {shown} syntax errors, the rest is not shown");
    Diagnostic::error("E0115", message, at, "the first one that is not shown")
}

pub(super) fn too_many_brackets(at: Span) -> Diagnostic {
    let message = format!("brackets nest more than {MAX_NESTING} deep");
    Diagnostic::error("E0100", message, at, format!("bracket number {} inside each other", MAX_NESTING + 1))
        .with_help("name the inner parts: `let part = …`")
}

pub(super) fn too_deep(at: Span) -> Diagnostic {
    let message = format!("the expression nests more than {MAX_DEPTH} deep");
    Diagnostic::error("E0100", message, at, "too deep here").with_help("name the inner parts: `let part = …`")
}

pub(super) fn too_long(at: Span) -> Diagnostic {
    let message = format!("the expression chains more than {MAX_DEPTH} operators");
    Diagnostic::error("E0100", message, at, "too long here")
        .with_help("name parts of it with `let part = …`, or join shapes with `union([…])`")
}

pub(super) fn stray_bracket(at: Span, found: &str) -> Diagnostic {
    let opener = match found {
        ")" => "(",
        "]" => "[",
        _ => "{",
    };
    Diagnostic::error("E0101", format!("`{found}` closes nothing"), at, format!("no `{opener}` is open here"))
        .with_help(format!("remove the `{found}`"))
        .with_fix(Fix::remove(at))
}

/// `found` closes another bracket, further out, than the one at `opened`.
pub(super) fn crossed_bracket(opened: Span, expected: &str, at: Span, found: &str) -> Diagnostic {
    let message = format!("expected `{expected}`, found `{found}`");
    Diagnostic::error("E0101", message, at, format!("`{expected}` belongs before this"))
        .with_label(opened, "the bracket that it would close")
        .with_help(format!("write `{expected}` before the `{found}`"))
}

/// `found` closes no bracket, and the one at `opened` is not closed by another.
pub(super) fn wrong_bracket(opened: Span, expected: &str, at: Span, found: &str) -> Diagnostic {
    let message = format!("expected `{expected}`, found `{found}`");
    Diagnostic::error("E0101", message, at, format!("`{expected}` belongs here"))
        .with_label(opened, "the bracket that it would close")
        .with_help(format!("write `{expected}` instead of `{found}`"))
        .with_fix(Fix::replace(at, expected))
}

pub(super) fn unclosed_bracket(opened: Span, expected: &str, end: Span) -> Diagnostic {
    Diagnostic::error("E0101", format!("`{expected}` is missing"), opened, "this bracket is never closed")
        .with_label(end, format!("`{expected}` belongs before this place"))
        .with_help(format!("write `{expected}` where the bracket ends"))
}

/// `text` is the string up to the end of its line.
pub(super) fn unterminated_string(span: Span, text: &str) -> Diagnostic {
    let is_word = |c: char| c.is_alphanumeric() || matches!(c, '"' | '_' | '-' | '.' | '/');
    let word = text.trim_end();
    // Behind anything but a word the end of the string is unknown.
    let fix = word.chars().all(is_word).then(|| Fix::insert(span.start + word.len() as u32, "\""));
    Diagnostic::error("E0103", "the string has no closing quote", span, "runs to the end of the line")
        .with_help("write `\"` at its end; a line break inside a string is `\\n`")
        .with_fix(fix)
}

/// The comment begins at byte `at` of `text` and is `length` bytes long.
pub(super) fn block_comment(text: &str, at: usize, length: usize) -> Diagnostic {
    let help = "begin each line of the comment with `//`";
    Diagnostic::error("E0104", "comments have no `/*` form", Span::new(at, at + 2), "not a comment here")
        .with_help(help)
        .with_fix(repair::block_comment(help, text, at, length))
}

/// The character that begins at byte `at` of `text`.
pub(super) fn bad_character(text: &str, at: usize, character: char) -> Diagnostic {
    let span = Span::new(at, at + character.len_utf8());
    // Marks that turn the direction of text, or have no width, would garble the line.
    let is_invisible = matches!(character, '\u{200B}'..='\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2060}'..='\u{206F}' | '\u{FEFF}');
    let message = if character.is_control() || character.is_whitespace() || is_invisible {
        format!("the character U+{:04X} has no meaning here", u32::from(character))
    } else {
        format!("the character `{character}` has no meaning here")
    };
    let help = match character {
        ';' => "remove it: a new line ends an item, a new line or `,` an entry",
        '^' => "write a power as `pow(a, b)`",
        '?' => "write a choice as `if condition then a else b`",
        '\'' | '‘' | '’' | '“' | '”' => "write strings between two `\"`",
        '×' | '·' => "write `*`",
        '÷' => "write `/`",
        '−' | '–' | '—' => "write `-`",
        '°' => "write degrees as `45deg`",
        'π' => "write `pi`",
        character if character.is_whitespace() => "write a plain space",
        character if character.is_alphabetic() => "write names with the letters `a` to `z`, digits and `_`",
        _ => "remove it",
    };
    Diagnostic::error("E0104", message, span, "not part of the language")
        .with_help(help)
        .with_fix(repair::bad_character(text, span, character))
}

pub(super) fn wrong_version(span: Span, version: &str) -> Diagnostic {
    let message = match version {
        "" => "the version of the language is missing".to_owned(),
        _ => format!("this program does not read version {} of the language", quoted(version)),
    };
    Diagnostic::error("E0110", message, span, "only version 1 is known")
        .with_help("write `#vol 1`")
        .with_fix(Fix::replace(span, "#vol 1"))
}

/// `end` is the end of the entry before.
pub(super) fn missing_comma(at: Span, end: u32) -> Diagnostic {
    Diagnostic::error("E0105", "two entries share a line without a comma", at, "a new entry begins here")
        .with_help("write `,` before it, or begin a new line")
        .with_fix(Fix::insert(end, ","))
}

/// Numbers at `others` that follow the one at `value` without brackets around them all.
pub(super) fn loose_components(value: Span, others: Span, text: &str) -> Diagnostic {
    let all = value.to(others);
    let inside = text.get(all.start as usize..all.end as usize).unwrap_or_default();
    let first = text.get(others.start as usize..others.end as usize).unwrap_or_default();
    let first = first.split(',').next().unwrap_or_default().trim();
    Diagnostic::error(
        "E0102",
        format!("expected a key, found {}", quoted(first)),
        others,
        "not expected here",
    )
    .with_help(format!("write a vector in brackets: `({inside})`"))
    .with_fix(Fix::new(
        "put the vector into brackets",
        [(Span { end: all.start, ..all }, "("), (Span { start: all.end, ..all }, ")")],
    ))
}

pub(super) fn stray_comma(at: Span) -> Diagnostic {
    Diagnostic::error("E0102", "expected an entry before `,`", at, "nothing stands before this")
        .with_help("remove the `,`")
        .with_fix(Fix::remove(at))
}

pub(super) fn unknown_unit(at: Span, number: &str, unit: &str) -> Diagnostic {
    let meant = match unit {
        "m" | "cm" | "mm" | "km" | "px" | "f" | "f32" => Some(""),
        "d" | "degree" | "degrees" => Some("deg"),
        "sec" | "second" | "seconds" => Some("s"),
        "turns" | "rev" => Some("turn"),
        "radians" | "radian" => Some("rad"),
        _ => None,
    };
    let help = match meant {
        Some("") => format!("lengths have no unit: write `{number}`"),
        Some(known) => format!("write `{number}{known}`"),
        None => format!("write `{number}`, or a number with one of these units, such as `45deg`"),
    };
    let message = format!("{} is not a unit", quoted(unit));
    Diagnostic::error("E0106", message, at, format!("the units are {UNITS}"))
        .with_help(help)
        .with_fix(meant.map(|known| Fix::replace(at, known)))
}

pub(super) fn suspicious_angle(at: Span, digits: &str, unit: &str, meant: &str) -> Diagnostic {
    let message = format!("`{digits}{unit}` is an unusual angle");
    let label = format!("looks like a number of {}", if meant == "deg" { "degrees" } else { "radians" });
    Diagnostic::warning("W0110", message, at, label)
        .with_help(format!("write `{digits}{meant}`, or another number if `{unit}` is meant"))
}

pub(super) fn number_too_large(at: Span) -> Diagnostic {
    Diagnostic::error("E0107", "the number is too large", at, "not representable")
        .with_help("write a smaller number")
}

pub(super) fn not_a_color(at: Span, found: &str) -> Diagnostic {
    let message = format!("{} is not a colour", quoted(found));
    let error = Diagnostic::error("E0108", message, at, "needs three or six hexadecimal digits");
    match found.get(..7).filter(|_| found.len() == 9 && found[1..].bytes().all(|b| b.is_ascii_hexdigit())) {
        Some(opaque) => error
            .with_help(format!("write `{opaque}`: a colour has no transparency"))
            .with_fix(Fix::replace(at, opaque)),
        None => error.with_help("write a colour as `#rrggbb`, for example `#ff8800`"),
    }
}

pub(super) fn unknown_escape(at: Span, found: &str) -> Diagnostic {
    let message = format!("{} is not an escape", quoted(found));
    Diagnostic::error("E0109", message, at, "unknown after `\\`")
        .with_help("escapes are `\\\"`, `\\\\`, `\\n`, `\\t` and `\\u{…}`; a backslash itself is `\\\\`")
        .with_fix(Fix::insert(at.start, "\\"))
}

pub(super) fn long_tuple(at: Span, count: usize) -> Diagnostic {
    let message = format!("a vector has two to four components, this one has {count}");
    Diagnostic::error("E0112", message, at, "too many components")
        .with_help("write a list as `[a, b, c, d, e]`")
        .with_fix(Fix::new(
            "make it a list",
            [(Span { end: at.start + 1, ..at }, "["), (Span { start: at.end - 1, ..at }, "]")],
        ))
}

pub(super) fn not_a_parameter(at: Span) -> Diagnostic {
    Diagnostic::error("E0102", "expected a name before `=>`", at, "the parameters of a function are names")
        .with_help("write a function as `t => …` or `(t, l) => …`")
}

pub(super) fn not_an_argument_name(at: Span) -> Diagnostic {
    Diagnostic::error("E0102", "expected a name before `:`", at, "the name of an argument is one word")
        .with_help("write a named argument as `name: value`")
}

pub(super) fn not_a_key(at: Span) -> Diagnostic {
    Diagnostic::error("E0102", "expected `:` after the place of a key", at, "a key has a place and a value")
        .with_help("write keys as `keys(time, 0s: a, 2s: b)`")
}

pub(super) fn empty_keys(at: Span) -> Diagnostic {
    Diagnostic::error("E0102", "expected what runs along the keys", at, "nothing stands here")
        .with_help("write keys as `keys(time, 0s: a, 2s: b)`")
}

pub(super) fn empty_brackets(at: Span) -> Diagnostic {
    Diagnostic::error("E0102", "expected an expression between `(` and `)`", at, "nothing stands here")
        .with_help("write a value between them, or a function without parameters as `() => …`")
}

pub(super) fn not_a_range(at: Span) -> Diagnostic {
    Diagnostic::error("E0102", "expected a range after `in`", at, "this is one value")
        .with_help("write the lowest and the highest value as `in 0..10`")
}

/// `stray` is a sign between the head of the block and its `{`.
pub(super) fn expected_block(at: Span, keyword: &str, named: bool, stray: Option<Span>) -> Diagnostic {
    let form = if named { format!("{keyword} name {{ … }}") } else { format!("{keyword} {{ … }}") };
    Diagnostic::error("E0102", "expected `{`", at, format!("the {keyword}'s `{{` belongs before this"))
        .with_help(format!("write `{form}`"))
        .with_fix(stray.map(Fix::remove))
}

pub(super) fn after_block(at: Span, found: &str) -> Diagnostic {
    let message = format!("expected an item, found {}", quoted(found));
    Diagnostic::error("E0102", message, at, "not expected after the block").with_help("remove it")
}

/// Item words for the help lines.
fn item_words() -> impl Iterator<Item = &'static str> {
    ["import", "param", "let", "fn"].into_iter().chain(BLOCK_KINDS.iter().map(|kind| kind.keyword()))
}

/// An item that begins with a word that begins none, or with no word at all.
pub(super) fn unknown_item(at: Span, found: &str, next: Option<&str>) -> Diagnostic {
    let known = item_words().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ");
    let is_word = found.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    let (help, fix) = match (next, nearest(found, item_words())) {
        (Some("="), _) if is_word => {
            (format!("write `let {found} = …`"), Some(Fix::insert(at.start, "let ")))
        }
        _ if matches!(found, "function" | "func" | "def") => {
            ("write `fn name(x: float) -> float { … }`".to_owned(), Some(Fix::replace(at, "fn")))
        }
        _ if matches!(found, "var" | "const" | "float") => {
            ("write `let name = …`".to_owned(), Some(Fix::replace(at, "let")))
        }
        _ if found.starts_with('#') => {
            let sign = Span { end: at.start + 1, ..at };
            ("begin a comment with `//`".to_owned(), Some(Fix::replace(sign, "//")))
        }
        (_, Some(word)) => (format!("did you mean `{word}`"), Some(Fix::replace(at, word))),
        (Some("("), None) if is_word => {
            (format!("write `object name {{ shape: {found}(…) }}`, or `let name = {found}(…)`"), None)
        }
        _ => (format!("items begin with {known}"), None),
    };
    let message = format!("{} does not begin an item", quoted(found));
    Diagnostic::error("E0113", message, at, "expected an item here").with_help(help).with_fix(fix)
}
