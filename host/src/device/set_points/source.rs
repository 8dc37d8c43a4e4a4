//! A thread that reads lines, because reading waits: the board is looked after meanwhile.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use super::{LineError, Lines, Point};

/// Set-points that are read ahead. A pipe that is faster than the board waits.
const AHEAD: usize = 256;

/// Set-points as they are read; the channel ends with the input.
#[derive(Debug)]
pub struct Source {
    /// What it is called in messages.
    pub name: String,
    /// The set-points. An error is the last.
    pub points: Receiver<Result<Point, LineError>>,
}

/// Begins to read a file, or standard input (`-`).
///
/// # Errors
/// The file cannot be opened.
pub fn read(path: &Path, rate_hz: Option<f64>) -> io::Result<Source> {
    let standard = path.as_os_str() == "-";
    let name = if standard { "standard input".to_owned() } else { path.display().to_string() };
    let mut lines = Lines::new(&name, rate_hz);
    let (sender, points) = sync_channel(AHEAD);
    if standard {
        // Ends with the process where nobody writes any more.
        std::thread::spawn(move || pass(io::stdin().lock(), &mut lines, &sender));
    } else {
        let file = BufReader::new(File::open(path)?);
        std::thread::spawn(move || pass(file, &mut lines, &sender));
    }
    Ok(Source { name, points })
}

fn pass(mut input: impl BufRead, lines: &mut Lines, sender: &SyncSender<Result<Point, LineError>>) {
    let mut line = Vec::new();
    loop {
        line.clear();
        match input.read_until(b'\n', &mut line) {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
        let read = lines.next(&String::from_utf8_lossy(&line));
        let over = read.is_err();
        let gone = read.transpose().is_some_and(|point| sender.send(point).is_err());
        if gone || over {
            return;
        }
    }
}
