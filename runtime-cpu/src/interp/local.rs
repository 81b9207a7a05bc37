//! Functions shortened for parts of space: an octree over the box of a solid or medium, each of whose cells knows the
//! steps that can matter to a point in it.
//!
//! ```text
//! union of 500 boxes less balls, 19 000 steps
//!   └─ cell, 1/8 of the side: 2 200 steps ──► 1/16: 520 ──► 1/32: 180
//! ```
//!
//! A step that chooses among its operands is left out where the bounds of the operands in the cell ([`bounds`]) say which
//! one it takes, and with it all that only the others need ([`outline`]). The rest are the same operations
//! on the same numbers, so a point's results are the same bits in every cell that holds it.
//!
//! Cells are made when points have been asked for in the one around them often enough to pay for it, by
//! whichever thread comes first, and kept for the frame. Once they take [`MOST_BYTES`] no more are; where that is
//! due to their tapes these are made anew for each batch, which takes eight times as long as to run them.

mod bounds;
mod outline;

use super::LANES;
use crate::isa::Isa;
use bounds::{Choice, Eight, choices};
use outline::{Outline, Outlines, Room, spine};
use std::borrow::Cow;
use std::mem::size_of;
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use vol_compiler::frame::{Aabb, Frame};
use vol_compiler::ir::{FunctionId, Module};
use vol_compiler::ops::Op;
use vol_compiler::tape::{Link, Tape, TapeOp};
use vol_compiler::wgsl::render::padded;

/// Most bytes of the cells of all functions of a frame.
const MOST_BYTES: usize = 576 << 20;

/// As many for each instruction of those functions, if that is less.
const BYTES_PER_INSTRUCTION: usize = 32 << 10;

/// Bytes of a step of a tape.
const STEP: usize = size_of::<TapeOp>() + size_of::<Link>();

/// Most bytes that all this takes, with `threads` that divide cells.
pub(crate) fn most_bytes(module: &Module, frame: &Frame, threads: usize) -> usize {
    let candidates = candidates(module, frame);
    let lengths = || candidates.iter().map(|&(_, id)| length(module, id));
    let (all, longest) = (lengths().sum::<usize>(), lengths().max().unwrap_or(0));
    // Results are at most eight an instruction, and nearly always one.
    let step = STEP + 16 + 2 * size_of::<Choice>();
    let register = size_of::<Eight>() + 16;
    // A tape that is made for one batch, and its registers.
    let batch = STEP + LANES * size_of::<f32>();
    for_cells(all) + all * (step + 2 * threads * register) + longest * threads * batch
}

/// Most bytes of the cells of functions with so many instructions together.
fn for_cells(instructions: usize) -> usize {
    MOST_BYTES.min(BYTES_PER_INSTRUCTION * instructions)
}

fn length(module: &Module, id: FunctionId) -> usize {
    module.functions[id.index()].insts.len()
}

/// The functions that may be worth it, each with the box in which it matters.
fn candidates(module: &Module, frame: &Frame) -> Vec<(Place, FunctionId)> {
    let scene = padded(&frame.bounds);
    let objects = frame.objects.iter().map(|o| (o.bounds, [o.distance, o.gradient, o.surface]));
    let media = frame.media.iter().map(|m| (m.bounds, [m.region, m.interior, m.extinction]));
    let all = objects.chain(media).flat_map(move |(bounds, functions)| {
        let place = padded(&bounds).zip(scene).and_then(|(bounds, scene)| common(bounds, scene));
        let long = functions.into_iter().filter(|&id| length(module, id) >= FEW_STEPS);
        place.into_iter().flat_map(move |place| long.clone().map(move |id| (place, id)))
    });
    let mut all: Vec<_> = all.collect();
    if all.len() > MANY_FUNCTIONS {
        all.retain(|&(_, id)| length(module, id) >= MANY_STEPS);
    }
    all
}

