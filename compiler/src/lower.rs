//! Lowering: the typed scene becomes a [`Program`].
//!
//! Lists, functions, shapes, curves and blocks are evaluated away here ([`value::Value`]); what
//! depends on a position, the time or a param stays behind as nodes of one [`Graph`], from which
//! the functions are cut out at the end.
//!
//! | room | holds |
//! |---|---|
//! | `value` | what an expression can be at compile time |
//! | `expr`, `keys` | expressions to values |
//! | `curve` | curves to chains of quadratic pieces |
//! | `shape`, `tube` | solids: distance, local coordinates, extent |
//! | `optics`, `cloud` | materials and phase functions |
//! | `scene` | blocks to the plan of the program |
//! | `ranges` | what the scene says its numbers may be |

pub(crate) mod cloud;
pub(crate) mod curve;
pub(crate) mod expr;
mod iterate;
mod keys;
pub(crate) mod optics;
mod ranges;
mod scene;
pub(crate) mod shape;
pub(crate) mod tube;
pub(crate) mod value;

use crate::families::KeptFamilies;
use crate::ir::graph::{Graph, Rate, Slots};
use crate::ir::origin::Origins;
use crate::ir::{Function, FunctionId, Module, ValueId, verify};
use crate::program::{Curve, Measure, Program, Slot, Slot3, TubeSizes};
use crate::skip::{Skip, Skips};
use crate::tape::KeptTapes;
use std::collections::{HashMap, HashSet};
use value::{Environment, Value};
use vol_language::diag::Diagnostic;
use vol_language::hir;
use vol_language::source::Span;

/// Most expressions that a scene may unroll to, calls and list elements counted each time.
pub const MAX_UNROLLED: u32 = 2_000_000;

/// Deepest nesting of expressions and calls while unrolling.
pub const MAX_DEPTH: u32 = 400;

/// Codes of this stage with what each is about.
pub const CODES: &[(&str, &str)] = &[
    ("E0401", "the scene unrolls to too many expressions"),
    ("E0402", "expressions and calls nest too deep"),
    ("E0403", "a value that shapes the scene depends on the position"),
    ("E0404", "a choice between shapes, curves or lists depends on a run-time value"),
    ("E0405", "a value must be known at compile time"),
    ("E0406", "a local coordinate that this region does not have"),
    ("E0407", "a number outside of what a function takes"),
    ("E0408", "a surface without a slope"),
    ("E0501", "the steepness of a shape is not bounded"),
    ("E0502", "a repeated shape reaches further than the copies that are asked"),
    ("E0503", "a tube whose surface cannot be marched safely"),
    ("W0201", "a path with a gap or a corner"),
    ("E0505", "a style of a light that is not distant"),
    ("E0506", "two styles of one light are on"),
    ("E0507", "a stroke outside of the picture"),
    ("W0401", "a style without a medium that it could change"),
];

/// What lowering an expression gives, or the message about why it cannot be.
pub(crate) type Lowered<T> = Result<T, Box<Diagnostic>>;

/// Compiles a checked scene. The program is there whenever no diagnostic is an error.
///
/// ```
/// use vol_language::source::SourceFile;
/// let file = SourceFile::new("ball.vol", "object ball { shape: sphere(1) }");
/// let library = vol_compiler::library::library();
/// let (scene, _) = vol_language::analyse(&file, &library);
/// let (program, diagnostics) = vol_compiler::lower::compile(&scene.expect("no errors"));
/// assert!(diagnostics.is_empty());
/// assert_eq!(program.expect("no errors").objects.len(), 1);
/// ```
#[must_use]
pub fn compile(scene: &hir::Scene) -> (Option<Program>, Vec<Diagnostic>) {
    compile_with(scene, Skips::ALL)
}

