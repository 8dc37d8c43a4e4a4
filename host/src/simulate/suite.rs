//! The standard suite of experiments (discovery.md, "The standard suite"), sized from the break-away force.

use super::SimulateError;
use super::axis::{Axis, Run};
use super::experiment::{Excitation, Experiment, Reference, Sensor};

/// Whether a recording is for fitting or for scoring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// To fit.
    Fit,
    /// To score only.
    Score,
}

/// What the machine allows and is seen through.
#[derive(Clone, Copy, Debug)]
pub struct Machine {
    /// Largest |drive|.
    pub drive_limit: f64,
    /// Half the travel used by the long-travel relay, position units.
    pub travel: f64,
    /// Tick, s.
    pub tick_s: f64,
    /// Sensor of the simulated axis.
    pub sensor: Sensor,
    /// Seed of the noise and phases.
    pub seed: u64,
}

/// Finds the break-away force: a slow ramp of the drive until the reading moves by ten steps or noise deviations.
///
/// # Errors
/// [`SimulateError::NoBreakaway`] if nothing moves up to the drive limit (taken as 1e3 where there is none).
pub fn breakaway(axis: &Axis, machine: &Machine) -> Result<f64, SimulateError> {
    breakaway_by(machine, |ramp| axis.clone().run(ramp))
}

/// [`breakaway`] of an axis on which `run` runs the ramps.
///
/// # Errors
/// Those of `run`, and [`SimulateError::NoBreakaway`].
pub fn breakaway_by<E: From<SimulateError>>(
    machine: &Machine,
    mut run: impl FnMut(&Experiment) -> Result<Run, E>,
) -> Result<f64, E> {
    let limit = if machine.drive_limit.is_finite() { machine.drive_limit } else { 1e3 };
    let threshold = 10.0 * machine.sensor.encoder_step.max(machine.sensor.noise).max(1e-6);
    // Each ramp reaches ten times higher than the last, so that weak axes are not thrown.
    let mut amplitude = limit * 1e-3;
    while amplitude < limit * 9.99 {
        let ramp = Experiment {
            name: "break-away".into(),
            tick_s: machine.tick_s,
            duration_s: 2.0,
            seed: machine.seed,
            drive_limit: limit,
            travel_limit: threshold,
            excitation: Excitation::Ramp { amplitude: amplitude.min(limit), period_s: 2.0, centring: 0.0 },
            sensor: machine.sensor,
        };
        let run = run(&ramp)?;
        if run.tripped.is_some() {
            return Ok(run.recording.u.last().copied().unwrap_or(amplitude).abs());
        }
        amplitude *= 10.0;
    }
    Err(SimulateError::NoBreakaway(limit).into())
}

/// The suite for an axis whose break-away force is `breakaway`: the experiments in the order in which they are run.
pub fn suite(breakaway: f64, machine: &Machine) -> Vec<(Role, Experiment)> {
    // Relay high takes eight times the break-away force, or what the drive allows; the rest scales with it.
    let high = (8.0 * breakaway).min(0.95 * machine.drive_limit);
    let relay = |share: f64, ratio: f64, reference: Reference| {
        let total = high * share;
        Excitation::Relay { h1: total * ratio / (1.0 + ratio), h2: total / (1.0 + ratio), hysteresis: None, reference }
    };
    // The pull towards the start moves the mean by less than a tenth of the drive over the travel.
    let centring = 0.1 * high / machine.travel;
    let multisine = Excitation::Multisine { amplitude: 0.9 * high, from_hz: 0.25, to_hz: 16.0, centring };
    let slow = |share: f64| Excitation::Sine { amplitude: share * breakaway, frequency_hz: 0.5, centring: 0.0 };
    let travel = Reference::Triangle { amplitude: machine.travel, period_s: 10.0 };
    let list = [
        (Role::Fit, "relay_high", 6.0, relay(1.0, 3.0, Reference::Start)),
        (Role::Fit, "relay_low", 6.0, relay(0.5, 1.6, Reference::Start)),
        (Role::Fit, "multisine", 8.0, multisine.clone()),
        (Role::Fit, "slow_sine", 10.0, slow(1.5)),
        (Role::Fit, "relay_travel", 10.0, relay(0.8, 3.0, travel)),
        (Role::Score, "relay_mid", 6.0, relay(0.7, 2.2, Reference::Start)),
        (Role::Score, "multisine_2", 6.0, multisine),
        (Role::Score, "slow_sine_2", 8.0, slow(1.3)),
    ];
    list.into_iter()
        .enumerate()
        .map(|(i, (role, name, duration_s, excitation))| {
            let experiment = Experiment {
                name: name.into(),
                tick_s: machine.tick_s,
                duration_s,
                seed: machine.seed.wrapping_add(1 + i as u64),
                drive_limit: machine.drive_limit,
                travel_limit: f64::INFINITY,
                excitation,
                sensor: machine.sensor,
            };
            (role, experiment)
        })
        .collect()
}

#[cfg(test)]
mod tests;
