//! Chooses for each light whether its shadows in media come from a grid, and how fine that is.
//!
//! Grids grow finer until the pilot's rays look as they do with direct marching, or until filling them would
//! cost more than it saves or not fit the memory; then shadow rays go on marching. Costs are counted in
//! evaluations, not timed: the choice must not depend on how busy the machine is, nor on the backend.
//!
//! One light is judged at a time, the others have coarse grids meanwhile: their errors are the same on both sides.
//!
//! Rays are compared, not single points: their error is what was asked for, and at points that of a grid is
//! ten times as large as in rays, which are means over many nodes (so is that of marching).

use super::fields::Batch;
use super::filled_grids::FilledGrids;
use super::light_grid::{self, Grid};
use super::pilot::{MOST_BUDGET, Picture, Pilot, cost};
use super::scene::{Medium, Scene};
use super::spacing_choice::spaced;
use super::step_choice::{Search, StepChoice};
use crate::interp::Tapes;
use crate::math::fun::{exp2, log2};
use std::sync::Arc;
use vol_compiler::frame::{Aabb, Frame, Job, LightFrame, LightGrid, Sampling};
use vol_compiler::program::Program;

/// Intervals along the longest side of the first grid.
const FIRST_INTERVALS: u32 = 32;

/// Intervals along the longest side of the grids by which steps are chosen.
const COARSE_INTERVALS: u32 = 96;

/// Most words of all grids together, 96 MiB: a buffer that any device can bind holds 128 MiB.
pub(super) const MAX_WORDS: usize = 24 << 20;

/// Filling grids may cost this part of marching directly: looking up costs something, too.
const PAYS: f64 = 0.5;

/// Evaluations per node where none has been counted yet: region and extinction.
const EVALUATIONS_PER_NODE: f64 = 2.0;

/// The step of the marching that a grid is compared with, over that of shadow rays: its own error is small beside that of the
/// grid, else ever finer grids would be filled for nothing.
const TEST_STEP: f32 = 0.125;

/// Part of the allowed error that a grid is meant to have.
const PART: f32 = 0.7;

/// Part of it that the finest grid which can be had may use up. What a grid leaves is for the steps.
const MOST_PART: f32 = 0.8;

/// Part of that error which the next grid is meant to have.
const AIM: f32 = 0.8;

/// The error is taken to fall with this power of the distance between points, or with a lower one that the last two grids
/// show, down to [`LEAST_ORDER`].
const USUAL_ORDER: f32 = 2.0;

/// As slowly it falls beside walls, where detail begins to be resolved.
const LEAST_ORDER: f32 = 1.25;

/// The error falls at best with this power: if even that does not suffice there will be no grid.
const BEST_ORDER: i32 = 3;

/// The next grid has at least this many times as many points along an axis.
const LEAST_STEP: f32 = 1.1;

/// And at most this many times as many, twice as many up to [`TELLING_INTERVALS`].
const MOST_STEP: f32 = 4.0;

/// From here on errors say how fine a grid has to be.
const TELLING_INTERVALS: u32 = 100;

/// A spline has at most this part of the error of a local cubic: beside walls it has not.
const BETTER: f32 = 0.8;

/// Part of its allowed error that a local cubic may have: it serves where walls are, and what they leave is rings.
const LOCAL: f32 = 0.7;

/// Part of the room that is left which rounding of the numbers of points does not exceed.
const ROOM: f32 = 0.98;

/// Samples that the pilot's rays may take at a time: a few times what they took to choose the step.
const LIMIT: u64 = 4 * MOST_BUDGET;

/// Samples of a pixel that adaptive sampling is taken to need.
const ADAPTIVE_SAMPLES: u32 = 9;

/// What was chosen for a light.
#[derive(Clone, Debug, Default)]
pub struct GridChoice {
    /// For [`Frame::light_grids`]; none to march.
    pub grid: Option<Arc<LightGrid>>,
    /// Error of the grid, or of the finest one that was tried: rms over the pilot's rays of the difference
    /// to marching with shorter steps, over the rms of their colour.
    pub error: Option<f32>,
}

impl GridChoice {
    /// Error of the grid, if there is one.
    fn taken(&self) -> Option<f32> {
        self.error.filter(|_| self.grid.is_some())
    }
}

/// A choice for each light of a frame, given the picture to be rendered and the error that is allowed in it.
/// Grids that the frame holds already do not count. The result depends on the arguments alone.
#[must_use]
pub fn choose_light_grids(program: &Program, frame: &Frame, job: &Job, max_error: f32) -> Vec<GridChoice> {
    choose_among(program, frame, job, max_error, &mut FilledGrids::default())
}

