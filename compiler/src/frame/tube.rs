//! What the distance to a tube's surface needs to know, found out once per frame in f64.
//!
//! Let Q be the axis, r the radius, R its largest value, d = |P - Q(t)| for the foot t of P, and F =
//! d - r(t). The surface of a tube is marched by a lower bound on the distance to it
//! (`lower/tube.rs`, `Tube::distance`), made of these parts:
//!
//! * **One radius.** d is a distance to a set, so F changes at most as fast as P moves.
//! * **Far.** The tube lies within R of the axis, so d - R never exceeds the distance to it.
//! * **Near, radius varying.** Let rho be the reach of the axis: every point nearer than rho has one foot
//!   only, and within d < s < rho the foot moves at most 1 / (1 - s / rho) as fast as the point (Federer
//!   1959, theorem 4.8). So there the slope of F is at most S = sqrt(1 + (m / (1 - s / rho))^2), m the
//!   largest |dr/dl|. A way to the surface, where d <= R, either stays within d < s and is at least
//!   |F| / S long, or leaves it and is at least s - R long: min(F / S, s - R) is safe.
//! * **Reach.** It is at least the smaller of 1 / K, K the largest curvature, and half the smallest
//!   distance of two points of the axis that are pi / K or more apart along it. For nearer ones Schur's
//!   comparison with the circle of curvature K gives Federer's |b - a|^2 >= 2 rho dist(b - a, tangent).
//!   A corner has K = infinity.
//! * **Flat ends.** Let e be an end, A the arc from it with curvature k and length a, k a <= pi / 2, C the
//!   distance from e to the rest of the axis. P beyond e at height o has the foot e. A point P' of the tube
//!   has its foot either on A, and is behind the plane of the end if k R <= 1, so |P - P'| >= o;
//!   or on the rest, so |P - P'| >= C / 2 - d, since that foot is not farther from P' than e. So
//!   min(o, C / 2 - d) is safe, and d - R > 0 takes over where C / 2 > R. From inside, a foot l along A is at
//!   least l (1 - k R) sin(k a) / (k a) behind the plane, and feet on the rest are at least C - 2 R from the
//!   disc of the end.
//!
//! Where one of the conditions fails the tube can be filled with a medium but not be an object.

use super::extent::Space;
use crate::curve::Quadratic;
use crate::ops::interval::Interval;
use crate::program::{Caps, LEAST_RADIUS, TubeSizes, TubeSlope};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;
use vol_language::diag::Diagnostic;
use vol_language::source::Span;

mod reach;

/// A number that stands for infinity: differences of two such are still numbers in f32.
const FAR: f64 = 1e15;

/// Most arcs into which a curve is cut.
const MOST_ARCS: usize = 8192;

/// Fewest.
const FEWEST_ARCS: usize = 64;

/// A gap counts as so many lengths of the whole curve.
const GAP: f64 = 100.0;

/// Tangents that turn by more than this from one segment to the next are a corner; radians.
const CORNER: f64 = 1e-4;

/// The reach is not looked for beyond so many largest radii.
const MOST_REACH: f64 = 16.0;

/// How far along an arc from an end its curvature may turn the tangent.
const END_TURN: f64 = FRAC_PI_2;

/// What is known of a tube in a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measured {
    /// See [`TubeSizes`].
    pub(super) numbers: [f64; TubeSizes::COUNT],
    /// Whether its surface can be marched.
    pub(super) safe: bool,
    /// Whether its distance is a bound only outside.
    pub(super) loose: bool,
}

/// A short part of the axis.
#[derive(Clone, Copy, Debug)]
struct Arc {
    middle: DVec3,
    /// Half of an upper bound on its length.
    half: f64,
    /// Length from the start of the curve to its start, at most too large; see [`GAP`].
    start: f64,
    /// Largest curvature, infinite at a cusp or where it begins with a corner.
    curvature: f64,
    /// The kernels' t.
    t: Interval,
    /// Smallest speed: length per t.
    speed: f64,
}

