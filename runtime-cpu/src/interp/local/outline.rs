//! What of a function matters in a box: an outline of its tape, a few numbers instead of thousands of steps.
//!
//! In: the tape of a function, each of whose values has a register of its own, the outline of it in a box, and what is
//! decided in the eighths of that box ([`bounds`](super::bounds)). Out: the outlines in the eighths
//! ([`Outlines`]), and from an outline a tape of its own ([`Outline::tape`]).
//!
//! ```text
//! r0 = input 0    r1 = a r0    r2 = b r0    r3 = min r1 r2    r4 = c r0    r5 = min r3 r4
//! in a box where r1 < r2:   steps 0..2, r3 is r1, steps 4..6
//! ```

use super::bounds::{Choice, Side};
use std::mem::size_of;
use std::ops::Range;
use std::sync::{Arc, OnceLock};
use vol_compiler::ops::{Op, operation};
use vol_compiler::tape::{Link, Register, Scalar, Tape, TapeLoop, TapeOp};

/// Outlines of more steps than this are written with few gaps, since those take memory.
const LONG: usize = 8 << 10;

/// Which steps of a tape choose among large parts: those between which and the results there are only other choices, and
/// what follows the last of all. Of a union of boxes, say, those that join boxes, and not those within each box.
pub(super) fn spine(tape: &Tape) -> Vec<bool> {
    let mut writer = vec![0; tape.registers as usize];
    for (index, step) in tape.ops.iter().enumerate() {
        writer[step.written(&tape.loops)].fill(index);
    }
    let (mut spine, mut seen) = (vec![false; tape.ops.len()], vec![false; tape.ops.len()]);
    // Steps to look at, and whether there was a choice on the way.
    let mut left: Vec<(usize, bool)> =
        tape.outputs.iter().map(|output| (writer[output.index()], false)).collect();
    while let Some((index, below)) = left.pop() {
        if std::mem::replace(&mut seen[index], true) {
            continue;
        }
        let step = &tape.ops[index];
        let chooses = match step {
            TapeOp::Apply { op, .. } => {
                matches!(op, Op::Min | Op::Max | Op::Select | Op::Less | Op::LessEqual | Op::Sub)
            }
            _ => false,
        };
        spine[index] = chooses;
        if chooses || !below {
            left.extend(
                step.operands(&tape.loops).iter().map(|operand| (writer[operand.index()], below || chooses)),
            );
        }
    }
    spine
}

/// The steps of a tape that matter in a box.
#[derive(Debug)]
pub(super) struct Outline {
    /// In the order of the steps.
    pub(super) parts: Vec<Part>,
    /// Registers of the results.
    outputs: Vec<Register>,
    /// How many steps there are.
    pub(super) steps: usize,
    /// The steps as a tape, once it is needed; nothing if there is no memory for it.
    pub(super) tape: OnceLock<Option<Tape>>,
}

/// Some steps, or what a step that is left out would give to those that read it.
#[derive(Debug)]
pub(super) enum Part {
    Steps(Range<u32>),
    Same { to: Register, from: Register },
    Scalar { to: Register, scalar: Scalar },
}

/// Room to work in, one number for each register of the tape; 0 between uses.
#[derive(Debug)]
pub(super) struct Room {
    /// In which boxes each register is read, one bit each.
    read: Vec<u8>,
    /// In which of them by a step that is left.
    read_by_step: Vec<u8>,
    /// The register that holds the same.
    same: Vec<Register>,
}

impl Room {
    pub(super) fn new(tape: &Tape) -> Self {
        let count = tape.registers as usize;
        Self { read: vec![0; count], read_by_step: vec![0; count], same: vec![Register(0); count] }
    }
}

impl Outline {
    /// All of a tape.
    pub(super) fn whole(tape: &Tape) -> Self {
        let all = Part::Steps(0..tape.ops.len() as u32);
        Self { parts: vec![all], outputs: tape.outputs.clone(), steps: tape.ops.len(), tape: OnceLock::new() }
    }

