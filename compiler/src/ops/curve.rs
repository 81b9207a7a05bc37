//! Rows of the closest point of a curve and of how it moves.
//!
//! The distance is 1-Lipschitz in the position, which gives its interval and its error. The other
//! results depend on where the foot is, and that jumps on the medial axis and runs away near the focal
//! line: there their errors are infinite; elsewhere they are first-order estimates, **not proofs**.
//! Example: 0.1 from a straight curve the foot moves as far as the position does, half way to the
//! focal line of an arc twice as far.

mod feet;

pub(super) use feet::FOOT;

use super::error::{UNIT, decision, operand};
use super::interval::Interval;
use super::{Context, MAX_RESULTS, Op, Operation, Results, Ty, range, slope};
use crate::curve::Quadratic;
use crate::error_bound::Bounded;
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::reference::curve::{self, ReferencePoint};

/// Distance to a curve without segments, scene units.
const FAR: f64 = 1e18;
/// Positions beyond this are outside the range of the kernels, scene units.
const REACH: f64 = 1e8;
/// Largest stretch.
const LARGEST_STRETCH: f64 = 1e6;
/// Own error of the distance over the scale, twice what f32 rounded to nearest shows (4e-7).
const DISTANCE_ERROR: f64 = 8e-7;
/// Own error of the place of the foot over the scale at stretch 1. Rounding to nearest shows 4e-6
/// down to a stretch of 0.05, where it counts twenty times.
const FOOT_ERROR: f64 = 2e-6;
/// Own relative error of lengths along the curve, twice the measured 1e-6.
const LENGTH_ERROR: f64 = 2e-6;
/// Below this stretch the foot is too loose to say where it is.
const LEAST_STRETCH: f64 = 0.05;
/// A rival must be farther by this share of the scale.
const LEAST_GAP: f64 = 1e-4;

pub(super) const CLOSEST: Operation = Operation {
    op: Op::Closest,
    name: "closest",
    args: &[Ty::Number; 3],
    results: &[Ty::Number; MAX_RESULTS],
    has_data: true,
    meaning: |x, context| results(&closest([x[0], x[1], x[2]], segments(context))),
    interval: |x, context| bounds([x[0], x[1], x[2]], segments(context)),
    error: |x, e, _, context| errors([0, 1, 2].map(|i| operand(x, e, i)), segments(context)),
    derivative: along,
    range: range::unknown,
    wgsl: "vol_closest(vec3f({0}, {1}, {2}), {curve})",
    wgsl_extract: &[".t", ".arc_length", ".curve_length", ".x", ".y", ".distance", ".overshoot", ".stretch"],
    domain: &[(-4.0, 4.0); 3],
};

/// Largest change of arc length reported: where it is reached the stretch is [`LEAST_STRETCH`].
const LARGEST_SLIDE: f64 = 1.0 / LEAST_STRETCH;
/// Rate of change of t along a curve that is a point or stands still, and the largest reported.
const LARGEST_RATE: f64 = 1e15;

pub(super) const CLOSEST_GRADIENT: Operation = Operation {
    op: Op::ClosestGradient,
    name: "closest_gradient",
    args: &[Ty::Number; 3],
    results: &[Ty::Number; MAX_RESULTS],
    has_data: true,
    meaning: |x, context| movement([x[0], x[1], x[2]], segments(context)),
    interval: |_, _| movement_bounds(),
    error: |x, e, _, context| movement_errors([0, 1, 2].map(|i| operand(x, e, i)), segments(context)),
    derivative: none,
    range: range::unknown,
    wgsl: "vol_closest_gradient(vec3f({0}, {1}, {2}), {curve})",
    wgsl_extract: &[
        ".direction.x",
        ".direction.y",
        ".direction.z",
        ".tangent.x",
        ".tangent.y",
        ".tangent.z",
        ".rate",
        ".slide",
    ],
    domain: &[(-4.0, 4.0); 3],
};

