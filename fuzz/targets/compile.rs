//! A generated scene is correct: it compiles without an error, and its shader is accepted.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vol_compiler::frame::Quadrature;
use vol_compiler::{lints, lower, wgsl};
use vol_language::diag::{Diagnostic, render};
use vol_language::source::SourceFile;

fuzz_target!(|bytes: &[u8]| {
    let text = vol_generator::scene(bytes);
    let file = SourceFile::new("fuzz.vol", text);
    let (scene, mut diagnostics) = vol_language::analyse(&file, &vol_compiler::library::library());
    let program = scene.and_then(|scene| {
        let (program, found) = lower::compile(&scene);
        diagnostics.extend(found);
        program
    });
    let sources = file.into();
    assert!(
        !diagnostics.iter().any(Diagnostic::is_error),
        "{}",
        render::human(&sources, &diagnostics, false)
    );
    let program = program.expect("a scene without errors is compiled");
    for quadrature in [Quadrature::Midpoint, Quadrature::Corrected] {
        wgsl::render::render_module(&program, quadrature, [8, 8]).expect("the shader is accepted");
    }
    // A frame may be refused with a message: what params and time set is not known before.
    if let Ok(frame) = program.frame(&program.default_params(), 0.5, 1.0, [64, 36]) {
        let _ = lints::warnings(&program, &frame);
    }
});
