//! The renderer written by hand: sixteen neighbouring rays at once, in even steps.
//!
//! 1. Rays are cut with the ball; all sixteen take as many steps, each of its own length, and end where nothing comes through.
//! 2. What is lost in a step scatters light in its middle: such places are put side by side, so that no lane is idle
//!    when the light is asked for.
//! 3. Sixteen places at a time learn how deep they lie, by [`Shadows`].

use crate::lanes::{LANES, Lanes, Mask};
use crate::light_grid::LightGrid;
use crate::noise::Noise;
use crate::points::Points;
use crate::scene::{Rays, SIZE, extinction, toward_light, way_out};
use pulp::NullaryFnOnce;
use pulp::x86::V4;
use rayon::prelude::*;

/// Sixteen rays are those of a block of pixels so wide and high.
const BLOCK: [u32; 2] = [8, 2];

/// Pixels that a thread takes at a time: two rows of the picture.
const STRIP: usize = 2 * SIZE[0] as usize;

/// A ray ends where less than this of the light comes through, as in vol.
const STOP: f32 = 1.0 / 65_536.0;
/// The same as an optical depth.
const OPAQUE: f32 = 11.09;

/// How the optical depth towards the light is found.
#[derive(Clone, Copy)]
pub(crate) enum Shadows<'a> {
    /// By steps of at most this length, scene units.
    March(f32),
    /// From depths that were computed before.
    Grid(&'a LightGrid),
}

/// The noise, and proof of the instructions.
pub(crate) struct Renderer {
    pub(crate) simd: V4,
    pub(crate) noise: Noise,
}

impl Renderer {
    /// The whole picture, rows from the top: radiance, the same in all channels. `step` is the longest of the rays from the eye,
    /// scene units.
    pub(crate) fn picture(&self, step: f32, shadows: Shadows<'_>) -> Vec<f32> {
        let places = blocks();
        let radiance = self.pixels(&places, step, shadows);
        let mut picture = vec![0.0; places.len()];
        for ([x, y], radiance) in places.into_iter().zip(radiance) {
            picture[(y * SIZE[0] + x) as usize] = radiance;
        }
        picture
    }

    /// Some pixels, given by column and row: best if each sixteen are neighbours.
    pub(crate) fn pixels(&self, pixels: &[[u32; 2]], step: f32, shadows: Shadows<'_>) -> Vec<f32> {
        let mut radiance = vec![0.0; pixels.len()];
        let strips = pixels.par_chunks(STRIP).zip(radiance.par_chunks_mut(STRIP));
        strips.for_each(|(pixels, radiance)| {
            let Self { simd, noise } = self;
            simd.vectorize(Strip { simd: *simd, noise, pixels, radiance, step, shadows });
        });
        radiance
    }
}

/// All pixels, block after block.
fn blocks() -> Vec<[u32; 2]> {
    let [width, height] = BLOCK;
    let corners = (0..SIZE[1])
        .step_by(height as usize)
        .flat_map(|y| (0..SIZE[0]).step_by(width as usize).map(move |x| [x, y]));
    corners
        .flat_map(|[x, y]| (0..height).flat_map(move |j| (0..width).map(move |i| [x + i, y + j])))
        .collect()
}

/// Work for a thread.
struct Strip<'a> {
    simd: V4,
    noise: &'a Noise,
    pixels: &'a [[u32; 2]],
    radiance: &'a mut [f32],
    step: f32,
    shadows: Shadows<'a>,
}

impl NullaryFnOnce for Strip<'_> {
    type Output = ();

    #[inline(always)]
    fn call(mut self) {
        let mut lit = Lit::default();
        let mut scattering = Vec::with_capacity(self.pixels.len() + LANES);
        for first in (0..self.pixels.len()).step_by(LANES) {
            // The last block may be smaller: its last pixel comes several times, and the first of them counts.
            let last = self.pixels.len() - 1;
            let (mut columns, mut rows) = ([0.0; LANES], [0.0; LANES]);
            for (lane, (column, row)) in columns.iter_mut().zip(&mut rows).enumerate() {
                let [x, y] = self.pixels[last.min(first + lane)];
                (*column, *row) = (x as f32, y as f32);
            }
            let rays = Rays::new(Lanes::of(self.simd, columns), Lanes::of(self.simd, rows));
            scattering.extend(rays.scattering(self.simd).array());
            self.march(&rays, first, &mut lit);
        }
        self.light(&mut lit);
        for (radiance, scattering) in self.radiance.iter_mut().zip(scattering) {
            *radiance *= scattering;
        }
    }
}

