//! What surfaces look like: their own light, and the lights that reach them.
//!
//! Twin: `compiler/src/wgsl/render/shade.wgsl`.

use super::camera::{FAR, Ray};
use super::fields::{Fields, Points};
use super::penumbra::Cone;
use super::scene::{Integrator, Light};
use super::shadow::ShadowRay;
use super::surface::{Contact, shadow_bias};
use crate::real::{Real, Vec3, add, dot, mul, scale, splat, sub};
use std::collections::BTreeMap;
use vol_compiler::frame::MAX_SPREAD_TANGENT;
use vol_compiler::program::SURFACE_OUTPUTS;

/// Light on its way to a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arriving<R> {
    /// Unit direction towards the light.
    pub(crate) direction: Vec3<R>,
    /// Distance of the light.
    pub(crate) distance: R,
    /// Irradiance on a plane that faces the light, if nothing is between.
    pub(crate) irradiance: Vec3<R>,
    /// Tangent of half the angle across the light.
    pub(crate) slope: R,
}

/// How a surface answers light, see [`SURFACE_OUTPUTS`].
#[derive(Clone, Copy, Debug)]
struct Response<R> {
    emitted: Vec3<R>,
    diffuse: Vec3<R>,
    specular: Vec3<R>,
    shininess: R,
}

/// A contact that a light can reach.
struct Facing<R> {
    /// Index of the contact.
    contact: usize,
    /// The light.
    arriving: Arriving<R>,
    /// Cosine between the normal and the direction towards the light; positive.
    cosine: R,
}

/// What a light sends to a point.
pub(crate) fn arriving<R: Real>(light: &Light<R>, point: Vec3<R>) -> Arriving<R> {
    if light.distant {
        return Arriving {
            direction: light.position,
            distance: R::from_f32(FAR),
            irradiance: light.color,
            slope: light.size,
        };
    }
    let toward = sub(light.position, point);
    // At the very place of the light the irradiance stays finite.
    let squared = dot(toward, toward).max(R::from_f32(1e-12));
    let distance = squared.sqrt();
    Arriving {
        direction: toward.map(|component| component / distance),
        distance,
        irradiance: light.color.map(|component| component / squared),
        slope: (light.size / distance).min(R::from_f32(MAX_SPREAD_TANGENT as f32)),
    }
}

/// x^y for x >= 0; 0 at 0.
fn power<R: Real>(x: R, y: R) -> R {
    if x > R::ZERO { (y * x.log2()).exp2() } else { R::ZERO }
}