/// Derivatives along a motion of the position, all but that of the stretch, which has no rule. Where
/// the foot jumps there is none; they are those on the side that was chosen.
///
/// The frame turns with the foot but about axes across the tangent only, so the offset across the
/// tangent has the coordinates x and y whose gradients are the frame's axes U and V:
/// with o across, `x o - y T x o = (x^2 + y^2) U`, and `V = T x U`.
fn along(g: &mut Graph, data: u32, args: &[ValueId], node: ValueId, d: &[ValueId]) -> Option<Vec<ValueId>> {
    let results = g.extract_all(Op::Closest, node);
    let moves = g.apply_all(Op::ClosestGradient, data, args);
    let (direction, tangent) = ([moves[0], moves[1], moves[2]], [moves[3], moves[4], moves[5]]);
    let zero = g.number(0.0);
    let forward = slope::along(g, &tangent, d);
    let distance = slope::along(g, &direction, d);
    let arc_length = g.mul(moves[7], forward);
    let t = g.mul(moves[6], arc_length);
    // Beyond an end the overshoot grows outwards.
    let lean = g.dot(&direction, &tangent);
    let behind = g.apply(Op::Less, &[lean, zero]);
    let backward = g.apply(Op::Neg, &[forward]);
    let outward = g.select(behind, backward, forward);
    let beyond = g.apply(Op::Less, &[zero, results[6]]);
    let overshoot = g.select(beyond, outward, zero);
    let [along_u, along_v] = frame_motion(g, &results, direction, tangent, d);
    Some(vec![t, arc_length, zero, along_u, along_v, distance, overshoot])
}

/// Components of a motion along the axes U and V of the frame; 0 on the curve.
fn frame_motion(
    g: &mut Graph,
    results: &[ValueId],
    direction: [ValueId; 3],
    tangent: [ValueId; 3],
    d: &[ValueId],
) -> [ValueId; 2] {
    let (x, y) = (results[3], results[4]);
    let lean = g.dot(&direction, &tangent);
    let across = [0, 1, 2].map(|i| {
        let part = g.mul(lean, tangent[i]);
        let rest = g.sub(direction[i], part);
        g.mul(results[5], rest)
    });
    let turned = cross_product(g, tangent, across);
    let squared = g.dot(&[x, y], &[x, y]);
    let over = slope::over_positive(g, 1.0, squared);
    let u = [0, 1, 2].map(|i| {
        let (first, second) = (g.mul(x, across[i]), g.mul(y, turned[i]));
        let sum = g.sub(first, second);
        g.mul(sum, over)
    });
    let v = cross_product(g, tangent, u);
    [slope::along(g, &u, d), slope::along(g, &v, d)]
}

fn cross_product(g: &mut Graph, a: [ValueId; 3], b: [ValueId; 3]) -> [ValueId; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| {
        let (first, second) = (g.mul(a[i], b[j]), g.mul(a[j], b[i]));
        g.sub(first, second)
    })
}

/// How a foot moves has no rule of its own.
fn none(_: &mut Graph, _: u32, _: &[ValueId], _: ValueId, _: &[ValueId]) -> Option<Vec<ValueId>> {
    None
}

fn segments(context: Context<'_>) -> &[Quadratic] {
    context.curves.get(context.data as usize).map_or(&[], Vec::as_slice)
}

/// The reference's answer, or the kernels' for no segments.
fn closest(p: [f64; 3], segments: &[Quadratic]) -> ReferencePoint {
    curve::closest(p, segments).unwrap_or(ReferencePoint {
        t: 0.0,
        arc_length: 0.0,
        curve_length: 0.0,
        x: FAR,
        y: 0.0,
        distance: FAR,
        overshoot: 0.0,
        stretch: 1.0,
        gap: f64::INFINITY,
    })
}

/// In the order of the operation's results.
fn results(at: &ReferencePoint) -> Results<f64> {
    [at.t, at.arc_length, at.curve_length, at.x, at.y, at.distance, at.overshoot, at.stretch]
}

