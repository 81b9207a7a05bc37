//! What `vol render` writes.

use super::{Sandbox, equal, trial};
use libtest_mimic::{Failed, Trial};

pub(super) fn trials() -> Vec<Trial> {
    vec![
        trial("render::png", png),
        trial("render::exr", exr),
        trial("render::same_bytes_on_any_number_of_threads", same_bytes),
        trial("render::frames_include_both_ends", frames),
        trial("render::frame_is_the_moment", frame_is_the_moment),
        trial("render::params_and_time_change_the_picture", params_and_time),
        trial("render::stats", stats),
        trial("render::step_scale_and_reference", step_scale_and_reference),
        trial("render::samples", samples),
        trial("render::integrators", integrators),
        trial("render::summary_names_the_device", summary),
        trial("render::auto_without_a_device_is_cpu", auto_without_device),
        trial("render::replaces_the_old_picture", replaces),
        #[cfg(target_os = "linux")]
        trial("render::interrupted", interrupted),
    ]
}

fn png(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.vol("render ball.vol -o a.png --backend cpu")?.expect(0, &[])?;
    equal(sandbox.new_files()?, vec!["a.png".to_owned()])?;
    let picture = image::open(sandbox.path("a.png"))?;
    equal(picture.color(), image::ColorType::Rgb8)?;
    equal([picture.width(), picture.height()], [32, 18])?;
    // The ball is in the middle, nothing is in the corner.
    let picture = picture.to_rgb8();
    equal(picture.get_pixel(0, 0).0, [0; 3])?;
    if picture.get_pixel(16, 9).0 == [0; 3] {
        return Err("the ball is black".into());
    }
    sandbox.vol("render ball.vol -o B.PNG --backend cpu --size 7x5")?.expect(0, &[])?;
    let picture = image::load_from_memory(&sandbox.read("B.PNG")?)?;
    equal([picture.width(), picture.height()], [7, 5])
}

fn exr(sandbox: &Sandbox) -> Result<(), Failed> {
    use exr::prelude::{FlatSamples, ReadChannels as _, ReadLayers as _, read};
    sandbox.vol("render fog.vol -o a.exr --backend cpu")?.expect(0, &[])?;
    let image = read().no_deep_data().largest_resolution_level().all_channels();
    let image = image.first_valid_layer().all_attributes().from_file(sandbox.path("a.exr"))?;
    equal((image.layer_data.size.width(), image.layer_data.size.height()), (32, 18))?;
    let channels = &image.layer_data.channel_data.list;
    let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
    equal(
        names.join(" "),
        "A B Error.Estimate G R Transmittance.B Transmittance.G Transmittance.R Z".to_owned(),
    )?;
    let samples = |index: usize| match &channels[index].sample_data {
        FlatSamples::F32(samples) => Ok(samples.clone()),
        _ => Err(Failed::from("not 32-bit float")),
    };
    let (alpha, red, transmittance, depth) = (samples(0)?, samples(4)?, samples(7)?, samples(8)?);
    let centre = 9 * 32 + 16;
    // In the corner the bare background, in the middle fog before it, no surface anywhere.
    equal((alpha[0], transmittance[0], depth[0]), (0.0, 1.0, f32::INFINITY))?;
    let srgb = f64::from(0x20_u8) / 255.0;
    let background = ((srgb + 0.055) / 1.055).powf(2.4) as f32;
    if (red[0] - background).abs() > 1e-6 {
        return Err(format!("background {} instead of {background}", red[0]).into());
    }
    if !(alpha[centre] > 0.5 && transmittance[centre] < 0.5 && depth[centre].is_infinite()) {
        return Err(
            format!("centre: alpha {}, transmittance {}", alpha[centre], transmittance[centre]).into()
        );
    }
    Ok(())
}

fn same_bytes(sandbox: &Sandbox) -> Result<(), Failed> {
    for (name, options) in [("a", "--threads 1"), ("b", "--threads 3 --seed 7"), ("c", "")] {
        for format in ["png", "exr"] {
            let run = format!("render fog.vol -o {name}.{format} --backend cpu {options}");
            sandbox.vol(&run)?.expect(0, &[])?;
        }
    }
    for format in ["png", "exr"] {
        let [a, b, c] = ["a", "b", "c"].map(|name| sandbox.read(&format!("{name}.{format}")));
        let (a, b, c) = (a?, b?, c?);
        if a != b || a != c {
            return Err(format!("the {format} files differ").into());
        }
    }
    Ok(())
}

