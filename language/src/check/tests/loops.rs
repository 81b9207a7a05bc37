//! Loops, keys, words and nested settings.

use super::support::{errors, help, message, scene_errors, value};

#[test]
fn a_loop_is_a_record_of_its_state() {
    let source = "let a = iterate 8 from (z = (1, 2, 3), n = 0) while n < 4: (z = 2 * z, n = n + 1)";
    assert!(value(&format!("{source}\nlet b = a.z")).ends_with("a.0:vec3"));
    assert!(value(&format!("{source}\nlet b = a.n")).ends_with("a.1:int"));
    assert_eq!(errors(&format!("{source}\nlet b = a.q")), ["E0209 `q`: no such field"]);
}

#[test]
fn next_values_see_the_old_state_in_any_order() {
    let shown = value("let a = iterate 3 from (x = 1.5, y = 2.5): (y = x, x = y)");
    assert_eq!(shown, "iterate 3 from (%0 = 1.5, %1 = 2.5): (%1, %0)");
}

#[test]
fn whole_first_values_widen_unless_they_count() {
    assert!(value("let a = iterate 3 from (x = 0): (x = x + 0.5)").contains("float!retype(0)"));
    assert!(value("let a = iterate 3 from (x = 0): (x = x + 1)").contains("%0 = 0)"));
    assert!(value("let a = iterate 3 from (x = 1): (x = x / 2)").contains("float!retype(1)"));
}

#[test]
fn mistakes_in_loops() {
    let next = "let a = iterate 3 from (x = 0): (y = 1)";
    assert_eq!(errors(next), ["E0235 `y`: has no first value"]);
    let missing = "let a = iterate 3 from (x = 0, y = 1): (x = 1)";
    assert_eq!(errors(missing), ["E0234 `y`: only the first value is given"]);
    assert_eq!(errors("let a = iterate 2.5 from (x = 0): (x = 1)"), ["E0205 `2.5`: this is a float"]);
    assert_eq!(errors("let a = iterate 3 from (x = 0) while x: (x = 1)"), ["E0205 `x`: this is an int"]);
    let vector = "let a = iterate 3 from (x = 0.5): (x = (1, 2, 3))";
    assert_eq!(errors(vector), ["E0205 `(1, 2, 3)`: this is a vec3"]);
    assert_eq!(message(vector), "expected a float as the next value of `x`, found a vec3");
    assert_eq!(
        errors("let a = iterate 3 from (x = sphere(1)): (x = x)"),
        ["E0236 `sphere(1)`: `x` is a shape"]
    );
    assert_eq!(errors("let a = iterate 3 from (x = 1, x = 2): (x = 1)").len(), 2);
    assert_eq!(errors("fn f() -> float { iterate 3 from (x = 1.5): (x = 2 * x) }").len(), 1);
    let state: Vec<String> = (0..17).map(|i| format!("x{i} = 0")).collect();
    let state = state.join(", ");
    assert_eq!(
        errors(&format!("let a = iterate 3 from ({state}): ({state})")),
        ["E0236 `x16`: one too many"]
    );
}

#[test]
fn keys_hold_one_type_in_order() {
    assert_eq!(value("let a = keys(time, 0s: 1, 2s: 2.5)"), "keys(time, 0: float!retype(1), 2: 2.5, Linear)");
    assert!(value("let a = time.keys(0s: (1, 2, 3), 500ms: (3, 4, 5), ease: smooth)").ends_with("Smooth)"));
    assert!(value("let a = keys(time, 0s: 10deg, 1s: 20deg, ease: hold)").ends_with("Hold)"));
    assert!(value("let a = keys(time, 0s: 1, 1s: 2, ease: u => u * u)").contains("=>"));
    assert_eq!(errors("let a = keys(time, 1s: 1, 1s: 2)"), ["E0233 `1s`: not above the one before"]);
    assert_eq!(errors("let a = keys(time)"), ["E0233 `keys(time)`: no key"]);
    assert_eq!(errors("let a = keys(time, time: 1)"), ["E0228 `time`: not a constant"]);
    assert_eq!(errors("let a = keys(time, 0s: 1, 1s: 45deg)"), ["E0219 `45deg`: this is an angle"]);
    assert_eq!(errors("let a = keys(time, 0s: sphere(1))"), ["E0233 `sphere(1)`: this is a shape"]);
    assert_eq!(errors("let a = keys(45deg, 0s: 1)"), ["E0207 `45deg`: this is an angle"]);
    assert_eq!(help("let a = keys(time, 0s: 1, ease: smoth)"), "did you mean `smooth`");
}

