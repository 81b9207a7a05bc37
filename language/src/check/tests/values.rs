//! Names, fields, tuples, lists, comprehensions, `if` and blocks.

use super::support::{errors, help, message, scene, show, value, warnings};

#[test]
fn built_in_values() {
    assert_eq!(value("let a = time + frame"), "(time + float!retype(frame)):float");
    assert_eq!(value("let a = pi"), format!("{:?}", std::f64::consts::PI));
}

#[test]
fn unknown_name_shows_the_nearest() {
    let source = "let spine = 1 let a = spnie";
    assert_eq!(errors(source), ["E0201 `spnie`: no such name"]);
    assert_eq!(help(source), "did you mean `spine`");
    assert_eq!(help("let a = zzzzzz"), "define it: `let zzzzzz = …`");
}

#[test]
fn function_name_is_no_value() {
    let source = "let a = sphere";
    assert_eq!(errors(source), ["E0217 `sphere`: not called"]);
    assert_eq!(help(source), "call it; its form is `sphere(radius: float) -> shape`");
}

#[test]
fn swizzles() {
    assert_eq!(value("let v = (1, 2, 3) let a = v.y"), "v.[1]:float");
    assert_eq!(value("let v = (1, 2, 3) let a = v.zx"), "v.[2, 0]:vec2");
    assert_eq!(value("let v = (1, 2) let a = v.xxyy"), "v.[0, 0, 1, 1]:vec4");
    assert_eq!(value("let c = #000000 let a = c.bgr"), "c.[2, 1, 0]:color");
    assert_eq!(value("let c = #000000 let a = c.g"), "c.[1]:float");
}

#[test]
fn missing_component() {
    let source = "let v = (1, 2) let a = v.z";
    assert_eq!(errors(source), ["E0209 `z`: no such field"]);
    assert_eq!(help(source), "it has `.x`, `.y`, and up to four of these letters together");
    assert_eq!(errors("let c = #000000 let a = c.rx"), ["E0209 `rx`: no such field"]);
    assert_eq!(errors("let v = (1, 2) let a = v.xxxxx"), ["E0209 `xxxxx`: no such field"]);
}

#[test]
fn field_that_is_a_function() {
    assert_eq!(help("let v = (1, 2, 3) let a = v.length"), "call it: `.length(…)`");
    assert_eq!(errors("let v = 1 let a = v.foo"), ["E0209 `foo`: no such field"]);
}

#[test]
fn fields_of_the_local_point() {
    let scene = scene("fn f(q: local) -> float { q.local.x + q.t + q.angle / 1rad }");
    assert_eq!(
        show(&scene, scene.functions[0].body),
        "((%0.Local.[0]:float + %0.T):float + (%0.Angle / 1.000rad):float):float"
    );
}

#[test]
fn unknown_field_of_the_local_point() {
    let source = "fn f(q: local) -> float { q.radus }";
    assert_eq!(errors(source), ["E0209 `radus`: no such field"]);
    assert_eq!(help(source), "did you mean `radius`");
}

#[test]
fn tuples_are_vectors() {
    assert_eq!(value("let a = (1, time)"), "vec2(float!retype(1), time)");
    assert_eq!(value("let a = (0.0, 1.0, 2.0, 3.0)"), "vec4(0.0, 1.0, 2.0, 3.0)");
}

#[test]
fn tuples_hold_numbers() {
    let source = "let a = ((1, 2), 3)";
    assert_eq!(errors(source), ["E0205 `(1, 2)`: this is a vec2"]);
    assert_eq!(errors("let a = (1, true)"), ["E0205 `true`: this is a bool"]);
    assert_eq!(errors("let a = (1, 20deg)"), ["E0207 `20deg`: this is an angle"]);
}

#[test]
fn list_takes_the_more_general_type() {
    assert_eq!(value("let a = [1, 2.0]"), "[float!retype(1), 2.0]");
    assert_eq!(value("let a = [1.0, (1.0, 2.0, 3.0)]"), "[vec3!broadcast(1.0), vec3(1.0, 2.0, 3.0)]");
}

