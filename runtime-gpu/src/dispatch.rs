//! Buffers, dispatches and reading back.
//!
//! A buffer is a row of 32-bit words; what they mean is between the kernel and the caller ([`Gpu::upload_f32`] and [`Gpu::read_f32`] see
//! them as floats). Nothing waits but [`Gpu::read`] and [`Gpu::wait`], so several dispatches can add to one output before it is read.
//!
//! A desktop driver may reset a device that is busy with one dispatch for seconds: split a long render into several.

use std::sync::mpsc;
use std::time::Duration;

use crate::device::Gpu;
use crate::error::GpuError;
use crate::pipeline::Kernel;

/// Most workgroups along one axis of a dispatch, on any WebGPU device.
pub const MAX_GROUPS_PER_AXIS: u32 = 65_535;

/// How long the answer of a finished copy may take.
const ANSWER: Duration = Duration::from_secs(10);

/// Size of the allocation behind an empty buffer, in bytes: wgpu knows none of size zero, and a binding must hold one array element.
const EMPTY_BYTES: u64 = 256;

/// A row of 32-bit words in the device's memory.
#[derive(Debug)]
pub struct Buffer {
    raw: wgpu::Buffer,
    words: usize,
}

impl Buffer {
    /// The number of words.
    pub fn len(&self) -> usize {
        self.words
    }

    /// True for a buffer of no words; it can be bound and read all the same.
    pub fn is_empty(&self) -> bool {
        self.words == 0
    }
}

/// The workgroups, of `group_size` invocations each, that cover `invocations`: one row of them where it suffices, else several.
///
/// With more than one row the kernel finds its index, and must leave out those past the end, like this:
///
/// ```wgsl
/// @compute @workgroup_size(64)
/// fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
///     let index = (id.y * groups.x * 64u) + id.x;
///     if (index >= count) { return; }
/// }
/// ```
///
/// # Errors
///
/// [`GpuError::TooLarge`] where 65 535 rows do not suffice, or where the indices past the end would leave 32 bits.
pub fn groups_for(invocations: u32, group_size: u32) -> Result<[u32; 3], GpuError> {
    let group_size = group_size.max(1);
    let groups = invocations.div_ceil(group_size);
    let rows = groups.div_ceil(MAX_GROUPS_PER_AXIS).max(1);
    let columns = groups.div_ceil(rows);
    let covered = u64::from(rows) * u64::from(columns) * u64::from(group_size);
    if rows > MAX_GROUPS_PER_AXIS || covered > 1 << 32 {
        return Err(GpuError::TooLarge {
            what: "a dispatch".to_owned(),
            needed: covered,
            allowed: 1 << 32,
            unit: "invocations",
        });
    }
    Ok([columns, rows, 1])
}

