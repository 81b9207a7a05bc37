//! The Mandelbulb: the points `p` that `z <- z^n + p` keeps near, with the power of a vector that
//! multiplies its two angles.
//!
//! In: power, number of iterations, level of detail. Out: one loop of the IR that follows `z` until it
//! leaves, with two derivatives beside it, and from its last state a distance:
//!
//! ```text
//! estimate = r (ln r - n^(k - N) ln R) / (2 dr)      z left at iteration k of N, r = |z|
//!          = (r - R) / (2 dr (k + 1))                it did not leave: inside
//! distance = (estimate - detail) dr / steepest      no more than the distance to a cut
//! ```
//!
//! The first is half the potential over its slope, less the potential at which `|z|` is the escape radius
//! `R = 2^(1/(n-1))` after the last iteration, so that few iterations give the smooth level `|z| = R` and many
//! the set itself. The solid is where the estimate is below `detail`: a level in front of the set, where `z`
//! still leaves and the estimate has a slope, and not the set, whose inside has none that f32 could hold.
//!
//! `dr <- n r^(n-1) dr + 1` is the usual derivative. It counts as if the power stretched all directions alike,
//! but around the poles it stretches by `|sin n theta / sin theta|` up to `n` times more, which `df` counts; and
//! where `z` comes near 0 the derivative is small and that of the points about it is not, so `steepest` is the
//! largest `df` on the way; inside, where all derivatives may stay small, also the number of iterations counts.
//! By `dr` alone the distance would reach up to 4 times too far. The ratio of the two
//! scales the distance and does not move the surface.
//!
//! Method: Hart, Sandin, Kauffman 1989; White and Nylander's power; `algorithms.md` §7.1. Iterations end where a
//! derivative is so large that the estimate is far below the detail, so nothing overflows however many are
//! asked for.

use super::primitives::clamped;
use crate::ir::ValueId;
use crate::ir::graph::{Graph, Repeated};
use crate::lower::{Lowered, Lowerer};
use crate::ops::Op;
use std::f64::consts::LN_2;
use vol_language::source::Span;

/// Least and largest power: below, the set has no bound; above, `r^n` would leave f32.
const POWERS: [f64; 2] = [2.0, 32.0];

/// Least level of detail: f32 holds positions of size 1 to 6e-8.
const LEAST_DETAIL: f64 = 1e-6;

/// With the derivative at this over the detail the estimate is a small part of the detail.
const FINEST: f64 = 64.0;

/// As [`FINEST`] for the derivative in the steepest direction, which the estimate does not see.
const FINEST_ANY: f64 = 4096.0;

/// `|z|^n` where the iteration ends, as a power of 2: there one more would change the estimate by 1 / 256.
const BAIL_BITS: f64 = 8.0;

/// Divides where a length may be 0: the quotient is then 0.
const TINY: f64 = 1e-18;

/// Nearer to the poles than this sine the stretch is taken as that at the upper one, `n`.
const POLAR: f64 = 2e-3;

/// A Mandelbulb at the origin, its axis z; the usual one of power 8 has a radius of about 1.2.
///
/// A bound inside and outside, not 1-Lipschitz. The solid is within its box for every power.
#[derive(Debug)]
pub(crate) struct Mandelbulb {
    /// Of `z`, 2 to 32; not whole: cut along y = 0, x < 0.
    power: ValueId,
    /// Most iterations, and the bound on them that the loop needs.
    iterations: ValueId,
    most: u32,
    /// Where the surface is in front of the set, in the units of the set.
    detail: ValueId,
}

/// Sizes that follow from the power and the detail.
struct Sizes {
    power: ValueId,
    detail: ValueId,
    /// What `|z|` exceeds only if it leaves.
    escape: ValueId,
    /// Radius of a ball that holds the solid.
    reach: ValueId,
}

/// The numbers that the loop carries.
struct State {
    z: [ValueId; 3],
    /// Derivative of `|z|`, as if the power were conformal.
    slope: ValueId,
    /// Bound on the derivative in any direction, and the largest one so far.
    any: ValueId,
    steepest: ValueId,
    /// Iterations so far.
    count: ValueId,
    /// Distance to a cut, of a power that is not whole.
    cut: Option<ValueId>,
}

