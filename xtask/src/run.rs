//! Running commands: never interactive, always named when they fail.

use std::cell::Cell;
use std::env;
use std::ffi::OsStr;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use crate::processor;
use crate::report::Tests;

/// The cargo that runs this program (so that all steps use one toolchain), at the root of the workspace.
pub fn cargo<S: AsRef<OsStr>>(args: impl IntoIterator<Item = S>) -> Command {
    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(args).current_dir(root());
    if env::var_os("CI").is_some() {
        once(&mut command);
    }
    command
}

/// In CI nothing is built a second time: what a second build would take up need not be kept. Nobody debugs there either, and a
/// panic names its line by itself.
pub fn once(command: &mut Command) {
    command.env("CARGO_INCREMENTAL", "0").env("CARGO_PROFILE_DEV_DEBUG", "0");
}

/// The root of the workspace.
pub fn root() -> &'static Path {
    let xtask = Path::new(env!("CARGO_MANIFEST_DIR"));
    xtask.parent().unwrap_or(xtask)
}

thread_local! {
    /// Whether the commands of this thread run beside those of the steps.
    static BESIDE: Cell<bool> = const { Cell::new(false) };
}

/// Does `work` with its commands unseen, and with their processor time counted by itself.
pub fn beside(work: impl FnOnce()) {
    BESIDE.set(true);
    work();
    BESIDE.set(false);
}

/// Runs to the end, output passed through.
pub fn run(command: &mut Command) -> Result<()> {
    let line = announce(command);
    let mut child = command.spawn().with_context(|| line.clone())?;
    let status = wait(&mut child).with_context(|| line.clone())?;
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
        if let Some(status) = ended(&mut child)? {
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
        thread::sleep(LOOK);
    }
}

/// What a run of tests counted, and whether it succeeded.
pub type Counted = (Tests, Result<()>);

/// As [`run`], counting what the test runner in it reports. The counts hold whether it fails or not.
pub fn run_counting(command: &mut Command) -> Counted {
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

/// Two runs of tests side by side, and what both counted.
pub fn side_by_side(one: impl FnOnce() -> Counted, other: impl FnOnce() -> Counted + Send) -> Counted {
    thread::scope(|scope| {
        let other = scope.spawn(other);
        let (mut tests, result) = one();
        let Ok((more, other)) = other.join() else { return (tests, Err(anyhow::anyhow!("a runner has panicked"))) };
        tests += more;
        (tests, result.and(other))
    })
}

/// Two runs of tests one after another, the second one even if the first fails.
pub fn one_after_another(one: impl FnOnce() -> Counted, other: impl FnOnce() -> Counted) -> Counted {
    let (mut tests, result) = one();
    let (more, other) = other();
    tests += more;
    (tests, result.and(other))
}

/// The same command, which gives way to whatever else runs; as it is where there is no `nice`.
pub fn at_low_priority(command: &Command) -> Command {
    const NICE: [&str; 2] = ["-n", "19"];
    let nice = succeeds(Command::new("nice").args(NICE).arg("true"));
    let mut lower = Command::new(if nice { OsStr::new("nice") } else { command.get_program() });
    if nice {
        lower.args(NICE).arg(command.get_program());
    }
    lower.args(command.get_args());
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => lower.env(name, value),
            None => lower.env_remove(name),
        };
    }
    if let Some(folder) = command.get_current_dir() {
        lower.current_dir(folder);
    }
    lower
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

/// Between two looks at a command, which takes seconds.
const LOOK: Duration = Duration::from_millis(50);

/// Waits for the end.
fn wait(child: &mut Child) -> std::io::Result<ExitStatus> {
    if !BESIDE.get() {
        return child.wait();
    }
    loop {
        if let Some(status) = ended(child)? {
            return Ok(status);
        }
        thread::sleep(LOOK);
    }
}

/// How it has ended, if it has.
fn ended(child: &mut Child) -> std::io::Result<Option<ExitStatus>> {
    // Once it has been waited for, its time is part of that of all commands.
    let used = if BESIDE.get() { processor::ticks_of(child) } else { None };
    let status = child.try_wait()?;
    if status.is_some() {
        processor::was_beside(used.unwrap_or(0));
    }
    Ok(status)
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
    if BESIDE.get() {
        command.stdout(Stdio::null()).stderr(Stdio::null());
    } else {
        println!("$ {line}");
    }
    line
}
