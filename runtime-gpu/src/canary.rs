//! A check for a driver that computes wrong pictures without a word.

use vol_compiler::wgsl::Space;

use crate::device::Gpu;
use crate::error::GpuError;

/// Turns of the loop asked of the driver: more than the 65 535 at which the broken one stops.
const TURNS: u32 = 70_000;

impl Gpu {
    /// False where the driver ends shader loops early.
    ///
    /// Mesa before version 23 stops each invocation of a software-rendered shader after 65 535 loop turns, all its loops counted
    /// together. A ray march then ends in mid-air, with no error.
    ///
    /// # Errors
    ///
    /// As [`Gpu::kernel`] and [`Gpu::read`].
    pub fn loop_budget_ok(&self) -> Result<bool, GpuError> {
        let source = include_str!("shaders/loop_budget.wgsl");
        let kernel = self.kernel("loop budget", source, "main", &[Space::Storage])?;
        let turns = self.upload(&[TURNS])?;
        let last = self.zeroed(1)?;
        self.dispatch(&kernel, &[&turns], &last, [1, 1, 1])?;
        Ok(self.read(&last)? == [state_after(TURNS)])
    }
}

/// The generator of `loop_budget.wgsl` after so many turns.
fn state_after(turns: u32) -> u32 {
    (0..turns).fold(0_u32, |state, _| state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223))
}

#[cfg(test)]
mod tests {
    use super::{TURNS, state_after};

    #[test]
    fn a_missing_turn_shows() {
        assert_ne!(state_after(TURNS), state_after(65_535));
        assert_ne!(state_after(TURNS), state_after(TURNS - 1));
    }
}
