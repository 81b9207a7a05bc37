//! `vol stress` over every primitive, operator, transform, curve, noise and phase function, at ordinary and
//! at awkward sizes and places; in `faults` over scenes and programs with planted faults, which it has to find.

mod faults;

use crate::support::{Diagnosed, diagnose, ensure};
use crate::{operators, primitives};
use libtest_mimic::{Failed, Trial};
use vol::backend::Device;
use vol::stress::{self, Config, Moment, Report};
use vol_compiler::program::Program;
use vol_language::diag::{Diagnostic, render};
use vol_language::source::SourceFile;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = faults::trials();
    trials.extend([
        Trial::test("stress::primitives", || {
            suite(
                "",
                primitives::SOLIDS.iter().map(|row| row.0.to_owned()).map(object),
                25,
                ERRORS_AND_WARNINGS,
            )
        }),
        Trial::test("stress::primitives_far_huge_and_tiny", || {
            suite("", elsewhere().map(object), 120, ALL_BUT_DIGITS)
        }),
        Trial::test("stress::primitives_without_size", || {
            let texts = primitives::DEGENERATE.iter().map(|row| row.0.to_owned());
            suite("let z = 0\n", texts.clone().map(object), 25, ERRORS)?;
            suite("param z: float = 0 in 0..1\n", texts.map(object), 25, ERRORS)
        }),
        Trial::test("stress::transforms", || suite("", transforms().map(object), 35, ERRORS_AND_WARNINGS)),
        Trial::test("stress::blends", || suite("", blends().map(object), 35, ERRORS_AND_WARNINGS)),
        Trial::test("stress::fields", || {
            suite("", FIELDS.iter().map(|text| object((*text).to_owned())), 8, ERRORS)
        }),
        Trial::test("stress::tubes", || suite("", tubes(), 100, ERRORS)),
        Trial::test("stress::solid_tubes", || suite("", solid_tubes(), 10, ERRORS)),
        Trial::test("stress::noises", || suite("", noises(), 50, ERRORS)),
        Trial::test("stress::functions", || suite("", functions(), 40, ERRORS)),
        Trial::test("stress::phases", || suite("", phases(), 30, ERRORS_AND_WARNINGS)),
    ]);
    trials
}

/// Places per function in the suite.
const FEW: Config = Config { points: 200, seed: 7 };

/// What `vol stress` finds about a program by default, with fewer places.
pub(crate) fn report(program: &Program) -> Result<Report, Failed> {
    let (moments, messages) = stress::moments(program, &program.default_params(), 0.0);
    let mut report = run(program, &moments, &FEW, &[&Device::Cpu])?;
    report.diagnostics.extend(messages);
    Ok(report)
}

fn run(
    program: &Program,
    moments: &[Moment],
    config: &Config,
    devices: &[&Device],
) -> Result<Report, Failed> {
    stress::run(program, moments, config, devices).map_err(|failure| format!("{failure:?}").into())
}

/// A scene that compiles.
pub(crate) fn compiled(text: &str) -> Result<Program, Failed> {
    let Diagnosed { program, diagnostics, .. } = diagnose(SourceFile::new("scene.vol", text));
    program.ok_or_else(|| shown(text, &diagnostics).into())
}

/// The messages as people read them.
fn shown(text: &str, diagnostics: &[Diagnostic]) -> String {
    render::human(&SourceFile::new("scene.vol", text).into(), diagnostics, false)
}

/// Codes that a suite does not allow.
const ERRORS: &[&str] = &["E07"];

/// Also what is slow and what jumps.
const ERRORS_AND_WARNINGS: &[&str] = &["E07", "W07"];

/// Far off, digits are lost.
const ALL_BUT_DIGITS: &[&str] = &["E07", "W0702", "W0703"];

