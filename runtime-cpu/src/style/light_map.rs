//! The colour of a light across its direction, fitted to strokes painted in some views (Kol et al. 2016, §4.2).
//!
//! A pixel of a stroke is a ray; the light that media send along it is linear in the texels of the map. The weights are
//! those of the integrator itself with a white map, each sample of a medium counted to the texel that it lies in, so
//! whatever media there are is right. The paper prints weights without `sigma_t dt`; its Eq. 1 has them. The colour asked for
//! is the stroke's times what the white map gives: strokes say nothing about shading. Where strokes of one view cross the
//! last one counts.

use super::least_squares::{Fit, Transport, fit as solve};
use super::{Hiders, Stage, shadow_map};
use crate::render::{Batch, Batches, Integrator, Scene, camera_ray, fill_light_grid, filling_bytes};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use vol_compiler::frame::styled::{LightMapTable, stroke_outside};
use vol_compiler::frame::{Aabb, CameraFrame, Diagnostic, Frame, Job, LightFrame, LightGrid};
use vol_compiler::program::style::{LightMap, Stroke, Style};

/// Most pixels that are asked for a colour; of more, some are taken.
const MAX_PIXELS: usize = 1 << 16;

/// Rays that one thread follows at a time.
const RAYS: usize = 64;

/// Intervals along the longest side of the grid of depths towards the light: weights are sums over many samples, and
/// marching from each of them was a third of the time of a light map.
const INTERVALS: u32 = 128;

/// A light map and how well it meets its strokes.
#[derive(Clone, Debug)]
pub struct FittedMap {
    /// Name of the style.
    pub style: String,
    /// The map.
    pub table: LightMapTable,
    /// How it was found; none where it was known before.
    pub fit: Option<FitReport>,
}

/// How a light map was found.
#[derive(Clone, Debug)]
pub struct FitReport {
    /// Pixels asked for a colour.
    pub pixels: usize,
    /// Steps of the conjugate gradients.
    pub iterations: usize,
    /// Whether they came to an end before their number did.
    pub converged: bool,
    /// Residual over the colours asked for, both as lengths.
    pub residual: f64,
    /// The same of the white map and after each step.
    pub history: Vec<f64>,
}

/// The light map of a style; `texels` where they are known.
pub(super) fn fit(
    stage: &Stage<'_>,
    style: &Style<f64>,
    settings: &LightMap<f64>,
    hiders: &Hiders,
    texels: Option<Vec<[f32; 3]>>,
) -> Result<FittedMap, Diagnostic> {
    let light = &stage.frame.lights[style.light];
    let mut table = across(light, &stage.bounds, settings.size);
    let count = (settings.size * settings.size) as usize;
    if let Some(texels) = texels.filter(|texels| texels.len() == count) {
        table.texels = texels;
        return Ok(FittedMap { style: style.name.clone(), table, fit: None });
    }
    let mut views = Vec::new();
    for (camera, strokes) in self::views(stage, &settings.strokes) {
        views.push((camera, painted(&strokes, stage.job.size, stage.program.render.size)?));
    }
    let all: usize = views.iter().map(|(_, pixels)| pixels.len()).sum();
    let stride = all.div_ceil(MAX_PIXELS).max(1);
    let (mut rows, mut wanted) = (Vec::new(), Vec::new());
    let mut light_grids = vec![None; stage.frame.lights.len()];
    light_grids[style.light] = depths(stage, light);
    for (camera, pixels) in views {
        let pixels: Vec<Painted> = pixels.into_iter().step_by(stride).collect();
        let lit = seen_from(stage, style, hiders, camera);
        let frame = Frame { light_grids: light_grids.clone(), ..lit };
        for (row, color) in weights(stage, &frame, style.light, &table, &pixels).into_iter().zip(&pixels) {
            let white = row.iter().fold([0.0; 3], |sum, (_, w)| [0, 1, 2].map(|i| sum[i] + f64::from(w[i])));
            wanted.push([0, 1, 2].map(|i| (white[i] * color.1[i]) as f32));
            rows.push(row);
        }
    }
    let transport = Transport::new(rows, count);
    let solution = solve(&transport, &wanted, settings.size as usize, &Fit::default());
    table.texels = solution.texels;
    let fit = FitReport {
        pixels: wanted.len(),
        iterations: solution.iterations,
        converged: solution.converged,
        residual: solution.residual,
        history: solution.history.iter().map(|progress| progress.residual).collect(),
    };
    Ok(FittedMap { style: style.name.clone(), table, fit: Some(fit) })
}

