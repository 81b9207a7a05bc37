//! Closest point on a curve of canonical pieces in f32, the same text as `compiler/src/wgsl/curve.wgsl`.
//!
//! In: a point and the pieces of `vol_compiler::curve::prepare`. Out: a [`CurvePoint`]: where the
//! foot lies along the curve and where the point lies in the rotation-minimising frame there.
//!
//! * [`Search::visit`] solves one piece without a branch, so that a loop over points vectorises: batch
//!   callers take [`held_point`]s, put pieces outside and points inside, in the order of the curve
//!   (a local copy of each piece keeps its words in registers), then
//! * [`describe`] turns the winning foot into coordinates. [`closest`] is both for one point.
//!
//! Source: `algorithms.md` §1.1 ("uform 2+2"), §2.1 frame, §2.2 arc length, §3.3 stretching.

pub mod feet;
pub mod nodes;

use vol_compiler::curve::{Node, Piece};

use super::fun::{greater, hold, lesser, log2};

/// Below this a divisor counts as it: quotients stay finite.
const TINY: f32 = 1e-30;
/// Distance to a curve without pieces, scene units.
pub const FAR: f32 = 1e18;
/// Points farther out are held here, scene units.
const REACH: f32 = 1e8;
/// Largest stretch reported.
const STRETCH: f32 = 1e6;

/// A foot at an end is held there if its offset leans along the tangent by more than this share.
const LEAN: f32 = 1e-3;
/// Where the stretch is smaller, a foot is taken to slide as if it were this.
const LEAST_STRETCH: f32 = 0.05;
/// Largest change of t per length reported.
const LARGEST_RATE: f32 = 1e15;

/// A point seen from its closest point on a curve.
///
/// Scale, in the errors below, is the larger of the distance from the start of the curve and its size. All but that of
/// `distance` hold where the foot is unique by 1e-4 of the scale and `stretch > 0.05`: elsewhere the
/// foot may jump or slide (tests `agrees_with_f64`, `many_segments_agree_with_f64`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Curve parameter of the foot, 0..=1 over the whole curve, evenly per segment; error: moves
    /// the foot by 1e-6 of the scale.
    pub t: f32,
    /// Length from the start of the curve to the foot, scene units, 0..=`curve_length`; error 1e-6
    /// of the scale.
    pub arc_length: f32,
    /// Length of the whole curve, scene units.
    pub curve_length: f32,
    /// Offset from the foot along U, scene units; error 1e-6 of the scale.
    pub x: f32,
    /// Offset from the foot along V = T x U, scene units; error as `x`.
    pub y: f32,
    /// Distance to the foot, scene units; error 2e-7 of the scale, unconditionally.
    pub distance: f32,
    /// Distance beyond the end of the curve along its outward tangent, scene units, at least 0;
    /// 0 unless the foot is an end of the whole curve; error 4e-7 of the scale.
    pub overshoot: f32,
    /// Volume factor 1 - kappa o.N of the offset, `D(t) / (2 |v|^2)` at a foot inside a piece, held
    /// within 0..=1e6; 1 on straight pieces, cusps and points; 0 on the focal line. Error
    /// 6e-6 (1 + stretch) times scale over size of the curve.
    pub stretch: f32,
}

/// What [`closest`] returns for a curve without pieces.
const NOWHERE: CurvePoint = CurvePoint {
    t: 0.0,
    arc_length: 0.0,
    curve_length: 0.0,
    x: FAR,
    y: 0.0,
    distance: FAR,
    overshoot: 0.0,
    stretch: 1.0,
};

/// Closest point of one piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Parameter of the piece, 0..=1.
    pub t: f32,
    /// Squared distance, scene units squared.
    pub dist_sq: f32,
}

#[inline(always)]
fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    ((a[0] * b[0]) + (a[1] * b[1])) + (a[2] * b[2])
}

#[inline(always)]
fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [(a[1] * b[2]) - (a[2] * b[1]), (a[2] * b[0]) - (a[0] * b[2]), (a[0] * b[1]) - (a[1] * b[0])]
}

/// A point held within ±1e8 units, where no product below overflows.
#[inline(always)]
pub fn held_point(p: [f32; 3]) -> [f32; 3] {
    [hold(p[0], -REACH, REACH), hold(p[1], -REACH, REACH), hold(p[2], -REACH, REACH)]
}

