//! Many copies of a solid at the price of few: along axes and around one.
//!
//! A point asks the copies of the cells around it. The nearest copy is among the two whose centres are
//! on both sides of the point as long as the solid stays within its cell; where it may reach over by
//! `overlap` cells, so many more are asked on each side. The extent refuses solids that reach further.

use super::transform::turned_back;
use super::{Lowered, Shape};
use crate::ir::ValueId;
use crate::ir::graph::Graph;
use crate::lower::Lowerer;
use crate::ops::Op;
use crate::ops::range::Range;
use crate::program::{Extent, Run};
use std::f64::consts::TAU;
use vol_language::source::Span;

/// Copies: a lower bound of the distance, exact if the child is and stays within its cell.
#[derive(Clone, Debug)]
pub(crate) enum Copies {
    /// Along the axes, `None` where there is one only.
    Along { axes: [Option<Row>; 3], overlap: u32 },
    /// Around the y axis, the first as the child is.
    Around { count: u32, overlap: u32 },
}

/// Copies along an axis, centred at the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    /// From copy to copy; positive.
    pub(crate) period: ValueId,
    /// How many; 0 without end.
    pub(crate) count: u32,
    /// Whether the child is its own mirror image, so that the own cell alone may be asked.
    pub(crate) symmetric: bool,
}

impl Copies {
    /// How many copies a point asks.
    pub(super) fn asked(&self) -> u32 {
        match self {
            Self::Along { axes, overlap } => {
                let rows = axes.iter().flatten();
                rows.map(|row| row.asked(*overlap)).fold(1, u32::saturating_mul)
            }
            Self::Around { count, overlap } => neighbours(*overlap).min(*count),
        }
    }

    /// The point in the coordinates of each copy that it asks.
    pub(super) fn to_child(&self, graph: &mut Graph, p: [ValueId; 3]) -> Vec<[ValueId; 3]> {
        match self {
            Self::Along { axes, overlap } => {
                let mut places = vec![p];
                for (axis, row) in axes.iter().enumerate() {
                    let Some(row) = row else { continue };
                    let along = row.to_child(graph, p[axis], *overlap);
                    let at = |place: [ValueId; 3], x| [0, 1, 2].map(|i| if i == axis { x } else { place[i] });
                    places = along.iter().flat_map(|&x| places.iter().map(move |&q| at(q, x))).collect();
                }
                places
            }
            Self::Around { count, overlap } => around(graph, p, *count, *overlap),
        }
    }

    /// Where copies are asked for positions in a box, in their own coordinates: up to so many periods off,
    /// or as far off as the position where there are no more copies.
    pub(super) fn reach(&self, graph: &mut Graph, place: [Range; 3]) -> [Range; 3] {
        match self {
            Self::Along { axes, overlap } => [0, 1, 2].map(|axis| {
                let Some(row) = axes[axis] else { return place[axis] };
                let cells = graph.number(f64::from(1 + overlap));
                let within = graph.mul(row.period, cells);
                let beyond = place[axis].magnitude(graph);
                let reach = if row.count == 0 { within } else { graph.max(within, beyond) };
                Range::symmetric(graph, reach)
            }),
            Self::Around { .. } => {
                let sides = [place[0], place[2]].map(|range| range.magnitude(graph));
                let reach = graph.length(&sides);
                let across = Range::symmetric(graph, reach);
                [across, place[1], across]
            }
        }
    }

    /// The point in the coordinates of the nearest copy, and the distance.
    pub(super) fn nearest(
        &self,
        lowerer: &mut Lowerer<'_>,
        child: &Shape,
        p: [ValueId; 3],
    ) -> Lowered<([ValueId; 3], ValueId)> {
        let mut places = self.to_child(&mut lowerer.graph, p).into_iter();
        let mut place = places.next().unwrap_or(p);
        let mut least = child.distance(lowerer, place)?;
        for other in places {
            let distance = child.distance(lowerer, other)?;
            let graph = &mut lowerer.graph;
            let nearer = graph.apply(Op::Less, &[distance, least]);
            place = [0, 1, 2].map(|i| graph.select(nearer, other[i], place[i]));
            least = graph.min(distance, least);
        }
        Ok((place, least))
    }

