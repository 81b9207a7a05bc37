//! What the `vol` command is made of, without its argument parsing and its printing.
//!
//! ```text
//! path ──session──► Program ──frame──► Frame ──backend──► Image ──output──► PNG, EXR
//!                                        ├──compare──► reports of `vol diff` and of the tests
//!                                        ├──stress───► what goes wrong at awkward places
//!                                        └──profile──► what each line costs
//! ```
//!
//! Nothing in here prints or exits: a [`failure::Failure`] goes up to `main`.

pub mod backend;
pub mod bench;
pub mod compare;
pub mod explain;
pub mod failure;
pub mod output;
pub mod probe;
pub mod profile;
pub mod reflect;
pub mod session;
pub mod stress;
pub mod styles;
