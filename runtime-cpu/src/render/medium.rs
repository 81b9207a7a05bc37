//! What media along a ray add and take away.
//!
//! Nodes of [`super::comb`] are gathered for a batch of rays, a few per ray at a time. At each
//! node the optical depths `x` and the sources of all media are added up, and the node gives what a
//! homogeneous stretch would: `L += T source (1 - exp(-x)) / x`, `T *= exp(-x)`. The corrected form
//! ([`super::corrected`]) shares what comes before and after.
//!
//! **Doubt.** The same sum over every other node, each counted twice, is a second picture at twice the
//! step for nothing. How far it is from the first says little about one ray: it is a measure of how much
//! there is to miss (algorithms.md §5.1), and its rms over the picture is scaled to what the pilot found.
//!
//! Twin: `compiler/src/wgsl/render/medium.wgsl`.

use super::camera::Ray;
use super::comb::{Combs, Cursor, Inside};
use super::fields::{Fields, colors};
use super::scatter::{Filling, scatters};
use super::scene::Integrator;
use super::styled::StyledRays;
use crate::real::{Real, Vec3, add, largest, mul, scale, splat};
use std::array;
use vol_compiler::frame::Quadrature;

/// Places of the colours among the outputs of [`vol_compiler::program::Medium::interior`].
pub(super) const SCATTERING: usize = 1;
pub(super) const EXTINCTION: usize = 4;
pub(super) const EMISSION: usize = 7;

/// Where less than this of the light arrives, the ray ends: what lies behind is lost, at most this
/// much of its radiance.
pub(crate) const STOP: f32 = 1.0 / 65_536.0;

/// What media do to a ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Glow<R> {
    /// Radiance that they add.
    pub(crate) light: Vec3<R>,
    /// Fraction that they let through from behind.
    pub(crate) transmittance: Vec3<R>,
    /// The same two by every other node.
    pub(crate) coarse_light: Vec3<R>,
    pub(crate) coarse_transmittance: Vec3<R>,
}

impl<R: Real> Glow<R> {
    /// Nothing is there.
    pub(super) fn clear() -> Self {
        let (zero, one) = (splat(R::ZERO), splat(R::ONE));
        Self { light: zero, transmittance: one, coarse_light: zero, coarse_transmittance: one }
    }

    /// Takes every other node for as good as all: of ways that have none.
    pub(super) fn without_doubt(&mut self) {
        (self.coarse_light, self.coarse_transmittance) = (self.light, self.transmittance);
    }
}

/// The next nodes or panels of each active ray; one slot for each.
pub(super) struct Chunk<R> {
    /// Optical depth.
    pub(super) depth: Vec<Vec3<R>>,
    /// exp(-x) of that.
    pub(super) decay: Vec<Vec3<R>>,
    /// Fraction of what is sent from there that reaches the eye; nothing behind the end of the ray.
    pub(super) arriving: Vec<Option<Vec3<R>>>,
    /// Light that leaves towards the eye.
    pub(super) sent: Vec<Vec3<R>>,
}

impl<R: Real> Chunk<R> {
    /// Nothing is there.
    pub(super) fn new(slots: usize) -> Self {
        let zero = splat(R::ZERO);
        let decay = vec![splat(R::ONE); slots];
        Self { depth: vec![zero; slots], decay, arriving: vec![None; slots], sent: vec![zero; slots] }
    }

    /// What leaves a node of a source that is spread over its optical depth.
    pub(super) fn mean(&self, slot: usize, source: Vec3<R>) -> Vec3<R> {
        let [depth, decay] = [self.depth[slot], self.decay[slot]];
        mul(source, array::from_fn(|channel| depth[channel].mean_decay(decay[channel])))
    }
}

