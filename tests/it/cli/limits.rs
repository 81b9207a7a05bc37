//! Scenes that ask for too much: they end in a picture, within the memory that `--stats` tells before, or are
//! refused with a reason.

use super::{Sandbox, equal, trial};
use libtest_mimic::{Failed, Trial};

pub(super) fn trials() -> Vec<Trial> {
    let bounded = BOUNDED.iter().map(|&(name, scene)| {
        trial(&format!("limits::memory_of_{name}"), move |sandbox| within_bound(sandbox, &scene()))
    });
    let refused = REFUSED.iter().map(|&(name, scene, words)| {
        trial(&format!("limits::refuses_{name}"), move |sandbox| refuses(sandbox, &scene(), words))
    });
    bounded.chain(refused).collect()
}

/// A name, and what makes the scene.
type Bounded = (&'static str, fn() -> String);

const BOUNDED: &[Bounded] = &[
    ("many_tubes", || {
        let axis =
            "bezier((sin(i), cos(1.7 * i), 0), (sin(0.3 * i), cos(i), 0), (cos(i), sin(1.1 * i), 0.5))";
        let tubes = format!("[for i in 0..10000: tube({axis}, 0.05)]");
        // Without light, and few samples: 10 000 curves are asked for each.
        format!("medium m {{ region: union({tubes}), density: 3, scatter: 0, absorb: 1 }}\n")
            + "render { size: (2, 2) }\n"
    }),
    ("many_media", || {
        let medium = |i: usize| {
            let axis = format!("bezier((sin({i}), cos({i}), 0), (0, cos(2 * {i}), 1), (cos({i}), 0, 0))");
            format!("medium m{i} {{ region: tube({axis}, 0.05), density: 3, scatter: 0, absorb: 1 }}\n")
        };
        (0..500).map(medium).collect()
    }),
    ("a_large_union", || {
        let ball = "sphere(0.02).translate((2 * sin(i), 2 * cos(1.7 * i), 0))";
        format!("object o {{ shape: union([for i in 0..5000: {ball}]) }}\nrender {{ size: (8, 4) }}\n")
    }),
    ("many_objects", || {
        let ball =
            |i: usize| format!("object o{i} {{ shape: sphere(0.1).translate((sin({i}), cos({i}), 0)) }}\n");
        (0..500).map(ball).collect()
    }),
    ("much_noise", || {
        let sum: Vec<_> = (1..=2).map(|k| format!("fbm({k} * q.local, 32)")).collect();
        format!(
            "medium m {{ region: sphere(1), density: q => max(0, {}), scatter: 0, absorb: 1 }}\n",
            sum.join(" + ")
        )
    }),
    ("great_extinction", || {
        "medium m { region: sphere(1), density: q => 1e6 * (2 + q.local.x) }\n".to_owned()
    }),
    ("a_long_curve", || {
        let points = "[for i in 0..3000: (sin(i), cos(1.3 * i), sin(0.7 * i))]";
        format!(
            "medium m {{ region: tube(catmull_rom({points}), 0.02), density: 3, scatter: 0, absorb: 1 }}\n"
        )
    }),
];

/// What is refused, the scene, and words of the message.
type Refused = (&'static str, fn() -> String, &'static [&'static str]);

const REFUSED: &[Refused] = &[
    (
        "a_union_of_100000_moved_parts",
        || {
            let ball = "sphere(0.02).translate((2 * sin(i), 2 * cos(1.7 * i), 2 * sin(2.3 * i)))";
            format!("object o {{ shape: union([for i in 0..100000: {ball}]) }}\n")
        },
        &["error[E0401]", "unrolls to more than"],
    ),
    (
        "a_union_of_100000_equal_parts",
        || "object o { shape: union([for i in 0..100000: sphere(0.02)]) }\n".to_owned(),
        &["error[E0401]", "parts"],
    ),
    (
        "64_octaves",
        || "medium m { region: sphere(1), density: q => fbm(q.local, 64) }\n".to_owned(),
        &["error[E0407]", "at most 32 octaves"],
    ),
    (
        "10000_operators",
        || format!("object o {{ shape: {} }}\n", vec!["sphere(1)"; 10_000].join(" | ")),
        &["error[E0100]", "chains more than 256 operators"],
    ),
];

/// Renders a scene and compares what it took with what it was allowed.
fn within_bound(sandbox: &Sandbox, scene: &str) -> Result<(), Failed> {
    sandbox.write("scene.vol", scene)?;
    let options = "--backend cpu --threads 2 --max-error 0.3 --stats s.json";
    let size = if scene.contains("size:") { "" } else { "--size 32x18" };
    sandbox.vol(&format!("render scene.vol -o a.exr {options} {size}"))?.expect(0, &[])?;
    let stats: serde_json::Value = serde_json::from_slice(&sandbox.read("s.json")?)?;
    let memory = |key: &str| stats["memory"][key].as_u64();
    let Some(bound) = memory("bound") else { return Err(format!("no bound in {stats}").into()) };
    equal(cfg!(target_os = "linux"), memory("peak").is_some())?;
    let grown = memory("peak").zip(memory("before")).map_or(0, |(peak, before)| peak - before);
    if grown > bound || bound > 1 << 30 {
        return Err(format!("took {grown} bytes, the bound is {bound}").into());
    }
    Ok(())
}

fn refuses(sandbox: &Sandbox, scene: &str, words: &[&str]) -> Result<(), Failed> {
    sandbox.write("scene.vol", scene)?;
    sandbox.vol("render scene.vol -o a.exr --backend cpu")?.expect(1, words)?;
    equal(sandbox.new_files()?, vec!["scene.vol".to_owned()])
}
