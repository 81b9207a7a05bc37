//! Functions of objects that differ in their numbers alone, as one function that is given those.
//!
//! Drivers write out every function that a shader calls and compile each: a thousand balls are a thousand functions, which
//! take minutes. Here they are one, and its numbers lie in front of `vol_input`, a row for each object:
//!
//! ```text
//! distance:ball7(3) {             family(5) {
//!   %3 = constant 0.25              %3 = input 3          row of the object: 0.25, uniform 9
//!   %4 = uniform 9          ──►     %4 = input 4
//!   %5 = sub %0 %3                  %5 = sub %0 %3
//! ```
//!
//! The operations on the numbers are the same, so are the bits. Numbers of curves are such numbers. Which numbers are equal by chance does not matter: each
//! place where one is read counts by itself.

use crate::frame::Frame;
use crate::ir::{Function, FunctionId, Inst, Number, ValueId};
use crate::program::{Object, Program};
use crate::tape::rounded;
use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, OnceLock};

/// Fewer functions than this stay as they are: reading numbers takes longer than having them in the text.
const FEWEST: usize = 8;

/// The same for functions that search a curve, which are long.
const FEWEST_SEARCHES: usize = 2;

/// Most numbers that a function is given: WGSL allows 255 arguments.
const MOST_NUMBERS: usize = 200;

/// The kinds of functions that an object has one of each.
const KINDS: [fn(&Object) -> Option<FunctionId>; 4] =
    [|own| Some(own.distance), |own| Some(own.gradient), |own| own.steepness, |own| Some(own.surface)];

/// Some functions of one form.
#[derive(Debug)]
pub(crate) struct Family {
    /// The function: the arguments of its members, then the numbers in which these differ.
    pub(crate) function: Function,
    /// The member whose places in the scene are the family's.
    pub(crate) first: FunctionId,
    /// Operations on a curve whose number is an argument, with that argument.
    pub(crate) curves: BTreeMap<ValueId, ValueId>,
    /// The instruction of that member which each of the family's is, but for numbers.
    pub(crate) origins: Vec<Option<usize>>,
    /// First word of its numbers in a row.
    pub(crate) at: usize,
    /// How many of them there are.
    pub(crate) numbers: usize,
}

/// Where a number is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Source {
    Constant(Number),
    Uniform(u32),
    /// The number of a curve, itself.
    Curve(u32),
}

/// The families of a program.
#[derive(Debug, Default)]
pub(crate) struct Families {
    /// All of them.
    pub(crate) all: Vec<Family>,
    /// The family of each function that is in one, by its index.
    of: HashMap<FunctionId, usize>,
    /// Words of a row.
    pub(crate) row: usize,
    /// The numbers of all objects, row by row; none where a row is longer than what the object needs.
    sources: Vec<Option<Source>>,
}

/// The families of a program, kept from when somebody first asks for them. A copy starts without any.
#[derive(Debug, Default)]
pub struct KeptFamilies(OnceLock<Arc<Families>>);

impl Clone for KeptFamilies {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Families {
    /// Those of a program.
    pub(crate) fn of(program: &Program) -> Arc<Self> {
        program.families.0.get_or_init(|| Arc::new(Self::find(program))).clone()
    }

    fn find(program: &Program) -> Self {
        let mut families = Self::default();
        let mut numbers: BTreeMap<(usize, usize), Source> = BTreeMap::new();
        for kind in KINDS {
            let width = families.find_kind(program, kind, &mut numbers);
            families.row += width;
        }
        families.sources = vec![None; families.row * program.objects.len()];
        for ((object, at), source) in numbers {
            families.sources[object * families.row + at] = Some(source);
        }
        families
    }

    /// Finds the families of one kind of functions, puts down their numbers by object and place in the row, and tells
    /// how many words of the row they take.
    fn find_kind(
        &mut self,
        program: &Program,
        kind: fn(&Object) -> Option<FunctionId>,
        numbers: &mut BTreeMap<(usize, usize), Source>,
    ) -> usize {
        let mut forms: HashMap<Form, Vec<Member>> = HashMap::new();
        for (object, own) in program.objects.iter().enumerate() {
            let Some(function) = kind(own) else { continue };
            let (form, sources) = Form::of(program.module.function(function));
            forms.entry(form).or_default().push(Member { object, function, sources });
        }
        let mut forms: Vec<_> =
            forms.into_iter().filter(|(form, members)| members.len() >= form.fewest()).collect();
        forms.sort_unstable_by_key(|(_, members)| members[0].object);
        let mut width = 0;
        for (form, members) in forms {
            let places = Places::of(&members);
            if places.numbers.len() > MOST_NUMBERS {
                continue;
            }
            for member in &members {
                let own = places.numbers.iter().map(|&place| member.sources[place]);
                numbers
                    .extend(own.enumerate().map(|(number, own)| ((member.object, self.row + number), own)));
            }
            self.of.extend(members.iter().map(|member| (member.function, self.all.len())));
            let first = members[0].function;
            let written = form.written(program.module.function(first), &members[0].sources, &places);
            self.all.push(Family { first, at: self.row, ..written });
            width = width.max(places.numbers.len());
        }
        width
    }

