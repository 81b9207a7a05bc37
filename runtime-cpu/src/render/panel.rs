//! The panels of the corrected form: stretches of a ray between two places at which a medium is
//! sampled, and how much matter is in each.
//!
//! Places are the nodes of the comb inside the medium, the origin and the end of the ray, and the walls
//! that lie between two nodes, found by the Illinois rule. In a panel the density is taken to be linear:
//! trapezoid. Where it changes its sign, from p > 0 to m < 0, the positive part of the line is
//! integrated and the error of the trapezoids before it made good (algorithms.md §5.1):
//!
//! `mass = length (p^2 / (2 (p - m)) + (p - m) / 12)`
//!
//! The last term is that of Euler and Maclaurin for the slope at which the density ends. Where matter is cut
//! off (at a wall, at the ray's origin, at its end) the same term, `step^2 / 12` times the slope, comes from the two
//! densities of the last panel. Error: the third power of the step; where less than a quarter of a panel is
//! left beside a wall, some of the second power.
//!
//! Between two nodes outside, a ray may pass through a corner: [`super::chord`] looks for that. What is thinner
//! than a step and far from both nodes, and gaps between two nodes inside, are lost, as in [`super::comb`].
//!
//! Twin: `compiler/src/wgsl/render/panel.wgsl`.

use super::camera::Ray;
use super::chord::{Chord, Gap};
use super::comb::{Combs, Cursor, LaidOut, Run};
use super::fields::{Fields, Points};
use super::scatter::Place;
use super::scene::Integrator;
use crate::real::{Real, Vec3, add, scale};
use vol_compiler::ir::FunctionId;

/// Rounds by which a wall is found.
pub(crate) const WALL_ROUNDS: u32 = 5;

/// A stretch of a ray inside a medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Panel<R> {
    /// Index of the active ray.
    pub(crate) which: usize,
    /// Number of the interval between nodes after the cursor.
    pub(crate) number: usize,
    /// Places at which it begins and ends.
    pub(crate) ends: [usize; 2],
    /// Integral of the density that each end stands for.
    pub(crate) masses: [R; 2],
}

/// The panels of one medium, and a function of it at their ends.
pub(crate) struct Panels<R, const N: usize> {
    /// Where they begin and end.
    pub(crate) places: Vec<Place<R>>,
    /// The same in space.
    pub(crate) points: Points<R>,
    /// Outputs of the function there; the first is the density.
    pub(crate) values: [Vec<R>; N],
    /// Those with matter.
    pub(crate) list: Vec<Panel<R>>,
}

impl<R: Real, const N: usize> Panels<R, N> {
    /// Three outputs of the function at a place.
    pub(crate) fn color(&self, first: usize, place: usize) -> Vec3<R> {
        [self.values[first][place], self.values[first + 1][place], self.values[first + 2][place]]
    }

    /// Optical depth of a panel; the extinction per unit of density is in three outputs.
    pub(crate) fn depth(&self, panel: &Panel<R>, first: usize) -> Vec3<R> {
        let [from, to] = panel.ends;
        add(scale(self.color(first, from), panel.masses[0]), scale(self.color(first, to), panel.masses[1]))
    }
}

/// Where a panel will be.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    which: usize,
    number: usize,
    ends: [usize; 2],
    /// Whether matter is cut off at each end: at a wall or an end of the ray.
    open: [bool; 2],
}

/// Nodes inside a medium, where its panels will be, and the walls that end some of them.
type Found<R> = (Vec<Place<R>>, Vec<Stretch>, Vec<Crossing<R>>);

/// Two neighbouring nodes of which one is inside: distance along the ray and signed distance of each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing<R> {
    pub(super) which: usize,
    pub(super) inside: [R; 2],
    pub(super) outside: [R; 2],
    /// Which of them was found last, if any.
    moved: Option<bool>,
}

impl<R: Real> Crossing<R> {
    pub(super) fn new(which: usize, inside: [R; 2], outside: [R; 2]) -> Self {
        Self { which, inside, outside, moved: None }
    }

    /// Where the signed distance would be 0 if it were linear between the two.
    fn probe(&self) -> R {
        let ([t, value], [other_t, other_value]) = (self.inside, self.outside);
        t + (other_t - t) * (value / (value - other_value))
    }

    /// Takes the signed distance at the probe into account. An end that stays twice counts half (the Illinois
    /// rule), else it would stay for ever where the distance bends.
    fn narrow(&mut self, t: R, value: R) {
        let half = R::from_f32(0.5);
        let enters = value < R::ZERO;
        let (replaced, kept) = if enters {
            (&mut self.inside, &mut self.outside)
        } else {
            (&mut self.outside, &mut self.inside)
        };
        *replaced = [t, value];
        if self.moved == Some(enters) {
            kept[1] = half * kept[1];
        }
        self.moved = Some(enters);
    }
}

