//! The invariants of the IR, checked after lowering and after every pass of a debug build.
//!
//! A function is well formed when
//!
//! 1. [`operands_are_earlier`]: every operand is an earlier value of the function;
//! 2. [`leaves_are_in_range`]: inputs and uniforms exist, constants are finite;
//! 3. [`operands_fit`]: operations have as many operands as the table says, of its types;
//! 4. [`data_fits`]: data is 0 where it means nothing, and a curve that exists for curve operations;
//! 5. [`tuples_are_extracted`]: values of operations with several results and of loops are read only
//!    by `extract`, which reads nothing else and stays within their results;
//! 6. [`outputs_are_numbers`]: outputs exist and are single numbers;
//! 7. [`loops_fit`]: a loop takes at most [`MAX_STEPS`] steps, has a state of 1 to [`MAX_STATE`] numbers
//!    and as many operands as its body has inputs, all single numbers; its body is well formed, reads
//!    no uniform, and its last output is a truth value.
//!
//! A module is well formed when besides
//!
//! 8. [`module`]: the frame function reads no uniform, and its outputs are the uniforms of the rest.
//!
//! Example: `%0 = less %0 %0` breaks 1; [`random`] makes functions that break nothing.

pub mod random;

use super::{Function, Inst, MAX_STATE, MAX_STEPS, Module, ValueId};
use crate::ops::{self, Ty};

/// What breaks an invariant, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VerifyError {
    /// An operand does not exist yet.
    #[error("`{function}`, {value}: operand {operand} is not an earlier value")]
    OperandNotEarlier {
        /// Name of the function.
        function: String,
        /// The instruction.
        value: ValueId,
        /// The operand.
        operand: ValueId,
    },
    /// An input or uniform does not exist.
    #[error("`{function}`, {value}: {what} {index} of {count}")]
    LeafOutOfRange {
        /// Name of the function.
        function: String,
        /// The instruction.
        value: ValueId,
        /// `input` or `uniform`.
        what: &'static str,
        /// Its index.
        index: u32,
        /// How many there are.
        count: u32,
    },
    /// A constant is infinite or not a number.
    #[error("`{function}`, {value}: the constant is not finite")]
    ConstantNotFinite {
        /// Name of the function.
        function: String,
        /// The instruction.
        value: ValueId,
    },
    /// An operation has too many or too few operands.
    #[error("`{function}`, {value}: {found} operands, {expected} expected")]
    WrongArity {
        /// Name of the function.
        function: String,
        /// The instruction.
        value: ValueId,
        /// Operands it has.
        found: usize,
        /// Operands the table gives it.
        expected: usize,
    },
    /// An operand has the wrong type.
    #[error("`{function}`, {value}: operand {operand} is a {found:?}")]
    WrongType {
        /// Name of the function.
        function: String,
        /// The instruction.
        value: ValueId,
        /// The operand.
        operand: ValueId,
        /// Its type.
        found: Ty,
    },
    /// Data that means nothing, or a curve that does not exist.
    #[error("`{function}`, {value}: data {data} out of range")]
    DataOutOfRange {
        /// Name of the function.
        function: String,
        /// The instruction.
        value: ValueId,
        /// Its data.
        data: u32,
    },
    /// A value with several results is read as one.
    #[error("`{function}`, {value}: {tuple} has several results")]
    TupleReadWhole {
        /// Name of the function.
        function: String,
        /// The instruction that reads, or the tuple itself if an output reads it.
        value: ValueId,
        /// The value with several results.
        tuple: ValueId,
    },
    /// An extract that has nothing to read.
    #[error("`{function}`, {value}: {tuple} has no result {index} to extract")]
    NothingToExtract {
        /// Name of the function.
        function: String,
        /// The instruction.
        value: ValueId,
        /// The value it reads.
        tuple: ValueId,
        /// The result it asks for.
        index: u32,
    },
    /// A loop takes too many steps or has no state or too much of it.
    #[error("`{function}`, {value}: a loop of {steps} steps over {state} numbers")]
    LoopOutOfRange {
        /// Name of the function.
        function: String,
        /// The instruction.
        value: ValueId,
        /// Steps it takes.
        steps: u32,
        /// Numbers in its state.
        state: usize,
    },
    /// The last output of the body of a loop is no truth value.
    #[error("`{function}`, {value}: the body does not say whether to go on")]
    NoCondition {
        /// Name of the function.
        function: String,
        /// The loop.
        value: ValueId,
    },
    /// An output does not exist or is no number.
    #[error("`{function}`: output {output} is not a number of the function")]
    BadOutput {
        /// Name of the function.
        function: String,
        /// The output.
        output: ValueId,
    },
}

