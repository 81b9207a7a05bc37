//! Styles from the command line: their maps as files, what is kept of them, and what refuses them.

use super::{Outcome, Sandbox, equal, trial};
use libtest_mimic::{Failed, Trial};
use serde_json::Value;

pub(super) fn trials() -> Vec<Trial> {
    vec![
        trial("styles::maps_are_written", maps_are_written),
        trial("styles::light_maps_are_kept", light_maps_are_kept),
        trial("styles::pictures_are_read", pictures_are_read),
        trial("styles::reference_integrators_refuse_them", references_refuse),
        trial("styles::exports_say_what_they_lack", exports_say),
        trial("styles::looks_are_imported", looks_are_imported),
    ]
}

/// Runs `vol` with what it keeps from run to run in the sandbox.
fn vol(sandbox: &Sandbox, arguments: &str) -> Result<Outcome, Failed> {
    let mut command = sandbox.command(arguments.split_whitespace());
    Ok(command.env("XDG_CACHE_HOME", sandbox.path("cache")).output()?.into())
}

/// A roof with a hole in haze, with a style.
fn scene(style: &str) -> String {
    format!(
        "object roof {{ shape: box((2, 0.1, 2)).translate((0, 1.5, 0)) - cylinder(0.4, 1).translate((0, 1.5, 0)) }}\n\
         light sun {{ from: (0.2, 1, 0.1), color: 4 }}\n\
         medium air {{ region: box((1, 1, 1)), scatter: 0.3 }}\n\
         camera {{ from: (0, 0, 5), at: (0, 0, 0), fov: 40deg }}\n\
         render {{ size: (32, 24) }}\n\
         style mood {{ light: sun, {style} }}\n"
    )
}

const PAINTED: &str = "light_map: paint(32, [stroke(camera, (16, 8), (16, 16), 4, #ff4000)])";

fn maps_are_written(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("s.vol", scene(&format!("shadow_map: 64, {PAINTED}")))?;
    let run =
        "render s.vol -o a.exr --backend cpu --shadow-map shadow.png --light-map light.exr --stats s.json";
    vol(sandbox, run)?.expect(0, &["a.exr"])?;
    let sizes = [image::open(sandbox.path("shadow.png"))?.width(), 64];
    equal(sizes[0], sizes[1])?;
    equal(vol::output::exr::read(&sandbox.path("light.exr")).map_err(|e| format!("{e:?}"))?.size, [32, 32])?;
    let stats: Value = serde_json::from_slice(&sandbox.read("s.json")?)?;
    let map = &stats["light_maps"][0];
    equal(map["style"].as_str(), Some("mood"))?;
    let steps = map["residuals"].as_array().map_or(0, Vec::len) as u64;
    equal(map["iterations"].as_u64().map(|count| count + 1), Some(steps))?;
    sandbox.vol("render s.vol -o a.exr --shadow-map a.gif")?.expect(2, &["a.gif"])?;
    Ok(())
}

/// The second run finds what the first has fitted, unless something has changed; the picture is the same.
fn light_maps_are_kept(sandbox: &Sandbox) -> Result<(), Failed> {
    let run = |text: &str, picture: &str| -> Result<bool, Failed> {
        sandbox.write("s.vol", text)?;
        vol(sandbox, &format!("render s.vol -o {picture} --backend cpu --stats s.json"))?.expect(0, &[])?;
        let stats: Value = serde_json::from_slice(&sandbox.read("s.json")?)?;
        Ok(stats["light_maps"][0]["iterations"].is_u64())
    };
    let text = scene(&format!("shadow_map: 64, {PAINTED}"));
    equal([run(&text, "a.exr")?, run(&text, "b.exr")?], [true, false])?;
    equal(sandbox.read("a.exr")? == sandbox.read("b.exr")?, true)?;
    equal(run(&text.replace("#ff4000", "#0040ff"), "c.exr")?, true)?;
    equal(run(&text.replace("0.4, 1", "0.3, 1"), "c.exr")?, true)
}

fn pictures_are_read(sandbox: &Sandbox) -> Result<(), Failed> {
    let blue = image::RgbaImage::from_pixel(3, 2, image::Rgba([0, 0, 255, 255]));
    blue.save(sandbox.path("blue.png"))?;
    sandbox.write("s.vol", scene("transfer: [image(\"blue.png\")]"))?;
    sandbox.vol("render s.vol -o a.exr --backend cpu")?.expect(0, &[])?;
    let colors = vol::output::exr::read(&sandbox.path("a.exr")).map_err(|e| format!("{e:?}"))?;
    let [r, _, b] = colors.pixels[12 * 32 + 16];
    equal((r.abs() < 1e-6, b > 1e-3), (true, true))?;
    // Relative to the file that names it, not to where `vol` runs.
    std::fs::create_dir(sandbox.path("deeper"))?;
    std::fs::rename(sandbox.path("blue.png"), sandbox.path("deeper/blue.png"))?;
    std::fs::rename(sandbox.path("s.vol"), sandbox.path("deeper/s.vol"))?;
    sandbox.vol("check deeper/s.vol")?.expect(0, &[])?;
    sandbox.write("deeper/blue.png", "no picture")?;
    sandbox.vol("check deeper/s.vol")?.expect(1, &["E0508", "blue.png"])?;
    Ok(())
}

fn references_refuse(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("s.vol", scene("fill_holes: disk(5)"))?;
    for integrator in ["fixed-step", "monte-carlo"] {
        let run = format!("render s.vol -o a.png --integrator {integrator}");
        sandbox.vol(&run)?.expect(2, &[integrator, "styles"])?;
    }
    sandbox.write("s.vol", scene("fill_holes: disk(5), when: time > 1"))?;
    sandbox.vol("render s.vol -o a.png --integrator fixed-step")?.expect(0, &[])?;
    Ok(())
}

fn exports_say(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("s.vol", scene("fill_holes: disk(5)"))?;
    sandbox.vol("compile s.vol --target wgsl --step 0.1 -o s.wgsl")?.expect(0, &["styles"])?;
    let text = String::from_utf8(sandbox.read("s.wgsl")?)?;
    equal(text.contains("fn style_rays"), true)
}

fn looks_are_imported(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("looks.vol", "fn dusk(level: float) -> [layer] { [solid(rgb(level, 0, 0))] }\n")?;
    let text = scene("transfer: looks.dusk(0.5)");
    sandbox.write("s.vol", format!("import \"looks.vol\" as looks\n{text}"))?;
    sandbox.vol("render s.vol -o a.exr --backend cpu")?.expect(0, &[])?;
    let colors = vol::output::exr::read(&sandbox.path("a.exr")).map_err(|e| format!("{e:?}"))?;
    let [r, g, _] = colors.pixels[12 * 32 + 16];
    equal((r > 1e-3, g.abs() < 1e-6), (true, true))
}
