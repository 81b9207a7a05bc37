//! WGSL: the functions of a module as shader text.
//!
//! In: verified IR. Out: text that naga has accepted. What every shader of this crate is made of:
//!
//! | part | from |
//! |---|---|
//! | bindings | [`layout`], with the words that the host puts into the buffers |
//! | prelude: `fun.wgsl`, `noise.wgsl` and its folder, `curve.wgsl`, `feet.wgsl` | kept as files, included where called |
//! | `fn vol_f0_name(x0: f32, …)`, one per IR function | [`expr`] |
//! | an entry point | [`evaluation_module`], [`render`] |
//!
//! ```text
//! fn distance:ball(3) {              // distance:ball
//!   %0 = input 0                     fn vol_f0_distance_ball(x0: f32, x1: f32, x2: f32) -> f32 {
//!   %1 = uniform 4                     let v1: f32 = vol_uniforms[1].x;
//!   %2 = mul %0 %1            ──►      let v2: f32 = (x0 * v1);
//!   return %2                          return v2;
//! }                                  }
//! ```
//!
//! A function gives `f32`, `vec2f`, `vec3f` or `vec4f` for one to four outputs, else a structure
//! `VolOut10 { v0: f32, … }` that all functions with so many outputs share. Every intermediate has a
//! name, everything is in parentheses, and there is neither a branch (but for the ends of loops) nor
//! `&&` or `||`: drivers take exponential time over those, and Tint refuses what naga lets pass.

mod batch;
mod expr;
pub mod layout;
pub mod names;
pub mod render;
pub(crate) mod spirv;

use crate::families::Families;
use crate::ir::origin::Origins;
use crate::ir::{Function, FunctionId, Module, ValueId};
use crate::program::Program;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use vol_language::source::Span;

use layout::SceneRows;
pub use layout::{Space, scene_words};
pub use spirv::{Arithmetic, Spirv, strict_spirv};

/// Threads in a workgroup of [`evaluation_module`].
pub const EVALUATION_GROUP: u32 = 64;

/// Bindings of [`evaluation_module`] after those of the scene.
const EVALUATION_BINDINGS: &str = "\
@group(0) @binding(3) var<storage, read> vol_input: array<f32>;
@group(0) @binding(4) var<storage, read_write> vol_output: array<f32>;

";

/// Prelude files, those that others call first.
const PRELUDE: [&str; 8] = [
    include_str!("wgsl/fun.wgsl"),
    include_str!("wgsl/noise.wgsl"),
    include_str!("wgsl/noise/perlin4.wgsl"),
    include_str!("wgsl/noise/value.wgsl"),
    include_str!("wgsl/noise/simplex.wgsl"),
    include_str!("wgsl/noise/worley.wgsl"),
    include_str!("wgsl/curve.wgsl"),
    include_str!("wgsl/feet.wgsl"),
];

/// A text that naga does not accept: a fault of this crate, never of a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WgslError {
    /// It is no WGSL.
    #[error("the shader does not parse: {message}")]
    Parse {
        /// What naga says.
        message: String,
    },
    /// It breaks a rule of WGSL.
    #[error("the shader is not valid: {message}")]
    Validate {
        /// What naga says.
        message: String,
    },
    /// It cannot be said in another language.
    #[error("the shader cannot be translated to {language}: {message}")]
    Translate {
        /// The other language.
        language: &'static str,
        /// What naga says.
        message: String,
    },
}

/// A shader text and how its inputs are bound.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shader {
    /// WGSL that naga has accepted.
    pub text: String,
    /// What kind of buffer each input is, by binding; the output, a storage buffer that is written, comes after them.
    pub inputs: Vec<Space>,
}

/// The prelude, those functions of a program that are asked for, and its families: what an entry point is put under. `fun.wgsl` is there
/// in any case, for the entry point.
fn functions(
    program: &Program,
    rows: &SceneRows<'_>,
    notes: Option<&Notes<'_>>,
    is_asked: &dyn Fn(FunctionId) -> bool,
) -> String {
    let functions = program.module.functions.iter().enumerate();
    let comments =
        |index: usize| notes.map_or_else(Vec::new, |notes| notes.of(index, &program.module.functions[index]));
    let mut all: Vec<Definition<'_>> = functions
        .filter(|(index, _)| is_asked(FunctionId(*index as u32)))
        .map(|(index, _)| Definition { comments: comments(index), ..Definition::of(&program.module, index) })
        .collect();
    let families = Families::of(program);
    all.extend(families.all.iter().enumerate().map(|(number, family)| {
        let of_first = comments(family.first.index());
        let comment = |origin: &Option<usize>| of_first.get((*origin)?)?.clone();
        let comments = family.origins.iter().map(comment).collect();
        let index = family_index(program, number);
        Definition { function: &family.function, index, comments, curves: family.curves.clone() }
    }));
    let used = if program.styles.is_empty() { "vol_exp2(" } else { "vol_exp2(vol_atan2(" };
    definitions(rows, &all, used)
}

