//! Surfaces, shadows and normals against geometry.

use super::super::Batches;
use super::support::{Body, MATT, World, floor, glowing, norm, sphere, toward};
use vol_compiler::frame::{Aabb, Job, LightFrame, Quadrature, Sampling};
use vol_compiler::ir::Function;
use vol_compiler::ops::Op;

const SLOPE: f64 = 0.4;

fn world() -> World {
    World::new([0.0, 0.0, 4.0], SLOPE as f32)
}

/// Distance at which a ray from z = 4 meets the unit sphere.
fn sphere_hit(direction: [f64; 3]) -> Option<f64> {
    let length = norm(direction);
    let b = 4.0 * direction[2] / length;
    let root = b * b - 15.0;
    (root > 0.0).then(|| -b - root.sqrt())
}

#[test]
fn ball_covers_its_silhouette() {
    let mut world = world();
    world.ball([0.0; 3], 1.0, glowing([1.0; 3]));
    let size = 128;
    let image = world.render(size, 1.0);
    let hits = image.pixels.iter().filter(|pixel| pixel.depth.is_finite()).count() as f64;
    // The cone that touches the sphere has sine 1/4: a disc of radius tan in the plane at 1.
    let radius = 0.25 / (1.0_f64 - 0.0625).sqrt();
    let want = std::f64::consts::PI * radius * radius / (4.0 * SLOPE * SLOPE);
    let got = hits / f64::from(size * size);
    // Half a pixel of tolerance makes the disc a little larger.
    assert!((got / want - 1.0).abs() < 0.02, "{got} {want}");
}

#[test]
fn hits_are_exact() {
    for (steepness, size) in [(1.0, 16), (1.0, 96), (3.0, 33)] {
        let mut world = world();
        let bounds = Aabb { lo: [-1.0; 3], hi: [1.0; 3] };
        world.solid(sphere([0.0; 3], 1.0, steepness), glowing([1.0; 3]), bounds, 1.0 / steepness as f32);
        let mut worst: f64 = 0.0;
        for (index, pixel) in world.render(size, 1.0).pixels.iter().enumerate() {
            let direction = toward(size, SLOPE, index);
            // Leave out the outermost fiftieth, where the ray touches rather than meets.
            let aside = norm([direction[0], direction[1], 0.0]);
            if let Some(t) = sphere_hit(direction).filter(|_| aside < 0.98 * 0.2582) {
                worst = worst.max((f64::from(pixel.depth) - t / norm(direction)).abs());
            }
        }
        assert!(worst < 1e-5, "{worst:e} at steepness {steepness}, {size} pixels");
    }
}

#[test]
fn matt_ball_obeys_lambert() {
    let mut world = world();
    world.ball([0.0; 3], 1.0, MATT);
    world.sun([0.6, 0.0, 0.8], [1.0, 2.0, 4.0]);
    let size = 48;
    for (index, pixel) in world.render(size, 1.0).pixels.iter().enumerate() {
        let direction = toward(size, SLOPE, index);
        let aside = norm([direction[0], direction[1], 0.0]);
        let Some(t) = sphere_hit(direction).filter(|_| aside < 0.98 * 0.2582) else { continue };
        let scale = t / norm(direction);
        let normal = [direction[0] * scale, direction[1] * scale, 4.0 - scale];
        let cosine = (normal[0] * 0.6 + normal[2] * 0.8).max(0.0);
        for (channel, light) in pixel.color.into_iter().zip([1.0, 2.0, 4.0]) {
            assert!((f64::from(channel) - light * cosine).abs() < 1e-4 * light, "{index}");
        }
    }
}

#[test]
fn ball_shows_its_normals() {
    let mut world = world();
    world.ball([0.0; 3], 1.0, MATT);
    world.frame.objects[0].shows_normals = true;
    let image = world.render(33, 1.0);
    let centre = image.pixels[16 * 33 + 16].color;
    assert!(
        (centre[0] - 0.5).abs() < 1e-6 && (centre[1] - 0.5).abs() < 1e-6 && (centre[2] - 1.0).abs() < 1e-6
    );
}

/// A ball over a floor, the sun in the zenith: the shadow is the ball's disc.
#[test]
fn shadow_is_where_it_must_be() {
    let mut world = World::new([0.0, 3.0, 8.0], 0.5);
    // Look down at the floor by 45 degrees.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    world.frame.camera.origin = [0.0, 6.0, 6.0];
    world.frame.camera.forward = [0.0, -half, -half];
    world.frame.camera.up = [0.0, 0.5 * half, -0.5 * half];
    let everywhere = Aabb { lo: [f32::NEG_INFINITY; 3], hi: [f32::INFINITY; 3] };
    world.solid(floor(0.0), MATT, everywhere, 1.0);
    world.ball([0.0, 5.0, 0.0], 1.0, glowing([0.0, 0.0, 3.0]));
    world.sun([0.0, 1.0, 0.0], [1.0; 3]);
    let size = 200;
    let mut dark = 0;
    for (index, pixel) in world.render(size, 1.0).pixels.iter().enumerate() {
        if pixel.color[2] > 2.0 {
            continue;
        }
        // Where the ray meets the floor, and how far from the edge of the disc.
        let [right, up, _] = toward(size, 1.0, index);
        let camera = &world.frame.camera;
        let direction: Vec<f64> = (0..3)
            .map(|axis| {
                f64::from(camera.forward[axis])
                    + right * f64::from(camera.right[axis])
                    + up * f64::from(camera.up[axis])
            })
            .collect();
        let t = -6.0 / direction[1];
        let edge = norm([t * direction[0], 0.0, 6.0 + t * direction[2]]) - 1.0;
        // A shadow ray starts a tenth of a pixel (0.005 here) off the floor.
        if edge.abs() > 1e-3 {
            assert_eq!(pixel.color[0] == 0.0, edge < 0.0, "pixel {index}, {edge} from the edge");
        }
        dark += usize::from(pixel.color[0] == 0.0);
    }
    assert!(dark > 100, "{dark} pixels of shadow");
}

