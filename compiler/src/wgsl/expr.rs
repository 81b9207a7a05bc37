//! One IR function as a WGSL function.
//!
//! In: a verified function and its number. Out: its text; each instruction but inputs and `extract`
//! of unread results is one `let`, spelled by the operation table:
//!
//! ```text
//! %7 = mul %2 %3          let v7: f32 = (v2 * v3);
//! %8 = closest[1] …       let v8 = vol_closest(vec3f(…), VolCurve(…));
//! %9 = extract %8 5       let v9: f32 = v8.distance;
//! ```
//!
//! A loop keeps its state in variables and has the values of its body inside; a condition that fails
//! keeps the state and ends the loop, without a branch:
//!
//! ```text
//! %7 = loop 8 %2 %3 {     var v7_s0: f32 = v2;
//!                         var v7_go: bool = true;
//!                         for (var v7_i: u32 = 0u; (v7_i < 8u) & v7_go; v7_i = v7_i + 1u) {
//!   %0 = input 0
//!   %1 = input 1
//!   %2 = mul %0 %1          let v7_2: f32 = (v7_s0 * v3);
//!   %3 = less %0 %1         let v7_3: bool = (v7_s0 < v3);
//!   return %2 %3            let v7_n0: f32 = select(v7_s0, v7_2, v7_3);
//!                           v7_s0 = v7_n0;
//! }                         v7_go = v7_3; }
//! ```
//!
//! Searches for closest points that are alike are turns of one loop, see [`super::batch`].

mod turns;

use super::batch::{Member, Schedule, Step};
use super::layout::SceneRows;
use super::{Definition, names};
use crate::ir::{Function, Inst, ValueId};
use crate::ops::{self, Ty};
use crate::tape::rounded;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Text of a function.
pub(super) fn function(own: &Definition<'_>, rows: &SceneRows<'_>) -> String {
    let Definition { function, index, comments, curves } = own;
    let parameters: Vec<String> = (0..function.inputs).map(|i| format!("x{i}: f32")).collect();
    let mut text = format!(
        "// {}\nfn {}({}) -> {} {{\n",
        names::comment(&function.name),
        names::function(*index, &function.name),
        parameters.join(", "),
        names::output_type(function.outputs.len()),
    );
    let inputs: Vec<String> = (0..function.inputs).map(|i| format!("x{i}")).collect();
    let writer = Writer {
        function,
        // Searches are put together by the numbers of their curves, which must be known.
        schedule: &if curves.is_empty() { Schedule::of(function) } else { Schedule::plain(function) },
        inside: None,
        rows,
        comments,
        curves,
        inputs,
        prefix: "v".to_owned(),
        indent: "  ".to_owned(),
    };
    writer.statements(&mut text);
    let outputs: Vec<String> = function.outputs.iter().map(|&v| writer.name(v)).collect();
    let _ = writeln!(text, "  return {};\n}}\n", names::output_value(&outputs));
    text
}

struct Writer<'a> {
    function: &'a Function,
    schedule: &'a Schedule,
    /// The batch whose loop is written.
    inside: Option<usize>,
    rows: &'a SceneRows<'a>,
    /// A comment for each instruction, where there is something to say.
    comments: &'a [Option<String>],
    /// Operations on a curve whose number is a value, with that value.
    curves: &'a BTreeMap<ValueId, ValueId>,
    /// What the inputs are called.
    inputs: Vec<String>,
    /// What the names of values start with.
    prefix: String,
    indent: String,
}

impl<'a> Writer<'a> {
    /// What a value is called: inputs keep the name of their parameter.
    fn name(&self, value: ValueId) -> String {
        if let Some(member) = self.schedule.member(value)
            && self.inside != Some(member.batch)
        {
            return format!("{}[{}]", self.array(member.batch, member.row, None), member.turn);
        }
        match self.function.insts[value.index()] {
            Inst::Input(index) => self.inputs[index as usize].clone(),
            Inst::Constant(_)
            | Inst::Boolean(_)
            | Inst::Uniform(_)
            | Inst::Apply { .. }
            | Inst::Loop { .. }
            | Inst::Extract(..) => {
                format!("{}{}", self.prefix, value.0)
            }
        }
    }

    fn statements(&self, text: &mut String) {
        let mut last = None;
        for step in &self.schedule.steps {
            match *step {
                Step::One(value) => self.commented(text, value, &mut last),
                Step::Batch(index) => self.batch(text, index),
            }
        }
    }

    /// An instruction with a comment where it comes from.
    fn commented(&self, text: &mut String, value: ValueId, last: &mut Option<&'a str>) {
        let inst = &self.function.insts[value.index()];
        let comment = self.comments.get(value.index()).and_then(Option::as_deref);
        // Neighbours of one line share its comment; a number stands where it was first written, which may be anywhere.
        if let (Some(comment), Inst::Apply { .. } | Inst::Loop { .. }) = (comment, inst)
            && *last != Some(comment)
        {
            let _ = writeln!(text, "{}// {comment}", self.indent);
            *last = Some(comment);
        }
        self.statement(text, value, inst);
    }

    fn statement(&self, text: &mut String, value: ValueId, inst: &Inst) {
        let operands = self.operands(value, inst);
        let expression = match inst {
            Inst::Input(_) => return,
            Inst::Constant(number) => names::literal(rounded(number.0)),
            Inst::Boolean(truth) => truth.to_string(),
            Inst::Uniform(index) => self.rows.uniforms.word(u64::from(*index)),
            Inst::Apply { op, .. } => self.operation(ops::operation(*op), value, &operands),
            Inst::Extract(tuple, part) => self.extract(*tuple, *part, &operands[0]),
            Inst::Loop { most, body, .. } => {
                return self.repeat(text, &self.name(value), *most, body, operands);
            }
        };
        let (indent, name) = (&self.indent, self.name(value));
        let _ = match self.written_type(value, inst) {
            Some(ty) => writeln!(text, "{indent}let {name}: {ty} = {expression};"),
            None => writeln!(text, "{indent}let {name} = {expression};"),
        };
    }

