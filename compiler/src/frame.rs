//! A program at one moment: every number that the runtimes need, ready in f32.
//!
//! Both backends render from the same [`Frame`], so whatever is computed here once per frame on
//! the host in f64 cannot differ between them.

mod camera;
mod extent;
mod inputs;
mod light_grid;
pub mod styled;
mod tube;

pub use extent::MOST_CELLS;
pub use inputs::Inputs;
pub use light_grid::{GridColumn, LightGrid};

use crate::curve::{self, CurveTable, Quadratic};
use crate::ir::FunctionId;
use crate::program::style::Style;
use crate::program::{LightKind, Lighting, Program, Slot, Slot3, TubeSizes};
use crate::reference;
use crate::skip::{Skip, Skips};
use extent::{Solid, Space};
use glam::DVec3;
use std::sync::Arc;
use styled::StyledLight;
pub use vol_language::diag::Diagnostic;

/// A box aligned with the axes; infinite for shapes without bounds, `lo > hi` if empty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub lo: [f32; 3],
    /// Largest corner.
    pub hi: [f32; 3],
}

impl Aabb {
    /// The smallest box around both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self {
            lo: std::array::from_fn(|axis| self.lo[axis].min(other.lo[axis])),
            hi: std::array::from_fn(|axis| self.hi[axis].max(other.hi[axis])),
        }
    }

    /// Distance between its corners.
    #[must_use]
    pub fn diagonal(&self) -> f32 {
        (0..3).map(|axis| (self.hi[axis] - self.lo[axis]).powi(2)).sum::<f32>().sqrt()
    }
}

impl Frame {
    /// A camera at the origin, for what depends on none.
    #[must_use]
    pub fn default_camera() -> CameraFrame {
        CameraFrame {
            origin: [0.0; 3],
            forward: [0.0, 0.0, -1.0],
            right: [1.0, 0.0, 0.0],
            up: [0.0, 1.0, 0.0],
        }
    }

    /// The box around all media, if there are any.
    #[must_use]
    pub fn media_bounds(&self) -> Option<Aabb> {
        self.media.iter().map(|medium| medium.bounds).reduce(|a, b| a.union(&b))
    }
}

/// Everything about one frame of a program. Objects, media and lights that are switched off are
/// left out, so indices here are not those of the program.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Outputs of the frame function in f64, for the reference.
    pub uniforms: Vec<f64>,
    /// The same rounded to f32, for the runtimes.
    pub uniforms_f32: Vec<f32>,
    /// Control points of each curve.
    pub curves: Vec<Vec<Quadratic>>,
    /// Prepared pieces of each curve.
    pub curve_tables: Vec<CurveTable>,
    /// Eye and picture plane.
    pub camera: CameraFrame,
    /// Solids that are there.
    pub objects: Vec<ObjectFrame>,
    /// Media that are there.
    pub media: Vec<MediumFrame>,
    /// Lights that are on.
    pub lights: Vec<LightFrame>,
    /// What media leave of each light, tabulated; where there is none, and for lights beyond the end of the
    /// list, both backends march through the media instead. Empty until someone chooses.
    pub light_grids: Vec<Option<Arc<LightGrid>>>,
    /// Styles that are on; indices of lights are those here.
    pub styles: Vec<Style<f64>>,
    /// What styles make of each light; lights without, and beyond the end of the list, shine as they are.
    /// Empty until someone prepares the styles.
    pub styled_lights: Vec<Option<Arc<StyledLight>>>,
    /// Radiance where nothing is hit.
    pub background: [f32; 3],
    /// Box around all bounded objects and media; what the default camera frames.
    pub bounds: Aabb,
    /// What may be left out of the work.
    pub skips: Skips,
}

/// Eye and picture plane: the ray through `(u, v)` in [-1, 1], v up, is
/// `forward + u * right + v * up`, normalised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFrame {
    /// The eye.
    pub origin: [f32; 3],
    /// Unit vector into the picture.
    pub forward: [f32; 3],
    /// To the right edge of the picture at distance 1, aspect ratio included.
    pub right: [f32; 3],
    /// To the upper edge of the picture at distance 1.
    pub up: [f32; 3],
}

