// How open a surface is: light that reaches it from all sides, as an option of a light.
// Twin: runtime-cpu/src/render/occlusion.rs, which says why.

const WEIGHT_COUNT: u32 = 5u;
const WEIGHTS = array<f32, 5>(16.0, 8.0, 4.0, 2.0, 1.0);
const WEIGHT_SUM: f32 = 31.0;

// How open a contact is, 0 to 1, to what is within a distance of it.
fn openness(contact: Contact, reach: f32) -> f32 {
    var weights = WEIGHTS;
    var sides: array<f32, OBJECT_SLOTS>;
    find_sides(&sides);
    var hidden = 0.0;
    for (var index = 0u; index < WEIGHT_COUNT; index++) {
        let share = f32(index + 1u) / f32(WEIGHT_COUNT);
        let height = share * reach;
        let distance = distance_above(contact, height, &sides);
        let lack = max((height - distance) / height, 0.0);
        hidden += weights[index] * min(0.5 * lack, 1.0);
    }
    return 1.0 - min(hidden / WEIGHT_SUM, 1.0);
}

// Distance of the nearest solid at a height above a contact; at most the height.
fn distance_above(
    contact: Contact,
    height: f32,
    sides: ptr<function, array<f32, OBJECT_SLOTS>>,
) -> f32 {
    let point = contact.position + (contact.normal * height);
    var distance = height;
    // That without the parts of a union that holds the eye, whose farthest wall counts.
    var others = height;
    var farthest = -FAR;
    for (var solid = 0u; solid < OBJECT_COUNT; solid++) {
        if (!(joins_the_one_before(solid) & ((*sides)[solid] < 0.0))) {
            others = distance;
            farthest = -FAR;
        }
        // A solid whose box is farther than the height hides nothing.
        let at = object_word(solid);
        let lo = word3(at + 1u) - vec3f(height);
        let hi = word3(at + 4u) + vec3f(height);
        if (contains(lo, hi, point) & (vol_frame_word(at) != 0.0)) {
            farthest = max(farthest, (*sides)[solid] * object_distance(solid, point));
            distance = min(others, farthest);
        }
    }
    return distance;
}
