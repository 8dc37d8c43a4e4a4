//! `cargo xtask fleet-test`: `fleet/fleet.py` on a scheduler and two workers of this computer, one of which is killed.
//!
//! It needs Python and PyPI, and is therefore no part of `cargo xtask test`.

mod machines;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};

use crate::cross::target_folder;
use crate::environment::environment;
use crate::python;
use crate::run::{answer, root, run_within};

/// Everything together takes half a minute; what takes ten has hung.
const LIMIT: Duration = Duration::from_secs(600);

/// A process that ends with this program, whatever becomes of it.
struct Running(Child);

impl Running {
    fn start(command: &mut Command) -> Result<Self> {
        println!("$ {command:?}");
        let child = command.stdin(Stdio::null()).spawn().with_context(|| format!("{command:?}"))?;
        Ok(Self(child))
    }

    /// SIGKILL: it has no chance to say good-bye.
    fn kill(&mut self) -> Result<()> {
        self.0.kill()?;
        self.0.wait()?;
        Ok(())
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.kill();
    }
}

/// A row of the Parquet file.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Row {
    verdict: String,
    effects: String,
    worker: String,
    skipped: bool,
    reason: String,
}

/// Runs it all.
pub fn test() -> Result<()> {
    let began = Instant::now();
    let folder = target_folder().join("fleet-test");
    let python = environment(&target_folder().join("fleet-venv"), &root().join("fleet/requirements.txt"))?;
    python::install(&python, &python::wheel(&python::environments()?)?)?;
    let breakaway = target_folder().join("debug").join(format!("breakaway{}", std::env::consts::EXE_SUFFIX));
    if folder.exists() {
        fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    }
    fs::create_dir_all(&folder)?;
    let names = machines::make(&folder, &breakaway)?;

    let file = folder.join("scheduler.json");
    let dask = |what: &str| {
        let mut command = Command::new(&python);
        command.args(["-m", "dask", what, "--host", "127.0.0.1", "--no-dashboard", "--scheduler-file"]).arg(&file);
        command
    };
    let _scheduler = Running::start(dask("scheduler").args(["--port", "0"]))?;
    let worker = |name: &str| {
        let own = folder.join(name);
        Running::start(
            dask("worker").args(["--nthreads", "1", "--no-nanny", "--name", name, "--local-directory"]).arg(own),
        )
    };
    let mut one = worker("one")?;
    let _two = worker("two")?;

    let out = folder.join("out");
    let fleet = || {
        let mut command = Command::new(&python);
        command.arg(root().join("fleet/fleet.py")).arg(folder.join("machines")).arg("-o").arg(&out);
        command.arg("--scheduler-file").arg(&file);
        command
    };
    let mut first = Running::start(&mut fleet())?;
    // In its second machine: it has given one away, and holds one that nobody else has.
    let mut begun = BTreeSet::new();
    let cut = until("worker one has a second machine", &mut first, || {
        let machine = worked_on(&out, "one")?;
        begun.insert(machine.clone());
        (begun.len() >= 2).then_some(machine)
    })?;
    one.kill()?;
    println!("worker one was killed while it worked on {cut}");
    ended(&mut first)?;
    let rows = parquet(&python, &out)?;
    check(&rows, &names, &cut)?;

    // Again: nothing is worked out twice.
    run_within(&mut fleet(), LIMIT)?;
    let again = parquet(&python, &out)?;
    for (name, row) in &rows {
        let other = &again[name];
        ensure!(other.skipped == row.reason.is_empty(), "{name} again: {other:?}");
        ensure!((&other.verdict, &other.effects) == (&row.verdict, &row.effects), "{name}: {row:?}, again: {other:?}");
    }
    println!(
        "fleet-test: {} machines, one worker of two killed over {cut}, which worker two finished; none lost, \
         none done again: {:.1} s",
        rows.len(),
        began.elapsed().as_secs_f64()
    );
    Ok(())
}

/// What `look` finds before the process ends.
fn until<T>(what: &str, process: &mut Running, mut look: impl FnMut() -> Option<T>) -> Result<T> {
    let end = Instant::now() + LIMIT;
    loop {
        if let Some(found) = look() {
            return Ok(found);
        }
        if let Some(status) = process.0.try_wait()? {
            bail!("waiting until {what}, but fleet.py ended: {status}");
        }
        ensure!(Instant::now() < end, "waited {} s until {what}", LIMIT.as_secs());
        sleep(Duration::from_millis(20));
    }
}

/// Waits for a process that must succeed.
fn ended(process: &mut Running) -> Result<()> {
    let end = Instant::now() + LIMIT;
    let status = loop {
        match process.0.try_wait()? {
            Some(status) => break status,
            None => ensure!(Instant::now() < end, "fleet.py: ended after {} s", LIMIT.as_secs()),
        }
        sleep(Duration::from_millis(50));
    };
    ensure!(status.success(), "fleet.py: {status}");
    Ok(())
}

/// A machine that `worker` has begun and not finished.
fn worked_on(out: &Path, worker: &str) -> Option<String> {
    let places = fs::read_dir(out).ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let open = |place: &PathBuf| !place.join("result.json").exists() && !place.ends_with(machines::BROKEN);
    places.filter(open).find_map(|place| {
        let started = fs::read_to_string(place.join("started.json")).ok()?;
        let own = started.contains(&format!("\"worker\": \"{worker}\""));
        own.then(|| place.file_name().unwrap_or_default().to_string_lossy().into_owned())
    })
}

/// The rows of the Parquet file, read by pyarrow.
fn parquet(python: &Path, out: &Path) -> Result<BTreeMap<String, Row>> {
    const READ: &str = "import sys, pyarrow.parquet as pq\n\
                        for row in pq.read_table(sys.argv[1]).to_pylist():\n    \
                        print(row['machine'], row['verdict'] or '', '+'.join(row['effects'] or []), row['worker'] or '', \
                        row['skipped'], (row['reason'] or '').split('\\n')[0], sep='\\t')";
    let text = answer(Command::new(python).args(["-c", READ]).arg(out.join("fleet.parquet")))
        .context("fleet.parquet cannot be read")?;
    let mut rows = BTreeMap::new();
    for line in text.lines() {
        // The last field may be empty, and the answer is trimmed.
        let mut cells = line.split('\t').map(str::to_owned);
        let mut cell = || cells.next().unwrap_or_default();
        let name = cell();
        let (verdict, effects, worker, skipped) = (cell(), cell(), cell(), cell() == "True");
        let row = Row { verdict, effects, worker, skipped, reason: cell() };
        ensure!(rows.insert(name, row).is_none(), "a machine has two rows: {line}");
    }
    Ok(rows)
}

/// Every machine is there, with what was hidden in it; the one that was cut off was finished by the other worker.
fn check(rows: &BTreeMap<String, Row>, names: &[String], cut: &str) -> Result<()> {
    ensure!(rows.keys().eq(names), "machines {names:?}, rows {:?}", rows.keys());
    for (name, row) in rows {
        println!("  {name}: {row:?}");
        let right = match name.as_str() {
            machines::BROKEN => row.reason.contains("nonsense.csv"),
            machines::FREE => row.reason.is_empty() && row.effects.is_empty(),
            _ => row.reason.is_empty() && row.effects == "constant_load",
        };
        ensure!(right, "{name}: {row:?}");
    }
    ensure!(rows[cut].worker == "two", "{cut} was cut off: {:?}", rows[cut]);
    Ok(())
}
