//! Simulated recordings.

use breakaway::model::Model;
use breakaway::simulate::axis::{Axis, Run};
use breakaway::simulate::experiment::Experiment;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{array, column};
use crate::error::exception;
use crate::recording::Recording;
use crate::work::away;

/// A recording, the positions without noise and steps, and where the travel limit ended it.
type Simulated = (Recording, Py<PyArray1<f64>>, Option<f64>);

/// An experiment from a file, from TOML or from the tables of such a file as JSON; which of them is said by `form`.
fn experiment(form: &str, text: &str) -> anyhow::Result<Experiment> {
    Ok(match form {
        "file" => Experiment::read(text.as_ref())?,
        "toml" => Experiment::parse("the experiment", text)?,
        _ => {
            let tables: serde_json::Value = serde_json::from_str(text)?;
            Experiment::parse("the experiment", &toml::to_string(&tables)?)?
        }
    })
}

fn simulated(py: Python<'_>, run: Run) -> PyResult<Simulated> {
    let Run { recording, true_x, tripped, .. } = run;
    let name = recording.name.clone();
    // It was made of the model and the experiment, not of a file.
    Ok((Recording::new(py, recording, name, String::new(), "x")?, array(py, true_x)?, tripped))
}

/// Runs an experiment on a simulated axis at rest.
#[pyfunction]
pub fn simulate(py: Python<'_>, model: String, form: String, text: String) -> PyResult<Simulated> {
    let run = away(py, None, move |_| {
        let model = Model::parse("the model", &model)?;
        let experiment = experiment(&form, &text)?;
        Ok(Axis::new(model.base, &model.plant_effects()?, model.units.clone()).run(&experiment)?)
    })?;
    simulated(py, run)
}

/// Applies the drive `u` to a simulated axis at rest. Of the experiment the clock, the sensor and the limits are used.
#[pyfunction]
pub fn simulate_drive(py: Python<'_>, model: String, u: &Bound<'_, PyAny>, text: String) -> PyResult<Simulated> {
    let u = column("u", u)?;
    if let Some(at) = u.iter().position(|u| !u.is_finite()) {
        let refused = py.import("breakaway._errors")?.getattr("ArrayError")?;
        let message = format!("u[{at}] is {}; a drive that is applied is a finite number", u[at]);
        return Err(PyErr::from_value(refused.call1((message,))?));
    }
    let experiment = experiment("json", &text).map_err(|error| exception(py, &error))?;
    let run = away(py, None, move |_| {
        let model = Model::parse("the model", &model)?;
        let mut axis = Axis::new(model.base, &model.plant_effects()?, model.units.clone());
        Ok(axis.run_with(&experiment, |k, _| u.get(k).copied().unwrap_or(0.0))?)
    })?;
    simulated(py, run)
}