/// Start of the piece seen from `p`; the low part keeps it exact far from the scene origin.
#[inline(always)]
fn from_point(p: [f32; 3], piece: &Piece) -> [f32; 3] {
    [
        (piece.origin[0] - p[0]) + piece.origin_low[0],
        (piece.origin[1] - p[1]) + piece.origin_low[1],
        (piece.origin[2] - p[2]) + piece.origin_low[2],
    ]
}

/// `Q(t) - p`.
#[inline(always)]
fn reach(w: [f32; 3], piece: &Piece, t: f32) -> [f32; 3] {
    [
        w[0] + (t * ((2.0 * piece.b1[0]) + (t * piece.b2[0]))),
        w[1] + (t * ((2.0 * piece.b1[1]) + (t * piece.b2[1]))),
        w[2] + (t * ((2.0 * piece.b1[2]) + (t * piece.b2[2]))),
    ]
}

/// The end of a piece at t = 1 seen from `p`.
#[inline(always)]
fn end_from_point(p: [f32; 3], piece: &Piece) -> [f32; 3] {
    [
        (piece.end[0] - p[0]) + piece.end_low[0],
        (piece.end[1] - p[1]) + piece.end_low[1],
        (piece.end[2] - p[2]) + piece.end_low[2],
    ]
}

/// `Q(t) - p` from the nearer end of the piece, which halves what rounding takes.
#[inline(always)]
fn offset_at(p: [f32; 3], piece: &Piece, t: f32) -> [f32; 3] {
    let (start, end) = (reach(from_point(p, piece), piece, t), end_from_point(p, piece));
    let back = 1.0 - t;
    let before = |axis: usize| {
        let twice = 2.0 * (piece.b1[axis] + piece.b2[axis]);
        end[axis] - (back * (twice - (back * piece.b2[axis])))
    };
    let past = t > 0.5;
    [
        if past { before(0) } else { start[0] },
        if past { before(1) } else { start[1] },
        if past { before(2) } else { start[2] },
    ]
}

/// Start for the cube root of `x >= 0`, a few per cent off.
#[inline(always)]
fn rough_cube_root(x: f32) -> f32 {
    f32::from_bits((x.to_bits() / 3) + 709_921_077)
}

/// The foot inside a canonical piece, if it has one, and what decides between it and the start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inner {
    /// Parameter of the largest root of g, held within 0..=1.
    pub t: f32,
    /// Squared distance there.
    pub dist_sq: f32,
    /// Whether the start is a minimum of the distance by itself: it grows from there on. At a cusp its slope is 0
    /// there, and its curvature says.
    pub start_is_least: bool,
    /// Squared distance at the start.
    pub start_sq: f32,
    /// Whether g falls below 0 between a start and an end where it is not.
    pub dips: bool,
}

/// Closest point of one canonical piece.
///
/// * `p`: scene units, |p| <= 1e8; straight, cusp and point pieces included
/// * error: distance 2e-7 of the scale for every point and piece (test `agrees_with_f64`)
/// * method: g(t) = (Q - p).Q'/4 is convex on [0, 1], so the minimum is t = 0, its largest root or
///   t = 1; two Newton steps on the depressed cubic from above, two more on g itself
#[inline(always)]
pub fn foot(p: [f32; 3], piece: &Piece) -> Foot {
    let Inner { t, dist_sq, start_is_least, start_sq, .. } = inner(p, piece);
    // Prefer the start where it is itself a minimum and nearer.
    let start_wins = start_is_least & (start_sq <= dist_sq);
    Foot { t: if start_wins { 0.0 } else { t }, dist_sq: if start_wins { start_sq } else { dist_sq } }
}

