//! Words and nested settings: values that only a certain key or parameter takes.
//!
//! A *choice* is one word of a few, some with arguments: `lighting: unshadowed`, `fill_holes: disk(11)`.
//! Its words mean something only where the choice is asked for, so that scenes may use them as names.
//! *Settings* are `{ key: value, … }` as the value of a key.

use crate::blocks::{BlockKind, Key, key, required};
use crate::ty::Type;

/// The choices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ChoiceKind {
    /// How a key-framed value goes from key to key.
    Ease,
    /// How light reaches a medium.
    Lighting,
    /// The ends of a tube.
    Caps,
    /// How the frame of a tube is carried along its curve.
    Frame,
    /// What decides where a tube overlaps itself.
    Overlap,
    /// How holes of occluders are closed.
    HoleFilling,
    /// A layer of a transfer function.
    Layer,
    /// How a layer is put over those before.
    Blend,
    /// A colour at a place of a transfer function.
    Constraint,
    /// A light map.
    LightMap,
    /// A stroke painted in a view.
    Stroke,
    /// A brush in space.
    Brush,
    /// The noise of a heterogeneity.
    Noise,
    /// The noise of a cloud.
    CloudNoise,
}

/// A word of a choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Word {
    /// The word.
    pub name: &'static str,
    /// Its arguments in order; none for a bare word.
    pub params: Vec<Key>,
    /// What it means.
    pub doc: &'static str,
}

impl ChoiceKind {
    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ease => "ease",
            Self::Lighting => "lighting",
            Self::Caps => "caps",
            Self::Frame => "frame",
            Self::Overlap => "overlap",
            Self::HoleFilling => "hole filling",
            Self::Layer => "layer",
            Self::Blend => "blend",
            Self::Constraint => "constraint",
            Self::LightMap => "light map",
            Self::Stroke => "stroke",
            Self::Brush => "brush",
            Self::Noise => "noise",
            Self::CloudNoise => "cloud noise",
        }
    }

    /// The words that there are.
    #[must_use]
    pub fn words(self) -> Vec<Word> {
        match self {
            Self::Ease => vec![
                bare("linear", "in proportion"),
                bare("smooth", "slow at both keys, 3 u^2 - 2 u^3"),
                bare("hold", "the value of the key before"),
            ],
            Self::Lighting => vec![
                bare("none", "emission only"),
                bare("unshadowed", "every light in full"),
                bare("shadowed", "lights weakened by media and hidden by objects"),
            ],
            Self::Caps => vec![
                bare("round", "half balls of the radius at the ends"),
                bare("flat", "cut off at the ends"),
                bare("open", "no ends: the tube goes straight on"),
            ],
            Self::Frame => vec![
                bare("minimal", "turns no more about the curve than it must"),
                bare("frenet", "follows the curvature"),
            ],
            Self::Overlap => vec![
                bare("nearest", "the closest point of the curve"),
                bare("min_ratio", "the least distance over the radius: the union of all parts"),
                bare("sum", "all parts: their densities add up"),
            ],
            Self::HoleFilling => hole_fillings(),
            Self::Layer => layers(),
            Self::Blend => vec![
                bare("add", "sum"),
                bare("multiply", "product"),
                word("alpha", vec![required("amount", Type::Float, "0 to 1")], "mixed by an amount"),
            ],
            Self::Constraint => constraints(),
            Self::LightMap => vec![word(
                "paint",
                vec![
                    key("size", Type::Int, "width and height in texels; default 512"),
                    required("strokes", Type::list(Type::Choice(Self::Stroke)), "what is painted"),
                ],
                "fitted to strokes by least squares",
            )],
            Self::Stroke => vec![stroke()],
            Self::Brush => brushes(),
            Self::Noise => vec![bare("perlin", "improved gradient noise")],
            Self::CloudNoise => vec![
                bare("perlin", "octaves of improved gradient noise, (1 + fbm) / 2"),
                bare("gardner", "products of sums of sines"),
            ],
        }
    }
}

fn bare(name: &'static str, doc: &'static str) -> Word {
    Word { name, params: Vec::new(), doc }
}

