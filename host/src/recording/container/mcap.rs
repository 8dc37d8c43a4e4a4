//! MCAP: one channel, `axis`, of messages in JSON with their schema. Without packing, so that every reader opens it.

use std::collections::BTreeMap;
use std::io::{self, Cursor, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::{McapError, WriteOptions};

use super::columns::{Columns, library};

/// The channel.
const TOPIC: &str = "axis";
/// The name of its schema.
const SCHEMA: &str = "breakaway.Sample";

pub(super) fn write(columns: &Columns, out: &mut impl Write) -> io::Result<()> {
    let bytes = bytes(columns).map_err(|error| match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    })?;
    out.write_all(&bytes)
}

fn bytes(columns: &Columns) -> Result<Vec<u8>, McapError> {
    let mut writer = WriteOptions::new().compression(None).library(library()).create(Cursor::new(Vec::new()))?;
    let schema = writer.add_schema(SCHEMA, "jsonschema", schema(columns).to_string().as_bytes())?;
    let channel = writer.add_channel(schema, TOPIC, "json", &BTreeMap::new())?;
    writer.write_metadata(&Metadata {
        name: "recording".to_owned(),
        metadata: columns.header.iter().cloned().collect(),
    })?;
    let first_s = columns.values.first().and_then(|t| t.first()).copied().unwrap_or_default();
    for row in 0..columns.rows() {
        let t_s = columns.values[0][row];
        // Stamps are not negative; the time itself is in the message.
        let log_time = ((t_s - first_s.min(0.0)) * 1e9).round() as u64;
        let fields = columns.names.iter().zip(&columns.values);
        let message: serde_json::Map<String, serde_json::Value> =
            fields.map(|(name, values)| (name.clone(), values[row].into())).collect();
        let header = MessageHeader { channel_id: channel, sequence: row as u32, log_time, publish_time: log_time };
        writer.write_to_known_channel(&header, serde_json::Value::Object(message).to_string().as_bytes())?;
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

/// The schema of a message. A field without a number is `null`.
fn schema(columns: &Columns) -> serde_json::Value {
    let number = serde_json::json!({ "type": ["number", "null"] });
    let properties: serde_json::Map<String, serde_json::Value> =
        columns.names.iter().map(|name| (name.clone(), number.clone())).collect();
    serde_json::json!({ "title": SCHEMA, "type": "object", "properties": properties })
}
