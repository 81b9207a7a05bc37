//! The reference modes against closed forms, the comb and each other.

use super::super::camera::Ray;
use super::super::fields::Batch;
use super::super::majorant::{Majorants, Tentative};
use super::super::method::Way;
use super::super::random::{Purpose, Stream};
use super::super::scene::{Integrator, Scene};
use super::super::{Batches, Method, Stats, TubeBounds, Watch, render_by, render_scene};
use super::support::{Body, Gas, World, constant, mixed, norm, sphere, toward};
use crate::interp::Tapes;
use crate::real::length;
use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;
use vol_compiler::frame::{Aabb, Image, Job, LightFrame, Quadrature, Sampling};
use vol_compiler::ops::Op;
use vol_compiler::program::Lighting;

const SIZE: u32 = 8;
const SLOPE: f64 = 0.15;
const EXTINCTION: [f64; 3] = [0.35, 0.8, 2.1];

/// Places in a pixel: the same for the paths and for the comb that they are compared with.
const PLACES: u32 = 8;

/// Independent pictures of so many paths per pixel.
const PICTURES: u64 = 512;

/// Step of the combs that paths are compared with; their error is below [`COMB_ERROR`].
const STEP: f32 = 0.01;

/// Of the comb, relative to the largest value of the picture.
const COMB_ERROR: f64 = 3e-4;

fn by(world: &World, method: Method, job: &Job) -> (Image, Stats) {
    let render = render_by(method, &world.program, &world.frame, job, &|_| {}, &AtomicBool::new(false));
    render.expect("bounded").expect("not cancelled")
}

fn job(step: f32, samples: u32) -> Job {
    Job {
        size: [SIZE; 2],
        step,
        shadow_step: step,
        quadrature: Quadrature::Midpoint,
        sampling: Sampling::uniform(samples),
    }
}

fn fixed(jitter: Option<u64>) -> Method {
    Method::FixedStep { jitter, tube_bounds: TubeBounds::Cells }
}

/// Colours and transmittances of a picture, one after the other.
fn numbers(image: &Image) -> Vec<f64> {
    image.pixels.iter().flat_map(|p| [p.color, p.transmittance]).flatten().map(f64::from).collect()
}

/// Pictures of random paths by the seeds from 0 on.
fn draws(world: &World, samples: u32, count: u64) -> Vec<Image> {
    let job = job(1.0, samples);
    let way = Way::new(Method::MonteCarlo { seed: 0 }, &world.program, &world.frame).expect("bounded");
    let mut scene = Scene { way, ..Scene::new(&world.frame, &job) };
    let watch = Watch { progress: &|_| {}, cancelled: &AtomicBool::new(false) };
    let draw = |number| {
        if let Way::MonteCarlo { seed, .. } = &mut scene.way {
            *seed = number;
        }
        let batches = Batches::DEFAULT;
        render_scene(&world.program, &world.frame, &job, &scene, batches, &watch).expect("not cancelled").0
    };
    (0..count).map(draw).collect()
}

/// How far random pictures are from what is expected, in standard errors of their mean.
struct Deviation {
    /// Of the number that is farthest off.
    worst: f64,
    /// Root mean square over the numbers.
    rms: f64,
    /// Of the sums of colours and of transmittances over the picture, which see a common bias best.
    sums: [f64; 2],
}

/// Mean and standard error of the mean.
fn mean(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let spread: f64 = values.map(|value| (value - mean).powi(2)).sum();
    (mean, (spread / (count * (count - 1.0))).sqrt())
}

fn deviation(world: &World, expected: &[f64]) -> Deviation {
    let pictures: Vec<_> = draws(world, PLACES, PICTURES).iter().map(numbers).collect();
    let most = expected.iter().copied().fold(0.0, f64::max);
    // What none of the paths met may still be met by one of them.
    let least = most / (PICTURES as f64 * f64::from(PLACES));
    let (mut worst, mut squares) = (0.0_f64, 0.0);
    for (index, expected) in expected.iter().enumerate() {
        let (mean, error) = mean(pictures.iter().map(|picture| picture[index]));
        let off = ((mean - expected).abs() - COMB_ERROR * most).max(0.0) / error.max(least);
        worst = worst.max(off);
        squares += off * off;
    }
    let sums = [0, 1].map(|which| {
        let sum = |picture: &[f64]| picture.chunks(3).skip(which).step_by(2).flatten().sum::<f64>();
        let (total, error) = mean(pictures.iter().map(|picture| sum(picture)));
        (total - sum(expected)) / error
    });
    Deviation { worst, rms: (squares / expected.len() as f64).sqrt(), sums }
}

