//! Noise on a batch: octaves outside, lanes inside.
//!
//! Values are those of [`crate::math::noise`] bit for bit (test `noise_is_that_of_the_kernels`); the
//! loops are turned around so that the lanes vectorise.

#[cfg(target_arch = "x86_64")]
use super::permutation::LookUp;
use super::{LANES, Operands, Out};
use crate::isa::{Isa, Kernel, kernel};
use crate::math::noise::{self, Nearest, next_octave, octave_count};
use std::array;

/// One coordinate, or one component of a gradient, of each lane.
type Row<'a> = &'a [f32];

/// [`noise::perlin`] in each lane.
pub(super) fn perlin(isa: Isa, x: &Operands<'_>, out: &mut Out, seed: u32) -> usize {
    values(isa, [x[0], x[1], x[2]], &mut Cells::new(), &mut out[0].0, seed);
    1
}

/// [`noise::perlin_gradient`] in each lane.
pub(super) fn perlin_gradient(isa: Isa, x: &Operands<'_>, out: &mut Out, seed: u32) -> usize {
    let [value, dx, dy, dz, ..] = out;
    let out = [&mut value.0, &mut dx.0, &mut dy.0, &mut dz.0];
    gradients(isa, [x[0], x[1], x[2]], &mut Cells::new(), out, seed);
    4
}

fn values(isa: Isa, point: [Row<'_>; 3], cells: &mut Cells, out: &mut [f32; LANES], seed: u32) {
    if seed == 0 {
        isa.run::<Find>((point, cells));
        look_up(isa, cells);
        isa.run::<CodedValues>((cells, out));
    } else {
        isa.run::<HashedValues>((point, out, seed));
    }
}

fn gradients(isa: Isa, point: [Row<'_>; 3], cells: &mut Cells, out: [&mut [f32; LANES]; 4], seed: u32) {
    if seed == 0 {
        isa.run::<Find>((point, cells));
        look_up(isa, cells);
        isa.run::<CodedGradients>((cells, out));
    } else {
        isa.run::<HashedGradients>((point, out, seed));
    }
}

/// Sets the codes of cells.
fn look_up(isa: Isa, cells: &mut Cells) {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = isa.avx512() {
        return simd.vectorize(LookUp { simd, cells });
    }
    look_up_one_by_one(cells);
}

/// Only where the cell changes: neighbours on a ray are often in the same.
fn look_up_one_by_one(Cells { points, corner: [x, y, z], codes, .. }: &mut Cells) {
    let mut last = ([0; 3], noise::table_codes([0; 3]));
    for lane in 0..*points {
        let corner = [x[lane], y[lane], z[lane]];
        if corner != last.0 {
            last = (corner, noise::table_codes([x[lane].into(), y[lane].into(), z[lane].into()]));
        }
        codes[lane] = last.1;
    }
}

/// Rows of the same number of points, at most a batch.
#[inline(always)]
fn even([x, y, z]: [Row<'_>; 3]) -> (usize, [Row<'_>; 3]) {
    let n = x.len().min(y.len()).min(z.len()).min(LANES);
    (n, [&x[..n], &y[..n], &z[..n]])
}

/// The cells that the points of a batch are in.
pub(super) struct Cells {
    /// How many points there are.
    pub(super) points: usize,
    /// Whole coordinates, which the table takes modulo 256.
    pub(super) corner: [[u16; LANES]; 3],
    /// The places inside.
    place: [[f32; LANES]; 3],
    /// [`noise::table_codes`].
    pub(super) codes: [u32; LANES],
}

impl Cells {
    fn new() -> Self {
        Self { points: 0, corner: [[0; LANES]; 3], place: [[0.0; LANES]; 3], codes: [0; LANES] }
    }
}

kernel! {
    fn Find<'a>((point, cells): ([Row<'a>; 3], &'a mut Cells)) {
        let (n, [x, y, z]) = even(point);
        cells.points = n;
        for lane in 0..n {
            let (corner, place) = noise::cell_and_place([x[lane], y[lane], z[lane]]);
            [cells.corner[0][lane], cells.corner[1][lane], cells.corner[2][lane]] =
                [corner[0] as u16, corner[1] as u16, corner[2] as u16];
            [cells.place[0][lane], cells.place[1][lane], cells.place[2][lane]] = place;
        }
    }
}

kernel! {
    fn CodedValues<'a>((cells, out): (&'a Cells, &'a mut [f32; LANES])) {
        let [x, y, z] = &cells.place;
        for lane in 0..cells.points.min(LANES) {
            out[lane] = noise::perlin_of_codes([x[lane], y[lane], z[lane]], cells.codes[lane]);
        }
    }
}

