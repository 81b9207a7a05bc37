//! An independent oracle: `--integrator monte-carlo`. Unbiased, and slow.
//!
//! A sample of a pixel follows one random path (delta tracking, Woodcock 1965; local majorants):
//!
//! 1. Tentative collisions along the camera ray are a Poisson process whose rate `m` is nowhere below the
//!    extinction ([`super::majorant`]).
//! 2. At each, emission is gathered as `w e / m`, w the weight of the path per channel, at first 1.
//! 3. The collision is a real one with probability `p = sum(w s) / (m sum(w))` over the channels, s the
//!    extinction; for grey media `s / m`. Then the light of all lamps that is scattered there counts by
//!    `w scattering / (m p)` and the path ends.
//! 4. Else the path goes on with `w (1 - s / m) / (1 - p)`: the sum of the weights stays 3, so none grows
//!    beyond (history-aware null collisions, Kutz et al. 2017).
//! 5. A path that comes through sees what is behind times w.
//!
//! The transmittance towards a light is a product of `1 - s / m` over tentative collisions (ratio tracking,
//! Novak et al. 2014). Below [`FAINT`] Russian roulette ends it as in the third paper: killed with
//! probability `1 - 1/d`, else multiplied by `d`.
//!
//! No step, no comb and no rule about walls is used, so agreement with the comb says something about both.
//! Solids, surfaces and their soft shadows are those of the comb.

use super::camera::Ray;
use super::fields::{Fields, Points};
use super::majorant::{FreePath, Majorants, Tentative};
use super::matter::{Part, Place};
use super::medium::Glow;
use super::random::{Purpose, Stream};
use super::scene::Integrator;
use crate::real::{Real, Vec3, add, largest, mul, scale, splat};

/// Transmittance below which Russian roulette begins.
const FAINT: f32 = 1e-3;

/// What a transmittance that survives it is multiplied by, the paper's d; one of d survives.
const ROULETTE: f32 = 2.0;

/// Stands for the optical depth of nothing arriving.
const BLACK: f32 = 1e4;

/// A path that has not ended.
struct Walk<R> {
    /// Index of the ray.
    ray: usize,
    path: FreePath,
    /// Weight of what comes from farther on.
    weight: Vec3<R>,
}

/// A walk at its next tentative collision.
struct Collision<R> {
    walk: Walk<R>,
    at: Tentative,
}

impl<F: Fields> Integrator<'_, F> {
    /// One random path along each camera ray.
    pub(super) fn draw_paths(
        &mut self,
        rays: &[Ray<F::Real>],
        ends: &[F::Real],
        seed: u64,
        majorants: &Majorants,
    ) -> Vec<Glow<F::Real>> {
        let dark = Glow { transmittance: splat(F::Real::ZERO), ..Glow::clear() };
        let mut glows = vec![dark; rays.len()];
        let (mut places, mut parts, mut origins) = (Vec::new(), Vec::new(), Vec::new());
        let mut walks = start(rays, ends, seed, Purpose::Path, majorants);
        while !walks.is_empty() {
            // Walk to the next tentative collisions; what comes through sees what is behind.
            let (collisions, through) = collide(walks, majorants);
            through.into_iter().for_each(|walk| glows[walk.ray].transmittance = walk.weight);
            let points = collisions.iter().map(|collision| at(rays, collision)).collect();
            let (extinctions, emissions, scatterings) = self.matter_of_all(&points);
            walks = Vec::with_capacity(collisions.len());
            let mut stopped = vec![None; collisions.len()];
            for (index, mut collision) in collisions.into_iter().enumerate() {
                let (ray, rate) = (collision.walk.ray, F::Real::from_f64(collision.at.rate));
                let weight = collision.walk.weight;
                let emitted = mul(weight, emissions[index]).map(|light| light / rate);
                glows[ray].light = add(glows[ray].light, emitted);
                // Is it a real one?
                let extinction = extinctions[index];
                let probability = real_share(weight, extinction, rate);
                if collision.walk.path.stream.uniform::<F::Real>() < probability {
                    stopped[index] = Some((places.len(), weight.map(|w| w / (rate * probability))));
                    let ray = &rays[ray];
                    let t = F::Real::from_f64(collision.at.t);
                    places.push(Place { point: ray.at(t), direction: ray.direction, t });
                    origins.push(collision.walk.ray);
                } else {
                    let rest = F::Real::ONE - probability;
                    let missed = extinction.map(|s| (F::Real::ONE - s / rate) / rest);
                    walks.push(Walk { weight: mul(weight, missed), ..collision.walk });
                }
            }
            for (medium, index, scattering) in scatterings {
                if let Some((place, weight)) = stopped[index] {
                    parts.push(Part { place, medium, scattering: mul(scattering, weight) });
                }
            }
        }
        let lights = self.scattered(&places, &parts);
        for (ray, light) in origins.into_iter().zip(lights) {
            glows[ray].light = add(glows[ray].light, light);
        }
        glows
    }

    /// `-ln` of an unbiased estimate of the transmittance of each ray.
    pub(super) fn tracked_depth(
        &mut self,
        rays: &[Ray<F::Real>],
        ends: &[F::Real],
        seed: u64,
        majorants: &Majorants,
    ) -> Vec<Vec3<F::Real>> {
        let mut depths = vec![splat(F::Real::from_f32(BLACK)); rays.len()];
        let mut walks = start(rays, ends, seed, Purpose::Light, majorants);
        while !walks.is_empty() {
            let (collisions, through) = collide(walks, majorants);
            through.into_iter().for_each(|walk| depths[walk.ray] = walk.weight.map(depth));
            let points = collisions.iter().map(|collision| at(rays, collision)).collect();
            let extinctions = self.extinction_of_all(&points);
            walks = Vec::with_capacity(collisions.len());
            for (Collision { mut walk, at }, extinction) in collisions.into_iter().zip(extinctions) {
                let rate = F::Real::from_f64(at.rate);
                walk.weight = mul(walk.weight, extinction.map(|s| F::Real::ONE - s / rate));
                if survives(&mut walk) {
                    walks.push(walk);
                }
            }
        }
        depths
    }

    /// Extinction and emission of all media at points, and what scatters: medium, index of the point, scattering.
    fn matter_of_all(&mut self, points: &Points<F::Real>) -> Everything<F::Real> {
        let mut extinctions = vec![splat(F::Real::ZERO); points.len()];
        let mut emissions = extinctions.clone();
        let mut scatterings = Vec::new();
        for medium in 0..self.scene.media.len() {
            let inside = self.inside_of(medium, points);
            let own = inside.iter().map(|&index| points.get(index)).collect();
            for (index, matter) in inside.into_iter().zip(self.matter(medium, &own)) {
                extinctions[index] = add(extinctions[index], matter.extinction);
                emissions[index] = add(emissions[index], matter.emission);
                scatterings.push((medium, index, matter.scattering));
            }
        }
        (extinctions, emissions, scatterings)
    }

    /// Extinction of all media at points.
    fn extinction_of_all(&mut self, points: &Points<F::Real>) -> Vec<Vec3<F::Real>> {
        let mut extinctions = vec![splat(F::Real::ZERO); points.len()];
        for medium in 0..self.scene.media.len() {
            let inside = self.inside_of(medium, points);
            let own = inside.iter().map(|&index| points.get(index)).collect();
            for (index, extinction) in inside.into_iter().zip(self.extinction(medium, &own)) {
                extinctions[index] = add(extinctions[index], extinction);
            }
        }
        extinctions
    }
}

