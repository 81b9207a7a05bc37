//! What `vol check`, `compile`, `query`, `diff` and `stress` say.

use super::{Outcome, Sandbox, equal, trial};
#[cfg(feature = "gpu")]
use crate::gpu_device::gpu_trial;
use libtest_mimic::{Failed, Trial};

pub(super) fn trials() -> Vec<Trial> {
    let trials = vec![
        trial("help_and_version", help),
        trial("check::fine", check_fine),
        trial("check::verbose", check_verbose),
        trial("check::human", check_human),
        trial("check::json", check_json),
        trial("check::fix", check_fix),
        trial("check::all_files_are_checked", check_all),
        trial("explain", explain),
        trial("compile::wgsl", compile),
        trial("compile::languages", compile_languages),
        trial("compile::reflection", compile_reflection),
        trial("query::reference_and_cpu", query),
        trial("query::points_from_a_file", query_file),
        trial("query::params_and_time", query_params),
        trial("query::several_components", query_components),
        trial("query::unknown_field_lists_the_fields", query_unknown),
        trial("query::broken_pipe_is_quiet", broken_pipe),
        trial("stress::fine", stress_fine),
        trial("stress::faults", stress_faults),
        trial("gpu_by_name_without_a_device", no_device),
    ];
    trials.into_iter().chain(gpu_trials()).collect()
}

#[cfg(feature = "gpu")]
fn gpu_trials() -> Vec<Trial> {
    vec![
        gpu_trial("cli::diff", |_| diff(&Sandbox::new()?)),
        gpu_trial("cli::render_and_query", |_| gpu_by_name(&Sandbox::new()?)),
    ]
}

#[cfg(not(feature = "gpu"))]
fn gpu_trials() -> Vec<Trial> {
    Vec::new()
}

fn help(sandbox: &Sandbox) -> Result<(), Failed> {
    let help = sandbox.vol("--help")?.expect(0, &[])?.stdout;
    for command in
        ["render", "check", "fmt", "params", "explain", "compile", "query", "diff", "stress", "Exit codes"]
    {
        equal((command, help.contains(command)), (command, true))?;
    }
    let version = sandbox.vol("--version")?.expect(0, &[])?.stdout;
    equal(version, format!("vol {}\n", env!("CARGO_PKG_VERSION")))
}

/// A table on standard output, nothing wrong, the same twice.
fn stress_fine(sandbox: &Sandbox) -> Result<(), Failed> {
    let run = || sandbox.vol("stress ball.vol --points 200 --backend cpu");
    let outcome = run()?.expect(0, &["moments", "against f64"])?;
    for function in ["distance:ball", "gradient:ball", "surface:ball", "ramp", "seen"] {
        equal((function, outcome.stdout.contains(function)), (function, true))?;
    }
    equal(run()?.stdout, outcome.stdout)
}

/// Exit code 1 and the expression underlined; the same as JSON.
fn stress_faults(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("bad.vol", "medium fog { region: sphere(1), density: q => 2 + 1 / q.local.x }\n")?;
    let words = ["error[E0701]", "bad.vol:1:51", "the inside of the medium `fog`", "`/` of 1 and 0 is inf"];
    sandbox.vol("stress bad.vol --backend cpu")?.expect(1, &words)?;
    let outcome = sandbox.vol("stress bad.vol --backend cpu --message-format json")?.expect(1, &[])?;
    let lines: Vec<serde_json::Value> =
        outcome.stdout.lines().map(serde_json::from_str).collect::<Result<_, _>>()?;
    let codes = lines.iter().filter(|line| line["code"] == "E0701").count();
    let rows = lines.iter().filter(|line| line["function"].is_string()).count();
    equal((codes, rows), (1, 4))
}

