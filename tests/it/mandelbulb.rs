//! The Mandelbulb against its iteration, done again here with angles in f64.

use crate::solid::{Solid, along, direction, length};
use crate::support::{Random, ensure};
use libtest_mimic::{Failed, Trial};

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("mandelbulb::nothing_is_nearer_than_the_distance", nothing_is_nearer),
        Trial::test("mandelbulb::surface_is_in_front_of_the_set", surface_is_in_front),
        Trial::test("mandelbulb::few_iterations_are_a_level", few_iterations_are_a_level),
        Trial::test("mandelbulb::power_is_that_of_the_angles", power_is_that_of_the_angles),
        Trial::test("mandelbulb::whole_powers_have_no_angles", whole_powers_have_no_angles),
        Trial::test("mandelbulb::derivative_along_the_axis", derivative_along_the_axis),
        Trial::test("mandelbulb::slopes_are_those_of_the_distance", slopes_are_right),
        Trial::test("mandelbulb::surface_has_normals", surface_has_normals),
        Trial::test("mandelbulb::all_is_finite", all_is_finite),
    ]
}

/// Powers, whole ones and others.
const POWERS: [f64; 12] = [2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.3, 8.0, 9.0, 11.5, 12.0, 32.0];

/// The default detail.
const DETAIL: f64 = 1e-3;

/// `z^n + p` by angles.
fn step(z: [f64; 3], p: [f64; 3], n: f64) -> [f64; 3] {
    let rho = z[0].hypot(z[1]);
    let (tilt, turn) = (n * rho.atan2(z[2]), n * z[1].atan2(z[0]));
    let size = length(z).powf(n);
    let power = [tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos()];
    along(p, power, size)
}

/// The last `|z|` after some iterations, or the first beyond the radius from which all leave.
fn last(p: [f64; 3], n: f64, iterations: u32) -> f64 {
    let escape = 2f64.powf(1.0 / (n - 1.0));
    let mut z = p;
    for _ in 0..iterations {
        if length(z) > escape {
            break;
        }
        z = step(z, p, n);
    }
    length(z)
}

/// Whether a point has not left.
fn stays(p: [f64; 3], n: f64, iterations: u32) -> bool {
    last(p, n, iterations) <= 2f64.powf(1.0 / (n - 1.0))
}

fn single(p: [f64; 3]) -> [f32; 3] {
    p.map(|c| c as f32)
}

fn double(p: [f32; 3]) -> [f64; 3] {
    p.map(f64::from)
}

/// Points about a bulb, of which seven eighths have come nearer to its surface by up to seven steps.
fn points(solid: &Solid, count: usize, seed: u64) -> Result<Vec<[f32; 3]>, Failed> {
    let mut random = Random::new(seed);
    let reach = f64::from(solid.frame.objects[0].bounds.hi[0]);
    let mut points: Vec<[f32; 3]> =
        (0..count).map(|_| single([(); 3].map(|()| random.between(-1.2 * reach, 1.2 * reach)))).collect();
    let ways: Vec<[f64; 3]> = (0..count).map(|_| direction(&mut random)).collect();
    for round in 1..8 {
        let distances = solid.distances(&points)?;
        for (i, point) in points.iter_mut().enumerate().filter(|(i, _)| i % 8 >= round) {
            *point = single(along(double(*point), ways[i], 0.5 * f64::from(distances[i].abs())));
        }
    }
    Ok(points)
}

/// No point of the set, and none of the solid, is within the distance of a point outside; none outside
/// the solid is within the depth of one inside. The nearest found is 1.05 times as far.
fn nothing_is_nearer() -> Result<(), Failed> {
    let mut random = Random::new(7);
    for n in POWERS {
        for iterations in [3, 14] {
            let solid = Solid::new(&format!("mandelbulb(power: {n}, iterations: {iterations})"))?;
            let points = points(&solid, 3000, u64::from(iterations))?;
            let distances = solid.distances(&points)?;
            let mut tries = Vec::new();
            let mut near = Vec::new();
            for (point, &distance) in points.iter().zip(&distances) {
                for _ in 0..6 {
                    let part = random.between(0.0, 1.0).sqrt();
                    let q = along(double(*point), direction(&mut random), part * f64::from(distance.abs()));
                    tries.push((*point, distance, q));
                    near.push(single(q));
                }
            }
            for ((p, distance, q), there) in tries.into_iter().zip(solid.distances(&near)?) {
                let right =
                    if distance > 0.0 { there >= 0.0 && !stays(q, n, iterations) } else { there <= 0.0 };
                ensure(right, || format!("power {n}: {distance} at {p:?}, but {there} at {q:?}"))?;
            }
        }
    }
    Ok(())
}

