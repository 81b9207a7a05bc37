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
mod tests;
