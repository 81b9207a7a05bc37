//! How open a surface is: light that reaches it from all sides, as an option of a light.
//!
//! At five heights above a point, along its normal, the distance to the nearest solid is compared with the
//! height. Over a plane they are equal; where another surface is nearer, it hides
//! `(1 - distance / height) / 2` of the sky, which is 1/2 for a wall that stands at the point and 1 where the place is as
//! deep inside a solid as the height. The lower heights count for more.
//!
//! * an infinite plane is open by 1 (up to rounding), the edge between two walls at a right angle by 1/2,
//!   as the hemisphere weighted by the cosine is; a place at a distance x from the wall by
//!   `1 - sum w_i max(0, 1 - x / h_i) / 2`; never outside 0..1 (test `occlusion_of_known_places`)
//! * the distances are taken as the scene gives them: where a displaced solid's are too small, it is darker
//! * method: samples along the normal with falling weights (A. Evans, "Fast approximations for global illumination on
//!   dynamic scenes", SIGGRAPH 2006 course notes), weights that sum to 1
//!
//! Twin: `compiler/src/wgsl/render/occlusion.wgsl`.

use super::box_tree::Answer;
use super::camera::contains;
use super::fields::{Fields, Points};
use super::scene::Integrator;
use super::surface::Contact;
use crate::real::{Real, Vec3, add, scale};

/// Weights of the heights from the lowest, times 31: each counts half as much as the one below.
const WEIGHTS: [f32; 5] = [16.0, 8.0, 4.0, 2.0, 1.0];

impl<F: Fields> Integrator<'_, F> {
    /// How open each contact is, 0 to 1, to what is within a distance of it.
    pub(super) fn openness(&mut self, contacts: &[&Contact<F::Real>], reach: F::Real) -> Vec<F::Real> {
        let mut hidden = vec![F::Real::ZERO; contacts.len()];
        for (index, weight) in WEIGHTS.into_iter().enumerate() {
            let share = F::Real::from_index(index as i32 + 1) / F::Real::from_index(WEIGHTS.len() as i32);
            let height = share * reach;
            let distances = self.distances_above(contacts, height);
            for (hidden, distance) in hidden.iter_mut().zip(distances) {
                let lack = ((height - distance) / height).max(F::Real::ZERO);
                let part = (F::Real::from_f32(0.5) * lack).min(F::Real::ONE);
                *hidden = *hidden + F::Real::from_f32(weight) * part;
            }
        }
        let sum = F::Real::from_f32(WEIGHTS.iter().sum());
        hidden.into_iter().map(|hidden| F::Real::ONE - (hidden / sum).min(F::Real::ONE)).collect()
    }

    /// Distance of the nearest solid at a height above each contact; at most the height.
    fn distances_above(&mut self, contacts: &[&Contact<F::Real>], height: F::Real) -> Vec<F::Real> {
        let mut distances = vec![height; contacts.len()];
        let scene = self.scene;
        let above: Vec<_> =
            contacts.iter().map(|contact| add(contact.position, scale(contact.normal, height))).collect();
        // A solid whose box is farther than the height hides nothing.
        let is_near = |point: usize, lo: Vec3<F::Real>, hi: Vec3<F::Real>| {
            contains(lo.map(|x| x - height), hi.map(|x| x + height), above[point]).then_some(())
        };
        let whole = |answer: &Answer<()>| scene.solids[answer.index].whole;
        for parts in scene.ask_boxes(above.len(), is_near).chunk_by(|a, b| whole(a) == whole(b)) {
            // Who is in one part of a union that holds the eye is in all of it: the farthest wall counts.
            let mut walls = vec![None; above.len()];
            for near in parts.chunk_by(|a, b| a.index == b.index) {
                let solid = near[0].index;
                let points: Points<_> = near.iter().map(|answer| above[answer.question]).collect();
                let [found] = self.fields.sample(scene.solids[solid].distance, &points);
                self.stats.surface_evaluations += near.len() as u64;
                let side = self.sides[solid];
                let join = if side < F::Real::ZERO { F::Real::max } else { F::Real::min };
                for (answer, distance) in near.iter().zip(found) {
                    let wall: &mut Option<F::Real> = &mut walls[answer.question];
                    *wall = Some(wall.map_or(side * distance, |other| join(other, side * distance)));
                }
            }
            for (distance, wall) in distances.iter_mut().zip(walls) {
                *distance = wall.map_or(*distance, |wall| distance.min(wall));
            }
        }
        distances
    }
}
