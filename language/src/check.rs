//! Checking: an untyped file in, a typed scene and all its mistakes out.
//!
//! ```text
//! modules ──names──► uses ──order──► items in dependency order ──► hir::Scene, diagnostics
//! ```
//!
//! Comes in: the trees that the parser built, and the compiler's [`Library`]. Goes out: a
//! [`hir::Scene`] in which every name is resolved, every expression typed and every conversion
//! written out. A wrong expression becomes [`hir::ExprKind::Error`] of [`Type::Error`], which
//! silences follow-ups, so that all mistakes of a file come in one run.
//!
//! Nothing here recurses deeper than `MAX_DEPTH` expressions: chains of operators, methods and
//! fields are walked by loops, and so are the passes that look at whole trees.

mod arguments;
mod block;
mod block_rules;
mod call;
mod choice;
mod codes;
mod constant;
mod construct;
mod convert;
mod expr;
mod field;
mod function;
mod item;
mod iterate;
mod keys;
mod mismatch;
mod names;
mod operator;
mod order;
mod overload;
mod param;
mod resolve;
mod scope;
#[cfg(test)]
mod tests;
mod words;

pub use codes::CODES;

use crate::ast::ItemKind;
use crate::blocks::BlockKind;
use crate::diag::Diagnostic;
use crate::hir::{self, Expr, ExprId, ExprKind, FunctionId};
use crate::library::{BuiltinId, Library};
use crate::module::{Module, ModuleId};
use crate::source::Span;
use crate::standard;
use crate::ty::Type;
use constant::Constant;
use item::Global;
use scope::Scope;
use std::collections::HashMap;

/// Largest magnitude of a whole number: every backend holds these exactly in an f32.
pub const MAX_INT: i64 = 1 << 24;

/// Deepest nesting of expressions; deeper ones are an error, so that the stack never overflows.
const MAX_DEPTH: u32 = 400;

/// How many names a run compares to find those nearest to misspelt ones. It is enough for thousands
/// of mistakes in a usual file, and keeps huge files quick.
const MAX_COMPARISONS: usize = 1_000_000;

/// Names that stand for values and cannot be redefined anywhere.
const BUILT_IN_VALUES: [&str; 4] = ["time", "frame", "pi", "tau"];

/// Checks the files of a scene; the first is its own.
///
/// Only blocks of the scene's own file count. The scene can be used if no diagnostic is an error.
#[must_use]
pub fn check(modules: &[Module], library: &Library) -> (hir::Scene, Vec<Diagnostic>) {
    let own = library.signatures.len();
    let library = standard::extended(library);
    let mut checker = Checker::new(modules, &library, own);
    for index in 0..modules.len() {
        checker.declare(index);
    }
    let uses = names::uses(modules, &checker.globals, checker.items.len());
    checker.diagnostics.extend(uses.warnings);
    checker.warn_unused(&uses.used);
    checker.check_library(&uses.mentioned);
    let (order, cycles) = order::sort(&uses.edges);
    for cycle in &cycles {
        checker.report_cycle(cycle);
    }
    for index in order {
        checker.check_item(index);
    }
    let root = modules.iter().take(1).flat_map(|module| &module.file.items);
    let blocks = root.filter_map(|item| match &item.kind {
        ItemKind::Block(block) => Some(block),
        ItemKind::Import(_) | ItemKind::Param(_) | ItemKind::Let(_) | ItemKind::Function(_) => None,
    });
    checker.module = ModuleId::ROOT;
    checker.check_blocks(blocks);
    checker.scene.local_count = checker.scope.count();
    (checker.scene, checker.diagnostics)
}

/// What is known while a scene is checked.
struct Checker<'a> {
    modules: &'a [Module],
    /// The compiler's functions, then those of the standard library.
    library: &'a Library,
    /// How many of them are the compiler's.
    own: usize,
    /// The functions of the standard library that the scene uses, by their place in it.
    standard: Vec<Option<FunctionId>>,
    /// The file whose names are visible.
    module: ModuleId,
    /// Overloads by name.
    builtins: HashMap<&'a str, Vec<BuiltinId>>,
    /// The params, lets and functions of all files in order, duplicates included.
    items: Vec<Global<'a>>,
    /// For each file the first item of each name, by index.
    globals: Vec<HashMap<&'a str, usize>>,
    /// The blocks of the scene's own file that have a name.
    block_names: HashMap<&'a str, BlockKind>,
    scope: Scope<'a>,
    scene: hir::Scene,
    /// Value of each expression of the scene that is known at compile time.
    constants: Vec<Option<Constant>>,
    diagnostics: Vec<Diagnostic>,
    depth: u32,
    reported_depth: bool,
    comparisons_left: usize,
}

impl<'a> Checker<'a> {
    fn new(modules: &'a [Module], library: &'a Library, own: usize) -> Self {
        let mut builtins: HashMap<&'a str, Vec<BuiltinId>> = HashMap::new();
        for (i, signature) in library.signatures.iter().enumerate() {
            builtins.entry(signature.name).or_default().push(BuiltinId(i as u32));
        }
        Self {
            modules,
            library,
            own,
            standard: vec![None; library.signatures.len() - own],
            module: ModuleId::ROOT,
            builtins,
            items: Vec::new(),
            globals: Vec::new(),
            block_names: HashMap::new(),
            scope: Scope::default(),
            scene: hir::Scene::default(),
            constants: Vec::new(),
            diagnostics: Vec::new(),
            depth: 0,
            reported_depth: false,
            comparisons_left: MAX_COMPARISONS,
        }
    }

    /// Appends an expression to the scene.
    fn push(&mut self, kind: ExprKind, ty: Type, span: Span) -> ExprId {
        let constant = self.fold(&kind);
        let id = ExprId(self.scene.exprs.len() as u32);
        self.scene.exprs.push(Expr { kind, ty, span });
        self.constants.push(constant);
        id
    }

    /// Stands for an expression that was reported.
    fn wrong(&mut self, span: Span) -> ExprId {
        self.push(ExprKind::Error, Type::Error, span)
    }

    fn report(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    fn ty(&self, id: ExprId) -> &Type {
        &self.scene.exprs[id.index()].ty
    }

    fn span(&self, id: ExprId) -> Span {
        self.scene.exprs[id.index()].span
    }

    fn is_wrong(&self, id: ExprId) -> bool {
        *self.ty(id) == Type::Error
    }

    /// The value of an expression if it is known at compile time.
    fn constant(&self, id: ExprId) -> Option<Constant> {
        self.constants[id.index()]
    }

    /// Goes one level down; `false` (reported once per file) if that is too deep.
    fn descend(&mut self, span: Span) -> bool {
        if self.depth < MAX_DEPTH {
            self.depth += 1;
            return true;
        }
        if !self.reported_depth {
            self.reported_depth = true;
            let help = "name parts of it with `let`";
            let error =
                Diagnostic::error("E0226", "the expression is nested too deeply", span, "too deep here");
            self.report(error.with_help(help));
        }
        false
    }

    /// The candidate nearest to a misspelt name.
    fn suggest<'c>(&mut self, name: &str, candidates: impl FnOnce(&Self) -> Vec<&'c str>) -> Option<String> {
        if self.comparisons_left == 0 {
            return None;
        }
        let candidates = candidates(self);
        self.comparisons_left = self.comparisons_left.saturating_sub(candidates.len());
        crate::nearest::nearest(name, candidates).map(str::to_owned)
    }
}
