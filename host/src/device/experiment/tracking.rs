//! A reference followed on the board.

use breakaway_core::control::{Adaptation, Gains, Setpoint};
use breakaway_core::link::{
    Adaptive, Bounds, Command, ControllerGains, Ended, Ending, ErrorRate, Mismatch, Mode, Model, Pid, Track, Trajectory,
};

use super::Runner;
use crate::control::design::Design;
use crate::control::reference::Reference;
use crate::control::tracking::Tracked;
use crate::device::stream::Row;
use crate::device::{DeviceError, text};
use crate::interrupt::FinishFirst;

/// A reference to follow with one controller.
#[derive(Clone, Debug)]
pub struct TrackRun<'a> {
    /// Name of the recording.
    pub name: &'a str,
    /// The model to load before.
    pub model: &'a Model,
    /// Whether it is compensated; otherwise the PID is alone.
    pub compensate: bool,
    /// Who follows.
    pub controller: ControllerGains,
    /// What is followed.
    pub reference: &'a Reference,
    /// The same at each tick, from tick 0.
    pub points: &'a [Setpoint<f32>],
    /// First sample that counts.
    pub from: usize,
    /// Largest |drive|, drive units.
    pub drive_limit: f64,
}

/// A reference that was followed to its end.
#[derive(Clone, Debug)]
pub struct Followed {
    /// Errors against the encoder: a board knows no other position.
    pub tracked: Tracked,
    /// Samples that were lost on the way.
    pub missing: u64,
    /// What the board's drift watch said.
    pub mismatches: Vec<Mismatch>,
}

/// Where a run began: its first tick, and the count from which its reference counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Begin {
    tick: u64,
    count: i32,
}

impl Begin {
    /// The first samples may be lost on the way. So the tick is that of the end less the run's length. The count follows
    /// from the reference that the board followed. A count is `step` position units.
    fn of(rows: &[Row], ended: Option<Ended>, points: &[Setpoint<f32>], step: f64) -> Self {
        let Some(first) = rows.first() else { return Self::default() };
        let before = |ended: Ended| {
            let before = (first.tick as u32).wrapping_sub(ended.tick.wrapping_sub(ended.ticks));
            (before < ended.ticks).then_some(before)
        };
        let before = ended.and_then(before).unwrap_or(0);
        let point = points.get(before as usize).map_or(0.0, |point| f64::from(point.x));
        let followed = (point / step).round() as i32;
        Self { tick: first.tick.saturating_sub(before.into()), count: first.reference.wrapping_sub(followed) }
    }
}

/// The PID of remark 1 as a board takes it: `b·Kv·(Λ2·e + Λ1·∫e + ė)`.
pub fn pid(gains: &Gains) -> ControllerGains {
    let k = gains.b * gains.kv;
    let (kp, ki, kd) = ((k * gains.lambda2) as f32, (k * gains.lambda1) as f32, k as f32);
    ControllerGains::Pid(Pid { kp, ki, kd, error_rate: error_rate(gains) })
}

/// How a board makes ė.
fn error_rate(gains: &Gains) -> ErrorRate {
    ErrorRate { filter_s: gains.filter_s as f32, observer_rad_s: gains.observer_rad_s as f32 }
}

/// The adaptive law of a design as a board takes it, for a reference that is at each tick what `points` are.
///
/// A board gets the rate of adaptation, in rad/s. It computes the gains from the loaded model and the reference
/// ([`Adaptation::normalised`]); these are the rates that give the design's gains.
pub fn adaptive(design: &Design, points: &[Setpoint<f32>]) -> ControllerGains {
    let most =
        |of: fn(&Setpoint<f32>) -> f32| points.iter().map(|point| f64::from(of(point).abs())).fold(0.0, f64::max);
    let (gains, wanted) = (&design.gains, &design.adaptation.gains);
    let delta = design.adaptation.delta;
    let unit = Adaptation::normalised(&design.start, 1.0, most(|point| point.v), most(|point| point.a), delta).gains;
    let rate = |wanted: f64, unit: f64| if unit > 0.0 { (wanted / unit).sqrt() as f32 } else { 0.0 };
    ControllerGains::Adaptive(Adaptive {
        kv: gains.kv as f32,
        lambda1: gains.lambda1 as f32,
        lambda2: gains.lambda2 as f32,
        delta: delta as f32,
        error_rate: error_rate(gains),
        // a and f2 are one estimate, c: its rate goes with a.
        rates: [rate(wanted.c, unit.c), rate(wanted.b, unit.b), rate(wanted.f1, unit.f1), 0.0, rate(wanted.f, unit.f)],
    })
}

/// The board's trajectory for a reference, at ticks of `tick_s` s.
///
/// # Errors
/// [`DeviceError::Reference`]: the board has no such trajectory.
fn trajectory(reference: &Reference, tick_s: f64) -> Result<Trajectory, DeviceError> {
    match *reference {
        Reference::Sine { amplitude, frequency_hz } => {
            Ok(Trajectory::Sine { amplitude: amplitude as f32, period_s: (1.0 / frequency_hz) as f32 })
        }
        Reference::Profile { distance, .. } => match reference.phases(tick_s) {
            Ok(Some((phases, rest_ticks))) => Ok(Trajectory::Profile {
                distance: distance as f32,
                jerk_ticks: phases.jerk,
                acceleration_ticks: phases.acceleration,
                cruise_ticks: phases.cruise,
                rest_ticks,
            }),
            // Its points were made before, so it is one.
            Ok(None) | Err(_) => Err(DeviceError::Reference(reference.to_string())),
        },
        Reference::File(_) => Err(DeviceError::Reference(reference.to_string())),
    }
}

