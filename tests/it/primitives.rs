//! Primitives against their nearest points: at many places inside and out, without size, far from the
//! origin and small; distances in f64 and f32, and the gradients that normals are made of.

use crate::nearest::{
    Distance, between, cuboid, ellipsoid, grown, half_space, octahedron, ring, ring_of_circles, thick_disk,
    thick_segment, turned,
};
use crate::solid::{Solid, direction, length};
use crate::support::{Random, ensure};
use libtest_mimic::{Failed, Trial};

/// Points per solid.
const POINTS: usize = 100_000;

/// Points per solid in special conditions.
const FEWER: usize = 4000;

/// How a shape's number relates to the distance.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Claim {
    /// Equal.
    Exact,
    /// Equal outside, not above the depth inside.
    ExactOutside,
    /// Neither above the distance nor above the depth, of the right sign.
    Bound,
}

use Claim::{Bound, Exact, ExactOutside};

/// Text, what it promises, its nearest point.
pub(crate) type Row = (&'static str, Claim, fn() -> Distance);

/// `z` is 0, constant or of a param.
pub(crate) const SOLIDS: &[Row] = &[
    ("sphere(0.8)", Exact, || ring_of_circles(0.0, 0.8)),
    ("box((0.7, 0.3, 0.9))", Exact, || cuboid([0.7, 0.3, 0.9])),
    ("torus(0.8, 0.3)", Exact, || ring_of_circles(0.8, 0.3)),
    ("torus(0.3, 0.7)", ExactOutside, || ring_of_circles(0.3, 0.7)),
    ("cylinder(0.5, 0.9)", Exact, || turned(vec![[0.0, -0.9], [0.5, -0.9], [0.5, 0.9], [0.0, 0.9]])),
    ("infinite_cylinder(0.6)", Exact, || turned(vec![[0.6, -1e3], [0.6, 1e3]])),
    ("cone(0.9, 0.7)", Exact, || turned(vec![[0.0, -0.7], [0.9, -0.7], [0.0, 0.7]])),
    ("cone(0.3, 0.7, top: 0.8)", Exact, || turned(vec![[0.0, -0.7], [0.3, -0.7], [0.8, 0.7], [0.0, 0.7]])),
    ("cone(0.9, 0.05, top: 0.1)", Exact, || {
        turned(vec![[0.0, -0.05], [0.9, -0.05], [0.1, 0.05], [0.0, 0.05]])
    }),
    ("capsule((-0.4, 0.2, 0.1), (0.5, -0.6, 0.7), 0.3)", Exact, || {
        thick_segment([-0.4, 0.2, 0.1], [0.5, -0.6, 0.7], 0.3)
    }),
    ("prism(3, 0.9, 0.4)", Exact, || between(ring(3, 0.9, -0.4, 0.0), ring(3, 0.9, 0.4, 0.0))),
    ("prism(5, 0.6, 0.9)", Exact, || between(ring(5, 0.6, -0.9, 0.0), ring(5, 0.6, 0.9, 0.0))),
    ("prism(12, 0.8, 0.2)", Exact, || between(ring(12, 0.8, -0.2, 0.0), ring(12, 0.8, 0.2, 0.0))),
    ("pyramid(0.7, 0.6)", Exact, || pyramid(0.7, 0.6)),
    ("pyramid(0.2, 0.9)", Exact, || pyramid(0.2, 0.9)),
    ("pyramid(0.9, 0.1)", Exact, || pyramid(0.9, 0.1)),
    ("plane((0.6, -2, 0.3), 0.4)", Exact, || half_space([0.6, -2.0, 0.3], 0.4)),
    ("ellipsoid((0.9, 0.3, 0.6))", Bound, || ellipsoid([0.9, 0.3, 0.6])),
    ("ellipsoid((0.7, 0.7, 0.7))", Exact, || ellipsoid([0.7, 0.7, 0.7])),
    ("octahedron(0.9)", Exact, || octahedron(0.9)),
    ("disk(0.8, thickness: 0.3)", Exact, || thick_disk(0.8, 0.15)),
    ("box((0.5, 0.2, 0.7)).round(0.2)", Exact, || grown(cuboid([0.5, 0.2, 0.7]), 0.2)),
    ("sphere(0.8).shell(0.2)", Exact, || {
        let sphere = ring_of_circles(0.0, 0.8);
        Box::new(move |p| sphere(p).abs() - 0.1)
    }),
    ("sphere(0.3).elongate((0, 0.5, 0))", ExactOutside, || {
        thick_segment([0.0, -0.5, 0.0], [0.0, 0.5, 0.0], 0.3)
    }),
    ("cylinder(0.3, 0.4).elongate((0, 0.5, 0))", ExactOutside, || {
        turned(vec![[0.0, -0.9], [0.3, -0.9], [0.3, 0.9], [0.0, 0.9]])
    }),
];

/// The same without some of their sizes.
pub(crate) const DEGENERATE: &[Row] = &[
    ("sphere(z)", Exact, || thick_segment([0.0; 3], [0.0; 3], 0.0)),
    ("box((0.7, z, 0.9))", Exact, || cuboid([0.7, 0.0, 0.9])),
    ("box((z, z, 0.9))", Exact, || cuboid([0.0, 0.0, 0.9])),
    ("box((z, z, z))", Exact, || cuboid([0.0; 3])),
    ("torus(0.8, z)", Exact, || ring_of_circles(0.8, 0.0)),
    ("torus(z, 0.3)", Exact, || ring_of_circles(0.0, 0.3)),
    ("cylinder(z, 0.9)", Exact, || turned(vec![[0.0, -0.9], [0.0, 0.9]])),
    ("cylinder(0.5, z)", Exact, || thick_disk(0.5, 0.0)),
    ("infinite_cylinder(z)", Exact, || turned(vec![[0.0, -1e3], [0.0, 1e3]])),
    ("cone(0.5, 0.7, top: 0.5 + z)", Exact, || {
        turned(vec![[0.0, -0.7], [0.5, -0.7], [0.5, 0.7], [0.0, 0.7]])
    }),
    ("cone(z, 0.7, top: z)", Exact, || turned(vec![[0.0, -0.7], [0.0, 0.7]])),
    ("cone(0.9, z, top: 0.4)", Exact, || thick_disk(0.9, 0.0)),
    ("cone(z, z)", Exact, || thick_segment([0.0; 3], [0.0; 3], 0.0)),
    ("capsule((0.3, 0.2, z), (0.3, 0.2, z), 0.4)", Exact, || {
        thick_segment([0.3, 0.2, 0.0], [0.3, 0.2, 0.0], 0.4)
    }),
    ("capsule((0.3, z, 0), (-0.3, 0.5, 0), z)", Exact, || {
        thick_segment([0.3, 0.0, 0.0], [-0.3, 0.5, 0.0], 0.0)
    }),
    ("prism(5, z, 0.9)", Exact, || thick_segment([0.0, -0.9, 0.0], [0.0, 0.9, 0.0], 0.0)),
    ("prism(5, 0.8, z)", Exact, || between(ring(5, 0.8, 0.0, 0.0), ring(5, 0.8, 0.0, 0.0))),
    ("pyramid(0.7, z)", Exact, || cuboid([0.7, 0.0, 0.7])),
    ("pyramid(z, 0.7)", Exact, || thick_segment([0.0, -0.7, 0.0], [0.0, 0.7, 0.0], 0.0)),
    ("pyramid(z, z)", Exact, || thick_segment([0.0; 3], [0.0; 3], 0.0)),
    ("octahedron(z)", Exact, || thick_segment([0.0; 3], [0.0; 3], 0.0)),
    ("disk(0.8, thickness: z)", Exact, || thick_disk(0.8, 0.0)),
    ("disk(z, thickness: 0.4)", Exact, || thick_disk(0.0, 0.2)),
    ("ellipsoid((0.9, 1e-6 + z, 0.9))", Bound, || ellipsoid([0.9, 1e-6, 0.9])),
    ("sphere(0.5).shell(z)", Exact, || {
        let sphere = ring_of_circles(0.0, 0.5);
        Box::new(move |p| sphere(p).abs())
    }),
    ("box((0.5, z, 0.7)).round(z)", Exact, || cuboid([0.5, 0.0, 0.7])),
    ("sphere(0.3).elongate((z, 0.5, z))", ExactOutside, || {
        thick_segment([0.0, -0.5, 0.0], [0.0, 0.5, 0.0], 0.3)
    }),
];

fn pyramid(half: f64, half_height: f64) -> Distance {
    let base = ring(4, half * 2f64.sqrt(), -half_height, 0.125);
    between(base, vec![[0.0, half_height, 0.0]; 4])
}

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let mut trials = Vec::new();
    for (i, &row) in SOLIDS.iter().enumerate() {
        let name = row.0.split('(').next().unwrap_or_default();
        trials.push(Trial::test(format!("primitives::{i:02}_{name}_is_at_its_distance"), move || {
            check(&Solid::new(row.0)?, row, &Place::HERE, POINTS)
        }));
    }
    trials.push(Trial::test("primitives::without_size", without_size));
    trials.push(Trial::test("primitives::far_off", || {
        elsewhere(&Place { offset: 1e4, size: 1.0 })?;
        elsewhere(&Place { offset: 12_345.678, size: 1.0 })
    }));
    trials.push(Trial::test("primitives::small", || elsewhere(&Place { offset: 0.0, size: 1e-4 })));
    trials.push(Trial::test("primitives::large", || elsewhere(&Place { offset: 0.0, size: 1e4 })));
    trials.push(Trial::test("primitives::gradients_point_away", gradients_point_away));
    trials
}