fn frames(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox
        .vol("render ball.vol -o f.####.png --backend cpu --frames 9..11")?
        .expect(0, &["3 frames of 32x18"])?;
    equal(sandbox.new_files()?.join(" "), "f.0009.png f.0010.png f.0011.png".to_owned())?;
    sandbox.vol("render ball.vol -o one.png --backend cpu --frames 4..4")?.expect(0, &[])?;
    sandbox.read("one.png").map(drop)
}

fn frame_is_the_moment(sandbox: &Sandbox) -> Result<(), Failed> {
    // At ten frames per second frame 4 is at 0.4 s.
    let scene = "object ball { shape: sphere(1).translate((time, 0.1 * frame, 0)) }\n\
                 camera { from: (0, 0, 5), at: (0, 0, 0) }\nrender { size: (32, 18), fps: 10 }\n";
    sandbox.write("moving.vol", scene)?;
    sandbox.vol("render moving.vol -o f#.exr --backend cpu --frames 0..4")?.expect(0, &[])?;
    sandbox.vol("render moving.vol -o t.exr --backend cpu --time 400ms")?.expect(0, &[])?;
    equal(sandbox.read("f4.exr")? == sandbox.read("t.exr")?, true)?;
    equal(sandbox.read("f0.exr")? == sandbox.read("t.exr")?, false)
}

fn params_and_time(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.vol("render ball.vol -o a.exr --backend cpu")?.expect(0, &[])?;
    sandbox.vol("render ball.vol -o b.exr --backend cpu -D tint=#ff8000")?.expect(0, &[])?;
    sandbox
        .vol("render ball.vol -o c.exr --backend cpu -D tint=#ffffff -D shown=true --time 0s")?
        .expect(0, &[])?;
    sandbox.vol("render ball.vol -o d.exr --backend cpu -D shown=false")?.expect(0, &[])?;
    let [a, b, c, d] = ["a.exr", "b.exr", "c.exr", "d.exr"].map(|name| sandbox.read(name));
    let a = a?;
    equal((a == b?, a == c?, a == d?), (false, true, false))
}

/// The step is multiplied, and a picture with larger steps is farther from the reference.
fn step_scale_and_reference(sandbox: &Sandbox) -> Result<(), Failed> {
    let run = |options: &str| {
        let run = format!("render fog.vol -o a.exr --backend cpu --stats s.json {options}");
        let summary = sandbox.vol(&run)?.expect(0, &[])?.stderr;
        let stats: serde_json::Value = serde_json::from_slice(&sandbox.read("s.json")?)?;
        let number = |key: &str| stats[key].as_f64();
        Ok::<_, Failed>((summary, number("step"), number("shadow_step"), number("error")))
    };
    sandbox.vol("render fog.vol -o r.exr --backend cpu --max-error 1e-3")?.expect(0, &[])?;
    let (summary, step, shadow_step, error) = run("")?;
    equal((error, summary.contains("scaled"), summary.contains("reference")), (None, false, false))?;
    let (summary, twice, shadow_twice, near) = run("--step-scale 2 --reference r.exr")?;
    // Numbers in the file are rounded to eight digits.
    let doubled = |scaled: Option<f64>, chosen: Option<f64>| (scaled? / chosen? - 2.0).abs().lt(&1e-6).into();
    equal((doubled(twice, step), doubled(shadow_twice, shadow_step)), (Some(true), Some(true)))?;
    equal(
        (summary.contains("before the step was scaled"), summary.contains("against the reference")),
        (true, true),
    )?;
    let (_, _, _, far) = run("--step-scale 8 --reference r.exr")?;
    equal(near > Some(0.0) && near < far, true)?;
    let (_, _, _, none) = run("--max-error 1e-3 --reference r.exr")?;
    equal(none, Some(0.0))?;
    let wrong_size = "render fog.vol -o a.exr --backend cpu --size 8x8 --reference r.exr";
    sandbox.vol(wrong_size)?.expect(2, &["`r.exr` is 32x18, the picture 8x8", "--size"]).map(drop)
}

