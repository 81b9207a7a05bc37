//! How far a value of a solid's field can be walked: segment tracing (Galin, Guerin, Paris, Peytavie 2020).
//!
//! A distance can be walked as it is. Displaced solids and fields of the author's own change faster: their
//! value is divided by a bound on their slope, one for all of the solid or, where slopes differ much, one
//! over the very piece of the ray that is about to be walked, at most twice as long as the last. So a
//! bound that is loose over long pieces costs a shorter step, never a hole.
//!
//! Twin: `compiler/src/wgsl/render/stride.wgsl`.

use super::camera::Ray;
use super::fields::Fields;
use super::scene::{Integrator, Scene, Solid, Stride};
use super::surface::EPSILON;
use crate::real::{Real, Vec3};
use vol_compiler::ir::FunctionId;
use vol_compiler::program::NO_BOUND;

/// How often a step is made shorter in search of a bound, by 4 each time.
const TRIES: u32 = 8;

/// A place on a ray from which to go on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead<R> {
    pub(super) ray: Ray<R>,
    /// Distance walked.
    pub(super) t: R,
    /// Length of the last step, 0 if there was none.
    pub(super) last: R,
}

impl<R: Real> Ahead<R> {
    /// How far the next step may go: to where a distance proper would, and at most twice as far as
    /// the last, if there was one.
    fn reach(&self, value: R) -> R {
        let outside = value.max(R::ZERO);
        let twice = R::from_f32(2.0) * self.last;
        if self.last > R::ZERO { outside.min(twice) } else { outside }
    }

    /// Corners of the box of the next step, a little larger than rounding can make it.
    fn way(&self, scene: &Scene<R>, reach: R) -> [Vec3<R>; 2] {
        let (from, to) = (self.ray.at(self.t), self.ray.at(self.t + reach));
        let slack = R::from_f32(4.0 * EPSILON) * (scene.remoteness + (self.t + reach));
        let lo = [0, 1, 2].map(|axis| from[axis].min(to[axis]) - slack);
        let hi = [0, 1, 2].map(|axis| from[axis].max(to[axis]) + slack);
        [lo, hi]
    }
}

impl<F: Fields> Integrator<'_, F> {
    /// Makes values of a solid's field safe to walk, which are those at places `ahead`; what is inside stays as it is.
    pub(super) fn shorten(
        &mut self,
        solid: &Solid<F::Real>,
        ahead: impl Fn(usize) -> Ahead<F::Real>,
        values: &mut [F::Real],
    ) {
        let steepness = match solid.stride {
            Stride::Within(steepness) => steepness,
            Stride::Scale(scale) => {
                values.iter_mut().for_each(|value| *value = scale * *value);
                return;
            }
        };
        let there: Vec<_> = (0..values.len()).map(ahead).collect();
        let mut reaches: Vec<_> =
            there.iter().zip(&*values).map(|(ahead, &value)| ahead.reach(value)).collect();
        let mut pending: Vec<usize> = (0..there.len()).filter(|&i| values[i] > F::Real::ZERO).collect();
        for _ in 0..TRIES {
            let steepest = self.steepest(steepness, &there, &reaches, &pending);
            let is_known = |found: &(usize, F::Real)| found.1 < F::Real::from_f32(NO_BOUND);
            let (known, unknown): (Vec<_>, Vec<_>) = pending.into_iter().zip(steepest).partition(is_known);
            known.into_iter().for_each(|(i, steepest)| values[i] = (values[i] / steepest).min(reaches[i]));
            if unknown.is_empty() {
                return;
            }
            // Look less far where nothing is known: there may be a jump on the way.
            pending = unknown.into_iter().map(|(i, _)| i).collect();
            pending.iter().for_each(|&i| reaches[i] = F::Real::from_f32(0.25) * reaches[i]);
        }
        pending.into_iter().for_each(|i| values[i] = F::Real::ZERO);
    }

    /// Bounds on the slope over the ways of the given places.
    fn steepest(
        &mut self,
        steepness: FunctionId,
        there: &[Ahead<F::Real>],
        reaches: &[F::Real],
        which: &[usize],
    ) -> Vec<F::Real> {
        let mut corners: [Vec<F::Real>; 6] = std::array::from_fn(|_| Vec::with_capacity(which.len()));
        for &i in which {
            let [lo, hi] = there[i].way(self.scene, reaches[i]);
            corners.iter_mut().zip(lo.into_iter().chain(hi)).for_each(|(column, x)| column.push(x));
        }
        let [steepest] = self.fields.apply(steepness, &corners.each_ref().map(Vec::as_slice));
        self.stats.surface_evaluations += steepest.len() as u64;
        steepest
    }
}
