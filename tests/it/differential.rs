//! CPU, GPU and f64 reference against each other: every operation of the table, random functions,
//! every field of every example. The tolerance is the running error bound, never a guess.

use crate::support::{FIRST, Random, compile_file, ensure, examples, frame, point, program_of};
use libtest_mimic::{Failed, Trial};
use std::path::{Path, PathBuf};
use vol::backend::Device;
use vol::compare::{self, FieldReport};
use vol_compiler::error_bound::{self, Bounded};
use vol_compiler::frame::Frame;
use vol_compiler::ir::verify::random;
use vol_compiler::ir::{Function, Inst, Number, ValueId};
use vol_compiler::ops::{Operation, TABLE, Ty};
use vol_compiler::program::Program;

/// Points per operation.
const OPERATION_POINTS: usize = 2000;

/// Random functions per run.
const FUNCTIONS: u64 = 60;

/// Points per random function and field.
const POINTS: usize = 400;

/// Values of a function at rows of inputs.
type Evaluate = dyn Fn(&Program, &Frame, &[f32]) -> Result<Vec<f32>, Failed>;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = Vec::new();
    for operation in TABLE {
        let name = operation.name;
        trials.push(Trial::test(format!("differential::operation_{name}__cpu"), move || {
            check_operation(operation, &on_cpu)
        }));
        #[cfg(feature = "gpu")]
        trials.push(crate::gpu_device::gpu_trial(&format!("differential::operation_{name}"), move |gpu| {
            check_operation(operation, &on_gpu(gpu))
        }));
    }
    trials.push(Trial::test("differential::random_functions__cpu", || random_functions(&on_cpu)));
    #[cfg(feature = "gpu")]
    trials.push(crate::gpu_device::gpu_trial("differential::random_functions", |gpu| {
        random_functions(&on_gpu(gpu))
    }));
    for (name, path) in examples() {
        trials.extend(example_trials(&name, path));
    }
    trials
}

fn example_trials(name: &str, path: PathBuf) -> Vec<Trial> {
    let scene = path.clone();
    #[cfg_attr(not(feature = "gpu"), expect(unused_mut, reason = "the GPU trial is added to it"))]
    let mut trials = vec![Trial::test(format!("differential::fields_of_{name}__cpu"), move || {
        check_fields(&scene, &|program, frame, id, points| {
            Device::Cpu.evaluate(program, frame, id, points).map_err(|failure| format!("{failure:?}").into())
        })
    })];
    #[cfg(feature = "gpu")]
    trials.push(crate::gpu_device::gpu_trial(&format!("differential::fields_of_{name}"), move |gpu| {
        check_fields(&path, &|program, frame, id, points| {
            Ok(vol_runtime_gpu::evaluate(gpu, program, frame, id, points.as_flattened())?)
        })
    }));
    trials
}

pub(crate) fn on_cpu(program: &Program, frame: &Frame, inputs: &[f32]) -> Result<Vec<f32>, Failed> {
    let function = program.module.function(FIRST);
    let tapes = vol_runtime_cpu::interp::Tapes::new(program);
    let mut evaluator = vol_runtime_cpu::interp::Evaluator::new(&tapes, frame);
    let width = function.inputs as usize;
    let rows = inputs.len() / width.max(1);
    let columns: Vec<Vec<f32>> =
        (0..width).map(|i| inputs.iter().skip(i).step_by(width).copied().collect()).collect();
    let columns: Vec<&[f32]> = columns.iter().map(Vec::as_slice).collect();
    let mut outputs = vec![vec![0.0; rows]; function.outputs.len()];
    let mut slices: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
    evaluator.evaluate(FIRST, &columns, &mut slices);
    Ok((0..rows).flat_map(|row| outputs.iter().map(move |output| output[row])).collect())
}

#[cfg(feature = "gpu")]
pub(crate) fn on_gpu(
    gpu: &vol_runtime_gpu::Gpu,
) -> impl Fn(&Program, &Frame, &[f32]) -> Result<Vec<f32>, Failed> {
    move |program, frame, inputs| Ok(vol_runtime_gpu::evaluate(gpu, program, frame, FIRST, inputs)?)
}

/// A function that applies one operation to its inputs; truth values are `input > 1/2`.
pub(crate) fn function_of(operation: &Operation, data: u32) -> Function {
    let mut insts = Vec::new();
    let mut push = |inst: Inst| {
        insts.push(inst);
        ValueId(insts.len() as u32 - 1)
    };
    let half = push(Inst::Constant(Number(0.5)));
    let mut args = Vec::new();
    for (i, ty) in (0..).zip(operation.args) {
        let input = push(Inst::Input(i));
        args.push(match ty {
            Ty::Number => input,
            Ty::Bool => {
                push(Inst::Apply { op: vol_compiler::ops::Op::Less, data: 0, args: vec![half, input] })
            }
        });
    }
    let result = push(Inst::Apply { op: operation.op, data, args });
    let mut outputs = Vec::new();
    if operation.results.len() > 1 {
        outputs.extend((0..operation.results.len() as u32).map(|i| push(Inst::Extract(result, i))));
    } else if operation.results[0] == Ty::Bool {
        let (one, zero) = (push(Inst::Constant(Number(1.0))), push(Inst::Constant(Number(0.0))));
        let args = vec![result, one, zero];
        outputs.push(push(Inst::Apply { op: vol_compiler::ops::Op::Select, data: 0, args }));
    } else {
        outputs.push(result);
    }
    Function { name: operation.name.to_owned(), inputs: operation.args.len() as u32, insts, outputs }
}

