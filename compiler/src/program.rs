//! The contract between the compiler and the runtimes: a scene as plain data.
//!
//! A [`Program`] holds everything about a scene that does not change from frame to frame. Numbers
//! that may depend on params and time are [`Slot`]s: indices into the outputs of the frame
//! function. [`crate::frame::Frame`] is a program at one moment, with those numbers filled in.

pub mod style;

use crate::families::KeptFamilies;
use crate::ir::origin::Origins;
use crate::ir::{FunctionId, Module};
use crate::skip::Skips;
use crate::tape::KeptTapes;
use vol_language::source::Span;
use vol_language::ty::Type;

/// Least radius of a tube, in scene units: a radius function may touch 0, and local coordinates
/// divide by it.
pub const LEAST_RADIUS: f64 = 1e-6;

/// Index of a number among the frame function's outputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Slot(pub u32);

/// Three slots: a point, direction or colour.
pub type Slot3 = [Slot; 3];

/// A compiled scene.
#[derive(Clone, Debug)]
pub struct Program {
    /// All functions.
    pub module: Module,
    /// Values set from outside.
    pub params: Vec<Param>,
    /// Curves by index; data of [`crate::ops::Op::Closest`].
    pub curves: Vec<Curve>,
    /// Numbers of shapes that enter the frame function, with the first input that each sets. They
    /// depend on none of one another.
    pub measures: Vec<(u32, Measure)>,
    /// What each frame finds out about tubes.
    pub tubes: Vec<TubeSizes>,
    /// Solids, large unions in parts.
    pub objects: Vec<Object>,
    /// Participating media.
    pub media: Vec<Medium>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Styles of lights.
    pub styles: Vec<style::Style<Slot>>,
    /// Pictures that styles name; whoever renders reads them.
    pub images: Vec<style::ImageFile>,
    /// The camera.
    pub camera: Camera,
    /// Picture settings.
    pub render: Render,
    /// Functions of a position that can be asked for by name (`vol query`, tests).
    pub fields: Vec<Field>,
    /// What the compiler left out and the author should know, one sentence each; all of it: [`crate::dropped`].
    pub report: Vec<String>,
    /// Where the instructions of each function come from, by its index.
    pub origins: Vec<Origins>,
    /// What may be left out of the work.
    pub skips: Skips,
    /// The functions as tapes, once somebody has asked for them.
    pub tapes: KeptTapes,
    /// Functions that differ in their numbers alone, once a shader has asked for them.
    pub families: KeptFamilies,
}

impl Program {
    /// An object of each block that makes solids: the first of those that are its parts.
    pub fn blocks_of_objects(&self) -> impl Iterator<Item = &Object> {
        self.objects
            .iter()
            .enumerate()
            .filter(|(index, object)| object.whole == *index)
            .map(|(_, object)| object)
    }
}

/// A param and where its components enter the frame function.
#[derive(Clone, Debug)]
pub struct Param {
    /// Its name.
    pub name: String,
    /// Its type; angles are in radians.
    pub ty: Type,
    /// Default, one number per component.
    pub default: Vec<f64>,
    /// Allowed range of a scalar.
    pub range: Option<(f64, f64)>,
    /// What its doc comment says: the label of its slider.
    pub label: String,
    /// First input of the frame function that it sets.
    pub first_input: u32,
}

/// A chain of quadratic Bezier segments with control points set per frame.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Control points a, b, c of each segment.
    pub segments: Vec<[Slot3; 3]>,
}

/// A tube about which each frame finds out some numbers before it runs the frame function: they are
/// further inputs of that function, after the params.
///
/// In this order: the largest radius; within what distance from the axis the wall may be approached by
/// the slope of the radius; the factor that makes `|P - Q| - r` safe there; from what distance on
/// the flat ends do not count; the factor that makes the length to an end safe; the largest such
/// distance; by how much the frame of a closed curve is turned per length, so that it fits; the angle
/// from U to the centre of curvature, to be subtracted; the length of the curve.
#[derive(Clone, Copy, Debug)]
pub struct TubeSizes {
    /// The curve.
    pub curve: u32,
    /// (t, arc length) to radius: 2 inputs, 1 output.
    pub radius: FunctionId,
    /// How the radius changes.
    pub slope: TubeSlope,
    /// How it ends.
    pub caps: Caps,
    /// First input of the frame function that it sets.
    pub first_input: u32,
}

impl TubeSizes {
    /// How many numbers there are.
    pub const COUNT: usize = 9;
}

/// How a tube ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Caps {
    /// Cut off by the planes across the ends of the axis.
    Flat,
    /// By parts of balls as thick as the tube.
    Round,
    /// Not at all: it goes on straight for ever, with the coordinates of its ends.
    Open,
    /// In itself: the curve is closed.
    Joined,
}

