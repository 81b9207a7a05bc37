//! `docs/shapes.md`, `docs/figures.md`, `docs/tubes.md` and `docs/volumes.md`: every scene on them is right on both backends, and none is missing.

use crate::support::{compile, ensure, frame};
use crate::{differential, docs, examples, spec};
use libtest_mimic::{Failed, Trial};
use std::path::Path;
use vol::backend::Device;
use vol_compiler::frame::{Frame, Quadrature};
use vol_compiler::library::library;
use vol_compiler::program::Program;

/// The pages, each with a folder of pictures.
const PAGES: [&str; 4] = ["shapes", "figures", "tubes", "volumes"];

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = vec![
        Trial::test("pages::every_scene_has_a_picture", every_scene_has_a_picture),
        Trial::test("pages::no_shape_is_missing", no_shape_is_missing),
    ];
    let named = |page| scenes(page).into_iter().map(move |(name, text)| (format!("{page}_{name}"), text));
    for (name, text) in PAGES.into_iter().flat_map(named) {
        let scene = text.clone();
        let reference = move || {
            let program = program(&scene)?;
            fields(&program)?;
            examples::reference(&program)
        };
        trials.push(Trial::test(format!("pages::{name}_agrees_with_the_reference"), reference));
        #[cfg(feature = "gpu")]
        {
            let name = format!("pages::{name}_agrees_with_the_cpu");
            trials.push(crate::gpu_device::gpu_trial(&name, move |gpu| {
                examples::agrees(gpu, &program(&text)?, Quadrature::Midpoint)
            }));
        }
    }
    trials
}

fn text_of(page: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("docs/{page}.md"));
    std::fs::read_to_string(path).unwrap_or_default()
}

fn program(text: &str) -> Result<Program, Failed> {
    compile("page.vol", text)
}

/// Distances, gradients and colours in f32 against f64.
fn fields(program: &Program) -> Result<(), Failed> {
    let frame = frame(program, 0.0, [8, 8])?;
    let evaluate = |program: &Program, frame: &Frame, id, points: &[[f32; 3]]| {
        Device::Cpu.evaluate(program, frame, id, points).map_err(|failure| format!("{failure:?}").into())
    };
    for (name, report) in differential::compare_fields(program, &frame, 300, &evaluate)? {
        ensure(report.passes(), || format!("{name}: {report:?}"))?;
    }
    Ok(())
}

/// Each block under a name, behind the last one that stands under none.
fn scenes(page: &str) -> Vec<(String, String)> {
    let (text, mut scenes, mut shared) = (text_of(page), Vec::new(), String::new());
    let lines: Vec<&str> = text.lines().collect();
    for (first_line, block) in spec::blocks(&text) {
        // The fence stands before the first line, which counts from 1.
        let above = lines[..first_line - 2].iter().rev();
        let heading = above.copied().find(|line| line.starts_with("## ") || line.starts_with("### "));
        match heading.and_then(|line| line.strip_prefix("### ")) {
            Some(name) => scenes.push((name.trim_matches('`').to_owned(), format!("{shared}{block}"))),
            None => shared = block,
        }
    }
    scenes
}

fn every_scene_has_a_picture() -> Result<(), Failed> {
    for page in PAGES {
        let (text, scenes) = (text_of(page), scenes(page));
        ensure(!scenes.is_empty(), || format!("docs/{page}.md has no scenes"))?;
        for (name, _) in scenes {
            let picture = format!("![{name}]({page}/{name}.png)");
            ensure(text.contains(&picture), || format!("`{name}` shows no picture"))?;
            let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("docs/{page}/{name}.png"));
            ensure(file.exists(), || format!("{} is missing: run `scripts/gallery`", file.display()))?;
        }
    }
    Ok(())
}

/// Every function that gives a solid or a material, and every blend in every operator.
fn no_shape_is_missing() -> Result<(), Failed> {
    let scenes = scenes("shapes");
    let shown = |call: &str| scenes.iter().any(|(_, text)| text.contains(call));
    for signature in library().signatures {
        let asked = ["primitives", "operators", "transforms", "materials"];
        let is_asked = asked.contains(&docs::group(&signature, false));
        let call = format!("{}(", signature.name);
        let by_operator = ["union", "intersect", "subtract"].contains(&signature.name);
        ensure(!is_asked || by_operator || shown(&call), || format!("`{call}…)` is not on the page"))?;
    }
    for operator in ["union", "intersection", "difference"] {
        for blend in ["", "smooth_", "chamfer_", "stairs_"] {
            let name = format!("{blend}{operator}");
            ensure(scenes.iter().any(|(found, _)| *found == name), || format!("there is no `{name}`"))?;
        }
    }
    Ok(())
}
