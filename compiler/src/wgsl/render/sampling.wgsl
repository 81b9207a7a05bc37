// The samples of a pixel: where they are, their mean, and when there are enough of them.
// Twin: runtime-cpu/src/render/sampling.rs, which says why.

const STRIDE: vec2u = vec2u(3242174889u, 2447445414u);
// 2^32 over the golden ratio.
const GOLDEN_STRIDE: u32 = 2654435769u;
const FIRST_ROUND: u32 = 9u;
const ROUND: u32 = 8u;
const LEAST_BRIGHTNESS: f32 = 0.0625;

// What a camera ray brings back; depth NO_DEPTH without a surface.
struct Radiance {
    color: vec3f,
    transmittance: vec3f,
    depth: f32,
    // How far the colour is from the one by every other node of the media.
    doubt: f32,
}

struct Mean {
    count: u32,
    color: vec3f,
    transmittance: vec3f,
    depth: f32,
    color_spread: f32,
    transmittance_spread: f32,
    doubt: f32,
}

fn place_in_pixel(index: u32) -> vec2f {
    let step = (index + 1u) / 2u;
    let signed = select(0u - step, step, (index % 2u) == 1u);
    let place = ((vec2u(signed) * STRIDE) + vec2u(0x80000000u)) >> vec2u(16u);
    return vec2f(place) * (1.0f / 65536.0f);
}

// How far the comb of a sample is moved, in steps.
fn comb_shift(pixel: vec2u, index: u32) -> f32 {
    let place = ((pixel.x * STRIDE.x) + (pixel.y * STRIDE.y)) + (index * GOLDEN_STRIDE);
    return (f32((place + 0x80000000u) >> 16u) * (1.0f / 65536.0f)) - 0.5;
}

// Takes one more sample into the mean.
fn add_sample(old: Mean, sample: Radiance) -> Mean {
    var mean = old;
    mean.count += 1u;
    // The first is the mean, bit for bit.
    if (mean.count == 1u) {
        mean.color = sample.color;
        mean.transmittance = sample.transmittance;
        mean.depth = sample.depth;
        mean.doubt = sample.doubt;
        return mean;
    }
    let share = 1.0 / f32(mean.count);
    mean.doubt = mean.doubt + ((sample.doubt - mean.doubt) * share);
    let color = sample.color - mean.color;
    mean.color = mean.color + (color * share);
    mean.color_spread = mean.color_spread + dot3(color, sample.color - mean.color);
    let transmittance = sample.transmittance - mean.transmittance;
    mean.transmittance = mean.transmittance + (transmittance * share);
    let from_new = sample.transmittance - mean.transmittance;
    mean.transmittance_spread = mean.transmittance_spread + dot3(transmittance, from_new);
    return mean;
}

// Lets the radiance at a corner count for the spread, but not for the mean.
fn add_probe(old: Mean, probe: Radiance) -> Mean {
    var mean = old;
    let color = probe.color - mean.color;
    mean.color_spread = mean.color_spread + dot3(color, color);
    let transmittance = probe.transmittance - mean.transmittance;
    mean.transmittance_spread = mean.transmittance_spread + dot3(transmittance, transmittance);
    return mean;
}

// Whether corners are probed: where there is a test before the last sample.
fn is_probed() -> bool {
    return (vol_frame_word(AT_TOLERANCE) > 0.0) && (u32(vol_frame_word(AT_SAMPLES)) > FIRST_ROUND);
}

// Whether the pixel takes no more samples.
fn is_done(mean: Mean) -> bool {
    if (mean.count >= u32(vol_frame_word(AT_SAMPLES))) {
        return true;
    }
    let tested = (mean.count >= FIRST_ROUND) && (((mean.count - FIRST_ROUND) % ROUND) == 0u);
    let tolerance = vol_frame_word(AT_TOLERANCE);
    return tested && (tolerance > 0.0) && is_within(mean, tolerance);
}

// Whether the standard errors, rms over the channels, are within a tolerance.
fn is_within(mean: Mean, tolerance: f32) -> bool {
    // Three channels; spread / (n (n - 1)) is the squared error of the mean.
    let count = f32(mean.count);
    let least = (3.0 * LEAST_BRIGHTNESS) * LEAST_BRIGHTNESS;
    let scaled = (tolerance * tolerance) * (count * (count - 1.0));
    let color = scaled * max(dot3(mean.color, mean.color), least);
    let transmittance = scaled * 3.0;
    return (mean.color_spread <= color) && (mean.transmittance_spread <= transmittance);
}
