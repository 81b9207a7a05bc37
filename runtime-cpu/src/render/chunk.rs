//! The next nodes or panels of some rays, one slot for each: what light goes through them, and what is added.
//!
//! Twin: `gather` in `compiler/src/wgsl/render/medium.wgsl`.
//!
//! Slots of one node or panel of all rays are neighbours, so that rays go through them side by side, [`LANES`] at a time.

use super::comb::Cursor;
use super::fields::Colors;
use super::medium::Glow;
use super::scatter::Place;
use crate::isa::Loop;
use crate::real::{Decays, Real, Vec3, largest};
use std::array;

/// Rays that go side by side.
const LANES: usize = 16;

/// A number of each of them.
type Lanes<R> = [R; LANES];

/// The slots of some active rays.
pub(super) struct Chunk<R> {
    /// Slots from one node to the next: as many as there are rays, and some more.
    width: usize,
    nodes: usize,
    /// See [`Scene::stop`](super::scene::Scene::stop).
    stop: R,
    /// Optical depth.
    pub(super) depth: Colors<R>,
    /// exp(-x) of that.
    pub(super) decay: Colors<R>,
    /// Fraction of what is sent from there that reaches the eye.
    arriving: Colors<R>,
    /// Light that leaves towards the eye.
    pub(super) sent: Colors<R>,
}

impl<R: Real> Chunk<R> {
    /// Nothing is there.
    pub(super) fn new(rays: usize, nodes: usize, stop: R) -> Self {
        let width = rays.next_multiple_of(LANES);
        let [depth, sent, decay, arriving] = array::from_fn(|_| Colors::splat(R::ZERO, width * nodes));
        Self { width, nodes, stop, depth, decay, arriving, sent }
    }

    /// The slot of a place; that of its ray's first node for a wall.
    #[inline(always)]
    pub(super) fn slot(&self, place: &Place<R>) -> usize {
        self.slot_of(place.which, place.node.unwrap_or(0))
    }

    fn slots(&self, places: &[Place<R>]) -> Vec<usize> {
        places.iter().map(|place| self.slot(place)).collect()
    }

    /// The slot of a node or panel of an active ray.
    #[inline(always)]
    pub(super) fn slot_of(&self, which: usize, node: usize) -> usize {
        node * self.width + which
    }

    /// Whether light from a slot arrives: the ray has not ended before it.
    #[inline(always)]
    pub(super) fn is_open(&self, slot: usize) -> bool {
        is_open(self.arriving.get(slot), self.stop)
    }

    /// Fraction of what is sent from a slot that reaches the eye; nothing behind the end of the ray.
    pub(super) fn arriving(&self, slot: usize) -> Option<Vec3<R>> {
        self.is_open(slot).then(|| self.arriving.get(slot))
    }

    /// Adds optical depths at places.
    pub(super) fn deepen(&mut self, places: &[Place<R>], depths: &Colors<R>) {
        let slots = self.slots(places);
        for (row, depths) in self.depth.0.iter_mut().zip(&depths.0) {
            for (&slot, &depth) in slots.iter().zip(depths) {
                row[slot] = row[slot] + depth;
            }
        }
    }

    /// Adds the light of sources at places, `means` as of [`Chunk::means`].
    pub(super) fn send(&mut self, places: &[Place<R>], sources: &Colors<R>, means: &Colors<R>) {
        let slots = self.slots(places);
        for (row, (sources, means)) in self.sent.0.iter_mut().zip(sources.0.iter().zip(&means.0)) {
            for (&slot, &source) in slots.iter().zip(sources) {
                row[slot] = row[slot] + source * means[slot];
            }
        }
    }

    /// What leaves each slot of a source of 1 that is spread over its optical depth.
    pub(super) fn means(&self) -> Colors<R> {
        let mut means = Colors::splat(R::ZERO, self.depth.len());
        for channel in 0..3 {
            R::vectorized(Means {
                depth: &self.depth.0[channel],
                decay: &self.decay.0[channel],
                means: &mut means.0[channel],
            });
        }
        means
    }

    /// Finds how much of each slot's light arrives, and which slots are behind the end of the ray.
    pub(super) fn transmit(&mut self, active: &[Cursor], glows: &[Glow<R>]) {
        for (x, decays) in self.depth.0.iter().zip(&mut self.decay.0) {
            R::vectorized(Decays { x, decays });
        }
        for (lane, cursor) in active.iter().enumerate() {
            self.arriving.set(lane, glows[cursor.ray].transmittance);
        }
        R::vectorized(Transmit(self));
    }

