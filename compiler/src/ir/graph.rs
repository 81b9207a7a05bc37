//! Builds functions: one hash-consed graph for the whole scene, split by rate at the end.
//!
//! While lowering, all expressions of a scene live in one [`Graph`]. Equal instructions are one
//! node (common subexpressions), operations on constants are computed at once in f64, and every
//! node has a [`Rate`]. [`Slots`] then cuts out functions: what a point function needs of frame
//! rate becomes a uniform, computed once per frame on the host.

mod repeat;

use super::origin::Origins;
use super::{Function, Inst, Number, ValueId};
use crate::ops::{self, Op, Ty};
use rustc_hash::FxHashMap;
use vol_language::source::Span;

pub use repeat::Repeated;

/// How often a value changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rate {
    /// Never.
    Constant,
    /// With params and time.
    Frame,
    /// With the arguments of the function, mostly a position.
    Point,
}

/// All expressions of a scene. Inside the graph [`Inst::Uniform`] is an input of the frame
/// function: 0 is the time, 1 the frame number, params follow.
#[derive(Debug, Default)]
pub struct Graph {
    insts: Vec<Inst>,
    rates: Vec<Rate>,
    known: FxHashMap<Inst, ValueId>,
    /// What in the scene each value was first made for.
    places: Vec<Option<Span>>,
    /// What in the scene new values are made for.
    place: Option<Span>,
    /// Placeholders made so far.
    placeholders: u32,
}

impl Graph {
    /// The instruction behind a value.
    #[must_use]
    pub fn inst(&self, value: ValueId) -> &Inst {
        &self.insts[value.index()]
    }

    /// How often a value changes.
    #[must_use]
    pub fn rate(&self, value: ValueId) -> Rate {
        self.rates[value.index()]
    }

    /// What in the scene a value was first made for.
    #[must_use]
    pub fn place(&self, value: ValueId) -> Option<Span> {
        self.places[value.index()]
    }

    /// Says what in the scene new values are made for; returns what it was before.
    pub fn set_place(&mut self, place: Option<Span>) -> Option<Span> {
        std::mem::replace(&mut self.place, place)
    }

    /// The number that a value always is.
    #[must_use]
    pub fn constant(&self, value: ValueId) -> Option<f64> {
        match self.inst(value) {
            Inst::Constant(number) => Some(number.0),
            Inst::Boolean(truth) => Some(f64::from(u8::from(*truth))),
            Inst::Input(_)
            | Inst::Uniform(_)
            | Inst::Apply { .. }
            | Inst::Extract(..)
            | Inst::Loop { .. } => None,
        }
    }

    /// Adds an instruction, or finds the equal one.
    pub fn push(&mut self, inst: Inst) -> ValueId {
        if let Some(&value) = self.known.get(&inst) {
            return value;
        }
        // The frame function runs before the curves are known.
        let own = match &inst {
            Inst::Input(_) => Rate::Point,
            Inst::Uniform(_) => Rate::Frame,
            Inst::Apply { .. } | Inst::Loop { .. } if asks_curves(&inst) => Rate::Point,
            Inst::Constant(_)
            | Inst::Boolean(_)
            | Inst::Apply { .. }
            | Inst::Extract(..)
            | Inst::Loop { .. } => Rate::Constant,
        };
        let rate = inst.operands().iter().map(|&v| self.rate(v)).fold(own, Rate::max);
        let value = ValueId(self.insts.len() as u32);
        self.insts.push(inst.clone());
        self.rates.push(rate);
        self.places.push(self.place);
        self.known.insert(inst, value);
        value
    }

    /// A number.
    pub fn number(&mut self, number: f64) -> ValueId {
        self.push(Inst::Constant(Number(number)))
    }

    /// A truth value.
    pub fn boolean(&mut self, truth: bool) -> ValueId {
        self.push(Inst::Boolean(truth))
    }

    /// Argument `index` of the function being built.
    pub fn input(&mut self, index: u32) -> ValueId {
        self.push(Inst::Input(index))
    }

    /// Input `index` of the frame function.
    pub fn frame_input(&mut self, index: u32) -> ValueId {
        self.push(Inst::Uniform(index))
    }

