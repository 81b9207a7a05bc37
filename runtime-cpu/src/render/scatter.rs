//! Single scattering: light of the lamps that media send towards the eye, at the places where they are
//! sampled.
//!
//! Twin: `compiler/src/wgsl/render/scatter.wgsl`.

use super::camera::Ray;
use super::comb::Cursor;
use super::fields::{Fields, Points};
use super::scene::{Integrator, Light};
use super::shade::{Arriving, arriving};
use super::shadow::ShadowRay;
use super::styled::{StyledRay, StyledRays, asked};
use super::surface::shadow_bias;
use crate::real::{Real, Vec3, add, dot, mul, scale, splat, sub};
use vol_compiler::program::Lighting;

/// Where a medium is sampled.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place<R> {
    /// Index of the active ray.
    pub(crate) which: usize,
    /// Number of the node after the cursor; none for a wall.
    pub(crate) node: Option<usize>,
    /// Distance from the origin of the ray.
    pub(crate) t: R,
}

impl<R> Place<R> {
    /// The slot of its node, with so many to an active ray.
    pub(crate) fn slot(&self, nodes: usize) -> usize {
        self.which * nodes + self.node.unwrap_or(0)
    }
}

/// One medium at its places.
pub(crate) struct Filling<R> {
    pub(crate) medium: usize,
    pub(crate) places: Vec<Place<R>>,
    /// The same in space.
    pub(crate) points: Points<R>,
    /// Scattering, times whatever the source is meant per.
    pub(crate) scatter: Vec<Vec3<R>>,
    /// Whether light matters there.
    pub(crate) lit: Vec<bool>,
    /// Light sent towards the eye; the medium's own before that of the lamps.
    pub(crate) source: Vec<Vec3<R>>,
}

/// Whether any channel scatters.
pub(crate) fn scatters<R: Real>(scatter: Vec3<R>) -> bool {
    scatter.iter().any(|&k| k > R::ZERO)
}

