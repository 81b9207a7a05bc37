use super::*;
use crate::ir::text;
use crate::ir::verify::random;
use crate::ir::walk::{self, Domain};
use crate::ops::{self, Context};

const UNIFORMS: [f64; 4] = [0.5, -2.0, 3.25, 100.0];

/// The table's meaning, with constants rounded as on a tape.
struct Direct;

impl Domain for Direct {
    type Value = f64;

    fn constant(&mut self, number: f64) -> f64 {
        f64::from(rounded(number))
    }

    fn truth(&mut self, truth: bool) -> f64 {
        f64::from(u8::from(truth))
    }

    fn uniform(&mut self, index: usize) -> f64 {
        UNIFORMS[index]
    }

    fn apply(&mut self, op: Op, data: u32, _: &[ValueId], operands: &[f64]) -> ops::Results<f64> {
        (operation(op).meaning)(operands, Context { data, curves: &[] })
    }

    fn repeat(&mut self, most: u32, body: &Function, operands: &[f64]) -> Vec<f64> {
        walk::repeat(self, most, body, operands, |goes_on| goes_on != 0.0)
    }
}

/// The same from the tape, as its links tell. Registers start empty, or with the inputs of a loop's body; those of
/// results that nothing reads are emptied, so that a clobbered register shows.
fn by_tape(tape: &Tape, inputs: &[f64], inside: bool) -> Vec<f64> {
    let mut registers: Vec<Option<f64>> = vec![None; tape.registers as usize];
    if inside {
        registers[..inputs.len()].copy_from_slice(&inputs.iter().map(|&x| Some(x)).collect::<Vec<_>>());
    }
    let mut last = f64::NAN;
    for (step, link) in tape.ops.iter().zip(&tape.links) {
        let read = |r: &Register| registers[r.index()].expect("reads a register that was written");
        let operands =
            step.operands(&tape.loops).iter().enumerate().map(|(i, operand)| match (link.carried, i) {
                (Carried::First | Carried::Both, 0) | (Carried::Second | Carried::Both, 1) => last,
                _ => read(operand),
            });
        let operands: Vec<f64> = operands.collect();
        match *step {
            TapeOp::Constant { to, value } => registers[to.index()] = Some(f64::from(value)),
            TapeOp::Input { to, index } => registers[to.index()] = Some(inputs[index as usize]),
            TapeOp::Uniform { to, index } => registers[to.index()] = Some(UNIFORMS[index as usize]),
            TapeOp::Apply { op, data, to, wanted, .. } => {
                let row = operation(op);
                let results = (row.meaning)(&operands, Context { data, curves: &[] });
                for (i, _) in row.results.iter().enumerate() {
                    registers[to.index() + i] = (wanted >> i & 1 == 1).then_some(results[i]);
                }
            }
            TapeOp::ApplyScalar { op, scalar_first, scalar, to, .. } => {
                let scalar = match scalar {
                    Scalar::Number(number) => f64::from(number),
                    Scalar::Uniform(index) => UNIFORMS[index as usize],
                };
                let args = if scalar_first { [scalar, operands[0]] } else { [operands[0], scalar] };
                let result = (operation(op).meaning)(&args, Context::default())[0];
                registers[to.index()] = Some(result);
            }
            TapeOp::Loop { index, to } => {
                let repeated = &tape.loops[index as usize];
                let mut state = operands;
                for _ in 0..repeated.most {
                    let next = by_tape(&repeated.body, &state, true);
                    if next[repeated.state()] == 0.0 {
                        break;
                    }
                    state[..repeated.state()].copy_from_slice(&next[..repeated.state()]);
                }
                for i in 0..repeated.state() {
                    registers[to.index() + i] = Some(state[i]);
                }
            }
        }
        if step.is_simple() {
            let to = step.written(&tape.loops).start;
            last = registers[to].expect("a step has a result");
            registers[to] = registers[to].filter(|_| link.kept);
        }
    }
    let unchanged = |i: usize| registers[i].map(f64::to_bits) == Some(inputs[i].to_bits());
    assert!(!inside || (0..inputs.len()).all(unchanged), "a body keeps its inputs");
    tape.outputs.iter().map(|r| registers[r.index()].expect("outputs were written")).collect()
}

#[test]
fn tapes_are_made_once_and_anew_for_a_copy() {
    let made = std::cell::Cell::new(0);
    let make = || -> Arc<[Tape]> {
        made.set(made.get() + 1);
        Arc::new([])
    };
    let kept = KeptTapes::default();
    assert!(Arc::ptr_eq(&kept.get_or_make(make), &kept.get_or_make(make)));
    assert_eq!(made.get(), 1);
    kept.clone().get_or_make(make);
    assert_eq!(made.get(), 2);
}

