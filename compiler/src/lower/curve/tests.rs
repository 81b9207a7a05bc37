//! Curves of scenes sampled against their definitions, in f64.

use crate::curve::Quadratic;
use crate::program::Program;
use glam::DVec3;
use std::f64::consts::TAU;
use vol_language::diag::Diagnostic;
use vol_language::source::SourceFile;

fn compiled(curve: &str) -> (Option<Program>, Vec<Diagnostic>) {
    let text = format!("medium m {{ region: tube({curve}, radius: 0.1) }}");
    let file = SourceFile::new("curve.vol", text.as_str());
    let (scene, diagnostics) = vol_language::analyse(&file, &crate::library::library());
    let scene = scene.unwrap_or_else(|| panic!("{curve}: {diagnostics:?}"));
    crate::lower::compile(&scene)
}

/// Pieces of the curve that an expression makes, at a time.
fn pieces_at(curve: &str, time: f64) -> Vec<Quadratic> {
    let (program, diagnostics) = compiled(curve);
    let program = program.unwrap_or_else(|| panic!("{curve}: {diagnostics:?}"));
    let frame = program.frame(&[], time, 0.0, [4, 4]).expect("a frame");
    assert!(frame.curves[0].iter().flat_map(|s| [s.a, s.b, s.c]).flatten().all(f64::is_finite), "{curve}");
    frame.curves[0].clone()
}

fn pieces(curve: &str) -> Vec<Quadratic> {
    pieces_at(curve, 0.0)
}

fn codes(curve: &str) -> Vec<&'static str> {
    compiled(curve).1.iter().map(|diagnostic| diagnostic.code).collect()
}

fn point(pieces: &[Quadratic], t: f64) -> DVec3 {
    let place = t * pieces.len() as f64;
    let index = (place as usize).min(pieces.len() - 1);
    let u = place - index as f64;
    let [a, b, c] = [pieces[index].a, pieces[index].b, pieces[index].c].map(DVec3::from);
    a.lerp(b, u).lerp(b.lerp(c, u), u)
}

/// Largest distance at equal parameter.
fn deviation(pieces: &[Quadratic], truth: impl Fn(f64) -> DVec3) -> f64 {
    let at = |i: i32| f64::from(i) / 4000.0;
    (0..=4000).map(|i| point(pieces, at(i)).distance(truth(at(i)))).fold(0.0, f64::max)
}

/// Largest angle between tangents where pieces meet, and largest gap; degenerate pieces left out.
fn jumps(pieces: &[Quadratic], closed: bool) -> (f64, f64) {
    let next = pieces.iter().skip(1).chain(closed.then(|| &pieces[0]));
    let mut worst = (0.0, 0.0);
    for (before, after) in pieces.iter().zip(next) {
        let leave = DVec3::from(before.c) - DVec3::from(before.b);
        let enter = DVec3::from(after.b) - DVec3::from(after.a);
        if leave.length() > 1e-6 && enter.length() > 1e-6 {
            worst.0 = f64::max(worst.0, leave.angle_between(enter));
        }
        worst.1 = f64::max(worst.1, DVec3::from(before.c).distance(after.a.into()));
    }
    worst
}

fn cubic([a, b, c, d]: [DVec3; 4], t: f64) -> DVec3 {
    let (ab, bc, cd) = (a.lerp(b, t), b.lerp(c, t), c.lerp(d, t));
    ab.lerp(bc, t).lerp(bc.lerp(cd, t), t)
}

fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    // Few digits, so that the text says exactly the same.
    (((*seed >> 40) as f64 / f64::from(1 << 24) - 0.5) * 4000.0).round() / 1000.0
}

fn random_points(count: usize, seed: &mut u64) -> Vec<DVec3> {
    (0..count).map(|_| DVec3::from_array([(); 3].map(|()| random(seed)))).collect()
}