type Checked = Result<(), VerifyError>;

/// Checks a whole module of a program with so many curves.
///
/// # Errors
///
/// The first broken invariant.
pub fn module(module: &Module, curves: u32) -> Checked {
    function(&module.frame, 0, curves)?;
    let uniforms = module.frame.outputs.len() as u32;
    module.functions.iter().try_for_each(|f| function(f, uniforms, curves))
}

/// Checks one function that may read so many uniforms and curves.
///
/// # Errors
///
/// The first broken invariant.
pub fn function(f: &Function, uniforms: u32, curves: u32) -> Checked {
    instructions(f, uniforms, curves)?;
    outputs_are_numbers(f, &f.outputs)
}

fn instructions(f: &Function, uniforms: u32, curves: u32) -> Checked {
    for (i, inst) in f.insts.iter().enumerate() {
        let value = ValueId(i as u32);
        operands_are_earlier(f, value, inst)?;
        leaves_are_in_range(f, value, inst, uniforms)?;
        operands_fit(f, value, inst)?;
        data_fits(f, value, inst, curves)?;
        tuples_are_extracted(f, value, inst)?;
        loops_fit(f, value, inst, curves)?;
    }
    Ok(())
}

fn operands_are_earlier(f: &Function, value: ValueId, inst: &Inst) -> Checked {
    match inst.operands().iter().find(|&&operand| operand >= value) {
        None => Ok(()),
        Some(&operand) => Err(VerifyError::OperandNotEarlier { function: f.name.clone(), value, operand }),
    }
}

fn leaves_are_in_range(f: &Function, value: ValueId, inst: &Inst, uniforms: u32) -> Checked {
    let (what, index, count) = match inst {
        Inst::Input(index) => ("input", *index, f.inputs),
        Inst::Uniform(index) => ("uniform", *index, uniforms),
        Inst::Constant(number) if !number.0.is_finite() => {
            return Err(VerifyError::ConstantNotFinite { function: f.name.clone(), value });
        }
        Inst::Constant(_) | Inst::Boolean(_) | Inst::Apply { .. } | Inst::Extract(..) | Inst::Loop { .. } => {
            return Ok(());
        }
    };
    if index < count {
        return Ok(());
    }
    Err(VerifyError::LeafOutOfRange { function: f.name.clone(), value, what, index, count })
}

fn operands_fit(f: &Function, value: ValueId, inst: &Inst) -> Checked {
    let Inst::Apply { op, args, .. } = inst else { return Ok(()) };
    let row = ops::operation(*op);
    if args.len() != row.args.len() {
        let (found, expected) = (args.len(), row.args.len());
        return Err(VerifyError::WrongArity { function: f.name.clone(), value, found, expected });
    }
    for (&operand, &expected) in args.iter().zip(row.args) {
        let found = f.ty(operand);
        if found != expected {
            return Err(VerifyError::WrongType { function: f.name.clone(), value, operand, found });
        }
    }
    Ok(())
}

fn data_fits(f: &Function, value: ValueId, inst: &Inst, curves: u32) -> Checked {
    let Inst::Apply { op, data, .. } = inst else { return Ok(()) };
    let fits = match op {
        op if op.reads_curve() => *data < curves,
        other => *data == 0 || ops::operation(*other).has_data,
    };
    if fits {
        Ok(())
    } else {
        Err(VerifyError::DataOutOfRange { function: f.name.clone(), value, data: *data })
    }
}

