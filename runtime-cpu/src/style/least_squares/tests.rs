use super::*;

type Rows = Vec<Vec<(u32, Rgb)>>;

/// Numbers in 0..1, the same on every run.
struct Random(u64);

impl Random {
    fn word(&mut self) -> u64 {
        // Knuth's MMIX generator; its high bits are good enough for test data.
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    fn number(&mut self) -> f32 {
        (self.word() % (1 << 20)) as f32 / (1 << 20) as f32
    }

    fn below(&mut self, end: usize) -> usize {
        self.word() as usize % end
    }

    fn color(&mut self) -> Rgb {
        from_fn(|_| self.number())
    }

    fn colors(&mut self, count: usize) -> Vec<Rgb> {
        (0..count).map(|_| self.color()).collect()
    }

    /// Rows in any order of texels, some of which come more than once.
    fn rows(&mut self, pixels: usize, texels: usize, most: usize, colored: bool) -> Rows {
        let entry = |random: &mut Self| {
            let grey = 0.01 + random.number();
            let weight = if colored { random.color() } else { [grey; 3] };
            (random.below(texels) as u32, weight)
        };
        (0..pixels).map(|_| (0..self.below(most + 1)).map(|_| entry(self)).collect()).collect()
    }
}

/// All products in f64.
struct Dense {
    /// Per pixel, texel and channel.
    weights: Vec<Vec<[f64; 3]>>,
    size: usize,
}

impl Dense {
    fn new(rows: &Rows, size: usize) -> Self {
        let mut weights = vec![vec![[0.0; 3]; size * size]; rows.len()];
        for (row, weights) in rows.iter().zip(&mut weights) {
            for (texel, weight) in row {
                let sum = &mut weights[*texel as usize];
                *sum = from_fn(|channel| sum[channel] + f64::from(weight[channel]));
            }
        }
        Self { weights, size }
    }

    /// `T x` of a channel.
    fn forward(&self, channel: usize, x: &[f64]) -> Vec<f64> {
        let pixel = |row: &Vec<[f64; 3]>| row.iter().zip(x).map(|(weight, x)| weight[channel] * x).sum();
        self.weights.iter().map(pixel).collect()
    }

    /// `T'T` of a channel.
    fn normal(&self, channel: usize) -> Vec<Vec<f64>> {
        let texels = self.size * self.size;
        let product =
            |i: usize, j: usize| self.weights.iter().map(|row| row[i][channel] * row[j][channel]).sum();
        (0..texels).map(|i| (0..texels).map(|j| product(i, j)).collect()).collect()
    }

    /// Pulls of a channel, not relative: lambda and mu.
    fn pulls(&self, channel: usize, settings: &Fit) -> [f64; 2] {
        let normal = self.normal(channel);
        let most = (0..normal.len()).map(|i| normal[i][i]).fold(0.0, f64::max);
        [settings.lambda * most, settings.mu * most]
    }

    /// `T'T + lambda + mu K` and `T'b + lambda x0`.
    fn equations(&self, channel: usize, target: &[Rgb], settings: &Fit) -> (Vec<Vec<f64>>, Vec<f64>) {
        let [lambda, mu] = self.pulls(channel, settings);
        let mut matrix = self.normal(channel);
        let side = |texel: usize| {
            let sum: f64 = self
                .weights
                .iter()
                .zip(target)
                .map(|(row, b)| row[texel][channel] * f64::from(b[channel]))
                .sum();
            sum + lambda
        };
        let sides = (0..matrix.len()).map(side).collect();
        for (i, row) in matrix.iter_mut().enumerate() {
            row[i] += lambda;
        }
        for (a, b) in self.neighbours() {
            matrix[a][a] += mu;
            matrix[b][b] += mu;
            matrix[a][b] -= mu;
            matrix[b][a] -= mu;
        }
        (matrix, sides)
    }

    /// Pairs of texels beside each other.
    fn neighbours(&self) -> Vec<(usize, usize)> {
        let size = self.size;
        let right = (0..size * size).filter(|at| at % size + 1 < size).map(|at| (at, at + 1));
        let below = (0..size * size).filter(|at| at / size + 1 < size).map(|at| (at, at + size));
        right.chain(below).collect()
    }

