//! Closest point on a curve in f64, slow and obvious: what the f32 kernels are tested against.
//!
//! In: a point and the segments as the author drew them. Out: the eight quantities of the kernels'
//! `CurvePoint` and how clear the choice was. No canonical pieces here: candidates come from dense
//! sampling and bisection, lengths from adaptive quadrature, frames from rotations about the
//! binormal of whole segments. Shares only [`initial_normal`] and the documented rules for
//! degenerate segments with [`crate::curve`].

use crate::curve::{Quadratic, initial_normal};

mod feet;

pub use feet::{ReferenceFoot, next_foot};

/// Intervals sampled per half segment.
const SAMPLES: usize = 128;

type Vector = [f64; 3];

/// The closest point of a curve and its frame coordinates, f64.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferencePoint {
    /// Curve parameter of the foot, 0..1 over the whole curve, evenly per segment.
    pub t: f64,
    /// Length from the start of the curve to the foot, scene units.
    pub arc_length: f64,
    /// Length of the whole curve, scene units.
    pub curve_length: f64,
    /// Offset from the foot along U, scene units.
    pub x: f64,
    /// Offset from the foot along V = T x U, scene units.
    pub y: f64,
    /// Distance to the foot, scene units.
    pub distance: f64,
    /// Distance beyond the end of the curve along its outward tangent, 0 unless the foot is an end.
    pub overshoot: f64,
    /// 1 - curvature times the offset towards the centre of curvature, held within 0..=1e6.
    pub stretch: f64,
    /// How much farther the best foot elsewhere (t differing by more than 1e-3) is; infinite if none.
    pub gap: f64,
}

/// Closest point of the curve; `None` for no segments.
///
/// * method: every sign change of (Q - P) . Q' on a grid, bisected, and all segment ends
/// * rules shared with the kernels: a foot where two segments touch belongs to the one after; segments shorter than 1e-10 of the longest (or 1e-9) are left out;
///   a bend sharper than 1e-8 of its segment is a cusp; a curve that is a point has tangent +z
pub fn closest(p: Vector, segments: &[Quadratic]) -> Option<ReferencePoint> {
    let arms = arms_of(segments);
    if arms.is_empty() {
        return segments.first().map(|s| at_point(p, s.a));
    }
    let Nearest { index, u, distance, gap } = nearest(p, &arms);
    let found = described(p, &arms, index, u);
    Some(ReferencePoint { curve_length: length_of(&arms), distance, gap, ..found })
}

/// A point seen from the place `u` of an arm; length of the curve and gap are not known here.
fn described(p: Vector, arms: &[Arm], index: usize, u: f64) -> ReferencePoint {
    let arm = &arms[index];
    let offset = sub(p, arm.point(u));
    let tangent = arm.tangent(u);
    let normal = arm.normal(u);
    let first_end = if index == 0 && u == 0.0 { -dot(offset, tangent) } else { 0.0 };
    let last_end = if index + 1 == arms.len() && u == 1.0 { dot(offset, tangent) } else { 0.0 };
    ReferencePoint {
        t: arm.t(u),
        arc_length: length_of(&arms[..index]) + arm.length_to(u),
        curve_length: 0.0,
        x: dot(offset, normal),
        y: dot(offset, cross(tangent, normal)),
        distance: norm(offset),
        overshoot: first_end.max(last_end).max(0.0),
        stretch: (1.0 - dot(offset, arm.curvature(u))).clamp(0.0, 1e6),
        gap: f64::INFINITY,
    }
}

/// How the closest point of a curve moves, f64.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceSlopes {
    /// Unit vector from the foot to the position; 0 on the curve.
    pub direction: Vector,
    /// Unit tangent at the foot.
    pub tangent: Vector,
    /// Change of t per arc length.
    pub rate: f64,
    /// Change of arc length per length along the tangent: 1 / stretch, at most 20; 0 where the foot
    /// stays at an end or a corner.
    pub slide: f64,
}

