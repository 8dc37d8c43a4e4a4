//! References of the command line: `sine:1,0.5`, `trapezoid:2,1,4`, `s_curve:2,1,4,40`, or a CSV file.

use std::path::Path;
use std::str::FromStr;

use breakaway_core::control::{Fast, Phases, Profile, Samples, Setpoint, Sine};

use super::ControlError;
use crate::recording::{ReadOptions, Signal};

/// What is followed, relative to the start.
#[derive(Clone, Debug, PartialEq)]
pub enum Reference {
    /// Amplitude (X) and frequency (Hz).
    Sine {
        /// Peak, X.
        amplitude: f64,
        /// Hz.
        frequency_hz: f64,
    },
    /// Back and forth within limits; with a jerk limit an S-curve.
    Profile {
        /// X.
        distance: f64,
        /// X/s.
        speed: f64,
        /// X/s².
        acceleration: f64,
        /// X/s³; `None` for a trapezoid.
        jerk: Option<f64>,
        /// Rest at both ends, s.
        rest_s: f64,
    },
    /// A column of a CSV file.
    File(String),
}

/// The forms, for messages and help.
const FORMS: &str = "sine:AMPLITUDE,HZ, trapezoid:DISTANCE,SPEED,ACCELERATION[,REST_S], \
                     s_curve:DISTANCE,SPEED,ACCELERATION,JERK[,REST_S], or a FILE.csv with columns t and x";
/// Rest at the ends of a profile where none is given, s.
const REST_S: f64 = 0.5;

impl FromStr for Reference {
    type Err = ControlError;

    fn from_str(text: &str) -> Result<Self, ControlError> {
        let wrong = |reason: String| ControlError::Reference { text: text.to_owned(), reason };
        let Some((kind, rest)) = text.split_once(':') else {
            if Path::new(text).extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
                return Ok(Self::File(text.to_owned()));
            }
            return Err(wrong(format!("expected {FORMS}")));
        };
        let numbers: Vec<f64> = rest
            .split(',')
            .map(|n| n.trim().parse::<f64>().ok().filter(|n| n.is_finite()))
            .collect::<Option<_>>()
            .ok_or_else(|| wrong(format!("numbers are expected after `{kind}:`; the forms are {FORMS}")))?;
        let reference = match (kind, numbers.as_slice()) {
            ("sine", &[amplitude, frequency_hz]) => Self::Sine { amplitude, frequency_hz },
            ("trapezoid", &[distance, speed, acceleration, ref rest @ ..]) if rest.len() <= 1 => Self::Profile {
                distance,
                speed,
                acceleration,
                jerk: None,
                rest_s: rest.first().copied().unwrap_or(REST_S),
            },
            ("s_curve", &[distance, speed, acceleration, jerk, ref rest @ ..]) if rest.len() <= 1 => Self::Profile {
                distance,
                speed,
                acceleration,
                jerk: Some(jerk),
                rest_s: rest.first().copied().unwrap_or(REST_S),
            },
            _ => return Err(wrong(format!("the forms are {FORMS}"))),
        };
        Ok(reference)
    }
}

impl Reference {
    /// A sensible length of a run, s: ten periods, four strokes, the file.
    ///
    /// # Errors
    /// As [`Self::points`].
    pub fn duration_s(&self, tick_s: f64) -> Result<f64, ControlError> {
        Ok(match self {
            Self::Sine { frequency_hz, .. } => 10.0 / frequency_hz,
            Self::Profile { rest_s, .. } => {
                let ticks = self.profile::<f64>(tick_s)?.map_or(0, |profile| profile.ticks());
                4.0 * (f64::from(ticks) * tick_s + rest_s)
            }
            Self::File(_) => self.samples(tick_s)?.len() as f64 * tick_s,
        })
    }

