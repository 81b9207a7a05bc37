// Light of a lamp with a style, as media send it towards the eye.
// Twin: runtime-cpu/src/render/styled.rs, which says why.

const LEAST_SINE: f32 = 1e-6;
const APART: f32 = 1e6;
const NEARLY: f32 = 1e-3;
const TAU: f32 = 6.2831855;
const NO_SLICE: u32 = 0xffffffffu;

// What hides the light, at the first word of a style's record.
const SLICED: f32 = 1.0;
const MARCHED: f32 = 2.0;

// A ray as a style sees it.
struct StyledRay {
    // Word of the first texel of its slice.
    slice: u32,
    slope: f32,
    texels: f32,
    end: f32,
    tint: vec3f,
}

// By light.
struct StyledRays {
    each: array<StyledRay, LIGHT_SLOTS>,
}

// A stretch of a ray.
struct Cell {
    start: f32,
    end: f32,
}

fn whole_word(at: u32) -> u32 {
    return u32(vol_frame_word(at));
}

// Finds out what styles make of a ray that ends somewhere.
fn style_rays(ray: Ray, end: f32) -> StyledRays {
    var rays: StyledRays;
    let count = light_count();
    for (var light = 0u; light < count; light++) {
        let style = whole_word((AT_LIGHTS + (LIGHT_WORDS * light)) + 11u);
        if (style != 0u) {
            rays.each[light] = style_ray(style, ray, end);
        }
    }
    return rays;
}

fn style_ray(style: u32, ray: Ray, end: f32) -> StyledRay {
    var styled = styled_ray(style, ray, end);
    let span = slab(ray, word3(style + 1u), word3(style + 4u));
    let cell = Cell(span.entry, min(span.leave, end));
    let depth = select(NO_DEPTH, end * dot3(ray.direction, word3(AT_FORWARD)), end < FAR);
    if (vol_frame_word(style + 26u) != 0.0) {
        var visible = 1.0;
        if (cell.start < cell.end) {
            visible = lit_share_of(style, styled, ray, cell);
        }
        styled.tint = transfer_color(style, visible, depth);
    }
    if (vol_frame_word(style + 41u) != 0.0) {
        var mean = 1.0;
        if (vol_frame_word(style + 43u) != 0.0) {
            mean = known_mean(style, pixel_of(ray), depth);
        } else {
            mean = ray_mean(style, ray, cell);
        }
        styled.tint = styled.tint * mean;
    }
    return styled;
}

// Mean of the heterogeneity over a stretch of a ray, at the middles of equal parts.
fn ray_mean(style: u32, ray: Ray, cell: Cell) -> f32 {
    if (cell.start >= cell.end) {
        return 1.0;
    }
    let count = vol_frame_word(style + 41u);
    let field = whole_word(style + 42u);
    let step_size = (cell.end - cell.start) / count;
    let steps = u32(count);
    var sum = 0.0;
    for (var i = 0u; i < steps; i++) {
        let t = cell.start + ((f32(i) + 0.5) * step_size);
        sum += style_field(field, ray_at(ray, t));
    }
    return sum / count;
}

// Part of the light of a lamp with a style that solids leave to the stretch around a place on a ray.
fn styled_share(lamp: Arriving, light: u32, rays: ptr<function, StyledRays>, ray: Ray, t: f32) -> f32 {
    if (vol_frame_word(lamp.style + 26u) != 0.0) {
        return 1.0;
    }
    let half = 0.5 * vol_frame_word(AT_STEP);
    let styled = (*rays).each[light];
    let cell = Cell(max(t - half, 0.0), min(t + half, styled.end));
    return lit_share_of(lamp.style, styled, ray, cell);
}