fn stats(sandbox: &Sandbox) -> Result<(), Failed> {
    let run = "render fog.vol -o f##.png --frames 0..1 --stats s.json --seed 42 --max-error 0.05 --backend cpu --size 16x8";
    sandbox.vol(run)?.expect(0, &[])?;
    let stats: serde_json::Value = serde_json::from_slice(&sandbox.read("s.json")?)?;
    let number =
        |key: &str| stats[key].as_f64().ok_or_else(|| Failed::from(format!("no number `{key}` in {stats}")));
    equal((number("frames")?, number("seed")?), (2.0, 42.0))?;
    equal(stats["size"].to_string(), "[16,8]".to_owned())?;
    equal(stats["backend"].as_str(), Some("cpu"))?;
    equal((number("max_error")? - 0.05).abs() < 1e-6, true)?;
    for key in ["step", "shadow_step", "rays", "samples", "evaluations"] {
        equal((key, number(key)? > 0.0), (key, true))?;
    }
    equal(number("estimate")? <= 0.05, true)?;
    let lights = stats["light_grids"].as_array().map(Vec::len);
    equal((lights, stats["light_grids"][0]["depths"].as_str()), (Some(1), Some("direct")))?;
    for phase in ["check", "compile", "prepare", "pilot", "grids", "render", "write"] {
        let time = stats["milliseconds"][phase].as_f64();
        equal((phase, time.is_some_and(|time| time >= 0.0)), (phase, true))?;
    }
    equal(stats["device"].as_str().is_some_and(|device| device.contains("thread")), true)
}

fn integrators(sandbox: &Sandbox) -> Result<(), Failed> {
    let render = |options: &str| -> Result<(Vec<u8>, serde_json::Value), Failed> {
        let run = format!("render fog.vol -o a.exr --stats s.json --size 16x9 {options}");
        sandbox.vol(&run)?.expect(0, &[])?;
        Ok((sandbox.read("a.exr")?, serde_json::from_slice(&sandbox.read("s.json")?)?))
    };
    // The default is the comb; the references choose the CPU by themselves.
    let (usual, stats) = render("--backend cpu")?;
    equal(usual == render("--backend cpu --integrator comb")?.0, true)?;
    equal((stats["integrator"].as_str(), stats["jitter"].is_null()), (Some("comb"), true))?;
    let (even, stats) = render("--integrator fixed-step --step 0.05 --light-step 0.1")?;
    equal((stats["integrator"].as_str(), stats["backend"].as_str()), (Some("fixed-step"), Some("cpu")))?;
    equal((stats["step"].to_string(), stats["shadow_step"].to_string()), ("0.05".into(), "0.1".into()))?;
    equal((stats["jitter"].as_bool(), stats["tube_bounds"].as_str()), (Some(false), Some("cells")))?;
    equal((stats["estimate"].is_null(), stats["max_error"].is_null()), (true, true))?;
    let jittered = "--integrator fixed-step --step 0.05 --light-step 0.1 --jitter";
    let seeds = [render(jittered)?.0, render(&format!("{jittered} --seed 0 --threads 3"))?.0];
    equal((seeds[0] == seeds[1], seeds[0] == even), (true, false))?;
    equal(seeds[0] == render(&format!("{jittered} --seed 1"))?.0, false)?;
    let (paths, stats) = render("--integrator monte-carlo")?;
    equal((stats["samples_per_pixel"].as_u64(), stats["step"].is_null()), (Some(64), true))?;
    let error = stats["estimate"].as_f64().unwrap_or_default();
    equal((error > 0.0 && error < 0.2, paths == usual), (true, false))?;
    equal(paths == render("--integrator monte-carlo --seed 0 --threads 1")?.0, true)?;
    equal(paths == render("--integrator monte-carlo --seed 1")?.0, false)?;
    // A quarter of the paths, twice the error.
    let few = render("--integrator monte-carlo --samples 16")?.1["estimate"].as_f64().unwrap_or_default();
    equal((1.5..2.5).contains(&(few / error)), true)
}

