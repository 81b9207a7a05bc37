//! Holes in occluders: where octaves of noise over the shadow map are below a level (Kol et al. 2016, Eq. 4 and 5).
//!
//! With `t` in 0..1 over the map, `q = t g f` and `g` = [`GRID`]: `N(q) = sum_i p^i P(2^i q) / max(1, o - i - 1)`, a hole
//! where `N(q) < h`. The paper prints `P(q)` in each term, so that the sum is a factor and the pattern one octave;
//! that is kept as `noise: printed`. A pattern that moves looks noise up twice: at `q` turned about the middle of the map
//! by the phase, then at `q` plus what was found.

use crate::isa::{Isa, kernel};
use crate::math::noise::perlin_hashed;
use rayon::prelude::*;
use std::f64::consts::TAU;
use vol_compiler::program::style::{Cut, Holes};

/// Cells of the noise along the map where the frequency is 1.
const GRID: f64 = 256.0;

/// Seed of the noise.
const SEED: u32 = 1;

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
    let mut mask = vec![false; size * size];
    mask.par_chunks_mut(size).enumerate().for_each_init(Places::default, |places, (row, mask)| {
        places.fill((0..size).map(|column| [column, row].map(|i| (i as f64 + 0.5) / size as f64)));
        let values = noise.at(places);
        mask.iter_mut().zip(values).for_each(|(hole, value)| *hole = *value < level);
    });
    mask
}

/// Many places of the map, 0..1 each, and room for what is computed there.
#[derive(Default)]
struct Places {
    map: Vec<[f64; 2]>,
    x: Vec<f32>,
    y: Vec<f32>,
    sway: [Vec<f32>; 2],
    sum: Vec<f32>,
}

impl Places {
    fn fill(&mut self, places: impl Iterator<Item = [f64; 2]>) {
        self.map.clear();
        self.map.extend(places);
    }
}

kernel! {
    /// Adds an amplitude times the noise in the plane, of all coordinates stretched.
    fn AddNoise<'a>((x, y, [stretch, amplitude], sum): (&'a [f32], &'a [f32], [f32; 2], &'a mut [f32])) {
        for ((sum, x), y) in sum.iter_mut().zip(x).zip(y) {
            *sum += amplitude * perlin_hashed([x * stretch, y * stretch, PLANE], SEED);
        }
    }
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

    /// The noise at places of the map.
    fn at<'a>(&self, places: &'a mut Places) -> &'a [f32] {
        let Places { map, x, y, sway, sum } = places;
        let count = map.len();
        let isa = Isa::best();
        if let Some([cos, sin]) = self.turn {
            // Look up first where the pattern has turned to, about the middle of the map.
            let turned = map.iter().map(|place| {
                let [x, y] = place.map(|t| (t - 0.5) * self.cells);
                [x * cos - y * sin, x * sin + y * cos]
            });
            for (elsewhere, sway) in [0.0, ELSEWHERE].into_iter().zip(sway.iter_mut()) {
                x.clear();
                x.extend(turned.clone().map(|[x, _]| x as f32 + elsewhere));
                y.clear();
                y.extend(turned.clone().map(|[_, y]| y as f32 + elsewhere));
                sway.clear();
                sway.resize(count, 0.0);
                isa.run::<AddNoise>((&*x, &*y, [1.0, SWAY], sway));
            }
        }
        for (axis, (own, sway)) in [&mut *x, &mut *y].into_iter().zip(sway.iter()).enumerate() {
            own.clear();
            own.extend(map.iter().map(|place| (place[axis] * self.cells) as f32));
            if self.turn.is_some() {
                own.iter_mut().zip(sway).for_each(|(own, sway)| *own += sway);
            }
        }
        sum.clear();
        sum.resize(count, 0.0);
        let (mut amplitude, mut stretch) = (1.0, 1.0);
        for octave in 0..self.octaves {
            let divisor = (self.octaves - octave).saturating_sub(1).max(1) as f32;
            isa.run::<AddNoise>((&*x, &*y, [stretch, amplitude / divisor], sum));
            amplitude *= self.persistence;
            stretch *= if self.as_printed { 1.0 } else { 2.0 };
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
        let mut places = Places::default();
        places.fill((0..PROBES * PROBES).map(place));
        let mut found = self.at(&mut places).to_vec();
        found.sort_unstable_by(f32::total_cmp);
        let rank = (share.clamp(0.0, 1.0) * found.len() as f64).round() as usize;
        found.get(rank).copied().unwrap_or(f32::INFINITY)
    }
}
