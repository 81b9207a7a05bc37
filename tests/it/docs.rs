//! Tables of the documentation, generated from the program's own tables.
//!
//! A page holds `<!-- table: NAME -->` and `<!-- end -->`; what stands between them is compared with
//! what the program says, and written anew with `VOL_UPDATE_DOCS=1 cargo test --test it -- docs`.

use crate::support::ensure_page;
use libtest_mimic::{Failed, Trial};
use std::path::Path;
use vol_compiler::library::library;
use vol_compiler::skip;
use vol_language::blocks::{BLOCK_KINDS, Key};
use vol_language::hir::LocalField;
use vol_language::library::{DefaultValue, Parameter, Signature};
use vol_language::settings::{ChoiceKind, SettingsKind};
use vol_language::standard;
use vol_language::ty::Type;

const LANGUAGE: &str = "docs/language.md";
const PERFORMANCE: &str = "docs/performance.md";

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("docs::tables_are_current", tables_are_current),
        Trial::test("docs::every_function_is_in_a_table", every_function_is_in_a_table),
        Trial::test("docs::coverage_names_tests_that_exist", coverage_names_tests_that_exist),
    ]
}

fn read(page: &str) -> Result<String, Failed> {
    Ok(std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(page))?)
}

fn tables_are_current() -> Result<(), Failed> {
    for page in [LANGUAGE, PERFORMANCE] {
        ensure_page(page, &with_tables(&read(page)?)?)?;
    }
    Ok(())
}

fn every_function_is_in_a_table() -> Result<(), Failed> {
    let text = read(LANGUAGE)?;
    let all = standard::extended(&library());
    let missing: Vec<&str> = all
        .signatures
        .iter()
        .filter(|signature| !text.contains(&format!("| `{}(", signature.name)))
        .map(|signature| signature.name)
        .collect();
    if missing.is_empty() { Ok(()) } else { Err(format!("not in a table: {}", missing.join(", ")).into()) }
}

/// Every name in the last column is a scene of `tests/ui`, or stands in a source file or its path.
fn coverage_names_tests_that_exist() -> Result<(), Failed> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("docs/coverage.md"))?;
    let mut sources = String::new();
    for folder in ["tests/it", "language/src", "compiler/src", "runtime-cpu/src"] {
        read_all(&root.join(folder), &mut sources)?;
    }
    let mut missing = Vec::new();
    for row in text.lines().filter(|line| line.starts_with("| ")) {
        let tests = row.trim_end_matches(" |").rsplit(" | ").next().unwrap_or_default();
        for name in tests.split('`').skip(1).step_by(2) {
            let last = name.rsplit("::").next().unwrap_or(name);
            if !root.join(format!("tests/ui/{name}.vol")).exists() && !sources.contains(last) {
                missing.push(name.to_owned());
            }
        }
    }
    if missing.is_empty() { Ok(()) } else { Err(format!("no such test: {}", missing.join(", ")).into()) }
}

/// Paths and texts of all files below a folder.
fn read_all(folder: &Path, out: &mut String) -> Result<(), Failed> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        *out += &path.display().to_string();
        out.push('\n');
        match path.is_dir() {
            true => read_all(&path, out)?,
            false => *out += &std::fs::read_to_string(&path).unwrap_or_default(),
        }
    }
    Ok(())
}

/// The page with all its tables written anew.
fn with_tables(text: &str) -> Result<String, Failed> {
    let mut out = String::new();
    let mut skipping = false;
    for line in text.lines() {
        if let Some(name) = line.strip_prefix("<!-- table: ").and_then(|rest| rest.strip_suffix(" -->")) {
            out += &format!("{line}\n{}", table(name).ok_or_else(|| format!("there is no table `{name}`"))?);
            skipping = true;
        } else if line == "<!-- end -->" {
            skipping = false;
        }
        if !skipping {
            out += line;
            out.push('\n');
        }
    }
    Ok(out)
}

/// What is left out of the work, see [`skip::TABLE`].
fn skips() -> String {
    let rows = skip::TABLE.iter().map(|row| format!("| `{}` | {} |\n", row.name, row.about));
    format!("| name | what is left out, and what that changes |\n|---|---|\n{}", rows.collect::<String>())
}

