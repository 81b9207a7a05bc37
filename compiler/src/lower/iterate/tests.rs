use crate::ir::text;
use crate::program::Program;
use crate::reference;
use vol_language::source::SourceFile;

/// The program of a scene with a medium of this density, and its messages.
fn compiled(items: &str, density: &str) -> (Option<Program>, Vec<String>) {
    let text = format!("{items}\nmedium m {{ region: sphere(2), density: {density} }}");
    let library = crate::library::library();
    let (scene, mut diagnostics) = vol_language::analyse(&SourceFile::new("test.vol", &text), &library);
    let mut program = None;
    if let Some(scene) = scene {
        let (compiled, more) = crate::lower::compile(&scene);
        program = compiled;
        diagnostics.extend(more);
    }
    (program, diagnostics.iter().map(|d| format!("{} {}", d.code, d.message)).collect())
}

/// The density at points, with the first param set.
#[track_caller]
fn density(items: &str, density: &str, param: Option<f64>, points: &[[f64; 3]]) -> Vec<f64> {
    let (program, messages) = compiled(items, density);
    let program = program.unwrap_or_else(|| panic!("{messages:?}"));
    let mut params = program.default_params();
    if let Some(value) = param {
        params[0] = vec![value];
    }
    let frame = program.frame(&params, 0.0, 0.0, [8, 8]).expect("no errors");
    let field = program.fields.iter().find(|field| field.name.contains("density")).expect("a density");
    let function = program.module.function(field.function);
    points.iter().map(|p| reference::evaluate(function, p, &frame.uniforms, &frame.curves)[0]).collect()
}

const POINTS: [[f64; 3]; 3] = [[0.1, 0.2, 0.3], [0.9, -0.4, 0.2], [-0.5, 0.5, 0.7]];

#[test]
fn steps_are_counted_by_a_param() {
    let items = "param n: int = 3 in 0..8";
    let loop_of = "q => (iterate n from (x = q.world.x, k = 0): (x = 2 * x, k = k + 1)).x + 200";
    for (n, factor) in [(0.0, 1.0), (1.0, 2.0), (3.0, 8.0), (8.0, 256.0), (20.0, 256.0)] {
        let found = density(items, loop_of, Some(n), &POINTS);
        assert!(
            found.iter().zip(POINTS).all(|(x, p)| (x - 200.0 - p[0] * factor).abs() < 1e-9),
            "{n}: {found:?}"
        );
    }
}

#[test]
fn points_stop_at_their_own_step() {
    let text = "q => (iterate 50 from (x = abs(q.world.x), k = 0) while x < 4: (x = 2 * x, k = k + 1)).k";
    let steps = |p: &[f64; 3]| (4.0 / p[0].abs()).log2().ceil().max(0.0);
    assert_eq!(density("", text, None, &POINTS), POINTS.iter().map(steps).collect::<Vec<f64>>());
}

#[test]
fn loops_of_constants_are_computed() {
    let (program, messages) =
        compiled("let a = iterate 10 from (x = 1.0, on = true) while on: (x = 2 * x, on = x < 100)", "a.x");
    let program = program.unwrap_or_else(|| panic!("{messages:?}"));
    assert!(!text::print_module(&program.module).contains("loop"));
    assert!(text::print_module(&program.module).contains("256.0"));
}

#[test]
fn loops_nest() {
    let text =
        "q => (iterate 3 from (x = q.world.x): (x = (iterate 2 from (y = x): (y = 2 * y + x)).y)).x + 400";
    let found = density("", text, None, &POINTS);
    assert!(found.iter().zip(POINTS).all(|(x, p)| (x - 400.0 - 343.0 * p[0]).abs() < 1e-9), "{found:?}");
}

#[test]
fn limits_are_told() {
    let first = |items: &str, text: &str| compiled(items, text).1.first().cloned().unwrap_or_default();
    assert_eq!(
        first("", "q => (iterate 1025 from (x = q.world.x): (x = x)).x"),
        "E0407 a loop takes at most 1024 steps"
    );
    let nested = "q => (iterate n from (x = q.world.x): (x = (iterate n from (y = x): (y = 2 * y)).y)).x";
    assert_eq!(
        first("param n: int = 3", nested),
        "E0407 loops inside each other take at most 65535 steps together"
    );
    assert_eq!(first("param n: int = 3 in 0..100", nested), "");
    let large = "q => (iterate 2 from (a = q.world, b = q.world, c = q.world, d = q.world, e = q.world, f = q.world): (a = a, b = b, c = c, d = d, e = e, f = f)).a.x";
    assert_eq!(first("", large), "E0407 the state of a loop has at most 16 numbers");
}