/// No scene has an error; so many are no scenes that `vol` refuses.
fn suite(
    before: &str,
    scenes: impl Iterator<Item = String>,
    least: usize,
    faults: &[&str],
) -> Result<(), Failed> {
    let mut done = 0;
    let mut wrong = String::new();
    for scene in scenes {
        let text = format!("{before}{scene}");
        let Diagnosed { program: Some(program), .. } = diagnose(SourceFile::new("scene.vol", text.as_str()))
        else {
            continue;
        };
        done += 1;
        let report = report(&program)?;
        let errors: Vec<Diagnostic> = report
            .diagnostics
            .into_iter()
            .filter(|d| faults.iter().any(|fault| d.code.starts_with(fault)))
            .collect();
        if !errors.is_empty() {
            wrong += &format!("{text}\n{}\n", shown(&text, &errors));
        }
    }
    ensure(wrong.is_empty(), || wrong)?;
    ensure(done >= least, || format!("only {done} of the scenes compile"))
}

fn object(shape: String) -> String {
    format!("object o {{ shape: {shape} }}")
}

/// Primitives of other sizes at other places.
fn elsewhere() -> impl Iterator<Item = String> {
    const PLACES: [&str; 4] = [
        ".scale(1e4)",
        ".scale(1e-4)",
        ".translate((1e4, -1e4, 1e4))",
        ".rotate((1, 2, 3), 50deg).translate((12345.678, 0, -12345.678))",
    ];
    let all = primitives::SOLIDS.iter().chain(primitives::DEGENERATE.iter().take(12));
    let texts = all.map(|row| row.0.replace('z', "0"));
    texts.flat_map(|text| PLACES.map(|place| format!("({text}){place}")))
}

/// Each transform of two solids, once of usual size, once far off.
fn transforms() -> impl Iterator<Item = String> {
    operators::TRANSFORMS.iter().enumerate().flat_map(|(i, (transform, _))| {
        let solid = |k: usize| operators::SOLIDS[(i + k) % operators::SOLIDS.len()];
        [
            format!("{}{transform}", solid(0)),
            format!("{}{transform}", solid(5)),
            format!("{}{transform}.scale(50).translate((1e4, 2, 0))", solid(9)),
        ]
    })
}

/// Each blend of three solids as it is, of parts that are nearly equal, and without width.
fn blends() -> impl Iterator<Item = String> {
    let nearly = "sphere(0.50000001) sphere(0.5) box((0.4, 0.4, 0.4))";
    operators::BLENDS.iter().flat_map(move |blend| {
        let parts: Vec<&str> = nearly.split(") ").collect();
        let part = |i: usize| {
            let text = parts[i].to_owned();
            if text.ends_with("))") { text } else { text + ")" }
        };
        let close = blend.replace('A', &part(0)).replace('B', &part(1)).replace('C', &part(2));
        let narrow = operators::of_parts(blend).replace("0.3", "1e-7").replace("0.2", "0");
        [operators::of_parts(blend), close, narrow]
    })
}

/// Solids whose values are no distances.
const FIELDS: &[&str] = &[
    "implicit(p => dot(p, p) - 0.5, bounds: 1)",
    "implicit(p => 1000 * (dot(p, p) - 0.5), bounds: 1)",
    "implicit(p => pow(p.x, 6) + pow(p.y, 6) + pow(p.z, 6) - 0.2, bounds: 1)",
    "implicit(p => sin(9 * p.x) * cos(9 * p.y) + sin(9 * p.y) * cos(9 * p.z), bounds: (0.7, 0.7, 0.7))",
    "implicit(p => if p.x < 0.1 then p.y else p.z - 0.2, bounds: 1)",
    "sphere(1).displace(p => 0.1 * perlin(3 * p))",
    "sphere(1).displace(p => 0.05 * fbm(5 * p, 5) + 0.02 * worley(4 * p))",
    "box((1, 0.5, 1)).displace(p => 0.05 * sin(20 * p.x) * sin(20 * p.z)).twist(60deg)",
    "mandelbulb()",
    "mandelbulb(power: 2.5)",
];

