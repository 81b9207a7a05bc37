//! Shapes made of others: how fast their distances change, and how deep they say one is.

use crate::nearest::{Distance, cuboid, ellipsoid, octahedron, ring_of_circles, turned};
use crate::solid::{Solid, along, direction, length};
use crate::support::{Random, ensure};
use libtest_mimic::{Failed, Trial};

/// Solids of finite size, off their symmetries.
pub(crate) const SOLIDS: &[&str] = &[
    "sphere(0.5)",
    "box((0.5, 0.3, 0.4))",
    "torus(0.4, 0.15)",
    "cylinder(0.4, 0.5)",
    "cone(0.5, 0.4, top: 0.2)",
    "capsule((-0.3, 0.1, 0), (0.4, -0.2, 0.3), 0.15)",
    "prism(5, 0.5, 0.3)",
    "pyramid(0.4, 0.5)",
    "ellipsoid((0.5, 0.2, 0.4))",
    "octahedron(0.5)",
    "disk(0.5, thickness: 0.1)",
    "tube(bezier((-0.4, -0.3, 0), (0, 0.4, 0.2), (0.4, -0.3, 0)), radius: 0.1)",
    "implicit(p => dot(p, p) - 0.2, bounds: 0.5)",
];

/// What is done to them, and whether every length is kept somewhere, so that the steepest slope is met.
pub(crate) const TRANSFORMS: &[(&str, bool)] = &[
    (".translate((1, -2, 0.5))", true),
    (".rotate((1, 2, 3), 77deg)", true),
    (".look_along((1, -2, 0.5))", true),
    (".scale(0.3)", true),
    (".scale(4)", true),
    (".scale((1.5, 0.4, 1))", false),
    (".translate((0.3, 0.1, 0)).mirror((1, 1, 0))", true),
    (".elongate((0.3, 0, 0.1))", true),
    (".twist(90deg)", false),
    (".twist(-400deg)", false),
    (".bend(50deg)", false),
    (".translate((0.2, 0.1, 0)).bend(-60deg)", false),
    (".repeat((1.2, 1.2, 1.2), count: (3, 2, 1))", true),
    (".repeat((0.7, 0, 0), count: (4, 1, 1), overlap: 1)", true),
    (".repeat((1.1, 0, 1.3))", true),
    (".translate((1, 0, 0)).repeat_polar(5)", true),
    (".rotate_z(20deg).repeat_polar(3, overlap: 1)", true),
    (".round(0.1)", true),
    (".shell(0.1)", true),
    (".displace(p => 0.05 * sin(6 * p.x) * cos(5 * p.z))", false),
    (".twist(70deg).scale((1, 0.5, 2)).round(0.05).rotate_x(30deg)", false),
];

/// Blends of three solids.
pub(crate) const BLENDS: &[&str] = &[
    "union(A, B, C)",
    "intersect(A, B, C)",
    "subtract(A, B)",
    "union(A, B, C, smooth: 0.3)",
    "intersect(A, B, C, smooth: 0.3)",
    "subtract(A, B, smooth: 0.3)",
    "union(A, B, C, chamfer: 0.2)",
    "intersect(A, B, C, chamfer: 0.2)",
    "subtract(A, B, chamfer: 0.2)",
    "union(A, B, C, stairs: 0.3, steps: 4)",
    "intersect(A, B, C, stairs: 0.3, steps: 3)",
    "subtract(A, B, stairs: 0.3, steps: 1)",
    "subtract(union(A, B, smooth: 0.1), C, stairs: 0.2) | (A & B).twist(40deg)",
];

