//! The streaming reader: the wanted columns of a CSV file, and nothing else, are kept.

use std::io::{BufRead, BufReader, Read};

use csv::ByteRecord;

use super::error::{Place, RecordingError};
use super::field;
use super::header::Header;
use super::lines::LineOfRow;
use super::options::ReadOptions;
use super::quality::Warning;
use crate::nearest::nearest;

/// Values of a `--where` column that a message lists.
const SEEN_VALUES: usize = 5;

/// A column that is wanted, and the flag with which the user names it.
pub(super) struct Wanted<'a> {
    pub name: &'a str,
    pub flag: &'static str,
}

/// The wanted columns. Time increases strictly, all numbers are finite, all columns have the same length.
#[derive(Debug)]
pub(super) struct Table {
    pub header: Header,
    /// Time, s.
    pub t: Vec<f64>,
    pub columns: Vec<Vec<f64>>,
    /// Kept rows at which a new piece begins: samples before it are missing (the header says so), are not selected, or were
    /// stamped by a clock that then started anew. Increasing.
    pub breaks: Vec<usize>,
    /// Those of `breaks` at which the clock starts anew: how long after the row before them they follow is not known.
    pub restarts: Vec<usize>,
    /// Line of each row.
    pub lines: LineOfRow,
    pub last_line: u64,
    /// What was mended.
    pub found: Vec<Warning>,
}

/// The header row: names, and where it stands.
struct Names<'a> {
    file: &'a str,
    line: u64,
    columns: Vec<String>,
}

impl Names<'_> {
    fn index(&self, wanted: &str, flag: &'static str) -> Result<usize, RecordingError> {
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
                nearest: nearest(wanted, self.columns.iter().map(String::as_str)).map(str::to_owned),
                columns: self.columns.iter().map(|name| field::shown(name)).collect(),
            }),
        }
    }
}

/// Where a row's time comes from.
enum Clock {
    /// A column, and its unit in seconds.
    Column { index: usize, unit_s: f64 },
    /// The row number.
    Rate { fs_hz: f64 },
    /// The row number, by the file's own `# tick`.
    Tick { tick_s: f64 },
}

