//! `breakaway bode`.

use std::f64::consts::PI;
use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use super::figures::{FiguresArgs, kind_of, write_one};
use super::output::Output;
use super::recording_args::{RecordingArgs, positive};
use crate::file::Target;
use crate::recording::Units;
use crate::report::json::Quantity;
use crate::report::remark::RemarkJson;
use crate::report::response;
use crate::response::{Estimate, FrequencyResponse, Mode, Point};

/// Frequency response from drive to position: gain, phase, coherence, resonances, antiresonances, delay
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway bode sweep.csv --time t_s --input u_V --position x_rad --figure bode.svg
  breakaway bode session/*.csv --segment 4 --figures figures --json

Spectra are averaged over segments that overlap by half (Welch). A longer segment tells nearer frequencies apart, and gives fewer
segments to average. Resonances, antiresonances and delay come from a fit where the coherence suffices.

JSON: segments, segment_s, points (frequency_hz, gain, gain_se, phase_deg, coherence, coherent), gain_unit, resonances and
antiresonances (frequency, damping_ratio), delay (value, se, unit; null where it cannot be told), remarks.")]
pub struct Args {
    /// Recordings of one axis
    #[arg(value_name = "REC", required = true)]
    pub recordings: Vec<PathBuf>,
    /// Length of a segment [default: as long as there are 16 of them]
    #[arg(long, value_name = "S", value_parser = positive, allow_negative_numbers = true)]
    pub segment: Option<f64>,
    /// Draw gain, phase and coherence, as SVG, or as what the name ends in: `.png`, `.csv`; `-` is standard output
    #[arg(long, value_name = "F.svg")]
    pub figure: Option<Target>,
    /// Figures.
    #[command(flatten)]
    pub figures: FiguresArgs,
    /// Columns and rows.
    #[command(flatten)]
    pub columns: RecordingArgs,
}

#[derive(Debug, Serialize, JsonSchema)]
struct PointJson {
    frequency_hz: f64,
    gain: f64,
    gain_se: f64,
    phase_deg: f64,
    coherence: f64,
    /// Whether the coherence suffices.
    coherent: bool,
}

impl From<&Point> for PointJson {
    fn from(point: &Point) -> Self {
        Self {
            frequency_hz: point.frequency_hz,
            gain: point.response.norm(),
            gain_se: point.gain_se,
            phase_deg: point.phase_rad * 180.0 / PI,
            coherence: point.coherence,
            coherent: point.coherent,
        }
    }
}

#[derive(Debug, Serialize, JsonSchema)]
struct ModeJson {
    frequency: Quantity,
    damping_ratio: Quantity,
}

fn quantity(estimate: Estimate, unit: &str) -> Quantity {
    Quantity { value: estimate.value, se: estimate.se, unit: unit.to_owned() }
}

impl From<&Mode> for ModeJson {
    fn from(mode: &Mode) -> Self {
        Self { frequency: quantity(mode.frequency_hz, "Hz"), damping_ratio: quantity(mode.damping_ratio, "") }
    }
}

/// The JSON document.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Document {
    segments: usize,
    segment_s: f64,
    points: Vec<PointJson>,
    gain_unit: String,
    resonances: Vec<ModeJson>,
    antiresonances: Vec<ModeJson>,
    delay: Option<Quantity>,
    remarks: Vec<RemarkJson>,
}

impl Document {
    fn new(found: &FrequencyResponse, units: &Units, left_out: &[String]) -> Self {
        let own = response::remarks(found).into_iter().map(|(kind, text)| RemarkJson::new(kind, &text));
        Self {
            segments: found.segments,
            segment_s: found.segment_s,
            points: found.points.iter().map(PointJson::from).collect(),
            gain_unit: response::gain_unit(units),
            resonances: found.resonances.iter().map(ModeJson::from).collect(),
            antiresonances: found.antiresonances.iter().map(ModeJson::from).collect(),
            delay: found.delay_s.map(|delay| quantity(delay, "s")),
            remarks: own.chain(left_out.iter().map(|text| RemarkJson::new("left_out", text))).collect(),
        }
    }
}

impl Args {
    /// Reads the recordings, averages, prints.
    ///
    /// # Errors
    /// Recordings that cannot be used, or in which the position does not follow the drive.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let inputs: Vec<_> = self.recordings.iter().map(PathBuf::as_path).collect();
        let targets: Vec<_> = self.figure.iter().map(|target| (target, kind_of(target))).collect();
        let output = output.claim(&targets, &inputs)?;
        self.figures.claim(output, &inputs)?;
        let session = self.columns.read_session(&self.recordings)?;
        let units = &session.recordings[0].units;
        let found = FrequencyResponse::of(&session.recordings, self.segment)?;
        let name = match session.recordings.as_slice() {
            [one] => one.name.clone(),
            all => format!("{} recordings", all.len()),
        };
        let figure = || response::figure(&found, units, &name);
        if let Some(target) = &self.figure {
            write_one(target, &figure())?;
        }
        self.figures.write(output, &inputs, || vec![figure()])?;
        output
            .print(&Document::new(&found, units, &session.remarks), |_| response::page(&found, units, &session.remarks))
    }
}
