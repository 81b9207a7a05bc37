//! Twisted, bent and repeated solids.

use super::{Box3, EMPTY, Solid, grown};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use vol_language::diag::Diagnostic;
use vol_language::source::Span;

/// By what share a measured size is enlarged, so that rounding it to f32 leaves the solid inside.
pub(super) const SLACK: f64 = 1e-6;

/// Rounding of sizes that are compared with a cell.
const TIE: f64 = 1e-9;

/// Largest distance of a box from the y axis, a little enlarged; 0 of nothing.
pub(super) fn radius(b: Box3) -> f64 {
    let far = |i: usize| b.lo[i].abs().max(b.hi[i].abs());
    if is_empty(b) { 0.0 } else { far(0).hypot(far(2)) * (1.0 + SLACK) + SLACK }
}

/// Turned about the y axis by `rate` radians per length. At a distance r from the axis the largest
/// singular value of the map is `(|rate| r + sqrt(rate^2 r^2 + 4)) / 2` (`algorithms.md` §7.2), and it
/// grows with r; beyond the solid the distance is that of points within, or of the cylinder around it.
pub(super) fn twisted(child: Solid, rate: f64, span: Span) -> Result<Solid, Diagnostic> {
    let reach = radius(child.bounds);
    let turn = rate.abs() * reach;
    if !turn.is_finite() {
        let message = "a shape without end across the y axis cannot be twisted";
        let label = "its distance has no bound on its slope";
        let diagnostic = Diagnostic::error("E0501", message, span, label);
        return Err(diagnostic
            .with_help("cut the shape first, as in `intersect(shape, cylinder(2, 2)).twist(30deg)`"));
    }
    let steepness = child.steepness * 0.5 * (turn + turn.hypot(2.0));
    Ok(Solid { steepness, ..one(turned(child.bounds)) })
}

/// The x axis bent to a circle about (0, 1 / rate). The map back stretches along the circle by
/// 1 / (1 - rate y), which is at most `2 / (1 - |rate| h)` half way from the largest |y| of the child,
/// h, to the centre; further in the distance is held.
pub(super) fn bent(child: Solid, rate: f64, span: Span) -> Result<Solid, Diagnostic> {
    let b = child.bounds;
    if is_empty(b) {
        return Ok(child);
    }
    // Enlarged, so that what is left of the room outlasts rounding to f32.
    let reach = |i: usize| b.lo[i].abs().max(b.hi[i].abs()) * (1.0 + 10.0 * SLACK);
    let (turn, rise) = (rate.abs() * reach(0), rate.abs() * reach(1));
    let fits = turn < PI && rise < 1.0 && reach(0).is_finite() && reach(1).is_finite();
    if !fits {
        let message = "this shape is too large across or along the x axis to be bent so much";
        let label = "it would reach the centre of the bend or meet its own other end";
        let help = "bend less, as in `.bend(10deg)`, or make the shape smaller in y or shorter in x";
        return Err(Diagnostic::error("E0501", message, span, label).with_help(help));
    }
    let steepness = child.steepness * 2.0 / (1.0 - rise);
    if rate == 0.0 {
        return Ok(Solid { steepness, ..one(b) });
    }
    let mut bounds = EMPTY;
    (bounds.lo[2], bounds.hi[2]) = (b.lo[2], b.hi[2]);
    let (from, to) = (rate.abs() * b.lo[0], rate.abs() * b.hi[0]);
    // Both coordinates are linear in y; along the circle they turn at these angles.
    let turns = [-FRAC_PI_2, 0.0, FRAC_PI_2].into_iter().filter(|&angle| from < angle && angle < to);
    for angle in turns.chain([from, to]) {
        for y in [b.lo[1], b.hi[1]] {
            let half = (0.5 * angle).sin();
            let run = (1.0 - rate * y) * angle.sin() / rate.abs();
            let point = [run, y * angle.cos() + 2.0 * half * half / rate];
            for (i, x) in point.into_iter().enumerate() {
                bounds.lo[i] = bounds.lo[i].min(x);
                bounds.hi[i] = bounds.hi[i].max(x);
            }
        }
    }
    Ok(Solid { steepness, ..one(grown(bounds, SLACK * (reach(0) + reach(1)))) })
}

