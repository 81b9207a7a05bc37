//! From rays to a picture: tiles, threads, pixels.
//!
//! Every pixel is computed from its own rays alone, so tiles may be done in any order, by any
//! number of threads.

use super::Stats;
use super::camera::{FAR, Ray, depth};
use super::fields::Fields;
use super::sampling::Mean;
use super::scene::{Batches, Integrator, Scene};
use crate::real::{Real, Vec3, add, length, mul, splat, sub};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use vol_compiler::frame::Job;

/// Width and height of a tile in pixels; a tile is one unit of work.
const TILE: u32 = 16;

/// 1 / sqrt(3): from the length of a colour to its rms over the channels.
const ROOT_THIRD: f32 = 0.577_350_3;

/// What a camera ray brings back, or the mean of several.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Radiance<R> {
    /// Radiance, background included.
    pub(crate) color: Vec3<R>,
    /// Fraction of the background that arrives.
    pub(crate) transmittance: Vec3<R>,
    /// Distance of the first surface along the viewing axis.
    pub(crate) depth: Option<R>,
    /// How far the colour is from the one by every other node of the media, rms over the channels; see
    /// [`super::medium`].
    pub(crate) doubt: R,
}

/// Part of the picture, in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tile {
    pub(super) x: u32,
    pub(super) y: u32,
    width: u32,
    height: u32,
}

impl Tile {
    /// Its pixels, row by row.
    pub(super) fn pixels(self) -> impl Iterator<Item = [u32; 2]> {
        (0..self.height)
            .flat_map(move |row| (0..self.width).map(move |column| [self.x + column, self.y + row]))
    }
}

impl<F: Fields> Integrator<'_, F> {
    /// Follows camera rays.
    pub(crate) fn radiance(&mut self, rays: &[Ray<F::Real>]) -> Vec<Radiance<F::Real>> {
        self.stats.rays += rays.len() as u64;
        rays.chunks(self.batches.rays).flat_map(|batch| self.batch_radiance(batch)).collect()
    }

    fn batch_radiance(&mut self, rays: &[Ray<F::Real>]) -> Vec<Radiance<F::Real>> {
        // Find what is behind the media: surfaces, else the background.
        let zero = splat(F::Real::ZERO);
        let mut behind: Vec<_> = rays.iter().map(|_| (self.scene.background, None)).collect();
        let mut ends = vec![F::Real::from_f32(FAR); rays.len()];
        let contacts = self.trace(rays);
        let colors = self.shade(rays, &contacts);
        for (contact, color) in contacts.iter().zip(colors) {
            behind[contact.ray] = (color, Some(depth(self.scene, &rays[contact.ray], contact.t)));
            ends[contact.ray] = contact.t;
        }
        // Look at it through the media.
        let glows = self.through(rays, &ends);
        let mut pixels = Vec::with_capacity(rays.len());
        for (glow, (color, depth)) in glows.into_iter().zip(behind) {
            let coarse = add(glow.coarse_light, mul(glow.coarse_transmittance, color));
            let color = add(glow.light, mul(glow.transmittance, color));
            pixels.push(Radiance {
                color,
                doubt: length(sub(coarse, color)) * F::Real::from_f32(ROOT_THIRD),
                transmittance: if depth.is_some() { zero } else { glow.transmittance },
                depth,
            });
        }
        pixels
    }
}

/// Who is told, and who may stop a render.
pub(crate) struct Watch<'a> {
    /// Called with the number of pixels done so far.
    pub(crate) progress: &'a (dyn Fn(u64) + Sync),
    /// Stops the render when set.
    pub(crate) cancelled: &'a AtomicBool,
}

/// Renders a picture; `fields` makes an evaluator for a thread. Nothing if cancelled.
pub(crate) fn expose<F: Fields>(
    scene: &Scene<F::Real>,
    job: &Job,
    batches: Batches,
    fields: &(dyn Fn() -> F + Sync),
    watch: &Watch<'_>,
) -> Option<(Vec<Radiance<F::Real>>, Stats)> {
    let finished = over_tiles(job.size, watch, |tile| {
        let mut integrator = Integrator::new(scene, fields(), batches);
        let pixels: Vec<_> = tile.pixels().collect();
        let means = integrator.sample_pixels(&pixels, &job.sampling, watch.cancelled)?;
        integrator.stats.variance += means.iter().map(Mean::variance).sum::<f64>();
        Some((tile, means.iter().map(Mean::radiance).collect(), integrator.stats))
    })?;
    let dark = Radiance {
        color: splat(F::Real::ZERO),
        transmittance: splat(F::Real::ZERO),
        depth: None,
        doubt: F::Real::ZERO,
    };
    Some(assemble(job.size, dark, finished))
}

/// What `work` makes of each tile of a picture, on many threads. Nothing if cancelled.
pub(super) fn over_tiles<T: Send>(
    size: [u32; 2],
    watch: &Watch<'_>,
    work: impl Fn(Tile) -> Option<T> + Sync,
) -> Option<Vec<T>> {
    let done = AtomicU64::new(0);
    let watched = |tile: Tile| {
        if watch.cancelled.load(Ordering::Relaxed) {
            return None;
        }
        let made = work(tile)?;
        let pixels = u64::from(tile.width) * u64::from(tile.height);
        let before = done.fetch_add(pixels, Ordering::Relaxed);
        (watch.progress)(before + pixels);
        Some(made)
    };
    tiles(size).into_par_iter().map(watched).collect()
}

/// Cuts a picture into tiles, rows from the top.
fn tiles([width, height]: [u32; 2]) -> Vec<Tile> {
    let edges =
        |size: u32| (0..size).step_by(TILE as usize).map(move |start| (start, TILE.min(size - start)));
    let tile = |(y, height)| edges(width).map(move |(x, width)| Tile { x, y, width, height });
    edges(height).flat_map(tile).collect()
}

/// Puts the tiles in their places.
pub(super) fn assemble<T: Copy>(
    [width, height]: [u32; 2],
    blank: T,
    tiles: Vec<(Tile, Vec<T>, Stats)>,
) -> (Vec<T>, Stats) {
    let mut picture = vec![blank; width as usize * height as usize];
    let mut stats = Stats::default();
    for (tile, pixels, own) in tiles {
        stats.add(&own);
        for ([x, y], pixel) in tile.pixels().zip(pixels) {
            picture[y as usize * width as usize + x as usize] = pixel;
        }
    }
    (picture, stats)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_every_pixel_once() {
        let mut count = vec![0; 37 * 19];
        for tile in tiles([37, 19]) {
            tile.pixels().for_each(|[x, y]| count[(y * 37 + x) as usize] += 1);
        }
        assert!(count.iter().all(|&c| c == 1));
    }
}
