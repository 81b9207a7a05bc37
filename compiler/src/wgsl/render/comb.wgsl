// The samples of media along a ray, and the length of ray that each stands for.
// Twin: runtime-cpu/src/render/comb.rs, which says why.

struct Comb {
    step: f32,
    // Where node 0 is, in steps.
    offset: f32,
    end: f32,
    // Nodes that may be inside some medium.
    first: i32,
    last: i32,
    // The same for each medium.
    ranges: array<vec2i, MEDIUM_SLOTS>,
    // Signed distances of each medium at the node before and at the next one.
    before: array<f32, MEDIUM_SLOTS>,
    own: array<f32, MEDIUM_SLOTS>,
}

// Where node 0 is, in steps. Panels begin at the origin, so there it is at or before it.
fn first_node(shift: f32) -> f32 {
    return select(0.5 + shift, select(shift, shift - 1.0, shift > 0.0), CORRECTED);
}

fn node_distance(node: i32, step_size: f32, offset: f32) -> f32 {
    return (f32(node) + offset) * step_size;
}

fn medium_word(medium: u32) -> u32 {
    return AT_MEDIA + (MEDIUM_WORDS * medium);
}

// Nodes that may be inside a medium. The box is grown by a step, so that the neighbours of a node
// inside are in the range or next to it, and so are the panels on both sides.
fn node_range(ray: Ray, medium: u32, step_size: f32, offset: f32, end: f32) -> vec2i {
    let at = medium_word(medium);
    let reach = vec3f(1.01 * step_size);
    let span = slab(ray, word3(at + 1u) - reach, word3(at + 4u) + reach);
    let leave = min(span.leave, end);
    // Node numbers stay where f32 knows them and a half.
    let first = min(max(floor((span.entry / step_size) - offset), 0.0), LAST_NODE);
    let last = min(floor((max(leave, 0.0) / step_size) - offset), LAST_NODE);
    let none = (span.entry > leave) | (vol_frame_word(at) == 0.0);
    return select(vec2i(i32(first), i32(last)), vec2i(0, -1), none);
}

// Smallest range that holds both.
fn range_union(a: vec2i, b: vec2i) -> vec2i {
    let both = vec2i(min(a.x, b.x), max(a.y, b.y));
    return select(select(both, a, b.x > b.y), b, a.x > a.y);
}

// Lays out the nodes of the ray up to its end.
fn new_comb(ray: Ray, end: f32, step_size: f32) -> Comb {
    var comb: Comb;
    comb.step = step_size;
    comb.end = end;
    let offset = first_node(ray.shift);
    comb.offset = offset;
    var whole = vec2i(0, -1);
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let range = node_range(ray, medium, step_size, offset, end);
        comb.ranges[medium] = range;
        whole = range_union(whole, range);
    }
    comb.first = whole.x;
    comb.last = min(whole.y, whole.x + (MAX_NODES - 1));
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        comb.before[medium] = FAR;
        comb.own[medium] = FAR;
    }
    return comb;
}

// Signed distance of a node at a distance t from the nearest of: the medium's wall, the ray's two ends.
fn wall(ray: Ray, medium: u32, range: vec2i, t: f32, node: i32, step_size: f32, end: f32) -> f32 {
    var region = FAR;
    let some = range.x <= range.y;
    if (some & (node >= (range.x - 1)) & (node <= (range.y + 1))) {
        let point = ray_at(ray, t);
        // What is not within a step of a cell is outside, and so are its neighbours.
        if (near_cell(medium, point, step_size)) {
            region = medium_region(medium, point);
        }
    }
    return max(region, max(t - end, -t));
}

// Whether a point is within a step of a cell of a medium; a medium without cells may be anywhere.
fn near_cell(medium: u32, point: vec3f, step_size: f32) -> bool {
    let at = medium_word(medium);
    let count = u32(vol_frame_word(at + 8u));
    let reach = vec3f(1.01 * step_size);
    var near = count == 0u;
    var cell = u32(vol_frame_word(at + 7u));
    for (var index = 0u; index < count; index++) {
        let lo = input3(cell) - reach;
        let hi = input3(cell + 3u) + reach;
        near = near | contains(lo, hi, point);
        cell += CELL_WORDS;
    }
    return near;
}

// Part of the interval between two neighbouring nodes that the first stands for, given the signed
// distances of both.
fn share(own: f32, other: f32, step_size: f32) -> f32 {
    let divisor = select(-1.0, own - other, own < other);
    let part = step_size * (own / divisor);
    return select(part, 0.5 * step_size, other < 0.0);
}

// The length of ray that a node stands for in each medium, and whether any is not 0. Nodes must
// come in order, from two before the first one: so that regions are asked at one place of the text,
// since drivers write them out at each.
fn weigh(ray: Ray, comb: ptr<function, Comb>, node: i32, weights: ptr<function, array<f32, MEDIUM_SLOTS>>) -> bool {
    var any_inside = false;
    let step_size = (*comb).step;
    let t = node_distance(node + 1, step_size, (*comb).offset);
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let before = (*comb).before[medium];
        let own = (*comb).own[medium];
        let after = wall(ray, medium, (*comb).ranges[medium], t, node + 1, step_size, (*comb).end);
        let weight = share(own, before, step_size) + share(own, after, step_size);
        let is_inside = (own < 0.0) & (node >= (*comb).first);
        (*weights)[medium] = select(0.0, weight, is_inside);
        any_inside = any_inside | is_inside;
        (*comb).before[medium] = own;
        (*comb).own[medium] = after;
    }
    return any_inside;
}
