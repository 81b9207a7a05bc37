//! The reference integrators against the comb, through scene texts.

use crate::support::{compile, ensure, frame};
use libtest_mimic::{Failed, Trial};
use std::sync::atomic::AtomicBool;
use vol::compare::color_error;
use vol_compiler::frame::{Image, Job, Quadrature, Sampling};
use vol_runtime_cpu::{Method, TubeBounds, render_by};

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("reference_modes::paths_agree_with_the_comb", paths_agree),
        Trial::test("reference_modes::sphere_marching_finds_even_tubes", even_tubes),
        Trial::test("reference_modes::sphere_marching_overshoots_where_the_radius_varies", steep_tubes),
        Trial::test("reference_modes::cloud_ball_by_fixed_steps_and_comb", cloud_ball),
    ]
}

fn render(scene: &str, method: Method, job: &Job) -> Result<(Image, vol_runtime_cpu::Stats), Failed> {
    let program = compile("reference.vol", scene)?;
    let frame = frame(&program, 0.0, job.size)?;
    let rendered = render_by(method, &program, &frame, job, &|_| {}, &AtomicBool::new(false));
    rendered.map_err(|error| Failed::from(format!("{error:?}")))?.ok_or_else(|| "cancelled".into())
}

fn job(step: f32, samples: u32) -> Job {
    Job {
        size: [12, 9],
        step,
        shadow_step: step,
        quadrature: Quadrature::Midpoint,
        sampling: Sampling::uniform(samples),
    }
}

fn fixed(tube_bounds: TubeBounds) -> Method {
    Method::FixedStep { jitter: None, tube_bounds }
}

fn colors(image: &Image) -> Vec<f64> {
    image.pixels.iter().flat_map(|pixel| pixel.color).map(f64::from).collect()
}

const CAMERA: &str =
    "camera { from: (0, 0, 4), at: (0, 0, 0), fov: 35deg }\nrender { background: (0.1, 0.2, 0.3) }\n";

/// Every phase function, noise, tubes, lighting of all kinds, and what is between.
const SCENES: [(&str, &str); 4] = [
    (
        "noise",
        "light sun { from: (-1, 2, 1), color: 8 }\n\
         medium m { region: sphere(1), density: q => 4 * max(0, fbm(2 * q.local, 4)) * falloff(0.7, 1, q.radius),\n\
           scatter: (0.9, 0.7, 0.5), absorb: (0.1, 0.3, 0.9), phase: henyey_greenstein(0.6) }",
    ),
    (
        "lamp and solid",
        "light lamp { at: (0.2, 1.4, 0.3), color: 5 }\n\
         object o { shape: sphere(0.4).translate((0.3, 0, 0.2)), material: diffuse(0.7) }\n\
         medium m { region: box((1, 0.8, 1)), scatter: 0.8, absorb: 0.3, phase: rayleigh() }\n\
         medium n { region: sphere(0.9).translate((-0.3, 0.2, 0)), scatter: (0.2, 0.5, 1.5), absorb: 0.1,\n\
           phase: double_hg(0.8, -0.4, 0.7), lighting: \"unshadowed\" }",
    ),
    (
        "tube",
        "light sun { from: (0.5, 1, 1), color: 6 }\n\
         medium m { region: tube(bezier((-1, -0.5, 0), (0, 1, 0.3), (1, -0.5, 0)), radius: t => 0.2 + 0.3 * t),\n\
           density: q => 5 * (1 + 0.5 * perlin(3 * q.local)), scatter: 0.9, absorb: 0.2, phase: schlick(0.4) }",
    ),
    (
        "glow",
        "medium m { region: torus(0.8, 0.3).rotate_x(50deg), density: 3, scatter: 0, absorb: (0.3, 1, 2), emit: (0.6, 0.3, 0.1) }\n\
         medium n { region: sphere(0.6), scatter: 0, emit: (0, 0, 0.4), lighting: \"none\" }",
    ),
];

