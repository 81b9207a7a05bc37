//! Scenes built by hand.

use super::super::{Batches, Stats, Watch, render_batches};
use std::sync::atomic::AtomicBool;
use vol_compiler::families::KeptFamilies;
use vol_compiler::frame::{
    Aabb, CameraFrame, Frame, Image, Job, LightFrame, MediumFrame, ObjectFrame, Pixel, Quadrature, Sampling,
    Stride,
};
use vol_compiler::ir::{Function, FunctionId, Inst, Module, Number, ValueId};
use vol_compiler::ops::Op;
use vol_compiler::program::{Camera, Extent, Lighting, Medium, Object, Program, Render, Slot};
use vol_compiler::skip::Skips;
use vol_compiler::tape::KeptTapes;

/// A function in the making.
pub(super) struct Body {
    function: Function,
}

impl Body {
    pub(super) fn new(name: &str, inputs: u32) -> Self {
        let mut function = Function { name: name.to_owned(), inputs, ..Function::default() };
        function.insts = (0..inputs).map(Inst::Input).collect();
        Self { function }
    }

    fn push(&mut self, inst: Inst) -> ValueId {
        self.function.insts.push(inst);
        ValueId(self.function.insts.len() as u32 - 1)
    }

    pub(super) fn input(&self, index: u32) -> ValueId {
        ValueId(index)
    }

    pub(super) fn number(&mut self, number: f64) -> ValueId {
        self.push(Inst::Constant(Number(number)))
    }

    pub(super) fn apply(&mut self, op: Op, args: &[ValueId]) -> ValueId {
        self.push(Inst::Apply { op, data: 0, args: args.to_vec() })
    }

    /// The position relative to a centre.
    pub(super) fn relative_to(&mut self, centre: [f64; 3]) -> [ValueId; 3] {
        [0, 1, 2].map(|axis| {
            let offset = self.number(centre[axis]);
            self.apply(Op::Sub, &[ValueId(axis as u32), offset])
        })
    }

    pub(super) fn length(&mut self, v: [ValueId; 3]) -> ValueId {
        let squares = v.map(|x| self.apply(Op::Mul, &[x, x]));
        let flat = self.apply(Op::Add, &[squares[0], squares[1]]);
        let sum = self.apply(Op::Add, &[flat, squares[2]]);
        self.apply(Op::Sqrt, &[sum])
    }

    pub(super) fn finish(mut self, outputs: &[ValueId]) -> Function {
        self.function.outputs = outputs.to_vec();
        self.function
    }
}

/// A function that is the same everywhere.
pub(super) fn constant(name: &str, inputs: u32, values: &[f64]) -> Function {
    let mut body = Body::new(name, inputs);
    let outputs: Vec<_> = values.iter().map(|&value| body.number(value)).collect();
    body.finish(&outputs)
}

/// Signed distance and gradient of a sphere; `scale` makes the field steeper than a distance.
pub(super) fn sphere(centre: [f64; 3], radius: f64, scale: f64) -> [Function; 2] {
    let mut distance = Body::new("distance", 3);
    let from = distance.relative_to(centre);
    let length = distance.length(from);
    let (radius, factor) = (distance.number(radius), distance.number(scale));
    let signed = distance.apply(Op::Sub, &[length, radius]);
    let scaled = distance.apply(Op::Mul, &[signed, factor]);

    let mut gradient = Body::new("gradient", 3);
    let from = gradient.relative_to(centre);
    let length = gradient.length(from);
    let tiny = gradient.number(1e-20);
    let divisor = gradient.apply(Op::Max, &[length, tiny]);
    let factor = gradient.number(scale);
    let slopes = from.map(|x| {
        let unit = gradient.apply(Op::Div, &[x, divisor]);
        gradient.apply(Op::Mul, &[unit, factor])
    });
    [distance.finish(&[scaled]), gradient.finish(&slopes)]
}

