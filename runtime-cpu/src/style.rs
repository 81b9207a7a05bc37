//! What styles make of their lights in one frame, before it is rendered.
//!
//! ```text
//! solids ─shadow_map─► heights ─occluders─► changed heights ─slices─► slopes    ┐
//! strokes ─light_map─► rows of weights ─least_squares─► colours of the light    ├─► StyledLight
//! layers ─transfer─► colour by average visibility and depth                    │
//! field ─means─► factors of a few rays                                         ┘
//! ```
//!
//! All of it is computed here, once for each frame, for both backends: they read the same numbers
//! ([`vol_compiler::frame::styled`]), so operators, transfer functions and light maps cannot differ between them.

mod holes;
mod least_squares;
mod light_map;
mod means;
mod morphology;
mod occluders;
mod shadow_map;
mod slices;
mod stages;
mod trace;
mod transfer;

pub(crate) use light_map::most_bytes;
pub use light_map::{FitReport, FittedMap};
pub use stages::{StageTimes, closing_times, heterogeneity, stage_times};
pub use transfer::Picture;

use crate::interp::Tapes;
use crate::render::{Batch, Batches, Integrator, NO_DEPTH, Ray, Scene};
use occluders::Traced;
use shadow_map::{Layout, bounded};
use std::sync::Arc;
use vol_compiler::frame::styled::{HeterogeneityTable, Occluders, StyledLight, TransferTable};
use vol_compiler::frame::{Aabb, CameraFrame, Diagnostic, Frame, Image, Job, Quadrature, Sampling};
use vol_compiler::program::style::{OperatorKind, Shafts, Style};
use vol_compiler::program::{Lighting, Program};
use vol_compiler::wgsl::render::padded;

/// Samples of media along the longest way through them.
const STEPS: f32 = 768.0;

/// Steps towards lights, over those from the eye: what is missed towards the light is missed in the white map, too.
const SHADOW_STEP: f32 = 24.0;

/// What styles make of a frame.
#[derive(Clone, Debug, Default)]
pub struct Prepared {
    /// For [`Frame::styled_lights`].
    pub lights: Vec<Option<Arc<StyledLight>>>,
    /// Light maps, in the order of the styles that have one.
    pub light_maps: Vec<FittedMap>,
}

/// The texels of a style's light map, where they have been fitted before.
pub type KnownMaps<'a> = &'a dyn Fn(&Style<f64>) -> Option<Vec<[f32; 3]>>;

/// Prepares all styles of a frame for a picture of `size` pixels.
///
/// * `images`: the pictures of [`Program::images`], in order
///
/// # Errors
/// A stroke that touches no pixel: a message about the scene.
pub fn prepare(
    program: &Program,
    frame: &Frame,
    size: [u32; 2],
    images: &[Picture],
    known: KnownMaps<'_>,
) -> Result<Prepared, Diagnostic> {
    let mut prepared = Prepared { lights: vec![None; frame.lights.len()], light_maps: Vec::new() };
    let Some(lit) = lit_bounds(frame).filter(|_| !frame.styles.is_empty()) else { return Ok(prepared) };
    let tapes = Tapes::of_frame(program, frame);
    let bounds = bounded(&lit, &frame.bounds);
    let step = bounds.diagonal() / STEPS;
    let job = job(size, step, SHADOW_STEP * step);
    let stage = Stage { program, frame, job: &job, tapes: &tapes, bounds };
    for style in &frame.styles {
        let hiders = stage.hiders(style);
        let mut styled = stage.lit_by(style, &hiders, &frame.camera);
        if let Some(settings) = &style.light_map {
            let fitted = light_map::fit(&stage, style, settings, &hiders, known(style))?;
            styled.light_map = Some(fitted.table.clone());
            prepared.light_maps.push(fitted);
        }
        if let Some(settings) = style.heterogeneity {
            let means = (settings.upsample > 1).then(|| means::means(&stage, settings));
            styled.heterogeneity =
                Some(HeterogeneityTable { field: settings.field, steps: settings.steps, means });
        }
        if let Some(settings) = &style.transfer {
            let range = depth_range(style, frame);
            let tracked = |point| stage.tracked(&styled, range, point);
            let texels = transfer::texture(settings, images, &tracked);
            let [near, per_unit] = range.map(|x| x as f32);
            styled.transfer = Some(TransferTable { near, per_unit, texels });
        }
        prepared.lights[style.light] = Some(Arc::new(styled));
    }
    Ok(prepared)
}

/// The shadow maps of a frame's styles after all operators, by the names of the styles: what is nearest to the light is
/// white, the lowest solid grey, and where there is none it is black. Styles without a map are left out.
#[must_use]
pub fn shadow_maps(program: &Program, frame: &Frame, size: [u32; 2]) -> Vec<(String, Image)> {
    let Some(lit) = lit_bounds(frame) else { return Vec::new() };
    let job = job(size, 1.0, 1.0);
    let tapes = Tapes::of_frame(program, frame);
    let stage = Stage { program, frame, job: &job, tapes: &tapes, bounds: bounded(&lit, &frame.bounds) };
    let mapped = frame.styles.iter().filter(|style| style.shafts == Shafts::Mapped);
    let image = |style: &Style<f64>| {
        let layout = stage.layout(style)?;
        let heights = Traced::new(&stage, style, layout).heights(style, frame.camera.origin);
        Some((style.name.clone(), layout.image(&heights)))
    };
    mapped.filter_map(image).collect()
}

