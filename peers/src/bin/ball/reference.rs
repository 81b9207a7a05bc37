//! What the picture should be: some of its pixels by hand, with steps so small that half of them change nothing
//! that matters here.

use crate::march::{Renderer, Shadows};
use crate::scene::SIZE;

/// Pixels of the reference; a third of them see the ball.
const PLACES: usize = 4096;

/// Steps along the rays from the eye and towards the light, scene units.
const STEP: f32 = 1.0 / 800.0;
const SHADOW_STEP: f32 = 1.0 / 400.0;

/// Radiance at some pixels.
pub(crate) struct Reference {
    /// Columns and rows.
    places: Vec<[u32; 2]>,
    radiance: Vec<f32>,
    /// By how much the last halving of the steps changed it: rms over rms.
    pub(crate) change: f64,
}

impl Reference {
    pub(crate) fn new(renderer: &Renderer) -> Self {
        let mut places = vol_runtime_cpu::spread_pixels(SIZE, PLACES);
        places.sort_unstable_by_key(|&[x, y]| (y, x));
        let coarse = renderer.pixels(&places, 2.0 * STEP, Shadows::March(2.0 * SHADOW_STEP));
        let radiance = renderer.pixels(&places, STEP, Shadows::March(SHADOW_STEP));
        let change = relative_rms(&coarse, &radiance);
        Self { places, radiance, change }
    }

    /// Root mean square of the reference itself.
    pub(crate) fn rms(&self) -> f64 {
        let squares: f64 = self.radiance.iter().map(|&right| f64::from(right).powi(2)).sum();
        (squares / self.radiance.len() as f64).sqrt()
    }

    /// Error of a picture: rms of the difference over the rms of the reference.
    pub(crate) fn error(&self, picture: &[f32]) -> f64 {
        let at = |&[x, y]: &[u32; 2]| picture[(y * SIZE[0] + x) as usize];
        relative_rms(&self.places.iter().map(at).collect::<Vec<_>>(), &self.radiance)
    }
}

fn relative_rms(found: &[f32], right: &[f32]) -> f64 {
    let (mut apart, mut whole) = (0.0_f64, 0.0_f64);
    for (&found, &right) in found.iter().zip(right) {
        apart += f64::from(found - right).powi(2);
        whole += f64::from(right).powi(2);
    }
    (apart / whole).sqrt()
}
