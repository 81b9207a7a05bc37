//! What a program leaves out of the work because the scene does not need it, in words.
//!
//! In: a compiled program. Out: one sentence for each thing, with the name of its block: `medium gas: nothing
//! scatters, so no light is asked for its samples`. Each is true of every frame: it is read off constants of the
//! program, not off the numbers of a moment. It tells what `vol check --verbose` and the list `dropped` of
//! `--stats` say.

use crate::ir::{Function, FunctionId, Inst, ValueId};
use crate::program::{Lighting, Medium, Program, Slot};
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// The sentences, in the order of the program's parts.
#[must_use]
pub fn dropped(program: &Program) -> Vec<String> {
    let mut list = program.report.clone();
    list.extend(switched_off(program));
    list.extend(in_parts(program));
    list.extend(program.media.iter().flat_map(|medium| of_medium(program, medium)));
    list.extend(of_lights(program));
    list.extend(unread_params(program));
    list.extend(unasked_fields(program));
    list.extend(hoisted(program));
    list
}

/// The number that a slot holds in every frame.
fn always(program: &Program, Slot(slot): Slot) -> Option<f64> {
    let frame = &program.module.frame;
    constant(frame, frame.outputs[slot as usize])
}

fn constant(function: &Function, value: ValueId) -> Option<f64> {
    match &function.insts[value.index()] {
        Inst::Constant(number) => Some(number.0),
        Inst::Boolean(truth) => Some(f64::from(u8::from(*truth))),
        Inst::Input(_) | Inst::Uniform(_) | Inst::Apply { .. } | Inst::Extract(..) | Inst::Loop { .. } => {
            None
        }
    }
}

/// Blocks that are there in no frame.
fn switched_off(program: &Program) -> Vec<String> {
    let objects = program.blocks_of_objects().map(|object| ("object", &object.name, object.enabled));
    let media = program.media.iter().map(|medium| ("medium", &medium.name, medium.enabled));
    let lights = program.lights.iter().map(|light| ("light", &light.name, light.enabled));
    let off = objects.chain(media).chain(lights).filter(|(.., slot)| always(program, *slot) == Some(0.0));
    off.map(|(kind, name, _)| format!("{kind} `{name}`: `when` is never true, so it is in no frame"))
        .collect()
}

/// Solids that are marched in parts.
fn in_parts(program: &Program) -> Vec<String> {
    let parts = |whole: usize| program.objects[whole..].iter().take_while(|part| part.whole == whole).count();
    let wholes =
        (0..program.objects.len()).map(|whole| (whole, parts(whole))).filter(|(_, parts)| *parts > 1);
    let sentence = |(whole, parts): (usize, usize)| {
        let name = &program.objects[whole].name;
        format!(
            "object `{name}`: the union of its {parts} solids; a ray asks only those whose boxes it meets"
        )
    };
    wholes.map(sentence).collect()
}

fn of_medium(program: &Program, medium: &Medium) -> Vec<String> {
    let interior = program.module.function(medium.interior);
    // Density, then rgb of scattering, extinction and emission.
    let is_zero = |first: usize| {
        interior.outputs[first..first + 3].iter().all(|&value| constant(interior, value) == Some(0.0))
    };
    let mut list = Vec::new();
    let mut say = |text: &str| list.push(format!("medium `{}`: {text}", medium.name));
    match medium.lighting {
        Lighting::None => say("lights do not matter to it, so none is asked for its samples"),
        Lighting::Unshadowed | Lighting::Shadowed if is_zero(1) => {
            say("nothing scatters, so no light is asked for its samples");
        }
        Lighting::Unshadowed => {
            say("its light is not weakened, so no rays are sent from its samples to lights");
        }
        Lighting::Shadowed => {}
    }
    if is_zero(7) {
        say("nothing glows, so nothing is computed for emission");
    }
    if (0..7).all(|output| constant(interior, interior.outputs[output]).is_some()) {
        say("it is the same everywhere, so its samples evaluate nothing but where it is");
    }
    list
}

fn of_lights(program: &Program) -> Vec<String> {
    let mut list = Vec::new();
    for light in program.lights.iter().filter(|light| always(program, light.shadows) == Some(0.0)) {
        list.push(format!("light `{}`: casts no shadows, so no rays are sent to it", light.name));
    }
    if program.lights.iter().all(|light| light.size.is_none()) {
        list.push("no light has a size, so nothing is computed for soft shadows".to_owned());
    }
    if program.lights.iter().all(|light| light.occlusion.is_none()) {
        list.push("no light has `occlusion`, so surfaces around a point are not looked for".to_owned());
    }
    list
}

/// Params on which nothing of the program depends.
fn unread_params(program: &Program) -> Vec<String> {
    let frame = &program.module.frame;
    let inputs = |inst: &Inst| match inst {
        Inst::Input(index) => Some(*index),
        Inst::Constant(_)
        | Inst::Boolean(_)
        | Inst::Uniform(_)
        | Inst::Apply { .. }
        | Inst::Extract(..)
        | Inst::Loop { .. } => None,
    };
    let read: BTreeSet<u32> = frame.insts.iter().filter_map(inputs).collect();
    let unread = program.params.iter().filter(|param| {
        let components = param.first_input..param.first_input + param.default.len() as u32;
        !components.into_iter().any(|input| read.contains(&input))
    });
    unread.map(|param| format!("param `{}`: nothing depends on it", param.name)).collect()
}

