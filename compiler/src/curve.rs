//! Quadratic Bezier axes prepared for the closest-point kernels.
//!
//! In: the control points of one curve, f64. Out: a [`CurveTable`] of canonical [`Piece`]s, the f32
//! numbers that `runtime-cpu/src/math/curve.rs` and `wgsl/curve.wgsl` read.
//!
//! * Each quadratic is split at its parabola vertex and the part before the vertex is reversed, so
//!   that along every piece the speed never falls (`b1 . b2 >= 0`) and the tangent turns by at most
//!   a right angle. The closest point is then one convex cubic, the frame needs no trigonometry, and
//!   the arc length has only positive terms (`algorithms.md` §1.1, §2.1, §2.2).
//! * Everything that does not depend on the sample point is computed here in f64 and rounded once.
//!
//! Example: the straight line from 0 to 2x becomes one piece with `length = 2`.
//!
//! Pieces are not scaled by a power of two: a test over sizes 1e-6 to 1e6 shows no need.

mod bounds;

pub use bounds::{Capsule, FEW_PIECES, Node};

/// One quadratic Bezier segment, scene units: start `a`, control point `b`, end `c`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quadratic {
    /// Start point.
    pub a: [f64; 3],
    /// Control point.
    pub b: [f64; 3],
    /// End point.
    pub c: [f64; 3],
}

/// One canonical piece, `Q(t) = origin + 2 t b1 + t^2 b2` for t in [0, 1], all f32.
///
/// "Along" means in the direction of the whole curve; a reversed piece runs against it.
///
/// | words | field | meaning |
/// |---|---|---|
/// | 0-2 | `origin` | start of the piece, scene units |
/// | 3-5 | `origin_low` | what rounding took from `origin`: far from the scene origin the sum is exact |
/// | 6-8 | `b1` | half the velocity at the start |
/// | 9-11 | `b2` | half the change of velocity / 2 |
/// | 12-14 | `tangent` | unit tangent at the start, along the curve |
/// | 15-17 | `normal` | U, unit, perpendicular to `tangent` |
/// | 18-20 | `binormal` | V = tangent x U |
/// | 21-23 | `bend` | b1 x b2, zero on a flat piece or cusp |
/// | 24 | `a3` | b2 . b2 |
/// | 25 | `a2` | b1 . b2, at least 0 |
/// | 26 | `b11` | b1 . b1 |
/// | 27 | `vertex` | t of the parabola vertex, `-a2 / a3`, at most 0; -1 when flat |
/// | 28 | `inv_a3` | 1 / a3; 0 is the flag of a flat piece (constant speed) |
/// | 29 | `t_start` | curve parameter at t = 0 |
/// | 30 | `t_span` | curve parameter at t = 1 minus `t_start`; negative when reversed, 0 for a point |
/// | 31 | `s_start` | arc length at t = 0 from the start of the curve, scene units |
/// | 32 | `sense` | +1, or -1 when reversed |
/// | 33 | `q` | sqrt a3; 0 when flat |
/// | 34 | `log_scale` | &#124;bend&#124;^2 / (a3 q); 0 when flat or straight |
/// | 35 | `log_base` | a2 + q &#124;b1&#124;; 1 when flat or a cusp |
/// | 36 | `straight` | 1: the tangent is `tangent` everywhere (line, cusp at the start, point); else 0 |
/// | 37 | `before` | what precedes the piece along the curve: 0 nothing, 1 a piece it touches, 2 a gap |
/// | 38 | `after` | what follows: 0 nothing, 1 a piece it touches, 2 a gap |
/// | 39 | `curve_length` | length of the whole curve, scene units |
/// | 40-42 | `end` | point at t = 1, scene units |
/// | 43-45 | `end_low` | what rounding took from `end` |
/// | 46-48 | `end_tangent` | unit tangent at t = 1, along the curve |
/// | 49-51 | `tangent_before` | unit tangent with which the piece before ends, along the curve; for the first piece that of the last |
/// | 52-54 | `lo` | smallest corner of a box around the piece, with room for rounding, scene units |
/// | 55-57 | `hi` | largest corner of it |
/// | 58-59 | | 0, so that each piece begins a row of four words |
///
/// Where two pieces touch, both have the same words for the point, and for the tangent if it does not turn by
/// more than 1e-8: whatever is decided by them there falls on one side (`algorithms.md` §3.1).
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
#[expect(missing_docs, reason = "the table above describes every field")]
pub struct Piece {
    pub origin: [f32; 3],
    pub origin_low: [f32; 3],
    pub b1: [f32; 3],
    pub b2: [f32; 3],
    pub tangent: [f32; 3],
    pub normal: [f32; 3],
    pub binormal: [f32; 3],
    pub bend: [f32; 3],
    pub a3: f32,
    pub a2: f32,
    pub b11: f32,
    pub vertex: f32,
    pub inv_a3: f32,
    pub t_start: f32,
    pub t_span: f32,
    pub s_start: f32,
    pub sense: f32,
    pub q: f32,
    pub log_scale: f32,
    pub log_base: f32,
    pub straight: f32,
    pub before: f32,
    pub after: f32,
    pub curve_length: f32,
    pub end: [f32; 3],
    pub end_low: [f32; 3],
    pub end_tangent: [f32; 3],
    pub tangent_before: [f32; 3],
    pub lo: [f32; 3],
    pub hi: [f32; 3],
}

