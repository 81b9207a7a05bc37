//! Rows of gradient noise.
//!
//! Bounds that hold for every seed (`algorithms.md` §4.1): a value is at most [`LARGEST`], a gradient
//! at most [`STEEPEST`] long, and the gradient changes by at most [`BENDING`] per unit. From these come
//! both the intervals and how far errors of the position spread. Example: over a box of radius 0.01
//! about a point where the noise is 0.3 and flat, it stays within 0.3 ± 0.0008.

use super::error::{self, operand};
use super::interval::Interval;
use super::math::{NUMBER, WHOLE};
use super::{Op, Operation, Results, Ty, one, one_within, several, several_within, slope};
use crate::error_bound::Bounded;
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::reference::noise;

/// Largest absolute value, rounded up.
pub(super) const LARGEST: f64 = 1.036_353_811_3;
/// Largest length of the gradient, and largest absolute partial derivative.
pub(super) const STEEPEST: f64 = 3.75;
/// Largest norm of the matrix of second derivatives, rounded up.
pub(super) const BENDING: f64 = 14.466;
/// The position is held within ± this.
const FIELD: f64 = 4_194_303.0;
/// Most octaves of a sum.
const OCTAVES: f64 = 32.0;
/// Factors of amplitude and frequency are held within ± this in f32, but not in the meaning.
const PRODUCT: f64 = 1_099_511_627_776.0;
/// Own error of a value; 6.2e-7 was seen over 3e6 points with every rounding drawn at random.
const VALUE_ERROR: f64 = 1e-6;
/// Own error of a partial derivative, likewise (1.9e-6).
const PARTIAL_ERROR: f64 = 3e-6;

const POINT: &[Ty] = &[Ty::Number; 3];
const SUM: &[Ty] = &[Ty::Number; 6];
const WITH_GRADIENT: &[Ty] = &[Ty::Number; 4];
const PARTS: &[&str] = &[".x", ".y", ".z", ".w"];
const SPACE: (f64, f64) = (-20.0, 20.0);
const SUM_DOMAIN: &[(f64, f64)] = &[SPACE, SPACE, SPACE, (0.0, 5.0), (1.5, 2.5), (0.25, 0.75)];

pub(super) const PERLIN: Operation = Operation {
    op: Op::Perlin,
    name: "perlin",
    args: POINT,
    results: NUMBER,
    has_data: true,
    meaning: |x, context| one(noise::perlin([x[0], x[1], x[2]], context.data)),
    interval: |x, context| one_within(octave_bounds([x[0], x[1], x[2]], context.data)[0]),
    error: |x, e, _, context| {
        let p = [0, 1, 2].map(|i| operand(x, e, i));
        one(octave(p, context.data)[0].error)
    },
    derivative: |graph, seed, x, _, d| {
        let parts = graph.apply_all(Op::PerlinGradient, seed, x);
        Some(vec![slope::along(graph, &parts[1..], d)])
    },
    wgsl: "vol_perlin(vec3f({0}, {1}, {2}), {d}u)",
    wgsl_extract: WHOLE,
    domain: &[SPACE; 3],
};

pub(super) const PERLIN_GRADIENT: Operation = Operation {
    op: Op::PerlinGradient,
    name: "perlin_gradient",
    args: POINT,
    results: WITH_GRADIENT,
    has_data: true,
    meaning: |x, context| several(&noise::perlin_gradient([x[0], x[1], x[2]], context.data)),
    interval: |x, context| several_within(&octave_bounds([x[0], x[1], x[2]], context.data)),
    error: |x, e, _, context| {
        let p = [0, 1, 2].map(|i| operand(x, e, i));
        several(&octave(p, context.data).map(|part| part.error))
    },
    derivative: none,
    wgsl: "vol_perlin_gradient(vec3f({0}, {1}, {2}), {d}u)",
    wgsl_extract: PARTS,
    domain: &[SPACE; 3],
};

