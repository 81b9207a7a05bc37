//! The bound on the distance to tubes against the definition of their inside, in f64.

use super::*;
use crate::frame::Frame;
use crate::ir::FunctionId;
use crate::program::Program;
use crate::reference;
use crate::reference::curve::closest;
use std::f64::consts::PI;
use vol_language::source::SourceFile;

struct Compiled {
    program: Program,
    frame: Result<Frame, Diagnostic>,
}

fn compile(text: &str) -> Compiled {
    let file = SourceFile::new("tube.vol", text);
    let (scene, diagnostics) = vol_language::analyse(&file, &crate::library::library());
    let scene = scene.unwrap_or_else(|| panic!("{text}: {diagnostics:?}"));
    let (program, diagnostics) = crate::lower::compile(&scene);
    let program = program.unwrap_or_else(|| panic!("{text}: {diagnostics:?}"));
    let frame = program.frame(&[], 0.0, 0.0, [4, 4]);
    Compiled { program, frame }
}

fn object(tube: &str) -> Compiled {
    compile(&format!("object o {{ shape: tube({tube}) }}"))
}

impl Compiled {
    fn frame(&self) -> &Frame {
        self.frame.as_ref().unwrap_or_else(|diagnostic| panic!("{}", diagnostic.message))
    }

    fn evaluate(&self, function: FunctionId, p: DVec3) -> Vec<f64> {
        let frame = self.frame();
        let function = self.program.module.function(function);
        reference::evaluate(function, &p.to_array(), &frame.uniforms, &frame.curves)
    }

    fn distance(&self, p: DVec3) -> f64 {
        self.evaluate(self.program.objects[0].distance, p)[0]
    }

    fn field(&self, name: &str, p: DVec3) -> Vec<f64> {
        let field = self.program.fields.iter().find(|field| field.name == name).expect("a field");
        self.evaluate(field.function, p)
    }
}

fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

fn random_point(seed: &mut u64) -> DVec3 {
    DVec3::new(random(seed), random(seed), random(seed))
}

/// A tube with what it is by definition.
struct Case {
    tube: &'static str,
    radius: fn(f64) -> f64,
    flat: bool,
    size: f64,
}

const CASES: &[Case] = &[
    Case { tube: "line((0, -1, 0), (0, 1, 0)), radius: 0.4", radius: |_| 0.4, flat: true, size: 1.6 },
    Case {
        tube: "line((0, -1, 0), (0, 1, 0)), radius: t => 0.1 + 0.7 * t",
        radius: |t| 0.1 + 0.7 * t,
        flat: true,
        size: 2.0,
    },
    Case {
        tube: "bezier((-1, 0, 0), (0, 1.4, 0.3), (1, 0, 0)), radius: t => 0.05 + 0.3 * t * t",
        radius: |t| 0.05 + 0.3 * t * t,
        flat: true,
        size: 1.6,
    },
    Case {
        tube: "bezier((-1, 0, 0), (0, 1.4, 0.3), (1, 0, 0)), radius: t => 0.2 + 0.1 * sin(20 * t), caps: round",
        radius: |t| 0.2 + 0.1 * (20.0 * t).sin(),
        flat: false,
        size: 1.6,
    },
    // Round ends and one radius: corners, a sharp bend and an overlap are all allowed.
    Case {
        tube: "path([line((-1, 0, 0), (0, 0.1, 0)), line((0, 0.1, 0), (-1, 0.3, 0.2))]), radius: 0.25, caps: round",
        radius: |_| 0.25,
        flat: false,
        size: 1.6,
    },
    Case { tube: "circle(1), radius: 0.3", radius: |_| 0.3, flat: false, size: 1.6 },
    Case {
        tube: "helix(0.7, 1.5, 1.5), radius: t => 0.1 + 0.1 * t",
        radius: |t| 0.1 + 0.1 * t,
        flat: true,
        size: 1.8,
    },
    // Two branches of one radius, the ends of the path flat.
    Case {
        tube: "path([line((-1, 0, 0), (0, 0.2, 0)), line((0, 1.2, 0), (1, 1, 0))]), radius: 0.2",
        radius: |_| 0.2,
        flat: true,
        size: 1.5,
    },
    // The ends come near each other.
    Case {
        tube: "catmull_rom([(0.3, 0, 1), (1, 0, 0.3), (0, 0, -1), (-1, 0, 0.3), (-0.3, 0, 1)]), radius: 0.14",
        radius: |_| 0.14,
        flat: true,
        size: 1.4,
    },
];