/// Extinctions, emissions, and the scattering of each medium at each point inside.
type Everything<R> = (Vec<Vec3<R>>, Vec<Vec3<R>>, Vec<(usize, usize, Vec3<R>)>);

/// All rays at their origins, with weight 1.
fn start<R: Real>(
    rays: &[Ray<R>],
    ends: &[R],
    seed: u64,
    purpose: Purpose,
    majorants: &Majorants,
) -> Vec<Walk<R>> {
    let walk = |(index, (ray, &end)): (usize, (&Ray<R>, &R))| {
        let path = majorants.path(ray, end, Stream::of_ray(ray, seed, purpose));
        Walk { ray: index, path, weight: splat(R::ONE) }
    };
    rays.iter().zip(ends).enumerate().map(walk).collect()
}

/// Takes walks to their next tentative collisions; second, those that come through.
fn collide<R: Real>(walks: Vec<Walk<R>>, majorants: &Majorants) -> (Vec<Collision<R>>, Vec<Walk<R>>) {
    let (mut collisions, mut through) = (Vec::with_capacity(walks.len()), Vec::new());
    for mut walk in walks {
        match walk.path.next::<R>(majorants) {
            Some(at) => collisions.push(Collision { walk, at }),
            None => through.push(walk),
        }
    }
    (collisions, through)
}

/// Where a collision is.
fn at<R: Real>(rays: &[Ray<R>], collision: &Collision<R>) -> Vec3<R> {
    rays[collision.walk.ray].at(R::from_f64(collision.at.t))
}

/// Probability of a real collision, at most 1.
fn real_share<R: Real>(weight: Vec3<R>, extinction: Vec3<R>, rate: R) -> R {
    let sum = |v: Vec3<R>| (v[0] + v[1]) + v[2];
    let all = rate * sum(weight);
    if all > R::ZERO { (sum(mul(weight, extinction)) / all).min(R::ONE) } else { R::ONE }
}

/// Russian roulette: whether a walk towards a light goes on.
fn survives<R: Real>(walk: &mut Walk<R>) -> bool {
    let most = largest(walk.weight);
    if most >= R::from_f32(FAINT) {
        return true;
    }
    let d = R::from_f32(ROULETTE);
    let killed = walk.path.stream.uniform::<R>() < R::ONE - R::ONE / d;
    walk.weight = scale(walk.weight, d);
    most > R::ZERO && !killed
}

/// The optical depth that lets so much through.
fn depth<R: Real>(transmittance: R) -> R {
    let ln_2 = R::from_f32(std::f32::consts::LN_2);
    if transmittance > R::ZERO { -(transmittance.log2() * ln_2) } else { R::from_f32(BLACK) }
}
