//! Noises and random numbers as scenes say them: against formulas written out here, and between the
//! compiler, which computes constants, and the backend, which computes the rest.

use crate::support::{Random, compile, compile_with_messages, ensure, frame};
use libtest_mimic::{Failed, Trial};
use vol::backend::Device;
use vol_compiler::frame::Frame;
use vol_compiler::ir::FunctionId;
use vol_compiler::program::Program;
use vol_compiler::reference::noise;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("noises::calls_mean_the_operations", calls_mean_the_operations),
        Trial::test(
            "noises::constants_are_what_the_backend_computes",
            constants_are_what_the_backend_computes,
        ),
        Trial::test("noises::seed_0_of_perlin_is_the_authors", seed_0_of_perlin_is_the_authors),
        Trial::test("noises::gardner_is_the_papers_formula", gardner_is_the_papers_formula),
        Trial::test("noises::gardner_stays_in_its_range", gardner_stays_in_its_range),
        Trial::test("noises::curl_has_no_sources", curl_has_no_sources),
        Trial::test("noises::curl_is_no_displacement", curl_is_no_displacement),
        Trial::test("noises::smooth_noises_displace", smooth_noises_displace),
    ]
}

/// A function of a scene.
struct Function {
    program: Program,
    frame: Frame,
    id: FunctionId,
}

impl Function {
    /// `fn f(p: vec3) -> {ty} { expression }`.
    fn new(ty: &str, expression: &str) -> Result<Self, Failed> {
        let scene = format!("fn f(p: vec3) -> {ty} {{ {expression} }}\nobject o {{ shape: sphere(1) }}");
        let program = compile("noise.vol", &scene)?;
        let field = program.fields.iter().find(|field| field.name == "f");
        let id = field.ok_or("the function is no field")?.function;
        Ok(Self { frame: frame(&program, 0.0, [8, 8])?, program, id })
    }

    fn at(&self, p: [f64; 3]) -> Vec<f64> {
        let function = self.program.module.function(self.id);
        vol_compiler::reference::evaluate(function, &p, &self.frame.uniforms, &self.frame.curves)
    }

    fn on_cpu(&self, points: &[[f32; 3]]) -> Result<Vec<f32>, Failed> {
        Device::Cpu
            .evaluate(&self.program, &self.frame, self.id, points)
            .map_err(|failure| format!("{failure:?}").into())
    }
}

fn somewhere(random: &mut Random, reach: f64) -> [f64; 3] {
    [(); 3].map(|()| random.between(-reach, reach))
}

type Meaning = fn([f64; 3]) -> f64;

fn calls_mean_the_operations() -> Result<(), Failed> {
    let cases: [(&str, Meaning); 13] = [
        ("perlin(p)", |p| noise::perlin(p, 0)),
        ("perlin(p, seed: 5)", |p| noise::perlin(p, 5)),
        ("perlin((p.x, p.y, p.z, 0.5 * p.x))", |p| noise::perlin4([p[0], p[1], p[2], 0.5 * p[0]], 0)),
        ("perlin(vec4(p.x, p.y, p.z, 3), seed: 2)", |p| noise::perlin4([p[0], p[1], p[2], 3.0], 2)),
        ("value(p, 9)", |p| noise::value(p, 9)),
        ("simplex(p, seed: -1)", |p| noise::simplex(p, u32::MAX)),
        ("worley(p)", |p| noise::worley(p, 0)),
        ("hash(p.x)", |p| noise::hash([p[0], 0.0, 0.0, 0.0], 0)),
        ("hash((p.x, p.y))", |p| noise::hash([p[0], p[1], 0.0, 0.0], 0)),
        ("hash(p)", |p| noise::hash([p[0], p[1], p[2], 0.0], 0)),
        ("random(p, seed: 3)", |p| noise::hash([p[0], p[1], p[2], 0.0], 3)),
        ("random(7)", |_| noise::hash([7.0, 0.0, 0.0, 0.0], 0)),
        ("random((p.x, p.y, p.z, 4), 3)", |p| noise::hash([p[0], p[1], p[2], 4.0], 3)),
    ];
    let mut random = Random::new(1);
    for (expression, meaning) in cases {
        let function = Function::new("float", expression)?;
        for _ in 0..50 {
            let p = somewhere(&mut random, 20.0);
            let (found, expected) = (function.at(p)[0], meaning(p));
            ensure(found == expected, || format!("{expression} at {p:?}: {found}, not {expected}"))?;
        }
    }
    Ok(())
}

fn constants_are_what_the_backend_computes() -> Result<(), Failed> {
    let numbers = [0, 1, 7, 4_000_000, 16_777_216, -1, -16_777_216];
    let at = numbers.map(|i| [i as f32, 0.0, 0.0]);
    for seed in [0, 3, -8] {
        let computed = Function::new("float", &format!("random(p.x, seed: {seed})"))?.on_cpu(&at)?;
        for (number, computed) in numbers.iter().zip(computed) {
            let constant = Function::new("float", &format!("random({number}, seed: {seed})"))?;
            let folded = constant.program.module.function(constant.id).insts.len();
            let found = constant.on_cpu(&[[0.0; 3]])?[0];
            ensure(folded == 1, || "the call is not folded".to_owned())?;
            ensure(found.to_bits() == computed.to_bits(), || format!("{number}: {found}, not {computed}"))?;
        }
    }
    Ok(())
}