    /// The number of the family that a function is in.
    pub(crate) fn number_of(&self, function: FunctionId) -> Option<usize> {
        self.of.get(&function).copied()
    }

    /// The rows of all objects in a frame, one after the other.
    pub(crate) fn words(&self, frame: &Frame) -> Vec<f32> {
        let word = |source: &Option<Source>| match *source {
            Some(Source::Constant(Number(number))) => rounded(number),
            Some(Source::Uniform(index)) => frame.uniforms_f32[index as usize],
            Some(Source::Curve(number)) => number as f32,
            None => 0.0,
        };
        self.sources.iter().map(word).collect()
    }

    /// How many words they are.
    pub(crate) fn word_count(&self) -> usize {
        self.sources.len()
    }
}

/// An object's function, with its numbers in the order in which they are read.
struct Member {
    object: usize,
    function: FunctionId,
    sources: Vec<Source>,
}

/// Stands for a number among the operands of a [`Form`].
const NUMBER: ValueId = ValueId(u32::MAX);

/// What functions of a family have in common: all but the numbers.
#[derive(PartialEq, Eq, Hash)]
struct Form {
    inputs: u32,
    insts: Vec<Inst>,
    outputs: Vec<ValueId>,
}

impl Form {
    /// The form of a function, and its numbers in the order in which they are read.
    fn of(function: &Function) -> (Self, Vec<Source>) {
        let (mut insts, mut sources) = (Vec::new(), Vec::new());
        let mut places: Vec<Result<ValueId, Source>> = Vec::with_capacity(function.insts.len());
        for inst in &function.insts {
            places.push(match inst {
                Inst::Constant(number) => Err(Source::Constant(*number)),
                Inst::Uniform(index) => Err(Source::Uniform(*index)),
                Inst::Boolean(_)
                | Inst::Input(_)
                | Inst::Apply { .. }
                | Inst::Extract(..)
                | Inst::Loop { .. } => {
                    sources.extend(curve_of(inst).map(Source::Curve));
                    let inst = inst.map_operands(|value| read(&places, &mut sources, value));
                    insts.push(with_curve(inst, 0));
                    Ok(ValueId(insts.len() as u32 - 1))
                }
            });
        }
        let outputs = function.outputs.iter().map(|&value| read(&places, &mut sources, value)).collect();
        (Self { inputs: function.inputs, insts, outputs }, sources)
    }

    /// From how many members on they are a family.
    fn fewest(&self) -> usize {
        let searches = self.insts.iter().any(|inst| curve_of(inst).is_some());
        if searches { FEWEST_SEARCHES } else { FEWEST }
    }

