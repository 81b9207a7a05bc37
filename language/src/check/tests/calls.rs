//! Calls: which argument goes where, defaults, forms of library functions, constructors.

use super::support::{errors, help, value};

#[test]
fn form_follows_the_types() {
    assert_eq!(value("let a = sin(1.0)"), "sin#0(1.0)");
    assert_eq!(value("let a = sin(1rad)"), "sin#1(1.000rad)");
    assert_eq!(value("let a = sin(1)"), "sin#0(float!retype(1))");
}

#[test]
fn cheapest_form_wins() {
    assert_eq!(value("let a = mix(0, 1, 0.5)"), "mix#4(float!retype(0), float!retype(1), 0.5)");
    assert_eq!(
        value("let a = mix((0.0, 0.0, 0.0), 1.0, 0.5)"),
        "mix#5(vec3(0.0, 0.0, 0.0), vec3!broadcast(1.0), 0.5)"
    );
    assert!(value("let a = mix(#000000, #ffffff, 0.5)").starts_with("mix#6("));
}

#[test]
fn no_form_fits() {
    let source = "let a = max(sphere(1), 1)";
    assert_eq!(errors(source), ["E0216 `max`: called with (shape, int)"]);
    assert_eq!(
        help(source),
        "the forms are `max(a: float, b: float) -> float`, `max(a: vec3, b: vec3) -> vec3`"
    );
}

#[test]
fn defaults_are_written_out() {
    assert_eq!(value("let a = fbm((0.0, 0.0, 0.0))"), "fbm#10(vec3(0.0, 0.0, 0.0), 4, 2.0)");
}

#[test]
fn named_arguments_go_to_their_places() {
    assert_eq!(
        value("let a = fbm(lacunarity: 3.0, p: (0.0, 0.0, 0.0))"),
        "fbm#10(vec3(0.0, 0.0, 0.0), 4, 3.0)"
    );
}

#[test]
fn default_of_a_color_broadcasts() {
    assert_eq!(value("let a = tint()"), "tint#22(color!broadcast(1.0))");
}

#[test]
fn defaults_of_functions_and_truth_values() {
    let text = value("let c = bezier((0,0,0), (0,1,0), (0,2,0))\nlet a = tube(c, t => t)");
    assert_eq!(text, "tube#20(c, (%0) => %0, (float, float) -> angle!constant(0.000rad), true)");
}

#[test]
fn rest_takes_arguments_or_one_list() {
    let lets = "let s = sphere(1)\nlet list = [s, s]\n";
    assert_eq!(value(&format!("{lets}let a = union(s, s, smooth: 0.1)")), "union#16([s, s], 0.1)");
    assert_eq!(value(&format!("{lets}let a = union([s, s])")), "union#16([s, s], 0.0)");
    assert_eq!(value(&format!("{lets}let a = union(list)")), "union#16(list, 0.0)");
    assert_eq!(value(&format!("{lets}let a = list.union()")), "union#16(list, 0.0)");
    assert_eq!(value(&format!("{lets}let a = union(s)")), "union#16([s], 0.0)");
}

#[test]
fn rest_elements_are_checked() {
    assert_eq!(errors("let a = union(sphere(1), 2)"), ["E0205 `2`: this is an int"]);
}

#[test]
fn method_is_a_call() {
    assert_eq!(
        value("let a = sphere(1.0).rotate_y(1rad).translate((0.0, 1.0, 0.0))"),
        "translate#14(rotate_y#13(sphere#11(1.0), 1.000rad), vec3(0.0, 1.0, 0.0))"
    );
    assert_eq!(value("fn twice(x: float) -> float { 2.0 * x } let a = (1.0).twice()"), "twice(1.0)");
}

#[test]
fn missing_argument() {
    let source = "let a = bezier((0, 0, 0))";
    assert_eq!(errors(source), ["E0211 `bezier`: `b` and `c` are missing"]);
    assert_eq!(help(source), "the form is `bezier(a: vec3, b: vec3, c: vec3) -> curve`");
}

#[test]
fn too_many_arguments() {
    assert_eq!(errors("let a = sphere(1, 2)"), ["E0212 `2`: one too many"]);
}

#[test]
fn unknown_argument() {
    let source = "let a = sphere(raduis: 1)";
    assert_eq!(errors(source), ["E0213 `raduis`: this name is not known here"]);
    assert_eq!(help(source), "did you mean `radius:`; the form is `sphere(radius: float) -> shape`");
}

#[test]
fn argument_given_twice() {
    assert_eq!(errors("let a = sphere(1, radius: 2)"), ["E0214 `radius`: given again here"]);
}

