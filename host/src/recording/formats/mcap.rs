//! MCAP: schemas, channels and messages, in chunks that may be packed by lz4 or zstd.
//!
//! Read here are messages in CDR, of ROS 1 and in protobuf with their definitions, and in JSON. The crate `mcap` is not used: it unpacks by
//! C libraries, and only records are needed here.

use std::collections::HashMap;
use std::io::Read;

use prost_reflect::MessageDescriptor;
use ruzstd::decoding::StreamingDecoder;

use super::bytes::Bytes;
use super::cdr::Form;
use super::fault::Fault;
use super::gather::Gather;
use super::leaf::Leaves;
use super::log::Log;
use super::ros_type::Types;
use super::{Format, cdr, json, protobuf};

/// Bytes before the first record.
const MAGIC: usize = 8;
/// Most bytes of a chunk, unpacked. Writers make chunks of 1 to 4 MB; one with an image of a camera is larger.
const MAX_CHUNK: usize = 1 << 28;

/// How the messages of a channel are read.
#[derive(Debug)]
enum Encoding {
    Ros(Types, Form),
    Json,
    Protobuf(MessageDescriptor),
}

/// A channel that is read.
#[derive(Debug)]
struct Topic {
    group: usize,
    encoding: Encoding,
    /// Whether a message could not be read; the others are tried no more.
    failed: bool,
    name: String,
}

#[derive(Debug, Default)]
struct Reader {
    /// Encoding and text of each schema.
    schemas: HashMap<u16, (String, String, Vec<u8>)>,
    topics: HashMap<u16, Option<Topic>>,
    gather: Gather,
    passed_over: Vec<String>,
}

/// Reads the file.
pub(super) fn read(bytes: &[u8]) -> Result<Log, Fault> {
    let mut bytes = Bytes::new(bytes);
    bytes.take(MAGIC)?;
    let mut reader = Reader::default();
    let torn_at = reader.records(&mut bytes, true)?;
    let mut log = reader.gather.log(Format::Mcap)?;
    (log.torn_at, log.passed_over) = (torn_at, reader.passed_over);
    Ok(log)
}

impl Reader {
    /// Reads records up to the end of the data. Returns where a record begins that is not whole, as a recorder leaves it that
    /// was stopped hard.
    fn records(&mut self, bytes: &mut Bytes<'_>, chunks: bool) -> Result<Option<u64>, Fault> {
        while !bytes.is_empty() {
            let began = bytes.at as u64;
            let mut head = || Ok((bytes.u8()?, bytes.u64()?));
            let content = head().and_then(|(kind, length)| {
                let length = usize::try_from(length).unwrap_or(usize::MAX);
                Ok((kind, bytes.take(length)?))
            });
            let (kind, content) = match content {
                Err(Fault::Truncated { .. }) => return Ok(Some(began)),
                content => content?,
            };
            let mut content = Bytes::new(content);
            let done = match kind {
                0x03 => self.schema(&mut content),
                0x04 => self.topic(&mut content),
                0x05 => self.message(&mut content),
                0x06 if chunks => self.chunk(&mut content),
                // The end of the data, and the footer: what follows is an index.
                0x0f | 0x02 => return Ok(None),
                _ => Ok(()),
            };
            done.map_err(|fault| match fault {
                Fault::Truncated { .. } => {
                    Fault::Damaged { at: began, what: "a record is too short for what it holds" }
                }
                Fault::Damaged { what, .. } => Fault::Damaged { at: began, what },
                other => other,
            })?;
        }
        Ok(None)
    }

    fn schema(&mut self, content: &mut Bytes<'_>) -> Result<(), Fault> {
        let (id, name, encoding) = (content.u16()?, content.text32()?, content.text32()?);
        let length = content.u32()? as usize;
        self.schemas.insert(id, (name, encoding, content.take(length)?.to_vec()));
        Ok(())
    }

