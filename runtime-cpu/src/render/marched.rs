//! How much of a stretch of a ray solids leave in the light of a distant lamp, without a map.
//!
//! Let `m(p)` be the least distance to a solid along the ray from `p` to the light, negative by how deep that ray goes into
//! one. If distances change by at most 1 per unit of length, so does `m`: nothing changes within `|m|` of `p`, and the
//! stretch is walked in steps of `|m|`, at least a quarter of a pixel. Where the light goes on or off in a step,
//! bisection finds where ([`HALVINGS`]).
//!
//! * `m` is a by-product of sphere tracing: between two places that are `f` apart by their distance, it is at least half of
//!   the distance at the second. Fields that are not walked by their distance alone give no bound, only short steps.
//! * Error: shadows and gaps narrower than a quarter of a pixel may be missed; edges are found to 2^-12 of a step.
//! * source: algorithms.md §5.3, "Accurate mode"
//!
//! Twin: `compiler/src/wgsl/render/marched.wgsl`.

use super::camera::{FAR, Ray, Span, slab};
use super::fields::Fields;
use super::near::{Met, Walkers};
use super::scene::{Integrator, Stride};
use super::styled::Cell;
use super::surface::{MAX_STEPS, stride};
use crate::real::{Real, Vec3};

/// Halvings by which an edge of a shadow is found.
const HALVINGS: u32 = 12;

/// Most places at which a stretch is asked.
const MAX_PROBES: u32 = 4096;

/// Shortest steps of a walk along a stretch, in those of [`stride`].
const LEAST_STEP: f32 = 10.0;

/// Places inside a solid at which is asked how deep a ray of the light goes.
const DEPTHS: u32 = 4;

/// A walk along a stretch.
#[derive(Clone, Copy, Debug)]
struct Walk<R> {
    /// Where the stretch ends.
    end: R,
    /// Up to where it is known.
    known: R,
    /// Whether it is lit there.
    lit: bool,
    /// Length that is lit so far.
    length: R,
    /// Where to ask next.
    probe: R,
    /// The two ends of a step in which the light changes, and how often it has yet to be halved.
    edge: Option<Edge<R>>,
    started: bool,
}

#[derive(Clone, Copy, Debug)]
struct Edge<R> {
    before: R,
    after: R,
    /// Where the step ended, and what was found there.
    far: R,
    found: R,
    halvings: u32,
}

impl<R: Real> Walk<R> {
    fn new(from: R, end: R) -> Self {
        Self { end, known: from, lit: true, length: R::ZERO, probe: from, edge: None, started: false }
    }

    /// Takes what was found at the probe; whether there is more to ask.
    fn take(&mut self, found: R, least: R) -> bool {
        let lit = found > R::ZERO;
        if !self.started {
            self.started = true;
            self.lit = lit;
            return self.advance(self.known, found, least);
        }
        if let Some(edge) = &mut self.edge {
            if lit == self.lit {
                edge.before = self.probe;
            } else {
                edge.after = self.probe;
            }
            edge.halvings -= 1;
            let middle = R::from_f32(0.5) * (edge.before + edge.after);
            if edge.halvings > 0 {
                self.probe = middle;
                return true;
            }
            // Change sides at the edge.
            let (far, found) = (edge.far, edge.found);
            self.length = self.length + if self.lit { middle - self.known } else { far - middle };
            self.lit = !self.lit;
            self.edge = None;
            return self.advance(far, found, least);
        }
        if lit == self.lit {
            if lit {
                self.length = self.length + (self.probe - self.known);
            }
            return self.advance(self.probe, found, least);
        }
        self.edge =
            Some(Edge { before: self.known, after: self.probe, far: self.probe, found, halvings: HALVINGS });
        self.probe = R::from_f32(0.5) * (self.known + self.probe);
        true
    }

    /// Goes on from a place as far as nothing changes; whether that is not to the end.
    fn advance(&mut self, from: R, found: R, least: R) -> bool {
        self.known = from;
        self.probe = (from + found.abs().max(least)).min(self.end);
        found.abs() < self.end - from
    }
}

