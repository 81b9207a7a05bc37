//! `vol render`: a scene as a picture, or one picture per frame.

use std::path::Path;
use std::time::Instant;

use vol::backend::{Choice, Device, Rendered, Renderer};
use vol::failure::{Failure, Message};
use vol::output::{self, Format, atomic};
use vol::session::Moment;
use vol::styles;
use vol_compiler::dropped;
use vol_compiler::frame::{Counts, Frame, Image, Inputs, Sampling};
use vol_compiler::skip::Skip;
use vol_compiler::wgsl::render::WORKGROUP;
use vol_runtime_cpu::{FilledGrids, Method};

use super::memory::{self, Memory};
use super::method;
use super::progress::Progress;
use super::stats::{LightMap, Phases, Stats, timed};
use super::values::{FrameRange, Size};
use super::{CANCELLED, Prepared};
use crate::cli;

pub(super) fn run(arguments: &cli::Render) -> Result<(), Failure> {
    let started = Instant::now();
    method::check(arguments)?;
    check_outputs(arguments)?;
    super::catch_interrupts()?;
    if let Some(threads) = arguments.threads {
        limit_threads(threads.into())?;
    }
    let prepared = Prepared::new(&arguments.scene)?;
    prepared.show_suspicions()?;
    let choice = match arguments.backend {
        cli::Backend::Cpu => Choice::Cpu,
        cli::Backend::Gpu => Choice::Gpu,
        // The references have no twin for the GPU.
        cli::Backend::Auto if arguments.integrator != cli::Integrator::Comb => Choice::Cpu,
        // Nor have costs.
        cli::Backend::Auto if arguments.aov.is_some() => Choice::Cpu,
        cli::Backend::Auto => Choice::Auto,
    };
    let device = super::open(choice, super::arithmetic(arguments.strict))?;
    let mut stats = new_stats(arguments, &prepared, &device);
    let reference =
        arguments.reference.as_deref().map(|path| read_reference(path, stats.size)).transpose()?;
    match render(arguments, &prepared, &device, reference.as_ref(), &mut stats) {
        // A device that was nobody's wish may fail without harm.
        Err(Failure::Device(message)) if choice == Choice::Auto => {
            super::print_line(&format!("note: {}; rendering on the CPU instead", message.text));
            stats = new_stats(arguments, &prepared, &Device::Cpu);
            render(arguments, &prepared, &Device::Cpu, reference.as_ref(), &mut stats)
        }
        done => done,
    }?;
    stats.memory.peak = memory::peak_resident();
    if let Some(path) = &arguments.stats {
        write_stats(&stats, path)?;
    }
    print_summary(arguments, &stats, started);
    Ok(())
}

/// Finds what would fail after the work is done before it starts.
fn check_outputs(arguments: &cli::Render) -> Result<(), Failure> {
    Format::of(&arguments.output)?;
    let mut output = arguments.output.clone();
    if let Some(FrameRange { first, last }) = arguments.frames {
        if first != last && !output::has_frame_number(&output) {
            let text = format!("all frames would be written to `{}`", output.display());
            let help = "put #### into the name where the frame's number belongs, as in frame.####.png";
            return Err(Failure::usage(text).with_help(help));
        }
        output = output::frame_path(&output, first);
    }
    atomic::probe(&output)?;
    for path in [&arguments.light_map, &arguments.shadow_map].into_iter().flatten() {
        Format::of(path)?;
        atomic::probe(path)?;
    }
    arguments.stats.as_deref().map_or(Ok(()), atomic::probe)
}

/// The picture to compare with.
fn read_reference(path: &Path, size: [u32; 2]) -> Result<output::exr::Colors, Failure> {
    let reference = output::exr::read(path)?;
    let ([width, height], [wide, high]) = (size, reference.size);
    if size == reference.size {
        return Ok(reference);
    }
    let text = format!("`{}` is {wide}x{high}, the picture {width}x{height}", path.display());
    Err(Failure::usage(text).with_help("a picture can be compared with one of its own size only; see --size"))
}

/// Limits all parallel work of this process.
pub(super) fn limit_threads(threads: usize) -> Result<(), Failure> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    pool.map_err(|error| Failure::usage(format!("cannot start {threads} threads: {error}")))
}