/// What is left out is told where it is asked for, and in the statistics of a render.
fn check_verbose(sandbox: &Sandbox) -> Result<(), Failed> {
    let scene = "medium fog { region: sphere(1), scatter: 0, absorb: 1 }\nlight sun { from: (1, 1, 1), shadows: false }\n";
    sandbox.write("dark.vol", scene)?;
    let words = ["note: medium `fog`: nothing scatters", "note: light `sun`: casts no shadows"];
    for run in ["check -v dark.vol", "check --verbose dark.vol"] {
        sandbox.vol(run)?.expect(0, &words)?;
    }
    equal(sandbox.vol("check dark.vol")?.expect(0, &["fine"])?.stderr.contains("note"), false)?;
    // A medium without matter is a thing to know in any case.
    sandbox.write("empty.vol", "medium gas { region: sphere(1), scatter: 0 }\n")?;
    sandbox.vol("check empty.vol")?.expect(0, &["note: medium `gas` neither scatters"])?;
    sandbox.vol("render dark.vol -o a.png --backend cpu --size 8x4 --stats s.json")?.expect(0, &[])?;
    let stats: serde_json::Value = serde_json::from_slice(&sandbox.read("s.json")?)?;
    let dropped = stats["dropped"].as_array().into_iter().flatten().filter_map(serde_json::Value::as_str);
    let told = dropped
        .filter(|sentence| words.iter().any(|word| sentence.starts_with(word.trim_start_matches("note: "))));
    equal(told.count(), 2)
}

fn check_fine(sandbox: &Sandbox) -> Result<(), Failed> {
    let outcome = sandbox.vol("check ball.vol fog.vol")?;
    let words =
        ["ball.vol: fine: 1 object, 0 media, 1 light, 6 params", "fog.vol: fine: 0 objects, 1 medium"];
    let outcome = outcome.expect(0, &words)?;
    equal(outcome.stdout, String::new())?;
    let outcome = sandbox.vol("check ball.vol --message-format json")?.expect(0, &[])?;
    equal((outcome.stdout, outcome.stderr), (String::new(), String::new()))
}

fn check_human(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("bad.vol", "object ball { shape: sphre(1) }\nobject cube { shape: 3 }\n")?;
    let outcome = sandbox
        .vol("check bad.vol")?
        .expect(1, &["error[E", "bad.vol:1:", "sphre", "bad.vol:2:", "bad.vol: 2 errors"])?;
    equal(outcome.stdout, String::new())?;
    equal(outcome.stderr.contains('\u{1b}'), false)
}

fn check_json(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("bad.vol", "object ball { shape: sphre(1) }\nobject cube { shape: 3 }\n")?;
    let outcome = sandbox.vol("check bad.vol --message-format json")?.expect(1, &[])?;
    equal(outcome.stderr, String::new())?;
    let lines: Result<Vec<serde_json::Value>, _> = outcome.stdout.lines().map(serde_json::from_str).collect();
    let lines = lines?;
    equal(lines.len(), 2)?;
    equal(lines.iter().all(|line| line["severity"] == "error" && line["file"] == "bad.vol"), true)
}

fn check_fix(sandbox: &Sandbox) -> Result<(), Failed> {
    let faulty = "let unused = 1\nobject ball { shape: shpere(1).rotate_y(45) }\nobject cube { shape: box((1, 1, 1)),, }\n";
    sandbox.write("bad.vol", faulty)?;
    // Beside an error of syntax unknown names are not reported; the next look finds them.
    let words = ["bad.vol: 2 repairs", "error[E0201]", "bad.vol: 1 error, 0 warnings"];
    sandbox.vol("check --fix bad.vol")?.expect(1, &words)?;
    sandbox.vol("check --fix bad.vol")?.expect(0, &["bad.vol: 1 repair\n", "warning[W0101]"])?;
    let repaired = "let unused = 1\nobject ball { shape: sphere(1).rotate_y(45deg) }\nobject cube { shape: box((1, 1, 1)), }\n";
    equal(String::from_utf8_lossy(&sandbox.read("bad.vol")?).into_owned(), repaired.to_owned())?;
    // Of two ways to repair it the author chooses.
    let twice = "object ball { shape: sphere(1), shape: sphere(2) }\n";
    sandbox.write("twice.vol", twice)?;
    sandbox.vol("check --fix twice.vol")?.expect(1, &["error[E0303]"])?;
    equal(sandbox.read("twice.vol")?, twice.as_bytes().to_vec())?;
    sandbox.vol("check --fix ball.vol")?.expect(0, &["ball.vol: fine"])?;
    Ok(())
}

