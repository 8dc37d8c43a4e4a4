//! Progress of long work: on a terminal, on standard error; nothing when piped.

use std::io::Read;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::console;
use crate::discover::progress::Progress;
use crate::recording::Source;

/// Bytes below which reading a file is over before a bar could be read.
const LONG_BYTES: u64 = 20_000_000;

/// A bar for `steps` steps of `what`. It is drawn only if standard error is a terminal.
pub fn bar(what: &'static str, steps: u64) -> ProgressBar {
    if !console::draws_progress() {
        console::detail(format_args!("{what}: {steps}"));
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(steps).with_message(what);
    styled(bar, "{msg} [{bar:30}] {pos}/{len} {eta}")
}

/// A line that says what is being done, on a terminal.
pub fn spinner() -> ProgressBar {
    if !console::draws_progress() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner();
    bar.enable_steady_tick(Duration::from_millis(120));
    styled(bar, WITHOUT_COUNT)
}

const WITHOUT_COUNT: &str = "{spinner} {msg} {elapsed}";
const WITH_COUNT: &str = "{spinner} {msg} [{bar:24}] {pos}/{len}, {eta} left";

/// The steps of a discovery. A terminal shows a spinner, and a bar with the time that is left while candidates are
/// compared. With `-v` the steps are lines.
#[derive(Debug)]
pub struct Steps {
    spinner: ProgressBar,
    began: Instant,
}

impl Steps {
    /// Begins; nothing is shown before the first step.
    pub fn begin() -> Self {
        Self { spinner: spinner(), began: Instant::now() }
    }

    /// Shows what is being done.
    pub fn show(&self, progress: Progress<'_>) {
        match progress {
            Progress::Step(what) => self.step(what, WITHOUT_COUNT),
            Progress::Round { effect, candidates } => {
                self.spinner.set_position(0);
                self.spinner.set_length(candidates as u64);
                self.spinner.reset_eta();
                self.step(&format!("looking for effect {effect} among {candidates}"), WITH_COUNT);
            }
            Progress::Compared => self.spinner.inc(1),
        }
    }

    fn step(&self, what: &str, template: &str) {
        console::detail(format_args!("{:6.1} s  {what}", self.began.elapsed().as_secs_f64()));
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.spinner.set_style(style);
        }
        self.spinner.set_message(what.to_owned());
    }

    /// Ends; the spinner goes.
    pub fn end(self) {
        self.spinner.finish_and_clear();
    }
}

/// Reads `source` under a progress bar, if it is long.
pub fn reading(source: Source) -> impl Read {
    let bytes = source.length();
    let bar = if bytes < LONG_BYTES || !console::draws_progress() {
        ProgressBar::hidden()
    } else {
        let bar = ProgressBar::new(bytes).with_message("reading");
        styled(bar, "{msg} [{bar:30}] {bytes}/{total_bytes} {eta}")
    };
    bar.wrap_read(source)
}

fn styled(bar: ProgressBar, template: &str) -> ProgressBar {
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
