//! `vol bench`: run time against error over a ladder of settings.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use vol::backend::{Choice, Device, Rendered};
use vol::bench::reference::{self, Reference};
use vol::bench::{self, Run, plot};
use vol::failure::Failure;
use vol::output::{atomic, png};
use vol_compiler::frame::{Frame, Job, Quadrature, Sampling};
use vol_compiler::program::{Extent, Program};
use vol_compiler::wgsl::Arithmetic;
use vol_runtime_cpu::{Method, TubeBounds};

use super::table::print_table;
use super::values::Size;
use super::{CANCELLED, Prepared};
use crate::cli::{self, BenchBackend};

/// Longest side of the pictures where no size is asked for, in pixels.
const LONGEST_SIDE: u32 = 256;

/// A setting is repeated for at least this long, and the shortest time counts.
const PATIENCE: Duration = Duration::from_millis(400);

/// The reference changes by at most this part of the smallest error asked for.
const MARGIN: f32 = 0.25;

/// Most levels of the reference beyond the first.
const LEVELS: u32 = 4;

/// Rays per pixel of the ladder of a scene without media, and of the first level of its reference.
const SAMPLES: [u32; 5] = [1, 4, 16, 64, 256];
const FIRST_SAMPLES: u32 = 256;

/// Steps of the baselines, times the default.
const BASELINE_STEPS: [f32; 6] = [4.0, 2.0, 1.0, 0.5, 0.25, 0.125];

pub(super) fn run(arguments: &cli::Bench) -> Result<(), Failure> {
    super::catch_interrupts()?;
    let prepared = Prepared::new(&arguments.scene)?;
    let program = &prepared.session.program;
    let size = arguments.size.map_or_else(|| super::at_most(program.render.size, LONGEST_SIDE), |Size(s)| s);
    let frame = prepared.styled_frame(size)?;
    fs::create_dir_all(&arguments.output)
        .map_err(|error| Failure::io("cannot make", &arguments.output, error))?;
    let devices = devices(arguments.backend)?;
    let bench = Bench { arguments, program, frame: &frame, size };
    let reference = bench.reference()?;
    let mut runs = Vec::new();
    for device in &devices {
        bench.ladder(device, &reference, &mut runs)?;
    }
    print_table(&bench::rows(&runs))?;
    let scene = &arguments.scene.scene;
    let stem = scene.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy());
    let title = format!("{stem} at {}x{}", size[0], size[1]);
    let names: Vec<String> = devices.iter().map(Device::description).collect();
    let machine = format!("{}: {}", bench::machine(), names.join("; "));
    write(&arguments.output, &stem, [&title, &machine], &runs, &reference)
}

/// The backends to measure; `both` goes without a GPU where there is none.
fn devices(backend: BenchBackend) -> Result<Vec<Device>, Failure> {
    Ok(match backend {
        BenchBackend::Cpu => vec![Device::open(Choice::Cpu, Arithmetic::Free)?],
        BenchBackend::Gpu => vec![Device::open(Choice::Gpu, Arithmetic::Free)?],
        BenchBackend::Both => {
            let mut devices = vec![Device::open(Choice::Cpu, Arithmetic::Free)?];
            match Device::open(Choice::Gpu, Arithmetic::Free) {
                Ok(gpu) => devices.push(gpu),
                Err(Failure::Device(message)) => super::print_message("note: without the GPU", &message),
                Err(failure) => return Err(failure),
            }
            devices
        }
    })
}

/// A scene to be measured.
struct Bench<'a> {
    arguments: &'a cli::Bench,
    program: &'a Program,
    frame: &'a Frame,
    size: [u32; 2],
}

/// How a picture is asked for.
enum Setting {
    /// `--max-error`
    MaxError(f32),
    /// `--samples`
    Samples(u32),
    /// A baseline with its step.
    Baseline(Method, f32),
}