fn table(name: &str) -> Option<String> {
    if let Some(kind) = BLOCK_KINDS.into_iter().find(|kind| kind.keyword() == name) {
        return Some(keys(&format!("key of `{name}`"), &kind.keys()));
    }
    Some(match name {
        "ease" => words(&[ChoiceKind::Ease]),
        "lighting" => words(&[ChoiceKind::Lighting]),
        "cloud_noise" => words(&[ChoiceKind::CloudNoise]),
        "words" => words(&[
            ChoiceKind::HoleFilling,
            ChoiceKind::Layer,
            ChoiceKind::Blend,
            ChoiceKind::LightMap,
            ChoiceKind::Stroke,
            ChoiceKind::Brush,
        ]),
        "settings" => [SettingsKind::Holes, SettingsKind::Heterogeneity]
            .map(|kind| keys(&format!("key of {}", kind.name()), &kind.keys()))
            .join("\n"),
        "local" => local(),
        "skips" => skips(),
        _ => {
            let library = standard::extended(&library());
            let own = library.signatures.len() - standard::signatures().len();
            let members = library.signatures.iter().enumerate();
            let members: Vec<&Signature> = members
                .filter(|(i, s)| group(s, *i >= own) == name)
                .map(|(_, signature)| signature)
                .collect();
            if members.is_empty() {
                return None;
            }
            functions(&members)
        }
    })
}

/// The table that a function stands in.
pub(crate) fn group(signature: &Signature, is_standard: bool) -> &'static str {
    let params = &signature.params;
    let is_shape = |index: usize| params.get(index).is_some_and(|param| param.ty == Type::Shape);
    let is_place = params.first().is_some_and(|param| param.name == "p");
    match signature.result {
        _ if is_standard => "standard",
        Type::Shape if is_shape(0) && (is_shape(1) || params[0].rest) => "operators",
        Type::Shape if is_shape(0) => "transforms",
        Type::Shape => "primitives",
        Type::Curve => "curves",
        Type::Material => "materials",
        Type::Phase => "phases",
        _ if is_place || ["hash", "random"].contains(&signature.name) => "noise",
        _ => "numbers",
    }
}

/// One row a function; forms that differ in types only share one.
fn functions(members: &[&Signature]) -> String {
    let mut out = "| function | gives | meaning |\n|---|---|---|\n".to_owned();
    let mut shown: Vec<(&str, &str)> = Vec::new();
    for signature in members {
        let key = (signature.name, signature.doc);
        if shown.contains(&key) {
            continue;
        }
        shown.push(key);
        let mut results: Vec<String> = Vec::new();
        for form in members.iter().filter(|form| (form.name, form.doc) == key) {
            let result = form.result.to_string();
            if !results.contains(&result) {
                results.push(result);
            }
        }
        let params: Vec<String> =
            signature.params.iter().map(|param| parameter(param, results.len() > 1)).collect();
        let results = results.join(" ");
        out += &format!(
            "| `{}({})` | `{results}` | {} |\n",
            signature.name,
            params.join(", "),
            cell(signature.doc)
        );
    }
    out
}

/// `octaves: int`, `seed: int = 0`; without the type where a function takes several.
fn parameter(param: &Parameter, is_general: bool) -> String {
    let mut text = param.name.to_owned();
    if !is_general {
        text += &format!(": {}", param.ty);
    }
    if param.rest {
        text += ", …";
    }
    match param.default {
        DefaultValue::Required => {}
        DefaultValue::Number(number) => text += &format!(" = {number}"),
        DefaultValue::Bool(truth) => text += &format!(" = {truth}"),
        DefaultValue::Word(word) => text += &format!(" = {word}"),
    }
    text
}

fn keys(title: &str, keys: &[Key]) -> String {
    let mut out = format!("| {title} | type | meaning |\n|---|---|---|\n");
    for key in keys {
        let required = if key.required { "; needed" } else { "" };
        out += &format!("| `{}` | `{}` | {}{required} |\n", key.name, key.ty, cell(key.doc));
    }
    out
}

fn words(kinds: &[ChoiceKind]) -> String {
    let mut out = "| choice | word | meaning |\n|---|---|---|\n".to_owned();
    for kind in kinds {
        for word in kind.words() {
            let params: Vec<String> =
                word.params.iter().map(|key| format!("{}: {}", key.name, key.ty)).collect();
            let form = if params.is_empty() {
                word.name.to_owned()
            } else {
                format!("{}({})", word.name, params.join(", "))
            };
            out += &format!("| {} | `{form}` | {} |\n", kind.name(), cell(word.doc));
        }
    }
    out
}

fn local() -> String {
    let mut out = "| field | type | meaning |\n|---|---|---|\n".to_owned();
    for (field, name, ty) in LocalField::ALL {
        out += &format!("| `q.{name}` | `{ty}` | {} |\n", cell(field.doc()));
    }
    out
}

/// Text that does not end its cell.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}