fn check_all(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("bad.vol", "object ball {")?;
    sandbox.vol("check bad.vol ball.vol")?.expect(1, &["bad.vol:1", "ball.vol: fine"])?;
    // The worst outcome decides, whatever the order.
    sandbox
        .vol("check missing.vol bad.vol ball.vol")?
        .expect(2, &["cannot read `missing.vol`", "bad.vol:1", "fine"])?;
    sandbox.vol("check bad.vol missing.vol")?.expect(2, &[]).map(drop)
}

fn explain(sandbox: &Sandbox) -> Result<(), Failed> {
    let list = sandbox.vol("explain")?.expect(0, &[])?.stdout;
    equal(list.lines().count(), vol::explain::codes().len())?;
    equal(list.contains("\nE0206  a bare number stands where an angle is expected\n"), true)?;
    let story = sandbox.vol("explain e0206")?.expect(0, &[])?.stdout;
    for part in ["E0206: a bare", "\nbefore:\n\n    param", "\nafter:\n\n    param", "rotate_x(30deg)"] {
        equal((part, story.contains(part)), (part, true))?;
    }
    equal(story.contains("```"), false)?;
    sandbox.vol("explain E206")?.expect(2, &["no code `E206`", "did you mean `E0206`?"])?;
    sandbox.vol("explain sphere")?.expect(2, &["no code `sphere`", "`vol explain` lists all codes"])?;
    Ok(())
}

fn compile(sandbox: &Sandbox) -> Result<(), Failed> {
    let text = sandbox.vol("compile ball.vol --target wgsl")?.expect(0, &[])?.stdout;
    equal((text.contains("@compute"), text.contains("@fragment"), text.ends_with('\n')), (true, true, true))?;
    equal(text.contains("// ball.vol:"), true)?;
    let outcome = sandbox.vol("compile ball.vol --target wgsl -o a.wgsl")?.expect(0, &[])?;
    equal(outcome.stdout, String::new())?;
    equal(String::from_utf8(sandbox.read("a.wgsl")?)?, text)?;
    sandbox.vol("compile ball.vol")?.expect(2, &["--target"])?;
    sandbox.vol("compile ball.vol --target basic")?.expect(2, &["wgsl", "shadertoy"]).map(drop)
}

/// Every language, in the forms that it has.
fn compile_languages(sandbox: &Sandbox) -> Result<(), Failed> {
    for (target, form, words) in [
        ("glsl", "module", ["#version 310 es", "VOL_COMPUTE"]),
        ("glsl", "library", ["sky_distance_ball", "sky_radiance"]),
        ("hlsl", "module", ["numthreads", "SV_Position"]),
        ("msl", "module", ["kernel", "fragment"]),
        ("shadertoy", "library", ["mainImage", "iResolution"]),
        ("wgsl", "library", ["fn sky_density(p: vec3f) -> f32", "The scene at 2 s"]),
    ] {
        let run = format!("compile ball.vol --target {target} --as {form} --prefix sky --time 2s");
        let text = sandbox.vol(&run)?.expect(0, &[])?.stdout;
        equal((target, words.map(|word| text.contains(word))), (target, [true; 2]))?;
    }
    sandbox.vol("compile ball.vol --target spirv -o a.spv")?.expect(0, &[])?;
    equal(sandbox.read("a.spv")?[..4].to_vec(), vec![3, 2, 0x23, 7])?;
    sandbox.vol("compile ball.vol --target spirv --as library")?.expect(2, &["SPIR-V", "--as"])?;
    sandbox.vol("compile ball.vol --target shadertoy --as module")?.expect(2, &["Shadertoy", "--as"])?;
    sandbox.vol("compile ball.vol --target wgsl -o a.x --reflect a.x")?.expect(2, &["one file"])?;
    sandbox.vol("compile ball.vol --target wgsl --prefix 9")?.expect(2, &["--prefix"])?;
    sandbox.vol("compile ball.vol --target wgsl --step 0.1 --max-error 0.1")?.expect(2, &["--step"])?;
    sandbox
        .vol("compile ball.vol --target wgsl --reflect no/such/folder.json")?
        .expect(2, &["no/such"])
        .map(drop)
}

