//! Bad input: a clear message, the right exit code, and nothing left behind.

use super::{Outcome, Sandbox, equal, trial};
use libtest_mimic::{Failed, Trial};

pub(super) fn trials() -> Vec<Trial> {
    vec![
        trial("mistakes::usage", usage),
        trial("mistakes::no_such_scene", no_such_scene),
        trial("mistakes::not_a_scene", not_a_scene),
        trial("mistakes::too_large", too_large),
        trial("mistakes::scene_errors_leave_no_file", scene_errors),
        trial("mistakes::outputs_are_checked_before_rendering", outputs),
        trial("mistakes::definitions", definitions),
        trial("mistakes::points", points),
        trial("mistakes::frame_rate", frame_rate),
        trial("mistakes::sampling", sampling),
        trial("mistakes::no_majorant", no_majorant),
        #[cfg(target_os = "linux")]
        trial("mistakes::full_disk", full_disk),
    ]
}

fn usage(sandbox: &Sandbox) -> Result<(), Failed> {
    let cases = [
        ("", "Usage"),
        ("rendr ball.vol", "render"),
        ("render ball.vol", "--output"),
        ("render -o a.png", "<SCENE>"),
        ("check", "<SCENE>"),
        ("render ball.vol -o a.png --backend cuda", "possible values: cpu, gpu, auto"),
        ("render ball.vol -o a.png --size 0x0", "1..16384"),
        ("render ball.vol -o a.png --size 99999x2", "1..16384"),
        ("render ball.vol -o a.png --size 5", "960x540"),
        ("render ball.vol -o a.png --time soon", "500ms"),
        ("render ball.vol -o a.png --time -1", "from 0 on"),
        ("render ball.vol -o a.png --threads 0", "--threads"),
        ("render ball.vol -o a.png --seed x", "--seed"),
        ("render ball.vol -o a.png --max-error 0", "above 0 and below 1"),
        ("render ball.vol -o a.png --max-error 1", "above 0 and below 1"),
        ("render ball.vol -o a.png --step-scale 0", "from 0.01 to 100"),
        ("render ball.vol -o a.png --step-scale -2", "from 0.01 to 100"),
        ("render ball.vol -o a.png --step-scale two", "from 0.01 to 100"),
        ("render ball.vol -o a.png --reference missing.exr", "cannot read `missing.exr`"),
        ("render ball.vol -o a.png --reference ball.vol", "cannot read `ball.vol`"),
        ("render ball.vol -o a#.png --reference b.exr --frames 0..1", "cannot be used with"),
        ("render ball.vol -o a.png --samples 0", "whole number from 1 to 4096"),
        ("render ball.vol -o a.png --samples -4", "whole number from 1 to 4096"),
        ("render ball.vol -o a.png --samples 2.5", "whole number from 1 to 4096"),
        ("render ball.vol -o a.png --samples 4097", "whole number from 1 to 4096"),
        ("render ball.vol -o a.png --adaptive 1", "from 0 to below 1"),
        ("render ball.vol -o a.png --adaptive -0.1", "from 0 to below 1"),
        ("render ball.vol -o a.png --adaptive nan", "from 0 to below 1"),
        ("render ball.vol -o a.png --integrator ode", "possible values: comb, fixed-step, monte-carlo"),
        ("render ball.vol -o a.png --integrator fixed-step --step 0", "must be a number above 0"),
        ("render ball.vol -o a.png --integrator fixed-step --step -0.1", "must be a number above 0"),
        ("render ball.vol -o a.png --integrator fixed-step --step nan", "must be a number above 0"),
        ("render ball.vol -o a.png --integrator fixed-step --light-step inf", "must be a number above 0"),
        ("render ball.vol -o a.png --integrator fixed-step --tube-bounds x", "cells, sphere-march"),
        ("render ball.vol -o a.png --step 0.1", "`--step` means nothing with `--integrator comb`"),
        ("render ball.vol -o a.png --light-step 0.1", "use `--integrator fixed-step`"),
        ("render ball.vol -o a.png --jitter", "`--jitter` means nothing with `--integrator comb`"),
        ("render ball.vol -o a.png --tube-bounds cells", "use `--integrator fixed-step`"),
        (
            "render ball.vol -o a.png --integrator monte-carlo --step 1",
            "means nothing with `--integrator monte-carlo`",
        ),
        ("render ball.vol -o a.png --integrator monte-carlo --adaptive 0.1", "`--adaptive` means nothing"),
        ("render ball.vol -o a.png --integrator fixed-step --max-error 0.1", "use `--integrator comb`"),
        (
            "render ball.vol -o a.png --integrator monte-carlo --backend gpu",
            "`monte-carlo` runs on the CPU only",
        ),
        (
            "render ball.vol -o a.png --integrator fixed-step --backend gpu",
            "`fixed-step` runs on the CPU only",
        ),
        ("render ball.vol -o a.png --aov normals", "possible values: cost"),
        ("render ball.vol -o a.png --aov", "a value is required"),
        ("render ball.vol -o a.png --aov cost --backend gpu", "costs are counted on the CPU only"),
        ("render ball.vol -o a.exr --aov cost --reference b.exr", "cannot be used with"),
        ("profile", "<SCENE>"),
        ("profile ball.vol --size 5", "960x540"),
        ("profile ball.vol --threads 0", "--threads"),
        ("profile ball.vol --max-error 0", "above 0 and below 1"),
        ("profile ball.vol --backend gpu", "unexpected argument"),
        ("profile ball.vol --only sphere", "no object and no medium `sphere`"),
        ("render ball.vol -o a.png --frames 3", "0..59"),
        ("render ball.vol -o a.png --frames 3..1", "before the first"),
        ("render ball.vol -o a.#.png --frames 1..3 --time 2s", "cannot be used with"),
        ("render ball.vol -o a.png --frames 1..3", "####"),
        ("render ball.vol -o a.png -D size", "spin=70deg"),
        ("diff ball.vol --points 0", "--points"),
    ];
    for (arguments, word) in cases {
        sandbox.vol(arguments)?.expect(2, &[word]).map_err(|failed| in_case(arguments, &failed))?;
    }
    equal(sandbox.new_files()?, vec![])
}

