// The integrator: what a picture means. Twin of runtime-cpu/src/render, with the same file names,
// function names and step comments. One invocation computes samples of
// one pixel.
//
// Written before this text, per program: how many objects and media there are, the places AT_… of
// the words of vol_input, and the functions object_… and medium_… that pick the function of one of
// them. Every value stays finite; skipped parts add exactly 0.

@group(0) @binding(3) var<storage, read> vol_input: array<f32>;
@group(0) @binding(4) var<storage, read_write> vol_output: array<u32>;

const FAR: f32 = 4.0e6;
const PARALLEL: f32 = 1e-12;
const EPSILON: f32 = 0x1p-23f;
const FLAT: f32 = 1e-15;
const OPAQUE: f32 = 24.0;
const STOP: f32 = 0x1p-16f;
const NO_DEPTH: f32 = 1e30;
const MAX_SPREAD_TANGENT: f32 = 1.7320508;
const MAX_STEPS: u32 = 2000u;
const REFINEMENTS: u32 = 4u;
const MAX_NODES: i32 = 16384;
const LAST_NODE: f32 = 4194304.0;
const SHOWS_NORMALS: f32 = 2.0;
const BY_STEEPNESS: f32 = 0.0;
const NO_BOUND: f32 = 1e30;
const TRIES: u32 = 8u;
const UNLIT: f32 = 1.0;
const UNSHADOWED: f32 = 2.0;
const SHADOWED: f32 = 3.0;
const ROOT_THIRD: f32 = 0.5773503;

fn word3(at: u32) -> vec3f {
    return vec3f(vol_input[at], vol_input[at + 1u], vol_input[at + 2u]);
}

fn dot3(a: vec3f, b: vec3f) -> f32 {
    return ((a.x * b.x) + (a.y * b.y)) + (a.z * b.z);
}

fn length3(v: vec3f) -> f32 {
    return sqrt(dot3(v, v));
}

fn largest(v: vec3f) -> f32 {
    return max(max(v.x, v.y), v.z);
}

fn smallest(v: vec3f) -> f32 {
    return min(min(v.x, v.y), v.z);
}

fn decay(x: f32) -> f32 {
    return vol_exp2(x * -1.44269504);
}

fn decay3(x: vec3f) -> vec3f {
    return vec3f(decay(x.x), decay(x.y), decay(x.z));
}

// (1 - exp(-x)) / x, 1 at 0.
fn mean_decay(x: f32) -> f32 {
    let tail = x * ((1.0f / 120.0f) - (x * (1.0f / 720.0f)));
    let series = 1.0 - (x * (0.5 - (x * ((1.0f / 6.0f) - (x * ((1.0f / 24.0f) - tail))))));
    let quotient = (1.0 - decay(x)) / max(x, 0.35);
    return select(quotient, series, x < 0.35);
}

fn mean_decay3(x: vec3f) -> vec3f {
    return vec3f(mean_decay(x.x), mean_decay(x.y), mean_decay(x.z));
}

// (1 - (1 + x) exp(-x)) / x^2, 1/2 at 0.
fn decay_moment(x: f32) -> f32 {
    let tail = x * ((1.0f / 144.0f) - (x * ((1.0f / 840.0f) - (x * (1.0f / 5760.0f)))));
    let series = 0.5 - (x * ((1.0f / 3.0f) - (x * ((1.0f / 8.0f) - (x * ((1.0f / 30.0f) - tail))))));
    let quotient = (mean_decay(x) - decay(x)) / max(x, 0.5);
    return select(quotient, series, x < 0.5);
}

fn decay_moment3(x: vec3f) -> vec3f {
    return vec3f(decay_moment(x.x), decay_moment(x.y), decay_moment(x.z));
}

// x^y for x >= 0; 0 at 0.
fn power(x: f32, y: f32) -> f32 {
    let some = x > 0.0;
    let value = vol_exp2(y * vol_log2(select(1.0, x, some)));
    return select(0.0, value, some);
}

// How much this invocation has computed, for statistics.
var<private> counted_camera_rays: u32;
var<private> counted_rays: u32;
var<private> counted_samples: u32;
var<private> counted_evaluations: u32;

