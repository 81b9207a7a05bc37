//! Holes in occluders: where octaves of noise over the shadow map are below a level (Kol et al. 2016, Eq. 4 and 5).
//!
//! With `t` in 0..1 over the map, `q = t g f` and `g` = [`GRID`]: `N(q) = sum_i p^i P(2^i q) / max(1, o - i - 1)`, a hole
//! where `N(q) < h`. The paper prints `P(q)` in each term, so that the sum is a factor and the pattern one octave;
//! that is kept as `noise: printed`. A pattern that moves looks noise up twice: at `q` turned about the middle of the map
//! by the phase, then at `q` plus what was found.

use crate::math::noise::perlin;
use rayon::prelude::*;
use std::f64::consts::TAU;
use vol_compiler::program::style::{Cut, Holes};

/// Cells of the noise along the map where the frequency is 1.
const GRID: f64 = 256.0;

/// How far the first look-up moves the second, in cells of the first octave.
const SWAY: f32 = 1.0;

/// Places along each side of the map at which the level of a probability is measured.
const PROBES: usize = 64;

/// Where along z the noise is cut: between its planes of zeros.
const PLANE: f32 = 0.5;

/// Apart enough in the noise to be independent.
const ELSEWHERE: f32 = 57.31;

/// Which texels of a map of `size` x `size` are holes.
pub(super) fn holes(holes: &Holes<f64>, size: usize) -> Vec<bool> {
    let noise = Noise::new(holes);
    let level = noise.level(&holes.cut);
    let at = |index: usize| (index as f64 + 0.5) / size as f64;
    (0..size * size).into_par_iter().map(|i| noise.at([at(i % size), at(i / size)]) < level).collect()
}

/// The noise over the map.
struct Noise {
    cells: f64,
    persistence: f32,
    octaves: u32,
    /// Cosine and sine of the phase.
    turn: Option<[f64; 2]>,
    as_printed: bool,
}

impl Noise {
    fn new(holes: &Holes<f64>) -> Self {
        // A param or the time may have set anything.
        let cells = GRID * if holes.frequency.is_finite() { holes.frequency.abs() } else { 0.0 };
        let turn = holes.phase.map(|turns| if turns.is_finite() { TAU * turns.fract() } else { 0.0 });
        Self {
            cells: cells.min(1e5),
            persistence: holes.persistence.clamp(0.0, 16.0) as f32,
            octaves: holes.octaves,
            turn: turn.map(|angle| [angle.cos(), angle.sin()]),
            as_printed: holes.as_printed,
        }
    }

    /// The noise at a place of the map, 0..1 each.
    fn at(&self, place: [f64; 2]) -> f32 {
        let [x, y] = place.map(|t| t * self.cells);
        let mut q = [x as f32, y as f32];
        if let Some([cos, sin]) = self.turn {
            let [x, y] = place.map(|t| (t - 0.5) * self.cells);
            let turned = [(x * cos - y * sin) as f32, (x * sin + y * cos) as f32];
            let sway = [plane(turned), plane(turned.map(|c| c + ELSEWHERE))];
            q = [q[0] + SWAY * sway[0], q[1] + SWAY * sway[1]];
        }
        self.octaves(q)
    }

    fn octaves(&self, q: [f32; 2]) -> f32 {
        let (mut sum, mut amplitude, mut stretch) = (0.0, 1.0, 1.0);
        for octave in 0..self.octaves {
            let divisor = (self.octaves - octave).saturating_sub(1).max(1) as f32;
            let place = if self.as_printed { q } else { q.map(|c| c * stretch) };
            sum += amplitude * plane(place) / divisor;
            amplitude *= self.persistence;
            stretch *= 2.0;
        }
        sum
    }

    /// The level below which noise is a hole.
    fn level(&self, cut: &Cut<f64>) -> f32 {
        let share = match *cut {
            Cut::Threshold(level) => return level as f32,
            Cut::Probability(share) => share,
        };
        // Not on a lattice, of whose points noise may be fond.
        let place = |i: usize| {
            let [x, y] = [i % PROBES, i / PROBES].map(|k| k as f64 + 0.5);
            [
                (x + 0.37 * (y * 0.618_034).fract()) / PROBES as f64,
                (y + 0.37 * (x * 0.618_034).fract()) / PROBES as f64,
            ]
        };
        let mut found: Vec<f32> = (0..PROBES * PROBES).map(|i| self.at(place(i))).collect();
        found.sort_unstable_by(f32::total_cmp);
        let rank = (share.clamp(0.0, 1.0) * found.len() as f64).round() as usize;
        found.get(rank).copied().unwrap_or(f32::INFINITY)
    }
}

/// Noise in the plane.
fn plane([x, y]: [f32; 2]) -> f32 {
    perlin([x, y, PLANE], 0)
}
