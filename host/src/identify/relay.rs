//! Relay runs: how the experiment ended (docs/theory.md, section 2).

use breakaway_core::estimate::limit_cycle::{
    DetectorError, DetectorSettings, Limit, LimitCycle, LimitCycleDetector, NoLimitCycleReason, RelayOutcome,
};
use serde::Serialize;

use crate::recording::Units;
use crate::simulate::axis::{Run, relay_resolution};
use crate::simulate::experiment::{Excitation, Experiment, Reference};

/// Change of period and amplitude still to come that counts as settled: the first of these that three cycles meet. Encoder
/// steps, noise and the tick move every switch, which a slowly contracting cycle amplifies beyond the strictest.
const TOLERANCES: [f64; 4] = [0.005, 0.01, 0.02, 0.05];

/// No motion though h1 + h2 exceeds the friction.
const STUCK: &str = "no motion: noise set the relays against each other before the axis left the hysteresis, and |h1 \
     − h2| does not break it away. Make |h1 − h2| larger than the break-away force, or start again";

/// A limit cycle's numbers, means over its last three cycles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct CycleNumbers {
    /// Period, s.
    pub period_s: f64,
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Amplitude, position units.
    pub amplitude: f64,
    /// Mean error, position units.
    pub bias: f64,
    /// Mean drive, drive units: the load.
    pub mean_drive: f64,
    /// Cycles until it had settled.
    pub cycles: u32,
    /// Relative change of period and amplitude that may still come.
    pub tolerance: f64,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum RelayReport {
    /// In a symmetric limit cycle.
    Settled(CycleNumbers),
    /// In a limit cycle whose directions differ.
    Asymmetric {
        /// Its numbers.
        #[serde(flatten)]
        cycle: CycleNumbers,
        /// (Time above zero − time below)/period.
        asymmetry: f64,
    },
    /// There is no limit cycle.
    NoLimitCycle {
        /// Why, and what to do.
        reason: &'static str,
    },
    /// The time was up before it settled.
    Timeout {
        /// Cycles seen.
        cycles: u32,
        /// Relative change of period or amplitude in the last one.
        last_change: f64,
    },
    /// A limit was passed.
    LimitTripped {
        /// `travel`, `error` or `not_finite`; on a board also `speed`, `current`, `mean_drive`.
        limit: &'static str,
        /// Position relative to the start, position units. It is the measured value where that was not finite. For
        /// the limits of a board it is its number (counts/s, mA, drive code).
        value: f64,
    },
    /// The detector does not apply.
    NotJudged {
        /// Why.
        reason: &'static str,
    },
}

/// How a run ended; `None` for an excitation that is no relay and met no limit. `f1` is the Coulomb friction (or the
/// break-away force) where it is known. It decides whether a limit cycle can exist, and how fast one settles.
pub fn ending(run: &Run, experiment: &Experiment, f1: Option<f64>) -> Option<RelayReport> {
    if let Some(value) = run.tripped {
        return Some(RelayReport::LimitTripped { limit: "travel", value });
    }
    let Excitation::Relay { h1, h2, hysteresis, reference } = experiment.excitation else {
        return None;
    };
    if moves(reference) {
        return Some(RelayReport::NotJudged { reason: "the reference moves" });
    }
    let (count, counts) = relay_resolution(hysteresis, experiment.sensor);
    let samples = run.recording.x.len();
    let settings = DetectorSettings {
        ts: experiment.tick_s,
        h1,
        h2,
        hysteresis: (f64::from(counts) + 0.5) * count,
        f1,
        tolerance: TOLERANCES[0],
        // The last sample of the run is the last that can end it.
        timeout_s: (samples as f64 - 0.5) * experiment.tick_s,
        max_error: f64::INFINITY,
    };
    let mut last = RelayReport::NotJudged { reason: "the run is empty" };
    for tolerance in TOLERANCES {
        last = match LimitCycleDetector::new(DetectorSettings { tolerance, ..settings }) {
            Ok(detector) => judged(&detector, run, tolerance),
            Err(DetectorError::Timeout) => {
                RelayReport::NotJudged { reason: "the run is too short to judge; give duration_s at least 17 ticks" }
            }
            Err(_) => RelayReport::NotJudged { reason: "the experiment is outside the detector's range" },
        };
        if !matches!(last, RelayReport::Timeout { .. }) {
            break;
        }
    }
    let weak = NoLimitCycleReason::DriveBelowBreakaway.advice();
    if last == (RelayReport::NoLimitCycle { reason: weak }) && f1.is_some_and(|f1| h1 + h2 > f1) {
        last = RelayReport::NoLimitCycle { reason: STUCK };
    }
    Some(last)
}

