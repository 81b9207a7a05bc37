//! The standard library that is written in the language, and loops: against formulas in f64.

use crate::support::{Random, compile, ensure, point};
use libtest_mimic::{Failed, Trial};
use vol_compiler::program::Program;
use vol_compiler::reference;

/// Points at which a function is asked.
const POINTS: usize = 4000;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("library::an_octave_loop_is_fbm", an_octave_loop_is_fbm),
        Trial::test("library::sums_of_octaves_are_their_formulas", sums_of_octaves_are_their_formulas),
        Trial::test("library::sums_of_octaves_stay_in_their_ranges", sums_of_octaves_stay_in_their_ranges),
        Trial::test("library::bias_and_gain_keep_their_points", bias_and_gain_keep_their_points),
        Trial::test("library::palettes_and_clouds_stay_in_their_ranges", palettes_and_clouds),
        Trial::test("library::the_bulb_of_power_8_is_its_formula", the_bulb_of_power_8_is_its_formula),
        Trial::test("library::loops_end_where_they_say", loops_end_where_they_say),
    ]
}

/// A function of the position `p`, from its body.
struct Function {
    program: Program,
    uniforms: Vec<f64>,
}

impl Function {
    fn new(result: &str, body: &str) -> Result<Self, Failed> {
        let text = format!("fn f(p: vec3) -> {result} {{ {body} }}\nobject ball {{ shape: sphere(1) }}");
        let program = compile("library.vol", &text)?;
        let frame = program.frame(&program.default_params(), 0.0, 0.0, [8, 8]).map_err(|d| d.message)?;
        Ok(Self { program, uniforms: frame.uniforms })
    }

    fn at(&self, p: [f64; 3]) -> Vec<f64> {
        let field =
            self.program.fields.iter().find(|field| field.name == "f").expect("a function of a position");
        reference::evaluate(self.program.module.function(field.function), &p, &self.uniforms, &[])
    }
}

fn points() -> impl Iterator<Item = [f64; 3]> {
    let mut random = Random::new(11);
    (0..POINTS).map(move |_| point(&mut random, [-5.0; 3], [5.0; 3]).map(f64::from))
}

fn same(first: &Function, second: impl Fn([f64; 3]) -> f64) -> Result<(), Failed> {
    for p in points() {
        let (found, wanted) = (first.at(p)[0], second(p));
        ensure((found - wanted).abs() <= 1e-12 * (1.0 + wanted.abs()), || {
            format!("at {p:?}: {found}, expected {wanted}")
        })?;
    }
    Ok(())
}

fn an_octave_loop_is_fbm() -> Result<(), Failed> {
    let by_loop = Function::new(
        "float",
        "let o = iterate 5 from (sum = 0, q = p, a = 1): (sum = sum + a * perlin(q, seed: 4), q = 2 * q, a = 0.5 * a)\n o.sum",
    )?;
    let by_function = Function::new("float", "fbm(p, 5, seed: 4)")?;
    same(&by_loop, |p| by_function.at(p)[0])
}

/// A sum over octaves of a function of the noise.
fn octaves(p: [f64; 3], count: i32, of: impl Fn(f64) -> f64) -> f64 {
    let octave = |k: i32| {
        let place = p.map(|x| x * 2f64.powi(k));
        0.5f64.powi(k) * of(reference::noise::perlin(place, 0))
    };
    (0..count).map(octave).sum()
}

fn sums_of_octaves_are_their_formulas() -> Result<(), Failed> {
    same(&Function::new("float", "turbulence(p, 4)")?, |p| octaves(p, 4, f64::abs))?;
    same(&Function::new("float", "billow(p, 4)")?, |p| octaves(p, 4, |n| 2.0 * n.abs() - 1.0))?;
    same(&Function::new("float", "ridged(p, 4)")?, |p| octaves(p, 4, |n| (1.0 - n.abs()).powi(2)))
}

/// Every component stays within two numbers.
fn within(function: &Function, lo: f64, hi: f64) -> Result<(), Failed> {
    for p in points() {
        let found = function.at(p);
        ensure(found.iter().all(|x| (lo..=hi).contains(x)), || {
            format!("at {p:?}: {found:?}, not in {lo}..{hi}")
        })?;
    }
    Ok(())
}

fn sums_of_octaves_stay_in_their_ranges() -> Result<(), Failed> {
    let sum = 1.0 + 0.5 + 0.25;
    within(&Function::new("float", "turbulence(p, 3)")?, 0.0, 1.0364 * sum)?;
    within(&Function::new("float", "billow(p, 3)")?, -sum, 1.0728 * sum)?;
    within(&Function::new("float", "ridged(p, 3)")?, 0.0, sum)?;
    // Nothing is summed.
    within(&Function::new("float", "turbulence(p, 0)")?, 0.0, 0.0)
}

