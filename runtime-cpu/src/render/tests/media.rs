//! Absorption, emission and single scattering against closed forms.

use super::support::{Body, Gas, MATT, World, bits, constant, glowing, mixed, norm, toward};
use std::f64::consts::PI;
use vol_compiler::frame::{Aabb, Image, Pixel, Quadrature};
use vol_compiler::program::Lighting;

const SIZE: u32 = 8;
const SLOPE: f64 = 0.15;
const EXTINCTION: [f64; 3] = [0.35, 0.8, 2.1];

/// A slab 2 thick about the origin, wide enough to be met by its faces alone, seen from z = 4.
fn slab(scattering: f64, emission: f64, lighting: Lighting) -> World {
    let mut world = World::new([0.0, 0.0, 4.0], SLOPE as f32);
    let half = [3.0, 3.0, 1.0];
    world.medium(Gas::uniform(half, [scattering; 3], EXTINCTION, [emission; 3], lighting));
    world
}

/// Length of each pixel's ray in the slab.
fn chord(index: usize) -> f64 {
    2.0 * norm(toward(SIZE, SLOPE, index))
}

/// Pixels with their numbers and what they may be off: uniform matter is exact by the midpoint rule, while the
/// corrected form is of second order at walls, where panels are thin; these are coarse.
fn with_tolerance([midpoint, corrected]: &[Image; 2]) -> impl Iterator<Item = (usize, Pixel, f64)> {
    let of = |image: &Image, tolerance: f64| {
        let pixels = image.pixels.clone().into_iter().enumerate();
        pixels.map(move |(index, pixel)| (index, pixel, tolerance))
    };
    of(midpoint, 1e-5).chain(of(corrected, 1e-2))
}

fn assert_close(got: [f32; 3], want: impl Fn(f64) -> f64, tolerance: f64) {
    for (got, extinction) in got.into_iter().zip(EXTINCTION) {
        let want = want(extinction);
        assert!((f64::from(got) - want).abs() < tolerance, "{got} for {want}");
    }
}

#[test]
fn slab_absorbs_by_beer_lambert() {
    let mut world = slab(0.0, 0.0, Lighting::None);
    world.frame.background = [1.0, 1.0, 1.0];
    for step in [0.031, 0.1, 0.137, 0.5, 0.77] {
        for (index, pixel) in world.both(SIZE, step).iter().flat_map(|image| image.pixels.iter().enumerate())
        {
            let through = |extinction: f64| (-extinction * chord(index)).exp();
            assert_close(pixel.transmittance, through, 1e-5);
            assert_close(pixel.color, through, 1e-5);
            assert_eq!(pixel.depth, f32::INFINITY);
        }
    }
}

/// Nothing is left out or counted twice where one node stands for another number of steps than the next.
#[test]
fn slabs_absorb_as_well_where_spacings_differ() {
    for (spacings, step) in
        [([1, 8], 0.031), ([1, 16], 0.05), ([2, 16], 0.031), ([4, 1], 0.1), ([8, 8], 0.03)]
    {
        let mut world = slab(0.0, 0.0, Lighting::None);
        let inner = [0.9, 0.1, 0.4];
        world.medium(Gas::uniform([3.0, 3.0, 0.3], [0.0; 3], inner, [0.0; 3], Lighting::None));
        world.frame.background = [1.0; 3];
        world.frame.media.iter_mut().zip([spacings[1], spacings[0]]).for_each(|(medium, spacing)| {
            medium.spacing = spacing;
        });
        let image = world.render(SIZE, step);
        for (index, pixel) in image.pixels.iter().enumerate() {
            for ((got, outer), inner) in pixel.transmittance.into_iter().zip(EXTINCTION).zip(inner) {
                let want = (-(outer + 0.3 * inner) * chord(index)).exp();
                assert!((f64::from(got) - want).abs() < 1e-5, "{got} for {want}, {spacings:?}, step {step}");
            }
        }
        // The other quadrature takes no notice.
        let mut even = World { quadrature: Quadrature::Corrected, ..world };
        let spaced = even.render(SIZE, step);
        even.frame.media.iter_mut().for_each(|medium| medium.spacing = 1);
        let numbers = |image: Image| image.pixels.iter().map(bits).collect::<Vec<_>>();
        assert_eq!(numbers(spaced), numbers(even.render(SIZE, step)));
    }
}

