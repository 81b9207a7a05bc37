// The integrator: what a picture means. Twin of runtime-cpu/src/render, with the same file names,
// function names and step comments.
//
// Written before this text, per program: how many objects and media there are, the places AT_… of
// the words of vol_frame, vol_frame_word for one of them, and the functions object_… and medium_… that
// pick the function of one of them. Every value stays finite; skipped parts add exactly 0.

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
const EAGERNESS: f32 = 1.95;
const ROOM: f32 = 0.98;
const MAX_NODES: i32 = 16384;
const LAST_NODE: f32 = 4194304.0;
const SHOWS_NORMALS: f32 = 2.0;
const BY_STEEPNESS: f32 = 0.0;
const NO_BOUND: f32 = 1e30;
const TRIES: u32 = 8u;
const UNLIT: f32 = 1.0;
const UNSHADOWED: f32 = 2.0;
const SHADOWED: f32 = 3.0;
// Pixels have fewer corners.
const NO_CORNER: u32 = 4u;
const ROOT_THIRD: f32 = 0.5773503;

fn word3(at: u32) -> vec3f {
    return vec3f(vol_frame_word(at), vol_frame_word(at + 1u), vol_frame_word(at + 2u));
}

fn input3(at: u32) -> vec3f {
    return vec3f(vol_input_word(at), vol_input_word(at + 1u), vol_input_word(at + 2u));
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

// Takes samples of a pixel until there are `last` of them, or enough.
fn sample_pixel(pixel: vec2u, before: Mean, last: u32) -> Mean {
    var mean = before;
    // Rays are followed at one place of the text, since drivers write it out at each: for samples, and
    // for the corners after the first round.
    var corner = NO_CORNER;
    while ((corner < NO_CORNER) || ((mean.count < last) && !is_done(mean))) {
        let is_probe = corner < NO_CORNER;
        let found = radiance(pixel_ray(pixel, mean.count, corner));
        if (is_probe) {
            mean = add_probe(mean, found);
            corner += 1u;
        } else {
            mean = add_sample(mean, found);
            corner = select(NO_CORNER, 0u, is_probed() && (mean.count == FIRST_ROUND));
        }
    }
    return mean;
}

// The ray of a sample, or through a corner of the pixel.
fn pixel_ray(pixel: vec2u, index: u32, corner: u32) -> Ray {
    let is_probe = corner < NO_CORNER;
    let aside = select(place_in_pixel(index), vec2f(vec2u(corner % 2u, corner / 2u)), is_probe);
    var ray = camera_ray(vec2f(pixel) + aside);
    ray.shift = select(comb_shift(pixel, index), 0.0, is_probe);
    return ray;
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