impl Piece {
    /// Words of one piece in the buffer `vol_curves`.
    pub const WORDS: usize = 60;

    /// All words 0.
    pub const ZERO: Self = Self {
        origin: [0.0; 3],
        origin_low: [0.0; 3],
        b1: [0.0; 3],
        b2: [0.0; 3],
        tangent: [0.0; 3],
        normal: [0.0; 3],
        binormal: [0.0; 3],
        bend: [0.0; 3],
        a3: 0.0,
        a2: 0.0,
        b11: 0.0,
        vertex: 0.0,
        inv_a3: 0.0,
        t_start: 0.0,
        t_span: 0.0,
        s_start: 0.0,
        sense: 0.0,
        q: 0.0,
        log_scale: 0.0,
        log_base: 0.0,
        straight: 0.0,
        before: 0.0,
        after: 0.0,
        curve_length: 0.0,
        end: [0.0; 3],
        end_low: [0.0; 3],
        end_tangent: [0.0; 3],
        tangent_before: [0.0; 3],
        lo: [0.0; 3],
        hi: [0.0; 3],
    };

    /// The piece as words, in field order.
    pub fn words(&self) -> [f32; Self::WORDS] {
        let mut words = [0.0; Self::WORDS];
        let triples = [
            self.origin,
            self.origin_low,
            self.b1,
            self.b2,
            self.tangent,
            self.normal,
            self.binormal,
            self.bend,
        ];
        words[..24].copy_from_slice(triples.as_flattened());
        words[24..40].copy_from_slice(&[
            self.a3,
            self.a2,
            self.b11,
            self.vertex,
            self.inv_a3,
            self.t_start,
            self.t_span,
            self.s_start,
            self.sense,
            self.q,
            self.log_scale,
            self.log_base,
            self.straight,
            self.before,
            self.after,
            self.curve_length,
        ]);
        let ends = [self.end, self.end_low, self.end_tangent, self.tangent_before, self.lo, self.hi];
        words[40..58].copy_from_slice(ends.as_flattened());
        words
    }
}

/// A prepared curve.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveTable {
    /// Canonical pieces in the order of the curve; empty only for an empty curve.
    pub pieces: Vec<Piece>,
    /// Capsules around consecutive pieces; none for a curve of at most [`FEW_PIECES`].
    pub nodes: Vec<Node>,
    /// Length of the whole curve, scene units.
    pub length: f64,
    /// The segments the table was made from, coordinates held as [`prepare`] says.
    pub segments: Vec<Quadratic>,
    /// Angle from U at the start to U at the end, carried on to the tangent at the start; radians.
    pub turn: f64,
    /// Angle from U to the centre of curvature where the curve bends first, 0 if nowhere; radians.
    pub bend_angle: f64,
}

impl CurveTable {
    /// All pieces as words of the buffer `vol_curves`, piece `i` at word `i * Piece::WORDS`.
    pub fn words(&self) -> Vec<f32> {
        self.pieces.iter().flat_map(Piece::words).collect()
    }

    /// Forgets where pieces are: all of them are looked at for every point.
    pub(crate) fn look_at_all(&mut self) {
        self.nodes.clear();
        let everywhere = |piece: &mut Piece| (piece.lo, piece.hi) = ([-EVERYWHERE; 3], [EVERYWHERE; 3]);
        self.pieces.iter_mut().for_each(everywhere);
    }
}

/// A box with this corner holds whatever a kernel may be asked for, scene units.
const EVERYWHERE: f32 = 1e18;

/// Tangents that differ by less at a joint are one.
const SMOOTH: f64 = 1e-8;

