//! What the steps of tapes cost: points, operations and time.
//!
//! ```text
//! Tapes + a label for each instruction ──► Stretches     neighbouring steps with one label, shared by all threads
//!                                             └──► Meter  one thread's account, filled by `evaluate_metered`
//! ```
//!
//! Reading the clock takes as long as a cheap step on a whole batch. So a call is timed as a whole, and only every
//! [`PERIOD`]th batch stretch by stretch: those times, less what timing nothing takes, say how the time of all calls of
//! the function is shared among its stretches. Points and operations are counted, not sampled.

use super::work::Known;
use super::{Evaluator, Registers, Tapes, batches};
use std::collections::HashSet;
use std::hint::black_box;
use std::ops::Range;
use std::time::{Duration, Instant};
use vol_compiler::ir::FunctionId;
use vol_compiler::tape::{Link, Tape, TapeOp, links};

/// One batch of so many is timed stretch by stretch; odd, so that it does not fall into step with calls of 2^n batches.
const PERIOD: u64 = 13;

/// Readings of the clock in a trial that finds out what one takes; the quickest of [`TRIALS`] counts.
const READINGS: u32 = 1000;
const TRIALS: u32 = 20;

/// Neighbouring steps of a tape with one label.
#[derive(Clone, Debug)]
struct Stretch {
    steps: Range<usize>,
    label: u32,
    /// Operations at a point, without those in loops.
    work: u64,
}

/// A tape cut into stretches.
#[derive(Clone, Debug)]
struct Cut {
    stretches: Vec<Stretch>,
    /// Of the steps of the tape; a stretch has nothing from the one before.
    links: Vec<Link>,
}

/// The tapes of a program cut into stretches.
#[derive(Clone, Debug)]
pub(crate) struct Stretches {
    functions: Vec<Cut>,
    /// Nanoseconds from one reading of the clock to the next with nothing between.
    reading: f64,
}

impl Stretches {
    /// Cuts tapes up; `labels` holds one for each instruction of each function.
    pub(crate) fn new(tapes: &Tapes, known: Known<'_>, labels: &[Vec<u32>]) -> Self {
        let functions =
            tapes.tapes.iter().zip(labels).map(|(tape, labels)| cut(tape, known, labels)).collect();
        Self { functions, reading: time_of_reading() }
    }
}

/// Cuts a tape up. What is loaded belongs to the operation that follows.
fn cut(tape: &Tape, known: Known<'_>, labels: &[u32]) -> Cut {
    let mut stretches: Vec<Stretch> = Vec::new();
    for (step, (op, value)) in tape.ops.iter().zip(&tape.values).enumerate() {
        let loads = matches!(op, TapeOp::Constant { .. } | TapeOp::Input { .. } | TapeOp::Uniform { .. });
        let computes = !loads;
        let (label, work) = (labels[value.index()], known.work_of_step(tape, step));
        let start = stretches.last().map_or(0, |last| last.steps.end);
        let is_last = step + 1 == tape.ops.len();
        match stretches.last_mut() {
            Some(last) if last.label == label && computes || !computes && is_last => {
                last.steps.end = step + 1;
                last.work += work;
            }
            _ if computes || is_last => {
                stretches.push(Stretch { steps: start..step + 1, label, work });
            }
            Some(_) | None => {}
        }
    }
    let starts: HashSet<usize> = stretches.iter().map(|stretch| stretch.steps.start).collect();
    Cut { links: links(tape, |step| starts.contains(&step)), stretches }
}

fn time_of_reading() -> f64 {
    let trial = |_| {
        let started = Instant::now();
        (1..READINGS).for_each(|_| {
            black_box(Instant::now());
        });
        nanoseconds(started.elapsed()) / f64::from(READINGS)
    };
    (0..TRIALS).map(trial).fold(f64::INFINITY, f64::min)
}

/// What was spent on a stretch.
#[derive(Clone, Copy, Debug, Default)]
struct Spent {
    /// Operations in loops.
    loop_work: u64,
    /// Nanoseconds in the batches that were timed by stretches.
    sampled: f64,
}

/// What was spent on a function.
#[derive(Clone, Debug, Default)]
struct Account {
    points: u64,
    /// Without what timing took.
    nanoseconds: f64,
    stretches: Vec<Spent>,
}

/// One thread's account.
#[derive(Clone, Debug)]
pub(crate) struct Meter<'a> {
    stretches: &'a Stretches,
    accounts: Vec<Account>,
    batches: u64,
    /// Readings of the clock.
    readings: u64,
}

