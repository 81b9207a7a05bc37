//! Renders a compiled program on the CPU.
//!
//! ```text
//! Program ──interp::Tapes──► Evaluator (batches of points, f32)  ┐
//!    └──────reference::evaluate (one point, f64)                 ┴─► render: tiles ─► rays ─► Image
//! ```
//!
//! * [`interp`] evaluates the program's functions for many points at once, with the kernels of
//!   [`math`].
//! * [`mod@render`] is the integrator: what a picture means. Its twin for the GPU is
//!   `compiler/src/wgsl/render.wgsl` with its folder: same function names, same step comments.
//!
//! A picture does not depend on the number of threads, the order of the tiles or the sizes of the
//! batches: bit for bit.

pub mod interp;
mod isa;
pub mod math;
mod real;
pub mod render;
pub mod style;

pub use isa::Isa;
pub use render::{
    Choice, FilledGrids, FunctionCost, GridChoice, Method, NoMajorant, PartCost, PixelCost, Profile, Stats,
    StepChoice, TubeBounds, choose, choose_light_grids, choose_step, choose_with, fixed_step_default,
    least_step, memory_bound, profile, reference_pixels, render, render_by, render_costs, render_reference,
    spread_pixels,
};