#[test]
fn tapes_compute_what_functions_mean() {
    for seed in 0..500 {
        let shape = random::Shape { curves: 0, operations: 60, ..random::Shape::default() };
        let function = random::function(seed, &shape);
        let inputs = [0.3, -1.75, 12.5];
        let bits = |values: Vec<f64>| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        let expected = bits(walk::walk(&mut Direct, &function, &inputs));
        for tape in [Tape::new(&function), Tape::with_own_registers(&function)] {
            let found = bits(by_tape(&tape, &inputs, false));
            assert_eq!(found, expected, "{}\n{tape:?}", text::print_function(&function));
        }
    }
}

#[test]
fn chains_stay_out_of_registers() {
    let body = "fn f(2) {\n%0 = input 0\n%1 = input 1\n%2 = constant 2.0\n%3 = sub %0 %2\n%4 = mul %3 %3\n\
        %5 = sub %1 %4\n%6 = sin %5\n%7 = add %6 %4\nreturn %7\n}";
    let tape = Tape::new(&text::parse_function(body).expect("well-formed text"));
    let found: Vec<_> = tape.links.iter().map(|link| (link.carried, link.kept)).collect();
    // Loads of both inputs come just before they are read; the sine is no simple step.
    let expected = [
        (Carried::Nothing, false),
        (Carried::First, false),
        (Carried::Both, true),
        (Carried::Nothing, false),
        (Carried::First, true),
        (Carried::Nothing, true),
        (Carried::Nothing, true),
    ];
    assert_eq!(found, expected, "{tape:?}");
    let apart = links(&tape, |_| true);
    assert!(apart.iter().all(|link| link.carried == Carried::Nothing && link.kept), "{apart:?}");
}

#[test]
fn registers_are_reused() {
    let mut body = "%0 = input 0\n".to_owned();
    for i in 1..100 {
        body += &format!("%{i} = add %{} %{}\n", i - 1, i - 1);
    }
    let function =
        text::parse_function(&format!("fn f(1) {{\n{body}return %99\n}}")).expect("well-formed text");
    assert_eq!(Tape::new(&function).registers, 1);
}

#[test]
fn results_of_a_tuple_are_consecutive() {
    let function = text::parse_function(
        "fn f(3) {\n%0 = input 0\n%1 = input 1\n%2 = input 2\n%3 = perlin_gradient[5] %0 %1 %2\n\
         %4 = extract %3 3\n%5 = extract %3 1\n%6 = sub %4 %5\nreturn %6\n}",
    )
    .expect("well-formed text");
    let tape = Tape::new(&function);
    // Three inputs stop being needed at the noise, whose four results start where they stood.
    assert_eq!(tape.registers, 4);
    let TapeOp::Apply { op: Op::Sub, to, args, .. } = tape.ops[4] else { panic!("{tape:?}") };
    assert_eq!((args[0], args[1], to, tape.outputs[0]), (Register(3), Register(1), Register(0), Register(0)));
}

#[test]
fn leaves_are_loaded_before_their_first_use() {
    let function = text::parse_function(
        "fn f(1) {\n%0 = constant 1.0\n%1 = uniform 0\n%2 = boolean true\n%3 = input 0\n%4 = neg %3\n\
         %5 = select %2 %4 %0\n%6 = sin %1\nreturn %5 %0\n}",
    )
    .expect("well-formed text");
    let tape = Tape::new(&function);
    // The dead sine and its uniform are left out.
    assert_eq!(tape.ops.len(), 5);
    assert_eq!(tape.values, [3, 4, 2, 0, 5].map(ValueId));
    assert_eq!(tape.ops[0], TapeOp::Input { to: Register(0), index: 0 });
    assert_eq!(tape.ops[2], TapeOp::Constant { to: Register(1), value: 1.0 });
}

#[test]
fn the_widest_operation_fits() {
    assert!(ops::TABLE.iter().all(|row| row.args.len() <= MAX_OPERANDS));
    assert!(size_of::<TapeOp>() <= 40);
}

#[test]
fn constants_are_finite() {
    assert_eq!([rounded(1e300), rounded(-1e300), rounded(0.1)], [f32::MAX, -f32::MAX, 0.1]);
    assert_eq!(rounded(-0.0).to_bits(), (-0.0f32).to_bits());
}
