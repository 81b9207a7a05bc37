//! Computations on several curves that are alike, put together.
//!
//! Drivers write a function out wherever it is called, and a search for the closest point of a curve is long. Searches of
//! one function that do not need each other's results are therefore one loop, a turn for each *place*: a point and a curve.
//! What follows from the search of one place alone is in the loop as far as it is alike for all places ([`mod@alike`]):
//!
//! ```text
//! %3 = closest[1] %0 %1 %2    var v8_of: array<f32, 2>;
//! %4 = extract %3 5           for (var v3_i: u32 = 0u; v3_i < 2u; v3_i = v3_i + 1u) {
//! %5 = closest[2] %0 %1 %2      let v3_in0: f32 = vol_uniform_word(7u - (2u * v3_i));
//! %6 = extract %5 5             let v3 = vol_closest(vec3f(x0, x1, x2), vol_curve(1u + v3_i));
//! %7 = uniform 7                let v4: f32 = v3.distance;
//! %8 = sub %4 %7                let v8: f32 = (v4 - v3_in0);
//! %9 = uniform 5                v8_of[v3_i] = v8;
//! %10 = sub %6 %9             }
//! %11 = min %8 %10            let v11: f32 = select(v8_of[1], v8_of[0], (v8_of[0] < v8_of[1]));
//! ```
//!
//! Every value is computed as it would be without a loop.

mod alike;

use crate::ir::{Function, Inst, ValueId};
use crate::ops::Op;
use std::collections::{BTreeMap, BTreeSet};

/// What is written next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// One instruction.
    One(ValueId),
    /// All of the batch with this index.
    Batch(usize),
}

/// Where a value of a batch stands in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Member {
    pub(super) batch: usize,
    pub(super) row: usize,
    /// The turn of the loop.
    pub(super) turn: usize,
}

/// Instructions that are alike for several places.
#[derive(Debug, Default)]
pub(super) struct Batch {
    /// Instructions of the loop, each with its value in every turn.
    pub(super) rows: Vec<Vec<ValueId>>,
    /// What the rows read that differs from turn to turn: its value in every turn.
    pub(super) inputs: Vec<Vec<ValueId>>,
    /// Rows that are read after the loop; of a tuple a part.
    pub(super) results: BTreeSet<(usize, Option<u32>)>,
}

impl Batch {
    /// Turns of the loop.
    pub(super) fn turns(&self) -> usize {
        self.rows[0].len()
    }

    /// An operand of a row by turn, if it comes from outside and is not always the same.
    fn varying(&self, function: &Function, row: usize, operand: usize) -> Option<Vec<ValueId>> {
        let values: Vec<ValueId> =
            self.rows[row].iter().map(|value| function.insts[value.index()].operands()[operand]).collect();
        let is_inside = self.rows[..row].contains(&values);
        (!is_inside && values.iter().any(|value| *value != values[0])).then_some(values)
    }

    /// The input that an operand of a row is, if it is one.
    pub(super) fn input(&self, function: &Function, row: usize, operand: usize) -> Option<usize> {
        let values = self.varying(function, row, operand)?;
        self.inputs.iter().position(|input| *input == values)
    }
}

/// The batches of a function and the order in which its instructions are written.
#[derive(Debug, Default)]
pub(super) struct Schedule {
    pub(super) batches: Vec<Batch>,
    pub(super) steps: Vec<Step>,
    members: BTreeMap<ValueId, Member>,
}

impl Schedule {
    /// Puts together what is as many searches deep.
    pub(super) fn of(function: &Function) -> Self {
        let mut new = Self::default();
        let depths = depths(function);
        for depth in 0..=depths.iter().copied().max().unwrap_or(0) {
            let is_root = |value: &ValueId| {
                let inst = &function.insts[value.index()];
                is_search(inst) && depths[value.index()] == depth && !new.members.contains_key(value)
            };
            let roots: Vec<ValueId> = (0..function.insts.len() as u32).map(ValueId).filter(is_root).collect();
            alike::loops(function, &roots).into_iter().for_each(|rows| new.add(function, rows));
        }
        new.find_results(function);
        new.steps = new.order(function);
        new
    }

    /// Each instruction by itself.
    pub(super) fn plain(function: &Function) -> Self {
        let steps = (0..function.insts.len() as u32).map(|value| Step::One(ValueId(value))).collect();
        Self { steps, ..Self::default() }
    }

    /// Where a value stands, if it is in a batch.
    pub(super) fn member(&self, value: ValueId) -> Option<Member> {
        self.members.get(&value).copied()
    }

