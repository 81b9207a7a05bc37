//! What a style makes of a light in one frame: tables that both backends read.
//!
//! `runtime-cpu/src/style` computes them once per frame; what the integrators do with them is told in
//! `runtime-cpu/src/render/styled.rs`.

use super::Aabb;
use crate::ir::FunctionId;
use vol_language::diag::Diagnostic;
use vol_language::source::Span;

/// Width and height of a transfer function.
pub const TRANSFER_SIZE: u32 = 256;

/// A light with a style.
#[derive(Clone, Debug, PartialEq)]
pub struct StyledLight {
    /// Unit vector towards the light.
    pub toward: [f32; 3],
    /// The box around all media that the light reaches: rays are averaged in it.
    pub bounds: Aabb,
    /// What hides the light from them.
    pub occluders: Occluders,
    /// Colour instead of visibility.
    pub transfer: Option<TransferTable>,
    /// Colour of the light across its direction.
    pub light_map: Option<LightMapTable>,
    /// Variation along rays.
    pub heterogeneity: Option<HeterogeneityTable>,
}

/// What hides a light from media.
#[derive(Clone, Debug, PartialEq)]
pub enum Occluders {
    /// Nothing.
    None,
    /// Solids, by a table.
    Slices(Slices),
    /// Solids themselves.
    Marched,
}

/// Epipolar slices: half planes that begin at the line through the eye along the light.
///
/// A point at `x` from that line and `z` towards the light from the eye has the slope `z / x`, and so has all of a
/// ray from the eye. It is lit where its slope is at least the [`slope`](Self::slopes) of what the light meets first
/// there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Slices {
    /// Unit vectors across the light, and towards it.
    pub axes: [[f32; 3]; 3],
    /// Angle about the line at which the first slice begins, in -pi..pi.
    pub first_angle: f32,
    /// Slices per radian.
    pub per_radian: f32,
    /// Slices.
    pub rows: u32,
    /// Distance from the line at which each slice begins; 0 if the eye is above or below the map.
    pub first_distance: f32,
    /// Texels per scene unit along a slice.
    pub per_unit: f32,
    /// Texels of a slice.
    pub columns: u32,
    /// Largest slope of solids at the middle of each texel, slice by slice; [`NO_SLOPE`](Self::NO_SLOPE) where
    /// there are none.
    pub slopes: Vec<f32>,
}

impl Slices {
    /// Below every slope: nothing hides the light.
    pub const NO_SLOPE: f32 = -1e30;
}

/// A transfer function.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferTable {
    /// Depth along the viewing axis that is 0.
    pub near: f32,
    /// Over that it rises by this per scene unit; rays that meet nothing have 1.
    pub per_unit: f32,
    /// Colours, [`TRANSFER_SIZE`] x [`TRANSFER_SIZE`]: average visibility runs fastest.
    pub texels: Vec<[f32; 3]>,
}

/// A light map.
#[derive(Clone, Debug, PartialEq)]
pub struct LightMapTable {
    /// A point `p` is at texel `(p - origin).axes`; texel (0, 0) is the middle of the first.
    pub origin: [f32; 3],
    /// Across the light, per texel.
    pub axes: [[f32; 3]; 2],
    /// Width and height.
    pub size: u32,
    /// Factors of the light's colour, rows from the origin; beyond the border those of the border.
    pub texels: Vec<[f32; 3]>,
}

/// Variation along rays.
#[derive(Clone, Debug, PartialEq)]
pub struct HeterogeneityTable {
    /// Position to factor: 3 inputs, 1 output.
    pub field: FunctionId,
    /// Samples along a ray.
    pub steps: u32,
    /// Means that are known; else each ray has its own.
    pub means: Option<Means>,
}

/// Mean factors of the rays through some pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Means {
    /// Pixels from one to the next, across and down.
    pub spacing: u32,
    /// How many across and down.
    pub counts: [u32; 2],
    /// Mean factor, and depth of the first surface along the viewing axis (1e30 where there is none), rows from the top.
    pub texels: Vec<[f32; 2]>,
}

/// Two styles of one light are on.
pub(super) fn two_styles(light: &str, first: Span, second: Span) -> Diagnostic {
    let message = format!("two styles of the light `{light}` are on");
    Diagnostic::error("E0506", message, second, "this is the second")
        .with_label(first, "this is the first")
        .with_help("switch one of them off with the key `when`")
}

/// A stroke of a light map that touches no pixel.
#[must_use]
pub fn stroke_outside(stroke: Span, [width, height]: [u32; 2]) -> Diagnostic {
    let message = "a stroke of a light map is outside of the picture";
    let label = format!("touches no pixel of {width} by {height}");
    let help =
        "pixels are counted from the upper left corner of a picture of the size that the render block says";
    Diagnostic::error("E0507", message, stroke, label).with_help(help)
}
