//! Soft shadows and occlusion against geometry, on both backends: the part of a light that is seen,
//! counted with many straight rays in f64, and places whose openness is a formula.

use crate::support::{Body, Draw, compile, ensure, frame, on_both};
use libtest_mimic::{Failed, Trial};
use std::f64::consts::{FRAC_1_SQRT_2, PI};
use vol_compiler::frame::{CameraFrame, Job, Quadrature, Sampling};

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    let bodies: [(&str, Body); 7] = [
        ("penumbra_matches_many_rays", penumbra_matches_many_rays),
        ("light_without_size_is_as_before", light_without_size_is_as_before),
        ("lamp_before_a_wall_is_whole", lamp_before_a_wall_is_whole),
        ("occlusion_of_known_places", occlusion_of_known_places),
        ("occlusion_stays_in_range", occlusion_stays_in_range),
        ("phong_has_three_terms", phong_has_three_terms),
        ("normals_flat_and_fields_of_color", normals_flat_and_fields_of_color),
    ];
    bodies.into_iter().flat_map(|(name, body)| on_both(&format!("lights::{name}"), body)).collect()
}

type V = [f64; 3];

fn plus(a: V, b: V, k: f64) -> V {
    [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]]
}

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: V) -> V {
    a.map(|x| x / dot(a, a).sqrt())
}

/// A pixel that shows a surface: its colour and place.
struct Seen {
    color: V,
    place: V,
    /// Unit direction of the ray.
    direction: V,
}

/// The pixels of a small picture that show surfaces.
fn seen(draw: &Draw<'_>, text: &str) -> Result<Vec<Seen>, Failed> {
    const SIZE: [u32; 2] = [60, 40];
    let program = compile("test.vol", text)?;
    let frame = frame(&program, 0.0, SIZE)?;
    let image = draw(
        &program,
        &frame,
        &Job {
            size: SIZE,
            step: 1.0,
            shadow_step: 1.0,
            quadrature: Quadrature::Midpoint,
            sampling: Sampling::CENTRE,
        },
    )?;
    let CameraFrame { origin, forward, right, up } = frame.camera;
    let [origin, forward, right, up] = [origin, forward, right, up].map(|v| v.map(f64::from));
    let pixels = image.pixels.iter().enumerate().filter(|(_, pixel)| pixel.depth.is_finite());
    let pixels = pixels.map(|(index, pixel)| {
        let (x, y) = (index % SIZE[0] as usize, index / SIZE[0] as usize);
        let u = 2.0 * (x as f64 + 0.5) / f64::from(SIZE[0]) - 1.0;
        let v = 1.0 - 2.0 * (y as f64 + 0.5) / f64::from(SIZE[1]);
        let toward = plus(plus(forward, right, u), up, v);
        Seen {
            color: pixel.color.map(f64::from),
            place: plus(origin, toward, f64::from(pixel.depth)),
            direction: unit(toward),
        }
    });
    Ok(pixels.collect())
}

/// Whether a straight line from a point meets a solid.
type Hits = fn(V, V) -> bool;

fn hits_ball(centre: V, radius: f64, from: V, direction: V) -> bool {
    let relative = plus(from, centre, -1.0);
    let b = dot(relative, direction);
    b < 0.0 && b * b > dot(relative, relative) - radius * radius
}

fn hits_box(centre: V, half: V, from: V, direction: V) -> bool {
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    for i in 0..3 {
        let to = |side: f64| (centre[i] + side * half[i] - from[i]) / direction[i];
        enter = enter.max(to(-1.0).min(to(1.0)));
        leave = leave.min(to(-1.0).max(to(1.0)));
    }
    enter < leave
}

/// What throws a shadow, in the language and as a formula.
const OCCLUDERS: [(&str, Hits); 5] = [
    ("sphere(0.5).translate((0.3, 1.5, 0))", |from, to| hits_ball([0.3, 1.5, 0.0], 0.5, from, to)),
    ("box((0.5, 0.4, 0.6)).translate((0, 1.4, 0))", |from, to| {
        hits_box([0.0, 1.4, 0.0], [0.5, 0.4, 0.6], from, to)
    }),
    // A thin wall hides as well as a thick one.
    ("box((0.9, 0.004, 0.7)).translate((0, 1.4, 0))", |from, to| {
        hits_box([0.0, 1.4, 0.0], [0.9, 0.004, 0.7], from, to)
    }),
    ("box((0.05, 0.05, 2)).translate((0, 1, 0))", |from, to| {
        hits_box([0.0, 1.0, 0.0], [0.05, 0.05, 2.0], from, to)
    }),
    // One long straight edge.
    ("box((8, 0.01, 5)).translate((0, 1.5, -5.5))", |from, to| {
        hits_box([0.0, 1.5, -5.5], [8.0, 0.01, 5.0], from, to)
    }),
];