/// A solid in one frame.
#[derive(Clone, Debug)]
pub struct ObjectFrame {
    /// Index in [`crate::program::Program::objects`].
    pub index: usize,
    /// See [`crate::program::Object`].
    pub whole: usize,
    /// See [`crate::program::Object`].
    pub distance: FunctionId,
    /// See [`crate::program::Object`].
    pub gradient: FunctionId,
    /// See [`crate::program::Object`].
    pub surface: FunctionId,
    /// See [`crate::program::Object`].
    pub shows_normals: bool,
    /// No surface is outside.
    pub bounds: Aabb,
    /// How far a distance can be walked.
    pub stride: Stride,
}

/// What makes a distance safe to walk.
#[derive(Clone, Copy, Debug)]
pub enum Stride {
    /// Times this it never overshoots the surface.
    Scale(f32),
    /// Nor divided by a bound on its slope in the box of the way: see
    /// [`crate::program::Object::steepness`].
    Within(FunctionId),
}

/// A medium in one frame.
#[derive(Clone, Debug)]
pub struct MediumFrame {
    /// Index in [`crate::program::Program::media`].
    pub index: usize,
    /// See [`crate::program::Medium`].
    pub region: FunctionId,
    /// See [`crate::program::Medium`].
    pub interior: FunctionId,
    /// See [`crate::program::Medium`].
    pub extinction: FunctionId,
    /// See [`crate::program::Medium`].
    pub phase: FunctionId,
    /// See [`crate::program::Medium`].
    pub lighting: Lighting,
    /// The region is inside.
    pub bounds: Aabb,
    /// The inside is in these boxes: for a tube one per part of its axis, with little outside
    /// between them; for most shapes one, `bounds`. At most [`MOST_CELLS`].
    pub cells: Vec<Aabb>,
    /// How many steps of a camera ray a sample of it may stand for with [`Quadrature::Midpoint`]: a power of 2, at most
    /// [`MOST_SPACING`]. Where media of lower spacing may be, samples are as near as those need. The runtime chooses it; 1 before
    /// that, and of a program's only medium.
    pub spacing: u32,
}

/// Largest [`MediumFrame::spacing`].
pub const MOST_SPACING: u32 = 64;

/// A light in one frame.
#[derive(Clone, Copy, Debug)]
pub struct LightFrame {
    /// Whether `position` is a unit direction towards the light or the place of a point light.
    pub distant: bool,
    /// Unit direction or position.
    pub position: [f32; 3],
    /// Irradiance on a facing plane, or radiant intensity.
    pub color: [f32; 3],
    /// Whether objects and media block it.
    pub shadows: bool,
    /// Tangent of half the angle across a distant light, at most [`MAX_SPREAD_TANGENT`], or radius of a
    /// point light; 0 for hard shadows.
    pub size: f32,
    /// Distance within which surfaces darken each other in this light; 0 if they do not.
    pub occlusion: f32,
}

/// Largest size of a distant light: half the angle across it is then 60 degrees.
pub const MAX_SPREAD_TANGENT: f64 = 1.732_050_807_568_877_2;

/// What is asked of a render, beside the scene.
#[derive(Clone, Copy, Debug)]
pub struct Job {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Distance between samples of media along camera rays, in scene units; positive.
    pub step: f32,
    /// Distance between samples along shadow rays through media; positive.
    pub shadow_step: f32,
    /// How samples of media become an integral.
    pub quadrature: Quadrature,
    /// Rays per pixel.
    pub sampling: Sampling,
}

/// How samples of media along a ray become an integral. Both converge to the same picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quadrature {
    /// Each sample stands for the stretch around it. Second order; cheap, and best while the step is not
    /// much shorter than the finest detail.
    #[default]
    Midpoint,
    /// Between two samples density and light change steadily; where the density is cut off at 0 and where
    /// the region ends is found between them. Third order where density ends at 0, second at hard walls.
    Corrected,
}

