//! Which operation of a function is to blame, and what in the scene it stands for.
//!
//! In: a function, a place, an output that is wrong there. Out: the operation at which it begins to be wrong.
//! All values of the function are computed, then followed from the output towards the inputs for as long as
//! an operand is wrong, too:
//!
//! * not finite: while an operand is not finite;
//! * lost digits: while one operand's error accounts for most of the result's, and is more than its own
//!   rounding;
//! * a jump between two places: while an operand jumps as well.

use vol_compiler::error_bound::{self, Bounded};
use vol_compiler::frame::Frame;
use vol_compiler::ir::{Function, FunctionId, Inst, Module, ValueId};
use vol_compiler::ops::{self, Context, Op, Operation};
use vol_compiler::program::Program;
use vol_compiler::reference;
use vol_language::source::Span;
use vol_runtime_cpu::interp::{Evaluator, Tapes};

use crate::probe::Probe;

use super::findings::{At, written};
use super::targets::Target;

/// An operand that is off by less than this part of itself is as good as f32 can be.
const ROUNDED: f64 = 1.0 / 1_048_576.0;

/// What is to blame.
#[derive(Clone, Debug)]
pub(super) struct Blame {
    /// Its place; none if only the block is known.
    pub(super) span: Option<Span>,
    /// What it does there.
    pub(super) label: String,
}

/// The operations of one function.
pub(super) struct Narrow<'a> {
    frame: &'a Frame,
    function: &'a Function,
    places: Vec<Option<Span>>,
    probe: Probe,
}

impl<'a> Narrow<'a> {
    pub(super) fn new(program: &'a Program, frame: &'a Frame, target: &Target) -> Self {
        let function = program.module.function(target.function);
        let origins = program.origins.get(target.function.index());
        let places = origins.map_or_else(|| vec![None; function.insts.len()], |o| o.places(function));
        Self { frame, function, places, probe: Probe::new(function) }
    }

    /// Where infinity or what is no number comes from.
    pub(super) fn not_finite(&self, at: At<'_>) -> Blame {
        let values = self.singles(at.inputs);
        let of = |value: ValueId| self.probe.outputs[value.index()].map(|output| values[output]);
        let wrong = |value: ValueId| of(value).is_some_and(|x| !x.is_finite());
        let value = self.follow(self.function.outputs[at.output], |operands| {
            operands.iter().copied().find(|&operand| wrong(operand))
        });
        let operands = self.operands(value);
        let shown: Vec<String> =
            operands.iter().filter_map(|&operand| Some(written(f64::from(of(operand)?)))).collect();
        let result = of(value).map_or(f64::NAN, f64::from);
        self.blame(value, |name| format!("`{name}` of {} is {}", shown.join(" and "), written(result)))
    }

    /// Where the error comes from.
    pub(super) fn lost_digits(&self, at: At<'_>) -> Blame {
        let values =
            error_bound::evaluate(&self.probe.function, at.inputs, &self.frame.uniforms, &self.frame.curves);
        let of = |value: ValueId| self.probe.outputs[value.index()].map(|output| values[output]);
        let mut value = self.function.outputs[at.output];
        loop {
            let inner = self.through(value);
            let Some(next) = self.main_source(inner, &of) else { break };
            value = next;
        }
        let value = self.through(value);
        let largest = self.operands(value).into_iter().filter_map(of);
        let largest = largest.map(|operand| operand.value.abs()).fold(0.0, f64::max);
        self.blame(value, |name| format!("`{name}` of numbers up to {} loses them", written(largest)))
    }

    /// The operand whose error explains that of a value, unless it is only rounded.
    fn main_source(&self, value: ValueId, of: &impl Fn(ValueId) -> Option<Bounded>) -> Option<ValueId> {
        let Inst::Apply { op, data, args } = &self.function.insts[value.index()] else {
            return self.operands(value).into_iter().find(|&operand| of(operand).is_some_and(is_off));
        };
        let row = ops::operation(*op);
        let context = Context { data: *data, curves: &self.frame.curves };
        let operands: Vec<Bounded> =
            args.iter().map(|&arg| of(arg).unwrap_or(Bounded { value: 0.0, error: 0.0 })).collect();
        let alone = (0..args.len()).map(|i| {
            let error = |k: usize| if k == i { operands[k].error } else { 0.0 };
            (i, error_of(row, &operands, error, context))
        });
        let own = error_of(row, &operands, |_| 0.0, context);
        let (main, most) = alone.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (most > 2.0 * own && is_off(operands[main])).then_some(args[main])
    }

