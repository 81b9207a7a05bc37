//! Variation along rays: three volumes painted by brushes, and the noise that they steer, as one function
//! of the position.
//!
//! `intensity (amount noise + 1 - amount)`, noise in 0..1. A brush moves what is there towards what it paints by
//! `weight = opacity (1 - smoothstep(hardness, 1, d))`, `d` the distance from its centre in its half axes; an eraser
//! towards what was there before any brush. Volumes are never stored: brushes are evaluated where a ray asks.

use super::super::super::value::Word;
use super::super::super::{Lowered, Lowerer};
use super::{Given, NOT_NEGATIVE, OCTAVES, POSITIVE, SHARE, argument, optional, word};
use crate::ir::ValueId;
use crate::ops::Op;
use crate::program::style::Heterogeneity;
use vol_language::diag::Diagnostic;

/// Default samples along a ray.
const STEPS: u32 = 64;

/// Octaves that brushes may add.
const MORE_OCTAVES: u32 = 4;

/// The variation that settings describe; `style` is the name of their style.
pub(super) fn heterogeneity(
    lowerer: &mut Lowerer<'_>,
    style: &str,
    given: &Given<'_>,
) -> Lowered<Heterogeneity> {
    let mut whole = |key: &str, what: &str, default: u32, most: u32| match given.get(key) {
        Some((value, span)) => lowerer.whole(value, span, what, 1, most),
        None => Ok(default),
    };
    let octaves = whole("octaves", "the number of octaves", OCTAVES, 12)?;
    let steps = whole("steps", "the number of samples", STEPS, 4096)?;
    let upsample = whole("upsample", "the upsampling", 1, 16)?;
    if let Some((_, span)) = given.get("upsample").filter(|_| ![1, 4, 16].contains(&upsample)) {
        let message = "the upsampling must be 1, 4 or 16 pixels";
        let error = Diagnostic::error("E0407", message, span, format!("here it is {upsample}"));
        return Err(Box::new(error.with_help("write `upsample: 4`")));
    }
    let value = field(lowerer, given, octaves)?;
    let name = format!("heterogeneity:{style}");
    Ok(Heterogeneity { field: lowerer.function(&name, 3, &[value]), steps, upsample })
}

/// The three volumes at a point.
#[derive(Clone, Copy)]
struct Painted {
    amount: ValueId,
    /// Octaves of the noise, added to those that it has.
    detail: ValueId,
    intensity: ValueId,
}

fn field(lowerer: &mut Lowerer<'_>, given: &Given<'_>, octaves: u32) -> Lowered<ValueId> {
    let brushes = given.get("brushes").map_or_else(|| [].into(), |(value, _)| value.list());
    // What is painted shows only against what is not.
    let everywhere = if brushes.is_empty() { 1.0 } else { 0.0 };
    let amount = setting(lowerer, given, "amount", everywhere, &SHARE)?;
    let frequency = setting(lowerer, given, "frequency", 1.0, &POSITIVE)?;
    let bare = Painted { amount, detail: lowerer.graph.number(0.0), intensity: lowerer.graph.number(1.0) };
    let mut painted = bare;
    for value in brushes.iter() {
        painted = brush(lowerer, word(value), bare, painted)?;
    }
    let noise = noise(lowerer, frequency, octaves, painted.detail);
    let graph = &mut lowerer.graph;
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    let least = graph.sub(noise, one);
    let change = graph.mul(painted.amount, least);
    let varied = graph.add(one, change);
    let value = graph.mul(painted.intensity, varied);
    Ok(graph.max(value, zero))
}

/// A setting or its default, as a value that does not depend on the position.
fn setting(
    lowerer: &mut Lowerer<'_>,
    given: &Given<'_>,
    key: &str,
    default: f64,
    within: &super::Within,
) -> Lowered<ValueId> {
    let Some((value, span)) = given.get(key) else { return Ok(lowerer.graph.number(default)) };
    lowerer.within(value.scalar(), &format!("`{key}`"), within, span)?;
    Ok(value.scalar())
}

/// What is painted once a brush or an eraser has been there.
fn brush(lowerer: &mut Lowerer<'_>, word: &Word, bare: Painted, before: Painted) -> Lowered<Painted> {
    let weight = weight(lowerer, word)?;
    let mut part = |index: usize, range: &super::Within| -> Lowered<Option<ValueId>> {
        let Some((value, span)) = optional(word, index) else { return Ok(None) };
        lowerer.within(value.scalar(), "what a brush paints", range, span)?;
        Ok(Some(value.scalar()))
    };
    let (frequency, amount, intensity) = (part(4, &POSITIVE)?, part(5, &SHARE)?, part(6, &NOT_NEGATIVE)?);
    let graph = &mut lowerer.graph;
    let erases = word.name == "eraser";
    let one = graph.number(1.0);
    let detail = frequency.map(|frequency| graph.apply(Op::Log2, &[frequency]));
    let nothing = frequency.is_none() && amount.is_none() && intensity.is_none();
    let target = Painted {
        amount: amount.unwrap_or(if nothing { one } else { before.amount }),
        detail: detail.unwrap_or(before.detail),
        intensity: intensity.unwrap_or(before.intensity),
    };
    let target = if erases { bare } else { target };
    let mut towards = |from: ValueId, to: ValueId| {
        let change = graph.sub(to, from);
        let part = graph.mul(weight, change);
        graph.add(from, part)
    };
    Ok(Painted {
        amount: towards(before.amount, target.amount),
        detail: towards(before.detail, target.detail),
        intensity: towards(before.intensity, target.intensity),
    })
}