/// How the closest point of the curve moves with the position; `None` for no segments.
///
/// * rule shared with the kernels: the foot stays where it is the end of a segment and the offset
///   leans along the tangent by more than 1e-3 of its length
pub fn slopes(p: Vector, segments: &[Quadratic]) -> Option<ReferenceSlopes> {
    let arms = arms_of(segments);
    if arms.is_empty() {
        let offset = sub(p, segments.first()?.a);
        let still = ReferenceSlopes { direction: [0.0; 3], tangent: [0.0, 0.0, 1.0], rate: 0.0, slide: 0.0 };
        let direction = if norm(offset) > 0.0 { unit(offset) } else { [0.0; 3] };
        return Some(ReferenceSlopes { direction, ..still });
    }
    let Nearest { index, u, distance, .. } = nearest(p, &arms);
    let arm = &arms[index];
    let (offset, tangent) = (sub(p, arm.point(u)), arm.tangent(u));
    let stays = (u == 0.0 || u == 1.0) && dot(offset, tangent).abs() > 1e-3 * distance;
    let stretch = (1.0 - dot(offset, arm.curvature(u))).max(0.05);
    Some(ReferenceSlopes {
        direction: if distance > 0.0 { offset.map(|x| x / distance) } else { [0.0; 3] },
        tangent,
        rate: arm.t_share / (2.0 * norm(arm.half_velocity(u))).max(1e-15),
        slide: if stays { 0.0 } else { 1.0 / stretch },
    })
}

/// The nearest foot.
struct Nearest {
    index: usize,
    u: f64,
    distance: f64,
    gap: f64,
}

fn nearest(p: Vector, arms: &[Arm]) -> Nearest {
    let (mut best, mut candidates) = ((f64::INFINITY, 0, 0.0), Vec::new());
    for (i, arm) in arms.iter().enumerate() {
        for u in arm.feet(p) {
            let distance = norm(sub(p, arm.point(u)));
            candidates.push((distance, arm.t(u)));
            if distance < best.0 {
                best = (distance, i, u);
            }
        }
    }
    let (distance, mut index, mut u) = best;
    // A foot where two segments touch belongs to the one after.
    let touches = |next: &Arm| norm(sub(next.start, arms[index].point(1.0))) <= 1e-9;
    if u == 1.0 && arms.get(index + 1).is_some_and(touches) {
        (index, u) = (index + 1, 0.0);
    }
    let t = arms[index].t(u);
    let rivals = candidates.iter().filter(|c| (c.1 - t).abs() > 1e-3);
    let gap = rivals.map(|c| c.0).fold(f64::INFINITY, f64::min) - distance;
    Nearest { index, u, distance, gap }
}

/// Length of arms together.
fn length_of(arms: &[Arm]) -> f64 {
    arms.iter().map(|arm| arm.length_to(1.0)).sum()
}

/// A curve that is one point, tangent +z.
fn at_point(p: Vector, a: Vector) -> ReferencePoint {
    let tangent = [0.0, 0.0, 1.0];
    let normal = initial_normal(tangent);
    let offset = sub(p, a);
    ReferencePoint {
        t: 0.0,
        arc_length: 0.0,
        curve_length: 0.0,
        x: dot(offset, normal),
        y: dot(offset, cross(tangent, normal)),
        distance: norm(offset),
        overshoot: dot(offset, tangent).abs(),
        stretch: 1.0,
        gap: f64::INFINITY,
    }
}

/// One segment with its place in the curve: `Q(u) = start + 2 u b1 + u^2 b2`.
struct Arm {
    start: Vector,
    b1: Vector,
    b2: Vector,
    t_first: f64,
    t_share: f64,
    first_normal: Vector,
    /// Parameter of the smallest speed, if inside.
    vertex: f64,
    /// The segment turns back on itself there.
    cusp: bool,
}

/// Lay out the segments that are long enough, one after the other.
fn arms_of(segments: &[Quadratic]) -> Vec<Arm> {
    let reach = |s: &Quadratic| norm(sub(s.b, s.a)) + norm(sub(s.c, s.b));
    let shortest = segments.iter().map(|s| reach(s) * 1e-10).fold(1e-9, f64::max);
    let mut arms: Vec<Arm> = Vec::new();
    for (i, s) in segments.iter().enumerate().filter(|(_, s)| reach(s) > shortest) {
        let b1 = sub(s.b, s.a);
        let b2 = sub(sub(s.c, s.b), b1);
        let vertex = if dot(b2, b2) > 0.0 { -dot(b1, b2) / dot(b2, b2) } else { -1.0 };
        let mut arm = Arm {
            start: s.a,
            b1,
            b2,
            t_first: i as f64 / segments.len() as f64,
            t_share: 1.0 / segments.len() as f64,
            first_normal: [0.0; 3],
            vertex,
            cusp: (-1e-8..=1.0 + 1e-8).contains(&vertex) && norm(cross(b1, b2)) <= 1e-8 * dot(b2, b2),
        };
        arm.first_normal = match arms.last() {
            None => initial_normal(arm.tangent(0.0)),
            Some(before) => around_corner(before.normal(1.0), before.tangent(1.0), arm.tangent(0.0)),
        };
        arms.push(arm);
    }
    arms
}

