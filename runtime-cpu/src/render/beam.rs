//! How far beams of parallel rays go before any of their rays may meet a solid.
//!
//! A beam is all that is within a radius `r` of its axis. Where no surface is nearer to the axis than `d`, a ball of that
//! radius is empty, and with it the beam for `sqrt(d^2 - r^2)`. A beam ends where it would get on by less than its
//! radius: narrower ones go on from there, at last the rays themselves.
//!
//! * in: axes, radius, where each starts and the length of all; out: a length for each, in which none of its rays is in
//!   a solid
//! * error: rounding moves surfaces by some 1e-6 of the coordinates; the radius is to have so much to spare
//! * source: cone marching (Seven/Fulcrum, "Cone marching", 2012); of parallel rays the cone is a cylinder

use super::camera::{FAR, Ray, Span, slab};
use super::fields::Fields;
use super::near::{Met, Walkers};
use super::scene::{Integrator, Stride};
use super::surface::MAX_STEPS;
use crate::real::{Real, Vec3};

impl<F: Fields> Integrator<'_, F> {
    /// Distances up to which no ray of some beams meets a solid, at least where each starts and about `length` if nothing
    /// is in its way.
    pub(crate) fn clear_lengths(
        &mut self,
        axes: &[Ray<F::Real>],
        radius: F::Real,
        starts: &[F::Real],
        length: F::Real,
    ) -> Vec<F::Real> {
        let length = length.min(F::Real::from_f32(FAR));
        let (met, ends) = self.met_by_beams(axes, radius, length);
        let mut clear = starts.to_vec();
        let mut walkers = Walkers::started(axes, met, starts);
        for _ in 0..MAX_STEPS {
            self.nearest(&mut walkers);
            walkers.go(|walker, near| {
                let distance = near.distance.max(F::Real::ZERO);
                let free = (distance * distance - radius * radius).max(F::Real::ZERO).sqrt();
                let t = (walker.t + free.min(near.gap)).min(ends[walker.ray]);
                clear[walker.ray] = t.max(walker.t);
                (free >= radius && t < ends[walker.ray]).then_some(walker.to(t))
            });
            if walkers.are_done() {
                break;
            }
        }
        clear
    }

    /// The solids whose boxes are in beams, with the parts of the axes where they are; and where each beam ends for
    /// certain. Of a solid whose field has a bound only along rays nothing is known beside them: it ends a beam.
    fn met_by_beams(
        &self,
        axes: &[Ray<F::Real>],
        radius: F::Real,
        length: F::Real,
    ) -> (Vec<Met<F::Real>>, Vec<F::Real>) {
        let part = |beam: usize, lo: Vec3<F::Real>, hi: Vec3<F::Real>| {
            let (lo, hi) = (lo.map(|x| x - radius), hi.map(|x| x + radius));
            Some(slab(&axes[beam], lo, hi).loosened()).filter(Span::is_some)
        };
        let mut ends = vec![length; axes.len()];
        let mut met = Met::of(&self.scene.ask_boxes(axes.len(), part));
        met.retain(|met| {
            let is_known = matches!(self.scene.solids[met.solid].stride, Stride::Scale(_));
            if !is_known {
                met.parts.iter().for_each(|&(beam, span)| ends[beam] = ends[beam].min(span.entry));
            }
            is_known
        });
        (met, ends)
    }
}
