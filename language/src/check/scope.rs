//! The bindings that are visible at a place: blocks, lambdas, parameters, comprehensions.

use super::constant::Constant;
use crate::hir::LocalId;
use crate::ty::Type;
use std::collections::HashMap;

/// A binding.
#[derive(Clone, Debug)]
pub(super) struct Local<'a> {
    /// Its name; empty for those that the checker makes up.
    pub(super) name: &'a str,
    /// Its type.
    pub(super) ty: Type,
    /// Its value if that is known at compile time.
    pub(super) constant: Option<Constant>,
}

/// All bindings ever made, and which of them are visible.
#[derive(Debug, Default)]
pub(super) struct Scope<'a> {
    locals: Vec<Local<'a>>,
    visible: HashMap<&'a str, Vec<LocalId>>,
    /// Visible names in the order in which they were bound.
    trail: Vec<&'a str>,
}

/// A state of the scope to go back to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mark(usize);

impl<'a> Scope<'a> {
    /// Number of bindings ever made.
    pub(super) fn count(&self) -> u32 {
        self.locals.len() as u32
    }

    /// Remembers what is visible.
    pub(super) fn mark(&self) -> Mark {
        Mark(self.trail.len())
    }

    /// Forgets everything bound since the mark.
    pub(super) fn leave(&mut self, mark: Mark) {
        for name in self.trail.drain(mark.0..).rev() {
            if let Some(ids) = self.visible.get_mut(name) {
                ids.pop();
                if ids.is_empty() {
                    self.visible.remove(name);
                }
            }
        }
    }

    /// Makes a visible binding.
    pub(super) fn bind(&mut self, name: &'a str, ty: Type, constant: Option<Constant>) -> LocalId {
        let id = self.add(Local { name, ty, constant });
        self.visible.entry(name).or_default().push(id);
        self.trail.push(name);
        id
    }

    /// Makes a binding that no name reaches.
    pub(super) fn fresh(&mut self, ty: Type) -> LocalId {
        self.add(Local { name: "", ty, constant: None })
    }

    /// The innermost visible binding of a name.
    pub(super) fn find(&self, name: &str) -> Option<LocalId> {
        self.visible.get(name).and_then(|ids| ids.last().copied())
    }

    /// The binding behind an id.
    pub(super) fn local(&self, id: LocalId) -> &Local<'a> {
        &self.locals[id.index()]
    }

    /// All visible names.
    pub(super) fn names(&self) -> impl Iterator<Item = &'a str> + '_ {
        self.visible.keys().copied()
    }

    fn add(&mut self, local: Local<'a>) -> LocalId {
        let id = LocalId(self.locals.len() as u32);
        self.locals.push(local);
        id
    }
}
