//! Bags of ROS 2 in SQLite: a table of topics, one of messages in CDR, and since ROS 2 Iron one of definitions.
//!
//! SQLite itself reads the file, from memory. Only its two or three tables are asked, and only if they are plain tables. A view
//! or a virtual table would run what the file says.

use std::collections::HashMap;

use rusqlite::config::DbConfig;
use rusqlite::{Connection, OptionalExtension as _};

use super::Format;
use super::cdr::{self, Form};
use super::fault::Fault;
use super::gather::Gather;
use super::log::Log;
use super::ros_type::Types;

/// Definitions of older bags, which have none: of the types that motors are logged in. Each begins with its name.
const KNOWN: &str = include_str!("rosbag2.msg");
/// Bytes of the header that say how the file is written to, and their value for a file without a log beside it.
const JOURNAL: std::ops::Range<usize> = 18..20;
const NO_LOG: u8 = 1;

/// A topic that is read.
struct Topic {
    group: usize,
    name: String,
    types: Types,
    failed: bool,
}

/// Reads the bag.
pub(super) fn read(bytes: &[u8]) -> Result<Log, Fault> {
    bag(bytes).map_err(|error| match error {
        Error::Sqlite => Fault::Damaged { at: 0, what: "SQLite does not find its tables whole" },
        Error::Fault(fault) => fault,
    })
}

enum Error {
    Sqlite,
    Fault(Fault),
}

impl From<rusqlite::Error> for Error {
    fn from(_: rusqlite::Error) -> Self {
        Self::Sqlite
    }
}

impl From<Fault> for Error {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

fn bag(bytes: &[u8]) -> Result<Log, Error> {
    let mut whole = bytes.to_vec();
    if let Some(journal) = whole.get_mut(JOURNAL) {
        journal.fill(NO_LOG);
    }
    let mut file = Connection::open_in_memory()?;
    file.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true)?;
    file.set_db_config(DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false)?;
    file.deserialize_read_exact("main", whole.as_slice(), whole.len(), true)?;
    if !(is_table(&file, "topics")? && is_table(&file, "messages")?) {
        let what = "an SQLite file that is no bag of ROS 2".to_owned();
        return Err(Fault::Unsupported { what, instead: "write the signals as CSV" }.into());
    }
    let mut gather = Gather::default();
    let mut passed_over = Vec::new();
    let mut topics = topics(&file, &mut gather, &mut passed_over)?;
    let mut messages = file.prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp")?;
    let mut rows = messages.query([])?;
    while let Some(row) = rows.next()? {
        let (id, stamp_ns): (i64, i64) = (row.get(0)?, row.get(1)?);
        let Some(topic) = topics.get_mut(&id).filter(|topic| !topic.failed) else { continue };
        let message = row.get_ref(2)?.as_blob().map_err(|_| Error::Sqlite)?;
        if let Ok(leaves) = cdr::read(&topic.types, Form::Cdr, message) {
            let second = 1_000_000_000;
            let stamp_s = stamp_ns.div_euclid(second) as f64 + stamp_ns.rem_euclid(second) as f64 / 1e9;
            gather.row(topic.group, stamp_s)?;
            leaves.set(&mut gather, topic.group)?;
        } else {
            topic.failed = true;
            passed_over.push(format!("`{}`: a message that does not follow its definition", topic.name));
        }
    }
    let mut log = gather.log(Format::Sqlite)?;
    log.passed_over = passed_over;
    Ok(log)
}

/// Whether the file has a plain table of this name.
fn is_table(file: &Connection, name: &str) -> Result<bool, Error> {
    let sql: Option<Option<String>> = file
        .query_row("SELECT sql FROM sqlite_schema WHERE type = 'table' AND name = ?1", [name], |row| row.get(0))
        .optional()?;
    Ok(sql.flatten().is_some_and(|sql| sql.to_ascii_uppercase().starts_with("CREATE TABLE")))
}

/// The topics whose messages can be read, by number.
fn topics(file: &Connection, gather: &mut Gather, passed_over: &mut Vec<String>) -> Result<HashMap<i64, Topic>, Error> {
    let mut definitions: HashMap<String, String> = HashMap::new();
    if is_table(file, "message_definitions")? {
        let mut all = file.prepare(
            "SELECT topic_type, encoded_message_definition FROM message_definitions WHERE encoding = 'ros2msg'",
        )?;
        let mut rows = all.query([])?;
        while let Some(row) = rows.next()? {
            definitions.insert(row.get(0)?, row.get(1)?);
        }
    }
    let mut topics = HashMap::new();
    let mut all = file.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let mut rows = all.query([])?;
    while let Some(row) = rows.next()? {
        let (id, name, kind, form): (i64, String, String, String) =
            (row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?);
        let own = definitions.get(&kind).map(String::as_str).filter(|text| !text.is_empty());
        let types = own.or_else(|| known(&kind)).and_then(Types::read);
        match types {
            Some(types) if form == "cdr" => {
                let group = gather.group(&name)?;
                topics.insert(id, Topic { group, name, types, failed: false });
            }
            Some(_) => passed_over.push(format!("`{name}`: messages in `{form}`")),
            None => passed_over.push(format!("`{name}`: {kind}, which this bag does not define; convert it to MCAP")),
        }
    }
    Ok(topics)
}

/// The definition of a type that is known.
fn known(kind: &str) -> Option<&'static str> {
    let kind = kind.replace("/msg/", "/");
    KNOWN.split("\n@ ").find_map(|entry| {
        let (name, text) = entry.trim_start_matches("@ ").split_once('\n')?;
        (name == kind).then_some(text)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every definition that is kept is understood, and has all the types that it names.
    #[test]
    fn known_types_are_whole() {
        for kind in ["sensor_msgs/msg/JointState", "std_msgs/msg/Float64", "std_msgs/msg/Float64MultiArray"] {
            let types = Types::read(known(kind).unwrap()).unwrap();
            assert!(!types.root.is_empty(), "{kind}");
        }
        for entry in KNOWN.split("\n@ ") {
            let text = entry.split_once('\n').unwrap().1;
            assert!(Types::read(text).is_some(), "{entry}");
        }
        assert!(known("sensor_msgs/msg/Image").is_none());
    }
}