/// `z` to a power, and by how much more than `n r^(n-1)` it stretches across the axis.
struct Power {
    z: [ValueId; 3],
    /// `n r^(n-1)`
    slope: ValueId,
    stretch: ValueId,
    /// From `z` to the place where the angles jump.
    cut: Option<ValueId>,
}

impl Mandelbulb {
    /// From the arguments of the call, in their order.
    pub(crate) fn new(lowerer: &mut Lowerer<'_>, args: [ValueId; 3], span: Span) -> Lowered<Self> {
        let [power, iterations, detail] = args;
        let places = [0, 1, 2].map(|i| lowerer.argument_span(i, span));
        let outside = |x: f64| !(POWERS[0]..=POWERS[1]).contains(&x);
        lowerer.refuse(&[power], outside, "the power of a Mandelbulb must be from 2 to 32", places[0])?;
        let coarse = |x: f64| x < LEAST_DETAIL;
        lowerer.refuse(&[detail], coarse, "the detail of a Mandelbulb must be at least 1e-6", places[2])?;
        // Slots refuse what depends on the position.
        lowerer.slot(iterations, "the number of iterations", places[1])?;
        let most = lowerer.most_steps(iterations, places[1])?;
        Ok(Self { power, iterations, most, detail })
    }

    /// Half extents of its box.
    pub(super) fn half(&self, graph: &mut Graph) -> [ValueId; 3] {
        [self.sizes(graph).reach; 3]
    }

    fn sizes(&self, graph: &mut Graph) -> Sizes {
        let [least, most] = POWERS.map(|power| graph.number(power));
        let (one, four, finest) = (graph.number(1.0), graph.number(4.0), graph.number(LEAST_DETAIL));
        let power = clamped(graph, self.power, least, most);
        let detail = graph.max(self.detail, finest);
        // |z|^n - |p| > |z| as soon as |z| is beyond this and |p|.
        let less = graph.sub(power, one);
        let root = graph.div(one, less);
        let escape = graph.apply(Op::Exp2, &[root]);
        let margin = graph.mul(four, detail);
        let reach = graph.add(escape, margin);
        Sizes { power, detail, escape, reach }
    }

    /// The estimate at the nearest point of the ball around it, or the distance to the ball if larger.
    pub(super) fn distance(&self, graph: &mut Graph, p: [ValueId; 3]) -> ValueId {
        let sizes = self.sizes(graph);
        let far = graph.length(&p);
        let beyond = graph.sub(far, sizes.reach);
        let held = graph.max(far, sizes.reach);
        let shrink = graph.div(sizes.reach, held);
        let p = p.map(|x| graph.mul(x, shrink));
        let last = self.iterate(graph, &sizes, p);
        let near = self.level(graph, &sizes, &last);
        graph.max(beyond, near)
    }

    /// The state in which the iteration ends.
    fn iterate(&self, graph: &mut Graph, sizes: &Sizes, p: [ValueId; 3]) -> State {
        let (zero, one) = (graph.number(0.0), graph.number(1.0));
        let whole = self.whole(graph);
        let cuts = whole.is_none();
        let mut first = vec![p[0], p[1], p[2], one, one, one, zero];
        first.extend(cuts.then(|| graph.number(1.0 / TINY)));
        let state: Vec<ValueId> = first.iter().map(|_| graph.placeholder()).collect();
        let at = State::of(&state);
        let goes_on = self.goes_on(graph, sizes, &at);
        // Follow z, its derivative and the bound on it.
        let power = match whole {
            Some(n) => whole_power(graph, n, at.z),
            None => real_power(graph, sizes.power, at.z),
        };
        let mut next: Vec<ValueId> = power.z.iter().zip(p).map(|(&z, p)| graph.add(z, p)).collect();
        let grown = graph.mul(power.slope, at.slope);
        next.push(graph.add(grown, one));
        let factor = graph.mul(power.slope, power.stretch);
        let grown = graph.mul(factor, at.any);
        let any = graph.add(grown, one);
        next.push(any);
        next.push(graph.max(at.steepest, any));
        next.push(graph.add(at.count, one));
        if let (Some(cut), Some(before)) = (power.cut, at.cut) {
            let here = graph.div(cut, at.steepest);
            next.push(graph.min(before, here));
        }
        let repeated = Repeated { state: &state, first: &first, next: &next, goes_on };
        State::of(&graph.repeat(self.most, repeated))
    }

