//! How much of a light with a size is seen past the solids: soft shadows.
//!
//! The light is a disk across the direction towards its centre. A ray to its centre and, where that
//! does not settle it, eight to its rim measure how clear of solids they are: the smallest angle between
//! the ray and a solid, in radii of the light. A disk of that radius around the ray's end is lit,
//! so the lit part of the light is the union of nine disks; its area is summed over 19 places. Nothing is drawn by chance,
//! and the part changes steadily from point to point.
//!
//! * error of the part against the area of the disk that hard rays see: 0.09 for an edge of any
//!   direction, a convex corner, a strip and balls of 0.3 to 3 times the light's radius, exactly 1 where the
//!   light is clear and exactly 0 where all nine rays are blocked (test `penumbra_matches_many_rays`)
//! * a solid's inside is never asked for how deep it is, so that a thin wall hides as well as a thick one
//! * method: the clearance is that of cone tracing with distances (R. Aaltonen, "GPU-based clay
//!   simulation and ray-tracing tech in Claybook", GDC 2018); the union of clear disks is the lower of the
//!   two extensions of a 1-Lipschitz function (E. J. McShane 1934), here of the clearance over the disk
//!
//! Twin: `compiler/src/wgsl/render/penumbra.wgsl`.

use super::camera::{FAR, Ray, Span, slab};
use super::fields::Fields;
use super::near::Met;
use super::scene::{Integrator, Stride};
use super::shadow::ShadowRay;
use super::stride::Ahead;
use super::surface::{EPSILON, MAX_STEPS};
use crate::real::{Real, Vec3, add, length, scale, sub};
use std::f32::consts::FRAC_1_SQRT_2;

/// Directions from the centre of the light to the rim.
const RIM: [[f32; 2]; 8] = [
    [1.0, 0.0],
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.0, 1.0],
    [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [-1.0, 0.0],
    [-FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
    [0.0, -1.0],
    [FRAC_1_SQRT_2, -FRAC_1_SQRT_2],
];

/// Where the lit part is asked for, in radii of the light: the centre and rings of 6 and 12, each place
/// for the same area.
const PLACES: [[f32; 2]; 19] = [
    [0.0, 0.0],
    [0.4, 0.0],
    [0.2, 0.346_410_2],
    [-0.2, 0.346_410_2],
    [-0.4, 0.0],
    [-0.2, -0.346_410_2],
    [0.2, -0.346_410_2],
    [0.772_740_7, 0.207_055_2],
    [0.565_685_4, 0.565_685_4],
    [0.207_055_2, 0.772_740_7],
    [-0.207_055_2, 0.772_740_7],
    [-0.565_685_4, 0.565_685_4],
    [-0.772_740_7, 0.207_055_2],
    [-0.772_740_7, -0.207_055_2],
    [-0.565_685_4, -0.565_685_4],
    [-0.207_055_2, -0.772_740_7],
    [0.207_055_2, -0.772_740_7],
    [0.565_685_4, -0.565_685_4],
    [0.772_740_7, -0.207_055_2],
];

/// Largest clearance that is measured: the light's diameter.
const CLEAR: f32 = 2.0;

/// A place counts in part where it is nearer than this to the edge of the lit part.
const BLUR: f32 = 0.3;

/// The union of disks lacks a little between them; as much is added to each on average.
const LACK: f32 = 0.05;

/// A light as a shadow ray sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone<R> {
    /// From the point to the centre of the light.
    pub(crate) shadow: ShadowRay<R>,
    /// Tangent of half the angle across the light.
    pub(crate) slope: R,
}

/// A ray on its way along a cone.
#[derive(Clone, Copy, Debug)]
struct Feeler<R> {
    /// Index of the cone.
    cone: usize,
    /// Distance walked.
    t: R,
    /// The last two samples, the older first: `[1 / t, y]`, y the squared sine of the clearance.
    last: [[R; 2]; 2],
}

