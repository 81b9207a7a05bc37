//! How long the parts of a style take, one by one, for comparison with the tables of Kol et al. 2016.

use super::morphology::{close_disk, dilate_row, erode_row};
use super::shadow_map::Layout;
use super::slices::Fan;
use super::{Stage, lit_bounds, means, shadow_map};
use crate::interp::Tapes;
use crate::render::{Batch, Batches, Integrator, Scene, camera_ray};
use rayon::prelude::*;
use std::time::Instant;
use vol_compiler::frame::styled::{Occluders, StyledLight, TransferTable};
use vol_compiler::frame::{Frame, Job};
use vol_compiler::program::Program;
use vol_compiler::program::style::{Heterogeneity, OperatorKind};

/// Rays that a thread follows at a time.
const RAYS: usize = 256;

/// Milliseconds of the parts of a style for one picture.
#[derive(Clone, Copy, Debug)]
pub struct StageTimes {
    /// Tracing the shadow map.
    pub shadow_map: f64,
    /// Noise and cutting of holes; 0 where the style has none.
    pub holes: f64,
    /// Cutting the map into slices.
    pub slices: f64,
    /// First surfaces of all camera rays.
    pub surfaces: f64,
    /// Average visibility of all camera rays.
    pub visibility: f64,
    /// Looking their colours up in the transfer function.
    pub transfer: f64,
}

/// Measures the parts of a frame's first style with a shadow map of some size, for a picture of `size` pixels; none
/// without a style, or without media and solids in its light.
#[must_use]
pub fn stage_times(program: &Program, frame: &Frame, size: [u32; 2], map_size: u32) -> Option<StageTimes> {
    let prepared = Measured::new(program, frame, size, map_size)?;
    let style = frame.styles.first()?;
    let stage = prepared.stage();
    let (shadow_map, mut heights) = timed(|| prepared.layout.trace(stage.tapes, frame, stage.job));
    let holes = style.operators.iter().find_map(|operator| match &operator.kind {
        OperatorKind::Holes(settings) => Some(settings),
        _ => None,
    });
    let (holes, ()) = timed(|| {
        if let Some(settings) = holes {
            let mask = super::holes::holes(settings, prepared.layout.size);
            let cut = heights.iter_mut().zip(mask).filter(|(_, hole)| *hole);
            cut.for_each(|(height, _)| *height = shadow_map::NOTHING);
        }
    });
    let fan = prepared.fan();
    let (slices, table) = timed(|| fan.table(fan.cut(&heights)));
    let texels = (0..256 * 256).map(|i| [(i % 256) as f32 / 255.0; 3]).collect();
    let light = StyledLight {
        toward: frame.lights[style.light].position,
        bounds: stage.bounds,
        occluders: Occluders::Slices(table),
        transfer: Some(TransferTable { near: 0.0, per_unit: 0.1, texels }),
        light_map: None,
        heterogeneity: None,
    };
    let scene = Scene::new(frame, stage.job);
    let pixels: Vec<[f32; 2]> =
        (0..size[0] * size[1]).map(|i| [(i % size[0]) as f32 + 0.5, (i / size[0]) as f32 + 0.5]).collect();
    let rays: Vec<_> = pixels.par_iter().map(|&pixel| camera_ray(&scene, pixel)).collect();
    let integrator = || Integrator::new(&scene, Batch::new(stage.tapes, frame), Batches::DEFAULT);
    let (surfaces, ends) = timed(|| {
        let chunks =
            rays.par_chunks(RAYS).map_init(integrator, |integrator, rays| integrator.first_surfaces(rays));
        chunks.collect::<Vec<_>>().concat()
    });
    // Who draws many pictures has their memory already.
    let (mut visible, mut colors) = (vec![1.0; rays.len()], vec![[1.0; 3]; rays.len()]);
    let (visibility, ()) = timed(|| {
        let chunks = rays.par_chunks(RAYS).zip(ends.par_chunks(RAYS)).zip(visible.par_chunks_mut(RAYS));
        let share = |integrator: &mut Integrator<'_, _>,
                     ((rays, ends), visible): ((&[_], &[f32]), &mut [f32])| {
            visible.copy_from_slice(&integrator.average_visibility(&light, rays, ends));
        };
        chunks.for_each_init(integrator, share);
    });
    let (transfer, ()) = timed(|| {
        let table = light.transfer.as_ref().expect("it has just been put there");
        let pixels = visible.par_iter().zip(&ends).zip(&mut colors);
        pixels.for_each(|((visible, depth), color)| {
            *color = crate::render::transfer_color(table, *visible, *depth);
        });
    });
    std::hint::black_box(colors);
    Some(StageTimes { shadow_map, holes, slices, surfaces, visibility, transfer })
}

