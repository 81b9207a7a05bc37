//! What can go wrong between the program and the graphics device, worded for the person who asked for a picture.

/// Why the GPU could not do what was asked.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// There is no Vulkan driver, or none of the devices found could be opened.
    #[error("no usable Vulkan device ({reason}); install a Vulkan driver, or render on the CPU")]
    NoDevice {
        /// What was looked for and what each candidate answered.
        reason: String,
    },
    /// The device stopped working: unplugged, reset by its driver, out of memory while running, or closed.
    #[error("the GPU stopped working ({reason}); render on the CPU, or in smaller parts")]
    Lost {
        /// The driver's own words.
        reason: String,
    },
    /// A shader was refused. Shaders are generated, so this is a fault of ours or of the driver, never of the scene.
    #[error("the GPU refused the shader `{label}`: {message}")]
    Shader {
        /// The kernel's name.
        label: String,
        /// The first complaint, with its place in the WGSL text where one is known.
        message: String,
    },
    /// Something exceeds what this device offers.
    #[error(
        "{what} needs {needed} {unit}, this GPU allows {allowed}; render on the CPU, or in smaller parts"
    )]
    TooLarge {
        /// The thing that does not fit, as the subject of the sentence.
        what: String,
        /// How much it needs, in `unit`.
        needed: u64,
        /// How much the device allows, in `unit`.
        allowed: u64,
        /// Plural noun: bytes, workgroups, buffers.
        unit: &'static str,
    },
    /// The device has less free memory than an allocation of an allowed size needs.
    #[error("the GPU is out of memory ({what}); render on the CPU, or in smaller parts")]
    OutOfMemory {
        /// What was being done.
        what: String,
    },
    /// wgpu or the driver reported a mistake in how we use them.
    #[error("the GPU driver reported an error ({what}): {message}")]
    Driver {
        /// What was being done.
        what: String,
        /// wgpu's message.
        message: String,
    },
}

impl GpuError {
    /// The error for a wgpu error that occurred during `what`.
    pub(crate) fn from_wgpu(what: &str, error: &wgpu::Error) -> Self {
        let what = what.to_owned();
        match error {
            wgpu::Error::OutOfMemory { .. } => Self::OutOfMemory { what },
            wgpu::Error::Validation { .. } | wgpu::Error::Internal { .. } => {
                Self::Driver { what, message: message_of(error) }
            }
        }
    }

    /// As [`GpuError::from_wgpu`], for an error that refuses a shader.
    pub(crate) fn from_shader(label: &str, error: &wgpu::Error) -> Self {
        match error {
            wgpu::Error::OutOfMemory { .. } => Self::from_wgpu(label, error),
            wgpu::Error::Validation { .. } | wgpu::Error::Internal { .. } => {
                Self::Shader { label: label.to_owned(), message: message_of(error) }
            }
        }
    }

    /// The error for a text that naga refuses.
    pub(crate) fn untranslatable(label: &str, error: &vol_compiler::wgsl::WgslError) -> Self {
        Self::Shader { label: label.to_owned(), message: error.to_string() }
    }
}

/// wgpu's description without its fixed heading.
fn message_of(error: &wgpu::Error) -> String {
    let text = error.to_string();
    let body = text.strip_prefix("Validation Error\n\nCaused by:\n");
    body.unwrap_or(&text).trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::GpuError;

    #[test]
    fn messages_name_the_numbers() {
        let error = GpuError::TooLarge {
            what: "the image buffer".to_owned(),
            needed: 300,
            allowed: 256,
            unit: "bytes",
        };
        assert_eq!(
            error.to_string(),
            "the image buffer needs 300 bytes, this GPU allows 256; render on the CPU, or in smaller parts"
        );
    }
}
