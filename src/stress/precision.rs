//! f32 against f64 and its running error bound, at awkward places.

use rayon::prelude::*;
use vol_compiler::error_bound::Bounded;
use vol_compiler::ir::FunctionId;
use vol_compiler::ir::verify::random::Random;

use super::Row;
use super::evaluate::Evaluator;
use super::findings::{At, Scope};
use super::points::{along, dot};
use super::targets::{Role, Target};
use crate::failure::Failure;

/// An error bound larger than this part of the function's values means that nothing is left of them.
const HOPELESS: f64 = 1e-2;

/// A bound is only believed to be hopeless where what was computed is off by this part of the values, too:
/// bounds of long chains of operations are seldom reached.
const VISIBLE: f64 = 1e-3;

/// Share of places at which a value that is undecided may also be wrong: beside a jump that the author
/// wrote, or a slope beside an edge.
const WRONG_BESIDE_JUMPS: f64 = 0.05;

/// How far below a surface its slope is asked, in sizes: the renderer asks inside, too, since a distance may
/// have no slope on the surface itself.
const BELOW: f64 = 1e-4;

/// The same where the solid is far from the origin, per distance: 16 units in the last place of a position.
const ROUNDING: f64 = 2e-6;

/// Compares a function's values in f32 with those in f64 and tells what is off.
///
/// # Errors
/// A device failure.
pub(super) fn check(
    evaluator: &Evaluator<'_>,
    target: &Target,
    count: usize,
    random: &mut Random,
    scope: &mut Scope<'_>,
) -> Result<Row, Failure> {
    let (width, outputs) = evaluator.shape(target.function);
    let rows = rows(evaluator, target, count, random);
    let expected = evaluator.bounded(target.function, &rows);
    let scales = scales(target, &rows, &expected, width, outputs);
    let mut row = Row {
        name: target.name.clone(),
        points: rows.len() / width,
        undecided: 0,
        apart: 0.0,
        share: 0.0,
        findings: 0,
    };
    for device in evaluator.devices {
        let found = evaluator.on(device, target.function, &rows)?;
        let mut beside = Beside::default();
        for (i, inputs) in rows.chunks_exact(width).enumerate() {
            for output in 0..outputs {
                let (single, bounded) = (found[i * outputs + output], expected[i * outputs + output]);
                let at = At { inputs, output };
                compare(&mut row, scope, at, (single, bounded, scales[output]), target, &mut beside);
            }
        }
        beside.report(scope);
    }
    let undecided = |values: &[Bounded]| values.iter().any(|bounded| !bounded.error.is_finite());
    row.undecided = expected.chunks_exact(outputs).filter(|values| undecided(values)).count();
    Ok(row)
}

/// Undecided values that are also far off, and of how many.
#[derive(Default)]
struct Beside {
    all: usize,
    wrong: Vec<(Vec<f32>, usize, f64, f64)>,
}

impl Beside {
    /// More than there can be next to jumps are a loss of digits.
    fn report(self, scope: &mut Scope<'_>) {
        if self.wrong.len() as f64 > WRONG_BESIDE_JUMPS * self.all as f64 {
            for (inputs, output, off, scale) in self.wrong.iter().take(1) {
                scope.lost_digits(At { inputs, output: *output }, *off, *scale);
            }
        }
    }
}

/// One value.
fn compare(
    row: &mut Row,
    scope: &mut Scope<'_>,
    at: At<'_>,
    (single, bounded, scale): (f32, Bounded, f64),
    target: &Target,
    beside: &mut Beside,
) {
    if !single.is_finite() {
        scope.not_finite(at);
        return;
    }
    let off = (f64::from(single) - bounded.value).abs();
    let scale = scale.max(bounded.value.abs());
    let judged = is_judged(target, at.inputs) && scale > 0.0;
    beside.all += usize::from(judged);
    // Slopes jump at edges, whatever their bound says.
    let may_jump = !bounded.error.is_finite() || matches!(target.role, Role::Gradient { .. });
    if may_jump && judged && off > HOPELESS * scale {
        beside.wrong.push((at.inputs.to_vec(), at.output, off, scale));
    }
    if !bounded.error.is_finite() {
        return;
    }
    let share = if off == 0.0 { 0.0 } else { off / bounded.error };
    row.share = row.share.max(share);
    if judged {
        row.apart = row.apart.max(off / scale);
    }
    if share > 1.0 {
        scope.out_of_bound(at, off, bounded.error);
    } else if judged && !may_jump && bounded.error > HOPELESS * scale && off > VISIBLE * scale {
        scope.lost_digits(at, bounded.error, scale);
    }
}

/// Whether a loss of digits matters there: near the box, where pictures ask.
fn is_judged(target: &Target, inputs: &[f32]) -> bool {
    match (target.role, inputs) {
        (Role::Phase, _) => true,
        (Role::Steepness, _) => false,
        (_, &[x, y, z]) => target.place.is_around([x, y, z]),
        (_, _) => false,
    }
}

/// How large the values of each output are: a distance as its box, a slope 1, others as they are found in
/// the box, vectors and colours alike.
fn scales(target: &Target, rows: &[f32], expected: &[Bounded], width: usize, outputs: usize) -> Vec<f64> {
    match target.role {
        Role::Distance { .. } | Role::Region => return vec![target.place.size; outputs],
        Role::Gradient { .. } => return vec![1.0; outputs],
        Role::Steepness | Role::Phase | Role::Surface { .. } | Role::Interior { .. } | Role::Field => {}
    }
    let here = |row: &[f32]| width != 3 || target.place.is_around([row[0], row[1], row[2]]);
    let near = rows.chunks_exact(width).zip(expected.chunks_exact(outputs)).filter(|(row, _)| here(row));
    let values = near.flat_map(|(_, values)| values.iter().map(|bounded| bounded.value.abs()));
    let largest = values.filter(|value| value.is_finite()).fold(0.0, f64::max);
    vec![largest; outputs]
}

