//! What `vol render --frames` keeps from frame to frame, and that it changes no picture.

use super::{Sandbox, equal, trial};
use libtest_mimic::{Failed, Trial};
use serde_json::Value;

pub(super) fn trials() -> Vec<Trial> {
    vec![
        trial("frames::same_frames_are_not_rendered_again", same_frames),
        trial("frames::a_param_that_reaches_nothing_changes_no_frame", unread),
        trial("frames::same_grids_are_not_filled_again", same_grids),
    ]
}

/// Renders frames 0 to 3 with and without what is kept under a name; the pictures must be the same files.
/// Returns the statistics of both runs.
fn both_ways(sandbox: &Sandbox, scene: &str, options: &str, name: &str) -> Result<[Value; 2], Failed> {
    let run = |folder: &str, more: &str| -> Result<Value, Failed> {
        std::fs::create_dir_all(sandbox.path(folder))?;
        let run = format!("render {scene} -o {folder}/#.exr --frames 0..3 --stats s.json {options} {more}");
        sandbox.vol(&run)?.expect(0, &["4 frames"])?;
        Ok(serde_json::from_slice(&sandbox.read("s.json")?)?)
    };
    let stats = [run("kept", "")?, run("anew", &format!("--no-skip {name}"))?];
    for frame in 0..4 {
        let [kept, anew] = ["kept", "anew"].map(|folder| sandbox.read(&format!("{folder}/{frame}.exr")));
        equal((frame, kept? == anew?), (frame, true))?;
    }
    Ok(stats)
}

fn count(stats: &Value, key: &str) -> Result<u64, Failed> {
    stats[key].as_u64().ok_or_else(|| format!("no count `{key}` in {stats}").into())
}

/// Two frames and two frames.
const STEPS: &str = "\
object ball { shape: sphere(1).translate((floor(0.5 * frame), 0, 0)) }
medium fog { region: sphere(1), density: q => 2 + q.local.x, scatter: 1 }
light sun { from: (1, 1, 1), color: 2 }
camera { from: (0, 0, 6), at: (0, 0, 0) }
render { size: (32, 18), fps: 10 }
";

fn same_frames(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("steps.vol", STEPS)?;
    for options in ["--backend cpu", "--integrator fixed-step", "--integrator monte-carlo --samples 4"] {
        let [kept, anew] = both_ways(sandbox, "steps.vol", options, "same-frames")?;
        equal([count(&kept, "same_frames")?, count(&anew, "same_frames")?], [2, 0])?;
        equal([count(&kept, "frames")?, count(&anew, "frames")?], [4, 4])?;
        // Half of the work; as much per frame that was rendered.
        equal(2 * count(&kept, "camera_rays")?, count(&anew, "camera_rays")?)?;
        equal(&kept["mean_samples_per_pixel"], &anew["mean_samples_per_pixel"])?;
    }
    let [first, second, third] = [0, 1, 2].map(|frame| sandbox.read(&format!("kept/{frame}.exr")));
    let (first, second, third) = (first?, second?, third?);
    equal((first == second, second == third), (true, false))
}

fn unread(sandbox: &Sandbox) -> Result<(), Failed> {
    // The ball's functions of the time can only be asked for.
    let [kept, anew] = both_ways(sandbox, "ball.vol", "--backend cpu", "same-frames")?;
    equal([count(&kept, "same_frames")?, count(&anew, "same_frames")?], [3, 0])?;
    // A sampling that changes is another picture.
    let scene = "object ball { shape: sphere(1) }\nrender { size: (16, 9), fps: 10, adaptive: min(0.5, 0.1 * frame), samples: 8 }\n";
    sandbox.write("adaptive.vol", scene)?;
    let [kept, _] = both_ways(sandbox, "adaptive.vol", "--backend cpu", "same-frames")?;
    equal(count(&kept, "same_frames")?, 0)
}

fn same_grids(sandbox: &Sandbox) -> Result<(), Failed> {
    // The eye goes around gas that stands still.
    let scene = "\
medium gas { region: sphere(1), density: q => 4 + 2 * sin(5 * q.local.x), scatter: 1 }
light sun { from: (1, 1, 1), color: 2 }
camera { from: (6 * sin(0.1 * frame), 0, 6 * cos(0.1 * frame)), at: (0, 0, 0), fov: 20deg }
render { size: (96, 54), fps: 10, samples: 4 }
";
    sandbox.write("around.vol", scene)?;
    let [kept, anew] = both_ways(sandbox, "around.vol", "--backend cpu --max-error 0.05", "same-grids")?;
    equal(kept["light_grids"][0]["depths"]["grid"].is_array(), true)?;
    equal(count(&anew, "same_grids")?, 0)?;
    // The first frame is sampled finer; those after it try the same grid first.
    equal(count(&kept, "same_grids")? >= 2, true)?;
    equal(&kept["light_grids"], &anew["light_grids"])
}