/// [`choose_light_grids`] with grids that were filled before.
pub(super) fn choose_among(
    program: &Program,
    frame: &Frame,
    job: &Job,
    max_error: f32,
    filled: &mut FilledGrids,
) -> Vec<GridChoice> {
    let tapes = Tapes::of_frame(program, frame);
    let light_grids = coarse_grids(program, frame, &tapes, filled);
    let lit = Frame { light_grids, ..frame.clone() };
    choose_by(&Pilot::new(&lit, &tapes, job.size), job, max_error, filled).lights
}

/// What was chosen for all lights.
struct Choices {
    lights: Vec<GridChoice>,
    /// Whether rays through media are marched towards any of them.
    marches: bool,
}

/// [`choose_light_grids`] with a pilot of a frame whose lights have their coarse grids.
fn choose_by(pilot: &Pilot<'_>, job: &Job, max_error: f32, filled: &mut FilledGrids) -> Choices {
    let frame = pilot.frame;
    let mut lights = vec![GridChoice::default(); frame.lights.len()];
    let fine_job = Job { shadow_step: TEST_STEP * job.shadow_step, ..*job };
    let fine = Scene::<f32>::new(frame, &fine_job);
    let is_any = frame.light_grids.iter().any(Option::is_some);
    let marched = is_any.then(|| marched(pilot, &fine, &fine_job)).flatten();
    let Some((marched, bounds)) = marched.zip(around(&fine.media)) else {
        return Choices { lights, marches: frame.lights.iter().any(|light| light.shadows) };
    };
    let asked = marched.iter().filter(|marched| marched.as_ref().is_some_and(|one| one.cost > 0.0)).count();
    // The errors of several lights add up like those of independent measurements.
    let share = max_error / (asked.max(1) as f32).sqrt();
    let mut trial = Trial {
        pilot,
        target: PART * share,
        most: MOST_PART * share,
        words: MAX_WORDS / asked.max(1),
        bounds,
        fine,
        scene: plain_scene(frame, job),
        filled,
    };
    let mut marches = false;
    for (index, choice) in lights.iter_mut().enumerate() {
        match &marched[index] {
            Some(marched) => *choice = trial.choose(index, marched),
            None => marches |= frame.lights[index].shadows,
        }
        let dear = marched[index].as_ref().is_some_and(|marched| marched.cost > 0.0);
        marches |= dear && choice.grid.is_none();
    }
    Choices { lights, marches }
}

/// What marching to one light gives.
struct Marched {
    /// The pilot's rays.
    picture: Picture,
    /// Evaluations that it would take in the whole picture.
    cost: f64,
}

/// The pilot's rays with marching to each light that has a grid, the others looked up in theirs; nothing if that takes too
/// much. The shadow step of the scene and the job is [`TEST_STEP`] of the picture's.
fn marched(pilot: &Pilot<'_>, fine: &Scene<f32>, job: &Job) -> Option<Vec<Option<Marched>>> {
    let samples = if job.sampling.tolerance > 0.0 {
        job.sampling.most.min(ADAPTIVE_SAMPLES)
    } else {
        job.sampling.most
    };
    let scale = f64::from(TEST_STEP) * pilot.scale * f64::from(samples);
    let (_, stats) = pilot.expose_scene(fine, pilot.all(), LIMIT)?;
    let without = cost(&stats);
    let march = |index: usize| {
        let mut scene = Scene::new(pilot.frame, job);
        scene.grids[index] = None;
        let (picture, stats) = pilot.expose_scene(&scene, pilot.all(), LIMIT)?;
        Some(Marched { picture, cost: scale * (cost(&stats) - without) as f64 })
    };
    let of_light = |(index, grid): (usize, &Option<Arc<LightGrid>>)| match grid {
        Some(_) => march(index).map(Some),
        None => Some(None),
    };
    pilot.frame.light_grids.iter().enumerate().map(of_light).collect()
}

/// A frame without the grids that it holds.
fn plain_scene(frame: &Frame, job: &Job) -> Scene<f32> {
    let mut scene = Scene::new(frame, job);
    scene.grids.clear();
    scene
}

/// The box around all media.
fn around(media: &[Medium<f32>]) -> Option<Aabb> {
    let boxes = media.iter().map(|medium| Aabb { lo: medium.lo, hi: medium.hi });
    boxes.reduce(|a, b| a.union(&b))
}