/// Integral of the positive part of a density over a stretch of a panel as long as `step`, by its values at
/// both ends: what each end stands for. An open end is one where matter is cut off.
fn masses<R: Real>(step: R, length: R, [from, to]: [R; 2], open: [bool; 2]) -> [R; 2] {
    let half = R::from_f32(0.5) * length;
    let (above, below) = (from.max(to), from.min(to));
    if !((above > R::ZERO) & (below < R::ZERO)) {
        let [from, to] = [from, to].map(|density| density.max(R::ZERO));
        let missed = if open[0] == open[1] {
            R::ZERO
        } else {
            // What the panels up to the node miss: it is given to the node.
            let rise = if open[0] { to - from } else { from - to };
            let part = step / length.max(R::from_f32(0.25) * step);
            let most = R::from_f32(0.5) * (half * (from + to));
            ((R::from_f32(1.0 / 12.0) * step) * (part * rise)).min(most).max(-most)
        };
        let [first, last] = if open[0] { [R::ZERO, missed] } else { [missed, R::ZERO] };
        return [(half * from + first).max(R::ZERO), (half * to + last).max(R::ZERO)];
    }
    let fall = above - below;
    let mass = half * (above * (above / fall)) + length * (fall * R::from_f32(1.0 / 12.0));
    if from > R::ZERO { [mass, R::ZERO] } else { [R::ZERO, mass] }
}

