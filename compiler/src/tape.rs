//! A function as a list of register operations, for interpreters.
//!
//! In: a verified [`Function`]. Out: a [`Tape`] that an interpreter walks from front to back:
//!
//! ```text
//! %0 = input 0               r0 = input 0
//! %1 = constant 2.0          r1 = constant 2.0
//! %2 = mul %0 %1             r1 = mul r0 r1        r1 is free again after its last use
//! %3 = perlin_gradient[0] …  r2..r5 = perlin_gradient r0 r1 r0
//! %4 = extract %3 2                                no operation: %4 is r4
//! return %4                  outputs: r4
//! ```
//!
//! | operation | reads | writes |
//! |---|---|---|
//! | [`TapeOp::Constant`] | nothing; truth values are 0 and 1 | one register |
//! | [`TapeOp::Input`], [`TapeOp::Uniform`] | an argument, an output of the frame function | one register |
//! | [`TapeOp::ApplyScalar`] | one register; the other operand is the same for all points | one register |
//! | [`TapeOp::Apply`] | as many registers as the operation has operands | consecutive registers, one per result |
//! | [`TapeOp::Loop`] | as many registers as the loop has operands | consecutive registers, one per number of the state |
//!
//! A result may have the register of an operand that is read for the last time. Values that no
//! output needs are left out.
//!
//! The body of a loop is a tape with registers of its own, of which the first are its inputs: they keep
//! their values to the end of a step, and an interpreter replaces the state between steps.

mod alloc;
mod link;

pub use link::{Carried, Link, links};

use crate::ir::{Function, ValueId};
use crate::ops::{Op, operation};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Most operands that an operation has.
pub const MAX_OPERANDS: usize = 6;

/// Index of a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Register(pub u32);

impl Register {
    /// As an index.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// The tapes of all functions of a program, kept from when somebody first asks for them. A copy starts without any: whoever
/// copies a program may change its functions.
#[derive(Debug, Default)]
pub struct KeptTapes(OnceLock<Arc<[Tape]>>);

impl KeptTapes {
    /// The tapes, by index of the function; made by `make` if nobody has asked before.
    pub fn get_or_make(&self, make: impl FnOnce() -> Arc<[Tape]>) -> Arc<[Tape]> {
        self.0.get_or_init(make).clone()
    }
}

impl Clone for KeptTapes {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// One step of a tape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TapeOp {
    /// A number.
    Constant {
        /// Register to write.
        to: Register,
        /// The number, rounded once.
        value: f32,
    },
    /// An argument of the function.
    Input {
        /// Register to write.
        to: Register,
        /// Which argument.
        index: u32,
    },
    /// An output of the frame function.
    Uniform {
        /// Register to write.
        to: Register,
        /// Which output.
        index: u32,
    },
    /// An operation of the table.
    Apply {
        /// Which one.
        op: Op,
        /// Seed of a noise, index of a curve.
        data: u32,
        /// First register to write, one per result.
        to: Register,
        /// Registers of the operands; entries past their number mean nothing.
        args: [Register; MAX_OPERANDS],
        /// Which results are read, one bit each from the lowest on; others need not be computed.
        wanted: u8,
    },
    /// An operation of two numbers, of which one is the same for all points.
    ApplyScalar {
        /// Which one, of those with [`takes_scalar`].
        op: Op,
        /// Whether the scalar is its first operand.
        scalar_first: bool,
        /// The scalar.
        scalar: Scalar,
        /// Register to write.
        to: Register,
        /// Register of the other operand.
        arg: Register,
    },
    /// A loop.
    Loop {
        /// Which of the tape's loops.
        index: u32,
        /// First register to write, one per number of the state.
        to: Register,
    },
}

impl TapeOp {
    /// Whether it is a few vector instructions, and not a function or a loop: what all points can do one step after the
    /// other.
    #[must_use]
    pub fn is_simple(&self) -> bool {
        match self {
            Self::Constant { .. } | Self::Input { .. } | Self::Uniform { .. } | Self::ApplyScalar { .. } => {
                true
            }
            Self::Apply { op, .. } => is_simple(*op),
            Self::Loop { .. } => false,
        }
    }

    /// The registers that it writes, in a tape with these loops.
    #[must_use]
    pub fn written(&self, loops: &[TapeLoop]) -> Range<usize> {
        let (to, results) = match *self {
            Self::Constant { to, .. }
            | Self::Input { to, .. }
            | Self::Uniform { to, .. }
            | Self::ApplyScalar { to, .. } => (to, 1),
            Self::Apply { op, to, .. } => (to, operation(op).results.len()),
            Self::Loop { index, to } => (to, loops[index as usize].state()),
        };
        to.index()..to.index() + results
    }