/// The largest root of g.
#[inline(always)]
pub fn inner(p: [f32; 3], piece: &Piece) -> Inner {
    // Coefficients of g = a3 t^3 + 3 a2 t^2 + a1 t + a0.
    let w = from_point(p, piece);
    let a3 = piece.a3;
    let a2x3 = 3.0 * piece.a2;
    let a1 = (2.0 * piece.b11) + dot(w, piece.b2);
    let a0 = dot(w, piece.b1);
    // Move to the larger extremum e, or to the vertex where g has none.
    let slope = (a1 + (a2x3 * piece.vertex)) * piece.inv_a3;
    let half_gap = greater(-slope * 0.333_333_34, 0.0).sqrt();
    let m = greater(slope, 0.0);
    let e = piece.vertex + half_gap;
    let at_e = ((((((a3 * e) + a2x3) * e) + a1) * e) + a0) * piece.inv_a3;
    let k = greater(-at_e, 0.0);
    let gap3 = 3.0 * half_gap;
    // Guess the root of u^3 + gap3 u^2 + m u = k by its largest term.
    let tiny = (1e-12 * k) + TINY;
    let by_square = (k / greater(gap3, tiny)).sqrt();
    let by_line = k / greater(m, tiny);
    let u0 = lesser(lesser(rough_cube_root(k), by_square), by_line);
    // Two Newton steps.
    let u1 = depressed_step(u0, gap3, m, k);
    let u2 = depressed_step(u1, gap3, m, k);
    // Return to t; a flat piece starts in the middle.
    let flat = piece.inv_a3 == 0.0;
    let low = if flat { 0.0 } else { hold(e, 0.0, 1.0) };
    let t0 = if flat { 0.5 } else { hold(e + u2, low, 1.0) };
    // Two polishing steps on g.
    let t1 = polish_step(t0, a3, a2x3, a1, a0, low);
    let t2 = polish_step(t1, a3, a2x3, a1, a0, low);
    let end = reach(w, piece, t2);
    Inner {
        t: t2,
        dist_sq: dot(end, end),
        start_is_least: (a0 > 0.0) | ((a0 == 0.0) & (a1 >= 0.0)),
        start_sq: dot(w, w),
        dips: !flat & (k > 0.0) & (e > 0.0) & (e < 1.0),
    }
}

/// One Newton step on `u^3 + gap3 u^2 + m u = k`, u >= 0.
#[inline(always)]
fn depressed_step(u: f32, gap3: f32, m: f32, k: f32) -> f32 {
    let value = ((((u + gap3) * u) + m) * u) - k;
    let slope = (((3.0 * u) + (2.0 * gap3)) * u) + m;
    greater(u - (value / greater(slope, TINY)), 0.0)
}

/// One Newton step on g, held within `low..=1`.
#[inline(always)]
fn polish_step(t: f32, a3: f32, a2x3: f32, a1: f32, a0: f32, low: f32) -> f32 {
    let value = (((((a3 * t) + a2x3) * t) + a1) * t) + a0;
    let slope = ((((3.0 * a3) * t) + (2.0 * a2x3)) * t) + a1;
    hold(t - (value / greater(slope, TINY)), low, 1.0)
}

/// Whether `t` is where the curve enters the piece, within 3e-8.
#[inline(always)]
fn at_first(piece: &Piece, t: f32) -> bool {
    piece.sense * (t - 0.5) <= -0.5
}

/// Whether `t` is where the curve leaves the piece, within 3e-8.
#[inline(always)]
fn at_last(piece: &Piece, t: f32) -> bool {
    piece.sense * (t - 0.5) >= 0.5
}

/// Closest point of the pieces visited so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Search {
    /// Squared distance, scene units squared.
    pub dist_sq: f32,
    /// Parameter on the winning piece.
    pub t: f32,
    /// Number of the winning piece.
    pub piece: u32,
    /// Whether the foot on the piece visited last is where the curve leaves it.
    pub left_at_last: bool,
}

impl Search {
    /// Nothing visited.
    pub const START: Search = Search { dist_sq: f32::MAX, t: 0.0, piece: 0, left_at_last: false };

    /// Visit the next piece along the curve.
    ///
    /// Where two pieces touch, one of their two feet there is redundant: a foot at the last point
    /// defers to the piece after; a foot at the first point counts only if the piece before deferred,
    /// since otherwise that one has a nearer foot inside. Comparing distances alone would lose half
    /// the digits of the foot beside every joint.
    #[inline(always)]
    #[must_use]
    pub fn visit(self, p: [f32; 3], piece: &Piece, index: u32) -> Search {
        let found = foot(p, piece);
        let leaves = at_last(piece, found.t);
        let defers = leaves & (piece.after == 1.0);
        let redundant = at_first(piece, found.t) & (piece.before == 1.0) & !self.left_at_last;
        let wins = (found.dist_sq < self.dist_sq) & !defers & !redundant;
        Search {
            dist_sq: if wins { found.dist_sq } else { self.dist_sq },
            t: if wins { found.t } else { self.t },
            piece: if wins { index } else { self.piece },
            left_at_last: leaves,
        }
    }
}