#[test]
fn list_of_different_types() {
    assert_eq!(errors("let a = [1, sphere(1)]"), ["E0219 `sphere(1)`: this is a shape"]);
}

#[test]
fn empty_list() {
    assert_eq!(errors("let a = []"), ["E0220 `[]`: empty list"]);
    assert_eq!(value("let a = path([])"), "path#18([])");
}

#[test]
fn comprehension_over_range_and_list() {
    assert_eq!(value("let a = [for i in 0..3: i * 2]"), "[for %0 in 0..3: (%0 * 2):int]");
    assert_eq!(
        value("let xs = [1.0, 2.0] let a = [for x in xs: sphere(x)]"),
        "[for %0 in xs: sphere#11(%0)]"
    );
}

#[test]
fn range_has_whole_ends() {
    assert_eq!(errors("let a = [for i in 0..2.5: i]"), ["E0205 `2.5`: this is a float"]);
}

#[test]
fn comprehension_over_a_number() {
    let source = "let n = 3 let a = [for i in n: i]";
    assert_eq!(errors(source), ["E0231 `n`: this is an int"]);
    assert_eq!(help(source), "write `0..n`");
}

#[test]
fn if_joins_its_branches() {
    assert_eq!(value("let a = if true then 1 else 2.0"), "if true then float!retype(1) else 2.0");
}

#[test]
fn if_with_branches_that_differ() {
    assert_eq!(errors("let a = if true then 1 else sphere(1)"), ["E0219 `sphere(1)`: this is a shape"]);
}

#[test]
fn condition_is_a_truth_value() {
    let source = "let n = 1 let a = if n then 1 else 2";
    assert_eq!(errors(source), ["E0205 `n`: this is an int"]);
    assert_eq!(help(source), "compare it: `n > 0`");
}

#[test]
fn block_binds() {
    assert_eq!(
        value("let a = { let b = 1  let c = b + 1  c * b }"),
        "{ %0 = 1; %1 = (%0 + 1):int; (%1 * %0):int }"
    );
}

#[test]
fn block_binding_ends_with_the_block() {
    assert_eq!(errors("let a = { let bb = 1  bb } let c = bb"), ["E0201 `bb`: no such name"]);
}

#[test]
fn block_binds_no_name_twice() {
    assert_eq!(errors("let a = { let b = 1  let b = 2  b }"), ["E0202 `b`: defined again here"]);
}

#[test]
fn inner_block_may_hide_an_outer_name() {
    assert_eq!(errors("let b = 1 let a = { let b = 2  { let b = b + 1  b } } + b"), [""; 0]);
}

#[test]
fn built_in_values_cannot_be_bound() {
    assert_eq!(errors("let a = { let time = 1  time }"), ["E0203 `time`: this name is taken"]);
}

#[test]
fn unused_binding_warns() {
    assert_eq!(warnings("let _a = { let b = 1  let _c = 2  3 }"), ["W0104 `b`: never used"]);
}

#[test]
fn record_is_no_value() {
    assert_eq!(errors("let a = { b: 1 }"), ["E0222 `{ b: 1 }`: no value"]);
}

#[test]
fn numbers_have_limits() {
    assert_eq!(errors("let a = 16777217"), ["E0224 `16777217`: too large"]);
    assert_eq!(errors("let a = 16777216 + 1"), ["E0224 `16777216 + 1`: too large"]);
    assert_eq!(errors("let a = 16777216 + 1.0"), [""; 0]);
}

#[test]
fn all_mistakes_come_in_one_run() {
    let source = "let a = nix\nlet b = 1 + sphere(1)\nfn f(x: flot) -> float { x.y }\nlet c = sphere(nax)";
    assert_eq!(
        errors(source),
        [
            "E0201 `nix`: no such name",
            "E0208 `1`: this is an int",
            "E0204 `flot`: no such type",
            "E0201 `nax`: no such name"
        ]
    );
    assert_eq!(message(source), "`nix` is not defined");
}
