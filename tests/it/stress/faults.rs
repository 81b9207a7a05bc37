//! Planted faults: scenes and programs that are wrong in a known way, and what has to be found.

use super::{FEW, object, report, run, shown};
use crate::support::{compile, ensure, frame};
use libtest_mimic::{Failed, Trial};
use vol::backend::Device;
use vol::stress::{self, Config, Moment, Report};
use vol_compiler::frame::Stride;
use vol_compiler::program::Program;
use vol_compiler::wgsl::Arithmetic;
use vol_language::diag::Diagnostic;

/// The trials of this file.
pub(super) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("stress::faults_of_scenes_are_found", faults_of_scenes),
        Trial::test("stress::what_is_defined_is_no_fault", defined_everywhere),
        Trial::test("stress::a_wrong_bound_is_found", wrong_bound),
        Trial::test("stress::a_distance_that_jumps_is_found", jumping_distance),
        Trial::test("stress::wrong_numbers_are_found", wrong_numbers),
        Trial::test("stress::params_at_their_ends", params_at_their_ends),
        Trial::test("stress::same_seed_same_report", same_seed_same_report),
        #[cfg(feature = "gpu")]
        crate::gpu_device::gpu_trial("stress::faults_are_found", faults_on_gpu),
    ]
}

/// A scene, the code that is found, and the text that is underlined.
const FAULTS: &[(&str, &str, &str)] = &[
    ("medium m { region: sphere(1), density: q => 2 + 1 / q.local.x }", "E0701", "1 / q.local.x"),
    (
        "object o { shape: sphere(1), material: diffuse(q => rgb(1, 1, 1) * (1 / q.local.y)) }",
        "E0701",
        "1 / q.local.y",
    ),
    (
        "fn steep(x: float) -> float { 0.5 / (x * x) }\nmedium m { region: sphere(1), density: q => steep(q.local.z) }",
        "E0701",
        "0.5 / (x * x)",
    ),
    (
        "medium m { region: sphere(1), density: q => (1e25 * q.local.x) * (1e25 * q.local.y) * 1e-20 }",
        "E0701",
        "(1e25 * q.local.x) * (1e25 * q.local.y)",
    ),
    (
        "medium m { region: sphere(1), density: q => if q.local.x < 0.3 then 1 else 2 }",
        "W0702",
        "if q.local.x < 0.3 then 1 else 2",
    ),
    (
        "medium m { region: sphere(1), density: q => 1 + floor(3 * q.local.y) }",
        "W0702",
        "floor(3 * q.local.y)",
    ),
    ("medium m { region: torus(1, 0.5), density: q => 2 + q.angle / 1turn }", "W0702", "q.angle"),
    (
        "medium m { region: sphere(1), density: q => 1 + perlin(1e7 * q.local) }",
        "W0701",
        "perlin(1e7 * q.local)",
    ),
    (
        "medium m { region: sphere(1), density: q => 2 + ((q.local.x + 1000000.1) - 1000000.1) }",
        "W0701",
        "(q.local.x + 1000000.1) - 1000000.1",
    ),
    ("fn f(p: vec3) -> float { 1 / p.x }\nobject o { shape: sphere(1) }", "W0704", "1 / p.x"),
    ("object o { shape: implicit(p => 0.001 * (dot(p, p) - 0.5), bounds: 1) }", "W0703", "object o"),
];

fn faults_of_scenes() -> Result<(), Failed> {
    for &(text, code, underlined) in FAULTS {
        let program = compile("scene.vol", text)?;
        found(&report(&program)?, text, code, underlined)?;
    }
    Ok(())
}

/// Fails unless the report says so at that place.
fn found(report: &Report, text: &str, code: &str, underlined: &str) -> Result<(), Failed> {
    let place = |d: &Diagnostic| {
        let span = d.labels[0].span;
        text.get(span.start as usize..span.end as usize).unwrap_or_default()
    };
    // Brackets around an expression are a part of it, or not.
    fn bare(text: &str) -> &str {
        text.trim_start_matches('(')
    }
    let right = |d: &Diagnostic| {
        d.code == code && (underlined.is_empty() || bare(place(d)).starts_with(bare(underlined)))
    };
    ensure(report.diagnostics.iter().any(right), || {
        format!("{text}\nno {code} at `{underlined}`:\n{}", shown(text, &report.diagnostics))
    })
}

/// What the language defines everywhere is never reported as infinite.
fn defined_everywhere() -> Result<(), Failed> {
    for value in [
        "log(abs(q.local.x))",
        "log(q.local.x)",
        "sqrt(q.local.x - q.local.x - 1e-7)",
        "pow(q.local.x, -0.5)",
        "length(normalize(q.local))",
        "exp(1000 * q.local.x) * 1e-30",
        "asin(5 * q.local.x) / 1rad",
    ] {
        let text = format!("medium m {{ region: sphere(1), density: q => 200 + {value} }}");
        let report = report(&compile("scene.vol", &text)?)?;
        ensure(!report.has_errors(), || format!("{text}\n{}", shown(&text, &report.diagnostics)))?;
    }
    Ok(())
}

