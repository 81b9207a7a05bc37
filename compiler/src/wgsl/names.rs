//! Names, types and literals in WGSL.

use std::fmt::Write as _;

/// A number that every WGSL compiler reads back bit for bit.
pub(super) fn literal(number: f32) -> String {
    // Rust's shortest form of the largest f32 is refused by Tint, and -0.0f loses its sign.
    if number.abs() == f32::MAX {
        let sign = if number < 0.0 { "-" } else { "" };
        return format!("({sign}0x1.fffffep+127f)");
    }
    if number == 0.0 && number.is_sign_negative() {
        return "bitcast<f32>(0x80000000u)".to_owned();
    }
    if number < 0.0 { format!("({number:?}f)") } else { format!("{number:?}f") }
}

/// What an IR function is called: by its number, since names need not differ, and by its name, for people.
#[must_use]
pub fn function(index: usize, name: &str) -> String {
    format!("vol_f{index}_{}", function_word(name)).trim_end_matches('_').to_owned()
}

/// A name like `density:cloud` as part of an identifier, never with two underscores in a row, which not all languages allow.
pub(crate) fn function_word(name: &str) -> String {
    let plain: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).take(40).collect();
    plain.split('_').filter(|part| !part.is_empty()).collect::<Vec<_>>().join("_")
}

/// A name of a function as it may stand in a comment.
pub(super) fn comment(name: &str) -> String {
    let harmless = |c: char| if c.is_ascii_graphic() || c == ' ' { c } else { ' ' };
    name.chars().take(120).map(harmless).collect::<String>().trim().to_owned()
}

/// The type that holds so many outputs.
pub(crate) fn output_type(outputs: usize) -> String {
    match outputs {
        0 | 1 => "f32".to_owned(),
        2..=4 => format!("vec{outputs}f"),
        _ => format!("VolOut{outputs}"),
    }
}

/// What follows a value of [`output_type`] to read output `i`.
pub(super) fn output_field(outputs: usize, i: usize) -> String {
    match outputs {
        0 | 1 => String::new(),
        2..=4 => [".x", ".y", ".z", ".w"][i].to_owned(),
        _ => format!(".v{i}"),
    }
}

/// A value of [`output_type`] from its parts.
pub(super) fn output_value(parts: &[String]) -> String {
    match parts {
        [] => "0.0f".to_owned(),
        [single] => single.clone(),
        _ => format!("{}({})", output_type(parts.len()), parts.join(", ")),
    }
}

/// The structure behind [`output_type`], empty for built-in types.
pub(super) fn output_structure(outputs: usize) -> String {
    if outputs <= 4 {
        return String::new();
    }
    let mut text = format!("struct {} {{\n", output_type(outputs));
    for i in 0..outputs {
        let _ = writeln!(text, "  v{i}: f32,");
    }
    text.push_str("}\n\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_are_exact() {
        let cases = [
            (0.0, "0.0f"),
            (-0.0, "bitcast<f32>(0x80000000u)"),
            (1.0, "1.0f"),
            (-2.5, "(-2.5f)"),
            (0.1, "0.1f"),
            (1e-7, "1e-7f"),
            (1e20, "1e20f"),
            (f32::MAX, "(0x1.fffffep+127f)"),
            (f32::MIN, "(-0x1.fffffep+127f)"),
            (1e-45, "1e-45f"),
        ];
        for (number, expected) in cases {
            assert_eq!(literal(number), expected);
        }
    }

    #[test]
    fn naga_reads_the_bits_back() {
        let mut random = crate::ir::verify::random::Random::new(5);
        let finite = (0..3000).map(|_| f32::from_bits(random.bits() as u32)).filter(|x| x.is_finite());
        let numbers: Vec<f32> = finite.chain([f32::MAX, f32::MIN, f32::MIN_POSITIVE, 1e-45]).collect();
        let mut text = String::new();
        for (i, &number) in numbers.iter().enumerate() {
            let _ = writeln!(text, "const c{i}: f32 = {};", literal(number));
        }
        let module = naga::front::wgsl::parse_str(&text).expect("constants parse");
        for ((_, constant), &number) in module.constants.iter().zip(&numbers) {
            let value = &module.global_expressions[constant.init];
            let naga::Expression::Literal(naga::Literal::F32(found)) = value else { panic!("{value:?}") };
            assert_eq!(found.to_bits(), number.to_bits(), "{number:?}");
        }
    }

    #[test]
    fn comments_stay_on_their_line() {
        assert_eq!(comment("a\n*/ fn b() {}\u{2028}c"), "a */ fn b() {} c");
    }
}
