//! Messages in JSON.

use serde_json::Value;

use super::fault::Fault;
use super::leaf::{Leaf, Leaves, MAX_ELEMENTS};

/// Reads a message. serde_json refuses values more than 128 deep.
pub(super) fn read(message: &[u8]) -> Result<Leaves, Fault> {
    let damaged = |_| Fault::Damaged { at: 0, what: "a message is not JSON" };
    let value: Value = serde_json::from_slice(message).map_err(damaged)?;
    let mut leaves = Leaves::default();
    add(&value, if value.is_object() { "" } else { "value" }, &mut leaves);
    Ok(leaves)
}

fn add(value: &Value, path: &str, leaves: &mut Leaves) {
    let number = |value: &Value| value.as_f64().or_else(|| value.as_bool().map(|truth| f64::from(u8::from(truth))));
    if let Some(number) = number(value) {
        leaves.push(path, Leaf::Number(number));
        return;
    }
    match value {
        Value::String(text) => leaves.push(path, Leaf::Text(text.clone())),
        Value::Object(fields) => {
            let from = leaves.len();
            for (name, value) in fields {
                add(value, &if path.is_empty() { name.clone() } else { format!("{path}/{name}") }, leaves);
            }
            sort_stamp(leaves, path, from);
        }
        Value::Array(items) if items.len() <= MAX_ELEMENTS => {
            let numbers: Option<Vec<f64>> = items.iter().map(number).collect();
            let texts: Option<Vec<String>> = items.iter().map(|item| item.as_str().map(str::to_owned)).collect();
            match (numbers, texts) {
                (Some(numbers), _) => leaves.push(path, Leaf::Numbers(numbers)),
                (_, Some(texts)) => leaves.push(path, Leaf::Texts(texts)),
                _ => items.iter().enumerate().for_each(|(k, item)| add(item, &format!("{path}[{k}]"), leaves)),
            }
        }
        _ => {}
    }
}

/// Makes one number of a stamp's seconds and nanoseconds, whichever comes first: JSON has no order.
fn sort_stamp(leaves: &mut Leaves, path: &str, from: usize) {
    leaves.sort_from(from);
    leaves.join_stamp(path, from);
}