/// The definition: nearer to the foot than the radius there, and not beyond a flat end.
fn inside(case: &Case, segments: &[Quadratic], p: DVec3) -> bool {
    let at = closest(p.to_array(), segments).expect("a curve");
    at.distance < (case.radius)(at.t) && !(case.flat && at.overshoot > 0.0)
}

#[test]
fn distances_never_reach_across_the_surface() {
    let mut seed = 7;
    for case in CASES {
        let tube = object(case.tube);
        let segments = tube.frame().curves[0].clone();
        let mut crossed = 0;
        for _ in 0..250 {
            let p = case.size * random_point(&mut seed);
            let distance = tube.distance(p);
            assert_eq!(distance < 0.0, inside(case, &segments, p), "{} {p}", case.tube);
            for _ in 0..12 {
                let direction = random_point(&mut seed).normalize();
                let share = 0.5 + 0.4999 * random(&mut seed).abs();
                let q = p + direction * share * distance.abs();
                crossed += usize::from(inside(case, &segments, q) != (distance < 0.0));
            }
        }
        assert_eq!(crossed, 0, "{}", case.tube);
    }
}

#[test]
fn distances_are_not_much_too_short() {
    // Marching needs few steps: along rays towards the middle the bound adds up to a hit.
    let mut seed = 8;
    for case in CASES {
        let tube = object(case.tube);
        let segments = tube.frame().curves[0].clone();
        let (mut steps, mut hits) = (0, 0);
        for _ in 0..60 {
            let from = 3.0 * random_point(&mut seed).normalize();
            let at = point_of(&segments, random(&mut seed).abs());
            let direction = (at - from).normalize();
            let mut s = 0.0;
            while s < 6.0 && steps < 60 * 400 {
                let distance = tube.distance(from + s * direction);
                if distance < 1e-4 {
                    hits += 1;
                    break;
                }
                s += distance;
                steps += 1;
            }
        }
        assert!(hits == 60 && steps < 60 * 60, "{}: {hits} hits, {steps} steps", case.tube);
    }
}

fn point_of(segments: &[Quadratic], t: f64) -> DVec3 {
    let place = t * segments.len() as f64;
    let index = (place as usize).min(segments.len() - 1);
    let u = place - index as f64;
    let [a, b, c] = [segments[index].a, segments[index].b, segments[index].c].map(DVec3::from);
    a.lerp(b, u).lerp(b.lerp(c, u), u)
}

#[test]
fn gradients_match_differences() {
    let mut seed = 9;
    for case in CASES {
        let tube = object(case.tube);
        let mut compared = 0;
        for _ in 0..100 {
            let p = case.size * random_point(&mut seed);
            let gradient = tube.evaluate(tube.program.objects[0].gradient, p);
            for (axis, &slope) in [DVec3::X, DVec3::Y, DVec3::Z].iter().zip(&gradient) {
                let difference = |step: f64| {
                    (tube.distance(p + *axis * step) - tube.distance(p - *axis * step)) / (2.0 * step)
                };
                let (coarse, fine) = (difference(2e-6), difference(1e-6));
                if (coarse - fine).abs() < 1e-5 {
                    assert!((slope - fine).abs() < 1e-4, "{} {p}: {slope} {fine}", case.tube);
                    compared += 1;
                }
            }
        }
        assert!(compared > 250, "{}: {compared}", case.tube);
    }
}

