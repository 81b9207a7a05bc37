//! Beams against the rays in them.

use super::super::{Batch, Batches, Integrator, Ray, Scene};
use super::support::{MATT, World, floor, sphere};
use crate::interp::Tapes;
use vol_compiler::frame::{Aabb, Job, Quadrature, Sampling};

const JOB: Job = Job {
    size: [16, 16],
    step: 1.0,
    shadow_step: 1.0,
    quadrature: Quadrature::Midpoint,
    sampling: Sampling::CENTRE,
};

/// Length of the rays: they end below the floor.
const LENGTH: f32 = 12.0;

/// Least step of a ray.
const LEAST: f32 = 1e-3;

/// Balls over an endless floor, one of them of a field that is three times as steep as a distance.
fn world() -> World {
    let mut world = World::new([0.0, 0.0, 4.0], 0.4);
    world.ball([0.0, 0.5, 0.0], 0.4, MATT);
    world.ball([0.9, 1.5, 0.2], 0.3, MATT);
    let bounds = Aabb { lo: [-1.4, 0.6, -0.4], hi: [-0.6, 1.4, 0.4] };
    world.solid(sphere([-1.0, 1.0, 0.0], 0.4, 3.0), MATT, bounds, 1.0 / 3.0);
    world.solid(floor(0.0), MATT, Aabb { lo: [f32::NEG_INFINITY; 3], hi: [f32::INFINITY; 3] }, 1.0);
    world
}

/// Down at a slant, through a place at the height 4.
fn ray([x, z]: [f32; 2]) -> Ray<f32> {
    Ray::new([x, 4.0, z], [0.0, -0.8, 0.6])
}

/// The middles of beams side by side.
fn middles() -> Vec<[f32; 2]> {
    (0..900).map(|i| [(i % 30) as f32 * 0.1 - 1.5, (i / 30) as f32 * 0.1 - 3.5]).collect()
}

#[test]
fn beams_end_before_their_rays_meet_anything() {
    let world = world();
    let (scene, tapes) = (Scene::new(&world.frame, &JOB), Tapes::new(&world.program));
    let mut integrator = Integrator::new(&scene, Batch::new(&tapes, &world.frame), Batches::DEFAULT);
    for radius in [0.4, 0.1, 0.02] {
        let axes: Vec<_> = middles().into_iter().map(ray).collect();
        let starts = vec![0.0; axes.len()];
        let clear = integrator.clear_lengths(&axes, radius, &starts, LENGTH);
        // All but the slowest get to where a ball of twice the radius is empty.
        assert!(clear.iter().all(|&clear| clear > 1.0), "radius {radius}");
        for turn in [0.0_f32, 1.3, 2.6, 3.9, 5.2] {
            // Across the rays.
            let [a, b] = [0.98 * radius * turn.cos(), 0.98 * radius * turn.sin()];
            let beside = |middle: &Ray<f32>| {
                let [x, y, z] = middle.origin;
                Ray::new([x + a, y + 0.6 * b, z + 0.8 * b], middle.direction)
            };
            let rays: Vec<_> = axes.iter().map(beside).collect();
            let wanted = integrator.entries(&rays, &starts, LENGTH, LEAST);
            let found = integrator.entries(&rays, &clear, LENGTH, LEAST);
            for (ray, (wanted, found)) in wanted.into_iter().zip(found).enumerate() {
                let (Some(wanted), Some(found)) = (wanted, found) else { panic!("the floor is below all") };
                assert!(wanted >= clear[ray], "radius {radius}: {wanted} before {}", clear[ray]);
                // Both are at most a step behind the surface.
                assert!((wanted - found).abs() <= 1.01 * LEAST, "radius {radius}: {wanted} {found}");
            }
        }
    }
}

#[test]
fn beams_that_meet_nothing_go_to_their_ends() {
    let mut world = World::new([0.0, 0.0, 4.0], 0.4);
    world.ball([0.0, 0.5, 0.0], 0.4, MATT);
    let (scene, tapes) = (Scene::new(&world.frame, &JOB), Tapes::new(&world.program));
    let mut integrator = Integrator::new(&scene, Batch::new(&tapes, &world.frame), Batches::DEFAULT);
    let axes = [ray([3.0, 0.0]), ray([0.0, -2.6])];
    let clear = integrator.clear_lengths(&axes, 0.1, &[0.0, 0.0], LENGTH);
    assert!(clear[0] >= LENGTH && clear[1] < LENGTH, "{clear:?}");
}
