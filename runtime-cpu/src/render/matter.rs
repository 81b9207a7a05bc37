//! Media as the reference modes read them: what is at a point, and the light that is scattered there.
//!
//! The only place where `fixed_step`, `monte_carlo` and `majorant` ask the functions of a medium.

use super::camera::{FAR, Ray};
use super::fields::{Fields, Points};
use super::scatter::turn;
use super::scene::{Integrator, Light};
use super::shade::{Arriving, arriving};
use super::shadow::ShadowRay;
use super::surface::shadow_bias;
use crate::real::{Real, Vec3, add, mul, scale, splat};
use vol_compiler::frame::{Frame, MediumFrame};
use vol_compiler::ops::interval::Interval;
use vol_compiler::program::{Lighting, Program};
use vol_compiler::reference;

/// What a medium is at a point inside it, per unit length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Matter<R> {
    pub(super) scattering: Vec3<R>,
    pub(super) extinction: Vec3<R>,
    pub(super) emission: Vec3<R>,
}

/// Bounds on a medium over a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct MatterBounds {
    /// Largest extinction of any channel; infinite or no number if nothing is known.
    pub(super) extinction: f64,
    /// Whether it may emit light.
    pub(super) glows: bool,
}

/// Bounds by interval evaluation; none if the medium's region does not reach into the box.
pub(super) fn bounds(
    program: &Program,
    frame: &Frame,
    medium: &MediumFrame,
    cell: &[Interval; 3],
) -> Option<MatterBounds> {
    let of = |function| {
        reference::interval(program.module.function(function), cell, &frame.uniforms, &frame.curves)
    };
    if of(medium.region)[0].lo > 0.0 {
        return None;
    }
    // Coefficients are per unit of density, and negative density is none.
    let (interior, shadow) = (of(medium.interior), of(medium.extinction));
    let most = |density: Interval, coefficient: &Interval| density.hi.max(0.0) * coefficient.hi;
    let of_camera = interior[4..7].iter().map(|extinction| most(interior[0], extinction));
    // Extinction of shadows and of camera rays is one formula, but each is bounded as it is asked.
    let of_shadows = shadow[1..4].iter().map(|extinction| most(shadow[0], extinction));
    let larger = |most: f64, bound: f64| if bound.is_nan() { f64::NAN } else { most.max(bound) };
    let extinction = of_camera.chain(of_shadows).fold(0.0, larger);
    let may_be = |bound: &Interval| bound.hi > 0.0 || bound.hi.is_nan();
    let glows = may_be(&interior[0]) && interior[7..10].iter().any(may_be);
    Some(MatterBounds { extinction, glows })
}

/// A point on a camera ray at which light is scattered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<R> {
    pub(super) point: Vec3<R>,
    /// Direction of the camera ray.
    pub(super) direction: Vec3<R>,
    /// Distance from the eye.
    pub(super) t: R,
}

/// A medium's part in the scattering at a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Part<R> {
    /// Index of the place.
    pub(super) place: usize,
    pub(super) medium: usize,
    /// Scattering, in whatever the light is to be multiplied by.
    pub(super) scattering: Vec3<R>,
}

