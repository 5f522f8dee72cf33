//! The most memory that this process has used.

/// Bytes that were resident at once since it started; `None` where only Linux could tell.
pub(super) fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim_end().parse().ok()?;
    Some(kibibytes * 1024)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn what_was_used_once_stays_the_peak() {
        const BYTES: usize = 64 << 20;
        let before = peak_bytes().expect("Linux tells");
        let used = std::hint::black_box(vec![1_u8; BYTES]);
        drop(used);
        assert!(peak_bytes().expect("Linux tells") >= before.max(BYTES as u64));
    }
}
