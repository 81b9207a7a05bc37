//! The rays of a distant light through the texels of its shadow map.
//!
//! Rays side by side have most of their way in common. A tile of the map is divided into beams, those into narrower
//! ones, down to the rays of the texels; each starts where the one around it could not go on
//! ([`Integrator::clear_lengths`]). A beam that meets nothing ends the search for all of its texels.
//!
//! * error: a height is at most [`LEAST_STEP`] of a texel below the first surface that the ray is under for longer than
//!   that, as without beams; both find the same surfaces, but may stop at different places of that stretch

use super::shadow_map::{Layout, NOTHING, is_endless};
use crate::interp::Tapes;
use crate::real::{Vec3, add, scale};
use crate::render::{Batch, Batches, FAR, Integrator, Ray, Scene, ShadowRay};
use rayon::prelude::*;
use vol_compiler::frame::{Frame, Job};
use vol_compiler::wgsl::render::padded;

/// Rays of the light walk at least this part of a texel at a time: nothing thinner is sure to be met.
const LEAST_STEP: f32 = 0.05;

/// Texels along the sides of the tiles that are traced at once; a multiple of the sides of beams.
const TILE: [usize; 2] = [64, 32];

/// Texels along a side of the beams, from wide to narrow, down to single rays.
const SIDES: [usize; 3] = [8, 2, 1];

/// A square of texels by its first one, and how far their rays are clear.
#[derive(Clone, Copy, Debug)]
struct Square {
    corner: [usize; 2],
    clear: f32,
}

/// What the tiles of a map have in common.
struct Tracer<'a> {
    layout: &'a Layout,
    /// Length of the rays.
    length: f32,
    /// Whether there are solids without end: they may lie above everything that has one.
    endless: bool,
}

impl Layout {
    /// Heights `w` of the solids of a frame, texel by texel, `u` fastest; [`NOTHING`] where there are none.
    pub(super) fn trace(&self, tapes: &Tapes, frame: &Frame, job: &Job) -> Vec<f32> {
        let scene = Scene::new(frame, job);
        let [bottom, top] = self.heights;
        let mut boxes = frame.objects.iter().filter_map(|object| padded(&object.bounds));
        let endless = boxes.any(|bounds| is_endless(&bounds));
        let tracer = Tracer { layout: self, length: (top - bottom) as f32, endless };
        let mut heights = vec![NOTHING; self.size * self.size];
        heights.par_chunks_mut(TILE[1] * self.size).enumerate().for_each(|(strip, heights)| {
            let mut integrator = Integrator::new(&scene, Batch::new(tapes, frame), Batches::DEFAULT);
            let row = strip * TILE[1];
            for column in (0..self.size).step_by(TILE[0]) {
                tracer.trace(&mut integrator, [column, row], |[x, y], height| {
                    heights[(y - row) * self.size + x] = height;
                });
            }
        });
        heights
    }
}

impl Tracer<'_> {
    /// Finds the heights of the texels of a tile in which there are any.
    fn trace(
        &self,
        integrator: &mut Integrator<'_, Batch<'_>>,
        tile: [usize; 2],
        mut found: impl FnMut([usize; 2], f32),
    ) {
        let mut squares = self.parts(&[Square { corner: tile, clear: 0.0 }], TILE, SIDES[0]);
        let hidden = if self.endless { self.hidden(integrator, &squares) } else { Vec::new() };
        for sides in SIDES.windows(2) {
            let (side, narrower) = (sides[0], sides[1]);
            let axes: Vec<_> = squares.iter().map(|square| self.axis(square, side, -1.0)).collect();
            let starts: Vec<_> = squares.iter().map(|square| square.clear).collect();
            let clear = integrator.clear_lengths(&axes, self.radius(side), &starts, self.length);
            squares.iter_mut().zip(clear).for_each(|(square, clear)| square.clear = clear);
            squares.retain(|square| square.clear < self.length);
            squares = self.parts(&squares, [side; 2], narrower);
        }
        let rays: Vec<_> = squares.iter().map(|square| self.axis(square, 1, -1.0)).collect();
        let starts: Vec<_> = squares.iter().map(|square| square.clear).collect();
        let top = self.layout.heights[1];
        for (square, entry) in
            squares.iter().zip(integrator.entries(&rays, &starts, self.length, self.least()))
        {
            if let Some(t) = entry {
                found(square.corner, (top - f64::from(t)) as f32);
            }
        }
        hidden.into_iter().for_each(|texel| found(texel, top as f32));
    }

    /// The texels of some beams that are below a solid without end.
    fn hidden(&self, integrator: &mut Integrator<'_, Batch<'_>>, beams: &[Square]) -> Vec<[usize; 2]> {
        let side = SIDES[0];
        let up: Vec<_> = beams.iter().map(|beam| self.axis(beam, side, 1.0)).collect();
        let starts = vec![0.0; up.len()];
        let clear = integrator.clear_lengths(&up, self.radius(side), &starts, f32::MAX);
        let doubtful = beams.iter().zip(clear).filter(|(_, clear)| *clear < FAR).map(|(beam, _)| *beam);
        let texels = self.parts(&doubtful.collect::<Vec<_>>(), [side; 2], 1);
        let ray = |texel: &Square| ShadowRay::new(self.axis(texel, 1, 1.0), f32::MAX, 4.0 * self.least());
        let blocked = integrator.blocked(&texels.iter().map(ray).collect::<Vec<_>>());
        texels.iter().zip(blocked).filter(|(_, blocked)| *blocked).map(|(texel, _)| texel.corner).collect()
    }

    /// The squares of a side in those of another size, as far as they are on the map.
    fn parts(&self, whole: &[Square], size: [usize; 2], side: usize) -> Vec<Square> {
        let part = |square: &Square, x, y| Square {
            corner: [square.corner[0] + x, square.corner[1] + y],
            ..*square
        };
        let rows = |square| (0..size[1]).step_by(side).map(move |y| (square, y));
        let parts = whole
            .iter()
            .flat_map(rows)
            .flat_map(|(square, y)| (0..size[0]).step_by(side).map(move |x| part(square, x, y)));
        parts.filter(|part| part.corner.iter().all(|&texel| texel < self.layout.size)).collect()
    }

    /// The ray along the middle of a square of texels, from above all that has an end, with the light or against it.
    fn axis(&self, square: &Square, side: usize, toward: f64) -> Ray<f32> {
        let [x, y] = self.layout.place(square.corner.map(|texel| texel as f64 + 0.5 * side as f64));
        let [u, v, w] = self.layout.axes;
        let origin = add(add(scale(u, x), scale(v, y)), scale(w, self.layout.heights[1]));
        let narrow = |v: Vec3<f64>| v.map(|x| x as f32);
        Ray::new(narrow(origin), narrow(scale(w, toward)))
    }

    /// From the middle of a square of texels to the farthest of their rays, and a little to spare for rounding.
    fn radius(&self, side: usize) -> f32 {
        std::f32::consts::FRAC_1_SQRT_2 * (side - 1) as f32 * self.layout.texel as f32 + self.least()
    }

    /// The least step of a ray.
    fn least(&self) -> f32 {
        LEAST_STEP * self.layout.texel as f32
    }
}
