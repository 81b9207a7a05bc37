//! Nanoseconds per point of the batch evaluator, one thread.
//!
//! `cargo bench -p vol-runtime-cpu --bench interp`; criterion reports points per second.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::fmt::Write as _;
use std::hint::black_box;
use vol_compiler::curve::{CurveTable, Quadratic, prepare};
use vol_compiler::ir::{FunctionId, Module, text};
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

fn interp(c: &mut Criterion) {
    let arch = Quadratic { a: [-2.0, 0.0, 0.0], b: [0.0, 3.0, 1.0], c: [2.0, 0.0, 0.5] };
    let back = Quadratic { a: [2.0, 0.0, 0.5], b: [4.0, -3.0, 0.0], c: [0.0, -2.0, -1.0] };
    let curves = [prepare(&[arch, back])];
    measure(c, "arithmetic_60", &arithmetic(), &[]);
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

criterion_group!(benches, interp);
criterion_main!(benches);
