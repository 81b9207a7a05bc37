//! Tests of transfer functions.

mod diffusion;
mod images;

use super::*;

const WHITE: [f64; 3] = [1.0; 3];
const BLACK: [f64; 3] = [0.0; 3];
const RED: [f64; 3] = [1.0, 0.0, 0.0];
const BLUE: [f64; 3] = [0.0, 0.0, 1.0];

type Texels = Vec<[f32; 3]>;

fn layer(content: Content<f64>, blend: Blend<f64>) -> Layer<f64> {
    Layer { content, blend }
}

fn solid(color: [f64; 3], blend: Blend<f64>) -> Layer<f64> {
    layer(Content::Solid(color), blend)
}

fn compose(layers: Vec<Layer<f64>>, pictures: &[Picture]) -> Texels {
    texture(&Transfer { keys: vec![layers], shares: Vec::new() }, pictures, &|_| None)
}

/// One layer over white.
fn over(content: Content<f64>) -> Texels {
    compose(vec![layer(content, Blend::Alpha(1.0))], &[])
}

fn gradient(places: [[f64; 2]; 2]) -> Texels {
    over(Content::Gradient { places, colors: [BLACK, WHITE] })
}

/// The texel nearest to a place.
fn at(texels: &Texels, place: [f64; 2]) -> [f32; 3] {
    let [column, row] = place.map(|part| (part * (SIZE - 1) as f64).round() as usize);
    texels[row * SIZE + column]
}

#[track_caller]
fn near(found: [f32; 3], wanted: [f64; 3], most: f64) {
    let apart = found.iter().zip(wanted).map(|(&a, b)| (f64::from(a) - b).abs());
    assert!(apart.into_iter().all(|apart| apart <= most), "{found:?} is not {wanted:?}");
}

/// The largest difference of any channel anywhere.
fn change(a: &Texels, b: &Texels) -> f32 {
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// Numbers of 0 to 1 in no order.
fn dice() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1_u64 << 24) as f64
    }
}

#[test]
fn no_layers_are_white() {
    for keys in [Vec::new(), vec![Vec::new()]] {
        let texels = texture(&Transfer { keys, shares: vec![0.5] }, &[], &|_| None);
        assert_eq!(texels, vec![[1.0; 3]; SIZE * SIZE]);
    }
}

#[test]
fn a_solid_is_one_colour() {
    let texels = over(Content::Solid([0.25, 0.5, 2.0]));
    assert_eq!(texels, vec![[0.25, 0.5, 2.0]; SIZE * SIZE]);
}

#[test]
fn layers_blend_by_their_formulas() {
    let blended = |blend| {
        compose(vec![solid([0.5, 0.2, 1.0], Blend::Multiply), solid([0.25, 0.5, 2.0], blend)], &[])[77]
    };
    near(blended(Blend::Add), [0.75, 0.7, 3.0], 1e-6);
    near(blended(Blend::Multiply), [0.125, 0.1, 2.0], 1e-6);
    near(blended(Blend::Alpha(0.25)), [0.4375, 0.275, 1.25], 1e-6);
    near(blended(Blend::Alpha(7.0)), [0.25, 0.5, 2.0], 1e-6);
    near(blended(Blend::Alpha(-1.0)), [0.5, 0.2, 1.0], 1e-6);
}

#[test]
fn blends_take_coverage_by_their_formulas() {
    let (d, c, a, k) = ([0.5, 0.2, 1.0], [0.25, 0.5, 2.0], 0.4, 0.5);
    let cover = |blend| {
        let constraint = Constraint { place: Place::Fixed([0.5; 2]), color: c, alpha: a };
        let content = Content::Diffusion(vec![constraint]);
        compose(vec![solid(d, Blend::Multiply), layer(content, blend)], &[])[77]
    };
    let each = |formula: fn(f64, f64, f64, f64) -> f64| [0, 1, 2].map(|i| formula(d[i], c[i], a, k));
    near(cover(Blend::Add), each(|d, c, a, _| d + a * c), 1e-6);
    near(cover(Blend::Multiply), each(|d, c, a, _| d * (1.0 - a + a * c)), 1e-6);
    near(cover(Blend::Alpha(k)), each(|d, c, a, k| d * (1.0 - k * a) + k * a * c), 1e-6);
}

