//! Short ways of a ray through a medium, between two neighbouring nodes outside: through the corner of a box, or
//! along the rim of a ball.
//!
//! Without them walls would be dotted where they are seen against the background: of the ways shorter than
//! a step nearly all would be lost.
//!
//! A signed distance changes by at most 1 per unit of length, so there can only be one where the distances of
//! both nodes add up to less than their distance from each other. The first probe is where a function
//! would touch 0 that falls and rises equally steeply: if it is steep enough to fall below 0, it does so there,
//! however steep that is. Then the middle of the part with more room is probed. Where the slopes differ up to
//! twenty times, all chords of half a gap are found, and nine in ten of a quarter.
//!
//! Twin: `compiler/src/wgsl/render/chord.wgsl`.

use super::camera::Ray;
use super::comb::Cursor;
use super::fields::Fields;
use super::panel::Crossing;
use super::scene::Integrator;
use crate::real::Real;

/// Probes between two nodes.
pub(crate) const ROUNDS: u32 = 3;

/// Part of the distance between two nodes by which they are taken to be outside at least.
const LEAST: f32 = 1e-6;

/// Two places outside, between which there may be an inside: distance along the ray and signed distance of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap<R> {
    which: usize,
    number: usize,
    ends: [[R; 2]; 2],
}

/// A short way through a medium.
pub(super) struct Chord<R> {
    /// As of [`super::panel::Panel`].
    pub(super) which: usize,
    pub(super) number: usize,
    /// Where it begins and ends.
    pub(super) walls: [Crossing<R>; 2],
}

impl<R: Real> Gap<R> {
    /// If there may be an inside.
    pub(super) fn new(which: usize, number: usize, from: [R; 2], to: [R; 2]) -> Option<Self> {
        let gap = Self { which, number, ends: [from, to] };
        (gap.room() > R::ZERO).then_some(gap)
    }

    /// Length that may be inside.
    fn room(&self) -> R {
        let [[from, before], [to, after]] = self.ends;
        (to - from) - (before + after)
    }

    fn probe(&self, round: u32) -> R {
        let [[from, before], [to, after]] = self.ends;
        let length = to - from;
        let least = R::from_f32(LEAST) * length;
        let touching = (before + least) / ((before + after) + (least + least));
        from + length * if round == 0 { touching } else { R::from_f32(0.5) }
    }

    /// What is left after a probe outside, if anything.
    fn narrowed(&self, t: R, value: R) -> Option<Self> {
        let [first, second] =
            [[self.ends[0], [t, value]], [[t, value], self.ends[1]]].map(|ends| Self { ends, ..*self });
        let better = if second.room() > first.room() { second } else { first };
        (better.room() > R::ZERO).then_some(better)
    }

    /// The chord around a probe inside.
    fn chord(&self, t: R, value: R) -> Chord<R> {
        let wall = |outside| Crossing::new(self.which, [t, value], outside);
        Chord { which: self.which, number: self.number, walls: self.ends.map(wall) }
    }
}

impl<F: Fields> Integrator<'_, F> {
    /// Searches gaps of a medium.
    pub(super) fn chords(
        &mut self,
        medium: usize,
        rays: &[Ray<F::Real>],
        active: &[Cursor],
        mut gaps: Vec<Gap<F::Real>>,
    ) -> Vec<Chord<F::Real>> {
        let mut chords = Vec::new();
        for round in 0..ROUNDS {
            if gaps.is_empty() {
                break;
            }
            let probes: Vec<_> = gaps.iter().map(|gap| gap.probe(round)).collect();
            let places = gaps.iter().map(|gap| gap.which).zip(probes.iter().copied());
            let values = self.region_at(medium, rays, active, places);
            let mut left = Vec::new();
            for (gap, (t, value)) in gaps.iter().zip(probes.into_iter().zip(values)) {
                if value < F::Real::ZERO {
                    chords.push(gap.chord(t, value));
                } else {
                    left.extend(gap.narrowed(t, value));
                }
            }
            gaps = left;
        }
        chords
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first place inside that is found between two places outside.
    fn found(region: impl Fn(f64) -> f64, from: f64, to: f64) -> Option<f64> {
        let mut gap = Gap::new(0, 0, [from, region(from)], [to, region(to)])?;
        for round in 0..ROUNDS {
            let t = gap.probe(round);
            if region(t) < 0.0 {
                return Some(t);
            }
            gap = gap.narrowed(t, region(t))?;
        }
        None
    }

    #[test]
    fn corners_with_equal_slopes_are_found_however_short() {
        for slope in [0.1, 0.5, 1.0] {
            for length in [1e-5, 1e-3, 0.1, 0.5] {
                for middle in [0.26, 0.5, 0.74] {
                    let region = |t: f64| slope * ((t - middle).abs() - 0.5 * length);
                    let t = found(region, 0.0, 1.0);
                    assert!(t.is_some_and(|t| region(t) < 0.0), "{slope} {length} {middle}");
                }
            }
        }
    }

    #[test]
    fn corners_with_unequal_slopes_are_found_from_half_of_the_gap() {
        for slope in [0.05, 0.2, 0.6] {
            for start in 0..=20 {
                let start = 0.025 * f64::from(start);
                let region = |t: f64| (slope * (start - t)).max(t - (start + 0.5));
                let mirrored = |t: f64| region(1.0 - t);
                for found in [found(region, 0.0, 1.0), found(mirrored, 0.0, 1.0)] {
                    assert!(found.is_some(), "{slope} {start}");
                }
            }
        }
    }

    #[test]
    fn where_nothing_can_be_nothing_is_asked() {
        let never = |_: f64| panic!("asked");
        assert!(Gap::new(0, 0, [0.0, 0.6], [1.0, 0.4]).is_none());
        assert!(Gap::new(0, 0, [0.0, f64::from(f32::MAX)], [1.0, 0.1]).is_none());
        assert!(Gap::<f64>::new(0, 0, [0.0, 0.7], [1.0, 0.7]).map(|gap| never(gap.probe(0))).is_none());
        // Along a wall: both are on it.
        assert_eq!(found(|_| 0.0, 0.0, 1.0), None);
    }
}
