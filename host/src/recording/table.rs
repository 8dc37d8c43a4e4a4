//! The streaming reader: the wanted columns of a CSV file, and nothing else, are kept.

use std::io::{BufRead, BufReader, Read};

use csv::ByteRecord;

use super::CURRENT;
use super::clock::Clock;
use super::error::{Place, RecordingError};
use super::formats::Format;
use super::header::Header;
use super::limits::{BUFFER, Limited, MAX_ROWS, Meter};
use super::lines::LineOfRow;
use super::options::{ReadOptions, Selection};
use super::quality::Warning;
use super::rows::{Names, RowReader, Rows};
use super::source::unpacked;
use super::{field, formats};
use crate::file::FileError;
use crate::mistaken::{Content, seems};

/// A column that is wanted, and the flag with which the user names it.
pub(super) struct Wanted<'a> {
    pub name: &'a str,
    pub flag: &'static str,
}

/// The wanted columns. Time increases strictly, all numbers are finite, all columns have the same length.
#[derive(Debug)]
pub(super) struct Table {
    pub header: Header,
    /// Where time comes from.
    pub clock: Clock,
    /// Time, s.
    pub t: Vec<f64>,
    pub columns: Vec<Vec<f64>>,
    /// Kept rows at which a new piece begins. Samples before it are missing (the header says so), are not selected,
    /// or were stamped by a clock that then started anew. Increasing.
    pub breaks: Vec<usize>,
    /// Those of `breaks` at which the clock starts anew: how long after the row before them they follow is not known.
    pub restarts: Vec<usize>,
    /// Line of each row.
    pub lines: LineOfRow,
    pub last_line: u64,
    /// What was mended.
    pub found: Vec<Warning>,
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
        let failed = |error: std::io::Error| FileError::reading(file, &error);
        let mut input = unpacked(input).map_err(failed)?;
        let mut head = Vec::new();
        input.by_ref().take(formats::HEAD as u64).read_to_end(&mut head).map_err(failed)?;
        let format = Format::of(&head);
        let input = std::io::Cursor::new(head).chain(input);
        if let Some(format) = format {
            return Self::of_log(
                file,
                &formats::foreign(file, format, input, options.dbc.as_deref())?,
                options,
                wanted,
            );
        }
        let (input, meter) = Limited::new(input);
        let mut input = BufReader::with_capacity(BUFFER, input);
        let mut header = Header::default();
        let (first_row, comments) = read_header(file, &mut input, &mut header, &meter)?;
        let delimiter = delimiter(&first_row);
        let csv = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .delimiter(delimiter)
            // Not CRLF: csv would end such a row at its CR and count the line only with the next row. The CR is trimmed.
            .terminator(csv::Terminator::Any(b'\n'))
            .buffer_capacity(BUFFER)
            .from_reader(first_row.as_slice().chain(input).chain(b"\n".as_slice()));
        let mut rows = Rows { csv, meter, file, comments, line: comments };

