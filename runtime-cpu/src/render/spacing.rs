//! How far apart the nodes of a ray are.
//!
//! A comb is counted in steps. Where all media that may be near are smooth one node stands for several of them: each medium has a
//! spacing ([`vol_compiler::frame::MediumFrame::spacing`]), a power of 2, and blocks as long as the widest one are divided by
//! the least spacing of the media that have a run in them; blocks without any are whole. A run of a medium is as far
//! from its inside as its own spacing, so that neighbours of nodes inside are never farther apart than that.
//!
//! Nodes are numbered without gaps, also where no medium is. Every node stands for the part of the ray from the middle of the
//! steps before it, so where spacings change nothing is counted twice and nothing is left out. Of second order, as the midpoint
//! rule is; errors that cancel along an even comb do not where spacings change.
//!
//! Twin: `compiler/src/wgsl/render/spacing.wgsl`.

use super::comb::NodeRange;
use crate::real::Real;
use vol_compiler::frame::MOST_SPACING;

/// Spacings that there are: 1, 2, 4 up to [`MOST_SPACING`].
const SPACINGS: usize = MOST_SPACING.ilog2() as usize + 1;

/// Runs of a medium, as many as shaders keep: where there are more they are joined, so that both backends divide alike.
#[derive(Clone, Copy, Debug)]
pub(super) struct Near([NodeRange; 4]);

impl Near {
    /// Joins ranges of steps, in the order of the medium's cells.
    pub(super) fn of(cells: &[(usize, NodeRange)]) -> Self {
        let none = NodeRange { first: i32::MAX, last: -1 };
        let mut runs = [none; 4];
        let mut cells = cells.to_vec();
        cells.sort_unstable_by_key(|&(cell, _)| cell);
        for (_, range) in cells.into_iter().filter(|(_, range)| !range.is_empty()) {
            let mut joined = range;
            for run in &mut runs {
                if run.first <= range.last + 2 && run.last >= range.first - 2 {
                    joined = joined.union(*run);
                    *run = none;
                }
            }
            let free = runs.iter().position(|run| run.is_empty()).unwrap_or(runs.len() - 1);
            runs[free] = runs[free].union(joined);
        }
        Self(runs)
    }
}

/// Nodes in a row that are as far apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part {
    /// Number of the first node.
    pub(super) number: i32,
    /// The step at which it begins.
    pub(super) start: i32,
    /// Steps from one node to the next.
    pub(super) spacing: i32,
}

/// A node for each step.
const EVEN: [Part; 1] = [Part { number: 0, start: 0, spacing: 1 }];

impl Part {
    /// The first step that a node stands for.
    #[inline(always)]
    pub(super) fn step_of(&self, node: i32) -> i32 {
        self.start + (node - self.number) * self.spacing
    }

    /// From the middle of the first step of a node to the middle of all, in steps.
    #[inline(always)]
    pub(super) fn middle<R: Real>(&self) -> R {
        R::from_f32(0.5) * R::from_index(self.spacing - 1)
    }
}

/// The parts of many rays.
#[derive(Default)]
pub(super) struct Parts {
    all: Vec<Part>,
    /// Where those of each ray end; of none if all are even.
    ends: Vec<usize>,
}

impl Parts {
    /// The parts of a ray, in order.
    #[inline(always)]
    pub(super) fn of(&self, ray: usize) -> &[Part] {
        match self.ends.get(ray) {
            Some(&end) => &self.all[ray.checked_sub(1).map_or(0, |before| self.ends[before])..end],
            None => &EVEN,
        }
    }

    /// The part that a node is in, and the number of the first node after it. Before the first part nodes are as in it.
    #[inline(always)]
    pub(super) fn around(&self, ray: usize, node: i32) -> (Part, i32) {
        let parts = self.of(ray);
        let after = parts.partition_point(|part| part.number <= node).max(1);
        (parts[after - 1], parts.get(after).map_or(i32::MAX, |part| part.number))
    }