    pub(super) fn extent(&self, lowerer: &mut Lowerer<'_>, child: &Shape, span: Span) -> Lowered<Extent> {
        let within = Box::new(child.extent(lowerer, span)?);
        match self {
            Self::Along { axes, overlap } => {
                let mut rows = [None; 3];
                for (row, axis) in rows.iter_mut().zip(axes) {
                    let Some(axis) = axis else { continue };
                    let period = lowerer.slot(axis.period, "a period", span)?;
                    *row = Some(Run { period, count: axis.count });
                }
                Ok(Extent::Repeated { child: within, axes: rows, overlap: *overlap, span })
            }
            Self::Around { count, overlap } => {
                Ok(Extent::Around { child: within, count: *count, overlap: *overlap, span })
            }
        }
    }
}

impl Row {
    fn asked(self, overlap: u32) -> u32 {
        let few = self.count > 0 && self.count <= neighbours(overlap);
        let own_cell = self.symmetric && overlap == 0;
        if few {
            self.count
        } else if own_cell {
            1
        } else {
            neighbours(overlap)
        }
    }

    /// The coordinate in each copy that is asked.
    fn to_child(self, graph: &mut Graph, x: ValueId, overlap: u32) -> Vec<ValueId> {
        let (zero, half) = (graph.number(0.0), graph.number(0.5));
        let least = graph.number(1e-6);
        let period = graph.max(self.period, least);
        let last = f64::from(self.count.max(1) - 1);
        let middle = graph.number(if self.count == 0 { 0.0 } else { 0.5 * last });
        let last = graph.number(last);
        let asked = self.asked(overlap);
        if asked == self.count {
            // Few enough to ask all of them.
            let places = (0..asked).map(|copy| {
                let copy = graph.number(f64::from(copy));
                let from_middle = graph.sub(copy, middle);
                let offset = graph.mul(from_middle, period);
                graph.sub(x, offset)
            });
            return places.collect();
        }
        let place = graph.div(x, period);
        let place = graph.add(place, middle);
        let place = if asked == 1 { graph.add(place, half) } else { place };
        let cell = graph.apply(Op::Floor, &[place]);
        let first = if asked == 1 { 0.0 } else { -f64::from(overlap) };
        let places = (0..asked).map(|i| {
            let step = graph.number(first + f64::from(i));
            let copy = graph.add(cell, step);
            let copy =
                if self.count == 0 { copy } else { super::primitives::clamped(graph, copy, zero, last) };
            let from_middle = graph.sub(copy, middle);
            let offset = graph.mul(from_middle, period);
            graph.sub(x, offset)
        });
        places.collect()
    }
}

/// The copies on both sides and `overlap` more on each.
fn neighbours(overlap: u32) -> u32 {
    overlap.saturating_mul(2).saturating_add(2)
}

/// The point turned into the sectors of the copies that it asks.
fn around(graph: &mut Graph, p: [ValueId; 3], count: u32, overlap: u32) -> Vec<[ValueId; 3]> {
    let sector = TAU / f64::from(count);
    let asked = neighbours(overlap).min(count);
    if asked == count {
        let places = (0..count).map(|copy| {
            let (sine, cosine) = (f64::from(copy) * sector).sin_cos();
            let (sine, cosine) = (graph.number(sine), graph.number(cosine));
            turned_back(graph, p, sine, cosine)
        });
        return places.collect();
    }
    // Copies follow one another from z to x, the angle is counted from x to z.
    let backwards = graph.apply(Op::Neg, &[p[2]]);
    let angle = graph.apply(Op::Atan2, &[backwards, p[0]]);
    let (sector, inverse) = (graph.number(sector), graph.number(1.0 / sector));
    let place = graph.mul(angle, inverse);
    let cell = graph.apply(Op::Floor, &[place]);
    let places = (0..asked).map(|i| {
        let step = graph.number(f64::from(i) - f64::from(overlap));
        let copy = graph.add(cell, step);
        let turn = graph.mul(copy, sector);
        let (sine, cosine) = (graph.apply(Op::Sin, &[turn]), graph.apply(Op::Cos, &[turn]));
        turned_back(graph, p, sine, cosine)
    });
    places.collect()
}