/// Functions that can be asked for by name and are in no picture.
fn unasked_fields(program: &Program) -> Option<String> {
    let objects = program.objects.iter().flat_map(|object| [object.distance, object.gradient]);
    let used: BTreeSet<FunctionId> =
        objects.chain(program.media.iter().map(|medium| medium.region)).collect();
    let count = program.fields.iter().filter(|field| !used.contains(&field.function)).count();
    (count > 0)
        .then(|| format!("{count} fields of `vol query`, from colours to functions: not run for pictures"))
}

/// How much of each function is computed once per frame; functions of parts of one solid have one name.
fn hoisted(program: &Program) -> Vec<String> {
    let mut counts = BTreeMap::<&str, usize>::new();
    for function in &program.module.functions {
        *counts.entry(&function.name).or_default() += operations_per_frame(&program.module.frame, function);
    }
    let mut seen = BTreeSet::new();
    let names = program.module.functions.iter().map(|function| &*function.name);
    let sentence = |name: &str| {
        let count = counts[name];
        let operations = if count == 1 { "operation is" } else { "operations are" };
        (count > 0).then(|| format!("`{name}`: {count} {operations} done once per frame"))
    };
    names.filter(|name| seen.insert(*name)).filter_map(sentence).collect()
}

/// Operations of the frame function that the uniforms of a function need.
fn operations_per_frame(frame: &Function, function: &Function) -> usize {
    let mut seen = HashSet::new();
    let uniforms = function.insts.iter().filter_map(|inst| match inst {
        Inst::Uniform(index) => Some(frame.outputs[*index as usize]),
        Inst::Constant(_)
        | Inst::Boolean(_)
        | Inst::Input(_)
        | Inst::Apply { .. }
        | Inst::Extract(..)
        | Inst::Loop { .. } => None,
    });
    let mut pending: Vec<ValueId> = uniforms.collect();
    while let Some(value) = pending.pop() {
        if seen.insert(value) {
            pending.extend_from_slice(frame.insts[value.index()].operands());
        }
    }
    let is_operation =
        |value: &&ValueId| matches!(frame.insts[value.index()], Inst::Apply { .. } | Inst::Loop { .. });
    seen.iter().filter(is_operation).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use vol_language::source::SourceFile;

    fn dropped_of(text: &str) -> Vec<String> {
        let (scene, _) =
            vol_language::analyse(&SourceFile::new("scene.vol", text), &crate::library::library());
        dropped(&crate::lower::compile(&scene.expect("a scene")).0.expect("a program"))
    }

    #[track_caller]
    fn assert_says(text: &str, expected: &[&str], unexpected: &[&str]) {
        let list = dropped_of(text);
        let says = |part: &&&str| list.iter().any(|sentence| sentence.contains(**part));
        assert!(expected.iter().all(|part| says(&part)), "{list:#?}");
        assert!(!unexpected.iter().any(|part| says(&part)), "{list:#?}");
    }

    #[test]
    fn media() {
        let glow =
            "medium glow { region: sphere(1), density: q => q.local.x, scatter: 0, absorb: 1, emit: 1 }";
        assert_says(glow, &["`glow`: nothing scatters"], &["nothing glows", "same everywhere"]);
        let fog = "medium fog { region: sphere(1), density: 2, absorb: 1 }";
        assert_says(
            fog,
            &["`fog`: nothing glows", "`fog`: it is the same everywhere"],
            &["nothing scatters"],
        );
        let bright = "medium fog { region: sphere(1), density: 2, lighting: unshadowed }";
        assert_says(bright, &["`fog`: its light is not weakened"], &["nothing scatters"]);
        let dark = "medium fog { region: sphere(1), density: 2, lighting: none }";
        assert_says(dark, &["`fog`: lights do not matter"], &["nothing scatters"]);
        // A param decides.
        let param = "param k: float = 0\nmedium fog { region: sphere(1), scatter: k, emit: k }";
        assert_says(param, &[], &["nothing scatters", "nothing glows"]);
    }

    #[test]
    fn lights_and_blocks() {
        let scene = "param on: bool = false\nobject a { shape: sphere(1), when: false }\n\
            object b { shape: sphere(1), when: on }\nlight sun { from: (1, 1, 1), shadows: false }";
        assert_says(
            scene,
            &["object `a`: `when`", "light `sun`: casts no", "no light has a size"],
            &["object `b`"],
        );
        let soft = "object a { shape: sphere(1) }\nlight sun { from: (1, 1, 1), spread: 5deg, occlusion: 1 }";
        assert_says(soft, &[], &["no light has", "casts no"]);
    }

    #[test]
    fn params_and_frames() {
        let scene = "param idle: float = 1\nparam r: float = 1\nlet _a = idle\n\
            object a { shape: sphere(r * r + sin(time)) }\nfn asked(p: vec3) -> float { p.x }";
        assert_says(
            scene,
            &["param `idle`: nothing", "`distance:a`: 3 operations are done once"],
            &["param `r`"],
        );
    }
}
