//! Grids of optical depth: pictures with and without them, on both backends.

use crate::support::{Body, Draw, compile, compile_file, ensure, examples, frame, on_both, render};
use libtest_mimic::{Failed, Trial};
use std::sync::Arc;
use vol::compare::color_error;
use vol_compiler::frame::{Frame, Image, Job, LightGrid, Quadrature, Sampling};
use vol_compiler::program::Program;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let bodies: [(&str, Body); 3] = [
        ("sun_through_a_cloud", sun_through_a_cloud),
        ("two_lights_and_a_solid", two_lights_and_a_solid),
        ("lamp_in_a_cloud", lamp_in_a_cloud),
    ];
    let mut trials: Vec<Trial> =
        bodies.into_iter().flat_map(|(name, body)| on_both(&format!("light_grids::{name}"), body)).collect();
    trials.push(Trial::test("light_grids::steps_and_grids_share_what_is_allowed", share_what_is_allowed));
    trials
}

/// The camera and background of all scenes.
const VIEW: &str =
    "camera { from: (1, 2, 6), at: (0, 0, 0), fov: 30deg }\nrender { background: (0.1, 0.2, 0.3) }\n";

/// A cloud that is grey where `absorb` is.
fn cloud(absorb: &str) -> String {
    format!(
        "medium cloud {{\n  region: sphere(1)\n  density: q => 6 * max(0, fbm(2 * q.local, 3) + 0.2)\n  \
         scatter: (0.9, 0.8, 0.5)\n  absorb: {absorb}\n}}\n"
    )
}

const SIZE: [u32; 2] = [24, 24];

/// Error that is allowed.
const MAX_ERROR: f32 = 1.5e-2;

/// Grids as for a large picture, of which a small one is drawn.
fn with_grids(program: &Program, job: &Job) -> Result<Frame, Failed> {
    let mut frame = frame(program, 0.0, SIZE)?;
    let large = Job { size: [4096, 4096], ..*job };
    let choices = vol_runtime_cpu::choose_light_grids(program, &frame, &large, MAX_ERROR);
    frame.light_grids = choices.into_iter().map(|choice| choice.grid).collect();
    Ok(frame)
}

/// The same frame, the numbers of its grids read as coefficients: a smoother cloud.
fn read_as_splines(frame: &Frame) -> Frame {
    let spline = |grid: &LightGrid| Arc::new(LightGrid { spline: true, ..grid.clone() });
    let grids = frame.light_grids.iter().map(|grid| grid.as_deref().map(spline));
    Frame { light_grids: grids.collect(), ..frame.clone() }
}

/// Relative rms of the difference of two pictures, and its largest value.
fn apart(a: &Image, b: &Image) -> (f64, f64) {
    let pairs = a.pixels.iter().zip(&b.pixels).flat_map(|(a, b)| a.color.into_iter().zip(b.color));
    let largest = pairs.map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max);
    (color_error(a, b), largest)
}

/// The estimate of a picture with a grid is within what was asked for; at some of these errors the first step that
/// is good enough is hardly better.
fn share_what_is_allowed() -> Result<(), Failed> {
    let examples = examples();
    let cloud = examples.iter().find(|(name, _)| name == "cloud_ball").ok_or("the example is missing")?;
    let program = compile_file(&cloud.1)?;
    let size = [480, 270];
    for max_error in (0..12).map(|index| 2e-2 * 0.87_f32.powi(index)) {
        let mut frame = frame(&program, 1.0, size)?;
        let choice = vol_runtime_cpu::choose(&program, &mut frame, size, Sampling::CENTRE, max_error);
        ensure(choice.grids[0].grid.is_some(), || format!("no grid for {max_error}"))?;
        ensure(choice.estimate <= max_error, || format!("{} instead of {max_error}", choice.estimate))?;
    }
    Ok(())
}

/// Draws a scene whose lights have grids as `wanted` says: like marching to what is allowed, and on both
/// backends alike.
fn looks_like_marching(draw: &Draw<'_>, text: &str, wanted: &[bool]) -> Result<(), Failed> {
    let program = compile("test.vol", &format!("{VIEW}{text}"))?;
    let job = Job {
        size: SIZE,
        step: 0.02,
        shadow_step: 0.02,
        quadrature: Quadrature::Midpoint,
        sampling: Sampling::CENTRE,
    };
    let frame = with_grids(&program, &job)?;
    let grids: Vec<bool> = frame.light_grids.iter().map(Option::is_some).collect();
    ensure(grids == wanted, || format!("grids of lights: {grids:?} instead of {wanted:?}"))?;
    let drawn = draw(&program, &frame, &job)?;
    let (twin, most) = apart(&drawn, &render(&program, &frame, &job, 2)?);
    ensure(twin < 1e-5 && most < 1e-3, || format!("rms {twin:e}, most {most:e} off the CPU"))?;
    let splines = read_as_splines(&frame);
    let smooth = draw(&program, &splines, &job)?;
    let (twin, most) = apart(&smooth, &render(&program, &splines, &job, 2)?);
    ensure(twin < 1e-5 && most < 1e-3, || format!("splines: rms {twin:e}, most {most:e} off the CPU"))?;
    let (blur, _) = apart(&smooth, &drawn);
    ensure(!wanted.contains(&true) || blur > 1e-6, || "splines look like local cubics".to_owned())?;
    let marched = draw(&program, &Frame { light_grids: Vec::new(), ..frame }, &job)?;
    let (error, _) = apart(&drawn, &marched);
    let changes = wanted.contains(&true);
    let (least, most) = if changes { (1e-6, f64::from(MAX_ERROR)) } else { (-1.0, 1e-9) };
    ensure(error > least && error < most, || format!("rms {error:e} off marching"))
}

fn sun_through_a_cloud(draw: &Draw<'_>) -> Result<(), Failed> {
    for absorb in ["0.1", "(0.1, 0.2, 0.5)", "q => 0.3 * vec3(1, q.radius, 0)"] {
        let sun = "light sun { from: (-0.35, 0.8, 0.5), color: 8 }\n";
        looks_like_marching(draw, &format!("{}{sun}", cloud(absorb)), &[true])?;
    }
    Ok(())
}

fn two_lights_and_a_solid(draw: &Draw<'_>) -> Result<(), Failed> {
    let rest = "object ground { shape: box((6, 0.2, 6)).translate((0, -1.4, 0)), material: diffuse(0.6) }\n\
                light sun { from: (-0.35, 0.8, 0.5), color: 8 }\n\
                light lamp { at: (3, 4, 1), color: (90, 60, 30) }\n";
    looks_like_marching(draw, &format!("{}{rest}", cloud("0.1")), &[true, true])
}

fn lamp_in_a_cloud(draw: &Draw<'_>) -> Result<(), Failed> {
    let lamp = "light lamp { at: (0.2, 0.3, 0.1), color: 3 }\n";
    looks_like_marching(draw, &format!("{}{lamp}", cloud("0.1")), &[false])
}