/// Where a solid is put, `(offset, -offset, offset)`, and how large it is made there.
struct Place {
    offset: f64,
    size: f64,
}

impl Place {
    const HERE: Self = Self { offset: 0.0, size: 1.0 };

    fn offset(&self) -> [f64; 3] {
        [self.offset, -self.offset, self.offset]
    }

    /// A position in the solid's own coordinates; exact for f32 positions near the solid.
    fn local(&self, p: [f32; 3]) -> [f64; 3] {
        let offset = self.offset();
        [0, 1, 2].map(|i| (f64::from(p[i]) - offset[i]) / self.size)
    }

    /// The nearest f32 position.
    fn world(&self, p: [f64; 3]) -> [f32; 3] {
        let offset = self.offset();
        [0, 1, 2].map(|i| (self.size * p[i] + offset[i]) as f32)
    }
}

/// Positions about a solid of size 1: most at random, one in eight on a plane or axis of symmetry, one in
/// sixteen far off.
fn positions(place: &Place, count: usize) -> Vec<[f32; 3]> {
    let mut random = Random::new(count as u64);
    let position = |i: usize| {
        let mut p = [(); 3].map(|()| random.between(-1.6, 1.6));
        match i % 16 {
            0 => p[i / 16 % 3] = 0.0,
            1 => p = [0, 1, 2].map(|k| if k == i / 16 % 3 { p[k] } else { 0.0 }),
            2 => p = direction(&mut random).map(|c| c * random.between(3.0, 30.0)),
            _ => {}
        }
        place.world(p)
    };
    let mut all: Vec<_> = (0..count).map(position).collect();
    all.push(place.world([0.0; 3]));
    all
}

