//! What is around the rays of a batch where they are: the distance to the nearest solid and to the next box.
//!
//! Where one part of a union holds the eye ([`Joined`]) all parts are seen from within, and the ray is in the union as
//! long as it is in one of them.
//!
//! Twin: `nearest` in `compiler/src/wgsl/render/surface.wgsl`.

use super::box_tree::Answer;
use super::camera::{FAR, Ray, Span};
use super::fields::Fields;
use super::scene::Integrator;
use super::stride::Ahead;
use super::surface::MAX_STEPS;
use crate::real::Real;

/// A ray on its way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Walker<R> {
    /// Index of the ray.
    pub(crate) ray: usize,
    /// Distance walked.
    pub(crate) t: R,
    /// Where it was one step earlier.
    pub(crate) from: R,
}

/// What a walker has around it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near<R> {
    /// Distance to the nearest surface of the solids in whose boxes it is, safe to walk.
    pub(crate) distance: R,
    /// The same as the solids' fields give it.
    pub(crate) value: R,
    /// Index of the solid.
    pub(crate) solid: usize,
    /// Distance along the ray to the next box.
    pub(crate) gap: R,
    /// Distance along the ray to the last end of the boxes in which it is.
    pub(crate) rest: R,
}

impl<R: Real> Near<R> {
    /// How far to walk: as far as nothing can be, at least by `least`. A ray that has used up half of its
    /// steps is stuck at a surface that it grazes, or in a field that is nearly flat: it goes through what
    /// is left of the boxes in even steps, rather than end in a hole.
    pub(crate) fn advance(&self, step: u32, least: R) -> R {
        let free = self.distance.min(self.gap);
        let stuck = step > MAX_STEPS / 2;
        let left = R::from_index((MAX_STEPS - step + 1) as i32);
        let even = if stuck { (self.rest / left).min(self.gap) } else { R::ZERO };
        free.max(least).max(even)
    }
}

/// What a solid says at a place.
#[derive(Clone, Copy, Debug)]
struct Wall<R> {
    /// Its index.
    solid: usize,
    /// Its distance, as the ray sees it.
    value: R,
    /// What of that is safe to walk.
    safe: R,
}

impl<R: Real> Near<R> {
    /// Keeps the smallest distance; that of the earlier solid on a tie.
    fn add(&mut self, wall: &Wall<R>) {
        self.value = self.value.min(wall.value);
        if wall.safe < self.distance {
            self.distance = wall.safe;
            self.solid = wall.solid;
        }
    }
}

/// The parts of a union that holds the eye, while they are gone through: a ray is inside as long as it is in one of
/// them, so the wall is that of the part in which it is deepest.
#[derive(Debug)]
struct Joined<R> {
    /// The first part of the union.
    whole: Option<usize>,
    /// What was near each walker without any of them.
    others: Vec<Near<R>>,
    /// The farthest wall of each walker.
    farthest: Vec<R>,
}

impl<R> Default for Joined<R> {
    fn default() -> Self {
        Self { whole: None, others: Vec::new(), farthest: Vec::new() }
    }
}

impl<R: Real> Joined<R> {
    /// Goes on to the next part, of the same union or of another.
    fn begin(&mut self, whole: usize, all: &[Near<R>]) {
        if self.whole != Some(whole) {
            let farthest = vec![-R::from_f32(FAR); all.len()];
            *self = Self { whole: Some(whole), others: all.to_vec(), farthest };
        }
    }

    /// Takes a part's wall into account.
    fn add(&mut self, near: &mut Near<R>, which: usize, wall: &Wall<R>) {
        if wall.value > self.farthest[which] {
            self.farthest[which] = wall.value;
            *near = Near { gap: near.gap, rest: near.rest, ..self.others[which] };
            near.add(wall);
        }
    }
}

/// A solid whose box some ray of a batch meets.
#[derive(Debug)]
pub(crate) struct Met<R> {
    /// Its index.
    pub(crate) solid: usize,
    /// Sign of its distance for these rays.
    pub(crate) side: R,
    /// The rays that meet its box, in order, each with its part in it.
    pub(crate) parts: Vec<(usize, Span<R>)>,
}