/// The number of a family in the names of functions: families come after the functions of the program.
fn family_index(program: &Program, number: usize) -> usize {
    program.module.functions.len() + number
}

/// A function to be written.
struct Definition<'a> {
    function: &'a Function,
    /// The number in its name.
    index: usize,
    /// A comment for each instruction, where there is something to say.
    comments: Vec<Option<String>>,
    /// Operations on a curve whose number is a value, with that value.
    curves: BTreeMap<ValueId, ValueId>,
}

impl<'a> Definition<'a> {
    /// A function of a module without comments.
    fn of(module: &'a Module, index: usize) -> Self {
        Self { function: &module.functions[index], index, comments: Vec::new(), curves: BTreeMap::new() }
    }
}

/// What a text says about where its lines come from.
pub struct Notes<'a> {
    origins: &'a [Origins],
    line: &'a dyn Fn(Span) -> Option<String>,
}

impl<'a> Notes<'a> {
    /// `line` words the line of a place, without an end of line.
    pub fn new(program: &'a Program, line: &'a dyn Fn(Span) -> Option<String>) -> Self {
        Self { origins: &program.origins, line }
    }

    /// A comment for each instruction of function `index`.
    fn of(&self, index: usize, function: &Function) -> Vec<Option<String>> {
        let places = self.origins.get(index).map_or_else(Vec::new, |origins| origins.places(function));
        places.into_iter().map(|place| Some(names::comment(&(self.line)(place?)?))).collect()
    }
}

/// A shader that evaluates one function at many points.
///
/// Its entry point is `evaluate`, in groups of [`EVALUATION_GROUP`] along x, then along y;
/// `vol_input` holds the number of points (the bits of a u32) and then the inputs, point by point;
/// `vol_output` gets the outputs, point by point.
///
/// # Errors
///
/// [`WgslError`] if naga does not accept the text.
pub fn evaluation_module(program: &Program, function: FunctionId) -> Result<Shader, WgslError> {
    evaluation(&program.module, &SceneRows::of(program), function)
}

fn evaluation(module: &Module, rows: &SceneRows<'_>, function: FunctionId) -> Result<Shader, WgslError> {
    let entry = evaluation_entry(function, module.function(function));
    let functions = definitions(rows, &[Definition::of(module, function.index())], "");
    let text = format!("{}{EVALUATION_BINDINGS}{functions}\n{entry}", declarations(rows));
    validate(&text)?;
    let inputs = rows.all().iter().map(layout::Row::space).chain([Space::Storage]).collect();
    Ok(Shader { text, inputs })
}

/// Asks naga about a text.
///
/// # Errors
///
/// [`WgslError`] with naga's message.
pub fn validate(wgsl: &str) -> Result<(), WgslError> {
    read(wgsl).map(drop)
}

/// A text as naga understands it, for its writers.
pub(crate) fn read(wgsl: &str) -> Result<(naga::Module, naga::valid::ModuleInfo), WgslError> {
    let module = naga::front::wgsl::parse_str(wgsl)
        .map_err(|error| WgslError::Parse { message: error.emit_to_string(wgsl) })?;
    let (flags, capabilities) = (naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty());
    let info = naga::valid::Validator::new(flags, capabilities)
        .validate(&module)
        .map_err(|error| WgslError::Validate { message: error.emit_to_string(wgsl) })?;
    Ok((module, info))
}

/// The parts of the prelude that `text` needs, in order.
fn prelude(text: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    // A file calls only files before it, so going backwards all callers are known.
    for part in PRELUDE.into_iter().rev() {
        let calls = |name: &str| text.contains(name) || parts.iter().any(|later| later.contains(name));
        let mut names = part.lines().filter_map(|line| line.strip_prefix("fn ")?.split_once('('));
        if names.any(|(name, _)| calls(&format!("{name}("))) {
            parts.insert(0, part);
        }
    }
    parts.join("\n")
}

/// Bindings of a scene's numbers.
fn declarations(rows: &SceneRows<'_>) -> String {
    rows.all().iter().map(layout::Row::declaration).collect()
}

/// Prelude with what `user` calls, output structures and text of functions.
fn definitions(rows: &SceneRows<'_>, all: &[Definition<'_>], user: &str) -> String {
    let mut body = String::new();
    let arities: BTreeSet<usize> = all.iter().map(|own| own.function.outputs.len()).collect();
    for arity in arities {
        body.push_str(&names::output_structure(arity));
    }
    for own in all {
        body.push_str(&expr::function(own, rows));
    }
    let prelude = prelude(&format!("{body}{user}"));
    // Arrays cannot be empty.
    let curves = format!("const VOL_CURVES: u32 = {}u;\n\n", rows.curve_count.max(1));
    let curves = if prelude.contains("VOL_CURVES") { &curves } else { "" };
    let curve = if body.contains("vol_curve(") { rows.curve_function() } else { String::new() };
    format!("{curves}{prelude}{curve}\n{body}")
}