pub(super) const FBM: Operation = Operation {
    op: Op::Fbm,
    name: "fbm",
    args: SUM,
    results: NUMBER,
    has_data: true,
    meaning: |x, context| one(noise::fbm([x[0], x[1], x[2]], octave_count(x[3]), x[4], x[5], context.data)),
    interval: |x, context| one_within(sum_bounds(x, context.data)[0]),
    error: |x, e, _, context| one(sum_errors(x, e, context.data)[0]),
    derivative: |graph, seed, x, _, d| {
        // Along the factors there is no rule; the number of octaves only jumps.
        if !(slope::is_zero(graph, d[4]) && slope::is_zero(graph, d[5])) {
            return None;
        }
        let parts = graph.apply_all(Op::FbmGradient, seed, x);
        Some(vec![slope::along(graph, &parts[1..], &d[..3])])
    },
    wgsl: "vol_fbm(vec3f({0}, {1}, {2}), {3}, {4}, {5}, {d}u)",
    wgsl_extract: WHOLE,
    domain: SUM_DOMAIN,
};

pub(super) const FBM_GRADIENT: Operation = Operation {
    op: Op::FbmGradient,
    name: "fbm_gradient",
    args: SUM,
    results: WITH_GRADIENT,
    has_data: true,
    meaning: |x, context| {
        let p = [x[0], x[1], x[2]];
        several(&noise::fbm_gradient(p, octave_count(x[3]), x[4], x[5], context.data))
    },
    interval: |x, context| several_within(&sum_bounds(x, context.data)),
    error: |x, e, _, context| sum_errors(x, e, context.data),
    derivative: none,
    wgsl: "vol_fbm_gradient(vec3f({0}, {1}, {2}), {3}, {4}, {5}, {d}u)",
    wgsl_extract: PARTS,
    domain: SUM_DOMAIN,
};

/// Second derivatives are not needed anywhere.
fn none(_: &mut Graph, _: u32, _: &[ValueId], _: ValueId, _: &[ValueId]) -> Option<Vec<ValueId>> {
    None
}

/// Whole part, held within 0 to 32.
fn octave_count(octaves: f64) -> u32 {
    // The cast holds negative numbers and NaN at 0.
    octaves.min(OCTAVES).floor() as u32
}

/// Bounds of one octave and its gradient over a box.
///
/// * method: Taylor about the middle, first and second order, and the bounds over all of space
fn octave_bounds(p: [Interval; 3], seed: u32) -> [Interval; 4] {
    let held = p.map(|x| Interval::new(x.lo.clamp(-FIELD, FIELD), x.hi.clamp(-FIELD, FIELD)));
    let radii = held.map(Interval::radius);
    let radius = radii.iter().map(|r| r * r).sum::<f64>().sqrt();
    let value = Interval::new(-LARGEST, LARGEST);
    let partial = Interval::new(-STEEPEST, STEEPEST);
    // A box this wide has nothing to gain from its middle.
    if radius > 2.0 * LARGEST / STEEPEST {
        return [value, partial, partial, partial];
    }
    let middle = noise::perlin_gradient(held.map(Interval::middle), seed);
    let sloped: f64 = (0..3).map(|i| middle[i + 1].abs() * radii[i]).sum();
    let reach = (STEEPEST * radius).min(sloped + 0.5 * BENDING * radius * radius);
    // The middle values are themselves f64 sums of eight terms.
    let rounding = 1e-14;
    std::array::from_fn(|i| match i {
        0 => Interval::around(middle[0], reach + rounding).within(value),
        _ => Interval::around(middle[i], BENDING * radius + rounding).within(partial),
    })
}

