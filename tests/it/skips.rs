//! What is left out of the work changes no picture: each way of it is switched off and the pictures are compared.

use crate::support::{compile_without, ensure, examples, frame, render};
use libtest_mimic::{Failed, Trial};
use std::path::Path;
use std::sync::atomic::AtomicBool;
use vol::compare::color_error;
use vol_compiler::frame::{Image, Job, Quadrature, Sampling};
use vol_compiler::skip::{self, Skip, Skips};

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = Vec::new();
    for row in skip::TABLE.iter().filter(|row| in_one_picture(row.skip)) {
        for (name, path) in examples() {
            trials
                .push(Trial::test(format!("skips::{}::{name}", row.name), move || neutral(row.skip, &path)));
        }
    }
    for (skip, scene) in [(Skip::Tapes, many_parts()), (Skip::Objects, many_objects())] {
        let test = move || neutral_in(skip, &scene, [160, 90]);
        trials.push(Trial::test(format!("skips::{}::many", skip::TABLE[skip as usize].name), test));
    }
    trials.push(Trial::test("skips::spacings::galaxy", smooth_media_are_sampled_less));
    for (place, eye) in [("outside", "(4, 4, 9)"), ("inside", "(1.5, 1.5, 1.5)")] {
        trials.push(Trial::test(format!("skips::parts::seen_from_{place}"), move || {
            edges_stay(&union_of_many(eye))
        }));
    }
    trials
}

/// Boxes less balls, some blended and some with noise on them, in one solid, and a plane below: enough for an octree.
fn many_parts() -> String {
    let place = "(3 * fract(0.82 * i), 3 * fract(0.67 * i), 3 * fract(0.55 * i))";
    let parts = |kind: &str, from: u32, to: u32| {
        format!("[for i in {from}..{to}: ({kind}).rotate_y(17deg * i).translate({place})]")
    };
    let hollow = parts("box((0.2, 0.2, 0.2)) - sphere(0.26)", 0, 90);
    let blended = parts("sphere(0.25)", 90, 130);
    format!(
        "object parts {{ shape: union(union({hollow}), union({blended}, smooth: 0.1))\n\
         .displace(p => 0.02 * perlin(5 * p)) }}\n\
         object ground {{ shape: plane((0, 1, 0)) }}\n\
         light sun {{ from: (0.4, 0.8, 0.5) }}\ncamera {{ from: (4, 4, 9), at: (1.5, 1.5, 1.5), fov: 40deg }}\n"
    )
}

/// As many solids of their own and a plane without end, in a light with a size that they darken corners in.
fn many_objects() -> String {
    let at = |i: u32, step: f64| 3.0 * (step * f64::from(i)).fract();
    let ball = |i: u32| {
        let place = format!("({:.4}, {:.4}, {:.4})", at(i, 0.82), at(i, 0.67), at(i, 0.55));
        format!("object o{i} {{ shape: (box((0.2, 0.2, 0.2)) - sphere(0.26)).translate({place}) }}\n")
    };
    (0..90).map(ball).collect::<String>()
        + "object ground { shape: plane((0, 1, 0)) }\n\
           light sun { from: (0.4, 0.8, 0.5), spread: 5deg, occlusion: 0.3 }\n\
           light lamp { at: (1, 5, 2), color: 20, radius: 0.3 }\n\
           camera { from: (4, 4, 9), at: (1.5, 1.5, 1.5), fov: 40deg }\n"
}

/// Overlapping balls of one solid, moved and turned together, and a ball of its own among them.
pub(crate) fn union_of_many(eye: &str) -> String {
    format!(
        "let balls = [for i in 0..60: sphere(0.4 + 0.3 * fract(0.37 * i)).translate(\
         3 * (fract(0.82 * i), fract(0.67 * i), fract(0.55 * i)))]\n\
         object cave {{\n  shape: (union(balls) | box((0.3, 0.3, 3))).rotate_y(20deg).scale(1.1)\n  \
         material: phong(0.2, (0.6, 0.5, 0.4), 0.2, 30)\n}}\n\
         object ball {{ shape: sphere(0.2).translate((1.2, 1.4, 1)) }}\n\
         light lamp {{ at: (1.7, 1.9, 1.6), color: 1, shadows: false, occlusion: 0.4 }}\n\
         light sun {{ from: (0.3, 0.8, 0.5), spread: 4deg }}\n\
         camera {{ from: {eye}, at: (1.8, 1.2, 0), fov: 60deg }}\n"
    )
}

