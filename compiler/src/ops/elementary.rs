//! Rows of roots, angles, powers and logarithms.
//!
//! All but the square root are our own f32 formulas, `wgsl/fun.wgsl` and `runtime-cpu/src/math/fun.rs`;
//! the meanings hold their arguments where the formulas do. Own errors are the column "defensible
//! test bound" of `algorithms.md` §8.2, with an ulp of `r` taken as `2 u |r|`, widened where the formulas
//! with every rounding drawn at random (3e6 arguments) came too near. Example: `exp2` is off by at most
//! 2 ulp, `4 u r`.

use super::error::{SMALLEST, UNIT, monotone};
use super::interval::Interval;
use super::math::{NUMBER, NUMBERS, WHOLE};
use super::{Op, Operation, one, one_within, range, slope};
use std::f64::consts::{FRAC_PI_2, LN_2, PI, TAU};

/// `exp2` is 0 below this.
const LEAST_EXPONENT: f64 = -126.0;
/// `exp2` stays as it is above this.
const LARGEST_EXPONENT: f64 = 127.0;
/// Own absolute errors of `sin` and `cos`: a fixed part and one per |argument|, which is a rounded
/// product and a third of that more for the rounded 1 / (2 pi).
pub(super) const CIRCLE_ERROR: (f64, f64) = (1.0 / 4_194_304.0, 1.375 / 8_388_608.0);
/// Own absolute error of `log2` within [1/2, 2].
pub(super) const LOG_ERROR: f64 = 1.5e-7;
/// Own absolute error of `acos`; 7.9e-7 was seen with roots off by 4 ulp.
pub(super) const ACOS_ERROR: f64 = 1e-6;

pub(super) const SQRT: Operation = Operation {
    op: Op::Sqrt,
    name: "sqrt",
    args: NUMBER,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(sqrt(x[0])),
    interval: |x, _| one_within(x[0].increasing(sqrt)),
    error: |x, e, _, _| {
        let (change, size) = monotone(x[0], e[0], sqrt);
        one(change + 9.0 * UNIT * size)
    },
    derivative: |graph, _, _, root, d| {
        let slope = slope::over_positive(graph, 0.5, root);
        Some(vec![slope::times(graph, slope, d[0])])
    },
    range: range::sqrt,
    wgsl: "sqrt(select(0.0, {0}, ({0} > 0.0)))",
    wgsl_extract: WHOLE,
    domain: &[(0.01, 100.0)],
};

pub(super) const SIN: Operation = Operation {
    op: Op::Sin,
    name: "sin",
    args: NUMBER,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(x[0].sin()),
    interval: |x, _| one_within(wave(x[0], FRAC_PI_2, f64::sin)),
    error: |x, e, r, _| one(circle_error(x[0], e[0], r[0], x[0].cos())),
    derivative: |graph, _, x, _, d| {
        let slope = graph.apply(Op::Cos, &[x[0]]);
        Some(vec![slope::times(graph, slope, d[0])])
    },
    range: range::wave,
    wgsl: "vol_sin({0})",
    wgsl_extract: WHOLE,
    domain: &[(-20.0, 20.0)],
};

pub(super) const COS: Operation = Operation {
    op: Op::Cos,
    name: "cos",
    args: NUMBER,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(x[0].cos()),
    interval: |x, _| one_within(wave(x[0], 0.0, f64::cos)),
    error: |x, e, r, _| one(circle_error(x[0], e[0], r[0], x[0].sin())),
    derivative: |graph, _, x, _, d| {
        let sine = graph.apply(Op::Sin, &[x[0]]);
        let slope = slope::negative(graph, sine);
        Some(vec![slope::times(graph, slope, d[0])])
    },
    range: range::wave,
    wgsl: "vol_cos({0})",
    wgsl_extract: WHOLE,
    domain: &[(-20.0, 20.0)],
};

pub(super) const EXP2: Operation = Operation {
    op: Op::Exp2,
    name: "exp2",
    args: NUMBER,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(exp2(x[0])),
    interval: |x, _| one_within(x[0].increasing(exp2)),
    error: |x, e, _, _| {
        let (change, size) = monotone(x[0], e[0], exp2);
        one(change + 4.0 * UNIT * size)
    },
    derivative: |graph, _, _, power, d| {
        let log = graph.number(LN_2);
        let slope = graph.mul(power, log);
        Some(vec![slope::times(graph, slope, d[0])])
    },
    range: range::exp2,
    wgsl: "vol_exp2({0})",
    wgsl_extract: WHOLE,
    domain: &[(-20.0, 20.0)],
};

pub(super) const LOG2: Operation = Operation {
    op: Op::Log2,
    name: "log2",
    args: NUMBER,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(log2(x[0])),
    interval: |x, _| one_within(x[0].increasing(log2)),
    error: |x, e, _, _| {
        let (change, size) = monotone(x[0], e[0], log2);
        one(change + (6.0 * UNIT * size).max(LOG_ERROR))
    },
    derivative: |graph, _, x, _, d| {
        let slope = slope::over_positive(graph, 1.0 / LN_2, x[0]);
        Some(vec![slope::times(graph, slope, d[0])])
    },
    range: range::log2,
    wgsl: "vol_log2({0})",
    wgsl_extract: WHOLE,
    domain: &[(0.01, 100.0)],
};

