//! Grids of optical depth against closed forms, marching and each other.

use super::super::fields::Batch;
use super::super::filled_grids::FilledGrids;
use super::super::grid_choice::choose_among;
use super::super::light_grid::{Grid, fill, splined, unpacked};
use super::super::scene::Scene;
use super::super::{Batches, choose_light_grids, render_reference};
use super::support::{Gas, World, constant, mixed, norm, sphere};
use crate::interp::Tapes;
use std::sync::Arc;
use vol_compiler::frame::{Aabb, GridColumn, Job, LightFrame, LightGrid, Quadrature, Sampling};
use vol_compiler::program::Lighting;
use vol_compiler::skip::{Skip, Skips};

const EXTINCTION: [f64; 3] = [0.7, 1.3, 2.1];

/// A picture so large that any grid pays.
const LARGE: Job = Job {
    size: [4096, 4096],
    step: 0.02,
    shadow_step: 0.04,
    quadrature: Quadrature::Midpoint,
    sampling: Sampling::CENTRE,
};

const SUNS: [[f32; 3]; 3] = [[0.0, 1.0, 0.0], [0.48, 0.8, 0.36], [-0.6, 0.0, 0.8]];

const LAMPS: [[f32; 3]; 2] = [[0.3, 5.0, 1.0], [-7.0, -3.0, 4.0]];

fn lamp(position: [f32; 3]) -> LightFrame {
    LightFrame { distant: false, position, color: [30.0; 3], shadows: true, size: 0.0, occlusion: 0.0 }
}

/// A ball of homogeneous gas.
fn ball(centre: [f64; 3], radius: f64, extinction: [f64; 3]) -> Gas {
    let corner = |side: f64| centre.map(|x| (x + side * radius) as f32);
    Gas {
        region: sphere(centre, radius, 1.0)[0].clone(),
        bounds: Aabb { lo: corner(-1.0), hi: corner(1.0) },
        extinction: constant("extinction", 3, &[&[1.0][..], &extinction].concat()),
        ..Gas::uniform([1.0; 3], [0.5; 3], extinction, [0.0; 3], Lighting::Shadowed)
    }
}

/// The world's first light's grid over all of its media.
fn table(world: &World, intervals: u32, shadow_step: f32) -> LightGrid {
    let job = Job { shadow_step, ..LARGE };
    let scene = Scene::<f32>::new(&world.frame, &job);
    let tapes = Tapes::new(&world.program);
    let corner = |axis: usize, lo: bool| {
        let corners = scene.media.iter().map(|medium| if lo { medium.lo[axis] } else { medium.hi[axis] });
        corners.reduce(if lo { f32::min } else { f32::max }).expect("a medium")
    };
    let [lo, hi] = [true, false].map(|lo| [0, 1, 2].map(|axis| corner(axis, lo)));
    let layout = LightGrid::layout(&world.frame.lights[0], &Aabb { lo, hi }, intervals).expect("a layout");
    let (grid, spent) = fill(layout, &scene, || Batch::new(&tapes, &world.frame)).expect("few nodes");
    assert!(spent > 0);
    grid
}

/// Points of low discrepancy in a cube about the origin.
fn points(half: f64) -> impl Iterator<Item = [f64; 3]> {
    let ratios = [0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_970_3];
    (1..2000).map(move |index| ratios.map(|ratio| half * (2.0 * (f64::from(index) * ratio).fract() - 1.0)))
}

