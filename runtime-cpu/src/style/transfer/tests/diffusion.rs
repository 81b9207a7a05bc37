//! Diffusion layers.

use super::*;

type Fixed = ([f64; 2], [f64; 3]);

fn constraint((place, color): Fixed, alpha: f64) -> Constraint<f64> {
    Constraint { place: Place::Fixed(place), color, alpha }
}

fn diffusion(constraints: &[Fixed]) -> Texels {
    over(Content::Diffusion(constraints.iter().map(|&fixed| constraint(fixed, 1.0)).collect()))
}

/// Constraints anywhere, at middles of texels so that there is one to look at, no two at one texel or beside
/// it.
fn random(count: usize) -> Vec<Fixed> {
    let mut roll = dice();
    let mut all: Vec<Fixed> = Vec::new();
    while all.len() < count {
        let place = [roll(), roll()].map(|part| (part * 255.0).round() / 255.0);
        if all.iter().all(|(other, _)| (other[0] - place[0]).hypot(other[1] - place[1]) > 1.5 / 255.0) {
            all.push((place, [roll(), 0.3 + 0.4 * roll(), 5.0 * roll()]));
        }
    }
    all
}

#[test]
fn none_cover_nothing_and_one_covers_all() {
    near(diffusion(&[])[0], WHITE, 0.0);
    assert_eq!(diffusion(&[([0.3, 0.4], RED)]), vec![[1.0, 0.0, 0.0]; SIZE * SIZE]);
    // Places outside are at the border.
    let (two, held) = ([([-7.0, 0.2], RED), ([1.0, 9.0], BLUE)], [([0.0, 0.2], RED), ([1.0, 1.0], BLUE)]);
    assert_eq!(diffusion(&two), diffusion(&held));
}

#[test]
fn two_are_the_gradient_between_their_places() {
    for places in
        [[[0.0, 0.5], [1.0, 0.5]], [[0.2, 0.3], [0.7, 0.5]], [[0.4, 0.8], [0.4, 0.1]], [[0.9; 2], [0.1; 2]]]
    {
        let two = diffusion(&[(places[0], BLACK), (places[1], WHITE)]);
        assert!(change(&two, &gradient(places)) < 1e-6);
    }
}

#[test]
fn on_one_line_they_are_linear_from_one_to_the_next() {
    let stops = [(0.8, BLUE), (0.2, RED), (0.4, BLACK)];
    let wanted = |x: f64| match x {
        _ if x < 0.4 => mix(&RED, &BLACK, ((x - 0.2) / 0.2).max(0.0)),
        _ => mix(&BLACK, &BLUE, ((x - 0.4) / 0.4).min(1.0)),
    };
    let along_a_row = diffusion(&stops.map(|(x, color)| ([x, 0.4], color)));
    for (index, &texel) in along_a_row.iter().enumerate() {
        near(texel, wanted(place(index % SIZE)), 1e-6);
    }
    let diagonal = diffusion(&stops.map(|(x, color)| ([x, x], color)));
    for (index, &texel) in diagonal.iter().enumerate() {
        near(texel, wanted(0.5 * (place(index % SIZE) + place(index / SIZE))), 1e-6);
    }
}

#[test]
fn three_are_met_and_nothing_jumps_between() {
    let three = [([0.2, 0.2], RED), ([0.8, 0.4], BLUE), ([0.4, 0.8], WHITE)];
    let texels = diffusion(&three);
    three.iter().for_each(|&(place, color)| near(at(&texels, place), color, 1e-6));
    for index in 0..SIZE * (SIZE - 1) - 1 {
        let beside = if index % SIZE + 1 < SIZE { index + 1 } else { index };
        for next in [beside, index + SIZE] {
            near(texels[next], texels[index].map(f64::from), 0.02);
        }
    }
}

#[test]
fn many_are_met_and_no_channel_leaves_their_range() {
    let all = random(200);
    let texels = diffusion(&all);
    all.iter().for_each(|&(place, color)| near(at(&texels, place), color, 1e-5));
    for channel in 0..3 {
        let colors = || all.iter().map(|(_, color)| color[channel] as f32);
        let (least, greatest) = (colors().fold(f32::MAX, f32::min), colors().fold(0.0, f32::max));
        assert!(texels.iter().all(|texel| (least - 1e-6..=greatest + 1e-6).contains(&texel[channel])));
    }
}

#[test]
fn neighbouring_texels_may_all_be_fixed() {
    let mut roll = dice();
    let side = |i: usize| (100 + i) as f64 * 1.0001 / 255.0;
    let all: Vec<Fixed> =
        (0..400).map(|i| ([side(i % 20), side(i / 20)], [roll(), roll(), roll()])).collect();
    let texels = diffusion(&all);
    for &(place, color) in &all {
        near(at(&texels, place), color, 0.05);
    }
    assert!(texels.as_flattened().iter().all(|channel| (0.0..=1.0).contains(channel)));
}

#[test]
fn those_at_one_place_become_their_mean() {
    let (a, b) = ([0.5; 2], [0.5 + 0.9 / 255.0, 0.5]);
    near(diffusion(&[(a, RED), (a, BLUE)])[9], [0.5, 0.0, 0.5], 1e-6);
    near(diffusion(&[(a, RED), (b, BLUE), (a, WHITE)])[9], [2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0], 1e-6);
    let (c, d) = (([0.1, 0.9], WHITE), ([0.8, 0.3], BLACK));
    let mean = diffusion(&[(a, [0.5, 0.0, 0.5]), c, d]);
    assert!(change(&diffusion(&[(a, RED), c, (a, BLUE), d]), &mean) < 1e-6);
}

