//! Imports: what is found, and every way in which they go wrong.
