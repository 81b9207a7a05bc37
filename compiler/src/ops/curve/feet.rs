//! The row of the feet of a point on a curve, one after the other.
//!
//! Operands: x, y, z, the number of the first foot that counts, the largest distance, whether the curve is
//! closed. Results: the number after that of the foot found, then those of the closest point but for the
//! length of the curve. Whether there is a foot, and which, is taken to be certain where it is the same at
//! points a little to all sides; otherwise every error is infinite. Like those of the closest point these
//! are estimates, **not proofs**.

use super::{
    Bounded, DISTANCE_ERROR, FAR, FOOT_ERROR, Interval, LARGEST_STRETCH, LEAST_STRETCH, LENGTH_ERROR,
    MAX_RESULTS, Op, Operation, Quadratic, REACH, Results, Ty, UNIT, decision, none, operand, range, reach,
    segments, shape_at,
};
use crate::reference::curve::{ReferenceFoot, ReferencePoint, next_foot};

pub(in crate::ops) const FOOT: Operation = Operation {
    op: Op::Foot,
    name: "foot",
    args: &[Ty::Number; 6],
    results: &[Ty::Number; MAX_RESULTS],
    has_data: true,
    meaning: |x, context| results(x[3], &found(x, segments(context))),
    interval: |x, context| bounds(x, segments(context)),
    error: |x, e, _, context| errors([0, 1, 2, 3, 4, 5].map(|i| operand(x, e, i)), segments(context)),
    derivative: none,
    range: range::unknown,
    wgsl: "vol_next_foot(vec3f({0}, {1}, {2}), {3}, {4}, {5}, {curve})",
    wgsl_extract: &[".next", ".t", ".arc_length", ".x", ".y", ".distance", ".overshoot", ".stretch"],
    domain: &[(-4.0, 4.0), (-4.0, 4.0), (-4.0, 4.0), (0.0, 8.0), (0.0, 8.0), (0.0, 1.0)],
};

fn found(x: &[f64], segments: &[Quadratic]) -> ReferenceFoot {
    next_foot([x[0], x[1], x[2]], segments, x[3].max(0.0) as u32, x[4], x[5] != 0.0)
}

/// In the order of the operation's results; the number asked from if there is no foot.
fn results(from: f64, foot: &ReferenceFoot) -> Results<f64> {
    let Some(at) = foot.point else { return [from, 0.0, 0.0, 0.0, 0.0, FAR, 0.0, 1.0] };
    let ReferencePoint { t, arc_length, x, y, distance, overshoot, stretch, .. } = at;
    [f64::from(foot.next), t, arc_length, x, y, distance, overshoot, stretch]
}

/// What the results mean is all that is looked at, so that long curves cost no more than short ones: loops
/// ask often.
fn bounds(x: &[Interval], segments: &[Quadratic]) -> Results<Interval> {
    let last = (6 * segments.len()) as f64;
    let most = x[4].hi.max(0.0);
    let side = Interval::new(-most, most);
    [
        Interval::new(x[3].lo, x[3].hi.max(last)),
        Interval::new(0.0, 1.0),
        Interval::new(0.0, f64::INFINITY),
        side,
        side,
        Interval::new(0.0, FAR.max(most)),
        Interval::new(0.0, most),
        Interval::new(0.0, LARGEST_STRETCH),
    ]
}

fn errors(x: [Bounded; 6], segments: &[Quadratic]) -> Results<f64> {
    let lost = [f64::INFINITY; MAX_RESULTS];
    let off = x[..3].iter().map(|x| x.error * x.error).sum::<f64>().sqrt();
    // Written so that NaN is refused.
    let place = x[..3].iter().all(|x| x.value.abs() + x.error <= REACH);
    let known = x[3].error == 0.0 && (x[5].error == 0.0 || x[5].value.abs() > x[5].error);
    if !place || !known {
        return lost;
    }
    let values = x.map(|x| x.value);
    let foot = found(&values, segments);
    let size = segments.iter().map(reach).fold(0.0, f64::max);
    let scale = size + foot.point.map_or(values[4].min(REACH), |at| at.distance);
    let near = off + DISTANCE_ERROR * scale;
    let sure = decision(steady(&values, &foot, segments, 2.0 * near + 1e-5 * scale, x[4].error));
    let Some(at) = foot.point else {
        let mut none = [sure; MAX_RESULTS];
        none[5] += 2.0 * UNIT * FAR;
        return none;
    };
    let shape = shape_at(at.t, segments);
    let loose = (off + FOOT_ERROR * scale) / at.stretch;
    let slide = loose + shape.bend * loose * loose;
    let sure = sure + decision(at.stretch > LEAST_STRETCH);
    let turning = shape.bend_change + shape.bend * shape.bend;
    let rounding = DISTANCE_ERROR * (1.0 + shape.bend * at.distance);
    let all = [
        sure,
        slide * shape.rate + 4.0 * UNIT + sure,
        slide + LENGTH_ERROR * (at.arc_length + size) + sure,
        near + slide + sure,
        near + slide + sure,
        near + 4.0 * UNIT * at.distance + sure,
        near + sure,
        shape.bend * near + at.distance * turning * slide + rounding + sure,
    ];
    all.map(|error| if error.is_nan() { f64::INFINITY } else { error })
}

/// Whether the same foot is found, or none, at points `step` to all sides and for limits that differ as much.
fn steady(x: &[f64; 6], foot: &ReferenceFoot, segments: &[Quadratic], step: f64, limit_error: f64) -> bool {
    let moved = |axis: usize, by: f64| {
        let mut moved = *x;
        moved[axis] += by;
        found(&moved, segments).next == foot.next
    };
    let limit = step + limit_error;
    let places = (0..3).all(|axis| moved(axis, step) && moved(axis, -step));
    places && moved(4, limit) && moved(4, -limit)
}
