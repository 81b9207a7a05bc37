//! Bounds and steepness of solids in one frame, in f64.

mod warp;

use super::tube::Measured;
use super::{Aabb, Stride};
use crate::curve::{CurveTable, Quadratic};
use crate::ir::{FunctionId, Module};
use crate::ops::interval::Interval;
use crate::program::{Caps, Extent, LEAST_RADIUS, Measure, Slot, Slot3};
use crate::reference;
use glam::DVec3;
use vol_language::diag::Diagnostic;
use vol_language::source::Span;

/// A box aligned with the axes; infinite where unbounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Box3 {
    pub(super) lo: [f64; 3],
    pub(super) hi: [f64; 3],
}

/// The box of nothing.
pub(super) const EMPTY: Box3 = Box3 { lo: [f64::INFINITY; 3], hi: [f64::NEG_INFINITY; 3] };

/// All of space.
const ALL: Box3 = Box3 { lo: [f64::NEG_INFINITY; 3], hi: [f64::INFINITY; 3] };

/// Where a solid is and how fast its distance can change.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    pub(super) bounds: Box3,
    /// Boxes that cover the inside together, seldom all of `bounds`: one per part of a tube; else
    /// one, `bounds`.
    pub(super) cells: Vec<Box3>,
    /// Largest length of the gradient of the distance; 1 for distances proper.
    pub(super) steepness: f64,
    /// Whether the distance is only a bound, so that growing by some of it may move the wall farther,
    /// though never out of the box grown by as much.
    loose: bool,
}

impl Solid {
    /// Moved.
    fn placed(self, columns: [[f64; 3]; 3], offset: [f64; 3]) -> Self {
        let cells = self.cells.into_iter().map(|b| placed(b, columns, offset)).collect();
        Self { bounds: placed(self.bounds, columns, offset), cells, ..self }
    }

    /// Pulled apart along the axes.
    fn widened(self, by: [f64; 3]) -> Self {
        let cells = self.cells.into_iter().map(|b| widened(b, by)).collect();
        Self { bounds: widened(self.bounds, by), cells, ..self }
    }

    /// Grown, or shrunk.
    fn grown(self, by: f64) -> Self {
        // A cell is the box of a slice. What is nearer than `by` to its rim may be off the slice and
        // off the rim, by that much each; and shrinking a slice does not make it thinner.
        let wider = std::f64::consts::SQRT_2 * by.max(0.0);
        let bounds = grown(self.bounds, by);
        let cells = self.cells.into_iter().map(|b| grown(b, wider)).collect();
        let cells = if self.loose && by > 0.0 { vec![bounds] } else { cells };
        Self { bounds, cells, ..self }
    }
}

/// What extents are computed from.
pub(super) struct Space<'a> {
    pub(super) module: &'a Module,
    pub(super) uniforms: &'a [f64],
    pub(super) curves: &'a [Vec<Quadratic>],
    pub(super) tables: &'a [CurveTable],
    /// What is known of tubes; nothing while it is being found out.
    pub(super) tubes: &'a [Measured],
}

/// Stands for what has no end where a number must be finite in f32.
const FAR: f64 = 1e18;

/// Parts per axis into which a box is cut when a function is bounded over it.
const PARTS: usize = 4;

/// A bound on the slope this many times that of the average part of a box is not used for all of it: asking
/// at each step costs about as much as the step.
const UNEVEN: f64 = 2.0;

/// Nor one that is larger than this: it stands for a jump somewhere.
const STEEPEST: f64 = 1e6;

/// Parts of a curve for the bound on its radius.
const CURVE_PARTS: usize = 32;

/// Most cells of a segment of a tube's axis: thinner slices save little more, and every point is
/// compared with every cell.
const SEGMENT_CELLS: usize = 16;

/// Most cells of a solid.
pub const MOST_CELLS: usize = 64;

/// Slower parts of an axis than this fraction of the fastest count as kinks.
const SLOW: f64 = 1e-3;

/// By how much of the radius an offset may be off the plane across the axis: rounding, generously.
const OFF_PLANE: f64 = 1e-3;

