// All feet of a point on a curve, one after the other, the same text as
// `runtime-cpu/src/math/curve/feet.rs`, where the rules and sources stand. Needs `curve.wgsl`.

// Feet that a piece may have.
const VOL_FEET: u32 = 3u;

// A foot and where to look for the next.
struct VolNextFoot {
    next: f32,
    t: f32,
    arc_length: f32,
    x: f32,
    y: f32,
    distance: f32,
    overshoot: f32,
    stretch: f32,
}

// Where a piece has feet: parameters in the order of the curve, -1 for none.
fn vol_feet_of(p: vec3f, word: u32, closed: bool) -> vec3f {
    // How the distance grows along the curve at both ends of the piece.
    let w = vol_from_point(p, word);
    let w_end = vol_end_from_point(p, word);
    let at_start = vol_dot(w, vol_curve_vector(word + 12u));
    let at_end = vol_dot(w_end, vol_curve_vector(word + 46u));
    let sense = vol_curve_word(word + 32u);
    let forward = sense > 0.0;
    let entering = select(at_end, at_start, forward);
    let leaving = select(at_start, at_end, forward);
    let before = vol_dot(select(w_end, w, forward), vol_curve_vector(word + 49u));
    // The joint at its start, and the end of the curve.
    let link_before = vol_curve_word(word + 37u);
    let link_after = vol_curve_word(word + 38u);
    let joined_before = (link_before == 1.0) | (closed & (link_before == 0.0));
    let joined_after = (link_after == 1.0) | (closed & (link_after == 0.0));
    let is_point = vol_curve_word(word + 30u) == 0.0;
    let enters = is_point | ((entering >= 0.0) & ((!joined_before) | (before <= 0.0)));
    let leaves = ((!is_point) & (!joined_after)) & (leaving <= 0.0);
    // Inside.
    let found = vol_inner(p, word);
    let approached = (sense * at_start) < 0.0;
    let left = (sense * at_end) > 0.0;
    let inside = ((!is_point) & left) & (approached | found.dips);
    return vec3f(
        select(-1.0, select(1.0, 0.0, forward), enters),
        select(-1.0, found.t, inside),
        select(-1.0, select(0.0, 1.0, forward), leaves),
    );
}

// Distance of a foot; farther than any bound where the parameter is -1, for none.
fn vol_foot_distance(p: vec3f, word: u32, t: f32) -> f32 {
    let r = vol_offset_at(p, word, vol_curve_vector(word + 6u), vol_curve_vector(word + 9u), max(t, 0.0));
    return select(sqrt(vol_dot(r, r)), VOL_LARGEST, t < 0.0);
}

// The first foot whose number is at least `start` and whose distance is at most `most`. Every point visits
// the same piece at the same time.
fn vol_next_foot(point: vec3f, start: f32, most: f32, joined: f32, curve: VolCurve) -> VolNextFoot {
    let p = vol_held_point(point);
    let number_from = u32(start);
    let closed = joined != 0.0;
    var winner = 0u;
    var number = 0u;
    var t = -1.0;
    for (var index = 0u; index < curve.count; index = index + 1u) {
        // The first foot of the piece that is near enough.
        let piece = (curve.first + index) * VOL_PIECE_WORDS;
        let first = index * VOL_FEET;
        let feet = vol_feet_of(p, piece, closed);
        let a = (vol_foot_distance(p, piece, feet.x) <= most) & (first >= number_from);
        let b = (vol_foot_distance(p, piece, feet.y) <= most) & ((first + 1u) >= number_from);
        let c = (vol_foot_distance(p, piece, feet.z) <= most) & ((first + 2u) >= number_from);
        let found = (t < 0.0) & ((a | b) | c);
        t = select(t, select(select(feet.z, feet.y, b), feet.x, a), found);
        number = select(number, first + select(select(2u, 1u, b), 0u, a), found);
        winner = select(winner, index, found);
    }
    if (t < 0.0) {
        return VolNextFoot(start, 0.0, 0.0, 0.0, 0.0, VOL_FAR, 0.0, 1.0);
    }
    // Describe it.
    let found = vol_describe(p, (curve.first + winner) * VOL_PIECE_WORDS, t);
    return VolNextFoot(
        f32(number + 1u),
        found.t,
        found.arc_length,
        found.x,
        found.y,
        found.distance,
        found.overshoot,
        found.stretch,
    );
}