        let mut row = ByteRecord::new();
        rows.next(&mut row)?;
        let names = Names::new(file, comments + 1, &row)?;
        // A file that is no recording at all has no such column either, and says so better.
        let other = |error| match seems(&first_row) {
            Some(found) => FileError::OtherKind { file: file.to_owned(), wanted: Content::Recording, found }.into(),
            None => error,
        };
        let clock = clock(options, &header, &names).map_err(other)?;
        let cells = wanted.iter().map(|w| names.cell(w.name, w.flag)).collect::<Result<Vec<_>, _>>().map_err(other)?;
        // As a board writes it. A stranger's column of that name is not looked at.
        let measured = header.units.get(CURRENT).is_some_and(|unit| unit == "A");
        let optional = names.columns.iter().position(|name| name == CURRENT).filter(|_| measured && wanted.len() == 2);
        let selection = options
            .select
            .iter()
            .map(|s| Ok((names.index(&s.column, "--where")?, s)))
            .collect::<Result<Vec<_>, RecordingError>>()?;
        let mut table = Self {
            header,
            clock: clock.clone(),
            t: Vec::new(),
            columns: vec![Vec::new(); wanted.len() + usize::from(optional.is_some())],
            breaks: Vec::new(),
            restarts: Vec::new(),
            lines: LineOfRow::default(),
            last_line: names.line,
            found: Vec::new(),
        };
        // Where commas separate, a decimal comma makes two fields of a number.
        let (window_s, decimal_comma) = (options.window_s, delimiter != b',');
        let (seen, values) = (Vec::new(), Vec::new());
        let mut reader = RowReader {
            names: &names,
            clock,
            cells,
            optional,
            decimal_comma,
            selection,
            seen,
            window_s,
            outside_s: None,
            values,
        };
        let most = options.max_rows.unwrap_or(MAX_ROWS);
        table.read_rows(&mut rows, &mut reader, most)?;
        if table.t.is_empty() {
            let seen = std::mem::take(&mut reader.seen);
            return Err(nothing(file, names.line, options, reader.outside_s, seen));
        }
        table.mended(file)
    }

    /// The table with a clock that increases strictly.
    pub(super) fn mended(mut self, file: &str) -> Result<Self, RecordingError> {
        if let Clock::Column { name, .. } = &self.clock {
            let name = name.clone();
            self.mend_clock(file, &name)?;
        }
        Ok(self)
    }

    /// Reads the rows below the header row, at most `most`.
    fn read_rows<R: Read>(
        &mut self,
        rows: &mut Rows<'_, R>,
        reader: &mut RowReader<'_>,
        most: usize,
    ) -> Result<(), RecordingError> {
        let mut dropped = std::mem::take(&mut self.header.gaps).into_iter().peekable();
        let mut broken = false;
        let mut row = ByteRecord::new();
        let mut number: usize = 0;
        while rows.next(&mut row)? {
            while dropped.next_if(|&at| at <= number).is_some() {
                broken = true;
            }
            let before = std::mem::replace(&mut self.last_line, rows.line);
            match reader.read(&row, number, || rows.first_line(&row)) {
                Ok(Some(t)) => {
                    if self.t.len() == most {
                        return Err(RecordingError::TooManyRows {
                            file: rows.file.to_owned(),
                            line: self.last_line,
                            most,
                        });
                    }
                    if broken && !self.t.is_empty() {
                        self.breaks.push(self.t.len());
                    }
                    broken = false;
                    self.t.push(t);
                    self.lines.push(if before + 1 == rows.line { rows.line } else { rows.first_line(&row) });
                    self.columns.iter_mut().zip(&reader.values).for_each(|(column, &value)| column.push(value));
                }
                Ok(None) => broken = true,
                Err(error) => {
                    let fields: Vec<_> = row.iter().map(String::from_utf8_lossy).collect();
                    let text = fields.join(",");
                    // Not one that an open quote has made of many.
                    let may_be_torn = row.len() < reader.names.columns.len() && !text.contains('\n');
                    let full = row.len() == reader.names.columns.len();
                    let line = rows.first_line(&row);
                    let last = (may_be_torn || full) && !rows.next(&mut row)?;
                    if !last || full && rows.ends_a_line() {
                        return Err(error);
                    }
                    self.found.push(Warning::Torn { line, text: field::shown(&text) });
                    break;
                }
            }
            number += 1;
        }
        Ok(())
    }
}

/// The refusal of a file of which no row is left.
pub(super) fn nothing(
    file: &str,
    line: u64,
    options: &ReadOptions,
    outside_s: Option<(f64, f64)>,
    seen: Vec<String>,
) -> RecordingError {
    let file = file.to_owned();
    match (options.window_s.zip(outside_s), seen.is_empty()) {
        (Some((window_s, found_s)), _) => RecordingError::OutsideWindow { file, window_s, found_s },
        (None, true) => RecordingError::NoRows { file, line },
        (None, false) => RecordingError::NothingSelected { file, wanted: join(&options.select), seen },
    }
}

fn join(selections: &[Selection]) -> String {
    let all: Vec<String> = selections.iter().map(ToString::to_string).collect();
    all.join(" and ")
}

/// Takes the comment lines; returns the first line that is none, and the number of lines before it.
pub(super) fn read_header(
    file: &str,
    input: &mut impl BufRead,
    header: &mut Header,
    meter: &Meter,
) -> Result<(Vec<u8>, u64), RecordingError> {
    let mut before = 0;
    let mut line = Vec::new();
    loop {
        line.clear();
        if let Err(error) = input.read_until(b'\n', &mut line) {
            return Err(match seems(&line) {
                Some(found) => FileError::OtherKind { file: file.to_owned(), wanted: Content::Recording, found }.into(),
                None => meter.error(file, before + 1, &error),
            });
        }
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
pub(super) fn delimiter(row: &[u8]) -> u8 {
    let found = |byte: &u8| row.contains(byte);
    [b',', b';', b'\t'].into_iter().find(found).unwrap_or(b',')
}

fn clock(options: &ReadOptions, header: &Header, names: &Names<'_>) -> Result<Clock, RecordingError> {
    if let Some(fs_hz) = options.fs_hz {
        return Ok(Clock::Rate { fs_hz });
    }
    let name = options.time_column();
    let of_its_own = options.time.is_none() && names.columns.iter().any(|column| column == name);
    if !of_its_own && let Some((index, part)) = names.split_stamp(options.time.as_deref()) {
        let name = format!("{} and {}", names.columns[index], names.columns[part]);
        return Ok(Clock::split(index, part, &name));
    }
    match (names.index(name, "--time (or give --fs)"), header.tick_s) {
        (Ok(index), _) => Ok(Clock::column(index, name, options.time_unit, header)),
        (Err(RecordingError::WrongColumn { .. }), Some(tick_s)) if options.time.is_none() => Ok(Clock::Tick { tick_s }),
        (Err(error), _) => Err(error),
    }
}