    /// What it takes in memory.
    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>() + self.parts.len() * size_of::<Part>() + self.outputs.len() * size_of::<Register>()
    }

    /// The steps with registers numbered anew: the same bits as the whole tape, in the box.
    pub(super) fn tape(&self, whole: &Tape, room: &mut Room) -> Tape {
        let names = &mut room.same;
        let mut short = Tape {
            inputs: whole.inputs,
            outputs: Vec::new(),
            registers: 0,
            ops: Vec::with_capacity(self.steps),
            // Nobody asks where the steps come from.
            values: Vec::new(),
            loops: Vec::new(),
            links: Vec::new(),
        };
        for part in &self.parts {
            match part {
                Part::Same { to, from } => names[to.index()] = names[from.index()],
                Part::Scalar { to, scalar } => {
                    let new = Register(short.registers);
                    short.ops.push(match *scalar {
                        Scalar::Number(value) => TapeOp::Constant { to: new, value },
                        Scalar::Uniform(index) => TapeOp::Uniform { to: new, index },
                    });
                    names[to.index()] = new;
                    short.registers += 1;
                }
                Part::Steps(steps) => {
                    for step in &whole.ops[steps.start as usize..steps.end as usize] {
                        let (old, new) = (step.written(&whole.loops), Register(short.registers));
                        let step = renamed(step, new, names, &whole.loops, &mut short.loops);
                        short.ops.push(step);
                        short.registers += old.len() as u32;
                        old.enumerate().for_each(|(i, old)| names[old] = Register(new.0 + i as u32));
                    }
                }
            }
        }
        short.outputs = self.outputs.iter().map(|output| names[output.index()]).collect();
        // It may be for a single batch, in which links do not gain what it takes to find them.
        short.links = vec![Link::NONE; short.ops.len()];
        short
    }
}

/// The outlines in the eighths of a box, before they are written.
pub(super) struct Outlines<'a> {
    tape: &'a Tape,
    around: &'a Outline,
    /// What matters in some of them, in order.
    kept: Vec<Kept>,
    /// How many steps are left in each.
    pub(super) lengths: [usize; 8],
}

/// What matters in some boxes.
enum Kept {
    /// A step: where it is computed, and what it is elsewhere.
    Step {
        index: u32,
        computed: u8,
        sides: Option<[(Side, u8); 2]>,
    },
    /// What the outline around says of steps that are left out.
    Same {
        to: Register,
        from: Register,
    },
    Scalar {
        to: Register,
        scalar: Scalar,
    },
}

impl<'a> Outlines<'a> {
    /// Goes from the results back to what they need.
    /// Of a long outline only choices of the `spine` leave anything out.
    pub(super) fn new(
        tape: &'a Tape,
        spine: &[bool],
        around: &'a Outline,
        choices: &[Choice],
        room: &mut Room,
    ) -> Self {
        let is_short = around.steps <= LONG;
        around.outputs.iter().for_each(|output| room.read[output.index()] = u8::MAX);
        let mut all = Self { tape, around, kept: Vec::new(), lengths: [0; 8] };
        let mut choices = choices.iter().rev().peekable();
        for part in around.parts.iter().rev() {
            match part {
                Part::Steps(steps) => {
                    for index in steps.clone().rev() {
                        let choice = choices.next_if(|choice| choice.step == index);
                        all.keep_step(index, choice.filter(|_| is_short || spine[index as usize]), room);
                    }
                }
                Part::Same { to, from } => {
                    let read = room.read[to.index()];
                    room.read[from.index()] |= read;
                    if read != 0 {
                        all.kept.push(Kept::Same { to: *to, from: *from });
                    }
                }
                Part::Scalar { to, scalar } => {
                    let read = room.read[to.index()];
                    all.count(read);
                    if read != 0 {
                        all.kept.push(Kept::Scalar { to: *to, scalar: *scalar });
                    }
                }
            }
        }
        all.kept.reverse();
        all
    }

    fn count(&mut self, boxes: u8) {
        (0..8).for_each(|which| self.lengths[which] += usize::from(boxes >> which & 1));
    }

    fn keep_step(&mut self, index: u32, choice: Option<&Choice>, room: &mut Room) {
        let step = &self.tape.ops[index as usize];
        let read = room.read[step.written(&self.tape.loops)].iter().fold(0, |all, read| all | read);
        if read == 0 {
            return;
        }
        let (mut computed, mut left) = (read, read);
        for (side, boxes) in choice.iter().flat_map(|choice| choice.sides) {
            computed &= !boxes;
            if let Side::Register(operand) = side {
                room.read[operand.index()] |= boxes & read;
                left &= !boxes;
            }
        }
        if computed != 0 {
            for operand in step.operands(&self.tape.loops) {
                room.read[operand.index()] |= computed;
                room.read_by_step[operand.index()] |= computed;
            }
        }
        self.count(left);
        self.kept.push(Kept::Step { index, computed, sides: choice.map(|choice| choice.sides) });
    }

