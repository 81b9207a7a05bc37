// Closest point on a curve of canonical pieces in f32, the same text as
// `runtime-cpu/src/math/curve.rs`, where ranges, errors and sources stand. Needs `fun.wgsl`, the number of curves
// VOL_CURVES and `vol_curve_word(index: u32) -> f32`; the words of a piece are those of `vol_compiler::curve::Piece`.

const VOL_PIECE_WORDS: u32 = 60u;
// Below this a divisor counts as it: quotients stay finite.
const VOL_TINY: f32 = 1e-30;
// Distance to a curve without pieces, scene units.
const VOL_FAR: f32 = 1e18;
// Points farther out are held here, scene units.
const VOL_REACH: f32 = 1e8;
// Largest stretch reported.
const VOL_STRETCH: f32 = 1e6;

// By how much a squared distance is taken larger before boxes are compared with it: more than the kernels are off far from
// the curve.
const VOL_LOOSE: f32 = 1.00001;
// What they are off near it, over the length of the curve, several times.
const VOL_SLACK: f32 = 4e-6;

// A foot at an end is held there if its offset leans along the tangent by more than this share.
const VOL_LEAN: f32 = 1e-3;
// Where the stretch is smaller, a foot is taken to slide as if it were this.
const VOL_LEAST_STRETCH: f32 = 0.05;
// Largest change of t per length reported.
const VOL_LARGEST_RATE: f32 = 1e15;

// A point seen from its closest point on a curve.
struct VolCurvePoint {
    t: f32,
    arc_length: f32,
    curve_length: f32,
    x: f32,
    y: f32,
    distance: f32,
    overshoot: f32,
    stretch: f32,
}

// Closest point of one piece.
struct VolFoot {
    t: f32,
    dist_sq: f32,
}

fn vol_dot(a: vec3f, b: vec3f) -> f32 {
    return ((a.x * b.x) + (a.y * b.y)) + (a.z * b.z);
}

fn vol_cross(a: vec3f, b: vec3f) -> vec3f {
    return vec3f((a.y * b.z) - (a.z * b.y), (a.z * b.x) - (a.x * b.z), (a.x * b.y) - (a.y * b.x));
}

// Three words of the curve buffer.
fn vol_curve_vector(word: u32) -> vec3f {
    return vec3f(vol_curve_word(word), vol_curve_word(word + 1u), vol_curve_word(word + 2u));
}

// A point held within +-1e8 units, where no product below overflows.
fn vol_held_point(p: vec3f) -> vec3f {
    return vec3f(
        vol_hold(p.x, -VOL_REACH, VOL_REACH),
        vol_hold(p.y, -VOL_REACH, VOL_REACH),
        vol_hold(p.z, -VOL_REACH, VOL_REACH),
    );
}

// Start of the piece seen from `p`; the low part keeps it exact far from the scene origin.
fn vol_from_point(p: vec3f, word: u32) -> vec3f {
    return (vol_curve_vector(word) - p) + vol_curve_vector(word + 3u);
}

// `Q(t) - p`.
fn vol_reach(w: vec3f, b1: vec3f, b2: vec3f, t: f32) -> vec3f {
    return w + (t * ((2.0 * b1) + (t * b2)));
}

// The end of a piece at t = 1 seen from `p`.
fn vol_end_from_point(p: vec3f, word: u32) -> vec3f {
    return (vol_curve_vector(word + 40u) - p) + vol_curve_vector(word + 43u);
}

// `Q(t) - p` from the nearer end of the piece, which halves what rounding takes.
fn vol_offset_at(p: vec3f, word: u32, b1: vec3f, b2: vec3f, t: f32) -> vec3f {
    let start = vol_reach(vol_from_point(p, word), b1, b2, t);
    let back = 1.0 - t;
    let before = vol_end_from_point(p, word) - (back * ((2.0 * (b1 + b2)) - (back * b2)));
    return select(start, before, t > 0.5);
}

// Start for the cube root of `x >= 0`, a few per cent off.
fn vol_rough_cube_root(x: f32) -> f32 {
    return bitcast<f32>((bitcast<u32>(x) / 3u) + 709921077u);
}

// The foot inside a canonical piece, if it has one, and what decides between it and the start.
struct VolInner {
    t: f32,
    dist_sq: f32,
    start_is_least: bool,
    start_sq: f32,
    dips: bool,
}

// Closest point of one canonical piece, given by its first word.
fn vol_foot(p: vec3f, word: u32) -> VolFoot {
    let inner = vol_inner(p, word);
    // Prefer the start where it is itself a minimum and nearer.
    let start_wins = inner.start_is_least & (inner.start_sq <= inner.dist_sq);
    return VolFoot(select(inner.t, 0.0, start_wins), select(inner.dist_sq, inner.start_sq, start_wins));
}

