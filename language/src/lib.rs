//! The `.vol` language: source text in, typed scene out.
//!
//! ```text
//! text ──parse──► ast::File ──check──► hir::Scene
//! ```
//!
//! Comes in: a [`source::SourceFile`] and the [`library::Library`] of built-in functions that the
//! compiler offers. Goes out: a [`hir::Scene`] in which every name is resolved and every
//! expression typed, and the [`diag::Diagnostic`]s of all mistakes found.
//!
//! This crate reads no files, prints nothing and never panics on a scene's text.

pub mod ast;
pub mod blocks;
pub mod check;
pub mod diag;
pub mod fmt;
pub mod hir;
pub mod library;
pub mod module;
pub mod nearest;
pub mod parse;
pub mod settings;
pub mod source;
pub mod standard;
pub mod ty;

use diag::Diagnostic;
use library::Library;
use module::{Loaded, Loader, NoFiles};
use source::{SourceFile, Sources};

/// Codes that a lost item causes elsewhere: names that only it defines, and all that is then missing.
const FOLLOW_UPS: [&str; 5] = ["E0201", "E0304", "E0308", "E0313", "E0605"];

/// Warnings about unused names; beside an error they may only say that a use of the name is wrong.
const UNUSED: [&str; 4] = ["W0101", "W0102", "W0103", "W0104"];

/// A scene that was parsed and checked.
#[derive(Debug)]
pub struct Analysis {
    /// Present whenever the scene is free of errors.
    pub scene: Option<hir::Scene>,
    /// Mistakes and warnings in the order of their places.
    pub diagnostics: Vec<Diagnostic>,
    /// The texts in which their places lie.
    pub sources: Sources,
}

/// Parses and checks a text that imports nothing; see [`analyse_with`].
#[must_use]
pub fn analyse(file: &SourceFile, library: &Library) -> (Option<hir::Scene>, Vec<Diagnostic>) {
    let Analysis { scene, diagnostics, .. } = analyse_with(file.clone(), library, &NoFiles);
    (scene, diagnostics)
}

/// Parses and checks a scene's own file and the files that it imports.
///
/// The scene is present whenever it is free of errors; warnings may stand beside it. An item with a
/// syntax error is left out of the check, and messages that only its absence causes are dropped.
#[must_use]
pub fn analyse_with(file: SourceFile, library: &Library, loader: &dyn Loader) -> Analysis {
    let Loaded { sources, modules, mut diagnostics } = module::load(file, loader);
    let (scene, mut found) = check::check(&modules, library);
    if diagnostics.iter().any(Diagnostic::is_error) {
        found.retain(|diagnostic| !FOLLOW_UPS.contains(&diagnostic.code));
    }
    diagnostics.extend(found);
    diagnostics.sort_by_key(|d| d.labels.first().map_or(0, |label| label.span.start));
    let failed = diagnostics.iter().any(Diagnostic::is_error);
    if failed {
        diagnostics.retain(|diagnostic| !UNUSED.contains(&diagnostic.code));
    }
    Analysis { scene: (!failed).then_some(scene), diagnostics, sources }
}
