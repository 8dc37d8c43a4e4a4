//! Trials of the drift watch: how soon it finds a rise of friction, how often it cries for nothing.

use breakaway_core::control::{
    Controller, ControllerState, DriftSettings, DriftState, DriftWatch, ModelMismatch, Motion, Pid, Sine, tune,
};
use breakaway_core::plant::{Base, Drive, Effect, Plant};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Tick of all trials, s.
const TICK_S: f64 = 1e-3;

/// What came of a trial.
#[derive(Clone, Debug)]
pub struct Watched {
    /// When the watch had learnt both directions, s; infinite for never.
    pub ready_s: f64,
    /// The times (s) of all alarms.
    pub alarms: Vec<(f64, ModelMismatch<f32>)>,
}

/// A trial: a PID follows a sine on a plant whose friction changes.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// The plant before the change.
    pub base: Base<f64>,
    /// Its effect, of which the watch knows nothing.
    pub effect: Option<Effect<f64>>,
    /// The model of controller and watch.
    pub known: Base<f64>,
    /// Factor on f1 from `change_s` on.
    pub factor: f64,
    /// When, s; infinite for never.
    pub change_s: f64,
    /// Length of the trial, s.
    pub seconds: f64,
    /// Encoder counts per turn.
    pub counts: f64,
    /// Seed of the noise (a third of a count).
    pub seed: u64,
}

impl Trial {
    /// The papers' plant behind 8000 counts per turn, unchanged.
    pub const fn papers(seconds: f64, seed: u64) -> Self {
        let base = Base { b: 0.02685, c: 0.11, f1: 0.5 };
        Self::of(base, 8000.0, seconds, seed)
    }

    /// A plant without effects that its model fits, unchanged.
    pub const fn of(base: Base<f64>, counts: f64, seconds: f64, seed: u64) -> Self {
        Self { base, effect: None, known: base, factor: 1.0, change_s: f64::INFINITY, seconds, counts, seed }
    }

    /// Follows a sine of 1 rad at 0.5 Hz, watched with the settings for it, as the firmware makes them.
    ///
    /// # Panics
    /// If the core refuses the plant.
    pub fn run(&self) -> Watched {
        let (Base { b, c, .. }, step) = (self.known, std::f64::consts::TAU / self.counts);
        let gains = tune(b, c, 10.0, TICK_S, 1).expect("10 Hz is allowed at 1 ms");
        let controller = Controller::pid(Pid::<f32>::new(&gains, TICK_S, 100.0).expect("gains are allowed"));
        let omega = std::f64::consts::PI;
        let motion = Motion { speed: omega, acceleration: omega * omega, encoder_step: step };
        let settings = DriftSettings::along(&motion, &self.known, TICK_S).expect("a motion that can be watched");
        let watch = DriftWatch::<f32>::new(&self.known, &[], &settings, TICK_S).expect("settings are allowed");
        let sine = Sine::<f32>::new(1.0, 0.5, TICK_S).expect("a sine");
        let before = Plant { base: self.base, effects: self.effect.as_slice() };
        let after = Plant { base: Base { f1: self.factor * self.base.f1, ..self.base }, ..before };
        let mut motion = before.at_rest(0.0);
        let mut state = ControllerState::start(&controller);
        let mut watched = DriftState::default();
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let mut pending = 0.0_f64;
        let mut found = Watched { ready_s: f64::INFINITY, alarms: Vec::new() };
        for k in 0..(self.seconds / TICK_S) as u32 {
            let t = f64::from(k) * TICK_S;
            let plant = if t < self.change_s { &before } else { &after };
            plant.advance(&mut motion, Drive { u: &[pending], ts: TICK_S, t }, 1);
            let noise = step * (rng.random_range(0.0..1.0) - rng.random_range(0.0..1.0)) * 0.8;
            let reading = (((motion.x + noise) / step).round() * step) as f32;
            if let Some(alarm) = watch.tick(&mut watched, pending as f32, reading) {
                found.alarms.push((t, alarm));
            }
            if watched.is_calibrated(&watch) {
                found.ready_s = found.ready_s.min(t);
            }
            pending = f64::from(controller.tick(&mut state, sine.at(k), reading).expect("a drive").u);
        }
        found
    }
}