fn tuples_are_extracted(f: &Function, value: ValueId, inst: &Inst) -> Checked {
    if let Inst::Extract(tuple, index) = inst {
        let parts = f.insts[tuple.index()].parts();
        if parts.is_some_and(|parts| (*index as usize) < parts) {
            return Ok(());
        }
        return Err(VerifyError::NothingToExtract {
            function: f.name.clone(),
            value,
            tuple: *tuple,
            index: *index,
        });
    }
    match inst.operands().iter().find(|operand| f.insts[operand.index()].parts().is_some()) {
        None => Ok(()),
        Some(&tuple) => Err(VerifyError::TupleReadWhole { function: f.name.clone(), value, tuple }),
    }
}

fn loops_fit(f: &Function, value: ValueId, inst: &Inst, curves: u32) -> Checked {
    let Inst::Loop { most, body, args } = inst else { return Ok(()) };
    let state = body.state();
    if *most > MAX_STEPS || state == 0 || state > MAX_STATE {
        let (function, steps) = (f.name.clone(), *most);
        return Err(VerifyError::LoopOutOfRange { function, value, steps, state });
    }
    let expected = body.inputs as usize;
    if args.len() != expected || args.len() < state {
        return Err(VerifyError::WrongArity {
            function: f.name.clone(),
            value,
            found: args.len(),
            expected: expected.max(state),
        });
    }
    if let Some(&operand) = args.iter().find(|&&operand| f.ty(operand) != Ty::Number) {
        return Err(VerifyError::WrongType { function: f.name.clone(), value, operand, found: Ty::Bool });
    }
    instructions(body, 0, curves)?;
    outputs_are_numbers(body, &body.outputs[..state])?;
    let decides = |condition: ValueId| {
        body.insts.get(condition.index()).is_some_and(|_| body.ty(condition) == Ty::Bool)
    };
    if decides(body.outputs[state]) {
        Ok(())
    } else {
        Err(VerifyError::NoCondition { function: f.name.clone(), value })
    }
}