impl Bench<'_> {
    /// The reference from the cache, or a new one.
    fn reference(&self) -> Result<Reference, Failure> {
        let wanted = MARGIN * self.finest();
        let places = reference::spread(self.size, self.arguments.places as usize);
        let folder = self.arguments.cache.clone().unwrap_or_else(reference::default_folder);
        let key = reference::key(self.program, self.frame, self.size, places.len(), f64::from(wanted));
        if let Some(kept) = Reference::load(&folder, &key) {
            return Ok(kept);
        }
        super::print_line(&format!("computing the reference at {} pixels in f64", places.len()));
        let steps = vol_runtime_cpu::choose_step(self.program, self.frame, self.size, self.finest());
        let first = steps.job(self.size, Sampling::CENTRE);
        let expose = |places: &[[u32; 2]], level: u32| {
            let job = if self.has_media() {
                let finer = 0.5f32.powi(level as i32);
                Job { step: finer * first.step, shadow_step: finer * first.shadow_step, ..first }
            } else {
                Job { sampling: Sampling::uniform(FIRST_SAMPLES << level), ..first }
            };
            let (program, frame) = (self.program, self.frame);
            vol_runtime_cpu::reference_pixels(program, frame, &job, places, &CANCELLED)
                .ok_or(Failure::Interrupted)
        };
        let made = Reference::converge(places, LEVELS, f64::from(wanted), expose)?;
        made.store(&folder, &key)?;
        Ok(made)
    }

    fn has_media(&self) -> bool {
        !self.frame.media.is_empty()
    }

    /// Whether a medium fills a tube, which can then be marched to.
    fn fills_tubes(&self) -> bool {
        let mut extents = self.frame.media.iter().map(|medium| &self.program.media[medium.index].extent);
        extents.any(|extent| matches!(extent, Extent::Tube { .. }))
    }

    fn ladder(&self, device: &Device, reference: &Reference, runs: &mut Vec<Run>) -> Result<(), Failure> {
        let on_cpu = matches!(device, Device::Cpu);
        let mut settings: Vec<Setting> = Vec::new();
        if self.has_media() {
            settings.extend(self.arguments.max_error.iter().copied().map(Setting::MaxError));
        } else {
            settings.extend(SAMPLES.map(Setting::Samples));
        }
        if self.has_media() && on_cpu {
            let bounds = [TubeBounds::Cells, TubeBounds::SphereMarch];
            let bounds = if self.fills_tubes() { &bounds[..] } else { &bounds[..1] };
            let default = vol_runtime_cpu::fixed_step_default(self.frame);
            for &tube_bounds in bounds {
                let method = Method::FixedStep { jitter: None, tube_bounds };
                settings.extend(BASELINE_STEPS.map(|times| Setting::Baseline(method, times * default)));
            }
        }
        for setting in settings {
            super::stop_if_cancelled()?;
            runs.push(self.measure(device, &setting, reference)?);
        }
        Ok(())
    }

    /// Renders a setting again and again and keeps the shortest time, with all that depends on the
    /// setting in it, but not what a driver does once.
    fn measure(&self, device: &Device, setting: &Setting, reference: &Reference) -> Result<Run, Failure> {
        let renderer = device.prepare(self.program)?;
        let prepare = || {
            let mut frame = self.frame.clone();
            let mut choose = |error, sampling| {
                vol_runtime_cpu::choose(self.program, &mut frame, self.size, sampling, error).job
            };
            let (method, job) = match *setting {
                Setting::MaxError(error) => (Method::Comb, choose(error, Sampling::CENTRE)),
                Setting::Samples(samples) => {
                    (Method::Comb, choose(self.finest(), Sampling::uniform(samples)))
                }
                Setting::Baseline(method, step) => {
                    let (size, quadrature, sampling) = (self.size, Quadrature::Midpoint, Sampling::CENTRE);
                    (method, Job { size, step, shadow_step: step, quadrature, sampling })
                }
            };
            (method, frame, job)
        };
        let render = || -> Result<Rendered, Failure> {
            let (method, frame, job) = prepare();
            renderer.render_by(method, &frame, &job, &|_| {}, &CANCELLED)
        };
        if !matches!(device, Device::Cpu) {
            // Drivers compile shaders when they are first used.
            let (method, frame, job) = prepare();
            renderer.render_by(method, &frame, &Job { size: [1, 1], ..job }, &|_| {}, &CANCELLED)?;
        }
        let started = Instant::now();
        let mut rendered = render()?;
        let mut shortest = started.elapsed();
        while started.elapsed() < PATIENCE {
            let again = Instant::now();
            rendered = render()?;
            shortest = shortest.min(again.elapsed());
        }
        Ok(Run {
            series: setting.series(device),
            setting: setting.typed(),
            promised: setting.promised(),
            seconds: shortest.as_secs_f64(),
            error: reference.error(&rendered.image),
            samples: rendered.counts.samples,
            evaluations: rendered.counts.evaluations,
        })
    }

    /// The smallest error asked for.
    fn finest(&self) -> f32 {
        self.arguments.max_error.iter().copied().fold(1.0, f32::min)
    }
}

impl Setting {
    /// The line of the plot.
    fn series(&self, device: &Device) -> String {
        match self {
            Self::MaxError(_) | Self::Samples(_) => device.name().to_owned(),
            Self::Baseline(Method::FixedStep { tube_bounds: TubeBounds::SphereMarch, .. }, _) => {
                format!("{} sphere-march", device.name())
            }
            Self::Baseline(..) => format!("{} fixed-step", device.name()),
        }
    }

    /// As on the command line of `vol render`.
    fn typed(&self) -> String {
        match *self {
            Self::MaxError(error) => format!("--max-error {error:e}"),
            Self::Samples(samples) => format!("--samples {samples}"),
            Self::Baseline(_, step) => format!("--step {step:.4}"),
        }
    }

    fn promised(&self) -> Option<f64> {
        match *self {
            Self::MaxError(error) => Some(f64::from(error)),
            Self::Samples(_) | Self::Baseline(..) => None,
        }
    }
}

fn write(
    folder: &Path,
    stem: &str,
    [title, machine]: [&str; 2],
    runs: &[Run],
    reference: &Reference,
) -> Result<(), Failure> {
    let text = |extension: &str, text: &str| {
        atomic::write(&folder.join(format!("{stem}.{extension}")), |out| out.write_all(text.as_bytes()))
    };
    text("csv", &bench::csv(runs))?;
    let compared = format!(
        "Against a reference in f64 at {} pixels, which its last halving of the step changed by {:.0e}.",
        reference.places.len(),
        reference.change
    );
    let table = bench::markdown(&bench::rows(runs));
    text("md", &format!("# {title}\n\n{machine}. {compared}\n\n![{title}]({stem}.svg)\n\n{table}"))?;
    let failed = |error: String| Failure::usage(format!("cannot draw the plot: {error}"));
    let svg = plot::svg(title, machine, runs).map_err(failed)?;
    text("svg", &svg)?;
    let (pixels, size) = plot::rasterise(&svg).map_err(failed)?;
    atomic::write(&folder.join(format!("{stem}.png")), |mut out| png::write_codes(&pixels, size, &mut out))
}
