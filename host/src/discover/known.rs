//! Recordings without known effects, so that the judge rules on what these leave.

use breakaway_core::plant::effect::ActsIn;
use breakaway_core::plant::{Drive, Effect, Plant};

use crate::fit::{Candidate, MeasuredMotion};
use crate::recording::Recording;

/// Steps in which the true position is found below a sensor's error. Each gains a factor of the error's slope, which
/// is below 1 for a sensor that tells its position.
const SENSOR_STEPS: usize = 4;

/// The recordings of a machine that has none of the model's effects. Their forces along the measured motion are added
/// to the drive, and the sensor's errors are taken from the position. A second body stays, because the measured motion
/// does not tell its force.
pub(super) fn without_effects(recordings: &[Recording], model: &Candidate) -> Vec<Recording> {
    let effects: Vec<Effect<f64>> = model.effects.iter().filter(|own| !own.kind.second_body()).copied().collect();
    if effects.is_empty() {
        return recordings.to_vec();
    }
    let plant = Plant { base: model.base, effects: &effects };
    recordings.iter().map(|recording| without(recording, &plant)).collect()
}

fn without(recording: &Recording, plant: &Plant<'_, f64>) -> Recording {
    let track = MeasuredMotion::new(recording);
    let mut own = recording.clone();
    for piece in track.pieces.windows(2) {
        let mut state = plant.at_rest(track.xs[piece[0]]);
        for k in piece[0]..piece[1] {
            let drive = Drive { u: &track.u[..=k], ts: track.dt(k), t: track.t[k] };
            own.u[k] += plant.effect_force(&mut state, drive, track.xs[k], track.vs[k], track.acceleration[k]);
        }
    }
    if plant.effects.iter().any(|effect| effect.kind.acts_in() == ActsIn::Sensor) {
        own.x.iter_mut().for_each(|x| *x = true_position(plant, *x));
    }
    own
}

/// The position at which the sensor reads `reading`.
fn true_position(plant: &Plant<'_, f64>, reading: f64) -> f64 {
    (0..SENSOR_STEPS).fold(reading, |x, _| reading - (plant.measured(x) - x))
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::{Base, Kind};

    use super::*;

    /// The position below an eccentricity of .05 rad is found within .05⁵ rad, the error of four steps.
    #[test]
    fn the_sensors_error_is_taken_from_the_position() {
        let effects = [Effect::new(Kind::EncoderEccentricity, &[0.05, 0.3])];
        let plant = Plant { base: Base { b: 1.0, c: 0.0, f1: 0.0 }, effects: &effects };
        for x in [-2.0, 0.0, 0.7, 3.0] {
            assert!((true_position(&plant, plant.measured(x)) - x).abs() < 0.05_f64.powi(5), "{x}");
        }
    }
}
