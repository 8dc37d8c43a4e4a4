//! Apache Parquet: flat columns of numbers and texts. Columns of lists and structures are passed over.

use std::rc::Rc;

use bytes::Bytes;
use parquet::basic::{LogicalType, TimeUnit};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use super::Format;
use super::fault::Fault;
use super::guard::guarded;
use super::log::{Channel, Log, MAX_CHANNELS, MAX_VALUES, Values};

/// Rows that are read at once.
const BATCH: usize = 1 << 14;

/// Reads the file's columns.
pub(super) fn read(bytes: &[u8]) -> Result<Log, Fault> {
    let bytes = Bytes::copy_from_slice(bytes);
    let damaged = Fault::Damaged { at: 0, what: "a page does not follow the format" };
    let (channels, passed_over) = guarded(|| columns(bytes)).unwrap_or(Err(damaged))?;
    let mut log = Log::of_arrays(Format::Parquet, channels)?;
    log.passed_over = passed_over;
    Ok(log)
}

/// What the crate says.
fn refused(error: &ParquetError) -> Fault {
    // It names the feature or the codec that is not there.
    let text = error.to_string().to_uppercase();
    let packing = ["BROTLI", "LZO"].into_iter().find(|name| text.contains(name));
    match packing {
        Some(name) => {
            let what = format!("Parquet packed by {name}");
            Fault::Unsupported { what, instead: "write it with compression \"snappy\" or \"gzip\"" }
        }
        None => Fault::Damaged { at: 0, what: "its table of contents or a page is not whole" },
    }
}

fn columns(bytes: Bytes) -> Result<(Vec<Channel>, Vec<String>), Fault> {
    let file = SerializedFileReader::new(bytes).map_err(|error| refused(&error))?;
    let schema = file.metadata().file_metadata().schema_descr();
    if schema.num_columns() > MAX_CHANNELS {
        return Err(Fault::TooLarge { what: "channels", most: MAX_CHANNELS });
    }
    let (mut channels, mut passed_over, mut left) = (Vec::new(), Vec::new(), MAX_VALUES);
    for index in 0..schema.num_columns() {
        let column = schema.column(index);
        let name = column.path().string();
        if column.max_rep_level() > 0 {
            passed_over.push(format!("`{name}`: lists"));
            continue;
        }
        let (mut numbers, mut texts): (Vec<f64>, Vec<Rc<str>>) = (Vec::new(), Vec::new());
        for group in 0..file.num_row_groups() {
            let group = file.get_row_group(group).map_err(|error| refused(&error))?;
            let reader = group.get_column_reader(index).map_err(|error| refused(&error))?;
            let full = column.max_def_level();
            let added = match reader {
                ColumnReader::BoolColumnReader(reader) => {
                    add(reader, full, left, |value| f64::from(u8::from(*value)), f64::NAN, &mut numbers)
                }
                ColumnReader::Int32ColumnReader(reader) => {
                    add(reader, full, left, |value| f64::from(*value), f64::NAN, &mut numbers)
                }
                ColumnReader::Int64ColumnReader(reader) => {
                    let per_second = per_second(&column);
                    add(reader, full, left, |value| *value as f64 / per_second, f64::NAN, &mut numbers)
                }
                ColumnReader::FloatColumnReader(reader) => {
                    add(reader, full, left, |value| f64::from(*value), f64::NAN, &mut numbers)
                }
                ColumnReader::DoubleColumnReader(reader) => {
                    add(reader, full, left, |value| *value, f64::NAN, &mut numbers)
                }
                ColumnReader::ByteArrayColumnReader(reader) => {
                    let text = |value: &parquet::data_type::ByteArray| String::from_utf8_lossy(value.data()).into();
                    add(reader, full, left, text, Rc::from(""), &mut texts)
                }
                ColumnReader::Int96ColumnReader(_) | ColumnReader::FixedLenByteArrayColumnReader(_) => Ok(0),
            }?;
            left -= added;
        }
        let unit = (per_second(&column) > 1.0).then(|| "s".to_owned());
        let values = if texts.is_empty() { Values::Numbers(numbers) } else { Values::Texts(texts) };
        if values.is_empty() {
            passed_over.push(format!("`{name}`: neither numbers nor text"));
        } else {
            channels.push(Channel { name, unit, values });
        }
    }
    Ok((channels, passed_over))
}

/// Steps of a date per second; 1 for what is none.
fn per_second(column: &ColumnDescriptor) -> f64 {
    match column.logical_type_ref() {
        Some(LogicalType::Timestamp(time) | LogicalType::Time(time)) => match time.unit {
            TimeUnit::MILLIS => 1e3,
            TimeUnit::MICROS => 1e6,
            TimeUnit::NANOS => 1e9,
        },
        _ => 1.0,
    }
}

/// Adds a column's values of one group of rows, `none` where a row has none; `full` is the level of a row that has one. At
/// most `left`. Returns how many.
fn add<T: DataType, V: Clone>(
    mut reader: ColumnReaderImpl<T>,
    full: i16,
    left: usize,
    value: impl Fn(&T::T) -> V,
    none: V,
    out: &mut Vec<V>,
) -> Result<usize, Fault> {
    let before = out.len();
    loop {
        let (mut values, mut levels) = (Vec::new(), Vec::new());
        let read = reader.read_records(BATCH, (full > 0).then_some(&mut levels), None, &mut values);
        let (records, ..) = read.map_err(|error| refused(&error))?;
        if records == 0 {
            return Ok(out.len() - before);
        }
        if out.len() - before + records > left {
            return Err(Fault::TooLarge { what: "values", most: MAX_VALUES });
        }
        let mut values = values.iter();
        if full == 0 {
            out.extend(values.map(&value));
        } else {
            out.extend(levels.iter().map(|level| {
                let present = (*level == full).then(|| values.next()).flatten();
                present.map_or_else(|| none.clone(), &value)
            }));
        }
    }
}