fn outputs_are_numbers(f: &Function, outputs: &[ValueId]) -> Checked {
    for &output in outputs {
        if output.index() >= f.insts.len() || f.ty(output) != Ty::Number {
            return Err(VerifyError::BadOutput { function: f.name.clone(), output });
        }
        if f.insts[output.index()].parts().is_some() {
            return Err(VerifyError::TupleReadWhole {
                function: f.name.clone(),
                value: output,
                tuple: output,
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::text;
    use crate::ops::Op;

    /// What the verifier says about a function of one input, two uniforms and one curve.
    fn verdict(body: &str) -> String {
        let f = text::parse_function(&format!("fn f(1) {{\n{body}\n}}")).expect("well-formed text");
        function(&f, 2, 1).map_or_else(|error| error.to_string(), |()| "fine".to_owned())
    }

    #[test]
    fn generated_functions_are_fine() {
        for seed in 0..500 {
            let shape = random::Shape::default();
            assert_eq!(function(&random::function(seed, &shape), shape.uniforms, shape.curves), Ok(()));
        }
    }

    /// A loop that halves a number while it is above 1 has this head and this condition.
    fn halving(head: &str, condition: &str) -> String {
        format!(
            "%0 = input 0\n%1 = {head} {{\n%0 = input 0\n%1 = constant 1.0\n%2 = less %1 %0\n\
             %3 = constant 0.5\n%4 = mul %0 %3\nreturn %4 {condition}\n}}\n%2 = extract %1 0\nreturn %2"
        )
    }

    #[test]
    fn each_invariant_is_checked() {
        let cases = [
            ("%0 = input 0\n%1 = add %0 %0\nreturn %1", "fine"),
            ("%0 = neg %0\nreturn %0", "`f`, %0: operand %0 is not an earlier value"),
            ("%0 = neg %7\nreturn %0", "`f`, %0: operand %7 is not an earlier value"),
            ("%0 = input 1\nreturn %0", "`f`, %0: input 1 of 1"),
            ("%0 = uniform 2\nreturn %0", "`f`, %0: uniform 2 of 2"),
            ("%0 = constant inf\nreturn %0", "`f`, %0: the constant is not finite"),
            ("%0 = input 0\n%1 = add %0\nreturn %1", "`f`, %1: 1 operands, 2 expected"),
            ("%0 = boolean true\n%1 = neg %0\nreturn %1", "`f`, %1: operand %0 is a Bool"),
            ("%0 = input 0\n%1 = not %0\nreturn %0", "`f`, %1: operand %0 is a Number"),
            ("%0 = input 0\n%1 = closest[1] %0 %0 %0\nreturn %0", "`f`, %1: data 1 out of range"),
            (
                "%0 = input 0\n%1 = closest[0] %0 %0 %0\n%2 = neg %1\nreturn %2",
                "`f`, %2: %1 has several results",
            ),
            ("%0 = input 0\n%1 = closest[0] %0 %0 %0\nreturn %1", "`f`, %1: %1 has several results"),
            (
                "%0 = input 0\n%1 = closest[0] %0 %0 %0\n%2 = extract %1 8\nreturn %2",
                "`f`, %2: %1 has no result 8 to extract",
            ),
            ("%0 = input 0\n%1 = extract %0 0\nreturn %1", "`f`, %1: %0 has no result 0 to extract"),
            (&halving("loop 3 %0", "%2"), "fine"),
            (&halving("loop 1024 %0", "%2"), "fine"),
            (&halving("loop 1025 %0", "%2"), "`f`, %1: a loop of 1025 steps over 1 numbers"),
            (
                "%0 = input 0\n%1 = loop 3 %0 {\n%0 = boolean true\nreturn %0\n}\nreturn %0",
                "`f`, %1: a loop of 3 steps over 0 numbers",
            ),
            (&halving("loop 3 %0", "%1"), "`f`, %1: the body does not say whether to go on"),
            (&halving("loop 3 %0", "%9"), "`f`, %1: the body does not say whether to go on"),
            (&halving("loop 3 %0 %1", "%2"), "`f`, %1: operand %1 is not an earlier value"),
            (
                "%0 = boolean true\n%1 = loop 3 %0 {\n%0 = input 0\n%1 = boolean true\nreturn %0 %1\n}\nreturn %0",
                "`f`, %1: operand %0 is a Bool",
            ),
            (
                "%0 = input 0\n%1 = loop 3 %0 {\n%0 = input 1\n%1 = boolean true\nreturn %0 %1\n}\nreturn %0",
                "``, %0: input 1 of 1",
            ),
            (
                "%0 = input 0\n%1 = loop 3 %0 {\n%0 = uniform 0\n%1 = boolean true\nreturn %0 %1\n}\nreturn %0",
                "``, %0: uniform 0 of 0",
            ),
            (
                "%0 = input 0\n%1 = loop 3 %0 {\n%0 = boolean true\nreturn %0 %0 %0\n}\nreturn %0",
                "`f`, %1: 1 operands, 2 expected",
            ),
            (
                &halving("loop 3 %0", "%2").replace("extract %1 0", "neg %1"),
                "`f`, %2: %1 has several results",
            ),
            (
                &halving("loop 3 %0", "%2").replace("extract %1 0", "extract %1 1"),
                "`f`, %2: %1 has no result 1 to extract",
            ),
            ("%0 = boolean true\nreturn %0", "`f`: output %0 is not a number of the function"),
            ("%0 = input 0\nreturn %1", "`f`: output %1 is not a number of the function"),
        ];
        for (body, expected) in cases {
            assert_eq!(verdict(body), expected, "{body}");
        }
    }

    #[test]
    fn data_must_mean_something() {
        let args = vec![ValueId(0)];
        let insts = vec![Inst::Input(0), Inst::Apply { op: Op::Neg, data: 3, args }];
        let f = Function { name: "f".to_owned(), inputs: 1, insts, outputs: vec![ValueId(1)] };
        let error = VerifyError::DataOutOfRange { function: "f".to_owned(), value: ValueId(1), data: 3 };
        assert_eq!(function(&f, 0, 0), Err(error));
    }

    #[test]
    fn the_frame_function_defines_the_uniforms() {
        let parse = |text| module(&text::parse_module(text).expect("well-formed text"), 0);
        assert_eq!(
            parse("frame(1) {\n%0 = input 0\nreturn %0\n}\nfn f(0) {\n%0 = uniform 0\nreturn %0\n}"),
            Ok(())
        );
        assert!(parse("frame(1) {\nreturn\n}\nfn f(0) {\n%0 = uniform 0\nreturn %0\n}").is_err());
        assert!(parse("frame(1) {\n%0 = uniform 0\nreturn %0\n}").is_err());
    }
}
