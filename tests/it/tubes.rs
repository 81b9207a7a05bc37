//! Tubes: what decides where they overlap, mass that is conserved, long curves.
//!
//! Densities come from the CPU as a picture would ask for them; what they should be from the definition of a
//! tube (lines, searched curves) or from integrals that are known.

use crate::solid::along;
use crate::support::{Random, compile, compile_with_messages, ensure, frame, on_both};
use libtest_mimic::{Failed, Trial};
use std::f64::consts::{PI, TAU};
use vol::backend::Device;
use vol_compiler::curve::Quadratic;
use vol_compiler::frame::{Frame, Job, Quadrature, Sampling};
use vol_compiler::program::Program;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = vec![
        Trial::test("tubes::overlap_rules_by_definition", overlap_rules_by_definition),
        Trial::test("tubes::a_foot_has_its_own_coordinates", a_foot_has_its_own_coordinates),
        Trial::test("tubes::open_ends_by_feet", open_ends_by_feet),
        Trial::test("tubes::crossing_parts_add_their_mass", crossing_parts_add_their_mass),
        Trial::test("tubes::overlap_is_for_media", overlap_is_for_media),
        Trial::test("tubes::mass_is_conserved", mass_is_conserved),
        Trial::test("tubes::mass_in_own_parameters", mass_in_own_parameters),
        Trial::test("tubes::ten_thousand_segments", ten_thousand_segments),
        Trial::test("tubes::mixed_paths_cost_no_runs", mixed_paths_cost_no_runs),
    ];
    trials.extend(on_both("tubes::a_sum_is_twice_as_dense", |draw| {
        // Looking down on a crossing: the middle of the picture sees both arms.
        let bright = |overlap: &str| -> Result<f32, Failed> {
            let text = scene(&format!("{CROSS}, radius: 0.3, overlap: {overlap}"), "density: 0.4\nemit: 1\nscatter: 0");
            let text = format!("{text}\ncamera {{ from: (0, 0, 6), at: (0, 0, 0), fov: 30deg }}\nlight l {{ from: (0, 1, 0) }}");
            let program = compile("cross.vol", &text)?;
            let frame = frame(&program, 0.0, [33, 33])?;
            let job = Job { size: [33, 33], step: 0.01, shadow_step: 0.1, quadrature: Quadrature::Midpoint, sampling: Sampling::CENTRE };
            Ok(draw(&program, &frame, &job)?.pixels[16 * 33 + 16].color[0])
        };
        let through = |depth: f64| depth as f32;
        let (one, both) = (bright("nearest")?, bright("sum")?);
        // 0.6 of density 0.4 that glows without absorbing, once and twice.
        ensure((one - through(0.24)).abs() < 2e-3, || format!("nearest: {one}"))?;
        ensure((both - through(0.48)).abs() < 2e-3, || format!("sum: {both}"))
    }));
    trials
}

/// Two lines that cross at the origin.
const CROSS: &str = "path([line((-2, 0, 0), (2, 0, 0)), line((0, -2, 0), (0, 2, 0))])";

fn scene(tube: &str, medium: &str) -> String {
    format!("medium m {{\nregion: tube({tube})\n{medium}\n}}")
}

struct Compiled {
    program: Program,
    frame: Frame,
}

impl Compiled {
    fn new(text: &str) -> Result<Self, Failed> {
        Self::at(text, 0.0)
    }

    fn at(text: &str, time: f64) -> Result<Self, Failed> {
        let program = compile("tube.vol", text)?;
        let frame = frame(&program, time, [4, 4])?;
        Ok(Self { program, frame })
    }

    /// A field of the medium at points, in f32.
    fn field(&self, name: &str, points: &[[f32; 3]]) -> Result<Vec<f32>, Failed> {
        let field = self.program.fields.iter().find(|field| field.name == name);
        let field = field.ok_or_else(|| format!("there is no field {name}"))?;
        let values = Device::Cpu.evaluate(&self.program, &self.frame, field.function, points);
        values.map_err(|failure| format!("{failure:?}").into())
    }

    /// Sum of the density over the medium's box, times the volume of a cell, in f64.
    fn mass(&self, cells: usize) -> Result<f64, Failed> {
        let bounds = self.frame.media[0].bounds;
        let size: [f64; 3] = std::array::from_fn(|i| f64::from(bounds.hi[i] - bounds.lo[i]) / cells as f64);
        let mut sum = 0.0;
        for slice in 0..cells {
            let place = |i: usize, k: usize| f64::from(bounds.lo[i]) + (k as f64 + 0.5) * size[i];
            let points: Vec<[f32; 3]> = (0..cells * cells)
                .map(|i| [place(0, i % cells), place(1, i / cells), place(2, slice)].map(|x| x as f32))
                .collect();
            sum += self.field("density:m", &points)?.into_iter().map(f64::from).sum::<f64>();
        }
        Ok(sum * size[0] * size[1] * size[2])
    }
}