    /// The registers that it reads, in a tape with these loops.
    #[must_use]
    pub fn operands<'a>(&'a self, loops: &'a [TapeLoop]) -> &'a [Register] {
        match self {
            Self::Constant { .. } | Self::Input { .. } | Self::Uniform { .. } => &[],
            Self::Apply { op, args, .. } => &args[..operation(*op).args.len()],
            Self::ApplyScalar { arg, .. } => std::slice::from_ref(arg),
            Self::Loop { index, .. } => &loops[*index as usize].args,
        }
    }
}

/// A number that is the same for all points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scalar {
    /// Written in the function, rounded once.
    Number(f32),
    /// An output of the frame function.
    Uniform(u32),
}

impl Scalar {
    /// The number, given the outputs of the frame function.
    #[inline(always)]
    #[must_use]
    pub fn value(self, uniforms: &[f32]) -> f32 {
        match self {
            Self::Number(number) => number,
            Self::Uniform(index) => uniforms[index as usize],
        }
    }
}

/// Whether an operation is a few vector instructions, and not a function of its own.
#[must_use]
pub fn is_simple(op: Op) -> bool {
    takes_scalar(op)
        || matches!(
            op,
            Op::Neg | Op::Abs | Op::Floor | Op::Sqrt | Op::Equal | Op::And | Op::Or | Op::Not | Op::Select
        )
}

/// Whether an operation may have a scalar for an operand: those of a few instructions that take two numbers.
#[must_use]
pub fn takes_scalar(op: Op) -> bool {
    matches!(op, Op::Add | Op::Sub | Op::Mul | Op::Div | Op::Min | Op::Max | Op::Less | Op::LessEqual)
}

/// A loop of a tape.
#[derive(Clone, Debug, PartialEq)]
pub struct TapeLoop {
    /// Steps at most.
    pub most: u32,
    /// Registers of the tape around it that hold the first state and then what else the body reads;
    /// they go to the first registers of the body.
    pub args: Vec<Register>,
    /// One step: the first registers hold its inputs, which it does not change; its outputs are the
    /// next state and then whether to go there.
    pub body: Arc<Tape>,
}

impl TapeLoop {
    /// Numbers in the state.
    #[must_use]
    pub fn state(&self) -> usize {
        self.body.outputs.len() - 1
    }
}

/// A function ready to be interpreted.
#[derive(Clone, Debug, PartialEq)]
pub struct Tape {
    /// Number of arguments.
    pub inputs: u32,
    /// Registers of the results, once all steps are done.
    pub outputs: Vec<Register>,
    /// Number of registers.
    pub registers: u32,
    /// The steps in order.
    pub ops: Vec<TapeOp>,
    /// The instruction that each step computes; beside the steps, so that these stay small. None of a tape that was
    /// made of another one.
    pub values: Vec<ValueId>,
    /// The loops among them.
    pub loops: Vec<TapeLoop>,
    /// How each step is joined to its neighbours.
    pub links: Vec<Link>,
}

impl Tape {
    /// Allocates registers for a verified function.
    #[must_use]
    pub fn new(function: &Function) -> Self {
        alloc::allocate(function)
    }

    /// The same where each value has a register of its own, written once, in the order of the steps.
    #[must_use]
    pub fn with_own_registers(function: &Function) -> Self {
        alloc::number(function)
    }

    /// All steps with their links.
    #[must_use]
    pub fn steps(&self) -> (&[TapeOp], &[Link]) {
        (&self.ops, &self.links)
    }

    /// The same tape with the links of its steps, whatever it had before.
    #[must_use]
    pub fn linked(self) -> Self {
        Self { links: links(&self, |_| false), ..self }
    }

    /// Number of registers with those of loops: each has its own and a copy of its state, above those
    /// of the tape around it.
    #[must_use]
    pub fn all_registers(&self) -> usize {
        let inside = self.loops.iter().map(|inner| inner.body.all_registers() + inner.state()).max();
        self.registers as usize + inside.unwrap_or(0)
    }
}

