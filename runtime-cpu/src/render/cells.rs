//! The boxes in which a medium may be, as a tree, and what is near them.
//!
//! In: boxes in any order. Out: for a ray the parts of it that are near some box, in order; for a point whether it is.
//! A ray asks of each node of the tree once, so what it costs grows with the boxes beside it and not with all of them.
//!
//! Example: of the 400 boxes of a tube of 100 segments a ray across it looks at about 30.

use super::camera::{Ray, Span, slab};
use crate::real::{Real, Vec3, add, splat, sub};

/// A tree of boxes.
#[derive(Debug)]
pub(crate) struct Cells<R> {
    /// Each before those below it.
    nodes: Vec<Node<R>>,
}

/// A box around others, or one of them.
#[derive(Debug)]
struct Node<R> {
    lo: Vec3<R>,
    hi: Vec3<R>,
    /// Index of the node after all that are in this one; the next one, if there are none in it.
    skip: usize,
}

impl<R: Real> Cells<R> {
    /// Puts boxes, smallest and largest corners, into a tree.
    pub(crate) fn new(mut boxes: Vec<[Vec3<R>; 2]>) -> Self {
        let mut cells = Self { nodes: Vec::with_capacity(2 * boxes.len()) };
        if !boxes.is_empty() {
            cells.build(&mut boxes);
        }
        cells
    }

    /// Whether there are no boxes: then the medium may be anywhere.
    pub(crate) fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    fn build(&mut self, boxes: &mut [[Vec3<R>; 2]]) {
        let (mut lo, mut hi) = (boxes[0][0], boxes[0][1]);
        for [other_lo, other_hi] in boxes.iter() {
            for axis in 0..3 {
                lo[axis] = lo[axis].min(other_lo[axis]);
                hi[axis] = hi[axis].max(other_hi[axis]);
            }
        }
        let index = self.nodes.len();
        self.nodes.push(Node { lo, hi, skip: index + 1 });
        if boxes.len() > 1 {
            // In halves along the longest axis.
            let size = sub(hi, lo);
            let axis = (0..3).fold(0, |most, axis| if size[axis] > size[most] { axis } else { most });
            let middle = |[lo, hi]: &[Vec3<R>; 2]| (lo[axis] + hi[axis]).to_f64();
            let half = boxes.len() / 2;
            boxes.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
            let (before, after) = boxes.split_at_mut(half);
            self.build(before);
            self.build(after);
            self.nodes[index].skip = self.nodes.len();
        }
    }

    /// The boxes grown by `reach` that hold what is asked for, as far as their own tree says so.
    fn visit<T>(
        &self,
        reach: R,
        ask: impl Fn(Vec3<R>, Vec3<R>) -> Option<T>,
        mut found: impl FnMut(T) -> bool,
    ) {
        let reach = splat(reach);
        let mut index = 0;
        while let Some(node) = self.nodes.get(index) {
            let answer = ask(sub(node.lo, reach), add(node.hi, reach));
            let is_leaf = node.skip == index + 1;
            index = if answer.is_some() { index + 1 } else { node.skip };
            if let Some(answer) = answer.filter(|_| is_leaf)
                && !found(answer)
            {
                return;
            }
        }
    }

    /// The parts of a ray up to `end` that are within `reach` of boxes, one for each of them.
    pub(crate) fn spans(&self, ray: &Ray<R>, reach: R, end: R) -> Vec<Span<R>> {
        let mut spans = Vec::new();
        let meets = |lo, hi| Some(slab(ray, lo, hi)).filter(|span| span.entry <= span.exit.min(end));
        self.visit(reach, meets, |span| {
            spans.push(span);
            true
        });
        spans
    }

    /// Whether a ray meets one of the boxes.
    pub(crate) fn is_met_by(&self, ray: &Ray<R>) -> bool {
        let mut met = false;
        let meets = |lo, hi| slab(ray, lo, hi).is_some().then_some(());
        self.visit(R::ZERO, meets, |()| {
            met = true;
            false
        });
        met
    }

    /// Whether a point is within `reach` of one of the boxes.
    pub(crate) fn is_near(&self, point: Vec3<R>, reach: R) -> bool {
        let mut near = false;
        let holds = |lo: Vec3<R>, hi: Vec3<R>| super::camera::contains(lo, hi, point).then_some(());
        self.visit(reach, holds, |()| {
            near = true;
            false
        });
        near
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
            let cells = Cells::new(boxes(count));
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
                assert_eq!(order(cells.spans(&ray, 0.05, 4.0)), order(expected));
                let met = boxes(count).iter().any(|&[lo, hi]| slab(&ray, lo, hi).is_some());
                assert_eq!(cells.is_met_by(&ray), met);
            }
        }
    }

    #[test]
    fn points_are_near_where_they_are_in_a_box() {
        let cells = Cells::new(boxes(250));
        let mut near = 0;
        for ray in rays() {
            for i in 0..20 {
                let point = ray.at(0.3 * f64::from(i));
                let inside = |[lo, hi]: [Vec3<f64>; 2]| {
                    (0..3).all(|axis| lo[axis] - 0.1 <= point[axis] && point[axis] <= hi[axis] + 0.1)
                };
                assert_eq!(cells.is_near(point, 0.1), boxes(250).into_iter().any(inside));
                near += usize::from(cells.is_near(point, 0.1));
            }
        }
        assert!(near > 100, "{near}");
    }

    #[test]
    fn without_boxes_there_is_nothing_to_meet() {
        let cells = Cells::<f64>::new(Vec::new());
        assert!(cells.is_empty() && rays().all(|ray| !cells.is_met_by(&ray)));
    }
}