#[test]
fn reach_by_hand() {
    let reach_of = |text: &str, most: f64| {
        let tube = compile(&format!("medium m {{ region: tube({text}) }}"));
        let segments = &tube.frame().curves[0];
        let table = crate::curve::prepare(segments);
        let closed = tube.program.tubes.first().is_some_and(|sizes| sizes.caps == Caps::Joined);
        let arcs = arcs(segments, table.length, 0.1, closed);
        reach::reach(&reach::Axis { arcs: &arcs, length: table.length, closed }, most)
    };
    let circle = reach_of("circle(1), radius: 0.1", 50.0);
    assert!(circle > 0.93 && circle <= 1.0, "{circle}");
    assert_eq!(reach_of("line((0, 0, 0), (1, 0, 0)), radius: 0.1", 50.0), 50.0);
    assert_eq!(
        reach_of("path([line((0, 0, 0), (1, 0, 0)), line((1, 0, 0), (1, 1, 0))]), radius: 0.1", 50.0),
        0.0
    );
    // Two turns of a spring, 0.3 apart.
    let spring = reach_of("helix(1, 0.6, 2), radius: 0.1", 50.0);
    assert!(spring > 0.12 && spring < 0.15, "{spring}");
    // Two parallel lines across a gap.
    let pair =
        reach_of("path([line((0, 0, 0), (1, 0, 0)), line((0, 0.4, 0), (1, 0.4, 0))]), radius: 0.1", 50.0);
    assert!(pair > 0.18 && pair <= 0.2, "{pair}");
}

#[test]
fn unsafe_tubes_are_refused_as_objects_only() {
    let corner = "path([line((0, 0, 0), (1, 0, 0)), line((1, 0, 0), (1, 1, 0))])";
    let refused = [
        format!("{corner}, radius: t => 0.1 + 0.1 * t"),
        "bezier((0, 0, 0), (0.2, 1, 0), (0.4, 0, 0)), radius: t => 0.2 + 0.5 * t".to_owned(),
        "line((0, 0, 0), (0, 1, 0)), radius: 0.1, caps: open".to_owned(),
        // An end inside another part.
        "bezier((0, 0, 0), (2, 0, 0), (0, 0.1, 0)), radius: 0.2".to_owned(),
    ];
    for tube in refused {
        let found = object(&tube).frame.err().map(|diagnostic| diagnostic.code);
        assert_eq!(found, Some("E0503"), "{tube}");
        compile(&format!("medium m {{ region: tube({tube}) }}")).frame();
    }
    object(&format!("{corner}, radius: 0.1")).frame();
}

#[test]
fn degenerate_tubes_are_finite() {
    for tube in [
        "line((1, 1, 1), (1, 1, 1)), radius: 0.2",
        "bezier((0, 0, 0), (0, 0, 0), (0, 0, 0)), radius: t => 0.1 + t",
        "line((0, 0, 0), (0, 1, 0)), radius: 0",
        "catmull_rom([(0, 0, 0), (0, 0, 0), (0, 0, 0)], closed: true), radius: 0.3",
        "line((100000, 0, 0), (100000, 1, 0)), radius: t => 0.2 + 0.1 * t",
    ] {
        let medium = compile(&format!("medium m {{ region: tube({tube}) }}"));
        for p in [DVec3::ZERO, DVec3::ONE, DVec3::splat(1e6), DVec3::new(100_000.0, 0.5, 0.1)] {
            let found = medium.field("distance:m", p)[0];
            assert!(found.is_finite(), "{tube} {p}: {found}");
        }
    }
}

