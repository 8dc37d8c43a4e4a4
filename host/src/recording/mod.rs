//! Recordings: time, applied drive and measured position.
//!
//! A file is CSV: `# key: value` lines (tick, units, encoder step, gaps, and provenance), a header row, and a row per sample.
//! Logs in other formats are known by their first bytes ([`formats`]).
//! [`ReadOptions`] maps a stranger's columns; [`RecordingError`] names what is wrong with file, line and column.

mod angle;
pub(crate) mod between;
mod clock;
mod container;
mod error;
mod field;
pub mod formats;
mod header;
mod held;
mod limits;
mod lines;
mod log_table;
mod mend;
mod options;
mod outliers;
mod quality;
mod quantisation;
mod refreshed;
mod rows;
mod session_clock;
mod signal;
mod source;
mod table;
mod timing;
mod units;
mod wrap;
mod write;

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

pub use clock::TimeUnit;
pub use container::Container;
pub use error::{ClockError, ListError, LogError, Place, RecordingError, SessionError};
pub use formats::Format;
pub use held::Held;
pub use limits::{MAX_COLUMNS, MAX_ROW_BYTES, MAX_ROWS};
pub use lines::Lines;
pub use options::{ReadOptions, Selection};
pub use quality::Warning;
pub use session_clock::{in_session_order, share_a_clock};
pub use signal::Signal;
pub use source::Source;
pub use timing::{EVEN_WITHIN, GAP_FACTOR, Timing};
pub use units::Units;
pub use wrap::Wrap;

use table::{Table, Wanted};

use crate::file::shown;

/// Fewest rows of a file that are worth reading: twice the four unknowns of a sine fit.
pub const MIN_ROWS: usize = 8;

/// The motor's current in A, as a column of a recording; its unit in the header's `units` line says that it is one.
pub const CURRENT: &str = "i_A";

/// One recording of an axis, evenly sampled or not.
///
/// `u[k]` is the drive applied from `t[k]` to `t[k + 1]` (zero-order hold); `x[k]` is the position read at `t[k]`.
/// The three have the same length ≥ 2 and `t` increases strictly.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    /// What to call it in reports: the file's name or the experiment's.
    pub name: String,
    /// Time, s. It need not begin at zero: recordings of one session may share a time axis.
    pub t: Vec<f64>,
    /// Applied drive, in `units.u`.
    pub u: Vec<f64>,
    /// Measured position, in `units.x`.
    pub x: Vec<f64>,
    /// Motor current read at each `t[k]`, A, where it was measured; else empty.
    pub current: Vec<f64>,
    /// Encoder step in position units, where it is known.
    pub encoder_step: Option<f64>,
    /// Units of drive and position, for reports.
    pub units: Units,
    /// Position units per turn of the axis, where the position is in counts and it is known.
    pub counts_per_turn: Option<f64>,
    /// Where it comes from: `experiment`, `firmware build`, `seed` and the like.
    pub meta: BTreeMap<String, String>,
    /// Indices, increasing, at which a new piece begins because samples before it are missing.
    pub gaps: Vec<usize>,
    /// Interval at which the sensor was read, s, where rows that repeated a reading were merged
    /// ([`Recording::refreshed`]). The position of a row is older than its stamp by an unknown part of it.
    pub read_every_s: Option<f64>,
    /// Interval of the rows in which those readings were seen, s.
    pub seen_every_s: Option<f64>,
    /// What the reader found in the file and mended; [`Recording::warnings`] has it too.
    pub found: Vec<Warning>,
}

impl Recording {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// [`RecordingError`], with file, line, column and what to do.
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Self, RecordingError> {
        Self::read_from(&shown(path), Source::open(path)?, options)
    }

    /// Reads from `input`; `file` is its name in messages. Only the three columns are kept in memory, and the current where there
    /// is one.
    ///
    /// A recording whose position does not move is read: [`Recording::moves`] tells.
    ///
    /// # Errors
    /// [`RecordingError`], with file, line, column and what to do.
    pub fn read_from(file: &str, input: impl Read, options: &ReadOptions) -> Result<Self, RecordingError> {
        Self::of_table(file, Table::read(file, input, options, &wanted(options))?, options)
    }

    /// Takes a recording from a log whose channels were read already; `file` is its name in messages.
    ///
    /// # Errors
    /// [`RecordingError`], as of [`Recording::read_from`].
    pub fn from_log(file: &str, log: &formats::Log, options: &ReadOptions) -> Result<Self, RecordingError> {
        Self::of_table(file, Table::of_log(file, log, options, &wanted(options))?, options)
    }

    fn of_table(file: &str, mut table: Table, options: &ReadOptions) -> Result<Self, RecordingError> {
        table.check(file)?;
        let unknown = Units::default();
        let unit_of = |name| units::of_column(name, &table.header).map(|unit| field::shown(&unit));
        let units = Units {
            u: unit_of(options.input_column()).unwrap_or(unknown.u),
            x: unit_of(options.position_column()).unwrap_or(unknown.x),
        };
        let milliamperes = options.current.as_deref().and_then(unit_of).is_some_and(|unit| unit == "mA");
        table.warn_of_drive(0);
        table.clean_position(file, (1, options.position_column()), &units.x, options.wrap)?;
        let too_short = table.too_short(file);
        let mut columns = std::mem::take(&mut table.columns).into_iter();
        let [u, x, mut current] = std::array::from_fn(|_| columns.next().unwrap_or_default());
        if milliamperes {
            for i in &mut current {
                *i *= 1e-3;
            }
        }
        if x.len() < MIN_ROWS {
            return Err(too_short);
        }
        let mut recording = Self {
            name: file_stem(file),
            encoder_step: options.encoder_step.or(table.header.encoder_step),
            units,
            counts_per_turn: options.counts_per_turn.or(table.header.counts_per_turn),
            gaps: timing::gaps(&table.t, &table.breaks),
            meta: table.header.meta,
            read_every_s: None,
            seen_every_s: None,
            found: table.found,
            t: table.t,
            u,
            x,
            // A row without its current: there is none of the recording.
            current: if current.iter().all(|i| i.is_finite()) { current } else { Vec::new() },
        };
        if recording.encoder_step.is_none() {
            recording.encoder_step = quantisation::infer_step(&recording.x, recording.held().is_some());
        }
        Ok(recording)
    }

    /// How many radians one position unit is, or `None` where the position is no angle, or nobody said which.
    pub fn radians_per_unit(&self) -> Option<f64> {
        self.units.radians(self.counts_per_turn)
    }
}

/// The columns of a recording: drive, position, and the current where it is named.
fn wanted(options: &ReadOptions) -> Vec<Wanted<'_>> {
    let drive = Wanted { name: options.input_column(), flag: "--input" };
    let position = Wanted { name: options.position_column(), flag: "--position" };
    let current = options.current.as_deref().map(|name| Wanted { name, flag: "--current" });
    [Some(drive), Some(position), current].into_iter().flatten().collect()
}

/// The name of a recording: its file's, without folder and endings.
fn file_stem(file: &str) -> String {
    let file = file.strip_suffix(".gz").unwrap_or(file);
    Path::new(file).file_stem().map_or_else(|| file.to_owned(), |stem| stem.to_string_lossy().into_owned())
}