/// Milliseconds of closing the shadow map of a frame's first style by disks of some diameters, and its slices by
/// some lengths: the least of some rounds.
#[must_use]
pub fn closing_times(
    program: &Program,
    frame: &Frame,
    map_size: u32,
    diameters: &[f32],
    lengths: &[usize],
) -> Option<[Vec<f64>; 2]> {
    const ROUNDS: usize = 7;
    let prepared = Measured::new(program, frame, [64, 36], map_size)?;
    let heights = prepared.layout.trace(&prepared.tapes, frame, &prepared.job);
    let least = |work: &dyn Fn() -> f64| (0..ROUNDS).map(|_| work()).fold(f64::INFINITY, f64::min);
    let disk = |&diameter: &f32| {
        least(&|| {
            let mut map = heights.clone();
            timed(|| close_disk(&mut map, prepared.layout.size, diameter)).0
        })
    };
    // As many texels as the map has, in rows of its size.
    let row = |&length: &usize| {
        least(&|| {
            let mut map = heights.clone();
            let close = |scratch: &mut Vec<f32>, row: &mut [f32]| {
                dilate_row(row, length, scratch);
                erode_row(row, length, scratch);
            };
            timed(|| map.par_chunks_mut(prepared.layout.size).for_each_init(Vec::new, close)).0
        })
    };
    Some([diameters.iter().map(disk).collect(), lengths.iter().map(row).collect()])
}

/// The heterogeneity of a frame's first style in each pixel, by some steps along each ray, looked up between the
/// means of every `upsample`-th pixel; and the milliseconds it took without finding surfaces.
#[must_use]
pub fn heterogeneity(
    program: &Program,
    frame: &Frame,
    size: [u32; 2],
    steps: u32,
    upsample: u32,
) -> Option<(Vec<f32>, f64)> {
    let prepared = Measured::new(program, frame, size, 64)?;
    let field = frame.styles.first()?.heterogeneity?.field;
    let settings = Heterogeneity { field, steps, upsample };
    let stage = prepared.stage();
    let scene = Scene::new(frame, stage.job);
    let pixels = (0..size[0] * size[1]).into_par_iter();
    let rays: Vec<_> = pixels
        .map(|i| camera_ray(&scene, [(i % size[0]) as f32 + 0.5, (i / size[0]) as f32 + 0.5]))
        .collect();
    let integrator = || Integrator::new(&scene, Batch::new(stage.tapes, frame), Batches::DEFAULT);
    let chunks =
        rays.par_chunks(RAYS).map_init(integrator, |integrator, rays| integrator.first_surfaces(rays));
    let ends = chunks.collect::<Vec<_>>().concat();
    let (milliseconds, values) = timed(|| {
        let means = (upsample > 1).then(|| means::means(&stage, settings));
        let chunks = rays.par_chunks(RAYS).zip(ends.par_chunks(RAYS));
        let value = |integrator: &mut Integrator<'_, _>, (rays, ends): (&[_], &[f32])| match &means {
            Some(means) => integrator.known_means(means, rays, ends),
            None => integrator.means_to(settings.field, settings.steps, &stage.bounds, rays, ends),
        };
        chunks.map_init(integrator, value).collect::<Vec<_>>().concat()
    });
    Some((values, milliseconds))
}

/// What the measurements have in common.
struct Measured<'a> {
    program: &'a Program,
    frame: &'a Frame,
    tapes: Tapes,
    job: Job,
    layout: Layout,
    bounds: vol_compiler::frame::Aabb,
}

impl<'a> Measured<'a> {
    fn new(program: &'a Program, frame: &'a Frame, size: [u32; 2], map_size: u32) -> Option<Self> {
        let light = &frame.lights[frame.styles.first()?.light];
        let bounds = shadow_map::bounded(&lit_bounds(frame)?, &frame.bounds);
        let layout = Layout::new(light, frame, &bounds, map_size, false)?;
        let tapes = Tapes::of_frame(program, frame);
        Some(Self { program, frame, tapes, job: super::job(size, 1.0, 1.0), layout, bounds })
    }

    fn stage(&self) -> Stage<'_> {
        let Self { program, frame, tapes, job, bounds, .. } = self;
        Stage { program, frame, job, tapes, bounds: *bounds }
    }

    fn fan(&self) -> Fan {
        Fan::new(self.layout, self.frame.camera.origin.map(f64::from))
    }
}

fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let started = Instant::now();
    let done = work();
    (started.elapsed().as_secs_f64() * 1e3, done)
}