/// Rms over points of a cube of the difference to a closed form of the light that arrives.
fn error(grid: &LightGrid, half: f64, length: impl Fn([f64; 3]) -> f64) -> f64 {
    let grid = Grid::<f32>::new(&Arc::new(grid.clone()));
    let mut sum = 0.0;
    for point in points(half) {
        let got = grid.depth(point.map(|x| x as f32));
        for (got, extinction) in got.into_iter().zip(EXTINCTION) {
            assert!(got.is_finite() && got >= 0.0);
            sum += ((-f64::from(got)).exp() - (-extinction * length(point)).exp()).powi(2);
        }
    }
    (sum / (3.0 * 1999.0)).sqrt()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Length in the unit ball of the way from a point along a unit direction, no farther than `most`.
fn in_ball(point: [f64; 3], direction: [f64; 3], most: f64) -> f64 {
    let along = dot(point, direction);
    let square = along * along - dot(point, point) + 1.0;
    let half = square.max(0.0).sqrt();
    ((-along + half).clamp(0.0, most) - (-along - half).clamp(0.0, most)).max(0.0)
}

/// The same in a box about the origin.
fn in_box(point: [f64; 3], direction: [f64; 3], half: [f64; 3]) -> f64 {
    let (mut entry, mut exit) = (0.0_f64, 1e9_f64);
    for axis in 0..3 {
        let (o, d) = (point[axis], direction[axis]);
        if d.abs() < 1e-12 {
            exit = if o.abs() > half[axis] { 0.0 } else { exit };
            continue;
        }
        let [a, b] = [(-half[axis] - o) / d, (half[axis] - o) / d];
        (entry, exit) = (entry.max(a.min(b)), exit.min(a.max(b)));
    }
    (exit - entry).max(0.0)
}

/// Grids of a homogeneous unit ball. About its rim the way through it falls like a square root, so that over
/// all points the error is of first order; deep inside it is smooth.
fn converges(world: &World, length: impl Fn([f64; 3]) -> f64) {
    let grids = [32, 128].map(|intervals| table(world, intervals, 0.01));
    let [coarse, fine] = grids.each_ref().map(|grid| [1.3, 0.4].map(|half| error(grid, half, &length)));
    assert!(coarse[0] < 4e-2 && fine[0] < 1.2e-2 && fine[0] < 0.4 * coarse[0], "{coarse:?} {fine:?}");
    assert!(fine[1] < 2e-4 && fine[1] < 0.3 * coarse[1], "{coarse:?} {fine:?}");
    // Of a spline only rounding is left.
    let [coarse, fine] =
        grids.map(|grid| error(&splined(&grid, usize::MAX).expect("few words"), 0.4, &length));
    assert!(coarse < 4e-5 && fine < 1e-6, "{coarse:e} {fine:e}");
}

#[test]
fn a_ball_under_a_sun() {
    for sun in SUNS {
        let mut world = World::new([0.0, 0.0, 4.0], 0.5);
        world.medium(ball([0.0; 3], 1.0, EXTINCTION));
        world.sun(sun, [1.0; 3]);
        let length = |point| in_ball(point, sun.map(f64::from), 1e9);
        converges(&world, length);
    }
}

#[test]
fn a_ball_under_a_lamp() {
    for position in LAMPS {
        let mut world = World::new([0.0, 0.0, 4.0], 0.5);
        world.medium(ball([0.0; 3], 1.0, EXTINCTION));
        world.frame.lights.push(lamp(position));
        let length = |point: [f64; 3]| {
            let toward: [f64; 3] = std::array::from_fn(|axis| f64::from(position[axis]) - point[axis]);
            let distance = norm(toward);
            in_ball(point, toward.map(|x| x / distance), distance)
        };
        converges(&world, length);
    }
}

#[test]
fn a_slab_under_a_sun() {
    let half = [0.9, 0.4, 1.1];
    for sun in SUNS {
        let mut world = World::new([0.0, 0.0, 4.0], 0.5);
        world.medium(Gas::uniform(half, [0.5; 3], EXTINCTION, [0.0; 3], Lighting::Shadowed));
        world.sun(sun, [1.0; 3]);
        let length = |point| in_box(point, sun.map(f64::from), half);
        let error = error(&table(&world, 128, 0.02), 1.3, length);
        // Along a face the wall is as wide as the distance between points.
        let steep = sun.iter().filter(|x| **x != 0.0).count() < 3;
        assert!(error < if steep { 4e-2 } else { 4e-3 }, "{sun:?}: {error:e}");
    }
}

#[test]
fn one_color_is_one_channel() {
    let mut world = World::new([0.0, 0.0, 4.0], 0.5);
    world.medium(ball([0.0; 3], 1.0, EXTINCTION));
    world.sun(SUNS[1], [1.0; 3]);
    let grid = table(&world, 16, 0.02);
    assert!(!grid.colored && grid.words() < grid.most_words());
    world.medium(ball([0.3, 0.0, 0.0], 0.5, [2.0, 0.0, 0.0]));
    let both = table(&world, 16, 0.02);
    assert!(both.colored && both.depths.len() > 2 * grid.depths.len());
    // Where the second ball is not, nothing has changed.
    let at = |grid: &LightGrid| Grid::<f32>::new(&Arc::new(grid.clone())).depth([-0.8, 0.1, 0.2]);
    let (one, three) = (at(&grid), at(&both));
    assert!(one.iter().zip(three).all(|(a, b)| (a - b).abs() < 1e-4 * a), "{one:?} {three:?}");
}

#[test]
fn f32_looks_up_what_f64_does() {
    let mut world = World::new([0.0, 0.0, 4.0], 0.5);
    world.medium(ball([0.0; 3], 1.0, EXTINCTION));
    world.frame.lights.push(lamp(LAMPS[0]));
    let grid = Arc::new(table(&world, 48, 0.02));
    let (single, double) = (Grid::<f32>::new(&grid), Grid::<f64>::new(&grid));
    for point in points(1.2) {
        let rounded = point.map(|x| x as f32);
        let (got, want) = (single.depth(rounded), double.depth(rounded.map(f64::from)));
        assert!((0..3).all(|i| (f64::from(got[i]) - want[i]).abs() < 5e-5), "{point:?}: {got:?} {want:?}");
    }
}

#[test]
fn columns_keep_what_lookups_need() {
    let mut world = World::new([0.0, 0.0, 4.0], 0.5);
    world.medium(ball([-1.2, 0.5, 0.1], 0.4, EXTINCTION));
    world.medium(ball([0.9, -0.6, 0.0], 0.5, [2.0, 0.0, 0.0]));
    for light in [None, Some(lamp(LAMPS[0]))] {
        world.frame.lights.clear();
        match light {
            Some(lamp) => world.frame.lights.push(lamp),
            None => world.sun(SUNS[1], [1.0; 3]),
        }
        let kept = table(&world, 48, 0.02);
        assert!(kept.words() < kept.most_words() / 3, "{} of {}", kept.words(), kept.most_words());
        // The same with all points of all columns.
        let (count, channels) = (kept.counts[2], kept.channels() as u32);
        let columns = (0..kept.columns.len() as u32).map(|index| GridColumn {
            first: 0,
            count,
            at: index * count * channels,
        });
        let all = LightGrid { columns: columns.collect(), depths: unpacked(&kept), ..kept.clone() };
        let [kept, all] = [kept, all].map(|grid| Grid::<f32>::new(&Arc::new(grid)));
        for point in points(2.0) {
            let point = point.map(|x| x as f32);
            assert_eq!(kept.depth(point).map(f32::to_bits), all.depth(point).map(f32::to_bits), "{point:?}");
        }
    }
}

#[test]
fn nothing_is_before_or_beside_a_grid() {
    let mut world = World::new([0.0, 0.0, 4.0], 0.5);
    world.medium(ball([0.0; 3], 1.0, EXTINCTION));
    world.sun([0.0, 1.0, 0.0], [1.0; 3]);
    world.frame.lights.push(lamp([0.0, 4.0, 0.0]));
    let sun = Grid::<f32>::new(&Arc::new(table(&world, 32, 0.02)));
    world.frame.lights.remove(0);
    let lamp = Grid::<f32>::new(&Arc::new(table(&world, 32, 0.02)));
    for grid in [&sun, &lamp] {
        for point in [[0.0, 1.1, 0.0], [0.0, 3.9, 0.0], [3.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 9.0, 0.0]] {
            assert_eq!(grid.depth(point), [0.0; 3], "{point:?}");
        }
        let behind = grid.depth([0.0, -8.0, 0.0]);
        assert!((behind[0] - 1.4).abs() < 5e-3, "{behind:?}");
    }
    // Anywhere the numbers are finite.
    for power in -30..=6 {
        for point in points(10.0_f64.powi(power)).take(20) {
            for offset in [0.0, 4.0] {
                let [x, y, z] = point.map(|x| x as f32);
                let depths = [sun.depth([x, y + offset, z]), lamp.depth([x, y + offset, z])];
                assert!(depths.as_flattened().iter().all(|x| x.is_finite() && *x >= 0.0), "{point:?}");
            }
        }
    }
}

#[test]
fn flat_tiny_and_opaque_media() {
    let halves = [[1.0, 1e-4, 1.0], [1e-4, 1e-4, 1e-4], [1.0, 1.0, 1e-4], [1e-3, 1.0, 1e-3]];
    for half in halves {
        for density in [1.0, 1e12, 3e38] {
            let mut world = World::new([0.0, 0.0, 4.0], 0.5);
            world.medium(Gas::uniform(half, [0.5; 3], [density; 3], [0.0; 3], Lighting::Shadowed));
            world.sun(SUNS[1], [1.0; 3]);
            let grid = Grid::<f32>::new(&Arc::new(table(&world, 32, 0.02)));
            for point in points(1.0) {
                let point: [f32; 3] = std::array::from_fn(|axis| (point[axis] * half[axis]) as f32);
                assert!(grid.depth(point).iter().all(|x| x.is_finite() && *x >= 0.0), "{half:?} {density}");
            }
        }
    }
}

/// Relative rms of the difference of two pictures of a world.
fn apart(a: &World, b: &World) -> f64 {
    let job = Job { size: [48, 48], ..LARGE };
    let [a, b] = [a, b].map(|world| world.render_with(&job, Batches::DEFAULT));
    let (mut changed, mut whole) = (0.0, 0.0);
    for (a, b) in a.pixels.iter().zip(&b.pixels) {
        for (a, b) in a.color.iter().zip(b.color) {
            changed += f64::from(a - b).powi(2);
            whole += f64::from(b).powi(2);
        }
    }
    (changed / whole).sqrt()
}

/// Solids in two overlapping media under a sun and two lamps, the last of which sees them under too wide an
/// angle.
fn crowd() -> World {
    let mut world = mixed();
    world.frame.lights.insert(0, lamp([-4.0, 5.0, 3.0]));
    world
}

#[test]
fn chosen_grids_change_a_picture_by_what_is_allowed() {
    for max_error in [3e-2, 1e-2] {
        let marched = crowd();
        let mut looked_up = crowd();
        let choices = choose_light_grids(&marched.program, &marched.frame, &LARGE, max_error);
        assert_eq!(choices.len(), 3);
        let chosen: Vec<bool> = choices.iter().map(|choice| choice.grid.is_some()).collect();
        assert_eq!(chosen, [true, true, false], "{choices:?}");
        assert!(choices.iter().all(|choice| choice.error.is_none_or(|error| error <= 0.5 * max_error)));
        looked_up.frame.light_grids = choices.into_iter().map(|choice| choice.grid).collect();
        let apart = apart(&looked_up, &marched);
        assert!(apart > 1e-6 && apart < f64::from(max_error), "{apart:e} for {max_error}");
        // Grids that are there already do not count.
        let again = choose_light_grids(&looked_up.program, &looked_up.frame, &LARGE, max_error);
        assert!(again.iter().zip(&looked_up.frame.light_grids).all(|(a, b)| a.grid == *b));
    }
}

/// How many grids were there already for a world, whose choices must be as if there had been none.
fn reused(world: &World, filled: &mut FilledGrids) -> u64 {
    let before = filled.reused();
    let fresh = choose_light_grids(&world.program, &world.frame, &LARGE, 3e-2);
    let found = choose_among(&world.program, &world.frame, &LARGE, 3e-2, filled);
    for (found, fresh) in found.iter().zip(&fresh) {
        assert_eq!(found.grid, fresh.grid);
        assert_eq!(found.error.map(f32::to_bits), fresh.error.map(f32::to_bits));
    }
    filled.reused() - before
}

#[test]
fn filled_grids_are_kept_while_media_and_lights_stay() {
    let mut filled = FilledGrids::default();
    let mut world = crowd();
    assert_eq!(reused(&world, &mut filled), 0, "nothing is there");
    let all = reused(&world, &mut filled);
    assert!(all >= 2, "{all}");
    world.frame.camera.origin[0] += 0.25;
    world.frame.background = [0.5; 3];
    assert!(reused(&world, &mut filled) >= 2, "the first grid of each light does not depend on the eye");
    world.frame.lights[0].position[1] += 0.25;
    let others = reused(&world, &mut filled);
    assert!(others > 0 && others < all, "{others}: one light has moved");
    let mut moved = crowd();
    moved.frame.media[0].bounds.hi[0] += 0.125;
    moved.frame.media[0].cells.clear();
    assert_eq!(reused(&moved, &mut filled), 0, "a medium has changed");
    assert_eq!(reused(&crowd(), &mut filled), 0, "and changed back");
    moved.frame.skips = Skips::ALL.without(Skip::SameGrids);
    assert_eq!([reused(&moved, &mut filled), reused(&moved, &mut filled)], [0, 0], "switched off");
}

#[test]
fn the_reference_marches() {
    let job = Job {
        size: [6, 4],
        step: 0.2,
        shadow_step: 0.3,
        quadrature: Quadrature::Midpoint,
        sampling: Sampling::CENTRE,
    };
    let mut world = crowd();
    let want = render_reference(&world.program, &world.frame, &job);
    let choices = choose_light_grids(&world.program, &world.frame, &LARGE, 3e-2);
    world.frame.light_grids = choices.into_iter().map(|choice| choice.grid).collect();
    assert_eq!(render_reference(&world.program, &world.frame, &job), want);
}

#[test]
fn where_marching_is_better() {
    let none = |world: &World, job: &Job| {
        let choices = choose_light_grids(&world.program, &world.frame, job, 1e-2);
        choices.iter().all(|choice| choice.grid.is_none())
    };
    let foggy = |gas: Gas| {
        let mut world = World::new([0.0, 0.0, 4.0], 0.3);
        world.medium(gas);
        world.sun(SUNS[1], [1.0; 3]);
        world
    };
    let gas = || ball([0.0; 3], 1.0, EXTINCTION);
    assert!(!none(&foggy(gas()), &LARGE), "the others differ from this one");
    assert!(none(&foggy(gas()), &Job { size: [4, 4], ..LARGE }), "a small picture");
    let endless = Aabb { lo: [f32::NEG_INFINITY; 3], hi: [f32::INFINITY; 3] };
    assert!(none(&foggy(Gas { bounds: endless, ..gas() }), &Job { step: 0.5, shadow_step: 0.5, ..LARGE }));
    assert!(none(&foggy(Gas { lighting: Lighting::Unshadowed, ..gas() }), &LARGE), "no shadows in it");
    let mut world = foggy(gas());
    world.frame.lights[0].shadows = false;
    assert!(none(&world, &LARGE), "no shadows at all");
    world.frame.lights[0] = lamp([0.2, 0.1, 0.3]);
    assert!(none(&world, &LARGE), "a light in the medium");
    world.frame.lights.clear();
    assert!(none(&world, &LARGE) && none(&World::new([0.0; 3], 0.3), &LARGE), "nothing");
}