    fn add(&mut self, function: &Function, rows: Vec<Vec<ValueId>>) {
        let index = self.batches.len();
        for (row, values) in rows.iter().enumerate() {
            let members = values.iter().enumerate();
            self.members.extend(members.map(|(turn, &value)| (value, Member { batch: index, row, turn })));
        }
        let mut batch = Batch { rows, ..Batch::default() };
        for row in 0..batch.rows.len() {
            for operand in 0..function.insts[batch.rows[row][0].index()].operands().len() {
                if let Some(values) = batch.varying(function, row, operand)
                    && !batch.inputs.contains(&values)
                {
                    batch.inputs.push(values);
                }
            }
        }
        self.batches.push(batch);
    }

    fn find_results(&mut self, function: &Function) {
        for (reader, inst) in function.insts.iter().enumerate() {
            let home = self.member(ValueId(reader as u32)).map(|member| member.batch);
            for &operand in inst.operands() {
                if let Some(read) = self.member(operand)
                    && home != Some(read.batch)
                {
                    let part = if let Inst::Extract(_, part) = inst { Some(*part) } else { None };
                    self.batches[read.batch].results.insert((read.row, part));
                }
            }
        }
        for &output in &function.outputs {
            if let Some(read) = self.member(output) {
                self.batches[read.batch].results.insert((read.row, None));
            }
        }
    }

    /// Instructions stay in their order, but what a batch needs comes before the first of it.
    fn order(&self, function: &Function) -> Vec<Step> {
        let read = self.read(function);
        let mut steps = Vec::new();
        let mut written = vec![false; function.insts.len()];
        let mut next = 0;
        for value in (0..function.insts.len() as u32).map(ValueId) {
            let member = self.member(value);
            // A batch needs none but those before it, since they are in the order of their depths.
            let end = member.map_or(next, |member| next.max(member.batch + 1));
            for batch in next..end {
                for needed in needs(function, &self.batches[batch]) {
                    if self.member(needed).is_none()
                        && read.contains(&needed)
                        && !std::mem::replace(&mut written[needed.index()], true)
                    {
                        steps.push(Step::One(needed));
                    }
                }
                steps.push(Step::Batch(batch));
            }
            next = end;
            let is_unread =
                matches!(function.insts[value.index()], Inst::Uniform(_)) && !read.contains(&value);
            if member.is_none() && !is_unread && !std::mem::replace(&mut written[value.index()], true) {
                steps.push(Step::One(value));
            }
        }
        steps
    }

    /// What is read by name: not what only loops read that find it by its place among the numbers of the frame.
    fn read(&self, function: &Function) -> BTreeSet<ValueId> {
        let mut read: BTreeSet<ValueId> = function.outputs.iter().copied().collect();
        for (value, inst) in (0..).map(ValueId).zip(&function.insts) {
            let of_input = |operand: usize| {
                let member = self.member(value)?;
                let batch = &self.batches[member.batch];
                batch.input(function, member.row, operand).map(|number| &batch.inputs[number])
            };
            for (i, &operand) in inst.operands().iter().enumerate() {
                if of_input(i).is_none_or(|values| even_uniforms(function, values).is_none()) {
                    read.insert(operand);
                }
            }
        }
        read
    }
}

/// Numbers of values that are all uniforms, each as far from the last.
pub(super) fn even_uniforms(function: &Function, values: &[ValueId]) -> Option<Vec<u32>> {
    let index = |value: &ValueId| match function.insts[value.index()] {
        Inst::Uniform(index) => Some(index),
        _ => None,
    };
    let indices: Vec<u32> = values.iter().map(index).collect::<Option<_>>()?;
    even_step(&indices).map(|_| indices)
}

/// How far numbers are apart, if all are equally far from the last.
pub(super) fn even_step(numbers: &[u32]) -> Option<i64> {
    let step = |pair: &[u32]| i64::from(pair[1]) - i64::from(pair[0]);
    let first = numbers.windows(2).map(step).next()?;
    numbers.windows(2).all(|pair| step(pair) == first).then_some(first)
}

/// Whether an instruction looks for the closest point of a curve.
fn is_search(inst: &Inst) -> bool {
    matches!(inst, Inst::Apply { op: Op::Closest | Op::ClosestGradient, .. })
}

/// How many searches are needed, one after the other, before each instruction.
fn depths(function: &Function) -> Vec<usize> {
    let mut depths: Vec<usize> = Vec::with_capacity(function.insts.len());
    for inst in &function.insts {
        let after =
            |value: &ValueId| depths[value.index()] + usize::from(is_search(&function.insts[value.index()]));
        let depth = inst.operands().iter().map(after).max().unwrap_or(0);
        depths.push(depth);
    }
    depths
}

/// What is needed, directly or not, before a batch, in order.
fn needs(function: &Function, batch: &Batch) -> BTreeSet<ValueId> {
    let mut needed = BTreeSet::new();
    let mut open: Vec<ValueId> = batch.rows.iter().flatten().copied().collect();
    while let Some(value) = open.pop() {
        let operands = function.insts[value.index()].operands();
        open.extend(operands.iter().copied().filter(|&operand| needed.insert(operand)));
    }
    needed
}

#[cfg(test)]
mod tests;
