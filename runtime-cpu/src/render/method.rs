//! The ways through the media that can be asked for: the comb, and two to compare it with.
//!
//! In: a [`Method`], in public words. Out: a [`Way`], with what the method finds out once per frame, on the
//! scene; the integrator asks it in two places, for camera rays ([`Integrator::through`]) and for rays
//! towards lights ([`Integrator::reference_depth`]). Surfaces are met and shaded alike in all of them.

use super::camera::Ray;
use super::fields::Fields;
use super::film::Watch;
use super::majorant::Majorants;
use super::medium::Glow;
use super::scene::{Batches, Integrator, Scene};
use super::tube_axis::TubeAxis;
use super::{Stats, render_scene};
use crate::real::Vec3;
use std::sync::atomic::AtomicBool;
use vol_compiler::frame::{Aabb, Frame, Image, Job};
use vol_compiler::program::Program;

/// How the media along rays are integrated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Nodes of one comb per ray, with walls where the signed distances say: the usual way.
    #[default]
    Comb,
    /// Even steps of about [`Job::step`] through the box around the media, and of [`Job::shadow_step`]
    /// towards lights: the marcher of the literature, see `render/fixed_step.rs`.
    FixedStep {
        /// Samples at random places of their steps, by this seed, instead of in the middle.
        jitter: Option<u64>,
        /// How tubes are found.
        tube_bounds: TubeBounds,
    },
    /// Random free paths: unbiased, as many per pixel as [`Job::sampling`] has samples. The steps of the job
    /// mean nothing. See `render/monte_carlo.rs`.
    MonteCarlo {
        /// Other seeds, other paths.
        seed: u64,
    },
}

/// How fixed steps find the part of a ray inside a tube.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TubeBounds {
    /// By steps through the box around all media; outside the cells of a medium it is not evaluated.
    #[default]
    Cells,
    /// By walking the distance to the axis less the radius at its closest point: see `render/tube_axis.rs`.
    SphereMarch,
}

/// A medium for whose extinction no bound is known: free paths cannot be drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoMajorant {
    /// Index in [`Program::media`].
    pub medium: usize,
}

/// A method with what it found out about the frame.
#[derive(Debug)]
pub(crate) enum Way {
    /// See [`Method::Comb`].
    Comb,
    /// See [`Method::FixedStep`]; axes of the media, in their order, to march to.
    FixedStep { jitter: Option<u64>, axes: Option<Vec<Option<TubeAxis>>> },
    /// See [`Method::MonteCarlo`].
    MonteCarlo { seed: u64, majorants: Majorants },
}

impl Way {
    pub(super) fn new(method: Method, program: &Program, frame: &Frame) -> Result<Self, NoMajorant> {
        Ok(match method {
            Method::Comb => Self::Comb,
            Method::FixedStep { jitter, tube_bounds } => {
                let marched = tube_bounds == TubeBounds::SphereMarch;
                Self::FixedStep { jitter, axes: marched.then(|| TubeAxis::of_media(program, frame)) }
            }
            Method::MonteCarlo { seed } => {
                Self::MonteCarlo { seed, majorants: Majorants::new(program, frame)? }
            }
        })
    }
}

/// Step of [`Method::FixedStep`] where none is asked for: a 96th of the diagonal of the box around the
/// media, in scene units; of the whole scene where they have no bounds.
#[must_use]
pub fn fixed_step_default(frame: &Frame) -> f32 {
    let boxes = [frame.media_bounds().unwrap_or(frame.bounds), frame.bounds];
    boxes.iter().map(Aabb::diagonal).find(|&size| size > 0.0 && size < 1e5).unwrap_or(1.0) / 96.0
}

/// [`render`](super::render()) on the surrounding pool by one of the methods.
///
/// # Errors
/// [`NoMajorant`], of [`Method::MonteCarlo`] only.
pub fn render_by(
    method: Method,
    program: &Program,
    frame: &Frame,
    job: &Job,
    progress: &(dyn Fn(u64) + Sync),
    cancelled: &AtomicBool,
) -> Result<Option<(Image, Stats)>, NoMajorant> {
    let watch = Watch { progress, cancelled };
    let scene = Scene { way: Way::new(method, program, frame)?, ..Scene::new(frame, job) };
    Ok(render_scene(program, frame, job, &scene, Batches::for_media(frame.media.len()), &watch))
}

impl<F: Fields> Integrator<'_, F> {
    /// Follows each camera ray through the media up to its end.
    pub(super) fn through(&mut self, rays: &[Ray<F::Real>], ends: &[F::Real]) -> Vec<Glow<F::Real>> {
        let mut glows = match &self.scene.way {
            Way::Comb => return self.march(rays, ends),
            Way::FixedStep { jitter, axes } => self.march_evenly(rays, ends, *jitter, axes.as_deref()),
            Way::MonteCarlo { seed, majorants } => self.draw_paths(rays, ends, *seed, majorants),
        };
        glows.iter_mut().for_each(Glow::without_doubt);
        glows
    }

    /// Optical depth, or an estimate, of each ray towards a light; nothing of the comb.
    pub(super) fn reference_depth(
        &mut self,
        rays: &[Ray<F::Real>],
        ends: &[F::Real],
    ) -> Option<Vec<Vec3<F::Real>>> {
        match &self.scene.way {
            Way::Comb => None,
            Way::FixedStep { axes, .. } => Some(self.even_depth(rays, ends, axes.as_deref())),
            Way::MonteCarlo { seed, majorants } => Some(self.tracked_depth(rays, ends, *seed, majorants)),
        }
    }
}