/// Three lines with a radius each; a point is in the part of one if its foot is inside.
const LINES: [([f64; 3], [f64; 3], f64); 3] = [
    ([-2.0, 0.0, 0.0], [2.0, 0.3, 0.0], 0.5),
    ([0.2, -2.0, 0.4], [0.0, 2.0, 0.3], 0.2),
    ([2.0, -1.75, 2.1], [-2.0, 1.25, -2.3], 0.35),
];

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    along(a, b, -1.0)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

/// Distance from a line, if its foot is inside.
fn from_line(p: [f64; 3], (a, b, _): ([f64; 3], [f64; 3], f64)) -> Option<f64> {
    let (axis, off) = (sub(b, a), sub(p, a));
    let t = dot(axis, off) / dot(axis, axis);
    let across: [f64; 3] = std::array::from_fn(|i| off[i] - t * axis[i]);
    (t > 0.0 && t < 1.0).then(|| dot(across, across).sqrt())
}

fn lines(overlap: &str) -> Result<Compiled, Failed> {
    let line = |(a, b, _): &([f64; 3], [f64; 3], f64)| {
        format!("line(({}, {}, {}), ({}, {}, {}))", a[0], a[1], a[2], b[0], b[1], b[2])
    };
    let path = LINES.iter().map(line).collect::<Vec<_>>().join(", ");
    let radius = "t => if t < 1 / 3 then 0.5 else if t < 2 / 3 then 0.2 else 0.35";
    Compiled::new(&scene(&format!("path([{path}]), radius: {radius}, overlap: {overlap}"), "density: 1"))
}

fn random_points(seed: u64, count: usize, size: f64) -> Vec<[f32; 3]> {
    let mut random = Random::new(seed);
    (0..count).map(|_| [(); 3].map(|()| random.between(-size, size) as f32)).collect()
}

fn overlap_rules_by_definition() -> Result<(), Failed> {
    let points = random_points(3, 20_000, 1.2);
    let (nearest, ratio, sum) = (lines("nearest")?, lines("min_ratio")?, lines("sum")?);
    let density = |scene: &Compiled| scene.field("density:m", &points);
    let found = [density(&nearest)?, density(&ratio)?, density(&sum)?];
    let distances = [ratio.field("distance:m", &points)?, sum.field("distance:m", &points)?];
    let mut different = [0, 0];
    for (i, p) in points.iter().enumerate() {
        let off: Vec<(f64, f64)> =
            LINES.iter().filter_map(|line| Some((from_line(p.map(f64::from), *line)?, line.2))).collect();
        if off.iter().any(|(d, r)| (d - r).abs() < 1e-5) {
            continue;
        }
        let inside = off.iter().filter(|(d, r)| d < r).count();
        let union = if inside > 0 { 1.0 } else { 0.0 };
        let place = || format!("{p:?}: {:?} inside {inside}", found.each_ref().map(|found| found[i]));
        ensure(found[1][i] == union && found[2][i] == inside as f32, place)?;
        ensure(distances.iter().all(|d| (d[i] < 0.0) == (inside > 0)), place)?;
        different[0] += usize::from(found[0][i] != union);
        different[1] += usize::from(inside > 1);
    }
    // The thick line hides within the thin ones by the nearest point.
    ensure(different[0] > 200 && different[1] > 500, || format!("{different:?}"))
}

fn a_foot_has_its_own_coordinates() -> Result<(), Failed> {
    // At the crossing a point is 0.1 from the thick line and 0.05 from the thin one, 0.1 / 0.5 < 0.05 / 0.1.
    let tube =
        |overlap: &str| format!("{CROSS}, radius: t => if t < 0.5 then 0.5 else 0.1, overlap: {overlap}");
    let point = [[0.05, 0.1, 0.0]];
    let asked = "density: q => q.t + 10 * q.l";
    let [nearest, ratio, sum] = ["nearest", "min_ratio", "sum"].map(|overlap| {
        Compiled::new(&scene(&tube(overlap), asked)).and_then(|scene| scene.field("density:m", &point))
    });
    let (thick, thin) = (0.5 * 2.05 / 4.0 + 20.5, 0.5 + 0.5 * 2.1 / 4.0 + 61.0);
    let near = |found: &[f32], wanted: f64| (f64::from(found[0]) - wanted).abs() < 1e-4;
    let (nearest, ratio, sum) = (nearest?, ratio?, sum?);
    ensure(near(&nearest, thin), || format!("nearest: {nearest:?}, not {thin}"))?;
    ensure(near(&ratio, thick), || format!("min_ratio: {ratio:?}, not {thick}"))?;
    ensure(near(&sum, thick + thin), || format!("sum: {sum:?}, not {}", thick + thin))?;
    // Moved and scaled it is the same.
    let moved = format!("{}).scale(2).translate((1, 0, 0)", tube("sum"));
    let found = Compiled::new(&scene(&moved, asked))?.field("density:m", &[[1.1, 0.2, 0.0]])?;
    ensure(near(&found, thick + thin), || format!("moved: {found:?}"))
}