/// Lights: block, place or direction, size as radius or tangent.
const LIGHTS: [(&str, bool, V, f64); 3] = [
    ("from: (0.5, 1, 0.3), color: 1, spread: 12deg", true, [0.5, 1.0, 0.3], 0.105_104_235),
    ("from: (-0.2, 1, 0.1), color: 1, spread: 40deg", true, [-0.2, 1.0, 0.1], 0.363_970_234),
    ("at: (0.5, 4, 0.5), color: 1, radius: 0.4", false, [0.5, 4.0, 0.5], 0.4),
];

/// Fraction of a light's disk, `grow` times as large, that is seen from a point.
fn brute_force(from: V, (distant, place, size): (bool, V, f64), grow: f64, hits: Hits) -> f64 {
    const RAYS: usize = 400;
    let toward = if distant { place } else { plus(place, from, -1.0) };
    let direction = unit(toward);
    let slope = if distant { size } else { size / dot(toward, toward).sqrt() };
    let right = unit(plus([0.0, 0.0, 1.0], direction, -direction[2]));
    let up = [
        direction[1] * right[2] - direction[2] * right[1],
        direction[2] * right[0] - direction[0] * right[2],
        direction[0] * right[1] - direction[1] * right[0],
    ];
    let free = (0..RAYS).filter(|&i| {
        let radius = grow * slope * ((i as f64 + 0.5) / RAYS as f64).sqrt();
        let turn = i as f64 * PI * (3.0 - 5f64.sqrt());
        let aside = plus(right.map(|x| x * radius * turn.cos()), up, radius * turn.sin());
        !hits(from, unit(plus(direction, aside, 1.0)))
    });
    free.count() as f64 / RAYS as f64
}

fn penumbra_matches_many_rays(draw: &Draw<'_>) -> Result<(), Failed> {
    for (solid, hits) in OCCLUDERS {
        for (light, distant, place, size) in LIGHTS {
            let text = format!(
                "camera {{ from: (0.5, 7, 6), at: (0, 0.5, 0), fov: 40deg }}\nlight l {{ {light} }}\n\
                 object floor {{ shape: plane((0, 1, 0)), material: phong(0, 1, 0, 1) }}\n\
                 object solid {{ shape: {solid}, material: flat((0, 0, 9)) }}"
            );
            let (mut worst, mut where_worst, mut between) = (0.0f64, [0.0; 3], 0);
            for Seen { color, place: at, .. } in seen(draw, &text)?.into_iter().filter(|s| s.color[2] < 8.0) {
                let toward = if distant { place } else { plus(place, at, -1.0) };
                let strength = if distant { 1.0 } else { 1.0 / dot(toward, toward) };
                let full = strength * unit(toward)[1];
                let part = color[0] / full;
                let around = |grow| brute_force(at, (distant, place, size), grow, hits);
                let expected = around(1.0);
                between += usize::from(expected > 0.05 && expected < 0.95);
                if (part - expected).abs() > worst {
                    (worst, where_worst) = ((part - expected).abs(), at);
                }
                // Where the whole light is clear or hidden, with some room, nothing is approximate.
                let settled = (expected == 0.0 || expected == 1.0) && expected == around(1.15);
                ensure(!settled || (part - expected).abs() < 1e-4, || {
                    format!("{solid}, {light}: {part} of the light at {at:?} instead of {expected}")
                })?;
            }
            ensure(between > 15, || format!("{solid}, {light}: only {between} places in the penumbra"))?;
            ensure(worst < 0.09, || {
                format!("{solid}, {light}: the part that is seen is off by {worst} at {where_worst:?}")
            })?;
        }
    }
    Ok(())
}

const BALL_ON_FLOOR: &str = "camera { from: (0, 4, 6), at: (0, 0.5, 0), fov: 40deg }\n\
    object floor { shape: plane((0, 1, 0)) }\nobject ball { shape: sphere(0.5).translate((0, 0.6, 0)) }\n";