impl<F: Fields> Integrator<'_, F> {
    /// Radiance that leaves each contact towards the eye.
    pub(crate) fn shade(
        &mut self,
        rays: &[Ray<F::Real>],
        contacts: &[Contact<F::Real>],
    ) -> Vec<Vec3<F::Real>> {
        let responses = self.responses(contacts);
        let mut colors: Vec<_> = responses.iter().map(|response| response.emitted).collect();
        for index in 0..self.scene.lights.len() {
            let light = &self.scene.lights[index];
            let facing = self.facing(light, contacts, &responses);
            let mut seen = self.seen(light, contacts, &facing);
            if light.occlusion > F::Real::ZERO {
                let places: Vec<_> = facing.iter().map(|facing| &contacts[facing.contact]).collect();
                let open = self.openness(&places, light.occlusion);
                seen.iter_mut().zip(open).for_each(|(seen, open)| *seen = scale(*seen, open));
            }
            for (facing, seen) in facing.iter().zip(seen) {
                let contact = &contacts[facing.contact];
                let response = &responses[facing.contact];
                let answer = answer(response, contact, facing, rays[contact.ray].direction);
                let light = mul(mul(facing.arriving.irradiance, seen), answer);
                colors[facing.contact] = add(colors[facing.contact], light);
            }
        }
        colors
    }

    /// Evaluates the surfaces. One that shows its normals emits them and answers no light.
    fn responses(&mut self, contacts: &[Contact<F::Real>]) -> Vec<Response<F::Real>> {
        let zero = splat(F::Real::ZERO);
        let dark = Response { emitted: zero, diffuse: zero, specular: zero, shininess: F::Real::ZERO };
        let mut responses = vec![dark; contacts.len()];
        let half = F::Real::from_f32(0.5);
        let mut by_solid: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        contacts
            .iter()
            .enumerate()
            .for_each(|(c, contact)| by_solid.entry(contact.solid).or_default().push(c));
        for (index, here) in by_solid {
            let solid = &self.scene.solids[index];
            if solid.shows_normals {
                for which in here {
                    responses[which].emitted = scale(add(contacts[which].normal, splat(F::Real::ONE)), half);
                }
                continue;
            }
            let points: Points<_> = here.iter().map(|&which| contacts[which].position).collect();
            let values: [Vec<F::Real>; SURFACE_OUTPUTS] = self.fields.sample(solid.surface, &points);
            for (i, which) in here.into_iter().enumerate() {
                let color = |first: usize| [values[first][i], values[first + 1][i], values[first + 2][i]];
                let shininess = values[9][i];
                responses[which] =
                    Response { emitted: color(0), diffuse: color(3), specular: color(6), shininess };
            }
        }
        responses
    }

    /// The contacts that answer a light and face it.
    fn facing(
        &self,
        light: &Light<F::Real>,
        contacts: &[Contact<F::Real>],
        responses: &[Response<F::Real>],
    ) -> Vec<Facing<F::Real>> {
        let mut facing = Vec::new();
        for (index, contact) in contacts.iter().enumerate() {
            let response = &responses[index];
            let answers = response.diffuse.iter().chain(&response.specular).any(|&k| k != F::Real::ZERO);
            let arriving = arriving(light, contact.position);
            let cosine = dot(contact.normal, arriving.direction);
            if answers && cosine > F::Real::ZERO {
                facing.push(Facing { contact: index, arriving, cosine });
            }
        }
        facing
    }

    /// Fraction of the light that arrives.
    fn seen(
        &mut self,
        light: &Light<F::Real>,
        contacts: &[Contact<F::Real>],
        facing: &[Facing<F::Real>],
    ) -> Vec<Vec3<F::Real>> {
        if !light.shadows {
            return vec![splat(F::Real::ONE); facing.len()];
        }
        let scene = self.scene;
        let shadow_ray = |facing: &Facing<F::Real>| {
            // Start off the surface, by at least twice what the hit may be off.
            let contact = &contacts[facing.contact];
            let bias = shadow_bias(scene, contact.t);
            let offset = bias.max(F::Real::from_f32(2.0) * contact.residual);
            let origin = add(contact.position, scale(contact.normal, offset));
            ShadowRay::new(Ray::new(origin, facing.arriving.direction), facing.arriving.distance, bias)
        };
        let rays: Vec<_> = facing.iter().map(shadow_ray).collect();
        if light.size > F::Real::ZERO {
            let cones = rays.iter().zip(facing);
            let cones = cones.map(|(&shadow, facing)| Cone { shadow, slope: facing.arriving.slope });
            return self.soft_visibility(&cones.collect::<Vec<_>>(), light);
        }
        self.visibility(&rays, light)
    }
}

/// Radiance towards the eye per irradiance on a facing plane.
fn answer<R: Real>(
    response: &Response<R>,
    contact: &Contact<R>,
    facing: &Facing<R>,
    direction: Vec3<R>,
) -> Vec3<R> {
    let mirrored = sub(scale(contact.normal, R::from_f32(2.0) * facing.cosine), facing.arriving.direction);
    let toward_eye = direction.map(|component| -component);
    let shine = power(dot(mirrored, toward_eye), response.shininess);
    add(scale(response.diffuse, facing.cosine), scale(response.specular, shine))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn point_light_falls_off_with_the_square() {
        let light = Light {
            distant: false,
            position: [0.0_f32, 3.0, 0.0],
            color: [18.0, 9.0, 0.0],
            shadows: true,
            size: 6.0,
            occlusion: 0.0,
            index: 0,
        };
        let at = arriving(&light, [0.0; 3]);
        assert_eq!(at.direction, [0.0, 1.0, 0.0]);
        assert_eq!(at.irradiance, [2.0, 1.0, 0.0]);
        assert_eq!(at.slope, MAX_SPREAD_TANGENT as f32, "the widest, instead of 2");
        let inside = arriving(&light, light.position);
        assert!(inside.direction[0].is_finite() && inside.irradiance[0].is_finite());
    }

    #[test]
    fn power_of_nothing_is_nothing() {
        assert_eq!(power(0.0_f32, 3.0), 0.0);
        assert_eq!(power(-0.5_f32, 3.0), 0.0);
        assert!((power(0.5_f32, 3.0) - 0.125).abs() < 1e-7);
    }
}
