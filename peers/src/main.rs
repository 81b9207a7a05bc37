//! Nanoseconds per point of the batch evaluator on one thread, beside native code and the `fidget` crate.
//!
//! Everything is measured in turns, many times, and the least of each counts: other programs on the machine can only add.
//! Prints a table in Markdown.

mod fields;

use fidget::context::Tree;
use fidget::jit::JitShape;
use fidget::shape::EzShape;
use fidget::vm::VmShape;
use pulp::{Simd, WithSimd};
use std::hint::black_box;
use std::time::Instant;
use vol_compiler::curve::{CurveTable, Quadratic, prepare};
use vol_compiler::ir::{FunctionId, Module, text};
use vol_runtime_cpu::Isa;
use vol_runtime_cpu::interp::{Evaluator, Tapes};

/// Points that are evaluated at once: their coordinates and values stay in the second cache.
const POINTS: usize = 4096;
/// Rounds of all measurements.
const ROUNDS: usize = 200;

/// One way to evaluate a field at all points.
struct Contender<'a> {
    name: String,
    run: Box<dyn FnMut() + 'a>,
    least: f64,
}

impl<'a> Contender<'a> {
    fn new(name: impl Into<String>, run: impl FnMut() + 'a) -> Self {
        Self { name: name.into(), run: Box::new(run), least: f64::INFINITY }
    }
}

/// Native code for the instructions that this machine has, as the evaluator's own kernels are.
struct Native<'a, F> {
    points: &'a Points,
    out: &'a mut [f32],
    field: F,
}

impl<F: Fn([f32; 3]) -> f32> WithSimd for Native<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Points { x, y, z } = self.points;
        for (out, ((&x, &y), &z)) in self.out.iter_mut().zip(x.iter().zip(y).zip(z)) {
            *out = (self.field)([x, y, z]);
        }
    }
}

/// Coordinates of all points.
struct Points {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

fn main() {
    let coordinate = |step: f32| (0..POINTS).map(|i| (i as f32 * step) % 7.0 - 3.5).collect();
    let points = Points { x: coordinate(0.371), y: coordinate(0.113), z: coordinate(0.057) };
    println!("| field | evaluator | ns per point | over native |");
    println!("|---|---|---|---|");
    compare(
        "60 operations: multiply, add, min",
        &points,
        &fields::arithmetic(),
        fields::arithmetic_native,
        fields::arithmetic_tree(),
    );
    compare(
        "union of six balls, 65 operations",
        &points,
        &fields::balls(),
        fields::balls_native,
        fields::balls_tree(),
    );
    alone(&points);
}

fn compare(field: &str, points: &Points, body: &str, native: impl Fn([f32; 3]) -> f32 + Copy, tree: Tree) {
    let tapes: Vec<Tapes> = Isa::all().into_iter().map(|isa| tapes(body).for_isa(isa)).collect();
    let mut native_out = vec![0.0; POINTS];
    let (vm, jit) = (VmShape::from(tree.clone()), JitShape::from(tree));
    let (vm_tape, jit_tape) = (vm.ez_float_slice_tape(), jit.ez_float_slice_tape());
    let (mut vm, mut jit) = (VmShape::new_float_slice_eval(), JitShape::new_float_slice_eval());
    let Points { x, y, z } = points;
    let mut contenders = vec![Contender::new("native code", || {
        pulp::Arch::new().dispatch(Native { points, out: &mut native_out, field: native });
        black_box(&mut native_out);
    })];
    for (tapes, isa) in tapes.iter().zip(Isa::all()) {
        contenders.push(Contender::new(format!("vol, {}", isa.name()), ours(tapes, points, &[])));
    }
    contenders.push(Contender::new("fidget, JIT", || {
        drop(black_box(jit.eval(&jit_tape, x, y, z).map(<[f32]>::len)))
    }));
    contenders
        .push(Contender::new("fidget, VM", || drop(black_box(vm.eval(&vm_tape, x, y, z).map(<[f32]>::len)))));
    measure(&mut contenders);
    let base = contenders[0].least;
    for contender in &contenders {
        println!("| {field} | {} | {:.2} | {:.2} |", contender.name, contender.least, contender.least / base);
    }
}

/// The functions of their own that take most of the time of a picture.
fn alone(points: &Points) {
    let arch = Quadratic { a: [-2.0, 0.0, 0.0], b: [0.0, 3.0, 1.0], c: [2.0, 0.0, 0.5] };
    let curves = [prepare(&[arch])];
    let fields = [
        (
            format!("closest point, a curve of {} pieces", curves[0].pieces.len()),
            "%6 = closest[0] %0 %1 %2\n%7 = extract %6 5",
            "%7",
        ),
        ("Perlin, hashed".to_owned(), "%6 = perlin[7] %0 %1 %2", "%6"),
        ("Perlin, published table".to_owned(), "%6 = perlin[0] %0 %1 %2", "%6"),
        ("fBm, 5 octaves, hashed".to_owned(), "%6 = fbm[7] %0 %1 %2 %3 %4 %5", "%6"),
        ("fBm, 5 octaves, published table".to_owned(), "%6 = fbm[0] %0 %1 %2 %3 %4 %5", "%6"),
    ];
    for (name, body, output) in fields {
        let body = format!(
            "%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = constant 5.0\n%4 = constant 2.0\n%5 = constant 0.5\n{body}\nreturn {output}"
        );
        let all: Vec<Tapes> = Isa::all().into_iter().map(|isa| tapes(&body).for_isa(isa)).collect();
        let mut contenders: Vec<_> = all
            .iter()
            .zip(Isa::all())
            .map(|(tapes, isa)| Contender::new(format!("vol, {}", isa.name()), ours(tapes, points, &curves)))
            .collect();
        measure(&mut contenders);
        for contender in &contenders {
            println!("| {name} | {} | {:.2} | |", contender.name, contender.least);
        }
    }
}

fn tapes(body: &str) -> Tapes {
    let function = text::parse_function(&format!("fn f(3) {{\n{body}\n}}")).expect("well-formed text");
    Tapes::of_module(&Module { functions: vec![function], ..Module::default() })
}

fn ours<'a>(tapes: &'a Tapes, points: &'a Points, curves: &'a [CurveTable]) -> impl FnMut() + 'a {
    let mut evaluator = Evaluator::of_parts(tapes, &[], curves);
    let mut out = vec![0.0; POINTS];
    move || {
        evaluator.evaluate(FunctionId(0), &[&points.x, &points.y, &points.z], &mut [&mut out]);
        black_box(&mut out);
    }
}

/// Nanoseconds per point of each, the least over all rounds.
fn measure(contenders: &mut [Contender<'_>]) {
    for _ in 0..ROUNDS {
        for contender in contenders.iter_mut() {
            let started = Instant::now();
            (contender.run)();
            let took = started.elapsed().as_secs_f64() * 1e9 / POINTS as f64;
            contender.least = contender.least.min(took);
        }
    }
}
