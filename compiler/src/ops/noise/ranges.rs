//! Ranges of the noises: what holds of them everywhere.
//!
//! Tighter ones, by Taylor about the middle of the box, were tried: a ray then takes a third fewer steps
//! through displaced noise and four times as long, since each step asks all octaves twice.

use super::super::Op;
use super::super::range::{Range, product};
use super::OCTAVES;
use super::cells::FARTHEST;
use super::smooth::Smooth;
use crate::ir::ValueId;
use crate::ir::graph::{Graph, Repeated};

impl Smooth {
    /// Ranges of the value and of the partial derivatives.
    pub(super) fn ranges(&self, graph: &mut Graph) -> Vec<Range> {
        let value = Range::constant(graph, -self.largest, self.largest);
        let partial = Range::constant(graph, -self.steepest, self.steepest);
        [vec![value], vec![partial; self.dimensions]].concat()
    }
}

/// The distance of cellular noise and its partial derivatives.
pub(super) fn distance(graph: &mut Graph) -> Vec<Range> {
    let direction = Range::constant(graph, -1.0, 1.0);
    vec![Range::constant(graph, 0.0, FARTHEST), direction, direction, direction]
}

/// The random number of a cell: any, since the cell is not known.
pub(super) fn cell(graph: &mut Graph) -> Range {
    Range::constant(graph, 0.0, 1.0)
}

/// Sum of octaves and its partial derivatives: operands are x, y, z, the number of octaves, lacunarity and
/// gain, of which the latter three must be known. What is left is a loop that each frame runs once.
pub(super) fn octaves(graph: &mut Graph, noise: &Smooth, x: &[Range]) -> Option<Vec<Range>> {
    let settings = &x[3..];
    if !settings.iter().all(|setting| setting.is_point()) {
        return None;
    }
    let [count, lacunarity, gain] = [0, 1, 2].map(|i| settings[i].lo);
    // How many octaves are done, the factors of the next, the sums of those of value and slope.
    let state: Vec<ValueId> = (0..5).map(|_| graph.placeholder()).collect();
    let [done, amplitude, frequency, largest, steepest] = [0, 1, 2, 3, 4].map(|i| state[i]);
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    let following = graph.add(done, one);
    let steepness = graph.mul(amplitude, frequency);
    let [size, steepness] = [amplitude, steepness].map(|factor| graph.apply(Op::Abs, &[factor]));
    let next = [
        following,
        graph.mul(amplitude, gain),
        graph.mul(frequency, lacunarity),
        graph.add(largest, size),
        graph.add(steepest, steepness),
    ];
    let goes_on = graph.apply(Op::LessEqual, &[following, count]);
    let repeated = Repeated { state: &state, first: &[zero, one, one, zero, zero], next: &next, goes_on };
    let most = graph.constant(count).map_or(OCTAVES, |count| count.clamp(0.0, OCTAVES));
    let last = graph.repeat(most as u32, repeated);
    let octave = noise.ranges(graph);
    let sums = [last[3], last[4], last[4], last[4]];
    Some(sums.into_iter().zip(octave).map(|(sum, part)| product(graph, Range::point(sum), part)).collect())
}