/// What a caller must know; contents of buffers are those of the moment.
fn compile_reflection(sandbox: &Sandbox) -> Result<(), Failed> {
    let reflected = |more: &str| -> Result<serde_json::Value, Failed> {
        let run = format!("compile ball.vol --target wgsl --reflect a.json -o a.wgsl {more}");
        sandbox.vol(&run)?.expect(0, &[])?;
        Ok(serde_json::from_slice(&sandbox.read("a.json")?)?)
    };
    let (usual, other) = (reflected("")?, reflected("-D size=0.5")?);
    equal(usual["params"][0]["name"].as_str(), Some("size"))?;
    equal(usual["bindings"][0]["words"] == other["bindings"][0]["words"], false)?;
    let names: Vec<_> =
        usual["bindings"].as_array().into_iter().flatten().map(|b| b["name"].as_str()).collect();
    let expected = ["vol_uniforms", "vol_curves", "vol_permutation", "vol_frame", "vol_input", "vol_output"];
    equal(names, expected.map(Some).to_vec())?;
    let text = String::from_utf8(sandbox.read("a.wgsl")?)?;
    for vectors in usual["test_vectors"].as_array().into_iter().flatten() {
        let function = vectors["function"].as_str().unwrap_or_default();
        equal((function, text.contains(&format!("fn {function}("))), (function, true))?;
        equal(vectors["points"].as_array().is_some_and(|points| !points.is_empty()), true)?;
    }
    let library = reflected("--as library")?;
    equal(
        (library["bindings"].is_null(), library["functions"][0]["name"].as_str()),
        (true, Some("vol_distance")),
    )
}

fn query(sandbox: &Sandbox) -> Result<(), Failed> {
    let points = "0,0,0\n\n# a comment\n 2 , 0 , 0\r\n0,0.5,0 # another\n";
    for backend in ["reference", "cpu"] {
        let run = format!("query ball.vol distance:ball --backend {backend}");
        let outcome = sandbox.vol_reading(&run, points)?.expect(0, &[])?;
        equal(outcome.stdout, "-1\n1\n-0.5\n".to_owned())?;
    }
    let outcome = sandbox.vol_reading("query fog.vol density:fog", "0.5,0,0\n")?.expect(0, &[])?;
    equal(outcome.stdout, "2.5\n".to_owned())?;
    let nothing = sandbox.vol_reading("query ball.vol distance:ball", "")?.expect(0, &[])?;
    equal(nothing.stdout, String::new())
}

fn query_file(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("points.csv", "1,0,0\n3,0,0\n")?;
    let outcome = sandbox.vol("query ball.vol distance:ball --at points.csv")?.expect(0, &[])?;
    equal(outcome.stdout, "0\n2\n".to_owned())
}

fn query_params(sandbox: &Sandbox) -> Result<(), Failed> {
    let cases = [
        ("distance:ball -D size=0.5", "-0.5"),
        ("distance:ball -D size=0.5 -D size=2", "-2"),
        ("ramp --time 2s", "2"),
        ("ramp --time 500ms -D place=(1,7,3)", "7.5"),
        ("seen --time 0.3 -D turn=0.5rad -D steps=8", "11.5"),
    ];
    for (arguments, expected) in cases {
        let outcome =
            sandbox.vol_reading(&format!("query ball.vol {arguments}"), "0,0,0\n")?.expect(0, &[])?;
        equal((arguments, outcome.stdout.trim_end()), (arguments, expected))?;
    }
    Ok(())
}

fn query_components(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write(
        "field.vol",
        "object ball { shape: sphere(1) }\nfn swap(p: vec3) -> vec3 { (p.y, p.x, 1 / 3) }\n",
    )?;
    let outcome = sandbox.vol_reading("query field.vol swap", "1,2,3\n-4,1e-7,0\n")?.expect(0, &[])?;
    let rows: Result<Vec<Vec<f32>>, _> =
        outcome.stdout.lines().map(|line| line.split(',').map(str::parse).collect()).collect();
    equal(rows?, vec![vec![2.0, 1.0, 1.0 / 3.0], vec![1e-7, -4.0, 1.0 / 3.0]])
}

fn query_unknown(sandbox: &Sandbox) -> Result<(), Failed> {
    let outcome = sandbox.vol("query ball.vol distance:bell")?;
    let words = ["no field `distance:bell`", "help: did you mean `distance:ball`?", "ramp"];
    outcome.expect(2, &words)?;
    sandbox.vol("query ball.vol xyz")?.expect(2, &["help: the fields are: ", "distance:ball"]).map(drop)
}

