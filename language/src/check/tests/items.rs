//! Items: order, cycles, duplicates, params, types.

use super::support::{errors, help, message, scene, warnings};

fn names(names: impl Iterator<Item = impl AsRef<str>>) -> String {
    names.map(|name| name.as_ref().to_owned()).collect::<Vec<_>>().join(" ")
}

#[test]
fn items_may_stand_in_any_order() {
    let scene = scene("let a = f(b)\nfn f(x: int) -> int { g(x) }\nlet b = 1\nfn g(x: int) -> int { x + b }");
    assert_eq!(names(scene.lets.iter().map(|item| &item.name)), "b a");
    assert_eq!(names(scene.functions.iter().map(|item| &item.name)), "g f");
}

#[test]
fn hidden_name_is_no_dependency() {
    assert_eq!(errors("let a = { let b = 1  b }\nlet b = a"), [""; 0]);
    assert_eq!(errors("fn f(g: float) -> float { g }\nfn g(x: float) -> float { f(x) }"), [""; 0]);
}

#[test]
fn function_cannot_call_itself() {
    let source = "fn f(x: float) -> float { f(x) + f(x) }";
    assert_eq!(errors(source), ["E0223 `f`: `f` calls `f` here"]);
    assert_eq!(message(source), "the function `f` calls itself");
}

#[test]
fn cycle_of_functions() {
    let source = "fn f(x: float) -> float { x.g() }\nfn g(x: float) -> float { f(x) }";
    assert_eq!(errors(source), ["E0223 `g`: `f` calls `g` here"]);
}

#[test]
fn cycle_of_lets() {
    assert_eq!(errors("let a = b + 1\nlet b = a"), ["E0223 `b`: `a` uses `b` here"]);
    assert_eq!(errors("let a = a"), ["E0223 `a`: `a` uses `a` here"]);
}

#[test]
fn two_cycles_are_two_errors() {
    assert_eq!(errors("let a = a\nlet b = b").len(), 2);
}

#[test]
fn name_defined_twice() {
    let source = "let a = 1\nfn a() -> int { 2 }\nlet b = a + nix";
    assert_eq!(errors(source), ["E0202 `a`: defined again here", "E0201 `nix`: no such name"]);
}

#[test]
fn built_in_name_defined_anew() {
    assert_eq!(errors("fn sin(x: float) -> float { x }"), ["E0203 `sin`: this name is taken"]);
    assert_eq!(errors("fn vec3() -> int { 2 }"), ["E0203 `vec3`: this name is taken"]);
    assert_eq!(errors("param time: float = 1"), ["E0203 `time`: this name is taken"]);
}

#[test]
fn a_value_does_not_hide_a_function_of_its_name() {
    assert_eq!(errors("let sin = 1\nlet a = sin * sin(2.0)"), [""; 0]);
    assert_eq!(errors("param max: float = 1\nlet a = max(max, 0.5)"), [""; 0]);
    // A value that can be called does.
    assert_eq!(errors("let a = max(1, 2)\nlet b = a(1)").len(), 1);
}

#[test]
fn unknown_type() {
    let source = "fn f(x: flaot) -> float { x }";
    assert_eq!(errors(source), ["E0204 `flaot`: no such type"]);
    assert_eq!(help(source), "did you mean `float`");
}

#[test]
fn parameter_defined_twice() {
    assert_eq!(errors("fn f(x: float, x: float) -> float { x }"), ["E0202 `x`: defined again here"]);
}

#[test]
fn result_has_the_declared_type() {
    let source = "fn f() -> angle { 45 }";
    assert_eq!(errors(source), ["E0206 `45`: this number has no unit"]);
    assert_eq!(message(source), "expected an angle as the result of `f`, found a bare number");
}

#[test]
fn default_sees_no_parameters() {
    assert_eq!(errors("fn f(xx: float, y: float = xx) -> float { xx + y }"), ["E0201 `xx`: no such name"]);
}

#[test]
fn param_of_each_type() {
    let scene = scene(
        "param b: bool = true\nparam i: int = 3 in 1..8\nparam f: float = 2 * 3 in 0..10\nparam a: angle = 180deg in 0deg..1turn\nparam v: vec2 = (1, 2)\nparam c: color = 0.5\n",
    );
    let defaults: Vec<Vec<f64>> = scene.params.iter().map(|param| param.default.clone()).collect();
    let pi = std::f64::consts::PI;
    let expected = [vec![1.0], vec![3.0], vec![6.0], vec![pi], vec![1.0, 2.0], vec![0.5, 0.5, 0.5]].to_vec();
    assert_eq!(defaults, expected);
    let ranges: Vec<_> = scene.params.iter().map(|param| param.range).collect();
    assert_eq!(ranges, [None, Some((1.0, 8.0)), Some((0.0, 10.0)), Some((0.0, 2.0 * pi)), None, None]);
}

#[test]
fn param_keeps_its_doc() {
    assert_eq!(scene("/// How many.\nparam n: int = 3").params[0].doc, "How many.");
}

#[test]
fn param_default_may_be_a_constant_let() {
    assert_eq!(scene("let k = 2 * pi\nparam f: float = k").params[0].default, [2.0 * std::f64::consts::PI]);
}

#[test]
fn param_default_is_constant() {
    assert_eq!(errors("param f: float = time"), ["E0228 `time`: not a constant"]);
    assert_eq!(errors("param f: float = 1 in 0..sin(1)"), ["E0228 `sin(1)`: not a constant"]);
}

#[test]
fn param_default_lies_in_its_range() {
    assert_eq!(errors("param f: float = 2 in 0..1"), ["E0229 `2`: above the range"]);
    assert_eq!(errors("param f: float = -1 in 0..1"), ["E0229 `-1`: below the range"]);
}

#[test]
fn param_range_is_not_empty() {
    assert_eq!(errors("param f: float = 1 in 2..0"), ["E0229 `2..0`: the first end is above the second"]);
}

#[test]
fn param_of_a_scene_type() {
    assert_eq!(errors("param s: shape = sphere(1)"), ["E0230 `shape`: cannot be set from outside"]);
}

#[test]
fn param_range_of_a_vector() {
    assert_eq!(errors("param v: vec2 = (1, 2) in 0..1"), ["E0230 `0..1`: a range stands here"]);
}

#[test]
fn param_of_angle_wants_units() {
    assert_eq!(
        errors("param a: angle = 45 in 0..90"),
        [
            "E0206 `45`: this number has no unit",
            "E0206 `0`: this number has no unit",
            "E0206 `90`: this number has no unit"
        ]
    );
}

#[test]
fn unused_items_warn() {
    assert_eq!(
        warnings("let a = 1\nlet _b = 2\nparam c: int = 1\nfn f(x: float, _y: float) -> float { 1 }"),
        ["W0103 `x`: never used", "W0101 `a`: never used", "W0102 `c`: never used"]
    );
}