fn new_stats(arguments: &cli::Render, prepared: &Prepared, device: &Device) -> Stats {
    let session = &prepared.session;
    Stats {
        version: env!("CARGO_PKG_VERSION"),
        scene: session.sources.root().name.clone(),
        backend: device.name(),
        device: device.description(),
        size: arguments.size.map_or(session.program.render.size, |Size(size)| size),
        frames: 0,
        same_frames: 0,
        same_grids: 0,
        seed: arguments.seed,
        integrator: method::name(arguments.integrator),
        jitter: method::jitter(arguments),
        tube_bounds: method::tube_bounds(arguments),
        max_error: method::max_error(arguments),
        step_scale: arguments.step_scale,
        quadrature: None,
        step: None,
        shadow_step: None,
        estimate: None,
        error: None,
        light_grids: Vec::new(),
        spacings: Vec::new(),
        light_maps: Vec::new(),
        samples_per_pixel: 0,
        adaptive: None,
        mean_samples_per_pixel: 0.0,
        most_operations_per_pixel: None,
        counts: Counts::default(),
        milliseconds: Phases {
            check: session.check_time,
            compile: session.compile_time,
            ..Phases::default()
        },
        memory: Memory { before: memory::peak_resident(), ..Memory::default() },
        dropped: dropped::dropped(&session.program),
    }
}

/// Renders and writes the pictures that the arguments ask for.
fn render(
    arguments: &cli::Render,
    prepared: &Prepared,
    device: &Device,
    reference: Option<&output::exr::Colors>,
    stats: &mut Stats,
) -> Result<(), Failure> {
    let Prepared { session, params, moment } = prepared;
    let frames = arguments.frames.map_or(1, |f| u64::from(f.last - f.first) + 1);
    let pixels = stats.size.map(u64::from).iter().product();
    let workgroup = arguments.workgroup.map_or(WORKGROUP, |Size(shape)| shape);
    let renderer =
        timed(&mut stats.milliseconds.prepare, || device.prepare_with(&session.program, workgroup))?;
    let progress = Progress::new(pixels * frames);
    let filled = FilledGrids::default();
    let mut pictures =
        Pictures { arguments, prepared, renderer, pixels, progress, reference, filled, last: None, stats };
    let Some(FrameRange { first, last }) = arguments.frames else {
        return pictures.render(*moment, &arguments.output);
    };
    for frame in first..=last {
        let moment = session.moment_of_frame(params, frame)?;
        pictures.render(moment, &output::frame_path(&arguments.output, frame))?;
    }
    Ok(())
}

/// What the pictures of one run have in common.
struct Pictures<'a> {
    arguments: &'a cli::Render,
    prepared: &'a Prepared,
    renderer: Renderer<'a>,
    /// Of one picture.
    pixels: u64,
    progress: Progress,
    /// What the picture is compared with.
    reference: Option<&'a output::exr::Colors>,
    /// Grids of lights of the frames so far.
    filled: FilledGrids,
    /// The last picture, where another one may equal it.
    last: Option<Last>,
    stats: &'a mut Stats,
}

/// A picture and what it was made from.
struct Last {
    inputs: Inputs,
    sampling: Sampling,
    rendered: Rendered,
}

