//! What is around the rays of a batch where they are: the distance to the nearest solid and to the next box.
//!
//! Where one part of a union holds the eye ([`Joined`]) all parts are seen from within, and the ray is in the union as
//! long as it is in one of them.
//!
//! Twin: `nearest` in `compiler/src/wgsl/render/surface.wgsl`.

use super::box_tree::Answer;
use super::camera::{FAR, Ray, Span};
use super::fields::{Fields, Points};
use super::scene::Integrator;
use super::stride::Ahead;
use super::surface::MAX_STEPS;
use crate::real::Real;
use std::ops::Range;

/// A ray on its way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Walker<R> {
    /// Index of the ray.
    pub(crate) ray: usize,
    /// Distance walked; infinite once it goes no further.
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
    /// Rays with their parts in its box.
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
}

/// A box that a ray comes to.
#[derive(Clone, Copy, Debug)]
struct Coming<R> {
    span: Span<R>,
    /// Which of the solids that are met.
    met: usize,
}

/// The rays of a batch that walk together. A step costs as much as there are rays that still walk and boxes that they
/// are in, however many lie ahead or behind.
#[derive(Debug)]
pub(crate) struct Walkers<'a, R> {
    rays: &'a [Ray<R>],
    /// By ray.
    all: Vec<Walker<R>>,
    /// What each has around it, by ray.
    near: Vec<Near<R>>,
    /// Rays that still walk, in order.
    going: Vec<usize>,
    /// All solids that are met, in order, with the parts of the rays that are in their boxes.
    met: Vec<Met<R>>,
    /// Those of which some ray is in the box, in order.
    entered: Vec<usize>,
    /// The boxes that rays come to, by ray, then by where they begin.
    coming: Vec<Coming<R>>,
    /// Which of these are ahead, by ray.
    ahead: Vec<Range<usize>>,
    /// Room for the questions to a solid.
    points: Points<R>,
    values: Vec<R>,
    safe: Vec<R>,
}

impl<'a, R: Real> Walkers<'a, R> {
    /// All rays at their origins.
    pub(crate) fn new(rays: &'a [Ray<R>], met: Vec<Met<R>>) -> Self {
        Self::started(rays, met, &vec![R::ZERO; rays.len()])
    }

    /// All rays at some distances from their origins.
    pub(crate) fn started(rays: &'a [Ray<R>], mut met: Vec<Met<R>>, distances: &[R]) -> Self {
        let far = R::from_f32(FAR);
        let nothing = Near { distance: far, value: far, solid: 0, gap: far, rest: R::ZERO };
        let (coming, ahead) = in_order(rays.len(), &mut met);
        Self {
            rays,
            all: distances.iter().enumerate().map(|(ray, &t)| Walker { ray, t, from: t }).collect(),
            near: vec![nothing; rays.len()],
            going: (0..rays.len()).collect(),
            met,
            entered: Vec::new(),
            coming,
            ahead,
            points: Points::new(),
            values: Vec::new(),
            safe: Vec::new(),
        }
    }

    /// Whether all have stopped.
    pub(crate) fn are_done(&self) -> bool {
        self.going.is_empty()
    }

    /// Lets each walker go on to a distance, in the order of the rays; it stops where `step` gives none.
    pub(crate) fn go(&mut self, mut step: impl FnMut(Walker<R>, &Near<R>) -> Option<R>) {
        let (all, near) = (&mut self.all, &self.near);
        self.going.retain(|&ray| {
            let from = all[ray].t;
            let to = step(all[ray], &near[ray]);
            all[ray] = Walker { ray, t: to.unwrap_or(R::from_f32(f32::INFINITY)), from };
            to.is_some()
        });
    }

    /// Enters the boxes that walkers have come to and leaves those that they are past; notes how far the next box is, and
    /// the last end of those around.
    fn arrive(&mut self) {
        let far = R::from_f32(FAR);
        for &ray in &self.going {
            let (t, ahead) = (self.all[ray].t, &mut self.ahead[ray]);
            let mut gap = far;
            while let Some(&Coming { span, met }) = self.coming[ahead.clone()].first() {
                if t < span.entry {
                    gap = gap.min(span.entry - t);
                    break;
                }
                ahead.start += 1;
                self.met[met].parts.push((ray, span));
                if let Err(place) = self.entered.binary_search(&met) {
                    self.entered.insert(place, met);
                }
            }
            self.near[ray] = Near { distance: far, value: far, solid: 0, gap, rest: R::ZERO };
        }
        let (all, near, met) = (&self.all, &mut self.near, &mut self.met);
        self.entered.retain(|&entered| {
            let parts = &mut met[entered].parts;
            parts.retain(|&(ray, span)| {
                let (t, near) = (all[ray].t, &mut near[ray]);
                near.rest = near.rest.max(span.exit - t);
                t <= span.exit
            });
            !parts.is_empty()
        });
    }
}

/// Takes the parts of rays out of what is met: the boxes that each ray comes to, by where they begin.
fn in_order<R: Real>(rays: usize, met: &mut [Met<R>]) -> (Vec<Coming<R>>, Vec<Range<usize>>) {
    let mut ahead = vec![0..0; rays];
    met.iter().flat_map(|met| &met.parts).for_each(|&(ray, _)| ahead[ray].end += 1);
    let mut count = 0;
    for own in &mut ahead {
        let start = count;
        count += own.end;
        *own = start..start;
    }
    let nothing = Coming { span: Span { entry: R::ZERO, exit: R::ZERO }, met: 0 };
    let mut coming = vec![nothing; count];
    for (index, met) in met.iter_mut().enumerate() {
        for (ray, span) in met.parts.drain(..) {
            coming[ahead[ray].end] = Coming { span, met: index };
            ahead[ray].end += 1;
        }
    }
    for own in &ahead {
        coming[own.clone()].sort_unstable_by(|a, b| a.span.entry.to_f64().total_cmp(&b.span.entry.to_f64()));
    }
    (coming, ahead)
}

impl<F: Fields> Integrator<'_, F> {
    /// Looks around from every walker.
    pub(crate) fn nearest(&mut self, walkers: &mut Walkers<'_, F::Real>) {
        walkers.arrive();
        let Walkers { rays, all, near, met, entered, points, values, safe, .. } = walkers;
        let scene = self.scene;
        let mut joined = Joined::default();
        for met in entered.iter().map(|&entered| &met[entered]) {
            let solid = &scene.solids[met.solid];
            points.set(met.parts.iter().map(|&(ray, _)| rays[ray].at(all[ray].t)));
            self.fields.sample_one(solid.distance, points, values);
            self.stats.surface_evaluations += values.len() as u64;
            values.iter_mut().for_each(|value| *value = met.side * *value);
            let ahead = |index: usize| {
                let Walker { ray, t, from } = all[met.parts[index].0];
                Ahead { ray: rays[ray], t, last: t - from }
            };
            safe.clone_from(values);
            self.shorten(solid, ahead, safe);
            let is_within = met.side < F::Real::ZERO;
            if is_within {
                joined.begin(solid.whole, near);
            }
            for ((&(ray, _), &value), &safe) in met.parts.iter().zip(&*values).zip(&*safe) {
                let wall = Wall { solid: met.solid, value, safe };
                if is_within {
                    joined.add(&mut near[ray], ray, &wall);
                } else {
                    near[ray].add(&wall);
                }
            }
        }
    }
}