/// What stays is inside; what is on the surface is off the set by about the detail.
fn surface_is_in_front() -> Result<(), Failed> {
    let mut random = Random::new(3);
    for n in POWERS {
        let solid = Solid::new(&format!("mandelbulb(power: {n}, iterations: 20)"))?;
        let points = points(&solid, 4000, 5)?;
        let distances = solid.distances(&points)?;
        for (point, &distance) in points.iter().zip(&distances) {
            let p = double(*point);
            ensure(!stays(p, n, 20) || distance < 0.0, || format!("power {n}: {p:?} stays at {distance}"))?;
        }
        // From the surface the set is found within some detail, but for a part of the places.
        let surface: Vec<_> = points.iter().zip(&distances).filter(|(_, d)| d.abs() < 5e-4).collect();
        let found = surface.iter().filter(|(point, _)| {
            (0..400).any(|_| {
                let far = random.between(0.0, 8.0 * DETAIL);
                stays(along(double(**point), direction(&mut random), far), n, 20)
            })
        });
        let (found, all) = (found.count(), surface.len());
        ensure(all > 30 && 10 * found > 3 * all, || format!("power {n}: the set near {found} of {all}"))?;
    }
    Ok(())
}

/// With few iterations the surface is a smooth level of |z|, the detail in front of it.
fn few_iterations_are_a_level() -> Result<(), Failed> {
    let mut random = Random::new(11);
    for n in [2.0, 3.0, 8.0] {
        let solid = Solid::new(&format!("mandelbulb(power: {n}, iterations: 2, detail: 1e-6)"))?;
        for _ in 0..80 {
            // The crossing of a ray from afar, by halving.
            let way = direction(&mut random);
            let (mut low, mut high) = (0.0, 3.0);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if solid.exact(along([0.0; 3], way, middle)) < 0.0 { low = middle } else { high = middle }
            }
            let found = last(along([0.0; 3], way, low), n, 2) / 2f64.powf(1.0 / (n - 1.0));
            ensure((found - 1.0).abs() < 1e-3, || {
                format!("power {n}: |z| is {found} of the radius along {way:?}")
            })?;
        }
    }
    Ok(())
}

/// By products of cosines it is as by angles, and a param is as a constant.
fn power_is_that_of_the_angles() -> Result<(), Failed> {
    for n in [2, 3, 5, 7, 8, 12] {
        let constant = Solid::new(&format!("mandelbulb(power: {n})"))?;
        let declared = format!("param n: float = {n} in 2..32\nparam k: int = 12 in 1..20");
        let param = Solid::with(&declared, "mandelbulb(power: n, iterations: k)")?;
        for point in points(&constant, 400, 17)? {
            let p = double(point);
            let (a, b) = (constant.exact(p), param.exact(p));
            // Without a whole power the cut behind the axis is kept away from, too.
            let right = (a - b).abs() < 1e-7 || (b.abs() < a.abs() && a * b >= 0.0);
            ensure(right, || format!("power {n} at {p:?}: {a} and {b}"))?;
        }
    }
    Ok(())
}

/// On the axis z, where the power is that of a number, the distance is half the potential over its
/// derivative; `dr` is computed here as a number's. Nearer and nearer to the set more iterations are taken.
fn derivative_along_the_axis() -> Result<(), Failed> {
    for n in [2, 3, 8] {
        let power = f64::from(n);
        let escape = 2f64.powf(1.0 / (power - 1.0));
        let solid = Solid::new(&format!("mandelbulb(power: {n}, iterations: 1000, detail: 1e-6)"))?;
        // Where the parabola of fixed points ends.
        let tip = (power - 1.0) * power.powf(-power / (power - 1.0));
        let mut longest = 0;
        for i in 1..60 {
            let p = f64::from((tip * (1.0 + 0.8f64.powi(i) * (escape / tip - 1.0))) as f32);
            let (mut z, mut slope, mut any, mut most, mut steps) = (p, 1.0f64, 1.0f64, 1.0f64, 0);
            while z < 2f64.powf(8.0 / power) && slope < 64e6 && any < 4096e6 && steps < 1000 {
                let factor = power * z.powi(n - 1);
                slope = factor * slope + 1.0;
                any = power * factor * any + 1.0;
                most = most.max(any);
                z = z.powi(n) + p;
                steps += 1;
            }
            if z < 2f64.powf(8.0 / power) {
                continue;
            }
            longest = longest.max(steps);
            let level = power.powi(steps - 1000) * escape.ln();
            let expected = (0.5 * z * (z.ln() - level) / slope - 1e-6) * slope / most;
            let (double, single) = (solid.exact([0.0, 0.0, p]), solid.distances(&[[0.0, 0.0, p as f32]])?[0]);
            ensure((double / expected - 1.0).abs() < 1e-9, || {
                format!("power {n} at {p}: {double}, not {expected}")
            })?;
            let off = (f64::from(single) / expected - 1.0).abs();
            ensure(off < 1e-3, || format!("power {n} at {p}: {single} in f32, not {expected}"))?;
        }
        ensure(longest >= 5, || format!("power {n}: at most {longest} iterations"))?;
    }
    Ok(())
}

/// A constant whole power needs no angle; any other does.
fn whole_powers_have_no_angles() -> Result<(), Failed> {
    for (arguments, angles) in [("", false), ("power: 7", false), ("power: 32", false), ("power: 2.5", true)]
    {
        let text = Solid::new(&format!("mandelbulb({arguments})"))?.text();
        let found = ["Sin", "Cos", "Atan2", "Acos"].iter().any(|op| text.contains(&format!("op: {op}")));
        ensure(found == angles && text.contains("op: Sqrt"), || format!("mandelbulb({arguments}): {text}"))?;
    }
    Ok(())
}

