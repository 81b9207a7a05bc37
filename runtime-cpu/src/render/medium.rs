//! What media along a ray add and take away.
//!
//! Nodes of [`super::comb`] are gathered for a batch of rays, a few per ray at a time. At each
//! node the optical depths `x` and the sources of all media are added up, and the node gives what a
//! homogeneous stretch would: `L += T source (1 - exp(-x)) / x`, `T *= exp(-x)`.
//!
//! Twin: `compiler/src/wgsl/render/medium.wgsl`.

use super::camera::Ray;
use super::comb::{Combs, Cursor, Inside};
use super::fields::Fields;
use super::scene::{Integrator, Light};
use super::shade::{Arriving, arriving};
use super::shadow::ShadowRay;
use super::surface::shadow_bias;
use crate::real::{Real, Vec3, add, dot, largest, mul, scale, splat, sub};
use vol_compiler::program::Lighting;

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
}

/// One medium's nodes of a chunk.
struct Filling<R> {
    medium: usize,
    inside: Inside<R>,
    /// Scattering times the length that the node stands for.
    scatter: Vec<Vec3<R>>,
    /// Emission times that length.
    emission: Vec<Vec3<R>>,
}

impl<R: Real> Filling<R> {
    /// Whether light matters at a node.
    fn scatters(&self, index: usize) -> bool {
        self.scatter[index].iter().any(|&k| k > R::ZERO)
    }
}

/// The next nodes of each active ray; one slot per node.
struct Chunk<R> {
    fillings: Vec<Filling<R>>,
    /// Optical depth.
    depth: Vec<Vec3<R>>,
    /// Fraction of what the node sends that reaches the eye; nothing behind the end of the ray.
    arriving: Vec<Option<Vec3<R>>>,
    /// Light that starts at the node.
    source: Vec<Vec3<R>>,
}