    /// What the operands of an instruction are called: in the loop of a batch some are its inputs.
    fn operands(&self, value: ValueId, inst: &Inst) -> Vec<String> {
        let input = |operand: usize| {
            let member = self.home(value)?;
            let batch = &self.schedule.batches[member.batch];
            Some(self.input(batch, batch.input(self.function, member.row, operand)?))
        };
        let operands = inst.operands().iter().enumerate();
        operands.map(|(i, &operand)| input(i).unwrap_or_else(|| self.name(operand))).collect()
    }

    /// A loop; its results are the variables `name_s0`, `name_s1` …
    fn repeat(&self, text: &mut String, name: &str, most: u32, body: &Function, mut inputs: Vec<String>) {
        let (indent, state) = (&self.indent, body.state());
        for (i, input) in inputs.iter_mut().enumerate().take(state) {
            let variable = format!("{name}_s{i}");
            let _ = writeln!(text, "{indent}var {variable}: f32 = {input};");
            *input = variable;
        }
        let _ = writeln!(
            text,
            "{indent}var {name}_go: bool = true;\n\
             {indent}for (var {name}_i: u32 = 0u; ({name}_i < {most}u) & {name}_go; {name}_i = {name}_i + 1u) {{",
        );
        let inside = Writer {
            function: body,
            schedule: &Schedule::of(body),
            inside: None,
            comments: &[],
            curves: &BTreeMap::new(),
            inputs,
            prefix: format!("{name}_"),
            indent: format!("{indent}  "),
            ..*self
        };
        inside.statements(text);
        let outputs: Vec<String> = body.outputs.iter().map(|&output| inside.name(output)).collect();
        let (indent, goes_on) = (&inside.indent, &outputs[state]);
        // All of the next state before any of it is replaced: outputs may be variables of the state.
        for (i, next) in outputs.iter().enumerate().take(state) {
            let _ = writeln!(text, "{indent}let {name}_n{i}: f32 = select({name}_s{i}, {next}, {goes_on});");
        }
        for i in 0..state {
            let _ = writeln!(text, "{indent}{name}_s{i} = {name}_n{i};");
        }
        let _ = writeln!(text, "{indent}{name}_go = {goes_on};\n{}}}", self.indent);
    }

    /// The type to write; tuples have types of the prelude, which are left to the compiler.
    fn written_type(&self, value: ValueId, inst: &Inst) -> Option<&'static str> {
        let tuple = inst.parts().is_some();
        let ty = match self.function.ty(value) {
            Ty::Number => "f32",
            Ty::Bool => "bool",
        };
        (!tuple).then_some(ty)
    }

    /// A part of a tuple that is called `name`.
    fn extract(&self, tuple: ValueId, part: u32, name: &str) -> String {
        match self.schedule.member(tuple) {
            Some(member) if self.inside != Some(member.batch) => {
                format!("{}[{}]", self.array(member.batch, member.row, Some(part)), member.turn)
            }
            _ => format!("{name}{}", self.suffix(tuple, part)),
        }
    }

    /// What follows the name of a tuple to read a part.
    fn suffix(&self, tuple: ValueId, part: u32) -> String {
        match &self.function.insts[tuple.index()] {
            Inst::Apply { op, .. } => ops::operation(*op).wgsl_extract[part as usize].to_owned(),
            Inst::Loop { .. } => format!("_s{part}"),
            Inst::Constant(_) | Inst::Boolean(_) | Inst::Input(_) | Inst::Uniform(_) | Inst::Extract(..) => {
                String::new()
            }
        }
    }

    /// The table's text with its holes filled.
    fn operation(&self, row: &ops::Operation, value: ValueId, operands: &[String]) -> String {
        let mut text = String::new();
        let mut rest = row.wgsl;
        while let Some((before, hole)) = rest.split_once('{') {
            let (hole, after) = hole.split_once('}').unwrap_or((hole, ""));
            text.push_str(before);
            text.push_str(&match hole {
                "d" => self.data(value).to_string(),
                "curve" => self.curve(value),
                operand => {
                    operand.parse().ok().and_then(|i: usize| operands.get(i).cloned()).unwrap_or_default()
                }
            });
            rest = after;
        }
        text.push_str(rest);
        // Function calls need no parentheses of their own; operators have theirs in the table.
        text
    }

    /// Where a value stands in the batch whose loop is written.
    fn home(&self, value: ValueId) -> Option<Member> {
        self.schedule.member(value).filter(|member| self.inside == Some(member.batch))
    }

    fn data(&self, value: ValueId) -> u32 {
        if let Inst::Apply { data, .. } = &self.function.insts[value.index()] { *data } else { 0 }
    }

    /// Where the curve of an operation is.
    fn curve(&self, value: ValueId) -> String {
        if let Some(member) = self.home(value)
            && let Some(number) = self.curve_of_turn(&self.schedule.batches[member.batch], member.row)
        {
            return format!("vol_curve({number})");
        }
        if let Some(&number) = self.curves.get(&value) {
            return format!("vol_curve(u32({}))", self.name(number));
        }
        let curve = self.data(value);
        let [first, count] = self.rows.curve(curve);
        format!("VolCurve({first}, {count}, {curve}u)")
    }
}