/// Length of a piece from t = 0 to `t`, scene units; every term is positive.
///
/// * error: 1e-6 relative (test `arc_length_at_a_foot`)
#[inline(always)]
fn length_to(piece: &Piece, t: f32) -> f32 {
    // Half speed at both ends and its rise.
    let rate = (piece.a3 * t) + (2.0 * piece.a2);
    let speed0 = piece.b11.sqrt();
    let speed = ((rate * t) + piece.b11).sqrt();
    let rise = (t * rate) / greater(speed + speed0, TINY);
    // The logarithm: a series for small z, else log2.
    let z = (piece.q * ((piece.q * t) + rise)) / piece.log_base;
    let y = z / (2.0 + z);
    let yy = y * y;
    let s3 = 0.142_857_15 + (yy * 0.111_111_11);
    let s2 = 0.2 + (yy * s3);
    let s1 = 0.333_333_34 + (yy * s2);
    let series = (2.0 * y) * (1.0 + (yy * s1));
    let logarithm = log2(1.0 + z) * core::f32::consts::LN_2;
    let log_term = if z < 0.414 { series } else { logarithm };
    // Add the terms.
    let bent = (t * speed) + ((-piece.vertex * rise) + (piece.log_scale * log_term));
    if piece.inv_a3 == 0.0 { (2.0 * speed0) * t } else { bent }
}

/// Coordinates of `p` about the point `t` of a piece.
///
/// * `t`: 0..=1, normally from [`foot`]
/// * method: U(t) = U0 - (U0.T)/(1 + T0.T) (T0 + T) with 1 + T0.T = T0.(T0 + T), exact for a planar piece turning by at most a
///   right angle; stretch = 1 + (Q - p).(bend x v) / (2 |v|^4), free of cancellation
#[inline(always)]
pub fn describe(p: [f32; 3], piece: &Piece, t: f32) -> CurvePoint {
    // Offset and half velocity at the foot.
    let r = offset_at(p, piece, t);
    let v =
        [piece.b1[0] + (t * piece.b2[0]), piece.b1[1] + (t * piece.b2[1]), piece.b1[2] + (t * piece.b2[2])];
    let vv = greater(dot(v, v), TINY);
    // Unit tangent along the curve.
    let straight = piece.straight != 0.0;
    let per_speed = piece.sense / vv.sqrt();
    let t0 = piece.tangent;
    let tangent = [
        if straight { t0[0] } else { v[0] * per_speed },
        if straight { t0[1] } else { v[1] * per_speed },
        if straight { t0[2] } else { v[2] * per_speed },
    ];
    // Coordinates in the carried frame.
    let sum = [t0[0] + tangent[0], t0[1] + tangent[1], t0[2] + tangent[2]];
    let turn = dot(r, sum) / dot(t0, sum);
    let x = (dot(piece.normal, tangent) * turn) - dot(r, piece.normal);
    let y = (dot(piece.binormal, tangent) * turn) - dot(r, piece.binormal);
    // How far beyond an end of the whole curve; a point has both ends in one place.
    let ahead = -dot(r, tangent);
    let starts = at_first(piece, t) & (piece.before == 0.0);
    let ends = (at_last(piece, t) | (piece.t_span == 0.0)) & (piece.after == 0.0);
    let behind_first = if starts { -ahead } else { 0.0 };
    let beyond_last = if ends { ahead } else { 0.0 };
    // Stretch of volume by the bend.
    let bent = dot(r, cross(piece.bend, v)) / vv;
    let stretch = 1.0 + (bent / (2.0 * vv));
    let s = piece.s_start + (piece.sense * length_to(piece, t));
    CurvePoint {
        t: hold(piece.t_start + (piece.t_span * t), 0.0, 1.0),
        arc_length: hold(s, 0.0, piece.curve_length),
        curve_length: piece.curve_length,
        x,
        y,
        distance: dot(r, r).sqrt(),
        overshoot: greater(greater(behind_first, beyond_last), 0.0),
        stretch: hold(stretch, 0.0, STRETCH),
    }
}

