//! Parquet: one column of doubles for each column of the recording. A field without a number is null.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, Repetition, Type};
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type as Schema;

use super::columns::{Columns, library};

pub(super) fn write(columns: &Columns, out: &mut impl Write) -> io::Result<()> {
    let bytes = bytes(columns).map_err(io::Error::other)?;
    out.write_all(&bytes)
}

fn bytes(columns: &Columns) -> Result<Vec<u8>, ParquetError> {
    let field = |name: &String| {
        let field = Schema::primitive_type_builder(name, Type::DOUBLE).with_repetition(Repetition::OPTIONAL);
        field.build().map(Arc::new)
    };
    let fields = columns.names.iter().map(field).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Schema::group_type_builder("recording").with_fields(fields).build()?);
    let header = columns.header.iter().map(|(key, value)| KeyValue::new(key.clone(), value.clone())).collect();
    let properties = WriterProperties::builder()
        .set_created_by(library())
        .set_compression(Compression::SNAPPY)
        .set_key_value_metadata(Some(header))
        .build();
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for values in &columns.values {
        let Some(mut column) = group.next_column()? else { break };
        let there: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
        let levels: Vec<i16> = values.iter().map(|value| i16::from(!value.is_nan())).collect();
        column.typed::<DoubleType>().write_batch(&there, Some(&levels), None)?;
        column.close()?;
    }
    group.close()?;
    writer.into_inner()
}