// Part of a stretch of a ray that solids leave lit.
fn lit_share_of(style: u32, styled: StyledRay, ray: Ray, cell: Cell) -> f32 {
    let occluders = vol_frame_word(style);
    if (occluders == SLICED) {
        return lit_share(style, styled, cell);
    }
    if (MARCHED_SHAFTS) {
        if (occluders == MARCHED) {
            return marched_share(word3(style + 7u), ray, cell);
        }
    }
    return 1.0;
}

// Factor of the light of a lamp at a place, beside visibility.
fn styled_tint(lamp: Arriving, light: u32, rays: ptr<function, StyledRays>, point: vec3f) -> vec3f {
    let tint = (*rays).each[light].tint;
    if (vol_frame_word(lamp.style + 30u) != 0.0) {
        return tint * light_color(lamp.style, point);
    }
    return tint;
}

// A ray without tint.
fn styled_ray(style: u32, ray: Ray, end: f32) -> StyledRay {
    var styled = StyledRay(NO_SLICE, 0.0, 0.0, end, vec3f(1.0));
    if (vol_frame_word(style) == SLICED) {
        let u = dot3(ray.direction, word3(style + 10u));
        let v = dot3(ray.direction, word3(style + 13u));
        let toward = dot3(ray.direction, word3(style + 16u));
        let sine = max(sqrt((u * u) + (v * v)), LEAST_SINE);
        styled.slope = toward / sine;
        styled.texels = sine * vol_frame_word(style + 23u);
        styled.slice = slice_of(style, vol_atan2(v, u));
    }
    return styled;
}

// First texel of the slice at an angle about the line through the eye.
fn slice_of(style: u32, angle: f32) -> u32 {
    let turned = angle - vol_frame_word(style + 19u);
    let positive = select(turned, turned + TAU, turned < 0.0);
    let found = i32(floor(positive * vol_frame_word(style + 20u)));
    let last = i32(vol_frame_word(style + 21u));
    // Rounding may turn the last slice by one too many.
    let row = select(found, last - 1, found == last);
    let first = whole_word(style + 25u) + (u32(row) * whole_word(style + 24u));
    return select(NO_SLICE, first, (row >= 0) & (row < last));
}

// Part of a stretch of a ray that solids leave lit, by its slice.
fn lit_share(style: u32, ray: StyledRay, cell: Cell) -> f32 {
    if (ray.slice == NO_SLICE) {
        return 1.0;
    }
    let first_distance = vol_frame_word(style + 22u);
    let start = first_distance * vol_frame_word(style + 23u);
    let nearer = (cell.start * ray.texels) - start;
    let farther = (cell.end * ray.texels) - start;
    let width = farther - nearer;
    let columns = vol_frame_word(style + 24u);
    // Before the slice and behind it nothing hides.
    let begin = min(max(nearer, 0.0), columns);
    let end = min(max(farther, 0.0), columns);
    if (begin >= end) {
        return 1.0;
    }
    let left = u32(floor(begin));
    let right = min(u32(floor(end)), u32(columns) - 1u);
    // The parts of the texels at the ends of the stretch that are dark, and all of those between.
    var parts = 0.0;
    var whole = 0u;
    for (var texel = left; texel <= right; texel++) {
        let slope = vol_input_word(ray.slice + texel);
        let hides = slope > ray.slope;
        if ((texel == left) | (texel == right)) {
            let low = max(begin, f32(texel));
            let high = min(end, f32(texel + 1u));
            let holds_eye = (texel == 0u) & (first_distance == 0.0);
            let hidden = select(0.0, high - low, hides);
            parts += select(hidden, hidden_at_the_eye(slope, ray.slope, low, high), holds_eye);
        } else {
            whole += select(0u, 1u, hides);
        }
    }
    let dark = f32(whole) + parts;
    return min(max(1.0 - (dark / width), 0.0), 1.0);
}