/// What hides the light of a style, whoever looks.
enum Hiders {
    None,
    /// Solids that are marched to.
    Marched,
    /// A shadow map of them.
    Mapped(Traced),
}

/// What all parts of a style are prepared from.
struct Stage<'a> {
    program: &'a Program,
    frame: &'a Frame,
    job: &'a Job,
    tapes: &'a Tapes,
    /// The box around all media that lights reach.
    bounds: Aabb,
}

impl Stage<'_> {
    /// What hides the light of a style.
    fn hiders(&self, style: &Style<f64>) -> Hiders {
        if !self.frame.lights[style.light].shadows || self.frame.objects.is_empty() {
            Hiders::None
        } else if style.shafts == Shafts::Exact {
            Hiders::Marched
        } else {
            let layout = self.layout(style);
            layout.map_or(Hiders::None, |layout| Hiders::Mapped(Traced::new(self, style, layout)))
        }
    }

    /// The light of a style before its colours, for a camera.
    fn lit_by(&self, style: &Style<f64>, hiders: &Hiders, camera: &CameraFrame) -> StyledLight {
        StyledLight {
            toward: self.frame.lights[style.light].position,
            bounds: self.bounds,
            occluders: match hiders {
                Hiders::None => Occluders::None,
                Hiders::Marched => Occluders::Marched,
                Hiders::Mapped(traced) => Occluders::Slices(traced.slices(style, camera.origin)),
            },
            transfer: None,
            light_map: None,
            heterogeneity: None,
        }
    }

    /// Where the shadow map of a style is.
    fn layout(&self, style: &Style<f64>) -> Option<Layout> {
        let grow = style.operators.iter().any(|operator| matches!(operator.kind, OperatorKind::Extrude(_)));
        Layout::new(&self.frame.lights[style.light], self.frame, &self.bounds, style.shadow_map, grow)
    }

    /// Average visibility and depth, 0 to 1, of the ray through a point of the world; none if it is not in the picture.
    fn tracked(&self, styled: &StyledLight, range: [f64; 2], point: [f64; 3]) -> Option<[f64; 2]> {
        let scene = Scene::new(self.frame, self.job);
        let mut integrator = Integrator::new(&scene, Batch::new(self.tapes, self.frame), Batches::DEFAULT);
        let ray = ray_through(self.frame, point)?;
        let [visible, depth] = integrator.shaft_of(styled, &ray);
        let along = if depth < NO_DEPTH { (f64::from(depth) - range[0]) * range[1] } else { 1.0 };
        Some([f64::from(visible), along.clamp(0.0, 1.0)])
    }
}

/// What styles are prepared for: a ray through the middle of each pixel of a picture.
fn job(size: [u32; 2], step: f32, shadow_step: f32) -> Job {
    Job { size, step, shadow_step, quadrature: Quadrature::Midpoint, sampling: Sampling::CENTRE }
}

/// The ray from the eye through a point, if that is in the picture.
fn ray_through(frame: &Frame, point: [f64; 3]) -> Option<Ray<f32>> {
    let wide = |v: [f32; 3]| v.map(f64::from);
    let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
    let (eye, forward) = (wide(frame.camera.origin), wide(frame.camera.forward));
    let off = [0, 1, 2].map(|i| point[i] - eye[i]);
    let ahead = dot(off, forward);
    let beside = |axis: [f32; 3]| dot(off, wide(axis)) / (ahead * dot(wide(axis), wide(axis)));
    let inside = |x: f64| (-1.0..=1.0).contains(&x);
    if !(ahead > 0.0 && inside(beside(frame.camera.right)) && inside(beside(frame.camera.up))) {
        return None;
    }
    let length = dot(off, off).sqrt();
    Some(Ray::new(frame.camera.origin, off.map(|x| (x / length) as f32)))
}

/// The box around the media that lights reach.
fn lit_bounds(frame: &Frame) -> Option<Aabb> {
    let lit = frame.media.iter().filter(|medium| medium.lighting == Lighting::Shadowed);
    lit.filter_map(|medium| padded(&medium.bounds)).reduce(|a, b| a.union(&b))
}

/// Depth that is 0, and by how much it rises per scene unit over that.
fn depth_range(style: &Style<f64>, frame: &Frame) -> [f64; 2] {
    let camera = &frame.camera;
    let depth = |corner: usize| {
        let side =
            |axis: usize| if corner >> axis & 1 == 0 { frame.bounds.lo[axis] } else { frame.bounds.hi[axis] };
        let along =
            |axis: usize| f64::from(side(axis) - camera.origin[axis]) * f64::from(camera.forward[axis]);
        (0..3).map(along).sum::<f64>()
    };
    let corners = (0..8).map(depth);
    let whole = [corners.clone().fold(f64::INFINITY, f64::min).max(0.0), corners.fold(0.0, f64::max)];
    let [near, far] = style.depth_range.unwrap_or(whole);
    let length = if far - near > 1e-9 && (far - near).is_finite() { far - near } else { 1.0 };
    [if near.is_finite() { near } else { 0.0 }, 1.0 / length]
}