impl<F: Fields> Integrator<'_, F> {
    /// Indices of the points inside a medium.
    pub(super) fn inside_of(&mut self, medium: usize, points: &Points<F::Real>) -> Vec<usize> {
        let cells = &self.scene.media[medium].cells;
        let near = |&index: &usize| cells.is_empty() || cells.is_near(points.get(index), F::Real::ZERO);
        let near: Vec<usize> = (0..points.len()).filter(near).collect();
        let found = self.region(medium, &near.iter().map(|&index| points.get(index)).collect());
        let inside = near.into_iter().zip(found).filter(|(_, region)| *region < F::Real::ZERO);
        inside.map(|(index, _)| index).collect()
    }

    /// What a medium is at points inside it.
    pub(super) fn matter(&mut self, medium: usize, points: &Points<F::Real>) -> Vec<Matter<F::Real>> {
        let values: [Vec<F::Real>; 10] = self.fields.sample(self.scene.media[medium].interior, points);
        self.stats.medium_samples += points.len() as u64;
        let color = |first: usize, i: usize| {
            let density = values[0][i].max(F::Real::ZERO);
            scale([values[first][i], values[first + 1][i], values[first + 2][i]], density)
        };
        let matter = |i| Matter { scattering: color(1, i), extinction: color(4, i), emission: color(7, i) };
        (0..points.len()).map(matter).collect()
    }

    /// Extinction of a medium at points inside it, for rays towards lights.
    pub(super) fn extinction(&mut self, medium: usize, points: &Points<F::Real>) -> Vec<Vec3<F::Real>> {
        let [density, r, g, b] = self.fields.sample(self.scene.media[medium].extinction, points);
        self.stats.shadow_samples += points.len() as u64;
        let of = |i: usize| scale([r[i], g[i], b[i]], density[i].max(F::Real::ZERO));
        (0..points.len()).map(of).collect()
    }

    /// Light of all lamps that is scattered towards the eye at each place.
    pub(super) fn scattered(
        &mut self,
        places: &[Place<F::Real>],
        parts: &[Part<F::Real>],
    ) -> Vec<Vec3<F::Real>> {
        let mut sum = vec![splat(F::Real::ZERO); places.len()];
        let scene = self.scene;
        let lit = |part: &&Part<F::Real>| {
            scene.media[part.medium].lighting != Lighting::None
                && part.scattering.iter().any(|&k| k != F::Real::ZERO)
        };
        let parts: Vec<_> = parts.iter().filter(lit).copied().collect();
        if parts.is_empty() {
            return sum;
        }
        for light in &scene.lights {
            let lamps: Vec<_> = places.iter().map(|place| arriving(light, place.point)).collect();
            let seen = self.lamp_visibility(light, places, &lamps, &parts);
            for (index, medium) in scene.media.iter().enumerate() {
                let own: Vec<_> = parts.iter().filter(|part| part.medium == index).collect();
                let angles =
                    |part: &&Part<F::Real>| turn(lamps[part.place].direction, places[part.place].direction);
                let [less, more]: [Vec<_>; 2] =
                    [0, 1].map(|i| own.iter().map(|part| angles(part)[i]).collect());
                let [phase] = self.fields.apply(medium.phase, &[&less, &more]);
                for (part, phase) in own.into_iter().zip(phase) {
                    let free = medium.lighting == Lighting::Unshadowed;
                    let seen = if free { splat(F::Real::ONE) } else { seen[part.place] };
                    let arriving = mul(lamps[part.place].irradiance, seen);
                    sum[part.place] = add(sum[part.place], mul(scale(part.scattering, phase), arriving));
                }
            }
        }
        sum
    }

    /// Fraction of a lamp's light that arrives at each place where a medium needs to know.
    fn lamp_visibility(
        &mut self,
        light: &Light<F::Real>,
        places: &[Place<F::Real>],
        lamps: &[Arriving<F::Real>],
        parts: &[Part<F::Real>],
    ) -> Vec<Vec3<F::Real>> {
        let mut seen = vec![splat(F::Real::ONE); places.len()];
        if !light.shadows {
            return seen;
        }
        let shadowed = |part: &&Part<F::Real>| self.scene.media[part.medium].lighting == Lighting::Shadowed;
        let mut asked: Vec<usize> = parts.iter().filter(shadowed).map(|part| part.place).collect();
        asked.sort_unstable();
        asked.dedup();
        let shadow_ray = |&index: &usize| {
            let (place, lamp) = (&places[index], &lamps[index]);
            let ray = Ray::new(place.point, lamp.direction);
            ShadowRay::new(ray, lamp.distance.min(F::Real::from_f32(FAR)), shadow_bias(self.scene, place.t))
        };
        let rays: Vec<_> = asked.iter().map(shadow_ray).collect();
        let found = self.visibility(&rays, light);
        asked.into_iter().zip(found).for_each(|(index, found)| seen[index] = found);
        seen
    }
}