/// 4 standard errors for the picture; for the worst of 384 numbers, 5.
fn assert_unbiased(world: &World, expected: &[f64]) {
    let Deviation { worst, rms, sums } = deviation(world, expected);
    let unbiased = worst < 5.0 && rms < 1.15 && sums.iter().all(|sum| sum.abs() < 4.0);
    assert!(unbiased, "worst {worst}, rms {rms}, sums {sums:?}");
}

fn comb(world: &World) -> Vec<f64> {
    numbers(&by(world, Method::Comb, &job(STEP, PLACES)).0)
}

/// A slab 2 thick, seen from z = 4, before a background.
fn slab(scattering: f64, emission: f64, lighting: Lighting) -> World {
    let mut world = World::new([0.0, 0.0, 4.0], SLOPE as f32);
    world.frame.background = [1.0, 0.5, 0.2];
    let half = [3.0, 3.0, 1.0];
    world.medium(Gas::uniform(half, [scattering; 3], EXTINCTION, [emission; 3], lighting));
    world
}

#[test]
fn paths_through_a_slab() {
    let world = slab(0.0, 0.4, Lighting::None);
    // One place: the pixel's centre, for which the closed form is.
    let pictures = draws(&world, 1, 2000);
    for index in 0..pictures[0].pixels.len() {
        let chord = 2.0 * norm(toward(SIZE, SLOPE, index));
        for (channel, extinction) in EXTINCTION.into_iter().enumerate() {
            let through = (-extinction * chord).exp();
            let lit =
                f64::from(world.frame.background[channel]) * through + 0.4 * (1.0 - through) / extinction;
            let pixel = |picture: &Image| picture.pixels[index];
            let (found, error) = mean(pictures.iter().map(|p| f64::from(pixel(p).transmittance[channel])));
            assert!((found - through).abs() < 4.5 * error, "{found} for {through} within {error}");
            let (found, error) = mean(pictures.iter().map(|p| f64::from(pixel(p).color[channel])));
            assert!((found - lit).abs() < 4.5 * error, "{found} for {lit} within {error}");
        }
    }
}

/// A homogeneous ball of gas that is lit through itself and a lamp.
fn ball(albedo: f64) -> World {
    let mut world = World::new([0.0, 0.0, 4.0], 0.3);
    let scattering = [0.3, 0.5, 1.9].map(|s| s * albedo);
    let region = sphere([0.0; 3], 1.0, 1.0)[0].clone();
    let bounds = Aabb { lo: [-1.0; 3], hi: [1.0; 3] };
    let gas = Gas::uniform([1.0; 3], scattering, EXTINCTION, [0.0, 0.1, 0.0], Lighting::Shadowed);
    world.medium(Gas { region, bounds, ..gas });
    world.sun([0.6, 0.64, 0.48], [5.0, 4.0, 3.0]);
    world.frame.lights.push(LightFrame {
        distant: false,
        position: [-1.5, 0.3, 0.4],
        color: [2.0, 3.0, 4.0],
        shadows: true,
        size: 0.0,
        occlusion: 0.0,
    });
    world
}

#[test]
fn paths_through_a_lit_ball() {
    let world = ball(1.0);
    assert_unbiased(&world, &comb(&world));
}

#[test]
fn a_bias_of_two_per_cent_is_seen() {
    let found = deviation(&ball(1.02), &comb(&ball(1.0)));
    assert!(found.sums[0] > 5.0, "{:?}", found.sums);
}

/// Overlapping media of two kinds, one denser in its middle, solids in them, a sun and a lamp.
#[test]
fn paths_through_everything() {
    let world = mixed();
    assert_unbiased(&world, &comb(&world));
}

