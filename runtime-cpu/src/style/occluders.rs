//! The shadow map of a style: what hides the light, changed by the style's operators in their order.
//!
//! Solids that some operator treats apart from others have a map of their own, a *layer*. An operator for some objects
//! puts the layers with any of them together and changes that; what it has put together stays so. At the end the
//! highest of all layers counts. Surfaces keep the shadows of the solids themselves.

use super::Stage;
use super::holes::holes;
use super::morphology::{close_disk, dilate_row, erode_row};
use super::shadow_map::{Layout, NOTHING};
use super::slices::Fan;
use rayon::prelude::*;
use std::collections::BTreeMap;
use vol_compiler::frame::Frame;
use vol_compiler::frame::styled::Slices;
use vol_compiler::program::style::{MOST_KERNEL, Operator, OperatorKind, Style};

/// The shadow map of a style before any operator, whoever looks at it.
pub(super) struct Traced {
    layout: Layout,
    layers: Vec<Layer>,
}

impl Traced {
    /// Follows the rays of the light.
    pub(super) fn new(stage: &Stage<'_>, style: &Style<f64>, layout: Layout) -> Self {
        Self { layout, layers: layers(stage, style, &layout) }
    }

    /// The map after all operators, texel by texel, `u` fastest.
    pub(super) fn heights(&self, style: &Style<f64>, eye: [f32; 3]) -> Vec<f32> {
        let (fan, layers) = self.changed(style, eye);
        joined(layers, |layer| layer.into_map(&fan))
    }

    /// The slices of the light as an eye sees them.
    pub(super) fn slices(&self, style: &Style<f64>, eye: [f32; 3]) -> Slices {
        let (fan, layers) = self.changed(style, eye);
        fan.table(joined(layers, |layer| layer.into_slopes(&fan)))
    }

    /// The layers after all operators, and how the slices of an eye lie on them.
    fn changed(&self, style: &Style<f64>, eye: [f32; 3]) -> (Fan, Vec<Layer>) {
        let fan = Fan::new(self.layout, eye.map(f64::from));
        let mut layers = self.layers.clone();
        for operator in &style.operators {
            operate(operator, &mut layers, &self.layout, &fan);
        }
        (fan, layers)
    }
}

/// Some objects and how high they are.
#[derive(Clone)]
struct Layer {
    objects: Vec<String>,
    shape: Shape,
}

/// Heights on a map, or slopes in slices.
#[derive(Clone)]
enum Shape {
    Map(Vec<f32>),
    Slices(Vec<f32>),
}

impl Layer {
    fn into_map(self, fan: &Fan) -> Vec<f32> {
        match self.shape {
            Shape::Map(heights) => heights,
            Shape::Slices(slopes) => fan.join(&slopes),
        }
    }

    fn into_slopes(self, fan: &Fan) -> Vec<f32> {
        match self.shape {
            Shape::Map(heights) => fan.cut(&heights),
            Shape::Slices(slopes) => slopes,
        }
    }
}

/// One layer for all objects that the same operators are for.
fn layers(stage: &Stage<'_>, style: &Style<f64>, layout: &Layout) -> Vec<Layer> {
    let Stage { program, frame, job, tapes, .. } = *stage;
    let mut groups: BTreeMap<Vec<bool>, Vec<usize>> = BTreeMap::new();
    for (which, object) in frame.objects.iter().enumerate() {
        let name = &program.objects[object.index].name;
        let concerned = style.operators.iter().map(|operator| concerns(operator, name)).collect();
        groups.entry(concerned).or_default().push(which);
    }
    let layer = |objects: Vec<usize>| {
        let own = objects.iter().map(|&which| frame.objects[which].clone()).collect();
        let part = Frame { objects: own, ..frame.clone() };
        let heights = layout.trace(tapes, &part, job);
        let names = objects.iter().map(|&which| program.objects[frame.objects[which].index].name.clone());
        Layer { objects: names.collect(), shape: Shape::Map(heights) }
    };
    groups.into_values().map(layer).collect()
}

fn concerns(operator: &Operator<f64>, object: &str) -> bool {
    operator.only.as_ref().is_none_or(|names| names.iter().any(|name| name == object))
}

fn operate(operator: &Operator<f64>, layers: &mut Vec<Layer>, layout: &Layout, fan: &Fan) {
    let is_concerned = |layer: &Layer| layer.objects.iter().any(|name| concerns(operator, name));
    let (concerned, others): (Vec<_>, Vec<_>) = std::mem::take(layers).into_iter().partition(is_concerned);
    *layers = others;
    if concerned.is_empty() {
        return;
    }
    let objects = concerned.iter().flat_map(|layer| layer.objects.iter().cloned()).collect();
    // A param or the time may have set anything.
    let texels = |length: f64| if length.is_finite() { length.clamp(0.0, MOST_KERNEL) } else { 0.0 };
    let shape = match &operator.kind {
        OperatorKind::CloseDisk(diameter) => {
            let mut heights = joined(concerned, |layer| layer.into_map(fan));
            close_disk(&mut heights, layout.size, texels(*diameter) as f32);
            Shape::Map(heights)
        }
        OperatorKind::CloseEpipolar(length) => {
            let mut slopes = joined(concerned, |layer| layer.into_slopes(fan));
            let length = texels(*length).round() as usize;
            each_slice(&mut slopes, fan, |slice, scratch| {
                dilate_row(slice, length, scratch);
                erode_row(slice, length, scratch);
            });
            Shape::Slices(slopes)
        }
        OperatorKind::Extrude(length) => {
            let mut slopes = joined(concerned, |layer| layer.into_slopes(fan));
            let length = texels(*length).round() as usize;
            each_slice(&mut slopes, fan, |slice, scratch| dilate_row(slice, length, scratch));
            Shape::Slices(slopes)
        }
        OperatorKind::Holes(settings) => {
            let mask = holes(settings, layout.size);
            if concerned.iter().all(|layer| matches!(layer.shape, Shape::Map(_))) {
                let mut heights = joined(concerned, |layer| layer.into_map(fan));
                punch(&mut heights, &mask, NOTHING);
                Shape::Map(heights)
            } else {
                let mut slopes = joined(concerned, |layer| layer.into_slopes(fan));
                punch(&mut slopes, &fan.cut_mask(&mask), Slices::NO_SLOPE);
                Shape::Slices(slopes)
            }
        }
    };
    layers.push(Layer { objects, shape });
}

/// The highest of some layers, all in one form.
fn joined(layers: Vec<Layer>, form: impl Fn(Layer) -> Vec<f32>) -> Vec<f32> {
    let all = layers.into_iter().map(form).reduce(|mut all, other| {
        raise(&mut all, &other);
        all
    });
    all.unwrap_or_default()
}

fn raise(all: &mut [f32], other: &[f32]) {
    all.iter_mut().zip(other).for_each(|(height, other)| *height = height.max(*other));
}

fn punch(heights: &mut [f32], holes: &[bool], nothing: f32) {
    heights.iter_mut().zip(holes).filter(|(_, hole)| **hole).for_each(|(height, _)| *height = nothing);
}

fn each_slice(slopes: &mut [f32], fan: &Fan, change: impl Fn(&mut [f32], &mut Vec<f32>) + Sync) {
    slopes.par_chunks_mut(fan.columns()).for_each_init(Vec::new, |scratch, slice| change(slice, scratch));
}
