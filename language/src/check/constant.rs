//! Values known at compile time: literals and arithmetic of them.
//!
//! Every expression is folded once, when it enters the scene, from the values of its operands; so
//! folding never recurses. Calls, `time` and params are not constant here.

use super::Checker;
use crate::ast::{BinaryOp, UnaryOp};
use crate::hir::{Conversion, ExprId, ExprKind};

/// The components of a scalar, vector or colour; a truth value is 0 or 1, unused ones are 0.
pub(super) type Constant = [f64; 4];

impl Checker<'_> {
    /// The value of an expression about to be added.
    pub(super) fn fold(&self, kind: &ExprKind) -> Option<Constant> {
        match kind {
            ExprKind::Bool(value) => Some(scalar(f64::from(u8::from(*value)))),
            ExprKind::Number(value) => Some(scalar(*value)),
            ExprKind::Color([r, g, b]) => Some([*r, *g, *b, 0.0]),
            ExprKind::Local(local) => self.scope.local(*local).constant,
            ExprKind::Let(id) => self.constant(self.scene.lets[id.index()].value),
            ExprKind::Vector(parts) => self.fold_vector(parts),
            ExprKind::Swizzle(of, indices) => {
                let value = self.constant(*of)?;
                let mut picked = [0.0; 4];
                for (slot, &index) in picked.iter_mut().zip(indices) {
                    *slot = value[usize::from(index)];
                }
                Some(picked)
            }
            ExprKind::Unary(UnaryOp::Negate, inner) => Some(self.constant(*inner)?.map(|x| 0.0 - x)),
            ExprKind::Unary(UnaryOp::Not, inner) => Some(scalar(1.0 - self.constant(*inner)?[0])),
            ExprKind::Binary(op, left, right) => self.fold_binary(*op, *left, *right),
            ExprKind::If(condition, yes, no) => {
                self.constant(if self.constant(*condition)?[0] == 0.0 { *no } else { *yes })
            }
            ExprKind::Block(_, value) => self.constant(*value),
            ExprKind::Convert(Conversion::Retype, inner) => self.constant(*inner),
            ExprKind::Convert(Conversion::Broadcast, inner) => Some([self.constant(*inner)?[0]; 4]),
            ExprKind::Convert(Conversion::Constant, _)
            | ExprKind::String(_)
            | ExprKind::Param(_)
            | ExprKind::Time
            | ExprKind::Frame
            | ExprKind::LocalField(..)
            | ExprKind::Lambda(..)
            | ExprKind::CallFunction(..)
            | ExprKind::CallBuiltin(..)
            | ExprKind::CallValue(..)
            | ExprKind::List(_)
            | ExprKind::Comprehension { .. }
            | ExprKind::Iterate(_)
            | ExprKind::RecordField(..)
            | ExprKind::Keys(_)
            | ExprKind::Choice(..)
            | ExprKind::BlockName(_)
            | ExprKind::Settings(_)
            | ExprKind::Error => None,
        }
    }

    fn fold_vector(&self, parts: &[ExprId]) -> Option<Constant> {
        let mut value = [0.0; 4];
        let mut filled = 0;
        for &part in parts {
            let count = self.ty(part).components()?;
            let slots = value.get_mut(filled..filled + count)?;
            slots.copy_from_slice(&self.constant(part)?[..count]);
            filled += count;
        }
        Some(value)
    }

    fn fold_binary(&self, op: BinaryOp, left: ExprId, right: ExprId) -> Option<Constant> {
        let count = self.ty(left).components()?;
        let (a, b) = (self.constant(left)?, self.constant(right)?);
        let truth = |value: bool| Some(scalar(f64::from(u8::from(value))));
        match op {
            BinaryOp::Or => truth(a[0] != 0.0 || b[0] != 0.0),
            BinaryOp::And => truth(a[0] != 0.0 && b[0] != 0.0),
            BinaryOp::Equal => truth(a[0] == b[0]),
            BinaryOp::NotEqual => truth(a[0] != b[0]),
            BinaryOp::Less => truth(a[0] < b[0]),
            BinaryOp::LessEqual => truth(a[0] <= b[0]),
            BinaryOp::Greater => truth(a[0] > b[0]),
            BinaryOp::GreaterEqual => truth(a[0] >= b[0]),
            BinaryOp::Union | BinaryOp::Intersection => None,
            BinaryOp::Add => Some(componentwise(a, b, count, |a, b| a + b)),
            BinaryOp::Subtract => Some(componentwise(a, b, count, |a, b| a - b)),
            BinaryOp::Multiply => Some(componentwise(a, b, count, |a, b| a * b)),
            BinaryOp::Divide | BinaryOp::Modulo if b[..count].contains(&0.0) => None,
            BinaryOp::Divide => Some(componentwise(a, b, count, |a, b| a / b)),
            BinaryOp::Modulo => Some(componentwise(a, b, count, |a, b| a - b * (a / b).floor())),
        }
    }
}

/// Whether all components are zero.
pub(super) fn is_zero(value: Constant) -> bool {
    value.iter().all(|&x| x == 0.0)
}

fn scalar(value: f64) -> Constant {
    [value, 0.0, 0.0, 0.0]
}

fn componentwise(a: Constant, b: Constant, count: usize, op: impl Fn(f64, f64) -> f64) -> Constant {
    let mut value = [0.0; 4];
    for i in 0..count {
        value[i] = op(a[i], b[i]);
    }
    value
}
