//! Experiment files: an error, or an experiment that can be run to an answer or an error.

use breakaway::command::run::papers_plant;
use breakaway::identify::relay::ending;
use breakaway::simulate::axis::Axis;
use breakaway::simulate::experiment::{Excitation, Experiment, Sensor};

/// Reads the bytes as an experiment; a short one is run on the papers' plant.
pub fn run(bytes: &[u8]) -> bool {
    let text = String::from_utf8_lossy(bytes);
    let experiment = match Experiment::parse("fuzz.toml", &text) {
        Ok(experiment) => experiment,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    if experiment.samples() <= 5_000 && experiment.sensor.delay_ticks <= 5_000 {
        let plant = papers_plant();
        if let Ok(run) = Axis::new(plant.base, &[], plant.units).run(&experiment) {
            assert!(run.recording.x.iter().chain(&run.recording.u).all(|value| value.is_finite()));
            let ending = ending(&run, &experiment, None);
            assert!(ending.is_none_or(|ending| !ending.text(&run.recording.units).is_empty()));
        }
    }
    true
}

/// Fifty ticks of a sine: enough to move and to turn round.
pub(super) fn few_samples() -> Experiment {
    Experiment {
        name: "fuzz".to_owned(),
        tick_s: 1e-3,
        duration_s: 0.05,
        seed: 0,
        drive_limit: f64::INFINITY,
        travel_limit: f64::INFINITY,
        excitation: Excitation::Sine { amplitude: 2.0, frequency_hz: 40.0, centring: 0.0 },
        sensor: Sensor::default(),
    }
}