#[test]
fn caps_by_hand() {
    let inside = |caps: &str, p: [f64; 3]| {
        let text =
            format!("medium m {{ region: tube(line((0, 0, 0), (0, 1, 0)), radius: 0.5, caps: {caps}) }}");
        compile(&text).field("distance:m", p.into())[0] < 0.0
    };
    let above = [0.0, 1.3, 0.0];
    assert_eq!(["flat", "round", "open"].map(|caps| inside(caps, above)), [false, true, true]);
    assert_eq!(["flat", "round", "open"].map(|caps| inside(caps, [0.4, 1.4, 0.0])), [false, false, true]);
    assert_eq!(["flat", "round", "open"].map(|caps| inside(caps, [0.4, 0.9, 0.0])), [true; 3]);
    assert!(inside("open", [0.0, 500.0, 0.4]) && !inside("open", [0.0, 500.0, 0.6]));
}

#[test]
fn closed_tubes_have_no_seam() {
    let ring = "catmull_rom([(1, 0, 0), (0, 0.4, -1), (-1, 0, 0), (0, -0.3, 1)], closed: true)";
    let tube = object(&format!("{ring}, radius: 0.2"));
    let seam = DVec3::from(tube.frame().curves[0][0].a);
    assert!((tube.distance(seam) + 0.2).abs() < 1e-6, "{}", tube.distance(seam));
    // Local x and y are the same on both sides.
    let tangent = DVec3::from(tube.frame().curves[0][0].b) - seam;
    let tangent = tangent.normalize();
    let step = tangent * 1e-5;
    let side = seam + tangent.any_orthonormal_vector() * 0.1;
    let (before, after) = (tube.field("local:o", side - step), tube.field("local:o", side + step));
    assert!(
        (before[0] - after[0]).abs() < 1e-3 && (before[2] - after[2]).abs() < 1e-3,
        "{before:?} {after:?}"
    );
    assert!((before[1] - after[1]).abs() > 1.0, "{before:?} {after:?}");
}

#[test]
fn frenet_frame_points_to_the_centre() {
    for curve in ["circle(1)", "bezier((1, 0, 0), (0, 0, -1.4), (-1, 0, 0))"] {
        let tube = object(&format!("{curve}, radius: 0.2, frame: frenet"));
        let segment = tube.frame().curves[0][0];
        for u in [0.2, 0.5, 0.9] {
            let [a, b, c] = [segment.a, segment.b, segment.c].map(DVec3::from);
            let p = a.lerp(b, u).lerp(b.lerp(c, u), u);
            let tangent = (b - a).lerp(c - b, u).normalize();
            let inwards = ((c - b) - (b - a)).reject_from(tangent).normalize();
            let local = tube.field("local:o", p + 0.1 * inwards);
            assert!((local[0] - 0.5).abs() < 1e-5 && local[2].abs() < 1e-5, "{curve} {u}: {local:?}");
        }
    }
}

/// Sum of the density over a box, times the volume of a cell.
fn mass(scene: &Compiled, lo: [f64; 3], hi: [f64; 3], cells: usize) -> f64 {
    let size: DVec3 = (DVec3::from(hi) - DVec3::from(lo)) / cells as f64;
    let mut sum = 0.0;
    for i in 0..cells.pow(3) {
        let place = DVec3::new(
            (i % cells) as f64 + 0.5,
            (i / cells % cells) as f64 + 0.5,
            (i / cells.pow(2)) as f64 + 0.5,
        );
        sum += scene.field("density:m", DVec3::from(lo) + place * size)[0];
    }
    sum * size.x * size.y * size.z
}

