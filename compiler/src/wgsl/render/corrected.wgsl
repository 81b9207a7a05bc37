// What media along a ray add and take away, by panel.wgsl.
// Twin: runtime-cpu/src/render/corrected.rs, which says why.

const THIN: f32 = 0.125;
const THICK: f32 = 0.5;

// Where a panel of a medium begins or stops.
struct PanelEnd {
    interior: Interior,
    // Light sent towards the eye, per unit of density.
    source: vec3f,
    distance: f32,
    // Whether it is a node; else it is a wall.
    is_node: bool,
}

// The panels between two nodes, one for each medium.
struct Panels {
    starts: array<PanelEnd, MEDIUM_SLOTS>,
    stops: array<PanelEnd, MEDIUM_SLOTS>,
    // Integral of the density that each end stands for.
    masses: array<vec2f, MEDIUM_SLOTS>,
    depth: vec3f,
    some: bool,
    // Whether the sources at the node before are known.
    lit: bool,
}

// Follows the ray through the media up to its end.
fn march(ray: Ray, end: f32) -> Glow {
    var glow = clear_glow();
    var styled = style_rays(ray, end);
    var comb = new_comb(ray, end, vol_frame_word(AT_STEP), 1);
    var panels: Panels;
    // The panel before a run is nothing: its end is the beginning of the first.
    for (var at = start_node(&comb, 1); at.first <= comb.last; at = next_node(&comb, at, node_after(&comb, at), 1)) {
        let node = at.first;
        let t = vec2f(panel_node(&comb, node), panel_node(&comb, node + 1));
        find_panels(ray, &comb, node, t, &panels);
        var lit_after = false;
        if (panels.some) {
            if (LIT_MEDIA) {
                lit_after = light_ends(ray, &styled, &panels);
            }
            glow = gather(glow, node, Chunk(panels_sent(&panels), panels.depth));
        }
        // Go on while the ray still lets light through.
        if (largest(glow.transmittance) < STOP) {
            break;
        }
        panels.lit = lit_after;
        for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
            panels.starts[medium] = panels.stops[medium];
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
        let stretch = panel_stretch(own, t, between);
        let nothing = Interior(0.0, vec3f(0.0), vec3f(0.0), vec3f(0.0));
        var start = (*panels).starts[medium];
        var stop = PanelEnd(nothing, vec3f(0.0), stretch.y, between.next < 0.0);
        // Media are asked at one place of the text, since drivers write it out at each.
        let ends = new_ends(own, between);
        for (var end = ends.x; end < ends.y; end++) {
            let distance = select(stretch.x, stretch.y, end == STOP_END);
            let interior = medium_interior(medium, ray_at(ray, distance));
            if (end == STOP_END) {
                stop.interior = interior;
                stop.source = interior.emission;
            } else {
                start = PanelEnd(interior, interior.emission, distance, false);
            }
        }
        var masses = vec2f(0.0);
        if (has_panel(comb, node, t, own, between)) {
            let densities = vec2f(start.interior.density, stop.interior.density);
            let open = open_ends(comb, node, t, own, between.next);
            masses = panel_masses((*comb).step, stretch.y - stretch.x, densities, open);
            (*panels).depth += (start.interior.extinction * masses.x) + (stop.interior.extinction * masses.y);
        }
        (*panels).starts[medium] = start;
        (*panels).stops[medium] = stop;
        (*panels).masses[medium] = masses;
        (*panels).some = (*panels).some | any(masses > vec2f(0.0));
    }
}

fn panel_end(panels: ptr<function, Panels>, medium: u32, at_stop: bool) -> PanelEnd {
    if (at_stop) {
        return (*panels).stops[medium];
    }
    return (*panels).starts[medium];
}

// Places at which ends of panels are: the node before and the node after, which media share, then the two walls of each.
const PLACES_OF_ENDS: u32 = 2u + (2u * MEDIUM_COUNT);
const NODE_BEFORE: u32 = 0u;
const NODE_AFTER: u32 = 1u;

// Whether the panel of a medium has an end at a place.
fn is_end_at(end: PanelEnd, medium: u32, place: u32) -> bool {
    return place == select(2u + (2u * medium) + (place % 2u), place % 2u, end.is_node);
}