/// A lamp in a box lights nothing outside, and a wall between lamp and floor leaves no gap.
#[test]
fn lamp_in_a_ball_stays_there() {
    let mut world = world();
    world.ball([0.0; 3], 1.0, MATT);
    world.ball([0.0, -3.0, 0.0], 2.0, MATT);
    world.frame.lights.push(LightFrame {
        distant: false,
        position: [0.0, 0.5, 0.0],
        color: [50.0; 3],
        shadows: true,
        size: 0.0,
        occlusion: 0.0,
    });
    assert!(world.render(64, 1.0).pixels.iter().all(|pixel| pixel.color == [0.0; 3]));
    world.frame.lights[0].shadows = false;
    assert!(world.render(64, 1.0).pixels.iter().any(|pixel| pixel.color[0] > 0.1));
}

#[test]
fn eye_inside_a_ball_sees_its_far_wall() {
    let mut world = world();
    world.ball([0.0; 3], 6.0, MATT);
    world.frame.lights.push(LightFrame {
        distant: false,
        position: [0.0, 0.0, 1.0],
        color: [49.0; 3],
        shadows: false,
        size: 0.0,
        occlusion: 0.0,
    });
    let image = world.render(15, 1.0);
    let centre = image.pixels[7 * 15 + 7];
    assert!((centre.depth - 10.0).abs() < 1e-4, "{}", centre.depth);
    // The lamp is 7 from the wall and faces it: the normal points to the eye.
    assert!((centre.color[0] - 1.0).abs() < 1e-4, "{:?}", centre.color);
    assert!(image.pixels.iter().all(|pixel| pixel.depth.is_finite()));
}

#[test]
fn highlight_is_where_the_light_is_mirrored() {
    let mut world = world();
    world.ball([0.0; 3], 1.0, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 50.0]);
    world.sun([0.0, 0.0, 1.0], [1.0; 3]);
    let image = world.render(33, 1.0);
    assert!((image.pixels[16 * 33 + 16].color[0] - 1.0).abs() < 1e-4);
    assert!(image.pixels[16 * 33 + 9].color[0] < 0.1);
}

/// Rays that skim a floor without end end all the same, and find it where it is near enough.
#[test]
fn horizon_is_straight() {
    let mut world = World::new([0.0, 1.0, 0.0], 0.5);
    let everywhere = Aabb { lo: [f32::NEG_INFINITY; 3], hi: [f32::INFINITY; 3] };
    world.solid(floor(0.0), glowing([1.0; 3]), everywhere, 1.0);
    let image = world.render_with(
        &Job {
            size: [32, 64],
            step: 1.0,
            shadow_step: 1.0,
            quadrature: Quadrature::Midpoint,
            sampling: Sampling::CENTRE,
        },
        Batches::DEFAULT,
    );
    for (index, pixel) in image.pixels.iter().enumerate() {
        assert_eq!(pixel.depth.is_finite(), index / 32 >= 32, "row {}", index / 32);
    }
}

/// The distance of a box has no gradient on its faces: the normal must not be taken exactly there.
#[test]
fn flat_faces_have_no_specks() {
    let mut world = world();
    // |max(q, 0)| + min(max(q), 0) about the origin, and its gradient as the compiler derives it.
    let face = kinked_face();
    let bounds = Aabb { lo: [-1.0, -1.0, -1.0], hi: [1.0, 1.0, 1.0] };
    world.solid(face, MATT, bounds, 1.0);
    world.sun([0.0, 0.6, 0.8], [1.0; 3]);
    for pixel in world.render(64, 1.0).pixels.iter().filter(|pixel| pixel.depth.is_finite()) {
        assert!((pixel.color[0] - 0.8).abs() < 1e-5, "{}", pixel.color[0]);
    }
}

/// The half space z < 1 as `sqrt(max(z - 1, 0)^2) + min(z - 1, 0)`; the gradient is 0 where both are.
fn kinked_face() -> [Function; 2] {
    let parts = |body: &mut Body| {
        let height = body.relative_to([0.0, 0.0, 1.0])[2];
        let zero = body.number(0.0);
        let above = body.apply(Op::Max, &[height, zero]);
        let squared = body.apply(Op::Mul, &[above, above]);
        let outside = body.apply(Op::Sqrt, &[squared]);
        let inside = body.apply(Op::Min, &[height, zero]);
        (height, outside, inside, zero)
    };
    let mut distance = Body::new("face", 3);
    let (_, outside, inside, _) = parts(&mut distance);
    let sum = distance.apply(Op::Add, &[outside, inside]);
    let distance = distance.finish(&[sum]);
    // |height| / max(|height|, tiny): 1 everywhere but on the face.
    let mut gradient = Body::new("gradient", 3);
    let (height, _, _, zero) = parts(&mut gradient);
    let size = gradient.apply(Op::Abs, &[height]);
    let tiny = gradient.number(1e-30);
    let divisor = gradient.apply(Op::Max, &[size, tiny]);
    let slope = gradient.apply(Op::Div, &[size, divisor]);
    [distance, gradient.finish(&[zero, zero, slope])]
}