    /// The reference at each tick, from tick 0.
    ///
    /// # Errors
    /// A parameter out of range, or a file that cannot be read.
    pub fn points<R: Fast>(&self, tick_s: f64, ticks: usize) -> Result<Vec<Setpoint<R>>, ControlError> {
        let each = |at: &dyn Fn(u32) -> Setpoint<R>| (0..ticks as u32).map(at).collect();
        match self {
            Self::Sine { amplitude, frequency_hz } => {
                let sine = Sine::new(*amplitude, *frequency_hz, tick_s).map_err(|e| self.wrong(&e))?;
                Ok(each(&|k| sine.at(k)))
            }
            Self::Profile { .. } => {
                let Some(profile) = self.profile::<R>(tick_s)? else { return Ok(Vec::new()) };
                Ok(each(&|k| profile.at(k)))
            }
            Self::File(_) => {
                let x: Vec<R> = self.samples(tick_s)?.into_iter().map(R::from_f64).collect();
                let samples = Samples::new(&x, tick_s).map_err(|e| self.wrong(&e))?;
                Ok(each(&|k| samples.at(k)))
            }
        }
    }

    /// Of a profile its phases and its rest, in ticks; `None` of any other reference.
    ///
    /// # Errors
    /// As [`Self::points`].
    pub fn phases(&self, tick_s: f64) -> Result<Option<(Phases, u32)>, ControlError> {
        let Self::Profile { distance, speed, acceleration, jerk, rest_s } = *self else { return Ok(None) };
        // A rest that is out of range is refused with the profile.
        self.profile::<f64>(tick_s)?;
        let phases = match jerk {
            None => Profile::<f64>::trapezoid_phases(distance, speed, acceleration, tick_s),
            Some(jerk) => Profile::<f64>::s_curve_phases(distance, speed, acceleration, jerk, tick_s),
        };
        let phases = phases.map_err(|error| self.wrong(&error))?;
        Ok(Some((phases, (rest_s / tick_s).ceil() as u32)))
    }

    fn wrong(&self, reason: &(impl ToString + ?Sized)) -> ControlError {
        ControlError::Reference { text: self.to_string(), reason: reason.to_string() }
    }

    fn profile<R: Fast>(&self, tick_s: f64) -> Result<Option<Profile<R>>, ControlError> {
        let Self::Profile { distance, speed, acceleration, jerk, rest_s } = *self else { return Ok(None) };
        match jerk {
            None => Profile::trapezoid(distance, speed, acceleration, tick_s),
            Some(jerk) => Profile::s_curve(distance, speed, acceleration, jerk, tick_s),
        }
        .and_then(|profile| profile.back_and_forth(rest_s))
        .map(Some)
        .map_err(|error| self.wrong(&error))
    }

    /// The file's positions relative to its first, at every tick: cubic between its samples (Catmull and Rom), so that the
    /// velocity has no steps.
    fn samples(&self, tick_s: f64) -> Result<Vec<f64>, ControlError> {
        let Self::File(path) = self else { return Ok(Vec::new()) };
        let signal = Signal::read(path.as_ref(), None, &ReadOptions::default()).map_err(|error| self.wrong(&error))?;
        let (t, y) = (&signal.t, &signal.y);
        let (first, last) = (t[0], t[t.len() - 1]);
        let count = ((last - first) / tick_s).floor();
        if count.is_nan() || count >= 1e8 {
            return Err(self.wrong("the file is too long for this tick"));
        }
        let slope = |i: usize| {
            let (a, b) = (i.saturating_sub(1), (i + 1).min(t.len() - 1));
            (y[b] - y[a]) / (t[b] - t[a])
        };
        let mut i = 0;
        Ok((0..=count as usize)
            .map(|k| {
                let at = first + k as f64 * tick_s;
                while i + 2 < t.len() && t[i + 1] <= at {
                    i += 1;
                }
                let h = t[i + 1] - t[i];
                let s = ((at - t[i]) / h).clamp(0.0, 1.0);
                let (m0, m1) = (slope(i) * h, slope(i + 1) * h);
                let d = y[i + 1] - y[i];
                y[i] - y[0] + s * (m0 + s * (3.0 * d - 2.0 * m0 - m1 + s * (m0 + m1 - 2.0 * d)))
            })
            .collect())
    }
}

impl std::fmt::Display for Reference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Sine { amplitude, frequency_hz } => write!(f, "sine:{amplitude},{frequency_hz}"),
            Self::Profile { distance, speed, acceleration, jerk: None, rest_s } => {
                write!(f, "trapezoid:{distance},{speed},{acceleration},{rest_s}")
            }
            Self::Profile { distance, speed, acceleration, jerk: Some(jerk), rest_s } => {
                write!(f, "s_curve:{distance},{speed},{acceleration},{jerk},{rest_s}")
            }
            Self::File(file) => write!(f, "{file}"),
        }
    }
}