    /// Adds up the slots of each ray, front to back.
    pub(super) fn gather(&self, active: &[Cursor], glows: &mut [Glow<R>]) {
        for (block, cursors) in active.chunks(LANES).enumerate() {
            let mut sums = Sums::of(cursors, glows);
            R::vectorized(Gather { chunk: self, first: block * LANES, sums: &mut sums });
            for (lane, cursor) in cursors.iter().enumerate() {
                let lane = |rows: &[Lanes<R>; 3]| rows.map(|row| row[lane]);
                let [light, transmittance, coarse_light, coarse_transmittance] =
                    sums.rows.each_ref().map(lane);
                glows[cursor.ray] = Glow { light, transmittance, coarse_light, coarse_transmittance };
            }
        }
    }
}

#[inline(always)]
fn is_open<R: Real>(transmittance: Vec3<R>, stop: R) -> bool {
    let is_dark = largest(transmittance) < stop;
    // Also if it is no number, so that it is seen.
    !is_dark
}

struct Means<'a, R> {
    depth: &'a [R],
    decay: &'a [R],
    means: &'a mut [R],
}

impl<R: Real> Loop for Means<'_, R> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        for ((mean, &depth), &decay) in self.means.iter_mut().zip(self.depth).zip(self.decay) {
            *mean = depth.mean_decay(decay);
        }
    }
}

/// Lanes of a row from a slot on.
#[inline(always)]
fn lanes<R: Real>(row: &[R], slot: usize) -> Lanes<R> {
    let mut lanes = [R::ZERO; LANES];
    lanes.copy_from_slice(&row[slot..slot + LANES]);
    lanes
}

/// The same of each channel.
#[inline(always)]
fn colors<R: Real>(colors: &Colors<R>, slot: usize) -> [Lanes<R>; 3] {
    [lanes(&colors.0[0], slot), lanes(&colors.0[1], slot), lanes(&colors.0[2], slot)]
}

/// Which of the lanes are open.
#[inline(always)]
fn open<R: Real>(transmittance: &[Lanes<R>; 3], stop: R) -> [bool; LANES] {
    let mut open = [false; LANES];
    for lane in 0..LANES {
        open[lane] = is_open([transmittance[0][lane], transmittance[1][lane], transmittance[2][lane]], stop);
    }
    open
}

struct Transmit<'a, R>(&'a mut Chunk<R>);

impl<R: Real> Loop for Transmit<'_, R> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Chunk { width, nodes, stop, decay, arriving, .. } = self.0;
        for first in (0..*width).step_by(LANES) {
            let mut transmittance = colors(arriving, first);
            for node in 0..*nodes {
                let slot = node * *width + first;
                let open = open(&transmittance, *stop);
                for (channel, transmittance) in transmittance.iter_mut().enumerate() {
                    arriving.0[channel][slot..slot + LANES].copy_from_slice(transmittance);
                    let decay = lanes(&decay.0[channel], slot);
                    for lane in 0..LANES {
                        let t = transmittance[lane];
                        transmittance[lane] = if open[lane] { t * decay[lane] } else { t };
                    }
                }
            }
        }
    }
}

/// What some rays have gathered.
struct Sums<R> {
    /// Light, transmittance, and both by every other node.
    rows: [[Lanes<R>; 3]; 4],
    /// Whether the first node is one of the others.
    odd: [bool; LANES],
}

impl<R: Real> Sums<R> {
    fn of(cursors: &[Cursor], glows: &[Glow<R>]) -> Self {
        let mut sums = Self { rows: [[[R::ZERO; LANES]; 3]; 4], odd: [false; LANES] };
        for (lane, cursor) in cursors.iter().enumerate() {
            let Glow { light, transmittance, coarse_light, coarse_transmittance } = glows[cursor.ray];
            let colors = [light, transmittance, coarse_light, coarse_transmittance];
            for (rows, color) in sums.rows.iter_mut().zip(colors) {
                rows.iter_mut().zip(color).for_each(|(row, value)| row[lane] = value);
            }
            sums.odd[lane] = cursor.node % 2 != 0;
        }
        sums
    }
}

struct Gather<'a, R> {
    chunk: &'a Chunk<R>,
    /// The first of the rays.
    first: usize,
    sums: &'a mut Sums<R>,
}