fn open_ends_by_feet() -> Result<(), Failed> {
    // Open ends go on; the straight part beyond one crosses the other arm.
    let tube = "path([line((-3, 0, 0), (-1, 0, 0)), line((0, -2, 0), (0, 2, 0))]), radius: 0.3, caps: open";
    let points = [[0.0, 0.0, 0.1], [0.0, 1.0, 0.1], [0.0, 9.0, 0.1], [-9.0, 0.0, 0.1], [-2.0, 0.0, 0.4]];
    let found = |overlap: &str| {
        Compiled::new(&scene(&format!("{tube}, overlap: {overlap}"), "density: 1"))?
            .field("distance:m", &points)
    };
    let inside = |found: &[f32]| found.iter().map(|d| *d < 0.0).collect::<Vec<_>>();
    for overlap in ["nearest", "min_ratio", "sum"] {
        let found = found(overlap)?;
        ensure(inside(&found) == [true, true, true, true, false], || format!("{overlap}: {found:?}"))?;
    }
    Ok(())
}

fn crossing_parts_add_their_mass() -> Result<(), Failed> {
    // A loop that crosses itself, a closed eight, and turns that lie in each other; smooth at walls and ends.
    let open = "30 * pow(q.local.y * (1 - q.local.y), 2)";
    let cases = [
        ("bezier((-1, -0.6, 0), (3, 1.6, 0), (-3, 1.6, 0), (1, -0.6, 0))", 0.25, open),
        ("catmull_rom([(1, 0.5, 0), (1, -0.5, 0), (-1, 0.5, 0.02), (-1, -0.5, 0)], closed: true)", 0.15, "1"),
        ("helix(0.6, 0.5, 3)", 0.2, open),
    ];
    for (curve, radius, along) in cases {
        let mass = |overlap: &str| -> Result<(f64, f64), Failed> {
            let tube = format!("{curve}, radius: {radius}, stretch: true, overlap: {overlap}");
            let medium = format!("density: q => {along} * pow(max(0, 1 - q.radius * q.radius), 2)");
            let scene = Compiled::new(&scene(&tube, &medium))?;
            Ok((scene.mass(110)?, scene.frame.curve_tables[0].length))
        };
        let ((once, _), (all, length)) = (mass("nearest")?, mass("sum")?);
        // Pappus: what bends closer is made up for by what bends away.
        let wanted = PI / 3.0 * radius * radius * length;
        ensure((all / wanted - 1.0).abs() < 1e-3, || format!("{curve}: {all}, not {wanted}"))?;
        ensure(once < 0.99 * wanted, || format!("{curve}: nearest {once} of {wanted}"))?;
    }
    Ok(())
}

fn overlap_is_for_media() -> Result<(), Failed> {
    let codes = |text: &str| {
        let (_, messages) = compile_with_messages("tube.vol", text);
        messages
    };
    let object = |tube: &str| codes(&format!("object o {{ shape: tube({tube}) }}"));
    let varies = format!("{CROSS}, radius: t => 0.1 + 0.1 * t, overlap: min_ratio");
    ensure(object(&varies).contains("E0503"), || object(&varies))?;
    // With one radius and round ends it is the union in any case.
    let even = "bezier((0, 0, 0), (1, 1, 0), (2, 0, 0)), radius: 0.2, caps: round, overlap: min_ratio";
    ensure(object(even).is_empty(), || object(even))?;
    let part =
        codes("medium m { region: tube(line((0, 0, 0), (0, 1, 0)), radius: 0.2, overlap: sum) | sphere(1) }");
    ensure(part.contains("E0407"), || part.clone())
}

