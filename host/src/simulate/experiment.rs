//! What is applied to the axis: experiments, and their files.

use std::path::Path;

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use super::SimulateError;
use crate::file::read_as;
use crate::mistaken::Content;

/// One experiment: an excitation, its clock and the sensor it is seen through.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// Name; becomes the recording's.
    pub name: String,
    /// Control tick, s.
    #[serde(default = "default_tick")]
    pub tick_s: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// Seed of the noise and of the multisine's phases.
    #[serde(default)]
    pub seed: u64,
    /// Largest |drive|, drive units.
    #[serde(default = "unlimited")]
    pub drive_limit: f64,
    /// Largest |position − start|; the run ends there ("limit tripped").
    #[serde(default = "unlimited")]
    pub travel_limit: f64,
    /// What is applied.
    pub excitation: Excitation,
    /// What it is seen through (simulated axis only).
    #[serde(default)]
    pub sensor: Sensor,
}

fn default_tick() -> f64 {
    1e-3
}
const fn unlimited() -> f64 {
    f64::INFINITY
}

/// Position sensor of the simulated axis, and the computer's delay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Sensor {
    /// Encoder step in position units; 0 for none.
    pub encoder_step: f64,
    /// Standard deviation of Gaussian noise before quantisation, position units.
    pub noise: f64,
    /// Ticks between reading a position and applying the drive computed from it.
    pub delay_ticks: usize,
}

/// The excitation of an experiment. Amplitudes are in drive units, references in position units.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Excitation {
    /// Dual relay feedback around a reference (docs/theory.md, section 2).
    Relay {
        /// Amplitude on the error.
        h1: f64,
        /// Amplitude on the error's integral.
        h2: f64,
        /// Hysteresis on the error, position units; by default three standard deviations of the noise and a step.
        #[serde(default)]
        hysteresis: Option<f64>,
        /// What the error is taken against.
        #[serde(default)]
        reference: Reference,
    },
    /// Sines from `from_hz` to `to_hz` with random phases, scaled to a peak of `amplitude`.
    Multisine {
        /// Peak.
        amplitude: f64,
        /// Lowest line, Hz.
        from_hz: f64,
        /// Highest line, Hz.
        to_hz: f64,
        /// Pull towards the start, drive units per position unit: keeps an open-loop axis within its travel.
        #[serde(default)]
        centring: f64,
    },
    /// A sine of the drive.
    Sine {
        /// Peak.
        amplitude: f64,
        /// Frequency, Hz.
        frequency_hz: f64,
        /// Pull towards the start, drive units per position unit.
        #[serde(default)]
        centring: f64,
    },
    /// A drive that rises steadily and swaps direction every `period_s`.
    Ramp {
        /// Drive at the end of every rise.
        amplitude: f64,
        /// Length of a rise, s.
        period_s: f64,
        /// Pull towards the start, drive units per position unit.
        #[serde(default)]
        centring: f64,
    },
    /// Position control along a reference: proportional and derivative.
    Track {
        /// Drive units per position unit.
        kp: f64,
        /// Drive units per (position unit/s).
        kd: f64,
        /// What is followed.
        reference: Reference,
    },
}

/// A position reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(tag = "shape", rename_all = "snake_case", deny_unknown_fields)]
pub enum Reference {
    /// The starting position.
    #[default]
    Start,
    /// A triangle around the start.
    Triangle {
        /// Peak.
        amplitude: f64,
        /// Period, s.
        period_s: f64,
    },
    /// A sine around the start.
    Sine {
        /// Peak.
        amplitude: f64,
        /// Period, s.
        period_s: f64,
    },
}

impl Reference {
    /// The reference at time `t`, relative to the start.
    pub fn at(&self, t: f64) -> f64 {
        match *self {
            Self::Start => 0.0,
            Self::Triangle { amplitude, period_s } => {
                let phase = (t / period_s + 0.25).rem_euclid(1.0);
                amplitude * (1.0 - 4.0 * (phase - 0.5).abs())
            }
            Self::Sine { amplitude, period_s } => amplitude * (std::f64::consts::TAU * t / period_s).sin(),
        }
    }
}

impl Excitation {
    /// The position reference; the start where there is none.
    pub const fn reference(&self) -> Reference {
        match *self {
            Self::Relay { reference, .. } | Self::Track { reference, .. } => reference,
            Self::Multisine { .. } | Self::Sine { .. } | Self::Ramp { .. } => Reference::Start,
        }
    }
}

impl Experiment {
    /// Reads an experiment file.
    ///
    /// # Errors
    /// What is wrong, with file and line.
    pub fn read(path: &Path) -> Result<Self, SimulateError> {
        read_as(path, Content::Experiment, Self::parse)
    }

