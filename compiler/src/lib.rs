//! From the typed scene to a program that the runtimes execute.
//!
//! ```text
//! hir::Scene ──lower──► ir::Module + plan = Program ──frame──► Frame ──► runtimes
//!                          │                  └──wgsl──► WGSL text
//!                          └──passes (fold, cse, dce), verified
//! ```
//!
//! This crate reads no files, prints nothing and never panics on a scene. WGSL leaves it only
//! after naga has accepted the text.

pub mod curve;
pub mod dropped;
pub mod error_bound;
pub mod export;

pub mod families;
pub mod frame;
pub mod ir;
pub mod library;
pub mod lints;
pub mod lower;
pub mod noise_table;
pub mod ops;
pub mod passes;
pub mod program;
pub mod reference;
pub mod skip;
pub mod tape;
pub mod wgsl;
