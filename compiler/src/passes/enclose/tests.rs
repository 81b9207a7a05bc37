use super::*;
use crate::ir::Function;
use crate::ir::graph::{Repeated, Slots};
use crate::ir::verify::random::{self, Random};
use crate::reference;

/// A graph with a function of three inputs in it.
fn graph_of(function: &Function) -> (Graph, ValueId) {
    let mut graph = Graph::default();
    let mut renamed: Vec<ValueId> = Vec::new();
    for inst in &function.insts {
        let inst = inst.map_operands(|v| renamed[v.index()]);
        renamed.push(graph.push(inst));
    }
    let output = renamed[function.outputs[0].index()];
    (graph, output)
}

/// Cuts out a function; inputs of the frame function are 0.3.
fn cut(graph: &mut Graph, inputs: u32, values: &[ValueId]) -> impl Fn(&[f64]) -> Vec<f64> + use<> {
    let mut slots = Slots::default();
    let function = slots.point_function(graph, "test", inputs, values);
    let frame = slots.frame_function(graph, 8);
    let uniforms = reference::evaluate(&frame, &[0.3; 8], &[], &[]);
    move |inputs| reference::evaluate(&function, inputs, &uniforms, &[])
}

/// The box that inputs 0 to 5 stand for.
fn place(graph: &mut Graph) -> [Range; 3] {
    [0, 1, 2].map(|axis| Range { lo: graph.input(axis), hi: graph.input(axis + 3) })
}

/// Encloses a value and draws boxes and points in them; `None` if there is no range. Returns how often the
/// range was finite and narrower than anything.
fn assert_encloses(graph: &mut Graph, value: ValueId, random: &mut Random, boxes: usize) -> Option<usize> {
    let place = place(graph);
    let range = enclose(graph, &[value], place)?[0];
    let (bounds, exact) = (cut(graph, 6, &[range.lo, range.hi]), cut(graph, 3, &[value]));
    let mut useful = 0;
    for _ in 0..boxes {
        let lo = [(); 3].map(|()| random.between(-3.0, 3.0));
        let size = random.between(0.0, 1.0).powi(3);
        let hi = lo.map(|lo| lo + size * random.between(0.0, 3.0));
        let [low, high] = bounds(&[lo, hi].concat())[..] else { unreachable!("two outputs") };
        assert!(low.is_finite() && high.is_finite(), "{low} {high} over {lo:?} {hi:?}");
        for _ in 0..20 {
            let p = [0, 1, 2].map(|i| lo[i] + (hi[i] - lo[i]) * random.between(0.0, 1.0));
            let found = exact(&p)[0];
            // Beyond the largest ends nothing is promised.
            let slack = 1e-9 * (1.0 + found.abs());
            let promised = found.abs() < ops::range::LARGEST;
            let held = low - slack <= found && found <= high + slack;
            assert!(held || !promised, "{found} at {p:?} is not in {low} to {high}, of {lo:?} {hi:?}");
        }
        useful += usize::from(low < high && high - low < 1e6);
    }
    Some(useful)
}

#[test]
fn ranges_of_operations_hold() {
    let mut random = Random::new(3);
    for row in ops::TABLE {
        let mut graph = Graph::default();
        let inputs = [0, 1, 2].map(|i| graph.input(i));
        let half = graph.number(0.5);
        let settings = [4.0, 2.0, 0.5].map(|x| graph.number(x));
        let operand = |(i, ty): (usize, &Ty)| match ty {
            Ty::Number if i >= 3 && row.args.len() == 6 => settings[i - 3],
            Ty::Number => inputs[i % 3],
            Ty::Bool => graph.apply(Op::Less, &[inputs[i % 3], half]),
        };
        let args: Vec<ValueId> = row.args.iter().enumerate().map(operand).collect();
        let results = match row.results.len() {
            1 => vec![graph.apply_data(row.op, 0, &args)],
            _ => graph.apply_all(row.op, 0, &args),
        };
        for result in results {
            let result =
                if graph.ty(result) == Ty::Bool { graph.select(result, half, inputs[0]) } else { result };
            let useful = assert_encloses(&mut graph, result, &mut random, 200);
            assert!(useful.is_some() || row.op.reads_curve(), "{} has no range", row.name);
            assert!(useful.is_none_or(|useful| useful > 20), "{} has no useful range", row.name);
        }
    }
}

