// How far a value of a solid's field can be walked: segment tracing.
// Twin: runtime-cpu/src/render/stride.rs, which says why.

// Makes the value of a solid's field safe to walk; what is inside stays as it is.
fn shorten(solid: u32, ray: Ray, t: f32, last: f32, value: f32) -> f32 {
    let scale = vol_input[object_word(solid) + 7u];
    if (scale != BY_STEEPNESS) {
        return scale * value;
    }
    // As far as a step may go, and the box of what is on the way.
    let ahead = reach(last, value);
    let slack = (4.0 * EPSILON) * (remoteness() + (t + ahead));
    let here = ray_at(ray, t);
    let there = ray_at(ray, t + ahead);
    let steepest = object_steepness(solid, min(here, there) - slack, max(here, there) + slack);
    return select(value, min(value / steepest, ahead), value > 0.0);
}

// How far the next step may go: to where a distance proper would, and at most twice as far as the last,
// if there was one.
fn reach(last: f32, value: f32) -> f32 {
    let outside = max(value, 0.0);
    return select(outside, min(outside, 2.0 * last), last > 0.0);
}
