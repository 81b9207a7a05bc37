//! Rays on their way to a surface: steps that are too long, and ways that take too many.

use rayon::prelude::*;
use vol_compiler::frame::Stride;
use vol_compiler::ir::verify::random::Random;
use vol_compiler::program::NO_BOUND;

use super::evaluate::Evaluator;
use super::findings::Scope;
use super::points::{Place, along, direction, length};
use super::targets::{Role, Target};

/// Places along a step at which the surface is looked for.
const SAMPLES: usize = 24;

/// A step is looked at up to here, since a distance proper ends on the surface.
const MOST_OF_A_STEP: f64 = 0.9999;

/// A distance of the other sign counts from here on, in sizes: rounding of f64, generously.
const CROSSED: f64 = 1e-7;

/// Steps after which a ray counts as slow: the renderer then gives up to approach the surface.
const SLOW: u32 = 1000;

/// Share of rays that may be slow, since some graze a surface.
const MAY_BE_SLOW: f64 = 0.01;

/// Rays per solid.
const RAYS: usize = 300;

/// Shortest step of a ray per distance: a fortieth of a pixel of a picture 540 pixels high that shows 40
/// degrees.
const SHORTEST: f64 = 0.025 * 2.0 * 0.364 / 540.0;

/// How often a step is made shorter in search of a bound on the slope.
const TRIES: u32 = 8;

/// Looks for a surface nearer than a step of a ray is long.
pub(super) fn check_steps(
    evaluator: &Evaluator<'_>,
    target: &Target,
    count: usize,
    random: &mut Random,
    scope: &mut Scope<'_>,
) {
    let Role::Distance { stride, .. } = target.role else { return };
    let gradient = evaluator.program.objects.iter().find(|object| object.distance == target.function);
    let Some(gradient) = gradient.map(|object| object.gradient) else { return };
    let size = target.place.size;
    // Most often straight to the surface.
    let tries: Vec<([f64; 3], [f64; 3], f64)> = (0..count / 2)
        .map(|i| {
            let away = direction(random);
            let spread = if i % 4 == 0 { f64::INFINITY } else { random.between(0.0, 1.0) };
            (target.place.around(random), away, spread)
        })
        .collect();
    let crossed: Vec<_> = tries
        .par_iter()
        .filter_map(|&(from, away, spread)| {
            let value = evaluator.number(target.function, &from);
            let slope = evaluator.exact(gradient, &from);
            let straight = [0, 1, 2].map(|k| -value.signum() * slope[k]);
            let way = if spread.is_finite() { along(straight, away, spread) } else { away };
            let long = length(way);
            if !(long > 1e-9 && value.is_finite() && value != 0.0) {
                return None;
            }
            let way = way.map(|x| x / long);
            let step = safe(evaluator, stride, from, way, value.abs());
            let crossed = (1..=SAMPLES).find_map(|k| {
                let at = MOST_OF_A_STEP * step * k as f64 / SAMPLES as f64;
                let there = evaluator.number(target.function, &along(from, way, at));
                (there * value.signum() < -CROSSED * size).then_some(at)
            });
            crossed.map(|at| (from, step, at))
        })
        .collect();
    for (from, step, at) in crossed {
        scope.oversteps(from, step, at);
    }
}

/// How far the renderer goes from a place along a direction.
fn safe(evaluator: &Evaluator<'_>, stride: Stride, from: [f64; 3], way: [f64; 3], value: f64) -> f64 {
    let steepness = match stride {
        Stride::Scale(scale) => return f64::from(scale) * value,
        Stride::Within(steepness) => steepness,
    };
    let mut reach = value;
    for _ in 0..TRIES {
        let to = along(from, way, reach);
        let lo = [0, 1, 2].map(|k| from[k].min(to[k]));
        let hi = [0, 1, 2].map(|k| from[k].max(to[k]));
        let steepest = evaluator.number(steepness, &[lo, hi].concat());
        if steepest < f64::from(NO_BOUND) {
            return (value / steepest).min(reach);
        }
        reach *= 0.25;
    }
    0.0
}

/// A ray under way.
#[derive(Clone, Copy)]
struct Walker {
    origin: [f64; 3],
    direction: [f64; 3],
    t: f64,
    last: f64,
    exit: f64,
}

impl Walker {
    fn at(&self, t: f64) -> [f64; 3] {
        along(self.origin, self.direction, t)
    }
}

