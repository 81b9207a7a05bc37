//! Scene blocks: names, keys, values that belong together.

use super::support::{checked, help, message, scene, scene_errors, show};

const BALL: &str = "object ball { shape: sphere(1) }\n";

fn block_errors(blocks: &str) -> Vec<String> {
    scene_errors(&format!("{BALL}{blocks}"))
}

const TORNADO: &str = r"
param spin: angle = 70deg in 0deg..240deg   // per second; a slider: changing it recompiles nothing
param octaves: int = 5 in 1..8

let spine = bezier((0.3 * sin(time), 0, 0), (0.4 * cos(0.7 * time), 1.1, 0.2), (0, 2.2, 0))

medium cloud {
  region:  tube(spine, radius: t => mix(0.08, 0.6, t * t), twist: t => 0.8turn * t - spin * time)
  density: q => 25 * max(0, fbm(q.local * vec3(3, 6, 3) - (0, time, 0), octaves) + 0.15)
  scatter: #e6ebff
  absorb:  0.15
  phase:   henyey_greenstein(0.3)
}

light sun  { from: (-0.4, 0.8, 0.3), color: 12 }
camera     { from: (0, 1.1, 4.5), at: (0, 1.1, 0), fov: 40deg }
render     { size: (960, 540), background: #0b1020, duration: 10s, fps: 30 }
";

#[test]
fn tornado_is_clean() {
    let (scene, diagnostics) = checked(TORNADO);
    assert_eq!(diagnostics, []);
    let cloud = &scene.blocks[0];
    let absorb = show(&scene, cloud.entry("absorb").expect("given"));
    assert_eq!(absorb, "(local) -> color!constant(color!broadcast(0.15))");
    let keywords: Vec<_> = scene.blocks.iter().map(|block| block.kind.keyword()).collect();
    assert_eq!(keywords, ["medium", "light", "camera", "render"]);
}

#[test]
fn entries_keep_their_order() {
    let scene = scene("light sun { color: 2, from: (0, 1, 0) }");
    let keys: Vec<_> = scene.blocks[0].entries.iter().map(|(key, _)| *key).collect();
    assert_eq!(keys, ["color", "from"]);
}

#[test]
fn unknown_key() {
    let source = "medium m { region: sphere(1), densty: 1 }";
    assert_eq!(block_errors(source), ["E0302 `densty`: no such key"]);
    assert_eq!(help(source), "did you mean `density`");
    let keys = "the keys are `size`, `background`, `ambient`, `samples`, `adaptive`, `duration`, `fps`";
    assert_eq!(help("render { zzzz: 1 }"), keys);
}

#[test]
fn value_of_an_unknown_key_is_checked() {
    assert_eq!(
        block_errors("render { zzzz: nix }"),
        ["E0302 `zzzz`: no such key", "E0201 `nix`: no such name"]
    );
}

#[test]
fn key_given_twice() {
    assert_eq!(block_errors("render { fps: 30, fps: 25 }"), ["E0303 `fps`: given again here"]);
}

#[test]
fn required_key_missing() {
    assert_eq!(block_errors("medium m { density: 1 }"), ["E0304 `medium m`: `region` is missing"]);
}

#[test]
fn wrong_value_is_reported_and_no_follow_up() {
    assert_eq!(block_errors("medium m { region: nix }"), ["E0201 `nix`: no such name"]);
    assert_eq!(block_errors("medium m { region: 1 }"), ["E0205 `1`: this is an int"]);
    assert_eq!(message("medium m { region: 1 }"), "expected a shape for `region`, found an int");
}

#[test]
fn second_camera() {
    assert_eq!(block_errors("camera {}\ncamera {}"), ["E0305 `camera`: this is the second"]);
}

#[test]
fn missing_and_needless_names() {
    assert_eq!(block_errors("light { from: (0, 1, 0) }"), ["E0306 `light`: a name is missing after this"]);
    assert_eq!(block_errors("camera main {}"), ["E0306 `main`: a name stands here"]);
}

#[test]
fn two_blocks_of_one_name() {
    assert_eq!(block_errors("light ball { from: (0, 1, 0) }"), ["E0307 `ball`: used again here"]);
}

#[test]
fn light_has_one_place() {
    assert_eq!(block_errors("light l { color: 1 }"), ["E0308 `light l`: where does it shine from"]);
    assert_eq!(
        block_errors("light l { from: (0, 1, 0), at: (0, 2, 0) }"),
        ["E0308 `(0, 2, 0)`: the light has a `from`, too"]
    );
}

#[test]
fn light_has_a_direction() {
    assert_eq!(block_errors("light l { from: (0, 0, 0) }"), ["E0309 `(0, 0, 0)`: this is zero"]);
    assert_eq!(block_errors("light l { from: (0, time, 0) }"), [""; 0]);
}

#[test]
fn lighting_is_one_of_three_words() {
    let medium = |lighting: &str| format!("medium m {{ region: sphere(1), lighting: {lighting} }}");
    assert_eq!(block_errors(&medium("\"unshadowed\"")), [""; 0]);
    assert_eq!(block_errors(&medium("\"dark\"")), ["E0310 `\"dark\"`: no such lighting"]);
    assert_eq!(block_errors(&medium("none")), [""; 0]);
    assert_eq!(block_errors(&medium("if true then none else shadowed")), [""; 0]);
    assert_eq!(help(&medium("shadow")), "did you mean `shadowed`");
    assert_eq!(block_errors(&medium("1")), ["E0205 `1`: this is an int"]);
}

#[test]
fn size_is_two_whole_numbers() {
    assert_eq!(block_errors("render { size: (640, 1.5) }"), ["E0311 `(640, 1.5)`: this is 640 by 1.5"]);
    assert_eq!(block_errors("render { size: (0, 100) }"), ["E0311 `(0, 100)`: this is 0 by 100"]);
    assert_eq!(block_errors("render { size: (16385, 1) }"), ["E0311 `(16385, 1)`: this is 16385 by 1"]);
    assert_eq!(block_errors("render { size: (time, 1) }"), ["E0311 `(time, 1)`: not a constant"]);
    assert_eq!(block_errors("render { size: 512 }"), [""; 0]);
}

#[test]
fn fov_is_below_half_a_turn() {
    assert_eq!(block_errors("camera { fov: 180deg }"), ["E0312 `180deg`: this is 180deg"]);
    assert_eq!(block_errors("camera { fov: 0deg }"), ["E0312 `0deg`: this is 0deg"]);
    assert_eq!(block_errors("camera { fov: 40 }"), ["E0206 `40`: this number has no unit"]);
    assert_eq!(block_errors("camera { fov: time * 10deg }"), [""; 0]);
}

#[test]
fn nothing_to_draw() {
    assert_eq!(scene_errors(""), ["E0313 ``: nothing to draw"]);
    assert_eq!(scene_errors("object a { shape: nix }"), ["E0201 `nix`: no such name"]);
}

#[test]
fn timing_is_positive() {
    assert_eq!(block_errors("render { fps: 0 }"), ["E0314 `0`: this is 0"]);
    assert_eq!(block_errors("render { duration: -1 }"), ["E0314 `-1`: this is -1"]);
}

#[test]
fn sampling_is_in_range() {
    for (value, label) in [("0", "0"), ("-3", "-3"), ("4097", "4097"), ("2 * 0", "0")] {
        let source = format!("render {{ samples: {value} }}");
        assert_eq!(block_errors(&source), [format!("E0319 `{value}`: this is {label}")]);
    }
    for (value, label) in [("-0.01", "-0.01"), ("1", "1"), ("2.5", "2.5")] {
        let source = format!("render {{ adaptive: {value} }}");
        assert_eq!(block_errors(&source), [format!("E0319 `{value}`: this is {label}")]);
    }
    assert_eq!(help("render { samples: 0 }"), "write `samples: 16`");
    for fine in ["samples: 1", "samples: 4096, adaptive: 0", "adaptive: 0.999", "samples: 16, adaptive: time"]
    {
        assert_eq!(block_errors(&format!("render {{ {fine} }}")), [""; 0], "{fine}");
    }
    assert_eq!(block_errors("render { samples: 1.5 }").len(), 1);
}

#[test]
fn camera_looks_somewhere() {
    assert_eq!(block_errors("camera { from: (1, 1, 1), at: 1 }"), ["E0315 `1`: the same as `from`"]);
}
