//! Distances of shapes at points where they are known by hand, inside, outside and degenerate.

use crate::support::{compile, ensure, frame};
use libtest_mimic::{Failed, Trial};

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
const SOLIDS: [&str; 6] = [
    "union(sphere(0.6), cylinder(0.2, 1.1), smooth: 0.3).rotate_z(35deg).translate((0.3, 0, 0))",
    "(box((0.5, 0.2, 0.9)) - sphere(0.4)).rotate_x(20deg).rotate_y(50deg)",
    "torus(0.7, 0.2).scale(1.3).translate((0, 0.4, 0))",
    "sphere(0.8).displace(p => 0.1 * sin(9 * p.x) * sin(8 * p.y) * sin(7 * p.z))",
    "box((0.5, 0.5, 0.5)).round(0.1).displace(p => 0.15 * perlin(4 * p))",
    "capsule((-0.5, -0.5, 0), (0.5, 0.7, 0.2), 0.25) & sphere(0.8)",
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
        let program = compile("shape.vol", &format!("object o {{ shape: {shape} }}"))?;
        let frame = frame(&program, 0.0, [8, 8])?;
        let scale = f64::from(frame.objects[0].safe_scale);
        let function = program.module.function(program.objects[0].distance);
        let value =
            |p: &[f64; 3]| vol_compiler::reference::evaluate(function, p, &frame.uniforms, &frame.curves)[0];
        for p in grid().step_by(7) {
            for direction in [[0.01, 0.0, 0.0], [0.0, -0.02, 0.01], [0.005, 0.005, -0.005]] {
                let q = [0, 1, 2].map(|i| p[i] + direction[i]);
                let apart = direction.iter().map(|c| c * c).sum::<f64>().sqrt();
                let change = scale * (value(&p) - value(&q)).abs();
                ensure(change <= apart * (1.0 + 1e-9), || {
                    format!("{shape}: {change} over {apart} at {p:?}")
                })?;
            }
        }
    }
    Ok(())
}
