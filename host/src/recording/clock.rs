//! The clock of a file: where a row's time comes from, in which unit, and whether the rate that follows can be meant.

use std::fmt;
use std::str::FromStr;

use super::MIN_ROWS;
use super::error::{ClockError, RecordingError};
use super::header::Header;
use super::quality::Warning;
use super::table::Table;
use super::timing::median_interval;

/// Rates of rows that are believed where no unit is stated, Hz. A servo's motion lasts tenths of seconds, so fewer
/// rows show none of it. No position is read more often than the fastest drives switch. Times of 0.2 to 200 kHz in
/// ms, taken for s, are below this range; times in s, taken for ms, are above it.
const BELIEVED_HZ: (f64, f64) = (5.0, 500e3);
/// Rates that can be computed with at all, Hz: windows and segments of fixed lengths in s then hold at most 10⁸ rows.
pub(super) const POSSIBLE_HZ: (f64, f64) = (1e-4, 1e7);
/// The rate that is the likeliest where several are possible, Hz.
const LIKELY_HZ: f64 = 1e3;
/// Seconds since 1970 from 2001 to 2100.
const SINCE_1970_S: (f64, f64) = (1e9, 4.1e9);

/// Unit of a time column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TimeUnit {
    /// Hours.
    Hours,
    /// Minutes.
    Minutes,
    /// Seconds.
    Seconds,
    /// Milliseconds.
    Milliseconds,
    /// Microseconds.
    Microseconds,
    /// Nanoseconds.
    Nanoseconds,
}

impl TimeUnit {
    /// All units, the largest first.
    const ALL: [Self; 6] =
        [Self::Hours, Self::Minutes, Self::Seconds, Self::Milliseconds, Self::Microseconds, Self::Nanoseconds];

    /// How users write it, in lower case. The first one names it.
    fn spellings(self) -> &'static [&'static str] {
        match self {
            Self::Hours => &["h", "hr", "hrs", "hour", "hours"],
            Self::Minutes => &["min", "mins", "minute", "minutes"],
            Self::Seconds => &["s", "sec", "secs", "second", "seconds"],
            Self::Milliseconds => &["ms", "msec", "msecs", "milli", "millis", "millisecond", "milliseconds"],
            // Two letters look like the prefix: the micro sign and the Greek letter.
            Self::Microseconds => {
                &["us", "\u{b5}s", "\u{3bc}s", "usec", "usecs", "micro", "micros", "microsecond", "microseconds"]
            }
            Self::Nanoseconds => &["ns", "nsec", "nsecs", "nano", "nanos", "nanosecond", "nanoseconds"],
        }
    }

    /// `value` of this unit in s. Divisions, so that 3 ms are the number that is written 0.003.
    pub(crate) fn seconds(self, value: f64) -> f64 {
        match self {
            Self::Hours => value * 3600.0,
            Self::Minutes => value * 60.0,
            Self::Seconds => value,
            Self::Milliseconds => value / 1e3,
            Self::Microseconds => value / 1e6,
            Self::Nanoseconds => value / 1e9,
        }
    }

    /// The unit that a column's name ends in: in brackets, `t (us)`, `time [ms]`; after a separator, `t_ns`, `time-s`; or
    /// with a capital, `TimeMs`. A name that is a unit, `millis`, counts too.
    pub(crate) fn of_name(name: &str) -> Option<Self> {
        let name = name.trim();
        let bracketed = |open, close| name.strip_suffix(close).and_then(|rest: &str| rest.rsplit_once(open));
        if let Some((_, unit)) = bracketed('(', ')').or_else(|| bracketed('[', ']')) {
            return unit.parse().ok();
        }
        let letters: Vec<(usize, char)> = name.char_indices().collect();
        let capital = letters.windows(2).rev().find(|w| w[0].1.is_lowercase() && w[1].1.is_uppercase());
        let separator = name.rfind(|c: char| !c.is_alphanumeric());
        let after = |at: usize| name[at..].chars().next().map_or(at, |c| at + c.len_utf8());
        let start = capital.map_or(0, |w| w[1].0).max(separator.map_or(0, after));
        name[start..].parse().ok()
    }
}

