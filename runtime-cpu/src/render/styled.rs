//! Light of a lamp with a style (Kol et al. 2016), as media send it towards the eye.
//!
//! What a style makes of its light ([`StyledLight`]) is read in three places:
//!
//! * **Visibility.** A sample of a medium stands for a stretch of its ray; the light that arrives there counts by the part
//!   of the stretch that solids leave lit. So no edge of a shadow falls between two samples: with a steady medium
//!   `L = int sigma_s e^(-tau) V L_i` (Eq. 1) is left with the error of everything but `V`. With a transfer function the
//!   light arrives everywhere, and the average visibility of the whole ray chooses a colour instead (Eq. 2).
//! * **Tint** of a whole ray: that colour, times the mean of the heterogeneity.
//! * **Light map**: the colour of the light where it crosses the sample.
//!
//! A stretch is averaged in an epipolar slice ([`Slices`]): along a ray from the eye the slope `z / x` is the same
//! everywhere, so the ray is lit in those texels of its slice whose slope is not above it. Within the map nothing is left
//! to choose: the only error is its resolution. In the texel that holds the eye, where all slopes meet, heights are
//! compared instead.
//!
//! * source: T. Kol, O. Klehm, H.-P. Seidel, E. Eisemann, "Expressive Single Scattering for Light Shaft Stylization", TVCG
//!   2016; algorithms.md §5.3 and §6
//!
//! Twin: `compiler/src/wgsl/render/styled.wgsl`.

use super::camera::{FAR, Ray, depth, slab};
use super::comb::Cursor;
use super::fields::{Fields, Points};
use super::medium::Glow;
use super::scatter::Place;
use super::scene::{Integrator, Light, Scene};
use super::shadow::ShadowRay;
use crate::real::{Larger, Real, Vec3, add, dot, largest, mul, scale, splat, sub, vector};
use std::f64::consts::TAU;
use std::sync::Arc;
use vol_compiler::frame::Aabb;
use vol_compiler::frame::styled::{
    LightMapTable, Means, Occluders, Slices, StyledLight, TRANSFER_SIZE, TransferTable,
};
use vol_compiler::ir::FunctionId;

/// Least sine of the angle between a ray and the light: nearer to it a ray stays in one texel anyway.
const LEAST_SINE: f32 = 1e-6;

/// A depth that is none.
pub(crate) const NO_DEPTH: f32 = 1e30;

/// A relative difference of depths that is as bad as any.
const APART: f32 = 1e6;

/// Added to relative differences of depths: so much does not count.
const NEAR: f32 = 1e-3;

/// A ray as a style sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StyledRay<R> {
    /// First texel of its slice; none where nothing hides the light.
    slice: Option<usize>,
    /// Slope in the slice.
    slope: R,
    /// Texels of the slice per unit of the ray.
    texels: R,
    /// Where the ray ends.
    end: R,
    /// Factor of the light.
    tint: Vec3<R>,
}

/// A place where light is scattered, and how much of it the eye would see there.
pub(crate) type Scattering<R> = (Vec3<R>, Vec3<R>);

/// The rays of a batch by light; none for lights without a style.
pub(crate) type StyledRays<R> = Vec<Option<Vec<StyledRay<R>>>>;

