// What media along a ray add and take away, by panel.wgsl.
// Twin: runtime-cpu/src/render/corrected.rs, which says why.

// Ends of panels: the node before, the node after, the walls between them.
const BEFORE: u32 = 0u;
const AFTER: u32 = 1u;
const WALL: u32 = 2u;
const MOST_WALLS: u32 = 2u;
const THIN: f32 = 0.125;
const THICK: f32 = 0.5;
const END_SLOTS: u32 = (WALL + MOST_WALLS) * MEDIUM_SLOTS;

// The panels between two nodes.
struct Panels {
    // Each medium at each kind of end.
    interiors: array<Interior, END_SLOTS>,
    // Light sent towards the eye there, per unit of density.
    sources: array<vec3f, END_SLOTS>,
    // Distances of the walls.
    walls: array<vec2f, MEDIUM_SLOTS>,
    // Kinds of the two ends of each medium's panel.
    ends: array<vec2u, MEDIUM_SLOTS>,
    // Integral of the density that each end stands for.
    masses: array<vec2f, MEDIUM_SLOTS>,
    depth: vec3f,
    some: bool,
    // Whether the sources at the node before are known.
    lit: bool,
}

fn march_panels(ray: Ray, end: f32) -> Glow {
    var glow = clear_glow();
    var styled = style_rays(ray, end);
    var comb = new_comb(ray, end, vol_frame_word(AT_STEP));
    var panels: Panels;
    panels.lit = false;
    // The panel before the first one is nothing: its end is the beginning of the first.
    for (var node = comb.first - 1; node <= comb.last; node++) {
        let t = vec2f(panel_node(&comb, node), panel_node(&comb, node + 1));
        find_panels(ray, &comb, node, t, &panels);
        var lit_after = false;
        if (panels.some) {
            lit_after = light_ends(ray, t, &styled, &panels);
            glow = gather(glow, node, Chunk(panels_sent(&panels), panels.depth));
        }
        // Go on while the ray still lets light through.
        if (largest(glow.transmittance) < STOP) {
            break;
        }
        panels.lit = lit_after;
        for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
            panels.interiors[medium] = panels.interiors[MEDIUM_SLOTS + medium];
            panels.sources[medium] = panels.sources[MEDIUM_SLOTS + medium];
        }
    }
    return glow;
}

// Finds the panels after a node and their optical depths, all media together.
fn find_panels(ray: Ray, comb: ptr<function, Comb>, node: i32, t: vec2f, panels: ptr<function, Panels>) {
    (*panels).depth = vec3f(0.0);
    (*panels).some = false;
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let own = (*comb).own[medium];
        let between = find_walls(ray, medium, comb, node, t);
        let next = between.next;
        var masses = vec2f(0.0);
        var ends = vec2u(BEFORE, AFTER);
        var stretch = t;
        (*panels).walls[medium] = between.walls;
        // The node after, then the walls: media are asked at one place of the text, since drivers write it out at each.
        for (var kind = AFTER; kind < (WALL + between.count); kind++) {
            let is_wall = kind >= WALL;
            let wall = max(kind, WALL) - WALL;
            let distance = select(t.y, between.walls[wall], is_wall);
            var interior = Interior(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0));
            if (is_wall || (next < 0.0)) {
                interior = medium_interior(medium, ray_at(ray, distance));
            }
            (*panels).interiors[(kind * MEDIUM_SLOTS) + medium] = interior;
            let is_end = wall_ends(own, wall);
            ends = select(ends, select(vec2u(kind, ends.y), vec2u(ends.x, kind), is_end), is_wall);
            stretch = select(stretch, select(vec2f(distance, stretch.y), vec2f(stretch.x, distance), is_end), is_wall);
        }
        if (has_panel(comb, node, t, own, between)) {
            let first = (*panels).interiors[(ends.x * MEDIUM_SLOTS) + medium];
            let last = (*panels).interiors[(ends.y * MEDIUM_SLOTS) + medium];
            let open = open_ends(comb, node, t, own, next);
            masses = panel_masses((*comb).step, stretch.y - stretch.x, vec2f(first.density, last.density), open);
            (*panels).depth += (first.extinction * masses.x) + (last.extinction * masses.y);
        }
        (*panels).ends[medium] = ends;
        (*panels).masses[medium] = masses;
        (*panels).some = (*panels).some | any(masses > vec2f(0.0));
    }
}

// Lights the ends of panels with matter; whether those at the node after are among them.
fn light_ends(ray: Ray, t: vec2f, styled: ptr<function, StyledRays>, panels: ptr<function, Panels>) -> bool {
    var lit_after = false;
    for (var place = 0u; place < (WALL + (MOST_WALLS * MEDIUM_COUNT)); place++) {
        // Media share nodes; each has walls of its own.
        let is_wall = place >= WALL;
        let wall = (max(place, WALL) - WALL) % MOST_WALLS;
        let owner = (max(place, WALL) - WALL) / MOST_WALLS;
        let kind = select(place, WALL + wall, is_wall);
        var distance = select(t.y, t.x, kind == BEFORE);
        var wanted = false;
        var scatter: array<vec3f, MEDIUM_SLOTS>;
        var source: array<vec3f, MEDIUM_SLOTS>;
        for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
            let ends = (*panels).ends[medium];
            let own = !is_wall | (medium == owner);
            let asks = own & any(ends == vec2u(kind)) & any((*panels).masses[medium] > vec2f(0.0));
            wanted = wanted | asks;
            scatter[medium] = vec3f(0.0);
            source[medium] = vec3f(0.0);
            if (!is_wall | asks) {
                let interior = (*panels).interiors[(kind * MEDIUM_SLOTS) + medium];
                scatter[medium] = interior.scattering;
                source[medium] = interior.emission;
                distance = select(distance, (*panels).walls[medium][wall], is_wall);
            }
        }
        if (wanted & !((kind == BEFORE) & (*panels).lit)) {
            light_place(ray, distance, styled, &scatter, &source);
            lit_after = lit_after | (kind == AFTER);
            for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
                if (!is_wall | (medium == owner)) {
                    (*panels).sources[(kind * MEDIUM_SLOTS) + medium] = source[medium];
                }
            }
        }
    }
    return lit_after;
}

// Light that a panel sends towards the eye, in front of it.
fn panel_sent(masses: vec2f, start: vec3f, end: vec3f, depth: vec3f) -> vec3f {
    let steady = start * mean_decay3(depth);
    let change = (end - start) * decay_moment3(depth);
    let thick = (steady + change) * (masses.x + masses.y);
    let thin = (start * masses.x) + ((end * decay3(depth)) * masses.y);
    let rise = min(max((depth - vec3f(THIN)) * (1.0f / (THICK - THIN)), vec3f(0.0)), vec3f(1.0));
    return thin + ((thick - thin) * rise);
}

// Adds up what the panels send.
fn panels_sent(panels: ptr<function, Panels>) -> vec3f {
    let depth = (*panels).depth;
    var sent = vec3f(0.0);
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let masses = (*panels).masses[medium];
        if (any(masses > vec2f(0.0))) {
            let ends = (*panels).ends[medium];
            let start = (*panels).sources[(ends.x * MEDIUM_SLOTS) + medium];
            let end = (*panels).sources[(ends.y * MEDIUM_SLOTS) + medium];
            sent += panel_sent(masses, start, end, depth);
        }
    }
    return sent;
}