fn listed(points: &[DVec3]) -> String {
    points.iter().map(|p| format!("({}, {}, {})", p.x, p.y, p.z)).collect::<Vec<_>>().join(", ")
}

#[test]
fn cubics_stay_near() {
    let mut seed = 1;
    let mut worst = (0f64, 0f64);
    for _ in 0..60 {
        let control: [DVec3; 4] = random_points(4, &mut seed).try_into().expect("four");
        let legs: f64 = control.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        for (index, moving) in ["", " + (0, 0, 0 * time)"].into_iter().enumerate() {
            let points: Vec<String> = control.iter().map(|&p| format!("{}{moving}", listed(&[p]))).collect();
            let found = pieces(&format!("bezier({})", points.join(", ")));
            let off = deviation(&found, |t| cubic(control, t)) / legs;
            worst = if index == 0 { (worst.0.max(off), worst.1) } else { (worst.0, worst.1.max(off)) };
            let (angle, gap) = jumps(&found, false);
            assert!(angle < 1e-7 && gap < 1e-12, "{angle} {gap}");
        }
    }
    assert!(worst.0 < 5.9e-4 && worst.1 < 5.9e-4, "{worst:?}");
    assert!(worst.0 > 1e-4, "{worst:?}");
}

#[test]
fn straight_cubics_are_two_pieces() {
    let found = pieces("bezier((0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0))");
    assert_eq!(found.len(), 2);
    assert!(deviation(&found, |t| DVec3::new(3.0 * t, 0.0, 0.0)) < 1e-12);
    assert_eq!(pieces("bezier((1, 2, 3), (1, 2, 3), (1, 2, 3), (1, 2, 3))").len(), 2);
}

/// Barry and Goldman 1988: Catmull-Rom as nested interpolation between knots.
fn barry_goldman(points: [DVec3; 4], u: f64) -> DVec3 {
    let mut knots = [0.0; 4];
    for i in 0..3 {
        knots[i + 1] = knots[i] + points[i].distance(points[i + 1]).sqrt();
    }
    let t = knots[1] + u * (knots[2] - knots[1]);
    let blend = |a: DVec3, b: DVec3, from: f64, to: f64| a.lerp(b, (t - from) / (to - from));
    let first: [DVec3; 3] = std::array::from_fn(|i| blend(points[i], points[i + 1], knots[i], knots[i + 1]));
    let second: [DVec3; 2] = std::array::from_fn(|i| blend(first[i], first[i + 1], knots[i], knots[i + 2]));
    blend(second[0], second[1], knots[1], knots[2])
}

#[test]
fn catmull_rom_is_centripetal() {
    let mut seed = 2;
    for (count, closed) in [(2, false), (3, false), (7, false), (3, true), (8, true)] {
        let points = random_points(count, &mut seed);
        let found = pieces(&format!("catmull_rom([{}], closed: {closed})", listed(&points)));
        let spans = if closed { count } else { count - 1 };
        let at = |i: i64| -> DVec3 {
            let n = count as i64;
            match i {
                _ if closed => points[i.rem_euclid(n) as usize],
                -1 => 2.0 * points[0] - points[1],
                _ if i == n => 2.0 * points[count - 1] - points[count - 2],
                _ => points[i as usize],
            }
        };
        let truth = |t: f64| {
            let place = t * spans as f64;
            let span = (place as usize).min(spans - 1) as i64;
            barry_goldman([-1, 0, 1, 2].map(|k| at(span + k)), place - span as f64)
        };
        let size: f64 = (0..spans as i64).map(|i| at(i).distance(at(i + 1))).sum();
        let off = deviation(&found, truth) / size;
        assert!(off < 6e-4, "{count} {closed}: {off}");
        let (angle, gap) = jumps(&found, closed);
        assert!(angle < 1e-6 && gap < 1e-12, "{count} {closed}: {angle} {gap}");
    }
}

