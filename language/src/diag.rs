//! Diagnostics: what is wrong with a scene, as data.
//!
//! Every mistake becomes one [`Diagnostic`] with a stable [`code`](Diagnostic::code). Wording:
//! lower case, one sentence, no final stop, the user's terms, and a help line that says what to
//! write.

mod fix;
pub mod render;

pub use fix::{Edit, Fix, apply_all};

use crate::source::Span;
use serde::Serialize;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The scene cannot be used.
    Error,
    /// The scene works but probably not as meant.
    Warning,
}

/// A marked place with a remark.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// The place.
    pub span: Span,
    /// What is said about it; may be empty.
    pub text: String,
}

/// One message about a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// Stable code, `E0203` or `W0101`.
    pub code: &'static str,
    /// One sentence.
    pub message: String,
    /// The first is the main place, the others explain.
    pub labels: Vec<Label>,
    /// What to write instead.
    pub help: Option<String>,
    /// Repairs that each would do away with the message; several are a choice that the author has.
    pub fixes: Vec<Fix>,
}

impl Diagnostic {
    /// An error at `span`.
    #[must_use]
    pub fn error(
        code: &'static str,
        message: impl Into<String>,
        span: Span,
        label: impl Into<String>,
    ) -> Self {
        Self {
            severity: Severity::Error,
            code,
            message: message.into(),
            labels: vec![Label { span, text: label.into() }],
            help: None,
            fixes: Vec::new(),
        }
    }

    /// A warning at `span`.
    #[must_use]
    pub fn warning(
        code: &'static str,
        message: impl Into<String>,
        span: Span,
        label: impl Into<String>,
    ) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, message, span, label) }
    }

    /// Adds a second place.
    #[must_use]
    pub fn with_label(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label { span, text: text.into() });
        self
    }

    /// Adds the help line.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Adds a repair.
    #[must_use]
    pub fn with_fix(mut self, fix: impl Into<Option<Fix>>) -> Self {
        self.fixes.extend(fix.into());
        self
    }

    /// Adds the help line and the repair for a name that is spelt nearly like the known one `near`.
    #[must_use]
    pub fn did_you_mean(self, near: &str, span: Span) -> Self {
        self.with_help(format!("did you mean `{near}`")).with_fix(Fix::replace(span, near))
    }

    /// Moves all places towards the end by `bytes`: from those of one file to those of all files.
    pub fn shift(&mut self, bytes: u32) {
        let edits = self.fixes.iter_mut().flat_map(|fix| &mut fix.edits).map(|edit| &mut edit.span);
        for span in self.labels.iter_mut().map(|label| &mut label.span).chain(edits) {
            *span = span.shifted(bytes);
        }
    }

    /// Whether it is an error.
    #[must_use]
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}
