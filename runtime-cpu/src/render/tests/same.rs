//! What must not change a picture, and what the pilot and the controls do.

use super::super::{
    Batches, camera, choose_step, chord, comb, medium, near, panel, render, render_reference, sampling,
    shadow, surface,
};
use super::support::{World, bits, mixed};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use vol_compiler::frame::{Image, Job, Quadrature, Sampling};

const JOB: Job = Job {
    size: [37, 21],
    step: 0.11,
    shadow_step: 0.2,
    quadrature: Quadrature::Midpoint,
    sampling: Sampling::CENTRE,
};

fn with_threads(world: &World, job: &Job, threads: usize) -> Image {
    let idle = AtomicBool::new(false);
    render(&world.program, &world.frame, job, Some(threads), &|_| {}, &idle).expect("not cancelled").0
}

fn same_bits(a: &Image, b: &Image) -> bool {
    a.pixels.iter().zip(&b.pixels).all(|(a, b)| bits(a) == bits(b))
}

#[test]
fn threads_change_nothing() {
    let world = mixed();
    let one = with_threads(&world, &JOB, 1);
    for threads in [2, 3] {
        assert!(same_bits(&one, &with_threads(&world, &JOB, threads)), "{threads} threads");
    }
}

#[test]
fn batches_change_nothing() {
    let world = mixed();
    let usual = world.render_with(&JOB, Batches::DEFAULT);
    for (rays, nodes) in [(1, 1), (7, 3), (64, 50), (256, 1000)] {
        let other = world.render_with(&JOB, Batches { rays, nodes });
        assert!(same_bits(&usual, &other), "{rays} rays, {nodes} nodes");
    }
}

#[test]
fn order_of_light_is_kept() {
    // The picture is not trivially constant: the comparisons above compare something.
    let image = mixed().render_with(&JOB, Batches::DEFAULT);
    let hits = image.pixels.iter().filter(|pixel| pixel.depth.is_finite()).count();
    assert!(hits > 200 && hits < image.pixels.len() - 50, "{hits}");
}

#[test]
fn f32_is_near_f64() {
    let world = mixed();
    let image = world.render_with(&JOB, Batches::DEFAULT);
    let reference = render_reference(&world.program, &world.frame, &JOB);
    let mut outliers = 0;
    for (pixel, want) in image.pixels.iter().zip(&reference) {
        let got = [pixel.color, pixel.transmittance].concat();
        let off = got.iter().zip(want).map(|(&got, &want)| (f64::from(got) - want).abs());
        outliers += usize::from(off.fold(0.0, f64::max) > 2e-5);
    }
    // A ray that touches an edge of a solid or of a shadow may fall on the other side of it.
    assert!(outliers <= reference.len() / 100, "{outliers} of {}", reference.len());
}

#[test]
fn progress_reaches_the_end() {
    let world = mixed();
    let most = AtomicU64::new(0);
    let progress = |done| {
        most.fetch_max(done, Ordering::Relaxed);
    };
    let (image, stats) = render(&world.program, &world.frame, &JOB, None, &progress, &AtomicBool::new(false))
        .expect("not cancelled");
    assert_eq!(most.into_inner(), image.pixels.len() as u64);
    assert_eq!(stats.rays, image.pixels.len() as u64);
    assert!(
        stats.shadow_samples > stats.medium_samples && stats.shadow_rays > 0 && stats.surface_evaluations > 0
    );
}

#[test]
fn a_cancelled_render_gives_nothing() {
    let world = mixed();
    let cancelled = AtomicBool::new(false);
    let progress = |_| cancelled.store(true, Ordering::Relaxed);
    assert!(render(&world.program, &world.frame, &JOB, Some(1), &progress, &cancelled).is_none());
}

