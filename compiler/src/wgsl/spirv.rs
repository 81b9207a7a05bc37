//! SPIR-V of a shader text, where wanted with each operation rounded by itself.
//!
//! WGSL lets a driver fuse and reassociate; nothing in the language forbids it. SPIR-V does: a result decorated with
//! `NoContraction` is computed as it is written, and an entry point can ask that signs of zeros are kept. naga writes
//! neither, so they are put in here. On a device whose single operations round correctly a scene then means the same as
//! on the CPU, bit for bit.

use super::WgslError;
use naga::back::spv;

/// How a device may compute.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arithmetic {
    /// As the driver likes: fused, reassociated.
    #[default]
    Free,
    /// Each operation rounded by itself, in the order written.
    Strict,
}

/// A compute shader in SPIR-V 1.3, and what a device must be told of its entry point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spirv {
    /// The words of the module.
    pub words: Vec<u32>,
    /// Invocations of a workgroup along x, y, z.
    pub workgroup_size: [u32; 3],
}

/// Words of a module before its first instruction.
const HEADER_WORDS: usize = 5;
const OP_EXTENSION: u32 = 10;
const OP_EXT_INST_IMPORT: u32 = 11;
const OP_MEMORY_MODEL: u32 = 14;
const OP_ENTRY_POINT: u32 = 15;
const OP_EXECUTION_MODE: u32 = 16;
const OP_CAPABILITY: u32 = 17;
const OP_DECORATE: u32 = 71;
const OP_MEMBER_DECORATE: u32 = 72;
const NO_CONTRACTION: u32 = 42;
/// A capability.
const SIGNED_ZERO_INF_NAN_PRESERVE: u32 = 4466;
/// The mode of an entry point that needs it.
const PRESERVE_SIGNED_ZERO_INF_NAN: u32 = 4461;
/// Opcodes of floating-point arithmetic: OpExtInst, OpFNegate, OpFAdd, OpFSub, OpFMul, OpFDiv, OpFRem, OpFMod,
/// products of vectors and matrices, OpDot.
const ARITHMETIC: [u32; 15] = [12, 127, 129, 131, 133, 136, 140, 141, 142, 143, 144, 145, 146, 147, 148];

/// Translates the entry point `entry` of a WGSL text, with strict arithmetic.
///
/// Loops are not bounded and indices not checked beyond what the text does: it is for texts of this crate, whose loops
/// have bounds and whose indices come from its own tables.
///
/// # Errors
///
/// [`WgslError`] if naga does not accept the text or cannot say it in SPIR-V.
pub fn strict_spirv(wgsl: &str, entry: &str) -> Result<Spirv, WgslError> {
    let (module, info) = super::read(wgsl)?;
    let point = module.entry_points.iter().find(|point| point.name == entry);
    let point = point.ok_or_else(|| untranslatable(format!("there is no entry point `{entry}`")))?;
    let options = spv::Options { force_loop_bounding: false, ..options() };
    let pipeline = spv::PipelineOptions { shader_stage: point.stage, entry_point: entry.to_owned() };
    let words = spv::write_vec(&module, &info, &options, Some(&pipeline))
        .map_err(|error| untranslatable(error.to_string()))?;
    Ok(Spirv { words: strict(&words), workgroup_size: point.workgroup_size })
}

/// The words of all entry points of a WGSL text, with checks of indices and of loops.
pub(crate) fn whole(wgsl: &str) -> Result<Vec<u32>, WgslError> {
    let (module, info) = super::read(wgsl)?;
    spv::write_vec(&module, &info, &options(), None).map_err(|error| untranslatable(error.to_string()))
}

/// Names make modules readable; by itself naga writes them in debug builds alone.
fn options() -> spv::Options<'static> {
    spv::Options {
        lang_version: (1, 3),
        flags: spv::WriterFlags::DEBUG | spv::WriterFlags::LABEL_VARYINGS,
        ..spv::Options::default()
    }
}

fn untranslatable(message: String) -> WgslError {
    WgslError::Translate { language: "SPIR-V", message }
}

