//! The stories of `vol explain`: every code has one, and their scenes do what they say.

use crate::support::{Diagnosed, diagnose, ensure, ensure_page};
use libtest_mimic::{Failed, Trial};
use std::path::Path;
use vol::explain::{Story, codes, codes_with_text, story};
use vol_language::diag::Diagnostic;
use vol_language::source::{MAX_SOURCE_BYTES, SourceFile};

/// Codes without scenes: in a text the parser is first to notice a range or a kind of block that does
/// not belong where it stands, and of our own mistakes there is no scene.
const WITHOUT_SCENES: [&str; 5] = ["E0221", "E0301", "E0702", "E0703", "E0704"];

/// Codes whose first scene is many files; the tests of `language/src/module.rs` have them.
const OF_MANY_FILES: [&str; 1] = ["E0604"];

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let scenes = |(code, _): (&'static str, _)| {
        Trial::test(format!("explain::{code}"), move || scenes(&known_story(code)?))
    };
    let mut trials: Vec<Trial> = codes().into_iter().map(scenes).collect();
    trials.push(Trial::test("explain::every_code_has_a_text", every_code_has_a_text));
    trials.push(Trial::test("explain::codes_are_found", codes_are_found));
    trials.push(Trial::test("docs::errors_are_current", || ensure_page("docs/errors.md", &page())));
    trials
}

fn known_story(code: &str) -> Result<Story, Failed> {
    story(code).map_err(|_| format!("{code} is not known").into())
}

/// The scenes that are too long to be shown, by code.
fn long_scene(code: &str) -> Option<String> {
    let numbered = |count: usize, line: fn(usize) -> String| (0..count).map(line).collect::<String>();
    Some(match code {
        "E0100" => format!("object row {{ shape: sphere(1){} }}", " | sphere(0.1)".repeat(300)),
        "E0111" => "// A table.\n".repeat(MAX_SOURCE_BYTES / 10),
        "E0115" => format!("camera {{\n{}}}\n", numbered(120, |i| format!("  {i} {i},\n"))),
        "E0226" => {
            format!("let _deep = {}1{}\nobject ball {{ shape: sphere(1) }}\n", "[".repeat(50), "]".repeat(50))
        }
        "E0232" => {
            let parameters = numbered(65, |i| format!("_a{i}: float = {i}, "));
            format!("fn total({parameters}) -> float {{ 1 }}\nobject ball {{ shape: sphere(total()) }}\n")
        }
        "E0402" => {
            let step = |i: usize| format!("let f{} = f{i}{}\n", i + 1, ".rotate_y(1deg)".repeat(60));
            format!(
                "let f0 = sphere(1)\n{}object ball {{ shape: f10 }}\n",
                (0..10).map(step).collect::<String>()
            )
        }
        _ => return None,
    })
}

/// The first scene has this mistake and no other, the second none.
fn scenes(story: &Story) -> Result<(), Failed> {
    let code = story.code;
    if WITHOUT_SCENES.contains(&code) {
        return ensure((story.before(), story.after()) == (None, None), || format!("{code} has scenes"));
    }
    if !OF_MANY_FILES.contains(&code) {
        has_mistake(story)?;
    }
    has_none(story)
}

fn has_mistake(story: &Story) -> Result<(), Failed> {
    let code = story.code;
    let before = match (story.before(), long_scene(code)) {
        (Some(shown), None) => shown.to_owned(),
        (None, Some(long)) => long,
        (None, None) => return Err("there is no scene with the mistake".into()),
        (Some(_), Some(_)) => return Err("the scene is shown, but another one is tested".into()),
    };
    let found = messages(code, "before.vol", &before)?;
    let found: Vec<&str> = found.iter().map(|diagnostic| diagnostic.code).collect();
    ensure(!found.is_empty() && found.iter().all(|found| *found == code || is_flood(code, found)), || {
        format!("the scene before gives {found:?}")
    })?;
    ensure(found.contains(&code), || format!("the scene before gives {found:?}"))
}

fn has_none(story: &Story) -> Result<(), Failed> {
    let after = story.after().ok_or("there is no scene after")?;
    let compiles = diagnose(SourceFile::new("after.vol", after)).program.is_some();
    let found = messages(story.code, "after.vol", after)?;
    ensure(compiles && found.is_empty(), || format!("the scene after gives {found:#?}"))
}

/// What there is to say about a scene; what `vol stress` says where the code is one of its own.
fn messages(code: &str, name: &str, text: &str) -> Result<Vec<Diagnostic>, Failed> {
    let Diagnosed { program, mut diagnostics, .. } = diagnose(SourceFile::new(name, text));
    if let Some(program) = program.filter(|_| vol::stress::CODES.iter().any(|(own, _)| *own == code)) {
        diagnostics.extend(crate::stress::report(&program)?.diagnostics);
    }
    Ok(diagnostics)
}

/// Whether the code is about too many other messages, of which this is one.
fn is_flood(code: &str, found: &str) -> bool {
    code == "E0115" && found == "E0102"
}

fn every_code_has_a_text() -> Result<(), Failed> {
    let known: Vec<&str> = codes().into_iter().map(|(code, _)| code).collect();
    ensure(known == codes_with_text(), || {
        format!("the codes and the list in src/explain.rs differ:\n{known:?}\n{:?}", codes_with_text())
    })?;
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/explain");
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        files.push(entry?.file_name().to_string_lossy().into_owned());
    }
    files.sort();
    let expected: Vec<String> = known.iter().map(|code| format!("{code}.md")).collect();
    ensure(files == expected, || format!("files without a code, or the other way round: {files:?}"))
}

fn codes_are_found() -> Result<(), Failed> {
    ensure(story("e0203").is_ok_and(|story| story.code == "E0203"), || "e0203 is not found".into())?;
    ensure(story("E203") == Err(Some("E0203")), || "E203 has no suggestion".into())?;
    ensure(story("sphere") == Err(None), || "sphere is near to a code".into())
}

/// The page about all codes.
fn page() -> String {
    let mut page = String::from(
        "# Messages\n\n<!-- Written by `VOL_UPDATE_DOCS=1 cargo test --test it -- docs::` from src/explain. -->\n\n\
         Every message of `vol` about a scene has a code. `vol explain CODE` shows what is below about one,\n\
         `vol explain` the list of all.\n\n| code | meaning |\n|---|---|\n",
    );
    for (code, meaning) in codes() {
        page += &format!("| [{code}](#{}) | {} |\n", code.to_lowercase(), meaning.replace('|', "\\|"));
    }
    for (code, _) in codes() {
        page += &story(code).map_or_else(|_| String::new(), |story| format!("\n{}", story.markdown()));
    }
    page
}
