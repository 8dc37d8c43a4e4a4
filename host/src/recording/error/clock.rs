//! What can be wrong with a recording's clock.

use super::Place;
use crate::recording::TimeUnit;

/// Why a clock cannot be used.
#[derive(Debug, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
#[non_exhaustive]
pub enum ClockError {
    /// Time goes back so often that the rows are in no order of time.
    #[error(
        "{place}: time goes back from {before} to {after}{}; sort the rows, keep one recording per file, or give the right \
         column with --time",
        if *times > 1 { format!(", and so {times} times") } else { String::new() }
    )]
    TimeDecreases {
        /// Where it does so first.
        place: Place,
        /// Time of the row before, s.
        before: f64,
        /// Time of this row, s.
        after: f64,
        /// How often it does so.
        times: u64,
    },
    /// Time stands still in all but a few rows.
    #[error(
        "{place}: time stands still at {time}, {rows} rows repeat the stamp of the row before; give the right column with \
         --time, or the sampling rate with --fs"
    )]
    TimeRepeats {
        /// Where it does so first.
        place: Place,
        /// The time, s.
        time: f64,
        /// Rows that repeat the stamp of the row before.
        rows: usize,
    },
    /// Nanoseconds that are not a part of their second.
    #[error(
        "{place}: {value} is not from 0 to 999999999: these nanoseconds are no part of a second in a column beside them; \
         name another column with --time"
    )]
    NoPart {
        /// Where.
        place: Place,
        /// The value.
        value: f64,
    },
    /// Rows come at a rate at which no motor is recorded.
    #[error(
        "{file}: column `{column}`, read in {unit}, gives {} between rows, {}{}",
        rate(*rate_hz), if *possible { "at which no motor is recorded" } else { "past what can be computed with" },
        match likely {
            Some((likely, hz)) => format!(
                "; it is probably in {likely}{} ({} between rows): give --time-unit {likely}{}",
                if *since_1970 { " since 1970" } else { "" }, rate(*hz),
                if *possible { format!(", or --time-unit {unit} if it is right") } else { String::new() }
            ),
            None => String::from(": check the column, or give its unit with --time-unit, or the sampling rate with --fs"),
        }
    )]
    Rate {
        /// The file's name as it was given.
        file: String,
        /// The time column.
        column: String,
        /// The unit in which it was read.
        unit: TimeUnit,
        /// The rate that follows, Hz.
        rate_hz: f64,
        /// A likelier unit, and its rate, Hz.
        likely: Option<(TimeUnit, f64)>,
        /// Whether the time stamps count from 1970 in the likelier unit.
        since_1970: bool,
        /// Whether the rate can be computed with.
        possible: bool,
    },
    /// Several rows share each time stamp, and the stamps are too far apart.
    #[error(
        "{file}: column `{column}` is too coarse: about {rows_per_stamp:.0} rows have each time stamp, and stamps are \
         {interval_s} s apart; give the sampling rate with --fs"
    )]
    CoarseClock {
        /// The file's name as it was given.
        file: String,
        /// The time column.
        column: String,
        /// Median interval between different stamps, s.
        interval_s: f64,
        /// Rows per stamp.
        rows_per_stamp: f64,
    },
    /// The file's own tick cannot be computed with.
    #[error("{file}: header `tick` gives {}, past what can be computed with; give the sampling rate with --fs", rate(*rate_hz))]
    RowRate {
        /// The file's name as it was given.
        file: String,
        /// The rate, Hz.
        rate_hz: f64,
    },
}

/// A rate for a message: `1000 Hz`, `2.5e-7 Hz`.
fn rate(hz: f64) -> String {
    let text = format!("{hz:.3e}");
    let short: f64 = text.parse().unwrap_or(hz);
    if (0.01..1e6).contains(&short) { format!("{short} Hz") } else { format!("{short:e} Hz") }
}
