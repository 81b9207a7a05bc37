//! The arrows of ARCHITECTURE.md, read from the manifests.

use libtest_mimic::{Failed, Trial};
use std::collections::BTreeSet;
use std::path::Path;

/// Which crates of the workspace, and which outside libraries with one owner, a manifest may name.
const ALLOWED: &[(&str, &[&str])] = &[
    ("language", &["pest", "pest_derive", "codespan-reporting"]),
    ("compiler", &["vol-language", "naga"]),
    ("runtime-cpu", &["vol-compiler", "rayon"]),
    ("runtime-gpu", &["vol-compiler", "wgpu", "pollster"]),
];

/// Libraries that only the crates above may name.
const OWNED: &[&str] = &[
    "vol-language",
    "vol-compiler",
    "vol-runtime-cpu",
    "vol-runtime-gpu",
    "pest",
    "pest_derive",
    "codespan-reporting",
    "naga",
    "rayon",
    "wgpu",
    "pollster",
    "clap",
    "indicatif",
];

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials: Vec<Trial> = ALLOWED
        .iter()
        .map(|&(name, allowed)| {
            Trial::test(format!("architecture::{name}_depends_on_what_it_may"), move || {
                let manifest = read(&format!("{name}/Cargo.toml"))?;
                match wrong_arrow(&manifest, allowed) {
                    None => Ok(()),
                    Some(arrow) => Err(format!("{name} must not depend on {arrow}").into()),
                }
            })
        })
        .collect();
    trials.push(Trial::test("architecture::canary_sees_a_wrong_arrow", || {
        let planted = "[dependencies]\nvol-language.workspace = true\nwgpu = \"30\"\n";
        match wrong_arrow(planted, &["vol-language"]) {
            Some(arrow) if arrow == "wgpu" => Ok(()),
            found => Err(format!("the planted dependency on wgpu was not reported: {found:?}").into()),
        }
    }));
    trials.push(Trial::test("architecture::libraries_keep_their_rooms", libraries_keep_their_rooms));
    trials
}

fn read(path: &str) -> Result<String, Failed> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()).into())
}

/// The first dependency of a manifest that has an owner and is not allowed.
fn wrong_arrow(manifest: &str, allowed: &[&str]) -> Option<String> {
    let mut section = "";
    for line in manifest.lines().map(str::trim) {
        if let Some(header) = line.strip_prefix('[') {
            section = header.trim_end_matches(']');
        } else if section.ends_with("dependencies")
            && let Some(name) = line.split(['=', '.', ' ']).next()
            && OWNED.contains(&name)
            && !allowed.contains(&name)
        {
            return Some(name.to_owned());
        }
    }
    None
}

/// Only `parse/lower` names pest's rules, only `diag/render` names codespan.
fn libraries_keep_their_rooms() -> Result<(), Failed> {
    let rooms = [("codespan_reporting", "diag/render"), ("pest::", "parse")];
    let mut offenders = BTreeSet::new();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("language/src");
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).map_err(|error| error.to_string())? {
            let path = entry.map_err(|error| error.to_string())?.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).map_err(|error| error.to_string())?;
            let name = path.strip_prefix(&root).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            for (library, room) in rooms {
                if text.contains(library) && !name.starts_with(room) {
                    offenders.insert(format!("{name} names {library}"));
                }
            }
        }
    }
    if offenders.is_empty() { Ok(()) } else { Err(format!("{offenders:?}").into()) }
}