impl Arm {
    fn point(&self, u: f64) -> Vector {
        std::array::from_fn(|i| self.start[i] + u * (2.0 * self.b1[i] + u * self.b2[i]))
    }

    fn half_velocity(&self, u: f64) -> Vector {
        std::array::from_fn(|i| self.b1[i] + u * self.b2[i])
    }

    fn t(&self, u: f64) -> f64 {
        self.t_first + self.t_share * u
    }

    /// Unit tangent; at a cusp (within 1e-9) the one after it, unless the cusp is the end.
    fn tangent(&self, u: f64) -> Vector {
        if self.cusp {
            let forward = self.vertex <= 1e-8 || (self.vertex < 1.0 - 1e-8 && u >= self.vertex - 1e-9);
            return unit(if forward { self.b2 } else { self.b2.map(|x| -x) });
        }
        unit(self.half_velocity(u))
    }

    /// Rotation-minimising U: a segment is planar, so it turns about the fixed binormal.
    fn normal(&self, u: f64) -> Vector {
        let binormal = cross(self.b1, self.b2);
        if self.cusp || norm(binormal) == 0.0 {
            return self.first_normal;
        }
        rotate(self.first_normal, unit(binormal), self.tangent(0.0), self.tangent(u))
    }

    /// Curvature vector: acceleration across the tangent over the speed squared; 0 at a cusp.
    fn curvature(&self, u: f64) -> Vector {
        if self.cusp {
            return [0.0; 3];
        }
        let velocity = self.half_velocity(u).map(|x| 2.0 * x);
        let acceleration = self.b2.map(|x| 2.0 * x);
        let tangent = unit(velocity);
        let forward = dot(acceleration, tangent);
        std::array::from_fn(|i| (acceleration[i] - forward * tangent[i]) / dot(velocity, velocity))
    }

    /// Parameters of all local minima of the distance, and both ends.
    fn feet(&self, p: Vector) -> Vec<f64> {
        let slope = |u: f64| dot(sub(self.point(u), p), self.half_velocity(u));
        let middle = if self.vertex > 0.0 && self.vertex < 1.0 { self.vertex } else { 0.5 };
        let grid = |i: usize| {
            let share = (i % SAMPLES) as f64 / SAMPLES as f64;
            if i < SAMPLES { middle * share } else { middle + (1.0 - middle) * share }
        };
        let mut feet = vec![0.0, 1.0];
        for i in 0..2 * SAMPLES {
            let (mut low, mut high) = (grid(i), if i + 1 == 2 * SAMPLES { 1.0 } else { grid(i + 1) });
            if slope(low) <= 0.0 && slope(high) >= 0.0 {
                for _ in 0..60 {
                    let half = 0.5 * (low + high);
                    if slope(half) < 0.0 { low = half } else { high = half }
                }
                feet.push(low);
            }
        }
        feet
    }

    /// Length from the start to `u`, split at the vertex where the speed may have a kink.
    fn length_to(&self, u: f64) -> f64 {
        let speed = |v: f64| 2.0 * norm(self.half_velocity(v));
        let tolerance = 1e-14 * (norm(self.b1) + norm(self.b2));
        if self.vertex > 0.0 && self.vertex < u {
            integral(&speed, 0.0, self.vertex, tolerance, 40)
                + integral(&speed, self.vertex, u, tolerance, 40)
        } else {
            integral(&speed, 0.0, u, tolerance, 40)
        }
    }
}

/// Adaptive quadrature: 5-point Gauss-Legendre against its own two halves.
fn integral(f: &impl Fn(f64) -> f64, a: f64, b: f64, tolerance: f64, depth: u32) -> f64 {
    let half = 0.5 * (a + b);
    let whole = gauss(f, a, b);
    let halves = gauss(f, a, half) + gauss(f, half, b);
    if depth == 0 || (whole - halves).abs() <= tolerance {
        return halves;
    }
    integral(f, a, half, 0.5 * tolerance, depth - 1) + integral(f, half, b, 0.5 * tolerance, depth - 1)
}