#[test]
fn coincident_points_are_passed() {
    for closed in [false, true] {
        let found =
            pieces(&format!("catmull_rom([(0, 0, 0), (1, 0, 0), (1, 0, 0), (1, 1, 0)], closed: {closed})"));
        let passes = |p: [f64; 3]| found.iter().any(|s| DVec3::from(s.a).distance(p.into()) < 1e-9);
        assert!(passes([0.0; 3]) && passes([1.0, 0.0, 0.0]));
        pieces(&format!("bspline([(0, 0, 0), (0, 0, 0), (0, 0, 0)], closed: {closed})"));
        pieces(&format!("catmull_rom([(0, 0, 0), (0, 0, 0), (0, 0, 0)], closed: {closed})"));
    }
}

/// Uniform quadratic B-spline by its basis, knots doubled at the ends of an open one.
fn de_boor(points: &[DVec3], knots: &[f64], x: f64) -> DVec3 {
    let last = points.len() - 1;
    let k = (2..=last).rev().find(|&k| knots[k] <= x).unwrap_or(2);
    let mut d: Vec<DVec3> = (0..3).map(|j| points[j + k - 2]).collect();
    for r in 1..=2 {
        for j in (r..=2).rev() {
            let (lo, hi) = (knots[j + k - 2], knots[j + 1 + k - r]);
            d[j] = d[j - 1].lerp(d[j], (x - lo) / (hi - lo));
        }
    }
    d[2]
}

#[test]
fn b_splines_are_exact() {
    let mut seed = 3;
    for count in [3usize, 4, 9] {
        let points = random_points(count, &mut seed);
        let open = pieces(&format!("bspline([{}])", listed(&points)));
        assert_eq!(open.len(), count - 2);
        let spans = (count - 2) as f64;
        let knots: Vec<f64> = (0..count + 3).map(|i| (i as f64 - 2.0).clamp(0.0, spans)).collect();
        let off = deviation(&open, |t| de_boor(&points, &knots, t * spans));
        assert!(off < 1e-12, "{count}: {off}");
        let closed = pieces(&format!("bspline([{}], closed: true)", listed(&points)));
        let around: Vec<DVec3> = points.iter().chain(&points[..2]).copied().collect();
        let knots: Vec<f64> = (0..around.len() + 3).map(|i| i as f64 - 2.0).collect();
        let off = deviation(&closed, |t| de_boor(&around, &knots, t * count as f64));
        assert!(off < 1e-12, "{count} closed: {off}");
        assert!(jumps(&closed, true).0 < 1e-7);
    }
}

#[test]
fn circles_and_helices_are_round() {
    let circle = pieces("circle(2)");
    let radial = |pieces: &[Quadratic], radius: f64| {
        let off = |i: i32| {
            let p = point(pieces, f64::from(i) / 4000.0);
            (p.x.hypot(p.z) / radius - 1.0).abs()
        };
        (0..=4000).map(off).fold(0.0, f64::max)
    };
    let (angle, gap) = jumps(&circle, true);
    assert!(radial(&circle, 2.0) < 1.9e-4 && angle < 1e-7 && gap == 0.0, "{} {gap}", radial(&circle, 2.0));
    assert_eq!(point(&circle, 0.0), DVec3::new(2.0, 0.0, 0.0));
    // Counter-clockwise seen from above: from x towards -z.
    assert!(point(&circle, 0.25).distance(DVec3::new(0.0, 0.0, -2.0)) < 1e-12);
    for turns in [2.5, -1.0, 0.01, 0.0] {
        let helix = pieces(&format!("helix(0.5, 3, {turns})"));
        let truth = |t: f64| {
            let angle = TAU * turns * t;
            DVec3::new(0.5 * angle.cos(), 3.0 * t, -0.5 * angle.sin())
        };
        let off = deviation(&helix, truth);
        assert!(off < 2.6e-4 * 2.0 * 0.5 && jumps(&helix, false).0 < 1e-7, "{turns}: {off}");
        assert!(radial(&helix, 0.5) < 1.9e-4);
    }
}

