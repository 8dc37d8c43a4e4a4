//! `breakaway identify`.

use std::fmt::Write as _;
#[cfg(feature = "command")]
use std::path::Path;
use std::path::PathBuf;

use anyhow::Context;
use breakaway_core::plant::Base;
use schemars::JsonSchema;
use serde::Serialize;

#[cfg(feature = "command")]
use super::figures::FiguresArgs;
#[cfg(feature = "command")]
use super::output::Output;
use super::recording_args::RecordingArgs;
use super::session::Session;
#[cfg(feature = "command")]
use crate::file::FileKind;
use crate::file::Target;
use crate::identify::estimate::{self, Comparison, Identification, ModelEstimate, Value, Winding};
#[cfg(feature = "command")]
use crate::identify::typical::typical;
use crate::model::{BaseSe, EffectEntry, Model};
use crate::recording::Units;
use crate::report::choice;
#[cfg(feature = "command")]
use crate::report::identification::typical_figure;
use crate::report::json::Quantity;
use crate::report::remark::RemarkJson;

/// Identify inertia, viscous and Coulomb friction from recordings, with standard errors
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway identify run.csv --time t_s --input u_V --position x_m -o model.toml

JSON: b, c, f1, load (value, se, unit; load null where it is not significant), undetermined (parameter, advice),
noise (of the position), estimator, chosen_because, held_out (blocks, error_ratio, t; null where none was held out),
estimators (name, b, c, f1, load, holdout: its held-out error over the chosen one's), gravity (travel_rad, blocks, error_ratio, t, helps; null where it was not tried), white, simulation_error,
residual_correlation, winding (resistance, back_emf, inductance, viscous: what is left of c; null where no current is recorded),
remarks.")]
pub struct Args {
    /// Recordings of one session
    #[arg(value_name = "REC", required = true)]
    pub recordings: Vec<PathBuf>,
    /// Write the model to this file; `-` is standard output
    #[arg(short, long, value_name = "M.toml")]
    pub output: Option<Target>,
    /// Back-EMF constant of the name plate, V per position unit and second (in rad: the torque constant in Nm/A). It parts c into
    /// back-EMF and viscous friction where no current is recorded
    #[arg(long, value_name = "KE")]
    pub back_emf: Option<f64>,
    /// Figures.
    #[cfg(feature = "command")]
    #[command(flatten)]
    pub figures: FiguresArgs,
    /// Columns and rows.
    #[command(flatten)]
    pub columns: RecordingArgs,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Row {
    name: &'static str,
    b: Quantity,
    c: Quantity,
    f1: Quantity,
    load: Option<Quantity>,
    /// Held-out error over that of the estimator that is reported; null where it was not compared.
    holdout: Option<f64>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Missing {
    parameter: &'static str,
    advice: String,
}

/// Two models' prediction of held-out blocks.
#[derive(Debug, Serialize, JsonSchema)]
struct HeldOut {
    blocks: usize,
    /// Error of what is not reported, or of the base, over the error of what is, or of the base with gravity.
    error_ratio: f64,
    t: f64,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Gravity {
    travel_rad: f64,
    #[serde(flatten)]
    held_out: HeldOut,
    helps: bool,
}

/// The JSON document.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Document {
    b: Quantity,
    c: Quantity,
    f1: Quantity,
    load: Option<Quantity>,
    undetermined: Vec<Missing>,
    noise: f64,
    estimator: &'static str,
    chosen_because: String,
    held_out: Option<HeldOut>,
    estimators: Vec<Row>,
    gravity: Option<Gravity>,
    white: bool,
    simulation_error: f64,
    residual_correlation: f64,
    winding: Option<Electrical>,
    remarks: Vec<RemarkJson>,
}

/// The winding, and c without its back-EMF.
#[derive(Debug, Serialize, JsonSchema)]
struct Electrical {
    resistance: Quantity,
    back_emf: Quantity,
    inductance: Option<Quantity>,
    viscous: Quantity,
}

impl Electrical {
    fn new(winding: &Winding, c: Value, units: &Units) -> Self {
        let quantity = |value: Value, unit: &str| Quantity { value: value.value, se: value.se, unit: unit.to_owned() };
        let of_c = units.of_c();
        Self {
            resistance: quantity(winding.resistance, "Ω"),
            back_emf: quantity(winding.back_emf, &of_c),
            inductance: winding.inductance.map(|inductance| quantity(inductance, "H")),
            viscous: quantity(estimate::mechanical(c, winding.back_emf), &of_c),
        }
    }
}

impl Row {
    fn new(estimate: &ModelEstimate, units: &Units) -> Self {
        let quantity = |value: Value, unit: String| Quantity { value: value.value, se: value.se, unit };
        Self {
            name: estimate.estimator,
            b: quantity(estimate.b, units.of_b()),
            c: quantity(estimate.c, units.of_c()),
            f1: quantity(estimate.f1, units.of_f1()),
            load: estimate.load.map(|load| quantity(load, units.of_f1())),
            holdout: None,
        }
    }
}

impl HeldOut {
    fn new(comparison: &Comparison) -> Self {
        Self { blocks: comparison.blocks, error_ratio: comparison.ratio(), t: comparison.t() }
    }
}

impl Document {
    /// Of an identification; `left_out` says which recordings it did without.
    pub fn new(result: &Identification, units: &Units, left_out: Vec<String>) -> Self {
        let own = result.remarks.iter().map(|remark| RemarkJson::new(remark.kind(), remark));
        let remarks = own.chain(left_out.into_iter().map(|text| RemarkJson::new("left_out", &text)));
        let best = Row::new(&result.best, units);
        let ratio = result.choice.comparison().map(Comparison::ratio);
        // Weak form and output error are compared; the describing function's and the modulating functions' are not.
        let compared =
            |name: &str| result.choice.comparison().is_some() && ["weak_form", "output_error"].contains(&name);
        let row = |estimate: &ModelEstimate| {
            let own = estimate.estimator == result.best.estimator;
            let holdout = if own { ratio.map(|_| 1.0) } else { ratio.filter(|_| compared(estimate.estimator)) };
            Row { holdout, ..Row::new(estimate, units) }
        };
        Self {
            b: best.b,
            c: best.c,
            f1: best.f1,
            load: best.load.filter(|_| result.load.is_some()),
            undetermined: result
                .undetermined
                .iter()
                .map(|u| Missing { parameter: u.parameter, advice: u.advice.clone() })
                .collect(),
            noise: result.noise,
            estimator: best.name,
            chosen_because: choice::choice(&result.choice),
            held_out: result.choice.comparison().map(HeldOut::new),
            estimators: result.estimates.iter().map(row).collect(),
            gravity: result.gravity.as_ref().map(|trial| Gravity {
                travel_rad: trial.travel_rad,
                held_out: HeldOut::new(&trial.comparison),
                helps: trial.helps(),
            }),
            white: result.white,
            simulation_error: result.simulation_error,
            residual_correlation: result.residual_correlation,
            winding: result.winding.as_ref().map(|winding| Electrical::new(winding, result.best.c, units)),
            remarks: remarks
                .chain(result.gravity.iter().map(|trial| RemarkJson::new("gravity", &choice::gravity(trial))))
                .collect(),
        }
    }
}

impl Args {
    /// Reads the recordings, identifies, prints, writes the model.
    ///
    /// # Errors
    /// A recording that cannot be used; data that determine no model; a model file that cannot be written.
    #[cfg(feature = "command")]
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let targets: Vec<(&Target, FileKind)> = self.output.iter().map(|target| (target, FileKind::Model)).collect();
        let inputs: Vec<&Path> = self.recordings.iter().map(PathBuf::as_path).collect();
        let output = output.claim(&targets, &inputs)?;
        self.figures.claim(output, &inputs)?;
        let session = self.columns.read_session(&self.recordings)?;
        let found = find(&session, self.back_emf)?;
        if let Some(target) = &self.output {
            target.write_text(&found.model()?.to_toml())?;
        }
        self.figures.write(output, &inputs, || {
            let figures = typical(&session.recordings, &found.result);
            figures.iter().map(|own| typical_figure(own, &found.units, found.result.noise)).collect()
        })?;
        output.print(&found.document(), table)
    }
}

/// An identification with what its document and its model need beside it.
#[derive(Clone, Debug)]
pub struct Found {
    result: Identification,
    units: Units,
    files: Vec<String>,
    left_out: Vec<String>,
}

/// Identifies from the recordings of a session. `back_emf` is the constant of the name plate, V per position unit and
/// second; it is used where no current is recorded.
///
/// # Errors
/// [`IdentifyError`](crate::identify::estimate::IdentifyError), with the first file.
pub fn find(session: &Session, back_emf: Option<f64>) -> anyhow::Result<Found> {
    let mut result = estimate::identify(&session.recordings).with_context(|| session.first_file())?;
    if let Some(value) = back_emf.filter(|_| result.winding.is_none()) {
        result = estimate::apart(result, Value { value, se: 0.0 });
    }
    let units = session.recordings.first().map(|recording| recording.units.clone()).unwrap_or_default();
    let files = session.hashes.iter().map(|(file, _)| file.clone()).collect();
    Ok(Found { result, units, files, left_out: session.remarks.clone() })
}

impl Found {
    /// The JSON document.
    pub fn document(&self) -> Document {
        Document::new(&self.result, &self.units, self.left_out.clone())
    }

    /// The model as a model file has it.
    ///
    /// # Errors
    /// As of [`model`].
    pub fn model(&self) -> anyhow::Result<Model> {
        model(&self.result, &self.units, &self.files)
    }
}

/// The identified model as a model file has it.
///
/// # Errors
/// An estimate outside the range of a plant.
pub fn model(result: &Identification, units: &Units, sources: &[String]) -> anyhow::Result<Model> {
    let best = &result.best;
    let base = Base::new(best.b.value, best.c.value.max(0.0), best.f1.value.max(0.0))
        .map_err(|error| anyhow::anyhow!("the estimate is not a plant: {error}"))?;
    let effects = result.load.iter().map(|load| EffectEntry {
        name: "constant_load".into(),
        parameters: [("f0".to_owned(), load.value)].into(),
        se: [("f0".to_owned(), load.se)].into(),
    });
    Ok(Model {
        base,
        base_se: BaseSe { b: Some(best.b.se), c: Some(best.c.se), f1: Some(best.f1.se) },
        units: units.clone(),
        effects: effects.collect(),
        provenance: vec![format!("identified by breakaway {} ({})", env!("CARGO_PKG_VERSION"), best.estimator)]
            .into_iter()
            .chain(sources.iter().map(|source| format!("from {source}")))
            .collect(),
    })
}

/// A line of a number, its error and its unit.
fn row(text: &mut String, name: &str, quantity: &Quantity) {
    let Quantity { value, se, unit } = quantity;
    let percent = 100.0 * (se / value).abs();
    let _ = writeln!(text, "{name:<5}{value:>14.6e}  ± {se:.1e} ({percent:.2} %)  {unit}");
}

/// The result for people.
pub fn table(document: &Document) -> String {
    let mut text = String::new();
    row(&mut text, "b", &document.b);
    row(&mut text, "c", &document.c);
    row(&mut text, "f1", &document.f1);
    match &document.load {
        Some(load) => row(&mut text, "load", load),
        None => text.push_str("load  none that is significant\n"),
    }
    if let Some(Electrical { resistance, back_emf, inductance, viscous }) = &document.winding {
        text.push_str("\nfrom the current:\n");
        let parts = [("R", resistance), ("Ke", back_emf), ("c-Ke", viscous)];
        for (name, quantity) in parts.into_iter().chain(inductance.iter().map(|inductance| ("L", inductance))) {
            row(&mut text, name, quantity);
        }
    }
    let _ = writeln!(text, "\nreported: {}", document.chosen_because);
    text.push_str("\nby estimator:\n");
    for estimate in &document.estimators {
        let load = estimate.load.as_ref().map_or_else(String::new, |load| format!("  load {:.4e}", load.value));
        let _ = writeln!(
            text,
            "  {:<19} b {:.5e}  c {:.4e}  f1 {:.4e}{load}",
            estimate.name, estimate.b.value, estimate.c.value, estimate.f1.value
        );
    }
    let _ = writeln!(
        text,
        "\nposition noise {:.2e}; simulation error over 0.4 s {:.2e} ({:.1} times the noise)",
        document.noise,
        document.simulation_error,
        document.simulation_error / document.noise
    );
    for missing in &document.undetermined {
        let _ = writeln!(text, "undetermined: {}: {}", missing.parameter, missing.advice);
    }
    for remark in &document.remarks {
        let _ = writeln!(text, "note: {}", remark.text);
    }
    text
}
