//! What media along a ray add and take away, by [`super::panel`].
//!
//! In a thick panel the source (light sent per unit of density) changes linearly with the optical depth `x`,
//! from `s0` to `s1`: `L += T mass (s0 phi + (s1 - s0) psi)`, `phi = (1 - exp(-x)) / x`,
//! `psi = (phi - exp(-x)) / x` (algorithms.md §5.1), of all media with the same `x`. That is right for any `x`, but
//! of second order: its errors have one sign. In a thin panel it is the trapezoid of the whole integrand,
//! `L += T (m0 s0 + m1 s1 exp(-x))`, whose errors cancel along a ray (Euler and Maclaurin: only ends and kinks
//! count, and those are in the masses). Between [`THIN`] and [`THICK`] one goes over into the other. Nothing is
//! divided by the extinction: a gas that only glows is nothing special.
//!
//! Twin: `compiler/src/wgsl/render/corrected.wgsl`.

use super::camera::Ray;
use super::chunk::Chunk;
use super::comb::{Combs, Cursor};
use super::fields::Fields;
use super::medium::{EXTINCTION, Glow, coefficients_of};
use super::panel::{Panel, Panels};
use super::scatter::{Filling, scatters};
use super::scene::Integrator;
use super::styled::StyledRays;
use crate::real::{Real, Vec3, add, mul, scale, sub};
use std::array;

/// Up to this optical depth a panel is thin.
const THIN: f32 = 0.125;

/// From this optical depth a panel is thick.
const THICK: f32 = 0.5;

impl<F: Fields> Integrator<'_, F> {
    /// Light and optical depth of the next panels.
    pub(super) fn panel_chunk(
        &mut self,
        rays: &[Ray<F::Real>],
        styled: &StyledRays<F::Real>,
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
        glows: &[Glow<F::Real>],
    ) -> Chunk<F::Real> {
        let mut chunk = Chunk::new(active.len(), self.batches.nodes as usize, self.scene.stop);
        // Find the panels and their optical depths, all media together.
        let mut all = Vec::with_capacity(self.scene.media.len());
        for medium in 0..self.scene.media.len() {
            let interior = self.scene.media[medium].interior;
            let panels: Panels<_, 10> = self.panels(medium, interior, rays, combs, active);
            self.stats.medium_samples += panels.places.len() as u64;
            for panel in &panels.list {
                let slot = chunk.slot_of(panel.which, panel.number);
                chunk.depth.add(slot, panels.depth(panel, EXTINCTION));
            }
            all.push(panels);
        }
        chunk.transmit(active, glows);
        // Light their ends.
        let (mut fillings, mut lists) = (Vec::new(), Vec::new());
        for (medium, panels) in all.into_iter().enumerate() {
            let (filling, list) = filling(medium, panels, &chunk);
            fillings.push(filling);
            lists.push(list);
        }
        self.light_places(rays, styled, active, &mut fillings, None);
        // Add up what they send.
        for (filling, list) in fillings.iter().zip(lists) {
            for panel in list {
                let slot = chunk.slot_of(panel.which, panel.number);
                let sources = panel.ends.map(|end| filling.source.get(end));
                chunk
                    .sent
                    .add(slot, sent(panel.masses, sources, chunk.depth.get(slot), chunk.decay.get(slot)));
            }
        }
        chunk
    }
}

/// Light that a panel sends towards the eye, in front of it.
fn sent<R: Real>(masses: [R; 2], [from, to]: [Vec3<R>; 2], depth: Vec3<R>, decay: Vec3<R>) -> Vec3<R> {
    let steady = mul(from, array::from_fn(|channel| depth[channel].mean_decay(decay[channel])));
    let change = mul(sub(to, from), array::from_fn(|channel| depth[channel].decay_moment(decay[channel])));
    let thick = scale(add(steady, change), masses[0] + masses[1]);
    let thin = add(scale(from, masses[0]), scale(mul(to, decay), masses[1]));
    let rise = |x: R| ((x - R::from_f32(THIN)) * R::from_f32(1.0 / (THICK - THIN))).max(R::ZERO).min(R::ONE);
    add(thin, mul(sub(thick, thin), depth.map(rise)))
}

/// A medium at the ends of its panels, and those of them whose light arrives. Ends of others stay dark.
fn filling<R: Real>(medium: usize, panels: Panels<R, 10>, chunk: &Chunk<R>) -> (Filling<R>, Vec<Panel<R>>) {
    let [scatter, _, source] = coefficients_of(panels.values);
    let mut list = panels.list;
    list.retain(|panel| chunk.is_open(chunk.slot_of(panel.which, panel.number)));
    let mut lit = vec![false; panels.places.len()];
    for end in list.iter().flat_map(|panel| panel.ends) {
        lit[end] = scatters(scatter.get(end));
    }
    (Filling { medium, places: panels.places, points: panels.points, scatter, lit, source }, list)
}
