use super::*;
use vol_compiler::curve::{Quadratic, prepare};
use vol_compiler::error_bound;
use vol_compiler::ir::verify::random::{self, Random, Shape};
use vol_compiler::ir::{Function, text};
use vol_compiler::ops::interval::Interval;
use vol_compiler::passes::narrow;

const UNIFORMS: [f32; 4] = [0.75, -1.5, 2.0, 0.1];

fn curves() -> Vec<Vec<Quadratic>> {
    let arch = Quadratic { a: [0.0; 3], b: [0.0, 1.0, 0.5], c: [1.0, 2.0, -0.5] };
    let back = Quadratic { a: [1.0, 2.0, -0.5], b: [2.0, 3.0, 0.0], c: [-1.0, 1.0, 3.0] };
    let line = Quadratic { a: [-2.0, 0.0, 0.0], b: [0.0, 0.5, 0.0], c: [2.0, 1.0, 0.0] };
    vec![vec![arch, back], vec![line]]
}

fn tables() -> Vec<CurveTable> {
    curves().iter().map(|segments| prepare(segments)).collect()
}

fn module(functions: Vec<Function>) -> Module {
    Module { functions, ..Module::default() }
}

/// Arguments for `count` points, one vector per argument.
fn arguments(seed: u64, count: usize, inputs: u32) -> Vec<Vec<f32>> {
    let mut random = Random::new(seed);
    (0..inputs).map(|_| (0..count).map(|_| random.between(-4.0, 4.0) as f32).collect()).collect()
}

/// Outputs at all points, evaluated `batch` points at a time.
fn evaluate(module: &Module, inputs: &[Vec<f32>], batch: usize) -> Vec<Vec<f32>> {
    let (tapes, tables) = (Tapes::of_module(module), tables());
    let mut evaluator = Evaluator::of_parts(&tapes, &UNIFORMS, &tables);
    let count = inputs[0].len();
    let mut all = vec![vec![0.0; count]; module.functions[0].outputs.len()];
    for start in (0..count).step_by(batch) {
        let points = start..count.min(start + batch);
        let slices: Vec<&[f32]> = inputs.iter().map(|input| &input[points.clone()]).collect();
        let mut outputs: Vec<&mut [f32]> = all.iter_mut().map(|output| &mut output[points.clone()]).collect();
        evaluator.evaluate(FunctionId(0), &slices, &mut outputs);
    }
    all
}

/// NaNs are all alike: their bits are not part of any promise.
fn bits(values: &[Vec<f32>]) -> Vec<u32> {
    values.iter().flatten().map(|x| if x.is_nan() { u32::MAX } else { x.to_bits() }).collect()
}

#[test]
fn values_do_not_depend_on_the_batch() {
    for seed in 0..60 {
        let shape = Shape { operations: 40, tame: seed % 2 == 0, ..Shape::default() };
        let module = module(vec![random::function(seed, &shape)]);
        let inputs = arguments(seed, 200, shape.inputs);
        let whole = bits(&evaluate(&module, &inputs, 200));
        for batch in [1, 3, 16, 64, 65, 127, 128, 129] {
            assert_eq!(
                bits(&evaluate(&module, &inputs, batch)),
                whole,
                "{}",
                text::print_function(&module.functions[0])
            );
        }
    }
}

#[test]
fn all_instruction_sets_compute_the_same() {
    for seed in 0..80 {
        let shape = Shape { operations: 60, tame: seed % 2 == 0, ..Shape::default() };
        let module = module(vec![random::function(seed, &shape)]);
        let inputs = arguments(seed, 150, shape.inputs);
        let slices: Vec<&[f32]> = inputs.iter().map(Vec::as_slice).collect();
        let tables = tables();
        let of = |isa: Isa| {
            let tapes = Tapes::of_module(&module).for_isa(isa);
            let mut all = vec![vec![0.0; 150]; module.functions[0].outputs.len()];
            let mut outputs: Vec<&mut [f32]> = all.iter_mut().map(Vec::as_mut_slice).collect();
            Evaluator::of_parts(&tapes, &UNIFORMS, &tables).evaluate(FunctionId(0), &slices, &mut outputs);
            bits(&all)
        };
        for isa in Isa::all() {
            assert_eq!(of(isa), of(Isa::BASELINE), "{}", isa.name());
        }
    }
}

