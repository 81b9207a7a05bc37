//! Tests of all rows of the table against each other: every rule against the meaning.

use super::*;
use crate::error_bound::nasty;
use crate::ir::graph::Slots;
use crate::ir::verify::random::Random;
use crate::ir::{Inst, Number};
use crate::passes::gradient::gradient;
use crate::reference;

/// An arch and a straight line that joins it.
fn curves() -> Vec<Vec<Quadratic>> {
    let arch = Quadratic { a: [-1.0, 0.0, 0.0], b: [0.3, 2.0, 0.5], c: [1.0, 0.0, 1.0] };
    let line = Quadratic { a: [1.0, 0.0, 1.0], b: [1.5, -1.0, 1.0], c: [2.0, -2.0, 1.0] };
    vec![vec![arch, line]]
}

fn data(row: &Operation, random: &mut Random) -> u32 {
    if row.has_data && !row.op.reads_curve() { random.below(3) as u32 } else { 0 }
}

/// A number from the domain of operand `i`; truth values are 0 or 1.
fn drawn(row: &Operation, i: usize, random: &mut Random) -> f64 {
    let (lo, hi) = row.domain[i];
    match row.args[i] {
        Ty::Number => random.between(lo, hi),
        Ty::Bool => random.below(2) as f64,
    }
}

#[test]
fn table_is_in_order_and_complete() {
    assert_eq!(TABLE.len(), Op::Foot as usize + 1);
    for (i, row) in TABLE.iter().enumerate() {
        assert_eq!(row.op as usize, i, "{}", row.name);
        assert_eq!(by_name(row.name).map(|found| found.op), Some(row.op), "names differ");
        assert_eq!(row.args.len(), row.domain.len(), "{}", row.name);
        assert_eq!(row.results.len(), row.wgsl_extract.len(), "{}", row.name);
        assert!(row.results.len() <= MAX_RESULTS);
        let unread = (0..row.args.len()).find(|i| !row.wgsl.contains(&format!("{{{i}}}")));
        assert_eq!(unread, None, "{}", row.name);
        let placed = row.wgsl.contains("{d}") || row.wgsl.contains("{curve}");
        assert_eq!(row.has_data, placed, "{}", row.name);
    }
    assert!(by_name("extract").is_none());
}

#[test]
fn documented_edges() {
    let value = |op: Op, x: &[f64]| (operation(op).meaning)(x, Context::default())[0];
    assert_eq!([value(Op::Min, &[2.0, 1.0]), value(Op::Max, &[2.0, 1.0])], [1.0, 2.0]);
    assert_eq!([value(Op::Sqrt, &[-4.0]), value(Op::Exp2, &[-126.5]), value(Op::Exp2, &[-1e9])], [0.0; 3]);
    assert_eq!(value(Op::Exp2, &[1e9]), 127f64.exp2());
    assert_eq!([value(Op::Log2, &[0.0]), value(Op::Log2, &[-7.0])], [-126.0; 2]);
    assert_eq!([value(Op::Acos, &[2.0]), value(Op::Acos, &[-2.0])], [0.0, std::f64::consts::PI]);
    assert_eq!([value(Op::Atan2, &[0.0, 0.0]), value(Op::Atan2, &[-0.0, -0.0])], [0.0; 2]);
    assert_eq!(value(Op::Atan2, &[-0.0, -1.0]), std::f64::consts::PI);
    assert_eq!(value(Op::Fbm, &[0.5, 0.5, 0.5, -1.0, 2.0, 0.5]), 0.0);
    let nowhere = (operation(Op::Closest).meaning)(&[0.0; 3], Context::default());
    assert_eq!([nowhere[3], nowhere[5], nowhere[7]], [1e18, 1e18, 1.0]);
}

