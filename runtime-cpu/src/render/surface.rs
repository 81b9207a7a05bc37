//! Where rays meet solids: sphere tracing, by what [`super::stride`] makes of the distances, with steps that go farther
//! where distances fall evenly ([`super::near`]).
//!
//! All rays of a batch walk together, one step each at a time. A tree over the boxes of the solids tells which
//! of them some ray meets at all; each of these is evaluated for the rays that are inside its box. A solid whose inside holds the eye is seen from within: its
//! distance and its normal change sign for camera rays, so the ray ends at the far wall. Where one part of a union
//! holds the eye all are seen from within, and the ray ends where it leaves the last.
//!
//! A ray hits what it enters: it walks on, at least a fortieth of a pixel at a time, until a distance
//! is negative, and the hit is then found between the last two places. To stop where the distance is
//! below half a pixel would make every silhouette half a pixel larger.
//!
//! Twin: `compiler/src/wgsl/render/surface.wgsl`.

use super::box_tree::Answer;
use super::camera::{FAR, Ray, contains};
use super::fields::{Fields, Points};
use super::near::{Met, Walker, Walkers};
use super::scene::{Batches, Integrator, Scene};
use crate::real::{Real, Vec3, dot, length, scale};
use std::collections::{BTreeMap, BTreeSet};

/// Most steps of a ray towards a surface. A ray that is still walking then grazes something.
pub(crate) const MAX_STEPS: u32 = 2000;

/// Distance between neighbours of 1 in f32.
pub(super) const EPSILON: f32 = 1.192_092_9e-7;

/// Rounds of [`Integrator::refine`]: over a fortieth of a pixel the first leaves next to nothing where
/// the ray meets the surface, the others serve rays that only touch it.
pub(super) const REFINEMENTS: u32 = 4;

/// A gradient shorter than this has no direction.
pub(super) const FLAT: f32 = 1e-15;

/// Where a ray meets a solid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact<R> {
    /// Index of the ray.
    pub(crate) ray: usize,
    /// Index of the solid.
    pub(crate) solid: usize,
    /// Distance from the origin of the ray.
    pub(crate) t: R,
    /// The point.
    pub(crate) position: Vec3<R>,
    /// Unit normal on the eye's side of the wall; towards the eye where the field is flat.
    pub(crate) normal: Vec3<R>,
    /// How far the point may be off the surface.
    pub(crate) residual: R,
}

/// How near a ray may pass a surface unseen: half a pixel, or what rounding makes of positions.
pub(crate) fn tolerance<R: Real>(scene: &Scene<R>, t: R) -> R {
    let pixel = (R::from_f32(0.5) * scene.footprint) * t;
    pixel.max(R::from_f32(4.0 * EPSILON) * (scene.remoteness + t))
}

/// Shortest step of a ray: nothing thinner than a fortieth of a pixel is sure to be seen.
pub(crate) fn stride<R: Real>(scene: &Scene<R>, t: R) -> R {
    let pixel = (R::from_f32(0.025) * scene.footprint) * t;
    pixel.max(R::from_f32(4.0 * EPSILON) * (scene.remoteness + t))
}

/// How far shadow rays start off a surface: a tenth of a pixel plus what rounding may need.
pub(crate) fn shadow_bias<R: Real>(scene: &Scene<R>, t: R) -> R {
    let pixel = (R::from_f32(0.1) * scene.footprint) * t;
    pixel + rounding(scene, t)
}

/// How far rounding may move a surface along a ray, with room to spare.
fn rounding<R: Real>(scene: &Scene<R>, t: R) -> R {
    R::from_f32(64.0 * EPSILON) * (scene.remoteness + t)
}

impl<'a, F: Fields> Integrator<'a, F> {
    /// An integrator for camera rays of a scene.
    pub(crate) fn new(scene: &'a Scene<F::Real>, fields: F, batches: Batches) -> Self {
        let sides = vec![F::Real::ONE; scene.solids.len()];
        let mut new = Self { scene, fields, sides, batches, stats: super::Stats::default(), purse: None };
        new.find_sides();
        new
    }

    /// Finds the solids that hold the eye, with all that they are parts of.
    fn find_sides(&mut self) {
        let scene = self.scene;
        let eye = Points::from_iter([scene.camera.origin]);
        let holds = |_, lo, hi| contains(lo, hi, scene.camera.origin).then_some(());
        let mut holding = BTreeSet::new();
        for Answer { index, .. } in scene.ask_boxes(1, holds) {
            let [distance] = self.fields.sample(scene.solids[index].distance, &eye);
            if distance[0] < F::Real::ZERO {
                holding.insert(scene.solids[index].whole);
            }
        }
        for (side, solid) in self.sides.iter_mut().zip(&scene.solids) {
            *side = if holding.contains(&solid.whole) { -F::Real::ONE } else { F::Real::ONE };
        }
    }