    /// What is made least, summed over the channels.
    fn objective(&self, x: &[Rgb], target: &[Rgb], settings: &Fit) -> f64 {
        let of_channel = |channel: usize| {
            let x: Vec<f64> = x.iter().map(|x| f64::from(x[channel])).collect();
            let [lambda, mu] = self.pulls(channel, settings);
            let seen = self.forward(channel, &x);
            let misfit: f64 =
                seen.iter().zip(target).map(|(seen, b)| (seen - f64::from(b[channel])).powi(2)).sum();
            let from_white: f64 = x.iter().map(|x| (x - 1.0).powi(2)).sum();
            let rises: f64 = self.neighbours().iter().map(|&(a, b)| (x[a] - x[b]).powi(2)).sum();
            misfit + lambda * from_white + mu * rises
        };
        (0..3).map(of_channel).sum()
    }
}

/// Solves a symmetric positive system by elimination.
fn solve(mut matrix: Vec<Vec<f64>>, mut sides: Vec<f64>) -> Vec<f64> {
    let count = sides.len();
    for pivot in 0..count {
        let (lead, side) = (matrix[pivot].clone(), sides[pivot]);
        for (row, own) in matrix.iter_mut().zip(&mut sides).skip(pivot + 1) {
            let factor = row[pivot] / lead[pivot];
            row.iter_mut().zip(&lead).for_each(|(x, lead)| *x -= factor * lead);
            *own -= factor * side;
        }
    }
    for row in (0..count).rev() {
        let known: f64 = (row + 1..count).map(|column| matrix[row][column] * sides[column]).sum();
        sides[row] = (sides[row] - known) / matrix[row][row];
    }
    sides
}

fn dot(a: &[Rgb], b: &[Rgb]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
}

fn bits(colors: &[Rgb]) -> Vec<[u32; 3]> {
    colors.iter().map(|color| color.map(f32::to_bits)).collect()
}

/// Only the pull to white, and that weak.
const WEAK: Fit = Fit { lambda: 1e-8, mu: 0.0, iterations: 64, tolerance: 1e-12, projections: 8 };

#[test]
fn the_products_are_adjoint() {
    let mut random = Random(1);
    for case in 0..40 {
        let (pixels, size, most) = (1 + random.below(300), 1 + random.below(20), 1 + random.below(60));
        let transport = Transport::new(random.rows(pixels, size * size, most, case % 2 == 0), size * size);
        let (x, y) = (random.colors(size * size), random.colors(pixels));
        let (there, back) = (dot(&transport.forward(&x), &y), dot(&x, &transport.transposed(&y)));
        assert!((there - back).abs() <= 1e-5 * there.abs(), "case {case}: {there} {back}");
    }
}

#[test]
fn the_products_are_those_of_the_dense_matrix() {
    let mut random = Random(2);
    for colored in [false, true] {
        let rows = random.rows(200, 64, 90, colored);
        let dense = Dense::new(&rows, 8);
        let transport = Transport::new(rows, 64);
        let x = random.colors(64);
        let seen = transport.forward(&x);
        for channel in 0..3 {
            let x: Vec<f64> = x.iter().map(|x| f64::from(x[channel])).collect();
            for (expected, seen) in dense.forward(channel, &x).iter().zip(&seen) {
                assert!(
                    (expected - f64::from(seen[channel])).abs() <= 1e-5 * expected,
                    "{expected} {seen:?}"
                );
            }
        }
    }
}

#[test]
fn weights_of_one_texel_add_up() {
    let rows = vec![vec![(2, [1.0; 3]), (0, [0.5; 3]), (2, [0.5; 3]), (2, [2.5; 3])], vec![(2, [1.0; 3])]];
    let transport = Transport::new(rows, 4);
    let Weights::Alike(pair) = &transport.weights else { panic!("grey weights") };
    let count = |matrix: &Sparse<f32>| matrix.blocks.iter().map(|block| block.entries.len()).sum::<usize>();
    assert_eq!([count(&pair.by_pixel), count(&pair.by_texel)], [3, 3]);
    assert_eq!(transport.forward(&[[1.0; 3], [0.0; 3], [2.0; 3], [0.0; 3]]), [[8.5; 3], [2.0; 3]]);
    assert_eq!(transport.transposed(&[[1.0; 3], [4.0; 3]]), [[0.5; 3], [0.0; 3], [8.0; 3], [0.0; 3]]);
}

#[test]
fn weights_of_one_colour_are_stored_once() {
    let mut random = Random(3);
    let grey = random.rows(50, 16, 20, false);
    let tint = |tint: Rgb| {
        let tinted =
            |&(texel, weight): &(u32, Rgb)| (texel, from_fn(|channel| weight[channel] * tint[channel]));
        grey.iter().map(|row| row.iter().map(tinted).collect()).collect::<Rows>()
    };
    let is_alike = |rows| matches!(Transport::new(rows, 16).weights, Weights::Alike(_));
    assert!(is_alike(grey.clone()));
    assert!(is_alike(tint([0.3, 0.7, 1e-9])));
    assert!(!is_alike(tint([0.3, 0.7, 0.0])), "a channel of its own");
    assert!(!is_alike(random.rows(50, 16, 20, true)));
    // Both ways give the same.
    let x = random.colors(16);
    let mut rows = tint([0.3, 0.7, 0.9]);
    let alike = Transport::new(rows.clone(), 16).forward(&x);
    rows.push(vec![(0, [1e-3, 2e-3, 3e-3])]);
    let colored = Transport::new(rows, 16);
    assert!(matches!(colored.weights, Weights::Colored(_)));
    for (a, b) in alike.iter().zip(colored.forward(&x)) {
        assert!((0..3).all(|channel| (a[channel] - b[channel]).abs() <= 1e-5 * a[channel]), "{a:?} {b:?}");
    }
}

#[test]
fn the_solution_is_that_of_the_normal_equations() {
    let mut random = Random(4);
    for case in 0..12 {
        let (size, settings) = match case % 3 {
            0 => (3, Fit { lambda: 1e-2, mu: 0.0, tolerance: 1e-12, ..Fit::default() }),
            1 => (5, Fit { lambda: 1e-4, mu: 1e-2, tolerance: 1e-12, ..Fit::default() }),
            _ => (4, Fit { lambda: 0.0, mu: 1e-1, tolerance: 1e-12, ..Fit::default() }),
        };
        let rows = random.rows(60, size * size, 12, case % 2 == 0);
        let dense = Dense::new(&rows, size);
        let transport = Transport::new(rows, size * size);
        // Not far from what a map of light can do, so that none of it is negative.
        let light: Vec<Rgb> = random.colors(size * size).iter().map(|color| color.map(|x| 0.6 + x)).collect();
        let target: Vec<Rgb> = transport.forward(&light);
        let target: Vec<Rgb> =
            target.iter().map(|b| b.map(|b| b * (0.97 + 0.06 * random.number()))).collect();
        let solution = fit(&transport, &target, size, &settings);
        for channel in 0..3 {
            let (matrix, sides) = dense.equations(channel, &target, &settings);
            for (expected, texel) in solve(matrix, sides).iter().zip(&solution.texels) {
                assert!(*expected > 0.0, "the test needs a solution without negative light");
                assert!(
                    (expected - f64::from(texel[channel])).abs() < 1e-3,
                    "case {case}: {expected} {texel:?}"
                );
            }
        }
    }
}

#[test]
fn texels_that_no_pixel_sees_stay_white() {
    let rows = vec![vec![(5, [1.0; 3]), (6, [1.0; 3])], vec![(6, [0.5; 3])]];
    let transport = Transport::new(rows, 16);
    let solution = fit(&transport, &[[0.4, 1.0, 3.0], [0.1, 0.2, 1.0]], 4, &WEAK);
    for (at, texel) in solution.texels.iter().enumerate() {
        let expected = match at {
            5 => [0.2, 0.6, 1.0],
            6 => [0.2, 0.4, 2.0],
            _ => [1.0; 3],
        };
        let near = |channel: usize| (texel[channel] - expected[channel]).abs() < 1e-5;
        assert!((0..3).all(near) && (at == 5 || at == 6 || *texel == [1.0; 3]), "{at}: {texel:?}");
    }
}

#[test]
fn the_pull_to_neighbours_fades_to_white() {
    let size = 31;
    let transport = Transport::new(vec![vec![(15 * 31 + 15, [1.0; 3])]], size * size);
    let solution =
        fit(&transport, &[[0.0, 0.5, 1.0]], size, &Fit { lambda: 1e-3, mu: 1e-2, ..Fit::default() });
    let along = &solution.texels[15 * 31 + 15..16 * 31];
    assert!(along[0][0] < 0.1 && along[15][0] > 0.9, "{along:?}");
    assert!(along.windows(2).all(|pair| pair[1][0] > pair[0][0] && pair[1][1] > pair[0][1]), "{along:?}");
    assert!(along.iter().all(|texel| texel[2] == 1.0), "the white stroke asks for nothing");
}

#[test]
fn what_can_be_met_is_met() {
    let mut random = Random(5);
    for colored in [false, true] {
        let transport = Transport::new(random.rows(80, 400, 30, colored), 400);
        let target = transport.forward(&random.colors(400));
        let solution = fit(&transport, &target, 20, &WEAK);
        let unbounded = solution.history.last().unwrap().residual;
        assert!(
            solution.converged && unbounded < 1e-4 && solution.residual < 5e-3,
            "{unbounded} {solution:?}"
        );
        // With light that is far from 0 nothing is cut off.
        let light: Vec<Rgb> = random.colors(400).iter().map(|color| color.map(|x| 0.8 + 0.4 * x)).collect();
        let solution = fit(&transport, &transport.forward(&light), 20, &WEAK);
        assert!(solution.residual < 1e-4, "{}", solution.residual);
        assert_eq!(solution.residual, solution.history.last().unwrap().residual);
    }
}

#[test]
fn contradictions_give_the_mean() {
    let row = vec![(0, [2.0, 1.0, 0.5])];
    let transport = Transport::new(vec![row.clone(), row.clone(), row], 1);
    let solution = fit(&transport, &[[0.2, 0.4, 0.0], [0.6, 0.4, 3.0], [1.0, 1.0, 0.0]], 1, &WEAK);
    for (texel, expected) in solution.texels[0].iter().zip([0.3, 0.6, 2.0]) {
        assert!((texel - expected).abs() < 1e-5, "{:?}", solution.texels);
    }
}

#[test]
fn the_objective_falls() {
    let mut random = Random(6);
    for case in 0..6 {
        let rows = random.rows(120, 64, 20, case % 2 == 0);
        let dense = Dense::new(&rows, 8);
        let transport = Transport::new(rows, 64);
        let bright: Vec<Rgb> = transport.forward(&[[1.0; 3]; 64]);
        // A little off white nothing is cut off, and any colours cut off much.
        let target = |spread: f32, random: &mut Random| -> Vec<Rgb> {
            bright.iter().map(|b| b.map(|b| b * (1.0 + spread * (2.0 * random.number() - 1.0)))).collect()
        };
        let settings = Fit { lambda: 1e-3, mu: 1e-3, ..Fit::default() };
        let falls = |target: &[Rgb], settings: [Fit; 12]| {
            let objective = |settings: &Fit| {
                dense.objective(&fit(&transport, target, 8, settings).texels, target, settings)
            };
            let objectives = settings.each_ref().map(objective);
            assert!(objectives.windows(2).all(|pair| pair[1] <= pair[0] * (1.0 + 1e-6)), "{objectives:?}");
            assert!(objectives[11] < objectives[0], "{objectives:?}");
        };
        falls(&target(0.05, &mut random), from_fn(|iterations| Fit { iterations, ..settings }));
        falls(&target(1.0, &mut random), from_fn(|projections| Fit { projections, ..settings }));
    }
}

#[test]
fn light_is_not_negative_and_the_best_that_is_not() {
    let mut random = Random(7);
    for case in 0..6 {
        let rows = random.rows(60, 25, 8, case % 2 == 0);
        let dense = Dense::new(&rows, 5);
        let transport = Transport::new(rows, 25);
        let target = random.colors(60);
        let settings = Fit { lambda: 1e-2, mu: 1e-2, projections: 2000, ..Fit::default() };
        let solution = fit(&transport, &target, 5, &settings);
        assert!(solution.texels.iter().flatten().all(|x| *x >= 0.0));
        assert!(solution.texels.iter().flatten().any(|x| *x == 0.0), "the test needs light that is cut off");
        // At the best there is no slope, but downwards where light is 0.
        for channel in 0..3 {
            let (matrix, sides) = dense.equations(channel, &target, &settings);
            let x: Vec<f64> = solution.texels.iter().map(|x| f64::from(x[channel])).collect();
            for texel in 0..25 {
                let slope = sides[texel] - matrix[texel].iter().zip(&x).map(|(h, x)| h * x).sum::<f64>();
                assert!(
                    slope < 1e-4 && (slope > -1e-4 || x[texel] == 0.0),
                    "{texel}: {slope} at {}",
                    x[texel]
                );
            }
        }
    }
}

#[test]
fn the_default_keeps_light_that_is_cut_off_near_the_best() {
    let mut random = Random(8);
    let rows = random.rows(300, 100, 12, false);
    let dense = Dense::new(&rows, 10);
    let transport = Transport::new(rows, 100);
    let target = random.colors(300);
    let objective = |projections: usize| {
        let settings = Fit { projections, ..Fit::default() };
        dense.objective(&fit(&transport, &target, 10, &settings).texels, &target, &settings)
    };
    let [cut, few, best] = [0, 8, 1000].map(objective);
    assert!(few < 1.05 * best && few - best < 0.1 * (cut - best), "{cut} {few} {best}");
}

#[test]
fn the_history_tells_how_it_went() {
    let mut random = Random(9);
    let transport = Transport::new(random.rows(100, 100, 20, true), 100);
    let light: Vec<Rgb> = random.colors(100).iter().map(|color| color.map(|x| 0.8 + 0.4 * x)).collect();
    let solution = fit(&transport, &transport.forward(&light), 10, &Fit::default());
    assert!(solution.converged);
    assert_eq!(solution.history.len(), solution.iterations + 1);
    assert_eq!(solution.history[0].gradient, 1.0);
    assert!(solution.history.last().unwrap().gradient <= 1e-8);
    assert!(
        solution
            .history
            .iter()
            .skip(1)
            .all(|step| step.gradient > 1e-8 || step == &solution.history[solution.iterations])
    );
    assert!(solution.history.last().unwrap().residual < solution.history[0].residual);
    let two = fit(&transport, &transport.forward(&light), 10, &Fit { iterations: 2, ..Fit::default() });
    assert_eq!((two.iterations, two.converged), (2, false));
    assert_eq!(two.history[..], solution.history[..3]);
}

#[test]
fn a_white_stroke_changes_nothing() {
    let mut random = Random(10);
    let rows = random.rows(100, 1024, 2000, true);
    // As the caller adds up, which is not how the fit does.
    let dense = Dense::new(&rows, 32);
    let white = [0, 1, 2].map(|channel| dense.forward(channel, &[1.0; 1024]));
    let target: Vec<Rgb> = (0..100).map(|pixel| from_fn(|channel| white[channel][pixel] as f32)).collect();
    let solution = fit(&Transport::new(rows, 1024), &target, 32, &Fit::default());
    assert!(solution.texels.iter().all(|texel| *texel == [1.0; 3]));
    assert_eq!((solution.iterations, solution.converged, solution.residual), (0, true, 0.0));
}

#[test]
fn channels_do_not_see_each_other() {
    let mut random = Random(11);
    let transport = Transport::new(random.rows(100, 64, 20, false), 64);
    let target = random.colors(100);
    let one: Vec<Rgb> = target.iter().map(|color| [color[0], 0.5, color[0]]).collect();
    let [all, one] = [target, one].map(|target| fit(&transport, &target, 8, &WEAK).texels);
    assert!(all.iter().zip(&one).all(|(a, b)| a[0] == b[0] && b[0] == b[2]));
    assert!(all.iter().zip(&one).any(|(a, b)| a[1] != b[1] && a[2] != b[2]));
}

/// A solution that can be shown whatever it was asked for.
fn sane(rows: Rows, target: &[Rgb], size: usize, settings: &Fit) -> Solution {
    let transport = Transport::new(rows, size * size);
    let solution = fit(&transport, target, size, settings);
    assert_eq!(solution.texels.len(), size * size);
    assert!(solution.texels.iter().flatten().all(|x| x.is_finite() && *x >= 0.0), "{solution:?}");
    assert!(solution.residual.is_finite(), "{solution:?}");
    let numbers = solution.history.iter().flat_map(|step| [step.gradient, step.residual]);
    assert!({ numbers }.all(f64::is_finite), "{solution:?}");
    solution
}

#[test]
fn nothing_to_fit_leaves_white() {
    let white =
        |solution: &Solution| solution.texels.iter().all(|texel| *texel == [1.0; 3]) && solution.converged;
    let settings = Fit::default();
    assert!(white(&sane(vec![], &[], 3, &settings)));
    assert!(white(&sane(vec![], &[], 0, &settings)));
    let empty = sane(vec![vec![], vec![]], &[[0.3; 3]; 2], 3, &settings);
    assert!(white(&empty) && empty.residual == 1.0);
    assert!(white(&sane(vec![vec![(0, [0.0; 3]), (1, [-1.0; 3])]], &[[0.3; 3]], 3, &settings)));
    assert!(white(&sane(vec![vec![(0, [f32::NAN; 3]), (1, [f32::INFINITY; 3])]], &[[0.3; 3]], 3, &settings)));
    assert!(white(&sane(vec![vec![(9, [1.0; 3]), (u32::MAX, [1.0; 3])]], &[[0.3; 3]], 3, &settings)));
    // A channel without weights is white beside others that are fitted.
    let two = sane(vec![vec![(0, [1.0, 0.0, 1.0])]], &[[0.5; 3]], 1, &WEAK);
    assert!(two.texels[0][1] == 1.0 && two.texels[0][0] < 0.51, "{two:?}");
}

#[test]
fn one_texel_is_a_map() {
    let solution = sane(vec![vec![(0, [2.0; 3])]], &[[1.0, 0.0, 8.0]], 1, &Fit::default());
    for (texel, expected) in solution.texels[0].iter().zip([0.5, 0.0, 4.0]) {
        assert!((texel - expected).abs() < 1e-3, "{solution:?}");
    }
}

#[test]
fn targets_that_are_no_light_are_dark() {
    let rows = || vec![vec![(0, [1.0; 3])], vec![(1, [1.0; 3])], vec![(2, [1.0; 3]), (3, [1.0; 3])]];
    let wrong = [[-1.0, f32::NAN, 0.0], [f32::INFINITY, 0.5, -0.0], [f32::NEG_INFINITY, 1.0, f32::NAN]];
    let right = [[0.0; 3], [0.0, 0.5, 0.0], [0.0, 1.0, 0.0]];
    let [wrong, right] = [wrong, right].map(|target| sane(rows(), &target, 2, &WEAK));
    assert_eq!(bits(&wrong.texels), bits(&right.texels));
    let dark = sane(rows(), &[[0.0; 3]; 3], 2, &WEAK);
    assert!(dark.history[0].residual == 1.0 && dark.residual < 1e-4, "{dark:?}");
    assert!(dark.texels.iter().flatten().all(|x| *x < 1e-4), "{dark:?}");
}

#[test]
fn powers_of_ten_do_not_matter() {
    let mut random = Random(12);
    let rows = random.rows(60, 36, 10, true);
    let target = random.colors(60);
    let expected = sane(rows.clone(), &target, 6, &Fit::default()).texels;
    for factor in [1e30, 1e-30, 1e10] {
        let scaled = |color: &Rgb| color.map(|x| x * factor);
        let rows = rows
            .iter()
            .map(|row| row.iter().map(|(texel, weight)| (*texel, scaled(weight))).collect())
            .collect();
        let target: Vec<Rgb> = target.iter().map(scaled).collect();
        let solution = sane(rows, &target, 6, &Fit::default());
        for (a, b) in expected.iter().flatten().zip(solution.texels.iter().flatten()) {
            assert!((a - b).abs() < 1e-3, "{factor}: {a} {b}");
        }
    }
}

#[test]
fn wild_numbers_give_no_wild_maps() {
    let mut random = Random(13);
    let powers =
        [1e-45, 1e-38, 1e-30, 1e-20, 1e-8, 1.0, 1.0, 1.0, 1e8, 1e20, 1e30, 3e38, 0.0, -1.0, f32::NAN];
    let wild = |random: &mut Random| from_fn(|_| random.number() * powers[random.below(powers.len())]);
    for case in 0..100 {
        let (pixels, size) = (1 + random.below(40), 1 + random.below(6));
        let mut rows = random.rows(pixels, size * size, 12, true);
        let mut target = random.colors(rows.len());
        if case % 3 != 0 {
            rows.iter_mut().flatten().for_each(|(_, weight)| *weight = wild(&mut random));
        }
        if case % 3 != 1 {
            target.iter_mut().for_each(|color| *color = wild(&mut random));
        }
        for (lambda, mu) in [(1e-4, 1e-2), (1e-4, 0.0), (0.0, 0.0), (0.0, 1.0), (-1.0, f64::NAN)] {
            sane(rows.clone(), &target, size, &Fit { lambda, mu, tolerance: 0.0, ..Fit::default() });
        }
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let mut random = Random(14);
    for colored in [false, true] {
        // Enough for several blocks.
        let rows = random.rows(600, 1024, 100, colored);
        let target = random.colors(600);
        let [one, two, five] = [1, 2, 5].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                let transport = Transport::new(rows.clone(), 1024);
                let solution = fit(&transport, &target, 32, &Fit::default());
                (bits(&solution.texels), solution.history, solution.residual)
            })
        });
        assert!(one == two && one == five);
        assert!(one.0.iter().flatten().any(|x| *x == 0), "the test needs light that is cut off");
    }
}
