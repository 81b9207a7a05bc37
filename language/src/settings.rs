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
    /// How silhouettes of occluders are enhanced; a bare number is the length of `extrude`.
    Enhancement,
    /// How visibility along a ray is found.
    Shafts,
    /// The sum of octaves of which holes are made.
    HoleNoise,
    /// Where a stroke was painted.
    View,
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
            Self::Enhancement => "enhancement",
            Self::Shafts => "shafts",
            Self::HoleNoise => "hole noise",
            Self::View => "view",
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
            Self::Enhancement => vec![word(
                "extrude",
                vec![required("length", Type::Float, "texels"), only()],
                "dilation along epipolar lines, away from the eye",
            )],
            Self::Shafts => vec![
                bare("mapped", "looked up in slices of a shadow map"),
                bare("exact", "marched, each edge of a shadow found by bisection; no operator can change it"),
            ],
            Self::HoleNoise => vec![
                bare("octaves", "each octave of twice the frequency, as Eq. 5 of Kol et al. is meant"),
                bare("printed", "all octaves of one frequency, as Eq. 5 is printed"),
            ],
            Self::View => views(),
            Self::Layer => layers(),
            Self::Blend => vec![
                bare("add", "sum"),
                bare("multiply", "product"),
                word("alpha", vec![key("amount", Type::Float, "0 to 1; default 1")], "mixed by an amount"),
            ],
            Self::Constraint => constraints(),
            Self::LightMap => vec![word(
                "paint",
                vec![
                    key("size", Type::Int, "width and height in texels, 4 to 1024; default 512"),
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
        word("disk", vec![required("diameter", Type::Float, "texels"), only()], "closing by a disk"),
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
    let alpha = || key("alpha", Type::Float, "how much of the layer it covers, 0 to 1; default 1");
    vec![
        word(
            "place",
            vec![required("place", Type::Vec2, "in the transfer function"), color(), alpha()],
            "fixed place",
        ),
        word("point", vec![color(), alpha(), required("at", Type::Vec3, "world position")], "tracked point"),
    ]
}

fn views() -> Vec<Word> {
    let place = |name, doc| required(name, Type::Vec3, doc);
    let view = vec![
        place("from", "position of the eye"),
        place("at", "point looked at"),
        key("up", Type::Vec3, "direction that points up in the picture; default (0, 1, 0)"),
        key("fov", Type::Angle, "vertical field of view; default 40deg"),
    ];
    vec![bare("camera", "the scene's camera"), word("view", view, "a camera of its own")]
}

fn stroke() -> Word {
    let pixel = |name| required(name, Type::Vec2, "pixel from the top left");
    let params = vec![
        required("view", Type::Choice(ChoiceKind::View), "where it was painted"),
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
            key("hardness", Type::Float, "share of the radius at full opacity, 0 (soft) to 1; default 0.5"),
            key("opacity", Type::Float, "0 to 1; default 1"),
        ]
    };
    let mut painted = ellipsoid();
    painted.extend([
        key("frequency", Type::Float, "of the finest detail, relative: 2 adds an octave, 0.5 takes one away"),
        key("amount", Type::Float, "of variation, 0 to 1"),
        key("intensity", Type::Float, "factor of the light"),
    ]);
    vec![
        word("brush", painted, "paints what it names in an ellipsoid; without, an amount of 1"),
        word("eraser", ellipsoid(), "takes back what was painted in an ellipsoid"),
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
                key(
                    "frequency",
                    Type::Float,
                    "of the first octave, cells along 1/256 of the map; default 0.1",
                ),
                key("persistence", Type::Float, "amplitude from octave to octave; default 0.5"),
                key("octaves", Type::Int, "number of octaves, 1 to 16; default 4"),
                key("probability", Type::Float, "share of the map that is cut away, 0 to 1; default 0.5"),
                key(
                    "threshold",
                    Type::Float,
                    "level of the noise that is cut away below, instead of a share",
                ),
                only(),
                key(
                    "phase",
                    Type::Float,
                    "turns by which the pattern moves and changes; default: it stands still",
                ),
                key(
                    "noise",
                    Type::Choice(ChoiceKind::HoleNoise),
                    "how octaves are added up; default octaves",
                ),
            ],
            Self::Heterogeneity => vec![
                key("noise", Type::Choice(ChoiceKind::Noise), "the noise; default perlin"),
                key(
                    "amount",
                    Type::Float,
                    "of variation where nothing is painted, 0 to 1; default 1, with brushes 0",
                ),
                key("frequency", Type::Float, "of the noise's first octave, cells per scene unit; default 1"),
                key("octaves", Type::Int, "of the noise, 1 to 12; default 4"),
                key("steps", Type::Int, "samples along a ray, 1 to 4096; default 64"),
                key("upsample", Type::Int, "pixels per sample in width and height: 1, 4 or 16; default 1"),
                key(
                    "brushes",
                    Type::list(Type::Choice(ChoiceKind::Brush)),
                    "what is painted, one over the other; default nothing",
                ),
            ],
        }
    }
}