#[test]
fn unnamed_after_named() {
    assert_eq!(errors("let a = fbm(p: (0, 0, 0), 4)"), ["E0215 `4`: this one has no name"]);
}

#[test]
fn unknown_function() {
    let source = "let a = shpere(1)";
    assert_eq!(errors(source), ["E0201 `shpere`: no such function"]);
    assert_eq!(help(source), "did you mean `sphere`");
    assert_eq!(errors("let a = sphere(1).rotat_y(1)"), ["E0201 `rotat_y`: no such function"]);
}

#[test]
fn arguments_of_a_wrong_call_are_checked() {
    assert_eq!(
        errors("let a = shpere(nix)"),
        ["E0201 `shpere`: no such function", "E0201 `nix`: no such name"]
    );
}

#[test]
fn wrong_argument_is_reported_once() {
    assert_eq!(errors("let a = mix(nix, 1, 0.5) + (1, 2)"), ["E0201 `nix`: no such name"]);
}

#[test]
fn other_arguments_beside_a_wrong_one_are_checked() {
    assert_eq!(
        errors("let a = nix.rotate_y(3)"),
        ["E0201 `nix`: no such name", "E0206 `3`: this number has no unit"]
    );
    assert_eq!(errors("let a = max(nix, sphere(1))"), ["E0201 `nix`: no such name"]);
}

#[test]
fn value_is_no_function() {
    assert_eq!(errors("let k = 1 let a = k(2)"), ["E0210 `k`: called here"]);
    assert_eq!(errors("let a = pi(2)"), ["E0210 `pi`: called here"]);
}

#[test]
fn local_does_not_hide_a_library_function() {
    assert_eq!(value("let a = { let sin = 1.0  sin(sin) }"), "{ %0 = 1.0; sin#0(%0) }");
}

#[test]
fn users_function_with_default() {
    let function = "fn f(a: float, b: vec3 = 1) -> vec3 { a * b }\n";
    assert_eq!(
        value(&format!("{function}let x = f(2)")),
        "f(float!retype(2), vec3!broadcast(float!retype(1)))"
    );
    assert_eq!(
        value(&format!("{function}let x = f(b: (1.0, 2.0, 3.0), a: 1.0)")),
        "f(1.0, vec3(1.0, 2.0, 3.0))"
    );
}

#[test]
fn users_function_with_wrong_arguments() {
    let function = "fn f(a: float, b: vec3 = 1) -> vec3 { a * b }\n";
    assert_eq!(errors(&format!("{function}let x = f()")), ["E0211 `f`: `a` is missing"]);
    assert_eq!(help(&format!("{function}let x = f()")), "the form is `f(a: float, b: vec3 = …) -> vec3`");
    assert_eq!(errors(&format!("{function}let x = f(true)")), ["E0205 `true`: this is a bool"]);
    assert_eq!(errors(&format!("{function}let x = f(c: 1)")), ["E0213 `c`: this name is not known here"]);
}

#[test]
fn vectors_from_parts() {
    assert_eq!(value("let a = vec3(1.0)"), "vec3!broadcast(1.0)");
    assert_eq!(value("let a = vec3(1.0, 2.0, 3.0)"), "vec3(1.0, 2.0, 3.0)");
    assert_eq!(value("let a = vec3((1.0, 2.0), 3.0)"), "vec3(vec2(1.0, 2.0), 3.0)");
    assert_eq!(value("let a = rgb(1, 0.5, 0.0)"), "color(float!retype(1), 0.5, 0.0)");
    assert_eq!(value("let a = rgb((1.0, 0.5, 0.0))"), "color!retype(vec3(1.0, 0.5, 0.0))");
    assert_eq!(value("let a = float(1)"), "float!retype(1)");
}

#[test]
fn vectors_from_wrong_parts() {
    assert_eq!(errors("let a = vec3(1, 2)"), ["E0227 `vec3`: 2 components"]);
    assert_eq!(errors("let a = vec2((1, 2, 3))"), ["E0227 `vec2`: 3 components"]);
    assert_eq!(errors("let a = vec2(1, true)"), ["E0205 `true`: this is a bool"]);
    assert_eq!(errors("let a = float(1deg)"), ["E0207 `1deg`: this is an angle"]);
    assert_eq!(errors("let a = vec2(x: 1, y: 2)"), ["E0213 `x`: this name is not known here"]);
    assert_eq!(errors("let a = vec3()"), ["E0227 `vec3`: 0 components"]);
}
