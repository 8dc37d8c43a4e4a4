//! Samples to a recording, safe at every moment.
//!
//! While it grows it is `FILE.part`, a valid recording after every batch. [`Capture::finish`] puts the header with
//! the gaps in front and moves it to `FILE` in one step. What ends the capture (Ctrl-C, unplugging, even a kill) does
//! not cost what was received before.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Read as _, Write};
use std::path::{Path, PathBuf};

use breakaway_core::link::{Batch, Info};

use super::DeviceError;
use super::scale::{Scale, amperes};
use super::stream::{Row, Stream, Totals};
use crate::file::write_whole;
use crate::recording::{CURRENT, Container};

/// Gaps that the header lists one by one; a link worse than that is of no use.
const MOST_GAPS: usize = 100_000;

/// A recording being made.
#[derive(Debug)]
pub struct Capture {
    path: PathBuf,
    part: PathBuf,
    out: BufWriter<File>,
    scale: Scale,
    decimation: u16,
    provenance: Vec<String>,
    /// The board measures the motor's current.
    measures_current: bool,
    /// Rows before which samples are missing, and how many.
    gaps: Vec<(u64, u64)>,
    stream: Stream,
    rows: Vec<Row>,
    first_tick: Option<u64>,
    last_tick: u64,
    /// Ticks from the first sample to the last one wanted.
    most_ticks: Option<u64>,
}

/// Where the samples are while they come.
pub fn part_of(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".part");
    name.into()
}

impl Capture {
    /// Begins a recording that will become `path`, of at most `seconds` if given.
    ///
    /// # Errors
    /// The folder cannot be written, or an earlier capture was cut off and its part still lies there.
    pub fn create(
        path: &Path,
        info: &Info,
        scale: Scale,
        decimation: u16,
        seconds: Option<f64>,
    ) -> Result<Self, DeviceError> {
        let most_ticks = seconds.map(|seconds| scale.ticks("--seconds", seconds)).transpose()?.map(u64::from);
        let part = part_of(path);
        let failed = |source: io::Error| {
            if source.kind() == io::ErrorKind::AlreadyExists {
                let what = "an earlier capture was cut off here; it is a valid recording: rename it, or delete it";
                return DeviceError::Write { file: part.display().to_string(), reason: io::Error::other(what) };
            }
            DeviceError::Write { file: part.display().to_string(), reason: source }
        };
        if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
            let source = io::Error::other("is not an ordinary file");
            return Err(DeviceError::Write { file: path.display().to_string(), reason: source });
        }
        let file = OpenOptions::new().write(true).create_new(true).open(&part).map_err(failed)?;
        let mut capture = Self {
            path: path.to_owned(),
            out: BufWriter::with_capacity(1 << 16, file),
            scale,
            decimation,
            provenance: provenance(info),
            measures_current: info.current_range_ma > 0,
            gaps: Vec::new(),
            stream: Stream::default(),
            rows: Vec::new(),
            first_tick: None,
            last_tick: 0,
            most_ticks,
            part,
        };
        let header = capture.header("cut off: the program was killed before the end");
        capture.out.write_all(header.as_bytes()).and_then(|()| capture.out.flush()).map_err(|e| capture.failed(e))?;
        Ok(capture)
    }

    /// Takes a batch; afterwards it is in the file. Whether more is wanted.
    ///
    /// # Errors
    /// The disk is full or gone; [`DeviceError::Restarted`].
    pub fn push(&mut self, batch: &Batch, port: &str) -> Result<bool, DeviceError> {
        let taken = self.stream.take(batch, &mut self.rows);
        let first = self.stream.totals.samples - self.rows.len() as u64;
        let mut text = String::new();
        let mut more = true;
        for (i, row) in self.rows.drain(..).enumerate() {
            let passed = row.tick - self.first_tick.unwrap_or(row.tick);
            if self.most_ticks.is_some_and(|most| passed >= most) {
                // This one and those after it are past the end: as if they had not come.
                let totals = &mut self.stream.totals;
                totals.missing -= row.missing;
                totals.gaps -= u64::from(row.missing > 0);
                totals.samples = first + i as u64;
                more = false;
                break;
            }
            if row.missing > 0 && self.gaps.len() < MOST_GAPS {
                self.gaps.push((first + i as u64, row.missing));
            }
            self.first_tick.get_or_insert(row.tick);
            self.last_tick = row.tick;
            write_row(&mut text, &row, &self.scale, self.measures_current);
        }
        self.out.write_all(text.as_bytes()).and_then(|()| self.out.flush()).map_err(|e| self.failed(e))?;
        taken.map(|()| more).map_err(|_| DeviceError::Restarted { port: port.to_owned() })
    }

    /// What has come so far.
    pub const fn totals(&self) -> Totals {
        self.stream.totals
    }

    /// Time from the first sample to the last, s.
    pub fn seconds(&self) -> f64 {
        self.first_tick.map_or(0.0, |first| self.scale.time(self.last_tick - first))
    }

    /// Closes the recording: the header in front, the file in its place. Whether there was anything to keep.
    ///
    /// # Errors
    /// The file cannot be written; the samples are then still in the part.
    pub fn finish(mut self, ended: &str) -> Result<bool, DeviceError> {
        self.out.flush().map_err(|e| self.failed(e))?;
        if self.stream.totals.samples == 0 {
            fs::remove_file(&self.part).map_err(|e| self.failed(e))?;
            return Ok(false);
        }
        let header = self.header(ended);
        write_whole(&self.path, |mut out| {
            let mut part = io::BufReader::new(File::open(&self.part)?);
            skip_header(&mut part, self.columns())?;
            Container::of(&self.path).write(header.as_bytes().chain(part), &mut out)
        })
        .map_err(|source| DeviceError::Write { file: self.path.display().to_string(), reason: source })?;
        // The recording is safe; a part that does not go is only in the way of the next one, which says so.
        let _ = fs::remove_file(&self.part);
        Ok(true)
    }

    fn failed(&self, source: io::Error) -> DeviceError {
        DeviceError::Write { file: self.part.display().to_string(), reason: source }
    }

    /// The comment lines and the header row.
    fn header(&self, ended: &str) -> String {
        let tick_s = self.scale.tick_s() * f64::from(self.decimation);
        let current = if self.measures_current { format!(", {CURRENT}=A") } else { String::new() };
        let mut lines = vec![
            format!("tick: {tick_s:?} s"),
            format!("units: u={u}, x={x}, r={x}{current}", u = self.scale.units.u, x = self.scale.units.x),
            format!("encoder step: {:?} {}", self.scale.step, self.scale.units.x),
        ];
        if !self.gaps.is_empty() {
            let rows: Vec<String> = self.gaps.iter().map(|(row, _)| row.to_string()).collect();
            let missing: Vec<String> = self.gaps.iter().map(|(_, missing)| missing.to_string()).collect();
            lines.push(format!("gaps: {}", rows.join(", ")));
            lines.push(format!("samples missing at gaps: {}", missing.join(", ")));
        }
        let Totals { samples, missing, dropped, lost_batches, .. } = self.stream.totals;
        if samples > 0 {
            lines.push(format!(
                "samples: {samples}, missing {missing} (dropped on the board {dropped}, lost frames {lost_batches})"
            ));
        }
        if self.decimation > 1 {
            lines.push(format!(
                "decimation: {} (the drive between two rows is not recorded; do not identify from a relay run)",
                self.decimation
            ));
        }
        lines.extend(self.provenance.iter().cloned());
        lines.push(format!("ended: {ended}"));
        let mut text = String::new();
        for line in lines {
            text.push_str("# ");
            text.push_str(&line.replace(char::is_control, " "));
            text.push('\n');
        }
        text.push_str(self.columns());
        text
    }

    const fn columns(&self) -> &'static str {
        if self.measures_current { COLUMNS_WITH_CURRENT } else { COLUMNS }
    }
}