/// What a function cost.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FunctionCost {
    /// Points at which it was evaluated.
    pub evaluations: u64,
    /// In additions, see `interp/work.rs`.
    pub operations: u64,
    /// Time on all threads, added up.
    pub milliseconds: f64,
    /// The same by label, each once, in no order.
    pub parts: Vec<PartCost>,
}

/// What the instructions with one label cost in one function.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PartCost {
    /// The label.
    pub label: u32,
    /// Points at which any of them was evaluated.
    pub evaluations: u64,
    /// In additions.
    pub operations: u64,
    /// Time on all threads, added up.
    pub milliseconds: f64,
}

impl<'a> Meter<'a> {
    /// Nothing spent yet. Meters with different `phase` look at different batches.
    pub(crate) fn new(stretches: &'a Stretches, phase: u64) -> Self {
        let account = |cut: &Cut| Account {
            stretches: vec![Spent::default(); cut.stretches.len()],
            ..Account::default()
        };
        let accounts = stretches.functions.iter().map(account).collect();
        Self { stretches, accounts, batches: phase, readings: 0 }
    }

    /// Nanoseconds that timing took so far.
    pub(crate) fn own_time(&self) -> f64 {
        self.readings as f64 * self.stretches.reading
    }

    /// Adds the account of another thread.
    pub(crate) fn add(&mut self, other: &Self) {
        for (account, other) in self.accounts.iter_mut().zip(&other.accounts) {
            account.points += other.points;
            account.nanoseconds += other.nanoseconds;
            for (spent, other) in account.stretches.iter_mut().zip(&other.stretches) {
                spent.loop_work += other.loop_work;
                spent.sampled += other.sampled;
            }
        }
        self.readings += other.readings;
    }

    /// What each function cost.
    pub(crate) fn costs(&self) -> Vec<FunctionCost> {
        self.accounts
            .iter()
            .zip(&self.stretches.functions)
            .map(|(account, cut)| cost(account, &cut.stretches))
            .collect()
    }
}

/// Shares what was spent on a function among the labels of its stretches.
fn cost(account: &Account, cut: &[Stretch]) -> FunctionCost {
    let milliseconds = account.nanoseconds.max(0.0) * 1e-6;
    let work = |(spent, stretch): (&Spent, &Stretch)| spent.loop_work + account.points * stretch.work;
    // A function that was never timed by stretches is shared by operations.
    let sampled: f64 = account.stretches.iter().map(|spent| spent.sampled.max(0.0)).sum();
    let all_work: u64 = account.stretches.iter().zip(cut).map(work).sum();
    let share = |spent: &Spent, work: u64| match sampled > 0.0 {
        true => spent.sampled.max(0.0) / sampled,
        false if all_work > 0 => work as f64 / all_work as f64,
        false => 1.0 / cut.len() as f64,
    };
    let mut parts: Vec<PartCost> = Vec::new();
    for (spent, stretch) in account.stretches.iter().zip(cut) {
        let operations = work((spent, stretch));
        let index = parts.iter().position(|part| part.label == stretch.label).unwrap_or_else(|| {
            parts.push(PartCost { label: stretch.label, ..PartCost::default() });
            parts.len() - 1
        });
        let part = &mut parts[index];
        part.evaluations = account.points;
        part.operations += operations;
        part.milliseconds += milliseconds * share(spent, operations);
    }
    FunctionCost { evaluations: account.points, operations: all_work, milliseconds, parts }
}

fn nanoseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e9
}