/// What the detector says of the whole run.
fn judged(detector: &LimitCycleDetector<f64>, run: &Run, tolerance: f64) -> RelayReport {
    let mut state = detector.start();
    let samples = run.recording.x.iter().zip(&run.recording.u);
    let outcome = samples.into_iter().find_map(|(x, u)| detector.push(&mut state, run.start - x, *u));
    match outcome {
        Some(RelayOutcome::Settled(cycle)) => RelayReport::Settled(CycleNumbers::new(cycle, tolerance)),
        Some(RelayOutcome::Asymmetric { cycle, asymmetry }) => {
            RelayReport::Asymmetric { cycle: CycleNumbers::new(cycle, tolerance), asymmetry }
        }
        Some(RelayOutcome::NoLimitCycle { reason }) => RelayReport::NoLimitCycle { reason: reason.advice() },
        Some(RelayOutcome::Timeout { cycles, last_change }) => RelayReport::Timeout { cycles, last_change },
        Some(RelayOutcome::LimitTripped { which: Limit::Error, value }) => {
            RelayReport::LimitTripped { limit: "error", value }
        }
        Some(RelayOutcome::LimitTripped { which: Limit::NotFinite, value }) => {
            RelayReport::LimitTripped { limit: "not_finite", value }
        }
        // Not reached: the time given is that of the run.
        None => RelayReport::Timeout { cycles: 0, last_change: 1.0 },
    }
}

fn moves(reference: Reference) -> bool {
    match reference {
        Reference::Start => false,
        Reference::Triangle { amplitude, .. } | Reference::Sine { amplitude, .. } => amplitude != 0.0,
    }
}

impl CycleNumbers {
    fn new(cycle: LimitCycle<f64>, tolerance: f64) -> Self {
        let LimitCycle { period_s, omega, amplitude, bias, mean_drive, cycles, .. } = cycle;
        Self { period_s, omega, amplitude, bias, mean_drive, cycles, tolerance }
    }

    fn text(&self, units: &Units) -> String {
        let Self { period_s, omega, amplitude, bias, mean_drive, cycles, tolerance } = self;
        format!(
            "T = {period_s:.6} s, ω = {omega:.5} rad/s, a = {amplitude:.5} {x}, bias {bias:.1e} {x}, mean drive \
             {mean_drive:.1e} {u}, after {cycles} cycles to within {percent} %",
            percent = 100.0 * tolerance,
            x = units.x,
            u = units.u
        )
    }
}

impl RelayReport {
    /// The ending in words, with its numbers.
    pub fn text(&self, units: &Units) -> String {
        match self {
            Self::Settled(cycle) => format!("settled: {}", cycle.text(units)),
            Self::Asymmetric { cycle, asymmetry } => {
                format!("asymmetric ({:+.1} % of the period): {}", 100.0 * asymmetry, cycle.text(units))
            }
            Self::NoLimitCycle { reason } => format!("no limit cycle: {reason}"),
            Self::Timeout { cycles, last_change } => format!(
                "timeout: not settled after {cycles} cycles, the last one changed by {:.2} %; record for longer",
                100.0 * last_change
            ),
            Self::LimitTripped { limit: "travel", value } => {
                format!("limit tripped: {value:.4} {} from the start", units.x)
            }
            Self::LimitTripped { limit: "error", value } => {
                format!("limit tripped: the error was {value:.4} {}", units.x)
            }
            Self::LimitTripped { limit: limit @ ("speed" | "current" | "mean_drive"), value } => {
                format!("limit tripped: the board's {limit} limit, at {value}")
            }
            Self::LimitTripped { value, .. } => format!("limit tripped: the reading or the drive was {value}"),
            Self::NotJudged { reason } => format!("not judged: {reason}"),
        }
    }
}