/// Inputs at which a function is asked, rows one after the other.
fn rows(evaluator: &Evaluator<'_>, target: &Target, count: usize, random: &mut Random) -> Vec<f32> {
    match target.role {
        Role::Distance { .. } => {
            let mut points = target.place.awkward(count, random);
            points.extend(near_surface(evaluator, target, target.function, count / 4, random));
            points.concat()
        }
        Role::Region | Role::Field => target.place.awkward(count, random).concat(),
        Role::Gradient { distance } | Role::Surface { distance } => {
            near_surface(evaluator, target, distance, count, random).concat()
        }
        Role::Interior { region } => inside(evaluator, target, region, count, random).concat(),
        Role::Steepness => boxes(target, count, random),
        Role::Phase => (0..count).flat_map(|i| angle(i, random)).collect(),
    }
}

/// Places on a surface and next to it; for slopes a little below it.
fn near_surface(
    evaluator: &Evaluator<'_>,
    target: &Target,
    distance: FunctionId,
    count: usize,
    random: &mut Random,
) -> Vec<[f32; 3]> {
    let slope = evaluator.program.objects.iter().find(|object| object.distance == distance);
    let Some(slope) = slope.map(|object| object.gradient) else { return Vec::new() };
    let size = target.place.size;
    let starts = target.place.awkward(2 * count, random).into_iter().filter(|&p| target.place.is_around(p));
    let starts: Vec<[f32; 3]> = starts.take(count).collect();
    let far = target.place.lo.iter().chain(&target.place.hi).fold(0.0f64, |far, x| far.max(x.abs()));
    let is_slope = matches!(target.role, Role::Gradient { .. });
    let below = if is_slope { (BELOW * size).max(ROUNDING * far) } else { 0.0 };
    let landed: Vec<_> =
        starts.par_iter().filter_map(|p| land(evaluator, distance, slope, p.map(f64::from), size)).collect();
    // On it, or up to a millionth of the size to either side.
    let beside = landed.into_iter().map(|(p, slope)| {
        let off = [0.0, 1e-6, -1e-6, 1e-7][random.below(4)] * size;
        let p = along(p, super::points::direction(random), off);
        along(p, slope, -below / dot(slope, slope).sqrt().max(1e-6)).map(|x| x as f32)
    });
    beside.collect()
}

/// The surface near a place, by steps along the gradient, and the slope there; none if it is not found.
fn land(
    evaluator: &Evaluator<'_>,
    distance: FunctionId,
    slope: FunctionId,
    mut p: [f64; 3],
    size: f64,
) -> Option<([f64; 3], [f64; 3])> {
    let mut gradient = [0.0; 3];
    for _ in 0..12 {
        let value = evaluator.number(distance, &p);
        if value.abs() < 1e-9 * size {
            break;
        }
        let found = evaluator.exact(slope, &p);
        gradient = [found[0], found[1], found[2]];
        let square = dot(gradient, gradient);
        if !(square > 1e-12 && value.is_finite()) {
            return None;
        }
        p = along(p, gradient, -value / square);
    }
    (evaluator.number(distance, &p).abs() < 1e-4 * size).then_some((p, gradient))
}

/// Places inside a region, as the CPU sees it.
fn inside(
    evaluator: &Evaluator<'_>,
    target: &Target,
    region: FunctionId,
    count: usize,
    random: &mut Random,
) -> Vec<[f32; 3]> {
    // At most so many rounds: a thin region fills little of its box.
    const ROUNDS: usize = 8;
    let mut found = Vec::with_capacity(count);
    for _ in 0..ROUNDS {
        let points = target.place.awkward(count, random);
        let distances = evaluator.single(region, points.as_flattened());
        found.extend(points.into_iter().zip(distances).filter(|(_, d)| *d <= 0.0).map(|(p, _)| p));
        if found.len() >= count {
            break;
        }
    }
    found.truncate(count);
    found
}

/// Boxes of steps of rays: corners, the smallest first.
fn boxes(target: &Target, count: usize, random: &mut Random) -> Vec<f32> {
    let corners = target.place.awkward(count, random).into_iter().filter(|&p| target.place.is_around(p));
    let rows = corners.flat_map(|p| {
        let length = target.place.size * 10f64.powf(random.between(-6.0, 0.0));
        let way = super::points::direction(random);
        let q = along(p.map(f64::from), way, length).map(|x| x as f32);
        let (lo, hi) = ([0, 1, 2].map(|k| p[k].min(q[k])), [0, 1, 2].map(|k| p[k].max(q[k])));
        [lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]]
    });
    rows.collect()
}

/// `1 - cos` and `1 + cos` of an angle; forward, backward and nearly so, too.
fn angle(i: usize, random: &mut Random) -> [f32; 2] {
    let small = 10f64.powf(random.between(-12.0, 0.0));
    let less = match i % 8 {
        0 => 0.0,
        1 => 2.0,
        2 | 3 => small,
        4 | 5 => 2.0 - small,
        _ => random.between(0.0, 2.0),
    };
    [less as f32, (2.0 - less) as f32]
}
