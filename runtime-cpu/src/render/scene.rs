//! A frame and a job as the integrator reads them: in its own precision, boxes made finite.

use super::box_tree::{Answer, BoxTree};
use super::camera::{Ray, Span, slab};
use super::fields::Fields;
use super::light_grid::Grid;
use super::medium::STOP;
use super::method::Way;
use super::shadow::OPAQUE;
use crate::real::{Real, Vec3, length, vector};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use vol_compiler::frame::styled::StyledLight;
use vol_compiler::frame::{Frame, Job, Quadrature};
use vol_compiler::ir::FunctionId;
use vol_compiler::program::Lighting;
use vol_compiler::skip::Skip;
use vol_compiler::wgsl::render::{padded, padded_cells};

/// What the integrator knows of a frame.
#[derive(Debug)]
pub(crate) struct Scene<R> {
    /// Eye and picture plane.
    pub(crate) camera: Camera<R>,
    /// Width and height in pixels.
    pub(crate) size: [R; 2],
    /// Height of a pixel at distance 1 from the eye.
    pub(crate) footprint: R,
    /// Distance of the eye from the origin of the scene: sets what rounding does to positions.
    pub(crate) remoteness: R,
    /// Solids whose box is not empty.
    pub(crate) solids: Vec<Solid<R>>,
    /// Their boxes; empty where all solids are to be asked.
    pub(crate) solid_boxes: BoxTree<R>,
    /// Media whose box is not empty.
    pub(crate) media: Vec<Medium<R>>,
    /// Lights.
    pub(crate) lights: Vec<Light<R>>,
    /// Their grids, as far as there are any.
    pub(crate) grids: Vec<Option<Grid<R>>>,
    /// What styles make of them, as far as they do.
    pub(crate) styled_lights: Vec<Option<Arc<StyledLight>>>,
    /// Radiance where nothing is hit.
    pub(crate) background: Vec3<R>,
    /// Rays end where less than this of the light arrives, [`STOP`] or 0.
    pub(crate) stop: R,
    /// Optical depth from which on no light arrives, [`OPAQUE`] or infinite.
    pub(crate) opaque: R,
    /// Distance between nodes along camera rays.
    pub(crate) step: R,
    /// Distance between nodes along shadow rays.
    pub(crate) shadow_step: R,
    /// How media are integrated.
    pub(crate) way: Way,
    /// What becomes of the nodes.
    pub(crate) quadrature: Quadrature,
}

/// See [`vol_compiler::frame::CameraFrame`].
#[derive(Debug)]
pub(crate) struct Camera<R> {
    pub(crate) origin: Vec3<R>,
    pub(crate) forward: Vec3<R>,
    pub(crate) right: Vec3<R>,
    pub(crate) up: Vec3<R>,
}

/// See [`vol_compiler::frame::ObjectFrame`].
#[derive(Debug)]
pub(crate) struct Solid<R> {
    /// See [`vol_compiler::program::Object`].
    pub(crate) whole: usize,
    pub(crate) distance: FunctionId,
    pub(crate) gradient: FunctionId,
    pub(crate) surface: FunctionId,
    pub(crate) shows_normals: bool,
    pub(crate) lo: Vec3<R>,
    pub(crate) hi: Vec3<R>,
    pub(crate) stride: Stride<R>,
}

/// See [`vol_compiler::frame::Stride`].
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stride<R> {
    Scale(R),
    Within(FunctionId),
}

impl<R: Real> Stride<R> {
    fn new(stride: vol_compiler::frame::Stride) -> Self {
        match stride {
            vol_compiler::frame::Stride::Scale(scale) => Self::Scale(R::from_f32(scale)),
            vol_compiler::frame::Stride::Within(function) => Self::Within(function),
        }
    }
}

/// See [`vol_compiler::frame::MediumFrame`].
#[derive(Debug)]
pub(crate) struct Medium<R> {
    pub(crate) region: FunctionId,
    pub(crate) interior: FunctionId,
    pub(crate) extinction: FunctionId,
    pub(crate) phase: FunctionId,
    pub(crate) lighting: Lighting,
    pub(crate) lo: Vec3<R>,
    pub(crate) hi: Vec3<R>,
    /// Boxes in which it is; none if it may be anywhere in its own.
    pub(crate) cells: BoxTree<R>,
    /// See [`super::spacing`].
    pub(crate) spacing: i32,
}

