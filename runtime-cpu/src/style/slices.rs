//! A shadow map cut along the epipolar lines of an eye, and put together again.
//!
//! Distances along slices have the texels of the map; there are as many slices as keep neighbours no further
//! apart than a texel at their far ends, but no more words than [`MAX_WORDS`]. Texels take the height of the map where
//! their middles are: at most half a texel is lost each way.

use super::shadow_map::{Layout, NOTHING};
use crate::real::Vec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};
use vol_compiler::frame::styled::Slices;

/// Most words of all slices, 16 MiB: with the grids of lights and a light map they fit a buffer that any device can bind.
const MAX_WORDS: usize = 4 << 20;

/// How slices lie on a map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fan {
    layout: Layout,
    /// `(u, v, w)` of the eye.
    eye: Vec3<f64>,
    first_angle: f64,
    per_radian: f64,
    rows: usize,
    first_distance: f64,
    columns: usize,
}

impl Fan {
    /// All slices that meet a map.
    pub(super) fn new(layout: Layout, eye: Vec3<f64>) -> Self {
        let eye = layout.seen(eye);
        let side = layout.size as f64;
        let corners = [[0.0, 0.0], [side, 0.0], [0.0, side], [side, side]].map(|corner| layout.place(corner));
        let off = |place: [f64; 2]| [place[0] - eye[0], place[1] - eye[1]];
        let far = corners.map(|corner| length(off(corner))).into_iter().fold(0.0, f64::max);
        let nearest = [0, 1].map(|axis| eye[axis].clamp(corners[0][axis], corners[3][axis]));
        let mut first_distance = length(off(nearest));
        let (mut first_angle, mut angle) = (-PI, TAU);
        if first_distance > 0.0 {
            // The eye is beside the map: all of it is within half a turn.
            let middle = off(layout.place([0.5 * side, 0.5 * side]));
            let middle = middle[1].atan2(middle[0]);
            let turn = |corner| {
                let [x, y] = off(corner);
                (y.atan2(x) - middle + 3.0 * PI).rem_euclid(TAU) - PI
            };
            let turns = corners.map(turn);
            let (lo, hi) =
                turns.iter().fold((PI, -PI), |(lo, hi), &turn| (f64::min(lo, turn), f64::max(hi, turn)));
            let margin = layout.texel / far;
            angle = (hi - lo + 2.0 * margin).min(TAU);
            first_angle = (middle + lo - margin + PI).rem_euclid(TAU) - PI;
            // The first texel holds the eye only where the map does.
            first_distance = first_distance.max(layout.texel);
        }
        let columns = (((far - first_distance) / layout.texel).ceil() as usize).max(1);
        let rows = (angle * far / layout.texel).ceil();
        let rows = (rows as usize).clamp(1, (MAX_WORDS / columns).max(1));
        let per_radian = rows as f64 / angle;
        Self { layout, eye, first_angle, per_radian, rows, first_distance, columns }
    }

    /// Slopes of the heights on a map.
    pub(super) fn cut(&self, heights: &[f32]) -> Vec<f32> {
        let mut slopes = vec![Slices::NO_SLOPE; self.rows * self.columns];
        slopes.par_chunks_mut(self.columns).enumerate().for_each(|(row, slopes)| {
            let [cos, sin] = self.direction(row);
            for (column, slope) in slopes.iter_mut().enumerate() {
                let x = self.distance(column);
                let height = self.layout.texel_at([self.eye[0] + x * cos, self.eye[1] + x * sin]);
                let height = height.map_or(NOTHING, |texel| heights[texel]);
                if height > NOTHING {
                    *slope = ((f64::from(height) - self.eye[2]) / x) as f32;
                }
            }
        });
        slopes
    }

    /// What a map has at the middles of the texels of all slices; nothing where it does not reach.
    pub(super) fn cut_mask(&self, map: &[bool]) -> Vec<bool> {
        let texel = |index: usize| {
            let [cos, sin] = self.direction(index / self.columns);
            let x = self.distance(index % self.columns);
            let texel = self.layout.texel_at([self.eye[0] + x * cos, self.eye[1] + x * sin]);
            texel.is_some_and(|texel| map[texel])
        };
        (0..self.rows * self.columns).into_par_iter().map(texel).collect()
    }

    /// Heights on a map of the slopes of slices.
    pub(super) fn join(&self, slopes: &[f32]) -> Vec<f32> {
        let size = self.layout.size;
        let height = |index: usize| {
            let middle = [index % size, index / size].map(|i| i as f64 + 0.5);
            let place = self.layout.place(middle);
            let off = [place[0] - self.eye[0], place[1] - self.eye[1]];
            let x = length(off);
            let turned = (off[1].atan2(off[0]) - self.first_angle).rem_euclid(TAU);
            let row = ((turned * self.per_radian) as usize).min(self.rows - 1);
            let column = ((x - self.first_distance) / self.layout.texel).max(0.0) as usize;
            let column = column.min(self.columns - 1);
            let slope = slopes[row * self.columns + column];
            if slope > Slices::NO_SLOPE { (f64::from(slope) * x + self.eye[2]) as f32 } else { NOTHING }
        };
        (0..size * size).into_par_iter().map(height).collect()
    }

    /// Texels of a slice.
    pub(super) fn columns(&self) -> usize {
        self.columns
    }

    /// The slices as both backends read them.
    pub(super) fn table(&self, slopes: Vec<f32>) -> Slices {
        Slices {
            axes: self.layout.axes.map(|axis| axis.map(|x| x as f32)),
            first_angle: self.first_angle as f32,
            per_radian: self.per_radian as f32,
            rows: self.rows as u32,
            first_distance: self.first_distance as f32,
            per_unit: (1.0 / self.layout.texel) as f32,
            columns: self.columns as u32,
            slopes,
        }
    }

    /// Cosine and sine of the angle of a slice.
    fn direction(&self, row: usize) -> [f64; 2] {
        let angle = self.first_angle + (row as f64 + 0.5) / self.per_radian;
        [angle.cos(), angle.sin()]
    }

    /// Distance of the middle of a texel.
    fn distance(&self, column: usize) -> f64 {
        self.first_distance + (column as f64 + 0.5) * self.layout.texel
    }
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}