const PARTS: [&str; 3] = [
    "box((0.5, 0.3, 0.4))",
    "sphere(0.4).translate((0.3, 0.2, 0.1))",
    "octahedron(0.6).translate((0, 0.1, 0.2))",
];

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("operators::transforms_are_as_steep_as_they_say", transforms_are_as_steep),
        Trial::test("operators::stretch_of_a_twist_and_a_bend", stretch_by_formula),
        Trial::test("operators::blends_are_no_steeper_than_their_parts", blends_are_no_steeper),
        Trial::test("operators::blends_have_their_sign", blends_have_their_sign),
        Trial::test("operators::copies_are_the_nearest", copies_are_the_nearest),
        Trial::test("operators::depth_is_that_of_the_nearest_wall", depth_is_right),
        Trial::test("operators::depth_is_never_more_than_there_is", depth_is_held),
    ]
}

/// The largest change of the safe distance per length over pairs of points near and far.
fn steepest(solid: &Solid, text: &str, pairs: usize) -> Result<f64, Failed> {
    let bounds = solid.frame.objects[0].bounds;
    let ends = [0, 1, 2].map(|i| {
        let (lo, hi) = (f64::from(bounds.lo[i]).max(-3.0), f64::from(bounds.hi[i]).min(3.0));
        (lo - 0.3, hi + 0.3)
    });
    let mut random = Random::new(pairs as u64);
    let mut most: f64 = 0.0;
    for _ in 0..pairs {
        let p = ends.map(|(lo, hi)| random.between(lo, hi));
        let apart = 10f64.powf(random.between(-4.0, 0.6));
        let q = along(p, direction(&mut random), apart);
        let near = solid.exact(p);
        let slope = solid.safe_scale(p, q) * (near - solid.exact(q)).abs() / apart;
        // Along the gradient, too, where the change is largest.
        let way = solid.slope(p);
        let ahead = along(p, way, 1e-5 / length(way).max(1e-3));
        let along_way = length(along(ahead, p, -1.0));
        let change = solid.safe_scale(p, ahead) * (near - solid.exact(ahead)).abs();
        let steep = if along_way > 0.0 { change / along_way } else { 0.0 };
        most = most.max(slope).max(steep);
        ensure(slope <= 1.0 + 1e-6 && steep <= 1.0 + 1e-5, || {
            format!("{text} at {p:?}: {slope} over {apart}, {steep} along the gradient")
        })?;
    }
    Ok(most)
}

fn transforms_are_as_steep() -> Result<(), Failed> {
    let (mut done, mut most) = (0, vec![0.0f64; TRANSFORMS.len()]);
    for solid in SOLIDS {
        for (&(transform, tight), most) in TRANSFORMS.iter().zip(&mut most) {
            let text = format!("{solid}{transform}");
            // Some are too long for a copy or a bend, and say so.
            let Ok(solid) = Solid::new(&text) else { continue };
            done += 1;
            let found = steepest(&solid, &text, 60)?;
            let field = text.starts_with("implicit");
            ensure(!tight || field || found > 0.999, || format!("{text}: never steeper than {found}"))?;
            *most = most.max(found);
        }
    }
    ensure(done > 230, || format!("{done} shapes"))?;
    // What has a factor of its own comes near it for some solid.
    for (&(transform, _), &most) in TRANSFORMS.iter().zip(&most) {
        ensure(most > 0.4, || format!("{transform}: never steeper than {most}"))?;
    }
    Ok(())
}

/// The factors by which twisted and bent distances are divided are those of `algorithms.md` §7.2, at the
/// rim of the box.
fn stretch_by_formula() -> Result<(), Failed> {
    for rate in [-3.0f64, 0.01, 0.5, 2.0, 7.0] {
        let twisted = Solid::new(&format!("box((0.3, 2, 0.4)).twist({rate}rad)"))?;
        let turn = rate.abs() * 0.5;
        let expected = 2.0 / (turn + turn.hypot(2.0));
        let found = twisted.safe_scale([0.0; 3], [0.0; 3]);
        ensure((found / expected - 1.0).abs() < 1.1e-3, || format!("twist {rate}: {found}, not {expected}"))?;
    }
    for rate in [-1.5f64, 0.2, 1.0] {
        let bent = Solid::new(&format!("box((1.2, 0.4, 0.3)).bend({rate}rad)"))?;
        let expected = 0.5 * (1.0 - rate.abs() * 0.4);
        let found = bent.safe_scale([0.0; 3], [0.0; 3]);
        ensure((found / expected - 1.0).abs() < 1.1e-3, || format!("bend {rate}: {found}, not {expected}"))?;
    }
    Ok(())
}

