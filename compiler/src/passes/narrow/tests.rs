use super::*;
use crate::error_bound::nasty;
use crate::ir::verify::random::{self, Random, Shape};
use crate::ir::walk::{self, Domain};
use crate::ir::{text, verify};
use crate::ops::{Context, Results};
use crate::reference;

/// Three inputs and two uniforms of which nothing is known but that they are moderate numbers.
fn narrowed(before: &str) -> Narrowed {
    let function = text::parse_function(&format!("fn f(3) {{\n{before}\n}}")).expect("well-formed text");
    narrow(&function, &[any_input(); 3], &[any_input(); 2])
}

#[track_caller]
fn assert_narrows(before: &str, after: &str) {
    let expected = text::parse_function(&format!("fn f(3) {{\n{after}\n}}")).expect("well-formed text");
    let found = narrowed(before).function;
    assert_eq!(text::print_function(&found), text::print_function(&expected));
    assert_eq!(verify::function(&found, 2, 1), Ok(()));
}

#[track_caller]
fn assert_stays(body: &str) {
    assert_narrows(body, body);
}

#[test]
fn extremes_take_the_side_that_wins() {
    let square = "%0 = input 0\n%1 = mul %0 %0\nreturn %1";
    for extreme in ["max %1 %2", "max %2 %1"] {
        let before = format!("%0 = input 0\n%1 = mul %0 %0\n%2 = constant 0.0\n%3 = {extreme}\nreturn %3");
        assert_narrows(&before, square);
    }
    // A sine is never above 2.
    let sine = "%0 = input 0\n%1 = sin %0\nreturn %1";
    assert_narrows("%0 = input 0\n%1 = sin %0\n%2 = constant 2.0\n%3 = min %2 %1\nreturn %3", sine);
    // But it may be above 1, by its rounding.
    assert_stays("%0 = input 0\n%1 = sin %0\n%2 = constant 1.0\n%3 = min %1 %2\nreturn %3");
    assert_stays("%0 = input 0\n%1 = constant 0.0\n%2 = max %0 %1\nreturn %2");
}

#[test]
fn noises_stay_within_their_bounds() {
    let noise = "%0 = input 0\n%1 = perlin[3] %0 %0 %0\n%2 = constant 1.0364\n";
    assert_narrows(
        &format!("{noise}%3 = min %1 %2\nreturn %3"),
        "%0 = input 0\n%1 = perlin[3] %0 %0 %0\nreturn %1",
    );
    let noise = "%0 = input 0\n%1 = perlin[3] %0 %0 %0\n%2 = constant 1.03635\n";
    assert_stays(&format!("{noise}%3 = min %1 %2\nreturn %3"));
}

#[test]
fn what_is_decided_decides_what_follows() {
    let before = "%0 = input 0\n%1 = input 1\n%2 = abs %0\n%3 = constant -0.5\n%4 = less %2 %3\n\
        %5 = less %0 %1\n%6 = or %4 %5\n%7 = select %6 %0 %1\n%8 = select %4 %1 %7\nreturn %8";
    let after = "%0 = input 0\n%1 = input 1\n%2 = less %0 %1\n%3 = select %2 %0 %1\nreturn %3";
    assert_narrows(before, after);
}

#[test]
fn a_blend_that_is_out_of_reach_goes() {
    // min(a, b) - max(1 - |a - b|, 0)^2 / 4 with a in [0, 1] and b in [3, 4].
    let before = "%0 = input 0\n%1 = input 1\n%2 = min %0 %1\n%3 = sub %0 %1\n%4 = abs %3\n%5 = constant 1.0\n\
        %6 = sub %5 %4\n%7 = constant 0.0\n%8 = max %6 %7\n%9 = mul %8 %8\n%10 = constant 0.25\n\
        %11 = mul %9 %10\n%12 = sub %2 %11\nreturn %12";
    let function = text::parse_function(&format!("fn f(2) {{\n{before}\n}}")).expect("well-formed text");
    let [near, far] = [(0.0, 1.0), (3.0, 4.0)].map(|(lo, hi)| Computed::within(Interval::new(lo, hi)));
    let found = narrow(&function, &[near, far], &[]);
    assert_eq!(found.function.insts, [Inst::Input(0)]);
    assert_eq!(found.from, [0]);
}

#[test]
fn zeros_keep_their_sign() {
    // 0 times a number is -0 where that is negative.
    assert_stays("%0 = input 0\n%1 = constant 0.0\n%2 = mul %0 %1\nreturn %2");
    // max takes the second of two zeros, and the first may be -0.
    assert_stays("%0 = input 0\n%1 = constant 0.0\n%2 = min %0 %1\n%3 = neg %2\n%4 = max %3 %1\nreturn %4");
    // -0 + 0 is 0.
    assert_stays("%0 = input 0\n%1 = constant 0.0\n%2 = add %0 %1\nreturn %2");
    assert_stays("%0 = input 0\n%1 = constant -0.0\n%2 = max %1 %0\n%3 = abs %2\nreturn %3");
}

