//! The settings of a board by name.

use breakaway_core::link::{DriveUnit, Field, PositionUnit, Settings};
use serde_json::Value;

use super::scale::decimal;
use crate::nearest::nearest;

/// The settings as names and values, in their order. Units are symbols.
pub fn list(settings: &Settings) -> Vec<(String, Value)> {
    let Ok(Value::Object(fields)) = serde_json::to_value(settings) else { return Vec::new() };
    let mut list: Vec<(String, Value)> = fields
        .into_iter()
        .map(|(name, value)| {
            let value = match name.as_str() {
                "position_per_count" => decimal(settings.position_per_count).into(),
                "drive_full_scale" => decimal(settings.drive_full_scale).into(),
                "supply_v" => decimal(settings.supply_v).into(),
                "motor_resistance_ohm" => decimal(settings.motor_resistance_ohm).into(),
                "motor_inductance_h" => decimal(settings.motor_inductance_h).into(),
                "current_bandwidth_hz" => decimal(settings.current_bandwidth_hz).into(),
                "position_unit" => settings.position_unit.symbol().into(),
                "drive_unit" => settings.drive_unit.symbol().into(),
                _ => value,
            };
            (name, value)
        })
        .collect();
    // In the order of the fields; units last.
    list.sort_by_key(|(name, _)| Field::ALL.iter().position(|field| field.name() == name).unwrap_or(usize::MAX));
    list
}

/// Changes one setting, given as `name=value`.
///
/// # Errors
/// What is wrong with it: no such setting (with the nearest), not a value of it, out of range.
pub fn set(settings: &mut Settings, assignment: &str) -> Result<(), String> {
    let (name, text) = assignment.split_once('=').ok_or_else(|| format!("`{assignment}` is not NAME=VALUE"))?;
    let (name, text) = (name.trim(), text.trim());
    let names: Vec<String> = list(settings).into_iter().map(|(name, _)| name).collect();
    if !names.iter().any(|known| known == name) {
        let near = nearest(name, names.iter().map(String::as_str));
        let hint = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
        return Err(format!("there is no setting `{name}`{hint}"));
    }
    let need = Field::ALL.iter().find(|field| field.name() == name).map_or("", |field| field.need());
    let wrong = || format!("{name} = {text} is not valid: it must be {need}");
    match name {
        "position_unit" => {
            let unit = PositionUnit::ALL.into_iter().find(|unit| unit.symbol() == text);
            settings.position_unit = unit.ok_or_else(|| {
                format!(
                    "position_unit = {text} is not known; there are {}",
                    PositionUnit::ALL.map(PositionUnit::symbol).join(", ")
                )
            })?;
        }
        "drive_unit" => {
            let unit = DriveUnit::ALL.into_iter().find(|unit| unit.symbol() == text);
            settings.drive_unit = unit.ok_or_else(|| {
                format!(
                    "drive_unit = {text} is not known; there are {}",
                    DriveUnit::ALL.map(DriveUnit::symbol).join(", ")
                )
            })?;
        }
        _ => {
            let value: Value = serde_json::from_str(text).map_err(|_| wrong())?;
            let mut fields = serde_json::to_value(*settings).map_err(|error| error.to_string())?;
            fields[name] = value;
            *settings = serde_json::from_value(fields).map_err(|_| wrong())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_setting_can_be_listed_and_set_to_what_it_is() {
        let settings = Settings::default();
        let mut copy = settings;
        let list = list(&settings);
        assert_eq!(list.len(), 23);
        assert_eq!((list[0].0.as_str(), &list[0].1), ("drive_max_code", &Value::from(16_383)));
        for (name, value) in &list {
            let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            set(&mut copy, &format!("{name}={text}")).unwrap();
        }
        assert_eq!(copy, settings);
    }

    #[test]
    fn what_is_wrong_is_named() {
        let mut settings = Settings::default();
        for (assignment, part) in [
            ("drive_max=5", "did you mean `drive_max_code`?"),
            ("drive_max_code=70000", "1 to 32767 drive codes"),
            ("drive_max_code=half", "1 to 32767 drive codes"),
            ("encoder_reversed=1", "true or false"),
            ("drive_unit=kg", "V, A, N, Nm"),
            ("drive_unit", "not NAME=VALUE"),
        ] {
            let message = set(&mut settings, assignment).unwrap_err();
            assert!(message.contains(part), "{assignment}: {message}");
        }
        assert_eq!(settings, Settings::default());
    }
}