/// Compares the f64 and the f32 distance with the nearest point; in f32 to 1.5e-6 of the solid's size and
/// of the distance from its centre, and what rounding the offset moves it by.
fn check(solid: &Solid, row: Row, place: &Place, count: usize) -> Result<(), Failed> {
    let (text, claim, nearest) = (row.0, row.1, row.2());
    let points = positions(place, count);
    let singles = solid.distances(&points)?;
    for (&point, single) in points.iter().zip(singles) {
        let local = place.local(point);
        let right = place.size * nearest(local);
        let scale = place.size * (1.0 + length(local));
        let double = solid.exact(point.map(f64::from));
        let moved = 1.1e-7 * place.offset;
        for (found, doubt) in [(double, 1e-9 * scale), (f64::from(single), 1.5e-6 * scale + moved)] {
            let exact = claim == Exact || claim == ExactOutside && right >= 0.0;
            let same_side = found * right >= 0.0 || found.abs() <= doubt || right.abs() <= doubt;
            let held = same_side && found.abs() <= right.abs() + doubt;
            let equal = (found - right).abs() <= doubt;
            ensure(if exact { equal } else { held }, || {
                format!("{text} at {point:?}: {found}, not {right}")
            })?;
        }
    }
    Ok(())
}

/// Sizes of 0 written as constants and set by a param.
fn without_size() -> Result<(), Failed> {
    for &row in DEGENERATE {
        for declaration in ["let z = 0", "param z: float = 0"] {
            let solid = Solid::with(declaration, row.0)?;
            check(&solid, row, &Place::HERE, FEWER)?;
            finite_gradients(&solid, row.0, &positions(&Place::HERE, FEWER))?;
        }
    }
    Ok(())
}

fn elsewhere(place: &Place) -> Result<(), Failed> {
    for &row in SOLIDS.iter().chain(DEGENERATE) {
        let [x, y, z] = place.offset();
        let text = format!("({}).scale({:e}).translate(({x:e}, {y:e}, {z:e}))", row.0, place.size);
        let solid = Solid::with("let z = 0", &text)?;
        check(&solid, row, place, FEWER)?;
        finite_gradients(&solid, &text, &positions(place, FEWER))?;
    }
    Ok(())
}

/// Gradients in f32 are finite and nowhere longer than 1.
fn finite_gradients(solid: &Solid, text: &str, points: &[[f32; 3]]) -> Result<(), Failed> {
    for (p, slope) in points.iter().zip(solid.slopes(points)?) {
        let size = length(slope.map(f64::from));
        ensure(size <= 1.0 + 1e-4, || format!("{text} at {p:?}: gradient {slope:?}"))?;
    }
    Ok(())
}

/// Away from where two nearest points are equally far, the gradient of an exact distance is the unit
/// vector from the nearest point: the distance grows by as much as one goes that way.
fn gradients_point_away() -> Result<(), Failed> {
    for &row in SOLIDS.iter().filter(|row| row.1 == Exact) {
        let (solid, nearest) = (Solid::new(row.0)?, row.2());
        let points = positions(&Place::HERE, 2000);
        finite_gradients(&solid, row.0, &points)?;
        let mut unit = 0;
        for (p, slope) in points.iter().zip(solid.slopes(&points)?) {
            let (p, slope) = (p.map(f64::from), slope.map(f64::from));
            let ahead = crate::solid::along(p, slope, 1e-4);
            let rise = (nearest(ahead) - nearest(p)) / 1e-4;
            let good = (length(slope) - 1.0).abs() < 1e-4 && (rise - 1.0).abs() < 1e-3;
            unit += usize::from(good);
        }
        ensure(unit > 1880, || format!("{}: {unit} of 2000 gradients lead away", row.0))?;
    }
    Ok(())
}
