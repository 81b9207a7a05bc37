use super::words::{HEADER_WORDS, INFINITE, LIGHT_WORDS, MEDIUM_WORDS, OBJECT_WORDS};
use super::*;
use crate::families::KeptFamilies;
use crate::frame::{
    Aabb, CameraFrame, Counts, GridColumn, LightFrame, LightGrid, MediumFrame, ObjectFrame, Quadrature,
    Sampling, Stride,
};
use crate::ir::FunctionId;
use crate::ir::text;
use crate::program::{Camera, Extent, Light, LightKind, Lighting, Medium, Object, Render, Slot};
use crate::skip::Skips;
use crate::tape::KeptTapes;
use vol_language::source::Span;

const NOWHERE: Slot = Slot(0);

/// Objects and media of constant functions.
fn program(objects: usize, media: usize) -> Program {
    let function = |inputs: u32, outputs: usize| {
        let body = format!("fn f({inputs}) {{\n%0 = constant 0.5\nreturn{}\n}}", " %0".repeat(outputs));
        text::parse_function(&body).expect("well-formed text")
    };
    let mut module = text::parse_module("frame(1) {\n%0 = input 0\nreturn %0\n}").expect("well-formed text");
    module.functions =
        [(3, 1), (3, 3), (3, 10), (3, 10), (2, 1), (3, 4)].map(|(i, o)| function(i, o)).to_vec();
    let object = Object {
        name: "ball".to_owned(),
        whole: 0,
        distance: FunctionId(0),
        gradient: FunctionId(1),
        steepness: None,
        surface: FunctionId(2),
        shows_normals: false,
        steady: true,
        extent: Extent::Unbounded,
        enabled: NOWHERE,
        span: Span::default(),
    };
    let medium = Medium {
        name: "gas".to_owned(),
        region: FunctionId(0),
        interior: FunctionId(3),
        extinction: FunctionId(5),
        phase: FunctionId(4),
        lighting: Lighting::Shadowed,
        extent: Extent::Unbounded,
        enabled: NOWHERE,
        span: Span::default(),
    };
    Program {
        module,
        params: Vec::new(),
        measures: Vec::new(),
        curves: Vec::new(),
        tubes: Vec::new(),
        objects: vec![object; objects],
        media: vec![medium; media],
        lights: vec![lamp(); 3],
        styles: Vec::new(),
        images: Vec::new(),
        camera: Camera { from: None, at: None, up: [NOWHERE; 3], fov: NOWHERE },
        render: Render {
            size: [4, 4],
            background: [NOWHERE; 3],
            samples: None,
            adaptive: NOWHERE,
            duration: NOWHERE,
            fps: NOWHERE,
        },
        fields: Vec::new(),
        report: Vec::new(),
        origins: Vec::new(),
        skips: Skips::ALL,
        tapes: KeptTapes::default(),
        families: KeptFamilies::default(),
    }
}

fn lamp() -> Light {
    Light {
        name: "sun".to_owned(),
        kind: LightKind::Distant([NOWHERE; 3]),
        color: [NOWHERE; 3],
        shadows: NOWHERE,
        size: None,
        occlusion: None,
        enabled: NOWHERE,
    }
}

fn frame(program: &Program) -> Frame {
    let whole = Aabb { lo: [f32::NEG_INFINITY; 3], hi: [f32::INFINITY; 3] };
    let (object, medium) = (&program.objects[1], &program.media[0]);
    Frame {
        uniforms: vec![0.0],
        uniforms_f32: vec![0.0],
        curves: Vec::new(),
        curve_tables: Vec::new(),
        camera: CameraFrame {
            origin: [1.0, 2.0, 3.0],
            forward: [4.0, 5.0, 6.0],
            right: [7.0, 8.0, 9.0],
            up: [10.0, 11.0, 12.0],
        },
        objects: vec![ObjectFrame {
            index: 1,
            whole: 1,
            distance: object.distance,
            gradient: object.gradient,
            surface: object.surface,
            shows_normals: true,
            bounds: whole,
            stride: Stride::Scale(0.25),
        }],
        media: vec![MediumFrame {
            index: 0,
            region: medium.region,
            interior: medium.interior,
            extinction: medium.extinction,
            phase: medium.phase,
            lighting: Lighting::Unshadowed,
            bounds: Aabb { lo: [0.0; 3], hi: [0.0; 3] },
            cells: vec![Aabb { lo: [0.0; 3], hi: [0.0; 3] }, Aabb { lo: [-1.0; 3], hi: [0.0; 3] }],
            spacing: 16,
        }],
        lights: vec![LightFrame {
            distant: true,
            position: [0.0, 1.0, 0.0],
            color: [2.0; 3],
            shadows: true,
            size: 0.0,
            occlusion: 0.0,
        }],
        light_grids: Vec::new(),
        styles: Vec::new(),
        styled_lights: Vec::new(),
        background: [13.0, 14.0, 15.0],
        bounds: whole,
        skips: Skips::ALL,
    }
}

