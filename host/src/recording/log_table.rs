//! The wanted columns of a log that is not CSV.

use super::MAX_ROWS;
use super::clock::Clock;
use super::error::RecordingError;
use super::formats::{Joined, Log, Times};
use super::header::Header;
use super::lines::LineOfRow;
use super::options::ReadOptions;
use super::quality::Warning;
use super::table::{Table, Wanted, nothing};

impl Table {
    /// The wanted channels of `log` as a table. A row's line is its number in its group, from 1.
    pub(super) fn of_log(
        file: &str,
        log: &Log,
        options: &ReadOptions,
        wanted: &[Wanted<'_>],
    ) -> Result<Self, RecordingError> {
        options.check()?;
        let Joined { times, columns, selected, seen, units, clocks_of } = log.join(file, options, wanted)?;
        let mut header = Header::default();
        let named = wanted.iter().map(|wanted| wanted.name).zip(units);
        header.units.extend(named.filter_map(|(name, unit)| Some((name.to_owned(), unit?))));
        let (clock, times) = match times {
            Times::Rows => (Clock::Rate { fs_hz: options.fs_hz.unwrap_or(1.0) }, None),
            Times::Channel(name, unit, numbers) => {
                header.units.extend(unit.map(|unit| (name.clone(), unit)));
                (Clock::column(0, &name, options.time_unit, &header), Some(numbers))
            }
            Times::Stamps(name, stamps) => (Clock::stamps(&name), Some(stamps)),
        };
        let mut table = Self {
            header,
            clock: clock.clone(),
            t: Vec::new(),
            columns: vec![Vec::new(); wanted.len()],
            breaks: Vec::new(),
            restarts: Vec::new(),
            lines: LineOfRow::default(),
            last_line: selected.len() as u64,
            found: Vec::new(),
        };
        let most = options.max_rows.unwrap_or(MAX_ROWS);
        let (mut broken, mut without, mut outside_s) = (false, 0, None);
        for (row, selected) in selected.iter().enumerate() {
            let number = |_| times.as_ref().map_or(Ok(f64::NAN), |times| Ok::<f64, RecordingError>(times[row]));
            let t = clock.time_s(row, |at| number(at).map(super::clock::Stamp::Number), |_| Ok(0.0))?;
            let values = columns.iter().map(|column| column[row]);
            if !selected {
                broken = true;
            } else if !t.is_finite() || !values.clone().all(f64::is_finite) {
                (broken, without) = (true, without + 1);
            } else if options.window_s.is_some_and(|(from_s, to_s)| !(from_s <= t && t <= to_s)) {
                let (first, last): (f64, f64) = outside_s.unwrap_or((t, t));
                outside_s = Some((first.min(t), last.max(t)));
                broken = true;
            } else {
                if table.t.len() == most {
                    return Err(RecordingError::TooManyRows { file: file.to_owned(), line: row as u64 + 1, most });
                }
                if broken && !table.t.is_empty() {
                    table.breaks.push(table.t.len());
                }
                broken = false;
                table.t.push(t);
                table.lines.push(row as u64 + 1);
                table.columns.iter_mut().zip(values).for_each(|(column, value)| column.push(value));
            }
        }
        if table.t.is_empty() {
            return Err(nothing(file, table.last_line, options, outside_s, seen));
        }
        table.found.extend(log.torn_at.map(|at_byte| Warning::EndsInRecord { at_byte }));
        table.found.extend(clocks_of.map(|(drive, position)| Warning::Joined { drive, position }));
        if without > 0 {
            table.found.push(Warning::NoValue { rows: without, share: without as f64 / selected.len() as f64 });
        }
        table.mended(file)
    }
}
