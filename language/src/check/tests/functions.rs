//! Function values: lambdas, names of functions, functions with fewer parameters.

use super::support::{errors, help, scene, show, value};

const CURVE: &str = "let c = bezier((0,0,0), (0,1,0), (0,2,0))\n";

fn radius(items: &str, argument: &str) -> String {
    value(&format!("{CURVE}{items}\nlet a = tube(c, radius: {argument})"))
}

#[test]
fn lambda_takes_its_types_from_the_place() {
    let text = radius("", "(t, l) => t * l");
    assert!(text.starts_with("tube#20(c, (%0, %1) => (%0 * %1):float, "), "{text}");
}

#[test]
fn lambda_may_ignore_the_last_parameters() {
    let text = radius("", "t => 1");
    assert!(text.starts_with("tube#20(c, (%0) => float!retype(1), "), "{text}");
}

#[test]
fn lambda_with_too_many_parameters() {
    let source = format!("{CURVE}let a = tube(c, radius: (t, l, m) => t)");
    assert_eq!(errors(&source), ["E0218 `m`: only 2 values come in"]);
}

#[test]
fn lambda_binds_no_name_twice() {
    let source = format!("{CURVE}let a = tube(c, radius: (t, t) => t)");
    assert_eq!(errors(&source), ["E0202 `t`: defined again here"]);
}

#[test]
fn lambda_without_a_place_for_it() {
    assert_eq!(errors("let a = t => t"), ["E0217 `t => t`: the types of its parameters are unknown"]);
    assert_eq!(errors("let a = sphere(t => t)"), ["E0217 `t => t`: this is a function"]);
}

#[test]
fn lambda_body_is_checked() {
    let source = format!("{CURVE}let a = tube(c, radius: t => sphere(t))");
    assert_eq!(errors(&source), ["E0205 `sphere(t)`: this is a shape"]);
}

#[test]
fn name_of_a_users_function() {
    let text = radius("fn r(t: float) -> float { t }", "r");
    assert!(text.starts_with("tube#20(c, (%1) => r(%1), "), "{text}");
}

#[test]
fn name_of_a_users_function_with_defaults() {
    let text = radius("fn r(t: float, k: float = 2.0) -> float { t * k }", "r");
    assert!(text.starts_with("tube#20(c, (%2) => r(%2, 2.0), "), "{text}");
}

#[test]
fn name_of_a_users_function_that_returns_int() {
    let text = radius("fn r(_t: float) -> int { 1 }", "r");
    assert!(text.starts_with("tube#20(c, (%1) => float!retype(r(%1)), "), "{text}");
}

#[test]
fn name_of_a_users_function_that_does_not_fit() {
    let source = format!("fn r(t: shape) -> shape {{ t }}\n{CURVE}let a = tube(c, radius: r)");
    assert_eq!(errors(&source)[0], "E0205 `r`: this function does not fit");
}

#[test]
fn name_of_a_library_function_takes_the_fitting_form() {
    let text = radius("", "sin");
    assert!(text.starts_with("tube#20(c, (%0) => sin#0(%0), "), "{text}");
}

#[test]
fn function_of_a_point_is_called_with_the_local_coordinates() {
    let scene = scene(
        "fn d(p: vec3) -> float { p.x }\nmedium m { region: sphere(1), density: d, scatter: fbm, absorb: d }",
    );
    let block = &scene.blocks[0];
    assert_eq!(show(&scene, block.entry("density").expect("given")), "(%1) => d(%1.Local)");
    let scatter = show(&scene, block.entry("scatter").expect("given"));
    assert_eq!(scatter, "(%2) => color!broadcast(fbm#10(%2.local, 4, 2.0))");
}

#[test]
fn function_parameter_is_called_and_passed_on() {
    let scene = scene(
        "fn twice(f: (float) -> float, x: float) -> float { f(f(x)) }\nfn g(f: (float) -> float) -> float { twice(f, 1.0) }",
    );
    assert_eq!(show(&scene, scene.functions[0].body), "%0(%0(%1))");
    assert_eq!(show(&scene, scene.functions[1].body), "twice(%2, 1.0)");
}

#[test]
fn function_parameter_is_adapted() {
    let scene = scene("fn g(c: curve, f: (float) -> int) -> shape { tube(c, f) }");
    let text = show(&scene, scene.functions[0].body);
    assert!(text.starts_with("tube#20(%0, (%2) => float!retype(%1(%2)), "), "{text}");
}

#[test]
fn function_value_takes_all_its_arguments() {
    let source = "fn g(f: (float, float) -> float) -> float { f(1.0) }";
    assert_eq!(errors(source), ["E0211 `f`: called here"]);
    assert_eq!(help(source), "the function is `(float, float) -> float`");
    let source = "fn g(f: (float) -> float) -> float { f(x: 1.0) }";
    assert_eq!(errors(source), ["E0213 `x`: a name is given here"]);
}

#[test]
fn function_may_be_chosen_by_if() {
    let text = radius("", "if true then t => t else 2");
    assert!(
        text.starts_with(
            "tube#20(c, if true then (%0) => %0 else (float, float) -> float!constant(float!retype(2)), "
        ),
        "{text}"
    );
}

#[test]
fn number_chosen_by_if_is_one_constant() {
    let text = radius("", "if true then 1.0 else 2.0");
    assert!(
        text.starts_with("tube#20(c, (float, float) -> float!constant(if true then 1.0 else 2.0), "),
        "{text}"
    );
}