#[test]
fn intervals_enclose_meanings() {
    let curves = curves();
    let mut random = Random::new(1);
    for row in TABLE {
        let boxes = if row.op.reads_curve() { 40 } else { 500 };
        for _ in 0..boxes {
            let context = Context { data: data(row, &mut random), curves: &curves };
            let size = [0.0, 1e-6, 1e-2, 0.3, 1.0][random.below(5)];
            let range = |i: usize, random: &mut Random| {
                let (a, b) = (drawn(row, i, random), drawn(row, i, random));
                let near = if row.args[i] == Ty::Bool { b } else { a + size * (b - a) };
                Interval::new(a.min(near), a.max(near))
            };
            let ranges: Vec<Interval> = (0..row.args.len()).map(|i| range(i, &mut random)).collect();
            let bounds = (row.interval)(&ranges, context);
            for _ in 0..4 {
                let point = |x: &Interval, random: &mut Random| match random.below(4) {
                    0 => x.lo,
                    1 => x.hi,
                    _ if *x == Interval::EITHER => x.hi,
                    _ => random.between(x.lo, x.hi),
                };
                let x: Vec<f64> = ranges.iter().map(|range| point(range, &mut random)).collect();
                let values = (row.meaning)(&x, context);
                for i in 0..row.results.len() {
                    let name = row.name;
                    assert!(
                        bounds[i].contains(values[i]),
                        "{name} {x:?}: {} in {:?} of {ranges:?}",
                        values[i],
                        bounds[i]
                    );
                }
            }
        }
    }
}

#[test]
fn intervals_of_everything_are_sound() {
    let mut random = Random::new(2);
    for row in TABLE {
        let far = |ty: &Ty| if *ty == Ty::Bool { Interval::EITHER } else { Interval::EVERYTHING };
        let ranges: Vec<Interval> = row.args.iter().map(far).collect();
        let bounds = (row.interval)(&ranges, Context::default());
        assert!(bounds.iter().all(|bound| !bound.lo.is_nan() && bound.lo <= bound.hi), "{}", row.name);
        for _ in 0..200 {
            let x: Vec<f64> = (0..row.args.len()).map(|i| drawn(row, i, &mut random)).collect();
            let values = (row.meaning)(&x, Context::default());
            assert!((0..row.results.len()).all(|i| bounds[i].contains(values[i])), "{} {x:?}", row.name);
        }
    }
}

#[test]
fn intervals_find_extremes_of_waves_and_angles() {
    let bound = |op: Op, x: &[Interval]| (operation(op).interval)(x, Context::default())[0];
    assert_eq!(bound(Op::Sin, &[Interval::new(1.0, 2.0)]).hi, 1.0);
    assert_eq!(bound(Op::Cos, &[Interval::new(3.0, 3.5)]).lo, -1.0);
    assert_eq!(bound(Op::Cos, &[Interval::new(-0.1, 0.1)]).hi, 1.0);
    assert!(bound(Op::Sin, &[Interval::new(0.1, 0.2)]).width() < 0.1);
    let (front, behind) = (Interval::new(1.0, 2.0), Interval::new(-2.0, -1.0));
    let across = Interval::new(-1.0, 1.0);
    assert!(bound(Op::Atan2, &[across, front]).magnitude() < 0.8);
    assert!(bound(Op::Atan2, &[across, behind]).width() > 6.2);
    assert!(bound(Op::Atan2, &[front, behind]).lo > 1.5);
}

/// Inputs of a graph that stand for the operands of a row: truth values are `input > 0`.
fn operands(graph: &mut Graph, row: &Operation) -> Vec<ValueId> {
    let zero = graph.number(0.0);
    let operand = |(i, ty): (usize, &Ty)| {
        let input = graph.input(i as u32);
        if *ty == Ty::Bool { graph.apply(Op::Less, &[zero, input]) } else { input }
    };
    row.args.iter().enumerate().map(operand).collect()
}

#[test]
fn derivatives_match_differences() {
    let mut random = Random::new(3);
    for row in TABLE.iter().filter(|row| row.results == [Ty::Number]) {
        let mut graph = Graph::default();
        let args = operands(&mut graph, row);
        let result = graph.apply_data(row.op, if row.has_data { 1 } else { 0 }, &args);
        let count = args.len() as u32;
        // Sums of octaves have derivatives only along the position.
        let along: Vec<u32> = (0..count.min(4)).collect();
        let slopes = gradient(&mut graph, result, &along).expect("there is a rule");
        let outputs = [&[result], &slopes[..]].concat();
        let function = Slots::default().point_function(&mut graph, row.name, count, &outputs);
        let mut compared = 0;
        for _ in 0..500 {
            let x: Vec<f64> = (0..row.args.len()).map(|i| drawn(row, i, &mut random)).collect();
            let value = |x: &[f64]| reference::evaluate(&function, x, &[], &[]);
            let exact = value(&x);
            for axis in 0..along.len() {
                let difference = |step: f64| {
                    let (mut low, mut high) = (x.clone(), x.clone());
                    low[axis] -= step;
                    high[axis] += step;
                    (value(&high)[0] - value(&low)[0]) / (2.0 * step)
                };
                let (coarse, fine) = (difference(2e-6), difference(1e-6));
                let scale = 1.0 + fine.abs() + exact[0].abs();
                // Kinks and jumps are left out.
                if (coarse - fine).abs() < 1e-6 * scale {
                    assert!(
                        (exact[axis + 1] - fine).abs() < 1e-5 * scale,
                        "{} {x:?} {exact:?} {fine}",
                        row.name
                    );
                    compared += 1;
                }
            }
        }
        assert!(compared > 400, "{}: {compared} smooth places", row.name);
    }
}

