//! JSON schemas of the documents that `--json` prints. They stand in `host/schema`, made from the types.

use schemars::generate::SchemaSettings;
use schemars::transform::{RecursiveTransform, Transform};
use schemars::{JsonSchema, Schema};
use serde_json::{Value, json};

use super::output::SCHEMA_VERSION;
use super::virtual_board;
use super::{
    bode, capture, completions, demo, device, discover, effects, export, failure, identify, look, man, models, run,
    simulate, sinefit, track, tune,
};
use crate::report;
use crate::report::remark::RemarkJson;

/// The schema of each document, with its name: the command's, and its variant's where it has several.
pub fn schemas() -> Vec<(&'static str, Value)> {
    vec![
        ("bode", of::<bode::Document>()),
        ("capture", of::<capture::Document>()),
        ("completions", of::<completions::Document>()),
        ("demo", of::<demo::Document>()),
        ("demo-virtual", of::<demo::board::Document>()),
        ("device-done", of::<device::documents::Done>()),
        ("device-fault", of::<device::documents::Fault>()),
        ("device-identify", of::<device::documents::Identified>()),
        ("device-info", of::<device::documents::Info<'_>>()),
        ("device-list", of::<Vec<device::documents::Entry<'_>>>()),
        ("device-model", of::<device::documents::Model<'_>>()),
        ("device-moved", of::<device::documents::Moved>()),
        ("device-settings", of::<device::documents::Settings>()),
        ("device-status", of::<device::documents::Status>()),
        ("device-stop", of::<device::documents::Stopped>()),
        ("device-zero", of::<device::documents::Zeroed>()),
        ("discover", of::<report::json::Document<'_>>()),
        ("discover-fleet", of::<discover::fleet::Document<'_>>()),
        ("effects", of::<effects::Document>()),
        ("error", of::<failure::Document<'_>>()),
        ("export", of::<export::Document<'_>>()),
        ("identify", of::<identify::Document>()),
        ("look", of::<look::Document<'_>>()),
        ("man", of::<man::Document>()),
        ("models-add", of::<models::add::Document>()),
        ("models-compare", of::<models::Compared<'_>>()),
        ("models-list", of::<models::List>()),
        ("models-show", of::<models::Shown<'_>>()),
        ("run", of::<run::Document>()),
        ("simulate", of::<simulate::Document>()),
        ("sinefit", of::<sinefit::Document>()),
        ("track", of::<track::Document>()),
        ("track-follow", of::<track::follow::Document>()),
        ("tune", of::<tune::Document>()),
        ("virtual-board", of::<virtual_board::Document>()),
    ]
}

/// The schema of a document, with what every document has.
fn of<T: JsonSchema>() -> Value {
    let mut schema = SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<T>();
    RecursiveTransform(number_or_null).transform(&mut schema);
    let remarks = SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<Vec<RemarkJson>>();
    let mut value = schema.to_value();
    if let Some(definitions) = remarks.get("$defs").and_then(Value::as_object) {
        let own = value.as_object_mut().map(|own| own.entry("$defs").or_insert_with(|| json!({})));
        if let Some(Value::Object(own)) = own {
            own.extend(definitions.clone());
        }
    }
    if let Some(properties) = value.get_mut("properties").and_then(Value::as_object_mut) {
        properties.insert("remarks".to_owned(), json!({ "type": "array", "items": { "$ref": "#/$defs/RemarkJson" } }));
        properties.insert("schema_version".to_owned(), json!({ "const": SCHEMA_VERSION }));
    }
    if let Some(required) = value.get_mut("required").and_then(Value::as_array_mut) {
        required.push("schema_version".into());
    }
    value
}

/// A number that is not known is `null`.
fn number_or_null(schema: &mut Schema) {
    if schema.get("type") == Some(&json!("number")) {
        schema.insert("type".to_owned(), json!(["number", "null"]));
    }
}
