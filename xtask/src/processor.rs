//! Processor time of the commands that a step runs.

use std::process::Child;
use std::sync::atomic::{AtomicU64, Ordering};

use anyhow::{Context, Result, ensure};

/// Ticks of the commands that ran beside those of the steps, and have ended.
static BESIDE: AtomicU64 = AtomicU64::new(0);
/// `sysconf(_SC_CLK_TCK)`, which Linux keeps at 100 for whoever reads /proc.
const TICKS_PER_S: f64 = 100.0;

/// Processor time of a command so far, of its children that have ended too; in ticks.
pub fn ticks_of(child: &Child) -> Option<u64> {
    Some(stat(&child.id().to_string(), 14).ok()?.iter().sum())
}

/// A command that ran beside those of the steps has ended.
pub fn was_beside(ticks: u64) {
    BESIDE.fetch_add(ticks, Ordering::Relaxed);
}

/// Processor time of the commands that have ended, but those beside, and of theirs, s.
pub fn time_s() -> Result<f64> {
    let all: u64 = stat("self", 16)?.iter().sum();
    Ok(all.saturating_sub(BESIDE.load(Ordering::Relaxed)) as f64 / TICKS_PER_S)
}

/// Processor time of the commands beside that have ended, s.
pub fn time_beside_s() -> Option<f64> {
    time_s().is_ok().then(|| BESIDE.load(Ordering::Relaxed) as f64 / TICKS_PER_S)
}

/// Fields of a process from number `first` (14 to 16) to 17, in ticks (proc_pid_stat(5): `utime`, `stime`, `cutime`, `cstime`).
fn stat(process: &str, first: usize) -> Result<Vec<u64>> {
    let file = format!("/proc/{process}/stat");
    let stat = std::fs::read_to_string(&file).context("processor time is read from Linux's /proc")?;
    // The program's name is in brackets, and may hold blanks; the state, which is field 3, comes after it.
    let fields = stat.rsplit_once(')').map_or("", |(_, after)| after).split_whitespace();
    let ticks: Vec<u64> = fields.skip(first - 3).take(18 - first).filter_map(|field| field.parse().ok()).collect();
    ensure!(ticks.len() == 18 - first, "{file}: {stat}");
    Ok(ticks)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::process::Command;

    use super::*;
    use crate::run::{beside, run};

    const COUNT: [&str; 2] = ["-c", "i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done"];

    /// A shell that counts to a hundred thousand takes some time, and it is counted once it has ended.
    #[test]
    fn the_time_of_a_command_is_counted() {
        let before = time_s().unwrap();
        run(Command::new("sh").args(COUNT)).unwrap();
        let taken = time_s().unwrap() - before;
        assert!(taken >= 0.01, "{taken} s");
    }

    /// The same beside the steps is counted there. The other test may have its command at the same time.
    #[test]
    fn the_time_of_a_command_beside_is_counted_by_itself() {
        beside(|| run(Command::new("sh").args(COUNT)).unwrap());
        let taken = time_beside_s().unwrap();
        assert!(taken >= 0.01, "{taken} s");
    }
}
