//! The samples of a pixel: where they are, their mean, and when there are enough of them.
//!
//! Twin: `compiler/src/wgsl/render/sampling.wgsl`.
//!
//! **Where.** Sample k is at the fractional part of `1/2 + j (1/g, 1/g^2)`, where j is 0, 1, -1, 2, -2 …
//! and g = 1.3247… the plastic number: the sequence R2 of M. Roberts (The Unreasonable Effectiveness of
//! Quasirandom Sequences, 2018), walked from its middle to both sides. Sample 0 is the pixel's centre,
//! so that one sample is the picture without sampling; any odd number of them has its centre of gravity
//! there, where the one-sided sequence would move the picture by a tenth of a pixel. The same for all
//! pixels: edges are stepped, not noisy. All samples count the same: a box filter.
//!
//! **Combs.** What is left of the error of media follows the combs of the rays, and with the same comb for all
//! it would be seen as rings. So each sample's comb is moved by the part of a step that R2 gives its pixel (the
//! sum of column and row times its two strides) and the golden ratio its number: neighbours are moved by
//! quite different parts, and their errors have both signs. Whole numbers, so that all backends move alike.
//!
//! Error of the coverage by a straight edge, rms over its angles and places, and worst (test
//! `an_edge_covers_its_area`): 4 samples 0.144, 0.46; 16 samples 0.050, 0.15; 17 samples 0.043, 0.13; 64
//! samples 0.014, 0.06; 256 samples 0.006, 0.025. Random places: rms 0.18, 0.09, 0.09, 0.045, 0.022.
//! Star discrepancy: 4 samples 0.43, 8 0.27, 16 0.16, 64 0.062, 200 0.031 (test `places_are_even`).
//!
//! **Enough.** With a tolerance, a pixel asks after 9, 17, 25 … samples whether the standard error of
//! its mean is within the tolerance: that of the colour relative to its own brightness or
//! [`LEAST_BRIGHTNESS`], that of the transmittance as it is, both rms over the channels. It sees nothing but
//! itself, so neither tiles nor threads change a picture.
//!
//! The trap of such tests is a pixel whose first samples agree by chance. A straight edge that enters a
//! pixel has one of its corners on either side; so the first test also looks at the corners. What
//! it finds there counts as samples would, for the spread only: n samples may have missed 1/n of the
//! pixel, and a difference of c over that part is an error of c/n. Without, the error stayed above 0.015
//! whatever the tolerance; with (test `adaptive_sampling_keeps_its_promise`) it is below a quarter of the
//! tolerance, since the standard error is that of random places and these do better along edges.
//! What lies in a pixel and touches neither its corners nor its first nine samples is missed for good:
//! a spot of a twentieth of the pixel six times in ten.

use super::camera::{Ray, camera_ray};
use super::fields::Fields;
use super::film::Radiance;
use super::scene::{Integrator, Scene};
use crate::real::{Real, Vec3, add, dot, scale, splat, sub};
use std::sync::atomic::{AtomicBool, Ordering};
use vol_compiler::frame::Sampling;

/// 2^32 / g and 2^32 / g^2, rounded.
pub(super) const STRIDE: [u32; 2] = [3_242_174_889, 2_447_445_414];

/// 2^32 over the golden ratio, rounded.
pub(super) const GOLDEN_STRIDE: u32 = 2_654_435_769;

/// Samples before the first test; odd, see the module.
pub(super) const FIRST_ROUND: u32 = 9;

/// Places in a pixel that are probed at the first test.
const CORNERS: [[u32; 2]; 4] = [[0, 0], [1, 0], [0, 1], [1, 1]];

/// Samples between two tests.
pub(super) const ROUND: u32 = 8;

/// Darker pixels may err as much as one of this brightness: at a tolerance of 0.02 an eighth of a
/// per cent of white, half a step of an 8-bit picture.
pub(super) const LEAST_BRIGHTNESS: f32 = 0.0625;

