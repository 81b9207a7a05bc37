//! Single scattering: light of the lamps that media send towards the eye, at the places where they are
//! sampled.
//!
//! Twin: `compiler/src/wgsl/render/scatter.wgsl`.

use super::camera::Ray;
use super::comb::Cursor;
use super::fields::{Colors, Fields, Points};
use super::scene::{Integrator, Light};
use super::shade::{Arriving, arriving};
use super::shadow::{ShadowRay, let_through};
use super::styled::{StyledRay, StyledRays, asked};
use super::surface::shadow_bias;
use crate::real::{Real, Vec3, add, dot, mul, scale, splat, sub};
use std::mem;
use vol_compiler::ir::FunctionId;
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

/// One medium at its places.
pub(crate) struct Filling<R> {
    pub(crate) medium: usize,
    pub(crate) places: Vec<Place<R>>,
    /// The same in space.
    pub(crate) points: Points<R>,
    /// Scattering, times whatever the source is meant per.
    pub(crate) scatter: Colors<R>,
    /// Whether light matters there.
    pub(crate) lit: Vec<bool>,
    /// Light sent towards the eye; the medium's own before that of the lamps.
    pub(crate) source: Colors<R>,
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
        seen: &Colors<F::Real>,
    ) {
        let medium = &self.scene.media[filling.medium];
        if medium.lighting == Lighting::None {
            return;
        }
        let lit: Vec<usize> = (0..filling.lit.len()).filter(|&place| filling.lit[place]).collect();
        let lamps: Vec<_> = lit.iter().map(|&place| arriving(light, filling.points.get(place))).collect();
        let whiches: Vec<usize> = lit.iter().map(|&place| filling.places[place].which).collect();
        let phases = self.phases(medium.phase, light.distant, rays, active, &whiches, &lamps);
        // Add what arrives and is turned towards the eye.
        let table = self.scene.styled(light);
        for ((place, lamp), phase) in lit.into_iter().zip(lamps).zip(phases) {
            let arrives = match (medium.lighting, &table, styled) {
                (Lighting::Unshadowed, ..) => splat(F::Real::ONE),
                (_, Some(table), Some(styled)) => {
                    let (ray, _) = asked(active, &filling.places[place]);
                    mul(seen.get(place), self.styled_tint(table, &styled[ray], filling.points.get(place)))
                }
                _ => seen.get(place),
            };
            let light = mul(scale(filling.scatter.get(place), phase), mul(lamp.irradiance, arrives));
            filling.source.add(place, light);
        }
    }

    /// A phase function from a lamp towards the eye, at places on active rays; of a distant lamp it is the same all along a
    /// ray, and asked once.
    fn phases(
        &mut self,
        phase: FunctionId,
        distant: bool,
        rays: &[Ray<F::Real>],
        active: &[Cursor],
        whiches: &[usize],
        lamps: &[Arriving<F::Real>],
    ) -> Vec<F::Real> {
        let mut asked: Vec<usize> = (0..lamps.len()).collect();
        if distant {
            let mut is_known = vec![false; active.len()];
            asked.retain(|&place| !mem::replace(&mut is_known[whiches[place]], true));
        }
        let turns = asked
            .iter()
            .map(|&place| turn(lamps[place].direction, rays[active[whiches[place]].ray].direction));
        let turns: Vec<_> = turns.collect();
        let [less, more]: [Vec<_>; 2] = [0, 1].map(|side| turns.iter().map(|turn| turn[side]).collect());
        let [phases] = self.fields.apply(phase, &[&less, &more]);
        if !distant {
            return phases;
        }
        let mut of_rays = vec![F::Real::ZERO; active.len()];
        asked.iter().zip(phases).for_each(|(&place, phase)| of_rays[whiches[place]] = phase);
        whiches.iter().map(|&which| of_rays[which]).collect()
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
    ) -> Vec<Colors<F::Real>> {
        let one = F::Real::ONE;
        let seen = fillings.iter().map(|filling| Colors::splat(one, filling.places.len()));
        let mut seen: Vec<_> = seen.collect();
        if !light.shadows {
            return seen;
        }
        let media = &self.scene.media;
        let shadowed = |filling: &Filling<F::Real>| media[filling.medium].lighting == Lighting::Shadowed;
        // One node more than panels; of one medium each asks for itself.
        let nodes = self.batches.nodes as usize + 1;
        let shared = fillings.iter().filter(|filling| shadowed(filling)).count() > 1;
        let mut known = vec![None; if shared { active.len() * nodes } else { 0 }];
        let (mut asking, mut places, mut points) = (Vec::new(), Vec::new(), Points::new());
        for (which, filling) in fillings.iter().enumerate().filter(|(_, filling)| shadowed(filling)) {
            for (index, place) in filling.places.iter().enumerate().filter(|&(index, _)| filling.lit[index]) {
                let mut node = place.node.and_then(|node| known.get_mut(place.which * nodes + node));
                let number = node.as_ref().and_then(|node| **node).unwrap_or(places.len());
                if number == places.len() {
                    places.push(asked(active, place));
                    points.push(filling.points.get(index));
                }
                if let Some(node) = &mut node {
                    **node = Some(number);
                }
                asking.push((which, index, number));
            }
        }
        let found = self.arriving_at(light, rays, styled, &places, &points);
        asking.into_iter().for_each(|(which, index, number)| seen[which].set(index, found.get(number)));
        seen
    }

    /// Fraction of a lamp's light that arrives at points, which are `asked` for as a style is.
    fn arriving_at(
        &mut self,
        light: &Light<F::Real>,
        rays: &[Ray<F::Real>],
        styled: Option<&[StyledRay<F::Real>]>,
        asked: &[(usize, F::Real)],
        points: &Points<F::Real>,
    ) -> Colors<F::Real> {
        let scene = self.scene;
        let table = scene.styled(light).zip(styled);
        if let Some(grid) = scene.grid(light).filter(|_| table.is_none() && scene.solids.is_empty()) {
            self.stats.shadow_rays += points.len() as u64;
            return let_through(&grid.depths(points), scene.opaque);
        }
        let shadow_ray = |(index, &(_, t)): (usize, &(usize, F::Real))| {
            let origin = points.get(index);
            let lamp = arriving(light, origin);
            ShadowRay::new(Ray::new(origin, lamp.direction), lamp.distance, shadow_bias(scene, t))
        };
        let shadow_rays: Vec<_> = asked.iter().enumerate().map(shadow_ray).collect();
        let found = match table {
            Some((table, styled)) => self.styled_visibility(light, &table, rays, styled, asked, &shadow_rays),
            None => self.visibility(&shadow_rays, light),
        };
        found.into_iter().collect()
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
