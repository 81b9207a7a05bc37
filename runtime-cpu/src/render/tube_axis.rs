//! The distance by which the first paper walks up to a tube: `|P - Q| - r(t*)`, Q the point of the axis
//! closest to P and t* its parameter (Moinet 2022, sections 3 and 4.3).
//!
//! It is the distance to the tube where the radius is constant. Where it varies the nearest point of the
//! wall is not across from Q, and a walk by this distance can step over the wall into the tube or past a thin
//! part of it: the fault that the paper's section 5.3 names. Kept here as a baseline; the comb never uses it.

use super::fields::{Fields, Points};
use super::scene::Integrator;
use crate::math::curve::closest;
use crate::real::Real;
use vol_compiler::curve::CurveTable;
use vol_compiler::frame::Frame;
use vol_compiler::ir::FunctionId;
use vol_compiler::program::{Caps, Extent, LEAST_RADIUS, Program};
use vol_compiler::wgsl::render::padded;

/// The axis of a medium's tube.
#[derive(Debug)]
pub(crate) struct TubeAxis {
    curve: CurveTable,
    /// (t, arc length) to radius.
    radius: FunctionId,
    /// Whether it ends in planes.
    flat: bool,
}

/// Where a point is from a tube.
#[derive(Clone, Copy, Debug)]
pub(super) struct FromTube<R> {
    /// How far may be walked.
    pub(super) distance: R,
    /// Whether the point is inside, ends included.
    pub(super) inside: bool,
}

impl TubeAxis {
    /// The axes of the media that are tubes and nothing else, in the order of the scene's media: neither
    /// moved nor joined to other shapes.
    pub(super) fn of_media(program: &Program, frame: &Frame) -> Vec<Option<Self>> {
        let media = frame.media.iter().filter(|medium| padded(&medium.bounds).is_some());
        let axis = |extent: &Extent| match extent {
            Extent::Tube { curve, radius, caps, .. } if *caps != Caps::Open => Some(Self {
                curve: frame.curve_tables[*curve as usize].clone(),
                radius: *radius,
                flat: *caps == Caps::Flat,
            }),
            _ => None,
        };
        media.map(|medium| axis(&program.media[medium.index].extent)).collect()
    }
}

impl<F: Fields> Integrator<'_, F> {
    /// Where points are from a medium: by the axis of its tube, else by the signed distance of its region.
    pub(super) fn place_by_medium(
        &mut self,
        medium: usize,
        axis: Option<&TubeAxis>,
        points: &Points<F::Real>,
    ) -> Vec<FromTube<F::Real>> {
        self.stats.region_evaluations += points.len() as u64;
        let Some(axis) = axis else {
            let [region] = self.fields.sample(self.scene.media[medium].region, points);
            let from = |distance| FromTube { distance, inside: distance < F::Real::ZERO };
            return region.into_iter().map(from).collect();
        };
        let feet: Vec<_> = (0..points.len())
            .map(|index| points.get(index).map(|x| x.to_f64() as f32))
            .map(|point| closest(point, &axis.curve.pieces, &axis.curve.nodes))
            .collect();
        let t: Vec<_> = feet.iter().map(|foot| F::Real::from_f32(foot.t)).collect();
        let arc_length: Vec<_> = feet.iter().map(|foot| F::Real::from_f32(foot.arc_length)).collect();
        let [radius] = self.fields.apply(axis.radius, &[&t, &arc_length]);
        let from = |(foot, radius): (_, F::Real)| {
            let foot: &crate::math::curve::CurvePoint = foot;
            let radius = radius.max(F::Real::from_f32(LEAST_RADIUS as f32));
            let distance = F::Real::from_f32(foot.distance) - radius;
            let ends = axis.flat && foot.overshoot > 0.0;
            FromTube { distance, inside: distance < F::Real::ZERO && !ends }
        };
        feet.iter().zip(radius).map(from).collect()
    }
}
