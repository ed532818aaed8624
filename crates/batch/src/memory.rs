//! How much memory workers take and how much there is, where the system tells (Linux).

/// What a worker is taken to need before any has ended, in bytes.
const GUESS: u64 = 2 << 30;

/// Memory that may be had without swapping, in bytes.
pub fn available() -> Option<u64> {
    field(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// What a process holds and the most that it has held, in bytes.
pub fn of_process(id: u32) -> Option<(u64, u64)> {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    Some((field(&status, "VmRSS:")?, field(&status, "VmHWM:")?))
}

fn field(text: &str, name: &str) -> Option<u64> {
    let value = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(value.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

/// Whether one more worker may begin: it and those that run shall have room if each takes as much as the greatest
/// that was seen, `peak`. `held` is what those that run hold now, `limit` what all together may take at most. One
/// worker may always run.
pub fn has_room(
    running: usize,
    peak: Option<u64>,
    held: u64,
    available: Option<u64>,
    limit: Option<u64>,
) -> bool {
    let bound = match (limit, available) {
        (limit, Some(available)) => limit.unwrap_or(u64::MAX).min(available.saturating_add(held)),
        (Some(limit), None) => limit,
        (None, None) => return true,
    };
    running == 0 || (running as u64 + 1).saturating_mul(peak.unwrap_or(GUESS)) <= bound
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Protects the machine: a worker begins only where it has room, and one always may.
    #[test]
    fn workers_wait_for_room() {
        let gb = |n: u64| n << 30;
        assert!(has_room(0, Some(gb(9)), 0, Some(gb(1)), Some(gb(1))));
        // Two of 3 GB: 2 GB are held and 4 are free.
        assert!(has_room(1, Some(gb(3)), gb(2), Some(gb(4)), None));
        assert!(!has_room(1, Some(gb(3)), gb(2), Some(gb(3)), None));
        assert!(!has_room(1, Some(gb(3)), gb(2), Some(gb(40)), Some(gb(5))));
        assert!(has_room(1, Some(gb(3)), gb(2), None, Some(gb(6))));
        // Before the first has ended.
        assert!(has_room(1, None, 0, Some(gb(4)), None) && !has_room(2, None, 0, Some(gb(4)), None));
        assert!(has_room(7, Some(gb(3)), 0, None, None));
    }

    /// Protects the reading of the system's files.
    #[test]
    fn lines_of_the_system_are_read() {
        let text = "Name:\tx\nVmHWM:\t    1234 kB\nVmRSS:\t 1000 kB\n";
        assert_eq!((field(text, "VmHWM:"), field(text, "VmRSS:")), (Some(1234 << 10), Some(1000 << 10)));
        assert_eq!(field(text, "VmSwap:"), None);
        #[cfg(target_os = "linux")]
        assert!(
            available().is_some() && of_process(std::process::id()).is_some_and(|(now, peak)| now <= peak)
        );
    }
}