/// A map that covers a box, without texels yet.
fn across(light: &LightFrame, bounds: &Aabb, size: u32) -> LightMapTable {
    let ([u, v, _], lo, side) = shadow_map::across(light, bounds);
    let texel = side / f64::from(size);
    let middle = lo.map(|lo| lo + 0.5 * texel);
    let origin = [0, 1, 2].map(|i| (u[i] * middle[0] + v[i] * middle[1]) as f32);
    let axes = [u, v].map(|axis| axis.map(|x| (x / texel) as f32));
    LightMapTable { origin, axes, size, texels: Vec::new() }
}

/// The strokes of each view, in their order.
fn views<'a>(stage: &Stage<'_>, strokes: &'a [Stroke<f64>]) -> Vec<(CameraFrame, Vec<&'a Stroke<f64>>)> {
    let mut views: Vec<(CameraFrame, Vec<&Stroke<f64>>)> = Vec::new();
    for stroke in strokes {
        let camera = match &stroke.view {
            Some(view) => CameraFrame::of_view(view, stage.job.size),
            None => stage.frame.camera,
        };
        match views.iter_mut().find(|(known, _)| *known == camera) {
            Some((_, list)) => list.push(stroke),
            None => views.push((camera, vec![stroke])),
        }
    }
    views
}

/// A pixel and the colour that it is to have.
type Painted = ([u32; 2], [f64; 3]);

/// Pixels of a picture that strokes cover, which were painted in one of another size.
fn painted(
    strokes: &[&Stroke<f64>],
    size: [u32; 2],
    painted_in: [u32; 2],
) -> Result<Vec<Painted>, Diagnostic> {
    let mut pixels = BTreeMap::new();
    let scales = [0, 1].map(|axis| f64::from(size[axis]) / f64::from(painted_in[axis]));
    for stroke in strokes {
        let mut touches = false;
        for_each_pixel(&scaled(stroke, scales), size, |pixel| {
            touches = true;
            pixels.insert([pixel[1], pixel[0]], stroke.color);
        });
        if !touches {
            return Err(stroke_outside(stroke.span, painted_in));
        }
    }
    Ok(pixels.into_iter().map(|([y, x], color)| ([x, y], color)).collect())
}

/// A stroke in a picture of another size; as wide as the heights say.
fn scaled(stroke: &Stroke<f64>, [x, y]: [f64; 2]) -> Stroke<f64> {
    let ends = stroke.ends.map(|end| [x * end[0], y * end[1]]);
    Stroke { ends, width: y * stroke.width, ..stroke.clone() }
}