/// Curves of all kinds, some without length, straight, folded or nearly so.
pub(crate) const CURVES: &[&str] = &[
    "line((0, 0, 0), (0.3, 1, 0.2))",
    "line((0.1, 0.1, 0.1), (0.1, 0.1, 0.1))",
    "line((0, 0, 0), (1e-7, 0, 0))",
    "bezier((0, 0, 0), (0.4, 1.1, 0.2), (0, 2.2, 0))",
    "bezier((0, 0, 0), (0, 1, 0), (0, 2, 0))",
    "bezier((0, 0, 0), (0, 2, 0), (0, 1, 0))",
    "bezier((0, 0, 0), (0, 0, 0), (0, 1, 0))",
    "bezier((0, 0, 0), (1, 0, 0), (0, 0, 0))",
    "bezier((0, 0, 0), (1, 1e-7, 0), (2, 0, 0))",
    "bezier((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 1))",
    "bezier((0, 0, 0), (1, 1, 0), (0, 1, 0), (1, 0, 0))",
    "bezier((0, 0, 0), (0, 0, 0), (0, 0, 0), (1, 0, 0))",
    "path([line((0, 0, 0), (0, 1, 0)), bezier((0, 1, 0), (0, 2, 0), (1, 2, 0))])",
    "catmull_rom([(1, 0, 0), (0, 0.4, 1), (-1, 0, 0), (0, -0.4, -1)], closed: true)",
    "catmull_rom([(0, 0, 0), (1, 0, 0), (1, 1, 0), (1, 1, 1)])",
    "catmull_rom([(0, 0, 0), (0, 0, 0), (1, 1, 0), (1, 1, 1e-7)])",
    "bspline([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 1), (0, 0, 2)])",
    "circle(1)",
    "helix(0.4, 1.2, 3)",
    "helix(1, 0, 1)",
];

/// What a tube may be beside its curve.
const TUBES: &[&str] = &[
    "radius: 0.2",
    "radius: t => mix(0.08, 0.3, t * t), twist: t => 0.8turn * t, stretch: true",
    "radius: (t, l) => 0.1 + 0.05 * sin(6 * l), caps: round, conserve_mass: true",
    "radius: 0.25, caps: open, frame: frenet",
    "radius: t => 0.4 * t * (1 - t), twist: (t, l) => 90deg * l, caps: round, conserve_mass: true",
    "radius: 0, caps: round",
];

/// Every coordinate of a point in a tube.
const EVERYTHING: &str = "q => 1 + 0.3 * sin(3 * q.local.x) + q.t + 0.1 * q.l + 0.2 * cos(q.angle) + q.radius \
     + q.depth + 0.1 * q.local.y * q.local.z + 0.01 * q.stretch";

fn tubes() -> impl Iterator<Item = String> {
    const PLACES: [&str; 4] = ["", ".scale(1e4)", ".scale(1e-4)", ".translate((1e4, 0, -12345.678))"];
    CURVES.iter().enumerate().flat_map(|(i, curve)| {
        TUBES.iter().enumerate().map(move |(k, tube)| {
            let place = PLACES[(i + k) % PLACES.len()];
            format!("medium m {{ region: tube({curve}, {tube}){place}, density: {EVERYTHING} }}")
        })
    })
}

fn solid_tubes() -> impl Iterator<Item = String> {
    let thick = CURVES.iter().map(|curve| object(format!("tube({curve}, radius: 0.15, caps: round)")));
    let other = [
        "tube(line((0, 0, 0), (0, 2, 0)), radius: t => 0.2 + 0.1 * t)",
        "tube(bezier((-1, 0, 0), (0, 0.6, 0), (1, 0, 0)), radius: 0.1, caps: flat)",
        "tube(bezier((-1, 0, 0), (0, 0.6, 0), (1, 0, 0)), radius: t => 0.1 + 0.05 * t, caps: round)",
        "tube(circle(1), radius: (t, l) => 0.15 + 0.02 * sin(1turn * t))",
    ];
    thick.chain(other.map(|text| object(text.to_owned())))
}