/// Random operands from the operation's domain, every eighth on a whole number or an end.
pub(crate) fn operands(operation: &Operation) -> Vec<f32> {
    let mut random = Random::new(operation.op as u64 + 1);
    let mut rows = Vec::new();
    for row in 0..OPERATION_POINTS {
        for (i, _) in operation.args.iter().enumerate() {
            let (lo, hi) = operation.domain.get(i).copied().unwrap_or((0.0, 1.0));
            let value = random.between(lo, hi);
            rows.push(match row % 8 {
                0 => value.round().clamp(lo, hi),
                1 if random.below(4) == 0 => lo,
                _ => value,
            } as f32);
        }
    }
    rows
}

fn check_operation(operation: &Operation, evaluate: &Evaluate) -> Result<(), Failed> {
    // Two seeds of noises, of which 0 is a case of its own; two curves.
    for data in if operation.has_data { 0..2 } else { 0..1 } {
        let function = function_of(operation, data);
        let (report, _) = compare_function(function, &operands(operation), evaluate)?;
        ensure(report.passes(), || format!("{}[{data}]: {report:?}", operation.name))?;
        ensure(report.undecided * 2 < report.points, || {
            format!("{}[{data}]: hardly anything decided: {report:?}", operation.name)
        })?;
    }
    Ok(())
}

/// Compares a function at rows of inputs with the reference and its bound.
fn compare_function(
    function: Function,
    inputs: &[f32],
    evaluate: &Evaluate,
) -> Result<(FieldReport, Vec<Bounded>), Failed> {
    let program = program_of(function)?;
    let frame = frame(&program, 0.0, [8, 8])?;
    let function = program.module.function(FIRST);
    let expected: Vec<Bounded> = inputs
        .chunks_exact(function.inputs as usize)
        .flat_map(|row| error_bound::evaluate(function, row, &frame.uniforms, &frame.curves))
        .collect();
    let actual = evaluate(&program, &frame, inputs)?;
    Ok((compare::field(&actual, &expected, function.outputs.len()), expected))
}

/// Random well-formed functions within the domains of the operations.
fn random_functions(evaluate: &Evaluate) -> Result<(), Failed> {
    let mut decided = 0;
    for seed in 0..FUNCTIONS {
        let shape = random::Shape { uniforms: 0, curves: 2, tame: true, ..random::Shape::default() };
        let function = random::function(seed, &shape);
        let mut random = Random::new(seed);
        let inputs: Vec<f32> = (0..POINTS).flat_map(|_| point(&mut random, [-2.0; 3], [2.0; 3])).collect();
        let text = vol_compiler::ir::text::print_function(&function);
        let (report, _) = compare_function(function, &inputs, evaluate)?;
        ensure(report.passes(), || format!("function of seed {seed}: {report:?}\n{text}"))?;
        decided += report.points - report.undecided;
    }
    let all = FUNCTIONS as usize * POINTS;
    ensure(decided * 4 > all, || format!("only {decided} of {all} points are decided"))
}

/// Values of a field at points.
pub(crate) type EvaluateField =
    dyn Fn(&Program, &Frame, vol_compiler::ir::FunctionId, &[[f32; 3]]) -> Result<Vec<f32>, Failed>;

/// Every field of a scene at points scattered over its bounds, at two moments.
fn check_fields(path: &Path, evaluate: &EvaluateField) -> Result<(), Failed> {
    let program = compile_file(path)?;
    ensure(!program.fields.is_empty(), || "the scene has no fields".into())?;
    for time in [0.0, 1.7] {
        let frame = frame(&program, time, [8, 8])?;
        for (name, report) in compare_fields(&program, &frame, POINTS, evaluate)? {
            ensure(report.passes(), || format!("{name} at {time} s: {report:?}"))?;
            ensure(report.undecided < report.points, || format!("{name}: nothing decided"))?;
        }
    }
    Ok(())
}

/// Every field of a program at points scattered over the bounds of a frame, against the reference.
pub(crate) fn compare_fields(
    program: &Program,
    frame: &Frame,
    count: usize,
    evaluate: &EvaluateField,
) -> Result<Vec<(String, FieldReport)>, Failed> {
    let points = compare::scatter(&frame.bounds, count as u32);
    let compared = program.fields.iter().map(|field| {
        let function = program.module.function(field.function);
        let expected = compare::expected(function, frame, &points);
        let actual = evaluate(program, frame, field.function, &points)?;
        Ok((field.name.clone(), compare::field(&actual, &expected, function.outputs.len())))
    });
    compared.collect()
}