#[test]
fn words_are_names_elsewhere() {
    assert_eq!(
        errors("let smooth = 2\nlet linear = smooth\nlet a = keys(time, 0s: linear, ease: smooth)"),
        [""; 0]
    );
    let medium = |entry: &str| scene_errors(&format!("medium m {{ region: sphere(1), {entry} }}"));
    assert_eq!(medium("lighting: none"), [""; 0]);
    assert_eq!(medium("lighting: dark"), ["E0310 `dark`: no such lighting"]);
    assert_eq!(medium("lighting: none(1)"), ["E0212 `1`: one too many"]);
}

/// Errors of a style beside a light and an object.
fn style(entries: &str) -> Vec<String> {
    scene_errors(&format!(
        "light sun {{ from: (0, 1, 0) }}\nobject tree {{ shape: sphere(1) }}\nstyle s {{ light: sun\n{entries} }}"
    ))
}

#[test]
fn styles_name_blocks_words_and_settings() {
    assert_eq!(style("fill_holes: disk(11)"), [""; 0]);
    assert_eq!(style("fill_holes: epipolar(30, only: [tree])"), [""; 0]);
    assert_eq!(style("fill_holes: disk(11, only: [sun])"), ["E0316 `sun`: another kind"]);
    assert_eq!(style("fill_holes: disk(11, only: [tre])"), ["E0316 `tre`: no such block"]);
    assert_eq!(style("make_holes: { frequency: 0.3, only: [tree], phase: 0.2 * time }"), [""; 0]);
    assert_eq!(style("make_holes: { frequncy: 0.3 }"), ["E0302 `frequncy`: no such key"]);
    assert_eq!(style("make_holes: 3"), ["E0205 `3`: this is an int"]);
    assert_eq!(
        style("transfer: [gradient((0, 0), #fff, (1, 0), #000), solid(#fff, blend: alpha(0.5))]"),
        [""; 0]
    );
    assert_eq!(style("transfer: [diffusion([((0.2, 0.9), #f00), (at: (1, 2, 0), #fff)])]"), [""; 0]);
    assert_eq!(style("transfer: [diffusion([(45deg, #f00)])]"), ["E0207 `45deg`: this is an angle"]);
    assert_eq!(style("transfer: [gradint((0, 0), #fff)]"), ["E0310 `gradint`: no such layer"]);
    assert_eq!(style("transfer: keys(time, 0s: [solid(#fff)], 4s: [solid(#000)])"), [""; 0]);
    assert_eq!(style("transfer: [image(\"mood.png\")]"), [""; 0]);
    let paint =
        "light_map: paint(strokes: [stroke(view: camera, from: (1, 2), to: (3, 4), width: 2, color: #fff)])";
    assert_eq!(style(paint), [""; 0]);
    assert_eq!(style(&paint.replace("camera", "sun")), ["E0310 `sun`: no such view"]);
    assert_eq!(style(&paint.replace("view: camera", "view: view(from: (1, 2, 3), at: (0, 0, 0))")), [""; 0]);
    assert_eq!(style("enhance_silhouettes: 20 + time"), [""; 0]);
    assert_eq!(style("enhance_silhouettes: extrude(20, only: [tree])"), [""; 0]);
    assert_eq!(style("enhance_silhouettes: extrude(20, only: [sun])"), ["E0316 `sun`: another kind"]);
    assert_eq!(style("enhance_silhouettes: #fff"), ["E0205 `#fff`: this is a color"]);
    assert_eq!(style("heterogeneity: { noise: perlin, brushes: [eraser((0, 1, 0), (1, 1, 1))] }"), [""; 0]);
}

#[test]
fn a_style_needs_a_light() {
    assert_eq!(scene_errors("object b { shape: sphere(1) }\nstyle s { shadow_map: 512 }").len(), 1);
    let unknown = "object b { shape: sphere(1) }\nstyle s { light: moon }";
    assert_eq!(scene_errors(unknown), ["E0316 `moon`: no such block"]);
}