#[test]
fn pilot_meets_its_target() {
    let world = mixed();
    let (program, frame) = (&world.program, &world.frame);
    let size = [64, 64];
    let loose = choose_step(program, frame, size, 1e-2);
    let tight = choose_step(program, frame, size, 1e-3);
    assert!(
        loose.estimate <= 1e-2 && tight.estimate <= 1e-3 && tight.step < loose.step,
        "{loose:?} {tight:?}"
    );
    assert_eq!(tight, choose_step(program, frame, size, 1e-3));
    // A step four times finer changes the picture by less.
    let colors = |job: Job| {
        let image = with_threads(&world, &job, 2);
        image.pixels.iter().flat_map(|pixel| pixel.color).map(f64::from).collect::<Vec<_>>()
    };
    let job = tight.job(size, Sampling::CENTRE);
    let coarse = colors(job);
    let fine = colors(Job { step: 0.25 * job.step, shadow_step: 0.25 * job.shadow_step, ..job });
    let changed: f64 = coarse.iter().zip(&fine).map(|(a, b)| (a - b).powi(2)).sum();
    let whole: f64 = fine.iter().map(|b| b * b).sum();
    assert!((changed / whole).sqrt() < 1e-3, "{}", (changed / whole).sqrt());
}

#[test]
fn pilot_without_media_does_nothing() {
    let mut world = mixed();
    world.frame.media.clear();
    let choice = choose_step(&world.program, &world.frame, [64, 64], 1e-3);
    assert_eq!((choice.step, choice.estimate), (1.0, 0.0));
}

/// The WGSL twin has the same numbers.
#[test]
fn twins_share_their_constants() {
    let text = concat!(
        include_str!("../../../../compiler/src/wgsl/render.wgsl"),
        include_str!("../../../../compiler/src/wgsl/render/sampling.wgsl"),
        include_str!("../../../../compiler/src/wgsl/render/chord.wgsl"),
        include_str!("../../../../compiler/src/wgsl/render/panel.wgsl")
    );
    let (far, parallel, epsilon, flat) = (camera::FAR, camera::PARALLEL, surface::EPSILON, surface::FLAT);
    assert_eq!((far, parallel, epsilon, flat), (4.0e6, 1e-12, 2.0_f32.powi(-23), 1e-15));
    assert_eq!((shadow::OPAQUE, medium::STOP), (24.0, 2.0_f32.powi(-16)));
    let lines = [
        "FAR: f32 = 4.0e6".to_owned(),
        "PARALLEL: f32 = 1e-12".to_owned(),
        "EPSILON: f32 = 0x1p-23f".to_owned(),
        "FLAT: f32 = 1e-15".to_owned(),
        "OPAQUE: f32 = 24.0".to_owned(),
        "STOP: f32 = 0x1p-16f".to_owned(),
        format!("MAX_STEPS: u32 = {}u", surface::MAX_STEPS),
        format!("REFINEMENTS: u32 = {}u", surface::REFINEMENTS),
        format!("EAGERNESS: f32 = {}", near::EAGERNESS),
        format!("ROOM: f32 = {}", near::ROOM),
        format!("MAX_NODES: i32 = {}", comb::MAX_NODES),
        format!("LAST_NODE: f32 = {}.0", comb::LAST_NODE),
        format!("CHORD_ROUNDS: u32 = {}u", chord::ROUNDS),
        format!("GOLDEN_STRIDE: u32 = {}u", sampling::GOLDEN_STRIDE),
        format!("WALL_ROUNDS: u32 = {}u", panel::WALL_ROUNDS),
        format!("STRIDE: vec2u = vec2u({}u, {}u)", sampling::STRIDE[0], sampling::STRIDE[1]),
        format!("FIRST_ROUND: u32 = {}u", sampling::FIRST_ROUND),
        format!("ROUND: u32 = {}u", sampling::ROUND),
        format!("LEAST_BRIGHTNESS: f32 = {}", sampling::LEAST_BRIGHTNESS),
    ];
    for line in lines {
        assert!(text.contains(&format!("const {line};")), "{line}");
    }
}