/// An end that goes less than this along a coordinate goes straight across it: over the farthest that
/// rays go it moves by 4e-6.
const SIDEWAYS: f64 = 1e-12;

/// Rounding of a curve parameter, generously.
const T_SLACK: f64 = 1e-6;

impl Space<'_> {
    /// Bounds and steepness of a solid.
    ///
    /// # Errors
    /// A displacement without a bound.
    pub(super) fn solid(&self, extent: &Extent) -> Result<Solid, Diagnostic> {
        let exact = |bounds| Solid { bounds, cells: vec![bounds], steepness: 1.0, loose: false };
        Ok(match extent {
            Extent::Unbounded => exact(ALL),
            Extent::Box { lo, hi } => exact(ordered(self.at3(*lo), self.at3(*hi))),
            Extent::Tube { curve, radius, caps, sizes } => {
                let measured = sizes.map(|index| self.tubes[index as usize]);
                let safe = measured.is_none_or(|measured| measured.safe) && *caps != Caps::Open;
                let solid = match caps {
                    Caps::Open => {
                        let cells = self.open_cells(*curve as usize, *radius);
                        Solid { bounds: cells.iter().copied().fold(EMPTY, enclose), cells, ..exact(ALL) }
                    }
                    Caps::Flat | Caps::Round | Caps::Joined => {
                        let cells = self.tube_cells(*curve as usize, *radius, *caps);
                        Solid { cells, ..exact(self.tube(*curve as usize, *radius)) }
                    }
                };
                let loose = measured.is_some_and(|measured| measured.loose);
                Solid { steepness: if safe { 1.0 } else { f64::INFINITY }, loose, ..solid }
            }
            Extent::Union(parts) => self.union(parts)?,
            Extent::Intersection(parts) => self.intersection(parts)?,
            Extent::Complement(child) => Solid { steepness: self.solid(child)?.steepness, ..exact(ALL) },
            Extent::Placed { child, columns, offset } => {
                let columns = columns.map(|column| self.at3(column));
                let offset = self.at3(*offset);
                self.solid(child)?.placed(columns, offset)
            }
            Extent::Grown(child, by) => {
                let by = self.at(*by);
                self.solid(child)?.grown(by)
            }
            Extent::Elongated { child, by } => self.solid(child)?.widened(self.at3(*by)),
            Extent::Twisted { child, rate, span } => {
                warp::twisted(self.solid(child)?, self.at(*rate), *span)?
            }
            Extent::Bent { child, rate, span } => warp::bent(self.solid(child)?, self.at(*rate), *span)?,
            Extent::Repeated { child, axes, overlap, span } => {
                let rows = axes.map(|run| run.map(|run| (self.at(run.period), run.count)));
                warp::repeated(self.solid(child)?, rows, *overlap, *span)?
            }
            Extent::Around { child, count, overlap, span } => {
                warp::around(self.solid(child)?, *count, *overlap, *span)?
            }
            Extent::Field { half, slope, span } => {
                let half = self.at3(*half);
                let bounds = ordered(half.map(|c| -c), half);
                let steepness = self.steepest(bounds, *slope).ok_or_else(|| unbounded("field", *span))?;
                Solid { steepness: steepness.max(1.0), ..exact(bounds) }
            }
            Extent::Displaced { child, amount, slope, span } => {
                let child = self.solid(child)?;
                self.displaced(child, *amount, *slope, *span)?
            }
        })
    }

    fn at(&self, slot: Slot) -> f64 {
        self.uniforms[slot.0 as usize]
    }

    fn at3(&self, slots: Slot3) -> [f64; 3] {
        slots.map(|slot| self.at(slot))
    }

    fn union(&self, parts: &[Extent]) -> Result<Solid, Diagnostic> {
        let mut solid = Solid { bounds: EMPTY, cells: Vec::new(), steepness: 1.0, loose: false };
        for part in parts {
            let part = self.solid(part)?;
            solid.bounds = enclose(solid.bounds, part.bounds);
            solid.cells.extend(part.cells);
            solid.steepness = solid.steepness.max(part.steepness);
            solid.loose |= part.loose;
        }
        if solid.cells.len() > MOST_CELLS {
            solid.cells = vec![solid.bounds];
        }
        Ok(solid)
    }

    /// The inside is in the cells of every part: those of the part with most of them are kept, as
    /// they are. Clipped cells could be empty, and an empty box does not grow back.
    fn intersection(&self, parts: &[Extent]) -> Result<Solid, Diagnostic> {
        let mut solid = Solid { bounds: ALL, cells: Vec::new(), steepness: 1.0, loose: false };
        for part in parts {
            let part = self.solid(part)?;
            solid.bounds = common(solid.bounds, part.bounds);
            if part.cells.len() > solid.cells.len() {
                solid.cells = part.cells;
            }
            solid.steepness = solid.steepness.max(part.steepness);
            solid.loose |= part.loose;
        }
        if solid.cells.len() <= 1 {
            solid.cells = vec![solid.bounds];
        }
        Ok(solid)
    }

    /// Box of the control points, which contains the curve, grown by the largest radius.
    fn tube(&self, curve: usize, radius: FunctionId) -> Box3 {
        let points = self.curves[curve].iter().flat_map(|s| [s.a, s.b, s.c]);
        let hull = points.fold(EMPTY, |b, p| enclose(b, Box3 { lo: p, hi: p }));
        let largest = self.largest_radius(curve, radius);
        grown(hull, largest)
    }

    /// Largest radius of a tube, at least 0.
    pub(super) fn largest_radius(&self, curve: usize, radius: FunctionId) -> f64 {
        let length = self.tables[curve].length;
        let mut largest: f64 = 0.0;
        for part in 0..CURVE_PARTS {
            let (from, to) = (part as f64 / CURVE_PARTS as f64, (part + 1) as f64 / CURVE_PARTS as f64);
            // The arc length at t is not known here: all of it is possible.
            let inputs = [Interval::new(from, to), Interval::new(0.0, length)];
            largest = largest.max(self.interval(radius, &inputs)[0].hi);
        }
        largest
    }

    /// Boxes around consecutive parts of a tube: each that of the control points of the part of a
    /// segment, grown by what the largest radius there reaches across the axis. The
    /// offset from a foot inside is across the axis, but at a kink or an end that is not flat it may
    /// have any direction.
    fn tube_cells(&self, curve: usize, radius: FunctionId, caps: Caps) -> Vec<Box3> {
        let segments = &self.curves[curve];
        let parts = (MOST_CELLS / segments.len().max(1)).clamp(1, SEGMENT_CELLS);
        let count = (segments.len() * parts) as f64;
        let arc_length = Interval::new(0.0, self.tables[curve].length);
        let fastest = segments.iter().flat_map(|s| [velocity(s, 0.0), velocity(s, 1.0)].map(DVec3::length));
        let slow = SLOW * fastest.fold(0.0, f64::max);
        let smooth = |place: usize| match place {
            0 => caps == Caps::Flat,
            _ if place == segments.len() => caps == Caps::Flat,
            _ => joins(segments, place, slow),
        };
        let mut boxes = Vec::with_capacity(segments.len() * parts);
        for (index, segment) in segments.iter().enumerate() {
            for part in 0..parts {
                let place = boxes.len() as f64;
                let t = [place / count - T_SLACK, (place + 1.0) / count + T_SLACK];
                let t = Interval::new(t[0].max(0.0), t[1].min(1.0));
                let largest = self.interval(radius, &[t, arc_length])[0].hi.max(LEAST_RADIUS);
                let ends = [part, part + 1].map(|end| end as f64 / parts as f64);
                let kink = part == 0 && !smooth(index) || part + 1 == parts && !smooth(index + 1);
                let reach = if kink { [1.0; 3] } else { across(segment, ends, slow) };
                boxes.push(widened(hull(segment, ends), reach.map(|part| part * largest)));
            }
        }
        let run = boxes.len().div_ceil(MOST_CELLS).max(1);
        boxes.chunks(run).map(|run| run.iter().copied().fold(EMPTY, enclose)).collect()
    }

    /// Boxes around a tube with open ends: those along its axis, and one around each cylinder that goes on
    /// for ever, endless only the way that it goes. All of space if the axis has a kink, where offsets across
    /// the axis say little.
    fn open_cells(&self, curve: usize, radius: FunctionId) -> Vec<Box3> {
        let segments = &self.curves[curve];
        let smooth = |place: usize| joins(segments, place, 0.0);
        let (Some(first), Some(last)) = (segments.first(), segments.last()) else { return vec![ALL] };
        let ends = [(first.a, -velocity(first, 0.0), 0.0), (last.c, velocity(last, 1.0), 1.0)];
        let stands = ends.iter().any(|(_, direction, _)| direction.length() == 0.0 || !direction.is_finite());
        if stands || !(1..segments.len()).all(smooth) {
            return vec![ALL];
        }
        let mut cells = self.tube_cells(curve, radius, Caps::Flat);
        while cells.len() > MOST_CELLS - ends.len() {
            let (Some(a), Some(b)) = (cells.pop(), cells.pop()) else { break };
            cells.push(enclose(a, b));
        }
        let arc_length = Interval::new(0.0, self.tables[curve].length);
        for (at, direction, t) in ends {
            let t = Interval::new(f64::max(t - T_SLACK, 0.0), f64::min(t + T_SLACK, 1.0));
            let largest = self.interval(radius, &[t, arc_length])[0].hi.max(LEAST_RADIUS);
            let along = direction.normalize();
            let mut end = Box3 { lo: at, hi: at };
            for i in 0..3 {
                let reach = largest * ((1.0 - along[i] * along[i]).max(0.0).sqrt() + OFF_PLANE);
                let (back, forth) = (along[i] < -SIDEWAYS, along[i] > SIDEWAYS);
                end.lo[i] = if back { f64::NEG_INFINITY } else { at[i] - reach };
                end.hi[i] = if forth { f64::INFINITY } else { at[i] + reach };
            }
            cells.push(end);
        }
        cells
    }

    pub(super) fn interval(&self, function: FunctionId, inputs: &[Interval]) -> Vec<Interval> {
        reference::interval(self.module.function(function), inputs, self.uniforms, self.curves)
    }

    fn displaced(
        &self,
        child: Solid,
        amount: FunctionId,
        slope: FunctionId,
        span: Span,
    ) -> Result<Solid, Diagnostic> {
        let everywhere = [Interval::EVERYTHING; 3];
        let mut reach = self.interval(amount, &everywhere)[0].magnitude();
        if !reach.is_finite() {
            // Not bounded everywhere: bounded near the shape will do, if it stays near.
            let near = grown(child.bounds, half_diagonal(child.bounds));
            reach = self.interval(amount, &grid(near, 1)[0])[0].magnitude();
            let close = reach <= half_diagonal(child.bounds);
            if !close {
                return Err(unbounded("displacement", span));
            }
        }
        let solid = child.grown(reach);
        let steepest = self.steepest(solid.bounds, slope).ok_or_else(|| unbounded("displacement", span))?;
        Ok(Solid { steepness: solid.steepness + steepest, ..solid })
    }

    /// Largest length of a gradient over a box, if it is finite.
    fn steepest(&self, bounds: Box3, slope: FunctionId) -> Option<f64> {
        let mut steepest: f64 = 0.0;
        for cell in grid(bounds, PARTS) {
            let gradient = self.interval(slope, &cell);
            let squared: f64 = gradient.iter().map(|g| g.magnitude() * g.magnitude()).sum();
            steepest = steepest.max(squared.sqrt());
        }
        steepest.is_finite().then_some(steepest)
    }

    /// How a distance is made safe to walk: by one bound on its slope for all of its box if that is not
    /// much larger than those for parts of it.
    pub(super) fn stride(&self, steepness: FunctionId, bounds: Box3) -> Stride {
        let (mut sum, mut most) = (0.0, 1.0_f64);
        let cells = grid(bounds, PARTS);
        for cell in &cells {
            let corners = [cell.map(|x| x.lo), cell.map(|x| x.hi)].concat();
            let corners: Vec<f64> = corners.into_iter().map(|x| x.clamp(-FAR, FAR)).collect();
            let function = self.module.function(steepness);
            let bound = reference::evaluate(function, &corners, self.uniforms, self.curves)[0].max(1.0);
            (sum, most) = (sum + bound, most.max(bound));
        }
        if most > UNEVEN * (sum / cells.len() as f64) || most > STEEPEST {
            return Stride::Within(steepness);
        }
        // Rounded down, so that the product never exceeds the safe step.
        Stride::Scale((1.0 / most) as f32 * (1.0 - f32::EPSILON))
    }

    /// The numbers of a measure; infinite ones as large finite ones.
    ///
    /// # Errors
    /// A displacement without a bound.
    pub(super) fn measure(&self, measure: &Measure) -> Result<Vec<f64>, Diagnostic> {
        let numbers = match measure {
            Measure::Radius(extent) => vec![warp::radius(self.solid(extent)?.bounds)],
            Measure::Steepness(extent) => vec![self.solid(extent)?.steepness],
            Measure::Box(extent) => {
                let bounds = self.solid(extent)?.bounds;
                let endless = |i: usize| !(bounds.lo[i].is_finite() && bounds.hi[i].is_finite());
                let centre = |i| if endless(i) { 0.0 } else { 0.5 * (bounds.lo[i] + bounds.hi[i]) };
                // A little more, so that rounding to f32 leaves the solid inside.
                let slack = |i: usize| warp::SLACK * bounds.lo[i].abs().max(bounds.hi[i].abs());
                let wider = |i| {
                    if endless(i) { FAR } else { 0.5 * (bounds.hi[i] - bounds.lo[i]) + slack(i) }
                };
                vec![centre(0), centre(1), centre(2), wider(0), wider(1), wider(2)]
            }
        };
        Ok(numbers.into_iter().map(|x| x.clamp(-FAR, FAR)).collect())
    }
}