impl<F: Fields> Integrator<'_, F> {
    /// Finds out what styles make of rays that end somewhere.
    pub(super) fn style_rays(&mut self, rays: &[Ray<F::Real>], ends: &[F::Real]) -> StyledRays<F::Real> {
        let tables: Vec<_> = self.scene.lights.iter().map(|light| self.scene.styled(light)).collect();
        let rays_of =
            |table: Option<Arc<StyledLight>>| table.map(|table| self.style_rays_by(&table, rays, ends));
        tables.into_iter().map(rays_of).collect()
    }

    fn style_rays_by(
        &mut self,
        light: &StyledLight,
        rays: &[Ray<F::Real>],
        ends: &[F::Real],
    ) -> Vec<StyledRay<F::Real>> {
        let mut styled: Vec<_> =
            rays.iter().zip(ends).map(|(ray, &end)| styled_ray(light, ray, end)).collect();
        if let Some(transfer) = &light.transfer {
            let visible = self.mean_visibility(light, rays, &styled, ends);
            for (index, styled) in styled.iter_mut().enumerate() {
                let depth = self.first_depth(&rays[index], ends[index]);
                styled.tint = transfer_color(transfer, visible[index], depth);
            }
        }
        if let Some(heterogeneity) = &light.heterogeneity {
            let means = match &heterogeneity.means {
                Some(means) => self.known_means(means, rays, ends),
                None => self.means_to(heterogeneity.field, heterogeneity.steps, &light.bounds, rays, ends),
            };
            for (styled, mean) in styled.iter_mut().zip(means) {
                styled.tint = scale(styled.tint, mean);
            }
        }
        styled
    }

    /// Average visibility of a ray, and the depth of its first surface.
    pub(crate) fn shaft_of(&mut self, light: &StyledLight, ray: &Ray<F::Real>) -> [F::Real; 2] {
        let rays = [*ray];
        let ends = self.first_surfaces(&rays);
        [self.average_visibility(light, &rays, &ends)[0], self.first_depth(ray, ends[0])]
    }

    /// Average visibility of rays that end somewhere; 1 for those that meet no medium.
    pub(crate) fn average_visibility(
        &mut self,
        light: &StyledLight,
        rays: &[Ray<F::Real>],
        ends: &[F::Real],
    ) -> Vec<F::Real> {
        let styled: Vec<_> = rays.iter().zip(ends).map(|(ray, &end)| styled_ray(light, ray, end)).collect();
        self.mean_visibility(light, rays, &styled, ends)
    }

    fn mean_visibility(
        &mut self,
        light: &StyledLight,
        rays: &[Ray<F::Real>],
        styled: &[StyledRay<F::Real>],
        ends: &[F::Real],
    ) -> Vec<F::Real> {
        let mut visible = vec![F::Real::ONE; rays.len()];
        let spans = rays.iter().zip(ends).map(|(ray, &end)| stretch(&light.bounds, ray, end));
        let cells = spans.enumerate().filter(|(_, [from, to])| from < to);
        let cells: Vec<_> = cells.map(|(ray, [from, to])| Cell { ray, from, to }).collect();
        for (cell, share) in cells.iter().zip(self.lit_shares(light, rays, styled, &cells)) {
            visible[cell.ray] = share;
        }
        visible
    }

    /// Mean heterogeneity in a box of rays that end somewhere.
    pub(crate) fn means_to(
        &mut self,
        field: FunctionId,
        steps: u32,
        bounds: &Aabb,
        rays: &[Ray<F::Real>],
        ends: &[F::Real],
    ) -> Vec<F::Real> {
        let spans: Vec<_> = rays.iter().zip(ends).map(|(ray, &end)| stretch(bounds, ray, end)).collect();
        self.ray_means(field, steps, rays, &spans)
    }

    /// Mean heterogeneity in a box and depth of the first surface of each ray.
    pub(crate) fn means_and_depths(
        &mut self,
        field: FunctionId,
        steps: u32,
        bounds: &Aabb,
        rays: &[Ray<F::Real>],
    ) -> Vec<[F::Real; 2]> {
        let ends = self.first_surfaces(rays);
        let means = self.means_to(field, steps, bounds, rays, &ends);
        let depths = rays.iter().zip(&ends).map(|(ray, &end)| self.first_depth(ray, end));
        means.into_iter().zip(depths).map(|(mean, depth)| [mean, depth]).collect()
    }

    /// Distance of the first surface on each ray, [`FAR`] where there is none.
    pub(crate) fn first_surfaces(&mut self, rays: &[Ray<F::Real>]) -> Vec<F::Real> {
        let mut ends = vec![F::Real::from_f32(FAR); rays.len()];
        for contact in self.trace(rays) {
            ends[contact.ray] = contact.t;
        }
        ends
    }

    /// Where the light of a lamp with a style is scattered along rays, and how much a white light map would let each ray
    /// see of it there, by the midpoint rule.
    pub(crate) fn light_weights(
        &mut self,
        rays: &[Ray<F::Real>],
        light: usize,
    ) -> Vec<Vec<Scattering<F::Real>>> {
        let ends = self.first_surfaces(rays);
        let styled = self.style_rays(rays, &ends);
        let combs = self.combs(rays, &ends, self.scene.step);
        let mut active = combs.active();
        let mut glows = vec![Glow::clear(); rays.len()];
        let mut places = vec![Vec::new(); rays.len()];
        while !active.is_empty() {
            let (chunk, fillings) = self.lit_nodes(rays, &styled, &combs, &active, &glows, Some(light));
            let means = chunk.means();
            for filling in &fillings {
                for (index, place) in filling.places.iter().enumerate() {
                    let slot = chunk.slot(place);
                    let Some(arriving) = chunk.arriving(slot).filter(|_| filling.lit[index]) else {
                        continue;
                    };
                    let sent = mul(filling.source.get(index), means.get(slot));
                    places[active[place.which].ray].push((filling.points.get(index), mul(arriving, sent)));
                }
            }
            chunk.gather(&active, &mut glows);
            let (stop, nodes) = (self.scene.stop, self.batches.nodes);
            active.retain_mut(|cursor| {
                largest(glows[cursor.ray].transmittance) >= stop && combs.advance(cursor, nodes)
            });
        }
        places
    }

    /// Depth of the surface at the end of a ray.
    fn first_depth(&self, ray: &Ray<F::Real>, end: F::Real) -> F::Real {
        if end < F::Real::from_f32(FAR) { depth(self.scene, ray, end) } else { F::Real::from_f32(NO_DEPTH) }
    }

    /// Mean of the heterogeneity over a stretch of each ray, at the middles of equal parts.
    fn ray_means(
        &mut self,
        field: FunctionId,
        steps: u32,
        rays: &[Ray<F::Real>],
        spans: &[[F::Real; 2]],
    ) -> Vec<F::Real> {
        let steps = steps as usize;
        let count = F::Real::from_index(steps as i32);
        let mut means = Vec::with_capacity(rays.len());
        for (ray, &[from, to]) in rays.iter().zip(spans) {
            if from >= to {
                means.push(F::Real::ONE);
                continue;
            }
            let step = (to - from) / count;
            let place = |i: usize| from + (F::Real::from_index(i as i32) + F::Real::from_f32(0.5)) * step;
            let points: Points<_> = (0..steps).map(|i| ray.at(place(i))).collect();
            let [values] = self.fields.sample(field, &points);
            let sum = values.into_iter().fold(F::Real::ZERO, |sum, value| sum + value);
            means.push(sum / count);
        }
        means
    }

    /// Means looked up between pixels where they are known, by those at similar depths.
    pub(crate) fn known_means(&self, means: &Means, rays: &[Ray<F::Real>], ends: &[F::Real]) -> Vec<F::Real> {
        let mean = |(ray, &end): (&Ray<F::Real>, &F::Real)| {
            let depth = self.first_depth(ray, end);
            known_mean(means, pixel(self.scene, ray), depth)
        };
        rays.iter().zip(ends).map(mean).collect()
    }

    /// Part of the light of a lamp with a style that arrives at places on rays, each asked by a shadow ray from it.
    pub(super) fn styled_visibility(
        &mut self,
        light: &Light<F::Real>,
        table: &StyledLight,
        rays: &[Ray<F::Real>],
        styled: &[StyledRay<F::Real>],
        asked: &[(usize, F::Real)],
        shadow_rays: &[ShadowRay<F::Real>],
    ) -> Vec<Vec3<F::Real>> {
        self.stats.shadow_rays += shadow_rays.len() as u64;
        let half = F::Real::from_f32(0.5) * self.scene.step;
        let shares = if table.transfer.is_some() {
            vec![F::Real::ONE; asked.len()]
        } else {
            let cell = |&(ray, t): &(usize, F::Real)| {
                let end: F::Real = styled[ray].end;
                Cell { ray, from: (t - half).max(F::Real::ZERO), to: (t + half).min(end) }
            };
            let cells: Vec<_> = asked.iter().map(cell).collect();
            self.lit_shares(table, rays, styled, &cells)
        };
        self.through_media(shadow_rays, &shares, light)
    }

    /// Part of each stretch of a ray that solids leave lit.
    fn lit_shares(
        &mut self,
        table: &StyledLight,
        rays: &[Ray<F::Real>],
        styled: &[StyledRay<F::Real>],
        cells: &[Cell<F::Real>],
    ) -> Vec<F::Real> {
        let toward = vector(table.toward);
        match &table.occluders {
            Occluders::None => vec![F::Real::ONE; cells.len()],
            Occluders::Slices(slices) => {
                cells.iter().map(|cell| lit_share(slices, &styled[cell.ray], cell.from, cell.to)).collect()
            }
            Occluders::Marched => self.marched_shares(toward, rays, cells),
        }
    }

    /// Factor of the light of a lamp at a place, beside visibility.
    pub(super) fn styled_tint(
        &self,
        table: &StyledLight,
        styled: &StyledRay<F::Real>,
        point: Vec3<F::Real>,
    ) -> Vec3<F::Real> {
        match &table.light_map {
            Some(map) => mul(styled.tint, light_color(map, point)),
            None => styled.tint,
        }
    }
}

