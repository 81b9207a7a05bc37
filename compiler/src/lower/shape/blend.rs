//! How the surfaces of two solids meet: sharp, or rounded, bevelled or stepped over a width.
//!
//! With `overlap = max(width - |a - b|, 0)` the union is `min(a, b) - bulge(overlap)` and the
//! intersection `max(a, b) + bulge(overlap)`. The bulge never grows faster than the overlap does, so
//! that the result is as steep as the steeper of both (for steps it is locally one of both, moved).

use super::{Lowered, Shape};
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::lower::Lowerer;
use crate::ops::Op;
use std::rc::Rc;

/// How two surfaces meet; a width is how far from the edge of two faces at a right angle the blend
/// reaches along each.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Blend {
    /// An edge.
    Sharp,
    /// `overlap^2 / (4 width)`
    Smooth(ValueId),
    /// `overlap / 2`: flat.
    Chamfer(ValueId),
    /// A number of steps of equal size: `(overlap - distance to the nearest even step) / 2`.
    Steps(ValueId, u32),
}

impl Blend {
    /// `min`, blended.
    pub(super) fn union(self, graph: &mut Graph, a: ValueId, b: ValueId) -> ValueId {
        let sharp = graph.min(a, b);
        self.bulge(graph, a, b).map_or(sharp, |bulge| graph.sub(sharp, bulge))
    }

    /// `max`, blended.
    pub(super) fn intersection(self, graph: &mut Graph, a: ValueId, b: ValueId) -> ValueId {
        let sharp = graph.max(a, b);
        self.bulge(graph, a, b).map_or(sharp, |bulge| graph.add(sharp, bulge))
    }

    fn bulge(self, graph: &mut Graph, a: ValueId, b: ValueId) -> Option<ValueId> {
        let (zero, half) = (graph.number(0.0), graph.number(0.5));
        let width = self.width()?;
        // A width that a param turns to 0 must not divide by it.
        let least = graph.number(1e-6);
        let width = graph.max(width, least);
        let apart = graph.sub(a, b);
        let apart = graph.apply(Op::Abs, &[apart]);
        let overlap = graph.sub(width, apart);
        let overlap = graph.max(overlap, zero);
        Some(match self {
            Self::Sharp => return None,
            Self::Smooth(_) => {
                let squared = graph.mul(overlap, overlap);
                let quarter = graph.number(0.25);
                let divisor = graph.div(quarter, width);
                graph.mul(squared, divisor)
            }
            Self::Chamfer(_) => graph.mul(overlap, half),
            Self::Steps(_, count) => {
                // Edges that stand out are two steps of overlap apart, the first at 0.
                let steps = graph.number(0.5 * f64::from(count + 1));
                let pair = graph.div(width, steps);
                let place = graph.div(overlap, pair);
                let nearest = graph.add(place, half);
                let nearest = graph.apply(Op::Floor, &[nearest]);
                let off = graph.sub(place, nearest);
                let off = graph.apply(Op::Abs, &[off]);
                let off = graph.mul(off, pair);
                let rest = graph.sub(overlap, off);
                graph.mul(rest, half)
            }
        })
    }

    /// The width, unless sharp.
    pub(super) fn width(self) -> Option<ValueId> {
        match self {
            Self::Sharp => None,
            Self::Smooth(width) | Self::Chamfer(width) | Self::Steps(width, _) => Some(width),
        }
    }

    /// By how many widths the union of `count` solids reaches beyond them at most: each further solid
    /// that is as near adds the bulge of what the bulges so far have left of the width.
    pub(super) fn reach(self, count: usize) -> f64 {
        let add = |reach: f64| {
            let overlap = 1.0 - reach;
            match self {
                Self::Sharp => reach,
                Self::Smooth(_) => reach + 0.25 * overlap * overlap,
                Self::Chamfer(_) | Self::Steps(..) => reach + 0.5 * overlap,
            }
        };
        (1..count).fold(0.0, |reach, _| add(reach))
    }
}

/// A list of shapes joined from the left.
pub(super) fn fold(
    lowerer: &mut Lowerer<'_>,
    shapes: &[Rc<Shape>],
    p: [ValueId; 3],
    join: impl Fn(&mut Graph, ValueId, ValueId) -> ValueId,
) -> Lowered<ValueId> {
    let mut result = None;
    for shape in shapes {
        let distance = shape.distance(lowerer, p)?;
        result = Some(result.map_or(distance, |before| join(&mut lowerer.graph, before, distance)));
    }
    // The union of nothing is nowhere.
    Ok(result.unwrap_or_else(|| lowerer.graph.number(1e6)))
}
