//! Scenes of several files, what their params are called outside, and choosing among their blocks.

use super::{Sandbox, equal, trial};
use libtest_mimic::{Failed, Trial};

pub(super) fn trials() -> Vec<Trial> {
    vec![
        trial("imports::values_and_params", values_and_params),
        trial("imports::from_another_folder", from_another_folder),
        trial("imports::mistakes_name_their_file", mistakes),
        #[cfg(unix)]
        trial("imports::links_do_not_lead_out", links),
        trial("imports::texts_that_are_no_scenes", no_scenes),
        trial("params::lists", params),
        trial("only_and_hide", only_and_hide),
    ]
}

const SCENE: &str = "\
import \"lib/clouds.vol\" as clouds
medium fog { region: sphere(1), density: q => clouds.puff(q.world) }
fn probe(p: vec3) -> float { clouds.puff(p) }
";
const CLOUDS: &str = "\
import \"../amounts.vol\" as amounts
/// How thick it is.
param thickness: float = 2 in 0..9
fn puff(p: vec3) -> float { thickness * amounts.base + p.x }
";

fn write_scene(sandbox: &Sandbox) -> Result<(), Failed> {
    std::fs::create_dir(sandbox.path("lib"))?;
    sandbox.write("scene.vol", SCENE)?;
    sandbox.write("lib/clouds.vol", CLOUDS)?;
    sandbox.write("amounts.vol", "let base = 10\n")
}

fn values_and_params(sandbox: &Sandbox) -> Result<(), Failed> {
    write_scene(sandbox)?;
    let found = sandbox.vol_reading("query scene.vol probe", "0.5,0,0\n")?.expect(0, &[])?;
    equal(found.stdout.trim(), "20.5")?;
    let set =
        sandbox.vol_reading("query scene.vol probe -D clouds.thickness=3", "0.5,0,0\n")?.expect(0, &[])?;
    equal(set.stdout.trim(), "30.5")?;
    sandbox.vol("query scene.vol probe -D thickness=3")?.expect(2, &["clouds.thickness"])?;
    sandbox.vol("query scene.vol probe -D clouds.thickness=30")?.expect(2, &["must be in 0..9"])?;
    Ok(())
}

fn from_another_folder(sandbox: &Sandbox) -> Result<(), Failed> {
    write_scene(sandbox)?;
    std::fs::create_dir(sandbox.path("elsewhere"))?;
    sandbox.vol("check elsewhere/../scene.vol")?.expect(0, &["1 param"])?;
    Ok(())
}

fn mistakes(sandbox: &Sandbox) -> Result<(), Failed> {
    write_scene(sandbox)?;
    sandbox.write("amounts.vol", "let base = 10 +\n")?;
    sandbox.vol("check scene.vol")?.expect(1, &["amounts.vol:1:15", "1 error"])?;
    let json = sandbox.vol("check scene.vol --message-format json")?.expect(1, &[])?.stdout;
    equal(json.contains("amounts.vol\""), true)?;
    std::fs::remove_file(sandbox.path("amounts.vol"))?;
    sandbox.vol("check scene.vol")?.expect(1, &["E0601", "lib/clouds.vol:1:8"])?;
    Ok(())
}

/// A path that stays below the scene's folder, but over a link that does not.
#[cfg(unix)]
fn links(sandbox: &Sandbox) -> Result<(), Failed> {
    let outside = tempfile::tempdir()?;
    std::fs::write(outside.path().join("secret.vol"), "let base = 1\n")?;
    std::os::unix::fs::symlink(outside.path().join("secret.vol"), sandbox.path("amounts.vol"))?;
    sandbox.write("scene.vol", "import \"amounts.vol\" as a\nobject ball { shape: sphere(a.base) }\n")?;
    sandbox.vol("check scene.vol")?.expect(1, &["E0601", "outside of the scene's folder"])?;
    Ok(())
}

fn no_scenes(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("scene.vol", "import \"other.vol\" as other\nobject ball { shape: sphere(1) }\n")?;
    sandbox.write("other.vol", b"VOL\x03abc")?;
    sandbox.vol("check scene.vol")?.expect(1, &["E0601", "binary voxel grid"])?;
    sandbox.write("other.vol", [0xff, 0xfe])?;
    sandbox.vol("check scene.vol")?.expect(1, &["E0601", "not UTF-8"])?;
    std::fs::remove_file(sandbox.path("other.vol"))?;
    std::fs::create_dir(sandbox.path("other.vol"))?;
    sandbox.vol("check scene.vol")?.expect(1, &["E0601", "a folder"])?;
    Ok(())
}

fn params(sandbox: &Sandbox) -> Result<(), Failed> {
    write_scene(sandbox)?;
    let found = sandbox.vol("params scene.vol")?.expect(0, &[])?;
    equal(found.stdout.as_str(), "clouds.thickness: float = 2 in 0..9  // How thick it is.\n")?;
    let json = sandbox.vol("params ball.vol --message-format json")?.expect(0, &[])?.stdout;
    let list: Vec<serde_json::Value> = serde_json::from_str(&json)?;
    equal((list.len(), list[2]["name"].as_str(), list[2]["type"].as_str()), (6, Some("tint"), Some("color")))
}

fn only_and_hide(sandbox: &Sandbox) -> Result<(), Failed> {
    let two = "object a { shape: sphere(1) }\nobject b { shape: box((2, 2, 2)), material: flat(#f00) }\n";
    sandbox.write("two.vol", two)?;
    let render = |arguments: &str, name: &str| -> Result<Vec<u8>, Failed> {
        let line = format!("render two.vol {arguments} --backend cpu --size 16x16 -o {name}");
        sandbox.vol(&line)?.expect(0, &[])?;
        sandbox.read(name)
    };
    let (both, only, hide) =
        (render("", "1.png")?, render("--only b", "2.png")?, render("--hide b", "3.png")?);
    equal(both == only && both != hide, true)?;
    sandbox.vol("render two.vol --hide c -o 4.png")?.expect(2, &["no object and no medium `c`", "a, b"])?;
    sandbox.vol("render two.vol --hide a --only b -o 4.png")?.expect(2, &["cannot be used with"])?;
    Ok(())
}