/// A stretch of a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell<R> {
    /// Index of the ray.
    pub(super) ray: usize,
    /// Distances at which it begins and ends.
    pub(super) from: R,
    pub(super) to: R,
}

impl<R: Real> Scene<R> {
    /// What a style makes of a light.
    pub(super) fn styled(&self, light: &Light<R>) -> Option<Arc<StyledLight>> {
        self.styled_lights.get(light.index)?.clone()
    }
}

/// The part of a ray in a box, up to its end; nothing if the first is not below the second.
fn stretch<R: Real>(bounds: &Aabb, ray: &Ray<R>, end: R) -> [R; 2] {
    let span = slab(ray, vector(bounds.lo), vector(bounds.hi));
    [span.entry, span.exit.min(end)]
}

/// A ray without tint.
fn styled_ray<R: Real>(light: &StyledLight, ray: &Ray<R>, end: R) -> StyledRay<R> {
    let mut styled = StyledRay { slice: None, slope: R::ZERO, texels: R::ZERO, end, tint: splat(R::ONE) };
    if let Occluders::Slices(slices) = &light.occluders {
        let [u, v, toward] = slices.axes.map(|axis| dot(ray.direction, vector(axis)));
        let sine = (u * u + v * v).sqrt().max(R::from_f32(LEAST_SINE));
        styled.slope = toward / sine;
        styled.texels = sine * R::from_f32(slices.per_unit);
        styled.slice = slice_of(slices, v.atan2(u));
    }
    styled
}

