//! The built-in functions as the checker sees them.
//!
//! The compiler owns the functions (its operation table and its scene functions) and hands their
//! signatures over as a [`Library`]; this crate knows no function by name.

use crate::ty::Type;

/// Index of a signature in a [`Library`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct BuiltinId(pub u32);

/// What a parameter is when a call leaves it out.
#[derive(Clone, Debug, PartialEq)]
pub enum DefaultValue {
    /// The call must give it.
    Required,
    /// This number, whole or real as the type says; broadcast over vectors, radians for angles.
    Number(f64),
    /// This truth value.
    Bool(bool),
    /// This word of the parameter's choice.
    Word(&'static str),
}

/// One parameter of a built-in function.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name for named arguments.
    pub name: &'static str,
    /// Type asked for.
    pub ty: Type,
    /// Value when left out.
    pub default: DefaultValue,
    /// Takes all remaining positional arguments, or one list of them, as a list of `ty`.
    pub rest: bool,
}

/// One overload of a built-in function.
#[derive(Clone, Debug, PartialEq)]
pub struct Signature {
    /// The name that scenes use.
    pub name: &'static str,
    /// Parameters in order; at most one is `rest`, followed only by named ones.
    pub params: Vec<Parameter>,
    /// Type of the result.
    pub result: Type,
    /// What it computes, for help texts and the generated reference.
    pub doc: &'static str,
}

/// All built-in functions, in the compiler's order.
#[derive(Clone, Debug, Default)]
pub struct Library {
    /// Overloads of one name may stand anywhere in the list.
    pub signatures: Vec<Signature>,
}

impl Library {
    /// The overloads of `name`, in order.
    pub fn overloads<'a>(&'a self, name: &'a str) -> impl Iterator<Item = (BuiltinId, &'a Signature)> {
        let numbered = self.signatures.iter().enumerate();
        numbered.filter(move |(_, s)| s.name == name).map(|(i, s)| (BuiltinId(i as u32), s))
    }

    /// The signature behind an id of this library.
    #[must_use]
    pub fn signature(&self, id: BuiltinId) -> &Signature {
        &self.signatures[id.0 as usize]
    }
}
