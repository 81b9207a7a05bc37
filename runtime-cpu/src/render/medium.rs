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
//! Twin: `compiler/src/wgsl/render/medium.wgsl`, of the midpoint form `midpoint.wgsl` beside it.

use super::camera::Ray;
use super::chunk::Chunk;
use super::comb::{Combs, Cursor, Inside};
use super::fields::{Colors, Fields};
use super::scatter::{Filling, scatters};
use super::scene::Integrator;
use super::styled::StyledRays;
use crate::isa::Loop;
use crate::real::{Real, Vec3, largest, splat};
use vol_compiler::frame::Quadrature;
use vol_compiler::program::Lighting;

/// First place of the extinction among those outputs: see [`coefficients_of`].
pub(super) const EXTINCTION: usize = 4;

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

impl<F: Fields> Integrator<'_, F> {
    /// Follows each ray through the media up to its end.
    pub(crate) fn march(&mut self, rays: &[Ray<F::Real>], ends: &[F::Real]) -> Vec<Glow<F::Real>> {
        let mut glows = vec![Glow::clear(); rays.len()];
        let styled = self.style_rays(rays, ends);
        let combs = self.camera_combs(rays, ends);
        let mut active = combs.active();
        while !active.is_empty() {
            let before = self.stats.medium_samples;
            let chunk = match self.scene.quadrature {
                Quadrature::Midpoint => self.node_chunk(rays, &styled, &combs, &active, &glows),
                Quadrature::Corrected => self.panel_chunk(rays, &styled, &combs, &active, &glows),
            };
            chunk.gather(&active, &mut glows);
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
        let means = chunk.means();
        for filling in &fillings {
            chunk.send(&filling.places, &filling.source, &means);
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
        let mut chunk = Chunk::new(active.len(), self.batches.nodes as usize, self.scene.stop);
        let fillings = 0..self.scene.media.len();
        let fillings = fillings.map(|medium| self.fill(medium, rays, combs, active, &mut chunk));
        let mut fillings: Vec<_> = fillings.collect();
        chunk.transmit(active, glows);
        for filling in &mut fillings {
            if self.scene.media[filling.medium].lighting == Lighting::None {
                filling.lit = vec![false; filling.places.len()];
                continue;
            }
            let places = filling.places.iter().enumerate();
            let lit = places.map(|(index, place)| {
                chunk.is_open(chunk.slot(place)) && scatters(filling.scatter.get(index))
            });
            filling.lit = lit.collect();
        }
        if only.is_some() {
            for filling in &mut fillings {
                filling.source = Colors::splat(F::Real::ZERO, filling.places.len());
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
        let mut values: [Vec<F::Real>; 10] = self.fields.sample(interior, &points);
        self.stats.medium_samples += places.len() as u64;
        let mut masses = weights;
        let [density, coefficients @ ..] = &mut values;
        F::Real::vectorized(PerMass { density, masses: &mut masses, values: coefficients });
        let [scatter, extinction, source] = coefficients_of(values);
        chunk.deepen(&places, &extinction);
        Filling { medium, places, points, scatter, lit: Vec::new(), source }
    }
}

/// Scattering, extinction and emission among the outputs of [`vol_compiler::program::Medium::interior`]; the density is before
/// them.
pub(super) fn coefficients_of<R>([_, a, b, c, d, e, f, g, h, i]: [Vec<R>; 10]) -> [Colors<R>; 3] {
    [[a, b, c], [d, e, f], [g, h, i]].map(Colors)
}

/// Multiplies coefficients per unit of density by the matter of each node.
struct PerMass<'a, R> {
    density: &'a [R],
    /// Lengths of ray; then what matter there is in them.
    masses: &'a mut [R],
    values: &'a mut [Vec<R>],
}

impl<R: Real> Loop for PerMass<'_, R> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        for (mass, &density) in self.masses.iter_mut().zip(self.density) {
            *mass = density.max(R::ZERO) * *mass;
        }
        for values in self.values {
            for (value, &mass) in values.iter_mut().zip(&*self.masses) {
                *value = *value * mass;
            }
        }
    }
}