/// First texel of the slice at an angle about the line through the eye.
fn slice_of<R: Real>(slices: &Slices, angle: R) -> Option<usize> {
    let turned = angle - R::from_f32(slices.first_angle);
    let turned = if turned < R::ZERO { turned + R::from_f64(TAU) } else { turned };
    let row = (turned * R::from_f32(slices.per_radian)).floor().to_index();
    let last = slices.rows as i32;
    // Rounding may turn the last slice by one too many.
    let row = if row == last { last - 1 } else { row };
    (0..last).contains(&row).then(|| row as usize * slices.columns as usize)
}

/// Part of a stretch of a ray that solids leave lit, by its slice.
pub(super) fn lit_share<R: Real>(slices: &Slices, ray: &StyledRay<R>, from: R, to: R) -> R {
    let Some(first) = ray.slice else { return R::ONE };
    let start = R::from_f32(slices.first_distance) * R::from_f32(slices.per_unit);
    let from = from * ray.texels - start;
    let to = to * ray.texels - start;
    let width = to - from;
    let columns = slices.columns as i32;
    // Before the slice and behind it nothing hides.
    let held = |place: R| place.max(R::ZERO).min(R::from_index(columns));
    let (begin, end) = (held(from), held(to));
    if begin >= end {
        return R::ONE;
    }
    let (left, right) = (begin.floor().to_index(), end.floor().to_index().min(columns - 1));
    // The part of a texel at an end of the stretch that is dark.
    let part = |texel: i32| {
        let slope = R::from_f32(slices.slopes[first + texel as usize]);
        let low = begin.max(R::from_index(texel));
        let high = end.min(R::from_index(texel + 1));
        if (texel == 0) & (slices.first_distance == 0.0) {
            hidden_at_the_eye(slope, ray.slope, low, high)
        } else if slope > ray.slope {
            high - low
        } else {
            R::ZERO
        }
    };
    let parts = part(left) + if right > left { part(right) } else { R::ZERO };
    let between = &slices.slopes[first..][(left + 1) as usize..right.max(left + 1) as usize];
    let dark = R::from_index(R::vectorized(Larger { than: ray.slope, numbers: between }) as i32) + parts;
    (R::ONE - dark / width).max(R::ZERO).min(R::ONE)
}