/// Fewer steps than this are not worth a look at the cell.
const FEW_STEPS: usize = 128;
/// With more functions than this each is asked too seldom to pay for the first look at it, but for those of
/// [`MANY_STEPS`]: of 5000 solids that took more than a third of a picture.
const MANY_FUNCTIONS: usize = 256;
/// More steps than this are not run before a try to have fewer: the cell is divided at once.
const MANY_STEPS: usize = 1024;
/// A function with fewer choices is never shortened.
const FEW_CHOICES: usize = 4;
/// Batches of points in a cell that pay for its division: that takes about 50 ns a step, and a batch of a few points
/// about 2.5 ns a step.
const VISITS: u32 = 24;
/// All points of a batch.
const WHOLE_BATCH: usize = 256;
/// Most divisions, one in another: the sides of the smallest cells are 1/1024 of those of the largest.
const DEEPEST: u32 = 10;
/// After so many divisions, one in another, that left nothing out there is no further one.
const BARREN: u32 = 3;

/// The cells of the functions of one frame.
#[derive(Debug)]
pub(crate) struct LocalTapes {
    /// By function; only of those that are worth it.
    roots: Vec<Option<Root>>,
    uniforms: Vec<f32>,
    isa: Isa,
    /// Bytes that cells and their outlines may still take, and those that tapes may.
    left_for_outlines: AtomicUsize,
    left_for_tapes: AtomicUsize,
    /// Whether cells are divided at once and shortened by any step, be it worth it or not: for tests.
    is_eager: bool,
}

/// The octree of a function.
#[derive(Debug)]
struct Root {
    place: Place,
    /// The function, each of whose values has a register of its own.
    tape: Tape,
    /// Which of its steps choose among large parts.
    spine: Vec<bool>,
    cell: Cell,
    /// Room for those who divide cells.
    rooms: Mutex<Vec<Workroom>>,
}

/// What it takes to divide a cell.
#[derive(Debug)]
struct Workroom {
    bounds: Vec<Eight>,
    room: Room,
}

/// A part of space and what it takes to evaluate a function in it.
#[derive(Debug)]
struct Cell {
    outline: Arc<Outline>,
    /// Divisions around it, and how many of the last of them left nothing out.
    depth: u32,
    barren: u32,
    /// Batches that were here before it was divided, how many of their points were, and the sum of the parts of
    /// them that were, in units of 1 / [`WHOLE_BATCH`]. Which bits come out does not depend on them.
    visits: AtomicU32,
    points: AtomicU32,
    shares: AtomicU32,
    /// Its eighths, if it is worth it, once that has been looked at.
    parts: OnceLock<Option<Box<[Cell; 8]>>>,
}

/// A box: smallest and largest corner, both in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    lo: [f32; 3],
    hi: [f32; 3],
}

impl Place {
    /// Whether a point is in it.
    pub(crate) fn contains(&self, point: [f32; 3]) -> bool {
        (0..3).all(|axis| self.lo[axis] <= point[axis] && point[axis] <= self.hi[axis])
    }

    fn middle(&self) -> [f32; 3] {
        [0, 1, 2].map(|axis| self.lo[axis] + 0.5 * (self.hi[axis] - self.lo[axis]))
    }

    /// The eighth of it with an index: bit by bit whether it is the upper half of an axis.
    fn part(&self, index: usize) -> Self {
        let (middle, is_upper) = (self.middle(), |axis: usize| index >> axis & 1 == 1);
        Self {
            lo: [0, 1, 2].map(|axis| if is_upper(axis) { middle[axis] } else { self.lo[axis] }),
            hi: [0, 1, 2].map(|axis| if is_upper(axis) { self.hi[axis] } else { middle[axis] }),
        }
    }

    /// The index of an eighth that holds a point of the whole.
    fn index(&self, point: [f32; 3]) -> usize {
        let middle = self.middle();
        (0..3).map(|axis| usize::from(point[axis] > middle[axis]) << axis).sum()
    }
}

impl LocalTapes {
    /// Looks for functions of a frame that are worth it.
    pub(crate) fn new(module: &Module, frame: &Frame, isa: Isa) -> Self {
        let candidates = candidates(module, frame);
        let instructions = candidates.iter().map(|&(_, id)| length(module, id)).sum();
        let mut local = Self::without_functions(module, &frame.uniforms_f32, isa, for_cells(instructions));
        candidates.into_iter().for_each(|(place, id)| local.add(module, id, place));
        local
    }

