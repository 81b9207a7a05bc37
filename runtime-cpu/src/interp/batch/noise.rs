//! Noise on a batch: octaves outside, lanes inside.
//!
//! Values are those of [`crate::math::noise`] bit for bit (test `noise_is_that_of_the_kernels`); the
//! loops are turned around so that the lanes vectorise.

use super::{LANES, Operands, Out};
use crate::math::noise::{self, Nearest, next_octave, octave_count};
use std::array;

/// One coordinate, or one component of a gradient, of each lane.
type Row<'a> = &'a [f32];

/// [`noise::perlin`] in each lane.
pub(super) fn perlin(x: &Operands<'_>, out: &mut Out, seed: u32) -> usize {
    values(x[0], x[1], x[2], &mut out[0].0, seed);
    1
}

/// [`noise::perlin_gradient`] in each lane.
pub(super) fn perlin_gradient(x: &Operands<'_>, out: &mut Out, seed: u32) -> usize {
    let [value, dx, dy, dz, ..] = out;
    gradients(x[0], x[1], x[2], [&mut value.0, &mut dx.0, &mut dy.0, &mut dz.0], seed);
    4
}

/// The loop over lanes. Out of line, so that the compiler sees nothing but the loop; seed 0 is
/// another algorithm and has a loop of its own.
#[inline(never)]
fn values(x: Row<'_>, y: Row<'_>, z: Row<'_>, out: &mut [f32; LANES], seed: u32) {
    let lanes = out.iter_mut().zip(x).zip(y).zip(z);
    if seed == 0 {
        lanes.for_each(|(((out, &x), &y), &z)| *out = noise::perlin([x, y, z], 0));
    } else {
        lanes.for_each(|(((out, &x), &y), &z)| *out = noise::perlin([x, y, z], seed));
    }
}

/// As [`values`], with the gradient.
#[inline(never)]
fn gradients(x: Row<'_>, y: Row<'_>, z: Row<'_>, out: [&mut [f32; LANES]; 4], seed: u32) {
    let [value, dx, dy, dz] = out;
    let results = value.iter_mut().zip(dx).zip(dy).zip(dz);
    let lanes = results.zip(x.iter().zip(y).zip(z));
    if seed == 0 {
        lanes.for_each(|((((value, dx), dy), dz), ((&x, &y), &z))| {
            [*value, *dx, *dy, *dz] = noise::perlin_gradient([x, y, z], 0);
        });
    } else {
        lanes.for_each(|((((value, dx), dy), dz), ((&x, &y), &z))| {
            [*value, *dx, *dy, *dz] = noise::perlin_gradient([x, y, z], seed);
        });
    }
}

/// The octave sums of a batch between two octaves.
struct Octaves {
    /// Number of octaves of each lane.
    count: [i32; LANES],
    amplitude: [f32; LANES],
    frequency: [f32; LANES],
    /// Points in the current octave, one row per coordinate.
    scaled: [[f32; LANES]; 3],
}

impl Octaves {
    fn new(octaves: Row<'_>) -> Self {
        let mut count = [0; LANES];
        for (count, &octaves) in count.iter_mut().zip(octaves) {
            *count = octave_count(octaves);
        }
        Self { count, amplitude: [1.0; LANES], frequency: [1.0; LANES], scaled: [[0.0; LANES]; 3] }
    }

    /// Octaves of the lane that has most.
    fn most(&self) -> i32 {
        self.count.iter().copied().max().unwrap_or(0)
    }

    /// The points of the current octave.
    fn scale(&mut self, x: &Operands<'_>) {
        for (scaled, row) in self.scaled.iter_mut().zip(x) {
            for ((scaled, &coordinate), &frequency) in scaled.iter_mut().zip(*row).zip(&self.frequency) {
                *scaled = coordinate * frequency;
            }
        }
    }

    /// Adds an octave to a sum in the lanes that have so many.
    fn add(&self, octave: i32, sum: &mut [f32; LANES], factor: &[f32; LANES], noise: &[f32; LANES]) {
        for lane in 0..LANES {
            let more = sum[lane] + (factor[lane] * noise[lane]);
            sum[lane] = if octave < self.count[lane] { more } else { sum[lane] };
        }
    }