/// Prepare a curve; the parameter t runs 0..1 over the whole of it, evenly per segment.
///
/// * `segments`: in order; neighbours need not share tangents (corner) nor even points (gap)
/// * degenerate: segments shorter than 1e-10 of the longest (or 1e-9 units) are left out; if that is
///   all of them the curve is one point with tangent +z; a bend sharper than 1e-8 of its segment is a
///   cusp, the curve turning back on itself
/// * range: coordinates are held within ±1e8 units, NaN and infinities count as 0, so that every word
///   and every kernel result is finite
/// * error: the table is f64 rounded once; f64 checks in this file's tests
/// * source: `algorithms.md` §1.1, §2.1, §2.2
pub fn prepare(segments: &[Quadratic]) -> CurveTable {
    let segments: Vec<Quadratic> = segments.iter().map(held).collect();
    let parts = split_all(&segments);
    let length = parts.iter().map(Part::length).sum();
    let tangents = tangents_along(&parts);
    let mut pieces = Vec::with_capacity(parts.len());
    let mut offset = 0.0;
    let mut carried: Option<([f64; 3], [f64; 3])> = None;
    let mut first: Option<([f64; 3], [f64; 3])> = None;
    let mut bend_angle = None;
    for (i, part) in parts.iter().enumerate() {
        let [enter, leave] = tangents[i];
        let entering = match carried {
            Some((normal, before)) => transport(normal, before, enter),
            None => initial_normal(enter),
        };
        let leaving = transport(entering, enter, leave);
        let normal = if part.reversed { leaving } else { entering };
        first = first.or(Some((entering, enter)));
        if bend_angle.is_none() && part.bend != [0.0; 3] {
            // The part bends from its entering tangent towards its leaving one.
            bend_angle = Some(angle_about(enter, entering, leave));
        }
        let [_, before] = tangents[i.checked_sub(1).unwrap_or(parts.len() - 1)];
        let place = Place {
            normal,
            offset,
            length,
            tangents: [before, enter, leave],
            neighbours: [
                i.checked_sub(1).map_or(0.0, |j| link(&parts[j], part)),
                parts.get(i + 1).map_or(0.0, |next| link(part, next)),
            ],
        };
        pieces.push(part.piece(&place));
        offset += part.length();
        carried = Some((leaving, leave));
    }
    let turn = first.zip(carried).map_or(0.0, |((normal, tangent), (last, leave))| {
        angle_about(tangent, normal, transport(last, leave, tangent))
    });
    let nodes = bounds::tree(&pieces);
    CurveTable { pieces, nodes, length, segments, turn, bend_angle: bend_angle.unwrap_or(0.0) }
}

/// Unit tangents along the curve where it enters and leaves each part; the same where they agree.
fn tangents_along(parts: &[Part]) -> Vec<[[f64; 3]; 2]> {
    let mut tangents: Vec<[[f64; 3]; 2]> = parts.iter().map(Part::tangents_along).collect();
    for i in 0..tangents.len() {
        let next = tangents[(i + 1) % parts.len()][0];
        if norm(sub(next, tangents[i][1])) < SMOOTH {
            tangents[i][1] = next;
        }
    }
    tangents
}

/// Angle about a unit vector from one direction across it to another.
fn angle_about(axis: [f64; 3], from: [f64; 3], to: [f64; 3]) -> f64 {
    dot(to, cross(axis, from)).atan2(dot(to, from))
}

/// Components of a tangent that differ by less count as equal: rounding, and bends that count as straight, must
/// not decide between two axes.
const SAME_COMPONENT: f64 = 1e-6;

/// First frame axis U for a unit tangent: the coordinate axis with the smallest |component| (the
/// first of those within 1e-6 of each other), made perpendicular and unit. Both the pieces and the reference use it.
pub fn initial_normal(tangent: [f64; 3]) -> [f64; 3] {
    let mut smallest = 0;
    for i in 1..3 {
        if tangent[i].abs() < tangent[smallest].abs() - SAME_COMPONENT {
            smallest = i;
        }
    }
    let mut axis = [0.0; 3];
    axis[smallest] = 1.0;
    unit(along(axis, -tangent[smallest], tangent))
}