/// A size or a distance of 0 is the light of old, bit for bit, also if a param makes it so.
fn light_without_size_is_as_before(draw: &Draw<'_>) -> Result<(), Failed> {
    let colors = |light: &str| -> Result<Vec<V>, Failed> {
        let text = format!("param none: float = 0 in 0..1\n{BALL_ON_FLOOR}light l {{ {light} }}\n");
        Ok(seen(draw, &text)?.into_iter().map(|seen| seen.color).collect())
    };
    for place in ["from: (1, 2, 1), color: 3", "at: (1, 2, 1), color: 3"] {
        let kind = if place.starts_with("from") { "spread: none * 1deg" } else { "radius: none" };
        let plain = colors(place)?;
        let with = colors(&format!("{place}, {kind}, occlusion: none"))?;
        ensure(plain == with, || format!("{place}: a size of 0 changes the picture"))?;
    }
    Ok(())
}

/// What is behind a lamp hides nothing of it.
fn lamp_before_a_wall_is_whole(draw: &Draw<'_>) -> Result<(), Failed> {
    let text = "camera { from: (0, 3, 6), at: (0, 0, 0), fov: 40deg }\n\
        light l { at: (0, 2, 0), color: 1, radius: 0.4 }\n\
        object floor { shape: plane((0, 1, 0)), material: phong(0, 1, 0, 1) }\n\
        object ceiling { shape: box((1, 0.5, 1)).translate((0, 2.6, 0)), material: flat((0, 0, 9)) }";
    for Seen { color, place, .. } in seen(draw, text)?.into_iter().filter(|seen| seen.color[2] < 8.0) {
        let toward = plus([0.0, 2.0, 0.0], place, -1.0);
        let full = unit(toward)[1] / dot(toward, toward);
        // Far out the edge of the ceiling hangs before the lamp's upper rim.
        if place[0].hypot(place[2]) < 1.5 {
            ensure((color[0] / full - 1.0).abs() < 1e-4, || {
                format!("{} of the lamp at {place:?}", color[0] / full)
            })?;
        }
    }
    Ok(())
}

/// Distance of the nearest surface at a height above a place.
type Distance = fn(V, f64) -> f64;

/// One minus the weighted lack of distance, of a distance per height.
fn openness(reach: f64, distance: impl Fn(f64) -> f64) -> f64 {
    let hidden = (1..=5).map(|i| {
        let height = reach * f64::from(i) / 5.0;
        f64::from(1 << (5 - i)) / 31.0 * (0.5 * (1.0 - distance(height) / height)).clamp(0.0, 1.0)
    });
    1.0 - hidden.sum::<f64>()
}

fn occlusion_of_known_places(draw: &Draw<'_>) -> Result<(), Failed> {
    const REACH: f64 = 0.6;
    // A plane, a wall at a right angle, a wall that leans over the floor by 45 degrees.
    let walls: [(&str, Distance); 3] = [
        ("", |_, height| height),
        ("object wall { shape: plane((1, 0, 0)) }", |place, height| height.min(place[0])),
        ("object wall { shape: plane((1, -1, 0)) }", |place, height| {
            height.min(FRAC_1_SQRT_2 * (place[0] - height))
        }),
    ];
    for (wall, distance) in walls {
        let text = format!(
            "camera {{ from: (2, 1.5, 3), at: (0.3, 0, 0), fov: 30deg }}\n\
             light l {{ from: (0, 1, 0), color: 1, shadows: false, occlusion: {REACH} }}\n\
             object floor {{ shape: plane((0, 1, 0)), material: phong(0, 1, 0, 1) }}\n{wall}"
        );
        let mut near = 0;
        for Seen { color, place, .. } in seen(draw, &text)?.into_iter().filter(|seen| seen.place[1] < 1e-4) {
            let expected = openness(REACH, |height| distance(place, height));
            near += usize::from(place[0] < 0.1);
            ensure((color[0] - expected).abs() < 2e-4, || {
                format!("{wall}: {} at {place:?} instead of {expected}", color[0])
            })?;
        }
        ensure(near > 20, || format!("{wall}: only {near} places near the wall"))?;
    }
    // At the foot of a wall half is hidden, under a wall that leans over more.
    let (corner, crevice) = (openness(REACH, |_| 0.0), openness(REACH, |height| -FRAC_1_SQRT_2 * height));
    ensure((corner - 0.5).abs() < 1e-12 && crevice < 0.2, || format!("{corner}, {crevice}"))
}