#[test]
fn ranges_of_generated_functions_hold() {
    let shape = random::Shape { curves: 0, operations: 12, tame: true, ..random::Shape::default() };
    let (mut random, mut found) = (Random::new(9), 0);
    for seed in 0..1000 {
        let (mut graph, output) = graph_of(&random::function(seed, &shape));
        found += assert_encloses(&mut graph, output, &mut random, 20).unwrap_or(0);
    }
    assert!(found > 1000, "{found} useful ranges");
}

#[test]
fn small_boxes_are_tight() {
    let mut graph = Graph::default();
    let p = [0, 1, 2].map(|i| graph.input(i));
    let length = graph.length(&p);
    let quotient = graph.div(p[0], length);
    let place = place(&mut graph);
    let range = enclose(&mut graph, &[quotient], place).expect("has a range")[0];
    let bounds = cut(&mut graph, 6, &[range.lo, range.hi]);
    let found = bounds(&[2.0, 3.0, 6.0, 2.001, 3.001, 6.001]);
    assert!((found[0] - 2.0 / 7.0).abs() < 1e-3 && (found[1] - 2.0 / 7.0).abs() < 1e-3, "{found:?}");
}

#[test]
fn equal_ranges_are_not_equal_numbers() {
    let (mut graph, mut random) = (Graph::default(), Random::new(4));
    let waves = [0, 1].map(|i| {
        let x = graph.input(i);
        graph.apply(Op::Sin, &[x])
    });
    let product = graph.mul(waves[0], waves[1]);
    assert!(assert_encloses(&mut graph, product, &mut random, 100).is_some());
    let squared = graph.mul(waves[0], waves[0]);
    let place = place(&mut graph);
    let range = enclose(&mut graph, &[squared], place).expect("has a range")[0];
    assert_eq!(graph.constant(range.lo), Some(0.0));
}

#[test]
fn curves_have_none() {
    let mut graph = Graph::default();
    let p = [0, 1, 2].map(|i| graph.input(i));
    let distance = graph.apply_all(Op::Closest, 0, &p)[5];
    let place = place(&mut graph);
    assert_eq!(enclose(&mut graph, &[distance], place), None);
    // What does not depend on them has.
    assert!(enclose(&mut graph, &[p[0]], place).is_some());
}

/// `while x < limit: x ← x * x + c`, at most 5 times.
fn escape(graph: &mut Graph, c: ValueId, limit: f64) -> ValueId {
    let (x, limit) = (graph.placeholder(), graph.number(limit));
    let squared = graph.mul(x, x);
    let next = graph.add(squared, c);
    let goes_on = graph.apply(Op::Less, &[x, limit]);
    let repeated = Repeated { state: &[x], first: &[c], next: &[next], goes_on };
    graph.repeat(5, repeated)[0]
}

#[test]
fn loops_are_enclosed_whenever_they_end() {
    let mut random = Random::new(2);
    for limit in [0.1, 2.0, 50.0] {
        let mut graph = Graph::default();
        let c = graph.input(0);
        let last = escape(&mut graph, c, limit);
        let useful = assert_encloses(&mut graph, last, &mut random, 500);
        assert!(useful.is_some_and(|useful| useful > 50), "{useful:?}");
    }
}

#[test]
fn what_jumps_is_found() {
    let mut graph = Graph::default();
    let x = graph.input(0);
    let whole = graph.apply(Op::Floor, &[x]);
    let part = graph.sub(x, whole);
    let none = HashSet::new();
    assert_eq!(jumps(&mut graph, part, &none), Some(vec![whole]));
    // Deciding by it is a jump only if an author does.
    let zero = graph.number(0.0);
    let side = graph.apply(Op::Less, &[zero, whole]);
    let picked = graph.select(side, x, zero);
    assert_eq!(jumps(&mut graph, picked, &none), Some(vec![]));
    assert_eq!(jumps(&mut graph, picked, &HashSet::from([picked])), Some(vec![side]));
    // Inside a loop it cannot be told.
    let (state, one) = (graph.placeholder(), graph.number(1.0));
    let next = graph.apply(Op::Floor, &[state]);
    let goes_on = graph.apply(Op::Less, &[one, state]);
    let repeated = Repeated { state: &[state], first: &[x], next: &[next], goes_on };
    let last = graph.repeat(3, repeated)[0];
    assert_eq!(jumps(&mut graph, last, &none), None);
}