/// See [`vol_compiler::frame::LightFrame`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Light<R> {
    pub(crate) distant: bool,
    pub(crate) position: Vec3<R>,
    pub(crate) color: Vec3<R>,
    pub(crate) shadows: bool,
    pub(crate) size: R,
    pub(crate) occlusion: R,
    /// Index among the lights of the frame.
    pub(crate) index: usize,
}

impl<R: Real> Scene<R> {
    /// Reads a frame.
    pub(crate) fn new(frame: &Frame, job: &Job) -> Self {
        let camera = Camera {
            origin: vector(frame.camera.origin),
            forward: vector(frame.camera.forward),
            right: vector(frame.camera.right),
            up: vector(frame.camera.up),
        };
        let size = job.size.map(|pixels| R::from_index(pixels as i32));
        let lights = frame.lights.iter().enumerate().map(|(index, light)| Light {
            distant: light.distant,
            position: vector(light.position),
            color: vector(light.color),
            shadows: light.shadows,
            size: R::from_f32(light.size),
            occlusion: R::from_f32(light.occlusion),
            index,
        });
        let solids = solids(frame);
        let boxes = solids.iter().filter(|_| frame.skips.has(Skip::Objects));
        Self {
            solid_boxes: BoxTree::new(boxes.map(|solid| [solid.lo, solid.hi]).collect()),
            footprint: (R::from_f32(2.0) * length(camera.up)) / size[1],
            remoteness: length(camera.origin),
            camera,
            size,
            solids,
            media: media(frame),
            lights: lights.collect(),
            grids: frame.light_grids.iter().map(|grid| grid.as_ref().map(Grid::new)).collect(),
            styled_lights: frame.styled_lights.clone(),
            background: vector(frame.background),
            stop: R::from_f32(if frame.skips.has(Skip::Opaque) { STOP } else { 0.0 }),
            opaque: R::from_f32(if frame.skips.has(Skip::Opaque) { OPAQUE } else { f32::INFINITY }),
            step: R::from_f32(job.step),
            shadow_step: R::from_f32(job.shadow_step),
            way: Way::Comb,
            quadrature: job.quadrature,
        }
    }

    /// The parts of rays in the boxes of solids, a little longer than rounding can make them, by solid, then by ray.
    pub(crate) fn boxes_met(&self, rays: &[Ray<R>]) -> Vec<Answer<Span<R>>> {
        let part = |ray: usize, lo, hi| Some(slab(&rays[ray], lo, hi).loosened()).filter(Span::is_some);
        if self.solid_boxes.is_empty() {
            self.ask_each(rays.len(), part)
        } else {
            self.solid_boxes.met(rays, part)
        }
    }

    /// What `ask` finds of the boxes of solids for each of `count` questions, by solid, then by question; it is told
    /// the question and a box, and must find something of a box around one of which it does.
    pub(crate) fn ask_boxes<T>(
        &self,
        count: usize,
        ask: impl Fn(usize, Vec3<R>, Vec3<R>) -> Option<T>,
    ) -> Vec<Answer<T>> {
        if self.solid_boxes.is_empty() {
            self.ask_each(count, ask)
        } else {
            self.solid_boxes.answers(count, ask)
        }
    }

    /// The same without a tree.
    fn ask_each<T>(
        &self,
        count: usize,
        ask: impl Fn(usize, Vec3<R>, Vec3<R>) -> Option<T>,
    ) -> Vec<Answer<T>> {
        let mut answers = Vec::new();
        for (index, solid) in self.solids.iter().enumerate() {
            let found =
                (0..count).filter_map(|question| Some((question, ask(question, solid.lo, solid.hi)?)));
            answers.extend(found.map(|(question, found)| Answer { index, question, found }));
        }
        answers
    }