    /// The solids whose boxes camera rays meet; a solid that is seen from within may be anywhere on
    /// the rest of the ray, since it ends where the box may end.
    fn met_from_the_eye(&self, rays: &[Ray<F::Real>]) -> Vec<Met<F::Real>> {
        let mut all = self.met_from_outside(rays);
        for met in &mut all {
            met.side = self.sides[met.solid];
            if met.side < F::Real::ZERO {
                met.parts.iter_mut().for_each(|(_, span)| span.exit = F::Real::from_f32(FAR));
            }
        }
        all
    }

    /// The solids whose boxes rays meet.
    pub(crate) fn met_from_outside(&self, rays: &[Ray<F::Real>]) -> Vec<Met<F::Real>> {
        Met::of(&self.scene.boxes_met(rays))
    }

    /// First surface on each ray, in the order of the rays.
    pub(crate) fn trace(&mut self, rays: &[Ray<F::Real>]) -> Vec<Contact<F::Real>> {
        if self.scene.solids.is_empty() {
            return Vec::new();
        }
        let mut walkers = Walkers::new(rays, self.met_from_the_eye(rays));
        let mut hits = Vec::new();
        let scene = self.scene;
        for step in 1..=MAX_STEPS {
            self.nearest(&mut walkers);
            walkers.go(|walker, near| {
                if near.is_past(&walker) {
                    return Some(walker.back());
                }
                // Stop inside a solid; on the last step also where it would have been near enough.
                let patience = if step == MAX_STEPS { tolerance(scene, walker.t) } else { F::Real::ZERO };
                if near.value < patience {
                    hits.push((walker, near.solid));
                    return None;
                }
                // Walk as far as nothing can be, at least a fortieth of a pixel.
                let next = near.onward(walker, step, stride(scene, walker.t));
                (next.t < F::Real::from_f32(FAR)).then_some(next)
            });
            if walkers.are_done() {
                break;
            }
        }
        self.touch(rays, &hits)
    }

    /// Moves hits onto their surfaces and finds the normals.
    fn touch(&mut self, rays: &[Ray<F::Real>], hits: &[(Walker<F::Real>, usize)]) -> Vec<Contact<F::Real>> {
        let mut contacts = Vec::with_capacity(hits.len());
        let mut by_solid: BTreeMap<usize, Vec<_>> = BTreeMap::new();
        hits.iter().for_each(|&(walker, solid)| by_solid.entry(solid).or_default().push(walker));
        for (solid, here) in by_solid {
            contacts.extend(self.refine(rays, solid, here));
        }
        contacts.sort_unstable_by_key(|contact| contact.ray);
        contacts
    }

    /// False position between the last two places of each walker.
    fn refine(
        &mut self,
        rays: &[Ray<F::Real>],
        solid: usize,
        walkers: Vec<Walker<F::Real>>,
    ) -> Vec<Contact<F::Real>> {
        let start: Vec<_> = walkers.iter().map(|walker| Walker::new(walker.ray, walker.from)).collect();
        let outer = self.values(rays, solid, &start);
        let inner = self.values(rays, solid, &walkers);
        let bracket = |index: usize| {
            let walker: &Walker<F::Real> = &walkers[index];
            Bracket { outside: [walker.from, outer[index]], inside: [walker.t, inner[index]] }
        };
        let mut brackets: Vec<_> = (0..walkers.len()).map(bracket).collect();
        for _ in 0..REFINEMENTS {
            let between: Vec<_> =
                walkers.iter().zip(&brackets).map(|(walker, bracket)| bracket.probe(walker)).collect();
            let values = self.values(rays, solid, &between);
            let probes = between.iter().zip(values).zip(&mut brackets);
            probes.for_each(|((walker, value), bracket)| bracket.narrow(walker.t, value));
        }
        let ends = walkers.iter().zip(&brackets).map(|(walker, bracket)| (walker.ray, bracket.best()));
        let ends: Vec<_> = ends.collect();
        let gradients = self.facing_gradients(rays, solid, &ends);
        let ends = ends.into_iter().zip(gradients);
        ends.map(|((ray, best), gradient)| contact(self.scene, &rays[ray], (ray, solid), best, gradient))
            .collect()
    }