/// [`compile`] with some ways of leaving work out switched off, here and in what renders the program.
#[must_use]
pub fn compile_with(scene: &hir::Scene, skips: Skips) -> (Option<Program>, Vec<Diagnostic>) {
    let mut lowerer = Lowerer::new(scene);
    lowerer.skips = skips;
    let plan = scene::plan(&mut lowerer);
    let failed = lowerer.diagnostics.iter().any(Diagnostic::is_error);
    let program = (!failed).then(|| plan.map(|plan| lowerer.finish(plan))).flatten();
    (program, lowerer.diagnostics)
}

/// State of lowering one scene.
pub(crate) struct Lowerer<'a> {
    pub(crate) hir: &'a hir::Scene,
    pub(crate) graph: Graph,
    slots: Slots,
    functions: Vec<Function>,
    origins: Vec<Origins>,
    curves: Vec<Curve>,
    measures: Vec<(u32, Measure)>,
    tubes: Vec<TubeSizes>,
    /// Feet on curves, by index, that loops around the expression at hand go through.
    feet: Vec<(u32, tube::Foot)>,
    /// Feet that decide, by curve and point: each is a loop, which is not to be run twice.
    deciding_feet: HashMap<(u32, [ValueId; 3]), tube::Foot>,
    /// Values of the bindings in scope.
    environment: Environment,
    lets: Vec<Option<Lowered<Value>>>,
    /// Numbers that an author's `if` chooses by the position: they may jump.
    pub(crate) choices: HashSet<ValueId>,
    /// Arguments of the built-in function that is being called, for messages about one of them.
    arguments: &'a [hir::ExprId],
    /// First frame input of each param.
    param_inputs: Vec<u32>,
    frame_inputs: u32,
    unrolled: u32,
    /// Steps of the loops around the expression at hand, multiplied.
    loop_steps: u32,
    depth: u32,
    diagnostics: Vec<Diagnostic>,
    skips: Skips,
}

impl<'a> Lowerer<'a> {
    fn new(hir: &'a hir::Scene) -> Self {
        // Inputs of the frame function: time, frame number, then the params' components.
        let mut frame_inputs = 2;
        let mut param_inputs = Vec::with_capacity(hir.params.len());
        for param in &hir.params {
            param_inputs.push(frame_inputs);
            frame_inputs += param.default.len() as u32;
        }
        Self {
            hir,
            graph: Graph::default(),
            slots: Slots::default(),
            functions: Vec::new(),
            origins: Vec::new(),
            curves: Vec::new(),
            measures: Vec::new(),
            tubes: Vec::new(),
            feet: Vec::new(),
            deciding_feet: HashMap::new(),
            environment: Environment::new(hir.local_count),
            lets: vec![None; hir.lets.len()],
            choices: HashSet::new(),
            arguments: &[],
            param_inputs,
            frame_inputs,
            unrolled: 0,
            loop_steps: 1,
            depth: 0,
            diagnostics: Vec::new(),
            skips: Skips::ALL,
        }
    }

    /// Keeps a message; lowering goes on with the next entry.
    pub(crate) fn report(&mut self, diagnostic: Diagnostic) {
        // A `let` used twice must not be reported twice.
        if !self.diagnostics.contains(&diagnostic) {
            self.diagnostics.push(diagnostic);
        }
    }

    /// The place of an argument of the built-in function that is being called; for an argument that is
    /// left out that of the call.
    pub(crate) fn argument_span(&self, index: usize, call: Span) -> Span {
        self.arguments.get(index).map_or(call, |&id| self.hir.expr(id).span)
    }

    /// The position as the first three arguments of a function.
    pub(crate) fn position(&mut self) -> [ValueId; 3] {
        [0, 1, 2].map(|i| self.graph.input(i))
    }

    /// Adds a point function; its cost is only what `outputs` need.
    pub(crate) fn function(&mut self, name: &str, inputs: u32, outputs: &[ValueId]) -> FunctionId {
        let (function, origins) = self.slots.placed_function(&mut self.graph, name, inputs, outputs);
        self.functions.push(function);
        self.origins.push(origins);
        FunctionId(self.functions.len() as u32 - 1)
    }

