//! Linear-scan register allocation.
//!
//! In: a function in SSA form. Out: its tape. Each result of each instruction is a *cell*; an
//! `extract` is no cell of its own but names one. One walk from the end finds the last use of each
//! cell, one walk from the front hands out registers: the lowest free ones, given back after the
//! last use. Constants, inputs and uniforms are loaded just before their first use. The cells of one
//! operation lie in neighbouring registers.

use super::{MAX_OPERANDS, Register, Tape, TapeOp, rounded};
use crate::ir::{Function, Inst, ValueId};
use crate::ops;

/// Allocates registers for a verified function.
pub(super) fn allocate(function: &Function) -> Tape {
    let cells = Cells::new(function);
    let last_use = last_uses(function, &cells);
    let place = vec![None; cells.count];
    let mut scan = Scan { function, cells, last_use, place, free: Vec::new(), ops: Vec::new() };
    for (i, inst) in function.insts.iter().enumerate() {
        let needed = scan.cells.of(i).any(|cell| scan.last_use[cell].is_some());
        if let Inst::Apply { op, data, args } = inst
            && needed
        {
            let args = scan.operands(i, args);
            let to = scan.results(i);
            scan.ops.push(TapeOp::Apply { op: *op, data: *data, to, args });
        }
    }
    let outputs = function.outputs.iter().map(|&v| scan.read(v)).collect();
    Tape { inputs: function.inputs, outputs, registers: scan.free.len() as u32, ops: scan.ops }
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
                Inst::Apply { op, .. } => (cells.count, ops::operation(*op).results.len()),
                Inst::Constant(_) | Inst::Boolean(_) | Inst::Input(_) | Inst::Uniform(_) => (cells.count, 1),
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
    cells: Cells,
    last_use: Vec<Option<usize>>,
    /// Register of each cell that has been computed.
    place: Vec<Option<Register>>,
    /// Which registers are free; as long as the number of registers so far.
    free: Vec<bool>,
    ops: Vec<TapeOp>,
}

impl Scan<'_> {
    /// Registers of the operands of instruction `i`. Those that are read for the last time are free
    /// afterwards, so that the results may take them.
    fn operands(&mut self, i: usize, operands: &[ValueId]) -> [Register; MAX_OPERANDS] {
        let mut args = [Register(0); MAX_OPERANDS];
        for (arg, &operand) in args.iter_mut().zip(operands) {
            *arg = self.read(operand);
        }
        for (arg, operand) in args.iter().zip(operands) {
            self.free[arg.index()] |= self.last_use[self.cells.named[operand.index()]] == Some(i);
        }
        args
    }

    /// Registers for the results of instruction `i`; those that nothing reads are free again.
    fn results(&mut self, i: usize) -> Register {
        let to = self.take(self.cells.of(i).len());
        for (result, cell) in self.cells.of(i).enumerate() {
            let register = Register(to.0 + result as u32);
            self.place[cell] = Some(register);
            self.free[register.index()] = self.last_use[cell].is_none();
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
        match self.function.insts[value.index()] {
            Inst::Constant(number) => self.ops.push(TapeOp::Constant { to, value: rounded(number.0) }),
            Inst::Boolean(truth) => self.ops.push(TapeOp::Constant { to, value: f32::from(u8::from(truth)) }),
            Inst::Input(index) => self.ops.push(TapeOp::Input { to, index }),
            Inst::Uniform(index) => self.ops.push(TapeOp::Uniform { to, index }),
            // Operations have their place before anyone reads them: operands are earlier.
            Inst::Apply { .. } | Inst::Extract(..) => {}
        }
        to
    }

    /// The lowest `count` neighbouring free registers.
    fn take(&mut self, count: usize) -> Register {
        let mut start = 0;
        while let Some(used) = (start..self.free.len().min(start + count)).rfind(|&r| !self.free[r]) {
            start = used + 1;
        }
        self.free.resize(self.free.len().max(start + count), true);
        self.free[start..start + count].fill(false);
        Register(start as u32)
    }
}