impl<F: Fields> Integrator<'_, F> {
    /// Follows each ray through the media up to its end.
    pub(crate) fn march(&mut self, rays: &[Ray<F::Real>], ends: &[F::Real]) -> Vec<Glow<F::Real>> {
        let mut glows = vec![Glow::clear(); rays.len()];
        let styled = self.style_rays(rays, ends);
        let combs = self.combs(rays, ends, self.scene.step);
        let mut active = combs.active();
        while !active.is_empty() {
            let before = self.stats.medium_samples;
            let chunk = match self.scene.quadrature {
                Quadrature::Midpoint => self.node_chunk(rays, &styled, &combs, &active, &glows),
                Quadrature::Corrected => self.panel_chunk(rays, &styled, &combs, &active, &glows),
            };
            self.gather(&active, &mut glows, &chunk);
            let nodes = active.len() as u64 * self.batches.nodes as u64;
            if self.is_broke(nodes + self.stats.medium_samples - before) {
                break;
            }
            // Go on with the rays that still let light through.
            let stop = self.scene.stop;
            active.retain_mut(|cursor| {
                let open = largest(glows[cursor.ray].transmittance) >= stop;
                open && combs.advance(cursor, self.batches.nodes)
            });
        }
        glows
    }

    /// Light and optical depth of the next nodes.
    fn node_chunk(
        &mut self,
        rays: &[Ray<F::Real>],
        styled: &StyledRays<F::Real>,
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
        glows: &[Glow<F::Real>],
    ) -> Chunk<F::Real> {
        let (mut chunk, fillings) = self.lit_nodes(rays, styled, combs, active, glows, None);
        // Add up what they send.
        let nodes = self.batches.nodes as usize;
        for filling in &fillings {
            for (place, &source) in filling.places.iter().zip(&filling.source) {
                let slot = place.slot(nodes);
                chunk.sent[slot] = add(chunk.sent[slot], chunk.mean(slot, source));
            }
        }
        chunk
    }

    /// Optical depth of the next nodes, and the media at them with what they send; of one lamp's light alone if one is
    /// named.
    pub(super) fn lit_nodes(
        &mut self,
        rays: &[Ray<F::Real>],
        styled: &StyledRays<F::Real>,
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
        glows: &[Glow<F::Real>],
        only: Option<usize>,
    ) -> (Chunk<F::Real>, Vec<Filling<F::Real>>) {
        let nodes = self.batches.nodes as usize;
        let mut chunk = Chunk::new(active.len() * nodes);
        let fillings = 0..self.scene.media.len();
        let fillings = fillings.map(|medium| self.fill(medium, rays, combs, active, &mut chunk));
        let mut fillings: Vec<_> = fillings.collect();
        self.transmit(active, glows, &mut chunk);
        for filling in &mut fillings {
            let places = filling.places.iter().zip(&filling.scatter);
            let lit = places.map(|(place, &k)| chunk.arriving[place.slot(nodes)].is_some() && scatters(k));
            filling.lit = lit.collect();
            if only.is_some() {
                filling.source.fill(splat(F::Real::ZERO));
            }
        }
        self.light_places(rays, styled, active, &mut fillings, only);
        (chunk, fillings)
    }

    /// Evaluates one medium at the next nodes and adds its optical depths.
    fn fill(
        &mut self,
        medium: usize,
        rays: &[Ray<F::Real>],
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
        chunk: &mut Chunk<F::Real>,
    ) -> Filling<F::Real> {
        let Inside { places, weights, points } = self.inside(medium, rays, combs, active);
        let interior = self.scene.media[medium].interior;
        let values: [Vec<F::Real>; 10] = self.fields.sample(interior, &points);
        self.stats.medium_samples += places.len() as u64;
        let mut masses = weights;
        for (mass, density) in masses.iter_mut().zip(&values[0]) {
            *mass = density.max(F::Real::ZERO) * *mass;
        }
        let nodes = self.batches.nodes as usize;
        let per_mass = |first| colors(&values, first).zip(&masses).map(|(color, &mass)| scale(color, mass));
        for (place, depth) in places.iter().zip(per_mass(EXTINCTION)) {
            let slot = place.slot(nodes);
            chunk.depth[slot] = add(chunk.depth[slot], depth);
        }
        let [scatter, source] = [SCATTERING, EMISSION].map(|first| per_mass(first).collect());
        Filling { medium, places, points, scatter, lit: Vec::new(), source }
    }

    /// Finds how much of each node's light arrives, and which nodes are behind the end of the ray.
    pub(super) fn transmit(&self, active: &[Cursor], glows: &[Glow<F::Real>], chunk: &mut Chunk<F::Real>) {
        let nodes = self.batches.nodes as usize;
        F::Real::decays(chunk.depth.as_flattened(), chunk.decay.as_flattened_mut());
        for (which, cursor) in active.iter().enumerate() {
            let mut transmittance = glows[cursor.ray].transmittance;
            for slot in which * nodes..(which + 1) * nodes {
                if largest(transmittance) < self.scene.stop {
                    break;
                }
                chunk.arriving[slot] = Some(transmittance);
                transmittance = mul(transmittance, chunk.decay[slot]);
            }
        }
    }

    /// Adds up the nodes of each ray, front to back.
    pub(super) fn gather(&self, active: &[Cursor], glows: &mut [Glow<F::Real>], chunk: &Chunk<F::Real>) {
        let nodes = self.batches.nodes as usize;
        for (which, cursor) in active.iter().enumerate() {
            let glow = &mut glows[cursor.ray];
            for node in 0..nodes {
                let slot = which * nodes + node;
                let Some(arriving) = chunk.arriving[slot] else { break };
                let (sent, decay) = (chunk.sent[slot], chunk.decay[slot]);
                glow.light = add(glow.light, mul(arriving, sent));
                glow.transmittance = mul(arriving, decay);
                // Of twice the matter: (1 - exp(-2x)) / x is (1 - exp(-x)) / x times 1 + exp(-x).
                if (cursor.node as usize + node).is_multiple_of(2) {
                    let twice = mul(sent, decay.map(|decay| F::Real::ONE + decay));
                    glow.coarse_light = add(glow.coarse_light, mul(glow.coarse_transmittance, twice));
                    glow.coarse_transmittance = mul(glow.coarse_transmittance, mul(decay, decay));
                }
            }
        }
    }
}
