//! What is around the rays of a batch where they are, the distance to the nearest solid and to the next box, and how far
//! they go on.
//!
//! ```text
//! Walkers::new ──► nearest ──► Walkers::go ──► nearest ──► …      until all have stopped
//!   boxes of each ray, in order   a step of each ray: sure (Near::advance) or farther (Near::onward)
//! ```
//!
//! Where one part of a union holds the eye ([`Joined`]) all parts are seen from within, and the ray is in the union as
//! long as it is in one of them.
//!
//! Twin: `nearest`, `advance`, `onward` in `compiler/src/wgsl/render/surface.wgsl`.

use super::box_tree::Answer;
use super::camera::{FAR, Ray, Span};
use super::fields::{Fields, Points};
use super::scene::{Integrator, Stride};
use super::stride::Ahead;
use super::surface::MAX_STEPS;
use crate::real::Real;
use std::ops::Range;

/// Of how much farther than is sure a step may be where the distance falls evenly. Such a step is just not too long; so
/// much is left to rounding.
pub(super) const EAGERNESS: f32 = 1.95;

/// Part of the way to the next side of a box that such a step may take.
pub(super) const ROOM: f32 = 0.98;

/// A ray on its way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Walker<R> {
    /// Index of the ray.
    pub(crate) ray: usize,
    /// Distance walked; infinite once it goes no further.
    pub(crate) t: R,
    /// Where it was one step earlier.
    pub(crate) from: R,
    /// How far nothing could be from there.
    free: R,
    /// Whether it went farther than that.
    guessed: bool,
}

impl<R: Real> Walker<R> {
    /// Starts at a distance from the origin of a ray.
    pub(super) fn new(ray: usize, t: R) -> Self {
        Self { ray, t, from: t, free: R::ZERO, guessed: false }
    }

    /// Goes on to a place up to which nothing can be.
    pub(crate) fn to(self, t: R) -> Self {
        Self { ray: self.ray, t, from: self.t, free: t - self.t, guessed: false }
    }

    /// Goes back to where it was sure to come.
    pub(crate) fn back(self) -> Self {
        Self { t: self.from + self.free, guessed: false, ..self }
    }
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
    /// Where the next box begins.
    entry: R,
    /// Where the first of the boxes in which it is ends; 0 where a solid tells nothing of what is beside the way.
    exit: R,
}

impl<R: Real> Near<R> {
    /// Nothing.
    fn nothing() -> Self {
        let far = R::from_f32(FAR);
        Self { distance: far, value: far, solid: 0, gap: far, rest: R::ZERO, entry: far, exit: far }
    }

    /// How far to walk: as far as nothing can be, at least by `least`. A ray that has used up half of its
    /// steps is stuck at a surface that it grazes, or in a field that is nearly flat: it goes through what
    /// is left of the boxes in even steps, rather than end in a hole.
    pub(crate) fn advance(&self, step: u32, least: R) -> R {
        let free = self.distance.min(self.gap);
        let left = R::from_index((MAX_STEPS - step + 1) as i32);
        let even = if is_stuck(step) { (self.rest / left).min(self.gap) } else { R::ZERO };
        free.max(least).max(even)
    }

    /// Goes on, if possible farther than is sure, up to where the empty ball around the next place just touches the one
    /// here if the distance goes on falling as it did. Whether it does is known there: [`Near::is_past`]. Only balls around
    /// the same solids tell of each other, so such a step enters no box and leaves none.
    ///
    /// * source: automatic relaxation of sphere tracing (Ban, Valasek 2023) after Keinert et al. 2014
    pub(crate) fn onward(&self, walker: Walker<R>, step: u32, least: R) -> Walker<R> {
        let sure = self.advance(step, least);
        let last = walker.t - walker.from;
        let is_first = last <= R::ZERO;
        let fall = ((walker.free - self.distance) / if is_first { R::ONE } else { last }).max(R::ZERO);
        let touching = (R::from_f32(EAGERNESS) * self.distance) / (R::ONE + fall);
        let room = R::from_f32(ROOM);
        let guess = touching.min(room * self.gap).min(room * (self.exit - walker.t));
        let place = walker.t + guess;
        let is_inside = (place < self.entry) & (place <= self.exit);
        let guessed = (guess > sure) & is_inside & !is_first & !is_stuck(step);
        let t = if guessed { place } else { walker.t + sure };
        Walker { ray: walker.ray, t, from: walker.t, free: sure, guessed }
    }

    /// Whether a walker has gone too far: the balls that are empty around this place and the last do not touch.
    pub(crate) fn is_past(&self, walker: &Walker<R>) -> bool {
        walker.guessed & (walker.free + self.distance < walker.t - walker.from)
    }
}

