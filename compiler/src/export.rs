//! Scenes as shaders for other programs.
//!
//! In: a program at one moment. Out: text (or words) in a shader language, in one of two forms:
//!
//! | form | what it is |
//! |---|---|
//! | [`Form::Module`] | bindings, the entry points `render` (compute), `cover` and `paint` (vertex, fragment); params and time are data |
//! | [`Form::Library`] | functions of a point or a ray and nothing else: no bindings, no entry points; the moment is baked in |
//!
//! WGSL is written here; naga translates it to the other languages. A Shadertoy fragment is a library in GLSL with a
//! `mainImage`.

mod library;
mod prefix;
mod translate;

use crate::frame::{Frame, Job};
use crate::program::Program;
use crate::wgsl::render::shared_module;
use crate::wgsl::{Notes, WgslError};

pub use library::{Entry, entries};

/// A shader language.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// WebGPU's.
    Wgsl,
    /// OpenGL's: ES 3.10; a module has one part for each stage, chosen by a macro.
    Glsl,
    /// Vulkan's, as little-endian words.
    Spirv,
    /// Direct3D's, shader model 5.1.
    Hlsl,
    /// Metal's, version 2.0.
    Msl,
    /// GLSL ES 3.00 with a `mainImage`.
    Shadertoy,
}

/// What is exported.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A complete module with entry points.
    Module,
    /// Functions without bindings.
    Library,
}

/// What to export.
pub struct Source<'a> {
    /// The scene.
    pub program: &'a Program,
    /// Its moment, of a library; the grids of its lights are left out.
    pub frame: &'a Frame,
    /// The picture's size and how media are sampled.
    pub job: &'a Job,
    /// Where lines come from.
    pub notes: &'a Notes<'a>,
    /// Lines of a comment at the top: what the text was made from.
    pub title: &'a [String],
    /// What all names of a library start with.
    pub prefix: &'a str,
}

/// Why something cannot be exported.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExportError {
    /// The language has no such form.
    #[error("{0}")]
    NoSuchForm(&'static str),
    /// A fault of this crate or of naga.
    #[error(transparent)]
    Shader(#[from] WgslError),
}

/// Writes a scene in a language.
///
/// # Errors
///
/// [`ExportError::NoSuchForm`] for a library in SPIR-V and for a module for Shadertoy.
pub fn export(source: &Source<'_>, language: Language, form: Form) -> Result<Vec<u8>, ExportError> {
    let title: String = source.title.iter().map(|line| format!("// {line}\n")).collect();
    let text = match (language, form) {
        (Language::Spirv, Form::Module) => return Ok(translate::spirv_module(&module(source)?)?),
        (Language::Spirv, Form::Library) => {
            return Err(ExportError::NoSuchForm("SPIR-V has no libraries of functions"));
        }
        (Language::Shadertoy, Form::Module) => {
            return Err(ExportError::NoSuchForm("Shadertoy has no bindings, so there is no module for it"));
        }
        (Language::Wgsl, Form::Module) => module(source)?,
        (Language::Glsl, Form::Module) => translate::glsl_module(&module(source)?)?,
        (Language::Hlsl, Form::Module) => translate::hlsl(&module(source)?)?,
        (Language::Msl, Form::Module) => translate::msl(&module(source)?)?,
        (Language::Wgsl, Form::Library) => library::wgsl(source)?,
        (Language::Glsl, Form::Library) => translate::glsl_library(&library::kept(source)?)?,
        (Language::Hlsl, Form::Library) => translate::hlsl(&library::constant(source)?)?,
        (Language::Msl, Form::Library) => translate::msl(&library::constant(source)?)?,
        (Language::Shadertoy, Form::Library) => library::shadertoy(source)?,
    };
    // GLSL demands that its version comes first.
    let text = match text.split_once('\n') {
        Some((version, rest)) if version.starts_with("#version") => format!("{version}\n{title}{rest}"),
        _ => format!("{title}\n{text}"),
    };
    Ok(text.into_bytes())
}

fn module(source: &Source<'_>) -> Result<String, WgslError> {
    Ok(shared_module(source.program, source.job.quadrature, source.notes)?.text)
}

#[cfg(test)]
mod tests;