impl Strip<'_> {
    /// Goes along sixteen rays of pixels from number `first` on.
    #[inline(always)]
    fn march(&mut self, rays: &Rays, first: usize, lit: &mut Lit) {
        let inside = rays.lengths.above(0.0);
        let steps = (rays.lengths.largest() / self.step).ceil();
        let step = rays.lengths.scaled(1.0 / steps, 0.0);
        let mut through = Lanes::splat(self.simd, 1.0);
        for number in 0..steps as u32 {
            let goes_on = inside & through.above(STOP);
            if goes_on == 0 {
                break;
            }
            let middle = step.mul_add(step.same(number as f32 + 0.5), rays.entries);
            let points = rays.at(self.simd, middle);
            let decay = (extinction(self.simd, self.noise, points) * step).decay();
            let lost = through - through * decay;
            through = through * decay;
            lit.add(goes_on & lost.above(0.0), points, lost, first);
            if lit.count >= LANES {
                self.light(lit);
            }
        }
    }

    /// Adds the light of the next sixteen places, or of as many as there are.
    #[inline(always)]
    fn light(&mut self, lit: &mut Lit) {
        let [x, y, z] = &lit.points;
        let points =
            Points { x: first_of(self.simd, x), y: first_of(self.simd, y), z: first_of(self.simd, z) };
        let depth = match self.shadows {
            Shadows::March(step) => self.depth_towards_light(points, step),
            Shadows::Grid(grid) => grid.depth(points),
        };
        let light = first_of(self.simd, &lit.lost) * depth.decay();
        for (&pixel, light) in lit.pixels.iter().zip(light.array()).take(lit.count) {
            if let Some(radiance) = self.radiance.get_mut(pixel as usize) {
                *radiance += light;
            }
        }
        lit.drop_first();
    }

    /// Optical depth of sixteen places, in as many even steps for each.
    #[inline(always)]
    fn depth_towards_light(&self, points: Points, longest: f32) -> Lanes {
        let toward = Points::splat(self.simd, toward_light());
        let lengths = way_out(points, toward);
        let steps = (lengths.largest() / longest).ceil();
        let step = lengths.scaled(1.0 / steps, 0.0);
        let mut sum = Lanes::splat(self.simd, 0.0);
        for number in 0..steps as u32 {
            let t = step.scaled(number as f32 + 0.5, 0.0);
            sum = extinction(self.simd, self.noise, points.ahead(toward, t)).mul_add(step, sum);
            if sum.above(OPAQUE) == Mask::MAX {
                break;
            }
        }
        sum
    }
}

/// Places that scatter light, side by side.
#[derive(Default)]
struct Lit {
    /// How many there are: at most 15 before some are added.
    count: usize,
    points: [[f32; 2 * LANES]; 3],
    /// How much of the light is lost there on the way from behind to the eye.
    lost: [f32; 2 * LANES],
    /// Numbers of the pixels that see them; whole.
    pixels: [f32; 2 * LANES],
}

impl Lit {
    /// Adds the lanes of a mask; the first is a place of pixel `first`, the next ones of the pixels after it.
    #[inline(always)]
    fn add(&mut self, mask: Mask, points: Points, lost: Lanes, first: usize) {
        let range = self.count..self.count + LANES;
        let [x, y, z] = &mut self.points;
        x[range.clone()].copy_from_slice(&points.x.compressed(mask));
        y[range.clone()].copy_from_slice(&points.y.compressed(mask));
        z[range.clone()].copy_from_slice(&points.z.compressed(mask));
        self.lost[range.clone()].copy_from_slice(&lost.compressed(mask));
        self.pixels[range].copy_from_slice(&lost.counted(first as f32).compressed(mask));
        self.count += mask.count_ones() as usize;
    }

    #[inline(always)]
    fn drop_first(&mut self) {
        for column in self.points.iter_mut().chain([&mut self.lost, &mut self.pixels]) {
            column.copy_within(LANES.., 0);
        }
        self.count = self.count.saturating_sub(LANES);
    }
}

#[inline(always)]
fn first_of(simd: V4, column: &[f32; 2 * LANES]) -> Lanes {
    let (first, _) = column.as_chunks();
    Lanes::of(simd, first[0])
}