/// Noises near the origin, finely, coarsely and far away.
fn noises() -> impl Iterator<Item = String> {
    const NOISES: &[&str] = &[
        "perlin(P)",
        "perlin(P, seed: 5)",
        "perlin(vec4(P, 0.3))",
        "value(P)",
        "simplex(P)",
        "worley(P)",
        "fbm(P, 5)",
        "fbm(P, 7, lacunarity: 1.99, gain: 0.6)",
        "gardner(P)",
        "length(curl(P))",
        "turbulence(P, 4)",
        "billow(P, 4)",
        "ridged(P, 4)",
        "perlin(domain_warp(P, 0.3))",
        "cloud_cumulus(P)",
        "hash(P.x)",
    ];
    const PLACES: &[&str] = &["q.local", "1e-4 * q.local", "30 * q.local", "q.local + (1000, -1000, 0)"];
    NOISES.iter().flat_map(|noise| {
        PLACES.iter().map(move |place| {
            let density = noise.replace('P', &format!("({place})"));
            format!("medium m {{ region: box((2, 1, 2)), density: q => 1.5 + {density} }}")
        })
    })
}

/// Functions of numbers where they have edges: at 0, at ±1, where they are not defined, with large and with
/// nearly equal arguments.
fn functions() -> impl Iterator<Item = String> {
    const FUNCTIONS: &[&str] = &[
        "sqrt(x)",
        "exp(30 * x)",
        "exp2(200 * x)",
        "log(x)",
        "log2(x)",
        "pow(x, 0.5)",
        "pow(x, -2.5)",
        "pow(x, 3)",
        "pow(abs(x), y)",
        "asin(x) / 1rad",
        "acos(1.5 * x) / 1rad",
        "atan(1e6 * x) / 1rad",
        "atan2(x, y) / 1rad",
        "sin(1000 * x)",
        "x % 0.25",
        "mod(x, y + 2.5)",
        "smoothstep(0, 1, x)",
        "smoothstep(0.5, 0.5, x)",
        "smoothstep(0.5, 0.50000001, x)",
        "falloff(0.7, 1, x)",
        "remap(x, -1, 1, 0, 1)",
        "clamp(x, 0.5, -0.5)",
        "length(normalize(q.local))",
        "length(normalize(1e-30 * q.local))",
        "length(1e-20 * q.local)",
        "length(1e15 * q.local) * 1e-15",
        "bias(saturate(x), 0.999)",
        "gain(saturate(x), -0.999)",
        "sign(x) + step(0, y)",
        "fract(x) + floor(y) + round(x) + ceil(y)",
        "length(palette_rainbow(x)) + length(palette_fire(y))",
        "(iterate 30 from (z = x) while abs(z) < 4: (z = z * z + y)).z",
        "(x + 1e4) - 1e4",
        "keys(x, -0.5: 0, -0.4999999: 1, 0.5: 2)",
        "keys(x, 0: 0, 1: 1, ease: smooth)",
        "random(10 * x, seed: 3)",
    ];
    let scene = |text: &&str| {
        format!(
            "medium m {{ region: box((2, 1, 2)), density: q => {{ let x = q.local.x  let y = q.local.y  2 + ({text}) + 0 * x * y }} }}"
        )
    };
    let written = FUNCTIONS.iter().map(scene);
    // The same as the colour of a surface.
    let surfaces = FUNCTIONS.iter().step_by(4).map(|text| {
        format!("object o {{ shape: sphere(1), material: diffuse(q => {{ let x = q.local.x  let y = q.local.y  rgb(1, 1, 1) * (({text}) + 0 * x * y) }}) }}")
    });
    written.chain(surfaces)
}

fn phases() -> impl Iterator<Item = String> {
    const SHARES: [&str; 10] =
        ["0", "1e-7", "0.5", "0.9", "0.99", "0.999", "0.9999", "-0.5", "-0.999", "-0.9999"];
    let mut all = vec!["isotropic()".to_owned(), "rayleigh()".to_owned()];
    for share in SHARES {
        all.push(format!("henyey_greenstein({share})"));
        all.push(format!("schlick({share})"));
        all.push(format!("double_hg({share}, -0.3, 0.8)"));
        all.push(format!("double_hg(0.9, {share}, 1)"));
    }
    let scenes = all.into_iter().map(|phase| format!("medium m {{ region: sphere(1), phase: {phase} }}"));
    let ranged = ["henyey_greenstein(g)", "schlick(g)", "double_hg(g, -g, 0.5)"].into_iter().map(|phase| {
        format!("param g: float = 0.3 in -0.9999..0.9999\nmedium m {{ region: sphere(1), phase: {phase} }}")
    });
    scenes.chain(ranged)
}