fn bias_and_gain_keep_their_points() -> Result<(), Failed> {
    for amount in [-0.9, -0.3, 0.0, 0.4, 0.999, 7.0] {
        let bias = Function::new("float", &format!("bias(p.x, {amount})"))?;
        let gain = Function::new("float", &format!("gain(p.x, {amount})"))?;
        let held = f64::clamp(amount, -0.999, 0.999);
        let at = |f: &Function, x: f64| f.at([x, 0.0, 0.0])[0];
        for x in [0.001, 0.1, 0.25, 0.5, 0.7, 1.0] {
            let wanted = f64::powf(x, (1.0 - held) / (1.0 + held));
            let found = at(&bias, x);
            ensure((found - wanted).abs() < 1e-9, || format!("bias({x}, {amount}) = {found}"))?;
        }
        for (x, wanted) in [(0.0, 0.0), (0.5, 0.5), (1.0, 1.0)] {
            let found = at(&gain, x);
            ensure((found - wanted).abs() < 1e-9, || format!("gain({x}, {amount}) = {found}"))?;
        }
        let rising = (0..100).map(|i| at(&gain, f64::from(i) / 99.0)).collect::<Vec<_>>();
        ensure(rising.windows(2).all(|pair| pair[0] <= pair[1] + 1e-12), || {
            format!("gain of {amount} falls")
        })?;
    }
    Ok(())
}

fn palettes_and_clouds() -> Result<(), Failed> {
    for name in ["palette_rainbow", "palette_fire", "palette_ice", "palette_sunset"] {
        within(&Function::new("color", &format!("{name}(p.x)"))?, 0.0, 1.0 + 1e-12)?;
    }
    for name in ["cloud_cumulus", "cloud_stratus", "cloud_cirrus", "cloud_smoke"] {
        within(&Function::new("float", &format!("{name}(p)"))?, 0.0, 1.0)?;
    }
    Ok(())
}

/// The orbit of White and Nylander's power 8 in spherical coordinates, as a scene and as Rust.
fn the_bulb_of_power_8_is_its_formula() -> Result<(), Failed> {
    let body = "let last = iterate 6 from (z = p, r = length(p)) while r < 2: (
        z = { let th = 8 * acos(clamp(z.y / max(r, 1e-9), -1, 1)) / 1rad  let ph = 8 * atan2(z.z, z.x) / 1rad
              pow(r, 8) * vec3(sin(th) * cos(ph), cos(th), sin(th) * sin(ph)) + p },
        r = length({ let th = 8 * acos(clamp(z.y / max(r, 1e-9), -1, 1)) / 1rad  let ph = 8 * atan2(z.z, z.x) / 1rad
              pow(r, 8) * vec3(sin(th) * cos(ph), cos(th), sin(th) * sin(ph)) + p }),
    )
    last.r";
    let bulb = Function::new("float", body)?;
    let mut random = Random::new(5);
    for _ in 0..500 {
        let p = point(&mut random, [-1.1; 3], [1.1; 3]).map(f64::from);
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let (mut z, mut r) = (p, length(p));
        for _ in 0..6 {
            if r >= 2.0 {
                break;
            }
            let th = 8.0 * (z[1] / r.max(1e-9)).clamp(-1.0, 1.0).acos();
            let ph = 8.0 * z[2].atan2(z[0]);
            let power = r.powi(8);
            let turned = [th.sin() * ph.cos(), th.cos(), th.sin() * ph.sin()];
            z = [0, 1, 2].map(|i| power * turned[i] + p[i]);
            r = length(z);
        }
        let found = bulb.at(p)[0];
        // The orbit multiplies errors by 8 r^7 a step.
        ensure((found - r).abs() < 1e-6 * (1.0 + r), || format!("at {p:?}: {found}, expected {r}"))?;
    }
    Ok(())
}

fn loops_end_where_they_say() -> Result<(), Failed> {
    let at = |body: &str, x: f64| Ok::<f64, Failed>(Function::new("float", body)?.at([x, 0.0, 0.0])[0]);
    let check = |body: &str, x: f64, wanted: f64| {
        let found = at(body, x)?;
        ensure((found - wanted).abs() < 1e-12, || format!("{body} at {x}: {found}, expected {wanted}"))
    };
    check("(iterate 0 from (s = p.x): (s = s + 1)).s", 3.0, 3.0)?;
    check("(iterate -4 from (s = p.x): (s = s + 1)).s", 3.0, 3.0)?;
    check("(iterate 5 from (s = p.x): (s = 2 * s)).s", 3.0, 96.0)?;
    check("(iterate 50 from (s = p.x) while s < 20: (s = 2 * s)).s", 3.0, 24.0)?;
    check("(iterate 50 from (s = p.x) while s < 2: (s = 2 * s)).s", 3.0, 3.0)?;
    // Next values see the old state only.
    check("(iterate 1 from (a = p.x, b = 7.5): (a = b, b = a)).b", 3.0, 3.0)?;
    // A loop inside a loop, which sees its state.
    let nested = "(iterate 3 from (s = 0.0, k = 1.0): (s = s + (iterate 4 from (t = k): (t = t + k)).t, k = k + p.x)).s";
    check(nested, 1.0, 5.0 + 10.0 + 15.0)?;
    check("if (iterate 3 from (b = p.x > 2): (b = !b)).b then 1.0 else 2.0", 3.0, 2.0)
}