/// Whether a ray has used up half of its steps.
fn is_stuck(step: u32) -> bool {
    step > MAX_STEPS / 2
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
            let Near { gap, rest, entry, exit, .. } = *near;
            *near = Near { gap, rest, entry, exit, ..self.others[which] };
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
        let (coming, ahead) = in_order(rays.len(), &mut met);
        Self {
            rays,
            all: distances.iter().enumerate().map(|(ray, &t)| Walker::new(ray, t)).collect(),
            near: vec![Near::nothing(); rays.len()],
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

    /// Lets each walker take its next step, in the order of the rays; it stops where `step` gives none.
    pub(crate) fn go(&mut self, mut step: impl FnMut(Walker<R>, &Near<R>) -> Option<Walker<R>>) {
        let (all, near) = (&mut self.all, &self.near);
        self.going.retain(|&ray| {
            let next = step(all[ray], &near[ray]);
            all[ray] = next.unwrap_or(Walker { t: R::from_f32(f32::INFINITY), ..all[ray] });
            next.is_some()
        });
    }

    /// Enters the boxes that walkers have come to and leaves those that they are past; notes how far the next box is, and
    /// the last end of those around.
    fn arrive(&mut self) {
        for &ray in &self.going {
            let (t, ahead) = (self.all[ray].t, &mut self.ahead[ray]);
            let far = R::from_f32(FAR);
            let (mut gap, mut entry) = (far, far);
            while let Some(&Coming { span, met }) = self.coming[ahead.clone()].first() {
                if t < span.entry {
                    (gap, entry) = (span.entry - t, span.entry);
                    break;
                }
                ahead.start += 1;
                self.met[met].parts.push((ray, span));
                if let Err(place) = self.entered.binary_search(&met) {
                    self.entered.insert(place, met);
                }
            }
            self.near[ray] = Near { gap, entry, ..Near::nothing() };
        }
        let (all, near, met) = (&self.all, &mut self.near, &mut self.met);
        self.entered.retain(|&entered| {
            let parts = &mut met[entered].parts;
            parts.retain(|&(ray, span)| {
                let (t, near) = (all[ray].t, &mut near[ray]);
                let is_in = t <= span.exit;
                if is_in {
                    near.rest = near.rest.max(span.exit - t);
                    near.exit = near.exit.min(span.exit);
                }
                is_in
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
                let Walker { ray, t, from, .. } = all[met.parts[index].0];
                Ahead { ray: rays[ray], t, last: t - from }
            };
            safe.clone_from(values);
            self.shorten(solid, ahead, safe);
            let is_within = met.side < F::Real::ZERO;
            if is_within {
                joined.begin(solid.whole, near);
            }
            let is_ball = matches!(solid.stride, Stride::Scale(_));
            for ((&(ray, _), &value), &safe) in met.parts.iter().zip(&*values).zip(&*safe) {
                let wall = Wall { solid: met.solid, value, safe };
                if !is_ball {
                    near[ray].exit = F::Real::ZERO;
                }
                if is_within {
                    joined.add(&mut near[ray], ray, &wall);
                } else {
                    near[ray].add(&wall);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(distance: f32) -> Near<f32> {
        Near { distance, value: distance, rest: 100.0, ..Near::nothing() }
    }

    #[test]
    fn steps_towards_a_plane_grow_as_its_distance_falls_evenly() {
        // The distance falls by a fifth of the way: a ray at 12 degrees to a plane.
        let distance = |walker: &Walker<f32>| 1.0 - 0.2 * walker.t;
        let mut walker = Walker::new(0, 0.0);
        let mut steps = 0;
        while distance(&walker) > 1e-3 {
            let near = near(distance(&walker));
            assert!(!near.is_past(&walker), "{walker:?}");
            walker = near.onward(walker, 1, 1e-6);
            steps += 1;
        }
        // One by one they take ln 1000 / -ln 0.8.
        assert!(walker.t < 5.0 && steps <= 20, "{steps} steps instead of 31");
    }

    #[test]
    fn what_lies_between_two_balls_is_not_passed_over() {
        let first = near(1.0).onward(Walker::new(0, 0.0), 1, 1e-6);
        assert_eq!((first.t, first.guessed), (1.0, false));
        // The distance was 1 here, too: there seems to be nothing in sight.
        let guess = near(1.0).onward(first, 2, 1e-6);
        assert!(guess.guessed && guess.t > 2.9, "{guess:?}");
        assert!(!near(0.96).is_past(&guess));
        // Something is 0.9 away: it may be before this place.
        assert!(near(0.9).is_past(&guess));
        let back = guess.back();
        assert_eq!((back.t, back.from, back.guessed), (2.0, 1.0, false));
        assert!(!near(-1.0).is_past(&back));
    }

    #[test]
    fn no_guess_leaves_a_box_or_enters_one() {
        let first = near(1.0).onward(Walker::new(0, 0.0), 1, 1e-6);
        for short in [Near { gap: 1.25, entry: 2.25, ..near(1.0) }, Near { exit: 2.25, ..near(1.0) }] {
            let next = short.onward(first, 2, 1e-6);
            assert!(next.guessed && next.t > 2.2 && next.t < 2.25, "{next:?}");
        }
        assert_eq!(Near { exit: 0.0, ..near(1.0) }.onward(first, 2, 1e-6).t, 2.0);
        assert_eq!(near(1.0).onward(first, MAX_STEPS / 2 + 1, 1e-6).t, 2.0);
    }
}
