//! The rows of a file, one after the other: their names, their fields, and where they stand.

use std::io::Read;
use std::rc::Rc;

use csv::ByteRecord;

use super::clock::{Clock, Stamp};
use super::error::{ClockError, ListError, Place, RecordingError};
use super::limits::{MAX_COLUMNS, Meter};
use super::options::Selection;
use super::{field, formats};
use crate::nearest::nearest;

/// Columns that a message lists.
const LISTED: usize = 24;
/// How the columns of a stamp end that is split in seconds and nanoseconds, as ROS and its tools write it.
const SPLIT: [(&str, &str); 3] = [("sec", "nanosec"), ("secs", "nsecs"), ("sec", "nsec")];
/// Nanoseconds of a second.
const NANOSECONDS: f64 = 1e9;
/// Values of a `--where` column that a message lists.
const SEEN_VALUES: usize = 5;

/// The header row: names, and where it stands.
pub(super) struct Names<'a> {
    pub file: &'a str,
    pub line: u64,
    pub columns: Vec<String>,
}

impl<'a> Names<'a> {
    /// The names in a header row.
    pub(super) fn new(file: &'a str, line: u64, row: &ByteRecord) -> Result<Self, RecordingError> {
        if row.len() > MAX_COLUMNS {
            return Err(RecordingError::TooManyColumns { file: file.to_owned(), line, found: row.len() });
        }
        let columns = row.iter().map(|name| String::from_utf8_lossy(name.trim_ascii()).into_owned()).collect();
        let names = Self { file, line, columns };
        if names.columns.iter().all(|name| name.parse::<f64>().is_ok()) {
            let found = field::shown(&names.columns.join(","));
            return Err(RecordingError::NoHeader { file: file.to_owned(), line, found });
        }
        Ok(names)
    }

    pub(super) fn index(&self, wanted: &str, flag: &'static str) -> Result<usize, RecordingError> {
        let mut found = (0..self.columns.len()).filter(|&k| self.columns[k] == wanted);
        match (found.next(), found.next()) {
            (Some(index), None) => Ok(index),
            (Some(_), Some(_)) => Err(RecordingError::DuplicateColumn {
                file: self.file.to_owned(),
                line: self.line,
                column: wanted.to_owned(),
            }),
            (None, _) => Err(RecordingError::WrongColumn {
                file: self.file.to_owned(),
                line: self.line,
                wanted: wanted.to_owned(),
                flag,
                nearest: nearest(wanted, self.columns.iter().map(String::as_str)).map(field::shown),
                columns: self.listed(),
            }),
        }
    }
}

impl Names<'_> {
    /// The cell of a wanted column: `position`, or `position[1]` where the fields of `position` are lists.
    pub(super) fn cell(&self, wanted: &str, flag: &'static str) -> Result<Cell, RecordingError> {
        self.index(wanted, flag).map(|index| Cell { index, element: None }).or_else(|error| {
            let listed = wanted.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
            let element = listed.and_then(|(name, element)| Some((name, element.trim().parse().ok()?)));
            let Some((name, element)) = element else { return Err(error) };
            self.index(name, flag).map(|index| Cell { index, element: Some(element) }).map_err(|_| error)
        })
    }

    /// Seconds and nanoseconds in two columns: those of the prefix of `seconds` if given, else the first such pair.
    pub(super) fn split_stamp(&self, seconds: Option<&str>) -> Option<(usize, usize)> {
        let at = |name: &str| self.columns.iter().position(|column| column == name);
        let partner = |index: usize| {
            let name = &self.columns[index];
            let split = SPLIT.iter().find_map(|(whole, part)| Some((name.strip_suffix(whole)?, part)));
            let (prefix, part) = split.filter(|(prefix, _)| !prefix.ends_with(char::is_alphanumeric))?;
            Some((index, at(&format!("{prefix}{part}"))?))
        };
        match seconds {
            Some(name) => at(name).and_then(partner),
            None => (0..self.columns.len()).find_map(partner),
        }
    }

    /// The columns for a message.
    fn listed(&self) -> Vec<String> {
        let mut listed: Vec<String> = self.columns.iter().take(LISTED).map(|name| field::shown(name)).collect();
        if let Some(more) = self.columns.len().checked_sub(LISTED + 1) {
            listed.push(format!("and {} more", more + 1));
        }
        listed
    }
}

/// Where a number stands in a row: a field, or an element of the list in a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    pub index: usize,
    pub element: Option<usize>,
}

/// The rows of a file.
pub(super) struct Rows<'a, R> {
    pub csv: csv::Reader<R>,
    pub meter: Rc<Meter>,
    pub file: &'a str,
    /// Lines before the header row.
    pub comments: u64,
    /// Last line of the row that was read last.
    pub line: u64,
}

