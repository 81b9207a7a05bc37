//! How much of a light arrives at a point: solids between hide it, media between weaken it.
//!
//! Media are lit as if every light were a point: they blur the edges of their shadows themselves.
//!
//! Twin: `compiler/src/wgsl/render/shadow.wgsl`, of depths by marching `midpoint.wgsl` and `corrected.wgsl` beside it.

use super::camera::{FAR, Ray};
use super::comb::{Combs, Cursor};
use super::fields::{Colors, Fields};
use super::near::Walkers;
use super::panel::Panels;
use super::penumbra::Cone;
use super::scene::{Integrator, Light};
use super::surface::MAX_STEPS;
use crate::real::{Decays, Real, Vec3, add, scale, smallest, splat};
use vol_compiler::frame::Quadrature;

/// Optical depth above which nothing arrives; exp(-24) is 4e-11. It only grows along a ray, so
/// stopping early and looking at the end come to the same.
pub(super) const OPAQUE: f32 = 24.0;

/// A ray towards a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShadowRay<R> {
    /// From the point to the light.
    pub(crate) ray: Ray<R>,
    /// Distance of the light.
    pub(crate) length: R,
    /// Shortest step of the walk, a fortieth of a pixel: nothing thinner is sure to be seen.
    pub(crate) stride: R,
}

impl<R: Real> ShadowRay<R> {
    /// `bias` as of [`super::surface::shadow_bias`].
    pub(crate) fn new(ray: Ray<R>, length: R, bias: R) -> Self {
        Self { ray, length, stride: R::from_f32(0.25) * bias }
    }

    /// Whether a place on the ray is inside a solid, by the distance there. Where two surfaces meet in a
    /// corner the ray may start a little inside the other one: twice the bias does not count at first.
    pub(super) fn enters(&self, distance: R, t: R) -> bool {
        let start = R::from_f32(8.0) * self.stride - t;
        distance < -start.max(R::ZERO)
    }
}

/// Part of the light that optical depths let through; nothing where they are above `opaque`.
pub(super) fn let_through<R: Real>(depths: &Colors<R>, opaque: R) -> Colors<R> {
    let mut arriving = Colors::splat(R::ZERO, depths.len());
    for (x, decays) in depths.0.iter().zip(&mut arriving.0) {
        R::vectorized(Decays { x, decays });
    }
    for index in 0..depths.len() {
        if smallest(depths.get(index)) > opaque {
            arriving.set(index, splat(R::ZERO));
        }
    }
    arriving
}