#[test]
fn paths_in_a_furnace() {
    let mut world = World::new([0.0, 0.0, 4.0], 0.4);
    world.frame.background = [1.0; 3];
    world.medium(Gas::uniform([1.0, 0.7, 0.9], [0.0; 3], [0.5, 3.0, 9.0], [0.5, 3.0, 9.0], Lighting::None));
    world.medium(Gas::uniform([0.3, 1.7, 1.9], [0.0; 3], [2.0, 0.1, 0.7], [2.0, 0.1, 0.7], Lighting::None));
    let image = by(&world, Method::MonteCarlo { seed: 1 }, &job(1.0, 1024)).0;
    let colors = image.pixels.iter().map(|pixel| f64::from(pixel.color.iter().sum::<f32>() / 3.0));
    let (mean, error) = mean(colors);
    assert!((mean - 1.0).abs() < 4.0 * error && error < 4e-3, "{mean} within {error}");
}

/// Gas that glows and lets everything through has collisions, too.
#[test]
fn paths_through_clear_gas() {
    let mut world = World::new([0.0, 0.0, 4.0], SLOPE as f32);
    world.medium(Gas::uniform([3.0, 3.0, 1.0], [0.0; 3], [0.0; 3], [0.5; 3], Lighting::None));
    let image = by(&world, Method::MonteCarlo { seed: 1 }, &job(1.0, 256)).0;
    let (mean, error) = mean(image.pixels.iter().map(|pixel| f64::from(pixel.color[0])));
    let chords = (0..image.pixels.len()).map(|index| 2.0 * norm(toward(SIZE, SLOPE, index)));
    let expected = 0.5 * chords.sum::<f64>() / f64::from(SIZE * SIZE);
    assert!((mean - expected).abs() < 4.0 * error, "{mean} for {expected} within {error}");
    assert!(image.pixels.iter().all(|pixel| pixel.transmittance == [1.0; 3]));
}

#[test]
fn the_standard_error_falls_with_the_root() {
    let world = ball(1.0);
    let error =
        |samples: u32| by(&world, Method::MonteCarlo { seed: 3 }, &job(1.0, samples)).1.variance.sqrt();
    let (few, many) = (error(16), error(1024));
    assert!((few / many / 8.0 - 1.0).abs() < 0.1, "{few} {many}");
    // It is what pictures by other seeds differ by.
    let pictures: Vec<_> = draws(&world, 16, 32).iter().map(numbers).collect();
    let mut squared = 0.0;
    for index in (0..pictures[0].len()).filter(|index| index % 6 < 3) {
        let (_, error) = mean(pictures.iter().map(|picture| picture[index]));
        squared += 32.0 * error * error;
    }
    assert!((squared.sqrt() / few - 1.0).abs() < 0.15, "{} {few}", squared.sqrt());
}

#[test]
fn references_depend_on_neither_batches_nor_other_pixels() {
    let world = mixed();
    let job = Job { size: [21, 13], ..job(0.07, 3) };
    for method in [fixed(None), fixed(Some(5)), Method::MonteCarlo { seed: 5 }] {
        let scene = || {
            let way = Way::new(method, &world.program, &world.frame).expect("bounded");
            Scene { way, ..Scene::new(&world.frame, &job) }
        };
        let render = |batches| {
            let watch = Watch { progress: &|_| {}, cancelled: &AtomicBool::new(false) };
            let image = render_scene(&world.program, &world.frame, &job, &scene(), batches, &watch);
            image.expect("not cancelled").0
        };
        let image = render(Batches::DEFAULT);
        assert_eq!(image, render(Batches { rays: 7, nodes: 3 }), "{method:?}");
        assert_eq!(image, by(&world, method, &job).0, "{method:?}");
        assert!(numbers(&image).iter().all(|number| number.is_finite()));
    }
    let seeded = |seed| [fixed(Some(seed)), Method::MonteCarlo { seed }].map(|m| by(&world, m, &job).0);
    let ([a, b], [c, d]) = (seeded(1), seeded(2));
    assert!(a != c && b != d);
}