/// Gradients against differences of the f64 distance, where these agree with themselves.
fn slopes_are_right() -> Result<(), Failed> {
    for n in [2.0, 2.5, 8.0, 9.0] {
        for iterations in [2, 30, 300] {
            let solid = Solid::new(&format!("mandelbulb(power: {n}, iterations: {iterations})"))?;
            let mut compared = 0;
            for point in points(&solid, 150, 23)? {
                let p = double(point);
                let difference = |axis: usize, h: f64| {
                    let unit = [0, 1, 2].map(|i| if i == axis { 1.0 } else { 0.0 });
                    (solid.exact(along(p, unit, h)) - solid.exact(along(p, unit, -h))) / (2.0 * h)
                };
                let slope = solid.slope(p);
                for axis in 0..3 {
                    let (coarse, fine) = (difference(axis, 2e-8), difference(axis, 1e-8));
                    if (coarse - fine).abs() < 1e-5 * (1.0 + fine.abs()) {
                        compared += 1;
                        ensure((slope[axis] - fine).abs() < 1e-4 * (1.0 + fine.abs()), || {
                            format!("power {n}, {iterations} at {p:?}: {slope:?}, axis {axis} {fine}")
                        })?;
                    }
                }
            }
            ensure(compared > 225, || format!("power {n}, {iterations}: {compared} smooth places"))?;
        }
    }
    Ok(())
}

/// A little inside the surface, as the renderer asks, the f32 gradient is one to make unit length, and
/// in the mean turns towards the eye.
fn surface_has_normals() -> Result<(), Failed> {
    for n in [2.0, 3.0, 7.3, 8.0, 12.0] {
        let solid = Solid::new(&format!("mandelbulb(power: {n}, iterations: 1000)"))?;
        let mut random = Random::new(29);
        let ways: Vec<[f64; 3]> = (0..400).map(|_| direction(&mut random)).collect();
        let mut places = vec![3.0f64; ways.len()];
        let mut hit = vec![false; ways.len()];
        for _ in 0..2000 {
            if hit.iter().all(|&hit| hit) {
                break;
            }
            let at: Vec<_> =
                ways.iter().zip(&places).map(|(&way, &t)| single(along([0.0; 3], way, t))).collect();
            for (i, distance) in solid.distances(&at)?.into_iter().enumerate() {
                hit[i] |= distance < 0.0;
                places[i] -= if hit[i] { 0.0 } else { f64::from(distance).max(2e-6) };
            }
        }
        let inside: Vec<_> =
            ways.iter().zip(&places).map(|(&way, &t)| single(along([0.0; 3], way, t - 5e-5))).collect();
        let (mut hits, mut facing) = (0, 0);
        for (i, slope) in solid.slopes(&inside)?.into_iter().enumerate().filter(|(i, _)| hit[*i]) {
            let slope = double(slope);
            let size = length(slope);
            ensure(size > 1e-3 && size < 1e3, || format!("power {n}: slope {slope:?} along {:?}", ways[i]))?;
            hits += 1;
            facing += usize::from((0..3).map(|k| slope[k] * ways[i][k]).sum::<f64>() > 0.0);
        }
        ensure(hits > 340, || format!("power {n}: {hits} of 400 rays hit"))?;
        ensure(100 * facing > 97 * hits, || format!("power {n}: {facing} of {hits} normals face the eye"))?;
    }
    Ok(())
}

/// Distances and gradients are finite at any place with any number of iterations.
fn all_is_finite() -> Result<(), Failed> {
    let special: Vec<[f32; 3]> = [0.0, 1e-30, 1e-10, 1e-5, 0.3, 1.0, 1.2, 2.0, 1e4, 1e15]
        .into_iter()
        .flat_map(|x: f32| {
            [[x, 0.0, 0.0], [0.0, -x, 0.0], [0.0, 0.0, x], [0.0, 0.0, -x], [-x, -x, x], [x, x, -x]]
        })
        .collect();
    for n in POWERS.into_iter().step_by(2).chain([32.0]) {
        for (iterations, detail) in [(0, 1e-3), (1, 1e-6), (30, 1e-6), (1024, 1e-6), (1024, 0.1)] {
            let solid = Solid::new(&format!(
                "mandelbulb(power: {n}, iterations: {iterations}, detail: {detail:.6})"
            ))?;
            let mut all = points(&solid, 600, 31)?;
            all.extend_from_slice(&special);
            for (p, distance) in all.iter().zip(solid.distances(&all)?) {
                ensure(distance.is_finite(), || format!("power {n}, {iterations}: {distance} at {p:?}"))?;
            }
            for (p, slope) in all.iter().zip(solid.slopes(&all)?) {
                ensure(slope.iter().all(|c| c.is_finite()), || {
                    format!("power {n}, {iterations}: {slope:?} at {p:?}")
                })?;
            }
        }
    }
    Ok(())
}