impl<R: Read> Rows<'_, R> {
    /// Reads the next row that is not blank; `false` at the end.
    pub(super) fn next(&mut self, row: &mut ByteRecord) -> Result<bool, RecordingError> {
        loop {
            match self.csv.read_byte_record(row) {
                Err(error) => return Err(self.meter.error(self.file, self.line + 1, &error.into())),
                Ok(false) => return Ok(false),
                Ok(true) => {}
            }
            self.meter.row_ended();
            if !(row.len() == 1 && row.as_slice().trim_ascii().is_empty()) {
                self.line = self.comments + self.csv.position().line().saturating_sub(1);
                return Ok(true);
            }
        }
    }

    /// Whether the last byte of the file ends a line; known at its end.
    pub(super) fn ends_a_line(&self) -> bool {
        self.meter.ends_a_line()
    }

    /// The line on which the row that was read last begins, from 1. Its own position may lie on comments before it,
    /// so count back from its end. An unclosed quote has no end of line; there its own position is the later one.
    pub(super) fn first_line(&self, row: &ByteRecord) -> u64 {
        let lines = row.as_slice().split(|&byte| byte == b'\n').count() as u64;
        let start = row.position().map_or(0, csv::Position::line);
        self.comments + (self.line + 1 - self.comments).saturating_sub(lines).max(start)
    }
}

/// What is read of each row.
pub(super) struct RowReader<'a> {
    pub names: &'a Names<'a>,
    pub clock: Clock,
    pub cells: Vec<Cell>,
    /// A column after these that a row may lack: it is then not a number.
    pub optional: Option<usize>,
    /// Whether numbers have a decimal comma where they have no point: the delimiter is none.
    pub decimal_comma: bool,
    pub selection: Vec<(usize, &'a Selection)>,
    /// Values of `--where` columns, for the message when none matches.
    pub seen: Vec<String>,
    /// First and last time of the rows that are kept, s.
    pub window_s: Option<(f64, f64)>,
    /// Earliest and latest time of the rows that lie outside of that window, s.
    pub outside_s: Option<(f64, f64)>,
    /// The numbers of the last row, in the order of `cells`.
    pub values: Vec<f64>,
}

impl RowReader<'_> {
    /// Takes the numbers of a row, and gives its time in s, or `None` if it is not selected.
    pub(super) fn read(
        &mut self,
        row: &ByteRecord,
        number: usize,
        line: impl Fn() -> u64,
    ) -> Result<Option<f64>, RecordingError> {
        let Names { file, columns, .. } = self.names;
        let (found, expected) = (row.len(), columns.len());
        if found > expected {
            return Err(RecordingError::ExtraFields { file: (*file).to_owned(), line: line(), found, expected });
        }
        let place = |index: usize| {
            let column = columns.get(index).map(|name| field::shown(name));
            let column = column.unwrap_or_else(|| format!("number {}", index + 1));
            Place { file: (*file).to_owned(), line: line(), column }
        };
        let field = |index: usize| {
            row.get(index).ok_or_else(|| RecordingError::MissingField { place: place(index), found, expected })
        };
        let mut selected = true;
        for (index, condition) in &self.selection {
            let value = field(*index)?;
            if !condition.matches(value) {
                selected = false;
                note(&mut self.seen, value);
            }
        }
        if !selected {
            return Ok(None);
        }
        let number_in = |cell: Cell| {
            let (text, index) = (field(cell.index)?, cell.index);
            match cell.element {
                Some(element) => {
                    let item = formats::cell_of_list(text, element);
                    let item = item.map_err(|found| ListError::NoElement { place: place(index), element, found })?;
                    field::number(item, self.decimal_comma, || place(index))
                }
                None => field::number(text, self.decimal_comma, || place(index)),
            }
        };
        let stamp = |index: usize| {
            let text = field(index)?;
            match formats::seconds_of_date(text) {
                Some(seconds) => Ok(Stamp::Date(seconds)),
                None => field::number(text, self.decimal_comma, || place(index)).map(Stamp::Number),
            }
        };
        let part = |index: usize| {
            let nanoseconds = field::number(field(index)?, self.decimal_comma, || place(index))?;
            if (0.0..NANOSECONDS).contains(&nanoseconds) {
                return Ok(nanoseconds / NANOSECONDS);
            }
            Err(ClockError::NoPart { place: place(index), value: nanoseconds }.into())
        };
        let t = self.clock.time_s(number, stamp, part)?;
        if let Some((from_s, to_s)) = self.window_s
            && !(from_s <= t && t <= to_s)
        {
            let (first, last) = self.outside_s.unwrap_or((t, t));
            self.outside_s = Some((first.min(t), last.max(t)));
            return Ok(None);
        }
        self.values.clear();
        for &cell in &self.cells {
            self.values.push(number_in(cell)?);
        }
        self.values.extend(self.optional.map(|index| number_in(Cell { index, element: None }).unwrap_or(f64::NAN)));
        Ok(Some(t))
    }
}

/// Remembers a value of a `--where` column, for the message when none matches.
pub(super) fn note(seen: &mut Vec<String>, found: &[u8]) {
    if seen.len() < SEEN_VALUES {
        let text = format!("`{}`", field::shown(&String::from_utf8_lossy(found)));
        if !seen.contains(&text) {
            seen.push(text);
        }
    }
}