#[test]
fn each_point_leaves_a_loop_at_its_own_step() {
    // Doubled while below 100; the state changes places with a copy at each step.
    let body = "fn f(1) {\n%0 = input 0\n%1 = loop 12 %0 %0 {\n%0 = input 0\n%1 = input 1\n%2 = constant 100.0\n\
        %3 = less %0 %2\n%4 = add %0 %0\nreturn %4 %0 %3\n}\n%2 = extract %1 0\n%3 = extract %1 1\nreturn %2 %3\n}";
    let module = module(vec![text::parse_function(body).expect("well-formed text")]);
    let inputs = [(0..150).map(|i| i as f32).collect::<Vec<f32>>()];
    let found = evaluate(&module, &inputs, 150);
    for (i, &x) in inputs[0].iter().enumerate() {
        let (mut last, mut before) = (x, x);
        for _ in 0..12 {
            if last < 100.0 {
                (last, before) = (last + last, last);
            }
        }
        assert_eq!([found[0][i], found[1][i]], [last, before], "{x}");
    }
}

#[test]
fn the_choices_of_special_values() {
    let body = "fn f(2) {\n%0 = input 0\n%1 = input 1\n%2 = min %0 %1\n%3 = max %0 %1\n%4 = sqrt %0\n%5 = less %0 %1\n\
        %6 = not %5\n%7 = or %5 %6\n%8 = and %5 %6\n%9 = select %7 %0 %1\n%10 = select %8 %0 %1\nreturn %2 %3 %4 %9 %10\n}";
    let module = module(vec![text::parse_function(body).expect("well-formed text")]);
    let inputs = [vec![0.0, -0.0, -4.0, 4.0], vec![-0.0, 0.0, 1.0, 1.0]];
    let found = evaluate(&module, &inputs, 4);
    let expected = [
        vec![-0.0, 0.0, -4.0, 1.0],
        vec![-0.0, 0.0, 1.0, 4.0],
        vec![0.0, 0.0, 0.0, 2.0],
        inputs[0].clone(),
        inputs[1].clone(),
    ];
    assert_eq!(bits(&found), bits(&expected));
}

#[test]
fn functions_share_the_registers_of_an_evaluator() {
    let small = text::parse_function("fn a(1) {\n%0 = input 0\n%1 = add %0 %0\nreturn %1\n}")
        .expect("well-formed text");
    let module = module(vec![small, random::function(3, &Shape::default())]);
    let (tapes, tables) = (Tapes::of_module(&module), tables());
    let mut evaluator = Evaluator::of_parts(&tapes, &UNIFORMS, &tables);
    let inputs = [[1.0_f32, 2.0].as_slice(), &[3.0, 4.0], &[5.0, 6.0]];
    let mut first = [[0.0; 2]; 3];
    evaluator.evaluate(FunctionId(1), &inputs, &mut first.each_mut().map(|o| o.as_mut_slice()));
    let mut doubled = [0.0; 2];
    evaluator.evaluate(FunctionId(0), &inputs[..1], &mut [&mut doubled]);
    assert_eq!(doubled, [2.0, 4.0]);
    let mut second = [[0.0; 2]; 3];
    evaluator.evaluate(FunctionId(1), &inputs, &mut second.each_mut().map(|o| o.as_mut_slice()));
    assert_eq!(first.map(|o| o.map(f32::to_bits)), second.map(|o| o.map(f32::to_bits)));
}

