//! `breakaway sinefit`.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::Context;
use schemars::JsonSchema;
use serde::Serialize;

use super::figures::FiguresArgs;
use super::output::Output;
use super::recording_args::{RecordingArgs, positive};
use crate::file::shown;
use crate::report::sine::figure;
use crate::sine::{self, SineFit};

/// Fit `A·sin(ω(t − t0) + θ) + d` to one column, t0 the first sample used
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway sinefit run.csv --time t_s --position x_rad --from 2 --to 7
  breakaway sinefit run.csv --signal iq_A --time t_s --period 0.5 --json

JSON: amplitude, omega (rad/s), phase (rad, at the first sample used), phase_centre (rad, at the middle),
offset, rms (of the residual), se (standard errors of the same), cycles.")]
pub struct Args {
    /// The recording
    #[arg(value_name = "REC")]
    pub recording: PathBuf,
    /// Column to fit [default: the position]
    #[arg(long, value_name = "COL")]
    pub signal: Option<String>,
    /// About how long a period is; the fit looks from half to twice that [default: found in the data]
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    pub period: Option<f64>,
    /// Figures.
    #[command(flatten)]
    pub figures: FiguresArgs,
    /// Columns and rows.
    #[command(flatten)]
    pub columns: RecordingArgs,
}

/// The JSON document.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Document {
    amplitude: f64,
    omega: f64,
    phase: f64,
    phase_centre: f64,
    offset: f64,
    rms: f64,
    se: Errors,
    cycles: f64,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Errors {
    amplitude: f64,
    omega: f64,
    phase: f64,
    phase_centre: f64,
    offset: f64,
}

impl From<SineFit> for Document {
    fn from(fit: SineFit) -> Self {
        Self {
            amplitude: fit.amplitude,
            omega: fit.omega_rad_s,
            phase: fit.phase_start_rad,
            phase_centre: fit.phase_centre_rad,
            offset: fit.offset,
            rms: fit.rms,
            se: Errors {
                amplitude: fit.se.amplitude,
                omega: fit.se.omega_rad_s,
                phase: fit.se.phase_start_rad,
                phase_centre: fit.se.phase_centre_rad,
                offset: fit.se.offset,
            },
            cycles: fit.cycles,
        }
    }
}

impl Args {
    /// Reads the recording, fits, prints.
    ///
    /// # Errors
    /// A recording that cannot be used, or has no sine in it.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let inputs = [self.recording.as_path()];
        self.figures.claim(output, &inputs)?;
        let signal = self.columns.read_signal(&self.recording, self.signal.as_deref())?;
        let unit = signal.unit.clone().unwrap_or_default();
        let fit = sine::fit(&signal, f64::NEG_INFINITY..=f64::INFINITY, self.period)
            .with_context(|| format!("{}: column `{}`", shown(&self.recording), signal.column))?;
        self.figures.write(output, &inputs, || vec![figure(&signal, &fit)])?;
        output.print(&Document::from(fit), |fit| table(fit, &unit))
    }
}

/// The result for people: value, standard error, unit.
fn table(fit: &Document, unit: &str) -> String {
    let mut text = String::new();
    let mut row = |name: &str, value: f64, error: Option<f64>, unit: &str| {
        let error = error.map_or_else(String::new, |error| format!("± {error:.2e}"));
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name:<14}{value:>14.7}  {error:<12}{unit}");
    };
    row("amplitude", fit.amplitude, Some(fit.se.amplitude), unit);
    row("omega", fit.omega, Some(fit.se.omega), "rad/s");
    row("frequency", fit.omega / TAU, Some(fit.se.omega / TAU), "Hz");
    row("phase", fit.phase, Some(fit.se.phase), "rad at the first sample");
    row("phase_centre", fit.phase_centre, Some(fit.se.phase_centre), "rad at the middle");
    row("offset", fit.offset, Some(fit.se.offset), unit);
    row("rms", fit.rms, None, unit);
    row("cycles", fit.cycles, None, "");
    text
}
