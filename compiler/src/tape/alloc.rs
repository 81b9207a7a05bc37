//! Linear-scan register allocation.
//!
//! In: a function in SSA form. Out: its tape. Each result of each instruction is a *cell*; an
//! `extract` is no cell of its own but names one. One walk from the end finds the last use of each
//! cell, one walk from the front hands out registers: the lowest free ones, given back after the
//! last use. Constants, inputs and uniforms are loaded just before their first use. The cells of one
//! operation, and of the state of a loop, lie in neighbouring registers. In the body of a loop the
//! inputs have the first registers from beginning to end.

use super::{MAX_OPERANDS, Register, Scalar, Tape, TapeLoop, TapeOp, rounded, takes_scalar};
use crate::ir::{Function, Inst, ValueId};
use crate::ops::Op;
use std::sync::Arc;

/// Allocates registers for a verified function.
pub(super) fn allocate(function: &Function) -> Tape {
    Scan::new(function).tape()
}

/// Gives each value of a verified function a register of its own; bodies of loops share theirs.
pub(super) fn number(function: &Function) -> Tape {
    Scan { reuses: false, ..Scan::new(function) }.tape()
}

/// The same for the body of a loop.
fn allocate_body(body: &Function) -> Tape {
    let mut scan = Scan::new(body);
    scan.free.resize(body.inputs as usize, false);
    for (i, inst) in body.insts.iter().enumerate() {
        if let Inst::Input(index) = inst {
            let cell = scan.cells.named[i];
            scan.place[cell] = Some(Register(*index));
            // Read until the end, so never free.
            scan.last_use[cell] = Some(body.insts.len());
        }
    }
    scan.tape()
}

/// Numbers the results of all instructions.
struct Cells {
    /// First cell of each instruction, and the end.
    starts: Vec<usize>,
    /// The cell that each value names.
    named: Vec<usize>,
    count: usize,
}

impl Cells {
    fn new(function: &Function) -> Self {
        let mut cells = Self { starts: vec![0], named: Vec::new(), count: 0 };
        for inst in &function.insts {
            let (named, results) = match inst {
                Inst::Extract(tuple, index) => (cells.starts[tuple.index()] + *index as usize, 0),
                Inst::Constant(_)
                | Inst::Boolean(_)
                | Inst::Input(_)
                | Inst::Uniform(_)
                | Inst::Apply { .. }
                | Inst::Loop { .. } => (cells.count, inst.parts().unwrap_or(1)),
            };
            cells.named.push(named);
            cells.count += results;
            cells.starts.push(cells.count);
        }
        cells
    }

    /// The cells of instruction `i`.
    fn of(&self, i: usize) -> std::ops::Range<usize> {
        self.starts[i]..self.starts[i + 1]
    }
}

/// For each cell the last instruction that reads it: the end of the function for outputs, nothing
/// for cells that no output needs.
fn last_uses(function: &Function, cells: &Cells) -> Vec<Option<usize>> {
    let mut last = vec![None; cells.count];
    for output in &function.outputs {
        last[cells.named[output.index()]] = Some(function.insts.len());
    }
    for (i, inst) in function.insts.iter().enumerate().rev() {
        if cells.of(i).any(|cell| last[cell].is_some()) {
            for operand in inst.operands() {
                last[cells.named[operand.index()]].get_or_insert(i);
            }
        }
    }
    last
}

struct Scan<'a> {
    function: &'a Function,
    /// Whether registers are used again.
    reuses: bool,
    cells: Cells,
    last_use: Vec<Option<usize>>,
    /// Register of each cell that has been computed.
    place: Vec<Option<Register>>,
    /// Which registers are free; as long as the number of registers so far.
    free: Vec<bool>,
    /// No register below this one is free.
    lowest: usize,
    ops: Vec<TapeOp>,
    values: Vec<ValueId>,
    loops: Vec<TapeLoop>,
}

impl<'a> Scan<'a> {
    fn new(function: &'a Function) -> Self {
        let cells = Cells::new(function);
        let last_use = last_uses(function, &cells);
        let place = vec![None; cells.count];
        let (free, ops, values, loops) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { function, reuses: true, cells, last_use, place, free, lowest: 0, ops, values, loops }
    }

    fn tape(mut self) -> Tape {
        for (i, inst) in self.function.insts.iter().enumerate() {
            if self.cells.of(i).any(|cell| self.last_use[cell].is_some()) {
                self.step(i, inst);
            }
        }
        let outputs = self.function.outputs.iter().map(|&v| self.read(v)).collect();
        let (inputs, registers) = (self.function.inputs, self.free.len() as u32);
        let links = Vec::new();
        Tape { inputs, outputs, registers, ops: self.ops, values: self.values, loops: self.loops, links }
            .linked()
    }