#[test]
fn crossing_the_line_between_two_others_changes_little() {
    for others in [&[][..], &[([0.3, 0.51], RED)], &[([0.2, 0.9], RED), ([0.6, 0.1], BLUE)]] {
        let moved = |y: f64| {
            let line = [([0.1, 0.5], BLACK), ([0.5, y], WHITE), ([0.9, 0.5], BLACK)];
            diffusion(&[&line[..], others].concat())
        };
        let on = moved(0.5);
        for off in [1e-3, 1e-6, -1e-6, -1e-3] {
            assert!(change(&moved(0.5 + off), &on) < 0.03);
        }
    }
}

#[test]
fn coverage_lets_what_is_below_through() {
    // The colour of what covers nothing never shows.
    let (clear, black) = (([0.0, 0.5], [9.0; 3]), ([1.0, 0.5], BLACK));
    let texels = over(Content::Diffusion(vec![constraint(clear, 0.0), constraint(black, 1.0)]));
    for share in [0.0, 0.2, 0.6, 1.0] {
        near(at(&texels, [share, 0.3]), [1.0 - share; 3], 1e-6);
    }
    near(over(Content::Diffusion(vec![constraint(black, 0.0)]))[0], WHITE, 0.0);
    near(over(Content::Diffusion(vec![constraint(black, -3.0)]))[0], WHITE, 0.0);
    near(over(Content::Diffusion(vec![constraint(black, 7.0)]))[0], BLACK, 0.0);
}

#[test]
fn colours_stay_in_range_under_any_coverage() {
    let mut roll = dice();
    let all: Vec<_> =
        random(30).into_iter().map(|fixed| constraint((fixed.0, [0.5, 0.25, 1.0]), roll())).collect();
    // All have one colour: by how much it covers, not what it is, is all that may vary.
    let texels = compose(vec![layer(Content::Diffusion(all), Blend::Multiply)], &[]);
    for [r, g, b] in texels {
        let coverage = (1.0 - r) / 0.5;
        assert!((0.0..=1.0 + 1e-6).contains(&coverage));
        assert!((g - (1.0 - 0.75 * coverage)).abs() < 1e-5 && (b - 1.0).abs() < 1e-5);
    }
}

#[test]
fn beside_a_wide_set_they_go_on_and_coverage_stays_in_range() {
    let coverage = |places: [[f64; 2]; 4]| {
        let all = places.into_iter().zip([1.0, 0.2, 0.2, 0.2]);
        let all = all.map(|(place, alpha)| constraint((place, BLACK), alpha)).collect();
        over(Content::Diffusion(all)).iter().map(|texel| 1.0 - texel[0]).collect::<Vec<_>>()
    };
    // These are apt to leave the range.
    let close = coverage([[0.45, 0.5], [0.5, 0.45], [0.55, 0.52], [0.5, 0.56]]);
    assert!(close.iter().all(|level| (0.2 - 1e-6..=1.0 + 1e-6).contains(level)));
    let wide = coverage([[0.2, 0.5], [0.8, 0.5], [0.5, 0.35], [0.5, 0.65]]);
    assert!((wide[20 * SIZE + 40] - wide[60 * SIZE + 40]).abs() > 1e-2);
}

#[test]
fn tracked_ones_are_where_their_points_are() {
    let point = |x: f64| Constraint { place: Place::Tracked([x, 2.0, 3.0]), color: BLACK, alpha: 1.0 };
    let at_point = |x: f64, place: Option<[f64; 2]>| {
        let content = Content::Diffusion(vec![point(x), constraint(([1.0, 0.5], WHITE), 1.0)]);
        let transfer = Transfer { keys: vec![vec![layer(content, Blend::Multiply)]], shares: Vec::new() };
        texture(&transfer, &[], &move |point| if point == [1.0, 2.0, 3.0] { place } else { None })
    };
    let texels = at_point(1.0, Some([0.2, 0.5]));
    near(at(&texels, [0.2, 0.5]), BLACK, 1e-2);
    near(at(&texels, [0.6, 0.5]), [0.5; 3], 1e-2);
    // What is nowhere is left out.
    for (x, place) in [(0.0, Some([0.2, 0.5])), (1.0, None), (1.0, Some([f64::NAN, 0.5]))] {
        near(at(&at_point(x, place), [0.2, 0.5]), WHITE, 0.0);
    }
}

#[test]
fn those_that_are_not_finite_are_left_out() {
    let good = ([0.5; 2], BLUE);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        near(diffusion(&[([bad, 0.5], RED), good])[0], BLUE, 0.0);
        near(diffusion(&[([0.5, 0.1], [0.0, bad, 0.0]), good])[0], BLUE, 0.0);
        let content = Content::Diffusion(vec![constraint(([0.1; 2], RED), bad), constraint(good, 1.0)]);
        near(over(content)[0], BLUE, 0.0);
    }
    let large = f64::from(f32::MAX);
    let texels = diffusion(&[([0.1; 2], [large; 3]), ([0.9, 0.1], [-large; 3]), ([0.3, 0.8], BLACK)]);
    assert!(texels.as_flattened().iter().all(|channel| channel.is_finite()));
}
