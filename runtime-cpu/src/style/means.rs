//! Mean heterogeneity of a few rays, between which a picture looks it up: it varies less than what it multiplies.

use super::Stage;
use crate::render::{Batch, Batches, Integrator, Scene, camera_ray};
use rayon::prelude::*;
use vol_compiler::frame::styled::Means;
use vol_compiler::program::style::Heterogeneity;

/// The means of rays through the middles of squares of pixels.
pub(super) fn means(stage: &Stage<'_>, settings: Heterogeneity) -> Means {
    let spacing = settings.upsample;
    let counts = stage.job.size.map(|pixels| pixels.div_ceil(spacing));
    let scene = Scene::new(stage.frame, stage.job);
    let middle = |index: u32| (index as f32 + 0.5) * spacing as f32;
    let rows = (0..counts[1]).into_par_iter().map(|row| {
        let mut integrator = Integrator::new(&scene, Batch::new(stage.tapes, stage.frame), Batches::DEFAULT);
        let rays: Vec<_> =
            (0..counts[0]).map(|column| camera_ray(&scene, [middle(column), middle(row)])).collect();
        integrator.means_and_depths(settings.field, settings.steps, &stage.bounds, &rays)
    });
    let texels: Vec<Vec<[f32; 2]>> = rows.collect();
    Means { spacing, counts, texels: texels.into_iter().flatten().collect() }
}