    /// The slot of a number that must not depend on the position.
    pub(crate) fn slot(&mut self, value: ValueId, what: &str, span: Span) -> Lowered<Slot> {
        if self.graph.rate(value) == Rate::Point {
            return Err(depends_on_position(what, span));
        }
        Ok(Slot(self.slots.slot(value)))
    }

    /// Three slots.
    pub(crate) fn slots(&mut self, values: [ValueId; 3], what: &str, span: Span) -> Lowered<Slot3> {
        let [x, y, z] = values;
        Ok([self.slot(x, what, span)?, self.slot(y, what, span)?, self.slot(z, what, span)?])
    }

    /// A slot for a constant.
    pub(crate) fn constant_slot(&mut self, number: f64) -> Slot {
        let value = self.graph.number(number);
        Slot(self.slots.slot(value))
    }

    /// Three slots for constants.
    pub(crate) fn constant_slots(&mut self, numbers: [f64; 3]) -> Slot3 {
        numbers.map(|number| self.constant_slot(number))
    }

    /// Adds a curve; its index is the data of closest-point operations.
    pub(crate) fn curve(&mut self, curve: Curve) -> u32 {
        self.curves.push(curve);
        self.curves.len() as u32 - 1
    }

    /// The numbers of a measure, as inputs of the frame function after the params.
    pub(crate) fn measure(&mut self, measure: Measure) -> Vec<ValueId> {
        let (first, width) = (self.frame_inputs, measure.width());
        self.frame_inputs += width;
        self.measures.push((first, measure));
        (first..first + width).map(|input| self.graph.frame_input(input)).collect()
    }

    /// Adds what each frame has to find out about a tube; returns its index and its numbers.
    pub(crate) fn tube_sizes(&mut self, sizes: TubeSizes) -> (u32, [ValueId; TubeSizes::COUNT]) {
        let first_input = self.frame_inputs;
        self.frame_inputs += TubeSizes::COUNT as u32;
        self.tubes.push(TubeSizes { first_input, ..sizes });
        let inputs = std::array::from_fn(|i| self.graph.frame_input(first_input + i as u32));
        (self.tubes.len() as u32 - 1, inputs)
    }

    /// Cuts out the frame function and cleans up all functions.
    fn finish(&mut self, plan: scene::Plan) -> Program {
        let frame = self.slots.frame_function(&mut self.graph, self.frame_inputs);
        let mut module = Module { frame, functions: std::mem::take(&mut self.functions) };
        crate::passes::run(&mut module);
        let mut report = plan.report;
        if self.skips.has(Skip::Ranges) {
            report.extend(ranges::narrow(self.hir, &self.param_inputs, &mut module, &mut self.origins));
        }
        debug_assert_eq!(verify::module(&module, self.curves.len() as u32), Ok(()), "after lowering");
        let params = self.hir.params.iter().zip(&self.param_inputs);
        let params = params.map(|(param, &first_input)| crate::program::Param {
            name: param.name.clone(),
            ty: param.ty.clone(),
            default: param.default.clone(),
            range: param.range,
            label: param.doc.clone(),
            first_input,
        });
        Program {
            params: params.collect(),
            curves: std::mem::take(&mut self.curves),
            measures: std::mem::take(&mut self.measures),
            tubes: std::mem::take(&mut self.tubes),
            objects: plan.objects,
            media: plan.media,
            lights: plan.lights,
            styles: plan.styles,
            images: plan.images,
            camera: plan.camera,
            render: plan.render,
            fields: plan.fields,
            report,
            origins: std::mem::take(&mut self.origins),
            skips: self.skips,
            tapes: KeptTapes::default(),
            families: KeptFamilies::default(),
            module,
        }
    }
}

pub(crate) fn depends_on_position(what: &str, span: Span) -> Box<Diagnostic> {
    let message = format!("{what} cannot depend on the position");
    Box::new(
        Diagnostic::error("E0403", message, span, "this changes from point to point")
            .with_help("build it from numbers, params and `time` only"),
    )
}
