//! Models and what is written: texts in and out, so that there is one reader and one writer.

use std::path::PathBuf;

use anyhow::Context as _;
use breakaway::command::UsageError;
use breakaway::command::export::Document;
use breakaway::command::output::with_warnings;
use breakaway::export::{self as exports, Motor, Request};
use breakaway::file::{FileKind, Target, may_write};
use breakaway::model::Model;
use breakaway::models;
use pyo3::prelude::*;
use serde_json::{Value, json};

use crate::error::exception;

/// A model as a document: what the Python class holds.
fn document(model: &Model) -> Value {
    let se = &model.base_se;
    let effects = model
        .effects
        .iter()
        .map(|effect| json!({ "name": effect.name, "parameters": effect.parameters, "se": effect.se }));
    json!({
        "b": model.base.b, "c": model.base.c, "f1": model.base.f1,
        "se": { "b": se.b, "c": se.c, "f1": se.f1 },
        "units": { "u": model.units.u, "x": model.units.x },
        "effects": effects.collect::<Vec<_>>(),
        "provenance": model.provenance,
        "toml": model.to_toml(),
    })
}

/// Reads a model from text.
#[pyfunction]
pub fn parse_model(py: Python<'_>, name: &str, text: &str) -> PyResult<String> {
    let model = Model::parse(name, text).map_err(|error| exception(py, &error.into()))?;
    Ok(document(&model).to_string())
}

/// Reads a model file, or a card of the motor library.
#[pyfunction]
pub fn read_model(py: Python<'_>, path: PathBuf) -> PyResult<String> {
    let model = py.detach(|| Model::read(&path)).map_err(|error| exception(py, &error.into()))?;
    Ok(document(&model).to_string())
}

/// Makes a model of the tables of a model file, as JSON.
#[pyfunction]
pub fn make_model(py: Python<'_>, tables: &str) -> PyResult<String> {
    let made = || {
        let tables: Value = serde_json::from_str(tables)?;
        let text = toml::to_string(&tables).context("the model cannot be written as TOML")?;
        Ok(document(&Model::parse("the model", &text)?).to_string())
    };
    made().map_err(|error: anyhow::Error| exception(py, &error))
}

/// Motor and gear, as the command's flags have them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct MotorOptions {
    motor_constant: Option<f64>,
    resistance: Option<f64>,
    supply: Option<f64>,
    motor: Option<String>,
    gear: Option<f64>,
    drive_gain: Option<f64>,
    drive: Option<String>,
    encoder: Option<String>,
    counts_per_turn: Option<f64>,
}

impl MotorOptions {
    fn motor(self) -> anyhow::Result<Motor> {
        let refused = |name: &'static str| move |expected: String| UsageError(format!("{name}: {expected}"));
        let numbers = [
            ("motor_constant", self.motor_constant),
            ("resistance", self.resistance),
            ("supply", self.supply),
            ("gear", self.gear),
            ("drive_gain", self.drive_gain),
            ("counts_per_turn", self.counts_per_turn),
        ];
        let wrong = |value: &f64| !(value.is_finite() && *value > 0.0);
        if let Some((name, _)) = numbers.iter().find(|(_, value)| value.as_ref().is_some_and(wrong)) {
            return Err(refused(name)("expected a positive number".to_owned()).into());
        }
        let given = Motor {
            drive: self.drive.map(|text| text.parse().map_err(refused("drive"))).transpose()?,
            motor_constant: self.motor_constant,
            resistance: self.resistance,
            supply: self.supply,
            gear: self.gear,
            drive_gain: self.drive_gain,
            encoder: self.encoder.map(|text| text.parse().map_err(refused("encoder"))).transpose()?.unwrap_or_default(),
            counts_per_turn: self.counts_per_turn,
        };
        match &self.motor {
            Some(name) => Ok(models::card(name)?.motor.beside(&given)),
            None => Ok(given),
        }
    }
}

/// Exports a model: the document, which holds the file's text.
#[pyfunction]
#[pyo3(signature = (model, target, *, name, timestep, motor))]
pub fn export(
    py: Python<'_>,
    model: &str,
    target: &str,
    name: String,
    timestep: f64,
    motor: MotorOptions,
) -> PyResult<String> {
    let done = || {
        let refused = |name: &'static str| move |expected: String| UsageError(format!("{name}: {expected}"));
        if !(timestep.is_finite() && timestep > 0.0) {
            return Err(refused("timestep")("expected a positive number".to_owned()).into());
        }
        let target: exports::Target = target.parse().map_err(refused("to"))?;
        let model = Model::parse("the model", model)?;
        let request = Request { target, motor: motor.motor()?, name, timestep_s: timestep };
        let exported = exports::export(&model, &request)?;
        Ok(with_warnings(&Document::new(&exported, target, None), Vec::new())?.to_string())
    };
    done().map_err(|error: anyhow::Error| exception(py, &error))
}

/// Writes a text, whole or not at all; not over what breakaway did not write, unless `force`.
#[pyfunction]
pub fn write_text(py: Python<'_>, path: PathBuf, text: &str, kind: &str, force: bool) -> PyResult<()> {
    let kind = match kind {
        "model" => FileKind::Model,
        "report" => FileKind::Page,
        _ => FileKind::Export,
    };
    let written = py.detach(|| {
        may_write(&path, kind, &[], force)?;
        Target::File(path).write_text(text)
    });
    written.map_err(|error| exception(py, &error.into()))
}
