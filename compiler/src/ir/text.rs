//! Text form of the IR: what tests and `vol dump` read and write.
//!
//! In: a [`Function`] or [`Module`]. Out: the text described in [`crate::ir`], and back. A module is
//! its frame function followed by the others:
//!
//! ```text
//! frame(2) {
//!   %0 = input 0
//!   return %0
//! }
//!
//! fn distance:ball(3) {
//!   %0 = boolean true
//!   %1 = constant -0.0
//!   %2 = uniform 0
//!   %3 = select %0 %1 %2
//!   return %3
//! }
//! ```
//!
//! The body of a loop stands in braces after its operands, without a name; it has as many inputs as
//! the loop has operands. Numbers read back bit for bit. Reading checks the form only; [`crate::ir::verify`] checks the
//! rest. An empty line means nothing; the text of a name is kept up to the last `(` of its line.

use super::{Function, Inst, Module, Number, ValueId};
use crate::ops;
use std::fmt::Write as _;
use std::sync::Arc;

/// What is wrong with a text, and where.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct TextError {
    /// Line, counted from 1.
    pub line: usize,
    /// What is wrong.
    pub message: String,
}

/// Text of a whole module.
#[must_use]
pub fn print_module(module: &Module) -> String {
    let mut text = String::new();
    print_body(&mut text, "frame", &module.frame);
    for function in &module.functions {
        text.push('\n');
        text.push_str(&print_function(function));
    }
    text
}

/// Text of one function.
#[must_use]
pub fn print_function(function: &Function) -> String {
    let mut text = String::new();
    print_body(&mut text, &format!("fn {}", function.name), function);
    text
}

fn print_body(text: &mut String, head: &str, function: &Function) {
    let _ = writeln!(text, "{head}({}) {{", function.inputs);
    print_insts(text, "  ", function);
    text.push_str("}\n");
}

fn print_insts(text: &mut String, indent: &str, function: &Function) {
    for (i, inst) in function.insts.iter().enumerate() {
        let _ = writeln!(text, "{indent}{} = {}", ValueId(i as u32), print_inst(inst, indent));
    }
    let _ = write!(text, "{indent}return");
    print_operands(text, &function.outputs);
    text.push('\n');
}

fn print_inst(inst: &Inst, indent: &str) -> String {
    match inst {
        // The debug form of an f64 is the shortest that reads back to the same bits.
        Inst::Constant(number) => format!("constant {:?}", number.0),
        Inst::Boolean(truth) => format!("boolean {truth}"),
        Inst::Input(index) => format!("input {index}"),
        Inst::Uniform(index) => format!("uniform {index}"),
        Inst::Extract(tuple, index) => format!("extract {tuple} {index}"),
        Inst::Apply { op, data, args } => {
            let row = ops::operation(*op);
            let mut text = row.name.to_owned();
            if row.has_data {
                let _ = write!(text, "[{data}]");
            }
            print_operands(&mut text, args);
            text
        }
        Inst::Loop { most, body, args } => {
            let mut text = format!("loop {most}");
            print_operands(&mut text, args);
            text.push_str(" {\n");
            print_insts(&mut text, &format!("{indent}  "), body);
            text.push_str(indent);
            text.push('}');
            text
        }
    }
}

fn print_operands(text: &mut String, operands: &[ValueId]) {
    for operand in operands {
        let _ = write!(text, " {operand}");
    }
}

/// Reads a module.
///
/// # Errors
///
/// The first line that does not have the form.
pub fn parse_module(text: &str) -> Result<Module, TextError> {
    let mut lines = Lines::new(text);
    let frame = lines.function("frame")?;
    let mut functions = Vec::new();
    while lines.peek().is_some() {
        functions.push(lines.function("fn ")?);
    }
    Ok(Module { frame: Function { name: "frame".to_owned(), ..frame }, functions })
}

/// Reads one function.
///
/// # Errors
///
/// The first line that does not have the form, or that follows the function.
pub fn parse_function(text: &str) -> Result<Function, TextError> {
    let mut lines = Lines::new(text);
    let function = lines.function("fn ")?;
    match lines.peek() {
        None => Ok(function),
        Some((line, _)) => Err(TextError { line, message: "text after the function".to_owned() }),
    }
}