#[test]
fn derivatives_of_the_closest_point_match_differences() {
    let curves = curves();
    let mut graph = Graph::default();
    let args = operands(&mut graph, operation(Op::Closest));
    let results = graph.apply_all(Op::Closest, 0, &args);
    // All but the stretch.
    for (index, &result) in results[..7].iter().enumerate() {
        let slopes = gradient(&mut graph, result, &[0, 1, 2]).expect("there is a rule");
        let outputs = [&[result], &slopes[..]].concat();
        let function = Slots::default().point_function(&mut graph, "closest", 3, &outputs);
        let (mut compared, mut moving, mut random) = (0, 0, Random::new(8));
        for _ in 0..60 {
            let x: Vec<f64> = [(); 3].map(|()| random.between(-2.0, 3.0)).to_vec();
            let value = |x: &[f64]| reference::evaluate(&function, x, &[], &curves);
            let exact = value(&x);
            for axis in 0..3 {
                let difference = |step: f64| {
                    let (mut low, mut high) = (x.clone(), x.clone());
                    low[axis] -= step;
                    high[axis] += step;
                    (value(&high)[0] - value(&low)[0]) / (2.0 * step)
                };
                let (coarse, fine) = (difference(2e-5), difference(1e-5));
                let scale = 1.0 + fine.abs();
                if (coarse - fine).abs() < 1e-5 * scale && fine.abs() < 15.0 {
                    let found = exact[axis + 1];
                    assert!(
                        (found - fine).abs() < 1e-4 * scale,
                        "result {index} {x:?} {axis}: {found} {fine}"
                    );
                    compared += 1;
                    moving += usize::from(fine.abs() > 1e-3);
                }
            }
        }
        assert!(compared > 120 && (moving > 20 || index == 2), "{index}: {compared} places, {moving} moving");
    }
}

#[test]
fn factors_of_octaves_have_no_derivative() {
    let mut graph = Graph::default();
    let args = operands(&mut graph, operation(Op::Fbm));
    let result = graph.apply_data(Op::Fbm, 1, &args);
    assert_eq!(gradient(&mut graph, result, &[5]), None);
    let zero = graph.number(0.0);
    assert_eq!(gradient(&mut graph, result, &[3]), Some(vec![zero]));
}

#[test]
fn folding_agrees_with_meanings() {
    let mut random = Random::new(4);
    for row in TABLE.iter().filter(|row| row.results.len() == 1) {
        for _ in 0..50 {
            let mut graph = Graph::default();
            let data = data(row, &mut random);
            let x: Vec<f64> = (0..row.args.len()).map(|i| drawn(row, i, &mut random)).collect();
            let constant = |(i, &x): (usize, &f64)| match row.args[i] {
                Ty::Number => graph.push(Inst::Constant(Number(x))),
                Ty::Bool => graph.boolean(x != 0.0),
            };
            let args: Vec<ValueId> = x.iter().enumerate().map(constant).collect();
            let folded = graph.apply_data(row.op, data, &args);
            let value = (row.meaning)(&x, Context { data, curves: &[] })[0];
            assert_eq!(graph.constant(folded), Some(value), "{} {x:?}", row.name);
        }
    }
}