/// Gas whose bounds are loose, so thick that what arrives is up to roulette.
#[test]
fn roulette_keeps_the_mean() {
    let mut world = World::new([0.0, 0.0, 4.0], SLOPE as f32);
    let gas = Gas::uniform([1.0; 3], [0.0; 3], [4.0; 3], [0.0; 3], Lighting::None);
    // 4 + 100 x - 100 x: intervals do not know that it is 4.
    let mut body = Body::new("extinction", 3);
    let (one, hundred, four) = (body.number(1.0), body.number(100.0), body.number(4.0));
    let product = body.apply(Op::Mul, &[body.input(0), hundred]);
    let more = body.apply(Op::Add, &[product, four]);
    let same = body.apply(Op::Sub, &[more, product]);
    world.medium(Gas { extinction: body.finish(&[one, same, same, same]), ..gas });
    let way = Way::new(Method::MonteCarlo { seed: 1 }, &world.program, &world.frame).expect("bounded");
    let scene = Scene { way, ..Scene::new(&world.frame, &job(1.0, 1)) };
    let tapes = Tapes::new(&world.program);
    let fields = Batch::new(&tapes, &world.frame);
    let mut integrator = Integrator::new(&scene, fields, Batches::DEFAULT);
    let ray = |index: u16| Ray::new([f32::from(index) * 1e-5, 0.0, 4.0], [0.0, 0.0, -1.0]);
    let rays: Vec<_> = (0..60_000).map(ray).collect();
    let depths = integrator.reference_depth(&rays, &vec![9.0; rays.len()]).expect("not the comb");
    let (found, error) = mean(depths.iter().map(|depth| (-f64::from(depth[0])).exp()));
    let expected = (-8.0_f64).exp();
    assert!((found - expected).abs() < 4.0 * error, "{found} for {expected} within {error}");
    assert!(error < 0.05 * expected, "{error}");
}

/// The cells that a path goes through are those where it is.
#[test]
fn paths_know_their_cell() {
    let world = mixed();
    let grid = Majorants::new(&world.program, &world.frame).expect("bounded");
    let mut count = 0;
    for index in 0..2000_u16 {
        let turn = f32::from(index) * 0.37;
        let direction = [turn.cos() * 0.8, 0.6 * (0.3 * turn).sin(), turn.sin()];
        let direction = direction.map(|x| x / length(direction));
        let ray = Ray::new([0.01 * turn.sin(), 0.1, 0.2], direction);
        let stream = Stream::of_ray(&ray, 0, Purpose::Path);
        let mut path = grid.path(&ray, 9.0, stream);
        while let Some(Tentative { t, rate }) = path.next::<f32>(&grid) {
            // Beside a wall either cell may be meant.
            let at = |t: f64| [0, 1, 2].map(|i| f64::from(ray.origin[i]) + t * f64::from(ray.direction[i]));
            let rates = [t - 1e-9, t, t + 1e-9].map(|t| grid.rate_at(at(t)));
            assert!(rates.contains(&rate), "{rate} not in {rates:?} at {t}");
            count += 1;
        }
    }
    assert!(count > 3000, "{count}");
}

#[test]
fn no_extinction_is_above_its_majorant() {
    let world = mixed();
    let grid = Majorants::new(&world.program, &world.frame).expect("bounded");
    let mut tight = 0.0_f64;
    for index in 0..40_000_u32 {
        let share = |k: u32| f64::from(index.wrapping_mul(k) >> 8) / f64::from(1 << 24);
        let p = [(share(2_654_435_761), -1.5), (share(2_246_822_519), -0.8), (share(3_266_489_917), -1.0)];
        let p = p.map(|(share, lo)| lo + share * 2.0 * -lo);
        let mut total = 0.0_f64;
        for medium in &world.frame.media {
            let of = |function| {
                let function = world.program.module.function(function);
                vol_compiler::reference::evaluate(function, &p, &[], &[])
            };
            if of(medium.region)[0] < 0.0 {
                let [density, r, g, b] = of(medium.extinction)[..] else { unreachable!("four outputs") };
                total += density.max(0.0) * r.max(g).max(b);
            }
        }
        let rate = grid.rate_at(p);
        assert!(total <= rate, "{total} above {rate} at {p:?}");
        tight = tight.max(total / rate.max(1e-30));
    }
    assert!(tight > 0.9, "{tight}");
}

