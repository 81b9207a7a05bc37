//! Values that differ however near two places are.
//!
//! Ways through the solid are walked in small steps, and next to awkward places pairs are taken. The pairs
//! that differ by most, against the others of their way, are halved, keeping the half with the larger
//! difference, until they are some 1e-10 of the size apart. What then still differs by more than a
//! hundred-thousandth of the values would be steeper than 10 000.

use rayon::prelude::*;
use vol_compiler::frame::Stride;
use vol_compiler::ir::FunctionId;
use vol_compiler::ir::verify::random::Random;
use vol_compiler::program::NO_BOUND;

use super::evaluate::Evaluator;
use super::findings::{Kind, Scope};
use super::points::{along, direction};
use super::targets::{Role, Target};

/// Steps of a way.
const STEPS: usize = 24;

/// Length of a step, in sizes: of a way through the solid, and of one at an awkward place.
const LENGTHS: [f64; 2] = [0.03, 1e-4];

/// How often a pair is halved.
const HALVINGS: u32 = 28;

/// What is left of a jump, relative to the values.
const JUMP: f64 = 1e-5;

/// Pairs that are halved.
const MOST: usize = 24;

/// Two places and the values there.
#[derive(Clone)]
struct Pair {
    ends: [[f64; 3]; 2],
    values: [Vec<f64>; 2],
    /// The difference against those of the same way.
    score: f64,
}

impl Pair {
    /// Whether the two places are on different sides of a surface.
    fn crosses(&self) -> bool {
        (self.values[0][0] < 0.0) != (self.values[1][0] < 0.0)
    }

    /// The largest difference, and in which output it is.
    fn change(&self) -> (usize, f64) {
        let [a, b] = &self.values;
        let changes = a.iter().zip(b).map(|(a, b)| (a - b).abs()).enumerate();
        let finite = changes.filter(|(_, change)| change.is_finite());
        finite.fold((0, 0.0), |most, new| if new.1 > most.1 { new } else { most })
    }
}

/// Looks for jumps of a distance or of the inside of a medium.
pub(super) fn check(
    evaluator: &Evaluator<'_>,
    target: &Target,
    count: usize,
    random: &mut Random,
    scope: &mut Scope<'_>,
) {
    let region = match target.role {
        // The extinction is a part of it.
        Role::Interior { region } if target.name.starts_with("interior") => Some(region),
        Role::Distance { .. } => None,
        Role::Interior { .. }
        | Role::Gradient { .. }
        | Role::Steepness
        | Role::Surface { .. }
        | Role::Region
        | Role::Phase
        | Role::Field => return,
    };
    let ways: Vec<([f64; 3], [f64; 3])> = (0..count.div_ceil(STEPS / 4))
        .map(|i| {
            let awkward = target.place.awkward(1, random)[0];
            let is_through = i % 3 != 0 || !target.place.is_around(awkward);
            let from = if is_through { target.place.around(random) } else { awkward.map(f64::from) };
            let length = LENGTHS[usize::from(!is_through)] * random.between(0.3, 1.0) * target.place.size;
            (from, direction(random).map(|x| length * x))
        })
        .collect();
    let mut pairs: Vec<Pair> =
        ways.par_iter().flat_map_iter(|&(from, step)| walk(evaluator, target, region, from, step)).collect();
    let values = pairs.iter().flat_map(|pair| &pair.values[0]).filter(|x| x.is_finite());
    let least = if region.is_none() { target.place.size } else { 0.0 };
    let largest = values.fold(least, |most, x| most.max(x.abs()));
    pairs.sort_by(|a, b| b.score.total_cmp(&a.score));
    pairs.truncate(MOST);
    let halved: Vec<Pair> = pairs.into_par_iter().map(|pair| halved(evaluator, target, pair)).collect();
    for pair in halved {
        let (output, jump) = pair.change();
        if jump <= JUMP * largest {
            continue;
        }
        let kind = match target.role {
            Role::Distance { steady: false, .. } if !pair.crosses() => continue,
            Role::Distance { stride, .. } if !is_known(evaluator, stride, pair.ends) => Kind::DistanceJumps,
            _ => Kind::Jumps,
        };
        scope.jumps([&pair.ends[0], &pair.ends[1]], output, jump, kind);
    }
}

/// The steps of a way that are inside.
fn walk(
    evaluator: &Evaluator<'_>,
    target: &Target,
    region: Option<FunctionId>,
    from: [f64; 3],
    step: [f64; 3],
) -> Vec<Pair> {
    let is_inside = |p: &[f64; 3]| region.is_none_or(|region| evaluator.number(region, p) < 0.0);
    let places: Vec<[f64; 3]> = (0..=STEPS).map(|i| along(from, step, i as f64)).collect();
    let places: Vec<_> = places
        .into_iter()
        .map(|p| is_inside(&p).then(|| (p, evaluator.exact(target.function, &p))))
        .collect();
    let pair = |two: &[Option<([f64; 3], Vec<f64>)>]| match two {
        [Some((p, a)), Some((q, b))] => {
            Some(Pair { ends: [*p, *q], values: [a.clone(), b.clone()], score: 0.0 })
        }
        _ => None,
    };
    let mut pairs: Vec<Pair> = places.windows(2).filter_map(pair).collect();
    let mut changes: Vec<f64> = pairs.iter().map(|pair| pair.change().1).collect();
    changes.sort_by(f64::total_cmp);
    let usual = changes.get(changes.len() / 2).copied().unwrap_or(0.0);
    pairs.iter_mut().for_each(|pair| pair.score = pair.change().1 / (usual + 1e-9));
    pairs
}

fn halved(evaluator: &Evaluator<'_>, target: &Target, mut pair: Pair) -> Pair {
    for _ in 0..HALVINGS {
        let [p, q] = pair.ends;
        let middle = [0, 1, 2].map(|k| 0.5 * (p[k] + q[k]));
        let there = evaluator.exact(target.function, &middle);
        let [a, b] = pair.values;
        let first = Pair { ends: [p, middle], values: [a, there.clone()], score: 0.0 };
        let second = Pair { ends: [middle, q], values: [there, b], score: 0.0 };
        pair = if first.change().1 > second.change().1 { first } else { second };
    }
    pair
}

/// Whether the bound on the slope says that there may be a jump between two places.
fn is_known(evaluator: &Evaluator<'_>, stride: Stride, ends: [[f64; 3]; 2]) -> bool {
    let Stride::Within(steepness) = stride else { return false };
    let [p, q] = ends;
    let lo = [0, 1, 2].map(|k| p[k].min(q[k]));
    let hi = [0, 1, 2].map(|k| p[k].max(q[k]));
    evaluator.number(steepness, &[lo, hi].concat()) >= f64::from(NO_BOUND)
}
