//! One test binary over the whole of `vol`.
//!
//! A harness of its own, so that a GPU test on a machine without a device is listed as ignored, with
//! the reason, instead of passing silently. Names are `topic::case`, GPU tests begin with `gpu::`.

mod accuracy;
mod architecture;
mod canary;
mod cli;
mod clouds;
mod differential;
mod docs;
mod examples;
mod explain;
mod exports;
mod fixes;
mod generated;
#[cfg(feature = "gpu")]
mod gpu_device;
mod library;
mod light_grids;
mod lights;
mod mandelbulb;
mod media;
mod nearest;
mod noises;
mod numerics;
mod operators;
mod pages;
mod physics;
mod primitives;
mod properties;
mod reference_modes;
mod sampling;
mod shapes;
mod skips;
mod solid;
mod spec;
mod stress;
#[cfg(feature = "gpu")]
mod strict;
mod styles;
mod support;
mod surfaces;
mod tubes;
mod ui;

use libtest_mimic::{Arguments, Trial};

fn main() -> std::process::ExitCode {
    let arguments = Arguments::from_args();
    let mut trials: Vec<Trial> = Vec::new();
    trials.extend(accuracy::trials());
    trials.extend(architecture::trials());
    trials.extend(canary::trials());
    trials.extend(cli::trials());
    trials.extend(clouds::trials());
    trials.extend(differential::trials());
    trials.extend(docs::trials());
    trials.extend(examples::trials());
    trials.extend(explain::trials());
    trials.extend(exports::trials());
    trials.extend(fixes::trials());
    trials.extend(generated::trials());
    trials.extend(library::trials());
    trials.extend(light_grids::trials());
    trials.extend(styles::trials());
    trials.extend(lights::trials());
    trials.extend(mandelbulb::trials());
    trials.extend(media::trials());
    trials.extend(noises::trials());
    trials.extend(numerics::trials());
    trials.extend(operators::trials());
    trials.extend(pages::trials());
    trials.extend(physics::trials());
    trials.extend(primitives::trials());
    trials.extend(properties::trials());
    trials.extend(reference_modes::trials());
    trials.extend(sampling::trials());
    trials.extend(shapes::trials());
    trials.extend(skips::trials());
    trials.extend(surfaces::trials());
    trials.extend(spec::trials());
    trials.extend(stress::trials());
    trials.extend(tubes::trials());
    trials.extend(ui::trials());
    #[cfg(feature = "gpu")]
    trials.extend(gpu_device::trials().into_iter().chain(strict::trials()));
    libtest_mimic::run(&arguments, trials).exit_code()
}
