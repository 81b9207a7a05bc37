//! Any text is checked without a panic; a scene comes out exactly if there is no error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vol_language::diag::{Diagnostic, render};
use vol_language::source::SourceFile;

fuzz_target!(|text: &str| {
    let file = SourceFile::new("fuzz.vol", text);
    let (scene, diagnostics) = vol_language::analyse(&file, &vol_compiler::library::library());
    assert_eq!(scene.is_none(), diagnostics.iter().any(Diagnostic::is_error));
    let _ = render::human(&file.into(), &diagnostics, false);
});
