//! Pieces of a curve, another one in each lane: brought to the lanes word by word, so that loops over them vectorise.

use super::LANES;
use vol_compiler::curve::Piece;

/// Defines pieces, one for each lane, as an array for each of some of their words; the other words are 0.
macro_rules! own_pieces {
    ($(#[$meta:meta])* $name:ident: $($triple:ident)*; $($number:ident)*) => {
        $(#[$meta])*
        pub(super) struct $name {
            /// Number of the piece in each lane.
            pub(super) index: [u32; LANES],
            $($triple: [[f32; LANES]; 3],)*
            $($number: [f32; LANES],)*
        }

        impl $name {
            /// All words 0.
            pub(super) fn new() -> Self {
                Self { index: [0; LANES], $($triple: [[0.0; LANES]; 3],)* $($number: [0.0; LANES],)* }
            }

            /// Gives a lane its piece.
            #[inline(always)]
            pub(super) fn set(&mut self, lane: usize, pieces: &[Piece], index: u32) {
                let piece = &pieces[index as usize];
                self.index[lane] = index;
                $(
                    let [x, y, z] = &mut self.$triple;
                    [x[lane], y[lane], z[lane]] = piece.$triple;
                )*
                $(self.$number[lane] = piece.$number;)*
            }

            /// The piece of a lane, without the words that are not here.
            #[inline(always)]
            pub(super) fn piece(&self, lane: usize) -> Piece {
                Piece {
                    $($triple: [self.$triple[0][lane], self.$triple[1][lane], self.$triple[2][lane]],)*
                    $($number: self.$number[lane],)*
                    ..Piece::ZERO
                }
            }
        }
    };
}

own_pieces! {
    /// What is read of a piece to find the foot on it.
    Solved: origin origin_low b1 b2; a3 a2 b11 vertex inv_a3 sense before after
}

own_pieces! {
    /// What is read of a piece to describe a foot on it.
    Described: origin origin_low b1 b2 tangent normal binormal bend end end_low;
    a3 a2 b11 vertex inv_a3 t_start t_span s_start sense q log_scale log_base straight before after curve_length
}
