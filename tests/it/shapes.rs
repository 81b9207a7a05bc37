//! Distances of shapes at points where they are known by hand, inside, outside and degenerate.

use crate::solid::Solid;
use crate::support::{compile, ensure, frame};
use libtest_mimic::{Failed, Trial};
use std::f64::consts::SQRT_2;

/// Shape, point, signed distance.
const CASES: &[(&str, [f64; 3], f64)] = &[
    ("sphere(2)", [3.0, 0.0, 0.0], 1.0),
    ("sphere(2)", [0.0, 0.0, 0.0], -2.0),
    ("sphere(0)", [0.0, 3.0, 4.0], 5.0),
    ("box((1, 2, 3))", [4.0, 0.0, 0.0], 3.0),
    ("box((1, 2, 3))", [4.0, 6.0, 3.0], 5.0),
    ("box((1, 2, 3))", [0.5, 0.0, 0.0], -0.5),
    ("box((1, 0, 3))", [0.0, 2.0, 0.0], 2.0),
    ("cylinder(1, 2)", [4.0, 0.0, 0.0], 3.0),
    ("cylinder(1, 2)", [0.0, 5.0, 0.0], 3.0),
    ("cylinder(1, 2)", [4.0, 6.0, 0.0], 5.0),
    ("cylinder(1, 2)", [0.25, 1.5, 0.0], -0.5),
    ("infinite_cylinder(1)", [3.0, 100.0, 4.0], 4.0),
    ("torus(3, 1)", [3.0, 2.0, 0.0], 1.0),
    ("torus(3, 1)", [0.0, 0.0, 3.0], -1.0),
    ("capsule((0, 0, 0), (0, 2, 0), 0.5)", [2.0, 1.0, 0.0], 1.5),
    ("capsule((0, 0, 0), (0, 2, 0), 0.5)", [0.0, 4.0, 0.0], 1.5),
    ("capsule((1, 1, 1), (1, 1, 1), 0.5)", [1.0, 3.0, 1.0], 1.5),
    ("plane((0, 2, 0), 1)", [5.0, 4.0, 5.0], 3.0),
    ("sphere(1) | sphere(1).translate((5, 0, 0))", [5.0, 3.0, 0.0], 2.0),
    ("sphere(1) & sphere(1).translate((1, 0, 0))", [0.5, 0.0, 0.0], -0.5),
    ("sphere(2) - sphere(1)", [0.0, 0.0, 0.0], 1.0),
    ("sphere(2) - sphere(1)", [1.5, 0.0, 0.0], -0.5),
    // Two equal distances blended by k drop by k / 4.
    ("union(sphere(1), sphere(1), smooth: 0.4)", [3.0, 0.0, 0.0], 1.9),
    ("intersect(sphere(1), sphere(1), smooth: 0.4)", [3.0, 0.0, 0.0], 2.1),
    ("subtract(box((1, 1, 1)), box((1, 1, 1)).translate((2, 0, 0)), smooth: 0.4)", [1.0, 0.0, 0.0], 0.1),
    ("union(sphere(1), sphere(1), smooth: 0)", [3.0, 0.0, 0.0], 2.0),
    ("union([for i in 0..4: sphere(0.5).translate((2 * i, 0, 0))])", [6.0, 2.0, 0.0], 1.5),
    ("box((1, 2, 3)).rotate_z(90deg)", [4.0, 0.0, 0.0], 2.0),
    ("box((1, 2, 3)).rotate_x(90deg)", [0.0, 5.0, 0.0], 2.0),
    ("box((1, 2, 3)).rotate_y(90deg)", [5.0, 0.0, 0.0], 2.0),
    // Right-handed: a turn about z takes x to y.
    ("sphere(1).translate((3, 0, 0)).rotate_z(90deg)", [0.0, 3.0, 0.0], -1.0),
    ("sphere(1).translate((0, 3, 0)).rotate_x(90deg)", [0.0, 0.0, 3.0], -1.0),
    ("sphere(1).translate((0, 0, 3)).rotate_y(90deg)", [3.0, 0.0, 0.0], -1.0),
    ("sphere(1).scale(3)", [5.0, 0.0, 0.0], 2.0),
    ("box((1, 1, 1)).round(0.5)", [3.0, 0.0, 0.0], 1.5),
    ("sphere(1).displace(p => 0.25)", [3.0, 0.0, 0.0], 2.25),
    ("cone(3, 2)", [0.0, 4.0, 0.0], 2.0),
    ("cone(3, 2)", [5.0, -2.0, 0.0], 2.0),
    ("cone(3, 2)", [0.0, -1.75, 0.0], -0.25),
    ("cone(1, 2, top: 1)", [0.0, 0.0, 3.0], 2.0),
    ("cone(0, 0)", [3.0, 4.0, 0.0], 5.0),
    ("cone(1, 0)", [0.0, 2.0, 0.0], 2.0),
    ("cone(1, 0, top: 1)", [3.0, 0.0, 0.0], 2.0),
    ("prism(4, 2, 1)", [0.0, 3.0, 0.0], 2.0),
    ("prism(4, 2, 1)", [5.0, 0.0, 0.0], 3.0),
    ("prism(3, 2, 3)", [-3.0, 0.0, 0.0], 2.0),
    ("prism(6, 0, 0)", [0.0, 3.0, 4.0], 5.0),
    ("pyramid(1, 2)", [0.0, 5.0, 0.0], 3.0),
    ("pyramid(1, 2)", [0.0, -4.0, 0.0], 2.0),
    ("pyramid(0, 0)", [3.0, 4.0, 0.0], 5.0),
    ("pyramid(1, 0)", [0.0, 2.0, 0.0], 2.0),
    ("octahedron(2)", [5.0, 0.0, 0.0], 3.0),
    ("octahedron(0)", [0.0, 4.0, 3.0], 5.0),
    ("disk(3, thickness: 0.5)", [0.0, 2.0, 0.0], 1.75),
    ("disk(3, thickness: 0.5)", [6.0, 4.0, 0.0], 4.75),
    ("ellipsoid((1, 2, 3))", [4.0, 0.0, 0.0], 3.0),
    ("ellipsoid((1, 2, 3))", [0.0, 0.0, 0.0], -1.0),
    // A bevel of 0.4 cuts the middle of two equal distances by half of it.
    ("union(sphere(1), sphere(1), chamfer: 0.4)", [3.0, 0.0, 0.0], 1.8),
    ("intersect(sphere(1), sphere(1), chamfer: 0.4)", [3.0, 0.0, 0.0], 2.2),
    // Two steps in a width of 3: edges that stand out at (1, 2) and (2, 1), dents at (0, 2), (1, 1), (2, 0).
    ("union(plane((1, 0, 0)), plane((0, 1, 0)), stairs: 3, steps: 2)", [1.0, 1.0, 0.0], 0.0),
    ("union(plane((1, 0, 0)), plane((0, 1, 0)), stairs: 3, steps: 2)", [1.0, 2.0, 0.0], 0.0),
    ("union(plane((1, 0, 0)), plane((0, 1, 0)), stairs: 3, steps: 2)", [2.0, 2.5, 0.0], 1.0),
    ("union(plane((1, 0, 0)), plane((0, 1, 0)), stairs: 3, steps: 2)", [0.0, 4.0, 0.0], 0.0),
    ("sphere(1).translate((3, 0, 0)).rotate((0, 0, 2), 90deg)", [0.0, 3.0, 0.0], -1.0),
    ("sphere(1).translate((1, 0, 0)).rotate((1, 1, 1), 120deg)", [0.0, 1.0, 0.0], -1.0),
    ("sphere(1).translate((0, 3, 0)).look_along((1, 0, -1))", [1.5 * SQRT_2, 0.0, -1.5 * SQRT_2], -1.0),
    ("sphere(1).translate((0, 3, 0)).look_along((0, -1, 0))", [0.0, -3.0, 0.0], -1.0),
    ("sphere(1).translate((0, 0, 3)).look_along((0, -1, 0))", [0.0, 0.0, -3.0], -1.0),
    ("sphere(1).translate((3, 0, 0)).mirror((2, 0, 0))", [-3.0, 0.0, 2.0], 1.0),
    ("sphere(1).elongate((0, 2, 0))", [0.0, 5.0, 0.0], 2.0),
    ("sphere(2).shell(0.5)", [0.0, 0.0, 0.0], 1.75),
    ("sphere(2).shell(0.5)", [2.0, 0.0, 0.0], -0.25),
    ("box((1, 1, 1)).scale((1, 2, 3))", [4.0, 2.0, 3.0], 3.0),
    ("sphere(1).translate((2, 1, 0)).twist(90deg)", [0.0, 1.0, -2.0], -1.0),
    // A quarter of a circle of radius 2 about (0, 2, 0) takes (pi, 0, 0) to (2, 2, 0).
    ("sphere(0.5).translate((pi, 0, 0)).bend(0.5rad)", [2.0, 2.0, 0.0], -0.5),
    ("sphere(0.5).translate((pi, 0, 0)).bend(-0.5rad)", [2.0, -2.0, 0.0], -0.5),
    ("sphere(1).translate((2, 0, 0)).bend(0rad)", [2.0, 0.0, 0.5], -0.5),
    ("sphere(1).repeat((4, 0, 0), count: (3, 1, 1))", [10.0, 0.0, 0.0], 5.0),
    ("sphere(1).repeat((4, 0, 0), count: (3, 1, 1))", [4.0, 0.0, 0.0], -1.0),
    ("sphere(1).repeat((4, 0, 4))", [402.0, 0.0, 0.0], 1.0),
    ("sphere(1).repeat((4, 0, 0), count: 2)", [2.0, 0.0, 0.0], -1.0),
    // The nearest copy is in the next cell.
    ("sphere(1).translate((0.9, 0, 0)).repeat((4, 0, 0), overlap: 1)", [-1.5, 0.0, 0.0], 0.6),
    ("sphere(1).translate((4, 0, 0)).repeat_polar(4)", [0.0, 0.0, 4.0], -1.0),
    ("sphere(1).translate((4, 0, 0)).repeat_polar(6)", [-6.0, 0.0, 0.0], 1.0),
    ("implicit(p => dot(p, p) - 1, bounds: (2, 2, 2))", [1.5, 0.0, 0.0], 1.25),
    ("implicit(p => p.y, bounds: (2, 2, 2))", [5.0, -1.0, 0.0], 3.0),
];

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials: Vec<Trial> = CASES
        .iter()
        .enumerate()
        .map(|(i, &(shape, at, distance))| {
            Trial::test(
                format!("shapes::{i:02}_{}", shape.split('(').next().unwrap_or_default()),
                move || check(shape, at, distance),
            )
        })
        .collect();
    trials.push(Trial::test("shapes::faces_are_at_their_distance", faces_are_at_their_distance));
    trials.push(Trial::test("shapes::bounds_hold_the_inside", bounds_hold_the_inside));
    trials.push(Trial::test("shapes::safe_steps_do_not_overshoot", safe_steps_do_not_overshoot));
    trials
}

