//! Rows of noises that blend what the corners of a cell carry: Perlin noise of four coordinates, value
//! noise and simplex noise.
//!
//! Their bounds are suprema over all choices at the corners: at a fixed place and direction, value,
//! slope and second derivative are sums over the corners, so the unkindest choice is made corner by
//! corner; what is left was maximised over places and directions by Nelder-Mead from some hundred
//! starts. Those of value noise are exact: its slope by Parseval's identity for biased coins, since
//! `f'^2 / (f (1 - f))` of the fade weight `f` is largest in the middle, its bending `4 f'(1/2)^2`.

use super::super::math::{NUMBER, WHOLE};
use super::super::{Op, Operation, Ty, one, one_within, several, slope};
use super::smooth::Smooth;
use super::{PARTS, POINT, SPACE, WITH_GRADIENT, none};
use crate::reference::noise;

/// Operands of a noise of space and time.
const MOMENT: &[Ty] = &[Ty::Number; 4];
const WITH_GRADIENT4: &[Ty] = &[Ty::Number; 5];

/// Own errors: 6.5e-7 and, of a partial derivative, 2.1e-6 were seen over 3e6 points with every rounding
/// drawn at random.
const SPACE_TIME: Smooth = Smooth {
    dimensions: 4,
    gradient: |p, seed| several(&noise::perlin4_gradient([p[0], p[1], p[2], p[3]], seed)),
    largest: 1.536_582_334_1,
    steepest: 5.625,
    bending: 21.297,
    value_error: 1.1e-6,
    partial_error: 3.5e-6,
};

/// Own errors likewise: 6.1e-7, 1.6e-6.
const RANDOM_CORNERS: Smooth = Smooth {
    dimensions: 3,
    gradient: |p, seed| several(&noise::value_gradient([p[0], p[1], p[2]], seed)),
    largest: 1.0,
    steepest: 3.75,
    bending: 14.062_5,
    value_error: 1e-6,
    partial_error: 2.6e-6,
};

/// Own errors likewise: 1.4e-6, 8.3e-6.
const TETRAHEDRA: Smooth = Smooth {
    dimensions: 3,
    gradient: |p, seed| several(&noise::simplex_gradient([p[0], p[1], p[2]], seed)),
    largest: 1.0,
    steepest: 6.967,
    bending: 48.25,
    value_error: 2.2e-6,
    partial_error: 1.4e-5,
};

pub(in super::super) const PERLIN4: Operation = Operation {
    op: Op::Perlin4,
    name: "perlin4",
    args: MOMENT,
    results: NUMBER,
    has_data: true,
    meaning: |x, context| one(noise::perlin4([x[0], x[1], x[2], x[3]], context.data)),
    interval: |x, context| one_within(SPACE_TIME.bounds(x, context.data)[0]),
    error: |x, e, _, context| one(SPACE_TIME.errors(x, e, context.data)[0]),
    derivative: |graph, seed, x, _, d| {
        let parts = graph.apply_all(Op::Perlin4Gradient, seed, x);
        Some(vec![slope::along(graph, &parts[1..], d)])
    },
    range: |graph, _, _| Some(vec![SPACE_TIME.ranges(graph)[0]]),
    wgsl: "vol_perlin4(vec4f({0}, {1}, {2}, {3}), {d}u)",
    wgsl_extract: WHOLE,
    domain: &[SPACE; 4],
};

pub(in super::super) const PERLIN4_GRADIENT: Operation = Operation {
    op: Op::Perlin4Gradient,
    name: "perlin4_gradient",
    args: MOMENT,
    results: WITH_GRADIENT4,
    has_data: true,
    meaning: |x, context| (SPACE_TIME.gradient)(x, context.data),
    interval: |x, context| SPACE_TIME.bounds(x, context.data),
    error: |x, e, _, context| SPACE_TIME.errors(x, e, context.data),
    derivative: none,
    range: |graph, _, _| Some(SPACE_TIME.ranges(graph)),
    wgsl: "vol_perlin4_gradient(vec4f({0}, {1}, {2}, {3}), {d}u)",
    wgsl_extract: &[".value", ".gradient.x", ".gradient.y", ".gradient.z", ".gradient.w"],
    domain: &[SPACE; 4],
};