/// Vector operations on plain arrays.
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + s d`.
fn along(a: [f64; 3], s: f64, d: [f64; 3]) -> [f64; 3] {
    [a[0] + s * d[0], a[1] + s * d[1], a[2] + s * d[2]]
}

fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// `a` made unit; +z for the zero vector.
fn unit(a: [f64; 3]) -> [f64; 3] {
    let size = norm(a);
    if size > 0.0 { a.map(|x| x / size) } else { [0.0, 0.0, 1.0] }
}

/// The word `after` of a part that has a successor: 1 when they touch within 1e-9 of their size
/// (or 1e-9 units), 2 across a gap.
fn link(part: &Part, next: &Part) -> f32 {
    let gap = norm(sub(next.points_along()[0], part.points_along()[1]));
    let size = norm(part.b1) + norm(part.b2) + norm(next.b1) + norm(next.b2);
    if gap <= 1e-9 * (1.0 + size) { 1.0 } else { 2.0 }
}

/// Carry a normal from one tangent to the next by the smallest rotation; a half turn keeps it.
fn transport(normal: [f64; 3], from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    let closeness = 1.0 + dot(from, to);
    let sum = along(from, 1.0, to);
    let turned = if closeness < 1e-12 { normal } else { along(normal, -dot(normal, to) / closeness, sum) };
    // Take off what rounding left along the new tangent.
    unit(along(turned, -dot(turned, to), to))
}

fn held(segment: &Quadratic) -> Quadratic {
    let repair = |p: [f64; 3]| p.map(|x| if x.is_finite() { x.clamp(-1e8, 1e8) } else { 0.0 });
    Quadratic { a: repair(segment.a), b: repair(segment.b), c: repair(segment.c) }
}

/// A canonical piece in f64, before the frame is known.
struct Part {
    origin: [f64; 3],
    end: [f64; 3],
    b1: [f64; 3],
    b2: [f64; 3],
    bend: [f64; 3],
    t_start: f64,
    t_span: f64,
    reversed: bool,
    /// Constant speed within 1e-7.
    flat: bool,
    /// Speed zero at the start, hence straight.
    cusp: bool,
}

/// Where a part stands in its curve.
struct Place {
    /// U at the start of the canonical piece.
    normal: [f64; 3],
    /// Length of what comes before, and of the whole curve.
    offset: f64,
    length: f64,
    /// Where the part before leaves, and where this one is entered and left.
    tangents: [[f64; 3]; 3],
    /// The words `before` and `after`.
    neighbours: [f32; 2],
}

/// Canonical parts of all segments; one point if nothing else is left of a non-empty curve.
fn split_all(segments: &[Quadratic]) -> Vec<Part> {
    let extent = segments.iter().map(|s| norm(sub(s.b, s.a)) + norm(sub(s.c, s.b))).fold(0.0, f64::max);
    let shortest = (1e-10 * extent).max(1e-9);
    let share = 1.0 / segments.len().max(1) as f64;
    let mut parts = Vec::new();
    for (i, segment) in segments.iter().enumerate() {
        split(segment, i as f64 * share, share, shortest, &mut parts);
    }
    if let (true, Some(first)) = (parts.is_empty(), segments.first()) {
        parts.push(Part {
            origin: first.a,
            end: first.a,
            b1: [0.0; 3],
            b2: [0.0; 3],
            bend: [0.0; 3],
            t_start: 0.0,
            t_span: 0.0,
            reversed: false,
            flat: true,
            cusp: false,
        });
    }
    parts
}

/// Split one segment at its parabola vertex and append what is long enough.
fn split(segment: &Quadratic, t_first: f64, share: f64, shortest: f64, parts: &mut Vec<Part>) {
    let b1 = sub(segment.b, segment.a);
    let b2 = sub(sub(segment.c, segment.b), b1);
    if norm(b1) + norm(sub(segment.c, segment.b)) <= shortest {
        return;
    }
    let vertex = if dot(b2, b2) > 0.0 { -dot(b1, b2) / dot(b2, b2) } else { -1.0 };
    // A vertex within 1e-8 of an end is at the end.
    let cuts = if vertex > 1e-8 && vertex < 1.0 - 1e-8 { vec![0.0, vertex, 1.0] } else { vec![0.0, 1.0] };
    for range in cuts.windows(2) {
        let (t0, t1) = (range[0], range[1]);
        // The orientation comes from the vertex, never from the dot product recomputed at a cut.
        let reversed = 0.5 * (t0 + t1) < vertex;
        let (start, last) = if reversed { (t1, t0) } else { (t0, t1) };
        let h = last - start;
        let point = |t: f64| {
            // The very same point as that of the segment after.
            if t == 1.0 { segment.c } else { along(along(segment.a, 2.0 * t, b1), t * t, b2) }
        };
        let (origin, end) = (point(start), point(last));
        let part = Part {
            origin,
            end,
            b1: along(b1, start, b2).map(|x| x * h),
            b2: b2.map(|x| x * h * h),
            bend: cross(b1, b2).map(|x| x * h * h * h),
            t_start: t_first + share * start,
            t_span: share * h,
            reversed,
            flat: false,
            cusp: false,
        };
        if norm(part.b1) + norm(part.b2) > shortest {
            parts.push(part.classified());
        }
    }
}

impl Part {
    /// Decide flat and cusp, and make them exact.
    fn classified(mut self) -> Part {
        let (b11, a3) = (dot(self.b1, self.b1), dot(self.b2, self.b2));
        self.flat = a3 <= 1e-14 * b11;
        self.cusp = b11 <= 1e-16 * a3;
        if self.cusp {
            self.b1 = [0.0; 3];
        }
        if self.cusp || self.flat {
            self.bend = [0.0; 3];
        }
        self
    }

    fn sense(&self) -> f64 {
        if self.reversed { -1.0 } else { 1.0 }
    }

    /// Unit tangents along the curve where the curve enters and leaves the part.
    fn tangents_along(&self) -> [[f64; 3]; 2] {
        let at_start = unit(if self.cusp { self.b2 } else { self.b1 }).map(|x| x * self.sense());
        if self.flat || self.cusp {
            return [at_start; 2];
        }
        let at_end = unit(along(self.b1, 1.0, self.b2)).map(|x| x * self.sense());
        if self.reversed { [at_end, at_start] } else { [at_start, at_end] }
    }

    /// Length of the part: the closed form of `algorithms.md` §2.2 at t = 1, every term positive.
    fn length(&self) -> f64 {
        let (b11, a2, a3) = (dot(self.b1, self.b1), dot(self.b1, self.b2).max(0.0), dot(self.b2, self.b2));
        let speed0 = b11.sqrt();
        if self.flat {
            return 2.0 * speed0;
        }
        let q = a3.sqrt();
        let speed = (a3 + 2.0 * a2 + b11).sqrt();
        if self.cusp {
            return speed;
        }
        let rise = (a3 + 2.0 * a2) / (speed + speed0);
        let z = q * (q + rise) / (a2 + q * speed0);
        speed + a2 / a3 * rise + dot(self.bend, self.bend) / (a3 * q) * z.ln_1p()
    }

    /// Where the curve enters and leaves the part.
    fn points_along(&self) -> [[f64; 3]; 2] {
        if self.reversed { [self.end, self.origin] } else { [self.origin, self.end] }
    }

    /// Round to the table.
    fn piece(&self, place: &Place) -> Piece {
        let round = |v: [f64; 3]| v.map(|x| x as f32);
        let [tangent_before, enter, leave] = place.tangents;
        let [tangent, end_tangent] = if self.reversed { [leave, enter] } else { [enter, leave] };
        let (b11, a2, a3) = (dot(self.b1, self.b1), dot(self.b1, self.b2).max(0.0), dot(self.b2, self.b2));
        let q = if self.flat { 0.0 } else { a3.sqrt() };
        let (origin, origin_low) = split_digits(self.origin);
        let (end, end_low) = split_digits(self.end);
        let &Place { normal, offset, length, neighbours, .. } = place;
        let piece = Piece {
            origin,
            origin_low,
            b1: round(self.b1),
            b2: round(self.b2),
            tangent: round(tangent),
            normal: round(normal),
            binormal: round(cross(tangent, normal)),
            bend: round(self.bend),
            a3: a3 as f32,
            a2: a2 as f32,
            b11: b11 as f32,
            vertex: if self.flat { -1.0 } else { (-a2 / a3) as f32 },
            inv_a3: if self.flat { 0.0 } else { (1.0 / a3) as f32 },
            t_start: self.t_start as f32,
            t_span: self.t_span as f32,
            s_start: if self.reversed { offset + self.length() } else { offset } as f32,
            sense: self.sense() as f32,
            q: q as f32,
            log_scale: if self.flat { 0.0 } else { (dot(self.bend, self.bend) / (a3 * q)) as f32 },
            log_base: if self.flat || self.cusp { 1.0 } else { (a2 + q * b11.sqrt()) as f32 },
            straight: if self.flat || self.cusp { 1.0 } else { 0.0 },
            before: neighbours[0],
            after: neighbours[1],
            curve_length: length as f32,
            end,
            end_low,
            end_tangent: round(end_tangent),
            tangent_before: round(tangent_before),
            lo: [0.0; 3],
            hi: [0.0; 3],
        };
        let (lo, hi) = bounds::around(&piece);
        Piece { lo, hi, ..piece }
    }
}

/// A point rounded, and what rounding took from it.
fn split_digits(point: [f64; 3]) -> ([f32; 3], [f32; 3]) {
    let rounded = point.map(|x| x as f32);
    (rounded, std::array::from_fn(|i| (point[i] - f64::from(rounded[i])) as f32))
}

#[cfg(test)]
mod tests;