#[test]
fn modules_are_accepted() {
    for (objects, media) in [(0, 0), (1, 0), (0, 1), (3, 2), (0, MOST_WRITTEN_OUT + 1)] {
        for quadrature in [Quadrature::Midpoint, Quadrature::Corrected] {
            let text = render_module(&program(objects, media), quadrature, WORKGROUP);
            assert!(
                text.is_ok_and(|shader| shader.text.contains("fn render(")),
                "{objects} objects, {media} media"
            );
        }
    }
}

#[test]
fn loops_over_few_media_are_written_out() {
    let text = |media| integrator(&program(0, media), Quadrature::Midpoint);
    let (none, two, many) = (text(0), text(2), text(MOST_WRITTEN_OUT + 1));
    assert!(!none.contains("let medium ="));
    let loops = many.matches(MEDIA_LOOP).count();
    assert!(loops > 10 && !two.contains(MEDIA_LOOP));
    assert_eq!(two.matches("let medium = 1u;").count(), loops);
    assert_eq!(
        written_out("{\n  for (var medium = 0u; medium < MEDIUM_COUNT; medium++) {\n    a\n  }\n}\n", 2),
        "{\n  {\n      let medium = 0u;\n    a\n  }\n  {\n      let medium = 1u;\n    a\n  }\n}\n"
    );
}

#[test]
fn words_stand_where_the_shader_looks() {
    let program = program(2, 1);
    let job = Job {
        size: [40, 30],
        step: 0.1,
        shadow_step: 0.2,
        quadrature: Quadrature::Corrected,
        sampling: Sampling { most: 33, tolerance: 0.25 },
    };
    let words = frame_words(&program, &frame(&program), &job, [8, 16, 24, 32], 5);
    let words: Vec<f32> = words.into_iter().map(f32::from_bits).collect();
    assert_eq!(words[..8], [8.0, 16.0, 24.0, 32.0, 40.0, 30.0, 0.1, 0.2]);
    assert_eq!(words[8..24], [1., 2., 3., 4., 5., 6., 7., 8., 9., 10., 11., 12., 13., 14., 15., 1.]);
    assert_eq!(words[24..27], [33.0, 0.25, 5.0]);
    let text = glue(&program, Quadrature::Midpoint);
    let place = |name: &str| -> usize {
        let line = text.lines().find_map(|line| line.strip_prefix(&format!("const {name}: u32 = ")));
        line.and_then(|line| line.strip_suffix("u;")?.parse().ok()).expect("a constant of the glue")
    };
    assert_eq!(place("AT_OBJECTS"), 27);
    let (objects, media, lights) = (place("AT_OBJECTS"), place("AT_MEDIA"), place("AT_LIGHTS"));
    assert_eq!(words[objects..objects + 8], [0.0; 8], "an absent object");
    let (lo, hi) = (-INFINITE * 1.00001, INFINITE * 1.00001);
    assert_eq!(words[objects + 8..media], [2.0, lo, lo, lo, hi, hi, hi, 0.25]);
    assert_eq!(words[media..lights], [2.0, 0., 0., 0., 0., 0., 0., 2.0, 16.0]);
    assert_eq!(words[lights..lights + 11], [1.0, 0.0, 1.0, 0.0, 2.0, 2.0, 2.0, 1.0, 0.0, 0.0, 0.0]);
    let by = 1e-5;
    let cells = [[-by; 3], [by; 3], [-1.0 - by; 3], [by; 3]].concat();
    assert_eq!(words[place("AT_CELLS")..][..cells.len()], cells);
    assert_eq!(words.len(), (place("AT_CELLS") + 384).next_multiple_of(4), "64 cells for each medium");
    assert!(input_words(&program, &frame(&program)).is_empty());
}