    /// What jumps first between two places.
    pub(super) fn jumps(&self, ends: [&[f64]; 2], output: usize) -> Blame {
        let values = ends.map(|inputs| {
            reference::evaluate(&self.probe.function, inputs, &self.frame.uniforms, &self.frame.curves)
        });
        let change = |value: ValueId| {
            self.probe.outputs[value.index()].map_or(0.0, |output| {
                let [a, b] = [values[0][output], values[1][output]];
                let size = a.abs().max(b.abs()).max(1e-3);
                if a == b { 0.0 } else { (a - b).abs() / size }
            })
        };
        let value = self.follow(self.function.outputs[output], |operands| {
            let most = operands.iter().copied().max_by(|&a, &b| change(a).total_cmp(&change(b)));
            most.filter(|&operand| change(operand) > 1e-5)
        });
        self.blame(value, |name| format!("`{name}` jumps"))
    }

    /// From a value towards the inputs, as long as there is somewhere to go.
    fn follow(&self, value: ValueId, next: impl Fn(&[ValueId]) -> Option<ValueId>) -> ValueId {
        let mut value = self.through(value);
        while let Some(operand) = next(&self.operands(value)) {
            value = self.through(operand);
        }
        value
    }

    /// What a value is a part of, if it is one.
    fn through(&self, value: ValueId) -> ValueId {
        match &self.function.insts[value.index()] {
            Inst::Extract(tuple, _) => *tuple,
            Inst::Constant(_)
            | Inst::Boolean(_)
            | Inst::Input(_)
            | Inst::Uniform(_)
            | Inst::Apply { .. }
            | Inst::Loop { .. } => value,
        }
    }

    fn operands(&self, value: ValueId) -> Vec<ValueId> {
        self.function.insts[value.index()].operands().to_vec()
    }

    /// All numbers of the function in f32.
    fn singles(&self, inputs: &[f32]) -> Vec<f32> {
        let module = Module { frame: Function::default(), functions: vec![self.probe.function.clone()] };
        let tapes = Tapes::of_module(&module);
        let frame = self.frame;
        let mut evaluator = Evaluator::of_parts(&tapes, &frame.uniforms_f32, &frame.curve_tables);
        let mut values = vec![[0.0]; self.probe.function.outputs.len()];
        let mut slices: Vec<&mut [f32]> = values.iter_mut().map(<[f32; 1]>::as_mut_slice).collect();
        let inputs: Vec<&[f32]> = inputs.iter().map(std::slice::from_ref).collect();
        evaluator.evaluate(FunctionId(0), &inputs, &mut slices);
        values.into_iter().map(|[value]| value).collect()
    }

    fn blame(&self, value: ValueId, label: impl Fn(&str) -> String) -> Blame {
        let name = match &self.function.insts[value.index()] {
            Inst::Apply { op, .. } => spelled(*op),
            Inst::Loop { .. } => "iterate",
            Inst::Uniform(_) => "a number of this moment",
            Inst::Constant(_) | Inst::Boolean(_) | Inst::Input(_) | Inst::Extract(..) => "a number",
        };
        Blame { span: self.place(value), label: label(name) }
    }

    /// The place of a value, or of the nearest one that uses it.
    fn place(&self, value: ValueId) -> Option<Span> {
        if let Some(place) = self.places[value.index()] {
            return Some(place);
        }
        let later = (value.0 + 1..self.function.insts.len() as u32).map(ValueId);
        let user = later
            .filter(|user| self.function.insts[user.index()].operands().contains(&value))
            .find_map(|user| self.places[user.index()]);
        user.or_else(|| self.operands(value).into_iter().find_map(|operand| self.places[operand.index()]))
    }
}

/// Whether a number is worse than f32 makes it.
fn is_off(number: Bounded) -> bool {
    number.error > ROUNDED * number.value.abs()
}

/// Largest error of the results with given errors of the operands.
fn error_of(
    row: &Operation,
    operands: &[Bounded],
    error: impl Fn(usize) -> f64,
    context: Context<'_>,
) -> f64 {
    let values: Vec<f64> = operands.iter().map(|operand| operand.value).collect();
    let errors: Vec<f64> = (0..operands.len()).map(error).collect();
    let results = (row.meaning)(&values, context);
    let found = (row.error)(&values, &errors, &results, context);
    found[..row.results.len()].iter().map(|x| if x.is_nan() { f64::INFINITY } else { *x }).fold(0.0, f64::max)
}

/// An operation as scenes write it.
fn spelled(op: Op) -> &'static str {
    match op {
        Op::Add => "+",
        Op::Sub => "-",
        Op::Mul => "*",
        Op::Div => "/",
        Op::Neg => "-",
        Op::Less => "<",
        Op::LessEqual => "<=",
        Op::Equal => "==",
        Op::Select => "if",
        _ => ops::operation(op).name,
    }
}