impl fmt::Display for TimeUnit {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(self.spellings()[0])
    }
}

impl FromStr for TimeUnit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim().to_lowercase();
        let found = Self::ALL.into_iter().find(|unit| unit.spellings().contains(&text.as_str()));
        found.ok_or_else(|| "expected `s`, `ms`, `us`, `ns`, `min` or `h`".to_owned())
    }
}

/// Where a row's time comes from.
#[derive(Clone, Debug)]
pub(super) enum Clock {
    /// A column.
    Column {
        /// Its index.
        index: usize,
        /// The column with the nanoseconds of its seconds, where the stamp is split.
        part: Option<usize>,
        /// Its name, for messages.
        name: String,
        /// Its unit.
        unit: TimeUnit,
        /// Whether the user or the file's header says so; else it is what the name ends in, or s.
        stated: bool,
    },
    /// The row number, by `--fs`.
    Rate { fs_hz: f64 },
    /// The row number, by the file's own `# tick`.
    Tick { tick_s: f64 },
}

impl Clock {
    /// The column `name` as a clock.
    pub(super) fn column(index: usize, name: &str, wanted: Option<TimeUnit>, header: &Header) -> Self {
        let stated = wanted.or_else(|| header.units.get(name)?.parse().ok());
        let unit = stated.or_else(|| TimeUnit::of_name(name)).unwrap_or(TimeUnit::Seconds);
        Self::Column { index, part: None, name: super::field::shown(name), unit, stated: stated.is_some() }
    }

    /// The columns `index` and `part`, seconds and nanoseconds, as a clock.
    pub(super) fn split(index: usize, part: usize, name: &str) -> Self {
        let (unit, stated) = (TimeUnit::Seconds, true);
        Self::Column { index, part: Some(part), name: super::field::shown(name), unit, stated }
    }

    /// The stamps of a log, s, as a clock; `name` is what they are called.
    pub(super) fn stamps(name: &str) -> Self {
        Self::Column { index: 0, part: None, name: super::field::shown(name), unit: TimeUnit::Seconds, stated: true }
    }

    /// Time of a row in s: of its number in the file, from 0, or of what stands in the time column. `part` gives the part
    /// of a second in a column.
    ///
    /// # Errors
    /// What `stamp` and `part` say.
    pub(super) fn time_s<E>(
        &self,
        row: usize,
        stamp: impl FnOnce(usize) -> Result<Stamp, E>,
        part: impl FnOnce(usize) -> Result<f64, E>,
    ) -> Result<f64, E> {
        Ok(match self {
            Self::Column { index, part: of, unit, .. } => {
                let whole = match stamp(*index)? {
                    Stamp::Number(number) => unit.seconds(number),
                    Stamp::Date(seconds) => seconds,
                };
                match of {
                    Some(index) => whole + part(*index)?,
                    None => whole,
                }
            }
            Self::Rate { fs_hz } => row as f64 / fs_hz,
            Self::Tick { tick_s } => row as f64 * tick_s,
        })
    }
}

/// What stands in a time column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stamp {
    /// A number of the column's unit.
    Number(f64),
    /// A date or a time of day, s since 1970 or midnight.
    Date(f64),
}

impl Table {
    /// Refuses too few rows, and an implausible rate.
    ///
    /// # Errors
    /// [`RecordingError::TooShort`], and what the rate is refused with.
    pub(super) fn check(&self, file: &str) -> Result<(), RecordingError> {
        if self.t.len() < MIN_ROWS { Err(self.too_short(file)) } else { self.check_rate(file) }
    }