    /// The node that stands for a step.
    pub(super) fn node_at(&self, ray: usize, step: i32) -> i32 {
        let parts = self.of(ray);
        let part = parts[parts.partition_point(|part| part.start <= step).max(1) - 1];
        part.number + (step - part.start) / part.spacing
    }

    /// Adds a ray, given the runs of the media that are finer than blocks of some steps, with their spacings.
    pub(super) fn push(&mut self, block: i32, near: impl Iterator<Item = (Near, i32)>) {
        // Go through the blocks where runs begin and end.
        let mut edges = Vec::new();
        for (Near(runs), spacing) in near {
            for run in runs.iter().filter(|run| !run.is_empty()) {
                edges.push((run.first / block, spacing, 1));
                edges.push((run.last / block + 1, spacing, -1));
            }
        }
        edges.sort_unstable();
        let start = self.all.len();
        let mut open = [0; SPACINGS];
        let mut edges = edges.into_iter().peekable();
        let mut at = 0;
        loop {
            while let Some((_, spacing, change)) = edges.next_if(|&(edge, ..)| edge <= at) {
                open[spacing.ilog2() as usize] += change;
            }
            let finest = open.iter().position(|&count| count > 0);
            let spacing = finest.map_or(block, |power| 1 << power);
            let begin = block * at;
            match self.all[start..].last() {
                Some(last) if last.spacing == spacing => {}
                Some(last) => {
                    let number = last.number + (begin - last.start) / last.spacing;
                    self.all.push(Part { number, start: begin, spacing });
                }
                None => self.all.push(Part { number: 0, start: begin, spacing }),
            }
            match edges.peek() {
                Some(&(next, ..)) => at = next,
                None => break,
            }
        }
        self.ends.push(self.all.len());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(first: i32, last: i32) -> NodeRange {
        NodeRange { first, last }
    }

    fn near(ranges: &[NodeRange]) -> Near {
        Near::of(&ranges.iter().copied().enumerate().collect::<Vec<_>>())
    }

    fn parts(block: i32, media: &[(&[NodeRange], i32)]) -> Parts {
        let mut parts = Parts::default();
        parts.push(block, media.iter().map(|&(ranges, spacing)| (near(ranges), spacing)));
        parts
    }

    #[test]
    fn blocks_are_divided_by_the_finest_medium_in_them() {
        let parts = parts(8, &[(&[run(17, 20), run(40, 47)], 1), (&[run(30, 33)], 2)]);
        let spacings: Vec<_> = parts.of(0).iter().map(|part| (part.start, part.spacing)).collect();
        assert_eq!(spacings, [(0, 8), (16, 1), (24, 2), (40, 1), (48, 8)]);
        // Each step has a node, nodes follow one another, and each stands for as many steps as its part says.
        let mut steps = 0;
        for node in 0..40 {
            let (part, next) = parts.around(0, node);
            assert_eq!(part.step_of(node), steps, "{node}");
            assert!(part.number <= node && node < next);
            assert!((steps..steps + part.spacing).all(|step| parts.node_at(0, step) == node), "{node}");
            steps += part.spacing;
        }
    }

    #[test]
    fn without_finer_media_all_blocks_are_whole() {
        let parts = parts(4, &[(&[], 1)]);
        assert_eq!(parts.of(0), [Part { number: 0, start: 0, spacing: 4 }]);
        assert_eq!(parts.around(0, -1).0.step_of(-1), -4);
        assert_eq!(Parts::default().of(3), EVEN);
    }

    #[test]
    fn a_fifth_run_joins_the_last() {
        let far: Vec<_> = (0..6).map(|i| run(100 * i, 100 * i + 10)).collect();
        assert_eq!(near(&far).0, [run(0, 10), run(100, 110), run(200, 210), run(300, 510)]);
        // Whatever touches is one.
        assert_eq!(near(&[run(0, 10), run(20, 30), run(12, 18)]).0[0], run(0, 30));
    }
}
