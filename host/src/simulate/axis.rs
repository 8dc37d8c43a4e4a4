//! The simulated axis: a plant, its sensor and its drive, run through experiments on one session clock.

use breakaway_core::excite::relay::{DualRelay, DualRelayState, default_hysteresis};
use breakaway_core::plant::{Base, Drive, Effect};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, Normal};

use super::SimulateError;
use super::experiment::{Excitation, Experiment, Multisine, Sensor};
use super::motion::SimulatedMotion;
use crate::recording::{Recording, Units};

/// A simulated axis. It keeps position and session time from one experiment to the next, as a machine does.
#[derive(Clone, Debug)]
pub struct Axis {
    units: Units,
    motion: SimulatedMotion,
    t: f64,
}

/// The controller of an experiment.
enum ExperimentController {
    Relay(DualRelay<f64>, DualRelayState, f64),
    OpenLoop(Box<dyn Fn(f64) -> f64>, f64),
    Tracking { kp: f64, kd: f64, last: Option<f64> },
}

/// A recording and what ended it.
#[derive(Clone, Debug)]
pub struct Run {
    /// What was recorded.
    pub recording: Recording,
    /// Noise-free, unquantised positions.
    pub true_x: Vec<f64>,
    /// Position from which the run started: references are relative to it.
    pub start: f64,
    /// Position at which the travel limit ended the run, relative to the start.
    pub tripped: Option<f64>,
}

impl Axis {
    /// An axis at rest at x = 0 and session time 0.
    pub fn new(base: Base<f64>, effects: &[Effect<f64>], units: Units) -> Self {
        Self { units, motion: SimulatedMotion::at_rest(base, effects), t: 0.0 }
    }

    /// True position.
    pub const fn position(&self) -> f64 {
        self.motion.position()
    }

    /// Runs an experiment from where the axis is.
    ///
    /// # Errors
    /// Ranges of the experiment; a simulation that diverges.
    pub fn run(&mut self, experiment: &Experiment) -> Result<Run, SimulateError> {
        experiment.check()?;
        let mut controller = ExperimentController::new(experiment)?;
        let reference = experiment.excitation.reference();
        let tick_s = experiment.tick_s;
        self.run_with(experiment, |k, reading| {
            let local = k as f64 * tick_s;
            controller.drive(local, reference.at(local) - reading, tick_s)
        })
    }

    /// Runs under a controller of the caller's: `control` makes a drive of the tick's number and the reading relative to
    /// the start. Of the experiment its clock, limits, sensor and seed are used, not its excitation.
    ///
    /// # Errors
    /// Ranges of the experiment; a simulation that diverges, or a drive that is no number.
    pub fn run_with(
        &mut self,
        experiment: &Experiment,
        mut control: impl FnMut(usize, f64) -> f64,
    ) -> Result<Run, SimulateError> {
        experiment.check()?;
        let Sensor { encoder_step, noise, delay_ticks } = experiment.sensor;
        let mut rng = ChaCha8Rng::seed_from_u64(experiment.seed);
        let gauss = Normal::new(0.0, noise).map_err(|_| SimulateError::Range {
            field: "sensor.noise",
            value: noise,
            need: "≥ 0",
        })?;
        let ts = experiment.tick_s;
        let n = experiment.samples();
        let start = self.position();
        let (mut t, mut u, mut x, mut true_x) =
            (Vec::with_capacity(n), Vec::with_capacity(n), Vec::with_capacity(n), Vec::with_capacity(n));
        let mut queue = std::collections::VecDeque::from(vec![0.0; delay_ticks]);
        let mut tripped = None;
        let sub_steps = self.motion.sub_steps(ts);
        for k in 0..n {
            let position = self.position();
            if !position.is_finite() {
                return Err(SimulateError::Diverged { experiment: experiment.name.clone(), t: self.t });
            }
            let clean = self.motion.measured();
            let noisy = clean + gauss.sample(&mut rng);
            let reading = if encoder_step > 0.0 { (noisy / encoder_step).round() * encoder_step } else { noisy };
            let command = control(k, reading - start).clamp(-experiment.drive_limit, experiment.drive_limit);
            if !command.is_finite() {
                return Err(SimulateError::Diverged { experiment: experiment.name.clone(), t: self.t });
            }
            queue.push_back(command);
            let applied = queue.pop_front().unwrap_or(0.0);
            t.push(self.t);
            u.push(applied);
            x.push(reading);
            true_x.push(clean);
            if (position - start).abs() > experiment.travel_limit {
                tripped = Some(position - start);
                break;
            }
            self.motion.advance(Drive { u: &u, ts, t: self.t }, sub_steps);
            self.t += ts;
        }
        let mut recording = Recording {
            name: experiment.name.clone(),
            t,
            u,
            x,
            encoder_step: (encoder_step > 0.0).then_some(encoder_step),
            units: self.units.clone(),
            ..Recording::default()
        };
        recording.meta.insert("experiment".into(), experiment.name.clone());
        recording.meta.insert("seed".into(), experiment.seed.to_string());
        Ok(Run { recording, true_x, start, tripped })
    }
}

