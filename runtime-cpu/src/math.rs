//! Kernels of the operations in f32: twins of `compiler/src/wgsl/*.wgsl`, with the same file
//! names, function names and step comments.

pub mod curve;
pub mod fun;
pub mod noise;
