//! Dead code: values that no output needs are removed.
//!
//! ```text
//! %0 = input 0            %0 = input 0
//! %1 = input 1      ──►
//! %2 = sin %1
//! %3 = neg %0             %1 = neg %0
//! return %3               return %1
//! ```
//!
//! Precondition: a verified function. Exact: what stays keeps its order. The number of inputs and
//! outputs stays.

use crate::ir::{Function, Inst, ValueId};

/// The pass.
pub fn dce(function: &mut Function) -> bool {
    let inside = super::in_bodies(function, dce);
    let needed = needed(function);
    let mut renamed = vec![ValueId(0); function.insts.len()];
    let mut insts: Vec<Inst> = Vec::new();
    for (i, inst) in function.insts.iter().enumerate().filter(|(i, _)| needed[*i]) {
        renamed[i] = ValueId(insts.len() as u32);
        insts.push(inst.map_operands(|v| renamed[v.index()]));
    }
    for output in &mut function.outputs {
        *output = renamed[output.index()];
    }
    let changed = inside || insts.len() < function.insts.len();
    function.insts = insts;
    changed
}

/// Which instructions the pass keeps, in their order.
pub(super) fn kept(function: &Function) -> Vec<usize> {
    let needed = needed(function);
    (0..needed.len()).filter(|&i| needed[i]).collect()
}

/// Whether each instruction is needed for an output.
fn needed(function: &Function) -> Vec<bool> {
    // Operands are earlier, so one walk from the end marks all that is needed.
    let mut needed = vec![false; function.insts.len()];
    for output in &function.outputs {
        needed[output.index()] = true;
    }
    for (i, inst) in function.insts.iter().enumerate().rev() {
        if needed[i] {
            for operand in inst.operands() {
                needed[operand.index()] = true;
            }
        }
    }
    needed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::passes::testing::assert_pass;

    #[test]
    fn chains_without_users_go() {
        assert_pass(
            dce,
            "%0 = input 0\n%1 = input 1\n%2 = sin %1\n%3 = cos %2\n%4 = neg %0\nreturn %4",
            "%0 = input 0\n%1 = neg %0\nreturn %1",
        );
    }

    #[test]
    fn a_tuple_stays_for_one_of_its_results() {
        assert_pass(
            dce,
            "%0 = input 0\n%1 = closest[0] %0 %0 %0\n%2 = extract %1 0\n%3 = extract %1 5\nreturn %3",
            "%0 = input 0\n%1 = closest[0] %0 %0 %0\n%2 = extract %1 5\nreturn %2",
        );
    }

    #[test]
    fn functions_without_outputs_become_empty() {
        assert_pass(dce, "%0 = input 0\n%1 = neg %0\nreturn", "return");
    }
}