fn word(name: &'static str, params: Vec<Key>, doc: &'static str) -> Word {
    Word { name, params, doc }
}

fn only() -> Key {
    key("only", Type::list(Type::Block(BlockKind::Object)), "the objects that it is for; default all")
}

fn hole_fillings() -> Vec<Word> {
    vec![
        word("disk", vec![required("radius", Type::Float, "texels"), only()], "closing by a disk"),
        word(
            "epipolar",
            vec![required("length", Type::Float, "texels"), only()],
            "closing along epipolar lines",
        ),
    ]
}

fn layers() -> Vec<Word> {
    let color = |name| required(name, Type::Color, "linear colour");
    let place = |name| required(name, Type::Vec2, "average visibility and depth, 0 to 1 each");
    let blend = || key("blend", Type::Choice(ChoiceKind::Blend), "over the layers before; default multiply");
    vec![
        word("solid", vec![color("color"), blend()], "one colour"),
        word(
            "gradient",
            vec![place("from"), color("from_color"), place("to"), color("to_color"), blend()],
            "from one colour to another",
        ),
        word(
            "diffusion",
            vec![
                required("constraints", Type::list(Type::Choice(ChoiceKind::Constraint)), "fixed colours"),
                blend(),
            ],
            "smooth between fixed colours",
        ),
        word("image", vec![required("file", Type::Image, "path of a PNG"), blend()], "a picture"),
    ]
}

fn constraints() -> Vec<Word> {
    let color = || required("color", Type::Color, "the colour there");
    vec![
        word(
            "place",
            vec![required("place", Type::Vec2, "in the transfer function"), color()],
            "fixed place",
        ),
        word("point", vec![color(), required("at", Type::Vec3, "world position")], "tracked point"),
    ]
}

fn stroke() -> Word {
    let pixel = |name| required(name, Type::Vec2, "pixel from the top left");
    let params = vec![
        required("view", Type::Block(BlockKind::Camera), "where it was painted"),
        pixel("from"),
        pixel("to"),
        required("width", Type::Float, "pixels"),
        required("color", Type::Color, "linear colour"),
    ];
    word("stroke", params, "a straight stroke in a view")
}

fn brushes() -> Vec<Word> {
    let ellipsoid = || {
        vec![
            required("center", Type::Vec3, "world position"),
            required("radii", Type::Vec3, "half axes, scene units"),
            key("hardness", Type::Float, "0 (soft) to 1; default 0.5"),
            key("opacity", Type::Float, "0 to 1; default 1"),
        ]
    };
    let mut painted = ellipsoid();
    painted.push(key("frequency", Type::Float, "of the noise in it, per scene unit; default 1"));
    vec![
        word("brush", painted, "adds variation in an ellipsoid"),
        word("eraser", ellipsoid(), "takes variation away in an ellipsoid"),
    ]
}

/// The nested settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SettingsKind {
    /// Holes made in occluders.
    Holes,
    /// Variation of a medium.
    Heterogeneity,
}

impl SettingsKind {
    /// Its name in messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Holes => "hole settings",
            Self::Heterogeneity => "heterogeneity settings",
        }
    }

    /// The keys that it takes.
    #[must_use]
    pub fn keys(self) -> Vec<Key> {
        match self {
            Self::Holes => vec![
                key("frequency", Type::Float, "of the first octave, per texel; default 0.1"),
                key("persistence", Type::Float, "amplitude from octave to octave; default 0.5"),
                key("octaves", Type::Int, "number of octaves; default 4"),
                key("probability", Type::Float, "share that is cut away, 0 to 1; default 0.5"),
                only(),
                key("phase", Type::Float, "moves the pattern; default 0"),
            ],
            Self::Heterogeneity => vec![
                key("noise", Type::Choice(ChoiceKind::Noise), "the noise; default perlin"),
                key("amount", Type::Float, "0 to 1; default 1"),
                key("steps", Type::Int, "samples along a ray; default 64"),
                key("upsample", Type::Int, "pixels per sample in width and height: 1, 4 or 16; default 1"),
                key(
                    "brushes",
                    Type::list(Type::Choice(ChoiceKind::Brush)),
                    "where it is painted; default everywhere",
                ),
            ],
        }
    }
}