impl<F: Fields> Integrator<'_, F> {
    /// Part of each stretch that is lit by a lamp in a direction.
    pub(super) fn marched_shares(
        &mut self,
        toward: Vec3<F::Real>,
        rays: &[Ray<F::Real>],
        cells: &[Cell<F::Real>],
    ) -> Vec<F::Real> {
        let mut shares = Vec::with_capacity(cells.len());
        for batch in cells.chunks(self.batches.rays) {
            shares.extend(self.marched_batch(toward, rays, batch));
        }
        shares
    }

    fn marched_batch(
        &mut self,
        toward: Vec3<F::Real>,
        rays: &[Ray<F::Real>],
        cells: &[Cell<F::Real>],
    ) -> Vec<F::Real> {
        let mut walks: Vec<_> = cells.iter().map(|cell| Walk::new(cell.from, cell.to)).collect();
        let mut active: Vec<usize> = (0..cells.len()).filter(|&i| cells[i].from < cells[i].to).collect();
        for _ in 0..MAX_PROBES {
            if active.is_empty() {
                break;
            }
            let origin = |&i: &usize| Ray::new(rays[cells[i].ray].at(walks[i].probe), toward);
            let probes: Vec<_> = active.iter().map(origin).collect();
            let reach: Vec<_> = active.iter().map(|&i| cells[i].to - cells[i].from).collect();
            let least: Vec<_> = active.iter().map(|&i| stride(self.scene, walks[i].probe)).collect();
            let found = self.margins(&probes, &reach, &least);
            let mut at = 0;
            active.retain(|&i| {
                at += 1;
                walks[i].take(found[at - 1], F::Real::from_f32(LEAST_STEP) * least[at - 1])
            });
        }
        let share = |(walk, cell): (&Walk<F::Real>, &Cell<F::Real>)| {
            let width = cell.to - cell.from;
            // Up to the end nothing changes, or nobody had the patience to ask.
            let rest = if walk.lit { walk.end - walk.known } else { F::Real::ZERO };
            if width > F::Real::ZERO {
                ((walk.length + rest) / width).min(F::Real::ONE)
            } else {
                F::Real::ONE
            }
        };
        walks.iter().zip(cells).map(share).collect()
    }

    /// How far from the origin of each ray towards the light nothing changes: positive where it is lit, negative in a
    /// shadow; at most `reach`.
    fn margins(&mut self, rays: &[Ray<F::Real>], reach: &[F::Real], least: &[F::Real]) -> Vec<F::Real> {
        let mut margins = reach.to_vec();
        if self.scene.solids.is_empty() {
            return margins;
        }
        let mut walkers = Walkers::new(rays, self.met_nearby(rays, reach));
        let mut deep = vec![0; rays.len()];
        let scene = self.scene;
        for step in 1..=MAX_STEPS {
            self.nearest(&mut walkers);
            walkers.go(|walker, near| {
                let ray = walker.ray;
                let nowhere = near.distance >= F::Real::from_f32(FAR);
                let bounded = nowhere || !matches!(scene.solids[near.solid].stride, Stride::Within(_));
                let sure = if bounded { near.distance } else { F::Real::ZERO };
                let inside = near.distance < F::Real::ZERO;
                let mut t = walker.t + near.advance(step, least[ray]);
                if inside || deep[ray] > 0 {
                    // Ask on a little, since deeper inside the shadow is surer.
                    let depth = (-sure).max(F::Real::ZERO);
                    let first = deep[ray] == 0;
                    margins[ray] = if first { -depth } else { margins[ray].min(-depth) };
                    deep[ray] += 1;
                    if !inside || deep[ray] > DEPTHS {
                        margins[ray] = margins[ray].min(-F::Real::from_f32(f32::MIN_POSITIVE));
                        return None;
                    }
                    t = walker.t + depth.max(least[ray]);
                } else {
                    let half = F::Real::from_f32(0.5) * sure;
                    margins[ray] = margins[ray].min(half.max(F::Real::from_f32(f32::MIN_POSITIVE)));
                }
                (t < F::Real::from_f32(FAR)).then_some(walker.to(t))
            });
            if walkers.are_done() {
                break;
            }
        }
        margins
    }

    /// The solids that rays meet or pass within a reach.
    fn met_nearby(&self, rays: &[Ray<F::Real>], reach: &[F::Real]) -> Vec<Met<F::Real>> {
        let part = |ray: usize, lo: Vec3<F::Real>, hi: Vec3<F::Real>| {
            let lo = lo.map(|x| x - reach[ray]);
            let hi = hi.map(|x| x + reach[ray]);
            Some(slab(&rays[ray], lo, hi).loosened()).filter(Span::is_some)
        };
        Met::of(&self.scene.ask_boxes(rays.len(), part))
    }
}
