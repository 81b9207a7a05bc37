//! Nearest points of solids, found without the formulas that are tested: on triangles by clamping to
//! edges one by one, on curves by search, in f64.
//!
//! Every function gives a signed distance; that of an ellipsoid is by bisection on its Lagrange multiplier.

use crate::solid::{along, length};
use std::f64::consts::TAU;

/// A signed distance.
pub(crate) type Distance = Box<dyn Fn([f64; 3]) -> f64 + Send + Sync>;

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

fn from(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    along(b, a, -1.0)
}

/// Distance to a segment, by the place on it.
fn to_segment(p: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
    let axis = from(a, b);
    let square = dot(axis, axis);
    if square == 0.0 {
        return length(from(a, p));
    }
    let place = (dot(from(a, p), axis) / square).clamp(0.0, 1.0);
    length(from(along(a, axis, place), p))
}

/// Distance to a triangle: that of its plane if the foot is on the inner side of every edge.
fn to_triangle(p: [f64; 3], [a, b, c]: [[f64; 3]; 3]) -> f64 {
    let normal = cross(from(a, b), from(a, c));
    let size = length(normal);
    let within = [(a, b), (b, c), (c, a)]
        .iter()
        .all(|&(from_here, to)| dot(cross(from(from_here, to), from(from_here, p)), normal) >= 0.0);
    if size > 0.0 && within {
        return (dot(normal, from(a, p)) / size).abs();
    }
    to_segment(p, a, b).min(to_segment(p, b, c)).min(to_segment(p, c, a))
}

/// A convex solid from its faces, rings of corners. It holds the origin, or is flat or a point.
pub(crate) fn polyhedron(faces: Vec<Vec<[f64; 3]>>) -> Distance {
    let corners: Vec<[f64; 3]> = faces.concat();
    let middle = corners.iter().fold([0.0; 3], |sum, &c| along(sum, c, 1.0 / corners.len() as f64));
    let mut triangles = Vec::new();
    for face in &faces {
        triangles.extend((2..face.len()).map(|i| [face[0], face[i - 1], face[i]]));
    }
    let size = corners.iter().map(|&c| length(from(middle, c))).fold(0.0, f64::max);
    // Outward normals of the faces that have an area; none of a solid without volume.
    let mut planes = Vec::new();
    let mut flat = false;
    for &[a, b, c] in &triangles {
        let normal = cross(from(a, b), from(a, c));
        let area = length(normal);
        if area <= 1e-12 * size * size {
            continue;
        }
        let away = dot(normal, from(middle, a)) / area;
        flat |= away.abs() <= 1e-9 * size;
        planes.push((normal.map(|x| x * away.signum() / area), a));
    }
    let solid = !flat && planes.len() >= 4;
    Box::new(move |p| {
        let distance = triangles.iter().map(|&t| to_triangle(p, t)).fold(f64::INFINITY, f64::min);
        let inside = solid && planes.iter().all(|&(normal, a)| dot(normal, from(a, p)) < 0.0);
        if inside { -distance } else { distance }
    })
}

/// A box from its half extents.
pub(crate) fn cuboid(half: [f64; 3]) -> Distance {
    let corner = |signs: [f64; 3]| [0, 1, 2].map(|i| signs[i] * half[i]);
    let mut faces = Vec::new();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let ring = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(u, v)| {
                let mut signs = [side; 3];
                signs[(axis + 1) % 3] = u;
                signs[(axis + 2) % 3] = v;
                corner(signs)
            });
            faces.push(ring.to_vec());
        }
    }
    polyhedron(faces)
}

/// Between two rings of as many corners, ends closed.
pub(crate) fn between(low: Vec<[f64; 3]>, high: Vec<[f64; 3]>) -> Distance {
    let sides = low.len();
    let side = |i: usize| vec![low[i], low[(i + 1) % sides], high[(i + 1) % sides], high[i]];
    let mut faces: Vec<_> = (0..sides).map(side).collect();
    faces.push(low);
    faces.push(high);
    polyhedron(faces)
}

/// Corners at a height, the first towards an angle in turns from x to z.
pub(crate) fn ring(sides: usize, radius: f64, y: f64, first: f64) -> Vec<[f64; 3]> {
    let turn = |i: usize| TAU * (first + i as f64 / sides as f64);
    (0..sides).map(|i| [radius * turn(i).cos(), y, radius * turn(i).sin()]).collect()
}

/// An octahedron from the distance of its corners.
pub(crate) fn octahedron(radius: f64) -> Distance {
    let corner = |axis: usize, side: f64| {
        let mut corner = [0.0; 3];
        corner[axis] = side * radius;
        corner
    };
    let mut faces = Vec::new();
    for x in [-1.0, 1.0] {
        for y in [-1.0, 1.0] {
            faces.extend([-1.0, 1.0].map(|z| vec![corner(0, x), corner(1, y), corner(2, z)]));
        }
    }
    polyhedron(faces)
}

