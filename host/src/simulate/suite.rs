//! The standard suite of experiments (docs/formats.md, section "The standard suite"), sized from the break-away force.

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

/// What the ramps say of the break-away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Breakaway {
    /// The drive at which the axis broke away, read back from its motion after it.
    pub force: f64,
    /// The drive at which the reading had moved by ten steps or noise deviations: what the suite is sized from. It is more
    /// than the force, by what the ramp gains while the body covers them.
    pub moved_at: f64,
}

/// Finds the break-away force: a ramp of the drive until the reading moves by ten steps or noise deviations.
///
/// # Errors
/// [`SimulateError::NoBreakaway`] if nothing moves up to the drive limit (taken as 1e3 where there is none).
pub fn breakaway(axis: &Axis, machine: &Machine) -> Result<Breakaway, SimulateError> {
    breakaway_by(machine, |ramp| axis.clone().run(ramp))
}

/// [`breakaway`] of an axis on which `run` runs the ramps.
///
/// # Errors
/// Those of `run`, and [`SimulateError::NoBreakaway`].
pub fn breakaway_by<E: From<SimulateError>>(
    machine: &Machine,
    mut run: impl FnMut(&Experiment) -> Result<Run, E>,
) -> Result<Breakaway, E> {
    let limit = if machine.drive_limit.is_finite() { machine.drive_limit } else { 1e3 };
    let resolution = machine.sensor.encoder_step.max(machine.sensor.noise).max(1e-6);
    // Each ramp reaches ten times higher than the last, so that weak axes are not thrown.
    let mut amplitude = limit * 1e-3;
    while amplitude < limit * 9.99 {
        let ramp = Experiment {
            name: "break-away".into(),
            tick_s: machine.tick_s,
            duration_s: 2.0,
            seed: machine.seed,
            drive_limit: limit,
            travel_limit: 10.0 * resolution,
            excitation: Excitation::Ramp { amplitude: amplitude.min(limit), period_s: 2.0, centring: 0.0 },
            sensor: machine.sensor,
        };
        let run = run(&ramp)?;
        if run.tripped.is_some() {
            let moved_at = run.recording.u.last().copied().unwrap_or(amplitude).abs();
            return Ok(Breakaway { force: read_back(&run, resolution).clamp(0.0, moved_at), moved_at });
        }
        amplitude *= 10.0;
    }
    Err(SimulateError::NoBreakaway(limit).into())
}

/// The drive at which the motion of a ramp began. With a drive of r·t past the friction a body of inertia b moves by
/// r·t³/(6b). So the drive is a straight line over the third root of the way, and the result is its value at no way.
/// Where friction falls on break-away the body is faster at first, and what is found is a little (4 % of 0.8 V for
/// 0.3 V) low.
fn read_back(run: &Run, resolution: f64) -> f64 {
    let (x, u) = (&run.recording.x, &run.recording.u);
    let way = |k: usize| (x[k] - run.start).abs();
    // What is within the resolution says nothing; from where it is left for good on it is motion.
    let first = (0..x.len()).rev().find(|k| way(*k) < 1.5 * resolution).map_or(0, |k| k + 1);
    let points: Vec<(f64, f64)> = (first..x.len()).map(|k| (way(k).cbrt(), u[k].abs())).collect();
    let n = points.len() as f64;
    let [mx, mu] = [points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n];
    let sxx: f64 = points.iter().map(|p| (p.0 - mx).powi(2)).sum();
    let sxu: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - mu)).sum();
    let force = mu - sxu / sxx * mx;
    // Thrown within a few ticks: the first drive after it is all that is known.
    if points.len() < 5 || !force.is_finite() { points.first().map_or(f64::INFINITY, |p| p.1) } else { force }
}

/// The suite for an axis that `breakaway` moves ([`Breakaway::moved_at`]): the experiments in the order in which they are run.
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
