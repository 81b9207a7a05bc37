// The panels of the corrected form: stretches of a ray between two places at which a medium is
// sampled, and how much matter is in each.
// Twin: runtime-cpu/src/render/panel.rs, which says why.

const WALL_ROUNDS: u32 = 5u;

// Distance of a node from the origin of its ray: at least there, and at most at the end.
fn panel_node(comb: ptr<function, Comb>, node: i32) -> f32 {
    return min(max(node_distance(node, (*comb).step, (*comb).offset), 0.0), (*comb).end);
}

// Whether matter is cut off at each end of a panel after a node: at a wall, or at an end of the ray.
fn open_ends(comb: ptr<function, Comb>, node: i32, t: vec2f, own: f32, next: f32) -> vec2<bool> {
    let is_last = t.y < node_distance(node + 1, (*comb).step, (*comb).offset);
    return vec2<bool>((own >= 0.0) | (node == 0), (next >= 0.0) | is_last);
}

// Two places of which one is inside: distance along the ray and signed distance of each.
struct Crossing {
    inside: vec2f,
    outside: vec2f,
    // Which of them was found last: 0 none, 1 the one inside, 2 the other.
    moved: u32,
}

// Where the signed distance would be 0 if it were linear between the two.
fn crossing_probe(crossing: Crossing) -> f32 {
    let inside = crossing.inside;
    let outside = crossing.outside;
    return inside.x + ((outside.x - inside.x) * (inside.y / (inside.y - outside.y)));
}

// Takes the signed distance at the probe into account.
fn crossing_narrowed(crossing: Crossing, found: vec2f) -> Crossing {
    if (found.y < 0.0) {
        let kept = vec2f(crossing.outside.x, select(crossing.outside.y, 0.5 * crossing.outside.y, crossing.moved == 1u));
        return Crossing(found, kept, 1u);
    }
    let kept = vec2f(crossing.inside.x, select(crossing.inside.y, 0.5 * crossing.inside.y, crossing.moved == 2u));
    return Crossing(kept, found, 2u);
}

// What is probed.
const THE_NODE: u32 = 0u;
const A_GAP: u32 = 1u;
const A_WALL: u32 = 2u;
const NO_MORE: u32 = 3u;

// The region of a medium between two nodes.
struct Between {
    // Signed distance at the node after.
    next: f32,
    // The first and the last wall: there are none, one, or two around a chord.
    walls: vec2f,
    count: u32,
}

// Looks for the node after one at a distance t.x, and for walls between the two. The region is asked at one place of
// the text, since drivers write it out at each.
fn find_walls(ray: Ray, medium: u32, comb: ptr<function, Comb>, node: i32, t: vec2f) -> Between {
    let own = (*comb).own[medium];
    let run = (*comb).runs[medium];
    let known = ((node + 1) >= run.x) & (node <= run.y);
    var between = Between(FAR, vec2f(0.0), 0u);
    var gap: Gap;
    var crossing: Crossing;
    var other: Crossing;
    var wanted = 0u;
    var aim = THE_NODE;
    var round = 0u;
    while (aim != NO_MORE) {
        // Ask.
        var probe = t.y;
        if (aim == A_GAP) {
            probe = gap_probe(gap, round);
        } else if (aim == A_WALL) {
            probe = crossing_probe(crossing);
        }
        let point = ray_at(ray, probe);
        var value = FAR;
        if ((aim != THE_NODE) || known) {
            value = medium_region(medium, point);
        }
        let found = vec2f(probe, value);
        round += 1u;
        // Decide what to ask next.
        if (aim == THE_NODE) {
            between.next = value;
            let start = vec2f(t.x, own);
            round = 0u;
            aim = NO_MORE;
            if ((node >= (*comb).first) & (t.x < t.y)) {
                if ((own < 0.0) != (value < 0.0)) {
                    crossing = Crossing(select(found, start, own < 0.0), select(start, found, own < 0.0), 0u);
                    wanted = 1u;
                    aim = A_WALL;
                } else {
                    gap = Gap(start, found);
                    let may_enter = (own >= 0.0) & (gap_room(gap) > 0.0);
                    aim = select(NO_MORE, A_GAP, may_enter);
                }
            }
        } else if (aim == A_GAP) {
            if (value < 0.0) {
                crossing = Crossing(found, gap.start, 0u);
                other = Crossing(found, gap.stop, 0u);
                wanted = 2u;
                aim = A_WALL;
                round = 0u;
            } else {
                gap = gap_narrowed(gap, found);
                aim = select(NO_MORE, A_GAP, (round < CHORD_ROUNDS) & (gap_room(gap) > 0.0));
            }
        } else {
            crossing = crossing_narrowed(crossing, found);
            if (round == WALL_ROUNDS) {
                let wall = crossing_probe(crossing);
                between.walls = select(vec2f(between.walls.x, wall), vec2f(wall), between.count == 0u);
                between.count += 1u;
                crossing = other;
                aim = select(NO_MORE, A_WALL, between.count < wanted);
                round = 0u;
            }
        }
    }
    (*comb).own[medium] = between.next;
    return between;
}

// Whether a medium has a panel between two nodes.
fn has_panel(comb: ptr<function, Comb>, node: i32, t: vec2f, own: f32, between: Between) -> bool {
    let some = (own < 0.0) | (between.next < 0.0) | (between.count > 0u);
    return (node >= (*comb).first) & (t.x < t.y) & some;
}

// The two ends of a panel: where it begins, and where it stops.
const START_END: u32 = 0u;
const STOP_END: u32 = 1u;

// Distances of the ends of a panel between two nodes: those inside, else walls.
fn panel_stretch(own: f32, t: vec2f, between: Between) -> vec2f {
    return select(between.walls, t, vec2<bool>(own < 0.0, between.next < 0.0));
}

// From which of the ends on, and before which, the medium has yet to be sampled: at a node inside that a panel begins with
// it has been.
fn new_ends(own: f32, between: Between) -> vec2u {
    let has_walls = between.count > 0u;
    let first = select(STOP_END, START_END, (own >= 0.0) & has_walls);
    return vec2u(first, select(STOP_END, STOP_END + 1u, (between.next < 0.0) | has_walls));
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
