//! The paper's adaptive controller in closed loop, as its figures and its experiment have it: the core's law on the
//! event-exact plant, with exact velocity.

use std::f64::consts::TAU;

use breakaway::simulate::exact::Exact;
use breakaway_core::control::{Adaptation, Adaptive, AdaptiveState, Estimates, Gains, Ideal, Setpoint};
use breakaway_core::plant::Base;

/// Paper section 5: b = .1429, c = f2 − a = 1.429 + 10.5, f1 = 1.429 V (errata 24, 25).
pub const PAPER: Base<f64> = Base { b: 0.1429, c: 11.929, f1: 1.429 };

/// Starting estimates of Figs 8, 9, 10: zeros; a = −5, b = .05, f1 = f2 = 1 V (6.9979 N); a = −10, b = .1, f1 = f2 = 1.4 V (9.7971 N).
pub const FIGURES: [(u32, Estimates<f64>); 3] = [
    (8, Estimates { b: 0.0, c: 0.0, f1: 0.0, f: 0.0 }),
    (9, Estimates { b: 0.05, c: 6.0, f1: 1.0, f: 0.0 }),
    (10, Estimates { b: 0.1, c: 11.4, f1: 1.4, f: 0.0 }),
];

/// A closed loop.
#[derive(Clone, Copy, Debug)]
pub struct Loop {
    /// The plant.
    pub plant: Base<f64>,
    /// Kv, Λ1, Λ2.
    pub gains: Gains,
    /// Adaptation gains, δ.
    pub adaptation: Adaptation,
    /// Starting estimates.
    pub start: Estimates<f64>,
    /// Reference: amplitude (X) and frequency (Hz) of a sine.
    pub sine: (f64, f64),
    /// Tick, s.
    pub tick_s: f64,
    /// Drive limit.
    pub limit: f64,
    /// Whether adaptation is frozen in saturation, and the integral taken back.
    pub freeze: bool,
}

/// One tick of a run.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Time, s.
    pub t: f64,
    /// Reference.
    pub reference: f64,
    /// Tracking error.
    pub error: f64,
    /// Drive.
    pub u: f64,
    /// Estimates after the tick.
    pub estimates: Estimates<f64>,
}

impl Loop {
    /// Section 5's figures. The paper leaves gains and reference open; these are ours, slow enough for its words on Fig. 8
    /// ("the convergence rate is slow and the tracking error is large").
    pub const fn figure(start: Estimates<f64>) -> Self {
        Self {
            plant: PAPER,
            gains: Gains { b: PAPER.b, kv: 10.0, lambda1: 25.0, lambda2: 10.0, filter_s: 0.0, observer_rad_s: 0.0 },
            adaptation: Adaptation {
                gains: Estimates { b: 0.001, c: 2.0, f1: 1.0, f: 1.0 },
                sigma: 0.0,
                delta: 0.02,
                b_min: 0.0,
                pid_inside: false,
                speed: 2.0,
                acceleration: 12.0,
            },
            start,
            sine: (0.3, 1.0),
            tick_s: 1e-3,
            limit: f64::INFINITY,
            freeze: true,
        }
    }

    /// Section 6's motor in mm, s and V: Kp = 192.59 mm/s per V, Tp = 0.073454 s, f1 = 0.238 V; the paper's gains
    /// (40). The motion is 2 mm at 1 Hz, as neither amplitude nor frequency is given. It starts with the plant's own
    /// parameters, and its k = 1e-2 are times the parameters' squares: as printed they let b̂ run away.
    pub fn experiment() -> Self {
        let plant = Base { b: 0.073_454 / 192.59, c: 1.0 / 192.59, f1: 0.238 };
        Self {
            plant,
            gains: Gains {
                b: plant.b,
                kv: 1200.0,
                lambda1: 600.0,
                lambda2: 1400.0,
                filter_s: 0.0,
                observer_rad_s: 0.0,
            },
            adaptation: Adaptation {
                gains: Estimates {
                    b: 1e-2 * plant.b * plant.b,
                    c: 1e-2 * plant.c * plant.c,
                    f1: 1e-2 * plant.f1 * plant.f1,
                    f: 1e-2 * plant.f1 * plant.f1,
                },
                sigma: 0.0,
                delta: 10.0,
                b_min: 0.0,
                pid_inside: false,
                speed: 13.0,
                acceleration: 79.0,
            },
            start: Estimates { b: plant.b, c: plant.c, f1: plant.f1, f: 0.0 },
            sine: (2.0, 1.0),
            tick_s: 2e-4,
            limit: f64::INFINITY,
            freeze: true,
        }
    }

    /// Runs for `seconds` from rest.
    ///
    /// # Panics
    /// If the core refuses the gains.
    pub fn run(&self, seconds: f64) -> Vec<Moment> {
        let law = Adaptive::<f64>::new(&self.gains, &self.adaptation, &self.start, self.tick_s, 0, self.limit)
            .expect("gains within the limits");
        let mut state: AdaptiveState<f64> = law.start();
        let mut plant = Exact::at_rest(self.plant, 0.0, 0.0);
        let (amplitude, frequency) = self.sine;
        let w = TAU * frequency;
        (0..(seconds / self.tick_s).round() as usize)
            .map(|k| {
                let t = k as f64 * self.tick_s;
                let (sin, cos) = (w * t).sin_cos();
                let reference = Setpoint { x: amplitude * sin, v: amplitude * w * cos, a: -amplitude * w * w * sin };
                let error = reference.x - plant.x;
                let direction = if plant.v == 0.0 { 0.0 } else { plant.v.signum() };
                let signals = Ideal { error, error_rate: reference.v - plant.v, direction };
                let wanted = law.drive_ideal(&mut state, reference, signals);
                let u = wanted.clamp(-self.limit, self.limit);
                if self.freeze && u != wanted {
                    law.cut(&mut state, u - wanted);
                } else {
                    law.update(&mut state);
                }
                plant.advance(u, self.tick_s);
                Moment { t, reference: reference.x, error, u, estimates: state.estimates }
            })
            .collect()
    }
}

/// RMS of the tracking error from `from` to `to` seconds.
pub fn rms(run: &[Moment], from: f64, to: f64) -> f64 {
    let errors: Vec<f64> = run.iter().filter(|m| (from..to).contains(&m.t)).map(|m| m.error * m.error).collect();
    (errors.iter().sum::<f64>() / errors.len() as f64).sqrt()
}