/// How many rays a pixel is the mean of. Where they go and when a pixel has enough of them is told
/// in `runtime-cpu/src/render/sampling.rs`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Samples of each pixel; the most, if there is a tolerance, beside which four probes may be taken. 1 to
    /// [`MAX_SAMPLES`](vol_language::blocks::MAX_SAMPLES); 1 is the pixel's centre.
    pub most: u32,
    /// Standard error of a pixel relative to its brightness at which it takes no more samples, in
    /// 0..1; 0 for as many samples everywhere.
    pub tolerance: f32,
}

impl Sampling {
    /// One ray through each pixel's centre.
    pub const CENTRE: Self = Self { most: 1, tolerance: 0.0 };

    /// The same number of samples for each pixel.
    #[must_use]
    pub const fn uniform(samples: u32) -> Self {
        Self { most: samples, tolerance: 0.0 }
    }
}

/// Scene-linear picture, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// One per pixel, rows from the top.
    pub pixels: Vec<Pixel>,
}

/// What a pixel's camera rays bring back.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pixel {
    /// Radiance, background included: the mean over the samples.
    pub color: [f32; 3],
    /// Fraction of the background's light that arrives, 0 where a surface is hit: the mean over the
    /// samples.
    pub transmittance: [f32; 3],
    /// Distance along the viewing axis of the first surface in the pixel's centre; infinite where there
    /// is none. A mean of distances would lie where nothing is.
    pub depth: f32,
    /// How far the colour may be off for want of samples of media, rms over the channels. Of a single pixel
    /// it says little; over a picture its rms is the estimated error, once
    /// [`Image::scale_errors`] has been told that.
    pub error: f32,
}

impl Image {
    /// Scales the errors of the pixels, which runtimes give in a unit of their own, so that their rms over
    /// the picture is `estimate` times that of the colours.
    pub fn scale_errors(&mut self, estimate: f32) {
        let mean = |square: &dyn Fn(&Pixel) -> f64| self.pixels.iter().map(square).sum::<f64>();
        let errors = mean(&|pixel| f64::from(pixel.error).powi(2));
        let colors = mean(&|pixel| pixel.color.iter().map(|&c| f64::from(c).powi(2)).sum::<f64>() / 3.0);
        let factor = if errors > 0.0 { f64::from(estimate) * (colors / errors).sqrt() } else { 0.0 };
        self.pixels.iter_mut().for_each(|pixel| pixel.error = (factor * f64::from(pixel.error)) as f32);
    }
}

/// How much was computed for a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Camera rays: samples of pixels, and the probes of adaptive sampling.
    pub camera_rays: u64,
    /// Camera and shadow rays.
    pub rays: u64,
    /// Points inside media at which their properties were computed.
    pub samples: u64,
    /// Points at which functions of the scene were computed: the samples, and the search for
    /// surfaces and for the walls of media.
    pub evaluations: u64,
}

impl Counts {
    /// The counts of two pictures.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            camera_rays: self.camera_rays + other.camera_rays,
            rays: self.rays + other.rays,
            samples: self.samples + other.samples,
            evaluations: self.evaluations + other.evaluations,
        }
    }
}

impl Program {
    /// The default value of every param, in order.
    #[must_use]
    pub fn default_params(&self) -> Vec<Vec<f64>> {
        self.params.iter().map(|param| param.default.clone()).collect()
    }

    /// Inputs of the frame function; measures and the sizes of tubes are 0 until they are known.
    fn inputs(&self, params: &[Vec<f64>], time: f64, number: f64) -> Vec<f64> {
        let mut inputs = vec![time, number];
        inputs.extend(params.iter().flatten());
        inputs.resize(self.module.frame.inputs as usize, 0.0);
        inputs
    }

    /// Outputs of the frame function at a moment, right for all slots but those that depend on measures
    /// or on the sizes of tubes: enough for the settings of the picture.
    #[must_use]
    pub fn numbers(&self, params: &[Vec<f64>], time: f64, number: f64) -> Vec<f64> {
        reference::evaluate(&self.module.frame, &self.inputs(params, time, number), &[], &[])
    }

