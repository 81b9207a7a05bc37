//! Which operators need distances that change no faster than the position.
//!
//! A number that nothing of the solid is nearer than, such as that of a Mandelbulb, can be marched, cut,
//! moved and bent. To grow a solid by a length, or to blend two over one, makes another level of the number
//! the surface, and how far that is only the slope tells.

use super::primitives::Primitive;
use super::{Kind, Lowered};
use vol_language::diag::Diagnostic;
use vol_language::source::Span;

impl Kind {
    /// Whether the distance is known to change no faster than its extent says.
    pub(super) fn is_steady(&self) -> bool {
        let fractal = matches!(self, Self::Primitive(Primitive::Mandelbulb(_)));
        !fractal && self.children().iter().all(|child| child.steady)
    }

    /// Refuses what needs a steady distance of a solid that has none.
    pub(super) fn check_steady(&self, span: Span) -> Lowered<()> {
        let what = match self {
            Self::Rounded { .. } => Some("rounded"),
            Self::Shell { .. } => Some("made a shell"),
            Self::Displaced { .. } => Some("displaced"),
            Self::Union { blend, .. } | Self::Intersection { blend, .. } | Self::Difference { blend, .. } => {
                blend.width().map(|_| "blended")
            }
            Self::Primitive(_)
            | Self::Tube(_)
            | Self::Implicit { .. }
            | Self::Transformed { .. }
            | Self::Repeated { .. } => None,
        };
        let Some(what) = what.filter(|_| !self.is_steady()) else { return Ok(()) };
        let message = format!("a Mandelbulb cannot be {what}: the surface could not be marched safely");
        let label = "the slope of its distance has no bound";
        let help = "make it thicker by its `detail`, or join it with `|`, `&` or `-`";
        Err(Box::new(Diagnostic::error("E0501", message, span, label).with_help(help)))
    }
}