fn occlusion_stays_in_range(draw: &Draw<'_>) -> Result<(), Failed> {
    for reach in ["0.001", "0.5", "50"] {
        let text = format!(
            "camera {{ from: (0, 4, 6), at: (0, 0.5, 0), fov: 40deg }}\n\
             light l {{ from: (0, 1, 0), color: 1, shadows: false, occlusion: {reach} }}\n\
             object floor {{ shape: plane((0, 1, 0)), material: phong(0, 1, 0, 1) }}\n\
             object ball {{ shape: sphere(1).displace(q => 0.2 * perlin(4 * q)), material: phong(0, 1, 0, 1) }}"
        );
        for Seen { color, place, .. } in seen(draw, &text)? {
            ensure((0.0..=1.0).contains(&color[0]), || format!("{} at {place:?}, reach {reach}", color[0]))?;
        }
    }
    Ok(())
}

/// `ka * ambient + E (kd N.L + ks (R.E)^s)` on a ball, each factor on its own channel.
fn phong_has_three_terms(draw: &Draw<'_>) -> Result<(), Failed> {
    let text = "camera { from: (1, 2, 5), at: (0, 0, 0), fov: 30deg }\n\
        light l { from: (1, 2, 2), color: (2, 3, 4), shadows: false }\n\
        object ball { shape: sphere(1), material: phong((0.1, 0, 0.3), (0.5, 0.25, 0.1), (0.2, 0.9, 0.4), 12) }\n\
        render { ambient: (0.5, 0.6, 0.7) }";
    let toward = unit([1.0, 2.0, 2.0]);
    for Seen { color, place, direction } in seen(draw, text)? {
        let normal = unit(place);
        let cosine = dot(normal, toward);
        let mirrored = plus(normal.map(|x| 2.0 * cosine * x), toward, -1.0);
        let shine = (-dot(mirrored, direction)).max(0.0).powf(12.0);
        // Where the ray only touches the ball the place is less sure than elsewhere.
        if dot(normal, direction) > -0.2 || cosine.abs() < 1e-3 {
            continue;
        }
        for i in 0..3 {
            let (ambient, irradiance) = ([0.05, 0.0, 0.21][i], [2.0, 3.0, 4.0][i]);
            let (kd, ks) = ([0.5, 0.25, 0.1][i], [0.2, 0.9, 0.4][i]);
            let lit = if cosine > 0.0 { irradiance * (kd * cosine + ks * shine) } else { 0.0 };
            ensure((color[i] - (ambient + lit)).abs() < 1e-3, || {
                format!("channel {i} is {} at {place:?} instead of {}", color[i], ambient + lit)
            })?;
        }
    }
    Ok(())
}

/// `(N + 1) / 2`, a colour whatever the light, and colours that follow the place.
fn normals_flat_and_fields_of_color(draw: &Draw<'_>) -> Result<(), Failed> {
    type Expected = fn(V) -> V;
    let half = |place: V| unit(place).map(|x| 0.5 * (x + 1.0));
    let lit = |place: V| place.map(|x| (0.5 + 0.4 * x) / PI * 3.0 * unit(place)[1].max(0.0));
    let materials: [(&str, Expected); 4] = [
        ("normals()", half),
        ("flat((0.2, 0.5, 4))", |_| [0.2, 0.5, 4.0]),
        ("flat(q => (q.world.x * q.world.x, 0.5 + 0.5 * q.world.y, 1))", |[x, y, _]| {
            [x * x, 0.5 + 0.5 * y, 1.0]
        }),
        ("diffuse(q => 0.5 + 0.4 * q.world)", lit),
    ];
    for (material, expected) in materials {
        let text = format!(
            "camera {{ from: (1, 2, 5), at: (0, 0, 0), fov: 30deg }}\nlight l {{ from: (0, 1, 0), color: 3 }}\n\
             object ball {{ shape: sphere(1), material: {material} }}"
        );
        for Seen { color, place, direction } in seen(draw, &text)? {
            if dot(unit(place), direction) > -0.2 || place[1].abs() < 1e-2 {
                continue;
            }
            let wanted = expected(place);
            ensure((0..3).all(|i| (color[i] - wanted[i]).abs() < 3e-4), || {
                format!("{material}: {color:?} at {place:?} instead of {wanted:?}")
            })?;
        }
    }
    Ok(())
}
