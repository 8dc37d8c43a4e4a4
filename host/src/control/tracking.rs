//! The closed loop on the simulated axis: the core's controller, in the number type of the board, behind encoder and delay.

use breakaway_core::control::{Controller, ControllerState, Setpoint};
use breakaway_core::link::Mismatch;
use serde::Serialize;

use crate::model::Model;
use crate::recording::Recording;
use crate::simulate::SimulateError;
use crate::simulate::axis::Axis;
use crate::simulate::experiment::{Excitation, Experiment, Reference as Shape, Sensor};

/// The axis as the controller meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bench {
    /// Control tick, s.
    pub tick_s: f64,
    /// Ticks from reading to drive.
    pub delay_ticks: u32,
    /// Encoder step, X; 0 for none.
    pub encoder_step: f64,
    /// Standard deviation of the position noise, X.
    pub noise: f64,
    /// Largest |drive|; infinite for none.
    pub drive_limit: f64,
    /// Seed of the noise.
    pub seed: u64,
}

/// A tracked reference.
#[derive(Clone, Debug)]
pub struct Tracked {
    /// Time, applied drive, reading.
    pub recording: Recording,
    /// Reference minus true position, X.
    pub error: Vec<f64>,
    /// Reference, X.
    pub reference: Vec<f64>,
    /// Ticks in which the drive was cut by its limit.
    pub saturated: usize,
    /// First sample that the figures below count.
    pub from: usize,
}

impl Tracked {
    /// Root mean square of the error, X.
    pub fn rms(&self) -> f64 {
        let counted = &self.error[self.from.min(self.error.len())..];
        (counted.iter().map(|e| e * e).sum::<f64>() / counted.len().max(1) as f64).sqrt()
    }
    /// Largest |error|, X.
    pub fn peak(&self) -> f64 {
        self.error[self.from.min(self.error.len())..].iter().fold(0.0, |peak, e| peak.max(e.abs()))
    }
    /// Root mean square of the drive.
    pub fn drive_rms(&self) -> f64 {
        let counted = &self.recording.u[self.from.min(self.error.len())..];
        (counted.iter().map(|u| u * u).sum::<f64>() / counted.len().max(1) as f64).sqrt()
    }
}

/// A tracked reference under its name.
#[derive(Debug)]
pub struct Case {
    /// Short name, for files and JSON.
    pub name: &'static str,
    /// Name for a reader.
    pub title: &'static str,
    /// What came of it.
    pub tracked: Tracked,
    /// Of a board: what is beside it.
    pub board: Option<OnBoard>,
}

/// What a board adds to a run.
#[derive(Clone, Debug, Serialize, schemars::JsonSchema)]
pub struct OnBoard {
    /// Samples lost on the way.
    pub missing: u64,
    /// What its drift watch said.
    #[schemars(with = "Vec<serde_json::Value>")]
    pub mismatches: Vec<Mismatch>,
}

/// Follows `reference` on a plant, from rest; figures count from sample `from` on.
///
/// # Errors
/// A plant with too many effects; a loop that diverges.
pub fn track(
    plant: &Model,
    controller: &Controller<f32>,
    reference: &[Setpoint<f32>],
    bench: &Bench,
    from: usize,
) -> anyhow::Result<Tracked> {
    let experiment = Experiment {
        name: "track".into(),
        tick_s: bench.tick_s,
        duration_s: reference.len() as f64 * bench.tick_s,
        seed: bench.seed,
        drive_limit: bench.drive_limit,
        travel_limit: f64::INFINITY,
        // The excitation is not used: the core's controller drives.
        excitation: Excitation::Track { kp: 1.0, kd: 0.0, reference: Shape::Start },
        sensor: Sensor {
            encoder_step: bench.encoder_step,
            noise: bench.noise,
            delay_ticks: bench.delay_ticks as usize,
        },
    };
    let mut axis = Axis::new(plant.base, &plant.plant_effects()?, plant.units.clone());
    let mut state = ControllerState::start(controller);
    let mut saturated = 0;
    let run = axis.run_with(&experiment, |k, reading| {
        let point = reference.get(k).copied().unwrap_or_default();
        // What is no drive ends the run as diverged.
        let Some(command) = controller.tick(&mut state, point, reading as f32) else { return f64::NAN };
        saturated += usize::from(command.saturated);
        f64::from(command.u)
    })?;
    let followed: Vec<f64> = reference.iter().map(|point| f64::from(point.x)).collect();
    let error: Vec<f64> = followed.iter().zip(&run.true_x).map(|(r, x)| r - (x - run.start)).collect();
    if error.iter().any(|e| !e.is_finite()) {
        return Err(SimulateError::Diverged { experiment: "track".into(), t: 0.0 }.into());
    }
    Ok(Tracked { recording: run.recording, error, reference: followed, saturated, from })
}
