//! WGSL texts of this crate in other languages, by naga.

use crate::wgsl::{WgslError, read, spirv};
use naga::back::{glsl, hlsl, msl};
use naga::proc::BoundsCheckPolicies;
use naga::valid::ModuleInfo;
use naga::{Module, ShaderStage};

/// Macros that choose a stage of a GLSL module, and its entry point.
const STAGES: [(&str, ShaderStage, &str); 3] = [
    ("VOL_COMPUTE", ShaderStage::Compute, "render"),
    ("VOL_VERTEX", ShaderStage::Vertex, "cover"),
    ("VOL_FRAGMENT", ShaderStage::Fragment, "paint"),
];

fn failed(language: &'static str, error: &dyn std::error::Error) -> WgslError {
    WgslError::Translate { language, message: error.to_string() }
}

/// All entry points as little-endian SPIR-V 1.3.
pub(super) fn spirv_module(wgsl: &str) -> Result<Vec<u8>, WgslError> {
    Ok(spirv::whole(wgsl)?.into_iter().flat_map(u32::to_le_bytes).collect())
}

/// All entry points as HLSL; without any, all functions.
pub(super) fn hlsl(wgsl: &str) -> Result<String, WgslError> {
    let (module, info) = read(wgsl)?;
    let options = hlsl::Options::default();
    let mut text = String::new();
    hlsl::Writer::new(&mut text, &options, &hlsl::PipelineOptions::default())
        .write(&module, &info, None)
        .map_err(|error| failed("HLSL", &error))?;
    Ok(text)
}

/// All entry points as MSL; without any, all functions.
pub(super) fn msl(wgsl: &str) -> Result<String, WgslError> {
    let (module, info) = read(wgsl)?;
    let options =
        msl::Options { lang_version: (2, 0), fake_missing_bindings: true, ..msl::Options::default() };
    let (text, _) = msl::write_string(&module, &info, &options, &msl::PipelineOptions::default())
        .map_err(|error| failed("MSL", &error))?;
    Ok(text)
}

/// One text with the three stages, each behind its macro.
pub(super) fn glsl_module(wgsl: &str) -> Result<String, WgslError> {
    let (module, info) = read(wgsl)?;
    let mut text = String::new();
    for (index, (name, stage, entry)) in STAGES.into_iter().enumerate() {
        let part = glsl_part(&module, &info, 310, stage, entry)?;
        let (version, body) = part.split_once('\n').unwrap_or(("", &part));
        if index == 0 {
            text = format!("{version}\n// Define one of VOL_COMPUTE, VOL_VERTEX, VOL_FRAGMENT.\n");
        }
        text += &format!("#ifdef {name}\n{body}\n#endif // {name}\n");
    }
    Ok(text)
}

/// A library as GLSL ES 3.10; `wgsl` has an entry point that calls all that is to be kept.
pub(super) fn glsl_library(wgsl: &str) -> Result<String, WgslError> {
    library(wgsl, 310)
}

/// A library as GLSL ES 3.00.
pub(super) fn shadertoy_library(wgsl: &str) -> Result<String, WgslError> {
    library(wgsl, 300)
}

fn library(wgsl: &str, version: u16) -> Result<String, WgslError> {
    let (module, info) = read(wgsl)?;
    let text = glsl_part(&module, &info, version, ShaderStage::Fragment, "main_entry")?;
    // What is left is without the entry point and what belongs to it: the caller has a version, a precision and a `main`.
    let functions = text.split_once("void main() {").map_or(&*text, |(before, _)| before);
    let of_caller = |line: &&str| {
        !["#version", "precision ", "layout(location"].iter().any(|start| line.starts_with(start))
    };
    Ok(functions.lines().filter(of_caller).flat_map(|line| [line, "\n"]).collect())
}

fn glsl_part(
    module: &Module,
    info: &ModuleInfo,
    version: u16,
    stage: ShaderStage,
    entry: &str,
) -> Result<String, WgslError> {
    let bindings = module.global_variables.iter().filter_map(|(_, variable)| variable.binding);
    let options = glsl::Options {
        version: glsl::Version::Embedded { version, is_webgl: version == 300 },
        writer_flags: glsl::WriterFlags::empty(),
        binding_map: bindings.map(|binding| (binding, binding.binding as u8)).collect(),
        zero_initialize_workgroup_memory: true,
    };
    let pipeline =
        glsl::PipelineOptions { shader_stage: stage, entry_point: entry.to_owned(), multiview: None };
    let mut text = String::new();
    let policies = BoundsCheckPolicies::default();
    glsl::Writer::new(&mut text, module, info, &options, &pipeline, policies)
        .and_then(|mut writer| writer.write())
        .map_err(|error| failed("GLSL", &error))?;
    Ok(text)
}