/// The parts of a union are found where the union itself is, seen from outside and from within: but for pixels on an
/// edge, which a ray may pass on the other side.
fn edges_stay(text: &str) -> Result<(), Failed> {
    let size = [160, 90];
    let program = compile_without(text, Skips::ALL)?;
    ensure(program.objects.len() > 60, || "the union is not in parts".to_owned())?;
    let whole = picture(text, Skips::ALL.without(Skip::Parts), Quadrature::Midpoint, size)?;
    let parts = picture(text, Skips::ALL, Quadrature::Midpoint, size)?;
    let level = |image: &Image| image.pixels.iter().map(|pixel| pixel.color[0]).fold(0.0, f32::max);
    ensure(level(&whole) > 0.0, || "the picture is black".to_owned())?;
    let is_apart = |a: f32, b: f32| (a - b).abs() > 1e-2 * level(&whole);
    let pixels = whole.pixels.iter().zip(&parts.pixels);
    let apart = pixels.filter(|(a, b)| (0..3).any(|i| is_apart(a.color[i], b.color[i]))).count();
    ensure(apart <= whole.pixels.len() / 500, || format!("{apart} of {} pixels", whole.pixels.len()))
}

/// Whether it matters to a picture by itself; what is kept from frame to frame is tried in `cli/animations.rs`, spacings, which are
/// chosen for an error, in [`smooth_media_are_sampled_less`].
fn in_one_picture(skip: Skip) -> bool {
    match skip {
        Skip::Cells
        | Skip::CurveBoxes
        | Skip::Opaque
        | Skip::Ranges
        | Skip::Objects
        | Skip::Tapes
        | Skip::Parts => true,
        Skip::SameFrames | Skip::SameGrids | Skip::Spacings => false,
    }
}

/// Largest difference of a pixel that a skip may make, relative to the brightest one: 0 is the same bits.
fn bound(skip: Skip) -> f32 {
    match skip {
        Skip::Opaque => 2.0_f32.powi(-16),
        Skip::Cells
        | Skip::CurveBoxes
        | Skip::SameFrames
        | Skip::SameGrids
        | Skip::Ranges
        | Skip::Objects
        | Skip::Tapes
        // Of a scene without a union of many: see `edges_stay`.
        | Skip::Parts
        // Before they are chosen.
        | Skip::Spacings => 0.0,
    }
}

/// The galaxy's stars are sampled farther apart than its dust: for fewer samples, and not much is changed.
fn smooth_media_are_sampled_less() -> Result<(), Failed> {
    let examples = examples();
    let galaxy = examples.iter().find(|(name, _)| name == "galaxy").ok_or("the example is missing")?;
    let text = std::fs::read_to_string(&galaxy.1)?;
    let (size, max_error) = ([160, 90], 1e-2);
    let [with, without] = [Skips::ALL, Skips::ALL.without(Skip::Spacings)].map(|skips| {
        let program = compile_without(&text, skips)?;
        let mut frame = frame(&program, 1.0, size)?;
        let choice = vol_runtime_cpu::choose(&program, &mut frame, size, Sampling::CENTRE, max_error);
        let never = AtomicBool::new(false);
        let drawn = vol_runtime_cpu::render(&program, &frame, &choice.job, Some(2), &|_| {}, &never);
        let (image, stats) = drawn.ok_or("cancelled by nobody")?;
        let spacings: Vec<_> = frame.media.iter().map(|medium| medium.spacing).collect();
        Ok::<_, Failed>((spacings, image, stats.medium_samples))
    });
    let ((with, picture, samples), (without, plain, plain_samples)) = (with?, without?);
    ensure(with[0] == 1 && with[1] >= 8, || format!("spacings {with:?}"))?;
    ensure(without == [1, 1], || format!("spacings {without:?} when switched off"))?;
    ensure(3 * samples < plain_samples, || format!("{samples} samples instead of {plain_samples}"))?;
    let changed = color_error(&picture, &plain);
    ensure(changed > 0.0 && changed < 0.4 * f64::from(max_error), || format!("changed by {changed:e}"))
}

fn neutral(skip: Skip, path: &Path) -> Result<(), Failed> {
    neutral_in(skip, &std::fs::read_to_string(path)?, [20, 12])
}

fn neutral_in(skip: Skip, text: &str, size: [u32; 2]) -> Result<(), Failed> {
    for quadrature in [Quadrature::Midpoint, Quadrature::Corrected] {
        let without = picture(text, Skips::ALL.without(skip), quadrature, size)?;
        let with = picture(text, Skips::ALL, quadrature, size)?;
        let colors = |image: &Image| image.pixels.iter().flat_map(|pixel| pixel.color).collect::<Vec<f32>>();
        let (without, with) = (colors(&without), colors(&with));
        let brightest = without.iter().copied().fold(0.0, f32::max);
        ensure(brightest > 0.0, || "the picture is black".to_owned())?;
        let apart = without.iter().zip(&with).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        ensure(apart <= bound(skip) * brightest, || format!("{apart:e} apart, brightest {brightest}"))?;
    }
    Ok(())
}

fn picture(text: &str, skips: Skips, quadrature: Quadrature, size: [u32; 2]) -> Result<Image, Failed> {
    let program = compile_without(text, skips)?;
    let frame = frame(&program, 1.0, size)?;
    let step = vol_runtime_cpu::fixed_step_default(&frame);
    let job = Job { size, step, shadow_step: 2.0 * step, quadrature, sampling: Sampling::CENTRE };
    render(&program, &frame, &job, 2)
}
