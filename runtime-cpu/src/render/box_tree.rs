//! Boxes as a tree: those in which a medium may be, and those of the solids.
//!
//! In: boxes in any order. Out: for a ray the boxes that it meets or passes near, for a point those that hold it.
//! A ray asks of each node of the tree once, so what it costs grows with the boxes beside it and not with all of them.
//!
//! Example: of the 400 boxes of a tube of 100 segments a ray across it looks at about 30.

use super::camera::{FAR, PARALLEL, Ray, Span, contains, slab};
use crate::isa::{Isa, Kernel};
use crate::real::{Real, Vec3, add, splat, sub};
use std::marker::PhantomData;

/// A tree of boxes.
#[derive(Debug)]
pub(crate) struct BoxTree<R> {
    /// Each before those below it.
    nodes: Vec<Node<R>>,
}

/// What was found of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Answer<T> {
    /// Index of the box.
    pub(crate) index: usize,
    /// Number of the question.
    pub(crate) question: usize,
    pub(crate) found: T,
}

/// A box around others, or one of them.
#[derive(Debug)]
struct Node<R> {
    lo: Vec3<R>,
    hi: Vec3<R>,
    /// Index of the node after all that are in this one; the next one, if there are none in it.
    skip: usize,
    /// Index of the box, where it is one.
    index: usize,
}

impl<R: Real> BoxTree<R> {
    /// Puts boxes, smallest and largest corners, into a tree.
    pub(crate) fn new(boxes: Vec<[Vec3<R>; 2]>) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(2 * boxes.len()) };
        let mut numbered: Vec<_> = boxes.into_iter().enumerate().collect();
        if !numbered.is_empty() {
            tree.build(&mut numbered);
        }
        tree
    }

    /// Whether there are no boxes.
    pub(crate) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    fn build(&mut self, boxes: &mut [(usize, [Vec3<R>; 2])]) {
        let (index, [mut lo, mut hi]) = boxes[0];
        for (_, [other_lo, other_hi]) in boxes.iter() {
            for axis in 0..3 {
                lo[axis] = lo[axis].min(other_lo[axis]);
                hi[axis] = hi[axis].max(other_hi[axis]);
            }
        }
        let node = self.nodes.len();
        self.nodes.push(Node { lo, hi, skip: node + 1, index });
        if boxes.len() > 1 {
            // In halves along the longest axis.
            let size = sub(hi, lo);
            let axis = (0..3).fold(0, |most, axis| if size[axis] > size[most] { axis } else { most });
            let middle = |(_, [lo, hi]): &(usize, [Vec3<R>; 2])| (lo[axis] + hi[axis]).to_f64();
            let half = boxes.len() / 2;
            boxes.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
            let (before, after) = boxes.split_at_mut(half);
            self.build(before);
            self.build(after);
            self.nodes[node].skip = self.nodes.len();
        }
    }

    /// Goes through the boxes of which `ask` finds something, each with its index and what was found; a box that
    /// holds others is asked first. Ends early where `found` says so.
    fn visit<T>(&self, ask: impl Fn(Vec3<R>, Vec3<R>) -> Option<T>, mut found: impl FnMut(usize, T) -> bool) {
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            let answer = ask(node.lo, node.hi);
            let is_leaf = node.skip == at + 1;
            at = if answer.is_some() { at + 1 } else { node.skip };
            if let Some(answer) = answer.filter(|_| is_leaf)
                && !found(node.index, answer)
            {
                return;
            }
        }
    }

    /// What `ask` finds of each box for each of `count` questions, by the index of the box, then by the question. Of a
    /// box around others it must find something where it does of one of those.
    pub(crate) fn answers<T>(
        &self,
        count: usize,
        ask: impl Fn(usize, Vec3<R>, Vec3<R>) -> Option<T>,
    ) -> Vec<Answer<T>> {
        let mut answers = Vec::new();
        for question in 0..count {
            self.visit(
                |lo, hi| ask(question, lo, hi),
                |index, found| {
                    answers.push(Answer { index, question, found });
                    true
                },
            );
        }
        answers.sort_by_key(|answer| answer.index);
        answers
    }

    /// What `ask` finds of the boxes that rays meet, by the index of the box, then by the ray. It is asked of a few
    /// more, but of all that [`slab`] finds something of.
    pub(crate) fn met<T>(
        &self,
        rays: &[Ray<R>],
        ask: impl Fn(usize, Vec3<R>, Vec3<R>) -> Option<T>,
    ) -> Vec<Answer<T>> {
        let isa = Isa::best();
        let bundle = Bundle::new(rays);
        let mut near = vec![0; rays.len()];
        let (mut answers, mut at) = (Vec::new(), 0);
        while let Some(node) = self.nodes.get(at) {
            let count = isa.run::<Near<R>>((&bundle, node, &mut near));
            if count == 0 {
                at = node.skip;
                continue;
            }
            if node.skip == at + 1 {
                for question in (0..rays.len()).filter(|&ray| near[ray] != 0) {
                    let found = ask(question, node.lo, node.hi);
                    answers.extend(found.map(|found| Answer { index: node.index, question, found }));
                }
            }
            at += 1;
        }
        answers.sort_by_key(|answer| answer.index);
        answers
    }

    /// The parts of a ray up to `end` that are within `reach` of boxes, with the index of each box.
    pub(crate) fn spans(&self, ray: &Ray<R>, reach: R, end: R) -> Vec<(usize, Span<R>)> {
        let mut spans = Vec::new();
        let reach = splat(reach);
        let meets = |lo, hi| {
            let span = slab(ray, sub(lo, reach), add(hi, reach));
            (span.entry <= span.exit.min(end)).then_some(span)
        };
        self.visit(meets, |index, span| {
            spans.push((index, span));
            true
        });
        spans
    }

    /// Whether a ray meets one of the boxes.
    pub(crate) fn is_met_by(&self, ray: &Ray<R>) -> bool {
        let mut met = false;
        let meets = |lo, hi| slab(ray, lo, hi).is_some().then_some(());
        self.visit(meets, |_, ()| {
            met = true;
            false
        });
        met
    }

    /// Whether a point is within `reach` of one of the boxes.
    pub(crate) fn is_near(&self, point: Vec3<R>, reach: R) -> bool {
        let mut near = false;
        let reach = splat(reach);
        let holds = |lo, hi| contains(sub(lo, reach), add(hi, reach), point).then_some(());
        self.visit(holds, |_, ()| {
            near = true;
            false
        });
        near
    }
}