    fn without_functions(module: &Module, uniforms: &[f32], isa: Isa, bytes: usize) -> Self {
        Self {
            roots: module.functions.iter().map(|_| None).collect(),
            uniforms: uniforms.to_vec(),
            isa,
            left_for_outlines: AtomicUsize::new(bytes / 3 * 2),
            left_for_tapes: AtomicUsize::new(bytes / 3),
            is_eager: false,
        }
    }

    /// Makes a function's octree, one cell at first, if it has choices.
    fn add(&mut self, module: &Module, id: FunctionId, place: Place) {
        if self.roots[id.index()].is_some() {
            return;
        }
        let tape = Tape::with_own_registers(&module.functions[id.index()]);
        let choices = tape.ops.iter().filter(|step| is_choice(step)).count();
        if choices >= FEW_CHOICES {
            let cell = Cell::new(Arc::new(Outline::whole(&tape)), 0, 0);
            self.roots[id.index()] =
                Some(Root { place, spine: spine(&tape), tape, cell, rooms: Mutex::default() });
        }
    }

    /// Whether a function has cells.
    pub(crate) fn has(&self, function: FunctionId) -> bool {
        self.roots.get(function.index()).is_some_and(Option::is_some)
    }

    /// What a function takes near a point; nothing where it takes all of it and always will.
    pub(crate) fn find(&self, function: FunctionId, point: [f32; 3]) -> Option<Found<'_>> {
        let root = self.roots[function.index()].as_ref().filter(|root| root.place.contains(point))?;
        let mut found = Found { local: self, root, cell: &root.cell, place: root.place };
        let mut place = root.place;
        while let Some(parts) = self.parts(root, found.cell, &place) {
            let index = place.index(point);
            place = place.part(index);
            let is_new = !Arc::ptr_eq(&found.cell.outline, &parts[index].outline);
            found.cell = &parts[index];
            found.place = if is_new { place } else { found.place };
        }
        Some(found)
    }

    /// The eighths of a cell, if it is or can now be divided.
    fn parts<'a>(&self, root: &Root, cell: &'a Cell, place: &Place) -> Option<&'a [Cell; 8]> {
        if let Some(parts) = cell.parts.get() {
            return parts.as_deref();
        }
        let is_wanted =
            self.is_eager || cell.outline.steps > MANY_STEPS || cell.visits.load(Ordering::Relaxed) >= VISITS;
        is_wanted.then(|| cell.parts.get_or_init(|| self.divide(root, cell, place)).as_deref()).flatten()
    }

    fn divide(&self, root: &Root, cell: &Cell, place: &Place) -> Option<Box<[Cell; 8]>> {
        let before = cell.outline.steps;
        if before < FEW_STEPS && !self.is_eager || cell.depth >= DEEPEST {
            return None;
        }
        let places: [Place; 8] = std::array::from_fn(|index| place.part(index));
        root.with_room(|Workroom { bounds, room }| {
            let decided = choices(self.isa, &root.tape, &cell.outline, (&places, &self.uniforms), bounds);
            let outlines = Outlines::new(&root.tape, &root.spine, &cell.outline, &decided, room);
            let worth_it = (0.75 / cell.groups() * before as f32) as usize;
            let most = if self.is_eager { before.saturating_sub(1) } else { worth_it };
            let is_worth_it = |index: usize| outlines.lengths[index] <= most;
            let is_divided = cell.barren < BARREN || (0..8).any(is_worth_it);
            let part = |index: usize| {
                let short = is_worth_it(index).then(|| outlines.outline(index, room));
                match short.filter(|short| pay(&self.left_for_outlines, short.bytes())) {
                    Some(short) => Cell::new(Arc::new(short), cell.depth + 1, 0),
                    None => Cell::new(Arc::clone(&cell.outline), cell.depth + 1, cell.barren + 1),
                }
            };
            let is_divided = is_divided && pay(&self.left_for_outlines, 8 * size_of::<Cell>());
            let parts = is_divided.then(|| Box::new(std::array::from_fn(part)));
            outlines.clear(room);
            parts
        })
    }
}