    /// Reads an experiment from text; `file` is its name in messages.
    ///
    /// # Errors
    /// What is wrong, with file and line.
    pub fn parse(file: &str, text: &str) -> Result<Self, SimulateError> {
        let experiment: Self = toml::from_str(text).map_err(|source| SimulateError::Malformed {
            file: file.to_owned(),
            reason: source.to_string().trim_end().to_owned(),
        })?;
        experiment.check()?;
        Ok(experiment)
    }

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`SimulateError::Range`] names the field.
    pub fn check(&self) -> Result<(), SimulateError> {
        let positive = |field: &'static str, value: f64| {
            if value.is_finite() && value > 0.0 {
                Ok(())
            } else {
                Err(SimulateError::Range { field, value, need: "> 0" })
            }
        };
        let not_negative = |field: &'static str, value: f64| {
            if value.is_finite() && value >= 0.0 {
                Ok(())
            } else {
                Err(SimulateError::Range { field, value, need: "≥ 0" })
            }
        };
        positive("tick_s", self.tick_s)?;
        positive("duration_s", self.duration_s)?;
        not_negative("sensor.encoder_step", self.sensor.encoder_step)?;
        not_negative("sensor.noise", self.sensor.noise)?;
        let samples = self.duration_s / self.tick_s;
        if !(8.0..=1e8).contains(&samples) {
            return Err(SimulateError::Range {
                field: "duration_s / tick_s",
                value: samples,
                need: "8 to 1e8 samples",
            });
        }
        for (field, value) in [("drive_limit", self.drive_limit), ("travel_limit", self.travel_limit)] {
            if value.is_nan() || value <= 0.0 {
                return Err(SimulateError::Range { field, value, need: "> 0" });
            }
        }
        let nyquist = 0.5 / self.tick_s;
        let reference = |reference: &Reference| match *reference {
            Reference::Start => Ok(()),
            Reference::Triangle { amplitude, period_s } | Reference::Sine { amplitude, period_s } => {
                not_negative("reference.amplitude", amplitude)?;
                positive("reference.period_s", period_s)
            }
        };
        match &self.excitation {
            Excitation::Relay { h1, h2, hysteresis, reference: r } => {
                positive("excitation.h1", *h1)?;
                positive("excitation.h2", *h2)?;
                not_negative("excitation.hysteresis", hysteresis.unwrap_or(0.0))?;
                reference(r)
            }
            Excitation::Multisine { amplitude, from_hz, to_hz, centring } => {
                positive("excitation.amplitude", *amplitude)?;
                positive("excitation.from_hz", *from_hz)?;
                not_negative("excitation.centring", *centring)?;
                if *to_hz <= *from_hz || *to_hz >= nyquist || to_hz.is_nan() {
                    return Err(SimulateError::Range {
                        field: "excitation.to_hz",
                        value: *to_hz,
                        need: "above from_hz and below half the sample rate",
                    });
                }
                // The peak is searched over a period of the lowest difference of lines.
                if from_hz.min(*to_hz - *from_hz) < 1e-4 * *to_hz {
                    return Err(SimulateError::Range {
                        field: "excitation.from_hz",
                        value: *from_hz,
                        need: "1e-4 to 0.9999 of to_hz",
                    });
                }
                Ok(())
            }
            Excitation::Sine { amplitude, frequency_hz, centring } => {
                positive("excitation.amplitude", *amplitude)?;
                positive("excitation.frequency_hz", *frequency_hz)?;
                not_negative("excitation.centring", *centring)?;
                if *frequency_hz >= nyquist {
                    return Err(SimulateError::Range {
                        field: "excitation.frequency_hz",
                        value: *frequency_hz,
                        need: "below half the sample rate",
                    });
                }
                Ok(())
            }
            Excitation::Ramp { amplitude, period_s, centring } => {
                positive("excitation.amplitude", *amplitude)?;
                positive("excitation.period_s", *period_s)?;
                not_negative("excitation.centring", *centring)
            }
            Excitation::Track { kp, kd, reference: r } => {
                positive("excitation.kp", *kp)?;
                not_negative("excitation.kd", *kd)?;
                reference(r)
            }
        }
    }

    /// Samples the experiment takes.
    pub fn samples(&self) -> usize {
        (self.duration_s / self.tick_s).round() as usize
    }
}

/// The lines of a multisine: angular frequency and phase, and the scale to unit peak.
#[derive(Clone, Debug)]
pub struct Multisine {
    lines: Vec<(f64, f64)>,
    scale: f64,
}

/// Most lines of a multisine.
const MOST_LINES: f64 = 48.0;

impl Multisine {
    /// At most 48 lines, evenly spaced on multiples of `from_hz`; phases from the seed. The sum has the period of its
    /// lowest line, over which its peak is taken.
    pub fn new(from_hz: f64, to_hz: f64, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed ^ 0x6d75_6c74_6973_696e);
        // Lines on multiples of the lowest, so that the sum repeats after its period.
        let multiples = ((to_hz - from_hz) / from_hz).floor();
        let stride = (multiples / (MOST_LINES - 1.0)).ceil().max(1.0);
        let count = (multiples / stride).floor().min(MOST_LINES - 1.0) as usize + 1;
        let spacing = stride * from_hz;
        let lines: Vec<(f64, f64)> = (0..count)
            .map(|i| {
                let omega = std::f64::consts::TAU * (from_hz + i as f64 * spacing);
                (omega, rng.random_range(0.0..std::f64::consts::TAU))
            })
            .collect();
        let mut multisine = Self { lines, scale: 1.0 };
        let period = 1.0 / from_hz;
        let points = (period * to_hz * 16.0) as usize;
        let peak = (0..points).map(|i| multisine.at(period * i as f64 / points as f64).abs()).fold(0.0, f64::max);
        multisine.scale = 1.0 / peak.max(1e-12);
        multisine
    }

    /// The value at time `t`.
    pub fn at(&self, t: f64) -> f64 {
        self.scale * self.lines.iter().map(|(omega, phase)| (omega * t + phase).sin()).sum::<f64>()
    }
}

#[cfg(test)]
mod tests;
