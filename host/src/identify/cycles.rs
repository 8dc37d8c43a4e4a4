//! Relay limit cycles among the recordings: what the streaming estimators of the board make of them.
//!
//! `modulating` and `describing_function` (docs/theory.md, section 4, items 4 and 3) stand beside the host's own
//! estimates. The first is what a board reports, the second the closed form with its known bias.

use std::f64::consts::{FRAC_PI_4, TAU};

use breakaway_core::estimate::describing_function::{CycleFit, DescribingError, describing_function};
use breakaway_core::estimate::modulating::{Block, Modulating, Refusal, estimate};

use super::estimate::{ModelEstimate, Remark, Value};
use crate::fit::{MeasuredMotion, median};
use crate::recording::{Recording, Signal};
use crate::sine;

/// Half-width of the central difference whose sign is the velocity's, in periods (section 4, item 4).
const HALF_WIDTH: f64 = 0.02;
/// Delay line of the modulating estimator, samples: periods up to 51 000 samples keep the full half-width.
const LINE: usize = 2048;
/// A sine fit that leaves more than this share of the amplitude is no settled limit cycle: the harmonics of one leave 3 %.
const MOST_RESIDUAL: f64 = 0.15;

/// Rows for the table of estimates, and remarks on what they cannot tell.
#[derive(Clone, Debug, Default)]
pub struct CycleEstimates {
    /// `modulating` and `describing_function`, where they apply.
    pub estimates: Vec<ModelEstimate>,
    /// Refusals, with the experiment that would help.
    pub remarks: Vec<Remark>,
}

/// An evenly sampled recording under a relay.
struct Relay<'a> {
    recording: &'a Recording,
    sigma: f64,
    ts: f64,
    /// Mean period of the switching over the second half, s.
    period_s: f64,
    /// Distinct |u| other than 0, the largest first.
    levels: Vec<f64>,
}

/// Runs the streaming estimators over the relay recordings among `recordings`; `tracks` are the same, prepared.
/// Nothing at all where there is no relay recording.
pub fn estimates(recordings: &[Recording], tracks: &[MeasuredMotion]) -> CycleEstimates {
    let relays: Vec<Relay<'_>> = recordings.iter().zip(tracks).filter_map(|(r, t)| Relay::new(r, t)).collect();
    let mut found = CycleEstimates::default();
    if relays.is_empty() {
        return found;
    }
    match modulating(&relays) {
        Ok(estimate) => found.estimates.push(estimate),
        Err(refusal) => found.remarks.push(Remark::Refused { estimator: "modulating", advice: refusal.advice() }),
    }
    let cycles: Vec<CycleFit<f64>> = relays.iter().filter_map(Relay::cycle).collect();
    match describing(&cycles) {
        Ok(estimate) => found.estimates.push(estimate),
        Err(error) => {
            let advice = advice(error, cycles.len());
            found.remarks.push(Remark::Refused { estimator: "describing_function", advice });
        }
    }
    found
}

fn advice(error: DescribingError, settled: usize) -> &'static str {
    match (error, settled) {
        (DescribingError::TooFewExperiments, 0) => {
            "no relay recording ends in a settled limit cycle; b, c and f1 need two that do, with different h2: record \
             for longer, or raise h2"
        }
        (DescribingError::TooFewExperiments, _) => {
            "a single relay recording ends in a settled limit cycle: c and f1 cannot be separated by it; record another \
             with a different h2"
        }
        _ => error.advice(),
    }
}

impl<'a> Relay<'a> {
    /// `None` unless the recording is evenly sampled and its drive has at most four levels, symmetric about zero, that
    /// alternate with a steady period.
    fn new(recording: &'a Recording, track: &MeasuredMotion) -> Option<Self> {
        let ts = recording.evenly_sampled()?;
        let mut levels: Vec<f64> = Vec::new();
        for &u in &recording.u {
            if u != 0.0 && !levels.contains(&u) {
                levels.push(u);
                if levels.len() > 4 {
                    return None;
                }
            }
        }
        let largest = levels.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-6 * largest;
        if !levels.iter().all(|u| levels.iter().any(|v| same(*u, -v))) {
            return None;
        }
        levels.retain(|u| *u > 0.0);
        levels.sort_by(|a, b| b.total_cmp(a));
        let period_s = ts * switching_period(&recording.u)?;
        Some(Self { recording, sigma: track.sigma, ts, period_s, levels })
    }

    /// The second half, where the cycle has settled.
    fn settled(&self) -> Signal {
        let half = self.recording.t.len() / 2;
        Signal {
            name: self.recording.name.clone(),
            column: "x".to_owned(),
            unit: None,
            t: self.recording.t[half..].to_vec(),
            y: self.recording.x[half..].to_vec(),
            gaps: Vec::new(),
        }
    }