/// Largest share of the bound that a nasty device used up, over operands that carry errors of about
/// `spread` of themselves (0: none).
fn worst_share(row: &Operation, spread: f64, random: &mut Random) -> f64 {
    let curves = curves();
    let mut worst: f64 = 0.0;
    for _ in 0..if row.op.reads_curve() { 300 } else { 4000 } {
        let context = Context { data: data(row, random), curves: &curves };
        let mut given: Vec<f32> = (0..row.args.len()).map(|i| drawn(row, i, random) as f32).collect();
        // The number of octaves is whole, or every sum is undecided.
        if row.args.len() == 6 {
            given[3] = given[3].floor();
        }
        let error = |(i, &x): (usize, &f32)| match row.args[i] {
            Ty::Number if x.fract() != 0.0 => f64::from(x.abs()) * spread,
            Ty::Number | Ty::Bool => 0.0,
        };
        let errors: Vec<f64> = given.iter().enumerate().map(error).collect();
        let side = |random: &mut Random| [-0.999_999, 0.999_999, 0.3][random.below(3)];
        let exact: Vec<f64> =
            given.iter().zip(&errors).map(|(&x, e)| f64::from(x) + side(random) * e).collect();
        let values = (row.meaning)(&exact, context);
        let bounds = (row.error)(&exact, &errors, &values, context);
        let found = nasty::apply(row.op, &given, context, random);
        for i in 0..row.results.len() {
            let off = (f64::from(found[i]) - values[i]).abs();
            assert!(off <= bounds[i], "{}[{i}] {exact:?} ± {errors:?}: {off} > {}", row.name, bounds[i]);
            if off > 0.0 && bounds[i].is_finite() {
                worst = worst.max(off / bounds[i]);
            }
        }
    }
    worst
}

#[test]
fn error_rules_hold_and_are_tight() {
    let mut random = Random::new(6);
    for row in TABLE {
        for spread in [0.0, 1e-7, 1e-5, 1e-3] {
            let worst = worst_share(row, spread, &mut random);
            let decides = row.results == [Ty::Bool] || matches!(row.op, Op::Floor | Op::Hash);
            let exact = spread == 0.0 && matches!(row.op, Op::Min | Op::Max | Op::Neg | Op::Abs | Op::Select);
            assert!(worst > 0.02 || decides || exact, "{} with {spread}: {worst}", row.name);
        }
    }
}

#[test]
fn exact_arithmetic_has_no_error() {
    let error = |op: Op, x: &[f64]| {
        let row = operation(op);
        (row.error)(x, &[0.0; 3], &(row.meaning)(x, Context::default()), Context::default())[0]
    };
    assert_eq!(
        [error(Op::Add, &[1.5, 2.25]), error(Op::Sub, &[1.5, 1.5]), error(Op::Mul, &[0.0, 0.7])],
        [0.0; 3]
    );
    assert!(error(Op::Add, &[2f64.powi(100), 2f64.powi(-100)]) > 0.0);
    assert!(error(Op::Mul, &[1.0 + 2f64.powi(-20), 1.0 + 2f64.powi(-20)]) > 0.0);
    assert!(error(Op::Div, &[1.0, 0.0]).is_infinite());
}

#[test]
fn doubt_spreads_and_is_resolved() {
    let error = |op: Op, x: &[f64], e: &[f64]| {
        let row = operation(op);
        (row.error)(x, e, &(row.meaning)(x, Context::default()), Context::default())[0]
    };
    let doubt = f64::INFINITY;
    assert_eq!(error(Op::Less, &[1.0, 1.001], &[1e-2, 0.0]), doubt);
    assert_eq!(error(Op::Less, &[1.0, 1.1], &[1e-2, 0.0]), 0.0);
    assert_eq!(error(Op::Equal, &[1.0, 1.0], &[0.0, 0.0]), 0.0);
    assert_eq!(error(Op::Floor, &[3.0], &[1e-9]), doubt);
    assert_eq!(error(Op::Floor, &[3.5], &[1e-9]), 0.0);
    assert_eq!(error(Op::And, &[0.0, 1.0], &[0.0, doubt]), 0.0);
    assert_eq!(error(Op::And, &[1.0, 1.0], &[0.0, doubt]), doubt);
    assert_eq!(error(Op::Or, &[1.0, 1.0], &[0.0, doubt]), 0.0);
    assert_eq!(error(Op::Select, &[1.0, 5.0, 3.0], &[doubt, 0.1, 0.5]), 2.5);
    assert_eq!(error(Op::Select, &[1.0, 5.0, 3.0], &[0.0, 0.1, doubt]), 0.1);
    assert_eq!(error(Op::Min, &[1.0, 5.0], &[0.1, doubt]), doubt);
    assert_eq!(error(Op::Atan2, &[0.0, -1.0], &[1e-7, 0.0]), doubt);
    assert!(error(Op::Atan2, &[0.0, -1.0], &[0.0, 0.0]) < 4e-6);
}