/// A solid turned about the y axis: the profile is a convex chain of (distance from the axis, y) from the
/// axis to the axis, from the lower end to the upper one.
pub(crate) fn turned(profile: Vec<[f64; 2]>) -> Distance {
    Box::new(move |p| {
        let flat = |[u, y]: [f64; 2]| [u, y, 0.0];
        let here = [p[0].hypot(p[2]), p[1], 0.0];
        let edges: Vec<_> = profile.windows(2).map(|pair| (flat(pair[0]), flat(pair[1]))).collect();
        let least = edges.iter().map(|&(a, b)| to_segment(here, a, b)).fold(f64::INFINITY, f64::min);
        let inside = edges.iter().all(|&(a, b)| a == b || cross(from(a, b), from(a, here))[2] > 0.0);
        if inside { -least } else { least }
    })
}

/// A circle of a radius about a point of the same plane through the axis, turned about the axis; what of it
/// is beyond the axis is within the solid.
pub(crate) fn ring_of_circles(centre: f64, radius: f64) -> Distance {
    Box::new(move |p| {
        let here = [p[0].hypot(p[2]), p[1]];
        let off = |angle: f64| {
            let from_axis = centre + radius * angle.cos();
            let hidden = from_axis < -1e-12 && radius > centre && centre > 0.0;
            let off = (from_axis - here[0]).hypot(radius * angle.sin() - here[1]);
            if hidden { f64::INFINITY } else { off }
        };
        // Search about the best of some angles all around.
        let angles = (0..32).map(|i| TAU * f64::from(i) / 32.0);
        let best = angles.min_by(|&a, &b| off(a).total_cmp(&off(b))).unwrap_or(0.0);
        let distance = least(off, best - 0.3, best + 0.3);
        if (here[0] - centre).hypot(here[1]) < radius { -distance } else { distance }
    })
}

/// All within a radius of a segment, the place on it found by search.
pub(crate) fn thick_segment(a: [f64; 3], b: [f64; 3], radius: f64) -> Distance {
    Box::new(move |p| least(|t| length(from(along(a, from(a, b), t), p)), 0.0, 1.0) - radius)
}

/// All within a rim of a flat disk across y, the place on its radius found by search.
pub(crate) fn thick_disk(radius: f64, rim: f64) -> Distance {
    Box::new(move |p| least(|u| (p[0].hypot(p[2]) - u).hypot(p[1]), 0.0, radius) - rim)
}

/// A half space, from three points of its wall.
pub(crate) fn half_space(normal: [f64; 3], offset: f64) -> Distance {
    let size = length(normal);
    let wall = normal.map(|x| offset * x / (size * size) * size);
    let first = cross(normal, [0.3, -0.7, 0.2]);
    let second = cross(normal, first);
    Box::new(move |p| {
        // Take away what is along the wall; the rest is the distance, its side that of the normal.
        let mut rest = from(wall, p);
        for along_wall in [first, second] {
            rest = along(rest, along_wall, -dot(rest, along_wall) / dot(along_wall, along_wall));
        }
        length(rest).copysign(dot(rest, normal))
    })
}

/// An ellipsoid: the nearest point is `r^2 p / (r^2 + t)`, with t where that is on the surface.
pub(crate) fn ellipsoid(radii: [f64; 3]) -> Distance {
    Box::new(move |p| {
        let level = |p: [f64; 3]| [0, 1, 2].map(|i| (p[i] / radii[i]).powi(2)).iter().sum::<f64>() - 1.0;
        // In terms of s = t + the least r^2, which is small inside near the flat side.
        let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
        let wider = radii.map(|radius| (radius - least) * (radius + least));
        // Off the symmetry planes, where inside the nearest point is not unique.
        let q = p.map(|c| c.abs().max(1e-12));
        let foot = |s: f64| [0, 1, 2].map(|i| radii[i] * radii[i] * q[i] / (wider[i] + s));
        let largest = radii.iter().copied().fold(0.0, f64::max);
        let (mut low, mut high) = (0.0, 4.0 * (length(q) + largest) * largest + 1.0);
        for _ in 0..120 {
            let middle = 0.5 * (low + high);
            if level(foot(middle)) > 0.0 { low = middle } else { high = middle }
        }
        let distance = length(from(foot(high), q));
        if level(p) < 0.0 { -distance } else { distance }
    })
}

/// Grown by a radius on all sides.
pub(crate) fn grown(solid: Distance, by: f64) -> Distance {
    Box::new(move |p| solid(p) - by)
}

/// The least value of a function with one valley that is at least a sixteenth of the range wide: the best
/// of 17 places, then golden sections.
fn least(function: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    let step = (to - from) / 16.0;
    let values: Vec<f64> = (0..=16).map(|i| function(from + step * f64::from(i))).collect();
    let best = (0..17).min_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap_or(0);
    let place = from + step * best as f64;
    let (mut low, mut high) = ((place - step).max(from), (place + step).min(to));
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut at_a, mut at_b) = (function(a), function(b));
    for _ in 0..46 {
        if at_a < at_b {
            (high, b, at_b) = (b, a, at_a);
            a = high - golden * (high - low);
            at_a = function(a);
        } else {
            (low, a, at_a) = (a, b, at_b);
            b = low + golden * (high - low);
            at_b = function(b);
        }
    }
    at_a.min(at_b).min(values[best])
}
