use super::*;
use crate::interp::{Evaluator, Tapes};
use vol_compiler::ir::verify::random::{self, Random, Shape};
use vol_compiler::ir::{Function, text};

const UNIFORMS: [f32; 4] = [0.75, -1.5, 2.0, 0.1];

/// A module of one function, its tapes in an octree over a box, and without.
fn tapes(function: &Function, place: Place) -> [Tapes; 2] {
    let module = Module { functions: vec![function.clone()], ..Module::default() };
    let whole = Tapes::of_module(&module);
    let mut local = LocalTapes::without_functions(&module, &UNIFORMS, Isa::best(), MOST_BYTES);
    local.is_eager = true;
    local.add(&module, FunctionId(0), place);
    [Tapes { local: Some(local), ..Tapes::of_module(&module) }, whole]
}

/// Outputs at points, a few at a time so that cells are asked often.
fn evaluate(tapes: &Tapes, outputs: usize, points: &[[f32; 3]]) -> Vec<u32> {
    let mut evaluator = Evaluator::of_parts(tapes, &UNIFORMS, &[]);
    let mut bits = Vec::new();
    for points in points.chunks(20) {
        let inputs = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect::<Vec<f32>>());
        let mut values = vec![vec![0.0; points.len()]; outputs];
        let mut slices: Vec<&mut [f32]> = values.iter_mut().map(Vec::as_mut_slice).collect();
        evaluator.evaluate(FunctionId(0), &inputs.each_ref().map(Vec::as_slice), &mut slices);
        // NaNs are all alike: their bits are not part of any promise.
        bits.extend(values.iter().flatten().map(|x| if x.is_nan() { u32::MAX } else { x.to_bits() }));
    }
    bits
}

/// Points in a box and a little outside, many of them on the walls of its cells.
fn points(random: &mut Random, place: &Place, count: usize) -> Vec<[f32; 3]> {
    let mut coordinate = |axis: usize| {
        let (lo, hi) = (f64::from(place.lo[axis]), f64::from(place.hi[axis]));
        let eighths = f64::from(random.below(9) as u32) / 8.0;
        let share = if random.below(3) == 0 { eighths } else { random.between(-0.05, 1.05) };
        (lo + share * (hi - lo)) as f32
    };
    (0..count).map(|_| [coordinate(0), coordinate(1), coordinate(2)]).collect()
}

/// Cells of a function at all points, and how many steps they have together.
fn steps(tapes: &Tapes, points: &[[f32; 3]]) -> usize {
    let local = tapes.local.as_ref().expect("made with cells");
    let steps = |&point: &[f32; 3]| {
        let found = local.find(FunctionId(0), point).and_then(|found| found.tape());
        found.as_deref().unwrap_or(tapes.tape(FunctionId(0))).ops.len()
    };
    points.iter().map(steps).sum()
}

#[test]
fn cells_give_the_same_bits() {
    let mut shorter = 0;
    for seed in 0..60 {
        let shape = Shape { operations: 200, curves: 0, tame: seed % 4 != 0, ..Shape::default() };
        let function = random::function(seed, &shape);
        let mut random = Random::new(seed);
        let lo = [0, 1, 2].map(|_| random.between(-4.0, 2.0) as f32);
        let size = random.between(0.02, 1.0) as f32;
        let place = Place { lo, hi: lo.map(|lo| lo + size) };
        let [local, whole] = tapes(&function, place);
        let points = points(&mut random, &place, 600);
        let outputs = function.outputs.len();
        let expected = evaluate(&whole, outputs, &points);
        assert_eq!(evaluate(&local, outputs, &points), expected, "{}", text::print_function(&function));
        shorter += usize::from(steps(&local, &points) < 600 * whole.tape(FunctionId(0)).ops.len());
    }
    assert!(shorter > 20, "{shorter} became shorter");
}

/// A union of balls on a lattice in the unit cube, `side` along each axis; rounded by `width` where that is not 0.
fn balls(side: usize, width: f32) -> Function {
    let mut body = String::from("%0 = input 0\n%1 = input 1\n%2 = input 2\n");
    let mut next = 3;
    let mut add = |line: String| {
        body += &format!("%{next} = {line}\n");
        next += 1;
        next - 1
    };
    let zero = add("constant 0.0".to_owned());
    let (width, quarter) = (add(format!("constant {width:?}")), add(format!("constant {:?}", 0.25 / width)));
    let mut union = None;
    for ball in 0..side * side * side {
        let squares = [ball % side, ball / side % side, ball / (side * side)].into_iter().enumerate().map(
            |(axis, place)| {
                let centre = add(format!("constant {:?}", (place as f32 + 0.5) / side as f32));
                let offset = add(format!("sub %{axis} %{centre}"));
                add(format!("mul %{offset} %{offset}"))
            },
        );
        let squares: Vec<usize> = squares.collect();
        let sum = add(format!("add %{} %{}", squares[0], squares[1]));
        let sum = add(format!("add %{sum} %{}", squares[2]));
        let length = add(format!("sqrt %{sum}"));
        let radius = add(format!("constant {:?}", 0.3 / side as f32));
        let distance = add(format!("sub %{length} %{radius}"));
        let mut join = |before: usize| {
            let sharp = add(format!("min %{before} %{distance}"));
            let apart = add(format!("sub %{before} %{distance}"));
            let apart = add(format!("abs %{apart}"));
            let overlap = add(format!("sub %{width} %{apart}"));
            let overlap = add(format!("max %{overlap} %{zero}"));
            let squared = add(format!("mul %{overlap} %{overlap}"));
            let bulge = add(format!("mul %{squared} %{quarter}"));
            add(format!("sub %{sharp} %{bulge}"))
        };
        union = Some(union.map_or(distance, &mut join));
    }
    let all = body + &format!("return %{}", union.unwrap_or(0));
    text::parse_function(&format!("fn f(3) {{\n{all}\n}}")).expect("well-formed text")
}

#[test]
fn of_many_balls_few_are_left() {
    let function = balls(10, 0.01);
    let place = Place { lo: [0.0; 3], hi: [1.0; 3] };
    let [local, whole] = tapes(&function, place);
    let mut random = Random::new(1);
    let here =
        |random: &mut Random| (0..200).map(|_| [0.0; 3].map(|_| random.between(0.3, 0.45) as f32)).collect();
    let points: Vec<[f32; 3]> = here(&mut random);
    for _ in 0..20 {
        assert_eq!(evaluate(&local, 1, &points), evaluate(&whole, 1, &points));
    }
    let mean = steps(&local, &points) / points.len();
    // 17 000 steps; a ball and its 26 neighbours would have 450.
    assert!(mean < 300, "{mean} steps");
}

#[test]
fn memory_has_an_end() {
    let function = balls(4, 0.01);
    let place = Place { lo: [0.0; 3], hi: [1.0; 3] };
    let [mut local, whole] = tapes(&function, place);
    let points = points(&mut Random::new(3), &place, 3000);
    let cells = local.local.as_mut().expect("made with cells");
    (cells.left_for_outlines, cells.left_for_tapes) = (AtomicUsize::new(100_000), AtomicUsize::new(10_000));
    assert_eq!(evaluate(&local, 1, &points), evaluate(&whole, 1, &points));
    let cells = local.local.as_ref().expect("made with cells");
    let left = [&cells.left_for_outlines, &cells.left_for_tapes].map(|left| left.load(Ordering::Relaxed));
    assert!(left[0] < 5_000 && left[1] < 10_000, "{left:?} are left");
}