    /// The settled cycle; `None` if the second half is not close to one, or the drive is not that of a dual relay.
    fn cycle(&self) -> Option<CycleFit<f64>> {
        let signal = self.settled();
        let fit = sine::fit(&signal, f64::NEG_INFINITY..=f64::INFINITY, Some(self.period_s)).ok()?;
        if fit.rms > MOST_RESIDUAL * fit.amplitude {
            return None;
        }
        let (h1, h2) = self.amplitudes(fit.omega_rad_s, fit.phase_start_rad)?;
        Some(CycleFit {
            h1,
            h2,
            a: fit.amplitude,
            omega: fit.omega_rad_s,
            a_error: fit.se.amplitude,
            omega_error: fit.se.omega_rad_s,
        })
    }

    /// h1 and h2 from the levels h1 + h2 and |h1 − h2|. The relay on the error drives against the position, the one
    /// on its integral with the velocity. So the fundamental of u shows which of the two is larger.
    fn amplitudes(&self, omega: f64, phase: f64) -> Option<(f64, f64)> {
        let sum = *self.levels.first()?;
        let difference = match self.levels[..] {
            [_, difference] => difference,
            // Equal amplitudes leave 0 as their difference; without it there is one relay only.
            _ if self.recording.u.contains(&0.0) => 0.0,
            _ => return None,
        };
        let half = self.recording.t.len() / 2;
        let first = self.recording.t[half];
        let cycles = ((self.recording.t.len() - half) as f64 * self.ts * omega / TAU).floor();
        let whole = (cycles * TAU / (omega * self.ts)).round() as usize;
        let (mut against, mut with) = (0.0, 0.0);
        for (t, u) in self.recording.t[half..].iter().zip(&self.recording.u[half..]).take(whole) {
            // The drive is held to the next sample: its middle counts.
            let (sin, cos) = (omega * (t - first + 0.5 * self.ts) + phase).sin_cos();
            against -= u * sin;
            with += u * cos;
        }
        let (large, small) = (0.5 * (sum + difference), 0.5 * (sum - difference));
        let scale = 2.0 * FRAC_PI_4 / whole.max(1) as f64;
        let misfit = |h1: f64, h2: f64| (against * scale - h1).hypot(with * scale - h2);
        Some(if misfit(large, small) <= misfit(small, large) { (large, small) } else { (small, large) })
    }

    fn blocks(&self) -> Option<[Block; 1]> {
        let period = self.period_s / self.ts;
        let half_width = ((HALF_WIDTH * period).round() as usize).clamp(2, (LINE - 1) / 2);
        let x = &self.recording.x;
        let late = &x[x.len() / 2..];
        let range = late.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
        // Four deviations and a step, but never what a twentieth of the cycle moves.
        let band = 4.0 * self.sigma + self.recording.encoder_step.unwrap_or(0.0);
        let band = band.min(0.05 * (range.1 - range.0));
        let window = (2.0 * period).round() as u32;
        let estimator = Modulating::<f64, 1, LINE>::new(self.ts, window, half_width, [2], band).ok()?;
        let mut state = estimator.start();
        for (x, u) in x.iter().zip(&self.recording.u) {
            estimator.push(&mut state, *x, *u);
        }
        Some(*state.blocks())
    }
}

/// Samples per period, from the drive's changes of sign upwards in the second half of the record. `None` if there are
/// fewer than three periods or they are not steady.
fn switching_period(u: &[f64]) -> Option<f64> {
    let mut last = 0.0;
    let mut rises = Vec::new();
    for (k, &u) in u.iter().enumerate() {
        if u == 0.0 {
            continue;
        }
        if u > 0.0 && last < 0.0 {
            rises.push(k);
        }
        last = u;
    }
    rises.retain(|k| *k >= u.len() / 2);
    let intervals: Vec<f64> = rises.windows(2).map(|w| (w[1] - w[0]) as f64).collect();
    if intervals.len() < 3 {
        return None;
    }
    let typical = median(intervals.clone());
    let steady = intervals.iter().filter(|i| (*i - typical).abs() <= 0.1 * typical + 1.0).count();
    (steady * 10 >= intervals.len() * 9).then(|| intervals.iter().sum::<f64>() / intervals.len() as f64)
}

fn modulating(relays: &[Relay<'_>]) -> Result<ModelEstimate, Refusal> {
    let blocks: Vec<[Block; 1]> = relays.iter().filter_map(Relay::blocks).collect();
    let experiments: Vec<&[Block]> = blocks.iter().map(<[Block; 1]>::as_slice).collect();
    let found = estimate(&experiments)?;
    let [b, c, f1, _] = found.standard_errors;
    Ok(ModelEstimate {
        estimator: "modulating",
        b: Value { value: found.b, se: b },
        c: Value { value: found.c, se: c },
        f1: Value { value: found.f1, se: f1 },
        load: None,
    })
}

fn describing(cycles: &[CycleFit<f64>]) -> Result<ModelEstimate, DescribingError> {
    let found = describing_function(cycles)?;
    let value = |i: usize| Value { value: found.parameters[i], se: found.covariance[i][i].max(0.0).sqrt() };
    Ok(ModelEstimate { estimator: "describing_function", b: value(0), c: value(1), f1: value(2), load: None })
}