    /// The family of members, the first of which is given with its numbers; where its numbers lie is left open.
    fn written(&self, first: &Function, sources: &[Source], places: &Places) -> Family {
        let argument = |place: usize| places.numbers.iter().position(|&own| own == place);
        let number = |&place: &usize| match (argument(place), sources[place]) {
            (Some(argument), _) => Inst::Input(self.inputs + argument as u32),
            (None, Source::Constant(number)) => Inst::Constant(number),
            (None, Source::Uniform(index)) => Inst::Uniform(index),
            (None, Source::Curve(number)) => Inst::Constant(Number(f64::from(number))),
        };
        let mut insts: Vec<Inst> = places.distinct.iter().map(number).collect();
        let numbers = insts.len() as u32;
        let mut curves = BTreeMap::new();
        let mut reads = places.which.iter().copied();
        let mut next = || reads.next().expect("there is a place for each number that is read");
        for inst in &self.insts {
            let mut own = inst.clone();
            if curve_of(inst).is_some() {
                let which = next();
                match (&insts[which as usize], sources[places.distinct[which as usize]]) {
                    (Inst::Constant(_), Source::Curve(number)) => own = with_curve(own, number),
                    _ => drop(curves.insert(ValueId(insts.len() as u32), ValueId(which))),
                }
            }
            insts.push(own.map_operands(|value| {
                if value == NUMBER { ValueId(next()) } else { ValueId(numbers + value.0) }
            }));
        }
        let output =
            |&value: &ValueId| if value == NUMBER { ValueId(next()) } else { ValueId(numbers + value.0) };
        let outputs = self.outputs.iter().map(output).collect();
        let is_number = |inst: &Inst| matches!(inst, Inst::Constant(_) | Inst::Uniform(_));
        let others = first.insts.iter().enumerate().filter(|(_, inst)| !is_number(inst));
        let origins = vec![None; numbers as usize].into_iter().chain(others.map(|(place, _)| Some(place)));
        let inputs = self.inputs + places.numbers.len() as u32;
        Family {
            function: Function { name: first.name.clone(), inputs, insts, outputs },
            first: FunctionId(0),
            curves,
            origins: origins.collect(),
            at: 0,
            numbers: places.numbers.len(),
        }
    }
}

/// An operand of a form: a number goes to the list of those that are read.
fn read(places: &[Result<ValueId, Source>], sources: &mut Vec<Source>, value: ValueId) -> ValueId {
    places[value.index()].unwrap_or_else(|source| {
        sources.push(source);
        NUMBER
    })
}

/// The number of the curve that an operation is on.
fn curve_of(inst: &Inst) -> Option<u32> {
    match inst {
        Inst::Apply { op, data, .. } if op.reads_curve() => Some(*data),
        _ => None,
    }
}

/// The same on another curve, if it is on one.
fn with_curve(mut inst: Inst, curve: u32) -> Inst {
    if let Inst::Apply { op, data, .. } = &mut inst
        && op.reads_curve()
    {
        *data = curve;
    }
    inst
}

/// The numbers that the members of a family read; those that are equal in each of them are one.
struct Places {
    /// Where each of them is first read.
    distinct: Vec<usize>,
    /// Which of these it is, for every place where one is read.
    which: Vec<u32>,
    /// Those of `distinct` in which members differ.
    numbers: Vec<usize>,
}

impl Places {
    fn of(members: &[Member]) -> Self {
        let mut known: HashMap<Vec<Source>, u32> = HashMap::new();
        let mut places = Self { distinct: Vec::new(), which: Vec::new(), numbers: Vec::new() };
        for place in 0..members[0].sources.len() {
            let all: Vec<Source> = members.iter().map(|member| member.sources[place]).collect();
            let differ = all.iter().any(|source| *source != all[0]);
            let next = places.distinct.len() as u32;
            let which = *known.entry(all).or_insert(next);
            if which == next {
                places.distinct.push(place);
                places.numbers.extend(differ.then_some(place));
            }
            places.which.push(which);
        }
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::text;
    use crate::reference;

    fn member(object: usize, body: &str) -> (Form, Member, Function) {
        let function = text::parse_function(&format!("fn f(2) {{\n{body}\n}}")).expect("well-formed text");
        let (form, sources) = Form::of(&function);
        (form, Member { object, function: FunctionId(object as u32), sources }, function)
    }

    #[test]
    fn equal_numbers_do_not_matter() {
        // 2 x + u0 y, and 3 x + 3 y + ..: the second has one constant where the first has a constant and a uniform.
        let bodies = [
            "%0 = input 0\n%1 = input 1\n%2 = constant 2.0\n%3 = uniform 0\n%4 = mul %0 %2\n%5 = mul %1 %3\n\
             %6 = add %4 %5\n%7 = constant 7.0\n%8 = add %6 %7\nreturn %8",
            "%0 = input 0\n%1 = input 1\n%2 = constant 3.0\n%3 = mul %0 %2\n%4 = mul %1 %2\n%5 = add %3 %4\n\
             %6 = constant 7.0\n%7 = add %5 %6\nreturn %7",
        ];
        let [(form, first, function), (other, second, _)] = [0, 1].map(|i| member(i, bodies[i]));
        assert!(form == other);
        let members = [first, second];
        let places = Places::of(&members);
        assert_eq!(places.numbers, [0, 1], "7 is the same in both");
        let Family { function: written, origins, .. } = form.written(&function, &members[0].sources, &places);
        assert_eq!(
            text::print_function(&written),
            "fn f(4) {\n  %0 = input 2\n  %1 = input 3\n  %2 = constant 7.0\n  %3 = input 0\n  %4 = input 1\n  \
             %5 = mul %3 %0\n  %6 = mul %4 %1\n  %7 = add %5 %6\n  %8 = add %7 %2\n  return %8\n}\n"
        );
        assert_eq!(origins[5..], [Some(4), Some(5), Some(6), Some(8)]);
        assert_eq!(reference::evaluate(&written, &[1.0, 10.0, 3.0, 3.0], &[], &[]), [40.0]);
    }

    #[test]
    fn other_operations_are_another_form() {
        let of = |body| member(0, body).0;
        let (add, sub) =
            ("%0 = input 0\n%1 = add %0 %0\nreturn %1", "%0 = input 0\n%1 = sub %0 %0\nreturn %1");
        assert!(of(add) != of(sub));
        assert!(of(add) != of("%0 = input 0\n%1 = constant 1.0\n%2 = add %0 %1\nreturn %2"));
        assert!(of(add) != of("%0 = input 1\n%1 = add %0 %0\nreturn %1"));
    }
}
