//! Pictures written by hand with finer and finer steps: what each error takes.

use crate::light_grid::LightGrid;
use crate::march::{Renderer, Shadows};
use crate::reference::Reference;
use std::time::Instant;

/// Steps along the rays from the eye, scene units: the first, and each over the one before.
const FIRST_STEP: f32 = 0.08;
const FINER: f32 = std::f32::consts::FRAC_1_SQRT_2;

/// Most pictures of a ladder.
const MOST_RUNGS: i32 = 9;

/// How a picture learns what the light has lost.
#[derive(Clone, Copy)]
pub(crate) enum Way {
    /// Steps towards the light, so many times as long as those from the eye.
    March(f32),
    /// Points of a grid as far apart as so many steps from the eye.
    Grid(f32),
}

/// Pictures of one way, steps falling.
pub(crate) struct Ladder {
    way: Way,
    rungs: Vec<Rung>,
}

struct Rung {
    step: f32,
    error: f64,
    /// The least of all rounds.
    milliseconds: f64,
}

impl Way {
    /// The picture, with the grid that it takes.
    fn picture(self, renderer: &Renderer, step: f32) -> Vec<f32> {
        match self {
            Self::March(ratio) => renderer.picture(step, Shadows::March(ratio * step)),
            Self::Grid(ratio) => {
                let points = (2.0 / (ratio * step)).ceil() as usize + 1;
                let grid = LightGrid::new(renderer.simd, &renderer.noise, points);
                renderer.picture(step, Shadows::Grid(&grid))
            }
        }
    }
}

impl Ladder {
    /// Down to the first picture that is better than an error.
    pub(crate) fn new(renderer: &Renderer, reference: &Reference, way: Way, finest: f64) -> Self {
        let mut rungs: Vec<Rung> = Vec::new();
        for number in 0..MOST_RUNGS {
            let step = FIRST_STEP * FINER.powi(number);
            let error = reference.error(&way.picture(renderer, step));
            rungs.push(Rung { step, error, milliseconds: f64::INFINITY });
            if error < finest {
                break;
            }
        }
        Self { way, rungs }
    }

    /// Measures each picture once more.
    pub(crate) fn measure(&mut self, renderer: &Renderer) {
        for rung in &mut self.rungs {
            let started = Instant::now();
            std::hint::black_box(self.way.picture(renderer, rung.step));
            rung.milliseconds = rung.milliseconds.min(started.elapsed().as_secs_f64() * 1e3);
        }
    }

    /// Time at an error, in proportion between the logarithms of the two pictures around it; none if no picture is as
    /// good, or none as bad.
    pub(crate) fn milliseconds_at(&self, error: f64) -> Option<f64> {
        let around = self.rungs.windows(2).find(|pair| pair[0].error >= error && error > pair[1].error)?;
        let [coarse, fine] = [&around[0], &around[1]];
        let part = (coarse.error / error).ln() / (coarse.error / fine.error).ln();
        Some(coarse.milliseconds * (fine.milliseconds / coarse.milliseconds).powf(part))
    }
}
