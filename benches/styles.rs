//! Tables 1 and 2 and the figures of figures 21 and 22 of Kol et al. 2016, and the time of its light map, measured here: Markdown
//! on standard output, for docs/styles.md.
//!
//! ```text
//! cargo bench --bench styles -- stages | closings | heterogeneity | light-map
//! ```

use std::path::Path;
use std::time::Instant;

use vol::session::{Moment, Session, load};
use vol_compiler::frame::Frame;
use vol_compiler::skip::Skips;
use vol_runtime_cpu::style::{self, StageTimes};

/// Full HD, as in the paper.
const SIZE: [u32; 2] = [1920, 1080];

/// Rounds of which the least time counts.
const ROUNDS: usize = 5;

/// A line of a table of the paper: map, and milliseconds there.
type Printed<const N: usize> = (u32, [f64; N]);

fn main() {
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "stages" => stages(),
            "closings" => closings(),
            "heterogeneity" => heterogeneity(),
            "light-map" => light_map(),
            _ => {}
        }
    }
}

/// A scene of examples/styles with one of its styles on.
fn scene(name: &str, look: u32) -> (Session, Frame) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/styles").join(format!("{name}.vol"));
    let session = load(&path, Skips::ALL).unwrap_or_else(|failure| panic!("{failure:?}"));
    let params = session.params(&[("look".to_owned(), look.to_string())]).expect("the scene has looks");
    let frame = session.frame(&params, Moment { time: 0.0, frame: 0.0 }, SIZE).expect("a frame");
    (session, frame)
}

/// Table 1: the parts of hole creation with a transfer function, for the tree.
fn stages() {
    const PAPER: [Printed<5>; 3] = [
        (512, [1.3, 0.1, 4.0, 1.6, 0.2]),
        (1024, [1.6, 0.3, 3.9, 2.5, 0.2]),
        (2048, [4.0, 1.4, 4.1, 4.6, 0.2]),
    ];
    let (session, frame) = scene("tree", 1);
    println!("| map | shadow map | holes | slices | first surfaces | visibility | transfer function |");
    println!("|---|---|---|---|---|---|---|");
    for (map, [shadow_map, holes, surfaces, visibility, transfer]) in PAPER {
        println!("| {map}, paper | {shadow_map} | {holes} | - | {surfaces} | {visibility} | {transfer} |");
        let times = || style::stage_times(&session.program, &frame, SIZE, map).expect("the tree has a style");
        let all: Vec<StageTimes> = (0..2).map(|_| times()).collect();
        let least = |part: fn(&StageTimes) -> f64| all.iter().map(part).fold(f64::INFINITY, f64::min);
        println!(
            "| {map} | {:.0} | {:.1} | {:.1} | {:.0} | {:.1} | {:.1} |",
            least(|t| t.shadow_map),
            least(|t| t.holes),
            least(|t| t.slices),
            least(|t| t.surfaces),
            least(|t| t.visibility),
            least(|t| t.transfer),
        );
    }
}

/// Table 2: closings by disks and along epipolar lines.
fn closings() {
    const DIAMETERS: [f32; 3] = [11.0, 21.0, 41.0];
    const LENGTHS: [usize; 3] = [15, 30, 60];
    const PAPER: [Printed<6>; 3] = [
        (512, [1.1, 3.7, 13.3, 0.6, 1.1, 1.9]),
        (1024, [4.5, 15.4, 56.7, 1.7, 2.9, 5.2]),
        (2048, [18.0, 60.9, 222.0, 5.4, 9.3, 16.8]),
    ];
    let (session, frame) = scene("tree", 1);
    println!("| map | disk 11 | disk 21 | disk 41 | epipolar 15 | epipolar 30 | epipolar 60 |");
    println!("|---|---|---|---|---|---|---|");
    for (map, paper) in PAPER {
        let row = |numbers: &[f64]| numbers.iter().map(|x| format!(" {x:.2} |")).collect::<String>();
        println!("| {map}, paper |{}", row(&paper));
        let times = style::closing_times(&session.program, &frame, map, &DIAMETERS, &LENGTHS);
        println!("| {map} |{}", row(&times.expect("the tree has a style").concat()));
    }
}

/// Figures 21 and 22: error and time against steps and upsampling.
fn heterogeneity() {
    let (session, frame) = scene("tree", 7);
    let measure = |steps, upsample| {
        let rounds = if steps > 16 { 1 } else { ROUNDS };
        let found =
            || style::heterogeneity(&session.program, &frame, SIZE, steps, upsample).expect("it varies");
        let mut best = found();
        for _ in 1..rounds {
            best.1 = best.1.min(found().1);
        }
        best
    };
    let (wanted, _) = measure(2048, 1);
    let level = (wanted.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / wanted.len() as f64).sqrt();
    println!("| steps | upsampling | relative rms | largest difference | ms | paper, ms |");
    println!("|---|---|---|---|---|---|");
    let rows = [
        (2048, 1, "117"),
        (64, 1, "4.03, 4.26"),
        (16, 1, "0.95"),
        (4, 1, "0.29"),
        (64, 4, "0.327"),
        (64, 16, "0.0678"),
    ];
    for (steps, upsample, paper) in rows {
        let (found, milliseconds) = measure(steps, upsample);
        let apart = found.iter().zip(&wanted).map(|(a, b)| f64::from(a - b).abs());
        let rms = (apart.clone().map(|x| x * x).sum::<f64>() / wanted.len() as f64).sqrt() / level;
        let most = apart.fold(0.0, f64::max);
        println!("| {steps} | {upsample} | {rms:.1e} | {most:.1e} | {milliseconds:.1} | {paper} |");
    }
}

/// The light map of the citadel.
fn light_map() {
    let (session, frame) = scene("citadel", 6);
    println!("| pixels | map | iterations | converged | residual | s |");
    println!("|---|---|---|---|---|---|");
    let started = Instant::now();
    let prepared = style::prepare(&session.program, &frame, SIZE, &session.pictures, &|_| None);
    let seconds = started.elapsed().as_secs_f64();
    for map in prepared.expect("the strokes are in the picture").light_maps {
        let fit = map.fit.expect("nothing is known");
        let (pixels, size, iterations) = (fit.pixels, map.table.size, fit.iterations);
        println!(
            "| {pixels} | {size} | {iterations} | {} | {:.3} | {seconds:.2} |",
            fit.converged, fit.residual
        );
    }
    println!("| 41240, paper | 512 | 32 | | | 2.04 |");
}
