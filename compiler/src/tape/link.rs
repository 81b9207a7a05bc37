//! How neighbouring steps of a tape hand results on.
//!
//! An interpreter keeps the result of the last simple step in vector registers of the machine. A step that reads it need
//! not load it, and one that nobody else reads need not be stored: on a long chain of arithmetic that is most of the
//! traffic.
//!
//! ```text
//! r1 = sub r0 2.0     not stored          last = r0 - 2
//! r2 = mul r1 r1      carried: both       last = last * last, stored to r2
//! r1 = sin r2         no simple step      reads and writes registers
//! ```

use super::Tape;

/// Which operands of a step are the result of the step before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    /// None: all are read from registers.
    Nothing,
    /// The first one, alone of the first two.
    First,
    /// The second one, alone of the first two.
    Second,
    /// The first two.
    Both,
}

/// How a step is joined to its neighbours. Means something for simple steps alone, see [`is_simple`](super::is_simple).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Link {
    /// What it has from the step before. A third operand is always read from its register.
    pub carried: Carried,
    /// Whether its result is read from its register, by any step or as an output.
    pub kept: bool,
}

impl Link {
    /// A step by itself, which reads and writes registers.
    pub const NONE: Self = Self { carried: Carried::Nothing, kept: true };
}

/// The links of all steps of a tape; what an interpreter starts at one of the given steps has nothing from the one before.
#[must_use]
pub fn links(tape: &Tape, starts: impl Fn(usize) -> bool) -> Vec<Link> {
    let carried = |i| if starts(i) { Carried::Nothing } else { carried(tape, i) };
    let mut links: Vec<Link> =
        (0..tape.ops.len()).map(|i| Link { carried: carried(i), kept: true }).collect();
    let mut read_later = vec![false; tape.registers as usize];
    tape.outputs.iter().for_each(|output| read_later[output.index()] = true);
    for (link, step) in links.iter_mut().zip(&tape.ops).rev() {
        let to = step.written(&tape.loops);
        link.kept = read_later[to.clone()].contains(&true);
        read_later[to].fill(false);
        let operands = step.operands(&tape.loops);
        let loaded = match link.carried {
            Carried::Nothing => operands,
            Carried::Both => &operands[2..],
            // The other operand, or what follows the carried one.
            Carried::First => &operands[1..],
            Carried::Second => {
                read_later[operands[0].index()] = true;
                &operands[2..]
            }
        };
        loaded.iter().for_each(|operand| read_later[operand.index()] = true);
    }
    links
}

/// What step `i` has from the one before.
fn carried(tape: &Tape, i: usize) -> Carried {
    let step = &tape.ops[i];
    let Some(before) = i.checked_sub(1).map(|before| &tape.ops[before]) else { return Carried::Nothing };
    if !step.is_simple() || !before.is_simple() {
        return Carried::Nothing;
    }
    let last = before.written(&tape.loops).start;
    let operands = step.operands(&tape.loops);
    let is_last = |operand: usize| operands.get(operand).is_some_and(|operand| operand.index() == last);
    match (is_last(0), is_last(1)) {
        (false, false) => Carried::Nothing,
        (true, false) => Carried::First,
        (false, true) => Carried::Second,
        (true, true) => Carried::Both,
    }
}
