// How far a value of a solid's field can be walked: segment tracing.
// Twin: runtime-cpu/src/render/stride.rs, which says why.

// Makes the value of a solid's field safe to walk; what is inside stays as it is.
fn shorten(solid: u32, ray: Ray, t: f32, last: f32, value: f32) -> f32 {
    let scale = vol_frame_word(object_word(solid) + 7u);
    if (scale != BY_STEEPNESS) {
        return scale * value;
    }
    if (!(value > 0.0)) {
        return value;
    }
    var ahead = reach(last, value);
    for (var count = 0u; count < TRIES; count++) {
        let steepest = way_steepness(solid, ray, t, ahead);
        if (steepest < NO_BOUND) {
            return min(value / steepest, ahead);
        }
        // Look less far where nothing is known: there may be a jump on the way.
        ahead = 0.25 * ahead;
    }
    return 0.0;
}

// Bound on the slope over the box of the next step, a little larger than rounding can make it.
fn way_steepness(solid: u32, ray: Ray, t: f32, ahead: f32) -> f32 {
    let here = ray_at(ray, t);
    let there = ray_at(ray, t + ahead);
    let slack = (4.0 * EPSILON) * (remoteness() + (t + ahead));
    return object_steepness(solid, min(here, there) - slack, max(here, there) + slack);
}

// How far the next step may go: to where a distance proper would, and at most twice as far as the last,
// if there was one.
fn reach(last: f32, value: f32) -> f32 {
    let outside = max(value, 0.0);
    return select(outside, min(outside, 2.0 * last), last > 0.0);
}
