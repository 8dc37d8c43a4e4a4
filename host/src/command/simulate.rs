//! `breakaway simulate`.

use std::path::PathBuf;

use schemars::JsonSchema;
use serde::Serialize;

use super::output::Output;
use crate::file::{FileKind, Target};
use crate::model::Model;
use crate::simulate::axis::Axis;
use crate::simulate::experiment::Experiment;

/// Make a recording from a model, with any effects, and an experiment
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway simulate --model model.toml --experiment relay.toml -o recording.csv")]
pub struct Args {
    /// The model
    #[arg(long, value_name = "M.toml")]
    pub model: PathBuf,
    /// The experiment
    #[arg(long, value_name = "E.toml")]
    pub experiment: PathBuf,
    /// The recording to write; `-` is standard output
    #[arg(short, long, value_name = "REC.csv")]
    pub output: Target,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document {
    recording: String,
    samples: usize,
    travel_limit_tripped: bool,
}

impl Args {
    /// Simulates and writes the recording.
    ///
    /// # Errors
    /// A file that cannot be read or written, or a model that cannot be simulated.
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        let output = output.claim(&[(&self.output, FileKind::Recording)], &[&self.model, &self.experiment])?;
        let model = Model::read(&self.model)?;
        let experiment = Experiment::read(&self.experiment)?;
        let run = Axis::new(model.base, &model.plant_effects()?, model.units.clone()).run(&experiment)?;
        self.output.write(|mut out| run.recording.write_to(&mut out))?;
        let document = Document {
            recording: self.output.to_string(),
            samples: run.recording.t.len(),
            travel_limit_tripped: run.tripped.is_some(),
        };
        output.print(&document, |d| {
            let end = if d.travel_limit_tripped { "; it ended at the travel limit" } else { "" };
            format!("{} samples written to {}{end}", d.samples, d.recording)
        })
    }
}
