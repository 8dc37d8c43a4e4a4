//! Progress of long work: on a terminal, on standard error; nothing when piped.

use std::fs::File;
use std::io::Read;

use indicatif::{ProgressBar, ProgressStyle};

/// Bytes below which reading a file is over before a bar could be read.
const LONG_BYTES: u64 = 20_000_000;

/// A bar for `steps` steps of `what`. It is drawn only if standard error is a terminal.
pub fn bar(what: &'static str, steps: u64) -> ProgressBar {
    let bar = ProgressBar::new(steps).with_message(what);
    styled(bar, "{msg} [{bar:30}] {pos}/{len} {eta}")
}

/// A line that says what is being done, on a terminal.
pub fn spinner() -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    bar.enable_steady_tick(std::time::Duration::from_millis(120));
    styled(bar, "{spinner} {msg} {elapsed}")
}

/// Reads `file` under a progress bar, if it is long.
pub fn reading(file: File) -> impl Read {
    let bytes = file.metadata().map_or(0, |metadata| metadata.len());
    let bar = if bytes < LONG_BYTES {
        ProgressBar::hidden()
    } else {
        let bar = ProgressBar::new(bytes).with_message("reading");
        styled(bar, "{msg} [{bar:30}] {bytes}/{total_bytes} {eta}")
    };
    bar.wrap_read(file)
}

fn styled(bar: ProgressBar, template: &str) -> ProgressBar {
    match ProgressStyle::with_template(template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
