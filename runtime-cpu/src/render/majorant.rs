//! Bounds on the extinction of all media together, cell by cell, and free paths among them.
//!
//! The box around the media is cut into a grid of about cubic cells, [`CELLS`] along its longest side. The
//! bound of a cell is the sum over the media of what interval evaluation says of their extinction there, 0
//! where their regions do not reach: a true bound, by no sampling. It may be loose (noise over a cell as large as
//! its features is bounded by the noise's range), which costs time and no bias.

use super::camera::{FAR, PARALLEL, Ray};
use super::matter::bounds;
use super::method::NoMajorant;
use super::random::Stream;
use crate::real::Real;
use rayon::prelude::*;
use vol_compiler::frame::{Aabb, Frame};
use vol_compiler::ops::interval::Interval;
use vol_compiler::program::Program;
use vol_compiler::wgsl::render::{padded, padded_cells};

/// Cells along the longest side of the box.
const CELLS: f64 = 32.0;

/// A cell is bounded over this much more on each side, relative to its size: rays know in f64 in which cell they
/// are, points are f32.
const SLACK: f64 = 1e-3;

/// And by this share of the largest coordinate, the eye's included.
const ROUNDING: f64 = 1e-6;

/// Bounds grow by this share for what f32 adds to the meaning in f64.
const HEADROOM: f64 = 1.0 + 1e-4;

/// Tentative collisions over the longest side of the box where something glows, at least: emission is gathered
/// there.
const LEAST_COLLISIONS: f64 = 4.0;

/// The grid.
#[derive(Debug)]
pub(crate) struct Majorants {
    lo: [f64; 3],
    hi: [f64; 3],
    count: [usize; 3],
    /// Collisions per unit of length, x fastest; no extinction in the cell is above.
    rates: Vec<f64>,
}

impl Majorants {
    /// Bounds all media of a frame.
    pub(super) fn new(program: &Program, frame: &Frame) -> Result<Self, NoMajorant> {
        let boxes = frame.media.iter().filter_map(|medium| padded(&medium.bounds));
        let Some(around) = boxes.reduce(|a, b| a.union(&b)) else {
            return Ok(Self { lo: [0.0; 3], hi: [0.0; 3], count: [0; 3], rates: Vec::new() });
        };
        let (lo, hi) = (around.lo.map(f64::from), around.hi.map(f64::from));
        let longest = (0..3).map(|i| hi[i] - lo[i]).fold(0.0, f64::max);
        let count = [0, 1, 2].map(|i| ((hi[i] - lo[i]) / longest * CELLS).ceil().clamp(1.0, CELLS) as usize);
        let mut grid = Self { lo, hi, count, rates: Vec::new() };
        let corners = [around.lo, around.hi, frame.camera.origin].into_iter().flatten();
        let reach = ROUNDING * corners.fold(0.0, |most: f64, x| most.max(f64::from(x.abs())));
        let rates = (0..count.iter().product()).into_par_iter();
        grid.rates = rates.map(|cell| grid.rate(program, frame, cell, reach)).collect::<Result<_, _>>()?;
        Ok(grid)
    }

    /// The rate of a cell, grown by `reach` and [`SLACK`].
    fn rate(&self, program: &Program, frame: &Frame, cell: usize, reach: f64) -> Result<f64, NoMajorant> {
        let index = [
            cell % self.count[0],
            cell / self.count[0] % self.count[1],
            cell / self.count[0] / self.count[1],
        ];
        let width = self.width();
        let side = |i: usize| {
            let lo = self.lo[i] + width[i] * index[i] as f64;
            let reach = reach + SLACK * width[i];
            [lo - reach, lo + width[i] + reach]
        };
        let sides = [side(0), side(1), side(2)];
        let (mut rate, mut glows) = (0.0, false);
        for medium in &frame.media {
            let within = |around: &Aabb| {
                (0..3)
                    .all(|i| sides[i][0] <= f64::from(around.hi[i]) && f64::from(around.lo[i]) <= sides[i][1])
            };
            let cells = padded_cells(medium);
            let reached = padded(&medium.bounds).is_some_and(|bounds| within(&bounds))
                && (cells.is_empty() || cells.iter().any(within));
            let sides = sides.map(|[lo, hi]| Interval::new(lo, hi));
            let Some(bounds) = reached.then(|| bounds(program, frame, medium, &sides)).flatten() else {
                continue;
            };
            rate += HEADROOM * bounds.extinction;
            glows |= bounds.glows;
            if !rate.is_finite() {
                return Err(NoMajorant { medium: medium.index });
            }
        }
        let least = LEAST_COLLISIONS / (0..3).map(|i| self.hi[i] - self.lo[i]).fold(0.0, f64::max);
        Ok(if glows { rate.max(least) } else { rate })
    }

