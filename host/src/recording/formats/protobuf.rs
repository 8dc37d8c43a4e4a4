//! Messages of protobuf, by the definition that the log has of them.

use prost_reflect::{DescriptorPool, DynamicMessage, Kind, MessageDescriptor, ReflectMessage, Value};

use super::fault::Fault;
use super::guard::guarded;
use super::leaf::{Leaf, Leaves, MAX_ELEMENTS};

/// Most values of one message, and deepest message within a message.
const MAX_LEAVES: usize = 4096;
const MAX_DEPTH: usize = 16;

/// The definition of the message `name` in a set of definitions.
pub(super) fn definition(set: &[u8], name: &str) -> Option<MessageDescriptor> {
    // Version 0.16.5 of the crate panics while it words the error of a definition that is there twice.
    guarded(|| DescriptorPool::decode(set).ok()?.get_message_by_name(name)).flatten()
}

/// Reads a message.
pub(super) fn read(definition: &MessageDescriptor, message: &[u8]) -> Result<Leaves, Fault> {
    let refused = Fault::Damaged { at: 0, what: "a message does not follow its definition" };
    let message = guarded(|| DynamicMessage::decode(definition.clone(), message).ok()).flatten().ok_or(refused)?;
    let mut leaves = Leaves::default();
    add(&message, "", 0, &mut leaves);
    Ok(leaves)
}

fn add(message: &DynamicMessage, path: &str, depth: usize, leaves: &mut Leaves) {
    let from = leaves.len();
    for field in message.descriptor().fields() {
        // A number that is not written is 0; a message that is not written is none.
        let is_message = matches!(field.kind(), Kind::Message(_));
        if depth > MAX_DEPTH || leaves.len() > MAX_LEAVES || is_message && !message.has_field(&field) {
            continue;
        }
        let path = if path.is_empty() { field.name().to_owned() } else { format!("{path}/{}", field.name()) };
        match &*message.get_field(&field) {
            Value::List(items) if items.len() <= MAX_ELEMENTS => {
                let numbers: Option<Vec<f64>> = items.iter().map(number).collect();
                let texts: Option<Vec<String>> = items.iter().map(|item| item.as_str().map(str::to_owned)).collect();
                match (numbers, texts) {
                    (Some(numbers), _) if !is_message => leaves.push(&path, Leaf::Numbers(numbers)),
                    (_, Some(texts)) if !is_message => leaves.push(&path, Leaf::Texts(texts)),
                    _ => {
                        for (element, item) in items.iter().enumerate() {
                            if let Value::Message(inner) = item {
                                add(inner, &format!("{path}[{element}]"), depth + 1, leaves);
                            }
                        }
                    }
                }
            }
            Value::Message(inner) => add(inner, &path, depth + 1, leaves),
            Value::String(text) => leaves.push(&path, Leaf::Text(text.clone())),
            value => {
                if let Some(number) = number(value) {
                    leaves.push(&path, Leaf::Number(number));
                }
            }
        }
    }
    leaves.join_stamp(path, from);
}

/// The number in a value.
fn number(value: &Value) -> Option<f64> {
    Some(match value {
        Value::Bool(truth) => f64::from(u8::from(*truth)),
        Value::I32(number) | Value::EnumNumber(number) => f64::from(*number),
        Value::I64(number) => *number as f64,
        Value::U32(number) => f64::from(*number),
        Value::U64(number) => *number as f64,
        Value::F32(number) => f64::from(*number),
        Value::F64(number) => *number,
        _ => return None,
    })
}
