//! Values that differ however near two places are.
//!
//! Pairs of places a thousandth of the size apart; those that differ most are halved, keeping the half with
//! the larger difference, until they are 1e-11 of the size apart. What then still differs by more than a
//! hundred-thousandth of the values would be steeper than a million.

use vol_compiler::frame::Stride;
use vol_compiler::ir::verify::random::Random;
use vol_compiler::program::NO_BOUND;

use super::evaluate::Evaluator;
use super::findings::{Kind, Scope};
use super::points::{along, direction};
use super::targets::{Role, Target};

/// Distance of the places of a pair, in sizes.
const APART: f64 = 1e-3;

/// How often a pair is halved.
const HALVINGS: u32 = 26;

/// What is left of a jump, relative to the values.
const JUMP: f64 = 1e-5;

/// Pairs that are halved.
const MOST: usize = 24;

/// Two places and by how much each output differs between them.
struct Pair {
    ends: [[f64; 3]; 2],
    values: [Vec<f64>; 2],
}

impl Pair {
    fn new(evaluator: &Evaluator<'_>, target: &Target, ends: [[f64; 3]; 2]) -> Self {
        Self { ends, values: ends.map(|p| evaluator.exact(target.function, &p)) }
    }

    /// Whether the two places are on different sides of a surface.
    fn crosses(&self) -> bool {
        (self.values[0][0] < 0.0) != (self.values[1][0] < 0.0)
    }

    /// The largest difference, and in which output it is.
    fn change(&self) -> (usize, f64) {
        let [a, b] = &self.values;
        let changes = a.iter().zip(b).map(|(a, b)| (a - b).abs()).enumerate();
        changes
            .filter(|(_, change)| change.is_finite())
            .fold((0, 0.0), |most, new| if new.1 > most.1 { new } else { most })
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
        Role::Interior { region } if target.name.starts_with("interior") => Some(region),
        Role::Distance { .. } => None,
        _ => return,
    };
    let size = target.place.size;
    let is_inside = |p: &[f64; 3]| region.is_none_or(|region| evaluator.number(region, p) < 0.0);
    let mut pairs = Vec::new();
    let mut largest: f64 = if region.is_none() { size } else { 0.0 };
    for i in 0..count {
        let p = if i % 2 == 0 {
            target.place.around(random)
        } else {
            target.place.awkward(1, random)[0].map(f64::from)
        };
        let ends = [p, along(p, direction(random), APART * size)];
        if !target.place.is_around(p.map(|x| x as f32)) || !ends.iter().all(is_inside) {
            continue;
        }
        let pair = Pair::new(evaluator, target, ends);
        largest = pair.values[0]
            .iter()
            .fold(largest, |most, x| if x.is_finite() { most.max(x.abs()) } else { most });
        pairs.push(pair);
    }
    pairs.sort_by(|a, b| b.change().1.total_cmp(&a.change().1));
    for pair in pairs.into_iter().take(MOST) {
        let pair = halved(evaluator, target, pair);
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

fn halved(evaluator: &Evaluator<'_>, target: &Target, mut pair: Pair) -> Pair {
    for _ in 0..HALVINGS {
        let middle = [0, 1, 2].map(|k| 0.5 * (pair.ends[0][k] + pair.ends[1][k]));
        let first = Pair::new(evaluator, target, [pair.ends[0], middle]);
        let second =
            Pair { ends: [middle, pair.ends[1]], values: [first.values[1].clone(), pair.values[1].clone()] };
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