#[expect(clippy::approx_constant, reason = "the published argument is 3.14")]
fn seed_0_of_perlin_is_the_authors() -> Result<(), Failed> {
    let found = Function::new("float", "perlin(p)")?.at([3.14, 42.0, 7.0])[0];
    ensure((found - 0.136_919_958_784_000_12).abs() < 1e-15, || format!("{found}"))
}

/// The formula as the paper prints it, with T0 and k from a contrast.
fn gardner(p: [f64; 3], terms: i32, contrast: f64) -> f64 {
    use std::f64::consts::{FRAC_PI_2, PI};
    let c = |i: i32| 0.707f64.powi(i - 1);
    let f = |i: i32| 2f64.powi(i - 1);
    let all: f64 = (1..=terms).map(c).sum();
    let t0 = all / (f64::from(terms) * contrast);
    let sum = |along: f64, across: f64| -> f64 {
        let term = |i: i32| {
            let shift = FRAC_PI_2 * (0.5 * f(i - 1) * across).sin() + PI * (f(i) * p[2] / 2.0).sin();
            c(i) * (f(i) * along + if i > 1 { shift } else { 0.0 }).sin() + t0
        };
        (1..=terms).map(term).sum()
    };
    let k = (all + f64::from(terms) * t0).powi(-2);
    k * sum(p[0], p[1]) * sum(p[1], p[0])
}

fn gardner_is_the_papers_formula() -> Result<(), Failed> {
    let mut random = Random::new(2);
    for (arguments, terms, contrast) in [
        ("", 5, 1.0),
        (", terms: 1", 1, 1.0),
        (", terms: 7, contrast: 0.25", 7, 0.25),
        (", contrast: 3", 5, 3.0),
    ] {
        let function = Function::new("float", &format!("gardner(p{arguments})"))?;
        for _ in 0..200 {
            let p = somewhere(&mut random, 30.0);
            let (found, expected) = (function.at(p)[0], gardner(p, terms, contrast));
            ensure((found - expected).abs() < 1e-12, || format!("{arguments} at {p:?}: {found} {expected}"))?;
        }
    }
    let flat = Function::new("float", "gardner(p, contrast: 0)")?.at([1.0; 3])[0];
    ensure(flat == 1.0, || format!("without contrast: {flat}"))?;
    let (_, messages) =
        compile_with_messages("g.vol", "object o { shape: sphere(1).displace(p => gardner(p, 8)) }");
    ensure(messages.contains("E0407") && messages.contains("terms: 5"), || messages.clone())
}

fn gardner_stays_in_its_range() -> Result<(), Failed> {
    let mut random = Random::new(3);
    let (mut lowest, mut highest, mut steepest) = (1.0_f64, 0.0_f64, 0.0_f64);
    for seed in [0, 6] {
        let function = Function::new("float", &format!("gardner(p, seed: {seed})"))?;
        for _ in 0..30_000 {
            let p = somewhere(&mut random, 30.0);
            let value = function.at(p)[0];
            let slope = |axis: usize| {
                let mut q = p;
                q[axis] += 1e-6;
                (function.at(q)[0] - value) / 1e-6
            };
            let length = slope(0).hypot(slope(1)).hypot(slope(2));
            (lowest, highest, steepest) = (lowest.min(value), highest.max(value), steepest.max(length));
        }
    }
    ensure(lowest >= 0.0 && highest <= 1.0 && steepest <= 7.7, || format!("{lowest} {highest} {steepest}"))?;
    ensure(lowest < 0.05 && highest > 0.7 && steepest > 2.0, || format!("{lowest} {highest} {steepest}"))
}

fn curl_has_no_sources() -> Result<(), Failed> {
    let mut random = Random::new(4);
    for seed in [0, 1] {
        let flow = Function::new("vec3", &format!("curl(p, seed: {seed})"))?;
        let mut most = 0.0_f64;
        for _ in 0..3000 {
            let p = somewhere(&mut random, 40.0);
            let step = 1e-5;
            let rise = |axis: usize| {
                let (mut low, mut high) = (p, p);
                low[axis] -= step;
                high[axis] += step;
                (flow.at(high)[axis] - flow.at(low)[axis]) / (2.0 * step)
            };
            let (each, found) = ([rise(0), rise(1), rise(2)], flow.at(p));
            let sources: f64 = each.iter().sum();
            ensure(sources.abs() < 1e-6, || format!("{sources} at {p:?} of {each:?}"))?;
            ensure(found.iter().all(|x| x.abs() <= 7.5), || format!("{found:?}"))?;
            most = found.iter().fold(most, |most, x| most.max(x.abs()));
        }
        ensure(most > 2.0, || format!("hardly any flow: {most}"))?;
    }
    Ok(())
}

fn curl_is_no_displacement() -> Result<(), Failed> {
    let scene = "object o { shape: sphere(1).displace(p => 0.1 * curl(p).x) }";
    let (program, messages) = compile_with_messages("curl.vol", scene);
    ensure(program.is_none() && messages.contains("slope"), || messages.clone())
}

fn smooth_noises_displace() -> Result<(), Failed> {
    for noise in
        ["value(3 * p)", "simplex(2 * p)", "worley(3 * p)", "perlin((p.x, p.y, p.z, time))", "gardner(2 * p)"]
    {
        let scene = format!("object o {{ shape: sphere(1).displace(p => 0.1 * {noise}) }}");
        let (program, messages) = compile_with_messages("displaced.vol", &scene);
        ensure(program.is_some() && messages.is_empty(), || format!("{noise}: {messages}"))?;
    }
    Ok(())
}
