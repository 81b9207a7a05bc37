//! Names in scope and what may be used where.

use crate::piece::Coordinates;
use vol_language::ty::Type;

/// How often a value may change; the compiler's rates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Stage {
    /// Never: known at compile time.
    Constant,
    /// With params and the time.
    Frame,
    /// With the position.
    Point,
}

/// Where an expression stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// How often it may change.
    pub(crate) stage: Stage,
    /// How often bindings from before `floor`, the params and the time may change.
    pub(crate) outer: Stage,
    pub(crate) floor: usize,
    /// How many levels of expressions may follow.
    pub(crate) depth: u32,
    /// Whether it is part of a surface: no tubes.
    pub(crate) solid: bool,
    /// Whether it must have a slope.
    pub(crate) smooth: bool,
}

impl Place {
    pub(crate) fn new(stage: Stage, depth: u32) -> Self {
        Self { stage, outer: stage, floor: 0, depth, solid: true, smooth: true }
    }

    pub(crate) fn deeper(self) -> Self {
        Self { depth: self.depth.saturating_sub(1), ..self }
    }

    /// The same with values that change at most so often.
    pub(crate) fn at(self, stage: Stage) -> Self {
        Self { stage: self.stage.min(stage), outer: self.outer.min(stage), ..self }
    }

    /// The body of a function value whose parameters begin at `floor` and change with `stage`; what it
    /// takes from outside changes no more often than the function itself.
    pub(crate) fn body(self, stage: Stage, floor: usize) -> Self {
        if stage <= self.stage {
            return self.at(stage);
        }
        Self { stage, outer: self.outer.min(self.stage), floor, ..self }
    }

    /// Whether params and the time may be used.
    pub(crate) fn sees_time(self) -> bool {
        self.outer >= Stage::Frame
    }
}

/// A binding.
#[derive(Clone, Debug)]
pub(crate) struct Variable {
    pub(crate) name: String,
    pub(crate) ty: Type,
    pub(crate) stage: Stage,
    /// Of a param, or a parameter of a function: nothing is known of its value.
    pub(crate) opaque: bool,
    /// Expressions that a use costs.
    pub(crate) work: u64,
    /// Whether it is, or may contain, a tube.
    pub(crate) tube: bool,
    pub(crate) bound: i64,
    pub(crate) coordinates: Coordinates,
}

impl Variable {
    pub(crate) fn new(name: &str, ty: Type, stage: Stage) -> Self {
        Self {
            name: name.to_owned(),
            ty,
            stage,
            opaque: false,
            work: 1,
            tube: false,
            bound: 16,
            coordinates: Coordinates::default(),
        }
    }
}

/// The bindings in scope, innermost last.
#[derive(Default)]
pub(crate) struct Scope {
    variables: Vec<Variable>,
}

impl Scope {
    pub(crate) fn mark(&self) -> usize {
        self.variables.len()
    }

    pub(crate) fn leave(&mut self, mark: usize) {
        self.variables.truncate(mark);
    }

    pub(crate) fn bind(&mut self, variable: Variable) {
        self.variables.push(variable);
    }

    /// Whether the name is bound.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.variables.iter().any(|variable| variable.name == name)
    }

    /// The variables that can be named at a place and that fit.
    pub(crate) fn visible(&self, place: Place, fits: impl Fn(&Variable) -> bool) -> Vec<Variable> {
        let newest = |i: usize, name: &str| !self.variables[i + 1..].iter().any(|later| later.name == name);
        let reaches = |i: usize, variable: &Variable| {
            let most = if i >= place.floor { place.stage } else { place.outer };
            variable.stage <= most && !(place.solid && variable.tube)
        };
        let numbered = self.variables.iter().enumerate();
        let found = numbered.filter(|(i, v)| reaches(*i, v) && fits(v) && newest(*i, &v.name));
        found.map(|(_, variable)| variable.clone()).collect()
    }
}

/// A parameter of a user's function.
#[derive(Clone, Debug)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) ty: Type,
    /// How often arguments may change.
    pub(crate) stage: Stage,
    pub(crate) optional: bool,
}

/// A user's function.
#[derive(Clone, Debug)]
pub(crate) struct Function {
    pub(crate) name: String,
    pub(crate) params: Vec<Parameter>,
    pub(crate) result: Type,
    /// How often it changes by itself.
    pub(crate) stage: Stage,
    /// Expressions that a call costs.
    pub(crate) work: u64,
}