#[test]
fn conserved_mass_is_that_of_the_unit_cylinder() {
    let spine = "bezier((-1, 0, 0), (0, 1, 0), (1, 0, 0))";
    let (lo, hi) = ([-1.4, -0.4, -0.4], [1.4, 0.9, 0.4]);
    for tube in [
        format!("tube({spine}, radius: 0.35, conserve_mass: true)"),
        format!("tube({spine}, radius: t => 0.15 + 0.2 * t, twist: t => 3rad * t, conserve_mass: true)"),
    ] {
        let scene = compile(&format!("medium m {{ region: {tube} }}"));
        let found = mass(&scene, lo, hi, 36);
        assert!((found / PI - 1.0).abs() < 0.02, "{tube}: {found}");
    }
    // The key of the medium, and a scale about it.
    let scaled = format!("tube({spine}, radius: 0.35).scale(0.5)");
    let scene = compile(&format!("medium m {{ region: {scaled}, conserve_mass: true }}"));
    let found = mass(&scene, lo.map(|x| 0.5 * x), hi.map(|x| 0.5 * x), 36);
    assert!((found / PI - 1.0).abs() < 0.02, "{found}");
    let scene = compile(&format!(
        "medium m {{ region: tube({spine}, radius: 0.35, conserve_mass: true), conserve_mass: false }}"
    ));
    let volume = PI * 0.35 * 0.35 * scene.field("local:m", DVec3::new(1.0, 0.0, 0.0))[1];
    let found = mass(&scene, lo, hi, 36);
    assert!((found / volume - 1.0).abs() < 0.02, "{found} {volume}");
}

#[test]
fn grown_tubes_are_inside_their_cells() {
    let mut seed = 11;
    for case in CASES {
        let scene = compile(&format!("medium m {{ region: tube({}).round(0.3) }}", case.tube));
        let (mut inside, mut skipped) = (0, 0);
        for _ in 0..1500 {
            let p = 1.5 * case.size * random_point(&mut seed);
            let cells = &scene.frame().media[0].cells;
            let within = |c: &crate::frame::Aabb| {
                (0..3).all(|i| f64::from(c.lo[i]) <= p[i] && p[i] <= f64::from(c.hi[i]))
            };
            let covered = cells.iter().any(within);
            inside += usize::from(scene.field("distance:m", p)[0] < 0.0);
            skipped += usize::from(scene.field("distance:m", p)[0] < 0.0 && !covered);
        }
        assert!(skipped == 0 && inside >= 10, "{}: {skipped} of {inside}", case.tube);
    }
}

#[test]
fn open_tubes_are_inside_their_cells() {
    let mut seed = 12;
    for (tube, ends) in [
        ("line((0, -1, 0), (0, 1, 0)), radius: 0.3", [false, true, false]),
        ("bezier((-1, 0, 0), (0, 1, 0.4), (1, 0, 0)), radius: t => 0.1 + 0.3 * t", [true, true, true]),
        ("bezier((-1, 0, 0), (0, 1, 0), (1, 0, 0)), radius: 0.2", [true, true, false]),
        ("path([line((-1, 0, 0), (0, 0, 0)), line((0, 0, 0), (-1, 0.1, 0))]), radius: 0.2", [true; 3]),
    ] {
        let scene = compile(&format!("medium m {{ region: tube({tube}, caps: open) }}"));
        let medium = &scene.frame().media[0];
        assert!(medium.cells.len() <= 64);
        let endless = |i: usize| !(medium.bounds.lo[i].is_finite() && medium.bounds.hi[i].is_finite());
        assert_eq!([0, 1, 2].map(endless), ends, "{tube}");
        let mut inside = 0;
        for i in 0..3000 {
            let p = random_point(&mut seed) * if i % 2 == 0 { 1.5 } else { 30.0 };
            // Most of the far ones near the axis of an end.
            let p = if i % 4 == 1 { p * DVec3::new(0.02, 1.0, 0.02) } else { p };
            if scene.field("distance:m", p)[0] < 0.0 {
                let within = |c: &crate::frame::Aabb| {
                    (0..3).all(|i| f64::from(c.lo[i]) <= p[i] && p[i] <= f64::from(c.hi[i]))
                };
                assert!(medium.cells.iter().any(within), "{tube} {p}");
                inside += 1;
            }
        }
        assert!(inside > 20, "{tube}: {inside}");
    }
}