/// Length of a stretch of the texel around the eye, from `low` to `high`, that is below the surface: where the ray's
/// height, `place` times `own`, is below half the `slope`.
fn hidden_at_the_eye<R: Real>(slope: R, own: R, low: R, high: R) -> R {
    let height = R::from_f32(0.5) * slope;
    let rises = own > R::ZERO;
    let falls = own < R::ZERO;
    let crossing = height / if rises | falls { own } else { R::ONE };
    let below = if height > R::ZERO { high - low } else { R::ZERO };
    if rises {
        (high.min(crossing) - low).max(R::ZERO)
    } else if falls {
        (high - low.max(crossing)).max(R::ZERO)
    } else {
        below
    }
}

/// Colour for an average visibility and a depth along the viewing axis.
pub(crate) fn transfer_color<R: Real>(table: &TransferTable, visible: R, depth: R) -> Vec3<R> {
    let along = (depth - R::from_f32(table.near)) * R::from_f32(table.per_unit);
    let last = R::from_index(TRANSFER_SIZE as i32 - 1);
    let place = [visible, along].map(|share| share.max(R::ZERO).min(R::ONE) * last);
    bilinear(&table.texels, TRANSFER_SIZE, place)
}

/// Colour of a light where it crosses a point.
fn light_color<R: Real>(map: &LightMapTable, point: Vec3<R>) -> Vec3<R> {
    let off = sub(point, vector(map.origin));
    let last = R::from_index(map.size as i32 - 1);
    let place = map.axes.map(|axis| dot(off, vector(axis)).max(R::ZERO).min(last));
    bilinear(&map.texels, map.size, place)
}

/// Between four texels of a square table.
fn bilinear<R: Real>(texels: &[[f32; 3]], size: u32, place: [R; 2]) -> Vec3<R> {
    let most = R::from_index(size as i32 - 2);
    let [x, y] = place.map(|place| place.floor().min(most));
    let [a, b] = [place[0] - x, place[1] - y];
    let first = y.to_index() as usize * size as usize + x.to_index() as usize;
    let texel = |offset: usize| vector::<R>(texels[first + offset]);
    let mix = |from: Vec3<R>, to: Vec3<R>, share: R| add(from, scale(sub(to, from), share));
    let size = size as usize;
    mix(mix(texel(0), texel(1), a), mix(texel(size), texel(size + 1), a), b)
}

/// Place of the picture that a ray goes through, in pixels from the upper left corner.
fn pixel<R: Real>(scene: &Scene<R>, ray: &Ray<R>) -> [R; 2] {
    let camera = &scene.camera;
    let half = R::from_f32(0.5);
    let ahead = dot(ray.direction, camera.forward);
    let along = |axis: Vec3<R>| dot(ray.direction, axis) / (ahead * dot(axis, axis));
    let (u, v) = (along(camera.right), along(camera.up));
    [(half * (u + R::ONE)) * scene.size[0], (half * (R::ONE - v)) * scene.size[1]]
}

/// Between four known means, each by how near its pixel and its depth are.
fn known_mean<R: Real>(means: &Means, pixel: [R; 2], depth: R) -> R {
    let spacing = R::from_index(means.spacing as i32);
    let half = R::from_f32(0.5);
    let mut whole = [0; 2];
    let mut part = [R::ZERO; 2];
    for axis in 0..2 {
        let last = R::from_index(means.counts[axis] as i32 - 1);
        let place = (pixel[axis] / spacing - half).max(R::ZERO).min(last);
        let below = place.floor();
        whole[axis] = below.to_index() as usize;
        part[axis] = place - below;
    }
    let columns = means.counts[0] as usize;
    let (mut sum, mut weights) = (R::ZERO, R::ZERO);
    for corner in 0..4 {
        let [x, y] = [corner & 1, corner >> 1];
        let column = (whole[0] + x).min(columns - 1);
        let row = (whole[1] + y).min(means.counts[1] as usize - 1);
        let [mean, there] = means.texels[row * columns + column].map(R::from_f32);
        let side = |axis: usize, far: usize| if far == 1 { part[axis] } else { R::ONE - part[axis] };
        let apart = ((there - depth).abs() / depth.max(R::from_f32(NEAR))).min(R::from_f32(APART));
        let weight = (side(0, x) * side(1, y)) / (R::from_f32(NEAR) + apart);
        sum = sum + weight * mean;
        weights = weights + weight;
    }
    sum / weights
}

/// Where a sample of a medium is, as a style is asked for it.
pub(super) fn asked<R: Real>(active: &[Cursor], place: &Place<R>) -> (usize, R) {
    (active[place.which].ray, place.t)
}