impl Runner {
    /// Name of the board.
    pub fn board(&self) -> &str {
        &self.info.board
    }

    /// The largest drive that the settings allow, drive units.
    pub fn drive_limit(&self) -> f64 {
        self.scale.drive(self.settings.drive_max_code.into())
    }

    /// Whether a reference of ±`amplitude` around where the axis is stays within the travel limits of the settings.
    ///
    /// # Errors
    /// [`DeviceError::Range`]; a fault, or a board that is not idle.
    pub fn has_room(&mut self, amplitude: f64) -> Result<(), DeviceError> {
        let status = self.client.status()?;
        match status.mode {
            Mode::Idle => {}
            Mode::Fault => return Err(self.latched()),
            mode => return Err(DeviceError::NotIdle(mode.name())),
        }
        let (low, high) = (self.settings.travel_min_counts, self.settings.travel_max_counts);
        let room = (i64::from(status.count) - i64::from(low)).min(i64::from(high) - i64::from(status.count));
        let room = room.max(0) as f64 * self.scale.step;
        if amplitude.abs() < room {
            return Ok(());
        }
        let x = &self.scale.units.x;
        let at = self.scale.position(status.count);
        let need = format!(
            "the axis is at {at:.4} {x} and its travel limits leave {room:.4} {x} either way; move it, take less, or widen \
             travel_min_counts and travel_max_counts (`breakaway device settings set`)"
        );
        Err(DeviceError::Range { what: "the amplitude of --reference", value: amplitude, need })
    }

    /// Loads the model, follows the reference to its end.
    ///
    /// # Errors
    /// The board has no such trajectory, refuses, is lost, or ends the run before its time.
    pub fn follow(&mut self, run: &TrackRun<'_>, interrupt: &FinishFirst) -> Result<Followed, DeviceError> {
        let ticks = u32::try_from(run.points.len()).unwrap_or(u32::MAX);
        let limit_code = if run.drive_limit < self.drive_limit() {
            self.scale.code("--drive-limit", run.drive_limit)?
        } else {
            self.settings.drive_max_code
        };
        let start = Command::StartTrack(Track {
            trajectory: trajectory(run.reference, self.scale.tick_s())?,
            controller: run.controller,
            feed_forward: run.compensate,
            compensation: run.compensate,
            bounds: Bounds { max_ticks: ticks, drive_max_code: limit_code, travel_counts: 0 },
        });
        start.validate().map_err(|error| DeviceError::Refused { command: text::command_name(&start), error })?;
        let (record, error) = self.record(vec![Command::LoadModel(run.model.clone()), start], interrupt)?;
        if let Some(error) = error {
            return Err(error);
        }
        if let Some(ended) = record.ended.filter(|ended| ended.ending != Ending::TimeUp) {
            let why = text::ending(ended.ending, &self.scale, &self.settings);
            let after = self.scale.time(ended.ticks.into());
            return Err(DeviceError::Ended(format!("the board ended the run after {after:.3} s: {why}")));
        }
        let (recording, missing) = self.recording(run.name, &record, None);
        let begin = Begin::of(&record.rows, record.ended, run.points, self.scale.step);
        let mut reference = Vec::with_capacity(record.rows.len());
        let mut error = Vec::with_capacity(record.rows.len());
        let mut from = 0;
        for row in &record.rows {
            let tick = (row.tick - begin.tick) as usize;
            from += usize::from(tick < run.from);
            // Rounded to counts by the board; here as it was followed.
            let point = run.points.get(tick).map_or(0.0, |point| f64::from(point.x));
            reference.push(point);
            error.push(point - f64::from(row.count.wrapping_sub(begin.count)) * self.scale.step);
        }
        // What is logged is what was applied, after dead time and rounding: only the board knows that it asked for more.
        let saturated = record.ended.map_or(0, |ended| ended.saturated as usize);
        let tracked = Tracked { recording, error, reference, saturated, from };
        Ok(Followed { tracked, missing, mismatches: record.mismatches })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run of a line of two counts a tick, from count 7 and tick 2³² − 3 on. Its first four samples are lost. It began four
    /// ticks and eight counts before the first that came.
    #[test]
    fn a_run_began_before_its_first_sample() {
        let points: Vec<Setpoint<f32>> = (0..100).map(|k| Setpoint { x: 2e-3 * k as f32, v: 0.0, a: 0.0 }).collect();
        let start = u64::from(u32::MAX) - 2;
        let row = |k: u64| Row {
            tick: start + k,
            count: 0,
            drive_code: 0,
            reference: 7 + 2 * k as i32,
            mode: Mode::Track,
            current_ma: None,
            missing: 0,
        };
        let ended = Ended { mode: Mode::Track, ending: Ending::TimeUp, tick: 97, ticks: 100, saturated: 0 };
        let begin = Begin { tick: start, count: 7 };
        for lost in [0, 4] {
            let rows: Vec<Row> = (lost..100).map(row).collect();
            assert_eq!(Begin::of(&rows, Some(ended), &points, 1e-3), begin, "{lost}");
        }
        // Without a word of its end a run is taken to have begun with its first sample.
        let rows: Vec<Row> = (4..100).map(row).collect();
        assert_eq!(Begin::of(&rows, None, &points, 1e-3), Begin { tick: start + 4, count: 15 });
    }
}
