//! Nanoseconds per point of the batch evaluator, one thread.
//!
//! `cargo bench -p vol-runtime-cpu --bench interp`; criterion reports points per second.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::fmt::Write as _;
use std::hint::black_box;
use vol_compiler::curve::{CurveTable, Quadratic, prepare};
use vol_compiler::ir::{FunctionId, Module, text};
use vol_compiler::ops::interval::Interval;
use vol_compiler::passes::narrow;
use vol_runtime_cpu::interp::{Evaluator, Tapes};

const POINTS: usize = 4096;

/// Twenty times `a <- min(a * x + b, y); b <- a`: 60 operations.
fn arithmetic() -> String {
    let mut body = String::from("%0 = input 0\n%1 = input 1\n%2 = input 2\n");
    let (mut a, mut b, mut next) = (2, 1, 3);
    for _ in 0..20 {
        let _ = writeln!(
            body,
            "%{next} = mul %{a} %0\n%{} = add %{next} %{b}\n%{} = min %{} %1",
            next + 1,
            next + 2,
            next + 1
        );
        (b, a) = (a, next + 2);
        next += 3;
    }
    let _ = write!(body, "return %{a}");
    body
}

/// A union of six balls: 60 operations, of which 5 choose.
fn balls() -> String {
    let mut body = String::from("%0 = input 0\n%1 = input 1\n%2 = input 2\n");
    let (mut next, mut union) = (3, None);
    let mut add = |line: String| {
        let _ = writeln!(body, "%{next} = {line}");
        next += 1;
        next - 1
    };
    for ball in 0..6 {
        let squares = [0, 1, 2].map(|axis| {
            let centre = add(format!("constant {:?}", ((ball * 7 + axis * 3) % 5) as f32 - 2.0));
            let offset = add(format!("sub %{axis} %{centre}"));
            add(format!("mul %{offset} %{offset}"))
        });
        let sum = add(format!("add %{} %{}", squares[0], squares[1]));
        let sum = add(format!("add %{sum} %{}", squares[2]));
        let length = add(format!("sqrt %{sum}"));
        let radius = add("constant 0.7".to_owned());
        let distance = add(format!("sub %{length} %{radius}"));
        union = Some(union.map_or(distance, |union| add(format!("min %{union} %{distance}"))));
    }
    body + &format!("return %{}", union.unwrap_or(0))
}

/// A function of three inputs that does something with its position.
fn of_position(what: &str, output: &str) -> String {
    format!(
        "%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = constant 5.0\n%4 = constant 2.0\n%5 = constant 0.5\n{what}\nreturn {output}"
    )
}

fn measure(c: &mut Criterion, name: &str, body: &str, curves: &[CurveTable]) {
    let function = text::parse_function(&format!("fn f(3) {{\n{body}\n}}")).expect("well-formed text");
    let tapes = Tapes::of_module(&Module { functions: vec![function], ..Module::default() });
    let mut evaluator = Evaluator::of_parts(&tapes, &[], curves);
    let coordinate = |step: f32| (0..POINTS).map(|i| (i as f32 * step) % 7.0 - 3.5).collect::<Vec<f32>>();
    let (x, y, z) = (coordinate(0.371), coordinate(0.113), coordinate(0.057));
    let mut output = vec![0.0; POINTS];
    let mut group = c.benchmark_group("interp");
    group.throughput(Throughput::Elements(POINTS as u64));
    group.bench_function(name, |b| {
        b.iter(|| evaluator.evaluate(FunctionId(0), black_box(&[&x, &y, &z]), black_box(&mut [&mut output])));
    });
    group.finish();
}

/// What a function becomes in a box: bounds of all its values, and the function without what they decide.
fn intervals(c: &mut Criterion) {
    let function = text::parse_function(&format!("fn f(3) {{\n{}\n}}", balls())).expect("well-formed text");
    let small = [Interval::new(0.0, 0.25), Interval::new(-0.5, -0.25), Interval::new(1.0, 1.25)];
    c.bench_function("intervals/csg_60", |b| {
        b.iter(|| narrow::within(black_box(&function), black_box(&small), &[]));
    });
}

fn interp(c: &mut Criterion) {
    let arch = Quadratic { a: [-2.0, 0.0, 0.0], b: [0.0, 3.0, 1.0], c: [2.0, 0.0, 0.5] };
    let back = Quadratic { a: [2.0, 0.0, 0.5], b: [4.0, -3.0, 0.0], c: [0.0, -2.0, -1.0] };
    let curves = [prepare(&[arch, back])];
    measure(c, "arithmetic_60", &arithmetic(), &[]);
    measure(c, "csg_60", &balls(), &[]);
    for (kind, seed) in [("hash", 7), ("table", 0)] {
        measure(
            c,
            &format!("perlin_{kind}"),
            &of_position(&format!("%6 = perlin[{seed}] %0 %1 %2"), "%6"),
            &[],
        );
        let fbm = format!("%6 = fbm[{seed}] %0 %1 %2 %3 %4 %5");
        measure(c, &format!("fbm_5_{kind}"), &of_position(&fbm, "%6"), &[]);
    }
    let gradient = "%6 = perlin_gradient[7] %0 %1 %2\n%7 = extract %6 1";
    measure(c, "perlin_gradient_hash", &of_position(gradient, "%7"), &[]);
    let closest = "%6 = closest[0] %0 %1 %2\n%7 = extract %6 5";
    measure(c, "closest_2_segments", &of_position(closest, "%7"), &curves);
    measure(c, "sin", &of_position("%6 = sin %0", "%6"), &[]);
    measure(c, "exp2", &of_position("%6 = exp2 %0", "%6"), &[]);
}

criterion_group!(benches, interp, intervals);
criterion_main!(benches);
