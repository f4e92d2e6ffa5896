//! How much memory a computation may take, asked before it starts: an allocation that fails ends a program without a word.
//!
//! Each module states what it needs as a formula in bytes, an upper bound that was measured; [`require`] holds it against
//! what is left.

use std::fs::read_to_string;

use crate::error::Refusal;

/// Bytes that are assumed to be available where the system does not tell.
const ASSUMED: u64 = 4 << 30;

/// Bytes that this process may still take: what the system has available, what the limit of its address space (`ulimit
/// -v`) leaves, and what its control group leaves, whichever is least; less a quarter, for other programs, the stacks and
/// heaps of threads, and vectors that grow by doubling. Linux tells; elsewhere 4 GiB are assumed.
pub fn available() -> u64 {
    let limits = [system(), address_space(), control_group()];
    limits.into_iter().flatten().min().unwrap_or(ASSUMED) / 4 * 3
}

/// Bytes that are taken without asking: to ask costs a tenth of a millisecond, as much as a small impact, and where they are
/// not left nothing else would work either.
const TRIFLE: u64 = 1 << 20;

/// Whether `bytes` can be taken.
pub fn fits(bytes: u64) -> bool {
    bytes <= TRIFLE || bytes <= available()
}

/// Refuses `value`, found at `place`, if `what` needs more than is available. `allowed` is what would do with the bytes
/// that it is given.
///
/// # Errors
/// Names the bytes needed, the bytes available, and what is allowed.
pub fn require(
    (place, value): (&str, &str),
    what: &str,
    bytes: u64,
    allowed: impl FnOnce(u64) -> String,
) -> Result<(), Refusal> {
    if fits(bytes) {
        return Ok(());
    }
    let available = available();
    let value =
        format!("{value}, whose {what} need {bytes} bytes of memory where {available} are available,");
    Err(Refusal::new(place, value, allowed(available)))
}

/// The number after `key` in a file of lines `key: number kB`.
fn field(text: &str, key: &str) -> Option<u64> {
    let rest = text.lines().find_map(|line| line.strip_prefix(key))?;
    rest.split_whitespace().next()?.parse().ok()
}

fn system() -> Option<u64> {
    field(&read_to_string("/proc/meminfo").ok()?, "MemAvailable:").map(|kilobytes| kilobytes << 10)
}

/// What the soft limit of the address space leaves; `None` where it is unlimited.
fn address_space() -> Option<u64> {
    let limit = field(&read_to_string("/proc/self/limits").ok()?, "Max address space")?;
    let used = field(&read_to_string("/proc/self/status").ok()?, "VmSize:")? << 10;
    Some(limit.saturating_sub(used))
}

/// What the control group leaves, as a container sees it; `None` where it is unlimited.
fn control_group() -> Option<u64> {
    let number = |path: &str| read_to_string(path).ok()?.trim().parse::<u64>().ok();
    let left = |limit: &str, used: &str| Some(number(limit)?.saturating_sub(number(used)?));
    let (unified, old) = ("/sys/fs/cgroup/memory", "/sys/fs/cgroup/memory/memory");
    left(&format!("{unified}.max"), &format!("{unified}.current"))
        .or_else(|| left(&format!("{old}.limit_in_bytes"), &format!("{old}.usage_in_bytes")))
}

/// Asks the system to hold `entries`, just allocated and not yet written, in pages of megabytes: what streams through
/// millions of them stops at every page. A hint; nothing but Linux is asked.
#[allow(unsafe_code)]
pub(crate) fn prefer_large_pages<T>(entries: &[T]) {
    #[cfg(target_os = "linux")]
    {
        const LARGE: usize = 2 << 20;
        let range = entries.as_ptr_range();
        let (start, end) = (range.start.addr().next_multiple_of(LARGE), range.end.addr());
        if end > start + LARGE {
            // SAFETY: whole pages of this allocation, whose contents the advice leaves as they are.
            unsafe {
                libc::madvise(
                    range.start.with_addr(start).cast_mut().cast(),
                    (end - start) / LARGE * LARGE,
                    libc::MADV_HUGEPAGE,
                )
            };
        }
    }
    #[cfg(not(target_os = "linux"))]
    let _ = entries;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_system_are_read() {
        let text =
            "Max cpu time  unlimited  unlimited  seconds\nMax address space  8192000000  unlimited  bytes\n";
        assert_eq!(field(text, "Max address space"), Some(8_192_000_000));
        assert_eq!(field("Max address space  unlimited  unlimited  bytes", "Max address space"), None);
        assert_eq!(field("MemTotal: 9 kB\nMemAvailable:   23 kB\n", "MemAvailable:"), Some(23));
    }

    #[test]
    fn too_much_is_refused_with_its_bytes() {
        assert!(require(("here", "1"), "rows", 1, |_| String::new()).is_ok());
        let refusal = require(("here", "9"), "rows", u64::MAX, |left| format!("{}", left > 0)).unwrap_err();
        assert!(
            refusal.value.contains("18446744073709551615 bytes") && refusal.allowed == "true",
            "{refusal}"
        );
    }
}