impl<F: Fields> Integrator<'_, F> {
    /// Fraction of the light that arrives, per channel.
    pub(crate) fn visibility(
        &mut self,
        rays: &[ShadowRay<F::Real>],
        light: &Light<F::Real>,
    ) -> Vec<Vec3<F::Real>> {
        self.stats.shadow_rays += rays.len() as u64;
        let mut parts = Vec::with_capacity(rays.len());
        for batch in rays.chunks(self.batches.rays) {
            let blocked = self.blocked(batch).into_iter();
            parts.extend(blocked.map(|blocked| if blocked { F::Real::ZERO } else { F::Real::ONE }));
        }
        self.through_media(rays, &parts, light)
    }

    /// Fraction of lights with a size that arrives, per channel: the part that no solid hides, weakened by
    /// the media towards the centre.
    pub(super) fn soft_visibility(
        &mut self,
        cones: &[Cone<F::Real>],
        light: &Light<F::Real>,
    ) -> Vec<Vec3<F::Real>> {
        let parts = self.lit_parts(cones);
        let rays: Vec<_> = cones.iter().map(|cone| cone.shadow).collect();
        self.through_media(&rays, &parts, light)
    }

    /// The part of each light that solids let through, weakened by the media.
    pub(super) fn through_media(
        &mut self,
        rays: &[ShadowRay<F::Real>],
        parts: &[F::Real],
        light: &Light<F::Real>,
    ) -> Vec<Vec3<F::Real>> {
        let mut all = Vec::with_capacity(rays.len());
        let batches = rays.chunks(self.batches.rays).zip(parts.chunks(self.batches.rays));
        for (batch, parts) in batches {
            let mut seen = vec![splat(F::Real::ZERO); batch.len()];
            // Only what solids do not hide goes through the media.
            let free: Vec<usize> = (0..batch.len()).filter(|&ray| parts[ray] > F::Real::ZERO).collect();
            let arriving = let_through(&self.depth_towards(light, batch, &free), self.scene.opaque);
            for (index, ray) in free.into_iter().enumerate() {
                seen[ray] = scale(arriving.get(index), parts[ray]);
            }
            all.extend(seen);
        }
        all
    }

    /// Optical depth between the start of some rays and the light at their end: of the light's grid where it
    /// has one.
    fn depth_towards(
        &mut self,
        light: &Light<F::Real>,
        rays: &[ShadowRay<F::Real>],
        some: &[usize],
    ) -> Colors<F::Real> {
        if let Some(grid) = self.scene.grid(light) {
            return grid.depths(&some.iter().map(|&ray| rays[ray].ray.origin).collect());
        }
        let paths: Vec<_> = some.iter().map(|&ray| rays[ray].ray).collect();
        let ends: Vec<_> = some.iter().map(|&ray| rays[ray].length).collect();
        self.optical_depth(&paths, &ends).into_iter().collect()
    }

    /// Whether the ray enters a solid before it reaches the light.
    pub(crate) fn blocked(&mut self, rays: &[ShadowRay<F::Real>]) -> Vec<bool> {
        let mut blocked = vec![false; rays.len()];
        if self.scene.solids.is_empty() {
            return blocked;
        }
        let paths: Vec<_> = rays.iter().map(|ray| ray.ray).collect();
        let mut walkers = Walkers::new(&paths, self.met_from_outside(&paths));
        for step in 1..=MAX_STEPS {
            self.nearest(&mut walkers);
            walkers.go(|walker, near| {
                if near.is_past(&walker) {
                    return Some(walker.back());
                }
                // Only the inside of a solid hides: a ray may leave a surface at a grazing angle.
                let ray = &rays[walker.ray];
                if ray.enters(near.distance, walker.t) {
                    blocked[walker.ray] = true;
                    return None;
                }
                let next = near.onward(walker, step, ray.stride);
                (next.t < ray.length.min(F::Real::from_f32(FAR))).then_some(next)
            });
            if walkers.are_done() {
                break;
            }
        }
        blocked
    }

    /// Distance at which each ray first enters a solid from outside, up to a length, where it enters none up to `starts`;
    /// steps are no shorter than `least`.
    pub(crate) fn entries(
        &mut self,
        rays: &[Ray<F::Real>],
        starts: &[F::Real],
        length: F::Real,
        least: F::Real,
    ) -> Vec<Option<F::Real>> {
        let mut entries = vec![None; rays.len()];
        let mut walkers = Walkers::started(rays, self.met_from_outside(rays), starts);
        for step in 1..=MAX_STEPS {
            self.nearest(&mut walkers);
            walkers.go(|walker, near| {
                if near.distance < F::Real::ZERO {
                    entries[walker.ray] = Some(walker.t);
                    return None;
                }
                let t = walker.t + near.advance(step, least);
                (t < length).then_some(walker.to(t))
            });
            if walkers.are_done() {
                break;
            }
        }
        entries
    }

    /// Integral of the extinction along each ray.
    pub(super) fn optical_depth(&mut self, rays: &[Ray<F::Real>], ends: &[F::Real]) -> Vec<Vec3<F::Real>> {
        if let Some(depths) = self.reference_depth(rays, ends) {
            return depths;
        }
        let mut depths = vec![splat(F::Real::ZERO); rays.len()];
        let combs = self.combs(rays, ends, self.scene.shadow_step);
        let nodes = self.batches.nodes;
        let mut active = combs.active();
        while !active.is_empty() {
            let before = self.stats.shadow_samples + self.stats.region_evaluations;
            let steps = self.step_depths(rays, &combs, &active);
            let spent = self.stats.shadow_samples + self.stats.region_evaluations - before;
            if self.is_broke(spent) {
                break;
            }
            for steps in steps.chunks(active.len()) {
                for (cursor, &step) in active.iter().zip(steps) {
                    depths[cursor.ray] = add(depths[cursor.ray], step);
                }
            }
            // Go on with the rays that are not dark yet.
            active.retain_mut(|cursor| {
                let dark = smallest(depths[cursor.ray]) > self.scene.opaque;
                !dark && combs.advance(cursor, nodes)
            });
        }
        depths
    }

    /// Optical depth of each of the next nodes or panels, all media together: those of the first node of each active ray,
    /// then of the second.
    pub(super) fn step_depths(
        &mut self,
        rays: &[Ray<F::Real>],
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
    ) -> Vec<Vec3<F::Real>> {
        let mut steps = vec![splat(F::Real::ZERO); active.len() * self.batches.nodes as usize];
        for medium in 0..self.scene.media.len() {
            match self.scene.quadrature {
                Quadrature::Midpoint => self.node_depths(medium, rays, combs, active, &mut steps),
                Quadrature::Corrected => self.panel_depths(medium, rays, combs, active, &mut steps),
            }
        }
        steps
    }

    /// Adds the optical depth of one medium at the next nodes.
    fn node_depths(
        &mut self,
        medium: usize,
        rays: &[Ray<F::Real>],
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
        steps: &mut [Vec3<F::Real>],
    ) {
        let inside = self.inside(medium, rays, combs, active);
        let extinction = self.scene.media[medium].extinction;
        let values: [Vec<F::Real>; 4] = self.fields.sample(extinction, &inside.points);
        self.stats.shadow_samples += inside.places.len() as u64;
        let [density, r, g, b] = values;
        for (index, place) in inside.places.iter().enumerate() {
            let mass = density[index].max(F::Real::ZERO) * inside.weights[index];
            let step = &mut steps[place.node.unwrap_or(0) * active.len() + place.which];
            *step = add(*step, scale([r[index], g[index], b[index]], mass));
        }
    }

    /// Adds the optical depth of one medium in the next panels.
    fn panel_depths(
        &mut self,
        medium: usize,
        rays: &[Ray<F::Real>],
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
        steps: &mut [Vec3<F::Real>],
    ) {
        let extinction = self.scene.media[medium].extinction;
        let panels: Panels<_, 4> = self.panels(medium, extinction, rays, combs, active);
        self.stats.shadow_samples += panels.places.len() as u64;
        for panel in &panels.list {
            let step = &mut steps[panel.number * active.len() + panel.which];
            *step = add(*step, panels.depth(panel, 1));
        }
    }
}