/// What a relay makes of a position: its count in position units, and its hysteresis in counts.
///
/// The relay works on integer counts; a sensor without steps is given fine ones. `hysteresis` in position units, by
/// default three standard deviations of the noise and a count.
pub fn relay_resolution(hysteresis: Option<f64>, sensor: Sensor) -> (f64, u32) {
    let Sensor { encoder_step, noise, .. } = sensor;
    let count = if encoder_step > 0.0 { encoder_step } else { noise.max(1e-6) * 0.1 };
    let counts = match hysteresis {
        Some(band) => (band / count).ceil() as u32,
        None if noise == 0.0 && encoder_step == 0.0 => 0,
        None => default_hysteresis(noise / count).unwrap_or(1),
    };
    (count, counts)
}

impl ExperimentController {
    fn new(experiment: &Experiment) -> Result<Self, SimulateError> {
        Ok(match experiment.excitation {
            Excitation::Relay { h1, h2, hysteresis, .. } => {
                let (count, counts) = relay_resolution(hysteresis, experiment.sensor);
                let relay = DualRelay::with_real_drive(h1, h2, counts)
                    .map_err(|error| SimulateError::Relay(error.to_string()))?;
                Self::Relay(relay, DualRelayState::new(), count)
            }
            Excitation::Multisine { amplitude, from_hz, to_hz, centring } => {
                let multisine = Multisine::new(from_hz, to_hz, experiment.seed);
                Self::OpenLoop(Box::new(move |t| amplitude * multisine.at(t)), centring)
            }
            Excitation::Sine { amplitude, frequency_hz, centring } => Self::OpenLoop(
                Box::new(move |t| amplitude * (std::f64::consts::TAU * frequency_hz * t).sin()),
                centring,
            ),
            Excitation::Ramp { amplitude, period_s, centring } => Self::OpenLoop(
                Box::new(move |t| {
                    let rises = (t / period_s).floor();
                    let direction = if rises.rem_euclid(2.0) == 0.0 { 1.0 } else { -1.0 };
                    direction * amplitude * (t / period_s - rises)
                }),
                centring,
            ),
            Excitation::Track { kp, kd, .. } => Self::Tracking { kp, kd, last: None },
        })
    }

    /// `error` is the reference minus the reading.
    fn drive(&mut self, t: f64, error: f64, ts: f64) -> f64 {
        match self {
            Self::Relay(relay, state, count) => relay.tick(state, (error / *count).round() as i32),
            Self::OpenLoop(signal, centring) => signal(t) + *centring * error,
            Self::Tracking { kp, kd, last } => {
                let rate = last.map_or(0.0, |last| (error - last) / ts);
                *last = Some(error);
                *kp * error + *kd * rate
            }
        }
    }
}
