//! Identification, discovery and the sine fit: each gives the document that the command prints with `--json`.

use anyhow::Context as _;
use breakaway::command::output::with_warnings;
use breakaway::command::{discover as command, identify as identification, sinefit as sine_command};
use breakaway::model::Model;
use breakaway::recording::{ReadOptions, Signal};
use breakaway::report::{discovery, json};
use breakaway::sine;
use pyo3::prelude::*;

use crate::arrays::column;
use crate::recording::{Recording, Taken, log};
use crate::work::{away, with_threads};

/// Identifies: the document, and the model as TOML.
#[pyfunction]
#[pyo3(signature = (recordings, *, back_emf, threads))]
pub fn identify(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    back_emf: Option<f64>,
    threads: Option<usize>,
) -> PyResult<(String, String)> {
    let taken = Taken::of(py, &recordings)?;
    away(py, None, move |_| {
        with_threads(threads, || {
            let warnings = taken.warnings.clone();
            let found = identification::find(&taken.session()?, back_emf)?;
            let document = with_warnings(&found.document(), warnings)?;
            Ok((document.to_string(), found.model()?.to_toml()))
        })
    })
}

/// Discovers: the document, the improved model as TOML, and the report as HTML.
#[pyfunction]
#[pyo3(signature = (recordings, holdout, *, model, command, threads, progress))]
pub fn discover(
    py: Python<'_>,
    recordings: Vec<Py<Recording>>,
    holdout: Vec<Py<Recording>>,
    model: Option<(String, String)>,
    command: String,
    threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, String, String)> {
    let (fit, score) = (Taken::of(py, &recordings)?, Taken::of(py, &holdout)?);
    away(py, progress, move |steps| {
        with_threads(threads, || {
            let warnings = [fit.warnings.clone(), score.warnings.clone()].concat();
            let model = model.map(|(file, text)| Model::parse(&file, &text)).transpose()?;
            let (fit, score) = (fit.session()?, score.session()?);
            let watch = |progress: breakaway::discover::progress::Progress<'_>| steps.show(progress);
            let (found, folds) = command::find_in(fit, score, model, command, &watch)?;
            let document = with_warnings(&json::Document::from(&found), warnings)?;
            let improved = command::improved(&found).to_toml();
            Ok((document.to_string(), improved, discovery::html(&found, &folds)))
        })
    })
}

/// Fits one sine: the document.
#[pyfunction]
#[pyo3(signature = (t, x, *, period, name))]
pub fn sinefit(
    py: Python<'_>,
    t: &Bound<'_, PyAny>,
    x: &Bound<'_, PyAny>,
    period: Option<f64>,
    name: String,
) -> PyResult<String> {
    let channels = vec![("t", Some("s".to_owned()), column("t", t)?), ("x", None, column("x", x)?)];
    away(py, None, move |_| {
        let (signal, found) = Signal::from_log(&name, &log(channels), &ReadOptions::default())?;
        let fit = sine::fit(&signal, f64::NEG_INFINITY..=f64::INFINITY, period);
        let fit = fit.with_context(|| format!("{name}: column `{}`", signal.column))?;
        let warnings = found.iter().map(|warning| format!("{name}: {warning}")).collect();
        Ok(with_warnings(&sine_command::Document::from(fit), warnings)?.to_string())
    })
}