/// A constant of the IR as the runtimes use it: rounded once, never infinite.
#[must_use]
pub fn rounded(constant: f64) -> f32 {
    (constant as f32).clamp(-f32::MAX, f32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::text;
    use crate::ir::verify::random;
    use crate::ir::walk::{self, Domain};
    use crate::ops::{self, Context};

    const UNIFORMS: [f64; 4] = [0.5, -2.0, 3.25, 100.0];

    /// The table's meaning, with constants rounded as on a tape.
    struct Direct;

    impl Domain for Direct {
        type Value = f64;

        fn constant(&mut self, number: f64) -> f64 {
            f64::from(rounded(number))
        }

        fn truth(&mut self, truth: bool) -> f64 {
            f64::from(u8::from(truth))
        }

        fn uniform(&mut self, index: usize) -> f64 {
            UNIFORMS[index]
        }

        fn apply(&mut self, op: Op, data: u32, _: &[ValueId], operands: &[f64]) -> ops::Results<f64> {
            (operation(op).meaning)(operands, Context { data, curves: &[] })
        }

        fn repeat(&mut self, most: u32, body: &Function, operands: &[f64]) -> Vec<f64> {
            walk::repeat(self, most, body, operands, |goes_on| goes_on != 0.0)
        }
    }

    /// The same from the tape, as its links tell. Registers start empty, or with the inputs of a loop's body; those of
    /// results that nothing reads are emptied, so that a clobbered register shows.
    fn by_tape(tape: &Tape, inputs: &[f64], inside: bool) -> Vec<f64> {
        let mut registers: Vec<Option<f64>> = vec![None; tape.registers as usize];
        if inside {
            registers[..inputs.len()].copy_from_slice(&inputs.iter().map(|&x| Some(x)).collect::<Vec<_>>());
        }
        let mut last = f64::NAN;
        for (step, link) in tape.ops.iter().zip(&tape.links) {
            let read = |r: &Register| registers[r.index()].expect("reads a register that was written");
            let operands =
                step.operands(&tape.loops).iter().enumerate().map(|(i, operand)| match (link.carried, i) {
                    (Carried::First | Carried::Both, 0) | (Carried::Second | Carried::Both, 1) => last,
                    _ => read(operand),
                });
            let operands: Vec<f64> = operands.collect();
            match *step {
                TapeOp::Constant { to, value } => registers[to.index()] = Some(f64::from(value)),
                TapeOp::Input { to, index } => registers[to.index()] = Some(inputs[index as usize]),
                TapeOp::Uniform { to, index } => registers[to.index()] = Some(UNIFORMS[index as usize]),
                TapeOp::Apply { op, data, to, wanted, .. } => {
                    let row = operation(op);
                    let results = (row.meaning)(&operands, Context { data, curves: &[] });
                    for (i, _) in row.results.iter().enumerate() {
                        registers[to.index() + i] = (wanted >> i & 1 == 1).then_some(results[i]);
                    }
                }
                TapeOp::ApplyScalar { op, scalar_first, scalar, to, .. } => {
                    let scalar = match scalar {
                        Scalar::Number(number) => f64::from(number),
                        Scalar::Uniform(index) => UNIFORMS[index as usize],
                    };
                    let args = if scalar_first { [scalar, operands[0]] } else { [operands[0], scalar] };
                    let result = (operation(op).meaning)(&args, Context::default())[0];
                    registers[to.index()] = Some(result);
                }
                TapeOp::Loop { index, to } => {
                    let repeated = &tape.loops[index as usize];
                    let mut state = operands;
                    for _ in 0..repeated.most {
                        let next = by_tape(&repeated.body, &state, true);
                        if next[repeated.state()] == 0.0 {
                            break;
                        }
                        state[..repeated.state()].copy_from_slice(&next[..repeated.state()]);
                    }
                    for i in 0..repeated.state() {
                        registers[to.index() + i] = Some(state[i]);
                    }
                }
            }
            if step.is_simple() {
                let to = step.written(&tape.loops).start;
                last = registers[to].expect("a step has a result");
                registers[to] = registers[to].filter(|_| link.kept);
            }
        }
        let unchanged = |i: usize| registers[i].map(f64::to_bits) == Some(inputs[i].to_bits());
        assert!(!inside || (0..inputs.len()).all(unchanged), "a body keeps its inputs");
        tape.outputs.iter().map(|r| registers[r.index()].expect("outputs were written")).collect()
    }

    #[test]
    fn tapes_are_made_once_and_anew_for_a_copy() {
        let made = std::cell::Cell::new(0);
        let make = || -> Arc<[Tape]> {
            made.set(made.get() + 1);
            Arc::new([])
        };
        let kept = KeptTapes::default();
        assert!(Arc::ptr_eq(&kept.get_or_make(make), &kept.get_or_make(make)));
        assert_eq!(made.get(), 1);
        kept.clone().get_or_make(make);
        assert_eq!(made.get(), 2);
    }

    #[test]
    fn tapes_compute_what_functions_mean() {
        for seed in 0..500 {
            let shape = random::Shape { curves: 0, operations: 60, ..random::Shape::default() };
            let function = random::function(seed, &shape);
            let inputs = [0.3, -1.75, 12.5];
            let bits = |values: Vec<f64>| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            let expected = bits(walk::walk(&mut Direct, &function, &inputs));
            for tape in [Tape::new(&function), Tape::with_own_registers(&function)] {
                let found = bits(by_tape(&tape, &inputs, false));
                assert_eq!(found, expected, "{}\n{tape:?}", text::print_function(&function));
            }
        }
    }

    #[test]
    fn chains_stay_out_of_registers() {
        let body = "fn f(2) {\n%0 = input 0\n%1 = input 1\n%2 = constant 2.0\n%3 = sub %0 %2\n%4 = mul %3 %3\n\
            %5 = sub %1 %4\n%6 = sin %5\n%7 = add %6 %4\nreturn %7\n}";
        let tape = Tape::new(&text::parse_function(body).expect("well-formed text"));
        let found: Vec<_> = tape.links.iter().map(|link| (link.carried, link.kept)).collect();
        // Loads of both inputs come just before they are read; the sine is no simple step.
        let expected = [
            (Carried::Nothing, false),
            (Carried::First, false),
            (Carried::Both, true),
            (Carried::Nothing, false),
            (Carried::First, true),
            (Carried::Nothing, true),
            (Carried::Nothing, true),
        ];
        assert_eq!(found, expected, "{tape:?}");
        let apart = links(&tape, |_| true);
        assert!(apart.iter().all(|link| link.carried == Carried::Nothing && link.kept), "{apart:?}");
    }

    #[test]
    fn registers_are_reused() {
        let mut body = "%0 = input 0\n".to_owned();
        for i in 1..100 {
            body += &format!("%{i} = add %{} %{}\n", i - 1, i - 1);
        }
        let function =
            text::parse_function(&format!("fn f(1) {{\n{body}return %99\n}}")).expect("well-formed text");
        assert_eq!(Tape::new(&function).registers, 1);
    }

    #[test]
    fn results_of_a_tuple_are_consecutive() {
        let function = text::parse_function(
            "fn f(3) {\n%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = perlin_gradient[5] %0 %1 %2\n\
             %4 = extract %3 3\n%5 = extract %3 1\n%6 = sub %4 %5\nreturn %6\n}",
        )
        .expect("well-formed text");
        let tape = Tape::new(&function);
        // Three inputs stop being needed at the noise, whose four results start where they stood.
        assert_eq!(tape.registers, 4);
        let TapeOp::Apply { op: Op::Sub, to, args, .. } = tape.ops[4] else { panic!("{tape:?}") };
        assert_eq!(
            (args[0], args[1], to, tape.outputs[0]),
            (Register(3), Register(1), Register(0), Register(0))
        );
    }

    #[test]
    fn leaves_are_loaded_before_their_first_use() {
        let function = text::parse_function(
            "fn f(1) {\n%0 = constant 1.0\n%1 = uniform 0\n%2 = boolean true\n%3 = input 0\n%4 = neg %3\n\
             %5 = select %2 %4 %0\n%6 = sin %1\nreturn %5 %0\n}",
        )
        .expect("well-formed text");
        let tape = Tape::new(&function);
        // The dead sine and its uniform are left out.
        assert_eq!(tape.ops.len(), 5);
        assert_eq!(tape.values, [3, 4, 2, 0, 5].map(ValueId));
        assert_eq!(tape.ops[0], TapeOp::Input { to: Register(0), index: 0 });
        assert_eq!(tape.ops[2], TapeOp::Constant { to: Register(1), value: 1.0 });
    }

    #[test]
    fn the_widest_operation_fits() {
        assert!(ops::TABLE.iter().all(|row| row.args.len() <= MAX_OPERANDS));
        assert!(size_of::<TapeOp>() <= 40);
    }

    #[test]
    fn constants_are_finite() {
        assert_eq!([rounded(1e300), rounded(-1e300), rounded(0.1)], [f32::MAX, -f32::MAX, 0.1]);
        assert_eq!(rounded(-0.0).to_bits(), (-0.0f32).to_bits());
    }
}
