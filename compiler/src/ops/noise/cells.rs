//! Rows of what a cell decides: the distance to strewn points, and random numbers.
//!
//! A distance changes by no more than the position does, whichever point is nearest; its direction jumps
//! where two points are equally near, where no bound can be given. Example: `worley` at a position that
//! is off by 1e-3 is off by 1e-3 and its own rounding.

use super::super::error::{UNIT, decision, operand};
use super::super::interval::Interval;
use super::super::math::{NUMBER, WHOLE};
use super::super::{
    MAX_RESULTS, Op, Operation, Results, Ty, one, one_within, several, several_within, slope,
};
use super::{FIELD, PARTS, POINT, SPACE, WITH_GRADIENT, none, ranges};
use crate::error_bound::Bounded;
use crate::reference::noise::{self, Nearest};

/// Coordinates of random numbers are held within ± this.
const WHOLES: f64 = 16_777_216.0;
/// Distances are held at this.
pub(super) const FARTHEST: f64 = 1.0;
/// Own error of a distance: offsets are rounded once, and roots are off by 4.5 ulp. 4.8e-7 was seen over
/// 3e5 points with every rounding drawn at random, half of this.
const DISTANCE_ERROR: f64 = 16.0 * UNIT;
/// Own error of a component of a direction, beyond what the offset's rounding makes of it.
const DIRECTION_ERROR: f64 = 24.0 * UNIT;

pub(in super::super) const WORLEY: Operation = Operation {
    op: Op::Worley,
    name: "worley",
    args: POINT,
    results: NUMBER,
    has_data: true,
    meaning: |x, context| one(noise::worley([x[0], x[1], x[2]], context.data)),
    interval: |x, context| one_within(bounds([x[0], x[1], x[2]], context.data)[0]),
    error: |x, e, _, context| one(errors([0, 1, 2].map(|i| operand(x, e, i)), context.data)[0]),
    derivative: |graph, seed, x, _, d| {
        let parts = graph.apply_all(Op::WorleyGradient, seed, x);
        Some(vec![slope::along(graph, &parts[1..], d)])
    },
    range: |graph, _, _| Some(vec![ranges::distance(graph)[0]]),
    wgsl: "vol_worley(vec3f({0}, {1}, {2}), {d}u)",
    wgsl_extract: WHOLE,
    domain: &[SPACE; 3],
};

pub(in super::super) const WORLEY_GRADIENT: Operation = Operation {
    op: Op::WorleyGradient,
    name: "worley_gradient",
    args: POINT,
    results: WITH_GRADIENT,
    has_data: true,
    meaning: |x, context| several(&noise::worley_gradient([x[0], x[1], x[2]], context.data)),
    interval: |x, context| bounds([x[0], x[1], x[2]], context.data),
    error: |x, e, _, context| errors([0, 1, 2].map(|i| operand(x, e, i)), context.data),
    derivative: none,
    range: |graph, _, _| Some(ranges::distance(graph)),
    wgsl: "vol_worley_gradient(vec3f({0}, {1}, {2}), {d}u)",
    wgsl_extract: PARTS,
    domain: &[SPACE; 3],
};

pub(in super::super) const HASH: Operation = Operation {
    op: Op::Hash,
    name: "hash",
    args: &[Ty::Number; 4],
    results: NUMBER,
    has_data: true,
    meaning: |x, context| one(noise::hash([x[0], x[1], x[2], x[3]], context.data)),
    interval: |x, context| {
        let cell = [0, 1, 2, 3].map(|i| x[i].increasing_exact(|x| x.clamp(-WHOLES, WHOLES).floor()));
        one_within(if cell.iter().all(|x| x.is_point()) {
            Interval::point(noise::hash(cell.map(|x| x.lo), context.data))
        } else {
            Interval::new(0.0, 1.0)
        })
    },
    error: |x, e, _, _| {
        let sure = |(x, e): (&f64, &f64)| e.is_finite() && (x - e).floor() == (x + e).floor();
        one(decision(x.iter().zip(e).all(sure)))
    },
    derivative: |graph, _, _, _, _| Some(vec![graph.number(0.0)]),
    range: |graph, _, _| Some(vec![ranges::cell(graph)]),
    wgsl: "vol_hash(vec4f({0}, {1}, {2}, {3}), {d}u)",
    wgsl_extract: WHOLE,
    domain: &[SPACE; 4],
};