/// How the radius of a tube changes along it.
#[derive(Clone, Copy, Debug)]
pub enum TubeSlope {
    /// It does not.
    Flat,
    /// (t, arc length) to the derivatives along both: 2 inputs, 2 outputs.
    Known(FunctionId),
    /// In a way that has no derivative.
    Unknown,
}

/// A solid, or one of the parts that a union of many is made of.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name in the scene.
    pub name: String,
    /// Index of the first part of its block, its own if it has no others. Parts stand side by side in
    /// [`Program::objects`]; what is inside one of them is inside all.
    pub whole: usize,
    /// Position to signed distance bound: 3 inputs, 1 output.
    pub distance: FunctionId,
    /// Position to gradient of the distance: 3 inputs, 3 outputs, not normalised.
    pub gradient: FunctionId,
    /// Box of positions (smallest corner, largest corner) to a bound, at least 1, on the length of the
    /// gradient in it, or to [`NO_BOUND`]: 6 inputs, 1 output; without, that is 1 everywhere.
    pub steepness: Option<FunctionId>,
    /// Position to surface response: 3 inputs, [`SURFACE_OUTPUTS`] outputs.
    pub surface: FunctionId,
    /// Colour by normal instead of by light.
    pub shows_normals: bool,
    /// Whether the distance is known to change no faster than the extent says; else it is only a bound and
    /// may jump.
    pub steady: bool,
    /// Bounds and steepness, computed per frame.
    pub extent: Extent,
    /// Whether it is there this frame: 0 or 1.
    pub enabled: Slot,
    /// Its block.
    pub span: Span,
}

/// Stands for a slope of which nothing is known: a jump is possible.
pub const NO_BOUND: f32 = 1e30;

/// Outputs of [`Object::surface`]: emitted rgb (ambient light times ka in it), diffuse rgb (multiplies irradiance times
/// max(0, N.L)), specular rgb (multiplies irradiance times max(0, R.E)^shininess), shininess.
pub const SURFACE_OUTPUTS: usize = 10;

/// A participating medium.
#[derive(Clone, Debug)]
pub struct Medium {
    /// Its name in the scene.
    pub name: String,
    /// Position to signed distance of the region: 3 inputs, 1 output, negative inside. Along a
    /// ray it is used to find where the ray crosses the wall between two samples.
    pub region: FunctionId,
    /// Position inside the region to density, and to scattering, extinction and emission per unit length
    /// and unit of density: 3 inputs, 10 outputs, rgb of the last three, which are never negative. There is
    /// nothing where the density is negative; where an author cut it off at 0 it goes on below, and along a
    /// ray that tells where it ends between two samples.
    pub interior: FunctionId,
    /// Position inside the region to density and extinction as above: 3 inputs, 4 outputs; for shadows.
    pub extinction: FunctionId,
    /// Phase function: inputs `1 - cos` and `1 + cos` of the angle between the directions of the
    /// light before and after scattering; output per steradian, integral over the sphere 1.
    pub phase: FunctionId,
    /// How light reaches it.
    pub lighting: Lighting,
    /// Bounds of the region, computed per frame.
    pub extent: Extent,
    /// Whether it is there this frame: 0 or 1.
    pub enabled: Slot,
    /// Its block.
    pub span: Span,
}

/// How light reaches the points of a medium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lighting {
    /// Only emission.
    None,
    /// Every light in full.
    Unshadowed,
    /// Lights weakened by the media and hidden by the objects between.
    Shadowed,
}

/// A light.
#[derive(Clone, Debug)]
pub struct Light {
    /// Its name in the scene.
    pub name: String,
    /// Where it shines from.
    pub kind: LightKind,
    /// Irradiance on a facing plane (distant) or radiant intensity (point).
    pub color: Slot3,
    /// Whether objects and media block it.
    pub shadows: Slot,
    /// How large it is: angle across a distant light in radians, radius of a point light; none if it has
    /// no size in any frame.
    pub size: Option<Slot>,
    /// Distance within which surfaces darken each other; none if they never do.
    pub occlusion: Option<Slot>,
    /// Whether it is on: 0 or 1.
    pub enabled: Slot,
}

/// The kinds of lights.
#[derive(Clone, Copy, Debug)]
pub enum LightKind {
    /// Direction towards the light, any length but 0.
    Distant(Slot3),
    /// Position.
    Point(Slot3),
}

/// The camera; `None` frames the scene's bounds.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Eye.
    pub from: Option<Slot3>,
    /// Point looked at.
    pub at: Option<Slot3>,
    /// Direction that is up in the picture.
    pub up: Slot3,
    /// Vertical field of view in radians.
    pub fov: Slot,
}

