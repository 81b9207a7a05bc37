//! The scene: as a text for vol, and as numbers for the program written by hand.

use crate::lanes::Lanes;
use crate::noise::Noise;
use crate::points::Points;
use pulp::x86::V4;

/// The scene as vol is told it.
pub(crate) const TEXT: &str = "medium ball {
  region:  sphere(1)
  density: q => 20 * max(0, fbm(2.5 * q.local, 5)) * falloff(0.6, 1, q.radius)
  scatter: 0.9
  absorb:  0.1
  phase:   henyey_greenstein(0.3)
}
light sun { from: (-0.35, 0.8, 0.5), color: (3, 3, 3) }
camera    { from: (0, 0, 3.4), at: (0, 0, 0), fov: 40deg }
render    { size: (480, 270), background: (0, 0, 0) }
";

/// Pixels of the picture.
pub(crate) const SIZE: [u32; 2] = [480, 270];

/// Direction towards the light, of any length.
const FROM: [f32; 3] = [-0.35, 0.8, 0.5];
/// Irradiance on a plane that faces the light.
const IRRADIANCE: f32 = 3.0;
/// Where the eye is; it looks along -z.
const EYE: [f32; 3] = [0.0, 0.0, 3.4];
/// Vertical field of view, degrees.
const FIELD_OF_VIEW: f32 = 40.0;

/// Extinction where the noise is 1, and how many units of the lattice are one of the scene.
const DENSITY: f32 = 20.0;
const FREQUENCY: f32 = 2.5;
/// Distance from the centre where the ball begins to fade; it ends at 1.
const FADE_START: f32 = 0.6;
/// Scattering over extinction.
const ALBEDO: f32 = 0.9;
/// Mean cosine of the phase function.
const G: f32 = 0.3;

/// Sixteen rays from the eye.
pub(crate) struct Rays {
    pub(crate) directions: Points,
    /// Where they enter the ball, and how long they are in it: 0 for those that pass by.
    pub(crate) entries: Lanes,
    pub(crate) lengths: Lanes,
}

impl Rays {
    /// Through the centres of pixels, given by columns and rows.
    #[inline(always)]
    pub(crate) fn new(columns: Lanes, rows: Lanes) -> Self {
        let [width, height] = SIZE.map(|count| count as f32);
        let half_height = (0.5 * FIELD_OF_VIEW).to_radians().tan();
        let scale = 2.0 * half_height / height;
        let x = columns.scaled(scale, scale * (0.5 - 0.5 * width));
        let y = rows.scaled(-scale, -scale * (0.5 - 0.5 * height));
        let toward = Points { x, y, z: x.same(-1.0) };
        let size = toward.dot(toward).sqrt();
        let directions = Points { x: toward.x / size, y: toward.y / size, z: toward.z / size };
        // Where |eye + t direction| is 1.
        let [ex, ey, ez] = EYE;
        let middle =
            directions.x.scaled(ex, 0.0) + directions.y.scaled(ey, 0.0) + directions.z.scaled(ez, 0.0);
        let square = middle.mul_add(middle, x.same(1.0 - (ex * ex + ey * ey + ez * ez)));
        let half = square.hold(0.0, 1.0).sqrt();
        Self { directions, entries: middle.scaled(-1.0, 0.0) - half, lengths: half + half }
    }

    #[inline(always)]
    pub(crate) fn at(&self, simd: V4, t: Lanes) -> Points {
        Points::splat(simd, EYE).ahead(self.directions, t)
    }

    /// What arrives from the light, is scattered towards the eye and is not absorbed, over what is lost from a ray.
    #[inline(always)]
    pub(crate) fn scattering(&self, simd: V4) -> Lanes {
        let cosine = Points::splat(simd, toward_light()).dot(self.directions);
        let base = cosine.scaled(-2.0 * G, 1.0 + G * G);
        let numerator = IRRADIANCE * ALBEDO * (1.0 - G * G) / (4.0 * std::f32::consts::PI);
        cosine.same(numerator) / (base * base.sqrt())
    }
}

/// Unit direction towards the light.
pub(crate) fn toward_light() -> [f32; 3] {
    let [x, y, z] = FROM;
    let size = (x * x + y * y + z * z).sqrt();
    FROM.map(|component| component / size)
}

/// Distance from points in the ball to where they leave it in a direction.
#[inline(always)]
pub(crate) fn way_out(points: Points, direction: Points) -> Lanes {
    let along = points.dot(direction);
    let square = along.mul_add(along, along.same(1.0) - points.dot(points));
    square.hold(0.0, 4.0).sqrt() - along
}

/// What a ray loses per length; 0 outside of the ball.
#[inline(always)]
pub(crate) fn extinction(simd: V4, noise: &Noise, points: Points) -> Lanes {
    let radius = points.dot(points).sqrt();
    let width = 1.0 - FADE_START;
    let t = radius.scaled(1.0 / width, -FADE_START / width).hold(0.0, 1.0);
    let fade = (t * t).mul_add(t.scaled(2.0, -3.0), t.same(1.0));
    let sum = noise.octaves(simd, points.scaled(FREQUENCY, 0.0));
    sum.hold(0.0, f32::MAX) * fade.scaled(DENSITY, 0.0)
}