fn no_such_scene(sandbox: &Sandbox) -> Result<(), Failed> {
    std::fs::create_dir(sandbox.path("folder"))?;
    for command in ["check", "render -o a.png", "compile --target wgsl", "query f", "diff"] {
        let run = |scene: &str| {
            let (command, options) = command.split_once(' ').unwrap_or((command, ""));
            sandbox.vol(&format!("{command} {scene} {options}"))
        };
        run("missing.vol")?.expect(2, &["error: cannot read `missing.vol`: No such file"])?;
        run("folder")?.expect(2, &["error: cannot read `folder`: it is a folder"])?;
    }
    equal(sandbox.new_files()?, vec!["folder".to_owned()])
}

fn not_a_scene(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("latin.vol", b"// caf\xe9\nobject ball { shape: sphere(1) }\n")?;
    sandbox.vol("check latin.vol")?.expect(1, &["latin.vol", "not UTF-8", "offset 6"])?;
    sandbox.write("grid.vol", b"VOL\x03\x01\0\0\0")?;
    sandbox.vol("render grid.vol -o a.png")?.expect(1, &["grid.vol", "binary voxel grid"]).map(drop)
}

fn too_large(sandbox: &Sandbox) -> Result<(), Failed> {
    // Holes take no space on the disk; what is read are zeros.
    let file = std::fs::File::create(sandbox.path("large.vol"))?;
    file.set_len(50_000_000)?;
    sandbox.vol("check large.vol")?.expect(1, &["large.vol", "50000000 bytes", "at most"]).map(drop)
}

fn scene_errors(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("bad.vol", "object ball { shape: sphre(1) }\n")?;
    for arguments in [
        "render bad.vol -o a.png --stats s.json",
        "compile bad.vol --target wgsl -o a.wgsl",
        "query bad.vol f",
    ] {
        sandbox.vol(arguments)?.expect(1, &["error[E", "bad.vol:1:", "sphre"])?;
    }
    equal(sandbox.new_files()?, vec!["bad.vol".to_owned()])
}

fn outputs(sandbox: &Sandbox) -> Result<(), Failed> {
    std::fs::create_dir(sandbox.path("folder.png"))?;
    sandbox.write("file", "")?;
    let cases = [
        ("-o missing/a.png", "its folder does not exist"),
        ("-o a.png --stats missing/s.json", "its folder does not exist"),
        ("-o missing/a.####.png --frames 0..3", "its folder does not exist"),
        ("-o file/a.png", "its folder does not exist"),
        ("-o folder.png", "it is a folder"),
        ("-o a.jpg", "end the name with .png or .exr"),
        ("-o a", "end the name with .png or .exr"),
    ];
    for (options, word) in cases {
        // Large enough to take minutes if it were rendered first.
        let run = format!("render ball.vol --size 16384x16384 --backend cpu {options}");
        sandbox.vol(&run)?.expect(2, &["error: ", word]).map_err(|failed| in_case(options, &failed))?;
    }
    sandbox
        .vol("compile ball.vol --target wgsl -o missing/a.wgsl")?
        .expect(2, &["its folder does not exist"])?;
    equal(sandbox.new_files()?.join(" "), "file folder.png".to_owned())
}

fn definitions(sandbox: &Sandbox) -> Result<(), Failed> {
    let cases = [
        ("sise=1", "help: did you mean `size`?"),
        ("xyzzy=1", "help: its params are: size, turn"),
        ("size=3", "`size` must be in 0.1..2, not 3"),
        ("size=true", "cannot set `size` to `true`"),
        ("size=", "spin=70deg"),
        ("size=)", "cannot set `size` to `)`"),
        ("turn=45", "cannot set `turn` to `45`"),
        ("turn=100deg", "`turn` must be in 0deg..90deg, not 100deg"),
        ("steps=2.5", "cannot set `steps`"),
        ("steps=9", "`steps` must be in 1..8, not 9"),
        ("shown=1", "cannot set `shown`"),
        ("tint=red", "cannot set `tint`"),
        ("place=(1,2)", "cannot set `place`"),
        ("size=time", "cannot set `size`"),
    ];
    for (definition, word) in cases {
        let run = format!("render ball.vol -o a.png --backend cpu -D {definition}");
        sandbox.vol(&run)?.expect(2, &["error: ", word]).map_err(|failed| in_case(definition, &failed))?;
    }
    let plain = "object ball { shape: sphere(1) }\n";
    sandbox.write("plain.vol", plain)?;
    sandbox.vol("query plain.vol distance:ball -D a=1")?.expect(2, &["this scene has no params"])?;
    equal(sandbox.new_files()?, vec!["plain.vol".to_owned()])
}