    /// The power if it is a constant whole number.
    fn whole(&self, graph: &Graph) -> Option<u32> {
        graph.constant(self.power).filter(|power| power.fract() == 0.0).map(|power| power as u32)
    }

    /// Whether `z` has neither left nor been followed far enough.
    fn goes_on(&self, graph: &mut Graph, sizes: &Sizes, at: &State) -> ValueId {
        let bits = graph.number(2.0 * BAIL_BITS);
        let squared = graph.dot(&at.z, &at.z);
        let bits = graph.div(bits, sizes.power);
        let bail = graph.apply(Op::Exp2, &[bits]);
        let stays = graph.apply(Op::Less, &[squared, bail]);
        let mut coarse = |derivative: ValueId, finest: f64| {
            let finest = graph.number(finest);
            let most = graph.div(finest, sizes.detail);
            graph.apply(Op::Less, &[derivative, most])
        };
        let coarse = [coarse(at.slope, FINEST), coarse(at.any, FINEST_ANY)];
        let coarse = graph.apply(Op::And, &coarse);
        let goes_on = graph.apply(Op::And, &[stays, coarse]);
        if graph.constant(self.iterations).is_some() {
            return goes_on;
        }
        let half = graph.number(0.5);
        let end = graph.sub(self.iterations, half);
        let counts = graph.apply(Op::Less, &[at.count, end]);
        graph.apply(Op::And, &[counts, goes_on])
    }

    /// The distance that the last state tells.
    fn level(&self, graph: &mut Graph, sizes: &Sizes, last: &State) -> ValueId {
        let (zero, one) = (graph.number(0.0), graph.number(1.0));
        let (half, ln_2) = (graph.number(0.5), graph.number(LN_2));
        let r = graph.length(&last.z);
        // ln r less the logarithm of the escape radius after the last iteration, n^(k - N) times smaller here.
        let left = match graph.constant(self.iterations) {
            Some(_) => graph.number(f64::from(self.most)),
            None => self.iterations,
        };
        let left = graph.sub(last.count, left);
        let bits = graph.apply(Op::Log2, &[sizes.power]);
        let part = graph.mul(left, bits);
        let part = graph.apply(Op::Exp2, &[part]);
        let limit = graph.apply(Op::Log2, &[sizes.escape]);
        let limit = graph.mul(part, limit);
        let potential = graph.apply(Op::Log2, &[r]);
        let potential = graph.sub(potential, limit);
        let potential = graph.mul(potential, ln_2);
        let outside = graph.mul(r, potential);
        let inside = graph.sub(r, sizes.escape);
        let stays = graph.apply(Op::Less, &[inside, zero]);
        let passed = graph.add(last.count, one);
        let inside = graph.div(inside, passed);
        let off = graph.select(stays, inside, outside);
        let off = graph.mul(half, off);
        let estimate = graph.div(off, last.slope);
        let level = graph.sub(estimate, sizes.detail);
        let safe = graph.div(last.slope, last.steepest);
        let distance = graph.mul(level, safe);
        // What is beyond a cut is not seen by the estimate.
        let Some(cut) = last.cut else { return distance };
        let low = graph.apply(Op::Neg, &[cut]);
        clamped(graph, distance, low, cut)
    }
}

impl State {
    fn of(numbers: &[ValueId]) -> Self {
        Self {
            z: [numbers[0], numbers[1], numbers[2]],
            slope: numbers[3],
            any: numbers[4],
            steepest: numbers[5],
            count: numbers[6],
            cut: numbers.get(7).copied(),
        }
    }
}

/// Without trigonometry: multiples of the angles by products of their cosines and sines.
fn whole_power(graph: &mut Graph, n: u32, z: [ValueId; 3]) -> Power {
    let one = graph.number(1.0);
    let (rho, r) = (graph.length(&[z[0], z[1]]), graph.length(&z));
    let across = fraction(graph, &z[..2], rho);
    let [up, out] = fraction(graph, &[z[2], rho], r)[..] else { unreachable!("two in, two out") };
    // sin n theta over sin theta, which is never divided by.
    let squared = graph.mul(out, out);
    let (cosine, stretch) = multiple(graph, n, (up, one), squared);
    let turn = multiple(graph, n, (across[0], across[1]), one);
    let slope = crate::library::math::whole_power(graph, r, n - 1);
    let size = graph.mul(slope, r);
    let times = graph.number(f64::from(n));
    let sine = graph.mul(stretch, out);
    let stretch = graph.apply(Op::Abs, &[stretch]);
    let stretch = graph.max(stretch, one);
    let slope = graph.mul(times, slope);
    Power { z: spherical(graph, size, (cosine, sine), turn), slope, stretch, cut: None }
}