@compute @workgroup_size(8, 8)
fn render(@builtin(global_invocation_id) id: vec3u) {
    let tile = vec4u(
        u32(vol_input[AT_TILE]),
        u32(vol_input[AT_TILE + 1u]),
        u32(vol_input[AT_TILE + 2u]),
        u32(vol_input[AT_TILE + 3u]),
    );
    if ((id.x >= tile.z) | (id.y >= tile.w)) {
        return;
    }
    let column = tile.x + id.x;
    let row = tile.y + id.y;
    let index = (row * u32(vol_input[AT_SIZE])) + column;
    let pixel = vec2u(column, row);
    // Go on with the pixel where the dispatch before stopped.
    var mean = read_pixel(index);
    let last = min(mean.count + u32(vol_input[AT_BUDGET]), u32(vol_input[AT_SAMPLES]));
    while ((mean.count < last) && !is_done(mean)) {
        mean = add_sample(mean, radiance(sample_ray(pixel, mean.count)));
        if (is_probed() && (mean.count == FIRST_ROUND)) {
            for (var corner = 0u; corner < 4u; corner++) {
                let place = pixel + vec2u(corner % 2u, corner / 2u);
                mean = add_probe(mean, radiance(camera_ray(vec2f(place))));
            }
        }
    }
    write_pixel(index, mean);
}

// Follows a camera ray.
fn radiance(ray: Ray) -> Radiance {
    counted_camera_rays += 1u;
    counted_rays += 1u;
    // Find what is behind the media: surfaces, else the background.
    let contact = trace(ray);
    var behind = word3(AT_BACKGROUND);
    var end = FAR;
    var depth = NO_DEPTH;
    if (contact.hit) {
        behind = shade(ray, contact);
        end = contact.t;
        depth = contact.t * dot3(ray.direction, word3(AT_FORWARD));
    }
    // Look at it through the media.
    let glow = march(ray, end);
    let coarse = glow.coarse_light + (glow.coarse_transmittance * behind);
    let color = glow.light + (glow.transmittance * behind);
    let doubt = length3(coarse - color) * ROOT_THIRD;
    return Radiance(color, select(glow.transmittance, vec3f(0.0), contact.hit), depth, doubt);
}

fn read_pixel(index: u32) -> Mean {
    let at = PIXEL_WORDS * index;
    return Mean(
        vol_output[at + 11u],
        vec3f(output_float(at), output_float(at + 1u), output_float(at + 2u)),
        vec3f(output_float(at + 3u), output_float(at + 4u), output_float(at + 5u)),
        output_float(at + 6u),
        output_float(at + 12u),
        output_float(at + 13u),
        output_float(at + 14u),
    );
}

fn output_float(at: u32) -> f32 {
    return bitcast<f32>(vol_output[at]);
}

// Counts of dispatches are added up in whole numbers: with many samples they leave the 24 bits of a
// float.
fn write_pixel(index: u32, mean: Mean) {
    let at = PIXEL_WORDS * index;
    vol_output[at] = bitcast<u32>(mean.color.x);
    vol_output[at + 1u] = bitcast<u32>(mean.color.y);
    vol_output[at + 2u] = bitcast<u32>(mean.color.z);
    vol_output[at + 3u] = bitcast<u32>(mean.transmittance.x);
    vol_output[at + 4u] = bitcast<u32>(mean.transmittance.y);
    vol_output[at + 5u] = bitcast<u32>(mean.transmittance.z);
    vol_output[at + 6u] = bitcast<u32>(mean.depth);
    vol_output[at + 7u] += counted_rays;
    vol_output[at + 8u] += counted_samples;
    vol_output[at + 9u] += counted_evaluations;
    vol_output[at + 10u] += counted_camera_rays;
    vol_output[at + 11u] = mean.count;
    vol_output[at + 12u] = bitcast<u32>(mean.color_spread);
    vol_output[at + 13u] = bitcast<u32>(mean.transmittance_spread);
    vol_output[at + 14u] = bitcast<u32>(mean.doubt);
}
