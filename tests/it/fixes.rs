//! Repairs: each one of the scenes of `tests/ui`, made, does away with its message and brings no
//! new error.

use crate::support::{Diagnosed, diagnose, ensure, scenes_in};
use libtest_mimic::{Failed, Trial};
use std::path::{Path, PathBuf};
use vol_language::diag::{Diagnostic, Fix};
use vol_language::source::{SourceFile, Sources};

/// Scenes of which a repair uncovers another error, with the reason.
const UNCOVERS: [(&str, &str); 2] = [
    ("syntax_escape", "the text that can be read now is none that `lighting` takes"),
    ("syntax_missing_comma_in_vector", "two commas are missing, and the grammar stops at the first"),
];

/// The trials of this file: one per scene with a repair.
pub(crate) fn trials() -> Vec<Trial> {
    let scene = |(name, path): (String, PathBuf)| {
        Trial::test(format!("fixes::{name}"), move || check_scene(&name, &path))
    };
    let mut trials: Vec<Trial> = scenes_in("tests/ui").into_iter().map(scene).collect();
    trials.push(Trial::test("fixes::there_are_fixes", there_are_fixes));
    trials
}

fn read(path: &Path) -> Result<SourceFile, Failed> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    Ok(SourceFile::new("scene.vol", text))
}

fn check_scene(name: &str, path: &Path) -> Result<(), Failed> {
    let file = read(path)?;
    let Diagnosed { diagnostics: before, sources, .. } = diagnose(file.clone());
    for diagnostic in &before {
        for fix in diagnostic.fixes.iter().filter(|fix| is_in_scene(fix, &sources)) {
            check_fix(name, &file, &before, diagnostic, fix)?;
        }
    }
    Ok(())
}

/// Whether a repair is one of the scene's own file, not of one that it imports.
fn is_in_scene(fix: &Fix, sources: &Sources) -> bool {
    fix.edits.iter().all(|edit| std::ptr::eq(sources.locate(edit.span).0, sources.root()))
}

fn check_fix(
    name: &str,
    file: &SourceFile,
    before: &[Diagnostic],
    diagnostic: &Diagnostic,
    fix: &Fix,
) -> Result<(), Failed> {
    let repaired = SourceFile::new("scene.vol", fix.apply(&file.text));
    let after = diagnose(repaired.clone()).diagnostics;
    let place = |diagnostic: &Diagnostic| diagnostic.labels.first().map(|label| label.span.start);
    let moved = place(diagnostic).map(|start| after_edits(start, fix));
    let is_same = |found: &Diagnostic| {
        found.code == diagnostic.code && found.message == diagnostic.message && place(found) == moved
    };
    let report = || format!("{}: {}\n{}\n{after:#?}", diagnostic.code, fix.title, repaired.text);
    ensure(!after.iter().any(is_same), || format!("the message is still there: {}", report()))?;
    let is_new = |found: &&Diagnostic| {
        found.is_error() && !before.iter().any(|old| old.code == found.code && old.message == found.message)
    };
    let uncovers = UNCOVERS.iter().any(|(scene, _)| *scene == name);
    ensure(uncovers || !after.iter().any(|found| is_new(&found)), || {
        format!("there is a new error: {}", report())
    })
}

/// Where a place of the text is once the edits before it are made.
fn after_edits(place: u32, fix: &Fix) -> u32 {
    let before = fix.edits.iter().filter(|edit| edit.span.end <= place);
    before.fold(place, |at, edit| at + edit.text.len() as u32 - (edit.span.end - edit.span.start))
}

fn there_are_fixes() -> Result<(), Failed> {
    let mut count = 0;
    for (_, path) in scenes_in("tests/ui") {
        let found = diagnose(read(&path)?).diagnostics;
        count += found.iter().map(|diagnostic| diagnostic.fixes.len()).sum::<usize>();
    }
    ensure(count >= 80, || format!("only {count} repairs"))
}