impl Gpu {
    /// A new buffer with these words.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`], [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn upload(&self, words: &[u32]) -> Result<Buffer, GpuError> {
        let buffer = self.zeroed(words.len())?;
        self.write(&buffer, words)?;
        Ok(buffer)
    }

    /// As [`Gpu::upload`], for floats.
    ///
    /// # Errors
    ///
    /// As [`Gpu::upload`].
    pub fn upload_f32(&self, values: &[f32]) -> Result<Buffer, GpuError> {
        self.upload(bytemuck::cast_slice(values))
    }

    /// A new buffer of `words` words, all zero.
    ///
    /// # Errors
    ///
    /// As [`Gpu::upload`].
    pub fn zeroed(&self, words: usize) -> Result<Buffer, GpuError> {
        let bytes = self.checked_bytes(words)?;
        let usage = wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::UNIFORM
            | wgpu::BufferUsages::COPY_SRC
            | wgpu::BufferUsages::COPY_DST;
        let size = if words == 0 { EMPTY_BYTES } else { bytes };
        let raw = self.create_buffer("buffer", size, usage)?;
        Ok(Buffer { raw, words })
    }

    /// Replaces the first words of `buffer`, for dispatches after this call; those before it still see the old ones.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] for more words than the buffer has, [`GpuError::OutOfMemory`], [`GpuError::Lost`].
    pub fn write(&self, buffer: &Buffer, words: &[u32]) -> Result<(), GpuError> {
        if words.len() > buffer.words {
            return Err(GpuError::TooLarge {
                what: "the new contents of a buffer".to_owned(),
                needed: words.len() as u64,
                allowed: buffer.words as u64,
                unit: "words",
            });
        }
        if words.is_empty() {
            return self.check();
        }
        self.guarded(
            |error| GpuError::from_wgpu("writing a buffer", error),
            || {
                let bytes = bytemuck::cast_slice(words);
                self.queue.write_buffer(&buffer.raw, 0, bytes);
            },
        )
    }

    /// Starts `groups` workgroups of `kernel` and returns without waiting for them. Zero groups along an axis do nothing.
    ///
    /// Dispatches run in the order of the calls, each seeing all that the ones before it wrote.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] for more than 65 535 groups along an axis (see [`groups_for`]), [`GpuError::Driver`] when the buffers do not
    /// fit the kernel, [`GpuError::Lost`].
    pub fn dispatch(
        &self,
        kernel: &Kernel,
        inputs: &[&Buffer],
        output: &Buffer,
        groups: [u32; 3],
    ) -> Result<(), GpuError> {
        if let Some(&most) = groups.iter().max()
            && most > MAX_GROUPS_PER_AXIS
        {
            return Err(GpuError::TooLarge {
                what: format!("a dispatch of `{}`", kernel.label()),
                needed: u64::from(most),
                allowed: u64::from(MAX_GROUPS_PER_AXIS),
                unit: "workgroups along one axis",
            });
        }
        let what = format!("running `{}`", kernel.label());
        self.guarded(
            |error| GpuError::from_wgpu(&what, error),
            || {
                let bindings = self.bind(kernel, inputs, output);
                self.submit(|encoder| {
                    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                        label: Some(kernel.label()),
                        timestamp_writes: None,
                    });
                    pass.set_pipeline(&kernel.pipeline);
                    pass.set_bind_group(0, &bindings, &[]);
                    pass.dispatch_workgroups(groups[0], groups[1], groups[2]);
                });
            },
        )
    }

    /// Waits for all work handed in so far and returns the words of `buffer`.
    ///
    /// # Errors
    ///
    /// [`GpuError::Lost`] when the device stopped before it got there, [`GpuError::OutOfMemory`] where a copy of the buffer does not fit.
    pub fn read(&self, buffer: &Buffer) -> Result<Vec<u32>, GpuError> {
        self.read_as(buffer)
    }

    /// As [`Gpu::read`], for floats.
    ///
    /// # Errors
    ///
    /// As [`Gpu::read`].
    pub fn read_f32(&self, buffer: &Buffer) -> Result<Vec<f32>, GpuError> {
        self.read_as(buffer)
    }

    fn read_as<T: bytemuck::Pod>(&self, buffer: &Buffer) -> Result<Vec<T>, GpuError> {
        if buffer.is_empty() {
            return self.wait().map(|()| Vec::new());
        }
        // Copy into memory that the CPU can see.
        let bytes = buffer.words as u64 * 4;
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let staging = self.create_buffer("readback", bytes, usage)?;
        let (sender, receiver) = mpsc::channel();
        self.guarded(
            |error| GpuError::from_wgpu("reading a buffer", error),
            || {
                self.submit(|encoder| {
                    encoder.copy_buffer_to_buffer(&buffer.raw, 0, &staging, 0, bytes);
                });
                staging.map_async(wgpu::MapMode::Read, .., move |outcome| {
                    // The receiver waits below, or has left with an error.
                    let _ = sender.send(outcome);
                });
            },
        )?;
        // Wait for the copy, and with it for all that came before.
        self.poll(wgpu::PollType::wait_indefinitely())?;
        let refused = |message: String| GpuError::Driver { what: "reading a buffer".to_owned(), message };
        // The copy is done, but the answer may still be on its way through another thread that polls.
        match receiver.recv_timeout(ANSWER) {
            Ok(Ok(())) => {}
            Ok(Err(error)) => return Err(refused(error.to_string())),
            Err(_) => return Err(refused("the device never answered".to_owned())),
        }
        let view = staging.get_mapped_range(..);
        let view = view.map_err(|error| refused(error.to_string()))?;
        Ok(bytemuck::pod_collect_to_vec(&view))
    }

    /// The size of a buffer of `words` words in bytes, if a kernel can use one that large.
    fn checked_bytes(&self, words: usize) -> Result<u64, GpuError> {
        let needed = (words as u64).saturating_mul(4);
        let allowed = self.max_buffer_bytes();
        if needed > allowed {
            return Err(GpuError::TooLarge { what: "a buffer".to_owned(), needed, allowed, unit: "bytes" });
        }
        Ok(needed)
    }

    fn create_buffer(
        &self,
        label: &'static str,
        size: u64,
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, GpuError> {
        self.guarded(
            |error| GpuError::from_wgpu(&format!("a {label} of {size} bytes"), error),
            || {
                self.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some(label),
                    size,
                    usage,
                    mapped_at_creation: false,
                })
            },
        )
    }

    fn bind(&self, kernel: &Kernel, inputs: &[&Buffer], output: &Buffer) -> wgpu::BindGroup {
        let buffers = inputs.iter().copied().chain([output]);
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.raw.as_entire_binding(),
            })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(kernel.label()),
            layout: &kernel.layout,
            entries: &entries,
        })
    }

    fn submit(&self, record: impl FnOnce(&mut wgpu::CommandEncoder)) {
        let descriptor = wgpu::CommandEncoderDescriptor::default();
        let mut encoder = self.device.create_command_encoder(&descriptor);
        record(&mut encoder);
        self.queue.submit([encoder.finish()]);
    }
}

#[cfg(test)]
mod tests {
    use super::groups_for;

    #[test]
    fn groups_cover_the_invocations() {
        for invocations in [0, 1, 63, 64, 65, 4_194_240, 4_194_241, 100_000_000] {
            let [x, y, z] = groups_for(invocations, 64).expect("fits");
            let covered = u64::from(x) * u64::from(y) * 64;
            assert!(covered >= u64::from(invocations) && z == 1);
            // Fewer than one group too many for each row.
            assert!(covered < u64::from(invocations) + 64 * u64::from(y) + 64);
            assert!(x <= 65_535 && y <= 65_535);
        }
    }

    #[test]
    fn groups_refuse_what_an_index_cannot_count() {
        assert!(groups_for(u32::MAX, 1).is_err());
        assert!(groups_for(u32::MAX, 64).is_err());
        assert!(groups_for(4_000_000_000, 64).is_ok());
    }
}
