//! Running commands: never interactive, always named when they fail.

use std::env;
use std::ffi::OsStr;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};

use crate::report::Tests;

/// The cargo that runs this program (so that all steps use one toolchain), at the root of the workspace.
pub fn cargo<S: AsRef<OsStr>>(args: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(args).current_dir(root());
    // In CI nothing is built a second time: what a second build would take up need not be kept.
    if env::var_os("CI").is_some() {
        command.env("CARGO_INCREMENTAL", "0");
    }
    command
}

/// The root of the workspace.
pub fn root() -> &'static Path {
    let xtask = Path::new(env!("CARGO_MANIFEST_DIR"));
    xtask.parent().unwrap_or(xtask)
}

/// Runs to the end, output passed through.
pub fn run(command: &mut Command) -> Result<()> {
    let line = announce(command);
    let status = command.status().with_context(|| line.clone())?;
    if !status.success() {
        bail!("{line}: {status}");
    }
    Ok(())
}

/// As [`run`], but ended after `limit`: for what may hang on a network.
pub fn run_within(command: &mut Command, limit: Duration) -> Result<()> {
    let line = announce(command);
    let mut child = command.spawn().with_context(|| line.clone())?;
    let end = Instant::now() + limit;
    loop {
        if let Some(status) = child.try_wait()? {
            if status.success() {
                return Ok(());
            }
            bail!("{line}: {status}");
        }
        if Instant::now() >= end {
            child.kill()?;
            child.wait()?;
            bail!("{line}: ended after {} s", limit.as_secs());
        }
        thread::sleep(Duration::from_millis(50));
    }
}

/// As [`run`], counting what the test runner in it reports. The counts hold whether it fails or not.
pub fn run_counting(command: &mut Command) -> (Tests, Result<()>) {
    let line = announce(command);
    let mut child = match command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn() {
        Ok(child) => child,
        Err(error) => return (Tests::default(), Err(error).context(line)),
    };
    let out = child.stdout.take().map(|pipe| thread::spawn(|| relay(pipe, std::io::stdout())));
    let err = child.stderr.take().map(|pipe| thread::spawn(|| relay(pipe, std::io::stderr())));
    let status = child.wait();
    let mut tests = Tests::default();
    for reader in [out, err].into_iter().flatten() {
        if let Ok(seen) = reader.join() {
            tests += seen;
        }
    }
    let result = match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(anyhow::anyhow!("{line}: {status}")),
        Err(error) => Err(error).context(line),
    };
    (tests, result)
}

/// Whether a command starts and succeeds; its output is discarded.
pub fn succeeds(command: &mut Command) -> bool {
    let quiet = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    quiet.status().is_ok_and(|status| status.success())
}

/// What a command prints, trimmed; `None` if it fails.
pub fn answer(command: &mut Command) -> Option<String> {
    let output = command.stdin(Stdio::null()).output().ok()?;
    let text = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    output.status.success().then_some(text)
}

/// Processor time of the commands that have ended, and of theirs, s (proc_pid_stat(5): `cutime` and `cstime`).
pub fn processor_time_s() -> Result<f64> {
    /// `sysconf(_SC_CLK_TCK)`, which Linux keeps at 100 for whoever reads /proc.
    const TICKS_PER_S: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").context("processor time is read from Linux's /proc")?;
    // The program's name is in brackets, and may hold blanks; the state, which is field 3, comes after it.
    let fields = stat.rsplit_once(')').map_or("", |(_, after)| after).split_whitespace();
    let ticks: Vec<f64> = fields.skip(16 - 3).take(2).filter_map(|field| field.parse().ok()).collect();
    ensure!(ticks.len() == 2, "/proc/self/stat: {stat}");
    Ok(ticks.iter().sum::<f64>() / TICKS_PER_S)
}

/// Copies line by line, but the lines of tests that passed.
fn relay(pipe: impl Read, mut to: impl Write) -> Tests {
    let mut tests = Tests::default();
    let mut pipe = BufReader::new(pipe);
    let mut line = Vec::new();
    while pipe.read_until(b'\n', &mut line).is_ok_and(|read| read > 0) {
        if tests.take(&String::from_utf8_lossy(&line)) {
            // A reader of ours that went away must not stop the tests.
            let _ = to.write_all(&line).and_then(|()| to.flush());
        }
        line.clear();
    }
    tests
}

/// Shows the command as one could type it, and cuts it off from the terminal's input.
fn announce(command: &mut Command) -> String {
    command.stdin(Stdio::null());
    let program = Path::new(command.get_program());
    let name = match program.file_stem() {
        // rustup runs cargo by the full path of a toolchain, which says nothing to the reader.
        Some(name) if name == "cargo" && !program.starts_with("/usr/bin") => "cargo".to_owned(),
        _ => program.display().to_string(),
    };
    let environment =
        command.get_envs().filter_map(|(name, value)| Some(format!("{}={}", name.display(), value?.display())));
    let args = command.get_args().map(|arg| arg.display().to_string());
    let words: Vec<String> = environment.chain([name]).chain(args).collect();
    let line = words.join(" ");
    println!("$ {line}");
    line
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    /// A shell that counts to a hundred thousand takes some time, and it is counted once it has ended.
    #[test]
    fn the_time_of_a_command_is_counted() {
        let before = processor_time_s().unwrap();
        run(Command::new("sh").args(["-c", "i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done"])).unwrap();
        let taken = processor_time_s().unwrap() - before;
        assert!(taken >= 0.01, "{taken} s");
    }
}
