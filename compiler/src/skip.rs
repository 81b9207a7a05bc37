//! What is left out of the work because it cannot change the picture.
//!
//! Every way of leaving work out has a name here and can be switched off (`--no-skip NAME`), so that a test
//! can show that the picture stays the same. A [`Program`](crate::program::Program) carries the set that it was
//! compiled with, and hands it to each of its frames.

/// A way of leaving work out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Skip {
    /// The region of a medium is not asked far from the boxes along its tubes.
    Cells,
    /// Closest points are not looked for in parts of the curve that are farther than what was found.
    CurveBoxes,
    /// A ray ends where less than 2^-16 of the light arrives.
    Opaque,
    /// A frame that equals the one before is not rendered again.
    SameFrames,
    /// A light's grid that was filled for an earlier frame is not filled again.
    SameGrids,
    /// Decisions that always fall the same way are taken out of functions.
    Ranges,
    /// Of solids only those are asked whose boxes a ray meets, found by a tree.
    Objects,
    /// In parts of space what cannot win there is left out of functions.
    Tapes,
    /// Of a union of many solids only the parts are asked whose boxes a ray meets.
    Parts,
    /// A sample stands for several steps where only smooth media are.
    Spacings,
}

/// A name, and what is left out under it.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Which one.
    pub skip: Skip,
    /// As on the command line.
    pub name: &'static str,
    /// One sentence for people, with the bound on what it changes.
    pub about: &'static str,
}

/// All of them.
pub const TABLE: &[Row] = &[
    Row {
        skip: Skip::Cells,
        name: "cells",
        about: "regions of media are not evaluated far from the boxes along their tubes; changes nothing",
    },
    Row {
        skip: Skip::CurveBoxes,
        name: "curve-boxes",
        about: "pieces of long curves are passed over that are farther than one already found; changes nothing",
    },
    Row {
        skip: Skip::Opaque,
        name: "opaque",
        about: "rays end where media let less than 2^-16 through; changes a pixel by at most that part of what lies behind",
    },
    Row {
        skip: Skip::SameFrames,
        name: "same-frames",
        about: "a frame of an animation that equals the one before is written again, not rendered; changes nothing",
    },
    Row {
        skip: Skip::SameGrids,
        name: "same-grids",
        about: "grids of lights are kept from frame to frame as long as lights and media stay; changes nothing",
    },
    Row {
        skip: Skip::Ranges,
        name: "ranges",
        about: "extremes and branches are left out of which bounds on the numbers show one side alone; changes nothing",
    },
    Row {
        skip: Skip::Objects,
        name: "objects",
        about: "solids are found by a tree over their boxes, and others not looked at; changes nothing",
    },
    Row {
        skip: Skip::Tapes,
        name: "tapes",
        about: "functions are shortened for small parts of space, by what cannot win there; changes nothing",
    },
    Row {
        skip: Skip::Parts,
        name: "parts",
        about: "unions of 16 solids and more are marched as solids of their own; moves where a ray meets one by less than a fortieth of a pixel",
    },
    Row {
        skip: Skip::Spacings,
        name: "spacings",
        about: "where only smooth media are a sample stands for several steps; changes a picture by less than 0.4 of the error asked for",
    },
];

/// A set of ways of leaving work out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skips(u32);

impl Skips {
    /// Every one: what pictures are made with.
    pub const ALL: Self = Self(u32::MAX);
    /// None: everything is computed.
    pub const NONE: Self = Self(0);

    /// The same without one.
    #[must_use]
    pub const fn without(self, skip: Skip) -> Self {
        Self(self.0 & !(1 << skip as u32))
    }

    /// Whether work may be left out in this way.
    #[must_use]
    pub const fn has(self, skip: Skip) -> bool {
        self.0 & (1 << skip as u32) != 0
    }

    /// One bit for each way, by its number.
    #[must_use]
    pub(crate) const fn bits(self) -> u32 {
        self.0
    }
}

impl Default for Skips {
    fn default() -> Self {
        Self::ALL
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_in_order_and_names_differ() {
        for (index, row) in TABLE.iter().enumerate() {
            assert_eq!(row.skip as usize, index);
            assert!(TABLE[..index].iter().all(|other| other.name != row.name), "{}", row.name);
        }
        assert!(TABLE.len() <= 32);
    }

    #[test]
    fn one_is_switched_off_at_a_time() {
        for row in TABLE {
            let skips = Skips::ALL.without(row.skip);
            assert!(TABLE.iter().all(|other| skips.has(other.skip) == (other.skip != row.skip)));
            assert!(!Skips::NONE.has(row.skip));
        }
    }
}