/// Deepest nesting of loops that is read.
const MAX_NESTING: u32 = 64;

/// The lines that are not empty, with their numbers.
struct Lines<'a> {
    rest: Vec<(usize, &'a str)>,
    last: usize,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str) -> Self {
        let numbered = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
        let mut rest: Vec<_> = numbered.filter(|(_, line)| !line.is_empty()).collect();
        rest.reverse();
        Self { rest, last: text.lines().count() }
    }

    fn peek(&self) -> Option<(usize, &'a str)> {
        self.rest.last().copied()
    }

    fn next(&mut self) -> Result<(usize, &'a str), TextError> {
        let end = TextError { line: self.last, message: "the text ends inside a function".to_owned() };
        self.rest.pop().ok_or(end)
    }

    /// A function whose first line starts with `keyword`.
    fn function(&mut self, keyword: &str) -> Result<Function, TextError> {
        let (line, text) = self.next()?;
        let (name, inputs) = head(text, keyword).map_err(|message| TextError { line, message })?;
        self.rest_of(Function { name: name.to_owned(), inputs, ..Function::default() }, MAX_NESTING)
    }

    /// The instructions of a function up to its `}`; loops may nest so much deeper.
    fn rest_of(&mut self, mut function: Function, nesting: u32) -> Result<Function, TextError> {
        loop {
            let (line, text) = self.next()?;
            let fail = |message| TextError { line, message };
            if let Some(outputs) = text.strip_prefix("return") {
                function.outputs = values(outputs).map_err(fail)?;
                break;
            }
            let inst = instruction(text, function.insts.len()).map_err(fail)?;
            let inst = match inst.strip_suffix('{') {
                None => statement(inst).map_err(fail)?,
                Some(_) if nesting == 0 => return Err(fail("loops nest too deep".to_owned())),
                Some(head) => {
                    let (most, args) = loop_head(head).map_err(fail)?;
                    let body = Function { inputs: args.len() as u32, ..Function::default() };
                    Inst::Loop { most, body: Arc::new(self.rest_of(body, nesting - 1)?), args }
                }
            };
            function.insts.push(inst);
        }
        match self.next()? {
            (_, "}") => Ok(function),
            (line, _) => Err(TextError { line, message: "`}` expected after `return`".to_owned() }),
        }
    }
}

/// Name and number of inputs in `keyword` name `(` inputs `) {`.
fn head<'a>(text: &'a str, keyword: &str) -> Result<(&'a str, u32), String> {
    let expected = || format!("`{keyword}…(inputs) {{` expected");
    let rest = text.strip_prefix(keyword).and_then(|rest| rest.strip_suffix(") {")).ok_or_else(expected)?;
    let (name, inputs) = rest.rsplit_once('(').ok_or_else(expected)?;
    Ok((name.trim(), number(inputs)?))
}

/// The instruction after `%index = `.
fn instruction(text: &str, index: usize) -> Result<&str, String> {
    let (target, inst) = text.split_once('=').ok_or("`=` expected")?;
    if value(target.trim())?.index() != index {
        return Err(format!("%{index} expected on the left"));
    }
    Ok(inst.trim())
}

/// Steps and operands in `loop ` steps operands.
fn loop_head(text: &str) -> Result<(u32, Vec<ValueId>), String> {
    let rest = text.strip_prefix("loop ").ok_or("`loop` expected before `{`")?.trim();
    let (most, args) = rest.split_once(' ').ok_or("operands of the loop expected")?;
    Ok((number(most)?, values(args)?))
}

/// An instruction of one line.
fn statement(inst: &str) -> Result<Inst, String> {
    let (word, rest) = inst.split_once(' ').unwrap_or((inst, ""));
    let rest = rest.trim();
    match word {
        "constant" => {
            rest.parse().map(|n| Inst::Constant(Number(n))).map_err(|_| format!("`{rest}` is not a number"))
        }
        "boolean" => rest.parse().map(Inst::Boolean).map_err(|_| format!("`{rest}` is not true or false")),
        "input" => Ok(Inst::Input(number(rest)?)),
        "uniform" => Ok(Inst::Uniform(number(rest)?)),
        "extract" => {
            let (tuple, index) = rest.split_once(' ').ok_or("a value and an index expected")?;
            Ok(Inst::Extract(value(tuple)?, number(index.trim())?))
        }
        _ => operation(word, rest),
    }
}