#[test]
fn gradients_are_steady_along_their_line() {
    let texels = gradient([[0.0, 0.0], [1.0, 0.0]]);
    for column in 0..SIZE {
        near(texels[19 * SIZE + column], [column as f64 / 255.0; 3], 1e-7);
    }
    let texels = gradient([[0.0, 1.0], [0.0, 0.0]]);
    for row in 0..SIZE {
        near(texels[row * SIZE + 19], [1.0 - row as f64 / 255.0; 3], 1e-7);
    }
    // Beyond the ends it is steady, and across the line.
    let steep = gradient([[0.2, 0.4], [0.4, 0.4]]);
    for (place, level) in [([0.0, 1.0], 0.0), ([0.2, 0.0], 0.0), ([0.4, 1.0], 1.0), ([1.0, 0.0], 1.0)] {
        near(at(&steep, place), [level; 3], 0.0);
    }
    let diagonal = gradient([[0.0, 0.0], [1.0, 1.0]]);
    for (column, row) in [(0, 100), (70, 30), (50, 50)] {
        near(diagonal[row * SIZE + column], [50.0 / 255.0; 3], 1e-7);
    }
}

#[test]
fn a_gradient_between_equal_places_is_its_second_colour() {
    assert_eq!(gradient([[0.5; 2]; 2]), vec![[1.0; 3]; SIZE * SIZE]);
    // As is one between places that cannot be told apart, at its end and beyond.
    near(at(&gradient([[0.2, 0.2], [0.2 + 1e-300, 0.2]]), [0.9, 0.1]), WHITE, 0.0);
    let short = gradient([[0.2, 0.2], [0.2 + 1e-12, 0.2]]);
    near(at(&short, [0.1, 0.5]), BLACK, 0.0);
    near(at(&short, [0.3, 0.5]), WHITE, 0.0);
}

#[test]
fn keys_are_mixed_by_their_shares() {
    let key = |level: f64| vec![solid([level; 3], Blend::Multiply)];
    let mixed = |shares: &[f64]| {
        let keys = vec![key(0.0), key(1.0), key(5.0)];
        texture(&Transfer { keys, shares: shares.to_vec() }, &[], &|_| None)[0]
    };
    for (shares, level) in [
        (&[0.0, 0.0][..], 0.0),
        (&[0.25, 0.0], 0.25),
        (&[0.5, 0.0], 0.5),
        (&[1.0, 0.0], 1.0),
        (&[1.0, 0.5], 3.0),
        (&[1.0, 1.0], 5.0),
        (&[1.0, 1.5], 5.0),
        (&[-1.0, f64::NAN], 0.0),
        // What is missing is 0, and what is over says nothing.
        (&[1.0], 1.0),
        (&[1.0, 0.5, 1.0], 3.0),
    ] {
        near(mixed(shares), [level; 3], 1e-6);
    }
}

#[test]
fn only_keys_that_matter_are_composed() {
    let key = |point| {
        let constraint = Constraint { place: Place::Tracked([point, 0.0, 0.0]), color: RED, alpha: 1.0 };
        vec![layer(Content::Diffusion(vec![constraint]), Blend::Alpha(1.0))]
    };
    let asked = |shares: [f64; 3]| {
        let points = std::cell::RefCell::new(Vec::new());
        let keys = (0..4).map(|i| key(f64::from(i))).collect();
        texture(&Transfer { keys, shares: shares.to_vec() }, &[], &|point| {
            points.borrow_mut().push(point[0]);
            None
        });
        points.into_inner()
    };
    assert_eq!(asked([0.0, 0.0, 0.0]), [0.0]);
    assert_eq!(asked([1.0, 0.5, 0.0]), [1.0, 2.0]);
    assert_eq!(asked([1.0, 1.0, 1.0]), [3.0]);
}

#[test]
fn layers_that_are_not_finite_cover_nothing() {
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        near(over(Content::Solid([bad, 0.0, 0.0]))[0], WHITE, 0.0);
        near(gradient([[0.0, bad], [1.0, 0.0]])[0], WHITE, 0.0);
        let content = Content::Gradient { places: [[0.0; 2], [1.0; 2]], colors: [[0.0, bad, 0.0], WHITE] };
        near(over(content)[0], WHITE, 0.0);
    }
    let blended = |amount| compose(vec![solid(BLACK, Blend::Alpha(amount))], &[])[0];
    near(blended(f64::NAN), WHITE, 0.0);
    near(blended(f64::INFINITY), BLACK, 0.0);
}