/// What the trials of all lights have in common.
struct Trial<'a> {
    pilot: &'a Pilot<'a>,
    scene: Scene<f32>,
    /// The same with coarse grids, and with the step that grids are compared with.
    fine: Scene<f32>,
    /// Around all media.
    bounds: Aabb,
    /// Error that a grid is meant to have.
    target: f32,
    /// Error that the finest one may have.
    most: f32,
    /// Words that a grid may have.
    words: usize,
    /// Grids that need not be filled.
    filled: &'a mut FilledGrids,
}

impl Trial<'_> {
    /// Tries finer and finer grids for a light, given what marching gives.
    fn choose(&mut self, light: usize, marched: &Marched) -> GridChoice {
        let mut choice = GridChoice::default();
        let mut finest = None;
        // Intervals and error of the grid before.
        let mut before: Option<[f32; 2]> = None;
        let (mut spent, mut per_node, mut per_point) = (0.0, EVALUATIONS_PER_NODE, 0.0);
        let mut intervals = FIRST_INTERVALS;
        loop {
            let layout = LightGrid::layout(&self.pilot.frame.lights[light], &self.bounds, intervals);
            let nodes = layout.as_ref().and_then(|layout| light_grid::nodes(layout, self.scene.shadow_step));
            let (Some(layout), Some(nodes)) = (layout, nodes) else { break };
            // Finer columns keep no larger part of their points.
            let words = (layout.points() as f64 * per_point) as usize;
            if spent + nodes as f64 * per_node > PAYS * marched.cost || words > self.words {
                break;
            }
            let fields = || Batch::new(self.pilot.tapes, self.pilot.frame);
            let Some((grid, evaluations)) = self.filled.fill(layout, &self.scene, fields) else { break };
            spent += evaluations as f64;
            per_node = evaluations as f64 / nodes as f64;
            per_point = grid.words() as f64 / grid.points() as f64;
            let (grid, error) = self.smoothed(light, grid, marched);
            choice.error = Some(error);
            let words = grid.words();
            let target = if grid.spline { self.target } else { LOCAL * self.target };
            if error <= target && words <= self.words {
                choice.grid = Some(grid);
                break;
            }
            // As fine as seems needed and as memory allows; what coarse grids say of fine ones is not much.
            let room = (self.words as f32 / words as f32).cbrt();
            let order =
                before.filter(|[count, _]| *count >= TELLING_INTERVALS as f32).map_or(USUAL_ORDER, |last| {
                    let [finer, better] = [intervals as f32 / last[0], last[1] / error];
                    (log2(better) / log2(finer)).clamp(LEAST_ORDER, USUAL_ORDER)
                });
            before = Some([intervals as f32, error]);
            let needed = exp2(log2(error / (AIM * target)) / order);
            let most = if intervals < TELLING_INTERVALS { 2.0 } else { MOST_STEP };
            let finer = needed.clamp(LEAST_STEP, most).min(ROOM * room);
            if finer < LEAST_STEP || error > target * room.powi(BEST_ORDER) {
                finest = Some(grid);
                break;
            }
            finest = Some(grid);
            intervals = (finer * intervals as f32) as u32;
        }
        if choice.grid.is_none() && choice.error.is_some_and(|error| error <= self.most) {
            choice.grid = finest.filter(|grid| grid.words() <= self.words);
        }
        choice
    }

    /// A grid, or the spline through it where that is needed and clearly better, and its error.
    fn smoothed(&mut self, light: usize, grid: Arc<LightGrid>, marched: &Marched) -> (Arc<LightGrid>, f32) {
        let error = self.error(light, &grid, marched);
        if error <= LOCAL * self.target || grid.counts.iter().all(|&count| count <= TELLING_INTERVALS) {
            return (grid, error);
        }
        let Some(spline) = light_grid::splined(&grid, self.words).map(Arc::new) else { return (grid, error) };
        let smooth = self.error(light, &spline, marched);
        if smooth < BETTER * error { (spline, smooth) } else { (grid, error) }
    }

    /// What a grid of a light changes in the pilot's rays.
    fn error(&mut self, light: usize, grid: &Arc<LightGrid>, marched: &Marched) -> f32 {
        let coarse = self.fine.grids[light].replace(Grid::new(grid));
        let got = self.pilot.expose_scene(&self.fine, self.pilot.all(), LIMIT);
        self.fine.grids[light] = coarse;
        got.map_or(f32::INFINITY, |(got, _)| self.pilot.difference(&got, &marched.picture))
    }
}