#[test]
fn closest_points_are_those_of_the_kernel() {
    let body = "fn f(3) {\n%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = closest[0] %0 %1 %2\n%4 = extract %3 0\n\
        %5 = extract %3 3\n%6 = extract %3 7\n%7 = extract %3 5\nreturn %4 %5 %6 %7\n}";
    let module = module(vec![text::parse_function(body).expect("well-formed text")]);
    let mut inputs = arguments(8, 300, 3);
    // Groups beside one place, in the middle of a ring, whose pieces are all as near, and of both kinds.
    for i in 0..96 {
        let beside = [1.0 + 0.001 * i as f32, 0.0, 0.1];
        let place = if i < 32 || (i >= 64 && i % 5 > 0) { beside } else { [1e-4 * i as f32, 0.0, 0.0] };
        inputs.iter_mut().zip(place).for_each(|(column, x)| column[i] = x);
    }
    // Short, long enough for boxes, and no curve at all.
    let spiral = |i: usize| [0.1, 0.2].map(|part| (i as f64 * 0.2 + part) * 0.4);
    let place = |angle: f64| [angle.cos() * 3.0, 0.2 * angle - 3.0, angle.sin() * (1.0 + 0.1 * angle)];
    let long: Vec<Quadratic> = (0..500)
        .map(|i| {
            let [middle, end] = spiral(i).map(place);
            Quadratic { a: place(i as f64 * 0.08), b: middle, c: end }
        })
        .collect();
    let ring = |part: f64| [part.cos(), part.sin(), 0.0];
    let ring = |i: usize| [0.0, 0.05, 0.1].map(|part| ring(i as f64 * 0.1 + part));
    let ring = (0..60).map(ring).map(|[a, b, c]| Quadratic { a, b, c }).collect();
    for segments in [curves()[0].clone(), long, ring, Vec::new()] {
        let table = prepare(&segments);
        let (tapes, curves) = (Tapes::of_module(&module), [table.clone()]);
        let mut evaluator = Evaluator::of_parts(&tapes, &UNIFORMS, &curves);
        let mut found = vec![vec![0.0; 300]; 4];
        let slices: Vec<&[f32]> = inputs.iter().map(Vec::as_slice).collect();
        let mut outputs: Vec<&mut [f32]> = found.iter_mut().map(Vec::as_mut_slice).collect();
        evaluator.evaluate(FunctionId(0), &slices, &mut outputs);
        for i in 0..300 {
            let p = [inputs[0][i], inputs[1][i], inputs[2][i]];
            let expected = crate::math::curve::closest(p, &table.pieces, &[]);
            let expected = [expected.t, expected.x, expected.stretch, expected.distance];
            assert_eq!([found[0][i], found[1][i], found[2][i], found[3][i]], expected);
        }
    }
}

/// Time per point of the batch kernel by length of the curve; run with `--ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn cost_by_length() {
    let body = "fn f(3) {\n%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = closest[0] %0 %1 %2\n%4 = extract %3 5\nreturn %4\n}";
    let module = module(vec![text::parse_function(body).expect("well-formed text")]);
    let tapes = Tapes::of_module(&module);
    for count in [1, 2, 4, 8, 10, 12, 16, 24, 32, 100, 1000, 10_000] {
        let place = |i: usize| {
            let angle = (i as f64 / count as f64) * 60.0;
            [angle.cos() * (1.0 + 0.02 * angle), 0.05 * angle - 1.5, angle.sin()]
        };
        let segments: Vec<Quadratic> = (0..count)
            .map(|i| Quadratic { a: place(2 * i), b: place(2 * i + 1), c: place(2 * i + 2) })
            .collect();
        let table = prepare(&segments);
        let mut bare = table.clone();
        bare.nodes.clear();
        // Rays through the curve, 64 points each, side by side.
        let points = 64 * 64;
        let coordinate = |f: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..points).map(|i| f((i / 64) as f32 / 64.0, (i % 64) as f32 / 64.0)).collect()
        };
        let inputs = [
            coordinate(|ray, t| 4.0 * t - 2.0 + 0.1 * ray),
            coordinate(|ray, _| 0.2 * ray),
            coordinate(|_, t| t - 0.5),
        ];
        let slices = inputs.each_ref().map(Vec::as_slice);
        // Ray by ray, the least of many times each: the machine may be busy.
        let time = |table: &CurveTable| {
            let curves = [table.clone()];
            let mut evaluator = Evaluator::of_parts(&tapes, &UNIFORMS, &curves);
            let mut sum = 0.0;
            for ray in (0..64).step_by(8) {
                let slices = slices.map(|slice| &slice[64 * ray..64 * ray + 64]);
                let mut least = f64::INFINITY;
                for _ in 0..20 {
                    let start = std::time::Instant::now();
                    evaluator.evaluate(FunctionId(0), &slices, &mut [&mut [0.0; 64][..]]);
                    least = least.min(start.elapsed().as_secs_f64());
                }
                sum += least;
            }
            sum / 512.0 * 1e9
        };
        println!(
            "{count} segments, {} pieces: {:.1} ns, all {:.1} ns",
            table.pieces.len(),
            time(&table),
            time(&bare)
        );
    }
}