pub(crate) fn of_parts(text: &str) -> String {
    let [a, b, c] = PARTS;
    text.replace('A', a).replace('B', b).replace('C', c)
}

fn blends_are_no_steeper() -> Result<(), Failed> {
    for blend in BLENDS {
        let text = of_parts(blend);
        let found = steepest(&Solid::new(&text)?, &text, 1500)?;
        ensure(found > 0.7, || format!("{text}: never steeper than {found}"))?;
    }
    Ok(())
}

/// Nearest points of [`PARTS`].
fn parts() -> [Distance; 3] {
    let (cuboid, octahedron) = (cuboid([0.5, 0.3, 0.4]), octahedron(0.6));
    let sphere = ring_of_circles(0.0, 0.4);
    [
        cuboid,
        Box::new(move |p| sphere(along(p, [0.3, 0.2, 0.1], -1.0))),
        Box::new(move |p| octahedron(along(p, [0.0, 0.1, 0.2], -1.0))),
    ]
}

fn places(count: usize) -> Vec<[f64; 3]> {
    let mut random = Random::new(41);
    (0..count).map(|_| [(); 3].map(|()| random.between(-1.1, 1.1))).collect()
}

/// A blend contains what the sharp union does and no more than its reach beyond; an intersection or
/// difference the other way round; and away from the edge by the width they are equal.
fn blends_have_their_sign() -> Result<(), Failed> {
    let [a, b, _] = parts();
    // How they blend, over which width, and what share of it the surface moves at most.
    let blends = [
        ("smooth: 0", 0.0, 0.5),
        ("smooth: 0.3", 0.3, 0.25),
        ("chamfer: 0.2", 0.2, 0.5),
        ("stairs: 0.3", 0.3, 0.5),
    ];
    for (how, width, share) in blends {
        let mut largest: f64 = 0.0;
        let solid = |text: &str| Solid::new(&of_parts(&format!("{text}(A, B, {how})")));
        let (union, common, rest) = (solid("union")?, solid("intersect")?, solid("subtract")?);
        for p in places(3000) {
            let (a, b) = (a(p), b(p));
            let sharp = [a.min(b), a.max(b), a.max(-b)];
            let far = [(a - b).abs() >= width, (a - b).abs() >= width, (a + b).abs() >= width];
            let found = [union.exact(p), common.exact(p), rest.exact(p)];
            for i in 0..3 {
                let more = if i == 0 { sharp[0] - found[0] } else { found[i] - sharp[i] };
                let right =
                    if far[i] { more.abs() < 1e-9 } else { more >= -1e-9 && more <= share * width + 1e-9 };
                largest = largest.max(more);
                ensure(right, || format!("{how} at {p:?}: {found:?} of {sharp:?}"))?;
            }
        }
        ensure(largest >= 0.95 * share * width, || format!("{how} moves by {largest} at most"))?;
    }
    Ok(())
}

