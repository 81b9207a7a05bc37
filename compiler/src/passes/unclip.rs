//! What a density is where it is cut off at 0: the same value, going on below.
//!
//! `8 * max(0, fbm) * falloff` has a kink wherever the noise changes its sign. An integral by a few
//! samples finds the kink between two of them from the signs and sizes of what is under the `max`:
//!
//! ```text
//! %2 = max 0 %1                %1
//! %3 = mul 8 %2        ──►     %5 = mul 8 %1
//! %4 = mul %3 %9               %6 = the product of %5 and %9, negative if either is
//! ```
//!
//! Exact: the positive part of the result is that of the value, bit for bit but for the order of products.

use crate::ir::graph::{Graph, Rate};
use crate::ir::{Inst, ValueId};
use crate::ops::Op;
use std::collections::HashMap;

/// Operations followed from the result down: more than an author nests, few enough for the stack.
const MOST_LEVELS: u32 = 64;

/// A value with the same positive part as `value`, negative where `value` is 0 because it was cut off
/// there, as far as products, quotients, choices, least and largest values show it; else `value` itself.
pub(crate) fn unclipped(graph: &mut Graph, value: ValueId) -> ValueId {
    follow(graph, value, MOST_LEVELS, &mut HashMap::new()).signed
}

/// What is known of a value.
#[derive(Clone, Copy)]
struct Found {
    /// Has the same positive part.
    signed: ValueId,
    /// Whether the value itself is never negative.
    is_clipped: bool,
}

/// What is known of values that were followed.
type Known = HashMap<ValueId, Found>;

fn follow(graph: &mut Graph, value: ValueId, levels: u32, known: &mut Known) -> Found {
    if let Some(&found) = known.get(&value) {
        return found;
    }
    let found = look(graph, value, levels, known);
    known.insert(value, found);
    found
}

fn look(graph: &mut Graph, value: ValueId, levels: u32, known: &mut Known) -> Found {
    let as_it_is = |is_clipped| Found { signed: value, is_clipped };
    if let Some(number) = graph.constant(value) {
        return as_it_is(number >= 0.0);
    }
    let Inst::Apply { op, args, .. } = graph.inst(value).clone() else { return as_it_is(false) };
    if levels == 0 {
        return as_it_is(false);
    }
    let mut below = |graph: &mut Graph, index: usize| follow(graph, args[index], levels - 1, known);
    let found = match op {
        Op::Max => {
            let (a, b) = (below(graph, 0), below(graph, 1));
            let is_clipped = a.is_clipped | b.is_clipped;
            let zero = |found: Found| graph.constant(found.signed) == Some(0.0);
            let signed = match (zero(a), zero(b)) {
                (true, _) => b.signed,
                (_, true) => a.signed,
                _ => graph.max(a.signed, b.signed),
            };
            Found { signed, is_clipped }
        }
        Op::Min => {
            let (a, b) = (below(graph, 0), below(graph, 1));
            Found { signed: graph.min(a.signed, b.signed), is_clipped: a.is_clipped & b.is_clipped }
        }
        Op::Mul => {
            let factors = [below(graph, 0), below(graph, 1)];
            product(graph, value, [args[0], args[1]], factors)
        }
        Op::Div => {
            let (a, b) = (below(graph, 0), below(graph, 1));
            let is_clipped = a.is_clipped & b.is_clipped;
            Found { signed: if is_clipped { graph.div(a.signed, args[1]) } else { value }, is_clipped }
        }
        Op::Select => {
            let (a, b) = (below(graph, 1), below(graph, 2));
            let is_clipped = a.is_clipped & b.is_clipped;
            Found { signed: graph.select(args[0], a.signed, b.signed), is_clipped }
        }
        Op::Add => as_it_is(below(graph, 0).is_clipped && below(graph, 1).is_clipped),
        Op::Abs | Op::Sqrt | Op::Exp2 => as_it_is(true),
        _ => as_it_is(false),
    };
    // What is the same for the whole frame has no kink.
    if graph.rate(value) == Rate::Point { found } else { as_it_is(found.is_clipped) }
}

