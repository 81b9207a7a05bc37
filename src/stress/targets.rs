//! The functions that a picture is made of, and where each is asked.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use vol_compiler::frame::{Aabb, Frame, Stride};
use vol_compiler::ir::{Function, FunctionId, Inst};
use vol_compiler::program::Program;
use vol_language::source::Span;

use super::points::Place;

/// What a function says.
#[derive(Clone, Copy, Debug)]
pub(super) enum Role {
    /// Distance of an object, and what makes it safe to walk.
    Distance { stride: Stride, steady: bool },
    /// Gradient of a distance.
    Gradient { distance: FunctionId },
    /// Bound on the slope over a box.
    Steepness,
    /// Answer of a surface.
    Surface { distance: FunctionId },
    /// Distance of a medium's region.
    Region,
    /// What a medium is inside its region.
    Interior { region: FunctionId },
    /// Phase function.
    Phase,
    /// Function with a name.
    Field,
}

/// One function.
#[derive(Clone, Debug)]
pub(super) struct Target {
    pub(super) name: String,
    /// For people: "the distance of `ball`".
    pub(super) title: String,
    pub(super) function: FunctionId,
    pub(super) role: Role,
    /// Its block.
    pub(super) span: Span,
    /// Where it is asked.
    pub(super) place: Place,
}

/// Instructions computed per function and moment at most, loops counted by all their steps.
const BUDGET: u64 = 4_000_000;

/// Fewest places, however long a function is.
const FEWEST: u32 = 64;

impl Target {
    /// `points`, or fewer for a function that takes long.
    pub(super) fn affordable(&self, program: &Program, points: u32) -> u32 {
        let cost = |id: FunctionId| cost(program.module.function(id));
        // Places on a surface are found by steps along the gradient.
        let search = match self.role {
            Role::Gradient { distance } | Role::Surface { distance } => 4 * cost(distance),
            Role::Distance { .. }
            | Role::Steepness
            | Role::Region
            | Role::Interior { .. }
            | Role::Phase
            | Role::Field => 0,
        };
        let cost = cost(self.function).saturating_add(search);
        let most = u32::try_from(BUDGET / cost.max(1)).unwrap_or(u32::MAX);
        points.min(most.max(FEWEST)).max(1)
    }
}

fn cost(function: &Function) -> u64 {
    let inst = |inst: &Inst| match inst {
        Inst::Loop { most, body, .. } => u64::from(*most).saturating_mul(cost(body)),
        // A curve is a loop over its pieces, a sum of octaves one over noise.
        Inst::Apply { op, .. } if vol_compiler::ops::operation(*op).has_data => 20,
        Inst::Constant(_) | Inst::Boolean(_) | Inst::Input(_) | Inst::Uniform(_) | Inst::Extract(..) => 0,
        Inst::Apply { .. } => 1,
    };
    function.insts.iter().map(inst).fold(1, u64::saturating_add)
}

/// The functions that are there at a moment.
pub(super) fn targets(program: &Program, frame: &Frame) -> Vec<Target> {
    let mut all = Vec::new();
    for object in &frame.objects {
        let block = &program.objects[object.index];
        let place = place(frame, object.bounds);
        let mut add = |what: &str, title: &str, function, role| {
            let name = format!("{what}:{}", block.name);
            let title = format!("{title} of the object `{}`", block.name);
            all.push(Target { name, title, function, role, span: block.span, place: place.clone() });
        };
        let distance = object.distance;
        let role = Role::Distance { stride: object.stride, steady: block.steady };
        add("distance", "the distance", distance, role);
        add("gradient", "the slope of the distance", object.gradient, Role::Gradient { distance });
        if let Stride::Within(steepness) = object.stride {
            add("steepness", "the bound on the slope", steepness, Role::Steepness);
        }
        add("surface", "the surface", object.surface, Role::Surface { distance });
    }
    for medium in &frame.media {
        let block = &program.media[medium.index];
        let place = place(frame, medium.bounds);
        let mut add = |what: &str, title: &str, function, role| {
            let name = format!("{what}:{}", block.name);
            let title = format!("{title} of the medium `{}`", block.name);
            all.push(Target { name, title, function, role, span: block.span, place: place.clone() });
        };
        let region = medium.region;
        add("region", "the distance to the wall", region, Role::Region);
        add("interior", "the inside", medium.interior, Role::Interior { region });
        add("extinction", "the extinction", medium.extinction, Role::Interior { region });
        add("phase", "the phase function", medium.phase, Role::Phase);
    }
    // Those of the blocks are looked at above, as pictures use them.
    for field in program.fields.iter().filter(|field| !field.name.contains(':')) {
        let function = program.module.function(field.function);
        let (name, title) = (field.name.clone(), format!("the function `{}`", field.name));
        let span = program.origins.get(field.function.index()).and_then(|origins| {
            let places = origins.places(function);
            let own = function.outputs.iter().rev().find_map(|output| places[output.index()]);
            own.or_else(|| places.into_iter().flatten().next())
        });
        let span = span.unwrap_or_default();
        let place = place(frame, frame.bounds);
        all.push(Target { name, title, function: field.function, role: Role::Field, span, place });
    }
    all
}

fn place(frame: &Frame, bounds: Aabb) -> Place {
    Place::new(bounds, frame)
}

/// A number for a name, the same in every run.
pub(super) fn hash(name: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    name.hash(&mut hasher);
    hasher.finish()
}