fn check(shape: &str, at: [f64; 3], expected: f64) -> Result<(), Failed> {
    let program = compile("shape.vol", &format!("object o {{ shape: {shape} }}"))?;
    let frame = frame(&program, 0.0, [8, 8])?;
    let function = program.module.function(program.objects[0].distance);
    let found = vol_compiler::reference::evaluate(function, &at, &frame.uniforms, &frame.curves)[0];
    ensure((found - expected).abs() < 1e-12, || format!("{shape} at {at:?}: {found}, not {expected}"))
}

/// Shapes whose bounds come about in different ways.
const SOLIDS: &[&str] = &[
    "union(sphere(0.6), cylinder(0.2, 1.1), smooth: 0.3).rotate_z(35deg).translate((0.3, 0, 0))",
    "(box((0.5, 0.2, 0.9)) - sphere(0.4)).rotate_x(20deg).rotate_y(50deg)",
    "torus(0.7, 0.2).scale(1.3).translate((0, 0.4, 0))",
    "sphere(0.8).displace(p => 0.1 * sin(9 * p.x) * sin(8 * p.y) * sin(7 * p.z))",
    "box((0.5, 0.5, 0.5)).round(0.1).displace(p => 0.15 * perlin(4 * p))",
    "capsule((-0.5, -0.5, 0), (0.5, 0.7, 0.2), 0.25) & sphere(0.8)",
    "cone(0.6, 0.5)",
    "cone(0.3, 0.5, top: 0.7)",
    "prism(3, 0.8, 0.5)",
    "prism(5, 0.6, 0.9)",
    "pyramid(0.7, 0.6)",
    "pyramid(0.9, 0.1)",
    "ellipsoid((0.9, 0.15, 0.5)).round(0.1)",
    "octahedron(0.9)",
    "disk(0.9, thickness: 0.2)",
    "implicit(p => sin(6 * p.x) * cos(6 * p.y) + sin(6 * p.y) * cos(6 * p.z) + sin(6 * p.z) * cos(6 * p.x), bounds: 0.9)",
    "implicit(p => 0.05 * (dot(p, p) - 0.5), bounds: (0.6, 0.8, 0.9)).round(0.1)",
    "union(sphere(0.5), box((0.9, 0.1, 0.9)), sphere(0.55), sphere(0.52), chamfer: 0.3)",
    "union(cylinder(0.3, 0.9), box((0.9, 0.2, 0.9)), stairs: 0.4, steps: 4)",
    "union(sphere(0.5), sphere(0.5), sphere(0.5), sphere(0.5), smooth: 0.6)",
    "intersect(sphere(0.9), box((0.7, 0.7, 0.7)), stairs: 0.3)",
    "subtract(box((0.9, 0.4, 0.9)), cylinder(0.5, 2), chamfer: 0.2)",
    "cone(0.4, 0.9).rotate((1, 2, 3), 77deg).look_along((1, -2, 0.5))",
    "box((0.4, 0.2, 0.3)).translate((0.5, 0.1, 0)).mirror((1, 1, 0))",
    "octahedron(0.5).elongate((0.4, 0, 0.2))",
    "torus(0.8, 0.3).shell(0.1)",
    "sphere(0.5).scale((2.5, 0.6, 1)).round(0.1)",
    "box((0.8, 0.9, 0.1)).twist(100deg)",
    "union(box((0.2, 0.9, 0.1)).twist(200deg), sphere(0.2).translate((1, 0, 0)), smooth: 0.2)",
    "box((1.4, 0.2, 0.3)).bend(100deg)",
    "box((0.9, 0.3, 0.2)).translate((0.2, -0.1, 0)).bend(-90deg)",
    "sphere(0.6).bend(1e-9rad)",
    "cone(0.2, 0.2).translate((0.05, 0, 0)).repeat((0.5, 0.5, 0.6), count: (3, 2, 3))",
    "box((0.4, 0.1, 0.1)).rotate_y(30deg).repeat((0.5, 0.4, 0), count: (3, 4, 1), overlap: 1)",
    "box((0.3, 0.3, 0.1)).rotate_x(20deg).translate((0.8, 0, 0)).repeat_polar(7)",
    "capsule((0, 0, 0), (0.9, 0.3, 0.3), 0.1).repeat_polar(5, overlap: 5)",
];

