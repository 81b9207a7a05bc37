//! The scene by vol: compiled once, rendered as `vol render --max-error` does.

use crate::scene::{SIZE, TEXT};
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use vol_compiler::frame::{Frame, Sampling};
use vol_compiler::program::Program;
use vol_compiler::skip::Skips;
use vol_compiler::{library, lower};
use vol_language::module::NoFiles;
use vol_language::source::SourceFile;

/// The scene, ready to be rendered.
pub(crate) struct Vol {
    program: Program,
    frame: Frame,
}

/// A picture of vol's.
pub(crate) struct Rendered {
    /// Radiance in the first channel, rows from the top; the others are the same.
    pub(crate) picture: Vec<f32>,
    /// Time to choose steps and the grid of the light, milliseconds.
    pub(crate) choosing: f64,
}

impl Vol {
    pub(crate) fn new() -> Self {
        let library = library::library();
        let analysis = vol_language::analyse_with(SourceFile::new("ball.vol", TEXT), &library, &NoFiles);
        let scene = analysis.scene.expect("a scene without mistakes");
        let (program, _) = lower::compile_with(&scene, Skips::ALL);
        let program = program.expect("a scene that compiles");
        let frame = program.frame(&[], 0.0, 0.0, SIZE).expect("a frame");
        Self { program, frame }
    }

    /// The picture with at most this error, on the threads of the surrounding pool.
    pub(crate) fn render(&self, max_error: f32) -> Rendered {
        let started = Instant::now();
        let mut frame = self.frame.clone();
        let choice = vol_runtime_cpu::choose(&self.program, &mut frame, SIZE, Sampling::CENTRE, max_error);
        let choosing = started.elapsed().as_secs_f64() * 1e3;
        let never = AtomicBool::new(false);
        let rendered = vol_runtime_cpu::render(&self.program, &frame, &choice.job, None, &|_| {}, &never);
        let (image, _) = rendered.expect("not cancelled");
        Rendered { picture: image.pixels.iter().map(|pixel| pixel.color[0]).collect(), choosing }
    }
}