/// The module with `NoContraction` on every result of floating-point arithmetic, and signs of zeros, infinities and what is
/// no number kept.
fn strict(words: &[u32]) -> Vec<u32> {
    let (mut capabilities, mut modes, mut decorations) = (Vec::new(), Vec::new(), Vec::new());
    capabilities.extend([(2 << 16) | OP_CAPABILITY, SIGNED_ZERO_INF_NAN_PRESERVE]);
    capabilities.extend(extension("SPV_KHR_float_controls"));
    for (_, words) in instructions(words) {
        match opcode(words[0]) {
            OP_ENTRY_POINT => {
                modes.extend([(4 << 16) | OP_EXECUTION_MODE, words[2], PRESERVE_SIGNED_ZERO_INF_NAN, 32]);
            }
            code if ARITHMETIC.contains(&code) => {
                decorations.extend([(3 << 16) | OP_DECORATE, words[2], NO_CONTRACTION]);
            }
            _ => {}
        }
    }
    // A module has in this order, among others: capabilities, extensions, entry points, modes, names, decorations.
    let first = |codes: &[u32]| {
        let place = instructions(words).find(|(_, words)| codes.contains(&opcode(words[0])));
        place.map_or(words.len(), |(place, _)| place)
    };
    let places = [
        (first(&[OP_EXTENSION, OP_EXT_INST_IMPORT, OP_MEMORY_MODEL]), capabilities),
        (first(&[OP_EXECUTION_MODE]), modes),
        (first(&[OP_DECORATE, OP_MEMBER_DECORATE]), decorations),
    ];
    let mut all = Vec::with_capacity(words.len() + places.iter().map(|(_, more)| more.len()).sum::<usize>());
    let mut done = 0;
    for (place, more) in places {
        all.extend(&words[done..place]);
        all.extend(more);
        done = place;
    }
    all.extend(&words[done..]);
    all
}

/// An `OpExtension`: its name as bytes, at least one 0 after them.
fn extension(name: &str) -> Vec<u32> {
    let bytes: Vec<u8> = name.bytes().chain([0; 4]).collect();
    let name = bytes.chunks_exact(4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]]));
    let mut words: Vec<u32> = [OP_EXTENSION].into_iter().chain(name).collect();
    words[0] |= (words.len() as u32) << 16;
    words
}

/// The instructions of a module, each with the index of its first word.
fn instructions(words: &[u32]) -> impl Iterator<Item = (usize, &[u32])> {
    let mut place = HEADER_WORDS;
    std::iter::from_fn(move || {
        let start = place;
        let length = (words.get(start)? >> 16) as usize;
        place += length.max(1);
        Some((start, words.get(start..place)?))
    })
}

fn opcode(first: u32) -> u32 {
    first & 0xffff
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "
        @group(0) @binding(0) var<storage, read_write> values: array<f32>;
        @compute @workgroup_size(4, 2)
        fn main(@builtin(local_invocation_index) i: u32) {
            let x = values[i];
            values[i] = ((x * x) + sqrt(x)) - (f32(i + 3u) / x);
        }";

    fn decorated(words: &[u32]) -> usize {
        instructions(words)
            .filter(|(_, words)| opcode(words[0]) == OP_DECORATE && words[2] == NO_CONTRACTION)
            .count()
    }

    #[test]
    fn arithmetic_on_floats_is_decorated() {
        let free = whole(TEXT).expect("it is WGSL");
        let strict = strict_spirv(TEXT, "main").expect("it is WGSL");
        assert_eq!(strict.workgroup_size, [4, 2, 1]);
        assert_eq!(decorated(&free), 0);
        // Multiply, square root, add, divide, subtract; not the sum of whole numbers.
        assert_eq!(decorated(&strict.words), 5);
        // With them an execution mode.
        let preserves =
            |words: &[u32]| words.windows(2).any(|pair| pair == [PRESERVE_SIGNED_ZERO_INF_NAN, 32]);
        assert_eq!((preserves(&strict.words), preserves(&free)), (true, false));
    }

    #[test]
    fn what_cannot_be_said_is_an_error() {
        assert!(matches!(strict_spirv("fn f( {", "main"), Err(WgslError::Parse { .. })));
        assert!(matches!(strict_spirv(TEXT, "other"), Err(WgslError::Translate { .. })));
    }
}
