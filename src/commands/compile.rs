//! `vol compile`: a scene as a shader.

use std::io::{self, Write as _};

use vol::failure::Failure;
use vol::output::atomic;
use vol::reflect;
use vol_compiler::export::{self, ExportError, Form, Language, Source};
use vol_compiler::frame::{Frame, Job, Quadrature};
use vol_compiler::wgsl::Notes;
use vol_language::source::Span;

use super::Prepared;
use super::values::Size;
use crate::cli::{self, ExportForm, Target};

pub(super) fn run(arguments: &cli::Compile) -> Result<(), Failure> {
    for path in arguments.output.iter().chain(&arguments.reflect) {
        atomic::probe(path)?;
    }
    if arguments.output.is_some() && arguments.output == arguments.reflect {
        return Err(Failure::usage("the shader and what is said of it cannot be one file"));
    }
    let (language, form) = (language(arguments.target), form(arguments));
    let prepared = Prepared::new(&arguments.scene)?;
    if !prepared.session.program.styles.is_empty() {
        super::print_line(
            "note: tables of styles are not part of a shader; it draws lights as they are without",
        );
    }
    let (frame, job) = moment(&prepared, arguments)?;
    let session = &prepared.session;
    let line = |span: Span| Some(super::line_of(&session.sources, span));
    let source = Source {
        program: &session.program,
        frame: &frame,
        job: &job,
        notes: &Notes::new(&session.program, &line),
        title: &title(&prepared, &frame, form),
        prefix: &arguments.prefix,
    };
    let bytes = export::export(&source, language, form).map_err(|error| failure(&error, arguments))?;
    if let Some(path) = &arguments.reflect {
        let text = reflect::json(&source, language, form, prepared.moment.time, &prepared.params);
        atomic::write(path, |out| out.write_all(text.as_bytes()))?;
    }
    match &arguments.output {
        Some(path) => atomic::write(path, |out| out.write_all(&bytes)),
        None => {
            let mut out = io::stdout().lock();
            let written = out.write_all(&bytes).and_then(|()| out.flush());
            written.map_err(|error| Failure::stdout(&error))
        }
    }
}

fn language(target: Target) -> Language {
    match target {
        Target::Wgsl => Language::Wgsl,
        Target::Glsl => Language::Glsl,
        Target::Spirv => Language::Spirv,
        Target::Hlsl => Language::Hlsl,
        Target::Msl => Language::Msl,
        Target::Shadertoy => Language::Shadertoy,
    }
}

fn form(arguments: &cli::Compile) -> Form {
    match (arguments.form, arguments.target) {
        (Some(ExportForm::Library), _) | (None, Target::Shadertoy) => Form::Library,
        (Some(ExportForm::Module), _) | (None, _) => Form::Module,
    }
}

/// The frame and how it is sampled; depths towards lights are marched, since grids of them are as large as pictures.
fn moment(prepared: &Prepared, arguments: &cli::Compile) -> Result<(Frame, Job), Failure> {
    let program = &prepared.session.program;
    let size = arguments.size.map_or(program.render.size, |Size(size)| size);
    let mut frame = prepared.frame(size)?;
    let sampling = prepared.session.sampling(&prepared.params, prepared.moment, None, None)?;
    let job = match arguments.step {
        Some(step) => {
            Job { size, step, shadow_step: 2.0 * step, quadrature: Quadrature::Corrected, sampling }
        }
        None => vol_runtime_cpu::choose(program, &mut frame, size, sampling, arguments.max_error).job,
    };
    frame.light_grids.clear();
    Ok((frame, job))
}

/// What a text says of itself.
fn title(prepared: &Prepared, frame: &Frame, form: Form) -> Vec<String> {
    let name = super::base(&prepared.session.sources.root().name);
    let mut lines = vec![format!("{name}, translated by vol {}", env!("CARGO_PKG_VERSION"))];
    if form == Form::Library {
        lines
            .push(format!("The scene at {} s with the params it was translated with.", prepared.moment.time));
        lines.push("To be called:".to_owned());
        for entry in export::entries(&prepared.session.program, frame) {
            lines.push(format!("  {}{}: {}", entry.name, entry.signature, entry.meaning));
        }
    }
    lines
}

fn failure(error: &ExportError, arguments: &cli::Compile) -> Failure {
    match error {
        ExportError::NoSuchForm(reason) => {
            Failure::usage((*reason).to_owned()).with_help("take another `--as`, or another `--target`")
        }
        ExportError::Shader(error) => {
            let text = format!("cannot translate `{}`: {error}", arguments.scene.scene.display());
            Failure::content(text)
                .with_help("this is a mistake of vol itself; please report it with the scene")
        }
    }
}