#[test]
fn closest_gradients_are_those_of_the_kernel() {
    let body = "fn f(3) {\n%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = closest_gradient[0] %0 %1 %2\n\
        %4 = extract %3 1\n%5 = extract %3 3\n%6 = extract %3 6\n%7 = extract %3 7\nreturn %4 %5 %6 %7\n}";
    let module = module(vec![text::parse_function(body).expect("well-formed text")]);
    let inputs = arguments(9, 100, 3);
    let found = evaluate(&module, &inputs, 100);
    let table = &tables()[0];
    for i in 0..100 {
        let p = [inputs[0][i], inputs[1][i], inputs[2][i]];
        let expected = crate::math::curve::closest_gradient(p, &table.pieces, &[]);
        let expected = [expected.direction[1], expected.tangent[0], expected.rate, expected.slide];
        assert_eq!([found[0][i], found[1][i], found[2][i], found[3][i]], expected);
    }
}

#[test]
fn noise_is_that_of_the_kernels() {
    use crate::math::noise;
    for seed in [0, 9] {
        let body = format!(
            "fn f(4) {{\n%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = input 3\n%4 = constant 1.9\n%5 = constant -0.6\n\
             %6 = perlin[{seed}] %0 %1 %2\n%7 = perlin_gradient[{seed}] %0 %1 %2\n%8 = extract %7 2\n\
             %9 = fbm[{seed}] %0 %1 %2 %3 %4 %5\n%10 = fbm_gradient[{seed}] %0 %1 %2 %3 %4 %5\n%11 = extract %10 0\n\
             %12 = extract %10 3\nreturn %6 %8 %9 %11 %12\n}}"
        );
        let module = module(vec![text::parse_function(&body).expect("well-formed text")]);
        let inputs = arguments(seed.into(), 150, 4);
        let found = evaluate(&module, &inputs, 150);
        for i in 0..150 {
            let (p, octaves) = ([inputs[0][i], inputs[1][i], inputs[2][i]], inputs[3][i]);
            let sums = noise::fbm_gradient(p, octaves, 1.9, -0.6, seed);
            let gradient = noise::perlin_gradient(p, seed);
            let sum = noise::fbm(p, octaves, 1.9, -0.6, seed);
            let expected = [noise::perlin(p, seed), gradient[2], sum, sums[0], sums[3]];
            assert_eq!(
                array::from_fn(|k| found[k][i].to_bits()),
                expected.map(f32::to_bits),
                "{p:?} {octaves}"
            );
        }
    }
}