impl<F: Fields> Integrator<'_, F> {
    /// The panels of one medium between the next `batches.nodes + 1` nodes of each active ray, with the
    /// outputs of a function of which the first is the density.
    pub(crate) fn panels<const N: usize>(
        &mut self,
        medium: usize,
        function: FunctionId,
        rays: &[Ray<F::Real>],
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
    ) -> Panels<F::Real, N> {
        let (mut places, stretches, crossings) = self.stretches(medium, rays, combs, active);
        places.extend(self.walls(medium, rays, active, crossings));
        let points = places.iter().map(|place| rays[active[place.which].ray].at(place.t)).collect();
        let values: [Vec<F::Real>; N] = self.fields.sample(function, &points);
        let panel = |Stretch { which, number, ends, open }: Stretch| {
            let length = places[ends[1]].t - places[ends[0]].t;
            let masses = masses(combs.step, length, ends.map(|end| values[0][end]), open);
            Panel { which, number, ends, masses }
        };
        let has_matter = |panel: &Panel<F::Real>| panel.masses.iter().any(|&mass| mass > F::Real::ZERO);
        let list = stretches.into_iter().map(panel).filter(has_matter).collect();
        Panels { places, points, values, list }
    }

    /// The nodes inside, the stretches between places, and the crossings of walls, which are the places after
    /// the nodes.
    fn stretches(
        &mut self,
        medium: usize,
        rays: &[Ray<F::Real>],
        combs: &Combs<'_, F::Real>,
        active: &[Cursor],
    ) -> Found<F::Real> {
        // Take the nodes of the panels in the medium's range.
        let runs = combs.runs_of(medium, active, self.batches.nodes, [0, 1]);
        let LaidOut { distances, points, .. } = combs.laid_out(&runs, rays, active, true);
        let region = self.region(medium, &points);
        let is_inside = |index: usize| region[index] < F::Real::ZERO;
        let nodes = (0..region.len()).filter(|&index| is_inside(index)).count();
        let (mut places, mut stretches) = (Vec::with_capacity(nodes), Vec::with_capacity(region.len()));
        let (mut crossings, mut gaps) = (Vec::new(), Vec::new());
        for Run { which, first, places: run } in runs {
            let Cursor { ray, node } = active[which];
            let place = |index: usize| {
                let node = first - node + (index - run.start) as i32;
                Place { which, node: Some(node as usize), t: distances[index] }
            };
            let mut before = is_inside(run.start);
            if before {
                places.push(place(run.start));
            }
            // Between two of those inside is a stretch; a wall ends it where one is outside.
            for (to, number) in (run.start + 1..run.end).zip(first..) {
                let inside = [before, is_inside(to)];
                before = inside[1];
                let known = places.len();
                if inside[1] {
                    places.push(place(to));
                }
                let [from, to] = [to - 1, to].map(|index| [distances[index], region[index]]);
                if from[0] >= to[0] {
                    continue;
                }
                let is_last = to[0] < combs.distance(ray, number + 1);
                let first = number == 0;
                let number = (number - node) as usize;
                if inside == [false, false] {
                    gaps.extend(Gap::new(which, number, from, to));
                    continue;
                }
                let wall = nodes + crossings.len();
                let ends = [if inside[0] { known - 1 } else { wall }, if inside[1] { known } else { wall }];
                let open = [!inside[0] || first, !inside[1] || is_last];
                stretches.push(Stretch { which, number, ends, open });
                match inside {
                    [true, false] => crossings.push(Crossing::new(which, from, to)),
                    [false, true] => crossings.push(Crossing::new(which, to, from)),
                    _ => {}
                }
            }
        }
        for chord in self.chords(medium, rays, active, gaps) {
            let wall = nodes + crossings.len();
            let Chord { which, number, walls } = chord;
            stretches.push(Stretch { which, number, ends: [wall, wall + 1], open: [true, true] });
            crossings.extend(walls);
        }
        (places, stretches, crossings)
    }

    /// Signed distances of a medium's region at distances along active rays.
    pub(super) fn region_at(
        &mut self,
        medium: usize,
        rays: &[Ray<F::Real>],
        active: &[Cursor],
        places: impl Iterator<Item = (usize, F::Real)>,
    ) -> Vec<F::Real> {
        let points = places.map(|(which, t)| rays[active[which].ray].at(t)).collect();
        let [values] = self.fields.sample(self.scene.media[medium].region, &points);
        self.stats.region_evaluations += values.len() as u64;
        values
    }

    /// Finds the walls.
    fn walls(
        &mut self,
        medium: usize,
        rays: &[Ray<F::Real>],
        active: &[Cursor],
        mut crossings: Vec<Crossing<F::Real>>,
    ) -> Vec<Place<F::Real>> {
        for _ in 0..WALL_ROUNDS {
            let probes: Vec<_> = crossings.iter().map(Crossing::probe).collect();
            let places = crossings.iter().map(|crossing| crossing.which).zip(probes.iter().copied());
            let values = self.region_at(medium, rays, active, places);
            let found = crossings.iter_mut().zip(probes.into_iter().zip(values));
            found.for_each(|(crossing, (t, value))| crossing.narrow(t, value));
        }
        let place = |crossing: &Crossing<_>| Place { which: crossing.which, node: None, t: crossing.probe() };
        crossings.iter().map(place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stretch_without_a_change_of_sign_is_a_trapezoid() {
        let inner = |length, ends| masses(2.0, length, ends, [false, false]);
        assert_eq!(inner(2.0, [3.0, 5.0]), [3.0, 5.0]);
        assert_eq!(inner(2.0, [3.0, 0.0]), [3.0, 0.0]);
        assert_eq!(inner(2.0, [-3.0, -5.0]), [0.0, 0.0]);
        assert_eq!(inner(0.0, [-3.0, 5.0]), [0.0, 0.0]);
    }

    /// Integral of max(0, f) over -1..1 by panels of a width, first node at an offset.
    fn integral(f: impl Fn(f64) -> f64, step: f64, offset: f64) -> f64 {
        let node = |i: i32| -1.0 + (f64::from(i) - offset) * step;
        let count = (2.0 / step) as i32 + 2;
        (0..count)
            .map(|i| masses(step, step, [f(node(i)), f(node(i + 1))], [false, false]).iter().sum::<f64>())
            .sum()
    }

    #[test]
    fn ends_at_zero_are_third_order() {
        // 3/4 (1/4 - t^2) integrates to 1/8.
        let f = |t: f64| 0.75 * (0.25 - t * t);
        let worst = |step: f64| {
            let errors = (0..37).map(|i| (integral(f, step, (f64::from(i) + 0.5) / 37.0) - 0.125).abs());
            errors.fold(0.0, f64::max)
        };
        let (coarse, fine) = (worst(0.1), worst(0.025));
        assert!(coarse < 1e-3 && fine < coarse / 40.0, "{coarse:e} {fine:e}");
        // A trapezoid without the correction is of second order and worse.
        let plain = |step: f64| integral(|t| f(t).max(0.0), step, 0.3) - 0.125;
        assert!(plain(0.025).abs() > 3.0 * fine, "{:e} {fine:e}", plain(0.025));
    }

    #[test]
    fn walls_are_nearly_third_order() {
        // exp(t) from a wall at -1 + x to the end of the ray at 1.
        let integral = |step: f64, x: f64| {
            let place = |i: i32| (-1.0 + x + f64::from(i - 1) * step + 0.3 * step).max(-1.0 + x).min(1.0);
            let last = |i: i32| place(i) < place(i + 1);
            let panels = (0..).take_while(|&i| last(i)).map(|i| {
                let open = [i == 0, !last(i + 1)];
                let ends = [place(i), place(i + 1)];
                masses(step, ends[1] - ends[0], ends.map(f64::exp), open).iter().sum::<f64>()
            });
            panels.sum::<f64>() - (1.0_f64.exp() - (-1.0 + x).exp())
        };
        let worst =
            |step: f64| (0..31).map(|i| integral(step, 0.01 * f64::from(i)).abs()).fold(0.0, f64::max);
        let (coarse, fine) = (worst(0.1), worst(0.025));
        assert!(coarse < 1.5e-3 && fine < coarse / 14.0, "{coarse:e} {fine:e}");
    }

    #[test]
    fn a_wall_is_found() {
        // Through a ball of radius 1: the distance is not linear.
        let distance = |t: f64| (t * t + 0.3_f64.powi(2)).sqrt() - 1.0;
        let mut crossing = Crossing::new(0, [0.8, distance(0.8)], [1.1, distance(1.1)]);
        for _ in 0..WALL_ROUNDS {
            let t = crossing.probe();
            crossing.narrow(t, distance(t));
        }
        assert!((crossing.probe() - (1.0_f64 - 0.09).sqrt()).abs() < 1e-7);
    }
}
