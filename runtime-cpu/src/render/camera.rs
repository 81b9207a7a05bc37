//! Rays: through the picture, and against boxes.
//!
//! Twin: `compiler/src/wgsl/render/camera.wgsl`.

use super::scene::Scene;
use super::surface::EPSILON;
use crate::real::{Real, Vec3, add, dot, length, scale};

/// "Nowhere": farther than anything, and small enough that no product of two overflows f32. Boxes
/// end at 1e6 on each axis (`vol_compiler::wgsl::render::padded`), so rays end before this.
pub(crate) const FAR: f32 = 4.0e6;

/// A direction component below this is 0 for a box: over [`FAR`] it moves a point by 4e-6.
pub(super) const PARALLEL: f32 = 1e-12;

/// Half a line, from an origin along a unit direction, and how its samples of media lie.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ray<R> {
    /// Where it starts.
    pub(crate) origin: Vec3<R>,
    /// Unit direction.
    pub(crate) direction: Vec3<R>,
    /// How far its comb is moved along it: -1/2..1/2, in steps.
    pub(crate) shift: R,
}

impl<R: Real> Ray<R> {
    /// With its comb where it is usually.
    pub(crate) fn new(origin: Vec3<R>, direction: Vec3<R>) -> Self {
        Self { origin, direction, shift: R::ZERO }
    }

    /// The point at a distance from the origin.
    pub(crate) fn at(&self, t: R) -> Vec3<R> {
        add(self.origin, scale(self.direction, t))
    }
}

/// Part of a ray: from `entry` to `exit`, nothing if `entry > exit`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span<R> {
    /// Where it begins, at least 0.
    pub(crate) entry: R,
    /// Where it ends, at most [`FAR`].
    pub(crate) exit: R,
}

impl<R: Real> Span<R> {
    /// Whether any of the ray is in it.
    pub(crate) fn is_some(&self) -> bool {
        self.entry <= self.exit
    }

    /// A little longer than rounding can make it.
    pub(super) fn loosened(self) -> Self {
        let slack = R::from_f32(16.0 * EPSILON);
        Self { entry: self.entry - slack * self.entry, exit: self.exit + slack * self.exit }
    }
}

/// The ray through a place of the picture, in pixels from its upper left corner.
pub(crate) fn camera_ray<R: Real>(scene: &Scene<R>, place: [R; 2]) -> Ray<R> {
    let two = R::from_f32(2.0);
    let camera = &scene.camera;
    let u = (two * place[0]) / scene.size[0] - R::ONE;
    let v = R::ONE - (two * place[1]) / scene.size[1];
    let toward = add(add(camera.forward, scale(camera.right, u)), scale(camera.up, v));
    let size = length(toward);
    Ray::new(camera.origin, toward.map(|component| component / size))
}

/// Part of a ray inside a box; a box without volume may give nothing.
pub(crate) fn slab<R: Real>(ray: &Ray<R>, lo: Vec3<R>, hi: Vec3<R>) -> Span<R> {
    let far = R::from_f32(FAR);
    let mut span = Span { entry: R::ZERO, exit: far };
    for axis in 0..3 {
        // Where the ray crosses the two planes; along them it is between them always or never.
        let (o, d) = (ray.origin[axis], ray.direction[axis]);
        let parallel = d.abs() < R::from_f32(PARALLEL);
        let divisor = if parallel { R::ONE } else { d };
        let a = (lo[axis] - o) / divisor;
        let b = (hi[axis] - o) / divisor;
        let beside = (o < lo[axis]) | (o > hi[axis]);
        let near = if parallel { if beside { far } else { R::ZERO } } else { a.min(b) };
        let end = if parallel { if beside { -far } else { far } } else { a.max(b) };
        span.entry = span.entry.max(near);
        span.exit = span.exit.min(end);
    }
    span
}

/// Whether a point is in a box.
pub(crate) fn contains<R: Real>(lo: Vec3<R>, hi: Vec3<R>, point: Vec3<R>) -> bool {
    (0..3).all(|axis| lo[axis] <= point[axis] && point[axis] <= hi[axis])
}

/// Distance along the viewing axis.
pub(crate) fn depth<R: Real>(scene: &Scene<R>, ray: &Ray<R>, t: R) -> R {
    t * dot(ray.direction, scene.camera.forward)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray<f32> {
        Ray::new(origin, direction)
    }

    #[test]
    fn slab_along_an_axis() {
        let span = slab(&ray([-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), [-1.0; 3], [1.0; 3]);
        assert_eq!(span, Span { entry: 2.0, exit: 4.0 });
        let miss = slab(&ray([-3.0, 1.5, 0.0], [1.0, 0.0, 0.0]), [-1.0; 3], [1.0; 3]);
        assert!(!miss.is_some());
        let behind = slab(&ray([3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), [-1.0; 3], [1.0; 3]);
        assert!(!behind.is_some());
    }

    #[test]
    fn slab_from_inside_starts_at_the_eye() {
        let span = slab(&ray([0.0; 3], [0.6, -0.8, 0.0]), [-1.0; 3], [1.0; 3]);
        assert_eq!(span, Span { entry: 0.0, exit: 1.25 });
    }

    #[test]
    fn slab_of_a_huge_box_stays_finite() {
        for direction in [[0.0, 1.0, 0.0], [1e-30, 1.0, -0.0], [1e-11, 1.0, 1e-11]] {
            let span = slab(&ray([1.0, 2.0, 3.0], direction), [-1e6; 3], [1e6; 3]);
            assert!(span.entry == 0.0 && span.exit > 9e5 && span.exit <= FAR, "{span:?}");
        }
    }
}