fn gauss(f: &impl Fn(f64) -> f64, a: f64, b: f64) -> f64 {
    const RULE: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ];
    let (centre, radius) = (0.5 * (a + b), 0.5 * (b - a));
    RULE.iter().map(|(x, w)| w * f(centre + radius * x)).sum::<f64>() * radius
}

/// Rotate `v` about a unit axis by the angle from `from` to `to`, both perpendicular to the axis.
fn rotate(v: Vector, axis: Vector, from: Vector, to: Vector) -> Vector {
    let (sine, cosine) = dot(axis, cross(from, to)).atan2(dot(from, to)).sin_cos();
    let (side, lift) = (cross(axis, v), dot(axis, v) * (1.0 - cosine));
    std::array::from_fn(|i| v[i] * cosine + side[i] * sine + axis[i] * lift)
}

/// Smallest rotation from one tangent to the next; a half turn keeps the normal.
fn around_corner(normal: Vector, from: Vector, to: Vector) -> Vector {
    let axis = cross(from, to);
    if 1.0 + dot(from, to) < 1e-12 || norm(axis) == 0.0 {
        return normal;
    }
    rotate(normal, unit(axis), from, to)
}

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn sub(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[i] - b[i])
}

fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

fn unit(a: Vector) -> Vector {
    let size = norm(a);
    if size > 0.0 { a.map(|x| x / size) } else { [0.0, 0.0, 1.0] }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-12
    }

    #[test]
    fn straight_line_by_hand() {
        let line = [Quadratic { a: [0.0; 3], b: [1.0, 0.0, 0.0], c: [2.0, 0.0, 0.0] }];
        let Some(beside) = closest([0.5, 3.0, 4.0], &line) else { unreachable!("one segment") };
        assert!(near(beside.t, 0.25) && near(beside.arc_length, 0.5) && near(beside.curve_length, 2.0));
        assert!(near(beside.x, 3.0) && near(beside.y, 4.0) && near(beside.distance, 5.0));
        assert!(near(beside.stretch, 1.0) && near(beside.overshoot, 0.0));
        let Some(beyond) = closest([5.0, 0.0, 4.0], &line) else { unreachable!("one segment") };
        assert!(near(beyond.overshoot, 3.0) && near(beyond.y, 4.0) && near(beyond.t, 1.0));
        assert!(closest([0.0; 3], &[]).is_none());
    }

    #[test]
    fn parabola_by_hand() {
        // Q(u) = (2u - 1, (2u - 1)^2 / 2): curvature 1 at the vertex, unit circle of curvature.
        let parabola = [Quadratic { a: [-1.0, 0.5, 0.0], b: [0.0, -0.5, 0.0], c: [1.0, 0.5, 0.0] }];
        let Some(inside) = closest([0.0, 0.25, 0.0], &parabola) else { unreachable!("one segment") };
        assert!(near(inside.t, 0.5) && near(inside.distance, 0.25) && near(inside.stretch, 0.75));
        let exact = 2f64.sqrt() + 1f64.asinh();
        assert!(near(inside.curve_length, exact) && near(inside.arc_length, 0.5 * exact));
    }

    #[test]
    fn frame_matches_double_reflection() {
        // Wang, Jüttler, Zheng, Liu 2008, with many steps.
        let arm = &arms_of(&[Quadratic { a: [0.0; 3], b: [1.0, 0.2, 0.7], c: [-0.4, 0.9, 0.1] }])[0];
        let (steps, mut normal) = (2000, arm.normal(0.0));
        for i in 0..steps {
            let (u0, u1) = (f64::from(i) / f64::from(steps), f64::from(i + 1) / f64::from(steps));
            let reflect = |v: Vector, n: Vector| -> Vector {
                let k = 2.0 * dot(v, n) / dot(n, n);
                std::array::from_fn(|j| v[j] - k * n[j])
            };
            let chord = sub(arm.point(u1), arm.point(u0));
            let (carried, tangent) = (reflect(normal, chord), reflect(arm.tangent(u0), chord));
            normal = reflect(carried, sub(arm.tangent(u1), tangent));
        }
        assert!(norm(sub(normal, arm.normal(1.0))) < 1e-9);
    }
}
