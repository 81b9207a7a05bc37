//! How much cloud there is at a point.
//!
//! * source: C. Robles et al., "Procedural Rendering with Ray Marching" (2022), sections 2.3.2 and 4.3; there a
//!   fixed number of steps is marched below the surface, here the cloud is a medium, whose integral has an error that is chosen

use super::optics;
use super::value::{Closure, LocalPoint, Value};
use super::{Lowered, Lowerer};
use crate::ir::ValueId;
use crate::library::noise;
use std::f64::consts::TAU;
use std::rc::Rc;
use vol_language::hir::LocalField;
use vol_language::source::Span;

/// The noise of a cloud.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Pattern {
    /// `(1 + fbm) / 2`, held in 0..1.
    Perlin,
    /// Gardner's function with waves of length 1, 0..1.
    Gardner,
}

/// A cloud texture; its colour is a function of the local point.
#[derive(Clone, Debug)]
pub(crate) struct Cloud {
    pub(crate) color: Rc<Closure>,
    pub(crate) pattern: Pattern,
    /// Cells or waves per scene unit.
    pub(crate) frequency: ValueId,
    /// Octaves, or sines of Gardner's sums.
    pub(crate) octaves: u32,
    /// Texture value below which there is no cloud.
    pub(crate) cutoff: ValueId,
    /// Added to the position.
    pub(crate) offset: [ValueId; 3],
    /// Known at compile time.
    pub(crate) seed: ValueId,
}

impl Cloud {
    /// `max(0, T - cutoff) / (1 - cutoff)` at a local point, 0..1.
    pub(crate) fn amount(
        &self,
        lowerer: &mut Lowerer<'_>,
        point: &LocalPoint,
        span: Span,
    ) -> Lowered<ValueId> {
        let texture = self.texture(lowerer, point, span)?;
        let graph = &mut lowerer.graph;
        let (zero, one) = (graph.number(0.0), graph.number(1.0));
        let over = graph.sub(texture, self.cutoff);
        let over = graph.max(over, zero);
        let range = graph.sub(one, self.cutoff);
        // A cutoff of 1 or more leaves nothing: the texture is at most 1.
        let least = graph.number(1e-6);
        let range = graph.max(range, least);
        let amount = graph.div(over, range);
        Ok(graph.min(amount, one))
    }

    /// The texture value T, 0..1.
    fn texture(&self, lowerer: &mut Lowerer<'_>, point: &LocalPoint, span: Span) -> Lowered<ValueId> {
        let local = point.region.local_field(lowerer, point.world, LocalField::Local, span)?;
        let graph = &mut lowerer.graph;
        let scale = match self.pattern {
            Pattern::Perlin => self.frequency,
            Pattern::Gardner => {
                let turn = graph.number(TAU);
                graph.mul(turn, self.frequency)
            }
        };
        let place = [0, 1, 2].map(|axis| {
            let moved = graph.add(local[axis], self.offset[axis]);
            graph.mul(scale, moved)
        });
        let place = Value::Numbers(place.to_vec());
        let number =
            |lowerer: &mut Lowerer<'_>, number: f64| Value::Numbers(vec![lowerer.graph.number(number)]);
        let octaves = number(lowerer, f64::from(self.octaves));
        let seed = Value::Numbers(vec![self.seed]);
        match self.pattern {
            Pattern::Gardner => {
                let contrast = number(lowerer, 1.0);
                Ok(noise::gardner(lowerer, span, &[place, octaves, contrast, seed])?.scalar())
            }
            Pattern::Perlin => {
                let (lacunarity, gain) = (number(lowerer, 2.0), number(lowerer, 0.5));
                let sum = noise::fbm(lowerer, span, &[place, octaves, lacunarity, gain, seed])?.scalar();
                let graph = &mut lowerer.graph;
                let (zero, half, one) = (graph.number(0.0), graph.number(0.5), graph.number(1.0));
                let scaled = graph.mul(half, sum);
                let texture = graph.add(half, scaled);
                let texture = graph.max(texture, zero);
                Ok(graph.min(texture, one))
            }
        }
    }

    /// The colour over another, by the amount.
    pub(crate) fn over(
        &self,
        lowerer: &mut Lowerer<'_>,
        behind: &Closure,
        point: &Rc<LocalPoint>,
        span: Span,
    ) -> Lowered<[ValueId; 3]> {
        let amount = self.amount(lowerer, point, span)?;
        let color = optics::color(lowerer, &self.color, point)?;
        let behind = optics::color(lowerer, behind, point)?;
        let graph = &mut lowerer.graph;
        Ok([0, 1, 2].map(|i| {
            let gap = graph.sub(color[i], behind[i]);
            let part = graph.mul(amount, gap);
            graph.add(behind[i], part)
        }))
    }
}