    /// The grid of a light.
    pub(crate) fn grid(&self, light: &Light<R>) -> Option<&Grid<R>> {
        self.grids.get(light.index)?.as_ref()
    }
}

fn solids<R: Real>(frame: &Frame) -> Vec<Solid<R>> {
    let solid = |object: &vol_compiler::frame::ObjectFrame| {
        let bounds = padded(&object.bounds)?;
        Some(Solid {
            whole: object.whole,
            distance: object.distance,
            gradient: object.gradient,
            surface: object.surface,
            shows_normals: object.shows_normals,
            lo: vector(bounds.lo),
            hi: vector(bounds.hi),
            stride: Stride::new(object.stride),
        })
    };
    frame.objects.iter().filter_map(solid).collect()
}

fn media<R: Real>(frame: &Frame) -> Vec<Medium<R>> {
    let medium = |medium: &vol_compiler::frame::MediumFrame| {
        let bounds = padded(&medium.bounds)?;
        let cells = padded_cells(medium);
        Some(Medium {
            region: medium.region,
            interior: medium.interior,
            extinction: medium.extinction,
            phase: medium.phase,
            lighting: medium.lighting,
            lo: vector(bounds.lo),
            hi: vector(bounds.hi),
            cells: BoxTree::new(cells.iter().map(|cell| [vector(cell.lo), vector(cell.hi)]).collect()),
            spacing: medium.spacing as i32,
        })
    };
    frame.media.iter().filter_map(medium).collect()
}

/// Sizes of the batches; no picture depends on them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Batches {
    /// Rays that walk together.
    pub(crate) rays: usize,
    /// Nodes of each of those rays that are sampled together.
    pub(crate) nodes: i32,
}

impl Batches {
    /// About 2000 points at once: enough to pay for the interpreter and for the cells of long functions, small enough
    /// for the cache. Measured beside 64, 256 rays and 8, 32 nodes over solids, tubes and clouds.
    pub(crate) const DEFAULT: Self = Self { rays: 128, nodes: 16 };

    /// Most nodes of a batch, counted once for each medium: what all media hold at them is there at once.
    const MOST_NODES: usize = 65_536;

    /// The usual sizes, or fewer rays where there are so many media that a batch would fill the memory.
    pub(crate) fn for_media(media: usize) -> Self {
        let usual = Self::DEFAULT;
        let rays = Self::MOST_NODES / (usual.nodes as usize * media.max(1));
        Self { rays: rays.clamp(2, usual.rays), ..usual }
    }
}

/// The integrator at work: a scene, the evaluator of its functions, and what has been counted.
pub(crate) struct Integrator<'a, F: Fields> {
    pub(crate) scene: &'a Scene<F::Real>,
    pub(crate) fields: F,
    /// Sign of each solid's distance as the camera sees it, see [`super::surface`].
    pub(crate) sides: Vec<F::Real>,
    pub(crate) batches: Batches,
    pub(crate) stats: super::Stats,
    /// What it may spend; without, as much as it takes.
    pub(crate) purse: Option<&'a Purse>,
}

/// How many samples of media some integrators may take together.
#[derive(Debug)]
pub(crate) struct Purse {
    limit: u64,
    spent: AtomicU64,
}

impl Purse {
    /// As many as `limit`.
    pub(crate) fn new(limit: u64) -> Self {
        Self { limit, spent: AtomicU64::new(0) }
    }

    /// Whether more was asked for, so that rays ended early. Does not depend on who asked first.
    pub(crate) fn is_overdrawn(&self) -> bool {
        self.spent.load(Ordering::Relaxed) > self.limit
    }
}

impl<'a, F: Fields> Integrator<'a, F> {
    /// The same with a limit on its work.
    pub(crate) fn paid_from(mut self, purse: &'a Purse) -> Self {
        self.purse = Some(purse);
        self
    }

    /// Pays for a number of samples; whether there is nothing left, and the rays should end.
    pub(crate) fn is_broke(&self, samples: u64) -> bool {
        self.purse
            .is_some_and(|purse| purse.spent.fetch_add(samples, Ordering::Relaxed) + samples > purse.limit)
    }
}