impl Table {
    /// Reads from `input`; `file` is the name for messages.
    pub(super) fn read(
        file: &str,
        input: impl Read,
        options: &ReadOptions,
        wanted: &[Wanted<'_>],
    ) -> Result<Self, RecordingError> {
        options.check()?;
        let failed = |source| RecordingError::Read { file: file.to_owned(), source };
        let mut input = BufReader::with_capacity(1 << 16, input);
        let mut header = Header::default();
        let (first_row, comments) = read_header(file, &mut input, &mut header)?;
        let delimiter = delimiter(&first_row);
        let mut rows = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .delimiter(delimiter)
            // Not CRLF: csv would end such a row at its CR and count the line only with the next row. The CR is trimmed.
            .terminator(csv::Terminator::Any(b'\n'))
            .buffer_capacity(1 << 16)
            .from_reader(first_row.as_slice().chain(input).chain(b"\n".as_slice()));

        let mut row = ByteRecord::new();
        rows.read_byte_record(&mut row).map_err(|e| failed(e.into()))?;
        let names = Names {
            file,
            line: comments + 1,
            columns: row.iter().map(|name| String::from_utf8_lossy(name.trim_ascii()).into_owned()).collect(),
        };
        if names.columns.iter().all(|name| name.parse::<f64>().is_ok()) {
            return Err(RecordingError::NoHeader {
                file: file.to_owned(),
                line: names.line,
                found: field::shown(&names.columns.join(",")),
            });
        }
        // A file that is no recording at all has no such column either, and says so better.
        let other = |error| match crate::mistaken::seems(&first_row) {
            Some(found) => RecordingError::OtherFile { file: file.to_owned(), found },
            None => error,
        };
        let clock = clock(options, &header, &names).map_err(other)?;
        let indices =
            wanted.iter().map(|w| names.index(w.name, w.flag)).collect::<Result<Vec<_>, _>>().map_err(other)?;
        let selection = options
            .select
            .iter()
            .map(|s| Ok((names.index(&s.column, "--where")?, s)))
            .collect::<Result<Vec<_>, RecordingError>>()?;

        let mut table = Self {
            header,
            t: Vec::new(),
            columns: vec![Vec::new(); wanted.len()],
            breaks: Vec::new(),
            restarts: Vec::new(),
            lines: LineOfRow::default(),
            last_line: names.line,
            found: Vec::new(),
        };
        let mut dropped = std::mem::take(&mut table.header.gaps).into_iter().peekable();
        let mut seen: Vec<String> = Vec::new();
        let mut broken = false;
        let mut number: usize = 0;
        while rows.read_byte_record(&mut row).map_err(|e| failed(e.into()))? {
            if row.len() == 1 && row.as_slice().trim_ascii().is_empty() {
                continue;
            }
            let this = number;
            number += 1;
            let end = rows.position().line();
            let before = std::mem::replace(&mut table.last_line, comments + end.saturating_sub(1));
            // Asked only when something is wrong: it reads the row once more.
            let line = || comments + first_line(&row, end);
            let place = |index: usize| Place {
                file: file.to_owned(),
                line: line(),
                column: names
                    .columns
                    .get(index)
                    .map_or_else(|| format!("number {}", index + 1), |name| field::shown(name)),
            };
            if row.len() > names.columns.len() {
                return Err(RecordingError::ExtraFields {
                    file: file.to_owned(),
                    line: line(),
                    found: row.len(),
                    expected: names.columns.len(),
                });
            }
            let field = |index: usize| {
                row.get(index).ok_or_else(|| RecordingError::MissingField {
                    place: place(index),
                    found: row.len(),
                    expected: names.columns.len(),
                })
            };
            while dropped.next_if(|&at| at <= this).is_some() {
                broken = true;
            }
            let mut selected = true;
            for (index, condition) in &selection {
                let found = field(*index)?;
                if !condition.matches(found) {
                    selected = false;
                    note(&mut seen, found);
                }
            }
            if !selected {
                broken = true;
                continue;
            }
            let t = match clock {
                Clock::Column { index, unit_s } => field::number(field(index)?, || place(index))? * unit_s,
                Clock::Rate { fs_hz } => this as f64 / fs_hz,
                Clock::Tick { tick_s } => this as f64 * tick_s,
            };
            if broken && !table.t.is_empty() {
                table.breaks.push(table.t.len());
            }
            broken = false;
            table.t.push(t);
            table.lines.push(if before + 1 == table.last_line { table.last_line } else { line() });
            for (column, &index) in table.columns.iter_mut().zip(&indices) {
                column.push(field::number(field(index)?, || place(index))?);
            }
        }
        if table.t.is_empty() {
            return Err(if number == 0 {
                RecordingError::NoRows { file: file.to_owned(), line: names.line }
            } else {
                RecordingError::NothingSelected { file: file.to_owned(), wanted: join(&options.select), seen }
            });
        }
        if let Clock::Column { index, .. } = clock {
            let column = names.columns.get(index).map_or_else(String::new, |name| field::shown(name));
            table.mend_clock(file, &column)?;
        }
        Ok(table)
    }
}

/// The line on which a row begins, from 1. Its own position may lie on comments before it, so count back from its end;
/// an unclosed quote has no end of line, there its own position is the later one.
fn first_line(row: &ByteRecord, end: u64) -> u64 {
    let lines = row.as_slice().split(|&byte| byte == b'\n').count() as u64;
    let start = row.position().map_or(0, csv::Position::line);
    end.saturating_sub(lines).max(start)
}

/// Remembers a value of a `--where` column, for the message when none matches.
fn note(seen: &mut Vec<String>, found: &[u8]) {
    if seen.len() < SEEN_VALUES {
        let text = format!("`{}`", field::shown(&String::from_utf8_lossy(found)));
        if !seen.contains(&text) {
            seen.push(text);
        }
    }
}

fn join(selections: &[super::Selection]) -> String {
    let all: Vec<String> = selections.iter().map(ToString::to_string).collect();
    all.join(" and ")
}

/// Takes the comment lines; returns the first line that is none, and the number of lines before it.
fn read_header(file: &str, input: &mut impl BufRead, header: &mut Header) -> Result<(Vec<u8>, u64), RecordingError> {
    let mut before = 0;
    let mut line = Vec::new();
    loop {
        line.clear();
        input.read_until(b'\n', &mut line).map_err(|source| RecordingError::Read { file: file.to_owned(), source })?;
        if line.is_empty() {
            return Err(RecordingError::Empty { file: file.to_owned() });
        }
        if before == 0 {
            // A spreadsheet's "Unicode text" is UTF-16, which shows itself by its first two bytes.
            if line.starts_with(&[0xff, 0xfe]) || line.starts_with(&[0xfe, 0xff]) {
                return Err(RecordingError::NotUtf8 {
                    place: Place { file: file.to_owned(), line: 1, column: "number 1".to_owned() },
                });
            }
            if line.starts_with(b"\xef\xbb\xbf") {
                line.drain(..3);
            }
        }
        let text = line.trim_ascii();
        if let Some(comment) = text.strip_prefix(b"#") {
            header.take(file, before + 1, &String::from_utf8_lossy(comment))?;
        } else if !text.is_empty() {
            return Ok((line, before));
        }
        before += 1;
    }
}

/// The delimiter of a header row: a comma, or where there is none a semicolon or a tab.
fn delimiter(row: &[u8]) -> u8 {
    let found = |byte: &u8| row.contains(byte);
    [b',', b';', b'\t'].into_iter().find(found).unwrap_or(b',')
}

fn clock(options: &ReadOptions, header: &Header, names: &Names<'_>) -> Result<Clock, RecordingError> {
    if let Some(fs_hz) = options.fs_hz {
        return Ok(Clock::Rate { fs_hz });
    }
    let name = options.time_column();
    match (names.index(name, "--time (or give --fs)"), header.tick_s) {
        (Ok(index), _) => {
            let unit_s = match name.rsplit('_').next() {
                Some("ms") => 1e-3,
                Some("us") => 1e-6,
                _ => 1.0,
            };
            Ok(Clock::Column { index, unit_s })
        }
        (Err(RecordingError::WrongColumn { .. }), Some(tick_s)) if options.time.is_none() => Ok(Clock::Tick { tick_s }),
        (Err(error), _) => Err(error),
    }
}
