//! Light transport against closed forms, through scene texts.

use crate::support::{ensure, picture};
use libtest_mimic::{Failed, Trial};
use vol_compiler::frame::Pixel;

/// The trials of this file.
pub(crate) fn trials() -> Vec<Trial> {
    vec![
        Trial::test("physics::slab_obeys_beer_lambert", slab_obeys_beer_lambert),
        Trial::test("physics::extinction_is_coloured", extinction_is_coloured),
        Trial::test("physics::emission_of_a_thin_slab", emission_of_a_thin_slab),
        Trial::test("physics::unshadowed_single_scattering", unshadowed_single_scattering),
        Trial::test("physics::shadowed_single_scattering", shadowed_single_scattering),
        Trial::test("physics::overlapping_media_add", overlapping_media_add),
        Trial::test("physics::surface_behind_medium", surface_behind_medium),
        Trial::test("physics::camera_inside_medium", camera_inside_medium),
        Trial::test("physics::lambert_facing_light", lambert_facing_light),
        Trial::test("physics::point_light_falls_off", point_light_falls_off),
        Trial::test("physics::hard_shadow_edge", hard_shadow_edge),
        Trial::test("physics::object_shadows_medium", object_shadows_medium),
        Trial::test("physics::phase_functions_integrate_to_one", phase_functions_integrate_to_one),
        Trial::test("physics::tube_end_is_flat", tube_end_is_flat),
    ]
}

/// A camera far away that looks along -z through a narrow angle: rays are nearly parallel.
const FAR_CAMERA: &str = "camera { from: (0, 0, 50), at: (0, 0, 0), fov: 0.2deg }\n";

/// The middle pixel of a 3x3 picture.
fn centre(scene: &str, step: f32) -> Result<Pixel, Failed> {
    let image = picture(scene, [3, 3], step)?;
    Ok(image.pixels[4])
}

fn near(name: &str, found: f32, expected: f64, tolerance: f64) -> Result<(), Failed> {
    ensure((f64::from(found) - expected).abs() <= tolerance, || {
        format!("{name}: found {found}, expected {expected} within {tolerance:e}")
    })
}

/// Homogeneous density: exact for any step well below the thickness, whatever the comb's phase.
fn slab_obeys_beer_lambert() -> Result<(), Failed> {
    for step in [0.037, 0.11, 0.31, 0.5] {
        let scene = format!(
            "{FAR_CAMERA}medium m {{ region: box((2, 2, 0.75)), scatter: 0.4, absorb: 0.3, lighting: \"none\" }}"
        );
        let pixel = centre(&scene, step)?;
        near(&format!("transmittance at step {step}"), pixel.transmittance[0], (-0.7f64 * 1.5).exp(), 2e-5)?;
    }
    Ok(())
}

fn extinction_is_coloured() -> Result<(), Failed> {
    let scene = format!(
        "{FAR_CAMERA}medium m {{ region: box((2, 2, 0.5)), scatter: 0, absorb: (0.1, 1, 4), lighting: \"none\" }}\nrender {{ background: (1, 2, 3) }}"
    );
    let pixel = centre(&scene, 0.1)?;
    for (i, absorb) in [0.1f64, 1.0, 4.0].into_iter().enumerate() {
        near("transmittance", pixel.transmittance[i], (-absorb).exp(), 2e-5)?;
        near("background behind", pixel.color[i], (i as f64 + 1.0) * (-absorb).exp(), 1e-4)?;
    }
    Ok(())
}

/// Radiance of a slab that only emits: emission times length.
fn emission_of_a_thin_slab() -> Result<(), Failed> {
    let scene =
        format!("{FAR_CAMERA}medium m {{ region: box((2, 2, 0.75)), scatter: 0, emit: (0.2, 0.4, 0.8) }}");
    let pixel = centre(&scene, 0.2)?;
    for (i, emission) in [0.2, 0.4, 0.8].into_iter().enumerate() {
        near("radiance", pixel.color[i], emission * 1.5, 1e-4)?;
    }
    Ok(())
}

/// `albedo E / (4 pi) (1 - exp(-tau))`
fn unshadowed_single_scattering() -> Result<(), Failed> {
    let scene = format!(
        "{FAR_CAMERA}light l {{ from: (1, 0, 0), color: 5 }}\nmedium m {{ region: box((2, 2, 0.75)), scatter: 0.6, absorb: 0.2, lighting: \"unshadowed\" }}"
    );
    let pixel = centre(&scene, 0.1)?;
    let expected = 0.75 * 5.0 / (4.0 * std::f64::consts::PI) * (1.0 - (-0.8f64 * 1.5).exp());
    near("radiance", pixel.color[1], expected, 1e-4)
}

/// Light from the eye's side: a sample at depth x gets exp(-sigma x) and returns exp(-sigma x).
fn shadowed_single_scattering() -> Result<(), Failed> {
    let scene = format!(
        "{FAR_CAMERA}light l {{ from: (0, 0, 1), color: 5 }}\nmedium m {{ region: box((20, 20, 0.75)), scatter: 0.6, absorb: 0.2 }}"
    );
    let pixel = centre(&scene, 0.01)?;
    let expected =
        0.6 * 5.0 / (4.0 * std::f64::consts::PI) * (1.0 - (-2.0f64 * 0.8 * 1.5).exp()) / (2.0 * 0.8);
    near("radiance", pixel.color[1], expected, expected * 1e-3)
}

fn overlapping_media_add() -> Result<(), Failed> {
    let slab = "region: box((2, 2, 0.5)), scatter: 0, lighting: \"none\"";
    let scene = format!("{FAR_CAMERA}medium a {{ {slab}, absorb: 0.7 }}\nmedium b {{ {slab}, absorb: 0.5 }}");
    near("transmittance", centre(&scene, 0.1)?.transmittance[0], (-1.2f64).exp(), 2e-5)
}

