//! Heights of what a distant light meets first, on a square map across it.
//!
//! The map covers what media and solids have in common as the light sees them: elsewhere nothing hides it from a
//! medium, unless solids are to grow. Each texel is one ray of the light through its middle
//! ([`super::trace`]).

use crate::real::{Vec3, dot, scale, vector};
use vol_compiler::frame::{Aabb, Frame, Image, LightFrame, Pixel};
use vol_compiler::wgsl::render::padded;

/// No solid.
pub(super) const NOTHING: f32 = f32::NEG_INFINITY;

/// A box that reaches further than this has no end.
const ENDLESS: f32 = 1e5;

/// Where the texels of a map are. Coordinates are `(u, v)` across the light and `w` towards it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    /// Unit vectors.
    pub(super) axes: [Vec3<f64>; 3],
    /// Corner of the map.
    pub(super) lo: [f64; 2],
    /// Side of a texel in scene units.
    pub(super) texel: f64,
    /// Texels along each side.
    pub(super) size: usize,
    /// Height above all bounded solids and media, and below all media.
    pub(super) heights: [f64; 2],
}

impl Layout {
    /// The map of a light; none where no solid can hide it from media in `lit`. Solids that may `grow` can hide it from any
    /// of these.
    pub(super) fn new(light: &LightFrame, frame: &Frame, lit: &Aabb, size: u32, grow: bool) -> Option<Self> {
        let axes = axes(light.position.map(f64::from));
        let solids: Vec<Aabb> = frame.objects.iter().filter_map(|object| padded(&object.bounds)).collect();
        let lit = bounded(lit, &frame.bounds);
        let [mut u, mut v, media] = extent(&axes, &lit);
        let mut top = media[1];
        let mut shadow = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for solid in &solids {
            if grow || is_endless(solid) {
                shadow = [u, v];
            }
            if is_endless(solid) {
                continue;
            }
            let [own_u, own_v, own_w] = extent(&axes, solid);
            // What is below all media hides nothing.
            if own_w[1] > media[0] && !grow {
                shadow = [joined(shadow[0], own_u), joined(shadow[1], own_v)];
            }
            top = top.max(own_w[1]);
        }
        u = [u[0].max(shadow[0][0]), u[1].min(shadow[0][1])];
        v = [v[0].max(shadow[1][0]), v[1].min(shadow[1][1])];
        let side = (u[1] - u[0]).max(v[1] - v[0]);
        if !(u[0] <= u[1] && v[0] <= v[1] && side > 0.0 && side.is_finite()) {
            return None;
        }
        // A texel more on each side, so that a shadow ends on the map.
        let texel = side / (f64::from(size) - 2.0);
        let half = 0.5 * texel * f64::from(size);
        let lo = [0.5 * (u[0] + u[1]) - half, 0.5 * (v[0] + v[1]) - half];
        let margin = 1e-3 * (top - media[0]).abs() + texel;
        Some(Self { axes, lo, texel, size: size as usize, heights: [media[0] - margin, top + margin] })
    }

    /// Coordinates of a point.
    pub(super) fn seen(&self, point: Vec3<f64>) -> Vec3<f64> {
        self.axes.map(|axis| dot(point, axis))
    }

    /// `(u, v)` of a place in texels from the corner.
    pub(super) fn place(&self, texels: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|axis| self.lo[axis] + texels[axis] * self.texel)
    }

    /// Index of the texel at `(u, v)`.
    pub(super) fn texel_at(&self, place: [f64; 2]) -> Option<usize> {
        let [x, y] = [0, 1].map(|axis| (place[axis] - self.lo[axis]) / self.texel);
        let size = self.size as f64;
        let inside = (0.0..size).contains(&x) && (0.0..size).contains(&y);
        inside.then(|| y as usize * self.size + x as usize)
    }

    /// Heights as a picture, the lowest of them dark.
    pub(super) fn image(&self, heights: &[f32]) -> Image {
        let there = heights.iter().copied().filter(|height| *height > NOTHING);
        let (lo, hi) = there.fold((f32::INFINITY, NOTHING), |(lo, hi), h| (lo.min(h), hi.max(h)));
        let length = if hi > lo { hi - lo } else { 1.0 };
        let level = |height: f32| if height > NOTHING { 0.1 + 0.9 * (height - lo) / length } else { 0.0 };
        let pixel =
            |&height: &f32| Pixel { color: [level(height); 3], depth: f32::INFINITY, ..Pixel::default() };
        // Up is where v is largest.
        let rows = heights.chunks(self.size).rev();
        let side = self.size as u32;
        Image { width: side, height: side, pixels: rows.flatten().map(pixel).collect() }
    }
}

/// Unit vectors across a light and towards it, and the corner and side of the square across it that a box fills.
pub(super) fn across(light: &LightFrame, bounds: &Aabb) -> ([Vec3<f64>; 3], [f64; 2], f64) {
    let axes = axes(light.position.map(f64::from));
    let [u, v, _] = extent(&axes, bounds);
    let side = (u[1] - u[0]).max(v[1] - v[0]).max(f64::from(f32::MIN_POSITIVE));
    let lo = [u, v].map(|[lo, hi]| 0.5 * (lo + hi) - 0.5 * side);
    (axes, lo, side)
}

/// Unit vectors across a direction and along it: `v` is up in the picture of a map, as far as up is across.
fn axes(toward: Vec3<f64>) -> [Vec3<f64>; 3] {
    let w = unit(toward);
    let up = if w[1].abs() < 0.9 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, -1.0] };
    let u = unit(cross(up, w));
    // As the shaders read them.
    [u, cross(w, u), w].map(|axis| axis.map(|x| f64::from(x as f32)))
}

fn unit(v: Vec3<f64>) -> Vec3<f64> {
    scale(v, 1.0 / dot(v, v).sqrt())
}

fn cross(a: Vec3<f64>, b: Vec3<f64>) -> Vec3<f64> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn is_endless(bounds: &Aabb) -> bool {
    bounds.lo.iter().chain(&bounds.hi).any(|x| x.abs() > ENDLESS)
}

/// A box that has an end: that of the whole scene where media have none.
pub(super) fn bounded(lit: &Aabb, scene: &Aabb) -> Aabb {
    if is_endless(lit) && scene.lo.iter().zip(&scene.hi).all(|(lo, hi)| lo <= hi) { *scene } else { *lit }
}

fn joined([lo, hi]: [f64; 2], [other_lo, other_hi]: [f64; 2]) -> [f64; 2] {
    [lo.min(other_lo), hi.max(other_hi)]
}

/// Smallest and largest coordinates of a box.
fn extent(axes: &[Vec3<f64>; 3], bounds: &Aabb) -> [[f64; 2]; 3] {
    let (lo, hi): (Vec3<f64>, Vec3<f64>) = (vector(bounds.lo), vector(bounds.hi));
    axes.map(|axis| {
        let ends = [0, 1, 2].map(|i| [axis[i] * lo[i], axis[i] * hi[i]]);
        let sum = |pick: fn(f64, f64) -> f64| ends.iter().map(|[a, b]| pick(*a, *b)).sum();
        [sum(f64::min), sum(f64::max)]
    })
}
