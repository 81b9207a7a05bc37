//! Operators: the type rules one by one, and what they refuse.

use super::support::{errors, help, value};

#[test]
fn int_arithmetic_stays_int() {
    assert_eq!(value("let a = 7 % 2 * 3 - 1"), "(((7 % 2):int * 3):int - 1):int");
}

#[test]
fn int_division_is_float() {
    assert_eq!(value("let a = 7 / 2"), "(float!retype(7) / float!retype(2)):float");
}

#[test]
fn int_and_float_give_float() {
    assert_eq!(value("let a = 1 + 0.5"), "(float!retype(1) + 0.5):float");
}

#[test]
fn scalar_broadcasts_over_vector() {
    assert_eq!(value("let a = 2 * (1.0, 2.0)"), "(vec2!broadcast(float!retype(2)) * vec2(1.0, 2.0)):vec2");
    assert_eq!(value("let a = (1.0, 2.0) / 2.0"), "(vec2(1.0, 2.0) / vec2!broadcast(2.0)):vec2");
}

#[test]
fn vec3_and_color_give_color() {
    assert_eq!(
        value("let a = (1.0, 2.0, 3.0) * #000000"),
        "(color!retype(vec3(1.0, 2.0, 3.0)) * rgb(0.0000, 0.0000, 0.0000)):color"
    );
}

#[test]
fn modulo_of_vectors() {
    assert_eq!(value("let a = (1.0, 2.0) % 2.0"), "(vec2(1.0, 2.0) % vec2!broadcast(2.0)):vec2");
}

#[test]
fn angle_and_number_keep_their_types() {
    assert_eq!(value("let a = 1rad * 2"), "(1.000rad * float!retype(2)):angle");
    assert_eq!(value("let a = 0.5 * 1rad"), "(0.5 * 1.000rad):angle");
    assert_eq!(value("let a = 1rad / 2.0"), "(1.000rad / 2.0):angle");
}

#[test]
fn angles_among_themselves() {
    assert_eq!(value("let a = 1rad / 2rad"), "(1.000rad / 2.000rad):float");
    assert_eq!(value("let a = 1rad + 2rad - 3rad"), "((1.000rad + 2.000rad):angle - 3.000rad):angle");
    assert_eq!(value("let a = 3rad % 2rad"), "(3.000rad % 2.000rad):angle");
}

#[test]
fn comparisons_give_bool() {
    assert_eq!(value("let a = 1 < 2"), "(1 < 2):bool");
    assert_eq!(value("let a = 1 <= 2.0"), "(float!retype(1) <= 2.0):bool");
    assert_eq!(value("let a = 1rad == 2rad"), "(1.000rad == 2.000rad):bool");
    assert_eq!(value("let a = true != false"), "(true != false):bool");
}

#[test]
fn logic() {
    assert_eq!(value("let a = true && !false || false"), "((true && Not(false)):bool || false):bool");
}

#[test]
fn shapes_combine() {
    let text = value("let s = sphere(1)\nlet a = s | s & s - s");
    assert_eq!(text, "(s | (s & (s - s):shape):shape):shape");
}

#[test]
fn minus_of_numbers_angles_and_vectors() {
    assert_eq!(value("let a = -1"), "Negate(1)");
    assert_eq!(value("let a = -(1rad)"), "Negate(1.000rad)");
    assert_eq!(value("let a = -(1.0, 2.0)"), "Negate(vec2(1.0, 2.0))");
}

#[test]
fn angle_plus_number_is_refused() {
    let source = "let a = 10deg + 1";
    assert_eq!(errors(source), ["E0206 `1`: this number has no unit"]);
    assert_eq!(help(source), "write `1deg`, or `1rad` for radians");
    assert_eq!(errors("let a = 1 < 10deg"), ["E0206 `1`: this number has no unit"]);
}

#[test]
fn angle_times_angle_is_refused() {
    let source = "let k = 1rad let a = k * k";
    assert_eq!(errors(source), ["E0208 `k`: this is an angle"]);
    assert_eq!(help(source), "write `k / 1rad` for radians, or `k / 1deg` for degrees");
    assert_eq!(errors("let k = 1rad let a = 1 / k"), ["E0208 `1`: this is an int"]);
    assert_eq!(errors("let k = 1rad let a = (1, 2) * k"), ["E0208 `(1, 2)`: this is a vec2"]);
}

#[test]
fn vectors_of_different_length_are_refused() {
    assert_eq!(errors("let a = (1, 2) + (1, 2, 3)"), ["E0208 `(1, 2)`: this is a vec2"]);
}

#[test]
fn shapes_are_not_added() {
    let source = "let s = sphere(1) let a = s + s";
    assert_eq!(errors(source), ["E0208 `s`: this is a shape"]);
    assert_eq!(help(source), "write `a | b`");
    assert_eq!(help("let a = true | false"), "write `a || b`");
}

#[test]
fn vectors_are_not_compared() {
    assert_eq!(errors("let a = (1, 2) < (2, 1)"), ["E0208 `(1, 2)`: this is a vec2"]);
}

#[test]
fn not_of_a_number_is_refused() {
    assert_eq!(errors("let a = !1"), ["E0208 `1`: this is an int"]);
    assert_eq!(errors("let a = -true"), ["E0208 `true`: this is a bool"]);
}

#[test]
fn division_by_literal_zero() {
    assert_eq!(errors("let a = 1 / 0"), ["E0225 `0`: this is 0"]);
    assert_eq!(errors("let a = 1 % 0.0"), ["E0225 `0.0`: this is 0"]);
    assert_eq!(errors("let a = 1 / (2 - 2)"), ["E0225 `(2 - 2)`: this is 0"]);
    assert_eq!(errors("let k = 0 let a = 1 / k"), ["E0225 `k`: this is 0"]);
    assert_eq!(errors("let a = 1rad / 0deg"), ["E0225 `0deg`: this is 0"]);
}

#[test]
fn division_of_vector_by_zero() {
    assert_eq!(errors("let a = (1, 2) / 0"), ["E0225 `0`: this is 0"]);
    assert_eq!(errors("let a = (1, 2) / (1, 0)"), ["E0225 `(1, 0)`: a component of this is 0"]);
}

#[test]
fn division_by_what_may_be_zero_is_fine() {
    assert_eq!(value("let a = 1.0 / time"), "(1.0 / time):float");
}

#[test]
fn wrong_operand_is_reported_once() {
    assert_eq!(errors("let a = (nix + 1) * 2 - (1, 2)"), ["E0201 `nix`: no such name"]);
}

#[test]
fn shape_and_number_are_refused() {
    assert_eq!(help("let a = sphere(1) | 3"), "both sides must be shapes");
    assert_eq!(
        help("let a = sphere(1) * 3"),
        "move, turn or scale a shape by calling a function on it: `shape.f(…)`"
    );
}