/// Rays side by side, for loops that vectorise.
struct Bundle<R> {
    origin: [Vec<R>; 3],
    /// One over the direction.
    inverse: [Vec<R>; 3],
}

/// One over a component that counts as 0: times any coordinate it is finite.
const STEEP: f32 = 1e30;

/// Part by which a ray may miss a box and still be near it: more than division and multiplication differ.
const SLACK: f32 = 1e-6;

impl<R: Real> Bundle<R> {
    fn new(rays: &[Ray<R>]) -> Self {
        let inverse = |d: R| if d.abs() < R::from_f32(PARALLEL) { R::from_f32(STEEP) } else { R::ONE / d };
        let row = |of: fn(&Ray<R>) -> Vec3<R>, axis: usize| rays.iter().map(move |ray| of(ray)[axis]);
        Self {
            origin: [0, 1, 2].map(|axis| row(|ray| ray.origin, axis).collect()),
            inverse: [0, 1, 2].map(|axis| row(|ray| ray.direction, axis).map(inverse).collect()),
        }
    }
}

/// Which rays of a bundle [`slab`] may find a part of in a node's box, 1 or 0 each, and how many.
struct Near<R>(PhantomData<R>);

impl<R: Real> Kernel for Near<R> {
    type Args<'a> = (&'a Bundle<R>, &'a Node<R>, &'a mut [u32]);
    type Out = u32;

    #[inline(always)]
    fn run((bundle, node, near): Self::Args<'_>) -> u32 {
        let [ox, oy, oz] = bundle.origin.each_ref().map(|row| &row[..near.len()]);
        let [ix, iy, iz] = bundle.inverse.each_ref().map(|row| &row[..near.len()]);
        let mut count = 0;
        for (ray, near) in near.iter_mut().enumerate() {
            let (mut entry, mut exit) = (R::ZERO, R::from_f32(FAR));
            let axes = [(ox[ray], ix[ray]), (oy[ray], iy[ray]), (oz[ray], iz[ray])];
            for (axis, (origin, inverse)) in axes.into_iter().enumerate() {
                let (lo, hi) = (node.lo[axis], node.hi[axis]);
                let (one, other) = ((lo - origin) * inverse, (hi - origin) * inverse);
                // Along the planes a ray is between them always or never.
                let always = (inverse == R::from_f32(STEEP)) & (lo <= origin) & (origin <= hi);
                entry = if always { entry } else { entry.max(one.min(other)) };
                exit = if always { exit } else { exit.min(one.max(other)) };
            }
            let slack = R::from_f32(SLACK);
            *near = u32::from(entry - slack * entry <= exit + slack * exit.abs());
            count += *near;
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes along a spiral, and some that overlap.
    fn boxes(count: usize) -> Vec<[Vec3<f64>; 2]> {
        let at = |i: usize| {
            let angle = i as f64 * 0.1;
            [angle.cos() * 3.0, 0.02 * i as f64, angle.sin() * 3.0]
        };
        (0..count).map(|i| [sub(at(i), splat(0.2)), add(at(i), splat(0.1 + 0.01 * (i % 7) as f64))]).collect()
    }

    fn rays() -> impl Iterator<Item = Ray<f64>> {
        (0..200).map(|i| {
            let angle = f64::from(i) * 0.7;
            let direction = [angle.cos(), 0.3 * (angle * 1.7).sin(), angle.sin()];
            let size = crate::real::length(direction);
            Ray::new([0.01 * f64::from(i), 1.0, -0.5], direction.map(|x| x / size))
        })
    }

    #[test]
    fn spans_are_those_of_all_boxes() {
        for count in [1, 2, 3, 250] {
            let tree = BoxTree::new(boxes(count));
            for ray in rays() {
                let order = |spans: Vec<Span<f64>>| {
                    let mut ends: Vec<_> = spans.iter().map(|span| [span.entry, span.exit]).collect();
                    ends.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
                    ends
                };
                let grown = boxes(count)
                    .into_iter()
                    .map(|[lo, hi]| slab(&ray, sub(lo, splat(0.05)), add(hi, splat(0.05))));
                let expected = grown.filter(|span| span.is_some() && span.entry <= 4.0).collect();
                let found = tree.spans(&ray, 0.05, 4.0).into_iter().map(|(_, span)| span);
                assert_eq!(order(found.collect()), order(expected));
                let met = boxes(count).iter().any(|&[lo, hi]| slab(&ray, lo, hi).is_some());
                assert_eq!(tree.is_met_by(&ray), met);
            }
        }
    }

    #[test]
    fn points_are_near_where_they_are_in_a_box() {
        let tree = BoxTree::new(boxes(250));
        let mut near = 0;
        for ray in rays() {
            for i in 0..20 {
                let point = ray.at(0.3 * f64::from(i));
                let inside = |[lo, hi]: [Vec3<f64>; 2]| {
                    (0..3).all(|axis| lo[axis] - 0.1 <= point[axis] && point[axis] <= hi[axis] + 0.1)
                };
                assert_eq!(tree.is_near(point, 0.1), boxes(250).into_iter().any(inside));
                near += usize::from(tree.is_near(point, 0.1));
            }
        }
        assert!(near > 100, "{near}");
    }

    #[test]
    fn answers_are_those_of_all_boxes_in_order() {
        let all = boxes(250);
        let tree = BoxTree::new(all.clone());
        let rays: Vec<_> = rays().collect();
        let meets = |ray: usize, lo, hi| {
            let span = slab(&rays[ray], lo, hi);
            span.is_some().then_some(span)
        };
        let expected = all.iter().enumerate().flat_map(|(index, &[lo, hi])| {
            let found =
                (0..rays.len()).filter_map(move |question| Some((question, meets(question, lo, hi)?)));
            found.map(move |(question, found)| Answer { index, question, found })
        });
        let expected: Vec<_> = expected.collect();
        assert!(expected.len() > 70, "{}", expected.len());
        assert_eq!(tree.answers(rays.len(), meets), expected);
        assert_eq!(tree.met(&rays, meets), expected);
    }

    #[test]
    fn rays_along_axes_and_faces_meet_what_slab_says() {
        let all: Vec<[Vec3<f32>; 2]> = (0..27)
            .map(|i| [i / 9, i / 3 % 3, i % 3].map(|x| x as f32))
            .map(|lo| [lo, add(lo, if lo[0] > 1.0 { [1.0, 0.0, 1.0] } else { splat(1.0) })])
            .collect();
        let tree = BoxTree::new(all.clone());
        let directions =
            [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [1e-13, 0.6, -0.8], [-0.6, 0.8, -0.0], [0.8, 3e-12, 0.6]];
        let origins = [[-1.0, 1.0, 1.0], [0.5, 4.0, 2.0], [3.0, 0.0, 3.0], [1.5, 1.5, 1.5], [-1e6, 1.0, 0.5]];
        let rays: Vec<_> = directions.into_iter().flat_map(|d| origins.map(|o| Ray::new(o, d))).collect();
        let meets = |ray: usize, lo, hi| {
            let span = slab(&rays[ray], lo, hi).loosened();
            span.is_some().then_some(span)
        };
        let expected = tree.answers(rays.len(), meets);
        assert!(expected.len() > 40, "{}", expected.len());
        assert_eq!(tree.met(&rays, meets), expected);
    }

    #[test]
    fn without_boxes_there_is_nothing_to_meet() {
        let tree = BoxTree::<f64>::new(Vec::new());
        assert!(tree.is_empty() && rays().all(|ray| !tree.is_met_by(&ray)));
    }
}