impl<F: Fields> Integrator<'_, F> {
    /// Adds the light of all lamps to the sources, or that of one of them.
    pub(super) fn light_places(
        &mut self,
        rays: &[Ray<F::Real>],
        styled: &StyledRays<F::Real>,
        active: &[Cursor],
        fillings: &mut [Filling<F::Real>],
        only: Option<usize>,
    ) {
        for index in (0..self.scene.lights.len()).filter(|&index| only.is_none_or(|only| index == only)) {
            let light = self.scene.lights[index];
            let styled = styled[index].as_deref();
            let seen = self.place_visibility(&light, rays, styled, active, fillings);
            for (filling, seen) in fillings.iter_mut().zip(seen) {
                self.scatter_light(&light, rays, styled, active, filling, &seen);
            }
        }
    }

    /// Adds the light of one lamp, scattered towards the eye by one medium.
    fn scatter_light(
        &mut self,
        light: &Light<F::Real>,
        rays: &[Ray<F::Real>],
        styled: Option<&[StyledRay<F::Real>]>,
        active: &[Cursor],
        filling: &mut Filling<F::Real>,
        seen: &[Vec3<F::Real>],
    ) {
        let medium = &self.scene.media[filling.medium];
        if medium.lighting == Lighting::None {
            return;
        }
        // Evaluate the phase function where light is scattered.
        let lit: Vec<usize> = (0..filling.lit.len()).filter(|&place| filling.lit[place]).collect();
        let lamp = |&place: &usize| arriving(light, filling.points.get(place));
        let lamps: Vec<Arriving<F::Real>> = lit.iter().map(lamp).collect();
        let angle = |(&place, lamp): (&usize, &Arriving<F::Real>)| {
            turn(lamp.direction, rays[active[filling.places[place].which].ray].direction)
        };
        let angles: Vec<_> = lit.iter().zip(&lamps).map(angle).collect();
        let less: Vec<_> = angles.iter().map(|angle| angle[0]).collect();
        let more: Vec<_> = angles.iter().map(|angle| angle[1]).collect();
        let [phase] = self.fields.apply(medium.phase, &[&less, &more]);
        // Add what arrives and is turned towards the eye.
        let table = self.scene.styled(light);
        for ((place, lamp), phase) in lit.into_iter().zip(lamps).zip(phase) {
            let arrives = match (medium.lighting, &table, styled) {
                (Lighting::Unshadowed, ..) => splat(F::Real::ONE),
                (_, Some(table), Some(styled)) => {
                    let (ray, _) = asked(active, &filling.places[place]);
                    mul(seen[place], self.styled_tint(table, &styled[ray], filling.points.get(place)))
                }
                _ => seen[place],
            };
            let light = mul(scale(filling.scatter[place], phase), mul(lamp.irradiance, arrives));
            filling.source[place] = add(filling.source[place], light);
        }
    }

    /// Fraction of a lamp's light that arrives at each place of each medium that needs to know. Media
    /// share their nodes.
    fn place_visibility(
        &mut self,
        light: &Light<F::Real>,
        rays: &[Ray<F::Real>],
        styled: Option<&[StyledRay<F::Real>]>,
        active: &[Cursor],
        fillings: &[Filling<F::Real>],
    ) -> Vec<Vec<Vec3<F::Real>>> {
        let one = splat(F::Real::ONE);
        let mut seen: Vec<_> = fillings.iter().map(|filling| vec![one; filling.lit.len()]).collect();
        if !light.shadows {
            return seen;
        }
        let scene = self.scene;
        let shadowed =
            |filling: &Filling<F::Real>| scene.media[filling.medium].lighting == Lighting::Shadowed;
        // One node more than panels; of one medium each asks for itself.
        let nodes = self.batches.nodes as usize + 1;
        let shared = fillings.iter().filter(|filling| shadowed(filling)).count() > 1;
        let mut known = vec![None; if shared { active.len() * nodes } else { 0 }];
        let (mut asking, mut places, mut shadow_rays) = (Vec::new(), Vec::new(), Vec::new());
        for (which, filling) in fillings.iter().enumerate().filter(|(_, filling)| shadowed(filling)) {
            for (index, place) in filling.places.iter().enumerate().filter(|&(index, _)| filling.lit[index]) {
                let mut node = place.node.and_then(|_| known.get_mut(place.slot(nodes)));
                let number = node.as_ref().and_then(|node| **node).unwrap_or(shadow_rays.len());
                if number == shadow_rays.len() {
                    let origin = filling.points.get(index);
                    let lamp = arriving(light, origin);
                    let ray = Ray::new(origin, lamp.direction);
                    places.push(asked(active, place));
                    shadow_rays.push(ShadowRay::new(ray, lamp.distance, shadow_bias(scene, place.t)));
                }
                if let Some(node) = &mut node {
                    **node = Some(number);
                }
                asking.push((which, index, number));
            }
        }
        let found = match (self.scene.styled(light), styled) {
            (Some(table), Some(styled)) => {
                self.styled_visibility(light, &table, rays, styled, &places, &shadow_rays)
            }
            _ => self.visibility(&shadow_rays, light),
        };
        asking.into_iter().for_each(|(which, index, number)| seen[which][index] = found[number]);
        seen
    }
}

/// `1 - cos` and `1 + cos` of the angle by which light from a lamp turns towards the eye, without
/// cancellation. `toward` is the direction to the lamp, `direction` that of the camera ray.
pub(super) fn turn<R: Real>(toward: Vec3<R>, direction: Vec3<R>) -> [R; 2] {
    // The light flies along -toward and leaves along -direction: their cosine is toward.direction.
    let half = R::from_f32(0.5);
    let apart = sub(toward, direction);
    let together = add(toward, direction);
    [half * dot(apart, apart), half * dot(together, together)]
}