/// The medium ends at the surface: half of the slab is hidden.
fn surface_behind_medium() -> Result<(), Failed> {
    let scene = format!(
        "{FAR_CAMERA}medium m {{ region: box((2, 2, 1)), scatter: 0, absorb: 0.5, lighting: \"none\" }}\nobject o {{ shape: box((3, 3, 0.5)).translate((0, 0, -0.5)), material: flat(0.8) }}"
    );
    let pixel = centre(&scene, 0.3)?;
    near("colour", pixel.color[0], 0.8 * (-0.5f64).exp(), 1e-3)?;
    near("depth", pixel.depth, 50.0, 2e-3)?;
    near("transmittance behind a surface", pixel.transmittance[0], 0.0, 0.0)
}

fn camera_inside_medium() -> Result<(), Failed> {
    let scene = "camera { from: (0, 0, 0), at: (0, 0, -1), fov: 1deg }\nmedium m { region: box((2, 2, 2)), scatter: 0, absorb: 0.5, lighting: \"none\" }";
    near("transmittance", centre(scene, 0.3)?.transmittance[0], (-1.0f64).exp(), 2e-4)
}

/// `albedo / pi * E * cos`
fn lambert_facing_light() -> Result<(), Failed> {
    let scene = format!(
        "{FAR_CAMERA}light l {{ from: (0, 3, 4), color: 2 }}\nobject o {{ shape: box((1, 1, 1)), material: diffuse(0.5) }}"
    );
    near("radiance", centre(&scene, 1.0)?.color[2], 0.5 / std::f64::consts::PI * 2.0 * 0.8, 1e-5)
}

fn point_light_falls_off() -> Result<(), Failed> {
    let scene = format!(
        "{FAR_CAMERA}light l {{ at: (0, 0, 5), color: 8 }}\nobject o {{ shape: box((1, 1, 1)), material: diffuse(0.5) }}"
    );
    near("radiance", centre(&scene, 1.0)?.color[0], 0.5 / std::f64::consts::PI * 8.0 / 16.0, 2e-5)
}

/// A wall casts its shadow to where geometry says: the edge at 45 degrees.
fn hard_shadow_edge() -> Result<(), Failed> {
    let scene = "camera { from: (0, 10, 0), at: (0, 0, 0), up: (0, 0, -1), fov: 40deg }\n\
        light l { from: (-1, 1, 0), color: 3 }\n\
        object floor { shape: plane((0, 1, 0)), material: diffuse(0.5) }\n\
        object wall { shape: box((0.1, 1, 50)), material: diffuse(0.5) }";
    let image = picture(scene, [201, 3], 1.0)?;
    // Pixel x of the middle row sees floor at 10 tan(20 deg) aspect u.
    let half = 10.0 * 20f64.to_radians().tan() * 201.0 / 3.0;
    for x in 0..201 {
        let place = (2.0 * (x as f64 + 0.5) / 201.0 - 1.0) * half;
        let lit = image.pixels[201 + x].color[0] > 0.0;
        // Behind the wall, from its foot to as far as it is high, the floor is dark.
        if (0.2..1.0).contains(&place) {
            ensure(!lit, || format!("the floor at {place} is lit"))?;
        }
        if !(-0.2..=1.2).contains(&place) {
            ensure(lit, || format!("the floor at {place} is dark"))?;
        }
    }
    Ok(())
}

/// A disc between light and medium leaves the medium dark.
fn object_shadows_medium() -> Result<(), Failed> {
    let scene = format!(
        "{FAR_CAMERA}light l {{ from: (1, 0, 0), color: 5 }}\nmedium m {{ region: box((0.2, 0.2, 0.2)), scatter: 1 }}\nobject o {{ shape: box((0.1, 1, 1)).translate((2, 0, 0)), material: flat(1) }}"
    );
    near("radiance", centre(&scene, 0.05)?.color[0], 0.0, 0.0)
}

/// Every phase function through an optically thin ball seen from all sides: here by quadrature of
/// the compiled function over the cosine.
fn phase_functions_integrate_to_one() -> Result<(), Failed> {
    let phases = [
        "isotropic()",
        "henyey_greenstein(0.6)",
        "henyey_greenstein(-0.85)",
        "rayleigh()",
        "schlick(0.5)",
        "double_hg(0.8, -0.4, 0.7)",
    ];
    for phase in phases {
        let scene = format!("medium m {{ region: sphere(1), phase: {phase} }}");
        let program = crate::support::compile("phase.vol", &scene)?;
        let frame = crate::support::frame(&program, 0.0, [4, 4])?;
        let function = program.module.function(program.media[0].phase);
        let parts = 20_000;
        let mut sum = 0.0;
        for i in 0..parts {
            let cosine = -1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(parts);
            let inputs = [1.0 - cosine, 1.0 + cosine];
            sum += vol_compiler::reference::evaluate(function, &inputs, &frame.uniforms, &frame.curves)[0];
        }
        let integral = sum * 2.0 / f64::from(parts) * 2.0 * std::f64::consts::PI;
        near(phase, integral as f32, 1.0, 1e-4)?;
    }
    Ok(())
}

/// A straight tube along the view: its length is that of the axis, flat ends and all.
fn tube_end_is_flat() -> Result<(), Failed> {
    for step in [0.05, 0.13] {
        let scene = format!(
            "{FAR_CAMERA}medium m {{ region: tube(line((0, 0, -0.6), (0, 0, 0.6)), radius: 0.5), scatter: 0, absorb: 1, lighting: \"none\" }}"
        );
        near("transmittance", centre(&scene, step)?.transmittance[0], (-1.2f64).exp(), 1e-3)?;
    }
    Ok(())
}