/// Curves of more segments are not searched for bounds: the reference looks at every segment in many places.
const MANY_SEGMENTS: usize = 64;

/// What is known of any place and any curve.
fn rough_bounds() -> Results<Interval> {
    let size = Interval::new(0.0, f64::INFINITY);
    let side = Interval::EVERYTHING;
    [Interval::new(0.0, 1.0), size, size, side, side, size, size, Interval::new(0.0, LARGEST_STRETCH)]
}

/// Bounds over a box: the distance from its middle, the others by what they mean.
fn bounds(p: [Interval; 3], segments: &[Quadratic]) -> Results<Interval> {
    if segments.len() > MANY_SEGMENTS {
        return rough_bounds();
    }
    let middle = closest(p.map(Interval::middle), segments);
    let radius = p.iter().map(|x| x.radius() * x.radius()).sum::<f64>().sqrt();
    // The reference's sampling, bisection and quadrature leave less than this.
    let slack = 1e-9 * (middle.distance + middle.curve_length);
    let distance = if radius.is_finite() {
        let lo = (middle.distance - radius - slack).max(0.0);
        Interval::outward(lo, middle.distance + radius + slack)
    } else {
        Interval::new(0.0, f64::INFINITY)
    };
    let side = Interval::new(-distance.hi, distance.hi);
    let length = middle.curve_length + slack;
    [
        Interval::new(0.0, 1.0),
        Interval::new(0.0, length),
        Interval::new((middle.curve_length - slack).max(0.0), length),
        side,
        side,
        distance,
        Interval::new(0.0, distance.hi),
        Interval::new(0.0, LARGEST_STRETCH),
    ]
}

/// Errors of all results; see the header for what they are worth.
fn errors(p: [Bounded; 3], segments: &[Quadratic]) -> Results<f64> {
    let off = p.iter().map(|x| x.error * x.error).sum::<f64>().sqrt();
    // Written so that NaN is refused.
    if !p.iter().all(|x| x.value.abs() + x.error <= REACH) {
        return [f64::INFINITY; MAX_RESULTS];
    }
    let at = closest(p.map(|x| x.value), segments);
    let size = segments.iter().map(reach).fold(0.0, f64::max);
    let scale = at.distance + size;
    let near = off + DISTANCE_ERROR * scale;
    // Distance and length of the curve do not depend on where the foot is.
    let mut found = [f64::INFINITY; MAX_RESULTS];
    found[2] = LENGTH_ERROR * at.curve_length;
    found[5] = near + 4.0 * UNIT * at.distance;
    let shape = shape_at(at.t, segments);
    let loose = (off + FOOT_ERROR * scale) / at.stretch;
    // The foot slides along the curve, less tightly held on its inner side.
    let slide = loose + shape.bend * loose * loose;
    let sure = decision(at.gap > 2.0 * near + LEAST_GAP * scale && at.stretch > LEAST_STRETCH);
    found[0] = slide * shape.rate + 4.0 * UNIT + sure;
    found[1] = slide + LENGTH_ERROR * at.curve_length + sure;
    found[3] = near + slide + sure;
    found[4] = near + slide + sure;
    found[6] = near + sure;
    let turning = shape.bend_change + shape.bend * shape.bend;
    let rounding = DISTANCE_ERROR * (1.0 + shape.bend * at.distance);
    found[7] = shape.bend * near + at.distance * turning * slide + rounding + sure;
    found.map(|error| if error.is_nan() { f64::INFINITY } else { error })
}

/// The reference's answer in the order of the results; no direction without segments.
fn movement(p: [f64; 3], segments: &[Quadratic]) -> Results<f64> {
    let Some(moves) = curve::slopes(p, segments) else { return [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0] };
    let ([dx, dy, dz], [tx, ty, tz]) = (moves.direction, moves.tangent);
    [dx, dy, dz, tx, ty, tz, moves.rate.min(LARGEST_RATE), moves.slide]
}