    fn topic(&mut self, content: &mut Bytes<'_>) -> Result<(), Fault> {
        let (id, schema, name, encoding) = (content.u16()?, content.u16()?, content.text32()?, content.text32()?);
        // Each chunk may repeat it.
        if self.topics.contains_key(&id) {
            return Ok(());
        }
        let schema = self.schemas.get(&schema);
        let definition = || {
            let (_, encoding, text) = schema?;
            let text = matches!(encoding.as_str(), "ros2msg" | "ros1msg").then(|| String::from_utf8_lossy(text))?;
            Types::read(&text)
        };
        let encoding_of = match encoding.as_str() {
            "json" => Some(Encoding::Json),
            "protobuf" => schema
                .filter(|(_, encoding, _)| encoding == "protobuf")
                .and_then(|(name, _, set)| protobuf::definition(set, name))
                .map(Encoding::Protobuf),
            "cdr" => definition().map(|types| Encoding::Ros(types, Form::Cdr)),
            "ros1" => definition().map(|types| Encoding::Ros(types, Form::Ros1)),
            _ => None,
        };
        let topic = if let Some(encoding) = encoding_of {
            let group = self.gather.group(&name)?;
            Some(Topic { group, encoding, failed: false, name })
        } else {
            let schema = schema.map_or("none", |(_, encoding, _)| encoding.as_str());
            self.passed_over.push(format!("`{name}`: messages in `{encoding}` with a schema in `{schema}`"));
            None
        };
        self.topics.insert(id, topic);
        Ok(())
    }

    fn message(&mut self, content: &mut Bytes<'_>) -> Result<(), Fault> {
        let (id, _sequence, logged_ns, _published_ns) =
            (content.u16()?, content.u32()?, content.u64()?, content.u64()?);
        let Some(Some(topic)) = self.topics.get_mut(&id) else { return Ok(()) };
        if topic.failed {
            return Ok(());
        }
        let message = content.take(content.left())?;
        let leaves: Result<Leaves, Fault> = match &topic.encoding {
            Encoding::Ros(types, form) => cdr::read(types, *form, message),
            Encoding::Json => json::read(message),
            Encoding::Protobuf(definition) => protobuf::read(definition, message),
        };
        if let Ok(leaves) = leaves {
            self.gather.row(topic.group, seconds(logged_ns))?;
            return leaves.set(&mut self.gather, topic.group);
        }
        topic.failed = true;
        self.passed_over.push(format!("`{}`: a message that does not follow its definition", topic.name));
        Ok(())
    }

    fn chunk(&mut self, content: &mut Bytes<'_>) -> Result<(), Fault> {
        let (_first_ns, _last_ns, size, _crc) = (content.u64()?, content.u64()?, content.u64()?, content.u32()?);
        let packing = content.text32()?;
        let length = usize::try_from(content.u64()?).unwrap_or(usize::MAX);
        let packed = content.take(length)?;
        if size > MAX_CHUNK as u64 {
            return Err(Fault::TooLarge { what: "bytes in a chunk", most: MAX_CHUNK });
        }
        let damaged = Fault::Damaged { at: 0, what: "a chunk cannot be unpacked" };
        let unpacked = match packing.as_str() {
            "" => packed.to_vec(),
            "lz4" => whole(lz4_flex::frame::FrameDecoder::new(packed), size).ok_or(damaged)?,
            "zstd" => {
                let decoder = StreamingDecoder::new_with_max_window_size(packed, MAX_CHUNK as u64)
                    .map_err(|_| damaged.clone())?;
                whole(decoder, size).ok_or(damaged)?
            }
            other => {
                let what = format!("a chunk packed by `{}`", crate::recording::field::shown(other));
                return Err(Fault::Unsupported { what, instead: "pack it by zstd or lz4" });
            }
        };
        match self.records(&mut Bytes::new(&unpacked), false)? {
            Some(_) => Err(Fault::Damaged { at: 0, what: "a chunk ends inside a record" }),
            None => Ok(()),
        }
    }
}

/// The `size` bytes that a reader gives.
fn whole(reader: impl Read, size: u64) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.take(size).read_to_end(&mut bytes).ok()?;
    (bytes.len() as u64 == size).then_some(bytes)
}

/// Seconds of a stamp in ns: whole seconds and the rest by themselves, so that no digit is lost twice.
fn seconds(ns: u64) -> f64 {
    (ns / 1_000_000_000) as f64 + (ns % 1_000_000_000) as f64 / 1e9
}
