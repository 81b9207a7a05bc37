//! How much memory a render may take, known before it starts: a bound, not an estimate.
//!
//! In: a program, a frame, a job, the number of threads and the grids of lights that were filled. Out: bytes. What is
//! counted is told beside each constant; sizes of single numbers are those of the types in memory, rounded up.
//! The scene's text, its graph and the compiler's own memory do not count: they are there before.

use super::filled_grids::FilledGrids;
use super::scene::Batches;
use crate::interp::{LANES, Tapes, local};
use vol_compiler::frame::{Frame, Job};
use vol_compiler::ir::{Function, FunctionId, Inst};
use vol_compiler::program::Program;
use vol_compiler::skip::Skip;

/// Of a pixel: what its rays bring back, twice while tiles are put together; the picture, and that of the frame
/// before; the channels of a file before and after they are packed.
const PER_PIXEL: usize = 320;

/// Of an instruction, as a step of a tape and while that is made; tapes may be there twice.
const PER_INSTRUCTION: usize = 192;

/// Of a number of the frame: in both precisions, and while it is computed.
const PER_UNIFORM: usize = 32;

/// Of a piece of a curve: its words and control points, its part of the boxes, and a copy of all that.
const PER_PIECE: usize = 768;

/// Of a register, beside one number for each point of a batch.
const REGISTER: usize = 32;

/// Of a place along a ray: its position, up to ten numbers of a medium and what becomes of them.
const PER_PLACE: usize = 512;

/// Of a place in each medium, all of which are there at once.
const PER_PLACE_AND_MEDIUM: usize = 384;

/// Of a ray and a solid: the part of the ray in its box, for a camera ray and one towards a light.
const PER_RAY_AND_SOLID: usize = 64;

/// Places along a ray beside those of its nodes: neighbours, walls, ends.
const FURTHER_PLACES: usize = 4;

/// Rays of a tile and what they bring back, before the next test of adaptive sampling.
const TILE: usize = 4 << 20;

/// What an allocator keeps for a thread, and its stack.
const THREAD: usize = 6 << 20;

/// What the process takes to start rendering, whatever the scene.
const BASE: usize = 16 << 20;

/// Most bytes that a picture takes on the CPU: choosing how to sample it, rendering and writing it.
#[must_use]
pub fn memory_bound(
    program: &Program,
    frame: &Frame,
    job: &Job,
    threads: usize,
    filled: &FilledGrids,
) -> u64 {
    let module = &program.module;
    let tapes = Tapes::new(program);
    let functions = (0..module.functions.len() as u32).map(FunctionId);
    let registers = functions.map(|id| tapes.tape(id).all_registers()).max().unwrap_or(0);
    let instructions: usize = module.functions.iter().map(instructions).sum();
    let pieces: usize =
        frame.curve_tables.iter().map(|table| table.pieces.len() + table.segments.len()).sum();
    let scene = PER_INSTRUCTION * instructions
        + PER_UNIFORM * (frame.uniforms.len() + module.frame.insts.len())
        + PER_PIECE * pieces;
    let batches = Batches::for_media(frame.media.len());
    let places = batches.rays * (batches.nodes as usize + FURTHER_PLACES);
    let thread = registers * (LANES * size_of::<f32>() + REGISTER)
        + places * (PER_PLACE + PER_PLACE_AND_MEDIUM * frame.media.len())
        + batches.rays * PER_RAY_AND_SOLID * frame.objects.len()
        + TILE
        + THREAD;
    let local = if frame.skips.has(Skip::Tapes) { local::most_bytes(module, frame, threads) } else { 0 };
    // The grid of a light map is gone before those of lights are filled, but an allocator may keep its pages.
    let grids = filled.most_bytes() + crate::style::most_bytes(frame);
    let picture = PER_PIXEL as u64 * u64::from(job.size[0]) * u64::from(job.size[1]);
    picture + (BASE + scene + local + threads * thread + grids) as u64
}

/// Instructions of a function, those of its loops included.
fn instructions(function: &Function) -> usize {
    let within = |inst: &Inst| match inst {
        Inst::Loop { body, .. } => 1 + instructions(body),
        Inst::Constant(_)
        | Inst::Boolean(_)
        | Inst::Input(_)
        | Inst::Uniform(_)
        | Inst::Apply { .. }
        | Inst::Extract(..) => 1,
    };
    function.insts.iter().map(within).sum()
}