/// How the closest point moves with the position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveSlopes {
    /// Unit vector from the foot to the position, the gradient of the distance; 0 on the curve. Error
    /// 4e-6 of the scale over the distance, where the foot is unique as said at [`CurvePoint`].
    pub direction: [f32; 3],
    /// Unit tangent at the foot, along the curve; error 1e-5 where the curve bends by less than 1 / size.
    pub tangent: [f32; 3],
    /// Change of t per arc length, at most 1e15; 0 for a point.
    pub rate: f32,
    /// Change of arc length per length along the tangent: 1 / stretch, at most 20; 0 where the foot
    /// stays at an end or a corner, the offset leaning by more than 1e-3 of its length.
    pub slide: f32,
}

/// What [`closest_gradient`] returns for a curve without pieces.
const STILL: CurveSlopes =
    CurveSlopes { direction: [1.0, 0.0, 0.0], tangent: [0.0, 0.0, 1.0], rate: 0.0, slide: 0.0 };

/// How the foot of `p` at the point `t` of a piece moves.
#[inline(always)]
pub fn slopes(p: [f32; 3], piece: &Piece, t: f32) -> CurveSlopes {
    // Offset and half velocity at the foot.
    let w = from_point(p, piece);
    let r = reach(w, piece, t);
    let v =
        [piece.b1[0] + (t * piece.b2[0]), piece.b1[1] + (t * piece.b2[1]), piece.b1[2] + (t * piece.b2[2])];
    let vv = greater(dot(v, v), TINY);
    // Unit tangent along the curve.
    let straight = piece.straight != 0.0;
    let speed = vv.sqrt();
    let per_speed = piece.sense / speed;
    let t0 = piece.tangent;
    let tangent = [
        if straight { t0[0] } else { v[0] * per_speed },
        if straight { t0[1] } else { v[1] * per_speed },
        if straight { t0[2] } else { v[2] * per_speed },
    ];
    // Unit offset.
    let distance = dot(r, r).sqrt();
    let per_distance = if distance > 0.0 { -1.0 / greater(distance, TINY) } else { 0.0 };
    // How far the foot slides: not at all where it is held.
    let at_end = (t == 0.0) | (t == 1.0);
    let held = at_end & (dot(r, tangent).abs() > LEAN * distance);
    let bent = dot(r, cross(piece.bend, v)) / vv;
    let stretch = greater(1.0 + (bent / (2.0 * vv)), LEAST_STRETCH);
    CurveSlopes {
        direction: [r[0] * per_distance, r[1] * per_distance, r[2] * per_distance],
        tangent,
        rate: lesser(piece.t_span.abs() / (2.0 * speed), LARGEST_RATE),
        slide: if held | (piece.t_span == 0.0) { 0.0 } else { 1.0 / stretch },
    }
}

/// How the closest point of a whole curve moves: see [`closest`] for which one that is.
#[inline(always)]
pub fn closest_gradient(p: [f32; 3], pieces: &[Piece], nodes: &[Node]) -> CurveSlopes {
    let p = held_point(p);
    let search = nodes::search(p, pieces, nodes);
    // Describe how the foot moves on the winner.
    match pieces.get(search.piece as usize) {
        Some(piece) => slopes(p, piece, search.t),
        None => STILL,
    }
}

/// Closest point of a whole curve.
///
/// * `p`: scene units, held within ±1e8; `pieces`, `nodes`: from `vol_compiler::curve::prepare`; without
///   nodes all pieces are visited
/// * returns: the nearest piece wins, the first one on a tie, except that a foot where two pieces
///   touch belongs to the one after; finite for every curve
/// * degenerate: without pieces, a point 1e18 units away along U with everything else 0, stretch 1
#[inline(always)]
pub fn closest(p: [f32; 3], pieces: &[Piece], nodes: &[Node]) -> CurvePoint {
    let p = held_point(p);
    let search = nodes::search(p, pieces, nodes);
    // Describe the foot on the winner.
    match pieces.get(search.piece as usize) {
        Some(piece) => describe(p, piece, search.t),
        None => NOWHERE,
    }
}

#[cfg(test)]
mod tests;
