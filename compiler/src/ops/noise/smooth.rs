//! Bounds of a noise with continuous derivatives, from what holds of it everywhere.
//!
//! In: a box, or a position with errors. Out: the value and the partial derivatives there, by Taylor
//! about the middle (first and second order) and never wider than the bounds over all of space. Example:
//! over a box of radius 0.01 about a point where Perlin noise is 0.3 and flat, it stays within 0.3 ± 0.0008.

use super::super::interval::Interval;
use super::super::{Results, several, several_within};
use super::FIELD;
use crate::error_bound::Bounded;

/// What holds of a noise everywhere and for every seed.
pub(super) struct Smooth {
    /// How many coordinates it takes.
    pub(super) dimensions: usize,
    /// Value and partial derivatives in f64.
    pub(super) gradient: fn(&[f64], u32) -> Results<f64>,
    /// Largest absolute value.
    pub(super) largest: f64,
    /// Largest length of the gradient.
    pub(super) steepest: f64,
    /// Largest norm of the matrix of second derivatives.
    pub(super) bending: f64,
    /// Own error of the value in f32.
    pub(super) value_error: f64,
    /// Own error of a partial derivative in f32.
    pub(super) partial_error: f64,
}

impl Smooth {
    /// Bounds of the value and of the partial derivatives over a box.
    pub(super) fn bounds(&self, p: &[Interval], seed: u32) -> Results<Interval> {
        let hold = |x: &Interval| Interval::new(x.lo.clamp(-FIELD, FIELD), x.hi.clamp(-FIELD, FIELD));
        let held: Vec<Interval> = p.iter().map(hold).collect();
        let radii: Vec<f64> = held.iter().map(|x| x.radius()).collect();
        let radius = radii.iter().map(|r| r * r).sum::<f64>().sqrt();
        let value = Interval::new(-self.largest, self.largest);
        let partial = Interval::new(-self.steepest, self.steepest);
        let mut found = vec![partial; p.len() + 1];
        found[0] = value;
        // A box this wide has nothing to gain from its middle.
        if radius > 2.0 * self.largest / self.steepest {
            return several_within(&found);
        }
        let middle: Vec<f64> = held.iter().map(|x| x.middle()).collect();
        let middle = (self.gradient)(&middle, seed);
        let sloped: f64 = radii.iter().zip(&middle[1..]).map(|(radius, slope)| slope.abs() * radius).sum();
        let reach = (self.steepest * radius).min(sloped + 0.5 * self.bending * radius * radius);
        // The middle values are themselves f64 sums of some terms.
        let rounding = 1e-14;
        found[0] = Interval::around(middle[0], reach + rounding).within(value);
        for (found, slope) in found[1..].iter_mut().zip(&middle[1..]) {
            *found = Interval::around(*slope, self.bending * radius + rounding).within(partial);
        }
        several_within(&found)
    }

    /// The value and the partial derivatives at a position with errors, as f32 would compute them.
    pub(super) fn evaluate(&self, p: &[Bounded], seed: u32) -> Results<Bounded> {
        let at: Vec<f64> = p.iter().map(|x| x.value).collect();
        let exact = (self.gradient)(&at, seed);
        let off = p.iter().map(|x| x.error * x.error).sum::<f64>().sqrt();
        let bent = self.bending * off;
        let sloped: f64 = p.iter().zip(&exact[1..]).map(|(x, slope)| slope.abs() * x.error).sum();
        let change = (self.steepest * off).min(sloped + 0.5 * bent * off).min(2.0 * self.largest);
        std::array::from_fn(|i| {
            let error = match i {
                0 => change + self.value_error,
                _ => bent.min(2.0 * self.steepest) + self.partial_error,
            };
            // A position without a bound may be no number at all.
            let error = if off.is_finite() { error } else { f64::INFINITY };
            Bounded { value: exact[i], error }
        })
    }

    /// Errors of the results of a row: operands are the position.
    pub(super) fn errors(&self, x: &[f64], e: &[f64], seed: u32) -> Results<f64> {
        let position = |(&value, &error): (&f64, &f64)| Bounded { value, error };
        let p: Vec<Bounded> = x.iter().zip(e).map(position).collect();
        several(&self.evaluate(&p, seed).map(|part| part.error))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::ir::verify::random::Random;

    fn length(x: impl Iterator<Item = f64>) -> f64 {
        x.map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Absolute value, length of the gradient, change of the gradient along a short way per length.
    fn measures(noise: &Smooth, p: &[f64], way: &[f64], seed: u32) -> [f64; 3] {
        let n = p.len();
        let further: Vec<f64> = p.iter().zip(way).map(|(x, way)| x + 1e-5 * way).collect();
        let (here, there) = ((noise.gradient)(p, seed), (noise.gradient)(&further, seed));
        let turned = length((1..=n).map(|i| there[i] - here[i]));
        [here[0].abs(), length((1..=n).map(|i| here[i])), turned / (1e-5 * length(way.iter().copied()))]
    }

    /// Tries to break the bounds: climbs to the extremes near random places. `reached` says how near to
    /// the bounds on value, slope and bending it comes at least: they are those of the unkindest lattice.
    #[track_caller]
    pub(in super::super) fn assert_bounds_hold(noise: &Smooth, dimensions: usize, reached: [f64; 3]) {
        let mut random = Random::new(11);
        let bounds = [noise.largest, noise.steepest, noise.bending];
        let mut most = [0.0_f64; 3];
        for round in 0..9000 {
            let (aim, seed) = (round % 3, round as u32 / 3 % 5);
            let mut draw =
                |reach: f64| -> Vec<f64> { (0..dimensions).map(|_| random.between(-reach, reach)).collect() };
            let (mut p, mut way) = (draw(300.0), draw(1.0));
            let mut best = measures(noise, &p, &way, seed)[aim];
            let mut step = 0.3;
            // Only places that promise something are worth the climb.
            while step > 1e-3 && best > 0.5 * most[aim] {
                let moved = |x: &[f64], by: Vec<f64>| -> Vec<f64> {
                    x.iter().zip(by).map(|(x, by)| x + by).collect()
                };
                let near = (moved(&p, draw(step)), moved(&way, draw(step)));
                let found = measures(noise, &near.0, &near.1, seed)[aim];
                if found > best {
                    (best, (p, way)) = (found, near);
                } else {
                    step *= 0.9;
                }
            }
            most[aim] = most[aim].max(best);
        }
        for aim in 0..3 {
            assert!(most[aim] <= bounds[aim] * (1.0 + 1e-4), "{most:?} of {bounds:?}");
            assert!(most[aim] >= reached[aim] * bounds[aim], "{most:?} of {bounds:?}");
        }
    }
}
