//! The intermediate representation: flat functions of scalars.
//!
//! A [`Function`] is a list of instructions in SSA form. Operands always stand before their users,
//! vectors are already split into scalars, and there are no branches: both sides of an `if` are
//! computed and [`Op::Select`] picks one. The one thing that repeats is [`Inst::Loop`], whose body is
//! a function of its own. Text form, one instruction a line:
//!
//! ```text
//! fn distance:ball(3) {
//!   %0 = input 0
//!   %1 = constant 2.0
//!   %2 = uniform 4
//!   %3 = mul %0 %1
//!   %4 = perlin[0] %0 %1 %2
//!   %5 = closest[1] %0 %1 %2
//!   %6 = extract %5 3
//!   %7 = loop 8 %0 %1 {
//!     %0 = input 0
//!     %1 = input 1
//!     %2 = mul %0 %1
//!     %3 = less %0 %1
//!     return %2 %3
//!   }
//!   %8 = extract %7 0
//!   return %4 %8
//! }
//! ```
//!
//! Arithmetic: constants and the frame function are computed in f64 and rounded once to f32 where a
//! point function uses them; a point function's operations are f32, each rounded by itself.

pub mod graph;
pub mod origin;
pub mod text;
pub mod verify;
pub(crate) mod walk;

use crate::ops::{self, Op, Ty};
use std::fmt;
use std::sync::Arc;

/// Most steps that a loop takes.
pub const MAX_STEPS: u32 = 1024;

/// Most numbers in the state of a loop: 16 of a scene and a counter, with three derivatives each.
pub const MAX_STATE: usize = 17 * 4;

/// A value of a function: the index of the instruction that computes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ValueId(pub u32);

impl ValueId {
    /// As an index into [`Function::insts`].
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

impl fmt::Display for ValueId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "%{}", self.0)
    }
}

/// A number that can be a key: equal and hashed by its bits, so that `-0.0` is not `0.0`.
#[derive(Clone, Copy, Debug)]
pub struct Number(pub f64);

impl PartialEq for Number {
    fn eq(&self, other: &Self) -> bool {
        self.0.to_bits() == other.0.to_bits()
    }
}

impl Eq for Number {}

impl std::hash::Hash for Number {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.0.to_bits().hash(state);
    }
}

/// One instruction.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Inst {
    /// A finite number.
    Constant(Number),
    /// A truth value.
    Boolean(bool),
    /// Argument of the function, a number.
    Input(u32),
    /// Output of the frame function, a number.
    Uniform(u32),
    /// An operation of the table.
    Apply {
        /// Which one.
        op: Op,
        /// Seed of a noise, index of a curve; 0 for all others.
        data: u32,
        /// Operands, as many as the table says.
        args: Vec<ValueId>,
    },
    /// One result of an operation that has several, or of a loop.
    Extract(ValueId, u32),
    /// A state of numbers, replaced by the next one at most so many times. Its results are the last
    /// state, however short, and are read by [`Inst::Extract`].
    Loop {
        /// Steps, at most [`MAX_STEPS`].
        most: u32,
        /// Next state and whether to go there, from a state and constants of the loop. Inputs: the
        /// operands, the first of which are replaced by the state. Outputs: the numbers of the next
        /// state, then a truth value, both computed from the state before the step; where it is
        /// false, that state is the last. Reads no uniforms.
        body: Arc<Function>,
        /// The first state, then what else the body reads.
        args: Vec<ValueId>,
    },
}

impl Inst {
    /// The values that this instruction reads.
    #[must_use]
    pub fn operands(&self) -> &[ValueId] {
        match self {
            Self::Constant(_) | Self::Boolean(_) | Self::Input(_) | Self::Uniform(_) => &[],
            Self::Apply { args, .. } | Self::Loop { args, .. } => args,
            Self::Extract(tuple, _) => std::slice::from_ref(tuple),
        }
    }

    /// How many results [`Inst::Extract`] reads of this; nothing for what is one value.
    #[must_use]
    pub fn parts(&self) -> Option<usize> {
        match self {
            Self::Constant(_) | Self::Boolean(_) | Self::Input(_) | Self::Uniform(_) | Self::Extract(..) => {
                None
            }
            Self::Apply { op, .. } => Some(ops::operation(*op).results.len()).filter(|&results| results > 1),
            Self::Loop { body, .. } => Some(body.state()),
        }
    }

    /// The same instruction with its operands renamed.
    #[must_use]
    pub fn map_operands(&self, mut rename: impl FnMut(ValueId) -> ValueId) -> Self {
        match self {
            Self::Constant(_) | Self::Boolean(_) | Self::Input(_) | Self::Uniform(_) => self.clone(),
            Self::Apply { op, data, args } => {
                Self::Apply { op: *op, data: *data, args: args.iter().map(|&a| rename(a)).collect() }
            }
            Self::Extract(tuple, index) => Self::Extract(rename(*tuple), *index),
            Self::Loop { most, body, args } => Self::Loop {
                most: *most,
                body: Arc::clone(body),
                args: args.iter().map(|&a| rename(a)).collect(),
            },
        }
    }
}

/// A pure function from numbers to numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Function {
    /// What it computes, for people: `distance:ball`, `scatter:cloud`.
    pub name: String,
    /// Number of arguments.
    pub inputs: u32,
    /// Instructions; operands earlier.
    pub insts: Vec<Inst>,
    /// Results, all of type [`Ty::Number`] but for the last of the body of a loop.
    pub outputs: Vec<ValueId>,
}

impl Function {
    /// Numbers in the state, if this is the body of a loop.
    #[must_use]
    pub fn state(&self) -> usize {
        self.outputs.len().saturating_sub(1)
    }

    /// Type of a value; an operation with several results has the type of its first, which only
    /// [`Inst::Extract`] may read.
    #[must_use]
    pub fn ty(&self, value: ValueId) -> Ty {
        match &self.insts[value.index()] {
            Inst::Constant(_) | Inst::Input(_) | Inst::Uniform(_) => Ty::Number,
            Inst::Boolean(_) => Ty::Bool,
            Inst::Apply { op, .. } => ops::operation(*op).results[0],
            Inst::Extract(..) | Inst::Loop { .. } => Ty::Number,
        }
    }
}

/// Index of a point function in [`Module::functions`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FunctionId(pub u32);

impl FunctionId {
    /// As an index.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// All functions of a program.
///
/// `frame` runs once per frame on the host in f64; its outputs are the uniforms of the others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Module {
    /// Inputs: `time`, `frame`, then the params' components; outputs: the uniforms.
    pub frame: Function,
    /// Functions of a point (or of whatever their user says).
    pub functions: Vec<Function>,
}

impl Module {
    /// The function behind an id of this module.
    #[must_use]
    pub fn function(&self, id: FunctionId) -> &Function {
        &self.functions[id.index()]
    }
}
