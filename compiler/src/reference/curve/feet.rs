//! All feet of a point on a curve in f64: the local minima of the distance along it.
//!
//! In: a point, the segments, from which foot on and how far feet may be. Out: the next foot. The numbers
//! of feet are those of the kernels, three to a part of a segment, a segment being cut where it is
//! slowest: where the curve enters the part, inside, and where it leaves it at an end or before a gap.

use super::{Arm, ReferencePoint, SAMPLES, Vector, arms_of, at_point, described, dot, norm, sub, unit};
use crate::curve::Quadratic;

/// A foot and where to look for the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceFoot {
    /// Number after that of the foot; the one asked from if there is none.
    pub next: u32,
    /// The point seen from it; length of the curve and gap are not filled in.
    pub point: Option<ReferencePoint>,
}

/// A part of a segment along which the speed falls or rises.
struct Part {
    arm: usize,
    from: f64,
    to: f64,
}

/// The first foot whose number is at least `from` and whose distance is at most `most`.
///
/// * `closed`: whether the end of the curve is joined to its start
/// * rules shared with the kernels: parts that are not longer than 1e-10 of the longest segment (or 1e-9)
///   are left out; a place within 1e-8 of the end of a segment is at the end
#[must_use]
pub fn next_foot(p: Vector, segments: &[Quadratic], from: u32, most: f64, closed: bool) -> ReferenceFoot {
    let none = ReferenceFoot { next: from, point: None };
    let arms = arms_of(segments);
    if arms.is_empty() {
        let point = segments.first().map(|segment| at_point(p, segment.a));
        let near = point.filter(|point| from == 0 && point.distance <= most);
        return near.map_or(none, |point| ReferenceFoot { next: 1, point: Some(point) });
    }
    let parts = parts_of(&arms, segments);
    for index in 0..parts.len() {
        for (kind, place) in (0u32..).zip(feet_of(p, &arms, &parts, index, closed)) {
            let number = 3 * index as u32 + kind;
            let Some(u) = place.filter(|_| number >= from) else { continue };
            let arm = parts[index].arm;
            if norm(sub(p, arms[arm].point(u))) <= most {
                return ReferenceFoot { next: number + 1, point: Some(described(p, &arms, arm, u)) };
            }
        }
    }
    none
}

fn parts_of(arms: &[Arm], segments: &[Quadratic]) -> Vec<Part> {
    let reach = |s: &Quadratic| norm(sub(s.b, s.a)) + norm(sub(s.c, s.b));
    let shortest = segments.iter().map(|s| reach(s) * 1e-10).fold(1e-9, f64::max);
    let mut parts = Vec::new();
    for (index, arm) in arms.iter().enumerate() {
        let inside = arm.vertex > 1e-8 && arm.vertex < 1.0 - 1e-8;
        let cuts = if inside { vec![0.0, arm.vertex, 1.0] } else { vec![0.0, 1.0] };
        for ends in cuts.windows(2) {
            // The slower end comes first.
            let start = if 0.5 * (ends[0] + ends[1]) < arm.vertex { ends[1] } else { ends[0] };
            let share = ends[1] - ends[0];
            let size = share * norm(arm.half_velocity(start)) + share * share * norm(arm.b2);
            if size > shortest {
                parts.push(Part { arm: index, from: ends[0], to: ends[1] });
            }
        }
    }
    parts
}

/// Places of the feet of a part, on its segment.
fn feet_of(p: Vector, arms: &[Arm], parts: &[Part], index: usize, closed: bool) -> [Option<f64>; 3] {
    let part = &parts[index];
    let arm = &arms[part.arm];
    // How the distance grows along the curve where the part is entered and left.
    let (entering, leaving) = (grows(p, arm, part, part.from), grows(p, arm, part, part.to));
    let before = &parts[index.checked_sub(1).unwrap_or(parts.len() - 1)];
    let joined_before = if index > 0 { touch(arms, before, part) } else { closed };
    let joined_after = parts.get(index + 1).map_or(closed, |next| touch(arms, part, next));
    let grew = dot(sub(arm.point(part.from), p), tangent(&arms[before.arm], before, before.to));
    let enters = entering >= 0.0 && (!joined_before || grew <= 0.0);
    let leaves = !joined_after && leaving <= 0.0;
    let inside = inside(p, arm, part, [entering, leaving]);
    [enters.then_some(part.from), inside, leaves.then_some(part.to)]
}

fn touch(arms: &[Arm], part: &Part, next: &Part) -> bool {
    norm(sub(arms[next.arm].point(next.from), arms[part.arm].point(part.to))) <= 1e-9
}

/// The distance's growth along the tangent at an end of a part.
fn grows(p: Vector, arm: &Arm, part: &Part, u: f64) -> f64 {
    dot(sub(arm.point(u), p), tangent(arm, part, u))
}

/// Unit tangent at an end of a part; at a cusp that within the part.
fn tangent(arm: &Arm, part: &Part, u: f64) -> Vector {
    if arm.cusp {
        let forward = 0.5 * (part.from + part.to) >= arm.vertex;
        return unit(if forward { arm.b2 } else { arm.b2.map(|x| -x) });
    }
    unit(arm.half_velocity(u))
}

/// The foot inside a part: there is at most one, since the distance's growth is convex or concave along it.
fn inside(p: Vector, arm: &Arm, part: &Part, [entering, leaving]: [f64; 2]) -> Option<f64> {
    let place = |i: usize| part.from + (part.to - part.from) * i as f64 / SAMPLES as f64;
    let slope = |u: f64| dot(sub(arm.point(u), p), arm.half_velocity(u));
    let at = |i: usize| match i {
        0 => entering,
        SAMPLES => leaving,
        _ => slope(place(i)),
    };
    for i in 0..SAMPLES {
        let ends = at(i + 1) > 0.0 || at(i + 1) == 0.0 && i + 1 < SAMPLES;
        if at(i) < 0.0 && ends {
            let (mut low, mut high) = (place(i), place(i + 1));
            for _ in 0..60 {
                let half = 0.5 * (low + high);
                if slope(half) < 0.0 { low = half } else { high = half }
            }
            return Some(low);
        }
    }
    None
}