/// What a feeler has around it.
#[derive(Clone, Copy, Debug)]
struct Around<R> {
    /// Distance to the nearest solid as the scene gives it.
    distance: R,
    /// The same, safe to walk.
    safe: R,
    /// Distance along the ray to the next box.
    gap: R,
}

impl<F: Fields> Integrator<'_, F> {
    /// Fraction of each light that no solid hides.
    pub(super) fn lit_parts(&mut self, cones: &[Cone<F::Real>]) -> Vec<F::Real> {
        let one = F::Real::ONE;
        let centres = self.clearances(cones);
        let mut parts = vec![one; cones.len()];
        let unsettled: Vec<usize> = (0..cones.len()).filter(|&cone| centres[cone] < one).collect();
        let rims: Vec<_> = unsettled.iter().flat_map(|&cone| rim(&cones[cone])).collect();
        let clearances = self.clearances(&rims);
        for (cone, rim) in unsettled.into_iter().zip(clearances.chunks_exact(RIM.len())) {
            parts[cone] = lit_part(centres[cone], rim);
        }
        parts
    }

    /// How far each ray stays clear of all solids, in radii of the light: 0 where it enters one, at most
    /// [`CLEAR`].
    fn clearances(&mut self, cones: &[Cone<F::Real>]) -> Vec<F::Real> {
        self.stats.shadow_rays += cones.len() as u64;
        let batches = cones.chunks(self.batches.rays);
        batches.flat_map(|batch| self.walk(batch)).collect()
    }

    /// Walks along the axes of cones and keeps the smallest angle to a solid.
    fn walk(&mut self, cones: &[Cone<F::Real>]) -> Vec<F::Real> {
        let zero = F::Real::ZERO;
        let mut lowest: Vec<_> = cones.iter().map(|cone| squared_sine(wide(cone.slope))).collect();
        let met = self.met_by_cones(cones);
        let mut feelers: Vec<_> =
            (0..cones.len()).map(|cone| Feeler { cone, t: zero, last: [[zero; 2]; 2] }).collect();
        for _ in 0..MAX_STEPS {
            let around = self.around(cones, &met, &feelers);
            let mut left = Vec::with_capacity(feelers.len());
            for (feeler, around) in feelers.into_iter().zip(around) {
                let cone = &cones[feeler.cone];
                // A ray that enters a solid is not clear at all.
                if cone.shadow.enters(around.distance, feeler.t) {
                    lowest[feeler.cone] = zero;
                    continue;
                }
                let end = cone.shadow.length.min(F::Real::from_f32(FAR));
                // Count what is surely not behind the light.
                let counts =
                    (feeler.t > zero) & (around.distance >= zero) & (around.distance < end - feeler.t);
                let divisor = if counts { feeler.t } else { F::Real::ONE };
                let sine = (around.distance / divisor).min(F::Real::ONE);
                let sample = [F::Real::ONE / divisor, sine * sine];
                let [older, newer] = feeler.last;
                let found = sample[1].min(least(older, newer, sample));
                let before = lowest[feeler.cone];
                lowest[feeler.cone] = if counts { before.min(found) } else { before };
                let last = if counts { [newer, sample] } else { [[zero; 2]; 2] };
                let t = feeler.t + cone_step(cone, &around, feeler.t);
                if t < end {
                    left.push(Feeler { cone: feeler.cone, t, last });
                }
            }
            feelers = left;
            if feelers.is_empty() {
                break;
            }
        }
        lowest.into_iter().zip(cones).map(|(lowest, cone)| clearance(lowest, cone.slope)).collect()
    }

    /// The solids whose boxes are within cones, with the parts of the rays where they are.
    fn met_by_cones(&self, cones: &[Cone<F::Real>]) -> Vec<Met<F::Real>> {
        let part = |cone: usize, lo, hi| {
            let Cone { shadow: ShadowRay { ray, length: end, .. }, slope } = &cones[cone];
            let below = sub(lo, ray.origin).map(Real::abs);
            let above = sub(hi, ray.origin).map(Real::abs);
            let farthest = length([0, 1, 2].map(|axis| below[axis].max(above[axis])));
            let width = wide(*slope) * farthest.min(*end);
            Some(slab(ray, lo.map(|x| x - width), hi.map(|x| x + width)).loosened()).filter(Span::is_some)
        };
        Met::of(&self.scene.ask_boxes(cones.len(), part))
    }

    /// Looks around from every feeler.
    fn around(
        &mut self,
        cones: &[Cone<F::Real>],
        all_met: &[Met<F::Real>],
        feelers: &[Feeler<F::Real>],
    ) -> Vec<Around<F::Real>> {
        let far = F::Real::from_f32(FAR);
        let mut all = vec![Around { distance: far, safe: far, gap: far }; feelers.len()];
        let scene = self.scene;
        let feeler_in = by_ray(cones.len(), feelers.iter().map(|feeler| feeler.cone));
        for met in all_met {
            let solid = &scene.solids[met.solid];
            // Find the feelers near this solid's box, and how far the others are from it.
            let mut here = Vec::with_capacity(met.parts.len());
            for &(cone, span) in &met.parts {
                let Some(which) = feeler_in[cone] else { continue };
                let (t, around) = (feelers[which].t, &mut all[which]);
                if t < span.entry {
                    around.gap = around.gap.min(span.entry - t);
                } else if t <= span.exit {
                    here.push(which);
                }
            }
            if here.is_empty() {
                continue;
            }
            let places = here.iter().map(|&which| &feelers[which]);
            let points = places.map(|feeler| cones[feeler.cone].shadow.ray.at(feeler.t)).collect();
            let [mut distances] = self.fields.sample(solid.distance, &points);
            self.stats.surface_evaluations += here.len() as u64;
            let ahead = |index: usize| {
                let feeler: &Feeler<F::Real> = &feelers[here[index]];
                Ahead { ray: cones[feeler.cone].shadow.ray, t: feeler.t, last: F::Real::ZERO }
            };
            let mut safe = distances.clone();
            self.shorten(solid, ahead, &mut safe);
            // A field in units of its own is as far from 0 as its slope there says.
            if matches!(solid.stride, Stride::Within(_)) {
                distances.clone_from(&safe);
            }
            for (i, which) in here.into_iter().enumerate() {
                all[which].distance = all[which].distance.min(distances[i]);
                all[which].safe = all[which].safe.min(safe[i]);
            }
        }
        all
    }
}