/// A moment whose frame is tampered with.
fn tampered(
    program: &Program,
    change: impl FnOnce(&mut vol_compiler::frame::Frame),
) -> Result<Moment, Failed> {
    let mut frame = frame(program, 0.0, [8, 8])?;
    change(&mut frame);
    Ok(Moment { label: String::new(), frame })
}

/// A field whose values are walked as if they were distances, and a distance that is stretched.
fn wrong_bound() -> Result<(), Failed> {
    for (shape, scale) in [
        ("implicit(p => 3 * (p.x * p.x + p.y * p.y + p.z * p.z) - 1, bounds: 1)", 1.0),
        ("sphere(1)", 1.05),
        ("box((1, 0.5, 0.5)).twist(90deg)", 1.0),
        ("sphere(1).displace(p => 0.3 * sin(8 * p.x))", 1.0),
    ] {
        let text = object(shape.to_owned());
        let program = compile("scene.vol", &text)?;
        let moment = tampered(&program, |frame| frame.objects[0].stride = Stride::Scale(scale))?;
        found(&run(&program, &[moment], &FEW, &[&Device::Cpu])?, &text, "E0703", "")?;
    }
    Ok(())
}

/// A field that jumps, and of which rays do not know it.
fn jumping_distance() -> Result<(), Failed> {
    let text = "object o { shape: implicit(p => if p.x < 0.1 then p.y else p.y - 0.3, bounds: 1) }";
    let program = compile("scene.vol", text)?;
    found(&report(&program)?, text, "W0702", "if p.x < 0.1")?;
    let moment = tampered(&program, |frame| frame.objects[0].stride = Stride::Scale(0.01))?;
    found(&run(&program, &[moment], &FEW, &[&Device::Cpu])?, text, "E0704", "if p.x < 0.1")
}

/// A device whose numbers of the frame are off in the fifth digit.
fn wrong_numbers() -> Result<(), Failed> {
    let text = "param r: float = 0.7\nobject o { shape: sphere(r) }";
    let program = compile("scene.vol", text)?;
    let moment = tampered(&program, |frame| frame.uniforms_f32.iter_mut().for_each(|x| *x *= 1.00001))?;
    found(&run(&program, &[moment], &FEW, &[&Device::Cpu])?, text, "E0702", "")
}

/// What is right by default and wrong at an end of a range is found, and the end is named.
fn params_at_their_ends() -> Result<(), Failed> {
    let text = "param soft: float = 0.5 in 0..1\nmedium m { region: sphere(1), density: q => (0.1 + q.radius) / soft }";
    let program = compile("scene.vol", text)?;
    let report = report(&program)?;
    found(&report, text, "E0701", "(0.1 + q.radius) / soft")?;
    let message = shown(text, &report.diagnostics);
    ensure(message.contains("with soft = 0"), || message)
}

fn same_seed_same_report() -> Result<(), Failed> {
    let text = "medium m { region: sphere(1), density: q => fbm(q.local, 4) + 1 / q.local.x }";
    let program = compile("scene.vol", text)?;
    let text_of = |report: Report| format!("{report:?}");
    let (first, second) = (text_of(report(&program)?), text_of(report(&program)?));
    let moments = stress::moments(&program, &[], 0.0).0;
    let other = text_of(run(&program, &moments, &Config { seed: 8, ..FEW }, &[&Device::Cpu])?);
    ensure(first == second && first != other, || format!("{first}\n{second}\n{other}"))
}

/// On a graphics device, too, and nothing is found where there is nothing.
#[cfg(feature = "gpu")]
fn faults_on_gpu(_: &vol_runtime_gpu::Gpu) -> Result<(), Failed> {
    use vol::backend::Choice;
    let device = Device::open(Choice::Gpu, Arithmetic::Free).map_err(|failure| format!("{failure:?}"))?;
    let scene = |text: &str| -> Result<Report, Failed> {
        let program = compile("scene.vol", text)?;
        let moments = stress::moments(&program, &program.default_params(), 0.0).0;
        run(&program, &moments[..1], &FEW, &[&device])
    };
    let text = "medium m { region: tube(circle(1), radius: 0.3), density: q => 2 + 1 / (q.t - q.t) }";
    found(&scene(text)?, text, "E0701", "")?;
    let text = "object o { shape: sphere(1).displace(p => 0.1 * perlin(3 * p)) }\n\
        medium m { region: tube(circle(1), radius: 0.3), density: q => 2 + fbm(q.local, 3), phase: schlick(0.9) }";
    let report = scene(text)?;
    ensure(report.diagnostics.is_empty(), || shown(text, &report.diagnostics))
}
