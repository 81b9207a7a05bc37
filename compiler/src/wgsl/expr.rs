//! One IR function as a WGSL function.
//!
//! In: a verified function and its number. Out: its text; each instruction but inputs and `extract`
//! of unread results is one `let`, spelled by the operation table:
//!
//! ```text
//! %7 = mul %2 %3          let v7: f32 = (v2 * v3);
//! %8 = closest[1] …       let v8 = vol_closest(vec3f(…), bitcast<u32>(vol_uniforms[6]), …);
//! %9 = extract %8 5       let v9: f32 = v8.distance;
//! ```

use super::names;
use crate::ir::{Function, Inst, ValueId};
use crate::ops::{self, Ty};
use crate::tape::rounded;
use std::fmt::Write as _;

/// Text of function `index`; `curve_table` is the word of `vol_uniforms` where the curves start.
pub(super) fn function(index: usize, function: &Function, curve_table: u32) -> String {
    let parameters: Vec<String> = (0..function.inputs).map(|i| format!("x{i}: f32")).collect();
    let mut text = format!(
        "// {}\nfn vol_f{index}({}) -> {} {{\n",
        names::comment(&function.name),
        parameters.join(", "),
        names::output_type(function.outputs.len()),
    );
    let writer = Writer { function, curve_table };
    for (i, inst) in function.insts.iter().enumerate() {
        writer.statement(&mut text, ValueId(i as u32), inst);
    }
    let outputs: Vec<String> = function.outputs.iter().map(|&v| writer.name(v)).collect();
    let _ = writeln!(text, "  return {};\n}}\n", names::output_value(&outputs));
    text
}

struct Writer<'a> {
    function: &'a Function,
    curve_table: u32,
}

impl Writer<'_> {
    /// What a value is called: inputs keep the name of their parameter.
    fn name(&self, value: ValueId) -> String {
        match self.function.insts[value.index()] {
            Inst::Input(index) => format!("x{index}"),
            Inst::Constant(_)
            | Inst::Boolean(_)
            | Inst::Uniform(_)
            | Inst::Apply { .. }
            | Inst::Extract(..) => {
                format!("v{}", value.0)
            }
        }
    }

    fn statement(&self, text: &mut String, value: ValueId, inst: &Inst) {
        let expression = match inst {
            Inst::Input(_) => return,
            Inst::Constant(number) => names::literal(rounded(number.0)),
            Inst::Boolean(truth) => truth.to_string(),
            Inst::Uniform(index) => format!("vol_uniforms[{index}]"),
            Inst::Apply { op, data, args } => self.operation(ops::operation(*op), *data, args),
            Inst::Extract(tuple, index) => self.extract(*tuple, *index),
        };
        let _ = match self.written_type(value, inst) {
            Some(ty) => writeln!(text, "  let v{}: {ty} = {expression};", value.0),
            None => writeln!(text, "  let v{} = {expression};", value.0),
        };
    }

    /// The type to write; tuples have types of the prelude, which are left to the compiler.
    fn written_type(&self, value: ValueId, inst: &Inst) -> Option<&'static str> {
        let tuple = matches!(inst, Inst::Apply { op, .. } if ops::operation(*op).results.len() > 1);
        let ty = match self.function.ty(value) {
            Ty::Number => "f32",
            Ty::Bool => "bool",
        };
        (!tuple).then_some(ty)
    }

    fn extract(&self, tuple: ValueId, index: u32) -> String {
        let suffix = match &self.function.insts[tuple.index()] {
            Inst::Apply { op, .. } => ops::operation(*op).wgsl_extract[index as usize],
            Inst::Constant(_) | Inst::Boolean(_) | Inst::Input(_) | Inst::Uniform(_) | Inst::Extract(..) => {
                ""
            }
        };
        format!("{}{suffix}", self.name(tuple))
    }

    /// The table's text with its holes filled.
    fn operation(&self, row: &ops::Operation, data: u32, args: &[ValueId]) -> String {
        let mut text = String::new();
        let mut rest = row.wgsl;
        while let Some((before, hole)) = rest.split_once('{') {
            let (hole, after) = hole.split_once('}').unwrap_or((hole, ""));
            text.push_str(before);
            text.push_str(&self.hole(hole, data, args));
            rest = after;
        }
        text.push_str(rest);
        // Function calls need no parentheses of their own; operators have theirs in the table.
        text
    }

    fn hole(&self, hole: &str, data: u32, args: &[ValueId]) -> String {
        let curve_word = |offset: u32| {
            let word = u64::from(self.curve_table) + 2 * u64::from(data) + u64::from(offset);
            format!("bitcast<u32>(vol_uniforms[{word}])")
        };
        match hole {
            "d" => data.to_string(),
            "first" => curve_word(0),
            "count" => curve_word(1),
            operand => {
                let operand = operand.parse::<usize>().ok().and_then(|i| args.get(i));
                operand.map_or_else(String::new, |&value| self.name(value))
            }
        }
    }
}