/// Points on a grid over the unit neighbourhood.
fn grid() -> impl Iterator<Item = [f64; 3]> {
    let axis = || (0..41).map(|i| -1.6 + 0.08 * f64::from(i));
    axis().flat_map(move |x| axis().flat_map(move |y| axis().map(move |z| [x, y, z])))
}

fn bounds_hold_the_inside() -> Result<(), Failed> {
    for shape in SOLIDS {
        let program = compile("shape.vol", &format!("object o {{ shape: {shape} }}"))?;
        let frame = frame(&program, 0.0, [8, 8])?;
        let bounds = frame.objects[0].bounds;
        let function = program.module.function(program.objects[0].distance);
        for p in grid() {
            let distance = vol_compiler::reference::evaluate(function, &p, &frame.uniforms, &frame.curves)[0];
            let held = (0..3).all(|i| p[i] >= f64::from(bounds.lo[i]) && p[i] <= f64::from(bounds.hi[i]));
            ensure(distance >= 0.0 || held, || format!("{shape}: {p:?} is inside but not in {bounds:?}"))?;
        }
    }
    Ok(())
}

/// No two points have distances further apart than they are, after scaling by the steepness.
fn safe_steps_do_not_overshoot() -> Result<(), Failed> {
    for shape in SOLIDS {
        let solid = Solid::new(shape)?;
        for p in grid().step_by(7) {
            for direction in [[0.01, 0.0, 0.0], [0.0, -0.02, 0.01], [0.005, 0.005, -0.005]] {
                let q = [0, 1, 2].map(|i| p[i] + direction[i]);
                let apart = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
                let change = solid.safe_scale(p, q) * (solid.exact(p) - solid.exact(q)).abs();
                ensure(change <= apart * (1.0 + 1e-9), || {
                    format!("{shape}: {change} over {apart} at {p:?}")
                })?;
            }
        }
    }
    Ok(())
}