/// Tangent of the widest clearance that is measured.
fn wide<R: Real>(slope: R) -> R {
    R::from_f32(CLEAR) * slope
}

/// Squared sine of an angle from its tangent.
fn squared_sine<R: Real>(tangent: R) -> R {
    let squared = tangent * tangent;
    squared / (R::ONE + squared)
}

/// A clearance in radii of the light from its squared sine.
fn clearance<R: Real>(squared_sine: R, slope: R) -> R {
    let cosine = (R::ONE - squared_sine).max(R::from_f32(EPSILON));
    ((squared_sine / cosine).sqrt() / slope).min(R::from_f32(CLEAR))
}

/// How far to walk: out of the cone's reach at once, else by half the distance, so that the samples are
/// dense where a solid is near; nothing thinner than 1/500 of the light is sure to be seen.
fn cone_step<R: Real>(cone: &Cone<R>, around: &Around<R>, t: R) -> R {
    let sine = squared_sine(wide(cone.slope)).sqrt();
    let free = (around.safe - sine * t) / (R::ONE + sine);
    let half = R::from_f32(0.5) * around.safe;
    let shortest = cone.shadow.stride.max((R::from_f32(0.002) * cone.slope) * t);
    free.max(half).min(around.gap).max(shortest)
}

/// Least value of the parabola through three samples if the middle one is the lowest, else that.
///
/// Near an edge and along a plane the squared sine is a parabola of 1 / t. Samples lie half a distance
/// apart, so that the true minimum is at least 0.75 of the lowest; what falls below is no parabola.
fn least<R: Real>(a: [R; 2], b: [R; 2], c: [R; 2]) -> R {
    let in_order = (a[0] > b[0]) & (b[0] > c[0]);
    let lowest = (b[1] <= a[1]) & (b[1] <= c[1]);
    if !(in_order & lowest) {
        return c[1];
    }
    let fall = (b[1] - a[1]) / (b[0] - a[0]);
    let rise = (c[1] - b[1]) / (c[0] - b[0]);
    let bend = (rise - fall) / (c[0] - a[0]);
    if bend <= R::ZERO {
        return b[1];
    }
    let half = R::from_f32(0.5);
    let place = half * (a[0] + b[0]) - half * (fall / bend);
    let value = a[1] + (place - a[0]) * (fall + bend * (place - b[0]));
    value.max(R::from_f32(0.75) * b[1]).min(b[1])
}