impl Root {
    /// Does something that takes room; others may do the same at the same time.
    fn with_room<T>(&self, work: impl FnOnce(&mut Workroom) -> T) -> T {
        let rooms = || self.rooms.lock().unwrap_or_else(PoisonError::into_inner);
        let taken = rooms().pop();
        let mut room = taken.unwrap_or_else(|| Workroom {
            bounds: vec![Eight::UNKNOWN; self.tape.registers as usize],
            room: Room::new(&self.tape),
        });
        let result = work(&mut room);
        rooms().push(room);
        result
    }
}

impl Cell {
    fn new(outline: Arc<Outline>, depth: u32, barren: u32) -> Self {
        let [visits, points, shares] = [const { AtomicU32::new(0) }; 3];
        let parts = OnceLock::new();
        Self { outline, depth, barren, visits, points, shares, parts }
    }

    /// Into how many groups a division parts the points of a batch that are here, at a guess: hardly any if all of
    /// the batch is here, else up to four.
    fn groups(&self) -> f32 {
        let load = |sum: &AtomicU32| sum.load(Ordering::Relaxed) as f32;
        let visits = load(&self.visits);
        if visits == 0.0 {
            return 1.0;
        }
        let (share, points) =
            (load(&self.shares) / (WHOLE_BATCH as f32 * visits), load(&self.points) / visits);
        1.0 + (1.0 - share) * (points.min(4.0) - 1.0)
    }
}

/// A cell, and where its tape may be used.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found<'a> {
    local: &'a LocalTapes,
    root: &'a Root,
    cell: &'a Cell,
    pub(crate) place: Place,
}

impl<'a> Found<'a> {
    /// The tape; nothing where it is that of the whole function.
    pub(crate) fn tape(&self) -> Option<Cow<'a, Tape>> {
        let Self { local, root, cell, .. } = *self;
        if Arc::ptr_eq(&cell.outline, &root.cell.outline) {
            return None;
        }
        let make = || root.with_room(|room| cell.outline.tape(&root.tape, &mut room.room));
        let bytes = cell.outline.steps * STEP;
        let keep = || pay(&local.left_for_tapes, bytes).then(|| make().linked());
        let kept = cell.outline.tape.get_or_init(keep).as_ref();
        Some(kept.map_or_else(|| Cow::Owned(make()), Cow::Borrowed))
    }

    /// Tells that so many points of a batch were evaluated with this tape.
    pub(crate) fn note(&self, points: usize, batch: usize) {
        // Of no interest any more once it is decided whether to divide the cell.
        if self.cell.parts.get().is_none() {
            self.cell.visits.fetch_add(1, Ordering::Relaxed);
            self.cell.points.fetch_add(points as u32, Ordering::Relaxed);
            self.cell.shares.fetch_add((points * WHOLE_BATCH / batch) as u32, Ordering::Relaxed);
        }
    }
}

/// Whether so much memory is left, which is then taken.
fn pay(left: &AtomicUsize, bytes: usize) -> bool {
    left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(bytes)).is_ok()
}

fn is_choice(step: &TapeOp) -> bool {
    match step {
        TapeOp::Apply { op, .. } | TapeOp::ApplyScalar { op, .. } => {
            matches!(op, Op::Min | Op::Max | Op::Select)
        }
        TapeOp::Constant { .. } | TapeOp::Input { .. } | TapeOp::Uniform { .. } | TapeOp::Loop { .. } => {
            false
        }
    }
}

/// The part of a box that matters: a solid without end does where the others are. A little larger, since rays start
/// to look a little outside of boxes. Nothing if it is empty.
fn common(bounds: Aabb, scene: Aabb) -> Option<Place> {
    let lo = [0, 1, 2].map(|axis| bounds.lo[axis].max(scene.lo[axis]));
    let hi = [0, 1, 2].map(|axis| bounds.hi[axis].min(scene.hi[axis]));
    let beyond = 1e-3 * (0..3).map(|axis| hi[axis] - lo[axis]).fold(0.0, f32::max);
    let place = Place { lo: lo.map(|x| x - beyond), hi: hi.map(|x| x + beyond) };
    (0..3).all(|axis| lo[axis] < hi[axis]).then_some(place)
}

#[cfg(test)]
mod tests;