pub(super) const ACOS: Operation = Operation {
    op: Op::Acos,
    name: "acos",
    args: NUMBER,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(acos(x[0])),
    interval: |x, _| one_within(-((-x[0]).increasing(|x| -acos(-x)))),
    error: |x, e, _, _| one(monotone(x[0], e[0], acos).0 + ACOS_ERROR),
    derivative: |graph, _, x, _, d| {
        // -1 / sqrt((1 - a) (1 + a))
        let one = graph.number(1.0);
        let (less, more) = (graph.sub(one, x[0]), graph.add(one, x[0]));
        let squared = graph.mul(less, more);
        let sine = graph.apply(Op::Sqrt, &[squared]);
        let slope = slope::over_positive(graph, -1.0, sine);
        Some(vec![slope::times(graph, slope, d[0])])
    },
    range: range::acos,
    wgsl: "vol_acos({0})",
    wgsl_extract: WHOLE,
    domain: &[(-0.99, 0.99)],
};

pub(super) const ATAN2: Operation = Operation {
    op: Op::Atan2,
    name: "atan2",
    args: NUMBERS,
    results: NUMBER,
    has_data: false,
    meaning: |x, _| one(atan2(x[0], x[1])),
    interval: |x, _| one_within(angles(x[0], x[1])),
    error: |x, e, r, _| one(angle_error(x[0], x[1], e, r[0])),
    derivative: |graph, _, x, _, d| {
        // (x dy - y dx) / (x^2 + y^2)
        let squared = graph.dot(x, x);
        let slope = slope::over_positive(graph, 1.0, squared);
        let (up, across) = (slope::times(graph, x[1], d[0]), slope::times(graph, x[0], d[1]));
        let turn = slope::minus(graph, up, across);
        Some(vec![slope::times(graph, slope, turn)])
    },
    range: range::atan2,
    wgsl: "vol_atan2({0}, {1})",
    wgsl_extract: WHOLE,
    domain: &[(-8.0, 8.0), (0.25, 8.0)],
};

fn sqrt(x: f64) -> f64 {
    if x > 0.0 { x.sqrt() } else { 0.0 }
}

fn exp2(x: f64) -> f64 {
    if x < LEAST_EXPONENT { 0.0 } else { x.min(LARGEST_EXPONENT).exp2() }
}

fn log2(x: f64) -> f64 {
    x.clamp(SMALLEST, f64::from(f32::MAX)).log2()
}

fn acos(x: f64) -> f64 {
    x.clamp(-1.0, 1.0).acos()
}

/// The sign of a zero does not count: adding 0 makes it positive.
fn atan2(y: f64, x: f64) -> f64 {
    (y + 0.0).atan2(x + 0.0)
}

/// Bounds of a sine wave with a crest at `crest` and every turn.
fn wave(x: Interval, crest: f64, function: impl Fn(f64) -> f64) -> Interval {
    let all = Interval::new(-1.0, 1.0);
    // Beyond this the phase is not exact enough to tell where the crests are.
    if x.magnitude() > 1e6 {
        return all;
    }
    // Whether some `phase + k TAU` may lie inside; the margin covers the rounding of the division.
    let meets = |phase: f64| {
        let turns = |end: f64| (end - phase) / TAU;
        (turns(x.hi) + 1e-9).floor() >= (turns(x.lo) - 1e-9).ceil()
    };
    let (first, last) = (function(x.lo), function(x.hi));
    let lo = if meets(crest + PI) { -1.0 } else { first.min(last) };
    let hi = if meets(crest) { 1.0 } else { first.max(last) };
    Interval::outward(lo, hi).within(all)
}

/// Own error of sine or cosine `r`, and what the argument's error makes of the slope.
fn circle_error(x: f64, error: f64, r: f64, slope: f64) -> f64 {
    if !error.is_finite() {
        return f64::INFINITY;
    }
    let own = CIRCLE_ERROR.0 + (x.abs() + error) * CIRCLE_ERROR.1;
    let change = error.min(slope.abs() * error + 0.5 * error * error);
    // Both the exact and the computed value are within ±1, but for the own error near 0.
    (change + own).min(1.0 + r.abs() + CIRCLE_ERROR.0)
}

/// Bounds of the angle of the points of a box.
fn angles(y: Interval, x: Interval) -> Interval {
    // The angle jumps across the negative x axis, and at the origin it is anything.
    if x.lo < 0.0 && y.lo < 0.0 && y.hi >= 0.0 {
        return Interval::outward(-PI, PI);
    }
    // Elsewhere it is extreme at corners; a box that touches the origin also has its 0.
    let corners = [(y.lo, x.lo), (y.lo, x.hi), (y.hi, x.lo), (y.hi, x.hi)].map(|(y, x)| atan2(y, x));
    let lo = corners.into_iter().fold(f64::INFINITY, f64::min);
    let hi = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let found = Interval::outward(lo, hi);
    if y.contains(0.0) && x.contains(0.0) { found.hull(Interval::point(0.0)) } else { found }
}

/// Own error of an angle, 5 ulp and 2.5 ulp of the division, and the angle under which the
/// operands' errors are seen; unbounded at the origin and on the cut.
fn angle_error(y: f64, x: f64, errors: &[f64], angle: f64) -> f64 {
    let (far, doubt) = (x.hypot(y), errors[0].hypot(errors[1]));
    if far == 0.0 && doubt == 0.0 {
        return 0.0;
    }
    // The quotient of the coordinates must not be flushed, nor its divisor too large.
    if !(far - doubt > 4.0 * SMALLEST && far + doubt < 8e37) {
        return f64::INFINITY;
    }
    let on_cut = x - errors[1] <= 0.0 && y.abs() <= errors[0] && errors[0] > 0.0;
    if on_cut {
        return f64::INFINITY;
    }
    let change = (doubt / far).asin();
    change + 15.0 * UNIT * (angle.abs() + change)
}
