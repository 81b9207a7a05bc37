//! The layer over wgpu: does the device open, compute, and answer misuse with errors instead of panics?
//!
//! The device is opened once and shared by all GPU trials. Where none opens, every one of them is listed as ignored, with the reason in
//! its kind.

use std::sync::OnceLock;
use std::thread;

use libtest_mimic::{Failed, Trial};
use vol_compiler::wgsl::{Arithmetic, Space};
use vol_runtime_gpu::{Gpu, GpuError, groups_for, open};

/// The device that the GPU trials share, or why there is none.
pub(crate) fn shared() -> Result<&'static Gpu, &'static GpuError> {
    static SHARED: OnceLock<Result<Gpu, GpuError>> = OnceLock::new();
    SHARED.get_or_init(|| open(Arithmetic::Free)).as_ref()
}

/// The same with strict arithmetic.
fn shared_strict() -> Result<&'static Gpu, &'static GpuError> {
    static SHARED: OnceLock<Result<Gpu, GpuError>> = OnceLock::new();
    SHARED.get_or_init(|| open(Arithmetic::Strict)).as_ref()
}

/// A trial named `gpu::<name>` that is handed the shared device, or is ignored where there is none.
pub(crate) fn gpu_trial(
    name: &str,
    body: impl FnOnce(&'static Gpu) -> Result<(), Failed> + Send + 'static,
) -> Trial {
    trial_on(shared(), name, body)
}

/// A trial named `gpu::<name>` that is handed a device of strict arithmetic whose single operations round correctly: Mesa's software
/// driver. Ignored on any other.
pub(crate) fn strict_trial(
    name: &str,
    body: impl FnOnce(&'static Gpu) -> Result<(), Failed> + Send + 'static,
) -> Trial {
    let trial = trial_on(shared_strict(), name, body);
    match shared_strict() {
        Ok(gpu) if !gpu.description().contains("llvmpipe") => {
            trial.with_ignored_flag(true).with_kind("equal bits are demanded of Mesa's software driver only")
        }
        Ok(_) | Err(_) => trial,
    }
}

fn trial_on(
    device: Result<&'static Gpu, &'static GpuError>,
    name: &str,
    body: impl FnOnce(&'static Gpu) -> Result<(), Failed> + Send + 'static,
) -> Trial {
    let trial = Trial::test(format!("gpu::{name}"), move || match device {
        Ok(gpu) => body(gpu),
        // Reached only with `--ignored` or `--include-ignored`.
        Err(error) => Err(error.into()),
    });
    match device {
        Ok(_) => trial,
        Err(GpuError::NoDevice { reason }) => ignored(trial, reason),
        Err(error) => ignored(trial, &error.to_string()),
    }
}

fn ignored(trial: Trial, reason: &str) -> Trial {
    trial.with_ignored_flag(true).with_kind(format!("no GPU: {reason}"))
}

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        gpu_trial("device::describes_itself", describes_itself),
        gpu_trial("device::loops_run_to_their_end", loops_run_to_their_end),
        gpu_trial("device::floats_come_back", floats_come_back),
        gpu_trial("device::dispatches_accumulate", dispatches_accumulate),
        gpu_trial("device::empty_buffers", empty_buffers),
        gpu_trial("device::rows_of_groups", rows_of_groups),
        gpu_trial("device::several_threads", several_threads),
        gpu_trial("device::bad_shaders_are_errors", bad_shaders_are_errors),
        gpu_trial("device::misuse_is_an_error", misuse_is_an_error),
        gpu_trial("device::loss_is_an_error", loss_is_an_error),
    ]
}

/// output[i] += (input[i] * 2) for i < count.
const ADD_TWICE: &str = "
@group(0) @binding(0) var<storage, read> count: array<u32>;
@group(0) @binding(1) var<storage, read> numbers: array<f32>;
@group(0) @binding(2) var<storage, read_write> sums: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= count[0]) { return; }
    sums[id.x] = sums[id.x] + (numbers[id.x] * 2.0f);
}";