kernel! {
    fn HashedValues<'a>((point, out, seed): ([Row<'a>; 3], &'a mut [f32; LANES], u32)) {
        let (n, [x, y, z]) = even(point);
        for lane in 0..n {
            out[lane] = noise::perlin_hashed([x[lane], y[lane], z[lane]], seed);
        }
    }
}

kernel! {
    fn CodedGradients<'a>((cells, out): (&'a Cells, [&'a mut [f32; LANES]; 4])) {
        let [x, y, z] = &cells.place;
        let [value, dx, dy, dz] = out;
        for lane in 0..cells.points.min(LANES) {
            let found = noise::perlin_gradient_of_codes([x[lane], y[lane], z[lane]], cells.codes[lane]);
            [value[lane], dx[lane], dy[lane], dz[lane]] = found;
        }
    }
}

kernel! {
    fn HashedGradients<'a>((point, out, seed): ([Row<'a>; 3], [&'a mut [f32; LANES]; 4], u32)) {
        let (n, [x, y, z]) = even(point);
        let [value, dx, dy, dz] = out;
        for lane in 0..n {
            let found = noise::perlin_gradient_hashed([x[lane], y[lane], z[lane]], seed);
            [value[lane], dx[lane], dy[lane], dz[lane]] = found;
        }
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

    /// Slopes grow with the frequency.
    #[inline(always)]
    fn steepness(&self) -> [f32; LANES] {
        array::from_fn(|lane| self.amplitude[lane] * self.frequency[lane])
    }
}

kernel! {
    /// The points of the current octave.
    fn Scale<'a>((octaves, x): (&'a mut Octaves, &'a Operands<'a>)) {
        for (scaled, row) in octaves.scaled.iter_mut().zip(x) {
            for ((scaled, &coordinate), &frequency) in scaled.iter_mut().zip(*row).zip(&octaves.frequency) {
                *scaled = coordinate * frequency;
            }
        }
    }
}

kernel! {
    /// Adds an octave to a sum in the lanes that have so many.
    fn Add<'a>(
        (octaves, octave, sum, factor, noise): (
            &'a Octaves, i32, &'a mut [f32; LANES], &'a [f32; LANES], &'a [f32; LANES],
        )
    ) {
        for lane in 0..LANES {
            let more = sum[lane] + (factor[lane] * noise[lane]);
            sum[lane] = if octave < octaves.count[lane] { more } else { sum[lane] };
        }
    }
}

kernel! {
    /// Amplitudes and frequencies of the next octave.
    fn Step<'a>((octaves, lacunarity, gain): (&'a mut Octaves, Row<'a>, Row<'a>)) {
        for (amplitude, &gain) in octaves.amplitude.iter_mut().zip(gain) {
            *amplitude = next_octave(*amplitude, gain);
        }
        for (frequency, &lacunarity) in octaves.frequency.iter_mut().zip(lacunarity) {
            *frequency = next_octave(*frequency, lacunarity);
        }
    }
}

/// A kernel of `IN` coordinates in each lane; one that is inlined, so that the loop vectorises.
#[inline(always)]
fn each<const IN: usize, const OUT: usize>(
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

/// Noises that are loops over lanes as they are.
macro_rules! noises {
    ($($name:ident: $kernel:expr;)*) => { $(
        kernel! {
            pub(super) fn $name<'a>((x, out, seed): (&'a Operands<'a>, &'a mut Out, u32)) -> usize {
                each(x, out, |p| $kernel(p, seed))
            }
        }
    )* };
}

noises! {
    Perlin4: |p, seed| [noise::perlin4(p, seed)];
    Perlin4Gradient: noise::perlin4_gradient;
    Value: |p, seed| [noise::value(p, seed)];
    ValueGradient: noise::value_gradient;
    Simplex: |p, seed| [noise::simplex(p, seed)];
    SimplexGradient: noise::simplex_gradient;
    Hash: |p, seed| [noise::hash(p, seed)];
}

/// The first `OUT` results of [`noise::worley_gradient`] in each lane: cells outside, lanes inside.
pub(super) struct Worley<const OUT: usize>;

impl<const OUT: usize> Kernel for Worley<OUT> {
    type Args<'a> = (&'a Operands<'a>, &'a mut Out, u32);
    type Out = usize;

    #[inline(always)]
    fn run((x, out, seed): Self::Args<'_>) -> usize {
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
}