#[test]
fn grids_stand_where_the_records_say() {
    let program = program(2, 1);
    let mut frame = frame(&program);
    let sun = frame.lights[0];
    frame.lights = vec![sun; 3];
    let grid = |depths: Vec<f32>| {
        let [a, b, c] = [[2.0; 3], [3.0; 3], [4.0; 3]];
        let (counts, tint) = ([2, 2, 5], [0.5, 1.0, 2.0]);
        let colored = depths.len() > 20;
        let (distant, origin, axes) = (true, [1.0; 3], [a, b, c]);
        let (lo, scale, spline) = ([5.0; 3], [6.0; 3], colored);
        let column = |at: u32| GridColumn { first: 1, count: 3, at };
        let columns = [0, 4, 8, 12].map(column).to_vec();
        let grid =
            LightGrid { distant, origin, axes, lo, scale, counts, tint, colored, spline, columns, depths };
        Some(std::sync::Arc::new(grid))
    };
    frame.light_grids = vec![grid(vec![7.0; 20]), None, grid(vec![9.0; 60])];
    let job = Job {
        size: [4, 4],
        step: 0.1,
        shadow_step: 0.2,
        quadrature: Quadrature::Midpoint,
        sampling: Sampling::CENTRE,
    };
    let words = frame_words(&program, &frame, &job, [0; 4], 1);
    let depths = input_words(&program, &frame);
    let word = |at: usize| f32::from_bits(words[at]);
    let depth_at = |at: usize| f32::from_bits(depths[at]);
    let lights = HEADER_WORDS + 2 * OBJECT_WORDS + MEDIUM_WORDS;
    let [first, none, last] = [0, 1, 2].map(|light| word(lights + LIGHT_WORDS * light + 10) as usize);
    assert_eq!(none, 0);
    for (record, channels, depth, count) in [(first, 1.0, 7.0, 20), (last, 3.0, 9.0, 60)] {
        assert_eq!((word(record), word(record + 4), word(record + 16)), (1.0, 2.0, 6.0));
        assert_eq!([19, 20, 21, 22, 24, 25].map(|at| word(record + at)), [2.0, 2.0, 5.0, 0.5, 2.0, channels]);
        assert_eq!(word(record + 27), f32::from(u8::from(channels > 1.0)), "a spline");
        let first = word(record + 26) as usize;
        // Four columns of three words, then the depths.
        assert_eq!(first % 64, 0);
        for column in 0..4 {
            let words = [0, 1, 2].map(|word| depth_at(first + 3 * column + word));
            assert_eq!(words, [1.0, 2.0, (3 + column) as f32]);
        }
        assert_eq!([first + 12, first + 11 + count].map(depth_at), [depth; 2]);
    }
    assert_eq!(depths.len(), word(last + 26) as usize + 12 + 60);
}

#[test]
fn empty_boxes_are_nothing() {
    assert_eq!(padded(&Aabb { lo: [0.0, 1.0, 0.0], hi: [1.0, 0.0, 1.0] }), None);
    let grown = padded(&Aabb { lo: [0.0; 3], hi: [1.0, 2.0, 4.0] }).expect("not empty");
    assert!(grown.lo.iter().all(|&x| x < 0.0 && x > -1e-4) && grown.hi[2] > 4.0);
}

#[test]
fn cells_are_used_if_they_say_more_than_the_box() {
    let program = program(2, 1);
    let mut medium = frame(&program).media[0].clone();
    let cell = |lo: f32, hi: f32| Aabb { lo: [lo; 3], hi: [hi; 3] };
    medium.cells = vec![cell(0.0, 1.0), cell(f32::INFINITY, f32::NEG_INFINITY), cell(2.0, 4.0)];
    let padded = padded_cells(&medium);
    assert_eq!(padded.len(), 2, "an empty cell is nothing");
    assert!(padded[1].lo[0] < 2.0 && padded[1].hi[0] > 4.0 && padded[1].hi[0] < 4.001);
    medium.cells[0].hi[1] = f32::INFINITY;
    assert_eq!(padded_cells(&medium), []);
    medium.cells.truncate(1);
    assert_eq!(padded_cells(&medium), []);
}

#[test]
fn depth_without_a_surface_is_infinite() {
    let first = ([1.0, 2.0, 3.0, 0.5, 0.25, 0.125, 1e30_f32], [1, 2, 3, 1, 1]);
    let second = ([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 7.0], [4, 5, 4_000_000_000, 2, 2]);
    let spreads = [0.5_f32.to_bits(); 2];
    let words = [first, second]
        .map(|(floats, counts)| {
            [&floats.map(f32::to_bits)[..], &counts[..], &spreads[..], &[0.25_f32.to_bits()]].concat()
        })
        .concat();
    let image = unpack(2, 1, &words);
    assert_eq!(counts(&words), Counts { camera_rays: 3, rays: 5, samples: 7, evaluations: 4_000_000_003 });
    assert_eq!(image.pixels[0].depth, f32::INFINITY);
    assert_eq!(image.pixels[0].transmittance, [0.5, 0.25, 0.125]);
    assert_eq!(image.pixels[1].depth, 7.0);
    assert_eq!(image.pixels[1].error, 0.25);
}

#[test]
fn loops_have_the_bounds_that_are_told() {
    let text = INTEGRATOR.iter().chain(&styles::STYLED).copied().collect::<Vec<_>>().join("\n");
    for (name, most, _) in LOOP_BOUNDS {
        let spelled = [format!("const {name}: u32 = {most}u;"), format!("const {name}: i32 = {most};")];
        assert!(spelled.iter().any(|line| text.contains(line)), "{name}");
    }
}
