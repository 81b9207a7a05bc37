//! Derivatives: from a value of a graph to its slopes along the inputs.
//!
//! ```text
//! %0 = input 0
//! %1 = sin %0        ──►   %2 = cos %0   (the slope of %1 along input 0)
//! ```
//!
//! Forward mode: every value that the result needs gets one derivative per direction, in the order of
//! the graph, by the derivative rules of the operation table; equal ones are one value. Values that do
//! not vary with the position have the derivative 0 and cost nothing. Exact where the value is smooth,
//! one of the one-sided derivatives at kinks.

mod repeat;

use crate::ir::graph::{Graph, Rate};
use crate::ir::{Inst, ValueId};
use crate::ops::{self, Op, Ty};
use repeat::Repeat;
use rustc_hash::FxHashMap;
use std::collections::HashSet;

/// Derivatives of a value that varies, by direction and result; `None` if an operation on the way has
/// no rule.
type Slopes = Option<Vec<Vec<ValueId>>>;

/// Derivatives of a number with respect to the given inputs, one value each.
///
/// * `value`: of type [`Ty::Number`]
/// * returns: `None` if the value depends on an input through an operation without a derivative rule
///   (the stretch about a curve, the factors of a sum of octaves)
pub fn gradient(graph: &mut Graph, value: ValueId, inputs: &[u32]) -> Option<Vec<ValueId>> {
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    let mut known: FxHashMap<ValueId, Slopes> = FxHashMap::default();
    for node in varying(graph, &[value], &known) {
        if let Inst::Input(index) = graph.inst(node) {
            let slopes = inputs.iter().map(|i| vec![if i == index { one } else { zero }]);
            known.insert(node, Some(slopes.collect()));
        }
    }
    differentiate(graph, &[value], &mut known, inputs.len());
    (0..inputs.len()).map(|direction| slope(&known, value, direction, zero)).collect()
}

/// The derivative of a single number; 0 for what does not vary at all.
fn slope(
    known: &FxHashMap<ValueId, Slopes>,
    value: ValueId,
    direction: usize,
    zero: ValueId,
) -> Option<ValueId> {
    match known.get(&value) {
        None => Some(zero),
        Some(slopes) => slopes.as_ref().map(|slopes| slopes[direction][0]),
    }
}

/// Adds the derivatives of all that `values` need; those of inputs are known.
fn differentiate(
    graph: &mut Graph,
    values: &[ValueId],
    known: &mut FxHashMap<ValueId, Slopes>,
    directions: usize,
) {
    let zero = graph.number(0.0);
    let outer = graph.set_place(None);
    for node in varying(graph, values, known) {
        // A slope belongs to what it is the slope of.
        graph.set_place(graph.place(node).or(outer));
        let slopes = match graph.inst(node).clone() {
            Inst::Constant(_) | Inst::Boolean(_) | Inst::Uniform(_) | Inst::Input(_) => continue,
            Inst::Extract(tuple, index) => {
                let part = |slopes: &Vec<ValueId>| slopes.get(index as usize).map(|&slope| vec![slope]);
                known[&tuple].as_ref().and_then(|slopes| slopes.iter().map(part).collect())
            }
            Inst::Apply { op, data, args } => {
                let step = Step { node, op, data, args, zero };
                step.slopes(graph, known, directions)
            }
            Inst::Loop { most, body, args } => {
                let repeat = Repeat { most, body: &body, args: &args, zero };
                repeat.slopes(graph, known, directions)
            }
        };
        known.insert(node, slopes);
    }
    graph.set_place(outer);
}

/// What `values` need, varies with the position and is not known, operands first.
pub(super) fn varying<T>(graph: &Graph, values: &[ValueId], known: &FxHashMap<ValueId, T>) -> Vec<ValueId> {
    let mut found = HashSet::new();
    let mut pending = values.to_vec();
    while let Some(node) = pending.pop() {
        if graph.rate(node) == Rate::Point && !known.contains_key(&node) && found.insert(node) {
            pending.extend_from_slice(graph.inst(node).operands());
        }
    }
    let mut order: Vec<ValueId> = found.into_iter().collect();
    order.sort_unstable();
    order
}

/// One operation on the way.
struct Step {
    node: ValueId,
    op: Op,
    data: u32,
    args: Vec<ValueId>,
    zero: ValueId,
}

