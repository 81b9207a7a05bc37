//! The f32 kernel against `vol_compiler::reference::curve` in f64.

mod long;

use super::*;
use vol_compiler::curve::{Quadratic, prepare};
use vol_compiler::reference::curve as reference;

const CATEGORIES: [&str; 10] = [
    "random",
    "straight",
    "nearly straight",
    "collinear",
    "collinear with cusp",
    "repeated points",
    "far point",
    "near the curve",
    "centre of curvature",
    "offset by 1000",
];

/// Xorshift numbers.
struct Dice(u64);

impl Dice {
    /// In [-1, 1).
    fn roll(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f64 / 8_388_608.0 - 1.0
    }

    fn unit(&mut self) -> f64 {
        0.5 * (self.roll() + 1.0)
    }

    fn vector(&mut self, reach: f64) -> [f64; 3] {
        [(); 3].map(|()| self.roll() * reach)
    }
}

fn along(a: [f64; 3], s: f64, d: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] + s * d[i])
}

fn dot64(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn norm(a: [f64; 3]) -> f64 {
    dot64(a, a).sqrt()
}

/// A curve and a point of one of the ten categories of `algorithms.md` §1.2.
fn case(dice: &mut Dice, category: usize) -> (Quadratic, [f32; 3]) {
    let (a, c, p) = (dice.vector(1.0), dice.vector(1.0), dice.vector(2.0));
    let far = 10f64.powf(4.0 * dice.unit());
    let chord = along(c, -1.0, a);
    let free = dice.vector(1.0);
    let place = |b: [f64; 3], t: f64| {
        std::array::from_fn(|i| (1.0 - t) * (1.0 - t) * a[i] + 2.0 * t * (1.0 - t) * b[i] + t * t * c[i])
    };
    let (b, c, p) = match category {
        1 => (along(a, 0.5, chord), c, p),
        2 => (along(along(a, 0.5, chord), 10f64.powf(-1.0 - 6.0 * dice.unit()), free), c, p),
        3 => (along(a, dice.unit(), chord), c, p),
        4 => (along(a, 3.0 * dice.roll(), chord), c, p),
        5 => match (dice.unit() * 4.0) as u32 {
            0 => (a, c, p),
            1 => (c, c, p),
            2 => (free, a, p),
            _ => (a, a, p),
        },
        6 => (free, c, p.map(|x| x * far)),
        7 => (free, c, along(place(free, dice.unit()), 10f64.powf(-5.0 * dice.unit()), dice.vector(1.0))),
        8 => {
            let t = dice.unit();
            let (b1, b2) = (along(free, -1.0, a), along(along(c, -1.0, free), -1.0, along(free, -1.0, a)));
            let (v, acc) = (along(b1, t, b2).map(|x| 2.0 * x), b2.map(|x| 2.0 * x));
            let across = along(acc, -dot64(v, acc) / dot64(v, v), v);
            let centre = along(place(free, t), dot64(v, v) / dot64(across, across), across);
            (free, c, along(centre, 10f64.powf(-6.0 * dice.unit()), dice.vector(1.0)))
        }
        _ => (free, c, p),
    };
    let shift = if category == 9 { dice.vector(1000.0) } else { [0.0; 3] };
    let moved = |q: [f64; 3]| along(q, 1.0, shift);
    (Quadratic { a: moved(a), b: moved(b), c: moved(c) }, moved(p).map(|x| x as f32))
}

/// Largest errors over the scale: distance; where the foot is clear also arc length, movement of the
/// foot, frame, overshoot.
#[derive(Default, Debug)]
struct Worst {
    distance: f64,
    arc: f64,
    slide: f64,
    frame: f64,
    overshoot: f64,
    stretch: f64,
}

/// Point of the curve at a parameter over all of it.
fn point_at(segments: &[Quadratic], t: f64) -> [f64; 3] {
    let place = t * segments.len() as f64;
    let segment = segments[(place as usize).min(segments.len() - 1)];
    let u = place - place.floor().min(segments.len() as f64 - 1.0);
    let w = 1.0 - u;
    std::array::from_fn(|i| w * w * segment.a[i] + 2.0 * u * w * segment.b[i] + u * u * segment.c[i])
}

fn compare(p: [f32; 3], segments: &[Quadratic], worst: &mut Worst) {
    let found = closest(p, &prepare(segments).pieces, &[]);
    let Some(truth) = reference::closest(p.map(f64::from), segments) else { unreachable!("not empty") };
    let all = [found.t, found.arc_length, found.x, found.y, found.distance, found.overshoot, found.stretch];
    assert!(all.iter().all(|x| x.is_finite()), "{segments:?} {p:?} {found:?}");
    let points = || segments.iter().flat_map(|s| [s.a, s.b, s.c]);
    let span = points().map(|q| norm(along(q, -1.0, segments[0].a))).fold(0.0, f64::max);
    let from_start = norm(along(p.map(f64::from), -1.0, segments[0].a));
    let scale = span.max(from_start).max(1e-30);
    let error = |a: f32, b: f64, sink: &mut f64| *sink = sink.max((f64::from(a) - b).abs() / scale);
    error(found.distance, truth.distance, &mut worst.distance);
    let length = (f64::from(found.curve_length) - truth.curve_length).abs() / truth.curve_length.max(scale);
    worst.arc = worst.arc.max(length);
    if truth.gap < 1e-4 * scale || truth.stretch < 0.05 {
        return;
    }
    error(found.arc_length, truth.arc_length, &mut worst.arc);
    let slide = norm(along(point_at(segments, f64::from(found.t)), -1.0, point_at(segments, truth.t)));
    worst.slide = worst.slide.max(slide / scale);
    error(found.overshoot, truth.overshoot, &mut worst.overshoot);
    error(found.x, truth.x, &mut worst.frame);
    error(found.y, truth.y, &mut worst.frame);
    // Seen from far away the same error of the foot is a longer slide along a short curve.
    let stretch = (f64::from(found.stretch) - truth.stretch).abs() / (1.0 + truth.stretch);
    worst.stretch = worst.stretch.max(stretch * span / scale);
}

/// Bounds on [`Worst`], in the order of its fields; the distance as asked for, the others twice what was measured or less.
fn assert_within(worst: &Worst, name: &str) {
    assert!(worst.distance <= 2e-7, "{name}: {worst:?}");
    assert!(worst.arc <= 1e-6 && worst.frame <= 1e-6, "{name}: {worst:?}");
    assert!(worst.slide <= 1e-6, "{name}: {worst:?}");
    assert!(worst.overshoot <= 4e-7 && worst.stretch <= 6e-6, "{name}: {worst:?}");
}

/// `VOL_CURVES=100000` makes it 1e6 curves.
#[test]
fn agrees_with_f64() {
    let wanted = std::env::var("VOL_CURVES").ok().and_then(|count| count.parse().ok());
    for (category, name) in CATEGORIES.iter().enumerate() {
        let mut dice = Dice(0x9E37_79B9_7F4A_7C15 ^ ((category as u64) << 32));
        let mut worst = Worst::default();
        for _ in 0..wanted.unwrap_or(2200) {
            let (segment, p) = case(&mut dice, category);
            compare(p, &[segment], &mut worst);
        }
        println!("{name}: {worst:?}");
        assert_within(&worst, name);
    }
}

#[test]
fn many_segments_agree_with_f64() {
    // Uniform B-splines (no corner) and free segments end to end (corners), some with a doubled point.
    let mut dice = Dice(3);
    for smooth in [true, false] {
        let mut worst = Worst::default();
        for i in 0..1500 {
            let mut points: Vec<[f64; 3]> = (0..9).map(|_| dice.vector(1.0)).collect();
            if i % 3 == 0 {
                points[4] = points[3];
            }
            let middle = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
            let segments: Vec<Quadratic> = if smooth {
                let of = |w: &[[f64; 3]]| Quadratic { a: middle(w[0], w[1]), b: w[1], c: middle(w[1], w[2]) };
                points.windows(3).map(of).collect()
            } else {
                points.windows(3).step_by(2).map(|w| Quadratic { a: w[0], b: w[1], c: w[2] }).collect()
            };
            compare(dice.vector(1.5).map(|x| x as f32), &segments, &mut worst);
        }
        assert_within(&worst, if smooth { "smooth" } else { "corners" });
    }
}

#[test]
fn every_size_agrees_with_f64() {
    for exponent in -6..=6 {
        let size = 10f64.powi(exponent);
        let (mut dice, mut worst) = (Dice(11), Worst::default());
        for i in 0..300 {
            let (segment, p) = case(&mut dice, i % 6);
            let sized = |q: [f64; 3]| q.map(|x| x * size);
            let segment = Quadratic { a: sized(segment.a), b: sized(segment.b), c: sized(segment.c) };
            compare(p.map(|x| (f64::from(x) * size) as f32), &[segment], &mut worst);
        }
        assert_within(&worst, &format!("size {size}"));
    }
}

#[test]
fn slopes_agree_with_f64() {
    let mut counted = 0;
    for (category, name) in CATEGORIES.iter().enumerate() {
        let mut dice = Dice(17 + category as u64);
        let mut worst = (0f64, 0f64, 0f64);
        for _ in 0..1000 {
            let (segment, p) = case(&mut dice, category);
            let found = closest_gradient(p, &prepare(&[segment]).pieces, &[]);
            let all = [found.direction, found.tangent].concat();
            assert!(
                all.iter().chain([&found.rate, &found.slide]).all(|x| x.is_finite()),
                "{segment:?} {found:?}"
            );
            let (wide, segments) = (p.map(f64::from), [segment]);
            let (Some(at), Some(truth)) =
                (reference::closest(wide, &segments), reference::slopes(wide, &segments))
            else {
                unreachable!("not empty")
            };
            let span = norm(along(segment.b, -1.0, segment.a)) + norm(along(segment.c, -1.0, segment.b));
            let scale = span.max(at.distance);
            // Away from jumps, cusps and the places where a held foot lets go.
            let lean = dot64(truth.direction, truth.tangent).abs();
            let clear = at.gap > 1e-3 * scale && at.stretch > 0.05 && !(1e-5..0.1).contains(&lean);
            let steady = truth.rate * span < 10.0 && at.distance > 1e-3 * scale;
            if !(clear && steady) {
                continue;
            }
            counted += 1;
            let off = |a: [f32; 3], b: [f64; 3]| norm(along(a.map(f64::from), -1.0, b));
            let per_distance = scale / at.distance;
            worst.0 = worst.0.max(off(found.direction, truth.direction) / per_distance);
            worst.1 = worst.1.max(off(found.tangent, truth.tangent));
            let slide = (f64::from(found.slide) - truth.slide).abs() / (1.0 + truth.slide * truth.slide);
            worst.2 = worst.2.max(slide / per_distance.max(scale / span));
            let rate = (f64::from(found.rate) - truth.rate).abs();
            assert!(rate <= 1e-4 * truth.rate, "{name} {segment:?} {p:?}: {found:?} {truth:?}");
        }
        assert!(worst.0 < 4e-6 && worst.1 < 1e-4 && worst.2 < 1e-4, "{name}: {worst:?}");
    }
    assert!(counted > 3000, "{counted}");
}

#[test]
fn slopes_of_nothing_and_points() {
    let at = |q: [f64; 3]| Quadratic { a: q, b: q, c: q };
    let point = closest_gradient([1.0, 2.0, 2.0], &prepare(&[at([1.0, 0.0, 2.0])]).pieces, &[]);
    assert_eq!((point.direction, point.rate, point.slide), ([0.0, 1.0, 0.0], 0.0, 0.0));
    assert_eq!(closest_gradient([0.0; 3], &[], &[]), STILL);
    let line = prepare(&[Quadratic { a: [0.0; 3], b: [1.0, 0.0, 0.0], c: [2.0, 0.0, 0.0] }]).pieces;
    let on = closest_gradient([1.0, 0.0, 0.0], &line, &[]);
    assert_eq!((on.direction, on.tangent, on.rate, on.slide), ([0.0; 3], [1.0, 0.0, 0.0], 0.5, 1.0));
    assert_eq!(closest_gradient([3.0, 1.0, 0.0], &line, &[]).slide, 0.0);
}

#[test]
fn arc_length_at_a_foot() {
    // At given parameters, so that the foot cannot slide: the length alone.
    let mut dice = Dice(5);
    for i in 0..6000 {
        let (segment, _) = case(&mut dice, i % 6);
        for piece in prepare(&[segment]).pieces {
            let half_speed = |t: f64| {
                let v = along(piece.b1.map(f64::from), t, piece.b2.map(f64::from));
                norm(v)
            };
            let t = dice.unit() as f32;
            // Simpson with steps crowding at the start, where a sharp bend is.
            let (n, mut truth) = (1500, 0.0);
            let place = |k: f64| f64::from(t) * (k / f64::from(n)).powi(3);
            for k in 0..n {
                let (a, b) = (place(f64::from(k)), place(f64::from(k) + 1.0));
                truth += (b - a) / 3.0 * (half_speed(a) + 4.0 * half_speed(0.5 * (a + b)) + half_speed(b));
            }
            let error = (f64::from(length_to(&piece, t)) - truth).abs();
            assert!(error <= 1e-6 * truth + 1e-30, "{segment:?} {t}: {error} of {truth}");
        }
    }
}

#[test]
fn frame_runs_without_jumps() {
    // Points at a fixed distance beside a smooth curve keep continuous coordinates.
    let mut dice = Dice(21);
    let points: Vec<[f64; 3]> = (0..6).map(|_| dice.vector(1.0)).collect();
    let middle = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
    let of = |w: &[[f64; 3]]| Quadratic { a: middle(w[0], w[1]), b: w[1], c: middle(w[1], w[2]) };
    let table = prepare(&points.windows(3).map(of).collect::<Vec<_>>());
    let pairs = table.pieces.windows(2);
    for (one, two) in pairs.map(|w| (&w[0], &w[1])) {
        let t_of = |piece: &Piece, last: bool| if (piece.sense > 0.0) == last { 1.0 } else { 0.0 };
        let p = [one.origin[0] + 0.01, one.origin[1] - 0.02, one.origin[2] + 0.03];
        let (a, b) = (describe(p, one, t_of(one, true)), describe(p, two, t_of(two, false)));
        assert!((a.x - b.x).abs() < 2e-6 && (a.y - b.y).abs() < 2e-6, "{a:?} {b:?}");
        assert!((a.arc_length - b.arc_length).abs() < 1e-6 && (a.t - b.t).abs() < 1e-6);
    }
}

#[test]
fn points_and_ends() {
    let at = |q: [f64; 3]| Quadratic { a: q, b: q, c: q };
    let point = closest([1.0, 2.0, 5.0], &prepare(&[at([1.0, 0.0, 2.0])]).pieces, &[]);
    assert_eq!([point.x, point.y, point.overshoot, point.stretch], [0.0, 2.0, 3.0, 1.0]);
    assert_eq!([point.t, point.arc_length, point.curve_length], [0.0; 3]);
    let line = prepare(&[Quadratic { a: [0.0; 3], b: [1.0, 0.0, 0.0], c: [2.0, 0.0, 0.0] }]).pieces;
    let far = closest([5.0, 3.0, 0.0], &line, &[]);
    assert_eq!([far.overshoot, far.x, far.y, far.t, far.arc_length], [3.0, 3.0, 0.0, 1.0, 2.0]);
    assert_eq!(closest([-2.0, 0.0, 0.0], &line, &[]).overshoot, 2.0);
    assert_eq!(closest([1.0, 1.0, 0.0], &line, &[]).overshoot, 0.0);
    assert_eq!(closest([1.0; 3], &[], &[]).distance, 1e18);
}

#[test]
fn nothing_overflows() {
    let mut dice = Dice(2);
    for i in 0..20_000 {
        let mut wild = || [(); 3].map(|()| dice.roll() * 10f64.powi((dice.unit() * 60.0) as i32 - 30));
        let segments =
            [Quadratic { a: wild(), b: wild(), c: wild() }, Quadratic { a: wild(), b: wild(), c: wild() }];
        let point = closest(wild().map(|x| x as f32), &prepare(&segments).pieces, &[]);
        let all =
            [point.t, point.arc_length, point.x, point.y, point.distance, point.overshoot, point.stretch];
        assert!(all.iter().all(|x| x.is_finite()), "{i}: {segments:?} {point:?}");
    }
}