    /// An operation of the table with one result, folded and simplified where possible.
    pub fn apply(&mut self, op: Op, args: &[ValueId]) -> ValueId {
        self.apply_data(op, 0, args)
    }

    /// [`Graph::apply`] for operations with data: the seed of a noise, the index of a curve.
    pub fn apply_data(&mut self, op: Op, data: u32, args: &[ValueId]) -> ValueId {
        let inst = Inst::Apply { op, data, args: args.to_vec() };
        match crate::passes::fold::simplify(&inst, |value| self.inst(value).clone()) {
            crate::passes::fold::Simplified::Same => self.push(inst),
            crate::passes::fold::Simplified::Value(value) => value,
            crate::passes::fold::Simplified::Inst(inst) => self.push(inst),
        }
    }

    /// All results of an operation that has several.
    pub fn apply_all(&mut self, op: Op, data: u32, args: &[ValueId]) -> Vec<ValueId> {
        let tuple = self.push(Inst::Apply { op, data, args: args.to_vec() });
        self.extract_all(op, tuple)
    }

    /// The results behind a tuple value.
    pub fn extract_all(&mut self, op: Op, tuple: ValueId) -> Vec<ValueId> {
        let count = ops::operation(op).results.len() as u32;
        (0..count).map(|i| self.push(Inst::Extract(tuple, i))).collect()
    }

    /// Type of a value.
    #[must_use]
    pub fn ty(&self, value: ValueId) -> Ty {
        match self.inst(value) {
            Inst::Boolean(_) => Ty::Bool,
            Inst::Apply { op, .. } => ops::operation(*op).results[0],
            Inst::Constant(_) | Inst::Input(_) | Inst::Uniform(_) | Inst::Extract(..) | Inst::Loop { .. } => {
                Ty::Number
            }
        }
    }

    /// a + b
    pub fn add(&mut self, a: ValueId, b: ValueId) -> ValueId {
        self.apply(Op::Add, &[a, b])
    }

    /// a - b
    pub fn sub(&mut self, a: ValueId, b: ValueId) -> ValueId {
        self.apply(Op::Sub, &[a, b])
    }

    /// a * b
    pub fn mul(&mut self, a: ValueId, b: ValueId) -> ValueId {
        self.apply(Op::Mul, &[a, b])
    }

    /// a / b
    pub fn div(&mut self, a: ValueId, b: ValueId) -> ValueId {
        self.apply(Op::Div, &[a, b])
    }

    /// The smaller.
    pub fn min(&mut self, a: ValueId, b: ValueId) -> ValueId {
        self.apply(Op::Min, &[a, b])
    }

    /// The larger.
    pub fn max(&mut self, a: ValueId, b: ValueId) -> ValueId {
        self.apply(Op::Max, &[a, b])
    }

    /// `a` if `condition` else `b`.
    pub fn select(&mut self, condition: ValueId, a: ValueId, b: ValueId) -> ValueId {
        self.apply(Op::Select, &[condition, a, b])
    }

    /// Sum of products, left to right.
    pub fn dot(&mut self, a: &[ValueId], b: &[ValueId]) -> ValueId {
        let mut sum = None;
        for (&x, &y) in a.iter().zip(b) {
            let product = self.mul(x, y);
            sum = Some(sum.map_or(product, |s| self.add(s, product)));
        }
        sum.unwrap_or_else(|| self.number(0.0))
    }

    /// Euclidean length.
    pub fn length(&mut self, v: &[ValueId]) -> ValueId {
        let squared = self.dot(v, v);
        self.apply(Op::Sqrt, &[squared])
    }
}

/// The frame function's outputs while functions are cut out of a graph.
#[derive(Debug, Default)]
pub struct Slots {
    values: Vec<ValueId>,
    known: FxHashMap<ValueId, u32>,
}

impl Slots {
    /// The slot of a value of at most frame rate.
    pub fn slot(&mut self, value: ValueId) -> u32 {
        *self.known.entry(value).or_insert_with(|| {
            self.values.push(value);
            self.values.len() as u32 - 1
        })
    }