    /// The outline in one of the eighths.
    pub(super) fn outline(&self, which: usize, room: &mut Room) -> Outline {
        let is_here = |boxes: u8| boxes >> which & 1 == 1;
        let mut parts: Vec<Part> = Vec::new();
        let mut add = |part: Part| match (parts.last_mut(), part) {
            (Some(Part::Steps(last)), Part::Steps(next)) if last.end == next.start => last.end = next.end,
            (_, part) => parts.push(part),
        };
        let Room { read, read_by_step, same } = room;
        for kept in &self.kept {
            // Which register this one is the same as, if not itself.
            let (to, other) = match kept {
                Kept::Same { to, from } => (to.index()..to.index() + 1, Some(*from)),
                Kept::Scalar { to, scalar } => {
                    if is_here(read[to.index()]) {
                        add(Part::Scalar { to: *to, scalar: *scalar });
                    }
                    (to.index()..to.index() + 1, None)
                }
                Kept::Step { index, computed, sides } => {
                    let to = self.tape.ops[*index as usize].written(&self.tape.loops);
                    let taken = sides.iter().flatten().find(|(_, boxes)| is_here(*boxes));
                    let other = match taken {
                        Some((Side::Register(operand), _)) => Some(*operand),
                        Some((Side::Scalar(scalar), _)) => {
                            if is_here(read[to.start]) {
                                add(Part::Scalar { to: Register(to.start as u32), scalar: *scalar });
                            }
                            None
                        }
                        None => {
                            if is_here(*computed) {
                                add(Part::Steps(*index..index + 1));
                            }
                            None
                        }
                    };
                    (to, other)
                }
            };
            if let Some(other) = other {
                let (to, from) = (Register(to.start as u32), same[other.index()]);
                same[to.index()] = from;
                if is_here(read_by_step[to.index()]) {
                    add(Part::Same { to, from });
                }
            } else {
                to.for_each(|register| same[register] = Register(register as u32));
            }
        }
        let outputs = self.around.outputs.iter().map(|output| same[output.index()]).collect();
        parts.shrink_to_fit();
        Outline { parts, outputs, steps: self.lengths[which], tape: OnceLock::new() }
    }

    /// Leaves the room as it was.
    pub(super) fn clear(self, room: &mut Room) {
        for part in &self.around.parts {
            match part {
                Part::Steps(steps) => {
                    for step in &self.tape.ops[steps.start as usize..steps.end as usize] {
                        room.read[step.written(&self.tape.loops)].fill(0);
                        room.read_by_step[step.written(&self.tape.loops)].fill(0);
                    }
                }
                Part::Same { to, .. } | Part::Scalar { to, .. } => {
                    (room.read[to.index()], room.read_by_step[to.index()]) = (0, 0);
                }
            }
        }
    }
}

/// A step that writes to other registers and reads from those that `names` tells.
fn renamed(
    step: &TapeOp,
    to: Register,
    names: &[Register],
    loops: &[TapeLoop],
    new_loops: &mut Vec<TapeLoop>,
) -> TapeOp {
    match *step {
        TapeOp::Constant { value, .. } => TapeOp::Constant { to, value },
        TapeOp::Input { index, .. } => TapeOp::Input { to, index },
        TapeOp::Uniform { index, .. } => TapeOp::Uniform { to, index },
        TapeOp::Apply { op, data, mut args, wanted, .. } => {
            args.iter_mut().take(operation(op).args.len()).for_each(|arg| *arg = names[arg.index()]);
            TapeOp::Apply { op, data, to, args, wanted }
        }
        TapeOp::ApplyScalar { op, scalar_first, scalar, arg, .. } => {
            TapeOp::ApplyScalar { op, scalar_first, scalar, to, arg: names[arg.index()] }
        }
        TapeOp::Loop { index, .. } => {
            let TapeLoop { most, args, body } = &loops[index as usize];
            let args = args.iter().map(|arg| names[arg.index()]).collect();
            new_loops.push(TapeLoop { most: *most, args, body: Arc::clone(body) });
            TapeOp::Loop { index: new_loops.len() as u32 - 1, to }
        }
    }
}
