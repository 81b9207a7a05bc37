//! SPIR-V that reaches the driver unchanged: the one thing here that wgpu calls unsafe.
//!
//! wgpu checks nothing of such a module. What is handed over is a text of `vol_compiler::wgsl` that naga has validated,
//! written by naga and changed by decorations of results alone.

use vol_compiler::wgsl::{self, WgslError};

/// Tells wgpu that an experimental feature is wanted.
#[allow(unsafe_code, reason = "wgpu wants to hear that its experimental features may have faults")]
pub(crate) fn allowed() -> wgpu::ExperimentalFeatures {
    // SAFETY: a promise to report faults of wgpu to wgpu; the feature used is `PASSTHROUGH_SHADERS`, see `module`.
    unsafe { wgpu::ExperimentalFeatures::enabled() }
}

/// A shader module of the WGSL text with strict arithmetic, as SPIR-V.
///
/// # Errors
///
/// [`WgslError`] if naga does not accept the text.
#[allow(unsafe_code, reason = "wgpu does not look at modules that it passes through")]
pub(crate) fn module(
    device: &wgpu::Device,
    label: &str,
    wgsl: &str,
    entry: &str,
) -> Result<wgpu::ShaderModule, WgslError> {
    let spirv = wgsl::strict_spirv(wgsl, entry)?;
    let [x, y, z] = spirv.workgroup_size;
    let entry_points = [wgpu::PassthroughShaderEntryPoint { name: entry.into(), workgroup_size: (x, y, z) }];
    let descriptor = wgpu::ShaderModuleDescriptorPassthrough {
        label: Some(label),
        entry_points: (&entry_points).into(),
        spirv: Some(spirv.words.into()),
        ..Default::default()
    };
    // SAFETY: naga validated the text and wrote the words; decorating results with NoContraction keeps a module valid.
    Ok(unsafe { device.create_shader_module_passthrough(descriptor) })
}