impl<R: Real> Met<R> {
    /// Those of which something was found, with the parts of the rays.
    pub(super) fn of(answers: &[Answer<Span<R>>]) -> Vec<Self> {
        let met = |own: &[Answer<Span<R>>]| Self {
            solid: own[0].index,
            side: R::ONE,
            parts: own.iter().map(|answer| (answer.question, answer.found)).collect(),
        };
        answers.chunk_by(|a, b| a.index == b.index).map(met).collect()
    }

    /// Keeps the parts that a walker is in or comes to; notes which walkers are in this solid's box, and how far the
    /// others are from it.
    fn keep_ahead(&mut self, walkers: &[Walker<R>], all: &mut [Near<R>], here: &mut Vec<usize>) {
        let mut which = 0;
        self.parts.retain(|&(ray, span)| {
            while walkers.get(which).is_some_and(|walker| walker.ray < ray) {
                which += 1;
            }
            let Some(t) = walkers.get(which).filter(|walker| walker.ray == ray).map(|walker| walker.t) else {
                return false;
            };
            let near = &mut all[which];
            if t < span.entry {
                near.gap = near.gap.min(span.entry - t);
            } else if t <= span.exit {
                near.rest = near.rest.max(span.exit - t);
                here.push(which);
            }
            t <= span.exit
        });
    }
}

impl<F: Fields> Integrator<'_, F> {
    /// Looks around from every walker; they are in the order of their rays. Parts of rays that no walker is before or in
    /// any more are forgotten, so that a few that walk on cost what a few cost.
    pub(crate) fn nearest(
        &mut self,
        rays: &[Ray<F::Real>],
        all_met: &mut Vec<Met<F::Real>>,
        walkers: &[Walker<F::Real>],
    ) -> Vec<Near<F::Real>> {
        let far = F::Real::from_f32(FAR);
        let mut all =
            vec![Near { distance: far, value: far, solid: 0, gap: far, rest: F::Real::ZERO }; walkers.len()];
        let scene = self.scene;
        let mut joined = Joined::default();
        let mut here = Vec::with_capacity(walkers.len());
        for met in &mut *all_met {
            let solid = &scene.solids[met.solid];
            here.clear();
            met.keep_ahead(walkers, &mut all, &mut here);
            if here.is_empty() {
                continue;
            }
            let places = here.iter().map(|&which| &walkers[which]);
            let points = places.map(|walker| rays[walker.ray].at(walker.t)).collect();
            let [mut values] = self.fields.sample(solid.distance, &points);
            self.stats.surface_evaluations += here.len() as u64;
            values.iter_mut().for_each(|value| *value = met.side * *value);
            let ahead = |index: usize| {
                let walker: &Walker<F::Real> = &walkers[here[index]];
                Ahead { ray: rays[walker.ray], t: walker.t, last: walker.t - walker.from }
            };
            let mut safe = values.clone();
            self.shorten(solid, ahead, &mut safe);
            let is_within = met.side < F::Real::ZERO;
            if is_within {
                joined.begin(solid.whole, &all);
            }
            for ((&which, value), safe) in here.iter().zip(values).zip(safe) {
                let wall = Wall { solid: met.solid, value, safe };
                if is_within {
                    joined.add(&mut all[which], which, &wall);
                } else {
                    all[which].add(&wall);
                }
            }
        }
        all_met.retain(|met| !met.parts.is_empty());
        all
    }
}

/// All rays at their origins.
pub(crate) fn start<R: Real>(rays: usize) -> Vec<Walker<R>> {
    (0..rays).map(|ray| Walker { ray, t: R::ZERO, from: R::ZERO }).collect()
}

/// All rays at some distances from their origins.
pub(super) fn started<R: Real>(distances: &[R]) -> Vec<Walker<R>> {
    distances.iter().enumerate().map(|(ray, &t)| Walker { ray, t, from: t }).collect()
}