/// [`noise::fbm`] in each lane.
pub(super) fn fbm(isa: Isa, x: &Operands<'_>, out: &mut Out, seed: u32) -> usize {
    let n = x[0].len();
    let (mut octaves, mut cells) = (Octaves::new(x[3]), Cells::new());
    let mut noise = [0.0; LANES];
    let sum = &mut out[0].0;
    sum.fill(0.0);
    for octave in 0..octaves.most() {
        // Add one octave.
        isa.run::<Scale>((&mut octaves, x));
        let [px, py, pz] = &octaves.scaled;
        values(isa, [&px[..n], &py[..n], &pz[..n]], &mut cells, &mut noise, seed);
        isa.run::<Add>((&octaves, octave, sum, &octaves.amplitude, &noise));
        // Step to the next.
        isa.run::<Step>((&mut octaves, x[4], x[5]));
    }
    1
}

/// [`noise::fbm_gradient`] in each lane.
pub(super) fn fbm_gradient(isa: Isa, x: &Operands<'_>, out: &mut Out, seed: u32) -> usize {
    let n = x[0].len();
    let (mut octaves, mut cells) = (Octaves::new(x[3]), Cells::new());
    let mut noise = [[0.0; LANES]; 4];
    out[..4].iter_mut().for_each(|sum| sum.0.fill(0.0));
    for octave in 0..octaves.most() {
        // Add one octave; the chain rule brings the frequency down.
        isa.run::<Scale>((&mut octaves, x));
        let [px, py, pz] = &octaves.scaled;
        gradients(isa, [&px[..n], &py[..n], &pz[..n]], &mut cells, noise.each_mut(), seed);
        let steepness = octaves.steepness();
        isa.run::<Add>((&octaves, octave, &mut out[0].0, &octaves.amplitude, &noise[0]));
        for i in 1..4 {
            isa.run::<Add>((&octaves, octave, &mut out[i].0, &steepness, &noise[i]));
        }
        // Step to the next.
        isa.run::<Step>((&mut octaves, x[4], x[5]));
    }
    4
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interp::batch::Lanes;
    use std::iter;

    /// Coordinates where cells begin, where the table repeats, and where they are held.
    const AWKWARD: [f32; 14] = [
        0.0, -0.0, -0.5, -1e-40, 63.5, 127.9, -128.0, 255.5, 256.0, -256.5, 65_535.5, -65_536.5, 3e38, -3e38,
    ];

    /// Awkward coordinates between others, in another order for each axis.
    fn coordinate(axis: usize, lane: usize) -> f32 {
        if lane % 3 == axis {
            AWKWARD[(lane * (3 + 2 * axis)) % AWKWARD.len()]
        } else {
            ((lane * (axis + 2)) as f32 * 37.31) % 700.0 - 350.0
        }
    }

    #[test]
    fn published_noise_is_that_of_the_kernels_at_all_lengths() {
        let row = |value: fn(usize) -> f32| (0..LANES).map(value).collect::<Vec<f32>>();
        let rows: [Vec<f32>; 6] = [
            row(|lane| coordinate(0, lane)),
            row(|lane| coordinate(1, lane)),
            row(|lane| coordinate(2, lane)),
            row(|lane| (lane % 5) as f32),
            row(|lane| 1.7 + 0.01 * lane as f32),
            row(|lane| 0.6 - 0.01 * lane as f32),
        ];
        for isa in Isa::all() {
            for n in 1..=LANES {
                let x: Operands<'_> = array::from_fn(|i| &rows[i][LANES - n..]);
                let mut found: [Out; 4] = array::from_fn(|_| array::from_fn(|_| Lanes::default()));
                perlin(isa, &x, &mut found[0], 0);
                perlin_gradient(isa, &x, &mut found[1], 0);
                fbm(isa, &x, &mut found[2], 0);
                fbm_gradient(isa, &x, &mut found[3], 0);
                for lane in 0..n {
                    let [p0, p1, p2, octaves, lacunarity, gain] = x.map(|row| row[lane]);
                    let p = [p0, p1, p2];
                    let expected = iter::once(noise::perlin(p, 0))
                        .chain(noise::perlin_gradient(p, 0))
                        .chain([noise::fbm(p, octaves, lacunarity, gain, 0)])
                        .chain(noise::fbm_gradient(p, octaves, lacunarity, gain, 0));
                    let found = found.iter().zip([1, 4, 1, 4]).flat_map(|(out, results)| &out[..results]);
                    for (i, (found, expected)) in found.zip(expected).enumerate() {
                        let found = found.0[lane];
                        assert_eq!(found.to_bits(), expected.to_bits(), "{} {p:?} of {n}: {i}", isa.name());
                    }
                }
            }
        }
    }
}