impl Step {
    fn slopes(&self, graph: &mut Graph, known: &FxHashMap<ValueId, Slopes>, directions: usize) -> Slopes {
        let row = ops::operation(self.op);
        // What only jumps has the derivative 0, whatever its operands do.
        let jumps = self.op == Op::Floor || row.results == [Ty::Bool];
        if jumps {
            return Some(vec![vec![self.zero]; directions]);
        }
        let along = |direction: usize| {
            let slopes = self.args.iter().map(|&arg| slope(known, arg, direction, self.zero));
            let slopes: Vec<ValueId> = slopes.collect::<Option<_>>()?;
            if slopes.iter().all(|&slope| slope == self.zero) {
                return Some(vec![self.zero; row.results.len()]);
            }
            (row.derivative)(graph, self.data, &self.args, self.node, &slopes)
        };
        (0..directions).map(along).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::Number;
    use crate::ir::graph::Slots;
    use crate::ir::verify::random::{self, Random};
    use crate::reference;

    /// Some graph values as a function of a point; inputs of the frame function are 0.3.
    fn cut(graph: &mut Graph, values: &[ValueId]) -> impl Fn([f64; 3]) -> Vec<f64> + use<> {
        let mut slots = Slots::default();
        let function = slots.point_function(graph, "test", 3, values);
        let frame = slots.frame_function(graph, 8);
        let uniforms = reference::evaluate(&frame, &[0.3; 8], &[], &[]);
        move |point| reference::evaluate(&function, &point, &uniforms, &[])
    }

    #[test]
    fn sphere_by_hand() {
        let mut graph = Graph::default();
        let p = [0, 1, 2].map(|i| graph.input(i));
        let distance = graph.length(&p);
        let slopes = gradient(&mut graph, distance, &[0, 1, 2]).expect("smooth");
        let value = cut(&mut graph, &slopes);
        let found = value([2.0, 3.0, 6.0]);
        assert!((0..3).all(|i| (found[i] - [2.0, 3.0, 6.0][i] / 7.0).abs() < 1e-15), "{found:?}");
        assert_eq!(value([0.0; 3]), [0.0; 3]);
    }

    #[test]
    fn constants_and_jumps_are_flat() {
        let mut graph = Graph::default();
        let (x, time) = (graph.input(0), graph.frame_input(0));
        let whole = graph.apply(Op::Floor, &[x]);
        let zero = graph.number(0.0);
        assert_eq!(gradient(&mut graph, time, &[0, 1]), Some(vec![zero; 2]));
        assert_eq!(gradient(&mut graph, whole, &[0]), Some(vec![zero]));
        let scaled = graph.mul(x, time);
        assert_eq!(gradient(&mut graph, scaled, &[0, 1]), Some(vec![time, zero]));
    }

    #[test]
    fn stretch_has_none_unless_it_does_not_matter() {
        let mut graph = Graph::default();
        let p = [0, 1, 2].map(|i| graph.input(i));
        let stretch = graph.apply_all(Op::Closest, 0, &p)[7];
        assert_eq!(gradient(&mut graph, stretch, &[0, 1, 2]), None);
        let side = graph.apply(Op::Less, &[stretch, p[0]]);
        let picked = graph.select(side, p[0], p[1]);
        assert!(gradient(&mut graph, picked, &[0, 1, 2]).is_some());
        let constant = [1.0, 2.0, 3.0].map(|x| graph.number(x));
        let fixed = graph.apply_all(Op::Closest, 0, &constant)[7];
        let moved = graph.add(fixed, p[0]);
        assert!(gradient(&mut graph, moved, &[0]).is_some());
    }

    #[test]
    fn noise_gradient_is_one_operation() {
        let mut graph = Graph::default();
        let p = [0, 1, 2].map(|i| graph.input(i));
        let noise = graph.apply_data(Op::Perlin, 3, &p);
        let slopes = gradient(&mut graph, noise, &[0, 1, 2]).expect("smooth");
        let tuples: HashSet<ValueId> =
            slopes.iter().flat_map(|&s| graph.inst(s).operands().to_vec()).collect();
        assert_eq!(tuples.len(), 1);
    }

    #[test]
    fn deep_graphs_need_no_stack() {
        let mut graph = Graph::default();
        let x = graph.input(0);
        let mut value = x;
        for i in 0..100_000 {
            let step = graph.push(Inst::Constant(Number(f64::from(i))));
            let sum = graph.add(value, step);
            value = graph.min(sum, x);
        }
        assert!(gradient(&mut graph, value, &[0]).is_some());
    }

    #[test]
    fn generated_functions_match_differences() {
        let shape = random::Shape::default();
        let (mut compared, mut random) = (0, Random::new(5));
        for seed in 0..300 {
            let function = random::function(seed, &shape);
            let mut graph = Graph::default();
            let mut renamed: Vec<ValueId> = Vec::new();
            for inst in &function.insts {
                let inst = inst.map_operands(|v| renamed[v.index()]);
                renamed.push(graph.push(inst));
            }
            let output = renamed[function.outputs[0].index()];
            if let Some(slopes) = gradient(&mut graph, output, &[0, 1, 2]) {
                let values = [&[output], &slopes[..]].concat();
                let point = [(); 3].map(|()| random.between(-2.0, 2.0));
                compared += compare(cut(&mut graph, &values), point);
            }
        }
        assert!(compared > 100, "{compared} smooth places");
    }

    /// Compares outputs 1 to 3 with differences of output 0; counts directions that are smooth.
    fn compare(value: impl Fn([f64; 3]) -> Vec<f64>, point: [f64; 3]) -> usize {
        let slopes = value(point);
        let mut smooth = 0;
        for axis in 0..3 {
            let difference = |step: f64| {
                let (mut low, mut high) = (point, point);
                low[axis] -= step;
                high[axis] += step;
                (value(high)[0] - value(low)[0]) / (2.0 * step)
            };
            let (coarse, fine) = (difference(2e-6), difference(1e-6));
            let scale = 1.0 + fine.abs() + slopes[0].abs();
            // Differences that disagree with each other see a kink or a jump; waves of a noise that are
            // shorter than the step, or held at the end of its range, they do not see at all.
            let seen = slopes[axis + 1].abs() < 1e6;
            if (coarse - fine).abs() < 1e-6 * scale && scale < 1e4 && seen {
                assert!((slopes[axis + 1] - fine).abs() < 1e-4 * scale, "{slopes:?} {fine} axis {axis}");
                smooth += 1;
            }
        }
        smooth
    }
}