/// The place of a sample in its pixel, in 0..1 from the upper left corner: a multiple of 2^-16, so
/// that it adds exactly to the pixel's index in both precisions.
pub(super) fn place_in_pixel<R: Real>(index: u32) -> [R; 2] {
    let step = index.div_ceil(2);
    let signed = if index % 2 == 1 { step } else { step.wrapping_neg() };
    STRIDE.map(|stride| {
        let place = signed.wrapping_mul(stride).wrapping_add(1 << 31) >> 16;
        R::from_index(place as i32) * R::from_f32(1.0 / 65536.0)
    })
}

/// How far the comb of a sample is moved, -1/2..1/2, in steps: a multiple of 2^-16, 0 for the first sample of
/// the upper left pixel.
pub(super) fn comb_shift<R: Real>(pixel: [u32; 2], index: u32) -> R {
    let places = pixel[0].wrapping_mul(STRIDE[0]).wrapping_add(pixel[1].wrapping_mul(STRIDE[1]));
    let place = places.wrapping_add(index.wrapping_mul(GOLDEN_STRIDE)).wrapping_add(1 << 31) >> 16;
    R::from_index(place as i32) * R::from_f32(1.0 / 65536.0) - R::from_f32(0.5)
}

/// The ray of a sample of a pixel.
pub(super) fn sample_ray<R: Real>(scene: &Scene<R>, pixel: [u32; 2], index: u32) -> Ray<R> {
    let [x, y] = place_in_pixel(index);
    let [column, row] = pixel.map(|index| R::from_index(index as i32));
    let shift = comb_shift(pixel, index);
    Ray { shift, ..camera_ray(scene, [column + x, row + y]) }
}

/// The mean of a pixel's samples so far, and how far they spread (Welford 1962).
///
/// In f32 the mean of n samples is off by at most n 2^-24 of the largest, about 1e-6 at 256.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mean<R> {
    count: u32,
    color: Vec3<R>,
    transmittance: Vec3<R>,
    /// Of the first sample.
    depth: Option<R>,
    /// Mean of the samples' doubts: as large as if all of them erred to one side.
    doubt: R,
    /// Sum of squared distances of the samples' colours from their mean.
    color_spread: R,
    /// The same of the transmittances.
    transmittance_spread: R,
}

impl<R: Real> Mean<R> {
    /// Before the first sample.
    pub(super) fn new() -> Self {
        let zero = splat(R::ZERO);
        Self {
            count: 0,
            color: zero,
            transmittance: zero,
            depth: None,
            doubt: R::ZERO,
            color_spread: R::ZERO,
            transmittance_spread: R::ZERO,
        }
    }

    /// Takes one more sample into the mean.
    fn add_sample(&mut self, sample: &Radiance<R>) {
        self.count += 1;
        // The first is the mean, bit for bit.
        if self.count == 1 {
            self.color = sample.color;
            self.transmittance = sample.transmittance;
            self.depth = sample.depth;
            self.doubt = sample.doubt;
            return;
        }
        let share = R::ONE / R::from_index(self.count as i32);
        self.doubt = self.doubt + (sample.doubt - self.doubt) * share;
        let from_old = sub(sample.color, self.color);
        self.color = add(self.color, scale(from_old, share));
        self.color_spread = self.color_spread + dot(from_old, sub(sample.color, self.color));
        let from_old = sub(sample.transmittance, self.transmittance);
        self.transmittance = add(self.transmittance, scale(from_old, share));
        self.transmittance_spread =
            self.transmittance_spread + dot(from_old, sub(sample.transmittance, self.transmittance));
    }

    /// Lets the radiance at a corner count for the spread, but not for the mean.
    fn add_probe(&mut self, probe: &Radiance<R>) {
        let color = sub(probe.color, self.color);
        self.color_spread = self.color_spread + dot(color, color);
        let transmittance = sub(probe.transmittance, self.transmittance);
        self.transmittance_spread = self.transmittance_spread + dot(transmittance, transmittance);
    }

