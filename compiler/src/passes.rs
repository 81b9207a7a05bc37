//! Passes: from a correct function to an equal, smaller one.
//!
//! In: the functions that lowering cut out of its graph. Out: the same functions, cheaper. The list
//! is fixed, each pass runs once per function, and a debug build verifies after each:
//!
//! | pass | before | after |
//! |---|---|---|
//! | [`fold`] | `add 1.0 2.0`, `mul %0 1.0` | `3.0`, `%0` |
//! | [`cse`] | `sqrt %0` twice | once |
//! | [`dce`] | values that no output needs | gone |
//!
//! [`narrow`] runs after them, with what the scene says its numbers may be (`lower/ranges.rs`).
//! [`gradient`], [`enclose`] and [`unclip`] are no simplifications but make new values; lowering calls them.

pub mod cse;
pub mod dce;
pub(crate) mod enclose;
pub mod fold;
pub mod gradient;
pub mod narrow;
pub(crate) mod unclip;

use crate::ir::{Function, Inst, Module, verify};
use std::sync::Arc;

/// A pass; true if it changed the function.
pub type Pass = fn(&mut Function) -> bool;

/// The passes in the order in which they run.
pub const PIPELINE: &[(&str, Pass)] = &[("fold", fold::fold), ("cse", cse::cse), ("dce", dce::dce)];

/// Runs a pass on the bodies of a function's loops; true if one changed.
fn in_bodies(function: &mut Function, pass: Pass) -> bool {
    let mut changed = false;
    for inst in &mut function.insts {
        if let Inst::Loop { body, .. } = inst {
            changed |= pass(Arc::make_mut(body));
        }
    }
    changed
}

/// Runs the pipeline on every function, the frame function included.
pub fn run(module: &mut Module) {
    for (name, pass) in PIPELINE {
        pass(&mut module.frame);
        for function in &mut module.functions {
            pass(function);
        }
        // Curve indices are not checked: how many there are is not known here.
        debug_assert_eq!(verify::module(module, u32::MAX), Ok(()), "after {name}");
    }
}

#[cfg(test)]
pub(crate) mod testing {
    //! Tests of passes: IR text in, IR text out.

    use super::Pass;
    use crate::ir::{text, verify};

    /// Runs a pass on the body of a function of three inputs and two uniforms.
    #[track_caller]
    pub(crate) fn assert_pass(pass: Pass, before: &str, after: &str) {
        let read =
            |body: &str| text::parse_function(&format!("fn f(3) {{\n{body}\n}}")).expect("well-formed text");
        let mut function = read(before);
        let changed = pass(&mut function);
        assert_eq!(text::print_function(&function), text::print_function(&read(after)));
        assert_eq!(changed, function != read(before), "says whether it changed something");
        assert_eq!(verify::function(&function, 2, 1), Ok(()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::text;
    use crate::ir::verify::random;

    #[test]
    fn the_pipeline_leaves_what_is_needed() {
        let before = "frame(1) {\n%0 = input 0\n%1 = constant 2.0\n%2 = div %0 %1\nreturn %2\n}\n\
            fn f(2) {\n%0 = input 0\n%1 = input 1\n%2 = constant 0.0\n%3 = add %0 %2\n%4 = mul %3 %1\n\
            %5 = mul %0 %1\n%6 = add %4 %5\n%7 = sin %6\n%8 = uniform 0\n%9 = add %6 %8\nreturn %9\n}";
        let after = "frame(1) {\n  %0 = input 0\n  %1 = constant 0.5\n  %2 = mul %0 %1\n  return %2\n}\n\n\
            fn f(2) {\n  %0 = input 0\n  %1 = input 1\n  %2 = mul %0 %1\n  %3 = add %2 %2\n  %4 = uniform 0\n  \
            %5 = add %3 %4\n  return %5\n}\n";
        let mut module = text::parse_module(before).expect("well-formed text");
        run(&mut module);
        let printed = text::print_module(&module);
        assert_eq!(printed, after);
    }

    #[test]
    fn the_pipeline_keeps_generated_functions_well_formed() {
        for seed in 0..200 {
            let shape = random::Shape::default();
            let mut module = Module::default();
            module.frame.inputs = shape.uniforms;
            module.frame.insts = (0..shape.uniforms).map(Inst::Input).collect();
            module.frame.outputs = (0..shape.uniforms).map(crate::ir::ValueId).collect();
            module.functions.push(random::function(seed, &shape));
            run(&mut module);
            let outputs = module.functions[0].outputs.len() as u32;
            assert_eq!(outputs, shape.outputs);
        }
    }
}