    /// Cuts out the function that computes `outputs`; frame-rate values become uniforms. Truth
    /// values among the outputs become 0 and 1.
    pub fn point_function(
        &mut self,
        graph: &mut Graph,
        name: &str,
        inputs: u32,
        outputs: &[ValueId],
    ) -> Function {
        self.placed_function(graph, name, inputs, outputs).0
    }

    /// [`Slots::point_function`], and where in the scene its instructions come from.
    pub fn placed_function(
        &mut self,
        graph: &mut Graph,
        name: &str,
        inputs: u32,
        outputs: &[ValueId],
    ) -> (Function, Origins) {
        let outputs = as_numbers(graph, outputs);
        let graph = &*graph;
        let leaf = |value: ValueId| {
            let hoisted = graph.rate(value) == Rate::Frame && graph.ty(value) == Ty::Number;
            let tuple = graph.inst(value).parts().is_some();
            (hoisted && !tuple).then(|| Inst::Uniform(self.slot(value)))
        };
        let (function, values) = cut(graph, name, inputs, &outputs, leaf);
        let origins = Origins::new(&function, values.into_iter().map(|value| graph.place(value)));
        (function, origins)
    }

    /// Cuts out the frame function, last of all. `inputs` counts time, frame and param components.
    pub fn frame_function(&mut self, graph: &mut Graph, inputs: u32) -> Function {
        let values = self.values.clone();
        let outputs = as_numbers(graph, &values);
        let graph = &*graph;
        let leaf = |value: ValueId| match graph.inst(value) {
            Inst::Uniform(index) => Some(Inst::Input(*index)),
            Inst::Constant(_)
            | Inst::Boolean(_)
            | Inst::Input(_)
            | Inst::Apply { .. }
            | Inst::Extract(..)
            | Inst::Loop { .. } => None,
        };
        cut(graph, "frame", inputs, &outputs, leaf).0
    }
}

/// Whether an instruction, or a loop inside it, needs control points.
fn asks_curves(inst: &Inst) -> bool {
    match inst {
        Inst::Constant(_) | Inst::Boolean(_) | Inst::Input(_) | Inst::Uniform(_) | Inst::Extract(..) => false,
        Inst::Apply { op, .. } => op.reads_curve(),
        Inst::Loop { body, .. } => body.insts.iter().any(asks_curves),
    }
}

fn as_numbers(graph: &mut Graph, values: &[ValueId]) -> Vec<ValueId> {
    let (one, zero) = (graph.number(1.0), graph.number(0.0));
    let number = |&value: &ValueId| match graph.ty(value) {
        Ty::Number => value,
        Ty::Bool => graph.select(value, one, zero),
    };
    values.iter().map(number).collect()
}

/// Copies what `outputs` need into a function of its own; `leaf` may replace a node by another. Also
/// returns the node behind each instruction.
fn cut(
    graph: &Graph,
    name: &str,
    inputs: u32,
    outputs: &[ValueId],
    mut leaf: impl FnMut(ValueId) -> Option<Inst>,
) -> (Function, Vec<ValueId>) {
    // Mark what is needed, from the outputs down: operands have smaller ids.
    let mut replaced: FxHashMap<ValueId, Option<Inst>> = FxHashMap::default();
    let mut pending: Vec<ValueId> = outputs.to_vec();
    while let Some(value) = pending.pop() {
        if replaced.contains_key(&value) {
            continue;
        }
        let new = leaf(value);
        if new.is_none() {
            pending.extend_from_slice(graph.inst(value).operands());
        }
        replaced.insert(value, new);
    }
    // Copy in the old order, which keeps operands first.
    let mut order: Vec<ValueId> = replaced.keys().copied().collect();
    order.sort_unstable();
    let mut renamed: FxHashMap<ValueId, ValueId> = FxHashMap::default();
    let mut insts = Vec::with_capacity(order.len());
    for &value in &order {
        let inst = replaced[&value].clone();
        let inst = inst.unwrap_or_else(|| graph.inst(value).map_operands(|v| renamed[&v]));
        renamed.insert(value, ValueId(insts.len() as u32));
        insts.push(inst);
    }
    let outputs = outputs.iter().map(|v| renamed[v]).collect();
    (Function { name: name.to_owned(), inputs, insts, outputs }, order)
}
