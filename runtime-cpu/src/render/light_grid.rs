//! Optical depth between a light and a point, looked up in the light's grid.
//!
//! A grid holds depths, not the light that arrives: between its points a depth is nearly linear where
//! `exp(-depth)` is not. [`fill()`] finds them. Between points depths are cubic along each axis, in one of two ways:
//!
//! * a local cubic: third order in the distance between points where the density is smooth, first order at walls;
//! * a cubic spline ([`spline`]): fourth order, 4e-7 deep inside a homogeneous ball with 129 points where the other is 2e-4
//!   off; but it swings for some points beside a wall, which draws rings.
//!
//! What that means for a scene is measured, and the way chosen, in [`super::grid_choice`].
//!
//! * source: algorithms.md §5.1, "Light"; R. G. Keys, "Cubic Convolution Interpolation for Digital Image
//!   Processing", IEEE TASSP 1981; M. Unser, "Splines: A Perfect Fit for Signal and Image Processing", IEEE Signal
//!   Processing Magazine 1999
//!
//! Twin of the look-up: `compiler/src/wgsl/render/light_grid.wgsl`.

mod fill;
mod packed;
mod spline;

pub(crate) use fill::{fill, filling_bytes};
pub(super) use fill::{nodes, recipe};
pub(super) use packed::unpacked;

use self::packed::Packed;
use super::fields::{Colors, Points};
use crate::isa::Loop;
use crate::real::{Real, Vec3, dot, length, mul, scale, splat, sub, vector};
use std::sync::Arc;
use vol_compiler::frame::{GridColumn, LightGrid};

/// A grid as the integrator reads it.
#[derive(Debug)]
pub(crate) struct Grid<R> {
    distant: bool,
    origin: Vec3<R>,
    axes: [Vec3<R>; 3],
    lo: Vec3<R>,
    scale: Vec3<R>,
    /// Index of the last point along each axis.
    last: Vec3<R>,
    tint: Vec3<R>,
    /// Columns along the second axis.
    row: usize,
    channels: usize,
    spline: bool,
    table: Arc<LightGrid>,
}

impl<R: Real> Grid<R> {
    /// Reads a grid.
    pub(crate) fn new(table: &Arc<LightGrid>) -> Self {
        Self {
            distant: table.distant,
            origin: vector(table.origin),
            axes: table.axes.map(vector),
            lo: vector(table.lo),
            scale: vector(table.scale),
            last: table.counts.map(|count| R::from_index(count as i32 - 1)),
            tint: vector(table.tint),
            row: table.counts[1] as usize,
            channels: table.channels(),
            spline: table.spline,
            table: Arc::clone(table),
        }
    }

    /// Depths at many points.
    pub(super) fn depths(&self, points: &Points<R>) -> Colors<R> {
        let mut depths = Colors::splat(R::ZERO, points.len());
        R::vectorized(Depths { grid: self, points, depths: &mut depths });
        depths
    }

    /// Depth at a point.
    #[inline(always)]
    pub(crate) fn depth(&self, point: Vec3<R>) -> Vec3<R> {
        // Find the point as the light sees it.
        let off = sub(point, self.origin);
        let [u, v, w] = self.axes.map(|axis| dot(off, axis));
        let ahead = self.distant | (w > R::from_f32(0.5) * self.lo[2]);
        let divisor = if ahead & !self.distant { w } else { R::ONE };
        let seen = [u / divisor, v / divisor, if self.distant { w } else { length(off) }];
        let last = self.last;
        let place = mul(sub(seen, self.lo), self.scale);
        let beside =
            (place[0] < R::ZERO) | (place[0] > last[0]) | (place[1] < R::ZERO) | (place[1] > last[1]);
        // Nothing is before the grid or beside it.
        if !ahead | beside | (place[2] <= R::ZERO) {
            return splat(R::ZERO);
        }
        // Behind it nothing is added.
        let held = [place[0], place[1], place[2].min(last[2])];
        let around = [0, 1, 2].map(|axis| Stencil::new(held[axis], last[axis], self.spline));
        if self.channels == 1 {
            return scale(self.tint, self.channel(0, &around));
        }
        mul(self.tint, [0, 1, 2].map(|channel| self.channel(channel, &around)))
    }