const COLUMNS: &str = "t,u,x,r,mode\n";
const COLUMNS_WITH_CURRENT: &str = "t,u,x,r,mode,i_A\n";

/// Where a recording comes from, as header lines.
pub fn provenance(info: &Info) -> Vec<String> {
    vec![
        format!("board: {}", info.board),
        format!("firmware: {}", info.firmware),
        format!("firmware build: {}", info.build),
        format!("control tick: {} Hz", info.tick_hz),
    ]
}

/// One row. A current that is missing from a board that measures it is an empty field, not one from before.
fn write_row(text: &mut String, row: &Row, scale: &Scale, measures_current: bool) {
    use std::fmt::Write as _;
    if row.missing > 0 {
        let _ = writeln!(text, "# gap: {} samples are missing here", row.missing);
    }
    let (t, u) = (scale.time(row.tick), scale.drive(row.drive_code.into()));
    let (x, r) = (scale.position(row.count), scale.position(row.reference));
    let _ = write!(text, "{t:?},{u:?},{x:?},{r:?},{}", row.mode.name());
    if measures_current {
        text.push(',');
        if let Some(current_ma) = row.current_ma {
            let _ = write!(text, "{:?}", amperes(current_ma));
        }
    }
    text.push('\n');
}

/// Reads up to and including the header row.
fn skip_header(part: &mut impl io::BufRead, columns: &str) -> io::Result<()> {
    let mut line = Vec::new();
    while line != columns.as_bytes() {
        line.clear();
        if part.read_until(b'\n', &mut line)? == 0 {
            return Err(io::Error::other("its header is gone"));
        }
    }
    Ok(())
}