/// Copies along the axes: period and count of each, 0 without end.
pub(super) fn repeated(
    child: Solid,
    rows: [Option<(f64, u32)>; 3],
    overlap: u32,
    span: Span,
) -> Result<Solid, Diagnostic> {
    if is_empty(child.bounds) {
        return Ok(child);
    }
    let mut bounds = child.bounds;
    for (axis, row) in rows.into_iter().enumerate() {
        let Some((period, count)) = row else { continue };
        let room = period * (0.5 + f64::from(overlap)) * (1.0 + TIE) + TIE;
        let asks_all = count > 0 && count <= 2 * overlap + 2;
        let far = bounds.hi[axis].max(-bounds.lo[axis]);
        if far > room && !asks_all {
            let cells = ((far / period - 0.5).ceil()).max(1.0);
            return Err(overlapping("xyz".get(axis..=axis).unwrap_or_default(), far, cells, span));
        }
        let ends = if count == 0 { f64::INFINITY } else { 0.5 * period * f64::from(count - 1) };
        bounds.lo[axis] -= ends;
        bounds.hi[axis] += ends;
    }
    Ok(Solid { steepness: child.steepness, ..one(bounds) })
}

/// Copies around the y axis.
pub(super) fn around(child: Solid, count: u32, overlap: u32, span: Span) -> Result<Solid, Diagnostic> {
    let sector = TAU / f64::from(count);
    let asks_all = count <= overlap.saturating_mul(2).saturating_add(2);
    let angle = widest_angle(child.bounds);
    if !asks_all && angle > sector * (0.5 + f64::from(overlap)) + TIE {
        let sectors = (angle / sector - 0.5).ceil();
        let message = format!(
            "this shape is wider than its sector: seen from the y axis it reaches {:.0} degrees off the x axis, half a sector {:.0}",
            angle.to_degrees(),
            (0.5 * sector).to_degrees()
        );
        let diagnostic = Diagnostic::error("E0502", message, span, "its copies would have holes");
        let help = format!("move it outwards along x before, or write `overlap: {sectors}`");
        return Err(diagnostic.with_help(help));
    }
    Ok(Solid { steepness: child.steepness, ..one(turned(child.bounds)) })
}

fn overlapping(axis: &str, far: f64, cells: f64, span: Span) -> Diagnostic {
    let message = format!("this shape reaches {far:.3} along {axis}, further than half the period");
    let diagnostic = Diagnostic::error("E0502", message, span, "its copies would have holes");
    diagnostic.with_help(format!("enlarge the period, centre the shape, or write `overlap: {cells}`"))
}

/// Largest angle off the x axis under which a box is seen from the y axis, in radians.
fn widest_angle(b: Box3) -> f64 {
    if is_empty(b) {
        return 0.0;
    }
    let holds_axis = b.lo[0] <= 0.0 && b.lo[2] <= 0.0 && b.hi[2] >= 0.0;
    if holds_axis {
        return PI;
    }
    let corners = [(b.lo[0], b.lo[2]), (b.lo[0], b.hi[2]), (b.hi[0], b.lo[2]), (b.hi[0], b.hi[2])];
    corners.into_iter().map(|(x, z)| z.atan2(x).abs()).fold(0.0, f64::max)
}

/// The box around all that a box sweeps when turned about the y axis.
fn turned(b: Box3) -> Box3 {
    if is_empty(b) {
        return EMPTY;
    }
    let reach = radius(b);
    Box3 { lo: [-reach, b.lo[1], -reach], hi: [reach, b.hi[1], reach] }
}

fn is_empty(b: Box3) -> bool {
    (0..3).any(|i| b.lo[i] > b.hi[i])
}

/// One cell, of a distance proper.
fn one(bounds: Box3) -> Solid {
    Solid { bounds, cells: vec![grown(bounds, 0.0)], steepness: 1.0, loose: false }
}
