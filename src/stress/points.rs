//! Places at which numbers are likely to go wrong.
//!
//! In: the box of a solid, the curves of its frame. Out: f32 positions: inside and around the box, on its
//! planes and corners, where coordinates are 0, whole, halves or nearly equal, next to the ends, joints and
//! centres of curvature of curves, at offsets down to 1e-8 of the size, and far off.

use vol_compiler::curve::Quadratic;
use vol_compiler::frame::{Aabb, Frame};
use vol_compiler::ir::verify::random::Random;

/// Half the edge of the box looked at where a solid has no bounds, in scene units.
const UNBOUNDED: f64 = 10.0;

/// Boxes larger than this stand for all of space, as in the renderer.
const LARGEST: f64 = 1e6;

/// Farthest places, in sizes of the box.
const FARTHEST: f64 = 1e8;

/// Most places of curves that are kept.
const MOST_ANCHORS: usize = 256;

/// Where a function is asked.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub(super) lo: [f64; 3],
    pub(super) hi: [f64; 3],
    /// Half the diagonal of the box, positive.
    pub(super) size: f64,
    /// The origin, the middle of the box, places of curves.
    anchors: Vec<[f64; 3]>,
}

impl Place {
    pub(super) fn new(bounds: Aabb, frame: &Frame) -> Self {
        let (mut lo, mut hi) = (bounds.lo.map(f64::from), bounds.hi.map(f64::from));
        for axis in 0..3 {
            let bounded = lo[axis] <= hi[axis] && lo[axis] > -LARGEST && hi[axis] < LARGEST;
            if !bounded {
                (lo[axis], hi[axis]) = (-UNBOUNDED, UNBOUNDED);
            }
        }
        let half = length([0, 1, 2].map(|axis| 0.5 * (hi[axis] - lo[axis])));
        let middle = [0, 1, 2].map(|axis| 0.5 * (lo[axis] + hi[axis]));
        let mut anchors = vec![middle, [0.0; 3], lo, hi];
        anchors.extend(frame.curves.iter().flatten().take(MOST_ANCHORS / 5).flat_map(of_piece));
        Self { lo, hi, size: if half > 1e-9 { half } else { 1e-3 }, anchors }
    }

    /// Whether a position is in the box or within a quarter of its size from it.
    pub(super) fn is_around(&self, p: [f32; 3]) -> bool {
        let margin = 0.25 * self.size;
        (0..3).all(|axis| {
            let x = f64::from(p[axis]);
            x >= self.lo[axis] - margin && x <= self.hi[axis] + margin
        })
    }

    /// A position in the box or within a quarter of its size from it.
    pub(super) fn around(&self, random: &mut Random) -> [f64; 3] {
        let margin = 0.25 * self.size;
        [0, 1, 2].map(|axis| random.between(self.lo[axis] - margin, self.hi[axis] + margin))
    }

    /// Some places of all kinds.
    pub(super) fn awkward(&self, count: usize, random: &mut Random) -> Vec<[f32; 3]> {
        (0..count).map(|i| self.one(i, random)).collect()
    }

    fn one(&self, i: usize, random: &mut Random) -> [f32; 3] {
        let mut p = self.around(random);
        let anchor = self.anchors[random.below(self.anchors.len())];
        let axis = random.below(3);
        match i % 20 {
            // Coordinates that are 0, or those of corners and anchors.
            0..3 => {
                let special = [0.0, self.lo[axis], self.hi[axis], anchor[axis]];
                p[axis] = special[random.below(4)];
                if i.is_multiple_of(2) {
                    p[(axis + 1) % 3] = anchor[(axis + 1) % 3];
                }
            }
            3 => p = [0, 1, 2].map(|k| [self.lo[k], self.hi[k], anchor[k]][random.below(3)]),
            // Next to anchors and on the axes through them.
            4..7 => {
                let away = self.size * 10f64.powf(random.between(-8.0, 0.0));
                let way = if i % 20 == 4 { along_axis(axis, random) } else { direction(random) };
                p = [0, 1, 2].map(|k| anchor[k] + away * way[k]);
            }
            // Coordinates that differ by a few units in the last place.
            7 | 8 => {
                let same = p[axis] as f32;
                return [0, 1, 2].map(|_| moved(same, random.below(5) as i32 - 2));
            }
            // Corners of the cells of noise, and next to them.
            9..12 => {
                let cells = f64::from(1 << random.below(6));
                return p.map(|x| moved(((x * cells).round() / cells) as f32, random.below(3) as i32 - 1));
            }
            // Far off.
            12..14 => {
                let away = self.size * 10f64.powf(random.between(0.5, FARTHEST.log10()));
                let way = if random.below(4) == 0 { along_axis(axis, random) } else { direction(random) };
                p = [0, 1, 2].map(|k| self.anchors[0][k] + away * way[k]);
            }
            _ => {}
        }
        p.map(|x| x as f32)
    }
}

/// Ends, middle and centres of curvature of a piece of a curve.
fn of_piece(piece: &Quadratic) -> [[f64; 3]; 5] {
    let Quadratic { a, b, c } = *piece;
    let middle = [0, 1, 2].map(|k| 0.25 * (a[k] + 2.0 * b[k] + c[k]));
    let bend = [0, 1, 2].map(|k| 2.0 * (a[k] - 2.0 * b[k] + c[k]));
    let centre = |at: [f64; 3], slope: [f64; 3]| {
        // at + n / k with the normal part of the second derivative.
        let speed = dot(slope, slope);
        let share = dot(bend, slope) / speed;
        let normal = [0, 1, 2].map(|k| bend[k] - share * slope[k]);
        let strength = dot(normal, normal);
        let found = [0, 1, 2].map(|k| at[k] + speed / strength * normal[k]);
        if found.iter().all(|x| x.abs() < LARGEST) { found } else { at }
    };
    let first = centre(a, [0, 1, 2].map(|k| 2.0 * (b[k] - a[k])));
    [a, c, middle, first, centre(middle, [0, 1, 2].map(|k| c[k] - a[k]))]
}

/// The f32 some places away.
fn moved(x: f32, ulps: i32) -> f32 {
    (0..ulps.abs()).fold(x, |x, _| if ulps > 0 { x.next_up() } else { x.next_down() })
}

fn along_axis(axis: usize, random: &mut Random) -> [f64; 3] {
    let mut way = [0.0; 3];
    way[axis] = if random.below(2) == 0 { 1.0 } else { -1.0 };
    way
}

/// A direction, all alike.
pub(super) fn direction(random: &mut Random) -> [f64; 3] {
    loop {
        let v = [(); 3].map(|()| random.between(-1.0, 1.0));
        let size = length(v);
        if size > 0.1 && size < 1.0 {
            return v.map(|x| x / size);
        }
    }
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn length(v: [f64; 3]) -> f64 {
    dot(v, v).sqrt()
}

/// `p + t v`
pub(super) fn along(p: [f64; 3], v: [f64; 3], t: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| p[k] + t * v[k])
}
