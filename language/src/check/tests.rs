//! Tests of the checker: sources in, the typed tree as text or the diagnostics out.

mod blocks;
mod calls;
mod conversions;
mod functions;
mod items;
mod limits;
mod loops;
mod operators;
mod support;
mod values;
