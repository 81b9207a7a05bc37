//! The plain marcher, as a baseline: `--integrator fixed-step`.
//!
//! As the third paper writes it (Scratchapixel, Volume Rendering of a 3D Density Field): the part of the
//! ray in the box around the media is cut into `n = ceil(length / step)` even steps; each is sampled in its
//! middle or, with jitter, at a random place in it; the transmittance is multiplied by the whole step's
//! **before** the step's light is added; light is marched from each sample with steps of its own and one
//! exponential at the end. First order in the step: the light of a step arrives as from its far end. The paper
//! attenuates by the step asked for and sums by the even one; here both are the even one.
//!
//! What it lacks against the comb is meant to be lacking: no walls (a sample stands for all of its step, inside
//! or not), no energy-conserving step, and the samples move with the box. Surfaces, several media, phase
//! functions and lights are as in the comb, as are the end of a ray (`stop` of the scene) and of a shadow (`opaque`).
//!
//! With `--tube-bounds sphere-march` the ray walks by distances until it is inside a medium, then in even
//! steps until a sample is outside, and so on (Moinet 2022, section 3): see [`super::tube_axis`].

use super::camera::{Ray, slab};
use super::comb::MAX_NODES;
use super::fields::{Fields, Points};
use super::matter::{Part, Place};
use super::medium::Glow;
use super::random::{Purpose, Stream};
use super::scene::Integrator;
use super::tube_axis::TubeAxis;
use crate::real::{Real, Vec3, add, largest, mul, scale, smallest, splat};

/// A walk up to a medium goes on by at least this part of a step, and ends where it is as near.
const NEAREST: f32 = 0.01;

/// A ray on its way through the box around the media.
#[derive(Clone, Copy, Debug)]
struct March<R> {
    /// Index of the ray.
    ray: usize,
    /// Where the next step begins.
    t: R,
    /// Where the box or the ray ends.
    exit: R,
    /// Length of a step.
    stride: R,
    /// Most steps, those of a walk up to a medium included.
    left: i32,
    /// Whether it walks by distances, and is on its way up to a medium.
    outside: bool,
    /// Where in each step the sample is; the middle without.
    jitter: Option<Stream>,
}

/// The samples that one step of each march leaves.
struct Round<R> {
    samples: Vec<Sample<R>>,
    /// Which of them are inside each medium; nothing where that is still to be asked.
    inside: Vec<Vec<usize>>,
}

/// A sample of a step.
#[derive(Clone, Copy, Debug)]
struct Sample<R> {
    ray: usize,
    t: R,
    /// Length of the step.
    length: R,
}

impl<R: Real> March<R> {
    /// Length of the next step: the last one ends with the box or the ray.
    fn length(&self) -> R {
        self.stride.min(self.exit - self.t)
    }

    /// The place of the sample in the step.
    fn place(&mut self) -> R {
        let share = self.jitter.as_mut().map_or(R::from_f32(0.5), Stream::uniform);
        self.t + share * self.length()
    }

    /// Whether there are further steps: half of one is kept from what rounding adds.
    fn goes_on(&self) -> bool {
        self.left > 0 && self.t + R::from_f32(1e-3) * self.stride < self.exit
    }
}