/// Densities whose mass in the unit cylinder is PI / 3: smooth at the wall, the flat ends none, different along
/// and around.
const OPEN: &str = "density: q => 30 * pow(q.local.y * (1 - q.local.y), 2) * pow(max(0, 1 - q.radius * q.radius), 2) * (1 + 0.8 * q.local.x)";
const CLOSED: &str = "density: q => (1 + 0.7 * sin(3turn * q.local.y)) * pow(max(0, 1 - q.radius * q.radius), 2) * (1 + 0.8 * q.local.x)";

/// Curves that stretch and bend with the time, with their radius and twist.
fn stretched() -> Vec<(String, &'static str)> {
    let spread = "radius: t => 0.2 + 0.15 * t, twist: t => 4rad * t";
    let waves = "radius: (t, l) => 0.25 + 0.08 * sin(5 * l), twist: (t, l) => 2rad * l";
    let ring = "radius: t => 0.2 + 0.05 * sin(1turn * t), twist: t => 1turn * t";
    vec![
        (format!("bezier((-1 - time, 0, 0), (0, 1.2, 0.4 * time), (1, 0, 0)), {spread}"), OPEN),
        (
            format!(
                "bezier((-1, 0, 0), (-0.5, 1.2 + time, 0.5), (1, -0.4, 0.3), (1.2 + time, 1, 0)), {spread}"
            ),
            OPEN,
        ),
        (format!("bspline([(-1, 0, 0), (0, 0.8 + time, 0), (1, 0.2, 0.6), (2, 0.5, 0)]), {waves}"), OPEN),
        (format!("helix(0.8, 1.5 + 2 * time, 1.25), {spread}"), OPEN),
        (
            format!(
                "catmull_rom([(1 + time, 0, 0), (0, 0.3, -1), (-1, 0, 0), (0, -0.2, 1)], closed: true), {ring}"
            ),
            CLOSED,
        ),
        (format!("circle(0.8 + time), {ring}"), CLOSED),
    ]
}

fn mass_is_conserved() -> Result<(), Failed> {
    for (tube, density) in stretched() {
        for time in [0.0, 0.5, 1.0] {
            let text = scene(&format!("{tube}, stretch: true, conserve_mass: true"), density);
            let found = Compiled::at(&text, time)?.mass(128)?;
            let error = found / (PI / 3.0) - 1.0;
            ensure(error.abs() < 1e-3, || format!("{tube} at {time}: off by {error}"))?;
        }
    }
    Ok(())
}

/// The same sum over places of the tube, by the curve's own points: midpoints along, around and outwards,
/// with the Jacobian from velocity and curvature of the control points.
fn mass_in_own_parameters() -> Result<(), Failed> {
    for (tube, density) in stretched() {
        let text = scene(&format!("{tube}, stretch: true, conserve_mass: true"), density);
        let scene = Compiled::at(&text, 0.5)?;
        let (points, weights) = places(&scene.frame.curves[0]);
        let values = scene.field("density:m", &points)?;
        let found: f64 = values.iter().zip(&weights).map(|(&value, weight)| f64::from(value) * weight).sum();
        let error = found / (PI / 3.0) - 1.0;
        ensure(error.abs() < 1e-3, || format!("{tube}: off by {error}"))?;
    }
    Ok(())
}