fn points(sandbox: &Sandbox) -> Result<(), Failed> {
    for line in ["1,2", "1,2,3,4", "a,b,c", "nan,0,0", "1;2;3"] {
        let input = format!("0,0,0\n# comment\n{line}\n");
        let outcome = sandbox.vol_reading("query ball.vol distance:ball", &input)?;
        let outcome = outcome.expect(2, &["line 3 of standard input", line, "help: "])?;
        equal(outcome.stdout, String::new())?;
    }
    sandbox
        .vol("query ball.vol distance:ball --at missing.csv")?
        .expect(2, &["cannot read `missing.csv`"])?;
    sandbox.vol("query ball.vol distance:ball --at .")?.expect(2, &["it is a folder"]).map(drop)
}

fn frame_rate(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("still.vol", "object ball { shape: sphere(1) }\nrender { fps: 0 }\n")?;
    let run = "render still.vol -o f#.png --backend cpu --frames 0..1";
    sandbox.vol(run)?.expect(1, &["fps"])?;
    equal(sandbox.new_files()?, vec!["still.vol".to_owned()])
}

/// Values that are only known once params and time are.
fn sampling(sandbox: &Sandbox) -> Result<(), Failed> {
    let scene = "param n: int = 1 in -10..10000\nparam e: float = 0 in -1..2\nobject ball { shape: sphere(1) }\n\
                 render { size: (8, 8), samples: n, adaptive: e / (1 - time) }\n";
    sandbox.write("many.vol", scene)?;
    for (options, words) in [
        ("-D n=0", ["takes 0 samples per pixel", "whole number from 1 to 4096"]),
        ("-D n=-3", ["takes -3 samples per pixel", "whole number from 1 to 4096"]),
        ("-D n=5000", ["takes 5000 samples per pixel", "whole number from 1 to 4096"]),
        ("-D e=-0.5", ["to an error of -0.5", "from 0 to below 1"]),
        ("-D e=1", ["to an error of 1", "from 0 to below 1"]),
        ("-D e=0 --time 1s", ["to an error of NaN", "from 0 to below 1"]),
        ("-D e=1 --time 1s", ["to an error of inf", "from 0 to below 1"]),
    ] {
        let run = format!("render many.vol -o a.png --backend cpu {options}");
        sandbox.vol(&run)?.expect(1, &words).map_err(|failed| in_case(options, &failed))?;
    }
    equal(sandbox.new_files()?, vec!["many.vol".to_owned()])?;
    sandbox.vol("render many.vol -o a.png --backend cpu -D n=20 -D e=0.5")?.expect(0, &[]).map(drop)
}

/// Random paths need to know how dense a medium can be.
fn no_majorant(sandbox: &Sandbox) -> Result<(), Failed> {
    let scene = "medium spike { region: sphere(1), density: q => 1 / (q.local.x * q.local.x) }\nrender { size: (8, 8) }\n";
    sandbox.write("spike.vol", scene)?;
    let run = "render spike.vol -o a.png --integrator monte-carlo";
    sandbox.vol(run)?.expect(1, &["no bound is known", "`spike`", "min(100"])?;
    equal(sandbox.new_files()?, vec!["spike.vol".to_owned()])?;
    sandbox.vol("render spike.vol -o a.png --integrator fixed-step")?.expect(0, &[]).map(drop)
}

#[cfg(target_os = "linux")]
fn full_disk(sandbox: &Sandbox) -> Result<(), Failed> {
    std::os::unix::fs::symlink("/dev/full", sandbox.path("full.png"))?;
    let words = ["error: cannot write `full.png`: No space left"];
    sandbox.vol("render ball.vol -o full.png --backend cpu")?.expect(2, &words)?;
    let device = std::fs::File::options().write(true).open("/dev/full")?;
    let output = sandbox.command(["compile", "ball.vol", "--target", "wgsl"]).stdout(device).output()?;
    Outcome::from(output).expect(2, &["error: cannot write to standard output: No space left"])?;
    // No folder takes a file in /proc, not even from root.
    sandbox
        .vol("render ball.vol -o /proc/a.png --backend cpu")?
        .expect(2, &["error: cannot write `/proc/a.png`"])?;
    equal(sandbox.new_files()?, vec!["full.png".to_owned()])
}

fn in_case(case: &str, failed: &Failed) -> Failed {
    format!("in `{case}`: {}", failed.message().unwrap_or_default()).into()
}