fn unbounded(what: &str, span: Span) -> Diagnostic {
    let message = format!("no bound can be given for this {what}, so its surface cannot be marched safely");
    Diagnostic::error("E0501", message, span, "its value or its slope is not bounded near the shape")
        .with_help("use functions with a bounded slope, such as sin or perlin, or keep the values in range with clamp")
}

/// Box of the control points of the part of a segment between two parameters.
fn hull(segment: &Quadratic, [from, to]: [f64; 2]) -> Box3 {
    // The polar form of the segment: its control points are those at (from, from), (from, to), (to, to).
    let blend = |u: f64, v: f64| {
        [0, 1, 2].map(|i| {
            let (a, b, c) = (segment.a[i], segment.b[i], segment.c[i]);
            (1.0 - u) * (1.0 - v) * a + (u * (1.0 - v) + v * (1.0 - u)) * b + u * v * c
        })
    };
    let points = [blend(from, from), blend(from, to), blend(to, to)];
    if !points.iter().flatten().all(|c| c.is_finite()) {
        return ALL;
    }
    points.into_iter().fold(EMPTY, |b, p| enclose(b, Box3 { lo: p, hi: p }))
}

/// Half the derivative of a segment.
fn velocity(segment: &Quadratic, t: f64) -> DVec3 {
    let [a, b, c] = [segment.a, segment.b, segment.c].map(DVec3::from);
    (b - a).lerp(c - b, t)
}

