//! The experiment that would decide between models that tie.

use breakaway_core::plant::Kind;

use super::data::FIT_SEGMENT_S;
use super::outcome::NextExperiment;
use crate::fit::{self, Candidate, Problem, session};
use crate::recording::Units;
use crate::simulate::axis::Axis;
use crate::simulate::experiment::{Excitation, Experiment, Reference, Sensor};

/// What the recordings show that the machine can do. Experiments stay within it.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Largest |drive| in the recordings.
    pub drive: f64,
    /// Largest travel from the start of a recording.
    pub travel: f64,
    /// Sample period, s.
    pub tick_s: f64,
    /// Noise floor of the position.
    pub sigma: f64,
}

/// The experiment of the family in which the two models differ most, over the noise. `None` if none makes them differ
/// by more than the noise.
pub fn deciding(
    a: &Candidate,
    b: &Candidate,
    kinds: &[Kind],
    limits: &Limits,
    units: &Units,
) -> Option<NextExperiment> {
    family(a, limits)
        .into_iter()
        .filter_map(|experiment| {
            let difference = difference(a, b, &experiment, units)? / limits.sigma;
            Some(NextExperiment { experiment, separates: kinds.to_vec(), difference_over_noise: difference })
        })
        .max_by(|x, y| x.difference_over_noise.total_cmp(&y.difference_over_noise))
        .filter(|best| best.difference_over_noise > 1.0)
}

fn family(model: &Candidate, limits: &Limits) -> Vec<Experiment> {
    let f1 = model.base.f1.max(0.02 * limits.drive);
    let travel = limits.travel.max(100.0 * limits.sigma);
    let relay = |total: f64, ratio: f64, reference| Excitation::Relay {
        h1: total * ratio / (1.0 + ratio),
        h2: total / (1.0 + ratio),
        hysteresis: Some(4.0 * limits.sigma),
        reference,
    };
    let centring = 0.1 * limits.drive / travel;
    let sine = |amplitude, frequency_hz| Excitation::Sine { amplitude, frequency_hz, centring };
    let long = Reference::Triangle { amplitude: 1.5 * travel, period_s: 10.0 };
    let list = [
        ("relay at full drive", relay(limits.drive, 3.0, Reference::Start)),
        ("relay at half drive", relay(0.5 * limits.drive, 1.6, Reference::Start)),
        ("relay over longer travel", relay(0.8 * limits.drive, 3.0, long)),
        ("slow sine through rest", sine((1.3 * f1).min(limits.drive), 0.5)),
        ("slower sine through rest", sine((1.15 * f1).min(limits.drive), 0.1)),
        (
            "ramps through break-away",
            Excitation::Ramp { amplitude: (1.5 * f1).min(limits.drive), period_s: 1.0, centring },
        ),
        ("multisine to 16 Hz", Excitation::Multisine { amplitude: limits.drive, from_hz: 0.25, to_hz: 16.0, centring }),
        ("multisine to 60 Hz", Excitation::Multisine { amplitude: limits.drive, from_hz: 1.0, to_hz: 60.0, centring }),
        ("fast sine", sine(limits.drive, 5.0)),
    ];
    list.into_iter()
        .map(|(name, excitation)| Experiment {
            name: name.replace(' ', "_"),
            tick_s: limits.tick_s,
            duration_s: 8.0,
            seed: 1,
            drive_limit: limits.drive,
            travel_limit: 3.0 * travel,
            excitation,
            sensor: Sensor::default(),
        })
        .collect()
}

/// Root mean square difference of the models on a simulated recording of `a`, position units. It is what `b` leaves
/// beyond what `a` leaves, over segments that each start from the recorded motion. `None` where the experiment cannot
/// be simulated.
fn difference(a: &Candidate, b: &Candidate, experiment: &Experiment, units: &Units) -> Option<f64> {
    let run = Axis::new(a.base, &a.effects, units.clone()).run(experiment).ok()?;
    let tracks = session(std::slice::from_ref(&run.recording));
    let segments = fit::segments(&tracks, FIT_SEGMENT_S);
    let problem = Problem {
        tracks: &tracks,
        segments: &segments,
        sigma: tracks[0].sigma.max(1e-12),
        warm_up_s: 0.3,
        softening: 0.0,
        coarse: false,
        work: None,
    };
    let own = problem.score(a);
    let other = problem.score(b);
    let mean = |mse: &[f64]| mse.iter().copied().filter(|m| m.is_finite()).sum::<f64>() / mse.len().max(1) as f64;
    Some((mean(&other) - mean(&own)).max(0.0).sqrt())
}