/// output[i] = i + 1 for i < input[0], over several rows of groups.
const COUNT_UP: &str = "
@group(0) @binding(0) var<storage, read> count: array<u32>;
@group(0) @binding(1) var<storage, read_write> indices: array<u32>;

@compute @workgroup_size(1)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let index = (id.y * groups.x) + id.x;
    if (index >= count[0]) { return; }
    indices[index] = index + 1u;
}";

fn describes_itself(gpu: &Gpu) -> Result<(), Failed> {
    let text = gpu.description();
    // Into the log, so that it is known which driver the other trials ran on.
    println!("GPU trials run on {text}");
    check(!text.trim().is_empty(), "the description is empty")
}

fn loops_run_to_their_end(gpu: &Gpu) -> Result<(), Failed> {
    let message = "this driver ends shader loops early: run `scripts/setup-vulkan --upgrade`";
    check(gpu.loop_budget_ok()?, message)
}

fn floats_come_back(gpu: &Gpu) -> Result<(), Failed> {
    let bits = [0x0000_0001, 0x7f80_0000, 0x8000_0000, 0x7fc0_1234, 0x3f80_0000];
    let values = bits.map(f32::from_bits);
    let read = gpu.read_f32(&gpu.upload_f32(&values)?)?;
    let same = read.iter().map(|value| value.to_bits()).eq(bits);
    check(same, &format!("{read:?} instead of {values:?}"))
}

fn dispatches_accumulate(gpu: &Gpu) -> Result<(), Failed> {
    let kernel = gpu.kernel("add twice", ADD_TWICE, "main", &[Space::Storage; 2])?;
    check(!kernel.compile_time().is_zero(), "compiling took no time")?;
    let values: Vec<f32> = (0_u16..1000).map(f32::from).collect();
    let count = gpu.upload(&[1000])?;
    let numbers = gpu.upload_f32(&values)?;
    let sums = gpu.zeroed(values.len())?;
    for _ in 0..3 {
        gpu.dispatch(&kernel, &[&count, &numbers], &sums, groups_for(1000, 64)?)?;
    }
    // Written between two dispatches: seen by the second alone.
    gpu.write(&count, &[500])?;
    gpu.dispatch(&kernel, &[&count, &numbers], &sums, groups_for(1000, 64)?)?;
    let expected = values.iter().zip(0..).map(|(value, index)| {
        let times = if index < 500 { 8.0 } else { 6.0 };
        value * times
    });
    let read = gpu.read_f32(&sums)?;
    check(read.iter().copied().eq(expected), "the sums are wrong")
}

fn empty_buffers(gpu: &Gpu) -> Result<(), Failed> {
    let kernel = gpu.kernel("add twice", ADD_TWICE, "main", &[Space::Storage; 2])?;
    let count = gpu.upload(&[0])?;
    let numbers = gpu.upload(&[])?;
    let sums = gpu.zeroed(0)?;
    gpu.write(&numbers, &[])?;
    gpu.dispatch(&kernel, &[&count, &numbers], &sums, groups_for(0, 64)?)?;
    gpu.dispatch(&kernel, &[&count, &numbers], &sums, [1, 1, 1])?;
    check(numbers.is_empty() && sums.is_empty(), "not empty")?;
    check(gpu.read(&sums)?.is_empty(), "words out of nowhere")
}

fn rows_of_groups(gpu: &Gpu) -> Result<(), Failed> {
    let kernel = gpu.kernel("count up", COUNT_UP, "main", &[Space::Storage; 1])?;
    let count = 200_001;
    let groups = groups_for(count, 1)?;
    check(groups[1] > 1, "one row is enough here")?;
    let input = gpu.upload(&[count])?;
    let indices = gpu.zeroed(count as usize)?;
    gpu.dispatch(&kernel, &[&input], &indices, groups)?;
    let read = gpu.read(&indices)?;
    check(read.into_iter().eq(1..=count), "an index is missing")
}

/// Each thread has error scopes of its own: the failures of one are not seen by another.
fn several_threads(gpu: &Gpu) -> Result<(), Failed> {
    thread::scope(|scope| {
        let good = scope.spawn(|| (0..8).try_for_each(|_| dispatches_accumulate(gpu)));
        let bad = scope.spawn(|| (0..8).try_for_each(|_| bad_shaders_are_errors(gpu)));
        good.join().expect("no panic")?;
        bad.join().expect("no panic")
    })
}