    /// The program at one moment: params (one list of components each, in order), time in seconds,
    /// number of the frame, and the size of the picture, which sets the aspect ratio. Params are to be within their
    /// declared ranges: functions are simplified for those ([`crate::passes::narrow`]), and are wrong outside.
    ///
    /// # Errors
    /// A displacement that has no bound, a tube whose surface cannot be marched safely: a message about
    /// the scene.
    pub fn frame(
        &self,
        params: &[Vec<f64>],
        time: f64,
        number: f64,
        size: [u32; 2],
    ) -> Result<Frame, Diagnostic> {
        let Known { uniforms, curves, curve_tables, tubes } = self.known(params, time, number)?;
        let at = |slot: Slot| uniforms[slot.0 as usize];
        let at3 = |slots: Slot3| slots.map(at);
        let on = |slot: Slot| at(slot) != 0.0;
        let space = Space {
            module: &self.module,
            uniforms: &uniforms,
            curves: &curves,
            tables: &curve_tables,
            tubes: &tubes,
        };
        let mut bounds = extent::EMPTY;
        let mut objects = Vec::new();
        for (index, object) in self.objects.iter().enumerate().filter(|(_, object)| on(object.enabled)) {
            let solid = space.solid(&object.extent)?;
            bounds = extent::enclose_finite(bounds, solid.bounds);
            if !solid.steepness.is_finite() {
                return Err(tube::unsafe_surface(object.span));
            }
            let stride = object.steepness.map_or(Stride::Scale(1.0), |f| space.stride(f, solid.bounds));
            objects.push(object_frame(index, object, &solid, stride));
        }
        let mut media = Vec::new();
        for (index, medium) in self.media.iter().enumerate().filter(|(_, medium)| on(medium.enabled)) {
            let solid = space.solid(&medium.extent)?;
            bounds = extent::enclose_finite(bounds, solid.bounds);
            let mut medium = medium_frame(index, medium, solid);
            if !self.skips.has(Skip::Cells) {
                medium.cells.clear();
            }
            media.push(medium);
        }
        let lights = self.lights.iter().filter(|light| on(light.enabled));
        let lights = lights.map(|light| LightFrame {
            distant: matches!(light.kind, LightKind::Distant(_)),
            position: match light.kind {
                LightKind::Distant(direction) => round3(camera::unit(at3(direction).into(), DVec3::Y).into()),
                LightKind::Point(position) => round3(at3(position)),
            },
            color: round3(at3(light.color)),
            shadows: on(light.shadows),
            size: light.size.map_or(0.0, |slot| size_of_light(light.kind, at(slot))),
            occlusion: light.occlusion.map_or(0.0, |slot| at(slot).max(0.0) as f32),
        });
        let lights = lights.collect();
        let styles = self.frame_styles(&uniforms)?;
        let view = camera::View {
            from: self.camera.from.map(at3),
            at: self.camera.at.map(at3),
            up: at3(self.camera.up),
            fov: at(self.camera.fov),
            aspect: f64::from(size[0]) / f64::from(size[1]),
        };
        Ok(Frame {
            camera: camera::camera(&view, bounds),
            background: round3(at3(self.render.background)),
            bounds: extent::rounded(bounds),
            uniforms_f32: uniforms.iter().map(|&v| v as f32).collect(),
            uniforms,
            curves,
            curve_tables,
            objects,
            media,
            lights,
            light_grids: Vec::new(),
            styles,
            styled_lights: Vec::new(),
            skips: self.skips,
        })
    }
}

impl Program {
    /// The styles that are on and whose lights are.
    fn frame_styles(&self, uniforms: &[f64]) -> Result<Vec<Style<f64>>, Diagnostic> {
        let at = |slot: Slot| uniforms[slot.0 as usize];
        let on = |light: usize| at(self.lights[light].enabled) != 0.0;
        let mut styles: Vec<Style<f64>> = Vec::new();
        for style in self.styles.iter().filter(|style| on(style.light)) {
            let light = (0..style.light).filter(|&light| on(light)).count();
            let style = Style { light, ..style.map(&at) };
            if style.enabled == 0.0 {
                continue;
            }
            if let Some(other) = styles.iter().find(|other| other.light == light) {
                return Err(styled::two_styles(&self.lights[style.light].name, other.span, style.span));
            }
            styles.push(style);
        }
        Ok(styles)
    }
}

