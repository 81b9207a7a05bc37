//! Sixteen points or directions at a time.
//!
//! Written out for each axis: the standard functions over arrays are not inlined by force, and calls for a
//! single instruction would be left.

use crate::lanes::Lanes;
use pulp::x86::V4;

/// Coordinates of sixteen points.
#[derive(Clone, Copy)]
pub(crate) struct Points {
    pub(crate) x: Lanes,
    pub(crate) y: Lanes,
    pub(crate) z: Lanes,
}

impl Points {
    /// The same point in all.
    #[inline(always)]
    pub(crate) fn splat(simd: V4, [x, y, z]: [f32; 3]) -> Self {
        Self { x: Lanes::splat(simd, x), y: Lanes::splat(simd, y), z: Lanes::splat(simd, z) }
    }

    /// `self * factor + term` in each coordinate, with the same factor and term in all lanes.
    #[inline(always)]
    pub(crate) fn scaled(self, factor: f32, term: f32) -> Self {
        Self {
            x: self.x.scaled(factor, term),
            y: self.y.scaled(factor, term),
            z: self.z.scaled(factor, term),
        }
    }

    /// Points so far along directions from others.
    #[inline(always)]
    pub(crate) fn ahead(self, direction: Self, distance: Lanes) -> Self {
        Self {
            x: direction.x.mul_add(distance, self.x),
            y: direction.y.mul_add(distance, self.y),
            z: direction.z.mul_add(distance, self.z),
        }
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> Lanes {
        self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z))
    }

    /// Each coordinate's largest whole number below.
    #[inline(always)]
    pub(crate) fn floor(self) -> Self {
        Self { x: self.x.floor(), y: self.y.floor(), z: self.z.floor() }
    }

    #[inline(always)]
    pub(crate) fn minus(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }
}
