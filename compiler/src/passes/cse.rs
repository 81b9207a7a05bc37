//! Common subexpressions: equal instructions become one.
//!
//! ```text
//! %0 = input 0            %0 = input 0
//! %1 = input 1            %1 = input 1
//! %2 = mul %0 %1          %2 = mul %0 %1
//! %3 = mul %1 %0    ──►
//! %4 = add %2 %3          %3 = add %2 %2
//! return %4               return %3
//! ```
//!
//! Precondition: a verified function. Exact: no value changes, the order of operands counts only
//! where it matters to the result.

use crate::ir::{Function, Inst, ValueId};
use crate::ops::Op;
use rustc_hash::FxHashMap;

/// The pass.
pub fn cse(function: &mut Function) -> bool {
    let inside = super::in_bodies(function, cse);
    let mut known: FxHashMap<Inst, ValueId> = FxHashMap::default();
    let mut renamed: Vec<ValueId> = Vec::with_capacity(function.insts.len());
    let mut insts: Vec<Inst> = Vec::with_capacity(function.insts.len());
    for old in &function.insts {
        let inst = old.map_operands(|v| renamed[v.index()]);
        let next = ValueId(insts.len() as u32);
        let value = *known.entry(key(&inst)).or_insert(next);
        if value == next {
            insts.push(inst);
        }
        renamed.push(value);
    }
    for output in &mut function.outputs {
        *output = renamed[output.index()];
    }
    let changed = inside || insts.len() < function.insts.len();
    function.insts = insts;
    changed
}

/// Equal for instructions that compute the same.
fn key(inst: &Inst) -> Inst {
    let mut key = inst.clone();
    if let Inst::Apply { op: Op::Add | Op::Mul | Op::Equal | Op::And | Op::Or, args, .. } = &mut key {
        args.sort_unstable();
    }
    key
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::passes::testing::assert_pass;

    #[test]
    fn equal_instructions_are_one() {
        assert_pass(
            cse,
            "%0 = input 0\n%1 = input 0\n%2 = sqrt %0\n%3 = sqrt %1\n%4 = sub %2 %3\nreturn %4 %3",
            "%0 = input 0\n%1 = sqrt %0\n%2 = sub %1 %1\nreturn %2 %1",
        );
    }

    #[test]
    fn the_order_of_operands_counts_where_it_matters() {
        assert_pass(
            cse,
            "%0 = input 0\n%1 = input 1\n%2 = add %0 %1\n%3 = add %1 %0\n%4 = sub %0 %1\n%5 = sub %1 %0\nreturn %2 %3 %4 %5",
            "%0 = input 0\n%1 = input 1\n%2 = add %0 %1\n%3 = sub %0 %1\n%4 = sub %1 %0\nreturn %2 %2 %3 %4",
        );
    }

    #[test]
    fn zeros_of_different_sign_are_two() {
        let kept = "%0 = constant 0.0\n%1 = constant -0.0\nreturn %0 %1";
        assert_pass(cse, kept, kept);
    }

    #[test]
    fn seeds_and_results_count() {
        let kept = "%0 = input 0\n%1 = perlin_gradient[1] %0 %0 %0\n%2 = perlin_gradient[2] %0 %0 %0\n\
            %3 = extract %1 0\n%4 = extract %2 0\n%5 = extract %1 1\nreturn %3 %4 %5";
        assert_pass(cse, kept, kept);
    }
}
