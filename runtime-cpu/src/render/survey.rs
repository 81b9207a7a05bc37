//! How large media are to the eye, for the first step of the pilot.
//!
//! A step that is longer than what is seen of a medium finds nothing, and half of it nothing either: the
//! pilot would be content. So some rays are probed first: how far each looks into media until nothing more
//! arrives, and how dense they are. Bounded media are probed at even distances, boundless ones at distances
//! that grow, since only their density says how much of them is seen.

use super::camera::{Ray, slab};
use super::fields::{Fields, Points};
use super::scene::Scene;
use crate::real::largest;
use vol_compiler::frame::{Frame, Job, Quadrature, Sampling};

/// Rays that are probed.
const RAYS: usize = 64;

/// Probes along each.
const PROBES: usize = 96;

/// A longer way through boxes counts as boundless.
pub(super) const LONGEST: f32 = 1e5;

/// From the first growing distance to the last.
const REACH: f32 = 1e9;

/// Optical depth behind which nothing is seen.
const DEEP: f32 = 8.0;

/// The first step is this fraction of the way seen through media.
const FRACTION: f32 = 1.0 / 24.0;

/// The first step has at most this optical depth where media are dense.
const MOST_DEPTH: f32 = 2.0;

/// The pilot's first step.
pub(super) fn first_step<F: Fields<Real = f32>>(frame: &Frame, rays: &[Ray<f32>], mut fields: F) -> f32 {
    let job = Job {
        size: [1, 1],
        step: 1.0,
        shadow_step: 1.0,
        quadrature: Quadrature::Midpoint,
        sampling: Sampling::CENTRE,
    };
    let scene = Scene::<f32>::new(frame, &job);
    let size = scene_size(frame);
    let mut ways: Vec<[f32; 2]> =
        rays.iter().take(RAYS).filter_map(|ray| way(&scene, &mut fields, ray, size)).collect();
    if ways.is_empty() {
        return FRACTION * size;
    }
    // Half of the rays look less far; a tenth of them meet denser parts.
    let length = quantile(&mut ways, 0, 0.5);
    let density = quantile(&mut ways, 1, 0.9);
    let thick = if density > 0.0 { MOST_DEPTH / density } else { f32::INFINITY };
    (FRACTION * length).min(thick).max(1e-6 * size)
}

/// One of two numbers of which a fraction of all is below.
fn quantile(ways: &mut [[f32; 2]], which: usize, fraction: f32) -> f32 {
    ways.sort_by(|a, b| a[which].total_cmp(&b[which]));
    ways[((ways.len() - 1) as f32 * fraction) as usize][which]
}

/// Diagonal of the box around everything bounded, 1 if there is none.
fn scene_size(frame: &Frame) -> f32 {
    let diagonal = frame.bounds.diagonal();
    if diagonal > 0.0 && diagonal < LONGEST { diagonal } else { 1.0 }
}

/// How far a ray looks into media, and their largest extinction on the way; nothing if it finds none.
fn way<F: Fields<Real = f32>>(
    scene: &Scene<f32>,
    fields: &mut F,
    ray: &Ray<f32>,
    size: f32,
) -> Option<[f32; 2]> {
    // The part of the ray that is in boxes.
    let (mut entry, mut exit) = (f32::INFINITY, 0.0_f32);
    for medium in &scene.media {
        let span = slab(ray, medium.lo, medium.hi);
        if span.is_some() {
            (entry, exit) = (entry.min(span.entry), exit.max(span.exit));
        }
    }
    let length = exit - entry;
    let at = |index: usize| {
        let part = (index as f32 + 0.5) / PROBES as f32;
        if length < LONGEST { part * length } else { 1e-3 * size * REACH.powf(part) }
    };
    let points: Points<f32> = (0..PROBES).map(|index| ray.at(entry + at(index))).collect();
    let mut extinction = [0.0_f32; PROBES];
    let mut seen = [false; PROBES];
    for medium in &scene.media {
        let [region] = fields.sample(medium.region, &points);
        let [density, r, g, b] = fields.sample(medium.extinction, &points);
        for probe in (0..PROBES).filter(|&probe| region[probe] < 0.0 && density[probe] > 0.0) {
            seen[probe] = true;
            extinction[probe] += density[probe] * largest([r[probe], g[probe], b[probe]]);
        }
    }
    // Walk until nothing more arrives.
    let first = seen.iter().position(|&seen| seen)?;
    let start = if first == 0 { 0.0 } else { at(first - 1) };
    let (mut depth, mut densest, mut last, mut before) = (0.0, 0.0_f32, start, start);
    for probe in first..PROBES {
        if depth > DEEP {
            break;
        }
        let t = at(probe);
        depth += extinction[probe] * (t - before);
        densest = densest.max(extinction[probe]);
        last = if seen[probe] { t } else { last };
        before = t;
    }
    let way = last - start;
    Some([if way > 0.0 { way } else { at(first) }, densest])
        .filter(|way| way[0].is_finite() && way[1].is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles() {
        let mut ways = [[3.0, 1.0], [1.0, 5.0], [2.0, 4.0]];
        assert_eq!(quantile(&mut ways, 0, 0.5), 2.0);
        assert_eq!(quantile(&mut ways, 1, 0.0), 1.0);
        assert_eq!(quantile(&mut ways, 1, 1.0), 5.0);
    }
}
