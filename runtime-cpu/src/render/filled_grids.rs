//! Grids of lights that were filled for earlier frames.
//!
//! A grid depends on the light, on the box around the media and on what is in it, but neither on the camera nor on
//! solids: while an eye moves through a scene that stands still it is filled once. How fine it should be is
//! chosen anew for every frame; what is kept here are the answers to "fill this grid".

use super::fields::Fields;
use super::grid_choice::MAX_WORDS;
use super::light_grid;
use super::scene::Scene;
use std::sync::Arc;
use vol_compiler::frame::{Frame, Inputs, LightGrid};
use vol_compiler::program::Program;
use vol_compiler::skip::Skip;

/// Filled grids, at most [`MAX_WORDS`] of them and one more, the one used last at the end.
#[derive(Debug, Default)]
pub struct FilledGrids {
    /// What all of them depend on.
    media: Inputs,
    grids: Vec<Filled>,
    reused: u64,
    /// Most bytes that were needed at a time, here and while a grid was filled.
    most_bytes: usize,
}

#[derive(Debug)]
struct Filled {
    /// See [`light_grid::recipe`].
    recipe: Vec<u32>,
    grid: Arc<LightGrid>,
    /// Functions evaluated for it.
    evaluations: u64,
}

impl FilledGrids {
    /// How many times a grid was there already.
    #[must_use]
    pub fn reused(&self) -> u64 {
        self.reused
    }

    /// Most bytes that grids took at a time: those kept here, in the frame, and the one being filled.
    #[must_use]
    pub(super) fn most_bytes(&self) -> usize {
        self.most_bytes
    }

    /// Forgets what is of no use for a frame.
    pub(super) fn begin(&mut self, program: &Program, frame: &Frame) {
        let media = Inputs::of_depths(program, frame);
        if media != self.media || !frame.skips.has(Skip::SameGrids) {
            self.grids.clear();
        }
        self.media = media;
    }

    /// [`light_grid::fill`] in a scene of the frame that was begun with.
    pub(super) fn fill<F: Fields<Real = f32>>(
        &mut self,
        layout: LightGrid,
        scene: &Scene<f32>,
        fields: impl Fn() -> F + Sync,
    ) -> Option<(Arc<LightGrid>, u64)> {
        let recipe = light_grid::recipe(&layout, scene.shadow_step, scene.quadrature)?;
        let known = self.grids.iter().position(|filled| filled.recipe == recipe);
        let filled = match known {
            Some(index) => {
                self.reused += 1;
                self.grids.remove(index)
            }
            None => {
                let (grid, evaluations) = light_grid::fill(layout, scene, fields)?;
                self.count_bytes(&grid);
                Filled { recipe, grid: Arc::new(grid), evaluations }
            }
        };
        let found = (Arc::clone(&filled.grid), filled.evaluations);
        self.grids.push(filled);
        // Those used longest ago go.
        let mut words = self.words();
        while words > MAX_WORDS && self.grids.len() > 1 {
            words -= self.grids.remove(0).grid.words();
        }
        Some(found)
    }

    /// Words of all grids that are kept.
    fn words(&self) -> usize {
        self.grids.iter().map(|filled| filled.grid.words()).sum()
    }

    /// Counts what was there while one more grid was filled, and a spline put through it. Those of the frame may be gone
    /// from here.
    fn count_bytes(&mut self, grid: &LightGrid) {
        let kept = 2 * size_of::<f32>() * self.words();
        let spline = if grid.most_words() > MAX_WORDS { 0 } else { light_grid::spline_bytes(grid) };
        self.most_bytes = self.most_bytes.max(kept + light_grid::filling_bytes(grid, grid.words()) + spline);
    }
}