    /// Whether the pixel takes no more samples.
    fn is_done(&self, sampling: &Sampling) -> bool {
        if self.count >= sampling.most {
            return true;
        }
        let tested = self.count >= FIRST_ROUND && (self.count - FIRST_ROUND).is_multiple_of(ROUND);
        tested && sampling.tolerance > 0.0 && self.is_within(R::from_f32(sampling.tolerance))
    }

    /// Whether the standard errors, rms over the channels, are within a tolerance.
    fn is_within(&self, tolerance: R) -> bool {
        // Three channels; spread / (n (n - 1)) is the squared error of the mean.
        let count = R::from_index(self.count as i32);
        let least = R::from_f32(3.0 * LEAST_BRIGHTNESS * LEAST_BRIGHTNESS);
        let scaled = (tolerance * tolerance) * (count * (count - R::ONE));
        let color = scaled * dot(self.color, self.color).max(least);
        let transmittance = scaled * R::from_f32(3.0);
        self.color_spread <= color && self.transmittance_spread <= transmittance
    }

    /// Squared standard error of the mean colour, summed over the channels, as if the samples were
    /// independent; 0 of one sample.
    pub(super) fn variance(&self) -> f64 {
        let pairs = f64::from(self.count) * (f64::from(self.count) - 1.0);
        if pairs > 0.0 { self.color_spread.to_f64() / pairs } else { 0.0 }
    }

    pub(super) fn radiance(&self) -> Radiance<R> {
        Radiance {
            color: self.color,
            transmittance: self.transmittance,
            depth: self.depth,
            doubt: self.doubt,
        }
    }
}

impl<F: Fields> Integrator<'_, F> {
    /// Samples pixels until each has enough; nothing if cancelled.
    pub(super) fn sample_pixels(
        &mut self,
        pixels: &[[u32; 2]],
        sampling: &Sampling,
        cancelled: &AtomicBool,
    ) -> Option<Vec<Mean<F::Real>>> {
        let mut means = vec![Mean::new(); pixels.len()];
        let mut open: Vec<usize> = (0..pixels.len()).collect();
        let mut taken = 0;
        while !open.is_empty() {
            // As many samples for each pixel that is not done as there are before the next test.
            let until = if taken == 0 { FIRST_ROUND } else { taken + ROUND }.min(sampling.most);
            let corners = if until == FIRST_ROUND && is_probed(sampling) { &CORNERS[..] } else { &[] };
            let scene = self.scene;
            let rays: Vec<_> = open
                .iter()
                .flat_map(|&pixel| {
                    let pixel = pixels[pixel];
                    let samples = (taken..until).map(move |index| sample_ray(scene, pixel, index));
                    let probes = corners.iter().map(move |&[x, y]| {
                        let place = [pixel[0] + x, pixel[1] + y];
                        camera_ray(scene, place.map(|at| F::Real::from_index(at as i32)))
                    });
                    samples.chain(probes)
                })
                .collect();
            let mut samples = Vec::with_capacity(rays.len());
            for batch in rays.chunks(self.batches.rays) {
                if cancelled.load(Ordering::Relaxed) {
                    return None;
                }
                samples.extend(self.radiance(batch));
            }
            let per_pixel = (until - taken) as usize + corners.len();
            for (&index, samples) in open.iter().zip(samples.chunks(per_pixel)) {
                let (samples, probes) = samples.split_at((until - taken) as usize);
                samples.iter().for_each(|sample| means[index].add_sample(sample));
                probes.iter().for_each(|probe| means[index].add_probe(probe));
            }
            taken = until;
            open.retain(|&index| !means[index].is_done(sampling));
        }
        Some(means)
    }
}

/// Whether corners are probed: where there is a test before the last sample.
fn is_probed(sampling: &Sampling) -> bool {
    sampling.tolerance > 0.0 && sampling.most > FIRST_ROUND
}