#[test]
fn what_may_be_no_number_decides_nothing() {
    // The square of an input may overflow twice, and infinities cancel.
    let lost = "%0 = input 0\n%1 = mul %0 %0\n%2 = mul %1 %1\n%3 = mul %2 %2\n%4 = sub %3 %2\n%5 = sin %4\n";
    assert_stays(&format!("{lost}%6 = constant 2.0\n%7 = min %5 %6\nreturn %7"));
    assert_stays(&format!(
        "{lost}%6 = constant -2.0\n%7 = less %6 %5\n%8 = constant 1.0\n%9 = select %7 %5 %8\nreturn %9"
    ));
}

/// An interval that a function is narrowed to, and a number in it, often one of its ends.
fn drawn(random: &mut Random) -> (Interval, impl Fn(&mut Random) -> f32 + use<>) {
    let (a, b) = (random.between(-4.0, 4.0) as f32, random.between(-4.0, 4.0) as f32);
    let (lo, hi) = match random.below(4) {
        0 => (a, a),
        1 => (0.0, b.abs()),
        _ => (a.min(b), a.max(b)),
    };
    let point = move |random: &mut Random| match random.below(3) {
        0 => lo,
        1 => hi,
        _ => random.between(f64::from(lo), f64::from(hi)) as f32,
    };
    (Interval::new(f64::from(lo), f64::from(hi)), point)
}

fn shape(seed: u64) -> Shape {
    Shape { curves: 0, operations: 40, tame: seed.is_multiple_of(2), ..Shape::default() }
}

/// What a value may be, beside one that a device computes; walks over both at once.
struct Checked<'a> {
    uniforms: &'a [(Computed, f32)],
    coin: &'a mut Random,
}

impl Checked<'_> {
    fn check(&self, what: &str, bounds: Computed, found: f32) -> (Computed, f32) {
        let sure = if found.is_nan() { bounds.nan } else { bounds.interval.contains(f64::from(found)) };
        let signed = found == 0.0 && found.is_sign_negative();
        assert!(sure && (bounds.minus_zero || !signed), "{what}: {found:?} is not within {bounds:?}");
        (bounds, found)
    }
}

impl Domain for Checked<'_> {
    type Value = (Computed, f32);

    fn constant(&mut self, number: f64) -> Self::Value {
        self.check("constant", Computed::constant(number), crate::tape::rounded(number))
    }

    fn truth(&mut self, truth: bool) -> Self::Value {
        self.check("truth", Computed::truth(truth), f32::from(u8::from(truth)))
    }

    fn uniform(&mut self, index: usize) -> Self::Value {
        self.uniforms[index]
    }

    fn apply(&mut self, op: Op, data: u32, args: &[ValueId], x: &[Self::Value]) -> Results<Self::Value> {
        let (bounds, numbers): (Vec<Computed>, Vec<f32>) = x.iter().copied().unzip();
        let squared = args.len() == 2 && args[0] == args[1];
        let bounds = computed::apply(op, data, squared, &bounds);
        let mut found = nasty::apply(op, &numbers, Context { data, curves: &[] }, self.coin);
        // The error rule alone would let a wave pass its crest.
        if matches!(op, Op::Sin | Op::Cos) {
            found[0] = found[0].clamp(-1.0 - 2.0 * f32::EPSILON, 1.0 + 2.0 * f32::EPSILON);
        }
        std::array::from_fn(|i| self.check(&format!("{op:?} {x:?}"), bounds[i], found[i]))
    }

    fn repeat(&mut self, _: u32, body: &Function, x: &[Self::Value]) -> Vec<Self::Value> {
        x[..body.state()].iter().map(|&(_, found)| (Computed::UNKNOWN, found)).collect()
    }
}

#[test]
fn a_nasty_device_stays_within_the_bounds() {
    for seed in 0..3000 {
        let mut random = Random::new(seed);
        let function = random::function(seed, &shape(seed));
        let leaf = |random: &mut Random| {
            let (interval, point) = drawn(random);
            (Computed::within(interval), point(random))
        };
        let inputs: Vec<_> = (0..3).map(|_| leaf(&mut random)).collect();
        let uniforms: Vec<_> = (0..4).map(|_| leaf(&mut random)).collect();
        walk::walk(&mut Checked { uniforms: &uniforms, coin: &mut random }, &function, &inputs);
    }
}

#[test]
fn narrowed_functions_mean_the_same() {
    let mut fewer = 0;
    for seed in 0..1500 {
        let mut random = Random::new(seed);
        let function = random::function(seed, &shape(seed));
        let (intervals, points): (Vec<_>, Vec<_>) = (0..7).map(|_| drawn(&mut random)).unzip();
        let narrowed = within(&function, &intervals[..3], &intervals[3..]);
        assert_eq!(verify::function(&narrowed, 4, 1), Ok(()));
        fewer += usize::from(narrowed.insts.len() < function.insts.len());
        for _ in 0..20 {
            let numbers: Vec<f64> = points.iter().map(|point| f64::from(point(&mut random))).collect();
            let values = |function: &Function| -> Vec<u64> {
                let values = reference::evaluate(function, &numbers[..3], &numbers[3..], &[]);
                // NaNs are all alike.
                values.iter().map(|x| if x.is_nan() { u64::MAX } else { x.to_bits() }).collect()
            };
            let (before, after) = (values(&function), values(&narrowed));
            assert_eq!(
                before,
                after,
                "{}{}",
                text::print_function(&function),
                text::print_function(&narrowed)
            );
        }
    }
    assert!(fewer > 1000, "{fewer} became shorter");
}
