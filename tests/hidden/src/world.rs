//! What surrounds the plant: the kind world, in which the clock is exact and nothing is shaken, and what makes it unkind.
//!
//! Every real axis is shaken by torque, many clocks jitter, many sensors are slower than the log. A [`World`] says by how
//! much; [`Setting::draw`](crate::Setting::draw) draws one by seed. The default is the kind world.

mod draw;
mod setting;

pub use setting::{Item, Setting, UnknownItem};

use crate::plant::TS;

/// Longest session, rows; a faster clock makes every recording shorter.
const MOST_ROWS: f64 = 120_000.0;
/// Length of the suite, s, to which the limit is applied.
const SUITE_S: f64 = 60.0;

/// Everything that is not the machine and not the hidden effect.
#[derive(Clone, Debug, PartialEq)]
pub struct World {
    /// Tick of the drive and of the log, s: 1e-4 to 1e-2.
    pub tick_s: f64,
    /// Encoder other than the machine's own.
    pub encoder: Option<Encoder>,
    /// Random torque on the motor.
    pub torque: Option<Torque>,
    /// Jitter of the tick.
    pub jitter: Option<Jitter>,
    /// Time between two readings of the sensor, s: between them the log repeats the last one.
    pub held_s: Option<f64>,
    /// How late the position is reported, s; 0 for none.
    pub sensor_delay_s: f64,
    /// Supply that gives way under load.
    pub sag: Option<Sag>,
    /// Whether every recording is made in closed loop.
    pub closed: bool,
    /// Whether the encoder starts anywhere in each recording.
    pub zero: bool,
}

/// Resolution and noise of the encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    /// Steps per turn, 500 to 65 536.
    pub counts: u32,
    /// Standard deviation of the noise before quantisation, steps.
    pub noise_steps: f64,
}

/// Ornstein–Uhlenbeck torque: Gaussian, with the spectrum of a first-order low-pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Torque {
    /// Root mean square, % of the supply (the drive limit).
    pub rms_percent: f64,
    /// Frequency at which its power is halved, Hz.
    pub bandwidth_hz: f64,
}

/// Sample instants that stray from the grid, uniformly and independently.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jitter {
    /// Standard deviation of an instant from its place on the grid, in ticks; at most 0.2.
    pub share: f64,
    /// Whether the log holds the true instants, or those of the grid.
    pub true_stamps: bool,
}

/// Supply sag: the effective drive is u·(1 − share·⟨|u|⟩/limit), with ⟨|u|⟩ the low-passed size of the drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sag {
    /// Part of the drive that is lost at the drive limit.
    pub share: f64,
    /// Time constant of the low-pass, s.
    pub time_s: f64,
}

impl Default for World {
    fn default() -> Self {
        Self {
            tick_s: TS,
            encoder: None,
            torque: None,
            jitter: None,
            held_s: None,
            sensor_delay_s: 0.0,
            sag: None,
            closed: false,
            zero: false,
        }
    }
}

impl World {
    /// Whether nothing is unkind.
    pub fn is_kind(&self) -> bool {
        *self == Self::default()
    }

    /// The same without what is random from sample to sample: in it the effects are sized.
    pub(crate) fn calm(&self) -> Self {
        Self { torque: None, jitter: None, ..self.clone() }
    }

    /// Length of the recordings over that in the kind world.
    pub(crate) fn share(&self) -> f64 {
        (MOST_ROWS * self.tick_s / SUITE_S).min(1.0)
    }

    /// Mean time from a position to the drive that answers it, s.
    pub(crate) fn latency_s(&self) -> f64 {
        0.5 * self.tick_s + 0.5 * self.held_s.unwrap_or(0.0) + self.sensor_delay_s
    }

    /// What was drawn, as words `item=value` without commas; empty for the kind world.
    pub fn text(&self) -> String {
        let mut words = Vec::new();
        if let Some(t) = self.torque {
            words.push(format!("torque={:.3}%@{:.0}Hz", t.rms_percent, t.bandwidth_hz));
        }
        if let Some(j) = self.jitter {
            let stamps = if j.true_stamps { "true" } else { "nominal" };
            words.push(format!("jitter={:.0}%:{stamps}", 100.0 * j.share));
        }
        if let Some(held) = self.held_s {
            words.push(format!("held={:.1}ms", 1e3 * held));
        }
        if self.tick_s.to_bits() != TS.to_bits() {
            words.push(format!("rate={:.0}Hz", 1.0 / self.tick_s));
        }
        if let Some(e) = self.encoder {
            words.push(format!("counts={}", e.counts));
        }
        if self.sensor_delay_s > 0.0 {
            words.push(format!("delay={:.1}ms", 1e3 * self.sensor_delay_s));
        }
        if let Some(sag) = self.sag {
            words.push(format!("sag={:.1}%", 100.0 * sag.share));
        }
        words.extend(self.closed.then(|| "closed".to_owned()));
        words.extend(self.zero.then(|| "zero".to_owned()));
        words.join(" ")
    }
}