impl<F: Fields> Integrator<'_, F> {
    /// Follows each ray through the media up to its end.
    pub(crate) fn march(&mut self, rays: &[Ray<F::Real>], ends: &[F::Real]) -> Vec<Glow<F::Real>> {
        let clear = Glow { light: splat(F::Real::ZERO), transmittance: splat(F::Real::ONE) };
        let mut glows = vec![clear; rays.len()];
        let combs = self.combs(rays, ends, self.scene.step);
        let mut active = combs.active();
        while !active.is_empty() {
            let mut chunk = self.fill(rays, &combs, &active);
            self.transmit(&active, &glows, &mut chunk);
            self.emit(&mut chunk);
            for index in 0..self.scene.lights.len() {
                let light = self.scene.lights[index];
                self.scatter(&light, rays, &combs, &active, &mut chunk);
            }
            self.gather(&active, &mut glows, &chunk);
            // Go on with the rays that still let light through.
            let stop = F::Real::from_f32(STOP);
            active.retain_mut(|cursor| {
                cursor.node += self.batches.nodes;
                let open = largest(glows[cursor.ray].transmittance) >= stop;
                open && cursor.node <= combs.whole[cursor.ray].last
            });
        }
        glows
    }

    /// Evaluates the media at the next nodes.
    fn fill(
        &mut self,
        rays: &[Ray<F::Real>],
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
    ) -> Chunk<F::Real> {
        let zero = splat(F::Real::ZERO);
        let slots = active.len() * self.batches.nodes as usize;
        let mut chunk = Chunk {
            fillings: Vec::new(),
            depth: vec![zero; slots],
            arriving: vec![None; slots],
            source: vec![zero; slots],
        };
        for medium in 0..self.scene.media.len() {
            let inside = self.inside(medium, rays, combs, active);
            let interior = self.scene.media[medium].interior;
            let values: [Vec<F::Real>; 9] = self.fields.sample(interior, &inside.points);
            self.stats.medium_samples += inside.slots.len() as u64;
            let color =
                |first: usize, i: usize| [values[first][i], values[first + 1][i], values[first + 2][i]];
            let (mut scatter, mut emission) = (Vec::new(), Vec::new());
            for (i, (&slot, &weight)) in inside.slots.iter().zip(&inside.weights).enumerate() {
                chunk.depth[slot] = add(chunk.depth[slot], scale(color(3, i), weight));
                scatter.push(scale(color(0, i), weight));
                emission.push(scale(color(6, i), weight));
            }
            chunk.fillings.push(Filling { medium, inside, scatter, emission });
        }
        chunk
    }

    /// Finds how much of each node's light arrives, and which nodes are behind the end of the ray.
    fn transmit(&self, active: &[Cursor], glows: &[Glow<F::Real>], chunk: &mut Chunk<F::Real>) {
        let nodes = self.batches.nodes as usize;
        for (which, cursor) in active.iter().enumerate() {
            let mut transmittance = glows[cursor.ray].transmittance;
            for slot in which * nodes..(which + 1) * nodes {
                if largest(transmittance) < F::Real::from_f32(STOP) {
                    break;
                }
                chunk.arriving[slot] = Some(transmittance);
                transmittance = mul(transmittance, chunk.depth[slot].map(Real::decay));
            }
        }
    }

    /// Adds the media's own light.
    fn emit(&self, chunk: &mut Chunk<F::Real>) {
        for filling in &chunk.fillings {
            for (&slot, &emission) in filling.inside.slots.iter().zip(&filling.emission) {
                chunk.source[slot] = add(chunk.source[slot], emission);
            }
        }
    }

    /// Adds the light of one lamp, scattered towards the eye.
    fn scatter(
        &mut self,
        light: &Light<F::Real>,
        rays: &[Ray<F::Real>],
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
        chunk: &mut Chunk<F::Real>,
    ) {
        let seen = self.node_visibility(light, combs, active, chunk);
        let nodes = self.batches.nodes as usize;
        for filling in &chunk.fillings {
            let medium = &self.scene.media[filling.medium];
            if medium.lighting == Lighting::None {
                continue;
            }
            // Evaluate the phase function where light is scattered.
            let lit = |&i: &usize| chunk.arriving[filling.inside.slots[i]].is_some() && filling.scatters(i);
            let lit: Vec<usize> = (0..filling.inside.slots.len()).filter(lit).collect();
            let place = |&i: &usize| arriving(light, filling.inside.points.get(i));
            let lamps: Vec<Arriving<F::Real>> = lit.iter().map(place).collect();
            let ray = |i: usize| &rays[active[filling.inside.slots[i] / nodes].ray];
            let angles: Vec<_> =
                lit.iter().zip(&lamps).map(|(&i, lamp)| angle(lamp.direction, ray(i).direction)).collect();
            let less: Vec<_> = angles.iter().map(|angle| angle[0]).collect();
            let more: Vec<_> = angles.iter().map(|angle| angle[1]).collect();
            let [phase] = self.fields.apply(medium.phase, &[&less, &more]);
            // Add what arrives and is turned towards the eye.
            for (which, i) in lit.into_iter().enumerate() {
                let slot = filling.inside.slots[i];
                let free = medium.lighting == Lighting::Unshadowed;
                let seen = if free { splat(F::Real::ONE) } else { seen[slot] };
                let light = mul(scale(filling.scatter[i], phase[which]), mul(lamps[which].irradiance, seen));
                chunk.source[slot] = add(chunk.source[slot], light);
            }
        }
    }

    /// Fraction of a lamp's light that arrives at each slot where a medium needs to know.
    fn node_visibility(
        &mut self,
        light: &Light<F::Real>,
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
        chunk: &Chunk<F::Real>,
    ) -> Vec<Vec3<F::Real>> {
        let mut seen = vec![splat(F::Real::ONE); chunk.source.len()];
        if !light.shadows {
            return seen;
        }
        let nodes = self.batches.nodes as usize;
        let (mut slots, mut shadow_rays) = (Vec::new(), Vec::new());
        let mut asked = vec![false; chunk.source.len()];
        for filling in &chunk.fillings {
            if self.scene.media[filling.medium].lighting != Lighting::Shadowed {
                continue;
            }
            for (i, &slot) in filling.inside.slots.iter().enumerate() {
                if !asked[slot] && chunk.arriving[slot].is_some() && filling.scatters(i) {
                    asked[slot] = true;
                    let cursor = active[slot / nodes];
                    let t = combs.distance(cursor.node + (slot % nodes) as i32);
                    let origin = filling.inside.points.get(i);
                    let lamp = arriving(light, origin);
                    let ray = Ray { origin, direction: lamp.direction };
                    shadow_rays.push(ShadowRay::new(ray, lamp.distance, shadow_bias(self.scene, t)));
                    slots.push(slot);
                }
            }
        }
        let found = self.visibility(&shadow_rays);
        slots.into_iter().zip(found).for_each(|(slot, found)| seen[slot] = found);
        seen
    }

    /// Adds up the nodes of each ray, front to back.
    fn gather(&self, active: &[Cursor], glows: &mut [Glow<F::Real>], chunk: &Chunk<F::Real>) {
        let nodes = self.batches.nodes as usize;
        for (which, cursor) in active.iter().enumerate() {
            let glow = &mut glows[cursor.ray];
            for slot in which * nodes..(which + 1) * nodes {
                let Some(arriving) = chunk.arriving[slot] else { break };
                let depth = chunk.depth[slot];
                let sent = mul(chunk.source[slot], depth.map(Real::mean_decay));
                glow.light = add(glow.light, mul(arriving, sent));
                glow.transmittance = mul(arriving, depth.map(Real::decay));
            }
        }
    }
}

/// `1 - cos` and `1 + cos` of the angle by which light from a lamp turns towards the eye, without
/// cancellation. `toward` is the direction to the lamp, `direction` that of the camera ray.
pub(super) fn angle<R: Real>(toward: Vec3<R>, direction: Vec3<R>) -> [R; 2] {
    // The light flies along -toward and leaves along -direction: their cosine is toward.direction.
    let half = R::from_f32(0.5);
    let apart = sub(toward, direction);
    let together = add(toward, direction);
    [half * dot(apart, apart), half * dot(together, together)]
}
