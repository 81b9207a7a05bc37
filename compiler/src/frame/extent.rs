//! Bounds and steepness of solids in one frame, in f64.

use super::Aabb;
use crate::curve::{CurveTable, Quadratic};
use crate::ir::{FunctionId, Module};
use crate::ops::interval::Interval;
use crate::program::{Extent, Slot, Slot3};
use crate::reference;
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
#[derive(Clone, Copy, Debug)]
pub(super) struct Solid {
    pub(super) bounds: Box3,
    /// Largest length of the gradient of the distance; 1 for distances proper.
    pub(super) steepness: f64,
}

/// What extents are computed from.
pub(super) struct Space<'a> {
    pub(super) module: &'a Module,
    pub(super) uniforms: &'a [f64],
    pub(super) curves: &'a [Vec<Quadratic>],
    pub(super) tables: &'a [CurveTable],
}

/// Parts per axis into which a box is cut when a function is bounded over it.
const PARTS: usize = 4;

/// Parts of a curve for the bound on its radius.
const CURVE_PARTS: usize = 32;

impl Space<'_> {
    /// Bounds and steepness of a solid.
    ///
    /// # Errors
    /// A displacement without a bound.
    pub(super) fn solid(&self, extent: &Extent) -> Result<Solid, Diagnostic> {
        let exact = |bounds| Solid { bounds, steepness: 1.0 };
        Ok(match extent {
            Extent::Unbounded => exact(ALL),
            Extent::Box { lo, hi } => exact(ordered(self.at3(*lo), self.at3(*hi))),
            Extent::Tube { curve, radius } => exact(self.tube(*curve as usize, *radius)),
            Extent::Union(parts) => self.combined(parts, EMPTY, enclose)?,
            Extent::Intersection(parts) => self.combined(parts, ALL, common)?,
            Extent::Complement(child) => Solid { bounds: ALL, ..self.solid(child)? },
            Extent::Placed { child, columns, offset } => {
                let child = self.solid(child)?;
                let columns = columns.map(|column| self.at3(column));
                Solid { bounds: placed(child.bounds, columns, self.at3(*offset)), ..child }
            }
            Extent::Grown(child, by) => {
                let child = self.solid(child)?;
                Solid { bounds: grown(child.bounds, self.at(*by)), ..child }
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

    fn combined(
        &self,
        parts: &[Extent],
        start: Box3,
        join: fn(Box3, Box3) -> Box3,
    ) -> Result<Solid, Diagnostic> {
        let mut solid = Solid { bounds: start, steepness: 1.0 };
        for part in parts {
            let part = self.solid(part)?;
            solid.bounds = join(solid.bounds, part.bounds);
            solid.steepness = solid.steepness.max(part.steepness);
        }
        Ok(solid)
    }

    /// Box of the control points, which contains the curve, grown by the largest radius.
    fn tube(&self, curve: usize, radius: FunctionId) -> Box3 {
        let points = self.curves[curve].iter().flat_map(|s| [s.a, s.b, s.c]);
        let hull = points.fold(EMPTY, |b, p| enclose(b, Box3 { lo: p, hi: p }));
        let length = self.tables[curve].length;
        let mut largest: f64 = 0.0;
        for part in 0..CURVE_PARTS {
            let (from, to) = (part as f64 / CURVE_PARTS as f64, (part + 1) as f64 / CURVE_PARTS as f64);
            // The arc length at t is not known here: all of it is possible.
            let inputs = [Interval::new(from, to), Interval::new(0.0, length)];
            largest = largest.max(self.interval(radius, &inputs)[0].hi);
        }
        grown(hull, largest)
    }

    fn interval(&self, function: FunctionId, inputs: &[Interval]) -> Vec<Interval> {
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
            reach = self.interval(amount, &cells(near, 1)[0])[0].magnitude();
            if !(reach <= half_diagonal(child.bounds)) {
                return Err(unbounded(span));
            }
        }
        let bounds = grown(child.bounds, reach);
        let mut steepest: f64 = 0.0;
        for cell in cells(bounds, PARTS) {
            let gradient = self.interval(slope, &cell);
            let squared: f64 = gradient.iter().map(|g| g.magnitude() * g.magnitude()).sum();
            steepest = steepest.max(squared.sqrt());
        }
        if !steepest.is_finite() {
            return Err(unbounded(span));
        }
        Ok(Solid { bounds, steepness: child.steepness + steepest })
    }
}

fn unbounded(span: Span) -> Diagnostic {
    let message = "no bound can be given for this displacement, so its surface cannot be marched safely";
    Diagnostic::error("E0501", message, span, "its value or its slope is not bounded near the shape")
        .with_help("use functions with a bounded slope, such as sin or perlin, or keep the values in range with clamp")
}

fn half_diagonal(b: Box3) -> f64 {
    0.5 * (0..3).map(|i| (b.hi[i] - b.lo[i]).powi(2)).sum::<f64>().sqrt()
}

/// The cells of a box cut into `parts` along each axis; axes without end are not cut.
fn cells(b: Box3, parts: usize) -> Vec<[Interval; 3]> {
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
    Box3 { lo: b.lo.map(|c| c - by), hi: b.hi.map(|c| c + by) }
}

/// The box around the image of a box: per output axis, the sum of the columns' extremes.
fn placed(b: Box3, columns: [[f64; 3]; 3], offset: [f64; 3]) -> Box3 {
    if (0..3).any(|i| b.lo[i] > b.hi[i]) {
        return EMPTY;
    }
    let mut image = Box3 { lo: offset, hi: offset };
    for (axis, column) in columns.iter().enumerate() {
        for i in 0..3 {
            // An axis that does not reach this coordinate adds nothing, however long it is.
            let ends =
                if column[i] == 0.0 { [0.0; 2] } else { [column[i] * b.lo[axis], column[i] * b.hi[axis]] };
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