/// Points around a curve out to 0.42, which no tube of [`stretched`] exceeds, with volumes.
fn places(segments: &[Quadratic]) -> (Vec<[f32; 3]>, Vec<f64>) {
    let (count, around, outwards, most) = (480 / segments.len(), 24, 40, 0.42);
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for segment in segments {
        for i in 0..count {
            let u = (i as f64 + 0.5) / count as f64;
            let (b1, b2) = (sub(segment.b, segment.a), sub(segment.c, segment.b));
            let velocity: [f64; 3] = std::array::from_fn(|k| 2.0 * (b1[k] + u * (b2[k] - b1[k])));
            let change: [f64; 3] = std::array::from_fn(|k| 2.0 * (b2[k] - b1[k]));
            let at: [f64; 3] =
                std::array::from_fn(|k| segment.a[k] + u * (2.0 * b1[k] + u * (b2[k] - b1[k])));
            let speed = dot(velocity, velocity).sqrt();
            let tangent = velocity.map(|x| x / speed);
            let curvature = along(change, tangent, -dot(change, tangent)).map(|x| x / (speed * speed));
            // Two directions across.
            let axis = if tangent[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
            let x = along(axis, tangent, -dot(axis, tangent));
            let x = x.map(|c| c / dot(x, x).sqrt());
            let y = [
                tangent[1] * x[2] - tangent[2] * x[1],
                tangent[2] * x[0] - tangent[0] * x[2],
                tangent[0] * x[1] - tangent[1] * x[0],
            ];
            for k in 0..around * outwards {
                let angle = TAU * ((k % around) as f64 + 0.5) / around as f64;
                let out = most * ((k / around) as f64 + 0.5) / outwards as f64;
                let offset: [f64; 3] =
                    std::array::from_fn(|i| out * (angle.cos() * x[i] + angle.sin() * y[i]));
                let area = out * (most / outwards as f64) * (TAU / around as f64);
                points.push(along(at, offset, 1.0).map(|c| c as f32));
                weights.push(area * speed / count as f64 * (1.0 - dot(curvature, offset)).max(0.0));
            }
        }
    }
    (points, weights)
}

/// A path of 10 000 quadratics through a box, with its text.
fn long_path(segments: usize) -> String {
    format!(
        "fn at(i: float) -> vec3 {{ vec3(2 * cos(0.061 * i), 3 * i / {segments} - 1.5, sin(0.083 * i)) }}\n\
         medium m {{ region: tube(path([for i in 0..{segments}: bezier(0.5 * (at(i) + at(i + 1)), at(i + 1), \
         0.5 * (at(i + 1) + at(i + 2)))]), radius: 0.05) }}"
    )
}

fn ten_thousand_segments() -> Result<(), Failed> {
    let program = compile("long.vol", &long_path(10_000))?;
    let frame = frame(&program, 0.0, [4, 4])?;
    let segments = &frame.curves[0];
    ensure(segments.len() == 10_000, || format!("{} segments", segments.len()))?;
    let scene = Compiled { program, frame };
    let points = random_points(5, 300, 1.5);
    let found = scene.field("distance:m", &points)?;
    for (p, found) in points.iter().zip(found) {
        let wanted = nearest(p.map(f64::from), &scene.frame.curves[0]) - 0.05;
        ensure((f64::from(found) - wanted).abs() < 2e-6, || format!("{p:?}: {found}, not {wanted}"))?;
    }
    Ok(())
}

/// Distance to a curve by the places on a grid, made finer about the best.
fn nearest(p: [f64; 3], segments: &[Quadratic]) -> f64 {
    let distance = |s: &Quadratic, u: f64| {
        let v = 1.0 - u;
        let at = |i: usize| v * v * s.a[i] + 2.0 * u * v * s.b[i] + u * u * s.c[i] - p[i];
        (0..3).map(|i| at(i) * at(i)).sum::<f64>().sqrt()
    };
    let rough =
        |s: &Quadratic| (0..=4).map(|i| distance(s, f64::from(i) / 4.0)).fold(f64::INFINITY, f64::min);
    let least = segments.iter().map(rough).fold(f64::INFINITY, f64::min);
    let mut best = least;
    for segment in segments.iter().filter(|segment| rough(segment) < least + 0.1) {
        let (mut middle, mut half) = (0.5, 0.5);
        for _ in 0..12 {
            let at = |i: i32| f64::clamp(middle + half * f64::from(i) / 8.0, 0.0, 1.0);
            let i = (-8..=8).min_by(|&i, &k| distance(segment, at(i)).total_cmp(&distance(segment, at(k))));
            (middle, half) = (at(i.unwrap_or(0)), 0.25 * half);
        }
        best = best.min(distance(segment, middle));
    }
    best
}

fn mixed_paths_cost_no_runs() -> Result<(), Failed> {
    // Lines and cubics in turn: the parameter of a point is not put together from all of them.
    let path = |count: usize| {
        format!(
            "medium m {{ region: tube(path([for i in 0..2 * {count}: if i % 2 == 0 then line((i, 0, 0), (i + 1, 0, 0)) else \
             bezier((i, 0, 0), (i, 1, 0), (i + 1, 1, 0), (i + 1, 0, 0))]), radius: 0.1)\n\
             density: q => q.t }}"
        )
    };
    let size = |count: usize| -> Result<usize, Failed> {
        let program = compile("mixed.vol", &path(count))?;
        let field = program.fields.iter().find(|field| field.name == "density:m").ok_or("no field")?;
        Ok(program.module.function(field.function).insts.len())
    };
    let (short, long) = (size(10)?, size(1000)?);
    ensure(long <= short, || format!("{short} instructions for 10 curves of each kind, {long} for 1000"))?;
    let scene = Compiled::new(&path(100))?;
    let found = scene.field("density:m", &[[20.5, 0.0, 0.0]])?[0];
    // The middle of curve 20 of 200.
    ensure((found - 20.5 / 200.0).abs() < 1e-6, || format!("{found}"))
}
