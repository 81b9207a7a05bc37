//! Large unions as the parts that they are made of.
//!
//! A ray meets a sharp union where it first meets one of its parts, and each part has a box of its own: a tree over
//! the boxes finds the few that matter, where the distance of the whole would have to be asked.

use super::blend::Blend;
use super::{Kind, Shape};
use std::rc::Rc;

/// A union of fewer parts is asked as a whole: as a part of its own each takes a function, and a place in what
/// every ray of a shader looks through.
const FEWEST_PARTS: usize = 16;

/// A union of more parts is asked as a whole, too: three functions of each would take minutes to compile.
const MOST_PARTS: usize = 20_000;

impl Shape {
    /// The solids that this one is the sharp union of, moved and turned or not: as many as may stand for it,
    /// else itself alone.
    pub(crate) fn parts_to_march(self: &Rc<Self>) -> Vec<Rc<Self>> {
        let mut parts = Vec::new();
        self.collect_parts(&mut parts);
        if (FEWEST_PARTS..=MOST_PARTS).contains(&parts.len()) { parts } else { vec![Rc::clone(self)] }
    }

    fn collect_parts(self: &Rc<Self>, parts: &mut Vec<Rc<Self>>) {
        match &self.kind {
            // Twice as many are too many already.
            _ if parts.len() > MOST_PARTS => {}
            Kind::Union { shapes, blend: Blend::Sharp } => {
                shapes.iter().for_each(|shape| shape.collect_parts(parts));
            }
            Kind::Transformed { child, transform } if transform.keeps_shape() => {
                let first = parts.len();
                child.collect_parts(parts);
                if parts.len() == first + 1 {
                    parts[first] = Rc::clone(self);
                } else {
                    parts[first..].iter_mut().for_each(|part| *part = self.moved(part));
                }
            }
            _ => parts.push(Rc::clone(self)),
        }
    }

    /// A part of what a transform moves, moved like the whole.
    fn moved(&self, part: &Rc<Self>) -> Rc<Self> {
        let Kind::Transformed { transform, .. } = &self.kind else {
            unreachable!("only what is transformed moves its parts");
        };
        Rc::new(Self {
            kind: Kind::Transformed { child: Rc::clone(part), transform: transform.clone() },
            parts: part.parts + 1,
            levels: part.levels + 1,
            steady: part.steady,
            span: self.span,
        })
    }
}

#[cfg(test)]
mod tests {
    use vol_language::source::SourceFile;

    /// To which block each object belongs.
    #[track_caller]
    fn wholes(shape: &str) -> Vec<usize> {
        let text = format!(
            "let balls = [for i in 0..{FEWEST}: sphere(0.1 + 0.01 * i).translate((i, 0, 0))]\n\
             object first {{ shape: box((1, 1, 1)) }}\nobject many {{ shape: {shape} }}\n",
            FEWEST = super::FEWEST_PARTS,
        );
        let library = crate::library::library();
        let (scene, errors) = vol_language::analyse(&SourceFile::new("test.vol", &text), &library);
        let (program, more) = crate::lower::compile(&scene.unwrap_or_else(|| panic!("{errors:?}")));
        program.unwrap_or_else(|| panic!("{more:?}")).objects.iter().map(|object| object.whole).collect()
    }

    #[test]
    fn large_unions_are_objects_for_each_part() {
        let parts = |count: usize| [vec![0], vec![1; count]].concat();
        assert_eq!(wholes("union(balls)"), parts(16));
        assert_eq!(
            wholes("(union(balls).rotate_x(20deg) | sphere(3)).scale(2).translate((0, 1, 0))"),
            parts(17)
        );
        assert_eq!(wholes("union([for i in 0..15: sphere(1 + i)])"), parts(1));
        assert_eq!(wholes("union(balls, smooth: 0.1)"), parts(1));
        assert_eq!(wholes("union(balls).twist(20deg)"), parts(1));
        assert_eq!(wholes("union(balls) - sphere(1)"), parts(1));
        assert_eq!(wholes("union(balls) | (union(balls) - sphere(1))"), parts(17));
    }
}