impl<F: Fields> Integrator<'_, F> {
    /// Follows each camera ray through the media up to its end.
    pub(super) fn march_evenly(
        &mut self,
        rays: &[Ray<F::Real>],
        ends: &[F::Real],
        jitter: Option<u64>,
        axes: Option<&[Option<TubeAxis>]>,
    ) -> Vec<Glow<F::Real>> {
        let mut glows = vec![Glow::clear(); rays.len()];
        let mut marches = self.start_marches(rays, ends, self.scene.step, axes.is_some());
        for march in &mut marches {
            march.jitter = jitter.map(|seed| Stream::of_ray(&rays[march.ray], seed, Purpose::Jitter));
        }
        while !marches.is_empty() {
            let round = self.next_round(rays, &mut marches, axes);
            self.add_samples(rays, &round, &mut glows);
            let open = |ray: usize| largest(glows[ray].transmittance) >= self.scene.stop;
            marches.retain(|march| march.goes_on() && open(march.ray));
        }
        glows
    }

    /// Integral of the extinction along each ray towards a light.
    pub(super) fn even_depth(
        &mut self,
        rays: &[Ray<F::Real>],
        ends: &[F::Real],
        axes: Option<&[Option<TubeAxis>]>,
    ) -> Vec<Vec3<F::Real>> {
        let mut depths = vec![splat(F::Real::ZERO); rays.len()];
        let mut marches = self.start_marches(rays, ends, self.scene.shadow_step, axes.is_some());
        while !marches.is_empty() {
            let round = self.next_round(rays, &mut marches, axes);
            for medium in 0..self.scene.media.len() {
                let (inside, points) = self.samples_inside(medium, rays, &round);
                for (index, extinction) in inside.into_iter().zip(self.extinction(medium, &points)) {
                    let Sample { ray, length, .. } = round.samples[index];
                    depths[ray] = add(depths[ray], scale(extinction, length));
                }
            }
            let open = |ray: usize| smallest(depths[ray]) <= self.scene.opaque;
            marches.retain(|march| march.goes_on() && open(march.ray));
        }
        depths
    }

    /// The rays that meet the box around the media, at its wall.
    fn start_marches(
        &self,
        rays: &[Ray<F::Real>],
        ends: &[F::Real],
        step: F::Real,
        outside: bool,
    ) -> Vec<March<F::Real>> {
        let Some([lo, hi]) = self.box_of_media() else { return Vec::new() };
        let most = F::Real::from_index(MAX_NODES);
        let start = |(ray, (path, &end)): (usize, (&Ray<F::Real>, &F::Real))| {
            let span = slab(path, lo, hi);
            let exit = span.exit.min(end);
            // The whole number of even steps that are at most as long as asked for.
            let parts = -((span.entry - exit) / step).floor();
            let even = !outside && parts <= most;
            let stride = if even { (exit - span.entry) / parts.max(F::Real::ONE) } else { step };
            let march = March { ray, t: span.entry, exit, stride, left: MAX_NODES, outside, jitter: None };
            (span.entry < exit).then_some(march)
        };
        rays.iter().zip(ends).enumerate().filter_map(start).collect()
    }

    /// Smallest box around the boxes of all media.
    fn box_of_media(&self) -> Option<[Vec3<F::Real>; 2]> {
        let boxes = self.scene.media.iter().map(|medium| [medium.lo, medium.hi]);
        boxes.reduce(|[lo, hi], other| {
            let axes = [0, 1, 2];
            [axes.map(|axis| lo[axis].min(other[0][axis])), axes.map(|axis| hi[axis].max(other[1][axis]))]
        })
    }

    /// Takes each march one step on; those that are not on their way up to a medium leave a sample.
    fn next_round(
        &mut self,
        rays: &[Ray<F::Real>],
        marches: &mut [March<F::Real>],
        axes: Option<&[Option<TubeAxis>]>,
    ) -> Round<F::Real> {
        let probe = |march: &mut March<F::Real>| if march.outside { march.t } else { march.place() };
        let probes: Vec<_> = marches.iter_mut().map(probe).collect();
        let points: Points<_> =
            marches.iter().zip(&probes).map(|(march, &t)| rays[march.ray].at(t)).collect();
        let axes = axes.unwrap_or_default().iter().enumerate();
        let near: Vec<_> =
            axes.map(|(medium, axis)| self.place_by_medium(medium, axis.as_ref(), &points)).collect();
        let mut round =
            Round { samples: Vec::with_capacity(marches.len()), inside: vec![Vec::new(); near.len()] };
        for (index, (march, t)) in marches.iter_mut().zip(probes).enumerate() {
            march.left -= 1;
            let least = F::Real::from_f32(NEAREST) * march.stride;
            let distance = near.iter().map(|near| near[index].distance).reduce(Real::min);
            match distance {
                // Walk up to the wall.
                Some(distance) if march.outside && distance >= least => march.t = march.t + distance,
                Some(_) if march.outside => march.outside = false,
                // The sample is outside again: walk on from there.
                Some(distance) if distance >= F::Real::ZERO => {
                    march.outside = true;
                    march.t = t.max(march.t + least);
                }
                Some(_) | None => {
                    for (inside, near) in round.inside.iter_mut().zip(&near) {
                        inside.extend(near[index].inside.then_some(round.samples.len()));
                    }
                    round.samples.push(Sample { ray: march.ray, t, length: march.length() });
                    march.t = march.t + march.stride;
                }
            }
        }
        round
    }

    /// The samples inside a medium, and where they are.
    fn samples_inside(
        &mut self,
        medium: usize,
        rays: &[Ray<F::Real>],
        round: &Round<F::Real>,
    ) -> (Vec<usize>, Points<F::Real>) {
        let point = |sample: &Sample<F::Real>| rays[sample.ray].at(sample.t);
        let inside = match round.inside.get(medium) {
            Some(inside) => inside.clone(),
            None => self.inside_of(medium, &round.samples.iter().map(point).collect()),
        };
        let points = inside.iter().map(|&index| point(&round.samples[index])).collect();
        (inside, points)
    }

    /// Adds the light of one sample per ray: first the transmittance of its step, then its light.
    fn add_samples(&mut self, rays: &[Ray<F::Real>], round: &Round<F::Real>, glows: &mut [Glow<F::Real>]) {
        let samples = &round.samples;
        let mut depths = vec![splat(F::Real::ZERO); samples.len()];
        let mut sources = vec![splat(F::Real::ZERO); samples.len()];
        let mut parts = Vec::new();
        for medium in 0..self.scene.media.len() {
            let (inside, points) = self.samples_inside(medium, rays, round);
            for (place, matter) in inside.into_iter().zip(self.matter(medium, &points)) {
                let length = samples[place].length;
                depths[place] = add(depths[place], scale(matter.extinction, length));
                sources[place] = add(sources[place], scale(matter.emission, length));
                parts.push(Part { place, medium, scattering: scale(matter.scattering, length) });
            }
        }
        let place = |sample: &Sample<F::Real>| {
            let ray = &rays[sample.ray];
            Place { point: ray.at(sample.t), direction: ray.direction, t: sample.t }
        };
        let places: Vec<_> = samples.iter().map(place).collect();
        let lights = self.scattered(&places, &parts);
        for (index, sample) in samples.iter().enumerate() {
            let glow = &mut glows[sample.ray];
            glow.transmittance = mul(glow.transmittance, depths[index].map(Real::decay));
            let source = add(sources[index], lights[index]);
            glow.light = add(glow.light, mul(glow.transmittance, source));
        }
    }
}
