//! Messages: every scene of `tests/ui` with what the compiler says about it, compared with the
//! reviewed text beside it.

use crate::support::{compile_with_messages, scenes_in};
use libtest_mimic::{Failed, Trial};
use std::path::Path;

/// The trials of this file: one per scene.
pub(crate) fn trials() -> Vec<Trial> {
    let scene = |(name, path): (String, std::path::PathBuf)| {
        Trial::test(format!("ui::{name}"), move || check(&name, &path))
    };
    let mut trials: Vec<Trial> = scenes_in("tests/ui").into_iter().map(scene).collect();
    trials.push(Trial::test("ui::there_are_scenes", || {
        let count = scenes_in("tests/ui").len();
        if count >= 40 { Ok(()) } else { Err(format!("only {count} scenes in tests/ui").into()) }
    }));
    trials
}

fn check(name: &str, path: &Path) -> Result<(), Failed> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let (program, messages) = compile_with_messages(&format!("{name}.vol"), &text);
    // A scene here has something to say; one that is fine belongs elsewhere.
    if messages.is_empty() {
        return Err("the scene has no message".into());
    }
    let verdict = if program.is_some() { "compiles" } else { "fails" };
    insta::with_settings!({ snapshot_path => "../ui", prepend_module_to_snapshot => false, omit_expression => true }, {
        insta::assert_snapshot!(name, format!("{verdict}\n\n{messages}"));
    });
    Ok(())
}
