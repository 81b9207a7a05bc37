//! A function that shows all of its numbers.

use vol_compiler::ir::{Function, ValueId};
use vol_compiler::ops::Ty;

/// A function with all its numbers as outputs, and which output each value is.
#[derive(Clone, Debug)]
pub struct Probe {
    /// The function.
    pub function: Function,
    /// By value: its output; none for truths and for values of several parts, whose parts are values of their own.
    pub outputs: Vec<Option<usize>>,
}

impl Probe {
    /// Of a function; numbers inside its loops stay inside.
    #[must_use]
    pub fn new(function: &Function) -> Self {
        let mut probe = Function { outputs: Vec::new(), ..function.clone() };
        let mut outputs = vec![None; function.insts.len()];
        for (value, inst) in (0..).map(ValueId).zip(&function.insts) {
            if inst.parts().is_none() && function.ty(value) == Ty::Number {
                outputs[value.index()] = Some(probe.outputs.len());
                probe.outputs.push(value);
            }
        }
        Self { function: probe, outputs }
    }
}