fn evaluation_entry(id: FunctionId, function: &Function) -> String {
    let (inputs, outputs) = (function.inputs, function.outputs.len());
    let arguments: Vec<String> = (0..inputs).map(|i| format!("vol_input[source + {i}u]")).collect();
    let mut text = format!(
        "@compute @workgroup_size({EVALUATION_GROUP})\n\
         fn evaluate(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {{\n  \
           let index: u32 = id.x + (id.y * (groups.x * {EVALUATION_GROUP}u));\n  \
           if (index >= bitcast<u32>(vol_input[0])) {{ return; }}\n  \
           let source: u32 = 1u + (index * {inputs}u);\n  \
           let sink: u32 = index * {outputs}u;\n  \
           let result = {}({});\n",
        names::function(id.index(), &function.name),
        arguments.join(", "),
    );
    for i in 0..outputs {
        let _ = writeln!(text, "  vol_output[sink + {i}u] = result{};", names::output_field(outputs, i));
    }
    text.push_str("}\n");
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::text;
    use crate::ir::verify::random;

    fn module(functions: Vec<Function>) -> Module {
        let frame = "frame(1) {\n%0 = input 0\nreturn %0 %0 %0 %0\n}";
        Module { functions, ..text::parse_module(frame).expect("well-formed text") }
    }

    /// Of two curves.
    fn rows(module: &Module) -> SceneRows<'static> {
        SceneRows::new(module, 2, 8)
    }

    #[test]
    fn generated_functions_are_accepted() {
        for seed in 0..150 {
            let outputs = seed as u32 % 7;
            let shape = random::Shape { outputs, operations: 40, ..random::Shape::default() };
            let module = module(vec![random::function(seed, &shape)]);
            if let Err(error) = evaluation(&module, &rows(&module), FunctionId(0)) {
                panic!("{error}\n{}", text::print_function(&module.functions[0]));
            }
        }
    }

    #[test]
    fn one_module_holds_many_functions() {
        let shapes = (0..20).map(|i| random::Shape { outputs: i % 11, ..random::Shape::default() });
        let functions = shapes.enumerate().map(|(i, shape)| random::function(i as u64, &shape)).collect();
        let module = module(functions);
        let all: Vec<_> = (0..module.functions.len()).map(|index| Definition::of(&module, index)).collect();
        assert_eq!(
            validate(&format!("{}{}", declarations(&rows(&module)), definitions(&rows(&module), &all, ""))),
            Ok(())
        );
    }

    #[test]
    fn long_functions_are_accepted() {
        let shape = random::Shape { operations: 3000, ..random::Shape::default() };
        let module = module(vec![random::function(9, &shape)]);
        assert!(evaluation(&module, &rows(&module), FunctionId(0)).is_ok());
    }

    #[test]
    fn only_what_is_called_is_included() {
        let with = |line: &str| {
            let body = format!("fn f(1) {{\n%0 = input 0\n{line}\nreturn %0\n}}");
            let module = module(vec![text::parse_function(&body).expect("well-formed text")]);
            evaluation(&module, &rows(&module), FunctionId(0)).expect("naga accepts it").text
        };
        // In order: functions, noise, its four rooms, curves.
        let found = |text: &str| PRELUDE.map(|part| u8::from(text.contains(part)));
        assert_eq!(found(&with("")), [0; 8]);
        assert_eq!(found(&with("%1 = sin %0")), [1, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(found(&with("%1 = perlin[0] %0 %0 %0")), [1, 1, 0, 0, 0, 0, 0, 0]);
        assert_eq!(found(&with("%1 = perlin4[0] %0 %0 %0 %0")), [1, 1, 1, 0, 0, 0, 0, 0]);
        assert_eq!(found(&with("%1 = value[0] %0 %0 %0")), [1, 1, 0, 1, 0, 0, 0, 0]);
        assert_eq!(found(&with("%1 = simplex[0] %0 %0 %0")), [1, 1, 0, 0, 1, 0, 0, 0]);
        assert_eq!(found(&with("%1 = worley[0] %0 %0 %0")), [1, 1, 0, 0, 0, 1, 0, 0]);
        assert_eq!(found(&with("%1 = hash[0] %0 %0 %0 %0")), [1, 1, 0, 0, 0, 0, 0, 0]);
        assert_eq!(found(&with("%1 = closest[0] %0 %0 %0")), [1, 0, 0, 0, 0, 0, 1, 0]);
        assert_eq!(found(&with("%1 = foot[0] %0 %0 %0 %0 %0 %0")), [1, 0, 0, 0, 0, 0, 1, 1]);
    }

    #[test]
    fn the_text_of_a_function() {
        let body = "fn bad\u{7}name(2) {\n%0 = input 1\n%1 = constant -0.5\n%2 = uniform 3\n%3 = less %0 %1\n\
            %4 = select %3 %2 %0\nreturn %4 %0\n}";
        let function = text::parse_function(body).expect("well-formed text");
        let module = module(vec![function]);
        let own = Definition { index: 7, ..Definition::of(&module, 0) };
        let text = expr::function(&own, &rows(&module));
        let mut lines = text.lines();
        assert_eq!(lines.next(), Some("// bad name"));
        assert_eq!(lines.next(), Some("fn vol_f7_bad_name(x0: f32, x1: f32) -> vec2f {"));
        assert_eq!(lines.next(), Some("  let v1: f32 = (-0.5f);"));
        assert_eq!(lines.next(), Some("  let v2: f32 = vol_uniforms[0].w;"));
        assert!(lines.next().is_some_and(|line| line.starts_with("  let v3: bool = ")));
        assert!(lines.next().is_some_and(|line| line.starts_with("  let v4: f32 = ")));
        assert_eq!(lines.next(), Some("  return vec2f(v4, x1);"));
    }

    #[test]
    fn the_text_of_a_loop_does_not_grow_with_its_steps() {
        let with = |steps: &str| {
            // The state changes places, which needs both next values before either is replaced.
            let body = format!(
                "fn f(2) {{\n%0 = input 0\n%1 = input 1\n%2 = loop {steps} %0 %1 {{\n%0 = input 0\n%1 = input 1\n\
                 %2 = less %0 %1\nreturn %1 %0 %2\n}}\n%3 = extract %2 1\nreturn %3\n}}"
            );
            let module = module(vec![text::parse_function(&body).expect("well-formed text")]);
            evaluation(&module, &rows(&module), FunctionId(0)).expect("naga accepts it").text
        };
        let (few, many) = (with("8"), with("800"));
        assert_eq!(few.replace("< 8u", "< 800u"), many);
        let order = ["v2_n1: f32 = select(v2_s1, v2_s0, v2_2)", "v2_s0 = v2_n0;", "let v3: f32 = v2_s1;"];
        let places = order.map(|part| few.find(part));
        assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{few}");
    }

    #[test]
    fn the_text_of_tubes_does_not_grow_with_their_number() {
        // Radii from the frame, from a list, and curves in any order; the points are the same or of each tube.
        let with = |curves: &[u32], own_points: bool| {
            let mut body =
                "fn f(3) {\n%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = constant 9\n".to_owned();
            for (i, curve) in curves.iter().enumerate() {
                let v = 4 + 6 * i;
                let [shift, x, search, distance, field, least] = [0, 1, 2, 3, 4, 5].map(|offset| v + offset);
                let point = if own_points { x } else { 0 };
                let before = if i == 0 { 3 } else { v - 1 };
                body += &format!(
                    "%{shift} = uniform {}\n%{x} = add %0 %{shift}\n%{search} = closest[{curve}] %{point} %1 %2\n\
                     %{distance} = extract %{search} 5\n%{field} = sub %{distance} %{shift}\n\
                     %{least} = min %{before} %{field}\n",
                    i % 4
                );
            }
            let body = format!("{body}return %{}\n}}", 3 + 6 * curves.len());
            let module = module(vec![text::parse_function(&body).expect("well-formed text")]);
            evaluation(&module, &SceneRows::new(&module, 9, 9), FunctionId(0)).expect("naga accepts it").text
        };
        for curves in [&[0, 1, 2, 3][..], &[3, 2, 1], &[5, 1, 7, 3, 0, 2], &[0, 1]] {
            for own_points in [false, true] {
                let text = with(curves, own_points);
                // What follows from the first is less than from the others: it may stand by itself.
                assert!(text.matches("= vol_closest(").count() <= 2, "{text}");
            }
        }
        assert_eq!(with(&[4, 4, 4], true).matches("= vol_closest(").count(), 1, "one curve in three places");
        assert!(!with(&[6], false).contains("vol_curve("), "one tube is written as it is");
    }

    #[test]
    fn errors_carry_the_message_of_naga() {
        assert!(
            matches!(validate("fn f( {"), Err(WgslError::Parse { message }) if message.contains("expected"))
        );
        let invalid = "@compute @workgroup_size(0) fn f() {}";
        assert!(matches!(validate(invalid), Err(WgslError::Validate { .. } | WgslError::Parse { .. })));
    }
}
