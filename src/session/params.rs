//! Values of params set from outside: `-D spin=70deg`.
//!
//! A value is written as in the language, so the language itself reads it: `70deg` for the param
//! `spin: angle` is checked as the one-line scene `param spin: angle = 70deg`.

use vol_compiler::library;
use vol_compiler::program::Param;
use vol_language::diag::Diagnostic;
use vol_language::hir;
use vol_language::module::Module;
use vol_language::nearest::nearest;
use vol_language::source::SourceFile;
use vol_language::ty::Type;

use crate::failure::Failure;

/// The error of a scene that draws nothing, as the one-line scene of a value does.
const NOTHING_TO_DRAW: &str = "E0313";

/// The values of all params in order; of two definitions of one param the last counts.
pub(super) fn values(params: &[Param], definitions: &[(String, String)]) -> Result<Vec<Vec<f64>>, Failure> {
    let mut values: Vec<Vec<f64>> = params.iter().map(|param| param.default.clone()).collect();
    for (name, text) in definitions {
        let index = params.iter().position(|param| param.name == *name);
        let index = index.ok_or_else(|| unknown(name, params))?;
        values[index] = value(&params[index], text)?;
    }
    Ok(values)
}

fn unknown(name: &str, params: &[Param]) -> Failure {
    let failure = Failure::usage(format!("the scene has no param `{name}`"));
    let names: Vec<&str> = params.iter().map(|param| param.name.as_str()).collect();
    match nearest(name, names.iter().copied()) {
        Some(near) => failure.with_help(format!("did you mean `{near}`?")),
        None if names.is_empty() => failure.with_help("this scene has no params"),
        None => failure.with_help(format!("its params are: {}", names.join(", "))),
    }
}

fn value(param: &Param, text: &str) -> Result<Vec<f64>, Failure> {
    let refused = |why: &str| {
        let Param { name, ty, default, .. } = param;
        let help = format!("`{name}` is of type {ty}, for example -D '{name}={}'", written(ty, default));
        Failure::usage(format!("cannot set `{name}` to `{text}`: {why}")).with_help(help)
    };
    // Params of imported files have a dot in their names.
    let line = format!("param _given: {} = {text}\n", param.ty);
    let file = SourceFile::new("-D", line);
    let (ast, mut diagnostics) = vol_language::parse::parse(&file);
    let (scene, found) = vol_language::check::check(&[Module::root(ast, "")], &library::library());
    diagnostics.extend(found);
    let is_error = |diagnostic: &&Diagnostic| diagnostic.is_error() && diagnostic.code != NOTHING_TO_DRAW;
    if let Some(error) = diagnostics.iter().find(is_error) {
        return Err(refused(&error.message));
    }
    let value = only_value(&scene).ok_or_else(|| refused("this is not one value"))?;
    if let (Some((lo, hi)), [number]) = (param.range, value.as_slice())
        && !(lo..=hi).contains(number)
    {
        let [lo, hi] = [lo, hi].map(|end| written(&param.ty, &[end]));
        let text = format!("`{}` must be in {lo}..{hi}, not {}", param.name, written(&param.ty, &value));
        return Err(Failure::usage(text));
    }
    Ok(value)
}

/// The param's value if the text was one value and nothing else (no range, no further items).
fn only_value(scene: &hir::Scene) -> Option<Vec<f64>> {
    match scene.params.as_slice() {
        [param] if param.range.is_none() && is_bare(scene) => Some(param.default.clone()),
        _ => None,
    }
}

fn is_bare(scene: &hir::Scene) -> bool {
    scene.lets.is_empty() && scene.functions.is_empty() && scene.blocks.is_empty()
}

/// A value as the language writes it, to six digits.
pub fn written(ty: &Type, value: &[f64]) -> String {
    let number = |x: &f64| format!("{}", (x * 1e6).round() / 1e6);
    match (ty, value) {
        (Type::Bool, [x]) => (*x != 0.0).to_string(),
        (Type::Angle, [x]) => format!("{}deg", number(&x.to_degrees())),
        (Type::Color, parts) => format!("rgb({})", parts.iter().map(number).collect::<Vec<_>>().join(", ")),
        (_, [x]) => number(x),
        (_, parts) => format!("({})", parts.iter().map(number).collect::<Vec<_>>().join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::values;
    use vol_compiler::program::Param;
    use vol_language::ty::Type;

    fn params() -> Vec<Param> {
        let param = |name: &str, ty, default: &[f64], range| Param {
            name: name.to_owned(),
            ty,
            default: default.to_vec(),
            range,
            label: String::new(),
            first_input: 2,
        };
        vec![
            param("spin", Type::Angle, &[1.0], Some((0.0, 240_f64.to_radians()))),
            param("octaves", Type::Int, &[5.0], Some((1.0, 8.0))),
            param("on", Type::Bool, &[0.0], None),
            param("tint", Type::Color, &[1.0, 1.0, 1.0], None),
            param("place", Type::Vec3, &[0.0, 0.0, 0.0], None),
            param("amount", Type::Float, &[1.0], None),
        ]
    }

    fn set(name: &str, value: &str) -> Result<Vec<f64>, String> {
        let index = params().iter().position(|param| param.name == name).unwrap_or(0);
        let set = values(&params(), &[(name.to_owned(), value.to_owned())]);
        set.map(|values| values[index].clone()).map_err(|failure| format!("{failure:?}"))
    }

    #[test]
    fn values_are_written_as_in_the_language() {
        assert_eq!(set("spin", "180deg"), Ok(vec![std::f64::consts::PI]));
        assert_eq!(set("octaves", "8"), Ok(vec![8.0]));
        assert_eq!(set("on", "true"), Ok(vec![1.0]));
        assert_eq!(set("tint", "#ffffff"), Ok(vec![1.0; 3]));
        assert_eq!(set("place", "(1, -2, 3.5)"), Ok(vec![1.0, -2.0, 3.5]));
        assert_eq!(set("amount", "1.5"), Ok(vec![1.5]));
        assert_eq!(set("amount", "-2"), Ok(vec![-2.0]));
    }

    #[test]
    fn the_last_definition_counts() {
        let twice = [("octaves", "2"), ("octaves", "3")].map(|(n, v)| (n.to_owned(), v.to_owned()));
        assert_eq!(values(&params(), &twice).expect("fine")[1], [3.0]);
    }

    #[test]
    fn wrong_values_are_refused() {
        let bad = [
            ("spin", "70"),
            ("spin", "300deg"),
            ("octaves", "2.5"),
            ("octaves", "9"),
            ("on", "1"),
            ("tint", "red"),
            ("place", "(1, 2)"),
            ("amount", ""),
            ("amount", "1 in 0..2"),
            ("amount", "1\nlet a = 2"),
            ("amount", "1 2"),
        ];
        for (name, value) in bad {
            assert!(set(name, value).is_err(), "{name}={value}");
        }
    }

    #[test]
    fn messages_help() {
        let range = set("spin", "300deg").expect_err("range");
        assert!(range.contains("`spin` must be in 0deg..240deg, not 300deg"), "{range}");
        let name = set("octave", "3").expect_err("name");
        assert!(name.contains("did you mean `octaves`?"), "{name}");
    }
}
