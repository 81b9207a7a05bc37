//! Styles of single scattering (Kol et al. 2016) as plain data.
//!
//! `N` is what stands for a number: a [`Slot`](super::Slot) in a program, an `f64` in a frame.

use crate::ir::FunctionId;
use vol_language::source::Span;

/// Most texels of a kernel that changes a shadow map.
pub const MOST_KERNEL: f64 = 8192.0;

/// How the light of one distant lamp that media scatter is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Style<N> {
    /// Its name in the scene.
    pub name: String,
    /// Index of the light.
    pub light: usize,
    /// Width and height of the shadow map in texels.
    pub shadow_map: u32,
    /// How solids hide the light from media.
    pub shafts: Shafts,
    /// What is done to the shadow map, in this order.
    pub operators: Vec<Operator<N>>,
    /// Colour by average visibility and depth.
    pub transfer: Option<Transfer<N>>,
    /// Depths along the viewing axis that are 0 and 1 in the transfer function; without, those of the
    /// nearest and farthest corner of the scene's bounds.
    pub depth_range: Option<[N; 2]>,
    /// Strokes that the colour of the light is fitted to.
    pub light_map: Option<LightMap<N>>,
    /// Variation along rays.
    pub heterogeneity: Option<Heterogeneity>,
    /// Whether it is on: 0 or 1.
    pub enabled: N,
    /// Its block.
    pub span: Span,
}

/// How visibility along a ray is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shafts {
    /// Looked up in slices of a shadow map.
    #[default]
    Mapped,
    /// Marched, each edge of a shadow found by bisection.
    Exact,
}

/// A change of the shadow map.
#[derive(Clone, Debug, PartialEq)]
pub struct Operator<N> {
    /// Which.
    pub kind: OperatorKind<N>,
    /// Names of the objects that it changes; none for all.
    pub only: Option<Vec<String>>,
    /// Where it is asked for.
    pub span: Span,
}

/// The changes of a shadow map.
#[derive(Clone, Debug, PartialEq)]
pub enum OperatorKind<N> {
    /// Closing by a disk of this diameter in texels.
    CloseDisk(N),
    /// Closing along epipolar lines by as many texels.
    CloseEpipolar(N),
    /// Dilation away from the eye by as many texels (Eq. 3).
    Extrude(N),
    /// Holes where noise is below a threshold (Eq. 4 and 5).
    Holes(Holes<N>),
}

/// The noise of holes.
#[derive(Clone, Debug, PartialEq)]
pub struct Holes<N> {
    /// Cells of the first octave along 1/256 of the map.
    pub frequency: N,
    /// Factor of the amplitude from octave to octave.
    pub persistence: N,
    /// Number of octaves, at least 1.
    pub octaves: u32,
    /// Where it is cut.
    pub cut: Cut<N>,
    /// Turns of the pattern by which it moves; none for a pattern that does not.
    pub phase: Option<N>,
    /// Whether all octaves are of one frequency, as Eq. 5 is printed.
    pub as_printed: bool,
}

/// The level below which noise is a hole.
#[derive(Clone, Debug, PartialEq)]
pub enum Cut<N> {
    /// The level that this share of the map is below.
    Probability(N),
    /// The level itself.
    Threshold(N),
}

/// A picture that a scene names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ImageFile {
    /// Path as written, relative to the file that names it.
    pub path: String,
    /// Where it is named.
    pub span: Span,
}

/// A function from average visibility and linear depth to a colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Transfer<N> {
    /// The layers of each key, bottom first; at least one key.
    pub keys: Vec<Vec<Layer<N>>>,
    /// For each key after the first, its share against the one before: 0 before that, 1 from the key on.
    pub shares: Vec<N>,
}

/// A layer and how it is put over those below, of which the lowest is white.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer<N> {
    /// What is on it.
    pub content: Content<N>,
    /// How it is put there.
    pub blend: Blend<N>,
}

/// What a layer shows. Places are average visibility and depth, 0 to 1 each; colours are linear.
#[derive(Clone, Debug, PartialEq)]
pub enum Content<N> {
    /// One colour.
    Solid([N; 3]),
    /// From one colour at one place to another at another, steady along the line between them and
    /// beyond its ends.
    Gradient {
        /// The two places.
        places: [[N; 2]; 2],
        /// The two colours.
        colors: [[N; 3]; 2],
    },
    /// Smooth between fixed colours.
    Diffusion(Vec<Constraint<N>>),
    /// A picture: index into [`super::Program::images`].
    Image(usize),
}

/// A fixed colour of a diffusion layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint<N> {
    /// Where.
    pub place: Place<N>,
    /// The colour.
    pub color: [N; 3],
    /// How much of the layer it covers, 0 to 1.
    pub alpha: N,
}

/// Where a constraint is.
#[derive(Clone, Debug, PartialEq)]
pub enum Place<N> {
    /// In the transfer function.
    Fixed([N; 2]),
    /// At what the ray through this point of the world has.
    Tracked([N; 3]),
}

/// How a layer is put over those below: `c` its colour, `a` its coverage, `d` what is below.
#[derive(Clone, Debug, PartialEq)]
pub enum Blend<N> {
    /// `d + a c`
    Add,
    /// `d (1 - a + a c)`
    Multiply,
    /// `d (1 - a) + a c` with the coverage times this.
    Alpha(N),
}