/// How far a brush moves what is there: `opacity (1 - smoothstep(hardness, 1, d))`.
fn weight(lowerer: &mut Lowerer<'_>, word: &Word) -> Lowered<ValueId> {
    let (center, span) = argument(word, 0);
    lowerer.slots(center.vec3(), "the centre of a brush", span)?;
    let (radii, span) = argument(word, 1);
    let message = "the half axes of a brush must be more than 0";
    lowerer.refuse_with_help(&radii.vec3(), POSITIVE.wrong, message, span, "write (1, 1, 1) here")?;
    lowerer.slots(radii.vec3(), "the half axes of a brush", span)?;
    let mut share = |index: usize, what: &str, default: f64| -> Lowered<ValueId> {
        let Some((value, span)) = optional(word, index) else { return Ok(lowerer.graph.number(default)) };
        lowerer.within(value.scalar(), what, &SHARE, span)?;
        Ok(value.scalar())
    };
    let (hardness, opacity) =
        (share(2, "the hardness of a brush", 0.5)?, share(3, "the opacity of a brush", 1.0)?);
    let position = lowerer.position();
    let graph = &mut lowerer.graph;
    let mut square = graph.number(0.0);
    for ((place, center), radius) in position.into_iter().zip(center.vec3()).zip(radii.vec3()) {
        let off = graph.sub(place, center);
        let off = graph.div(off, radius);
        let off = graph.mul(off, off);
        square = graph.add(square, off);
    }
    let distance = graph.apply(Op::Sqrt, &[square]);
    // A hardness of 1 is a step that is still a number.
    let (zero, one, thinnest) = (graph.number(0.0), graph.number(1.0), graph.number(1e-4));
    let soft = graph.sub(one, hardness);
    let soft = graph.max(soft, thinnest);
    let left = graph.sub(one, distance);
    let share = graph.div(left, soft);
    let share = graph.max(share, zero);
    let share = graph.min(share, one);
    // smoothstep(hardness, 1, d) = 1 - smoothstep of what is left of the way, which is symmetric.
    let (two, three) = (graph.number(2.0), graph.number(3.0));
    let doubled = graph.mul(two, share);
    let bend = graph.sub(three, doubled);
    let squared = graph.mul(share, share);
    let smooth = graph.mul(squared, bend);
    Ok(graph.mul(opacity, smooth))
}

/// Octaves of perlin noise in 0..1: weights `2^-k clamp(octaves + detail - k, 0, 1)`, over the sum of those
/// without `detail`.
fn noise(lowerer: &mut Lowerer<'_>, frequency: ValueId, octaves: u32, detail: ValueId) -> ValueId {
    let position = lowerer.position();
    let graph = &mut lowerer.graph;
    let (zero, one) = (graph.number(0.0), graph.number(1.0));
    let varies = graph.constant(detail) != Some(0.0);
    let count = if varies { octaves + MORE_OCTAVES } else { octaves };
    let scaled = position.map(|x| graph.mul(x, frequency));
    let (mut sum, mut total) = (zero, 0.0);
    for octave in 0..count {
        let (stretch, gain) = (2f64.powi(octave as i32), 0.5f64.powi(octave as i32));
        let stretch = graph.number(stretch);
        let place = scaled.map(|x| graph.mul(x, stretch));
        let value = graph.apply_data(Op::Perlin, 0, &place);
        let level = graph.number(f64::from(octaves) - f64::from(octave));
        let weight = graph.add(level, detail);
        let weight = graph.max(weight, zero);
        let weight = graph.min(weight, one);
        let gain_value = graph.number(gain);
        let amplitude = graph.mul(gain_value, weight);
        let part = graph.mul(amplitude, value);
        sum = graph.add(sum, part);
        total += if octave < octaves { gain } else { 0.0 };
    }
    let half = graph.number(0.5);
    let scale = graph.number(0.5 / total);
    let swing = graph.mul(scale, sum);
    let noise = graph.add(half, swing);
    let noise = graph.max(noise, zero);
    graph.min(noise, one)
}
