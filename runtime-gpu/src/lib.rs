//! Renders a compiled program on the GPU through wgpu compute.

mod canary;
mod device;
mod dispatch;
mod error;
mod passthrough;
mod pipeline;
mod render;

pub use device::{Gpu, open};
pub use dispatch::{Buffer, MAX_GROUPS_PER_AXIS, groups_for};
pub use error::GpuError;
pub use pipeline::Kernel;
pub use render::{Renderer, evaluate};