#[test]
fn further_noises_are_those_of_the_kernels() {
    use crate::math::noise;
    type Kernel = fn([f32; 4], u32) -> Vec<f32>;
    let kernels: [(&str, usize, Kernel); 5] = [
        ("perlin4", 4, |p, seed| noise::perlin4_gradient(p, seed).to_vec()),
        ("value", 3, |p, seed| noise::value_gradient([p[0], p[1], p[2]], seed).to_vec()),
        ("simplex", 3, |p, seed| noise::simplex_gradient([p[0], p[1], p[2]], seed).to_vec()),
        ("worley", 3, |p, seed| noise::worley_gradient([p[0], p[1], p[2]], seed).to_vec()),
        ("hash", 4, |p, seed| vec![noise::hash(p, seed)]),
    ];
    assert_eq!(noise::worley([0.3, 0.4, 0.5], 1), noise::worley_gradient([0.3, 0.4, 0.5], 1)[0]);
    for (name, operands, kernel) in kernels {
        for seed in [0, 9] {
            let place = ["%0", "%1", "%2", "%3"][..operands].join(" ");
            let mut body =
                String::from("fn f(4) {\n%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = input 3\n");
            body += &format!("%4 = {name}[{seed}] {place}\n");
            let slopes = if name == "hash" { 0 } else { operands };
            let mut outputs = String::from("%4");
            if slopes > 0 {
                body += &format!("%5 = {name}_gradient[{seed}] {place}\n");
                for part in 0..=slopes {
                    body += &format!("%{} = extract %5 {part}\n", 6 + part);
                    outputs += &format!(" %{}", 6 + part);
                }
            }
            body += &format!("return {outputs}\n}}");
            let module = module(vec![text::parse_function(&body).expect("well-formed text")]);
            let inputs = arguments(seed.into(), 150, 4);
            let found = evaluate(&module, &inputs, 150);
            for i in 0..150 {
                let expected = kernel(array::from_fn(|k| inputs[k][i]), seed);
                assert_eq!(found[0][i].to_bits(), expected[0].to_bits(), "{name}");
                for part in 0..found.len() - 1 {
                    assert_eq!(found[part + 1][i].to_bits(), expected[part].to_bits(), "{name} {part}");
                }
            }
        }
    }
}

#[test]
fn values_are_within_the_error_bound_of_the_reference() {
    let (mut decided, mut all) = (0, 0);
    for seed in 0..300 {
        let shape = Shape { operations: 4 + (seed % 12) as u32, tame: true, ..Shape::default() };
        let function = random::function(seed, &shape);
        let module = module(vec![function.clone()]);
        let inputs = arguments(seed, 40, shape.inputs);
        let found = evaluate(&module, &inputs, 40);
        for i in 0..40 {
            let point: Vec<f32> = inputs.iter().map(|input| input[i]).collect();
            let expected = error_bound::evaluate(&function, &point, &UNIFORMS.map(f64::from), &curves());
            for (output, bounded) in found.iter().zip(expected) {
                let distance = (f64::from(output[i]) - bounded.value).abs();
                all += 1;
                decided += u32::from(bounded.error.is_finite());
                assert!(
                    distance <= bounded.error || bounded.error.is_infinite() || bounded.error.is_nan(),
                    "{} at {point:?}: {} is not {bounded:?}",
                    text::print_function(&function),
                    output[i],
                );
            }
        }
    }
    assert!(decided * 2 > all, "{decided} of {all} are decided");
}

/// Ends of intervals, and numbers between: where a decision taken out too early would show.
#[test]
fn narrowed_functions_give_the_same_bits() {
    let mut fewer = 0;
    for seed in 0..300 {
        let shape = Shape { operations: 40, tame: seed % 2 == 0, ..Shape::default() };
        let function = random::function(seed, &shape);
        let mut random = Random::new(seed);
        let mut interval = || {
            let ends =
                [random.between(-4.0, 4.0), random.between(-4.0, 4.0)].map(|end| f64::from(end as f32));
            Interval::new(ends[0].min(ends[1]), ends[0].max(ends[1]))
        };
        let intervals: Vec<Interval> = (0..shape.inputs).map(|_| interval()).collect();
        let uniforms = UNIFORMS.map(|uniform| Interval::point(f64::from(uniform)));
        let narrowed = narrow::within(&function, &intervals, &uniforms);
        fewer += usize::from(narrowed.insts.len() < function.insts.len());
        let mut point = |within: &Interval| match random.below(3) {
            0 => within.lo as f32,
            1 => within.hi as f32,
            _ => random.between(within.lo, within.hi) as f32,
        };
        let inputs: Vec<Vec<f32>> =
            intervals.iter().map(|within| (0..100).map(|_| point(within)).collect()).collect();
        let printed = text::print_function(&function);
        let [before, after] =
            [function, narrowed].map(|function| evaluate(&module(vec![function]), &inputs, 100));
        assert_eq!(bits(&before), bits(&after), "{printed}");
    }
    assert!(fewer > 200, "{fewer} became shorter");
}