pub(in super::super) const VALUE: Operation = Operation {
    op: Op::Value,
    name: "value",
    args: POINT,
    results: NUMBER,
    has_data: true,
    meaning: |x, context| one(noise::value([x[0], x[1], x[2]], context.data)),
    interval: |x, context| one_within(RANDOM_CORNERS.bounds(x, context.data)[0]),
    error: |x, e, _, context| one(RANDOM_CORNERS.errors(x, e, context.data)[0]),
    derivative: |graph, seed, x, _, d| {
        let parts = graph.apply_all(Op::ValueGradient, seed, x);
        Some(vec![slope::along(graph, &parts[1..], d)])
    },
    range: |graph, _, _| Some(vec![RANDOM_CORNERS.ranges(graph)[0]]),
    wgsl: "vol_value(vec3f({0}, {1}, {2}), {d}u)",
    wgsl_extract: WHOLE,
    domain: &[SPACE; 3],
};

pub(in super::super) const VALUE_GRADIENT: Operation = Operation {
    op: Op::ValueGradient,
    name: "value_gradient",
    args: POINT,
    results: WITH_GRADIENT,
    has_data: true,
    meaning: |x, context| (RANDOM_CORNERS.gradient)(x, context.data),
    interval: |x, context| RANDOM_CORNERS.bounds(x, context.data),
    error: |x, e, _, context| RANDOM_CORNERS.errors(x, e, context.data),
    derivative: none,
    range: |graph, _, _| Some(RANDOM_CORNERS.ranges(graph)),
    wgsl: "vol_value_gradient(vec3f({0}, {1}, {2}), {d}u)",
    wgsl_extract: PARTS,
    domain: &[SPACE; 3],
};

pub(in super::super) const SIMPLEX: Operation = Operation {
    op: Op::Simplex,
    name: "simplex",
    args: POINT,
    results: NUMBER,
    has_data: true,
    meaning: |x, context| one(noise::simplex([x[0], x[1], x[2]], context.data)),
    interval: |x, context| one_within(TETRAHEDRA.bounds(x, context.data)[0]),
    error: |x, e, _, context| one(TETRAHEDRA.errors(x, e, context.data)[0]),
    derivative: |graph, seed, x, _, d| {
        let parts = graph.apply_all(Op::SimplexGradient, seed, x);
        Some(vec![slope::along(graph, &parts[1..], d)])
    },
    range: |graph, _, _| Some(vec![TETRAHEDRA.ranges(graph)[0]]),
    wgsl: "vol_simplex(vec3f({0}, {1}, {2}), {d}u)",
    wgsl_extract: WHOLE,
    domain: &[SPACE; 3],
};

pub(in super::super) const SIMPLEX_GRADIENT: Operation = Operation {
    op: Op::SimplexGradient,
    name: "simplex_gradient",
    args: POINT,
    results: WITH_GRADIENT,
    has_data: true,
    meaning: |x, context| (TETRAHEDRA.gradient)(x, context.data),
    interval: |x, context| TETRAHEDRA.bounds(x, context.data),
    error: |x, e, _, context| TETRAHEDRA.errors(x, e, context.data),
    derivative: none,
    range: |graph, _, _| Some(TETRAHEDRA.ranges(graph)),
    wgsl: "vol_simplex_gradient(vec3f({0}, {1}, {2}), {d}u)",
    wgsl_extract: PARTS,
    domain: &[SPACE; 3],
};

#[cfg(test)]
mod tests {
    use super::super::smooth::tests::assert_bounds_hold;
    use super::*;

    #[test]
    fn bounds_of_perlin4_cannot_be_broken() {
        assert_bounds_hold(&SPACE_TIME, 4, [0.5, 0.5, 0.5]);
    }

    #[test]
    fn bounds_of_value_cannot_be_broken() {
        assert_bounds_hold(&RANDOM_CORNERS, 3, [0.8, 0.8, 0.8]);
    }

    #[test]
    fn bounds_of_simplex_cannot_be_broken() {
        assert_bounds_hold(&TETRAHEDRA, 3, [0.8, 0.8, 0.8]);
    }
}