/// A product of which one factor at least was cut off: negative where either factor is.
fn product(graph: &mut Graph, value: ValueId, args: [ValueId; 2], [a, b]: [Found; 2]) -> Found {
    let is_clipped = (a.is_clipped & b.is_clipped) | (args[0] == args[1]);
    // The sign of a product of two that go below 0 says nothing.
    if args[0] == args[1] || !(a.is_clipped | b.is_clipped) {
        return Found { signed: value, is_clipped };
    }
    let goes_below = |found: Found, arg: ValueId| !found.is_clipped || found.signed != arg;
    let signed = if goes_below(a, args[0]) && goes_below(b, args[1]) {
        // min(a, 0) |b| + max(a, 0) b
        let zero = graph.number(0.0);
        let (below, above) = (graph.min(a.signed, zero), graph.max(a.signed, zero));
        let size = graph.apply(Op::Abs, &[b.signed]);
        let (negative, positive) = (graph.mul(below, size), graph.mul(above, b.signed));
        graph.add(negative, positive)
    } else {
        graph.mul(a.signed, b.signed)
    };
    Found { signed, is_clipped }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::graph::Slots;
    use crate::ir::verify::random::Random;
    use crate::reference;

    /// Values at a place of the result of `unclipped` and of what it was given.
    fn both(graph: &mut Graph, value: ValueId) -> impl Fn(&[f64]) -> [f64; 2] + use<> {
        let signed = unclipped(graph, value);
        let function = Slots::default().point_function(graph, "test", 3, &[signed, value]);
        move |inputs| {
            let values = reference::evaluate(&function, inputs, &[], &[]);
            [values[0], values[1]]
        }
    }

    #[test]
    fn scaled_and_faded_noise_goes_on_below_zero() {
        let mut graph = Graph::default();
        let [x, y, _] = [0, 1, 2].map(|index| graph.input(index));
        let (zero, eight, one) = (graph.number(0.0), graph.number(8.0), graph.number(1.0));
        let clipped = graph.max(zero, x);
        let scaled = graph.mul(eight, clipped);
        let fade = graph.sub(one, y);
        let density = graph.mul(scaled, fade);
        let at = both(&mut graph, density);
        assert_eq!(at(&[0.5, 0.25, 0.0]), [3.0, 3.0]);
        assert_eq!(at(&[-0.5, 0.25, 0.0]), [-3.0, 0.0]);
        assert_eq!(at(&[0.5, 2.0, 0.0])[0], -4.0);
        assert_eq!(at(&[-0.5, 2.0, 0.0])[0], -4.0);
    }

    #[test]
    fn what_was_not_cut_off_is_left_alone() {
        let mut graph = Graph::default();
        let [x, y, _] = [0, 1, 2].map(|index| graph.input(index));
        let product = graph.mul(x, y);
        assert_eq!(unclipped(&mut graph, product), product);
        let squared = graph.mul(x, x);
        assert_eq!(unclipped(&mut graph, squared), squared);
    }

    /// A random expression of the operations that are followed.
    fn expression(graph: &mut Graph, random: &mut Random, levels: u32) -> ValueId {
        if levels == 0 || random.below(5) == 0 {
            return match random.below(6) {
                0 => graph.number(0.0),
                1 => graph.number(random.between(-2.0, 2.0)),
                axis => graph.input(axis as u32 % 3),
            };
        }
        let [a, b] = [(); 2].map(|()| expression(graph, random, levels - 1));
        let zero = graph.number(0.0);
        match random.below(9) {
            0 | 1 => graph.max(zero, a),
            2 => graph.max(a, b),
            3 => graph.min(a, b),
            // 0 / 0 has no positive part to compare.
            4 => {
                let (size, half) = (graph.apply(Op::Abs, &[b]), graph.number(0.5));
                let divisor = graph.add(size, half);
                graph.div(a, divisor)
            }
            5 => {
                let less = graph.apply(Op::Less, &[a, zero]);
                graph.select(less, b, a)
            }
            6 => graph.add(a, b),
            _ => graph.mul(a, b),
        }
    }

    #[test]
    fn positive_parts_are_the_same() {
        let mut random = Random::new(7);
        let mut changed = 0;
        for _ in 0..2000 {
            let mut graph = Graph::default();
            let value = expression(&mut graph, &mut random, 6);
            changed += usize::from(unclipped(&mut graph, value) != value);
            let at = both(&mut graph, value);
            for _ in 0..20 {
                let [signed, plain] = at(&[(); 3].map(|()| random.between(-2.0, 2.0)));
                if signed.is_finite() && plain.is_finite() {
                    let apart = (signed.max(0.0) - plain.max(0.0)).abs();
                    assert!(apart <= 1e-12 * plain.abs(), "{signed} {plain}");
                }
            }
        }
        assert!(changed > 500, "{changed}");
    }

    #[test]
    fn depth_is_bounded() {
        let mut graph = Graph::default();
        let mut value = graph.input(0);
        let two = graph.number(2.0);
        for _ in 0..100_000 {
            value = graph.mul(value, two);
        }
        unclipped(&mut graph, value);
    }
}