    fn step(&mut self, lacunarity: Row<'_>, gain: Row<'_>) {
        for (amplitude, &gain) in self.amplitude.iter_mut().zip(gain) {
            *amplitude = next_octave(*amplitude, gain);
        }
        for (frequency, &lacunarity) in self.frequency.iter_mut().zip(lacunarity) {
            *frequency = next_octave(*frequency, lacunarity);
        }
    }
}

/// A kernel of `IN` coordinates in each lane; one that is inlined, so that the loop vectorises.
#[inline(always)]
pub(super) fn each<const IN: usize, const OUT: usize>(
    x: &Operands<'_>,
    out: &mut Out,
    kernel: impl Fn([f32; IN]) -> [f32; OUT],
) -> usize {
    let lanes = x[0].len().min(LANES);
    let rows: [Row<'_>; IN] = array::from_fn(|i| &x[i][..lanes]);
    let mut results = [[0.0; LANES]; OUT];
    for lane in 0..lanes {
        let found = kernel(rows.map(|row| row[lane]));
        for (result, found) in results.iter_mut().zip(found) {
            result[lane] = found;
        }
    }
    for (out, result) in out.iter_mut().zip(results) {
        out.0 = result;
    }
    OUT
}

/// The first `OUT` results of [`noise::worley_gradient`] in each lane: cells outside, lanes inside.
pub(super) fn worley<const OUT: usize>(x: &Operands<'_>, out: &mut Out, seed: u32) -> usize {
    let mut found = [Nearest::default(); LANES];
    for (found, ((&x, &y), &z)) in found.iter_mut().zip(x[0].iter().zip(x[1]).zip(x[2])) {
        *found = Nearest::new([x, y, z]);
    }
    for step in Nearest::STEPS {
        for found in &mut found {
            *found = found.with(step, seed);
        }
    }
    for (lane, found) in found.iter().enumerate() {
        for (out, part) in out[..OUT].iter_mut().zip(found.gradient()) {
            out.0[lane] = part;
        }
    }
    OUT
}

/// [`noise::fbm`] in each lane.
pub(super) fn fbm(x: &Operands<'_>, out: &mut Out, seed: u32) -> usize {
    let n = x[0].len();
    let mut octaves = Octaves::new(x[3]);
    let mut noise = [0.0; LANES];
    let sum = &mut out[0].0;
    sum.fill(0.0);
    for octave in 0..octaves.most() {
        // Add one octave.
        octaves.scale(x);
        let [px, py, pz] = &octaves.scaled;
        values(&px[..n], &py[..n], &pz[..n], &mut noise, seed);
        octaves.add(octave, sum, &octaves.amplitude, &noise);
        // Step to the next.
        octaves.step(x[4], x[5]);
    }
    1
}

/// [`noise::fbm_gradient`] in each lane.
pub(super) fn fbm_gradient(x: &Operands<'_>, out: &mut Out, seed: u32) -> usize {
    let n = x[0].len();
    let mut octaves = Octaves::new(x[3]);
    let mut noise = [[0.0; LANES]; 4];
    let mut steepness = [0.0; LANES];
    out[..4].iter_mut().for_each(|sum| sum.0.fill(0.0));
    for octave in 0..octaves.most() {
        // Add one octave; the chain rule brings the frequency down.
        octaves.scale(x);
        let [px, py, pz] = &octaves.scaled;
        gradients(&px[..n], &py[..n], &pz[..n], noise.each_mut(), seed);
        let factors = octaves.amplitude.iter().zip(&octaves.frequency);
        for (steepness, (&amplitude, &frequency)) in steepness.iter_mut().zip(factors) {
            *steepness = amplitude * frequency;
        }
        octaves.add(octave, &mut out[0].0, &octaves.amplitude, &noise[0]);
        for i in 1..4 {
            octaves.add(octave, &mut out[i].0, &steepness, &noise[i]);
        }
        // Step to the next.
        octaves.step(x[4], x[5]);
    }
    4
}