/// Signed distance and gradient of the half space below a height.
pub(super) fn floor(height: f64) -> [Function; 2] {
    let mut distance = Body::new("floor", 3);
    let level = distance.number(height);
    let signed = distance.apply(Op::Sub, &[ValueId(1), level]);
    [distance.finish(&[signed]), constant("up", 3, &[0.0, 1.0, 0.0])]
}

/// Signed distance of a box about the origin (a lower bound outside its edges).
pub(super) fn cuboid(half: [f64; 3]) -> Function {
    let mut body = Body::new("box", 3);
    let sides = [0, 1, 2].map(|axis| {
        let size = body.apply(Op::Abs, &[ValueId(axis)]);
        let half = body.number(half[axis as usize]);
        body.apply(Op::Sub, &[size, half])
    });
    let flat = body.apply(Op::Max, &[sides[0], sides[1]]);
    let all = body.apply(Op::Max, &[flat, sides[2]]);
    body.finish(&[all])
}

/// A program and the frame of it, growing together.
pub(crate) struct World {
    pub(crate) program: Program,
    pub(crate) frame: Frame,
    pub(super) quadrature: Quadrature,
}

/// What a test medium is made of.
pub(crate) struct Gas {
    pub(super) region: Function,
    pub(super) interior: Function,
    pub(super) extinction: Function,
    pub(super) phase: Function,
    pub(super) lighting: Lighting,
    pub(super) bounds: Aabb,
}

impl Gas {
    /// The same everywhere in a box, with an isotropic phase function.
    pub(crate) fn uniform(
        half: [f64; 3],
        scattering: [f64; 3],
        extinction: [f64; 3],
        emission: [f64; 3],
        lighting: Lighting,
    ) -> Self {
        Self {
            region: cuboid(half),
            interior: constant("interior", 3, &[&[1.0][..], &scattering, &extinction, &emission].concat()),
            extinction: constant("extinction", 3, &[&[1.0][..], &extinction].concat()),
            phase: constant("phase", 2, &[0.25 / std::f64::consts::PI]),
            lighting,
            bounds: Aabb { lo: half.map(|x| -x as f32), hi: half.map(|x| x as f32) },
        }
    }
}

const NOWHERE: Slot = Slot(0);

