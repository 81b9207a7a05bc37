//! Each rule on a text before and after.