// The first place from one on with matter and without light; PLACES_OF_ENDS if there is none.
fn next_dark_place(panels: ptr<function, Panels>, first: u32) -> u32 {
    var next = PLACES_OF_ENDS;
    for (var place = PLACES_OF_ENDS; place > 0u;) {
        place -= 1u;
        var dark = false;
        for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
            let there = is_end_at(panel_end(panels, medium, (place % 2u) == STOP_END), medium, place);
            dark = dark | (there & any((*panels).masses[medium] > vec2f(0.0)));
        }
        let lit = (place == NODE_BEFORE) & (*panels).lit;
        next = select(next, place, (place >= first) & (dark & !lit));
    }
    return next;
}

// Lights the ends of panels with matter; whether those at the node after are among them. Rays that are looked at side by side
// each take their next place, so that all of them are done in a turn or two.
fn light_ends(ray: Ray, styled: ptr<function, StyledRays>, panels: ptr<function, Panels>) -> bool {
    var lit_after = false;
    var place = next_dark_place(panels, 0u);
    while (place < PLACES_OF_ENDS) {
        let at_stop = (place % 2u) == STOP_END;
        var distance = 0.0;
        var scatter: array<vec3f, MEDIUM_SLOTS>;
        var source: array<vec3f, MEDIUM_SLOTS>;
        for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
            let end = panel_end(panels, medium, at_stop);
            let there = is_end_at(end, medium, place);
            scatter[medium] = select(vec3f(0.0), end.interior.scattering, there);
            source[medium] = end.source;
            distance = select(distance, end.distance, there);
        }
        light_place(ray, distance, styled, &scatter, &source);
        for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
            if (at_stop) {
                (*panels).stops[medium].source = source[medium];
            } else {
                (*panels).starts[medium].source = source[medium];
            }
        }
        lit_after = lit_after | (place == NODE_AFTER);
        place = next_dark_place(panels, place + 1u);
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
            sent += panel_sent(masses, (*panels).starts[medium].source, (*panels).stops[medium].source, depth);
        }
    }
    return sent;
}

// Integral of the extinction along the ray.
fn optical_depth(ray: Ray, end: f32) -> vec3f {
    var comb = new_comb(ray, end, vol_frame_word(AT_SHADOW_STEP), 1);
    // Density and extinction of each medium at the node before.
    var before: array<vec4f, MEDIUM_SLOTS>;
    var depth = vec3f(0.0);
    // The panel before a run is nothing: its end is the beginning of the first.
    for (var node = start_node(&comb, 1); node.first <= comb.last; node = next_node(&comb, node, node_after(&comb, node), 1)) {
        // Optical depth of each panel, all media together.
        depth += panel_depth(ray, &comb, node.first, &before);
        // Go on while the ray is not dark yet.
        if (smallest(depth) > OPAQUE) {
            break;
        }
    }
    return depth;
}

fn panel_depth(ray: Ray, comb: ptr<function, Comb>, node: i32, before: ptr<function, array<vec4f, MEDIUM_SLOTS>>) -> vec3f {
    let step_size = (*comb).step;
    let t = vec2f(panel_node(comb, node), panel_node(comb, node + 1));
    var depth = vec3f(0.0);
    for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {
        let own = (*comb).own[medium];
        let between = find_walls(ray, medium, comb, node, t);
        let stretch = panel_stretch(own, t, between);
        var first = (*before)[medium];
        var last = vec4f(0.0);
        // Media are asked at one place of the text, since drivers write it out at each.
        let ends = new_ends(own, between);
        for (var end = ends.x; end < ends.y; end++) {
            let at_stop = end == STOP_END;
            let matter = medium_extinction(medium, ray_at(ray, select(stretch.x, stretch.y, at_stop)));
            first = select(matter, first, at_stop);
            last = select(last, matter, at_stop);
        }
        (*before)[medium] = select(vec4f(0.0), last, between.next < 0.0);
        if (has_panel(comb, node, t, own, between)) {
            let open = open_ends(comb, node, t, own, between.next);
            let masses = panel_masses(step_size, stretch.y - stretch.x, vec2f(first.x, last.x), open);
            depth += (first.yzw * masses.x) + (last.yzw * masses.y);
        }
    }
    return depth;
}