// The largest root of g.
fn vol_inner(p: vec3f, word: u32) -> VolInner {
    let b1 = vol_curve_vector(word + 6u);
    let b2 = vol_curve_vector(word + 9u);
    let vertex = vol_curve_word(word + 27u);
    let inv_a3 = vol_curve_word(word + 28u);
    // Coefficients of g = a3 t^3 + 3 a2 t^2 + a1 t + a0.
    let w = vol_from_point(p, word);
    let a3 = vol_curve_word(word + 24u);
    let a2x3 = 3.0 * vol_curve_word(word + 25u);
    let a1 = (2.0 * vol_curve_word(word + 26u)) + vol_dot(w, b2);
    let a0 = vol_dot(w, b1);
    // Move to the larger extremum e, or to the vertex where g has none.
    let slope = (a1 + (a2x3 * vertex)) * inv_a3;
    let half_gap = sqrt(max((-slope) * 0.33333334, 0.0));
    let m = max(slope, 0.0);
    let e = vertex + half_gap;
    let at_e = ((((((a3 * e) + a2x3) * e) + a1) * e) + a0) * inv_a3;
    let k = max(-at_e, 0.0);
    let gap3 = 3.0 * half_gap;
    // Guess the root of u^3 + gap3 u^2 + m u = k by its largest term.
    let tiny = (1e-12 * k) + VOL_TINY;
    let by_square = sqrt(k / max(gap3, tiny));
    let by_line = k / max(m, tiny);
    let u0 = min(min(vol_rough_cube_root(k), by_square), by_line);
    // Two Newton steps.
    let u1 = vol_depressed_step(u0, gap3, m, k);
    let u2 = vol_depressed_step(u1, gap3, m, k);
    // Return to t; a flat piece starts in the middle.
    let is_flat = inv_a3 == 0.0;
    let low = select(vol_hold(e, 0.0, 1.0), 0.0, is_flat);
    let t0 = select(vol_hold(e + u2, low, 1.0), 0.5, is_flat);
    // Two polishing steps on g.
    let t1 = vol_polish_step(t0, a3, a2x3, a1, a0, low);
    let t2 = vol_polish_step(t1, a3, a2x3, a1, a0, low);
    let end = vol_reach(w, b1, b2, t2);
    let dips = ((!is_flat) & (k > 0.0)) & ((e > 0.0) & (e < 1.0));
    let start_is_least = (a0 > 0.0) | ((a0 == 0.0) & (a1 >= 0.0));
    return VolInner(t2, vol_dot(end, end), start_is_least, vol_dot(w, w), dips);
}

// One Newton step on `u^3 + gap3 u^2 + m u = k`, u >= 0.
fn vol_depressed_step(u: f32, gap3: f32, m: f32, k: f32) -> f32 {
    let value = ((((u + gap3) * u) + m) * u) - k;
    let slope = (((3.0 * u) + (2.0 * gap3)) * u) + m;
    return max(u - (value / max(slope, VOL_TINY)), 0.0);
}

// One Newton step on g, held within `low..=1`.
fn vol_polish_step(t: f32, a3: f32, a2x3: f32, a1: f32, a0: f32, low: f32) -> f32 {
    let value = (((((a3 * t) + a2x3) * t) + a1) * t) + a0;
    let slope = ((((3.0 * a3) * t) + (2.0 * a2x3)) * t) + a1;
    return vol_hold(t - (value / max(slope, VOL_TINY)), low, 1.0);
}

// Whether `t` is where the curve enters the piece, within 3e-8.
fn vol_at_first(word: u32, t: f32) -> bool {
    return (vol_curve_word(word + 32u) * (t - 0.5)) <= -0.5;
}

// Whether `t` is where the curve leaves the piece, within 3e-8.
fn vol_at_last(word: u32, t: f32) -> bool {
    return (vol_curve_word(word + 32u) * (t - 0.5)) >= 0.5;
}

// Closest point of the pieces visited so far.
struct VolSearch {
    dist_sq: f32,
    t: f32,
    piece: u32,
    left_at_last: bool,
}

// Visit the next piece along the curve; at a joint one of the two feet is redundant.
fn vol_visit(before: VolSearch, p: vec3f, word: u32, index: u32) -> VolSearch {
    let found = vol_foot(p, word);
    let leaves = vol_at_last(word, found.t);
    let defers = leaves & (vol_curve_word(word + 38u) == 1.0);
    let redundant = (vol_at_first(word, found.t) & (vol_curve_word(word + 37u) == 1.0)) & (!before.left_at_last);
    let wins = ((found.dist_sq < before.dist_sq) & (!defers)) & (!redundant);
    return VolSearch(
        select(before.dist_sq, found.dist_sq, wins),
        select(before.t, found.t, wins),
        select(before.piece, index, wins),
        leaves,
    );
}