#[test]
fn slab_emits() {
    let world = slab(0.0, 0.4, Lighting::None);
    for step in [0.031, 0.137, 0.5] {
        for (index, pixel, tolerance) in with_tolerance(&world.both(SIZE, step)) {
            assert_close(
                pixel.color,
                |extinction| 0.4 * -(-extinction * chord(index)).exp_m1() / extinction,
                tolerance,
            );
        }
    }
}

#[test]
fn clear_gas_emits() {
    let mut world = World::new([0.0, 0.0, 4.0], SLOPE as f32);
    world.medium(Gas::uniform([3.0, 3.0, 1.0], [0.0; 3], [0.0; 3], [0.5; 3], Lighting::None));
    for (index, pixel) in world.both(SIZE, 0.137).iter().flat_map(|image| image.pixels.iter().enumerate()) {
        assert!((f64::from(pixel.color[0]) - 0.5 * chord(index)).abs() < 1e-5);
        assert_eq!(pixel.transmittance, [1.0; 3]);
    }
}

#[test]
fn slab_scatters_unshadowed() {
    let mut world = slab(0.3, 0.0, Lighting::Unshadowed);
    world.sun([0.6, 0.0, 0.8], [5.0, 5.0, 5.0]);
    let source = 0.3 * 5.0 / (4.0 * PI);
    for (index, pixel, tolerance) in with_tolerance(&world.both(SIZE, 0.137)) {
        assert_close(
            pixel.color,
            |extinction| source * -(-extinction * chord(index)).exp_m1() / extinction,
            tolerance,
        );
    }
}

/// The light is behind the eye, so a point at depth x sees it through x of gas.
#[test]
fn slab_shadows_itself_to_second_order() {
    let worst = |quadrature: Quadrature, step: f32| {
        let mut world = slab(0.3, 0.0, Lighting::Shadowed);
        world.quadrature = quadrature;
        world.sun([0.0, 0.0, 1.0], [5.0, 5.0, 5.0]);
        let mut worst: f64 = 0.0;
        for (index, pixel) in world.render(SIZE, step).pixels.iter().enumerate() {
            let slant = norm(toward(SIZE, SLOPE, index));
            for (got, extinction) in pixel.color.into_iter().zip(EXTINCTION) {
                let rate = extinction * (1.0 + slant);
                let want = 0.3 * 5.0 / (4.0 * PI) * slant * -(-rate * 2.0).exp_m1() / rate;
                worst = worst.max((f64::from(got) - want).abs() / want);
            }
        }
        worst
    };
    for quadrature in [Quadrature::Midpoint, Quadrature::Corrected] {
        let (coarse, fine) = (worst(quadrature, 0.1), worst(quadrature, 0.025));
        assert!(coarse < 4e-2, "{quadrature:?} {coarse:e}");
        assert!(fine < 0.1 * coarse, "{quadrature:?} {coarse:e} {fine:e}");
    }
}

/// In an oven of radiance 1 every gas that glows at that temperature is invisible.
#[test]
fn furnace_is_white() {
    let mut world = World::new([0.0, 0.0, 4.0], 0.4);
    world.frame.background = [1.0; 3];
    world.medium(Gas::uniform([1.0, 0.7, 0.9], [0.0; 3], [0.5, 3.0, 9.0], [0.5, 3.0, 9.0], Lighting::None));
    world.medium(Gas::uniform([0.3, 1.7, 1.9], [0.0; 3], [2.0, 0.1, 0.7], [2.0, 0.1, 0.7], Lighting::None));
    for (_, pixel, tolerance) in with_tolerance(&world.both(24, 0.173)) {
        for channel in pixel.color {
            assert!((channel - 1.0).abs() < tolerance as f32, "{channel}");
        }
    }
}

#[test]
fn surface_stands_in_gas() {
    let mut world = slab(0.0, 0.0, Lighting::None);
    world.ball([0.0, 0.0, -5.0], 5.0, glowing([1.0; 3]));
    for (index, pixel) in world.both(SIZE, 0.137).iter().flat_map(|image| image.pixels.iter().enumerate()) {
        // The ball's top is at z = 0: solve |4 z + t d - c| = 5 for the point that is seen.
        let direction = toward(SIZE, SLOPE, index);
        let (a, b, c) = (norm(direction).powi(2), -9.0, 81.0 - 25.0);
        let t = (-b - (b * b - a * c).sqrt()) / a;
        let path = (t - 3.0) * norm(direction);
        assert_close(pixel.color, |extinction| (-extinction * path).exp(), 1e-5);
        assert_eq!(pixel.transmittance, [0.0; 3]);
        assert!((f64::from(pixel.depth) - t).abs() < 1e-5);
    }
}

