//! Takes out of a scene's functions what is decided by the numbers that can occur.
//!
//! In: the functions as the passes leave them, and what is known of their inputs: the ranges that params
//! declare; of positions that they are moderate. Out: the same functions without the decisions that always
//! fall the same way ([`crate::passes::narrow`]), and a sentence about each function that lost some.

use crate::ir::origin::Origins;
use crate::ir::{Function, Module};
use crate::ops::computed::Computed;
use crate::ops::interval::Interval;
use crate::ops::{Op, operation};
use crate::passes::narrow::{any_input, narrow as narrowed, uniforms};
use crate::passes::{cse, dce};
use std::collections::BTreeSet;
use vol_language::hir;

/// Narrows all functions; returns what to report. `param_inputs`: first frame input of each param.
pub(super) fn narrow(
    hir: &hir::Scene,
    param_inputs: &[u32],
    module: &mut Module,
    origins: &mut [Origins],
) -> Vec<String> {
    let uniforms = uniforms(&module.frame, &frame_inputs(hir, param_inputs, &module.frame));
    let functions = module.functions.iter_mut().zip(origins);
    // Parts of one solid have functions of one name.
    let mut said = BTreeSet::new();
    functions
        .filter_map(|(function, origins)| narrow_one(function, origins, &uniforms))
        .filter(|sentence| said.insert(sentence.clone()))
        .collect()
}

/// Takes out of a function what ranges decide; a sentence about that.
fn narrow_one(function: &mut Function, origins: &mut Origins, uniforms: &[Computed]) -> Option<String> {
    let inputs = vec![any_input(); function.inputs as usize];
    let found = narrowed(function, &inputs, uniforms);
    let sentence = sentence(&function.name, &found.decided);
    if !found.decided.is_empty() {
        // What reads something else than before would not be found again.
        let places = origins.places(function);
        *function = found.function;
        *origins = Origins::new(function, found.from.iter().map(|&from| places[from]));
        cse::cse(function);
        dce::dce(function);
    }
    sentence
}

/// What the inputs of the frame function may be: time and frame number moderate, params in their range;
/// what frames find out about solids is not known.
fn frame_inputs(hir: &hir::Scene, param_inputs: &[u32], frame: &Function) -> Vec<Computed> {
    let mut inputs = vec![Computed::UNKNOWN; frame.inputs as usize];
    inputs.iter_mut().take(2).for_each(|input| *input = any_input());
    for (param, &first) in hir.params.iter().zip(param_inputs) {
        if let (Some((lo, hi)), 1) = (param.range, param.default.len()) {
            inputs[first as usize] = Computed::within(Interval::new(lo, hi));
        }
    }
    inputs
}

/// `3 max, 1 select of which one side is never taken (interior:cloud)`
fn sentence(function: &str, decided: &[Op]) -> Option<String> {
    let kinds = [Op::Max, Op::Min, Op::Select, Op::Abs, Op::Floor, Op::Less, Op::LessEqual, Op::Equal];
    let count = |kind: Op| decided.iter().filter(|&&op| op == kind).count();
    let found = kinds.into_iter().filter(|&kind| count(kind) > 0);
    let found: Vec<String> =
        found.map(|kind| format!("{} `{}`", count(kind), operation(kind).name)).collect();
    let names = found.join(", ");
    (!found.is_empty()).then(|| format!("{names} of `{function}` left out: numbers in range decide them"))
}