/// All that is chosen for a picture.
#[derive(Clone, Debug)]
pub struct Choice {
    /// How to sample it.
    pub job: Job,
    /// For each light; the frame has the grids already.
    pub grids: Vec<GridChoice>,
    /// Estimated root mean square error of the picture's colours over that of the colours, of steps, grids and
    /// spacings together; above what was asked for if that could not be met.
    pub estimate: f32,
}

/// Chooses steps ([`choose_step`](super::choose_step)), grids ([`choose_light_grids`]) and the spacings of media for a picture
/// with an error of at most `max_error`, and puts grids and spacings into the frame. The result depends on the arguments alone.
pub fn choose(
    program: &Program,
    frame: &mut Frame,
    size: [u32; 2],
    sampling: Sampling,
    max_error: f32,
) -> Choice {
    choose_with(program, frame, size, sampling, max_error, &mut FilledGrids::default())
}

/// [`choose`] for one of several frames of a program: grids that were `filled` for the others are not filled again.
/// The result does not depend on them.
pub fn choose_with(
    program: &Program,
    frame: &mut Frame,
    size: [u32; 2],
    sampling: Sampling,
    max_error: f32,
    filled: &mut FilledGrids,
) -> Choice {
    if frame.media.is_empty() {
        let grids = vec![GridChoice::default(); frame.lights.len()];
        frame.light_grids = vec![None; grids.len()];
        return Choice { job: StepChoice::ANY.job(size, sampling), grids, estimate: 0.0 };
    }
    frame.media.iter_mut().for_each(|medium| medium.spacing = 1);
    let tapes = Tapes::of_frame(program, frame);
    let mut lit = Frame { light_grids: coarse_grids(program, frame, &tapes, filled), ..frame.clone() };
    let (mut grids, mut taken, mut steps) = (vec![GridChoice::default(); frame.lights.len()], 0.0, None);
    if lit.light_grids.iter().any(Option::is_some) {
        let pilot = Pilot::new(&lit, &tapes, size);
        // What grids may add is left to them; what they do not use is for the steps.
        let beside = (1.0 - PART * PART).sqrt() * max_error;
        let search = Search::new(&pilot, beside);
        let job = search.choice(beside).job(size, sampling);
        let choices = choose_by(&pilot, &job, max_error, filled);
        grids = choices.lights;
        taken = grids.iter().filter_map(GridChoice::taken).fold(0.0, f32::hypot);
        steps = (!choices.marches).then(|| search.choices(rest(max_error, taken)));
    }
    lit.light_grids = grids.iter().map(|choice| choice.grid.clone()).collect();
    let steps = steps.unwrap_or_else(|| {
        // Where lights are marched to, their steps count.
        let left = rest(max_error, taken);
        Search::new(&Pilot::new(&lit, &tapes, size), left).choices(left)
    });
    let spaced = spaced(&Pilot::new(&lit, &tapes, size), steps, max_error);
    frame.media.iter_mut().zip(spaced.spacings).for_each(|(medium, spacing)| medium.spacing = spacing);
    frame.light_grids = lit.light_grids;
    let estimate = spaced.steps.estimate.hypot(taken).hypot(spaced.error);
    Choice { job: spaced.steps.job(size, sampling), grids, estimate }
}

/// The error that is left beside another one, if both are independent.
fn rest(max_error: f32, taken: f32) -> f32 {
    (max_error * max_error - taken * taken).sqrt()
}

/// Grids of all lights with shadows that can have one, good enough to find out how camera rays are to be sampled: their errors
/// are the same for all steps.
fn coarse_grids(
    program: &Program,
    frame: &Frame,
    tapes: &Tapes,
    filled: &mut FilledGrids,
) -> Vec<Option<Arc<LightGrid>>> {
    filled.begin(program, frame);
    let plain = StepChoice::ANY.job([1, 1], Sampling::CENTRE);
    let Some(bounds) = around(&Scene::<f32>::new(frame, &plain).media) else {
        return vec![None; frame.lights.len()];
    };
    let shadow_step = bounds.diagonal() / COARSE_INTERVALS as f32;
    let scene = plain_scene(frame, &Job { shadow_step, ..plain });
    let grid = |light: &LightFrame| {
        let layout = LightGrid::layout(light, &bounds, COARSE_INTERVALS).filter(|_| light.shadows)?;
        Some(filled.fill(layout, &scene, || Batch::new(tapes, frame))?.0)
    };
    frame.lights.iter().map(grid).collect()
}