impl Space<'_> {
    /// Finds out the numbers of a tube.
    pub(super) fn measure_tube(&self, sizes: &TubeSizes) -> Measured {
        let curve = sizes.curve as usize;
        let table = &self.tables[curve];
        let largest = self.largest_radius(curve, sizes.radius).max(LEAST_RADIUS);
        let arcs = arcs(&table.segments, table.length, largest, sizes.caps == Caps::Joined);
        let wall = match sizes.slope {
            TubeSlope::Flat => Some(Wall { shell: FAR, scale: 1.0 }),
            TubeSlope::Known(slope) => {
                let steepest = self.steepest_radius(slope, &arcs, table.length);
                let closed = sizes.caps == Caps::Joined;
                wall(&reach::Axis { arcs: &arcs, length: table.length, closed }, largest, steepest)
            }
            TubeSlope::Unknown => None,
        };
        let ends = match sizes.caps {
            Caps::Flat => ends(&arcs, &table.segments, table.length, largest),
            Caps::Round | Caps::Open | Caps::Joined => Some(Ends::FREE),
        };
        let turn_rate = if table.length > 0.0 { table.turn / table.length } else { 0.0 };
        let safe = wall.is_some() && ends.is_some();
        // Without a bound the signs at least are right.
        let (wall, ends) = (wall.unwrap_or(Wall { shell: FAR, scale: 1.0 }), ends.unwrap_or(Ends::FREE));
        let loose = wall.scale < 1.0 || ends.limit < FAR;
        let numbers = [
            largest,
            wall.shell,
            wall.scale,
            ends.limit,
            ends.scale,
            ends.depth,
            turn_rate,
            -table.bend_angle,
            table.length,
        ];
        Measured { numbers, safe, loose }
    }

    /// Largest change of the radius per length.
    fn steepest_radius(&self, slope: crate::ir::FunctionId, arcs: &[Arc], length: f64) -> f64 {
        let steepest = arcs.iter().map(|arc| {
            let along = Interval::new(0.0, length);
            let slopes = self.interval(slope, &[arc.t, along]);
            let by_t = slopes[0].magnitude();
            slopes[1].magnitude() + if by_t == 0.0 { 0.0 } else { by_t / arc.speed }
        });
        steepest.fold(0.0, f64::max)
    }
}

/// How the wall may be approached.
struct Wall {
    shell: f64,
    scale: f64,
}

fn wall(axis: &reach::Axis<'_>, largest: f64, steepest: f64) -> Option<Wall> {
    let reach = reach::reach(axis, MOST_REACH * largest);
    let shell = (largest + 0.25 * (reach - largest)).min(2.0 * largest);
    let slope = steepest / (1.0 - shell / reach);
    let scale = 1.0 / (1.0 + slope * slope).sqrt();
    (reach > largest && scale > 0.0).then_some(Wall { shell, scale })
}

/// How flat ends may be approached.
struct Ends {
    limit: f64,
    scale: f64,
    depth: f64,
}

impl Ends {
    const FREE: Self = Self { limit: FAR, scale: 1.0, depth: FAR };
}

fn ends(arcs: &[Arc], segments: &[Quadratic], length: f64, largest: f64) -> Option<Ends> {
    let gap = 0.5 * GAP * length;
    let (first, last) = (segments.first()?, segments.last()?);
    let start = end(arcs.iter(), first.a.into(), gap, largest)?;
    let end = end(arcs.iter().rev(), last.c.into(), gap, largest)?;
    Some(Ends {
        limit: start.limit.min(end.limit),
        scale: start.scale.min(end.scale),
        depth: start.depth.min(end.depth),
    })
}

/// One end; `arcs` are those of the curve, seen from it, and starts of arcs more than `gap` apart are on
/// both sides of a gap.
fn end<'a>(arcs: impl Iterator<Item = &'a Arc>, at: DVec3, gap: f64, largest: f64) -> Option<Ends> {
    let (mut bend, mut length, mut rest) = (0f64, 0.0, f64::INFINITY);
    let mut near = true;
    let mut turn = 0.0;
    let mut before = None;
    for arc in arcs {
        let goes_on = (arc.start - before.unwrap_or(arc.start)).abs() <= gap;
        before = Some(arc.start);
        let (wider, longer) = (bend.max(arc.curvature), length + 2.0 * arc.half);
        near = near && goes_on && wider * longer <= END_TURN && wider * largest < 1.0;
        if near {
            (bend, length) = (wider, longer);
            turn = bend * length;
        } else {
            rest = rest.min(arc.middle.distance(at) - arc.half);
        }
    }
    let shrink = if turn > 1e-6 { turn.sin() / turn } else { 1.0 };
    let scale = (1.0 - bend * largest) * shrink;
    let depth = (scale * length).min(rest - 2.0 * largest).min(FAR);
    (rest > 2.0 * largest).then_some(Ends { limit: (0.5 * rest).min(FAR), scale, depth })
}