/// The rays to the rim of a light.
fn rim<R: Real>(cone: &Cone<R>) -> [Cone<R>; 8] {
    let direction = cone.shadow.ray.direction;
    let (right, up) = across(direction);
    RIM.map(|[x, y]| {
        let aside = add(scale(right, R::from_f32(x)), scale(up, R::from_f32(y)));
        let toward = add(direction, scale(aside, cone.slope));
        let size = length(toward);
        let ray = Ray::new(cone.shadow.ray.origin, toward.map(|c| c / size));
        Cone { shadow: ShadowRay { ray, ..cone.shadow }, ..*cone }
    })
}

/// Two unit vectors across a unit vector and each other.
///
/// * source: T. Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017
fn across<R: Real>([x, y, z]: Vec3<R>) -> (Vec3<R>, Vec3<R>) {
    let sign = if z < R::ZERO { -R::ONE } else { R::ONE };
    let a = -R::ONE / (sign + z);
    let b = (x * y) * a;
    ([R::ONE + sign * ((x * x) * a), sign * b, -(sign * x)], [b, sign + (y * y) * a, -y])
}

/// Area of the union of clear disks around the centre and the places on the rim, over that of the light.
fn lit_part<R: Real>(centre: R, rim: &[R]) -> R {
    let mut sum = R::ZERO;
    for place in PLACES {
        // How far inside the lit part the place is, at least.
        let mut inside = clear_depth(centre, [0.0; 2], place);
        for (&clear, end) in rim.iter().zip(RIM) {
            inside = inside.max(clear_depth(clear, end, place));
        }
        let edge = (inside + R::from_f32(LACK)) / R::from_f32(BLUR);
        let edge = edge.max(-R::ONE).min(R::ONE);
        let over = R::ONE + edge;
        sum = sum + (R::from_f32(0.25) * (over * over)) * (R::from_f32(2.0) - edge);
    }
    let part = sum / R::from_index(PLACES.len() as i32);
    // Reach 1 where the centre is clear of the whole light, and 0 where nothing is clear.
    let four = R::from_f32(4.0);
    let whole = (four * centre - R::from_f32(3.0)).max(R::ZERO);
    let part = part + (R::ONE - part) * (whole * whole);
    let widest = rim.iter().fold(centre, |widest, &clear| widest.max(clear));
    part * (R::from_f32(10.0) * widest).min(R::ONE)
}

/// How deep a place lies in the clear disk around the end of a ray; far outside if the ray is blocked.
fn clear_depth<R: Real>(clear: R, end: [f32; 2], place: [f32; 2]) -> R {
    let x = R::from_f32(place[0]) - R::from_f32(end[0]);
    let y = R::from_f32(place[1]) - R::from_f32(end[1]);
    let aside = (x * x + y * y).sqrt();
    if clear > R::ZERO { clear - aside } else { -R::from_f32(CLEAR) }
}

/// Which of those that are still on their way is on each of `count` rays.
fn by_ray(count: usize, walking: impl Iterator<Item = usize>) -> Vec<Option<usize>> {
    let mut which = vec![None; count];
    walking.enumerate().for_each(|(index, ray)| which[ray] = Some(index));
    which
}