/// Looks for rays that take most of their steps.
pub(super) fn check_progress(
    evaluator: &Evaluator<'_>,
    target: &Target,
    random: &mut Random,
    scope: &mut Scope<'_>,
) {
    let Role::Distance { stride, .. } = target.role else { return };
    let all: Vec<Walker> = (0..RAYS).filter_map(|_| walker(&target.place, random)).collect();
    let started = all.len();
    let mut walkers = all;
    for _ in 0..SLOW {
        let rows: Vec<f32> = walkers.iter().flat_map(|w| w.at(w.t).map(|x| x as f32)).collect();
        let mut values: Vec<f64> =
            evaluator.single(target.function, &rows).into_iter().map(f64::from).collect();
        let outside: Vec<bool> = values.iter().map(|&value| value >= 0.0).collect();
        shorten(evaluator, stride, &walkers, &mut values);
        let moved = walkers.iter().zip(values).zip(outside).filter(|(_, outside)| *outside);
        let moved = moved.map(|((walker, value), _)| {
            let step = value.max(SHORTEST * walker.t);
            Walker { t: walker.t + step, last: step, ..*walker }
        });
        walkers = moved.filter(|walker| walker.t <= walker.exit).collect();
        if walkers.is_empty() {
            return;
        }
    }
    let share = walkers.len() as f64 / started as f64;
    if share > MAY_BE_SLOW {
        let ray = walkers[0];
        scope.slow(ray.origin.map(|x| x as f32), ray.direction.map(|x| x as f32), SLOW, share);
    }
}

/// A ray from around a solid into its box.
fn walker(place: &Place, random: &mut Random) -> Option<Walker> {
    let aim = [0, 1, 2].map(|k| random.between(place.lo[k], place.hi[k]));
    let away = direction(random);
    let origin = along(aim, away, 3.0 * place.size);
    let direction = away.map(|x| -x);
    // Where it is in the box.
    let (mut entry, mut exit) = (0.0f64, 1e30f64);
    for k in 0..3 {
        if direction[k].abs() < 1e-12 {
            continue;
        }
        let (a, b) = ((place.lo[k] - origin[k]) / direction[k], (place.hi[k] - origin[k]) / direction[k]);
        entry = entry.max(a.min(b));
        exit = exit.min(a.max(b));
    }
    (entry <= exit).then_some(Walker { origin, direction, t: entry, last: 0.0, exit })
}

/// Makes values safe to walk as the renderer does: by a bound on the slope over the next step, which is at
/// most twice as long as the last.
fn shorten(evaluator: &Evaluator<'_>, stride: Stride, walkers: &[Walker], values: &mut [f64]) {
    let steepness = match stride {
        Stride::Scale(scale) => {
            values.iter_mut().for_each(|value| *value *= f64::from(scale));
            return;
        }
        Stride::Within(steepness) => steepness,
    };
    let reach = |(walker, &value): (&Walker, &f64)| {
        let outside = value.max(0.0);
        if walker.last > 0.0 { outside.min(2.0 * walker.last) } else { outside }
    };
    let mut reaches: Vec<f64> = walkers.iter().zip(&*values).map(reach).collect();
    let mut pending: Vec<usize> = (0..walkers.len()).filter(|&i| values[i] > 0.0).collect();
    for _ in 0..TRIES {
        let corners = |&i: &usize| {
            let (from, to) = (walkers[i].at(walkers[i].t), walkers[i].at(walkers[i].t + reaches[i]));
            let lo = [0, 1, 2].map(|k| from[k].min(to[k]) as f32);
            let hi = [0, 1, 2].map(|k| from[k].max(to[k]) as f32);
            [lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]]
        };
        let rows: Vec<f32> = pending.iter().flat_map(corners).collect();
        let steepest = evaluator.single(steepness, &rows);
        let (known, unknown): (Vec<_>, Vec<_>) =
            pending.into_iter().zip(steepest).partition(|&(_, steepest)| steepest < NO_BOUND);
        known
            .into_iter()
            .for_each(|(i, steepest)| values[i] = (values[i] / f64::from(steepest)).min(reaches[i]));
        pending = unknown.into_iter().map(|(i, _)| i).collect();
        if pending.is_empty() {
            return;
        }
        pending.iter().for_each(|&i| reaches[i] *= 0.25);
    }
    pending.into_iter().for_each(|i| values[i] = 0.0);
}
