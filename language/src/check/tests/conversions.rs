//! Conversions, and values that no conversion helps.

use super::support::{errors, help, message, scene, show, value};

#[test]
fn int_widens_to_float() {
    assert_eq!(value("let a = sphere(1)"), "sphere#11(float!retype(1))");
}

#[test]
fn float_broadcasts_over_vec3() {
    assert_eq!(value("let a = box(0.5)"), "box#12(vec3!broadcast(0.5))");
}

#[test]
fn int_widens_then_broadcasts() {
    assert_eq!(value("let a = box(2)"), "box#12(vec3!broadcast(float!retype(2)))");
}

#[test]
fn vec3_turns_into_color() {
    assert_eq!(value("let a = diffuse((1.0, 0.5, 0.0))"), "diffuse#21(color!retype(vec3(1.0, 0.5, 0.0)))");
}

#[test]
fn color_turns_into_vec3() {
    assert_eq!(value("let a = length(#000000)"), "length#9(vec3!retype(rgb(0.0000, 0.0000, 0.0000)))");
}

#[test]
fn value_becomes_constant_function() {
    let text = value("let c = bezier((0,0,0), (0,1,0), (0,2,0))\nlet a = tube(c, 0.5)");
    assert!(text.starts_with("tube#20(c, (float, float) -> float!constant(0.5), "), "{text}");
}

#[test]
fn list_converts_element_by_element() {
    assert_eq!(value("let a = knots([1, 2.5])"), "knots#19([float!retype(1), 2.5])");
    assert_eq!(value("let a = knots([1, 2])"), "knots#19([float!retype(1), float!retype(2)])");
}

#[test]
fn comprehension_converts_its_body() {
    assert_eq!(value("let a = knots([for i in 0..3: i])"), "knots#19([for %0 in 0..3: float!retype(%0)])");
}

#[test]
fn named_list_converts_by_walking() {
    assert_eq!(value("let xs = [1, 2]\nlet a = knots(xs)"), "knots#19([for %0 in xs: float!retype(%0)])");
}

#[test]
fn srgb_turns_linear() {
    assert_eq!(value("let a = #ff8000"), "rgb(1.0000, 0.2159, 0.0000)");
    assert_eq!(value("let a = #0a0b00"), "rgb(0.0030, 0.0033, 0.0000)");
}

#[test]
fn bare_literal_for_angle_shows_its_own_digits() {
    let source = "let a = sphere(1).rotate_y(45)";
    assert_eq!(errors(source), ["E0206 `45`: this number has no unit"]);
    assert_eq!(message(source), "expected an angle for `angle` of `rotate_y`, found a bare number");
    assert_eq!(help(source), "write `45deg`, or `45rad` for radians");
    assert_eq!(help("let a = sphere(1).rotate_y(-0.5)"), "write `-0.5deg`, or `-0.5rad` for radians");
}

#[test]
fn bare_name_for_angle_shows_a_product() {
    assert_eq!(
        help("let k = 2 let a = sphere(1).rotate_y(k)"),
        "write `k * 1deg`, or `k * 1rad` for radians"
    );
    assert_eq!(help("let a = sphere(1).rotate_y(pi)"), "write `pi * 1deg`, or `pi * 1rad` for radians");
    assert_eq!(
        help("let k = 2 let a = sphere(1).rotate_y(k + 1)"),
        "multiply by a unit: `(…) * 1deg`, or `(…) * 1rad` for radians"
    );
}

#[test]
fn angle_for_number_shows_a_quotient() {
    let source = "let k = 20deg let a = sphere(k)";
    assert_eq!(errors(source), ["E0207 `k`: this is an angle"]);
    assert_eq!(help(source), "write `k / 1rad` for radians, or `k / 1deg` for degrees");
}

#[test]
fn bare_number_in_a_function_to_angle() {
    let source = "let c = bezier((0,0,0), (0,1,0), (0,2,0))\nlet a = tube(c, 0.5, twist: t => 3 * t)";
    assert_eq!(errors(source), ["E0206 `3 * t`: this number has no unit"]);
    let source = "let c = bezier((0,0,0), (0,1,0), (0,2,0))\nlet a = tube(c, 0.5, twist: 3)";
    assert_eq!(errors(source), ["E0206 `3`: this number has no unit"]);
}

#[test]
fn float_is_no_int() {
    let source = "let a = fbm((0, 0, 0), 3.0)";
    assert_eq!(errors(source), ["E0205 `3.0`: this is a float"]);
    assert_eq!(help(source), "write `3`");
}

#[test]
fn vector_for_number_takes_a_component() {
    let source = "let v = (1, 2, 3) let a = sphere(v)";
    assert_eq!(errors(source), ["E0205 `v`: this is a vec3"]);
    assert_eq!(help(source), "take one component: `v.x`");
}

#[test]
fn shape_is_no_number() {
    let source = "let a = sphere(sphere(1))";
    assert_eq!(errors(source), ["E0205 `sphere(1)`: this is a shape"]);
    assert_eq!(message(source), "expected a float for `radius` of `sphere`, found a shape");
}

#[test]
fn if_converts_inside_its_branches() {
    let scene = scene("fn f(b: bool) -> color { if b then 1 else (1.0, 0.0, 0.0) }");
    assert_eq!(
        show(&scene, scene.functions[0].body),
        "if %0 then color!broadcast(float!retype(1)) else color!retype(vec3(1.0, 0.0, 0.0))"
    );
}