/// Cuts a curve into arcs that are short against the radius.
fn arcs(segments: &[Quadratic], length: f64, largest: f64, closed: bool) -> Vec<Arc> {
    let wanted = (8.0 * length / largest).clamp(FEWEST_ARCS as f64, MOST_ARCS as f64);
    let longest = (length / wanted).max(f64::MIN_POSITIVE);
    let mut arcs: Vec<Arc> = Vec::new();
    let mut start = 0.0;
    let mut before: Option<&Quadratic> = if closed { segments.last() } else { None };
    for (index, segment) in segments.iter().enumerate() {
        let polygon = polygon(segment);
        if polygon <= 1e-10 * length {
            continue;
        }
        let corner = before.is_some_and(|before| turns(before, segment));
        if before.is_some_and(|before| DVec3::from(before.c).distance(segment.a.into()) > 1e-6 * length) {
            start += GAP * length;
        }
        let count = (polygon / longest).ceil().clamp(1.0, MOST_ARCS as f64) as usize;
        for part in 0..count {
            let ends = [part, part + 1].map(|i| i as f64 / count as f64);
            let mut arc = arc(segment, ends);
            arc.start = start;
            arc.t = Interval::new(
                (index as f64 + ends[0]) / segments.len() as f64,
                (index as f64 + ends[1]) / segments.len() as f64,
            );
            arc.speed *= segments.len() as f64;
            if part == 0 && corner {
                arc.curvature = f64::INFINITY;
            }
            start += 2.0 * arc.half;
            arcs.push(arc);
        }
        before = Some(segment);
    }
    arcs
}

/// The part of a segment between two parameters; `speed` per parameter of the segment.
fn arc(segment: &Quadratic, [from, to]: [f64; 2]) -> Arc {
    let [a, b, c] = [segment.a, segment.b, segment.c].map(DVec3::from);
    let (b1, b2) = (b - a, (c - b) - (b - a));
    let point = |u: f64| a + 2.0 * u * b1 + u * u * b2;
    let velocity = |u: f64| b1 + u * b2;
    let vertex = if b2.length_squared() > 0.0 { -b1.dot(b2) / b2.length_squared() } else { from };
    let slowest = velocity(vertex.clamp(from, to)).length();
    let bend = b1.cross(b2).length();
    // Collinear control points bend only where the curve turns back.
    let straight = bend <= 1e-12 * (b1.length() + b2.length()).powi(2);
    let curvature = match straight {
        true if slowest > 1e-9 * (b1.length() + b2.length()) => 0.0,
        true => f64::INFINITY,
        false => bend / (2.0 * slowest.powi(3)),
    };
    let reach = velocity(from).length() + velocity(to).length();
    Arc {
        middle: point(0.5 * (from + to)),
        half: 0.5 * (to - from) * reach,
        start: 0.0,
        curvature,
        t: Interval::point(0.0),
        speed: 2.0 * slowest,
    }
}

fn polygon(segment: &Quadratic) -> f64 {
    let [a, b, c] = [segment.a, segment.b, segment.c].map(DVec3::from);
    a.distance(b) + b.distance(c)
}

/// Whether the tangent jumps from one segment to the next.
fn turns(before: &Quadratic, after: &Quadratic) -> bool {
    let direction = |from: [f64; 3], to: [f64; 3], far: [f64; 3]| {
        let near = DVec3::from(to) - DVec3::from(from);
        if near.length() > 0.0 { near } else { DVec3::from(far) }.normalize_or_zero()
    };
    let chord = |s: &Quadratic| (DVec3::from(s.c) - DVec3::from(s.a)).to_array();
    let leave = direction(before.b, before.c, chord(before));
    let enter = direction(after.a, after.b, chord(after));
    leave.distance(enter) > CORNER
}

/// The message about an object that contains a tube without a bound.
pub(super) fn unsafe_surface(span: Span) -> Diagnostic {
    let message = "the surface of a tube of this object cannot be marched safely";
    let label = "it bends or comes back to itself within its own radius, or its ends are open";
    Diagnostic::error("E0503", message, span, label).with_help(
        "write `caps: round` and one radius for the whole tube, make it thinner, or fill it with a medium",
    )
}

#[cfg(test)]
mod tests;