/// Picture settings.
#[derive(Clone, Debug)]
pub struct Render {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Radiance where nothing is hit.
    pub background: Slot3,
    /// Samples of a pixel, or the most: see [`crate::frame::Sampling`]; `None` if the scene leaves
    /// that open.
    pub samples: Option<Slot>,
    /// Error at which a pixel takes no more samples.
    pub adaptive: Slot,
    /// Length of the animation in seconds.
    pub duration: Slot,
    /// Frames per second.
    pub fps: Slot,
}

/// A function of a position with a name.
#[derive(Clone, Debug)]
pub struct Field {
    /// `distance:ball`, `gradient:ball`, `density:cloud`, or the name of a top-level function.
    pub name: String,
    /// 3 inputs; as many outputs as the value has components.
    pub function: FunctionId,
}

/// Where a shape is and how steep its distance bound, as a recipe that each frame fills in.
#[derive(Clone, Debug)]
pub enum Extent {
    /// All of space (a plane, the complement of a solid).
    Unbounded,
    /// An axis-aligned box.
    Box {
        /// Smallest corner.
        lo: Slot3,
        /// Largest corner.
        hi: Slot3,
    },
    /// Tube around a curve.
    Tube {
        /// The curve.
        curve: u32,
        /// (t, arc length) to radius, held at [`LEAST_RADIUS`] by its users: 2 inputs, 1 output.
        radius: FunctionId,
        /// How it ends.
        caps: Caps,
        /// Index in [`Program::tubes`]; without, the distance is exact.
        sizes: Option<u32>,
    },
    /// Smallest box around all.
    Union(Vec<Extent>),
    /// Box common to all.
    Intersection(Vec<Extent>),
    /// Everything outside a shape: unbounded, as steep as the shape.
    Complement(Box<Extent>),
    /// Moved by `position * matrix + offset` (columns of a rotation times a uniform scale).
    Placed {
        /// What is moved.
        child: Box<Extent>,
        /// Columns: images of the axes.
        columns: [Slot3; 3],
        /// Image of the origin.
        offset: Slot3,
    },
    /// Grown on all sides by a distance.
    Grown(Box<Extent>, Slot),
    /// Pulled apart along each axis.
    Elongated {
        /// The shape before.
        child: Box<Extent>,
        /// By how much to either side.
        by: Slot3,
    },
    /// Turned about the y axis in proportion to y.
    Twisted {
        /// The shape before.
        child: Box<Extent>,
        /// Radians per unit of length.
        rate: Slot,
        /// The call, for messages.
        span: Span,
    },
    /// The x axis bent to a circle about (0, 1 / rate).
    Bent {
        /// The shape before.
        child: Box<Extent>,
        /// Radians per unit of length.
        rate: Slot,
        /// The call, for messages.
        span: Span,
    },
    /// Copies along the axes, centred at the origin.
    Repeated {
        /// One copy.
        child: Box<Extent>,
        /// Copies along each axis.
        axes: [Option<Run>; 3],
        /// Into how many further cells on each side a copy may reach.
        overlap: u32,
        /// The call, for messages.
        span: Span,
    },
    /// Copies around the y axis, the first as the child is.
    Around {
        /// One copy.
        child: Box<Extent>,
        /// How many.
        count: u32,
        /// Into how many further sectors on each side a copy may reach.
        overlap: u32,
        /// The call, for messages.
        span: Span,
    },
    /// A box at the origin, as steep as a field is in it.
    Field {
        /// Half extents.
        half: Slot3,
        /// Position to gradient of the field: 3 inputs, 3 outputs.
        slope: FunctionId,
        /// The call, for messages.
        span: Span,
    },
    /// Grown by the largest |amount| and steeper by the largest slope of the amount over the box.
    Displaced {
        /// The shape before displacement.
        child: Box<Extent>,
        /// Position to amount: 3 inputs, 1 output.
        amount: FunctionId,
        /// Position to gradient of the amount: 3 inputs, 3 outputs.
        slope: FunctionId,
        /// The displacement expression, for messages.
        span: Span,
    },
}

/// Copies along an axis.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// From copy to copy; positive.
    pub period: Slot,
    /// How many; 0 without end.
    pub count: u32,
}

/// Numbers of a shape's bounds that enter the frame function, for shapes whose distance is made of
/// those of another.
#[derive(Clone, Debug)]
pub enum Measure {
    /// Largest distance of the box from the y axis: one number.
    Radius(Extent),
    /// Centre and half extents of the box: six numbers.
    Box(Extent),
    /// Largest slope of the distance: one number.
    Steepness(Extent),
}

impl Measure {
    /// How many numbers it is.
    #[must_use]
    pub fn width(&self) -> u32 {
        match self {
            Self::Radius(_) | Self::Steepness(_) => 1,
            Self::Box(_) => 6,
        }
    }
}
