//! Numbers, colours and strings: from their text to values.

use crate::ast::ExprKind;
use crate::diag::Diagnostic;
use crate::parse::explain;
use crate::source::Span;

/// The value of a number with its unit, and what is wrong with it.
pub(super) fn number(text: &str, span: Span) -> (ExprKind, Option<Diagnostic>) {
    let (digits, unit) = text.split_at(unit_start(text));
    let value: f64 = digits.parse().unwrap_or(f64::INFINITY);
    let is_whole = digits.bytes().all(|byte| byte.is_ascii_digit());
    let kind = match unit {
        "" if is_whole => match digits.parse() {
            Ok(value) => ExprKind::Int(value),
            Err(_) => return (ExprKind::Int(0), Some(explain::number_too_large(span))),
        },
        "deg" => ExprKind::Angle(value.to_radians()),
        "rad" => ExprKind::Angle(value),
        "turn" => ExprKind::Angle(value * std::f64::consts::TAU),
        "ms" => ExprKind::Float(value / 1000.0),
        "" | "s" => ExprKind::Float(value),
        _ => {
            let at = Span { start: span.end - unit.len() as u32, end: span.end };
            return (ExprKind::Float(value), Some(explain::unknown_unit(at, digits, unit)));
        }
    };
    if matches!(kind, ExprKind::Float(value) | ExprKind::Angle(value) if !value.is_finite()) {
        return (ExprKind::Float(0.0), Some(explain::number_too_large(span)));
    }
    (kind, suspicious_angle(digits, value, unit, span))
}

/// A warning about an angle that was probably meant in another unit: `90rad`, `1.5708deg`, `180turn`.
fn suspicious_angle(digits: &str, value: f64, unit: &str, span: Span) -> Option<Diagnostic> {
    use std::f64::consts::PI;
    // Multiples of an eighth turn in radians, as people type them, have at least three decimals.
    let eighths = value / (PI / 4.0);
    let is_radians = digits.split('.').nth(1).is_some_and(|decimals| decimals.len() >= 3)
        && (0.5..16.5).contains(&eighths)
        && (eighths - eighths.round()).abs() < 2e-3;
    let is_degrees = value >= 45.0 && value % 15.0 == 0.0;
    let meant = match unit {
        "deg" if is_radians => "rad",
        "rad" | "turn" if is_degrees => "deg",
        _ => return None,
    };
    Some(explain::suspicious_angle(span, digits, unit, meant))
}

/// Where the unit begins; the `e` of an exponent is followed by a digit or a sign.
fn unit_start(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut exponent = false;
    for (i, byte) in bytes.iter().enumerate() {
        let next = bytes.get(i + 1).copied().unwrap_or(0);
        match byte {
            b'0'..=b'9' | b'.' => {}
            b'+' | b'-' if exponent && matches!(bytes[i - 1], b'e' | b'E') => {}
            b'e' | b'E' if !exponent && (next.is_ascii_digit() || matches!(next, b'+' | b'-')) => {
                exponent = true;
            }
            _ => return i,
        }
    }
    bytes.len()
}

/// The colour `#rrggbb` or `#rgb`.
pub(super) fn color(text: &str, span: Span) -> (ExprKind, Option<Diagnostic>) {
    let digits: Option<Vec<u8>> =
        text.chars().skip(1).map(|c| c.to_digit(16).map(|digit| digit as u8)).collect();
    match digits.as_deref() {
        Some(&[r, g, b]) => (ExprKind::Color([r * 17, g * 17, b * 17]), None),
        Some(&[r1, r0, g1, g0, b1, b0]) => {
            (ExprKind::Color([r1 * 16 + r0, g1 * 16 + g0, b1 * 16 + b0]), None)
        }
        _ => (ExprKind::Color([0; 3]), Some(explain::not_a_color(span, text))),
    }
}

/// The text between the quotes with its escapes resolved; one message per wrong escape.
pub(super) fn string(text: &str, span: Span) -> (ExprKind, Vec<Diagnostic>) {
    let inside = &text[1..text.len() - 1];
    let mut value = String::with_capacity(inside.len());
    let mut wrong = Vec::new();
    let mut rest = inside;
    while let Some(at) = rest.find('\\') {
        value.push_str(&rest[..at]);
        let (character, length) = escape(&rest[at..]);
        match character {
            Some(character) => value.push(character),
            None => {
                let start = span.start as usize + text.len() - 1 - rest.len() + at;
                wrong.push(explain::unknown_escape(Span::new(start, start + length), &rest[at..at + length]));
            }
        }
        rest = &rest[at + length..];
    }
    value.push_str(rest);
    (ExprKind::String(value), wrong)
}

/// The character that an escape stands for, if it is one, and its length; `text` begins with `\`.
fn escape(text: &str) -> (Option<char>, usize) {
    let mut characters = text.chars().skip(1);
    let simple = match characters.next() {
        Some('n') => '\n',
        Some('t') => '\t',
        Some('"') => '"',
        Some('\\') => '\\',
        Some('u') if characters.next() == Some('{') => {
            let Some(end) = text.find('}').filter(|&end| end <= 10) else { return (None, 3) };
            let code = u32::from_str_radix(&text[3..end], 16).ok();
            return (code.and_then(char::from_u32), end + 1);
        }
        Some(other) => return (None, 1 + other.len_utf8()),
        None => return (None, 1),
    };
    (Some(simple), 2)
}
