//! Well-formed functions at random, for tests of everything that reads IR.
//!
//! In: a seed and a [`Shape`]. Out: the same function each time, which the verifier accepts. All
//! operations of the table occur, and loops, some inside others. Most functions end far outside what a scene would compute
//! (overflow, division by zero); with [`Shape::tame`] operands are held within the domains of the
//! table, so that values stay finite.

use crate::ir::{Function, Inst, Number, ValueId};
use crate::ops::{self, Op, Operation, Ty};
use std::sync::Arc;

/// What a generated function may contain.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Arguments.
    pub inputs: u32,
    /// Uniforms it may read.
    pub uniforms: u32,
    /// Curves it may ask for the closest point.
    pub curves: u32,
    /// Operations.
    pub operations: u32,
    /// Results.
    pub outputs: u32,
    /// Hold operands within the domains of the table.
    pub tame: bool,
}

impl Default for Shape {
    fn default() -> Self {
        Self { inputs: 3, uniforms: 4, curves: 2, operations: 30, outputs: 3, tame: false }
    }
}

/// A pseudo-random stream, the same on every machine (splitmix64).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A stream of its own for each seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self(mix(seed ^ 0x1234_5678_9abc_def0))
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// A whole number below `count`, which is positive.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    /// A number in [lo, hi).
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * ((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }
}

fn mix(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A function of this shape.
#[must_use]
pub fn function(seed: u64, shape: &Shape) -> Function {
    let mut writer = Writer::new(Random::new(seed), shape, 2);
    for _ in 0..shape.operations {
        writer.operation();
    }
    let outputs = (0..shape.outputs).map(|_| writer.number()).collect();
    Function { name: format!("random:{seed}"), inputs: shape.inputs, insts: writer.insts, outputs }
}

struct Writer<'a> {
    random: Random,
    shape: &'a Shape,
    insts: Vec<Inst>,
    numbers: Vec<ValueId>,
    truths: Vec<ValueId>,
    /// How deep loops may still nest.
    nesting: u32,
}

impl<'a> Writer<'a> {
    fn new(random: Random, shape: &'a Shape, nesting: u32) -> Self {
        let (insts, numbers, truths) = (Vec::new(), Vec::new(), Vec::new());
        let mut writer = Self { random, shape, insts, numbers, truths, nesting };
        writer.leaves();
        writer
    }

    fn push(&mut self, inst: Inst) -> ValueId {
        self.insts.push(inst);
        ValueId(self.insts.len() as u32 - 1)
    }

    fn leaves(&mut self) {
        let inputs = (0..self.shape.inputs).map(Inst::Input);
        let uniforms = (0..self.shape.uniforms).map(Inst::Uniform);
        let round = [0.0, -0.0, 1.0, -1.0, 2.0, 0.5].map(|n| Inst::Constant(Number(n)));
        let odd = [(); 3].map(|()| Inst::Constant(Number(self.random.between(-3.0, 3.0))));
        for inst in inputs.chain(uniforms).chain(round).chain(odd) {
            let value = self.push(inst);
            self.numbers.push(value);
        }
        for truth in [true, false] {
            let value = self.push(Inst::Boolean(truth));
            self.truths.push(value);
        }
    }

    /// Some number; later ones more often, so that functions become deep.
    fn number(&mut self) -> ValueId {
        let count = self.numbers.len();
        let start = if self.random.below(3) > 0 { count.saturating_sub(8) } else { 0 };
        self.numbers[start + self.random.below(count - start)]
    }

    fn operation(&mut self) {
        if self.nesting > 0 && self.random.below(16) == 0 {
            return self.repeat();
        }
        let row = &ops::TABLE[self.random.below(ops::TABLE.len())];
        let data = match row.op {
            op if op.reads_curve() && self.shape.curves == 0 => return,
            op if op.reads_curve() => self.random.below(self.shape.curves as usize) as u32,
            _ if row.has_data => [0, 1, 7, u32::MAX][self.random.below(4)],
            _ => 0,
        };
        let args: Vec<ValueId> = (0..row.args.len()).map(|i| self.operand(row, i)).collect();
        let value = self.push(Inst::Apply { op: row.op, data, args });
        if row.results.len() > 1 {
            for index in 0..row.results.len() as u32 {
                // Some results stay unread.
                if self.random.below(4) > 0 {
                    let part = self.push(Inst::Extract(value, index));
                    self.numbers.push(part);
                }
            }
        } else {
            let pool = if row.results[0] == Ty::Bool { &mut self.truths } else { &mut self.numbers };
            pool.push(value);
        }
    }

    /// A loop of a few steps over a few numbers.
    fn repeat(&mut self) {
        let state = 1 + self.random.below(3);
        let args: Vec<ValueId> = (0..state + self.random.below(3)).map(|_| self.number()).collect();
        let shape = Shape { inputs: args.len() as u32, uniforms: 0, ..self.shape.clone() };
        let mut inside = Writer::new(Random(self.random.bits()), &shape, self.nesting - 1);
        for _ in 0..1 + self.random.below(8) {
            inside.operation();
        }
        let mut outputs: Vec<ValueId> = Vec::new();
        for _ in 0..state {
            let next = inside.number();
            outputs.push(if shape.tame { inside.held(next, -8.0, 8.0) } else { next });
        }
        // Always, never, or as some comparison says.
        outputs.push(inside.truths[inside.random.below(inside.truths.len())]);
        let insts = inside.insts;
        let body = Arc::new(Function { name: String::new(), inputs: shape.inputs, insts, outputs });
        let most = [0, 1, 2, 5][self.random.below(4)];
        let repeated = self.push(Inst::Loop { most, body, args });
        for index in 0..state as u32 {
            // Some results stay unread.
            if self.random.below(4) > 0 {
                let part = self.push(Inst::Extract(repeated, index));
                self.numbers.push(part);
            }
        }
    }

    fn operand(&mut self, row: &Operation, index: usize) -> ValueId {
        if row.args[index] == Ty::Bool {
            return self.truths[self.random.below(self.truths.len())];
        }
        let value = self.number();
        let grows =
            matches!(row.op, Op::Mul | Op::Div) || row.args.len() == 1 || row.has_data || row.op == Op::Atan2;
        match row.domain.get(index) {
            Some(&(lo, hi)) if self.shape.tame && grows => self.held(value, lo, hi),
            _ => value,
        }
    }

    fn held(&mut self, value: ValueId, lo: f64, hi: f64) -> ValueId {
        let lo = self.push(Inst::Constant(Number(lo)));
        let hi = self.push(Inst::Constant(Number(hi)));
        let above = self.push(Inst::Apply { op: Op::Max, data: 0, args: vec![value, lo] });
        self.push(Inst::Apply { op: Op::Min, data: 0, args: vec![above, hi] })
    }
}
