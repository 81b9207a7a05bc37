//! Points at which fields are compared.

use vol_compiler::frame::Aabb;

/// Half the edge of the box searched where a scene has no bounds, in scene units.
const UNBOUNDED: f32 = 10.0;

/// `count` points spread evenly over the bounds and a quarter of their size around them.
///
/// * method: the additive sequence of the plastic number's powers, in 64-bit integers, so that the
///   points are the same on every machine
/// * source: M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences" (2018)
#[must_use]
pub fn scatter(bounds: &Aabb, count: u32) -> Vec<[f32; 3]> {
    // 2^64 times 1/p, 1/p², 1/p³, where p is the real root of x⁴ = x + 1.
    const STEPS: [u64; 3] = [0xD1B5_4A32_D192_ED03, 0xABC9_8388_FB8F_AC03, 0x8CB9_2BA7_2F3D_8DD7];
    let ranges: [(f32, f32); 3] = std::array::from_fn(|axis| range(bounds.lo[axis], bounds.hi[axis]));
    let point = |i: u64| {
        std::array::from_fn(|axis| {
            let bits = STEPS[axis].wrapping_mul(i + 1) >> 40;
            let (from, to) = ranges[axis];
            from + (to - from) * (bits as f32 / (1_u32 << 24) as f32)
        })
    };
    (0..u64::from(count)).map(point).collect()
}

/// The part of an axis to search.
fn range(lo: f32, hi: f32) -> (f32, f32) {
    let (lo, hi) =
        (if lo.is_finite() { lo } else { -UNBOUNDED }, if hi.is_finite() { hi } else { UNBOUNDED });
    if lo > hi {
        return (-UNBOUNDED, UNBOUNDED);
    }
    let margin = 0.25 * (hi - lo).max(1e-3);
    (lo - margin, hi + margin)
}

#[cfg(test)]
mod tests {
    use super::scatter;
    use vol_compiler::frame::Aabb;

    #[test]
    fn points_fill_the_grown_box_evenly() {
        let bounds = Aabb { lo: [0.0, -1.0, 2.0], hi: [4.0, 1.0, f32::INFINITY] };
        let points = scatter(&bounds, 8000);
        let inside = |p: &[f32; 3], from: f32, to: f32| p[0] >= from && p[0] < to;
        assert!(
            points.iter().all(|p| inside(p, -1.0, 5.0) && p[1].abs() <= 1.5 && p[2] >= 0.0 && p[2] <= 12.0)
        );
        for eighth in 0..8_u8 {
            let from = -1.0 + 0.75 * f32::from(eighth);
            let share = points.iter().filter(|p| inside(p, from, from + 0.75)).count();
            assert!((950..1050).contains(&share), "{share}");
        }
    }

    #[test]
    fn a_scene_without_bounds_has_points_too() {
        let nothing = Aabb { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };
        assert!(scatter(&nothing, 10).iter().flatten().all(|x| x.abs() <= 15.0));
    }
}
