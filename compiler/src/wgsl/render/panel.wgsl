// The panels of the corrected form: stretches of a ray between two places at which a medium is
// sampled, and how much matter is in each.
// Twin: runtime-cpu/src/render/panel.rs, which says why.

const WALL_ROUNDS: u32 = 3u;

// Distance of a node from the origin of its ray; all behind the end are at the end.
fn panel_node(node: i32, step_size: f32, end: f32) -> f32 {
    return min(node_distance(node, step_size, 0.0), end);
}

// Whether matter is cut off at each end of a panel after a node: at a wall, or at an end of the ray.
fn open_ends(node: i32, t: vec2f, own: f32, next: f32, step_size: f32) -> vec2<bool> {
    let is_last = t.y < node_distance(node + 1, step_size, 0.0);
    return vec2<bool>((own >= 0.0) | (node == 0), (next >= 0.0) | is_last);
}

// Signed distance of a medium's region at a node.
fn panel_region(ray: Ray, medium: u32, range: vec2i, node: i32, t: f32, step_size: f32) -> f32 {
    let some = range.x <= range.y;
    if (some & (node >= range.x) & (node <= (range.y + 1))) {
        let point = ray_at(ray, t);
        if (near_cell(medium, point, step_size)) {
            return medium_region(medium, point);
        }
    }
    return FAR;
}

// Finds the wall between two nodes, of which one is inside: distance along the ray and signed distance
// of each.
fn find_wall(ray: Ray, medium: u32, inside_node: vec2f, outside_node: vec2f) -> f32 {
    var inside = inside_node;
    var outside = outside_node;
    for (var round = 0u; round < WALL_ROUNDS; round++) {
        let t = wall_probe(inside, outside);
        let value = medium_region(medium, ray_at(ray, t));
        inside = select(inside, vec2f(t, value), value < 0.0);
        outside = select(vec2f(t, value), outside, value < 0.0);
    }
    return wall_probe(inside, outside);
}

// Where the signed distance would be 0 if it were linear between the two.
fn wall_probe(inside: vec2f, outside: vec2f) -> f32 {
    return inside.x + ((outside.x - inside.x) * (inside.y / (inside.y - outside.y)));
}

// Integral of the positive part of a density over a stretch of a panel as long as a step, by its values at
// both ends: what each end stands for. An open end is one where matter is cut off.
fn panel_masses(step_size: f32, length: f32, ends: vec2f, open: vec2<bool>) -> vec2f {
    let half = 0.5 * length;
    let above = max(ends.x, ends.y);
    let below = min(ends.x, ends.y);
    let changes = (above > 0.0) & (below < 0.0);
    let densities = max(ends, vec2f(0.0));
    // What the panels up to the node miss: it is given to the node.
    let rise = select(densities.x - densities.y, densities.y - densities.x, open.x);
    let part = step_size / max(length, 0.25 * step_size);
    let most = 0.5 * (half * (densities.x + densities.y));
    let missed = max(min(((1.0f / 12.0f) * step_size) * (part * rise), most), -most);
    let given = select(vec2f(missed, 0.0), vec2f(0.0, missed), open.x);
    let plain = max((half * densities) + select(given, vec2f(0.0), open.x == open.y), vec2f(0.0));
    let fall = select(1.0, above - below, changes);
    let mass = (half * (above * (above / fall))) + (length * (fall * (1.0f / 12.0f)));
    let cut = select(vec2f(0.0, mass), vec2f(mass, 0.0), ends.x > 0.0);
    return select(plain, cut, changes);
}
