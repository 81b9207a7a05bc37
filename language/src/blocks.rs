//! The keys of the scene's blocks: names, types and defaults in one table.

use crate::settings::{ChoiceKind, SettingsKind};
use crate::ty::Type;

/// The kinds of blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum BlockKind {
    /// Where the picture is taken from; at most one.
    Camera,
    /// A light source.
    Light,
    /// A solid with a material.
    Object,
    /// A participating medium in a region.
    Medium,
    /// How single scattering of one light is styled (Kol et al. 2016).
    Style,
    /// Size, background and timing of the picture; at most one.
    Render,
}

/// Largest number of samples per pixel.
pub const MAX_SAMPLES: u32 = 4096;

/// Samples at most of a pixel that stops when it has enough, where a scene says no number: after as
/// many there is a test, and their centre of gravity is the pixel's.
pub const ADAPTIVE_SAMPLES: u32 = 65;

/// All kinds, in the order in which messages list them.
pub const BLOCK_KINDS: [BlockKind; 6] = [
    BlockKind::Camera,
    BlockKind::Light,
    BlockKind::Object,
    BlockKind::Medium,
    BlockKind::Style,
    BlockKind::Render,
];

impl BlockKind {
    /// The keyword.
    #[must_use]
    pub fn keyword(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Light => "light",
            Self::Object => "object",
            Self::Medium => "medium",
            Self::Style => "style",
            Self::Render => "render",
        }
    }

    /// Whether blocks of this kind carry a name of their own.
    #[must_use]
    pub fn is_named(self) -> bool {
        matches!(self, Self::Light | Self::Object | Self::Medium | Self::Style)
    }

    /// The keys that this kind takes.
    #[must_use]
    pub fn keys(self) -> Vec<Key> {
        match self {
            Self::Camera => camera(),
            Self::Light => light(),
            Self::Object => object(),
            Self::Medium => medium(),
            Self::Style => style(),
            Self::Render => render(),
        }
    }
}

/// One key of a block.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// The type of its value.
    pub ty: Type,
    /// Whether the block is wrong without it.
    pub required: bool,
    /// Meaning, unit and default.
    pub doc: &'static str,
}

pub(crate) fn key(name: &'static str, ty: Type, doc: &'static str) -> Key {
    Key { name, ty, required: false, doc }
}

pub(crate) fn required(name: &'static str, ty: Type, doc: &'static str) -> Key {
    Key { name, ty, required: true, doc }
}

fn of_local(result: Type) -> Type {
    Type::function(vec![Type::Local], result)
}

fn camera() -> Vec<Key> {
    vec![
        key("from", Type::Vec3, "position of the eye; default: frames the scene's bounds along -z"),
        key("at", Type::Vec3, "point looked at; default: the centre of the scene's bounds"),
        key("up", Type::Vec3, "direction that points up in the picture; default (0, 1, 0)"),
        key("fov", Type::Angle, "vertical field of view; default 40deg"),
    ]
}

fn light() -> Vec<Key> {
    vec![
        key(
            "from",
            Type::Vec3,
            "direction towards a distant light; `color` is then the irradiance on a plane facing it",
        ),
        key("at", Type::Vec3, "position of a point light; `color` is then its radiant intensity"),
        key("color", Type::Color, "colour and strength; default 1"),
        key("shadows", Type::Bool, "whether surfaces and media block this light; default true"),
        key(
            "spread",
            Type::Angle,
            "angle across a distant light as seen from the scene, 0deg to 120deg: shadows of surfaces get soft edges; the sun's is 0.53deg; default 0deg",
        ),
        key(
            "radius",
            Type::Float,
            "radius of a point light in scene units: shadows of surfaces get soft edges; default 0",
        ),
        key(
            "occlusion",
            Type::Float,
            "distance within which surfaces darken each other in this light; default 0, not at all",
        ),
        key("when", Type::Bool, "whether the light is on; default true"),
    ]
}

fn object() -> Vec<Key> {
    vec![
        required("shape", Type::Shape, "the solid"),
        key("material", Type::Material, "how its surface answers light; default diffuse(0.8)"),
        key("when", Type::Bool, "whether the object is there; default true"),
    ]
}

fn medium() -> Vec<Key> {
    vec![
        required("region", Type::Shape, "the solid that the medium fills"),
        key("density", of_local(Type::Float), "density, negative values count as 0; default 1"),
        key(
            "scatter",
            of_local(Type::Color),
            "scattering coefficient per unit density and length; default 1",
        ),
        key("absorb", of_local(Type::Color), "absorption coefficient per unit density and length; default 0"),
        key("emit", of_local(Type::Color), "emitted radiance per unit density and length; default 0"),
        key(
            "conserve_mass",
            Type::Bool,
            "whether density is per volume of the region's own map, divided by q.stretch; default as the tube says",
        ),
        key("phase", Type::Phase, "phase function; default isotropic()"),
        key("lighting", Type::Choice(ChoiceKind::Lighting), "how light reaches it; default shadowed"),
        key("when", Type::Bool, "whether the medium is there; default true"),
    ]
}

fn style() -> Vec<Key> {
    vec![
        required("light", Type::Block(BlockKind::Light), "the distant light whose shafts are styled"),
        key(
            "shadow_map",
            Type::Int,
            "width and height of the shadow map in texels, 16 to 8192; default 1024",
        ),
        key("shafts", Type::Choice(ChoiceKind::Shafts), "how solids hide the light; default mapped"),
        key("fill_holes", Type::Choice(ChoiceKind::HoleFilling), "closes holes of the occluders"),
        key(
            "enhance_silhouettes",
            Type::Choice(ChoiceKind::Enhancement),
            "length in texels by which occluders grow away from the eye",
        ),
        key("make_holes", Type::Settings(SettingsKind::Holes), "holes cut into the occluders by noise"),
        key(
            "transfer",
            Type::list(Type::Choice(ChoiceKind::Layer)),
            "colour of the shafts by average visibility (x) and depth (y), instead of the visibility",
        ),
        key(
            "depth_range",
            Type::Vec2,
            "depths that are 0 and 1 in `transfer`; default: those of the scene's bounds",
        ),
        key("light_map", Type::Choice(ChoiceKind::LightMap), "strokes that the light's colour is fitted to"),
        key(
            "heterogeneity",
            Type::Settings(SettingsKind::Heterogeneity),
            "variation of the light along rays",
        ),
        key("when", Type::Bool, "whether the style is on; default true"),
    ]
}

fn render() -> Vec<Key> {
    vec![
        key("size", Type::Vec2, "width and height in pixels; default (960, 540)"),
        key("background", Type::Color, "radiance where nothing is hit; default 0"),
        key("ambient", Type::Color, "ambient light that `phong` multiplies with ka; default 1"),
        key(
            "samples",
            Type::Int,
            "rays per pixel, 1 to 4096, of which it is the mean; with `adaptive` the most; default 1, with `adaptive` 65",
        ),
        key(
            "adaptive",
            Type::Float,
            "standard error of a pixel, relative to its brightness, at which it takes no more samples, below 1; default 0: all pixels take as many",
        ),
        key("duration", Type::Float, "length of the animation in seconds; default 0"),
        key("fps", Type::Float, "frames per second; default 30"),
    ]
}