/// What the results mean is all that is known: the foot may jump.
fn movement_bounds() -> Results<Interval> {
    let unit = Interval::outward(-1.0, 1.0);
    let (rate, slide) = (Interval::new(0.0, LARGEST_RATE), Interval::outward(0.0, LARGEST_SLIDE));
    [unit, unit, unit, unit, unit, unit, rate, slide]
}

/// Errors of the results; see the header for what they are worth.
fn movement_errors(p: [Bounded; 3], segments: &[Quadratic]) -> Results<f64> {
    let closest_errors = errors(p, segments);
    let middle = p.map(|x| x.value);
    let (at, Some(moves)) = (closest(middle, segments), curve::slopes(middle, segments)) else {
        return [0.0; MAX_RESULTS];
    };
    let shape = shape_at(at.t, segments);
    let slide = closest_errors[1];
    // The direction turns with the offset and the foot, the tangent with the foot.
    let turn = 2.0 * (closest_errors[5] + slide) / at.distance + 8.0 * UNIT;
    let bent = (shape.bend + DISTANCE_ERROR) * slide + 16.0 * UNIT;
    // Whether the foot stays is decided by how the offset leans.
    let lean: f64 = moves.direction.iter().zip(moves.tangent).map(|(a, b)| a * b).sum();
    let near_end = (at.t * segments.len() as f64).fract();
    let inside = near_end > 1e-4 && near_end < 1.0 - 1e-4;
    let sure = decision(inside || (lean.abs() - 1e-3).abs() > 2.0 * (turn + bent));
    let speeds = shape.rate * (shape.speed_change * slide + 16.0 * UNIT);
    let stretched = closest_errors[7] * moves.slide * moves.slide;
    let stretched = 2.0 * stretched + 16.0 * UNIT * moves.slide + sure;
    let all = [turn, turn, turn, bent, bent, bent, speeds, stretched];
    all.map(|error| if error.is_nan() { f64::INFINITY } else { error })
}

/// How a curve runs at a foot.
struct Shape {
    /// Change of the parameter per length.
    rate: f64,
    /// Curvature.
    bend: f64,
    /// Change of the curvature per length.
    bend_change: f64,
    /// Relative change of the speed per length.
    speed_change: f64,
}

/// The worst of the segments that meet at `t`.
fn shape_at(t: f64, segments: &[Quadratic]) -> Shape {
    let mut worst = Shape { rate: 0.0, bend: 0.0, bend_change: 0.0, speed_change: 0.0 };
    for (i, segment) in segments.iter().enumerate() {
        let u = t * segments.len() as f64 - i as f64;
        // Segments too short to count never hold the foot.
        if !(-1e-9..=1.0 + 1e-9).contains(&u) || reach(segment) == 0.0 {
            continue;
        }
        let b1 = sub(segment.b, segment.a);
        let b2 = sub(sub(segment.c, segment.b), b1);
        let half_velocity: [f64; 3] = std::array::from_fn(|k| b1[k] + u * b2[k]);
        let half_speed = norm(half_velocity);
        let along: f64 = (0..3).map(|k| half_velocity[k] * b2[k]).sum();
        let bend = norm(cross(b1, b2)) / (2.0 * half_speed.powi(3));
        worst.rate = worst.rate.max(1.0 / (2.0 * half_speed * segments.len() as f64));
        worst.bend = worst.bend.max(bend);
        worst.speed_change = worst.speed_change.max(along.abs() / half_speed.powi(3));
        worst.bend_change = worst.bend_change.max(1.5 * bend * along.abs() / half_speed.powi(3));
    }
    worst
}

/// Length of the control polygon, at least that of the segment.
fn reach(segment: &Quadratic) -> f64 {
    norm(sub(segment.b, segment.a)) + norm(sub(segment.c, segment.b))
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn norm(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}