/// An operation of the table, `name` or `name[data]`, and its operands.
fn operation(word: &str, operands: &str) -> Result<Inst, String> {
    let (name, data) = match word.strip_suffix(']').and_then(|word| word.split_once('[')) {
        Some((name, data)) => (name, Some(number(data)?)),
        None => (word, None),
    };
    let row = ops::by_name(name).ok_or_else(|| format!("no operation is called `{name}`"))?;
    if row.has_data != data.is_some() {
        let verb = if row.has_data { "needs" } else { "takes no" };
        return Err(format!("`{name}` {verb} data in brackets"));
    }
    Ok(Inst::Apply { op: row.op, data: data.unwrap_or(0), args: values(operands)? })
}

fn values(text: &str) -> Result<Vec<ValueId>, String> {
    text.split_whitespace().map(value).collect()
}

fn value(text: &str) -> Result<ValueId, String> {
    let digits = text.strip_prefix('%').ok_or_else(|| format!("`{text}` is not a value"))?;
    Ok(ValueId(number(digits)?))
}

fn number(text: &str) -> Result<u32, String> {
    text.parse().map_err(|_| format!("`{text}` is not a whole number"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::verify::random;

    #[test]
    fn generated_functions_survive_a_round_trip() {
        for seed in 0..300 {
            let mut function = random::function(seed, &random::Shape::default());
            function.name = "distance:ball (2)".to_owned();
            let text = print_function(&function);
            assert_eq!(parse_function(&text), Ok(function), "{text}");
        }
    }

    #[test]
    fn modules_survive_a_round_trip() {
        let mut frame = random::function(1, &random::Shape { uniforms: 0, ..random::Shape::default() });
        frame.name = "frame".to_owned();
        let functions = (2..5).map(|seed| random::function(seed, &random::Shape::default())).collect();
        let module = Module { frame, functions };
        assert_eq!(parse_module(&print_module(&module)), Ok(module));
    }

    #[test]
    fn numbers_keep_their_bits() {
        let numbers = [0.0, -0.0, 0.1, -1.5e-300, f64::MIN_POSITIVE / 8.0, f64::MAX, 1.0 / 3.0, 16_777_217.0];
        let insts = numbers.iter().map(|&n| Inst::Constant(Number(n))).collect();
        let function = Function { name: "n".to_owned(), inputs: 0, insts, outputs: Vec::new() };
        assert_eq!(parse_function(&print_function(&function)), Ok(function));
    }

    #[test]
    fn errors_name_the_line() {
        let cases = [
            ("", "line 0: the text ends inside a function"),
            ("fn f(1) {\n  %0 = input 0", "line 2: the text ends inside a function"),
            ("fn f(x) {\n  return\n}", "line 1: `x` is not a whole number"),
            ("function f(1) {\n}", "line 1: `fn …(inputs) {` expected"),
            ("fn f(1) {\n\n  %1 = input 0\n  return\n}", "line 3: %0 expected on the left"),
            ("fn f(1) {\n  %0 = bogus %1\n  return\n}", "line 2: no operation is called `bogus`"),
            ("fn f(1) {\n  %0 = add[3] %0 %0\n  return\n}", "line 2: `add` takes no data in brackets"),
            ("fn f(1) {\n  %0 = perlin %0 %0\n  return\n}", "line 2: `perlin` needs data in brackets"),
            ("fn f(1) {\n  %0 = input 0\n  %1 = loop %0 {\n", "line 3: operands of the loop expected"),
            ("fn f(1) {\n  %0 = input 0\n  %1 = neg %0 {\n", "line 3: `loop` expected before `{`"),
            (
                "fn f(1) {\n  %0 = input 0\n  %1 = loop 3 %0 {\n  %0 = bogus 0\n",
                "line 4: no operation is called `bogus`",
            ),
            ("fn f(1) {\n  return\n}\nmore", "line 4: text after the function"),
        ];
        for (text, message) in cases {
            assert_eq!(parse_function(text).map_err(|e| e.to_string()), Err(message.to_owned()));
        }
    }
}