/// Bounds of a sum of octaves and its gradient: of all numbers of octaves that are possible.
fn sum_bounds(x: &[Interval], seed: u32) -> [Interval; 4] {
    let (least, most) = (octave_count(x[3].lo), octave_count(x[3].hi));
    let (lacunarity, gain) = (x[4], x[5]);
    let mut amplitude = Interval::point(1.0);
    let mut frequency = Interval::point(1.0);
    let mut sum = [Interval::point(0.0); 4];
    let mut found = sum;
    for count in 1..=most {
        let octave = octave_bounds([x[0] * frequency, x[1] * frequency, x[2] * frequency], seed);
        for (i, part) in octave.into_iter().enumerate() {
            let factor = if i == 0 { amplitude } else { amplitude * frequency };
            sum[i] = sum[i] + factor * part;
            found[i] = if count <= least { sum[i] } else { found[i].hull(sum[i]) };
        }
        amplitude = amplitude * gain;
        frequency = frequency * lacunarity;
    }
    found
}

/// One octave and its gradient at a position with errors, as f32 would compute them.
fn octave(p: [Bounded; 3], seed: u32) -> [Bounded; 4] {
    let exact = noise::perlin_gradient(p.map(|x| x.value), seed);
    let off = p.iter().map(|x| x.error * x.error).sum::<f64>().sqrt();
    let bent = BENDING * off;
    let sloped: f64 = (0..3).map(|i| exact[i + 1].abs() * p[i].error).sum();
    let change = (STEEPEST * off).min(sloped + 0.5 * bent * off).min(2.0 * LARGEST);
    std::array::from_fn(|i| {
        let error = if i == 0 { change + VALUE_ERROR } else { bent.min(2.0 * STEEPEST) + PARTIAL_ERROR };
        // A position without a bound may be no number at all.
        let error = if off.is_finite() { error } else { f64::INFINITY };
        Bounded { value: exact[i], error }
    })
}

/// Errors of a sum of octaves and of its gradient: the kernel's loop with a bound on every step.
fn sum_errors(x: &[f64], e: &[f64], seed: u32) -> Results<f64> {
    let [lacunarity, gain] = [4, 5].map(|i| operand(x, e, i));
    let count = octave_count(x[3]);
    if octave_count(x[3] - e[3]) != count || octave_count(x[3] + e[3]) != count || !e[3].is_finite() {
        return [f64::INFINITY; super::MAX_RESULTS];
    }
    let mut amplitude = Bounded { value: 1.0, error: 0.0 };
    let mut frequency = amplitude;
    let mut sum = [Bounded { value: 0.0, error: 0.0 }; 4];
    for _ in 0..count {
        let q = [0, 1, 2].map(|i| error::mul(operand(x, e, i), frequency));
        let n = octave(q, seed);
        let steepness = error::mul(amplitude, frequency);
        for (i, part) in n.into_iter().enumerate() {
            let factor = if i == 0 { amplitude } else { steepness };
            sum[i] = error::add(sum[i], error::mul(factor, part));
        }
        amplitude = held(error::mul(amplitude, gain));
        frequency = held(error::mul(frequency, lacunarity));
    }
    several(&sum.map(|part| part.error))
}

/// A factor of an octave; unbounded where f32 holds it.
fn held(factor: Bounded) -> Bounded {
    let fits = factor.value.abs() + factor.error <= PRODUCT;
    Bounded { error: if fits { factor.error } else { f64::INFINITY }, ..factor }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_boxes_are_tight() {
        let around = |x: f64| Interval::new(x - 1e-4, x + 1e-4);
        let [value, partial, ..] = octave_bounds([around(0.3), around(1.7), around(-2.4)], 1);
        assert!(value.width() < 1e-3 && partial.width() < 1e-2, "{value:?} {partial:?}");
        let all = octave_bounds([Interval::EVERYTHING; 3], 1);
        assert_eq!(all[0], Interval::new(-LARGEST, LARGEST));
        assert_eq!(all[3], Interval::new(-STEEPEST, STEEPEST));
    }

    #[test]
    fn undecided_octaves() {
        let x = [0.5, 0.5, 0.5, 3.0, 2.0, 0.5];
        assert!(sum_errors(&x, &[0.0; 6], 0)[0] < 1e-5);
        assert!(sum_errors(&x, &[0.0, 0.0, 0.0, 1e-6, 0.0, 0.0], 0)[0].is_infinite());
    }
}