/// By the angles themselves.
fn real_power(graph: &mut Graph, n: ValueId, z: [ValueId; 3]) -> Power {
    let (zero, one, tiny) = (graph.number(0.0), graph.number(1.0), graph.number(TINY));
    let (rho, r) = (graph.length(&[z[0], z[1]]), graph.length(&z));
    let multiple = |graph: &mut Graph, y: ValueId, x: ValueId| {
        let angle = graph.apply(Op::Atan2, &[y, x]);
        let angle = graph.mul(n, angle);
        (graph.apply(Op::Cos, &[angle]), graph.apply(Op::Sin, &[angle]))
    };
    let tilt = multiple(graph, rho, z[2]);
    let turn = multiple(graph, z[1], z[0]);
    let bits = graph.apply(Op::Log2, &[r]);
    let less = graph.sub(n, one);
    let bits = graph.mul(less, bits);
    let slope = graph.apply(Op::Exp2, &[bits]);
    let size = graph.mul(slope, r);
    let slope = graph.mul(n, slope);
    // |sin n theta / sin theta|; at the lower pole it has no bound, which is a cut.
    let polar = graph.number(POLAR);
    let safe = graph.max(r, tiny);
    let out = graph.div(rho, safe);
    let sine = graph.apply(Op::Abs, &[tilt.1]);
    let held = graph.max(out, polar);
    let ratio = graph.div(sine, held);
    let near = graph.apply(Op::Less, &[out, polar]);
    let least = graph.select(near, n, one);
    let stretch = graph.max(ratio, least);
    // The angle about the axis jumps behind it.
    let behind = graph.apply(Op::Less, &[z[0], zero]);
    let beside = graph.apply(Op::Abs, &[z[1]]);
    let cut = graph.select(behind, beside, rho);
    Power { z: spherical(graph, size, tilt, turn), slope, stretch, cut: Some(cut) }
}

/// Components of a vector over its length; 0 for the zero vector.
fn fraction(graph: &mut Graph, components: &[ValueId], length: ValueId) -> Vec<ValueId> {
    let tiny = graph.number(TINY);
    let safe = graph.max(length, tiny);
    components.iter().map(|&component| graph.div(component, safe)).collect()
}

/// `(cos n a, u_n)` from `(cos a, u_1)`, where `sin k a = s u_k` and `square` is s^2, by repeated squaring.
fn multiple(graph: &mut Graph, mut n: u32, angle: (ValueId, ValueId), square: ValueId) -> (ValueId, ValueId) {
    let product = |graph: &mut Graph, a: (ValueId, ValueId), b: (ValueId, ValueId)| {
        let sines = graph.mul(a.1, b.1);
        let sines = graph.mul(sines, square);
        let cosines = graph.mul(a.0, b.0);
        let (mixed, other) = (graph.mul(a.1, b.0), graph.mul(a.0, b.1));
        (graph.sub(cosines, sines), graph.add(mixed, other))
    };
    let mut power = (graph.number(1.0), graph.number(0.0));
    let mut doubled = angle;
    while n > 0 {
        if n & 1 == 1 {
            power = product(graph, power, doubled);
        }
        n >>= 1;
        if n > 0 {
            doubled = product(graph, doubled, doubled);
        }
    }
    power
}

/// The point at a distance, from (cosine, sine) of its angles from z and from x about z.
fn spherical(
    graph: &mut Graph,
    size: ValueId,
    tilt: (ValueId, ValueId),
    turn: (ValueId, ValueId),
) -> [ValueId; 3] {
    let out = graph.mul(size, tilt.1);
    [graph.mul(out, turn.0), graph.mul(out, turn.1), graph.mul(size, tilt.0)]
}