/// What a frame finds out before its solids.
struct Known {
    uniforms: Vec<f64>,
    curves: Vec<Vec<Quadratic>>,
    curve_tables: Vec<CurveTable>,
    tubes: Vec<tube::Measured>,
}

impl Program {
    /// Curves, the sizes of tubes, measures, and the outputs of the frame function once these are among
    /// its inputs.
    fn known(&self, params: &[Vec<f64>], time: f64, number: f64) -> Result<Known, Diagnostic> {
        let mut inputs = self.inputs(params, time, number);
        let evaluate = |inputs: &[f64]| reference::evaluate(&self.module.frame, inputs, &[], &[]);
        let mut uniforms = evaluate(&inputs);
        let curves: Vec<Vec<Quadratic>> =
            self.curves.iter().map(|curve| control_points(curve, &uniforms)).collect();
        let tables: Vec<CurveTable> = curves.iter().map(|segments| self.table(segments)).collect();
        let space =
            Space { module: &self.module, uniforms: &uniforms, curves: &curves, tables: &tables, tubes: &[] };
        let tubes: Vec<tube::Measured> = self.tubes.iter().map(|sizes| space.measure_tube(sizes)).collect();
        for (sizes, measured) in self.tubes.iter().zip(&tubes) {
            let first = sizes.first_input as usize;
            inputs[first..first + TubeSizes::COUNT].copy_from_slice(&measured.numbers);
        }
        if !tubes.is_empty() {
            uniforms = evaluate(&inputs);
        }
        // Measures may be of solids with tubes in them.
        if !self.measures.is_empty() {
            let (module, curves, tables) = (&self.module, &curves, &tables);
            let space = Space { module, uniforms: &uniforms, curves, tables, tubes: &tubes };
            for (first, measure) in &self.measures {
                let numbers = space.measure(measure)?;
                inputs[*first as usize..][..numbers.len()].copy_from_slice(&numbers);
            }
            uniforms = evaluate(&inputs);
        }
        Ok(Known { uniforms, curves, curve_tables: tables, tubes })
    }

    fn table(&self, segments: &[Quadratic]) -> CurveTable {
        let mut table = curve::prepare(segments);
        if !self.skips.has(Skip::CurveBoxes) {
            table.look_at_all();
        }
        table
    }
}

fn control_points(curve: &crate::program::Curve, uniforms: &[f64]) -> Vec<Quadratic> {
    let at3 = |slots: Slot3| slots.map(|slot| uniforms[slot.0 as usize]);
    let segments = curve.segments.iter();
    segments.map(|&[a, b, c]| Quadratic { a: at3(a), b: at3(b), c: at3(c) }).collect()
}

/// See [`LightFrame::size`].
fn size_of_light(kind: LightKind, given: f64) -> f32 {
    let given = given.max(0.0);
    let size = match kind {
        LightKind::Distant(_) => (0.5 * given.min(3.0)).tan().min(MAX_SPREAD_TANGENT),
        LightKind::Point(_) => given,
    };
    size as f32
}

fn object_frame(index: usize, object: &crate::program::Object, solid: &Solid, stride: Stride) -> ObjectFrame {
    ObjectFrame {
        index,
        whole: object.whole,
        distance: object.distance,
        gradient: object.gradient,
        surface: object.surface,
        shows_normals: object.shows_normals,
        bounds: extent::rounded(solid.bounds),
        stride,
    }
}

fn medium_frame(index: usize, medium: &crate::program::Medium, solid: Solid) -> MediumFrame {
    MediumFrame {
        index,
        region: medium.region,
        interior: medium.interior,
        extinction: medium.extinction,
        phase: medium.phase,
        lighting: medium.lighting,
        bounds: extent::rounded(solid.bounds),
        cells: solid.cells.into_iter().map(extent::rounded).collect(),
        spacing: 1,
    }
}

fn round3(v: [f64; 3]) -> [f32; 3] {
    v.map(|c| c as f32)
}