    fn step(&mut self, i: usize, inst: &Inst) {
        match inst {
            Inst::Constant(_) | Inst::Boolean(_) | Inst::Input(_) | Inst::Uniform(_) | Inst::Extract(..) => {}
            Inst::Apply { op, data, args } => {
                if let Some((scalar, scalar_first)) = self.scalar(*op, args) {
                    let arg = self.operands(i, &args[usize::from(scalar_first)..][..1])[0];
                    let to = self.results(i);
                    self.push(i, TapeOp::ApplyScalar { op: *op, scalar_first, scalar, to, arg });
                    return;
                }
                let registers = self.operands(i, args);
                let mut args = [Register(0); MAX_OPERANDS];
                args[..registers.len()].copy_from_slice(&registers);
                let to = self.results(i);
                let read = self.cells.of(i).enumerate().filter(|&(_, cell)| self.last_use[cell].is_some());
                let wanted = read.fold(0, |wanted, (result, _)| wanted | 1 << result);
                self.push(i, TapeOp::Apply { op: *op, data: *data, to, args, wanted });
            }
            Inst::Loop { most, body, args } => {
                let args = self.operands(i, args);
                let to = self.results(i);
                self.push(i, TapeOp::Loop { index: self.loops.len() as u32, to });
                self.loops.push(TapeLoop { most: *most, args, body: Arc::new(allocate_body(body)) });
            }
        }
    }

    /// The scalar among the operands of an operation that may have one, and whether it is the first; nothing where
    /// both are scalars, which happens to little.
    fn scalar(&self, op: Op, args: &[ValueId]) -> Option<(Scalar, bool)> {
        let scalar = |arg: ValueId| match self.function.insts[arg.index()] {
            Inst::Constant(number) => Some(Scalar::Number(rounded(number.0))),
            Inst::Uniform(index) => Some(Scalar::Uniform(index)),
            Inst::Boolean(_)
            | Inst::Input(_)
            | Inst::Apply { .. }
            | Inst::Loop { .. }
            | Inst::Extract(..) => None,
        };
        match *args {
            [a, b] if takes_scalar(op) => match (scalar(a), scalar(b)) {
                (Some(scalar), None) => Some((scalar, true)),
                (None, Some(scalar)) => Some((scalar, false)),
                _ => None,
            },
            _ => None,
        }
    }

    /// Registers of the operands of instruction `i`. Those that are read for the last time are free
    /// afterwards, so that the results may take them.
    fn operands(&mut self, i: usize, operands: &[ValueId]) -> Vec<Register> {
        let args: Vec<Register> = operands.iter().map(|&operand| self.read(operand)).collect();
        for (arg, operand) in args.iter().zip(operands) {
            if self.last_use[self.cells.named[operand.index()]] == Some(i) {
                self.give_back(*arg);
            }
        }
        args
    }

    /// Registers for the results of instruction `i`; those that nothing reads are free again.
    fn results(&mut self, i: usize) -> Register {
        let to = self.take(self.cells.of(i).len());
        for (result, cell) in self.cells.of(i).enumerate() {
            let register = Register(to.0 + result as u32);
            self.place[cell] = Some(register);
            if self.last_use[cell].is_none() {
                self.give_back(register);
            }
        }
        to
    }

    /// The register of a value; loads it if it is a leaf that is not there yet.
    fn read(&mut self, value: ValueId) -> Register {
        let cell = self.cells.named[value.index()];
        if let Some(register) = self.place[cell] {
            return register;
        }
        let to = self.take(1);
        self.place[cell] = Some(to);
        let step = match self.function.insts[value.index()] {
            Inst::Constant(number) => TapeOp::Constant { to, value: rounded(number.0) },
            Inst::Boolean(truth) => TapeOp::Constant { to, value: f32::from(u8::from(truth)) },
            Inst::Input(index) => TapeOp::Input { to, index },
            Inst::Uniform(index) => TapeOp::Uniform { to, index },
            // Operations have their place before anyone reads them: operands are earlier.
            Inst::Apply { .. } | Inst::Loop { .. } | Inst::Extract(..) => return to,
        };
        self.push(value.index(), step);
        to
    }

    /// Adds the step that computes instruction `i`.
    fn push(&mut self, i: usize, step: TapeOp) {
        self.ops.push(step);
        self.values.push(ValueId(i as u32));
    }

    /// Says that a register is free.
    fn give_back(&mut self, register: Register) {
        self.free[register.index()] = true;
        self.lowest = self.lowest.min(register.index());
    }

    /// The lowest `count` neighbouring free registers.
    fn take(&mut self, count: usize) -> Register {
        let mut start = if self.reuses { self.lowest } else { self.free.len() };
        while let Some(used) = (start..self.free.len().min(start + count)).rfind(|&r| !self.free[r]) {
            start = used + 1;
        }
        self.free.resize(self.free.len().max(start + count), true);
        self.free[start..start + count].fill(false);
        if count == 1 || start == self.lowest {
            self.lowest = start + count;
        }
        Register(start as u32)
    }
}