impl<R: Real> Loop for Gather<'_, R> {
    type Out = ();

    #[inline(always)]
    fn run(self) {
        let Chunk { width, nodes, stop, decay, arriving, sent, .. } = self.chunk;
        let Sums { rows, odd } = *self.sums;
        let [mut light, mut through, mut coarse_light, mut coarse_through] = rows;
        for node in 0..*nodes {
            let slot = node * *width + self.first;
            let arriving = colors(arriving, slot);
            let open = open(&arriving, *stop);
            let is_even = node % 2 == 0;
            for channel in 0..3 {
                let arriving = &arriving[channel];
                let (sent, decay) = (lanes(&sent.0[channel], slot), lanes(&decay.0[channel], slot));
                for lane in 0..LANES {
                    let more = light[channel][lane] + arriving[lane] * sent[lane];
                    let after = arriving[lane] * decay[lane];
                    light[channel][lane] = if open[lane] { more } else { light[channel][lane] };
                    through[channel][lane] = if open[lane] { after } else { through[channel][lane] };
                    // Of twice the matter: (1 - exp(-2x)) / x is (1 - exp(-x)) / x times 1 + exp(-x).
                    let counts = open[lane] & (odd[lane] != is_even);
                    let twice = sent[lane] * (R::ONE + decay[lane]);
                    let coarse = coarse_through[channel][lane];
                    let more = coarse_light[channel][lane] + coarse * twice;
                    let after = coarse * (decay[lane] * decay[lane]);
                    coarse_light[channel][lane] = if counts { more } else { coarse_light[channel][lane] };
                    coarse_through[channel][lane] = if counts { after } else { coarse };
                }
            }
        }
        self.sums.rows = [light, through, coarse_light, coarse_through];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::{add, mul, splat};

    const NODES: usize = 7;

    /// What one ray gathers, node by node.
    fn alone(start: Glow<f32>, first: i32, stop: f32, nodes: &[[Vec3<f32>; 2]]) -> Glow<f32> {
        let mut glow = start;
        for ((depth, sent), node) in nodes.iter().map(|[depth, sent]| (*depth, *sent)).zip(first..) {
            if largest(glow.transmittance) < stop {
                break;
            }
            let decay = depth.map(Real::decay);
            glow.light = add(glow.light, mul(glow.transmittance, sent));
            glow.transmittance = mul(glow.transmittance, decay);
            if node % 2 == 0 {
                let twice = mul(sent, add(splat(1.0), decay));
                glow.coarse_light = add(glow.coarse_light, mul(glow.coarse_transmittance, twice));
                glow.coarse_transmittance = mul(glow.coarse_transmittance, mul(decay, decay));
            }
        }
        glow
    }

    #[test]
    fn rays_gather_what_each_does_alone() {
        let mut seed = 1_u32;
        let mut number = |most: f32| {
            seed = 1_664_525_u32.wrapping_mul(seed).wrapping_add(1_013_904_223);
            most * (seed >> 8) as f32 / (1 << 24) as f32
        };
        for (rays, stop) in [(1, 1e-3), (15, 0.0), (16, 1e-3), (17, 0.1), (40, 1e-3)] {
            let cursors: Vec<_> = (0..rays).map(|ray| Cursor { ray, node: 3 * ray as i32 }).collect();
            let mut glows: Vec<Glow<f32>> = vec![Glow::clear(); rays];
            glows[rays / 2].transmittance = [0.5, 1e-4, 0.25];
            let mut chunk = Chunk::new(rays, NODES, stop);
            let mut nodes = vec![[[splat(0.0); 2]; NODES]; rays];
            for (ray, nodes) in nodes.iter_mut().enumerate() {
                for (node, [depth, sent]) in nodes.iter_mut().enumerate() {
                    (*depth, *sent) =
                        ([number(3.0), number(1.0), number(5.0)], [number(1.0), number(2.0), 0.5]);
                    let slot = chunk.slot_of(ray, node);
                    chunk.depth.set(slot, *depth);
                    chunk.sent.set(slot, *sent);
                }
            }
            let want = cursors.iter().map(|at| alone(glows[at.ray], at.node, stop, &nodes[at.ray]));
            let want: Vec<_> = want.collect();
            chunk.transmit(&cursors, &glows);
            chunk.gather(&cursors, &mut glows);
            assert_eq!(format!("{glows:?}"), format!("{want:?}"), "{rays} rays");
        }
    }
}