// Length of a piece from t = 0 to `t`, scene units; every term is positive.
fn vol_length_to(word: u32, t: f32) -> f32 {
    let a3 = vol_curve_word(word + 24u);
    let b11 = vol_curve_word(word + 26u);
    let q = vol_curve_word(word + 33u);
    // Half speed at both ends and its rise.
    let rate = (a3 * t) + (2.0 * vol_curve_word(word + 25u));
    let speed0 = sqrt(b11);
    let speed = sqrt((rate * t) + b11);
    let rise = (t * rate) / max(speed + speed0, VOL_TINY);
    // The logarithm: a series for small z, else log2.
    let z = (q * ((q * t) + rise)) / vol_curve_word(word + 35u);
    let y = z / (2.0 + z);
    let yy = y * y;
    let s3 = 0.14285715 + (yy * 0.11111111);
    let s2 = 0.2 + (yy * s3);
    let s1 = 0.33333334 + (yy * s2);
    let series = (2.0 * y) * (1.0 + (yy * s1));
    let logarithm = vol_log2(1.0 + z) * VOL_LN_2;
    let log_term = select(logarithm, series, z < 0.414);
    // Add the terms.
    let bent = (t * speed) + (((-vol_curve_word(word + 27u)) * rise) + (vol_curve_word(word + 34u) * log_term));
    return select(bent, (2.0 * speed0) * t, vol_curve_word(word + 28u) == 0.0);
}

// Coordinates of `p` about the point `t` of a piece.
fn vol_describe(p: vec3f, word: u32, t: f32) -> VolCurvePoint {
    let b1 = vol_curve_vector(word + 6u);
    let b2 = vol_curve_vector(word + 9u);
    let t0 = vol_curve_vector(word + 12u);
    let normal = vol_curve_vector(word + 15u);
    let binormal = vol_curve_vector(word + 18u);
    let bend = vol_curve_vector(word + 21u);
    let t_span = vol_curve_word(word + 30u);
    let sense = vol_curve_word(word + 32u);
    let curve_length = vol_curve_word(word + 39u);
    // Offset and half velocity at the foot.
    let r = vol_offset_at(p, word, b1, b2, t);
    let v = b1 + (t * b2);
    let vv = max(vol_dot(v, v), VOL_TINY);
    // Unit tangent along the curve.
    let is_straight = vol_curve_word(word + 36u) != 0.0;
    let per_speed = sense / sqrt(vv);
    let tangent = select(v * per_speed, t0, is_straight);
    // Coordinates in the carried frame.
    let sum = t0 + tangent;
    let turn = vol_dot(r, sum) / vol_dot(t0, sum);
    let x = (vol_dot(normal, tangent) * turn) - vol_dot(r, normal);
    let y = (vol_dot(binormal, tangent) * turn) - vol_dot(r, binormal);
    // How far beyond an end of the whole curve; a point has both ends in one place.
    let ahead = -vol_dot(r, tangent);
    let starts = vol_at_first(word, t) & (vol_curve_word(word + 37u) == 0.0);
    let ends = (vol_at_last(word, t) | (t_span == 0.0)) & (vol_curve_word(word + 38u) == 0.0);
    let behind_first = select(0.0, -ahead, starts);
    let beyond_last = select(0.0, ahead, ends);
    // Stretch of volume by the bend.
    let bent = vol_dot(r, vol_cross(bend, v)) / vv;
    let stretch = 1.0 + (bent / (2.0 * vv));
    let s = vol_curve_word(word + 31u) + (sense * vol_length_to(word, t));
    return VolCurvePoint(
        vol_hold(vol_curve_word(word + 29u) + (t_span * t), 0.0, 1.0),
        vol_hold(s, 0.0, curve_length),
        curve_length,
        x,
        y,
        sqrt(vol_dot(r, r)),
        max(max(behind_first, beyond_last), 0.0),
        vol_hold(stretch, 0.0, VOL_STRETCH),
    );
}

// How the closest point moves with the position.
struct VolCurveSlopes {
    direction: vec3f,
    tangent: vec3f,
    rate: f32,
    slide: f32,
}

