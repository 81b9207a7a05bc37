//! Rows of the noises: improved Perlin noise and its sums here, the others in rooms of their own.
//!
//! | room | noises |
//! |---|---|
//! | [`ranges`] | ranges as values of a graph |
//! | [`smooth`] | what all with continuous derivatives have in common: intervals and errors |
//! | [`lattice`] | Perlin noise of four coordinates, value noise, simplex noise |
//! | [`cells`] | distance to strewn points, random numbers of cells |
//!
//! Bounds hold for every seed (`algorithms.md` §4.1): those of the unkindest choice of gradients or
//! numbers at the corners of a cell.

mod cells;
mod lattice;
mod ranges;
mod smooth;

use super::error::{self, operand};
use super::interval::Interval;
use super::math::{NUMBER, WHOLE};
use super::{Op, Operation, Results, Ty, one, one_within, several, several_within, slope};
use crate::error_bound::Bounded;
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::reference::noise;
use smooth::Smooth;

pub(super) use cells::{HASH, WORLEY, WORLEY_GRADIENT};
pub(super) use lattice::{PERLIN4, PERLIN4_GRADIENT, SIMPLEX, SIMPLEX_GRADIENT, VALUE, VALUE_GRADIENT};

/// Improved Perlin noise. Own errors: 6.2e-7 and, of a partial derivative, 1.9e-6 were seen over 3e6
/// points with every rounding drawn at random.
const OCTAVE: Smooth = Smooth {
    dimensions: 3,
    gradient: |p, seed| several(&noise::perlin_gradient([p[0], p[1], p[2]], seed)),
    largest: 1.036_353_811_3,
    steepest: 3.75,
    bending: 14.466,
    value_error: 1e-6,
    partial_error: 3e-6,
};

/// The position is held within ± this.
const FIELD: f64 = 4_194_303.0;
/// Most octaves of a sum.
pub(crate) const OCTAVES: f64 = 32.0;
/// Factors of amplitude and frequency are held within ± this in f32, but not in the meaning.
const PRODUCT: f64 = 1_099_511_627_776.0;

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
    interval: |x, context| one_within(OCTAVE.bounds(x, context.data)[0]),
    error: |x, e, _, context| one(OCTAVE.errors(x, e, context.data)[0]),
    derivative: |graph, seed, x, _, d| {
        let parts = graph.apply_all(Op::PerlinGradient, seed, x);
        Some(vec![slope::along(graph, &parts[1..], d)])
    },
    range: |graph, _, _| Some(vec![OCTAVE.ranges(graph)[0]]),
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
    interval: |x, context| OCTAVE.bounds(x, context.data),
    error: |x, e, _, context| OCTAVE.errors(x, e, context.data),
    derivative: none,
    range: |graph, _, _| Some(OCTAVE.ranges(graph)),
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
    range: |graph, _, x| Some(vec![ranges::octaves(graph, &OCTAVE, x)?[0]]),
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
    range: |graph, _, x| ranges::octaves(graph, &OCTAVE, x),
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

/// Bounds of a sum of octaves and its gradient: of all numbers of octaves that are possible.
fn sum_bounds(x: &[Interval], seed: u32) -> [Interval; 4] {
    let (least, most) = (octave_count(x[3].lo), octave_count(x[3].hi));
    let (lacunarity, gain) = (x[4], x[5]);
    let mut amplitude = Interval::point(1.0);
    let mut frequency = Interval::point(1.0);
    let mut sum = [Interval::point(0.0); 4];
    let mut found = sum;
    for count in 1..=most {
        let octave = OCTAVE.bounds(&[x[0] * frequency, x[1] * frequency, x[2] * frequency], seed);
        for (i, part) in octave.into_iter().take(4).enumerate() {
            let factor = if i == 0 { amplitude } else { amplitude * frequency };
            sum[i] = sum[i] + factor * part;
            found[i] = if count <= least { sum[i] } else { found[i].hull(sum[i]) };
        }
        amplitude = amplitude * gain;
        frequency = frequency * lacunarity;
    }
    found
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
        let n = OCTAVE.evaluate(&q, seed);
        let steepness = error::mul(amplitude, frequency);
        for (i, part) in n.into_iter().take(4).enumerate() {
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
        let [value, partial, ..] = OCTAVE.bounds(&[around(0.3), around(1.7), around(-2.4)], 1);
        assert!(value.width() < 1e-3 && partial.width() < 1e-2, "{value:?} {partial:?}");
        let all = OCTAVE.bounds(&[Interval::EVERYTHING; 3], 1);
        assert_eq!(all[0], Interval::new(-OCTAVE.largest, OCTAVE.largest));
        assert_eq!(all[3], Interval::new(-OCTAVE.steepest, OCTAVE.steepest));
    }

    #[test]
    fn bounds_cannot_be_broken() {
        smooth::tests::assert_bounds_hold(&OCTAVE, 3, [0.8, 0.8, 0.8]);
    }

    #[test]
    fn undecided_octaves() {
        let x = [0.5, 0.5, 0.5, 3.0, 2.0, 0.5];
        assert!(sum_errors(&x, &[0.0; 6], 0)[0] < 1e-5);
        assert!(sum_errors(&x, &[0.0, 0.0, 0.0, 1e-6, 0.0, 0.0], 0)[0].is_infinite());
    }
}
