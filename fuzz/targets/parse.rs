//! Any text is read without a panic, and every place in a message lies in the text.
#![no_main]

use libfuzzer_sys::fuzz_target;
use vol_language::diag::render;
use vol_language::parse::parse;
use vol_language::source::SourceFile;

fuzz_target!(|text: &str| {
    let file = SourceFile::new("fuzz.vol", text);
    let (_, diagnostics) = parse(&file);
    let sources = file.into();
    let _ = render::human(&sources, &diagnostics, false);
    let _ = render::json(&sources, &diagnostics);
});