/// The mean over the picture, where a common bias shows, and each number, all in standard errors.
fn paths_agree() -> Result<(), Failed> {
    for (name, text) in SCENES {
        let scene = format!("{CAMERA}{text}");
        let expected = colors(&render(&scene, Method::Comb, &job(0.006, 8))?.0);
        let mut pictures = Vec::new();
        for seed in 0..48 {
            pictures.push(colors(&render(&scene, Method::MonteCarlo { seed }, &job(1.0, 8))?.0));
        }
        let mean = |values: Vec<f64>| {
            let count = values.len() as f64;
            let mean = values.iter().sum::<f64>() / count;
            let spread: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
            (mean, (spread / (count * (count - 1.0))).sqrt())
        };
        let most = expected.iter().copied().fold(0.0, f64::max);
        for (index, expected) in expected.iter().enumerate() {
            let (found, error) = mean(pictures.iter().map(|picture| picture[index]).collect());
            ensure((found - expected).abs() <= 5.0 * error + 2e-3 * most, || {
                format!("{name}, number {index}: {found} for {expected} within {error}")
            })?;
        }
        let (found, error) = mean(pictures.iter().map(|picture| picture.iter().sum()).collect());
        let expected: f64 = expected.iter().sum();
        ensure((found - expected).abs() <= 4.0 * error + 5e-4 * expected, || {
            format!("{name}: {found} for {expected} within {error}")
        })?;
        ensure(error < 1e-2 * expected, || format!("{name}: {error} is no test of {expected}"))?;
    }
    Ok(())
}

fn tube(radius: &str, caps: &str) -> String {
    format!(
        "{CAMERA}medium m {{ region: tube(bezier((-1, -0.5, 0), (0, 1, 0.3), (1, -0.5, 0)), radius: {radius}, caps: {caps}),\n\
         density: 4, scatter: 0, absorb: 1, emit: 1 }}"
    )
}

/// A tube of one radius is found and left where it is, whatever its ends.
fn even_tubes() -> Result<(), Failed> {
    for caps in ["flat", "round"] {
        let scene = tube("0.3", caps);
        let expected = render(&scene, Method::Comb, &job(0.005, 1))?.0;
        for bounds in [TubeBounds::Cells, TubeBounds::SphereMarch] {
            let error = color_error(&render(&scene, fixed(bounds), &job(0.01, 1))?.0, &expected);
            ensure(error < 3e-2, || format!("{caps}, {bounds:?}: {error}"))?;
        }
    }
    Ok(())
}

/// The fault of the method: a wall that is nearer than the one across is stepped over. Fixed steps by cells do
/// not have it.
fn steep_tubes() -> Result<(), Failed> {
    let scene = tube("t => 0.22 + 0.2 * cos(40 * t)", "round");
    let expected = render(&scene, Method::Comb, &job(0.005, 1))?.0;
    let by =
        |bounds| Ok::<_, Failed>(color_error(&render(&scene, fixed(bounds), &job(0.005, 1))?.0, &expected));
    let (cells, marched) = (by(TubeBounds::Cells)?, by(TubeBounds::SphereMarch)?);
    ensure(cells < 2e-2 && marched > 2.0 * cells, || format!("{cells} and {marched}"))
}

/// Order of the two marchers on the third paper's cloud (algorithms.md section 5.2).
fn cloud_ball() -> Result<(), Failed> {
    let scene = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/cloud_ball.vol"))?;
    let converged = render(&scene, Method::Comb, &job(0.002, 1))?.0;
    let error = |method, step| {
        let (image, stats) = render(&scene, method, &job(step, 1))?;
        let samples = stats.medium_samples + stats.shadow_samples;
        Ok::<_, Failed>((color_error(&image, &converged), samples))
    };
    let (coarse, _) = error(fixed(TubeBounds::Cells), 0.04)?;
    let (fine, samples) = error(fixed(TubeBounds::Cells), 0.01)?;
    ensure((2.5..6.5).contains(&(coarse / fine)), || format!("fixed steps: {coarse}, {fine}"))?;
    let (comb, comb_samples) = error(Method::Comb, 0.01)?;
    ensure(comb < fine / 4.0 && comb_samples < samples * 3 / 2, || {
        format!("comb {comb} with {comb_samples}, fixed {fine} with {samples}")
    })
}