fn samples(sandbox: &Sandbox) -> Result<(), Failed> {
    let render = |options: &str| -> Result<serde_json::Value, Failed> {
        sandbox
            .vol(&format!("render ball.vol -o a.exr --backend cpu --stats s.json {options}"))?
            .expect(0, &[])?;
        Ok(serde_json::from_slice(&sandbox.read("s.json")?)?)
    };
    let number = |stats: &serde_json::Value, key: &str| {
        stats[key].as_f64().ok_or_else(|| Failed::from(format!("no number `{key}` in {stats}")))
    };
    let of = |stats: &serde_json::Value| -> Result<[f64; 4], Failed> {
        let keys = ["samples_per_pixel", "adaptive", "mean_samples_per_pixel", "camera_rays"];
        Ok([
            number(stats, keys[0])?,
            number(stats, keys[1])?,
            number(stats, keys[2])?,
            number(stats, keys[3])?,
        ])
    };
    let pixels = 32.0 * 18.0;
    equal(of(&render("")?)?, [1.0, 0.0, 1.0, pixels])?;
    let one = sandbox.read("a.exr")?;
    equal(of(&render("--samples 5")?)?, [5.0, 0.0, 5.0, 5.0 * pixels])?;
    equal(one == sandbox.read("a.exr")?, false)?;
    let stats = render("--samples 100 --adaptive 0.25")?;
    let [most, adaptive, mean, rays] = of(&stats)?;
    equal((most, adaptive, mean * pixels == rays), (100.0, 0.25, true))?;
    equal(mean > 12.9 && mean < 50.0, true)?;
    equal(number(&stats, "rays")? > rays, true)?;
    equal(of(&render("--adaptive 0.25")?)?[0], 65.0)?;
    // The scene says the same, and the command line something else.
    let scene = super::BALL.replace("fps: 10", "fps: 10, samples: 20 * steps + 40, adaptive: 0.25");
    sandbox.write("ball.vol", scene)?;
    equal(of(&render("")?)?, [most, adaptive, mean, rays])?;
    equal(of(&render("-D steps=1 --adaptive 0")?)?, [60.0, 0.0, 60.0, 60.0 * pixels])?;
    equal(of(&render("--samples 1")?)?[2], 1.0)?;
    equal(one == sandbox.read("a.exr")?, true)
}

fn summary(sandbox: &Sandbox) -> Result<(), Failed> {
    let outcome = sandbox.vol("render ball.vol -o a.png --backend cpu --threads 2")?;
    let outcome = outcome.expect(0, &["a.png: 32x18 in ", " s on CPU, 2 threads, estimated error"])?;
    equal(outcome.stdout, String::new())?;
    // No bar where standard error is no terminal.
    equal(outcome.stderr.lines().count(), 1)
}

fn auto_without_device(sandbox: &Sandbox) -> Result<(), Failed> {
    let mut command = sandbox.command(["render", "ball.vol", "-o", "a.png"]);
    let output = command.env("VK_DRIVER_FILES", "/nowhere.json").output()?;
    super::Outcome::from(output).expect(0, &["on CPU"])?;
    sandbox.read("a.png").map(drop)
}

fn replaces(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("a.png", "old")?;
    sandbox.vol("render ball.vol -o a.png --backend cpu")?.expect(0, &[])?;
    equal(&sandbox.read("a.png")?[1..4], &b"PNG"[..])
}

/// Presses Ctrl-C in renders of many seconds: of many pixels, and of many samples.
#[cfg(target_os = "linux")]
fn interrupted(sandbox: &Sandbox) -> Result<(), Failed> {
    interrupted_with(sandbox, "--size 8000x8000")?;
    interrupted_with(sandbox, "--size 160x160 --samples 4096")
}

#[cfg(target_os = "linux")]
fn interrupted_with(sandbox: &Sandbox, options: &str) -> Result<(), Failed> {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let arguments = format!("render ball.vol -o a.png --backend cpu --threads 1 --stats s.json {options}");
    let mut command = sandbox.command(arguments.split_whitespace());
    let child = command.stderr(Stdio::piped()).spawn()?;
    // Wait until the program catches the signal: bit 1 of the mask of caught signals.
    let started = Instant::now();
    let status = format!("/proc/{}/status", child.id());
    let catches = || {
        let status = std::fs::read_to_string(&status).ok()?;
        let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:"))?;
        Some(u64::from_str_radix(mask.trim(), 16).ok()? & 2 != 0)
    };
    while catches() != Some(true) && started.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(10));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status()?;
    super::Outcome::from(child.wait_with_output()?).expect(130, &["interrupted"])?;
    equal(sandbox.new_files()?, vec![])
}