/// Bounds of the distance and of its partial derivatives over a box.
fn bounds(p: [Interval; 3], seed: u32) -> Results<Interval> {
    let held = p.map(|x| Interval::new(x.lo.clamp(-FIELD, FIELD), x.hi.clamp(-FIELD, FIELD)));
    let radius = held.iter().map(|x| x.radius() * x.radius()).sum::<f64>().sqrt();
    let (value, partial) = (Interval::new(0.0, FARTHEST), Interval::new(-1.0, 1.0));
    let mut found = [value, partial, partial, partial];
    if radius < FARTHEST {
        let Nearest { offset, distance, second } = noise::nearest(held.map(Interval::middle), seed);
        found[0] = Interval::around(distance.min(FARTHEST), radius).within(value);
        // One point is nearest to all of the box, which it is not in.
        if second - distance > 2.0 * radius && distance > radius && distance + radius < FARTHEST {
            // Directions to it differ by an angle whose sine is at most this.
            let turned = radius / (distance - radius) + 1e-12;
            for i in 0..3 {
                found[i + 1] = Interval::around(offset[i] / distance, turned).within(partial);
            }
        }
    }
    several_within(&found)
}

/// Errors of the distance and of its partial derivatives.
fn errors(p: [Bounded; 3], seed: u32) -> Results<f64> {
    let off = p.iter().map(|x| x.error * x.error).sum::<f64>().sqrt();
    if !off.is_finite() {
        return [f64::INFINITY; MAX_RESULTS];
    }
    let Nearest { distance, second, .. } = noise::nearest(p.map(|x| x.value), seed);
    let near = off + DISTANCE_ERROR;
    let sure = second.min(FARTHEST) - distance > 2.0 * near && distance > near;
    let held = distance - FARTHEST > near;
    let direction = if held {
        0.0
    } else if sure {
        // As in [`bounds`]; no component is farther off than 2.
        (near / (distance - near) + DIRECTION_ERROR).min(2.0)
    } else {
        f64::INFINITY
    };
    let value = if held { 0.0 } else { near };
    [value, direction, direction, direction, 0.0, 0.0, 0.0, 0.0]
}

#[cfg(test)]
mod tests {
    use super::super::super::Context;
    use super::*;

    #[test]
    fn small_boxes_are_tight() {
        let around = |x: f64| Interval::new(x - 1e-4, x + 1e-4);
        let (mut narrow, mut all) = (0, 0);
        for i in 0..200 {
            let [value, partial, ..] = bounds([around(0.37 * f64::from(i)), around(1.7), around(-2.4)], 1);
            assert!(value.width() < 4e-4, "{value:?}");
            narrow += u32::from(partial.width() < 1e-2);
            all += 1;
        }
        assert!(narrow * 10 > all * 9, "{narrow} of {all}");
        assert_eq!(bounds([Interval::EVERYTHING; 3], 1)[0], Interval::new(0.0, 1.0));
    }

    #[test]
    fn directions_are_undecided_between_points() {
        // Between two neighbours the nearest changes: walk there by bisection.
        let at = |t: f64| [0.5 + t, 0.5, 0.5];
        let first = noise::nearest(at(0.0), 0);
        let point =
            |n: &Nearest, p: [f64; 3]| [0, 1, 2].map(|i| (p[i] - n.offset[i]) * 1024.0).map(f64::round);
        let (mut lo, mut hi) = (0.0, 3.0);
        for _ in 0..60 {
            let t = 0.5 * (lo + hi);
            if point(&noise::nearest(at(t), 0), at(t)) == point(&first, at(0.0)) { lo = t } else { hi = t }
        }
        let exact = |p: [f64; 3]| p.map(|value| Bounded { value, error: 0.0 });
        let found = errors(exact(at(lo)), 0);
        assert!(found[0] < 2e-6 && found[1].is_infinite(), "{found:?}");
        let found = errors(exact(at(0.0)), 0);
        assert!(found[1] < 1e-4, "{found:?}");
    }

    #[test]
    fn whole_numbers_decide() {
        let bound = |lo: f64, hi: f64| {
            (HASH.interval)(
                &[Interval::new(lo, hi), Interval::point(0.0), Interval::point(0.5), Interval::point(2.0)],
                Context::default(),
            )[0]
        };
        assert_eq!(bound(3.0, 3.9).width(), 0.0);
        assert_eq!(bound(3.9, 4.0), Interval::new(0.0, 1.0));
        let error = |x: f64, e: f64| (HASH.error)(&[x; 4], &[e; 4], &one(0.0), Context::default())[0];
        assert_eq!([error(3.5, 0.1), error(4.0, 0.0), error(4.0, 1e-9)], [0.0, 0.0, f64::INFINITY]);
    }
}
