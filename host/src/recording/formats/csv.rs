//! All columns of a CSV file, for whoever does not know yet which of them are wanted.

use std::io::{BufReader, Read};
use std::rc::Rc;

use ::csv::ByteRecord;

use super::fault::Fault;
use super::gather::{Gather, Value};
use super::log::{Group, Log, Values};
use super::text::{items, seconds_of_date};
use super::{Channel, Format};
use crate::file::FileError;
use crate::mistaken::{Content, seems};
use crate::recording::error::RecordingError;
use crate::recording::header::Header;
use crate::recording::limits::{BUFFER, Limited};
use crate::recording::rows::{Names, Rows};
use crate::recording::table::{delimiter, read_header};
use crate::recording::units;

/// Share of a column's fields that must be numbers for it to be one of numbers.
const NUMBERS: f64 = 0.9;
/// Rows by which a column is told to be numbers, text or lists.
const SHOWS: usize = 100;

/// What a column is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Numbers,
    Dates,
    Text,
    /// Lists of so many elements.
    Lists(usize),
}

/// Reads the file's columns; `file` is its name in messages.
///
/// # Errors
/// [`RecordingError`], with file and line.
pub fn read(file: &str, input: impl Read) -> Result<Log, RecordingError> {
    let (input, meter) = Limited::new(input);
    let mut input = BufReader::with_capacity(BUFFER, input);
    let mut header = Header::default();
    let (first_row, comments) = read_header(file, &mut input, &mut header, &meter)?;
    if let Some(found) = seems(&first_row) {
        return Err(FileError::OtherKind { file: file.to_owned(), wanted: Content::Recording, found }.into());
    }
    let delimiter = delimiter(&first_row);
    let csv = ::csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .delimiter(delimiter)
        .terminator(::csv::Terminator::Any(b'\n'))
        .buffer_capacity(BUFFER)
        .from_reader(first_row.as_slice().chain(input).chain(b"\n".as_slice()));
    let mut rows = Rows { csv, meter, file, comments, line: comments };
    let mut row = ByteRecord::new();
    rows.next(&mut row)?;
    let names = Names::new(file, comments + 1, &row)?;
    let mut gather = Gather::default();
    let too_large = |fault: Fault| RecordingError::from(fault.of(file, Format::Csv));
    let group = gather.group("").map_err(too_large)?;
    let mut first: Vec<ByteRecord> = Vec::new();
    while first.len() < SHOWS && rows.next(&mut row)? {
        first.push(row.clone());
    }
    let decimal_comma = delimiter != b',';
    let kinds: Vec<Kind> = (0..names.columns.len()).map(|column| kind(&first, column, decimal_comma)).collect();
    let mut number = 0;
    let mut add = |row: &ByteRecord| -> Result<(), Fault> {
        gather.row(group, header.tick_s.map_or(f64::NAN, |tick_s| f64::from(number) * tick_s))?;
        number += 1;
        for ((name, kind), field) in names.columns.iter().zip(&kinds).zip(row) {
            match kind {
                Kind::Numbers => gather.set(group, name, &Value::Number(parse(field, decimal_comma)))?,
                Kind::Dates => {
                    gather.set(group, name, &Value::Number(seconds_of_date(field).unwrap_or(f64::NAN)))?;
                }
                Kind::Text => gather.set(group, name, &Value::Text(&String::from_utf8_lossy(field.trim_ascii())))?,
                Kind::Lists(count) => {
                    for (element, item) in items(field).into_iter().enumerate().take(*count) {
                        gather.set(group, &format!("{name}[{element}]"), &Value::Number(parse(item, false)))?;
                    }
                }
            }
        }
        Ok(())
    };
    for row in &first {
        add(row).map_err(too_large)?;
    }
    while rows.next(&mut row)? {
        add(&row).map_err(too_large)?;
    }
    let mut log = gather.log(Format::Csv).map_err(too_large)?;
    for group in &mut log.groups {
        finish(group, &header, &names.columns, &kinds);
    }
    Ok(log)
}

/// Stamps that the file has, and units.
fn finish(group: &mut Group, header: &Header, names: &[String], kinds: &[Kind]) {
    if header.tick_s.is_none() || names.iter().any(|name| name == "t") {
        group.stamps_s = None;
    }
    for channel in &mut group.channels {
        let kind = names.iter().position(|name| *name == channel.name).map(|at| kinds[at]);
        let dated = (kind == Some(Kind::Dates)).then(|| "s".to_owned());
        channel.unit = dated.or_else(|| units::of_column(&channel.name, header));
    }
    group.channels.retain(|Channel { values, .. }| match values {
        Values::Numbers(numbers) => numbers.iter().any(|number| !number.is_nan()),
        Values::Texts(texts) => texts.iter().any(|text| **text != *Rc::<str>::from("")),
    });
}

/// The number in a field; NaN if it is none.
fn parse(field: &[u8], decimal_comma: bool) -> f64 {
    let text = std::str::from_utf8(field.trim_ascii()).unwrap_or_default();
    let number =
        text.parse().or_else(|error| if decimal_comma { text.replacen(',', ".", 1).parse() } else { Err(error) });
    number.unwrap_or(f64::NAN)
}

/// What a column is, by its first rows.
fn kind(rows: &[ByteRecord], column: usize, decimal_comma: bool) -> Kind {
    let fields = || rows.iter().filter_map(|row| row.get(column)).filter(|field| !field.trim_ascii().is_empty());
    let share = |counts: &dyn Fn(&[u8]) -> bool| {
        let all = fields().count();
        all > 0 && fields().filter(|field| counts(field)).count() as f64 >= NUMBERS * all as f64
    };
    let is_list = |field: &[u8]| field.contains(&b'[') || field.starts_with(b"(");
    match () {
        () if share(&|field| !parse(field, decimal_comma).is_nan() || field.eq_ignore_ascii_case(b"nan")) => {
            Kind::Numbers
        }
        () if share(&|field| seconds_of_date(field).is_some()) => Kind::Dates,
        () if share(&is_list) => Kind::Lists(fields().map(|field| items(field).len()).max().unwrap_or(0)),
        () if fields().next().is_none() => Kind::Numbers,
        () => Kind::Text,
    }
}
