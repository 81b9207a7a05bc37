//! Pictures with known answers, and what must not change a picture.

mod beams;
mod light_grids;
mod media;
mod reference;
mod same;
mod sampling;
mod solids;
pub(crate) mod support;