/// Whether an axis goes on smoothly where segment `next` begins.
fn joins(segments: &[Quadratic], next: usize, slow: f64) -> bool {
    let (before, after) = (&segments[next - 1], &segments[next]);
    let (from, to) = (velocity(before, 1.0), velocity(after, 0.0));
    let straight = from.dot(to) >= (1.0 - 1e-8) * from.length() * to.length();
    before.c == after.a && from.length() > slow && to.length() > slow && straight
}

/// How far a unit vector across a part of a segment reaches along each coordinate, at most.
fn across(segment: &Quadratic, ends: [f64; 2], slow: f64) -> [f64; 3] {
    let [from, to] = ends.map(|t| velocity(segment, t));
    // The nearest to 0 on the line between the two velocities.
    let change = to - from;
    let nearest = (-from.dot(change) / change.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    let keeps_moving = (from + change * nearest).length() > slow;
    if !keeps_moving {
        return [1.0; 3];
    }
    let fastest = from.length().max(to.length());
    [0, 1, 2].map(|i| {
        let turns = from[i] * to[i] <= 0.0;
        let along = if turns { 0.0 } else { from[i].abs().min(to[i].abs()) / fastest };
        ((1.0 - along * along).max(0.0).sqrt() + OFF_PLANE).min(1.0)
    })
}

fn half_diagonal(b: Box3) -> f64 {
    0.5 * (0..3).map(|i| (b.hi[i] - b.lo[i]).powi(2)).sum::<f64>().sqrt()
}

/// A box cut into `parts` along each axis; axes without end are not cut.
fn grid(b: Box3, parts: usize) -> Vec<[Interval; 3]> {
    let cut = |axis: usize| -> Vec<Interval> {
        let (lo, hi) = (b.lo[axis], b.hi[axis]);
        if !(lo.is_finite() && hi.is_finite()) {
            return vec![Interval::new(lo, hi)];
        }
        let edge = |i: usize| lo + (hi - lo) * (i as f64 / parts as f64);
        (0..parts).map(|i| Interval::new(edge(i), edge(i + 1).max(edge(i)))).collect()
    };
    let (x, y, z) = (cut(0), cut(1), cut(2));
    let mut all = Vec::with_capacity(x.len() * y.len() * z.len());
    for &i in &x {
        for &j in &y {
            all.extend(z.iter().map(|&k| [i, j, k]));
        }
    }
    all
}

fn ordered(a: [f64; 3], b: [f64; 3]) -> Box3 {
    Box3 { lo: [0, 1, 2].map(|i| a[i].min(b[i])), hi: [0, 1, 2].map(|i| a[i].max(b[i])) }
}

fn enclose(a: Box3, b: Box3) -> Box3 {
    Box3 { lo: [0, 1, 2].map(|i| a.lo[i].min(b.lo[i])), hi: [0, 1, 2].map(|i| a.hi[i].max(b.hi[i])) }
}

/// [`enclose`] if the second box is finite, else the first alone.
pub(super) fn enclose_finite(a: Box3, b: Box3) -> Box3 {
    let finite = b.lo.iter().chain(&b.hi).all(|c| c.is_finite());
    if finite { enclose(a, b) } else { a }
}

fn common(a: Box3, b: Box3) -> Box3 {
    Box3 { lo: [0, 1, 2].map(|i| a.lo[i].max(b.lo[i])), hi: [0, 1, 2].map(|i| a.hi[i].min(b.hi[i])) }
}

fn grown(b: Box3, by: f64) -> Box3 {
    widened(b, [by; 3])
}

fn widened(b: Box3, by: [f64; 3]) -> Box3 {
    Box3 { lo: [0, 1, 2].map(|i| b.lo[i] - by[i]), hi: [0, 1, 2].map(|i| b.hi[i] + by[i]) }
}

/// The box around the image of a box: per output axis, the sum of the columns' extremes.
fn placed(b: Box3, columns: [[f64; 3]; 3], offset: [f64; 3]) -> Box3 {
    if (0..3).any(|i| b.lo[i] > b.hi[i]) {
        return EMPTY;
    }
    let mut image = Box3 { lo: offset, hi: offset };
    for (axis, column) in columns.iter().enumerate() {
        for (i, &reach) in column.iter().enumerate() {
            // An axis that does not reach this coordinate adds nothing, however long it is.
            let ends = if reach == 0.0 { [0.0; 2] } else { [reach * b.lo[axis], reach * b.hi[axis]] };
            image.lo[i] += ends[0].min(ends[1]);
            image.hi[i] += ends[0].max(ends[1]);
        }
    }
    image
}

/// The box in f32, rounded outwards by a few units in the last place.
pub(super) fn rounded(b: Box3) -> Aabb {
    let slack = |c: f64| if c.is_finite() { c.abs() * 1e-6 + 1e-9 } else { 0.0 };
    Aabb { lo: b.lo.map(|c| (c - slack(c)) as f32), hi: b.hi.map(|c| (c + slack(c)) as f32) }
}

#[cfg(test)]
mod tests;