fn bad_shaders_are_errors(gpu: &Gpu) -> Result<(), Failed> {
    let not_wgsl = "fn main( {";
    let type_error = "@compute @workgroup_size(1) fn main() { let x: u32 = 1.0f; }";
    let no_entry = "@compute @workgroup_size(1) fn other() {}";
    let large_group = "@compute @workgroup_size(1024) fn main() {}";
    for wgsl in [not_wgsl, type_error, no_entry, large_group] {
        match gpu.kernel("bad", wgsl, "main", &[Space::Storage; 0]) {
            Err(GpuError::Shader { label, message }) => {
                check(label == "bad" && !message.is_empty(), "no message")?;
            }
            other => return Err(format!("{other:?} for {wgsl}").into()),
        }
    }
    // The place in the text is named, and the binding layout is checked against the text.
    let located = gpu.kernel("bad", type_error, "main", &[Space::Storage; 0]).err();
    let located = located.is_some_and(|error| error.to_string().contains("wgsl:1:"));
    check(located, "no position in the message")?;
    let bindings = gpu.kernel("bad", ADD_TWICE, "main", &[Space::Storage; 1]);
    check(matches!(bindings, Err(GpuError::Shader { .. })), "bindings unchecked")
}

fn misuse_is_an_error(gpu: &Gpu) -> Result<(), Failed> {
    let kernel = gpu.kernel("count up", COUNT_UP, "main", &[Space::Storage; 1])?;
    let input = gpu.upload(&[1])?;
    let output = gpu.zeroed(1)?;
    // Sizes.
    let many = gpu.dispatch(&kernel, &[&input], &output, [65_536, 1, 1]);
    check(matches!(many, Err(GpuError::TooLarge { .. })), "groups")?;
    let long = gpu.write(&input, &[1, 2]);
    check(matches!(long, Err(GpuError::TooLarge { .. })), "write")?;
    let huge = gpu.zeroed(usize::MAX);
    check(matches!(huge, Err(GpuError::TooLarge { .. })), "buffer")?;
    let wide = gpu.kernel("count up", COUNT_UP, "main", &[Space::Storage; 8]);
    check(matches!(wide, Err(GpuError::TooLarge { .. })), "bindings")?;
    // Buffers that do not fit the kernel: too few, and the same one read and written.
    let missing = gpu.dispatch(&kernel, &[], &output, [1, 1, 1]);
    check(matches!(missing, Err(GpuError::Driver { .. })), "missing")?;
    let aliased = gpu.dispatch(&kernel, &[&output], &output, [1, 1, 1]);
    check(matches!(aliased, Err(GpuError::Driver { .. })), "aliased")?;
    // None of it hurts what follows.
    gpu.dispatch(&kernel, &[&input], &output, [1, 1, 1])?;
    check(gpu.read(&output)? == [1], "wrong after the errors")
}

/// On a device of its own: the shared one is still needed.
fn loss_is_an_error(_: &Gpu) -> Result<(), Failed> {
    let gpu = open(Arithmetic::Free)?;
    let kernel = gpu.kernel("count up", COUNT_UP, "main", &[Space::Storage; 1])?;
    let input = gpu.upload(&[1])?;
    let output = gpu.zeroed(1)?;
    gpu.dispatch(&kernel, &[&input], &output, [1, 1, 1])?;
    gpu.close();
    let answers = [
        gpu.upload(&[1]).err(),
        gpu.write(&input, &[1]).err(),
        gpu.kernel("count up", COUNT_UP, "main", &[Space::Storage; 1]).err(),
        gpu.dispatch(&kernel, &[&input], &output, [1, 1, 1]).err(),
        gpu.read(&output).err(),
        gpu.wait().err(),
    ];
    let lost = answers.iter().all(|answer| matches!(answer, Some(GpuError::Lost { .. })));
    check(lost, &format!("after the loss: {answers:?}"))
}

fn check(holds: bool, message: &str) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(message.into()) }
}