/// Copies that keep to their cells are at the distance of the nearest of all, outside.
fn copies_are_the_nearest() -> Result<(), Failed> {
    let octahedron = octahedron(0.3);
    let rows =
        Solid::new("octahedron(0.3).translate((0.19, 0, -0.1)).repeat((1, 1.2, 0.8), count: (3, 2, 3))")?;
    let around = Solid::new("octahedron(0.3).translate((0.9, 0, 0.1)).repeat_polar(5)")?;
    for p in places(4000).into_iter().map(|p| p.map(|c| 2.0 * c)) {
        let (mut in_rows, mut in_turns) = (f64::INFINITY, f64::INFINITY);
        for i in 0..18 {
            let cell = [i % 3, i / 3 % 2, i / 6].map(f64::from);
            let centre = [cell[0] - 0.81, 1.2 * cell[1] - 0.6, 0.8 * cell[2] - 0.9];
            in_rows = in_rows.min(octahedron(along(p, centre, -1.0)));
        }
        for i in 0..5 {
            let (sine, cosine) = (std::f64::consts::TAU * f64::from(i) / 5.0).sin_cos();
            let turned = [cosine * p[0] - sine * p[2], p[1], sine * p[0] + cosine * p[2]];
            in_turns = in_turns.min(octahedron(along(turned, [0.9, 0.0, 0.1], -1.0)));
        }
        for (found, right) in [(rows.exact(p), in_rows), (around.exact(p), in_turns)] {
            let held = if right > 0.0 {
                (found - right).abs() < 1e-9
            } else {
                found >= right - 1e-9 && found <= 1e-9
            };
            ensure(held, || format!("at {p:?}: {found}, not {right}"))?;
        }
    }
    Ok(())
}

/// Inside a sharp intersection or difference of exact parts, and outside their union, the distance is
/// that to the nearest wall.
fn depth_is_right() -> Result<(), Failed> {
    let [a, b, c] = parts();
    let solid = |text: &str| Solid::new(&of_parts(text));
    let (union, common, rest) = (solid("A | B | C")?, solid("A & B & C")?, solid("A - B - C")?);
    let (mut inside, mut without) = (0, 0);
    for p in places(20_000) {
        let (a, b, c) = (a(p), b(p), c(p));
        let cases = [
            (union.exact(p), a.min(b).min(c), a.min(b).min(c) > 0.0),
            (common.exact(p), a.max(b).max(c), a.max(b).max(c) < 0.0),
            (rest.exact(p), a.max(-b).max(-c), a.max(-b).max(-c) < 0.0),
        ];
        inside += usize::from(cases[1].2);
        without += usize::from(cases[2].2);
        for (found, right, asked) in cases {
            ensure(!asked || (found - right).abs() < 1e-9, || format!("at {p:?}: {found}, not {right}"))?;
        }
    }
    ensure(inside > 100 && without > 100, || format!("{inside} and {without} places inside"))
}

/// A step as long as the depth, in any direction, ends inside; one as long as the distance, outside.
fn depth_is_held() -> Result<(), Failed> {
    let mut random = Random::new(43);
    for blend in BLENDS {
        let text = of_parts(blend);
        let solid = Solid::new(&text)?;
        let scale = solid.safe_scale([0.0; 3], [0.0; 3]);
        let mut inside = 0;
        for p in places(600) {
            let distance = scale * solid.exact(p);
            inside += usize::from(distance < 0.0);
            for _ in 0..4 {
                let q = along(p, direction(&mut random), 0.999 * distance.abs());
                let there = solid.exact(q);
                ensure(there * distance >= 0.0, || format!("{text}: {distance} at {p:?}, {there} at {q:?}"))?;
            }
        }
        ensure(inside > 0, || format!("{text}: no place inside"))?;
    }
    // The distances of single solids without a formula in common.
    let solids: [(&str, Distance); 2] = [
        ("ellipsoid((0.9, 0.3, 0.6)).shell(0.1)", ellipsoid([0.9, 0.3, 0.6])),
        ("cylinder(0.5, 0.4).shell(0.1)", turned(vec![[0.0, -0.4], [0.5, -0.4], [0.5, 0.4], [0.0, 0.4]])),
    ];
    for (text, nearest) in solids {
        let solid = Solid::new(text)?;
        for p in places(3000) {
            let (found, right) = (solid.exact(p), nearest(p).abs() - 0.05);
            ensure(found <= right + 1e-9, || format!("{text} at {p:?}: {found}, not {right}"))?;
        }
    }
    Ok(())
}