#[test]
fn curves_move() {
    let found = pieces_at("helix(1 + time, 2 * time, 1)", 2.0);
    assert!(point(&found, 1.0).distance(DVec3::new(3.0, 4.0, 0.0)) < 1e-12);
    let found = pieces_at("catmull_rom([(0, 0, 0), (0, time, 0), (0, 1, time)])", 0.5);
    assert!(point(&found, 0.5).distance(DVec3::new(0.0, 0.5, 0.0)) < 1e-12);
}

#[test]
fn far_from_the_origin() {
    let found = pieces("catmull_rom([(100000, 0, 0), (100001, 1, 0), (100002, 0, 0)])");
    assert!(point(&found, 0.5).distance(DVec3::new(100_001.0, 1.0, 0.0)) < 1e-9);
    assert!(jumps(&found, false).0 < 1e-4);
}

#[test]
fn paths_report_jumps() {
    let line = "line((0, 0, 0), (1, 0, 0))";
    assert!(codes(&format!("path([{line}, line((1, 0, 0), (2, 0, 0))])")).is_empty());
    assert!(codes(&format!("path([{line}])")).is_empty());
    assert_eq!(codes(&format!("path([{line}, line((1, 0, 0), (2, 0.1, 0))])")), ["W0201"]);
    assert_eq!(codes(&format!("path([{line}, line((1, 0.1, 0), (2, 0.1, 0))])")), ["W0201"]);
    assert!(codes(&format!("path([{line}, line((1, 0, 0), (2, time, 0))])")).is_empty());
    // A control point on the joint says nothing; the chord does.
    assert!(codes(&format!("path([{line}, bezier((1, 0, 0), (1, 0, 0), (2, 0, 0))])")).is_empty());
}

#[test]
fn lists_too_short_or_too_long() {
    for short in
        ["catmull_rom([(0, 0, 0)])", "bspline([(0, 0, 0), (1, 0, 0)], closed: true)", "bspline([(0, 0, 0)])"]
    {
        assert_eq!(codes(short), ["E0407"], "{short}");
    }
    assert_eq!(codes("helix(1, 1, 1e30)"), ["E0401"]);
    assert_eq!(codes("helix(1, 1, time)"), ["E0405"]);
    let many = "catmull_rom([for i in 0..3000: (0.1 * i, sin(0.3 * i), 0)])";
    let started = std::time::Instant::now();
    assert!(pieces(many).len() >= 2999 * 2);
    assert!(started.elapsed().as_secs() < 20, "{:?}", started.elapsed());
}

#[test]
fn parts_of_a_path_share_t_evenly() {
    let text = "medium m { region: tube(path([line((0, 0, 0), (1, 0, 0)), \
                bezier((1, 0, 0), (2, 0, 0), (3, 1, 0), (3, 2, 0))]), radius: 0.1), density: q => q.t }";
    let file = SourceFile::new("path.vol", text);
    let (scene, _) = vol_language::analyse(&file, &crate::library::library());
    let (program, _) = crate::lower::compile(&scene.expect("a scene"));
    let program = program.expect("a program");
    let frame = program.frame(&[], 0.0, 0.0, [4, 4]).expect("a frame");
    let density = program.fields.iter().find(|field| field.name == "density:m").expect("a density");
    let t = |p: [f64; 3]| {
        let function = program.module.function(density.function);
        crate::reference::evaluate(function, &p, &frame.uniforms, &frame.curves)[0]
    };
    assert!((t([0.5, 0.0, 0.0]) - 0.25).abs() < 1e-9);
    assert!((t([1.0, 0.0, 0.0]) - 0.5).abs() < 1e-9);
    assert!((t([3.0, 2.0, 0.0]) - 1.0).abs() < 1e-9);
    assert!((t([2.5, 0.625, 0.0]) - 0.75).abs() < 0.02);
}