    /// Refuses a rate at which no motor is recorded, unless the user or the file says that the unit is right. Always
    /// refuses a rate that cannot be computed with.
    ///
    /// # Errors
    /// [`ClockError::Rate`], with the unit that is likelier, and [`ClockError::CoarseClock`].
    fn check_rate(&self, file: &str) -> Result<(), RecordingError> {
        let interval_s = median_interval(&self.t);
        if interval_s <= 0.0 {
            return Ok(());
        }
        let rate_hz = 1.0 / interval_s;
        let within = |(low, high): (f64, f64), rate: f64| low <= rate && rate <= high;
        let possible = within(POSSIBLE_HZ, rate_hz);
        let Clock::Column { name, unit, stated, .. } = &self.clock else {
            return if possible { Ok(()) } else { Err(ClockError::RowRate { file: file.to_owned(), rate_hz }.into()) };
        };
        if possible && (*stated || within(BELIEVED_HZ, rate_hz)) {
            return Ok(());
        }
        let repeated = self.found.iter().find_map(|warning| match warning {
            Warning::StampRepeated { share, .. } => Some(*share),
            _ => None,
        });
        let column = name.clone();
        // Two rows or more per stamp: the stamps are whole seconds, say, and what fails is their resolution.
        if let Some(share) = repeated.filter(|share| *share >= 0.5 && rate_hz / (1.0 - share) >= BELIEVED_HZ.0) {
            let rows_per_stamp = 1.0 / (1.0 - share);
            return Err(ClockError::CoarseClock { file: file.to_owned(), column, interval_s, rows_per_stamp }.into());
        }
        // The raw numbers, in the unit they were taken for.
        let one = unit.seconds(1.0);
        let (interval, first) = (interval_s / one, self.t.first().copied().unwrap_or(0.0) / one);
        let rate_in = |unit: TimeUnit| 1.0 / unit.seconds(interval);
        let since_1970 = TimeUnit::ALL.into_iter().find(|unit| within(SINCE_1970_S, unit.seconds(first)));
        let off = |unit: TimeUnit| (rate_in(unit) / LIKELY_HZ).ln().abs();
        let others = TimeUnit::ALL.into_iter().filter(|other| other != unit && within(BELIEVED_HZ, rate_in(*other)));
        let likely = since_1970.filter(|other| other != unit && within(BELIEVED_HZ, rate_in(*other)));
        let likely = likely.or_else(|| others.min_by(|a, b| off(*a).total_cmp(&off(*b))));
        Err(RecordingError::Clock(ClockError::Rate {
            file: file.to_owned(),
            column,
            unit: *unit,
            rate_hz,
            likely: likely.map(|unit| (unit, rate_in(unit))),
            since_1970: likely.is_some() && likely == since_1970,
            possible,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_of_time_is_what_the_name_ends_in() {
        let cases = [
            ("time (us)", Some(TimeUnit::Microseconds)),
            ("t [ms]", Some(TimeUnit::Milliseconds)),
            ("Time(\u{b5}s)", Some(TimeUnit::Microseconds)),
            ("TimeMs", Some(TimeUnit::Milliseconds)),
            ("timeMS", Some(TimeUnit::Milliseconds)),
            ("t_ns", Some(TimeUnit::Nanoseconds)),
            ("header.stamp_usec", Some(TimeUnit::Microseconds)),
            ("Timestamp (seconds)", Some(TimeUnit::Seconds)),
            ("elapsed min", Some(TimeUnit::Minutes)),
            ("millis", Some(TimeUnit::Milliseconds)),
            ("t_s", Some(TimeUnit::Seconds)),
            ("t", None),
            ("time", None),
            ("timestamps", None),
            ("Time (UTC)", None),
            ("items", None),
            ("t_", None),
            ("zeit_\u{3c4}", None),
            ("", None),
        ];
        for (name, unit) in cases {
            assert_eq!(TimeUnit::of_name(name), unit, "{name}");
        }
    }

    #[test]
    fn three_milliseconds_are_the_number_that_is_written_so() {
        assert_eq!(TimeUnit::Milliseconds.seconds(3.0), 0.003);
        assert_eq!(TimeUnit::Microseconds.seconds(7.0), 7e-6);
        assert_eq!(TimeUnit::Minutes.seconds(1.5), 90.0);
    }
}