    /// Size of a cell.
    fn width(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| (self.hi[i] - self.lo[i]) / self.count[i] as f64)
    }

    /// The rate at a place, 0 outside the grid.
    #[cfg(test)]
    pub(super) fn rate_at(&self, place: [f64; 3]) -> f64 {
        let width = self.width();
        let index = [0, 1, 2].map(|i| ((place[i] - self.lo[i]) / width[i]).floor());
        if (0..3).any(|i| index[i] < 0.0 || index[i] >= self.count[i] as f64) {
            return 0.0;
        }
        let [x, y, z] = index.map(|i| i as usize);
        self.rates[x + self.count[0] * (y + self.count[1] * z)]
    }

    /// Starts a free path along a ray, up to its end.
    pub(super) fn path<R: Real>(&self, ray: &Ray<R>, end: R, mut stream: Stream) -> FreePath {
        let (origin, direction) = (ray.origin.map(Real::to_f64), ray.direction.map(Real::to_f64));
        // Enter the box.
        let (mut entry, mut exit) = (0.0_f64, end.to_f64().min(f64::from(FAR)));
        for i in 0..3 {
            if direction[i].abs() < f64::from(PARALLEL) {
                exit = if self.lo[i] <= origin[i] && origin[i] <= self.hi[i] { exit } else { -1.0 };
                continue;
            }
            let [a, b] = [self.lo[i], self.hi[i]].map(|wall| (wall - origin[i]) / direction[i]);
            (entry, exit) = (entry.max(a.min(b)), exit.min(a.max(b)));
        }
        if self.rates.is_empty() || entry >= exit {
            return FreePath { t: 0.0, exit: -1.0, left: 0.0, index: [0; 3], axes: [Axis::STILL; 3], stream };
        }
        // Find the first cell and the walls that come next (Amanatides and Woo 1987).
        let width = self.width();
        let mut index = [0; 3];
        let axes = [0, 1, 2].map(|i| {
            let place = (origin[i] + entry * direction[i] - self.lo[i]) / width[i];
            index[i] = place.floor().clamp(0.0, (self.count[i] - 1) as f64) as usize;
            if direction[i].abs() < f64::from(PARALLEL) {
                return Axis::STILL;
            }
            let ahead = if direction[i] > 0.0 { index[i] + 1 } else { index[i] };
            let wall = self.lo[i] + width[i] * ahead as f64;
            Axis {
                next: (wall - origin[i]) / direction[i],
                spacing: (width[i] / direction[i]).abs(),
                forward: direction[i] > 0.0,
            }
        });
        let left = stream.exponential::<R>();
        FreePath { t: entry, exit, left, index, axes, stream }
    }
}

/// The walls of the grid across an axis, as a ray meets them.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// Distance of the next one.
    next: f64,
    /// Distance between two.
    spacing: f64,
    forward: bool,
}

impl Axis {
    /// None: the ray runs along them.
    const STILL: Self = Self { next: f64::INFINITY, spacing: f64::INFINITY, forward: true };
}

/// A place where a photon may collide with something.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tentative {
    /// Distance from the origin of the ray.
    pub(super) t: f64,
    /// Collisions per unit of length there: no extinction is above.
    pub(super) rate: f64,
}

/// A walk through the grid from one tentative collision to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct FreePath {
    t: f64,
    exit: f64,
    /// Integral of the rate up to the next collision.
    left: f64,
    index: [usize; 3],
    axes: [Axis; 3],
    pub(super) stream: Stream,
}

impl FreePath {
    /// The next tentative collision; none if the ray ends first. They are a Poisson process of the
    /// cells' rates.
    pub(super) fn next<R: Real>(&mut self, grid: &Majorants) -> Option<Tentative> {
        while self.t < self.exit {
            let axis =
                (0..3).fold(0, |least, i| if self.axes[i].next < self.axes[least].next { i } else { least });
            let wall = self.axes[axis].next.min(self.exit).max(self.t);
            let [x, y, z] = self.index;
            let rate = grid.rates[x + grid.count[0] * (y + grid.count[1] * z)];
            let depth = rate * (wall - self.t);
            if self.left < depth {
                self.t = (self.t + self.left / rate).min(wall);
                self.left = self.stream.exponential::<R>();
                return Some(Tentative { t: self.t, rate });
            }
            self.left -= depth;
            self.t = wall;
            // Go to the next cell, or out of the grid.
            let Axis { forward, spacing, .. } = self.axes[axis];
            let edge = if forward { grid.count[axis] - 1 } else { 0 };
            if self.index[axis] == edge {
                self.exit = -1.0;
            } else {
                self.index[axis] = if forward { self.index[axis] + 1 } else { self.index[axis] - 1 };
                self.axes[axis].next += spacing;
            }
        }
        None
    }
}