// Length of a stretch of the texel around the eye that is below the surface.
fn hidden_at_the_eye(slope: f32, own: f32, low: f32, high: f32) -> f32 {
    let height = 0.5 * slope;
    let rises = own > 0.0;
    let falls = own < 0.0;
    let crossing = height / select(1.0, own, rises | falls);
    let below = select(0.0, high - low, height > 0.0);
    let rising = max(min(high, crossing) - low, 0.0);
    let falling = max(high - max(low, crossing), 0.0);
    return select(select(below, falling, falls), rising, rises);
}

// Colour for an average visibility and a depth along the viewing axis.
fn transfer_color(style: u32, visible: f32, depth: f32) -> vec3f {
    let along = (depth - vol_frame_word(style + 27u)) * vol_frame_word(style + 28u);
    let last = f32(TRANSFER_SIZE - 1u);
    let x = min(max(visible, 0.0), 1.0) * last;
    let y = min(max(along, 0.0), 1.0) * last;
    return bilinear(whole_word(style + 29u), TRANSFER_SIZE, x, y);
}

// Colour of a light where it crosses a point.
fn light_color(style: u32, point: vec3f) -> vec3f {
    let off = point - word3(style + 31u);
    let size = whole_word(style + 30u);
    let last = f32(size - 1u);
    let x = min(max(dot3(off, word3(style + 34u)), 0.0), last);
    let y = min(max(dot3(off, word3(style + 37u)), 0.0), last);
    return bilinear(whole_word(style + 40u), size, x, y);
}

// Between four texels of a square table.
fn bilinear(table: u32, size: u32, x: f32, y: f32) -> vec3f {
    let most = f32(size - 2u);
    let column = min(floor(x), most);
    let row = min(floor(y), most);
    let a = x - column;
    let b = y - row;
    let first = table + (3u * ((u32(row) * size) + u32(column)));
    let below = first + (3u * size);
    let upper = mixed(input3(first), input3(first + 3u), a);
    let lower = mixed(input3(below), input3(below + 3u), a);
    return mixed(upper, lower, b);
}

fn mixed(a: vec3f, b: vec3f, share: f32) -> vec3f {
    return a + ((b - a) * share);
}

// Place of the picture that a ray goes through, in pixels from the upper left corner.
fn pixel_of(ray: Ray) -> vec2f {
    let right = word3(AT_RIGHT);
    let up = word3(AT_UP);
    let ahead = dot3(ray.direction, word3(AT_FORWARD));
    let u = dot3(ray.direction, right) / (ahead * dot3(right, right));
    let v = dot3(ray.direction, up) / (ahead * dot3(up, up));
    let x = (0.5 * (u + 1.0)) * vol_frame_word(AT_SIZE);
    let y = (0.5 * (1.0 - v)) * vol_frame_word(AT_SIZE + 1u);
    return vec2f(x, y);
}

// Between four known means, each by how near its pixel and its depth are.
fn known_mean(style: u32, pixel: vec2f, depth: f32) -> f32 {
    let spacing = vol_frame_word(style + 43u);
    let counts = vec2f(vol_frame_word(style + 44u), vol_frame_word(style + 45u));
    let last = counts - vec2f(1.0);
    let place = min(max((pixel / spacing) - vec2f(0.5), vec2f(0.0)), last);
    let whole = floor(place);
    let part = place - whole;
    let columns = u32(counts.x);
    let means = whole_word(style + 46u);
    var sum = 0.0;
    var weights = 0.0;
    for (var corner = 0u; corner < 4u; corner++) {
        let far = vec2u(corner & 1u, corner >> 1u);
        let texel = min(vec2u(whole) + far, vec2u(last));
        let at = means + (2u * ((texel.y * columns) + texel.x));
        let sides = select(vec2f(1.0) - part, part, far == vec2u(1u));
        let there = vol_input_word(at + 1u);
        let apart = min(abs(there - depth) / max(depth, NEARLY), APART);
        let weight = (sides.x * sides.y) / (NEARLY + apart);
        sum += weight * vol_input_word(at);
        weights += weight;
    }
    return sum / weights;
}