/// `vol query … | head -0` with more output than a pipe holds.
fn broken_pipe(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox.write("points.csv", "0.1,0.2,0.3\n".repeat(100_000))?;
    let mut command =
        sandbox.command(["query", "ball.vol", "distance:ball", "--at", "points.csv", "--backend", "cpu"]);
    let piped = std::process::Stdio::piped;
    let mut child = command.stdout(piped()).stderr(piped()).spawn()?;
    drop(child.stdout.take());
    let outcome = Outcome::from(child.wait_with_output()?).expect(0, &[])?;
    equal(outcome.stderr, String::new())
}

fn no_device(sandbox: &Sandbox) -> Result<(), Failed> {
    for arguments in [
        "render ball.vol -o a.png --backend gpu",
        "diff ball.vol",
        "query ball.vol distance:ball --backend gpu",
    ] {
        let mut command = sandbox.command(arguments.split_whitespace());
        let output = command.env("VK_DRIVER_FILES", "/nowhere.json").output()?;
        Outcome::from(output).expect(3, &["error: ", "CPU"])?;
    }
    equal(sandbox.new_files()?, vec![])?;
    // Where nobody asked for the GPU the CPU does it, and a line says why.
    let mut command = sandbox.command("render ball.vol -o a.png --backend auto".split_whitespace());
    let output = command.env("VK_DRIVER_FILES", "/nowhere.json").output()?;
    Outcome::from(output).expect(0, &["note: ", "using the CPU", "on CPU"]).map(drop)
}

#[cfg(feature = "gpu")]
fn diff(sandbox: &Sandbox) -> Result<(), Failed> {
    for (scene, fields) in [("ball.vol", "distance:ball"), ("fog.vol", "density:fog")] {
        let outcome =
            sandbox.vol(&format!("diff {scene} --points 500"))?.expect(0, &["CPU, ", " against GPU, "])?;
        for word in ["undecided", "|cpu-ref|/bound", "|gpu-ref|/bound", fields, "over tolerance", "32x18"] {
            equal((word, outcome.stdout.contains(word)), (word, true))?;
        }
        equal(outcome.stdout.contains("FAILED"), false)?;
    }
    let outcome =
        sandbox.vol("diff ball.vol --points 10 --size 8x4 --time 1s -D size=0.5")?.expect(0, &[])?;
    equal(outcome.stdout.contains("8x4"), true)?;
    sandbox.vol("diff fog.vol --difference d.exr")?.expect(2, &["PNG"])?;
    // Bits are counted, and with strict arithmetic on software demanded.
    let outcome =
        sandbox.vol("diff fog.vol --points 100 --strict --difference d.png")?.expect(0, &["strict"])?;
    equal(outcome.stdout.contains("other bits"), true)?;
    equal(sandbox.read("d.png")?[1..4].to_vec(), b"PNG".to_vec())
}

#[cfg(feature = "gpu")]
fn gpu_by_name(sandbox: &Sandbox) -> Result<(), Failed> {
    sandbox
        .vol("render fog.vol -o a.png --backend gpu --stats s.json")?
        .expect(0, &["a.png: 32x18", "on GPU, "])?;
    let stats: serde_json::Value = serde_json::from_slice(&sandbox.read("s.json")?)?;
    equal(stats["backend"].as_str(), Some("gpu"))?;
    // The shape of workgroups changes no picture.
    let picture = |shape: &str| -> Result<Vec<u8>, Failed> {
        let run = format!("render fog.vol -o b.exr --backend gpu --strict --workgroup {shape}");
        sandbox.vol(&run)?.expect(0, &[])?;
        sandbox.read("b.exr")
    };
    equal(picture("8x8")? == picture("128x1")?, true)?;
    sandbox.vol("render fog.vol -o b.exr --workgroup 32x16")?.expect(2, &["256"])?;
    let outcome = sandbox.vol_reading("query ball.vol distance:ball --backend gpu", "0,0,0\n0,3,0\n")?;
    equal(outcome.expect(0, &[])?.stdout, "-1\n2\n".to_owned())
}