#[test]
fn eye_inside_gas() {
    let mut world = slab(0.0, 0.0, Lighting::None);
    world.frame.camera.origin = [0.0, 0.0, 0.63];
    for step in [0.05, 0.137, 0.5] {
        for (index, pixel) in world.both(SIZE, step).iter().flat_map(|image| image.pixels.iter().enumerate())
        {
            let path = 1.63 * norm(toward(SIZE, SLOPE, index));
            assert_close(pixel.transmittance, |extinction| (-extinction * path).exp(), 1e-5);
        }
    }
}

#[test]
fn boxes_only_skip() {
    let mut world = mixed();
    let tight = world.both(20, 0.11);
    for medium in &mut world.frame.media {
        medium.bounds = Aabb { lo: medium.bounds.lo.map(|x| x - 3.0), hi: medium.bounds.hi.map(|x| x + 2.0) };
    }
    assert_eq!(world.both(20, 0.11), tight);
}

/// The boxes of a grid over a box, without those that a ball inside does not meet.
fn cells(bounds: Aabb, parts: u8) -> Vec<Aabb> {
    let edge = |axis: usize, i: u8| {
        bounds.lo[axis] + (bounds.hi[axis] - bounds.lo[axis]) * f32::from(i) / f32::from(parts)
    };
    let middle = [0, 1, 2].map(|axis| 0.5 * (bounds.lo[axis] + bounds.hi[axis]));
    let radius = 0.5 * (bounds.hi[0] - bounds.lo[0]);
    let mut cells = Vec::new();
    for index in 0..u32::from(parts).pow(3) {
        let place = [0, 1, 2].map(|axis| (index / u32::from(parts).pow(axis) % u32::from(parts)) as u8);
        let lo = [0, 1, 2].map(|axis| edge(axis, place[axis]));
        let hi = [0, 1, 2].map(|axis| edge(axis, place[axis] + 1));
        let apart = [0, 1, 2].map(|i| (lo[i] - middle[i]).max(middle[i] - hi[i]).max(0.0));
        if apart.iter().map(|x| x * x).sum::<f32>() <= radius * radius {
            cells.push(Aabb { lo, hi });
        }
    }
    cells
}

#[test]
fn cells_only_skip() {
    let mut world = mixed();
    let ball = world.frame.media[1].bounds;
    for (step, quadrature) in [
        (0.03, Quadrature::Midpoint),
        (0.11, Quadrature::Midpoint),
        (0.4, Quadrature::Midpoint),
        (0.03, Quadrature::Corrected),
        (0.4, Quadrature::Corrected),
    ] {
        world.quadrature = quadrature;
        world.frame.media[1].cells = vec![ball];
        let whole = world.render_counted(20, step);
        world.frame.media[1].cells = cells(ball, 7);
        assert!(world.frame.media[1].cells.len() < 300);
        let skipping = world.render_counted(20, step);
        assert_eq!(skipping.0, whole.0, "step {step}");
        assert!(skipping.1.region_evaluations < whole.1.region_evaluations, "step {step}");
        assert_eq!(skipping.1.medium_samples, whole.1.medium_samples, "step {step}");
    }
}

#[test]
fn gas_without_bounds_ends() {
    let mut world = slab(0.0, 0.0, Lighting::None);
    world.frame.media[0].bounds = Aabb { lo: [f32::NEG_INFINITY; 3], hi: [f32::INFINITY; 3] };
    let images = world.both(4, 0.1);
    world.frame.media[0].bounds = Aabb { lo: [-3.0, -3.0, -1.0], hi: [3.0, 3.0, 1.0] };
    assert_eq!(images, world.both(4, 0.1));
}

/// Gas between a matt wall and the light weakens it as it weakens the wall for the eye.
#[test]
fn gas_casts_shadows_on_surfaces() {
    let mut world = slab(0.0, 0.0, Lighting::None);
    let mut distance = Body::new("wall", 3);
    let from = distance.relative_to([0.0, 0.0, -2.0]);
    let wall = [distance.finish(&from[2..]), constant("out", 3, &[0.0, 0.0, 1.0])];
    let bounds = Aabb { lo: [-9.0, -9.0, -3.0], hi: [9.0, 9.0, -2.0] };
    world.solid(wall, MATT, bounds, 1.0);
    world.sun([0.0, 0.0, 1.0], [1.0; 3]);
    for (index, pixel) in world.both(SIZE, 0.1).iter().flat_map(|image| image.pixels.iter().enumerate()) {
        assert_close(pixel.color, |extinction| (-extinction * (2.0 + chord(index))).exp(), 1e-5);
    }
}
