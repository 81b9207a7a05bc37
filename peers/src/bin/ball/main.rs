//! A whole picture by vol beside a program that was written by hand for this scene alone: a ball of noise that shadows itself.
//!
//! The program is what one would write for a processor with AVX-512 who has only this scene in mind: sixteen rays at once, nothing
//! general, the numbers of the scene in the text. vol reads the scene and chooses its steps itself. Both are
//! held against one reference, in turns on the same threads, and the least time of each counts. Prints a table in Markdown.

mod ladder;
mod lanes;
mod light_grid;
mod march;
mod noise;
mod ours;
mod points;
mod reference;
mod scene;

use ladder::{Ladder, Way};
use march::Renderer;
use noise::Noise;
use ours::Vol;
use pulp::x86::V4;
use reference::Reference;
use std::time::Instant;

/// Errors that vol is asked for.
const MAX_ERRORS: [f32; 4] = [3e-2, 1e-2, 3e-3, 1e-3];

/// The error that vol is asked for where it is to check the reference.
const CHECK: f32 = 1e-4;

/// Ways by hand: steps towards the light, and distances of points of its grid, over the steps from the eye. The best for each error
/// counts.
const MARCHES: [f32; 3] = [1.4, 1.8, 2.3];
const GRIDS: [f32; 3] = [0.8, 1.0, 1.2];

/// Rounds of all measurements.
const ROUNDS: usize = 5;

/// A picture that is asked of vol.
struct Asked {
    max_error: f32,
    error: f64,
    /// The least of all rounds, from the numbers of the scene to the picture.
    milliseconds: f64,
    /// The part of it that steps and the grid were chosen in.
    choosing: f64,
}

fn main() {
    let Some(simd) = V4::try_new() else {
        println!("Not measured: this machine has no AVX-512.");
        return;
    };
    let renderer = Renderer { simd, noise: Noise::new() };
    let reference = Reference::new(&renderer);
    let vol = Vol::new();
    println!(
        "{} threads. The rms of the picture is {:.4}. The last halving of the steps changed the reference by {:.0e}; vol, asked for {CHECK:.0e}, is \
         {:.1e} from it.",
        rayon::current_num_threads(),
        reference.rms(),
        reference.change,
        reference.error(&vol.render(CHECK).picture),
    );
    let mut asked = MAX_ERRORS.map(|max_error| {
        let error = reference.error(&vol.render(max_error).picture);
        Asked { max_error, error, milliseconds: f64::INFINITY, choosing: f64::INFINITY }
    });
    let finest = asked.iter().map(|asked| asked.error).fold(f64::INFINITY, f64::min);
    let ladder = |way| Ladder::new(&renderer, &reference, way, finest);
    let mut marches = MARCHES.map(|ratio| ladder(Way::March(ratio)));
    let mut grids = GRIDS.map(|ratio| ladder(Way::Grid(ratio)));
    for _ in 0..ROUNDS {
        asked.iter_mut().for_each(|asked| asked.measure(&vol));
        marches.iter_mut().chain(&mut grids).for_each(|ladder| ladder.measure(&renderer));
    }
    print(&asked, &marches, &grids);
}

impl Asked {
    fn measure(&mut self, vol: &Vol) {
        let started = Instant::now();
        let rendered = std::hint::black_box(vol.render(self.max_error));
        let milliseconds = started.elapsed().as_secs_f64() * 1e3;
        if milliseconds < self.milliseconds {
            (self.milliseconds, self.choosing) = (milliseconds, rendered.choosing);
        }
    }
}

fn print(asked: &[Asked], marches: &[Ladder], grids: &[Ladder]) {
    println!();
    println!(
        "| asked of vol | error | vol, ms | of that choosing, ms | marching by hand, ms | vol over that | with a grid by hand, ms | vol over that |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    for Asked { max_error, error, milliseconds, choosing } in asked {
        let columns = [marches, grids].map(|ladders| {
            let times = ladders.iter().filter_map(|ladder| ladder.milliseconds_at(*error));
            let columns =
                times.reduce(f64::min).map(|time| format!("{time:.1} | {:.2}", milliseconds / time));
            columns.unwrap_or_else(|| "| ".to_owned())
        });
        println!(
            "| {max_error:.0e} | {error:.1e} | {milliseconds:.0} | {choosing:.0} | {} | {} |",
            columns[0], columns[1]
        );
    }
}