/// Corners of a regular polygon at a height.
fn ring(sides: usize, radius: f64, y: f64) -> Vec<[f64; 3]> {
    let turn = |i| std::f64::consts::TAU * i as f64 / sides as f64;
    (0..sides).map(|i| [radius * turn(i).cos(), y, radius * turn(i).sin()]).collect()
}

/// Triangles between two rings and over both ends.
fn between(low: &[[f64; 3]], high: &[[f64; 3]]) -> Vec<[[f64; 3]; 3]> {
    let ends = [[0.0, low[0][1], 0.0], [0.0, high[0][1], 0.0]];
    let side = |i: usize| {
        let next = (i + 1) % low.len();
        let (a, b, c, d) = (low[i], low[next], high[i], high[next]);
        [[a, b, c], [b, c, d], [ends[0], a, b], [ends[1], c, d]]
    };
    (0..low.len()).flat_map(side).collect()
}

/// Distances of solids with faces against the nearest of many points on their triangles.
fn faces_are_at_their_distance() -> Result<(), Failed> {
    let square = ring(4, 0.7 * SQRT_2, -0.6).into_iter();
    let eighth = std::f64::consts::FRAC_1_SQRT_2;
    let square = square.map(|[x, y, z]| [eighth * (x - z), y, eighth * (x + z)]).collect::<Vec<_>>();
    let equator = ring(4, 0.9, 0.0);
    let tips = |y: f64| vec![[0.0, y, 0.0]; 4];
    let mut octahedron = between(&equator, &tips(0.9));
    octahedron.extend(between(&equator, &tips(-0.9)));
    // The equator's own disk is inside.
    octahedron.retain(|triangle| triangle.iter().any(|corner| corner[1] != 0.0));
    let solids = [
        ("pyramid(0.7, 0.6)", between(&square, &tips(0.6))),
        ("octahedron(0.9)", octahedron),
        ("prism(3, 0.8, 0.5)", between(&ring(3, 0.8, -0.5), &ring(3, 0.8, 0.5))),
        ("prism(5, 0.6, 0.9)", between(&ring(5, 0.6, -0.9), &ring(5, 0.6, 0.9))),
        ("cone(0.7, 0.5, top: 0.3)", between(&ring(200, 0.7, -0.5), &ring(200, 0.3, 0.5))),
        ("cone(0, 0.5, top: 0.7)", between(&ring(200, 0.0, -0.5), &ring(200, 0.7, 0.5))),
    ];
    for (shape, triangles) in solids {
        let program = compile("shape.vol", &format!("object o {{ shape: {shape} }}"))?;
        let frame = frame(&program, 0.0, [8, 8])?;
        let function = program.module.function(program.objects[0].distance);
        for p in grid().step_by(977) {
            let found = vol_compiler::reference::evaluate(function, &p, &frame.uniforms, &frame.curves)[0];
            let nearest = nearest(p, &triangles);
            // The samples are at most 0.02 apart, so the nearest is at most that much too far.
            let right = found.abs() <= nearest + 1e-3 && found.abs() >= nearest - 0.02;
            ensure(right, || format!("{shape} at {p:?}: {found}, not {nearest}"))?;
        }
    }
    Ok(())
}

/// Distance to the nearest of the points `(i a + j b + k c) / PARTS` of triangles.
fn nearest(p: [f64; 3], triangles: &[[[f64; 3]; 3]]) -> f64 {
    const PARTS: usize = 100;
    let mut least = f64::INFINITY;
    for [a, b, c] in triangles {
        for i in 0..=PARTS {
            for j in 0..=PARTS - i {
                let (u, v) = (i as f64 / PARTS as f64, j as f64 / PARTS as f64);
                let off = |axis: usize| u * a[axis] + v * b[axis] + (1.0 - u - v) * c[axis] - p[axis];
                least = least.min(off(0).powi(2) + off(1).powi(2) + off(2).powi(2));
            }
        }
    }
    least.sqrt()
}