impl World {
    /// Nothing, seen from `origin` along -z; the picture's half height is `slope` at distance 1.
    pub(crate) fn new(origin: [f32; 3], slope: f32) -> Self {
        let program = Program {
            measures: Vec::new(),
            module: Module::default(),
            params: Vec::new(),
            curves: Vec::new(),
            tubes: Vec::new(),
            objects: Vec::new(),
            media: Vec::new(),
            lights: Vec::new(),
            styles: Vec::new(),
            images: Vec::new(),
            camera: Camera { from: None, at: None, up: [NOWHERE; 3], fov: NOWHERE },
            render: Render {
                size: [16, 16],
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
        };
        let frame = Frame {
            uniforms: Vec::new(),
            uniforms_f32: Vec::new(),
            curves: Vec::new(),
            curve_tables: Vec::new(),
            camera: CameraFrame {
                origin,
                forward: [0.0, 0.0, -1.0],
                right: [slope, 0.0, 0.0],
                up: [0.0, slope, 0.0],
            },
            objects: Vec::new(),
            media: Vec::new(),
            lights: Vec::new(),
            light_grids: Vec::new(),
            styles: Vec::new(),
            styled_lights: Vec::new(),
            background: [0.0; 3],
            bounds: Aabb { lo: [-1.0; 3], hi: [1.0; 3] },
            skips: Skips::ALL,
        };
        Self { program, frame, quadrature: Quadrature::Midpoint }
    }

    fn function(&mut self, function: Function) -> FunctionId {
        self.program.module.functions.push(function);
        self.program.tapes = KeptTapes::default();
        self.program.families = KeptFamilies::default();
        FunctionId(self.program.module.functions.len() as u32 - 1)
    }

    /// Adds a solid with a constant surface.
    pub(super) fn solid(
        &mut self,
        [distance, gradient]: [Function; 2],
        surface: [f64; 10],
        bounds: Aabb,
        safe_scale: f32,
    ) {
        let [distance, gradient] = [self.function(distance), self.function(gradient)];
        let surface = self.function(constant("surface", 3, &surface));
        let index = self.program.objects.len();
        self.frame.objects.push(ObjectFrame {
            index,
            whole: index,
            distance,
            gradient,
            surface,
            shows_normals: false,
            bounds,
            stride: Stride::Scale(safe_scale),
        });
        self.program.objects.push(Object {
            name: "solid".to_owned(),
            whole: index,
            distance,
            gradient,
            steepness: None,
            surface,
            shows_normals: false,
            steady: true,
            extent: Extent::Unbounded,
            enabled: NOWHERE,
            span: Default::default(),
        });
    }

    /// Adds a sphere about a centre.
    pub(super) fn ball(&mut self, centre: [f64; 3], radius: f64, surface: [f64; 10]) {
        let corner = |side: f64| centre.map(|x| (x + side * radius) as f32);
        let bounds = Aabb { lo: corner(-1.0), hi: corner(1.0) };
        self.solid(sphere(centre, radius, 1.0), surface, bounds, 1.0);
    }

    /// Adds a medium.
    pub(crate) fn medium(&mut self, gas: Gas) {
        let [region, interior] = [self.function(gas.region), self.function(gas.interior)];
        let [extinction, phase] = [self.function(gas.extinction), self.function(gas.phase)];
        let index = self.program.media.len();
        let (lighting, bounds, cells) = (gas.lighting, gas.bounds, vec![gas.bounds]);
        let frame =
            MediumFrame { index, region, interior, extinction, phase, lighting, bounds, cells, spacing: 1 };
        self.frame.media.push(frame);
        self.program.media.push(Medium {
            name: "gas".to_owned(),
            region,
            interior,
            extinction,
            phase,
            lighting,
            extent: Extent::Unbounded,
            enabled: NOWHERE,
            span: Default::default(),
        });
    }

    /// Adds a distant light.
    pub(crate) fn sun(&mut self, direction: [f32; 3], color: [f32; 3]) {
        self.frame.lights.push(LightFrame {
            distant: true,
            position: direction,
            color,
            shadows: true,
            size: 0.0,
            occlusion: 0.0,
        });
    }

    /// Renders a square picture.
    pub(super) fn render(&self, size: u32, step: f32) -> Image {
        self.render_with(&self.job(size, step), Batches::DEFAULT)
    }

    /// Renders a square picture with both quadratures.
    pub(super) fn both(&self, size: u32, step: f32) -> [Image; 2] {
        [Quadrature::Midpoint, Quadrature::Corrected]
            .map(|quadrature| self.render_with(&Job { quadrature, ..self.job(size, step) }, Batches::DEFAULT))
    }

    /// The job of a square picture.
    fn job(&self, size: u32, step: f32) -> Job {
        let (size, quadrature) = ([size, size], self.quadrature);
        Job { size, step, shadow_step: step, quadrature, sampling: Sampling::CENTRE }
    }

    /// Renders a square picture and counts.
    pub(super) fn render_counted(&self, size: u32, step: f32) -> (Image, Stats) {
        let watch = Watch { progress: &|_| {}, cancelled: &AtomicBool::new(false) };
        render_batches(&self.program, &self.frame, &self.job(size, step), Batches::DEFAULT, &watch)
            .expect("not cancelled")
    }

    /// Renders with batches of other sizes.
    pub(super) fn render_with(&self, job: &Job, batches: Batches) -> Image {
        let watch = Watch { progress: &|_| {}, cancelled: &AtomicBool::new(false) };
        render_batches(&self.program, &self.frame, job, batches, &watch).expect("not cancelled").0
    }
}

/// Direction of the ray through a pixel of a square picture of [`World::new`], not normalised: z is -1.
pub(super) fn toward(size: u32, slope: f64, index: usize) -> [f64; 3] {
    let along = |pixel: usize| 2.0 * (pixel as f64 + 0.5) / f64::from(size) - 1.0;
    let (column, row) = (index % size as usize, index / size as usize);
    [slope * along(column), -slope * along(row), -1.0]
}

/// Euclidean length.
pub(super) fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// A surface with its own light only.
pub(super) fn glowing(color: [f64; 3]) -> [f64; 10] {
    [color[0], color[1], color[2], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]
}

/// A matt white surface.
pub(super) const MATT: [f64; 10] = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// All numbers of a pixel, as bits.
pub(super) fn bits(pixel: &Pixel) -> [u32; 7] {
    let ([r, g, b], [tr, tg, tb]) = (pixel.color, pixel.transmittance);
    [r, g, b, tr, tg, tb, pixel.depth].map(f32::to_bits)
}

/// Two solids, a floor without bounds, two overlapping media, a sun and a lamp.
pub(super) fn mixed() -> World {
    let mut world = World::new([0.3, 0.6, 4.0], 0.5);
    world.frame.background = [0.2, 0.3, 0.5];
    world.ball([0.5, 0.0, 0.2], 0.6, [0.05, 0.0, 0.0, 0.6, 0.5, 0.4, 0.3, 0.3, 0.3, 20.0]);
    let bounds = Aabb { lo: [-1.5, -0.7, -0.8], hi: [-0.3, 0.5, 0.4] };
    world.solid(sphere([-0.9, -0.1, -0.2], 0.5, 1.7), MATT, bounds, 1.0 / 1.7);
    let below = Aabb { lo: [f32::NEG_INFINITY; 3], hi: [f32::INFINITY, -0.8, f32::INFINITY] };
    world.solid(floor(-0.8), [0.0, 0.02, 0.0, 0.3, 0.3, 0.35, 0.0, 0.0, 0.0, 1.0], below, 1.0);
    let half = [1.4, 0.7, 0.9];
    world.medium(Gas::uniform(half, [0.3, 0.4, 0.5], [0.5, 0.5, 0.6], [0.0, 0.01, 0.0], Lighting::Shadowed));
    world.medium(fog([0.2, 0.4, 0.0], 0.9));
    world.sun([0.48, 0.8, 0.36], [2.0, 1.9, 1.7]);
    let lamp = LightFrame {
        distant: false,
        position: [-1.2, 1.5, 1.0],
        color: [1.0, 0.5, 0.3],
        shadows: true,
        size: 0.0,
        occlusion: 0.0,
    };
    world.frame.lights.push(lamp);
    world
}

/// A ball of gas whose density falls to 0 at its wall, with a phase function that is not constant.
fn fog(centre: [f64; 3], radius: f64) -> Gas {
    let with_density = |name: &str, factors: &[f64]| {
        let mut body = Body::new(name, 3);
        let from = body.relative_to(centre);
        let length = body.length(from);
        let radius = body.number(radius);
        let mut outputs = vec![body.apply(Op::Sub, &[radius, length])];
        outputs.extend(factors.iter().map(|&factor| body.number(factor)));
        body.finish(&outputs)
    };
    let interior = with_density("interior", &[2.0, 1.8, 1.5, 2.2, 2.2, 2.2, 0.0, 0.0, 0.3]);
    let extinction = with_density("extinction", &[2.2, 2.2, 2.2]);
    // (1 + cos)^2, forward; its integral over the sphere is 16 pi / 3.
    let mut phase = Body::new("phase", 2);
    let squared = phase.apply(Op::Mul, &[phase.input(1), phase.input(1)]);
    let factor = phase.number(3.0 / (16.0 * std::f64::consts::PI));
    let value = phase.apply(Op::Mul, &[squared, factor]);
    let phase = phase.finish(&[value]);
    let corner = |side: f64| centre.map(|x| (x + side * radius) as f32);
    let bounds = Aabb { lo: corner(-1.0), hi: corner(1.0) };
    Gas {
        region: sphere(centre, radius, 1.0)[0].clone(),
        interior,
        extinction,
        phase,
        lighting: Lighting::Shadowed,
        bounds,
    }
}
