//! Loops and keys.

use crate::Generator;
use crate::expr::is_numeric;
use crate::piece::Piece;
use crate::scope::{Place, Stage, Variable};
use vol_language::ty::Type;

impl Generator<'_> {
    /// The last value of a loop, or `None` where nothing that runs may stand.
    pub(crate) fn iterate(&mut self, ty: &Type, place: Place) -> Option<Piece> {
        // A whole number would have to stay one, and the state of a loop is not known at compile time.
        if *ty == Type::Int || place.stage == Stage::Constant {
            return None;
        }
        // Small and known: loops inside each other, also through functions, have a limit together.
        let count = self.source.pick(&["2", "0", "1", "3"]);
        let name = self.local_name();
        let first = self.value(ty, place);
        let mark = self.scope.mark();
        self.scope.bind(Variable { opaque: true, ..Variable::new(name, ty.clone(), place.stage) });
        let before = self.multiplier;
        self.multiplier = before.saturating_mul(3);
        // Inside, nothing is known at compile time of what the state touches: shapes and lists stay out.
        let inside = Place { depth: place.depth.min(2), ..place };
        let condition = if self.source.once_in(2) {
            format!(" while {}", self.value(&Type::Bool, inside).text)
        } else {
            String::new()
        };
        let next = self.value(ty, inside);
        self.multiplier = before;
        self.scope.leave(mark);
        debug_assert!(is_numeric(ty), "only numbers are a loop's state");
        let (first, next) = (&first.text, &next.text);
        Some(Piece::atom(format!(
            "(iterate {count} from ({name} = {first}){condition}: ({name} = {next})).{name}"
        )))
    }

    /// `keys(…)`, along the time or along something else.
    pub(crate) fn keys(&mut self, ty: &Type, place: Place) -> Piece {
        let at = self.value(&Type::Float, place).text;
        let mut keys = String::new();
        let mut start = self.source.below(5) as i64 - 2;
        for _ in 0..=self.source.below(3) {
            keys += &format!(", {start}: {}", self.value(ty, place).text);
            start += 1 + self.source.below(3) as i64;
        }
        let ease =
            self.source.pick(&["", ", ease: smooth", ", ease: linear", ", ease: hold", ", ease: u => u * u"]);
        Piece::atom(format!("keys({at}{keys}{ease})"))
    }
}
