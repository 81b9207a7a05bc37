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
    let sense = vol_curves[word + 32u];
    let forward = sense > 0.0;
    let entering = select(at_end, at_start, forward);
    let leaving = select(at_start, at_end, forward);
    let before = vol_dot(select(w_end, w, forward), vol_curve_vector(word + 49u));
    // The joint at its start, and the end of the curve.
    let link_before = vol_curves[word + 37u];
    let link_after = vol_curves[word + 38u];
    let joined_before = (link_before == 1.0) | (closed & (link_before == 0.0));
    let joined_after = (link_after == 1.0) | (closed & (link_after == 0.0));
    let is_point = vol_curves[word + 30u] == 0.0;
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

// The first foot whose number is at least `start` and whose distance is at most `most`.
fn vol_next_foot(point: vec3f, start: f32, most: f32, joined: f32, curve: VolCurve) -> VolNextFoot {
    let p = vol_held_point(point);
    let bound = vol_bound_of(most * most);
    let number_from = u32(start);
    let closed = joined != 0.0;
    let few = curve.node_count == 0u;
    let node_count = select(curve.node_count, 1u, few);
    // Pass over boxes that are too far or behind.
    var at = 0u;
    while (at < node_count) {
        let word = curve.nodes + (at * VOL_NODE_WORDS);
        var skip = 1u;
        var first = 0u;
        var end = curve.count;
        var far = false;
        if (!few) {
            skip = u32(vol_curves[word + 6u]);
            first = u32(vol_curves[word + 7u]);
            end = u32(vol_curves[word + 8u]);
            far = vol_box_dist_sq(p, word) > bound;
        }
        if (far | ((end * VOL_FEET) <= number_from)) {
            at = skip;
            continue;
        }
        if (skip == at + 1u) {
            // Describe the first foot that is near enough.
            for (var index = first; index < end; index = index + 1u) {
                let piece = (curve.first + index) * VOL_PIECE_WORDS;
                let feet = vol_feet_of(p, piece, closed);
                for (var kind = 0u; kind < VOL_FEET; kind = kind + 1u) {
                    let number = (index * VOL_FEET) + kind;
                    if ((feet[kind] < 0.0) | (number < number_from)) {
                        continue;
                    }
                    let at_foot = vol_describe(p, piece, feet[kind]);
                    if (at_foot.distance <= most) {
                        return VolNextFoot(
                            f32(number + 1u),
                            at_foot.t,
                            at_foot.arc_length,
                            at_foot.x,
                            at_foot.y,
                            at_foot.distance,
                            at_foot.overshoot,
                            at_foot.stretch,
                        );
                    }
                }
            }
        }
        at = at + 1u;
    }
    return VolNextFoot(start, 0.0, 0.0, 0.0, 0.0, VOL_FAR, 0.0, 1.0);
}
