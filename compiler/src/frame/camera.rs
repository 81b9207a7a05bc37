//! The camera's picture plane from its settings.

use super::CameraFrame;
use super::extent::Box3;
use crate::program::style;
use glam::DVec3;

/// Camera settings of one frame.
pub(super) struct View {
    pub(super) from: Option<[f64; 3]>,
    pub(super) at: Option<[f64; 3]>,
    pub(super) up: [f64; 3],
    /// Vertical field of view in radians.
    pub(super) fov: f64,
    /// Width over height.
    pub(super) aspect: f64,
}

/// Room left around a scene that the default camera frames.
const MARGIN: f64 = 1.1;

/// A vector shorter than this has no direction.
const SHORT: f64 = 1e-12;

/// Eye and picture plane. A missing eye or target frames `bounds` along -z.
pub(super) fn camera(view: &View, bounds: Box3) -> CameraFrame {
    // A field of view outside (0, 180) degrees can only come from params: keep it drawable.
    let half_height = (0.5 * view.fov.clamp(1e-3, 3.1)).tan();
    let half_width = half_height * view.aspect;
    let (centre, radius) = sphere_around(bounds);
    let at = view.at.map_or(centre, DVec3::from);
    let narrow = half_height.min(half_width).atan();
    let from = view.from.map_or(at + DVec3::Z * (MARGIN * radius / narrow.sin()), DVec3::from);
    let forward = unit(at - from, DVec3::NEG_Z);
    // Looking along `up`: any direction across will do.
    let right = unit(forward.cross(view.up.into()), forward.any_orthonormal_vector());
    let up = right.cross(forward);
    CameraFrame {
        origin: super::round3(from.into()),
        forward: super::round3(forward.into()),
        right: super::round3((right * half_width).into()),
        up: super::round3((up * half_height).into()),
    }
}

impl CameraFrame {
    /// The camera of a view that strokes were painted in, for a picture of a size in pixels.
    #[must_use]
    pub fn of_view(view: &style::View<f64>, [width, height]: [u32; 2]) -> Self {
        let aspect = f64::from(width) / f64::from(height);
        let view = View { from: Some(view.from), at: Some(view.at), up: view.up, fov: view.fov, aspect };
        camera(&view, super::extent::EMPTY)
    }
}

/// `v` with length 1, or `fallback` where it has no direction.
pub(super) fn unit(v: DVec3, fallback: DVec3) -> DVec3 {
    if v.is_finite() && v.length() > SHORT { v.normalize() } else { fallback }
}

/// Centre and radius of the sphere around a box; the unit sphere for an empty box.
fn sphere_around(bounds: Box3) -> (DVec3, f64) {
    let (lo, hi) = (DVec3::from(bounds.lo), DVec3::from(bounds.hi));
    if lo.cmpgt(hi).any() {
        return (DVec3::ZERO, 1.0);
    }
    let radius = 0.5 * (hi - lo).length();
    (0.5 * (lo + hi), if radius > 1e-9 { radius } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(from: [f64; 3], at: [f64; 3]) -> View {
        View { from: Some(from), at: Some(at), up: [0.0, 1.0, 0.0], fov: 1.0, aspect: 2.0 }
    }

    const UNIT: Box3 = Box3 { lo: [-1.0; 3], hi: [1.0; 3] };

    #[test]
    fn axes_are_right_handed() {
        let camera = camera(&view([0.0, 0.0, 5.0], [0.0; 3]), UNIT);
        assert_eq!(camera.forward, [0.0, 0.0, -1.0]);
        assert!(camera.right[0] > 0.0 && camera.up[1] > 0.0);
        assert!((camera.right[0] / camera.up[1] - 2.0).abs() < 1e-6);
    }

    #[test]
    fn looking_along_up_still_has_a_plane() {
        let camera = camera(&view([0.0, 5.0, 0.0], [0.0; 3]), UNIT);
        let length = |v: [f32; 3]| v.iter().map(|c| c * c).sum::<f32>().sqrt();
        assert!(length(camera.right) > 0.1 && length(camera.up) > 0.1);
    }

    #[test]
    fn eye_on_its_target_looks_along_minus_z() {
        assert_eq!(camera(&view([1.0; 3], [1.0; 3]), UNIT).forward, [0.0, 0.0, -1.0]);
    }

    #[test]
    fn default_camera_sees_the_whole_scene() {
        let missing = View { from: None, at: None, up: [0.0, 1.0, 0.0], fov: 0.7, aspect: 0.5 };
        let camera = camera(&missing, UNIT);
        // The sphere around the box is within the narrow angle.
        let half_width = (0.5f64 * 0.7).tan() * 0.5;
        let sine = 3f64.sqrt() / f64::from(camera.origin[2]);
        assert!(sine < half_width.atan().sin());
    }
}
