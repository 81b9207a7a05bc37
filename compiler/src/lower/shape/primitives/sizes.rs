//! Sizes that make no solid are refused where they are written.
//!
//! In: a primitive and its call. Out: E0407 at the first argument that is known to be negative; what a
//! param or the time sets is not known, and distances stay finite with it.

use super::Primitive;
use crate::ir::ValueId;
use crate::lower::{Lowered, Lowerer};
use vol_language::source::Span;

impl Primitive {
    /// Refuses sizes that are known to make no solid, at the argument of the call.
    pub(in crate::lower::shape) fn check_sizes(&self, lowerer: &Lowerer<'_>, span: Span) -> Lowered<()> {
        if let Self::Ellipsoid { radii } = self {
            let place = lowerer.argument_span(0, span);
            return lowerer.refuse(
                radii,
                |x| x <= 0.0,
                "a radius of an ellipsoid must be more than 0",
                place,
            );
        }
        for (argument, sizes, what) in self.sizes() {
            let place = lowerer.argument_span(argument, span);
            lowerer.refuse(sizes, |x| x < 0.0, &format!("{what} must be at least 0"), place)?;
        }
        Ok(())
    }

    /// Sizes that are at least 0: which argument of the call they are, and what messages call them.
    fn sizes(&self) -> Vec<(usize, &[ValueId], &'static str)> {
        let one = std::slice::from_ref;
        match self {
            Self::Sphere { radius } | Self::InfiniteCylinder { radius } | Self::Octahedron { radius } => {
                vec![(0, one(radius), "a radius")]
            }
            Self::Capsule { radius, .. } => vec![(2, one(radius), "a radius")],
            Self::Box { half } => vec![(0, half, "a half extent")],
            Self::Cylinder { radius, half_height } => {
                vec![(0, one(radius), "a radius"), (1, one(half_height), "a half height")]
            }
            Self::Prism { radius, half_height, .. } => {
                vec![(1, one(radius), "a radius"), (2, one(half_height), "a half height")]
            }
            Self::Torus { major, minor } => vec![(0, one(major), "a radius"), (1, one(minor), "a radius")],
            Self::Cone { radius, half_height, top } => {
                let ends = [radius, top].map(one);
                vec![
                    (0, ends[0], "a radius"),
                    (1, one(half_height), "a half height"),
                    (2, ends[1], "a radius"),
                ]
            }
            Self::Pyramid { half, half_height } => {
                vec![(0, one(half), "a half extent"), (1, one(half_height), "a half height")]
            }
            // The thickness of a disk is twice its rim and is looked at before.
            Self::Disk { radius, .. } => vec![(0, one(radius), "a radius")],
            Self::Ellipsoid { .. } | Self::Plane { .. } | Self::Mandelbulb(_) => Vec::new(),
        }
    }
}