    /// Gradients of one solid's distance where rays enter it, at `[t, value]`: taken a little inside, since
    /// on the surface itself a distance may have none. One that points along its ray is that of another
    /// wall, where solids touch: then it is taken a little outside.
    fn facing_gradients(
        &mut self,
        rays: &[Ray<F::Real>],
        solid: usize,
        ends: &[(usize, [F::Real; 2])],
    ) -> Vec<Vec3<F::Real>> {
        let scene = self.scene;
        let beside = |ray: usize, t: F::Real, side: F::Real| {
            let t = t + side * rounding(scene, t);
            Walker::new(ray, t)
        };
        let inside: Vec<_> = ends.iter().map(|&(ray, [t, _])| beside(ray, t, F::Real::ONE)).collect();
        let mut gradients = self.gradients(rays, solid, &inside);
        let away = |i: &usize| dot(gradients[*i], rays[ends[*i].0].direction) > F::Real::ZERO;
        let away: Vec<usize> = (0..ends.len()).filter(away).collect();
        let outside =
            away.iter().map(|&i| beside(ends[i].0, ends[i].1[0], -F::Real::ONE)).collect::<Vec<_>>();
        for (i, gradient) in away.into_iter().zip(self.gradients(rays, solid, &outside)) {
            gradients[i] = gradient;
        }
        gradients
    }

    /// Distances of one solid as the camera sees them.
    fn values(&mut self, rays: &[Ray<F::Real>], solid: usize, walkers: &[Walker<F::Real>]) -> Vec<F::Real> {
        let points = walkers.iter().map(|walker| rays[walker.ray].at(walker.t)).collect();
        let [values] = self.fields.sample(self.scene.solids[solid].distance, &points);
        self.stats.surface_evaluations += values.len() as u64;
        values.into_iter().map(|value| self.sides[solid] * value).collect()
    }

    /// Gradients of one solid's distance as the camera sees it.
    fn gradients(
        &mut self,
        rays: &[Ray<F::Real>],
        solid: usize,
        walkers: &[Walker<F::Real>],
    ) -> Vec<Vec3<F::Real>> {
        let points = walkers.iter().map(|walker| rays[walker.ray].at(walker.t)).collect();
        let [x, y, z] = self.fields.sample(self.scene.solids[solid].gradient, &points);
        self.stats.surface_evaluations += x.len() as u64;
        (0..x.len()).map(|i| scale([x[i], y[i], z[i]], self.sides[solid])).collect()
    }
}

/// Two places on a ray, the field 0 between them: `[t, value]` each.
#[derive(Clone, Copy, Debug)]
struct Bracket<R> {
    /// Where the value is not negative.
    outside: [R; 2],
    /// Where it is.
    inside: [R; 2],
}

impl<R: Real> Bracket<R> {
    /// Whether the field changes sign at all: not where a ray stopped for want of patience.
    fn is_proper(&self) -> bool {
        (self.outside[1] >= R::ZERO) & (self.inside[1] < R::ZERO)
    }

    /// Where the field would be 0 if it were linear between the two.
    fn probe(&self, walker: &Walker<R>) -> Walker<R> {
        let ([t, value], [other_t, other_value]) = (self.outside, self.inside);
        let fall = if self.is_proper() { value - other_value } else { R::ONE };
        let t = if self.is_proper() { t + (other_t - t) * (value / fall) } else { other_t };
        Walker::new(walker.ray, t)
    }

    /// Takes the value at the probe into account.
    fn narrow(&mut self, t: R, value: R) {
        if value < R::ZERO {
            self.inside = [t, value];
        } else {
            self.outside = [t, value];
        }
    }

    /// The place nearer to the surface, and how far the field is from 0 there.
    fn best(&self) -> [R; 2] {
        let outside = self.outside[1].abs() < self.inside[1].abs();
        let [t, value] = if outside { self.outside } else { self.inside };
        [t, value.abs()]
    }
}

/// The place of a hit, its normal and how exact it is.
fn contact<R: Real>(
    scene: &Scene<R>,
    ray: &Ray<R>,
    ids: (usize, usize),
    [t, value]: [R; 2],
    gradient: Vec3<R>,
) -> Contact<R> {
    let steepness = length(gradient);
    let flat = steepness < R::from_f32(FLAT);
    let divisor = if flat { R::ONE } else { steepness };
    let normal = if flat { ray.direction.map(|d| -d) } else { gradient.map(|g| g / divisor) };
    let most = R::from_f32(4.0) * tolerance(scene, t);
    Contact {
        ray: ids.0,
        solid: ids.1,
        t,
        position: ray.at(t),
        normal,
        residual: (value / divisor).min(most),
    }
}
