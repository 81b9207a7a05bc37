//! A prefix for all names that a WGSL text puts at module scope.
//!
//! In: a text of this crate, where such names stand at the start of a line. Out: the same text with `sky_distance` for
//! `vol_distance`, and with `sky_in_trace`, `Sky_in_Ray`, `SKY_IN_FAR` for `trace`, `Ray`, `FAR`, which nobody else is to
//! call; names inside functions and of fields stay.

use std::collections::HashSet;

/// Gives all names at module scope a prefix.
pub(super) fn prefixed(text: &str, prefix: &str) -> String {
    let declared = declared(text);
    let mut result = String::with_capacity(text.len() + text.len() / 8);
    for line in text.lines() {
        let (code, comment) = line.find("//").map_or((line, ""), |place| line.split_at(place));
        rename(code, &declared, prefix, &mut result);
        result.push_str(comment);
        result.push('\n');
    }
    result
}

/// Kinds of names at module scope.
struct Declared<'a> {
    /// Followed by a parenthesis wherever they are meant: variables may have the same name.
    functions: HashSet<&'a str>,
    others: HashSet<&'a str>,
}

fn declared(text: &str) -> Declared<'_> {
    let name = |line: &'_ str| line.find(|c: char| !is_of_name(c)).unwrap_or(line.len());
    let (mut functions, mut others) = (HashSet::new(), HashSet::new());
    for line in text.lines() {
        if let Some(rest) = line.strip_prefix("fn ") {
            functions.insert(&rest[..name(rest)]);
        } else if let Some(rest) =
            ["struct ", "const ", "var<private> "].iter().find_map(|word| line.strip_prefix(word))
        {
            others.insert(&rest[..name(rest)]);
        }
    }
    Declared { functions, others }
}

fn rename(code: &str, declared: &Declared<'_>, prefix: &str, result: &mut String) {
    let mut rest = code;
    let mut before = ' ';
    while let Some(first) = rest.chars().next() {
        if !is_of_name(first) {
            result.push(first);
            before = first;
            rest = &rest[first.len_utf8()..];
            continue;
        }
        let (word, after) = rest.split_at(rest.find(|c: char| !is_of_name(c)).unwrap_or(rest.len()));
        let is_global =
            declared.others.contains(word) || (declared.functions.contains(word) && after.starts_with('('));
        if is_global && before != '.' {
            result.push_str(&with_prefix(word, prefix));
        } else {
            result.push_str(word);
        }
        before = 'a';
        rest = after;
    }
}

/// A name with the prefix in its own spelling; names without this crate's are inner ones.
fn with_prefix(word: &str, prefix: &str) -> String {
    let own = ["vol_", "VOL_", "Vol"].iter().find_map(|own| word.strip_prefix(own));
    let bare = own.map_or_else(|| format!("in_{word}"), str::to_owned);
    if word.starts_with(char::is_lowercase) {
        return format!("{prefix}_{bare}");
    }
    if word.contains(char::is_lowercase) {
        let (first, rest) = prefix.split_at(1);
        return format!("{}{rest}_{bare}", first.to_uppercase());
    }
    format!("{prefix}_{bare}").to_uppercase()
}

fn is_of_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_at_module_scope_are_renamed() {
        let text = "const FAR: f32 = 2.0;\nstruct Ray {\n  turn: f32,\n}\nstruct VolFoot {\n  t: f32,\n}\n\
            fn vol_sin(x: f32) -> f32 {\n  return x; // vol_sin\n}\n\
            fn turn(ray: Ray) -> f32 {\n  let turn = ray.turn;\n  return vol_sin(turn) * FAR;\n}\n\
            fn f(ray: Ray) -> f32 { return turn(ray); }\n";
        let expected = "const SKY_IN_FAR: f32 = 2.0;\nstruct Sky_in_Ray {\n  turn: f32,\n}\nstruct Sky_Foot {\n  t: f32,\n}\n\
            fn sky_sin(x: f32) -> f32 {\n  return x; // vol_sin\n}\n\
            fn sky_in_turn(ray: Sky_in_Ray) -> f32 {\n  let turn = ray.turn;\n  return sky_sin(turn) * SKY_IN_FAR;\n}\n\
            fn sky_in_f(ray: Sky_in_Ray) -> f32 { return sky_in_turn(ray); }\n";
        assert_eq!(prefixed(text, "sky"), expected);
    }
}
