//! Random numbers that belong to a ray: which thread, batch or tile follows it changes nothing.
//!
//! A stream starts from the bits of the ray's origin and direction, a seed and what it is for. Rays
//! that differ in one bit have streams of their own; the same ray asked twice for the same has the same
//! numbers. So two samples of a pixel must be different rays, and they are: their places differ.

use super::camera::Ray;
use crate::real::Real;

/// What random numbers of a ray are for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Purpose {
    /// Where the steps of the fixed-step marcher are sampled.
    Jitter = 1,
    /// The free path of a camera ray.
    Path = 2,
    /// The transmittance towards a light.
    Light = 3,
}

/// A stream of random numbers: splitmix64 (Steele, Lea and Flood 2014).
#[derive(Clone, Copy, Debug)]
pub(super) struct Stream {
    state: u64,
}

impl Stream {
    /// The stream of a ray.
    pub(super) fn of_ray<R: Real>(ray: &Ray<R>, seed: u64, purpose: Purpose) -> Self {
        let words = ray.origin.iter().chain(&ray.direction).map(|x| x.to_f64().to_bits());
        let start = mixed(seed ^ mixed(purpose as u64));
        Self { state: words.fold(start, |state, word| mixed(state ^ word)) }
    }

    /// The next number, one of (k + 1/2) / 2^24: above 0 and below 1 in both precisions.
    pub(super) fn uniform<R: Real>(&mut self) -> R {
        self.state = self.state.wrapping_add(GOLDEN);
        let bits = (mixed(self.state) >> 40) as i32;
        // 2^24 steps; the last would round to 1 in f32.
        let bits = bits.min((1 << 24) - 2);
        (R::from_index(bits) + R::from_f32(0.5)) * R::from_f32(1.0 / 16_777_216.0)
    }

    /// The next number of the distribution exp(-x); mean 1, at most 17.4.
    pub(super) fn exponential<R: Real>(&mut self) -> f64 {
        let u: R = self.uniform();
        -u.log2().to_f64() * std::f64::consts::LN_2
    }
}

/// 2^64 over the golden ratio, odd.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A word in which each bit depends on all bits of `word`: the finaliser of splitmix64.
fn mixed(word: u64) -> u64 {
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(x: f32) -> Ray<f32> {
        Ray::new([0.0; 3], [x, 0.0, 1.0])
    }

    #[test]
    fn numbers_are_uniform_and_exponential() {
        let mut stream = Stream::of_ray(&ray(0.1), 0, Purpose::Path);
        let (mut sum, mut squares, mut waits, count) = (0.0, 0.0, 0.0, 200_000);
        for _ in 0..count {
            let u = f64::from(stream.uniform::<f32>());
            assert!(u > 0.0 && u < 1.0);
            sum += u;
            squares += u * u;
            waits += stream.exponential::<f32>();
        }
        let n = f64::from(count);
        // Four standard errors: 4 sqrt(1 / 12 n), 4 sqrt(4 / 45 n), 4 sqrt(1 / n).
        assert!((sum / n - 0.5).abs() < 4.0 * (1.0 / 12.0 / n).sqrt());
        assert!((squares / n - 1.0 / 3.0).abs() < 4.0 * (4.0 / 45.0 / n).sqrt());
        assert!((waits / n - 1.0).abs() < 4.0 / n.sqrt());
    }

    #[test]
    fn streams_differ_by_ray_seed_and_purpose() {
        let first = |x: f32, seed: u64, purpose| Stream::of_ray(&ray(x), seed, purpose).uniform::<f32>();
        let one = first(0.1, 0, Purpose::Path);
        assert_eq!(one, first(0.1, 0, Purpose::Path));
        for other in [
            first(0.1_f32.next_up(), 0, Purpose::Path),
            first(0.1, 1, Purpose::Path),
            first(0.1, 0, Purpose::Light),
            first(0.1, 0, Purpose::Jitter),
        ] {
            assert_ne!(one, other);
        }
        // First numbers of neighbouring rays are uniform, too.
        let (mut x, mut sum, count) = (0.1_f32, 0.0, 20_000);
        for _ in 0..count {
            x = x.next_up();
            sum += f64::from(first(x, 0, Purpose::Path));
        }
        assert!((sum / f64::from(count) - 0.5).abs() < 4.0 * (1.0 / 12.0 / f64::from(count)).sqrt());
    }
}