/// A light map fitted to strokes.
#[derive(Clone, Debug, PartialEq)]
pub struct LightMap<N> {
    /// Width and height in texels.
    pub size: u32,
    /// What is painted.
    pub strokes: Vec<Stroke<N>>,
}

/// A straight stroke with round ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke<N> {
    /// Where it was painted; none for the scene's camera.
    pub view: Option<View<N>>,
    /// Pixels from the upper left corner, of the centres of its ends.
    pub ends: [[N; 2]; 2],
    /// Width in pixels.
    pub width: N,
    /// Linear colour, as a factor of what a white light gives.
    pub color: [N; 3],
    /// Where it is asked for.
    pub span: Span,
}

/// A camera other than the scene's.
#[derive(Clone, Debug, PartialEq)]
pub struct View<N> {
    /// The eye.
    pub from: [N; 3],
    /// What it looks at.
    pub at: [N; 3],
    /// What is up in the picture.
    pub up: [N; 3],
    /// Vertical field of view in radians.
    pub fov: N,
}

/// Variation of the light along rays, by which it is multiplied: the mean of a field along each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heterogeneity {
    /// Position to `intensity (amount noise + 1 - amount)`: 3 inputs, 1 output, never negative.
    pub field: FunctionId,
    /// Samples along a ray.
    pub steps: u32,
    /// Pixels per sample, across and down.
    pub upsample: u32,
}

impl<N: Copy> Style<N> {
    /// The same style with other numbers, each from the one in its place.
    pub fn map<M>(&self, number: &dyn Fn(N) -> M) -> Style<M> {
        Style {
            name: self.name.clone(),
            light: self.light,
            shadow_map: self.shadow_map,
            shafts: self.shafts,
            operators: self.operators.iter().map(|operator| operator.map(number)).collect(),
            transfer: self.transfer.as_ref().map(|transfer| transfer.map(number)),
            depth_range: self.depth_range.map(|range| range.map(number)),
            light_map: self.light_map.as_ref().map(|map| LightMap {
                size: map.size,
                strokes: map.strokes.iter().map(|stroke| stroke.map(number)).collect(),
            }),
            heterogeneity: self.heterogeneity,
            enabled: number(self.enabled),
            span: self.span,
        }
    }
}

impl<N: Copy> Operator<N> {
    fn map<M>(&self, number: &dyn Fn(N) -> M) -> Operator<M> {
        let kind = match &self.kind {
            OperatorKind::CloseDisk(diameter) => OperatorKind::CloseDisk(number(*diameter)),
            OperatorKind::CloseEpipolar(length) => OperatorKind::CloseEpipolar(number(*length)),
            OperatorKind::Extrude(length) => OperatorKind::Extrude(number(*length)),
            OperatorKind::Holes(holes) => OperatorKind::Holes(Holes {
                frequency: number(holes.frequency),
                persistence: number(holes.persistence),
                octaves: holes.octaves,
                cut: match holes.cut {
                    Cut::Probability(share) => Cut::Probability(number(share)),
                    Cut::Threshold(level) => Cut::Threshold(number(level)),
                },
                phase: holes.phase.map(number),
                as_printed: holes.as_printed,
            }),
        };
        Operator { kind, only: self.only.clone(), span: self.span }
    }
}

impl<N: Copy> Transfer<N> {
    fn map<M>(&self, number: &dyn Fn(N) -> M) -> Transfer<M> {
        let key = |layers: &Vec<Layer<N>>| layers.iter().map(|layer| layer.map(number)).collect();
        Transfer {
            keys: self.keys.iter().map(key).collect(),
            shares: self.shares.iter().map(|&share| number(share)).collect(),
        }
    }
}

impl<N: Copy> Layer<N> {
    fn map<M>(&self, number: &dyn Fn(N) -> M) -> Layer<M> {
        let content = match &self.content {
            Content::Solid(color) => Content::Solid(color.map(number)),
            Content::Gradient { places, colors } => Content::Gradient {
                places: places.map(|place| place.map(number)),
                colors: colors.map(|color| color.map(number)),
            },
            Content::Diffusion(constraints) => {
                Content::Diffusion(constraints.iter().map(|constraint| constraint.map(number)).collect())
            }
            Content::Image(index) => Content::Image(*index),
        };
        let blend = match self.blend {
            Blend::Add => Blend::Add,
            Blend::Multiply => Blend::Multiply,
            Blend::Alpha(amount) => Blend::Alpha(number(amount)),
        };
        Layer { content, blend }
    }
}

impl<N: Copy> Constraint<N> {
    fn map<M>(&self, number: &dyn Fn(N) -> M) -> Constraint<M> {
        let place = match self.place {
            Place::Fixed(place) => Place::Fixed(place.map(number)),
            Place::Tracked(point) => Place::Tracked(point.map(number)),
        };
        Constraint { place, color: self.color.map(number), alpha: number(self.alpha) }
    }
}

impl<N: Copy> Stroke<N> {
    fn map<M>(&self, number: &dyn Fn(N) -> M) -> Stroke<M> {
        let view = self.view.as_ref().map(|view| View {
            from: view.from.map(number),
            at: view.at.map(number),
            up: view.up.map(number),
            fov: number(view.fov),
        });
        Stroke {
            view,
            ends: self.ends.map(|end| end.map(number)),
            width: number(self.width),
            color: self.color.map(number),
            span: self.span,
        }
    }
}
