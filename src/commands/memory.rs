//! What a render may take of the machine's memory, and what the process has taken.

use serde::Serialize;

/// Memory in bytes; null where the platform does not tell, or no bound is known.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Memory {
    /// Most that rendering takes on the CPU: `peak` less `before` is no more.
    pub(super) bound: Option<u64>,
    /// Most that was resident before rendering, with the scene compiled.
    pub(super) before: Option<u64>,
    /// Most that was resident at the end.
    pub(super) peak: Option<u64>,
}

/// Most memory of this process that was ever resident, in bytes. Linux only.
pub(super) fn peak_resident() -> Option<u64> {
    peak_of(&std::fs::read_to_string("/proc/self/status").ok()?)
}

/// The line `VmHWM:     1234 kB`.
fn peak_of(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
}

#[cfg(test)]
mod tests {
    use super::peak_of;

    #[test]
    fn the_peak_is_read() {
        assert_eq!(peak_of("VmPeak:\t 9 kB\nVmHWM:\t    1234 kB\nVmRSS:\t 7 kB\n"), Some(1234 * 1024));
        assert_eq!(peak_of("VmRSS:\t 7 kB\n"), None);
        assert_eq!(peak_of("VmHWM: many kB\n"), None);
    }
}