impl Pictures<'_> {
    /// Writes one picture: renders it, unless it is the last one again.
    fn render(&mut self, moment: Moment, path: &Path) -> Result<(), Failure> {
        super::stop_if_cancelled()?;
        let Prepared { session, params, .. } = self.prepared;
        let size = self.stats.size;
        let frame = session.frame(params, moment, size)?;
        let sampling = method::sampling(self.arguments, session, params, moment)?;
        let may_repeat = self.arguments.frames.is_some() && frame.skips.has(Skip::SameFrames);
        let inputs = may_repeat.then(|| Inputs::of_picture(&session.program, &frame));
        let is_same = |last: &&Last| Some(&last.inputs) == inputs.as_ref() && last.sampling == sampling;
        if let Some(last) = self.last.as_ref().filter(is_same) {
            timed(&mut self.stats.milliseconds.write, || write(&last.rendered, path))?;
            self.stats.add_same();
            self.progress.at(self.pixels * self.stats.frames);
            return Ok(());
        }
        let mut frame = frame;
        self.style(&mut frame)?;
        let rendered = self.compute(frame, sampling)?;
        timed(&mut self.stats.milliseconds.write, || write(&rendered, path))?;
        self.stats.error = self.reference.map(|reference| reference.error_of(&rendered.image));
        self.last = inputs.map(|inputs| Last { inputs, sampling, rendered });
        Ok(())
    }

    /// Prepares the styles of a frame and writes the maps that are asked for.
    fn style(&mut self, frame: &mut Frame) -> Result<(), Failure> {
        if frame.styles.is_empty() {
            return Ok(());
        }
        let (session, size) = (&self.prepared.session, self.stats.size);
        if self.arguments.integrator != cli::Integrator::Comb {
            let text =
                format!("the integrator `{}` knows no styles", method::name(self.arguments.integrator));
            return Err(Failure::usage(text).with_help("take `--integrator comb`, or switch the styles off"));
        }
        let maps = timed(&mut self.stats.milliseconds.styles, || session.prepare_styles(frame, size))?;
        if let Some(path) = &self.arguments.light_map {
            let images = maps.iter().map(|map| (map.style.clone(), styles::as_image(map)));
            write_maps(images.collect(), path)?;
        }
        if let Some(path) = &self.arguments.shadow_map {
            write_maps(vol_runtime_cpu::style::shadow_maps(&session.program, frame, size), path)?;
        }
        self.stats.light_maps = maps.iter().map(LightMap::new).collect();
        Ok(())
    }

    /// Computes one picture.
    fn compute(&mut self, mut frame: Frame, sampling: Sampling) -> Result<Rendered, Failure> {
        let Stats { size, frames, milliseconds: phases, memory, .. } = &mut *self.stats;
        // Choose the distance between samples from a few rays, unless it is given, and what to look up
        // instead of marching.
        let program = &self.prepared.session.program;
        let plan = timed(&mut phases.pilot, || {
            method::plan(self.arguments, program, &mut frame, *size, sampling, &mut self.filled)
        });
        super::stop_if_cancelled()?;
        if !self.renderer.is_on_device() {
            let threads = rayon::current_num_threads();
            let bound = vol_runtime_cpu::memory_bound(program, &frame, &plan.job, threads, &self.filled);
            memory.bound = memory.bound.max(Some(bound));
        }
        if plan.method == Method::Comb && self.arguments.aov.is_none() {
            timed(&mut phases.prepare, || self.renderer.compile(&frame, &plan.job))?;
        }
        // Compute the picture.
        let before = self.pixels * *frames;
        let progress = |done| self.progress.at(before + done);
        let mut rendered = timed(&mut phases.render, || match self.arguments.aov {
            None => self.renderer.render_by(plan.method, &frame, &plan.job, &progress, &CANCELLED),
            Some(cli::Aov::Cost) => {
                self.renderer.render_costs(plan.method, &frame, &plan.job, &progress, &CANCELLED)
            }
        })?;
        super::stop_if_cancelled()?;
        if let Some(estimate) = plan.estimate {
            rendered.image.scale_errors(estimate);
        }
        let most = rendered.costs.iter().flatten().map(|cost| cost.operations).max();
        self.stats.most_operations_per_pixel = self.stats.most_operations_per_pixel.max(most);
        self.stats.add(&plan, plan.estimate.or(rendered.standard_error), rendered.counts);
        self.stats.spacings = frame.media.iter().map(|medium| medium.spacing).collect();
        self.stats.same_grids = self.filled.reused();
        Ok(rendered)
    }
}

fn write(rendered: &Rendered, path: &Path) -> Result<(), Failure> {
    output::write_picture(&rendered.image, rendered.costs.as_deref(), path)
}

/// Writes the maps of styles as pictures; of several each with the name of its style.
fn write_maps(maps: Vec<(String, Image)>, path: &Path) -> Result<(), Failure> {
    let single = maps.len() == 1;
    for (style, image) in maps {
        let named = if single { path.to_owned() } else { output::with_suffix(path, &style) };
        output::write_picture(&image, None, &named)?;
    }
    Ok(())
}

fn write_stats(stats: &Stats, path: &Path) -> Result<(), Failure> {
    atomic::write(path, |out| {
        serde_json::to_writer_pretty(&mut *out, stats)?;
        out.write_all(b"\n")
    })
}

fn print_summary(arguments: &cli::Render, stats: &Stats, started: Instant) {
    if let (Some(estimate), Some(max_error)) = (stats.estimate, stats.max_error)
        && estimate > max_error
    {
        let text = format!("the estimated error {estimate:.1e} is above the {max_error:.1e} asked for");
        let help = "smaller steps would take too many samples, or did not help; look at the picture, or allow more with --max-error";
        super::print_message("warning", &Message { text, help: Some(help.to_owned()) });
    }
    let [width, height] = stats.size;
    let frames = match stats.frames {
        1 => String::new(),
        frames => format!("{frames} frames of "),
    };
    let same = match stats.same_frames {
        0 => String::new(),
        same => format!(" ({same} the same as the one before)"),
    };
    let scaled = if stats.step_scale.is_some() { " before the step was scaled" } else { "" };
    let estimate = match (stats.estimate, arguments.integrator) {
        (Some(error), cli::Integrator::MonteCarlo) => format!("standard error {error:.1e}"),
        (Some(error), _) => format!("estimated error {error:.1e}{scaled}"),
        (None, _) => "error not estimated".to_owned(),
    };
    let error =
        stats.error.map_or_else(String::new, |error| format!(", error against the reference {error:.1e}"));
    let cost = stats
        .most_operations_per_pixel
        .map_or_else(String::new, |most| format!(", at most {most} operations in a pixel"));
    super::print_line(&format!(
        "{}: {frames}{width}x{height}{same} in {:.2} s on {}, {estimate}{error}{cost}",
        arguments.output.display(),
        started.elapsed().as_secs_f64(),
        stats.device,
    ));
}