impl Evaluator<'_> {
    /// [`Evaluator::evaluate`], and what it costs.
    ///
    /// # Panics
    ///
    /// If slices are missing or differ in length.
    pub(crate) fn evaluate_metered(
        &mut self,
        function: FunctionId,
        inputs: &[&[f32]],
        outputs: &mut [&mut [f32]],
        meter: &mut Meter<'_>,
    ) {
        let tape = self.tapes.tape(function);
        let cut = &meter.stretches.functions[function.index()];
        let account = &mut meter.accounts[function.index()];
        let reading = meter.stretches.reading;
        let started = Instant::now();
        // From the first reading to the last there is one between two neighbours.
        let mut readings = 1;
        for points in batches(tape, inputs, outputs) {
            account.points += points.len() as u64;
            meter.batches += 1;
            let mut last = meter.batches.is_multiple_of(PERIOD).then(Instant::now);
            readings += u64::from(last.is_some());
            self.registers.lay_out(tape.all_registers(), points.len());
            for (stretch, spent) in cut.stretches.iter().zip(&mut account.stretches) {
                self.loop_work = Some(0);
                let steps = (&tape.ops[stretch.steps.clone()], &cut.links[stretch.steps.clone()]);
                self.run(tape, steps, Registers::of(tape), inputs, &points);
                spent.loop_work += self.loop_work.take().unwrap_or(0);
                if let Some(last) = &mut last {
                    let now = Instant::now();
                    spent.sampled += nanoseconds(now - *last) - reading;
                    (*last, readings) = (now, readings + 1);
                }
            }
            self.hand_out(tape, outputs, &points);
        }
        account.nanoseconds += nanoseconds(started.elapsed()) - readings as f64 * reading;
        meter.readings += readings + 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use vol_compiler::ir::{Module, text};

    /// A cheap line, a dear one and one with a loop, labelled 1 to 3; what has no line is 0.
    const BODY: &str = "fn f(3) {
%0 = input 0
%1 = input 1
%2 = input 2
%3 = add %0 %1
%4 = mul %3 %3
%5 = constant 8.0
%6 = constant 0.5
%7 = fbm[7] %0 %1 %2 %5 %6 %6
%8 = add %7 %4
%9 = loop 12 %0 {
%0 = input 0
%1 = constant 100.0
%2 = less %0 %1
%3 = add %0 %0
return %3 %2
}
%10 = extract %9 0
%11 = add %10 %8
%12 = neg %11
return %12
}";
    const LABELS: [u32; 13] = [0, 0, 0, 1, 1, 0, 0, 2, 1, 3, 3, 0, 1];

    /// Costs of some calls of the function, and its values.
    fn metered(x: &[f32], call: usize) -> (Vec<FunctionCost>, Vec<f32>) {
        let function = text::parse_function(BODY).expect("well-formed text");
        let tapes = Tapes::of_module(&Module { functions: vec![function], ..Module::default() });
        let mut evaluator = Evaluator::of_parts(&tapes, &[], &[]);
        let stretches = Stretches::new(&tapes, evaluator.known(), &[LABELS.to_vec()]);
        let mut meter = Meter::new(&stretches, 0);
        let mut values = vec![0.0; x.len()];
        for (x, values) in x.chunks(call).zip(values.chunks_mut(call)) {
            evaluator.evaluate_metered(FunctionId(0), &[x, x, x], &mut [values], &mut meter);
        }
        let mut same = vec![0.0; x.len()];
        let works = evaluator.known().works(&tapes);
        let counted = evaluator.evaluate_counted(FunctionId(0), &[x, x, x], &mut [&mut same], &works);
        assert_eq!(values, same);
        let costs = meter.costs();
        assert_eq!(costs[0].operations, counted);
        (costs, values)
    }

    #[test]
    fn counts_are_those_of_the_points() {
        // Each point leaves the loop at its own step.
        let x: Vec<f32> = (1..=1000).map(|i| i as f32 * 0.37).collect();
        let (costs, _) = metered(&x, 1000);
        let steps = |mut x: f32| {
            let mut steps = 0;
            while steps < 12 {
                steps += 1;
                if x >= 100.0 {
                    break;
                }
                x += x;
            }
            steps
        };
        let looped: u64 = x.iter().map(|&x| 2 * steps(x)).sum();
        let part = |label| *costs[0].parts.iter().find(|part| part.label == label).expect("is there");
        let sum = 8 * 12;
        assert_eq!([part(1), part(2), part(3), part(0)].map(|part| part.evaluations), [1000; 4]);
        assert_eq!(
            [part(1), part(2), part(3), part(0)].map(|part| part.operations),
            [4000, 1000 * sum, looped, 1000]
        );
        // Neither the size of a batch nor of a call changes a count.
        let counts = |costs: &[FunctionCost]| {
            costs[0]
                .parts
                .iter()
                .map(|part| (part.label, part.evaluations, part.operations))
                .collect::<Vec<_>>()
        };
        for call in [1, 7, 64, 65] {
            assert_eq!(counts(&metered(&x, call).0), counts(&costs), "{call} points a call");
        }
    }

    #[test]
    fn times_add_up_and_the_dear_line_is_dear() {
        let x: Vec<f32> = (0..100_000).map(|i| i as f32 * 0.001).collect();
        let costs = metered(&x, 4096).0;
        let parts = &costs[0].parts;
        let sum: f64 = parts.iter().map(|part| part.milliseconds).sum();
        assert!((sum - costs[0].milliseconds).abs() < 1e-9 * sum, "{sum} of {costs:?}");
        let dearest = parts.iter().max_by(|a, b| a.milliseconds.total_cmp(&b.milliseconds));
        assert_eq!(dearest.map(|part| part.label), Some(2), "{costs:?}");
        assert!(costs[0].milliseconds > 0.0);
    }
}