/// Calls with each pixel whose middle is within half the stroke's width of the line between its ends.
fn for_each_pixel(stroke: &Stroke<f64>, size: [u32; 2], mut call: impl FnMut([u32; 2])) {
    let [from, to] = stroke.ends;
    // Narrower than a pixel it would slip through between their middles.
    let reach = (0.5 * stroke.width).max(std::f64::consts::FRAC_1_SQRT_2);
    if !(from.iter().chain(&to).all(|x| x.is_finite()) && reach.is_finite()) {
        return;
    }
    let range = |axis: usize| {
        let last = f64::from(size[axis]);
        let lo = (from[axis].min(to[axis]) - reach).clamp(0.0, last);
        let hi = (from[axis].max(to[axis]) + reach).clamp(0.0, last);
        lo.floor() as u32..hi.ceil() as u32
    };
    let along = [to[0] - from[0], to[1] - from[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    for y in range(1) {
        for x in range(0) {
            let off = [f64::from(x) + 0.5 - from[0], f64::from(y) + 0.5 - from[1]];
            let share = if square > 0.0 { (off[0] * along[0] + off[1] * along[1]) / square } else { 0.0 };
            let share = share.clamp(0.0, 1.0);
            let apart = (off[0] - share * along[0]).hypot(off[1] - share * along[1]);
            if apart <= reach {
                call([x, y]);
            }
        }
    }
}

/// Optical depths towards the light, where a grid can hold them.
fn depths(stage: &Stage<'_>, light: &LightFrame) -> Option<Arc<LightGrid>> {
    let (layout, bounds) = depths_layout(stage.frame, light)?;
    let job = Job { shadow_step: bounds.diagonal() / INTERVALS as f32, ..*stage.job };
    let scene = Scene::new(stage.frame, &job);
    let (grid, _) = fill_light_grid(layout, &scene, || Batch::new(stage.tapes, stage.frame))?;
    Some(Arc::new(grid))
}

/// Where the points of that grid are, and the box around all media.
fn depths_layout(frame: &Frame, light: &LightFrame) -> Option<(LightGrid, Aabb)> {
    let bounds = frame.media_bounds()?;
    Some((LightGrid::layout(light, &bounds, INTERVALS)?, bounds))
}

/// Most bytes of the grids of depths of a frame's light maps: there is one at a time.
pub(crate) fn most_bytes(frame: &Frame) -> usize {
    let fitted = frame.styles.iter().filter(|style| style.light_map.is_some());
    let layouts = fitted.filter_map(|style| depths_layout(frame, &frame.lights[style.light]));
    let most = layouts.map(|(layout, _)| {
        let layout = LightGrid { colored: true, ..layout };
        filling_bytes(&layout, layout.most_words())
    });
    most.max().unwrap_or(0)
}

/// The frame from a camera, its light with the style's occluders and nothing else of the style.
fn seen_from(stage: &Stage<'_>, style: &Style<f64>, hiders: &Hiders, camera: CameraFrame) -> Frame {
    let mut frame = Frame { camera, ..stage.frame.clone() };
    let styled = stage.lit_by(style, hiders, &camera);
    frame.styled_lights = vec![None; frame.lights.len()];
    frame.styled_lights[style.light] = Some(Arc::new(styled));
    frame
}

/// Weights of texels for the rays through pixels.
fn weights(
    stage: &Stage<'_>,
    frame: &Frame,
    light: usize,
    table: &LightMapTable,
    pixels: &[Painted],
) -> Vec<Vec<(u32, [f32; 3])>> {
    let scene = Scene::new(frame, stage.job);
    let chunks = pixels.par_chunks(RAYS).map(|pixels| {
        let mut integrator = Integrator::new(&scene, Batch::new(stage.tapes, frame), Batches::DEFAULT);
        let middle = |([x, y], _): &Painted| camera_ray(&scene, [*x as f32 + 0.5, *y as f32 + 0.5]);
        let rays: Vec<_> = pixels.iter().map(middle).collect();
        let places = integrator.light_weights(&rays, light);
        places.into_iter().map(|places| by_texel(table, places)).collect::<Vec<_>>()
    });
    chunks.flatten().collect()
}

/// Adds up the weights of neighbouring samples in one texel.
fn by_texel(table: &LightMapTable, places: Vec<([f32; 3], [f32; 3])>) -> Vec<(u32, [f32; 3])> {
    let mut row: Vec<(u32, [f32; 3])> = Vec::new();
    for (point, weight) in places {
        let texel = texel(table, point);
        match row.last_mut() {
            Some((last, sum)) if *last == texel => *sum = [0, 1, 2].map(|i| sum[i] + weight[i]),
            _ => row.push((texel, weight)),
        }
    }
    row
}

fn texel(table: &LightMapTable, point: [f32; 3]) -> u32 {
    let last = table.size as f32 - 1.0;
    let [x, y] = table.axes.map(|axis| {
        let place: f32 = (0..3).map(|i| (point[i] - table.origin[i]) * axis[i]).sum();
        place.round().clamp(0.0, last) as u32
    });
    y * table.size + x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interp::Tapes;
    use crate::render::tests::support::{Gas, World};
    use crate::render::{FilledGrids, LightDepths, memory_bound};
    use vol_compiler::program::Lighting;

    /// Half the sides of a box of gas, and its extinction.
    const HALF: [f64; 3] = [1.0, 0.6, 0.8];
    const EXTINCTION: f64 = 1.5;

    fn box_of_gas(sun: [f32; 3]) -> World {
        let mut world = World::new([0.0, 0.0, 4.0], 0.4);
        world.medium(Gas::uniform(HALF, [0.5; 3], [EXTINCTION; 3], [0.0; 3], Lighting::Shadowed));
        world.sun(sun, [1.0; 3]);
        world
    }

    /// Length of the way from a point of the box towards a light.
    fn way_out(point: [f64; 3], toward: [f32; 3]) -> f64 {
        let side = |axis: usize| {
            let along = f64::from(toward[axis]);
            if along == 0.0 { f64::INFINITY } else { (along.signum() * HALF[axis] - point[axis]) / along }
        };
        (0..3).map(side).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn depths_are_those_of_a_box() {
        for sun in [[0.0, 1.0, 0.0], [0.48, 0.8, 0.36], [-0.6, 0.0, 0.8]] {
            let world = box_of_gas(sun);
            let (job, tapes) = (crate::style::job([64; 2], 0.01, 0.1), Tapes::new(&world.program));
            let (program, frame) = (&world.program, &world.frame);
            let bounds = frame.media_bounds().expect("a medium");
            let stage = Stage { program, frame, job: &job, tapes: &tapes, bounds };
            let grid = depths(&stage, &frame.lights[0]).expect("a bounded medium");
            let grid = LightDepths::<f64>::new(&grid);
            let (mut sum, mut most, mut count): (f64, f64, f64) = (0.0, 0.0, 0.0);
            for index in 0..1000 {
                // Beside walls that are parallel to the light depths jump, and within three points of one a cubic overshoots.
                let share = |axis: u32| f64::from(index / 10_u32.pow(axis) % 10) / 9.0 * 1.8 - 0.9;
                let point = [0, 1, 2].map(|axis: u32| share(axis) * HALF[axis as usize]);
                let off = (grid.depth(point)[0] - EXTINCTION * way_out(point, sun)).abs();
                (sum, most, count) = (sum + off * off, most.max(off), count + 1.0);
            }
            let rms = (sum / count).sqrt();
            assert!(most < 2.0e-2 && rms < 2.5e-3, "{most:.1e}, rms {rms:.1e} for {sun:?}");
        }
    }

    #[test]
    fn depths_count_as_memory() {
        let mut world = box_of_gas([0.0, 1.0, 0.0]);
        let job = crate::style::job([64; 2], 0.01, 0.1);
        let bound =
            |world: &World| memory_bound(&world.program, &world.frame, &job, 1, &FilledGrids::default());
        let before = bound(&world);
        world.frame.styles.push(Style {
            name: "painted".to_owned(),
            light: 0,
            shadow_map: 64,
            shafts: Default::default(),
            operators: Vec::new(),
            transfer: None,
            depth_range: None,
            light_map: Some(LightMap { size: 16, strokes: Vec::new() }),
            heterogeneity: None,
            enabled: 1.0,
            span: Default::default(),
        });
        let (layout, _) = depths_layout(&world.frame, &world.frame.lights[0]).expect("a bounded medium");
        assert_eq!(layout.counts.iter().max(), Some(&(INTERVALS + 1)));
        let kept = 3 * size_of::<f32>() * layout.points();
        assert!(bound(&world) - before >= kept as u64, "{} of {kept} bytes", bound(&world) - before);
    }
}