// How the foot of `p` at the point `t` of a piece moves.
fn vol_slopes(p: vec3f, word: u32, t: f32) -> VolCurveSlopes {
    let b1 = vol_curve_vector(word + 6u);
    let b2 = vol_curve_vector(word + 9u);
    let t0 = vol_curve_vector(word + 12u);
    let bend = vol_curve_vector(word + 21u);
    let t_span = vol_curve_word(word + 30u);
    // Offset and half velocity at the foot.
    let w = vol_from_point(p, word);
    let r = vol_reach(w, b1, b2, t);
    let v = b1 + (t * b2);
    let vv = max(vol_dot(v, v), VOL_TINY);
    // Unit tangent along the curve.
    let is_straight = vol_curve_word(word + 36u) != 0.0;
    let speed = sqrt(vv);
    let per_speed = vol_curve_word(word + 32u) / speed;
    let tangent = select(v * per_speed, t0, is_straight);
    // Unit offset.
    let distance = sqrt(vol_dot(r, r));
    let per_distance = select(0.0, -1.0 / max(distance, VOL_TINY), distance > 0.0);
    // How far the foot slides: not at all where it is held.
    let at_end = (t == 0.0) | (t == 1.0);
    let held = at_end & (abs(vol_dot(r, tangent)) > (VOL_LEAN * distance));
    let bent = vol_dot(r, vol_cross(bend, v)) / vv;
    let stretch = max(1.0 + (bent / (2.0 * vv)), VOL_LEAST_STRETCH);
    return VolCurveSlopes(
        r * per_distance,
        tangent,
        min(abs(t_span) / (2.0 * speed), VOL_LARGEST_RATE),
        select(1.0 / stretch, 0.0, held | (t_span == 0.0)),
    );
}

// Where a curve is: pieces `first .. first + count` of the buffer; `number` among all curves.
struct VolCurve {
    first: u32,
    count: u32,
    number: u32,
}

// The last search on a curve, from which the next one is most often near.
struct VolLastSearch {
    some: bool,
    point: vec3f,
    found: VolSearch,
    // Distance of the foot at most.
    reach: f32,
}

var<private> vol_last_search: array<VolLastSearch, VOL_CURVES>;

// Squared distance from a point to the box around a piece; 0 inside.
fn vol_box_dist_sq(p: vec3f, word: u32) -> f32 {
    let below = vol_curve_vector(word + 52u) - p;
    let above = p - vol_curve_vector(word + 55u);
    let x = max(max(below.x, above.x), 0.0);
    let y = max(max(below.y, above.y), 0.0);
    let z = max(max(below.z, above.z), 0.0);
    return ((x * x) + (y * y)) + (z * z);
}

// The closest point of a curve, from `vol_held_point`, as if every piece were visited: one that is passed over is in a box
// farther away than the winner can be. That is at most as far away as the last foot, which the point has moved away from.
fn vol_search(p: vec3f, curve: VolCurve) -> VolSearch {
    let last = vol_last_search[curve.number];
    if (last.some & all(last.point == p)) {
        return last.found;
    }
    let way = p - last.point;
    let reach = last.reach + sqrt(vol_dot(way, way));
    let bound = select(VOL_LARGEST, (reach * reach) * VOL_LOOSE, last.some);
    // Visit the pieces along the curve.
    var search = VolSearch(VOL_LARGEST, 0.0, 0u, false);
    for (var index = 0u; index < curve.count; index = index + 1u) {
        let word = (curve.first + index) * VOL_PIECE_WORDS;
        if (vol_box_dist_sq(p, word) <= bound) {
            search = vol_visit(search, p, word, index);
        }
    }
    let slack = VOL_SLACK * vol_curve_word((curve.first * VOL_PIECE_WORDS) + 39u);
    vol_last_search[curve.number] = VolLastSearch(true, p, search, sqrt(search.dist_sq) + slack);
    return search;
}

// How the closest point of a whole curve moves.
fn vol_closest_gradient(point: vec3f, curve: VolCurve) -> VolCurveSlopes {
    let p = vol_held_point(point);
    let search = vol_search(p, curve);
    // Describe how the foot moves on the winner.
    if (curve.count == 0u) {
        return VolCurveSlopes(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 0.0, 1.0), 0.0, 0.0);
    }
    return vol_slopes(p, (curve.first + search.piece) * VOL_PIECE_WORDS, search.t);
}

// Closest point of a whole curve.
fn vol_closest(point: vec3f, curve: VolCurve) -> VolCurvePoint {
    let p = vol_held_point(point);
    let search = vol_search(p, curve);
    // Describe the foot on the winner.
    if (curve.count == 0u) {
        return VolCurvePoint(0.0, 0.0, 0.0, VOL_FAR, 0.0, VOL_FAR, 0.0, 1.0);
    }
    return vol_describe(p, (curve.first + search.piece) * VOL_PIECE_WORDS, search.t);
}