    /// One channel between the points around; what the cubic overshoots below 0 is cut off.
    #[inline(always)]
    fn channel(&self, channel: usize, [x, y, z]: &[Stencil<R>; 3]) -> R {
        // Four sums side by side, which are one vector.
        let mut sums = [R::ZERO; 4];
        for i in 0..4 {
            for j in 0..4 {
                let weight = x.weights[i] * y.weights[j];
                let row = self.along(x.at[i] as usize * self.row + y.at[j] as usize, channel, z.at);
                for (sum, depth) in sums.iter_mut().zip(row) {
                    *sum = *sum + weight * R::from_f32(depth);
                }
            }
        }
        let [a, b, c, d] = z.weights;
        let sum = ((a * sums[0] + b * sums[1]) + c * sums[2]) + d * sums[3];
        sum.max(R::ZERO)
    }

    /// Depths at four points of a column.
    #[inline(always)]
    fn along(&self, column: usize, channel: usize, points: [i32; 4]) -> [f32; 4] {
        let GridColumn { first, count, at } = self.table.columns[column];
        let depths = &self.table.depths[at as usize..];
        // With one channel they are neighbours, but at the ends.
        let begin = (points[0] - first as i32) as usize;
        if self.channels == 1
            && points[3] == points[0] + 3
            && begin < count as usize
            && let Some(four) = depths[begin..count as usize].first_chunk()
        {
            return *four;
        }
        let places = points.map(|point| (point - first as i32).clamp(0, count as i32 - 1) as usize);
        places.map(|place| depths[self.channels * place + channel])
    }
}

struct Depths<'a, R> {
    grid: &'a Grid<R>,
    points: &'a Points<R>,
    depths: &'a mut Colors<R>,
}

impl<R: Real> Loop for Depths<'_, R> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        for index in 0..self.points.len() {
            self.depths.set(index, self.grid.depth(self.points.get(index)));
        }
    }
}

/// The four points around a place along one axis.
struct Stencil<R> {
    /// Their numbers; where there is none the last one counts twice.
    at: [i32; 4],
    /// Their weights.
    weights: [R; 4],
}

impl<R: Real> Stencil<R> {
    /// `place` in 0..`last`.
    #[inline(always)]
    fn new(place: R, last: R, spline: bool) -> Self {
        let index = place.floor().min(last - R::ONE);
        let t = place - index;
        let (f, half) = (R::from_f32, R::from_f32(0.5));
        let weights = if spline {
            let (back, sixth, two_thirds) = (R::ONE - t, f(1.0 / 6.0), f(2.0 / 3.0));
            [
                sixth * (back * (back * back)),
                two_thirds - (t * t) * (R::ONE - half * t),
                two_thirds - (back * back) * (R::ONE - half * back),
                sixth * (t * (t * t)),
            ]
        } else {
            [
                ((R::ONE - half * t) * t - half) * t,
                ((f(1.5) * t - f(2.5)) * t) * t + R::ONE,
                ((f(2.0) - f(1.5) * t) * t + half) * t,
                ((half * t - half) * t) * t,
            ]
        };
        let (index, last) = (index.to_index(), last.to_index());
        Self { at: [-1, 0, 1, 2].map(|k| (index + k).clamp(0, last)), weights }
    }
}

/// The same grid with a spline through its depths; none if that, which has all points of all columns, took more than so many
/// words.
pub(super) fn splined(grid: &LightGrid, most_words: usize) -> Option<LightGrid> {
    if grid.most_words() > most_words {
        return None;
    }
    let channels = grid.channels();
    let values = spline::coefficients(unpacked(grid), grid.counts, channels);
    let mut packed = Packed::new();
    values.chunks(grid.counts[2] as usize * channels).for_each(|column| packed.push(0, column, channels));
    let layout = LightGrid { spline: true, columns: Vec::new(), depths: Vec::new(), ..*grid };
    Some(packed.into_grid(layout))
}

/// Bytes that [`splined`] takes: all depths, and the coefficients twice.
pub(super) fn spline_bytes(grid: &LightGrid) -> usize {
    3 * size_of::<f32>() * grid.most_words()
}
