//! What memory this machine has left for a run.

use std::fs;
use std::path::Path;

/// Bytes that can still be had: what the system says is available, what the limits of control groups leave, and what the
/// process may address (`ulimit -v`). `None` where the system does not say.
pub fn available_bytes() -> Option<f64> {
    [available(), groups(), address_space()].into_iter().flatten().reduce(f64::min)
}

fn available() -> Option<f64> {
    let text = fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|l| l.strip_prefix("MemAvailable:"))?;
    Some(1024.0 * line.split_whitespace().next()?.parse::<f64>().ok()?)
}

/// The tightest of the control groups above this process, version 2 or 1.
fn groups() -> Option<f64> {
    let text = fs::read_to_string("/proc/self/cgroup").ok()?;
    let mut least = None::<f64>;
    for line in text.lines() {
        let mut parts = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(path)) = (parts.next(), parts.next()) else { continue };
        let (root, most, used) = match controllers {
            "" => ("/sys/fs/cgroup", "memory.max", "memory.current"),
            c if c.split(',').any(|c| c == "memory") => {
                ("/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes")
            }
            _ => continue,
        };
        for folder in Path::new(path.trim_start_matches('/')).ancestors() {
            let number = |file: &str| number(&Path::new(root).join(folder).join(file));
            if let (Some(most), Some(used)) = (number(most), number(used)) {
                least = Some(least.map_or(most - used, |l| l.min(most - used)));
            }
        }
    }
    least.map(|l| l.max(0.0))
}

fn number(file: &Path) -> Option<f64> {
    fs::read_to_string(file).ok()?.trim().parse().ok()
}

fn address_space() -> Option<f64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let soft = limits.lines().find_map(|l| l.strip_prefix("Max address space"))?;
    let most: f64 = soft.split_whitespace().next()?.parse().ok()?;
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let used = status.lines().find_map(|l| l.strip_prefix("VmSize:"))?;
    Some((most - 1024.0 * used.split_whitespace().next()?.parse::<f64>().ok()?).max(0.0))
}