/// The sum that the paper's loop makes of a homogeneous slab: its transmittance is exact, its light is that
/// of a geometric series with the step's absorption taken first.
#[test]
fn fixed_steps_are_the_papers_loop() {
    let world = slab(0.0, 0.4, Lighting::None);
    for step in [0.1, 0.137, 0.5] {
        let image = by(&world, fixed(None), &job(step, 1)).0;
        for (index, pixel) in image.pixels.iter().enumerate() {
            // The box of the slab is wider than it by a margin for rounding.
            let chord = 2.0 * norm(toward(SIZE, SLOPE, index));
            let count = (chord * 1.00002 / f64::from(step)).ceil();
            let stride = chord / count;
            for (channel, extinction) in EXTINCTION.into_iter().enumerate() {
                let kept = (-extinction * stride).exp();
                let through = kept.powf(count);
                let glow = 0.4 * stride * kept * (1.0 - through) / (1.0 - kept);
                let lit = f64::from(world.frame.background[channel]) * through + glow;
                assert!((f64::from(pixel.transmittance[channel]) - through).abs() < 1e-4);
                assert!(
                    (f64::from(pixel.color[channel]) - lit).abs() < 1e-4,
                    "{} {lit}",
                    pixel.color[channel]
                );
            }
        }
    }
}

/// Where the comb is of second order.
#[test]
fn fixed_steps_are_of_first_order() {
    let mut world = slab(0.3, 0.0, Lighting::Shadowed);
    world.sun([0.0, 0.0, 1.0], [5.0, 5.0, 5.0]);
    let worst = |method: Method, step: f32| {
        let mut worst: f64 = 0.0;
        for (index, pixel) in by(&world, method, &job(step, 1)).0.pixels.iter().enumerate() {
            let slant = norm(toward(SIZE, SLOPE, index));
            for (channel, extinction) in EXTINCTION.into_iter().enumerate() {
                let rate = extinction * (1.0 + slant);
                let lit = 0.3 * 5.0 / (4.0 * PI) * slant * -(-rate * 2.0).exp_m1() / rate;
                let behind = world.frame.background[channel] * pixel.transmittance[channel];
                worst = worst.max((f64::from(pixel.color[channel] - behind) - lit).abs() / lit);
            }
        }
        worst
    };
    let [coarse, fine] = [0.1, 0.025].map(|step| worst(fixed(None), step));
    assert!((3.0..5.0).contains(&(coarse / fine)), "{coarse} {fine}");
    let [coarse_comb, fine_comb] = [0.1, 0.025].map(|step| worst(Method::Comb, step));
    assert!(coarse_comb < coarse / 2.0 && fine_comb < fine / 8.0, "{coarse_comb} {fine_comb}");
}

/// Jitter makes noise of the error, about the same mean.
#[test]
fn jittered_steps_have_the_same_mean() {
    let world = mixed();
    let exact = by(&world, fixed(None), &job(0.005, 1)).0;
    let pictures: Vec<_> =
        (0..64).map(|seed| numbers(&by(&world, fixed(Some(seed)), &job(0.02, 1)).0)).collect();
    let (total, error) = mean(pictures.iter().map(|picture| picture.iter().sum::<f64>()));
    let expected: f64 = numbers(&exact).iter().sum();
    // The error of first order is left.
    assert!((total - expected).abs() < 4.0 * error + 0.02 * expected, "{total} {expected} {error}");
    assert!(error > 0.0);
}

#[test]
fn gas_without_a_bound_is_refused() {
    let mut world = slab(0.0, 0.0, Lighting::None);
    let gas = Gas::uniform([1.0; 3], [0.0; 3], [f64::INFINITY; 3], [0.0; 3], Lighting::None);
    world.medium(Gas { interior: constant("interior", 3, &[f64::INFINITY; 10]), ..gas });
    let method = Method::MonteCarlo { seed: 0 };
    let found =
        render_by(method, &world.program, &world.frame, &job(1.0, 1), &|_| {}, &AtomicBool::new(false));
    assert_eq!(found.map(|_| ()).map_err(|error| error.medium), Err(1));
}

#[test]
fn nothing_to_integrate() {
    let mut world = World::new([0.0, 0.0, 4.0], SLOPE as f32);
    world.frame.background = [0.5; 3];
    for method in [fixed(None), Method::MonteCarlo { seed: 0 }] {
        assert!(by(&world, method, &job(0.1, 2)).0.pixels.iter().all(|pixel| pixel.color == [0.5; 3]));
    }
}
