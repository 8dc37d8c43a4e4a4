//! The base model of a set of recordings: every estimator that applies, which one to trust, and what the data cannot
//! determine.

use breakaway_core::plant::{Base, Effect, Kind};
use nalgebra::{DMatrix, DVector};

use super::cycles;
use super::slow_log;
use super::swapped;
use super::weak::{self, WeakFit, Window};
use crate::fit::{self, Candidate, Fit, Free, Problem, Track, median, session};
use crate::recording::Recording;

/// Segments of the output-error fit, s (docs/theory.md, section 5).
pub const FIT_SEGMENT_S: f64 = 0.4;
/// Most segments that are simulated; longer sessions are sampled evenly.
pub const MAX_SEGMENTS: usize = 160;
/// A load is reported when it exceeds this many standard errors and this share of the Coulomb friction.
const LOAD_SIGNIFICANCE: (f64, f64) = (4.0, 0.01);
/// Standard errors from which a negative friction is taken at its word.
pub(super) const SIGNIFICANCE: f64 = 4.0;
/// Share of the drive that even a model with effects missing explains.
const MOST_UNEXPLAINED: f64 = 0.3;
/// A drive that follows the direction of motion to within this share is friction and nothing else.
const SAME_DRIVE: f64 = 1e-6;
/// The residual counts as white while the median segment's mean square stays below this multiple of the noise's.
const WHITE_RATIO: f64 = 1.5;

/// A number with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The estimate.
    pub value: f64,
    /// Its standard error.
    pub se: f64,
}

/// What one estimator says.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Name: `weak_form`, `output_error`, and for relay limit cycles `modulating` and `describing_function`.
    pub estimator: &'static str,
    /// Inertia.
    pub b: Value,
    /// Viscous.
    pub c: Value,
    /// Coulomb.
    pub f1: Value,
    /// Constant load, where both directions are seen.
    pub load: Option<Value>,
}

/// A parameter that the data cannot determine, and what would.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Undetermined {
    /// `b`, `c`, `f1` or `load`.
    pub parameter: &'static str,
    /// Why, and the experiment that would.
    pub advice: String,
}

/// The result of an identification.
#[derive(Clone, Debug)]
pub struct Identified {
    /// The estimate to use.
    pub best: Estimate,
    /// All estimates.
    pub estimates: Vec<Estimate>,
    /// The load, if it is significant.
    pub load: Option<Value>,
    /// What the data cannot determine.
    pub undetermined: Vec<Undetermined>,
    /// Position noise, position units.
    pub noise: f64,
    /// Median over the segments of the root mean square simulation error, position units.
    pub simulation_error: f64,
    /// Correlation of the weak-form residual between neighbouring windows that do not overlap.
    pub residual_correlation: f64,
    /// Whether the simulation error is down to the noise.
    pub white: bool,
    /// Remarks for the reader.
    pub remarks: Vec<String>,
    /// The output-error fit.
    pub fit: Option<Fit>,
}

/// Why no model can be given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IdentifyError {
    /// No recording.
    #[error("no recording to identify from")]
    Nothing,
    /// The axis does not move, or too briefly.
    #[error(
        "the recordings hold too little motion to identify from ({windows} windows in motion, at least 12 are needed): \
         drive the axis harder or record for longer; a relay experiment with h2 above the break-away force does it. If it did \
         move, check that --input and --position are not swapped"
    )]
    TooLittleMotion {
        /// Windows in motion.
        windows: usize,
    },
    /// A parameter cannot be told from others.
    #[error("the recordings cannot determine {parameter}: {advice}")]
    Undetermined {
        /// Which.
        parameter: &'static str,
        /// What would.
        advice: &'static str,
    },
    /// Inertia comes out negative.
    #[error(
        "the inertia comes out negative (b = {b:.3e}): a positive drive accelerates the axis backwards. Reverse the sign of \
         the drive or of the position, and check that --input and --position are not swapped"
    )]
    NegativeInertia {
        /// The estimate.
        b: f64,
    },
    /// An axis with drive and position in each other's place, and none as they are.
    #[error(
        "--input and --position seem to be swapped: as they are, {percent:.1} % of the drive stay unexplained; the other way \
         round {other_percent:.1} %, with a positive inertia and no negative friction"
    )]
    Swapped {
        /// Root mean square of the drive that is not explained, % of the drive's.
        percent: f64,
        /// The same with the columns in each other's place.
        other_percent: f64,
    },
    /// Friction comes out negative, and the equation of motion explains little of the drive.
    #[error(
        "this is no motion under this drive: {parameter} comes out negative ({value:.3e}) and {percent:.0} % of the drive \
         stay unexplained. Check that --input and --position are not swapped, and that both columns are of one recording"
    )]
    NegativeFriction {
        /// `c` or `f1`.
        parameter: &'static str,
        /// The estimate.
        value: f64,
        /// Root mean square of the drive that is not explained, % of the drive's.
        percent: f64,
    },
}

/// Identifies (b, c, f1) and a constant load from recordings of one session.
///
/// # Errors
/// [`IdentifyError`] says what is missing and which experiment would supply it.
pub fn identify(recordings: &[Recording]) -> Result<Identified, IdentifyError> {
    let mut identified = assuming_held(recordings)?;
    if slow_log::is_slow(recordings) {
        identified = slow_log::with_unknown_drive(identified, recordings);
    }
    identified.load = significant_load(&identified.best);
    Ok(identified)
}

/// Identifies with the drive held from row to row.
pub(super) fn assuming_held(recordings: &[Recording]) -> Result<Identified, IdentifyError> {
    if recordings.is_empty() {
        return Err(IdentifyError::Nothing);
    }
    let tracks = session(recordings);
    let windows = weak::windows(&tracks);
    if windows.len() < 12 {
        return Err(IdentifyError::TooLittleMotion { windows: windows.len() });
    }
    let mut undetermined = Vec::new();
    let both = both_directions(&windows);
    if !both {
        undetermined.push(Undetermined {
            parameter: "load",
            advice:
                "the axis moves in one direction only, where a load and Coulomb friction are the same force: f1 is \
                     their sum; record motion in both directions"
                    .into(),
        });
    }
    let weak_fit = solve_base(&windows, both)?;
    let weak_estimate = from_weak(&weak_fit, both);
    let biased = weak_estimate.b.value <= 0.0;
    if biased && work(&tracks) <= 0.0 {
        return Err(IdentifyError::NegativeInertia { b: weak_estimate.b.value });
    }
    let left = unexplained(&weak_fit, &windows);
    let frictions = [("c", weak_estimate.c), ("f1", weak_estimate.f1)];
    let impossible = frictions.into_iter().find(|(_, friction)| negative(*friction));
    let explained = left <= MOST_UNEXPLAINED;
    // What explains the drive by a friction that gives power is no axis; what explains little of it may still be one.
    if (impossible.is_some() || !explained)
        && let Some(other) = swapped::explains_more(recordings, left, explained)
    {
        return Err(IdentifyError::Swapped { percent: 100.0 * left, other_percent: 100.0 * other });
    }
    if let Some((parameter, Value { value, .. })) = impossible.filter(|_| !explained) {
        return Err(IdentifyError::NegativeFriction { parameter, value, percent: 100.0 * left });
    }
    weakly_determined(&weak_estimate, &mut undetermined);
    let noise = median(tracks.iter().map(|t| t.sigma).collect());
    let mut start = weak_estimate.clone();
    if biased {
        start.b.value = small_inertia(&tracks);
    }
    let segments = sampled_segments(&tracks, FIT_SEGMENT_S);
    let problem = output_error(&tracks, &segments, noise);
    let fit = fitted_from(&problem, &start);
    let mut estimates = vec![weak_estimate.clone()];
    let (mut simulation_error, mut white) = (f64::NAN, false);
    let simulated = fit.as_ref().map(|fit| from_fit(&problem, fit, both));
    if let Some(fit) = &fit {
        simulation_error = median(fit.mse.clone()).sqrt();
        white = simulation_error.powi(2) < WHITE_RATIO * noise * noise;
    }
    estimates.extend(simulated.clone());
    let best = match simulated {
        Some(simulated) if white || biased => simulated,
        _ => weak_estimate,
    };
    if best.b.value <= 0.0 {
        let advice = "the axis accelerates too little: record faster reversals, such as a relay experiment";
        return Err(IdentifyError::Undetermined { parameter: "b", advice });
    }
    let mut remarks = remarks(&estimates, white, simulation_error / noise);
    let cycles = cycles::estimates(recordings, &tracks);
    estimates.extend(cycles.estimates);
    remarks.extend(cycles.remarks);
    Ok(Identified {
        load: significant_load(&best),
        best,
        estimates,
        undetermined,
        noise,
        simulation_error,
        residual_correlation: weak_fit.lag_one,
        white,
        remarks,
        fit,
    })
}

/// The load, where it exceeds its error and a share of the Coulomb friction.
fn significant_load(best: &Estimate) -> Option<Value> {
    let (errors, share) = LOAD_SIGNIFICANCE;
    best.load.filter(|load| load.value.abs() > (errors * load.se).max(share * best.f1.value))
}

/// Whether a friction is negative by more than its error.
pub(super) fn negative(friction: Value) -> bool {
    friction.value < -SIGNIFICANCE * friction.se
}

/// Root mean square of the drive that a fit leaves, over the drive's.
pub(super) fn unexplained(fit: &WeakFit, windows: &[Window]) -> f64 {
    fit.residual.norm() / windows.iter().map(|w| w.drive * w.drive).sum::<f64>().sqrt()
}

/// Work of the drive on the motion, drive units times position units: friction takes it up, so it is positive, unless drive or
/// position has the wrong sign.
fn work(tracks: &[Track]) -> f64 {
    let of = |track: &Track| {
        let pieces = track.pieces.windows(2).flat_map(|piece| piece[0] + 1..piece[1]);
        pieces.map(|k| track.u[k - 1] * (track.xs[k] - track.xs[k - 1])).sum::<f64>()
    };
    tracks.iter().map(of).sum()
}

/// An inertia to start from where equation error gives none: its force is a tenth of the drive.
fn small_inertia(tracks: &[Track]) -> f64 {
    let mean_square = |of: fn(&Track) -> &[f64]| tracks.iter().flat_map(of).map(|value| value * value).sum::<f64>();
    0.1 * (mean_square(|track| &track.u) / mean_square(|track| &track.acceleration).max(f64::MIN_POSITIVE)).sqrt()
}

pub(super) fn both_directions(windows: &[Window]) -> bool {
    let forward = windows.iter().filter(|w| w.direction > 0.0).count();
    let least = (windows.len() / 50).max(3);
    forward >= least && windows.len() - forward >= least
}

/// Whether the drive has one value for each direction of motion: b = c = 0 then solves the equation.
fn follows_direction(windows: &[Window]) -> bool {
    [-1.0, 1.0].iter().all(|sign| {
        let means = || windows.iter().filter(|w| w.direction * sign > 0.0).map(|w| w.drive / w.unit);
        let (low, high) = means().fold((f64::MAX, f64::MIN), |(low, high), u| (low.min(u), high.max(u)));
        high - low <= SAME_DRIVE * high.abs().max(low.abs()) || low > high
    })
}

pub(super) fn solve_base(windows: &[Window], both: bool) -> Result<WeakFit, IdentifyError> {
    let (columns, target) = weak::base_columns(windows);
    let columns: DMatrix<f64> = if both { columns } else { columns.columns(0, 3).into_owned() };
    let refuse = |parameter, advice| Err(IdentifyError::Undetermined { parameter, advice });
    if follows_direction(windows) {
        return refuse(
            "b",
            "the drive never changes while the axis moves one way, and friction f1 equal to the drive explains it all: \
             record a drive that changes, such as a relay experiment or a sine",
        );
    }
    match weak::solve(&columns, &DVector::from_column_slice(target.as_slice())) {
        Some(fit) if fit.condition < 1e8 => Ok(fit),
        _ => {
            let flat = |j: usize| {
                let column = columns.column(j);
                let mean = column.mean();
                column.iter().all(|value| (value - mean).abs() <= 1e-3 * mean.abs())
            };
            if flat(1) {
                refuse(
                    "c",
                    "the speed never changes, so viscous and Coulomb friction are one force: record several speeds",
                )
            } else {
                refuse(
                    "b",
                    "inertia and friction forces keep one ratio throughout: record reversals at more than one drive level",
                )
            }
        }
    }
}

pub(super) fn from_weak(fit: &WeakFit, both: bool) -> Estimate {
    let value = |i: usize| Value { value: fit.coefficients[i], se: fit.covariance[(i, i)].max(0.0).sqrt() };
    Estimate { estimator: "weak_form", b: value(0), c: value(1), f1: value(2), load: both.then(|| value(3)) }
}

fn from_fit(problem: &Problem<'_>, fit: &Fit, both: bool) -> Estimate {
    let errors = problem.covariance(fit);
    let se = |free| errors.standard_error(free).unwrap_or(f64::NAN);
    let Base { b, c, f1 } = fit.candidate.base;
    Estimate {
        estimator: "output_error",
        b: Value { value: b, se: se(Free::Base(0)) },
        c: Value { value: c, se: se(Free::Base(1)) },
        f1: Value { value: f1, se: se(Free::Base(2)) },
        load: both.then(|| Value { value: fit.candidate.effects[0].p[0], se: se(Free::Effect(0, 0)) }),
    }
}

/// At most [`MAX_SEGMENTS`] segments, evenly taken.
pub fn sampled_segments(tracks: &[Track], length_s: f64) -> Vec<fit::Segment> {
    let all = fit::segments(tracks, length_s);
    if all.len() <= MAX_SEGMENTS {
        return all;
    }
    (0..MAX_SEGMENTS).map(|i| all[i * all.len() / MAX_SEGMENTS]).collect()
}

fn output_error<'a>(tracks: &'a [Track], segments: &'a [fit::Segment], noise: f64) -> Problem<'a> {
    let sigma = noise.max(f64::MIN_POSITIVE);
    Problem { tracks, segments, sigma, warm_up_s: 0.0, softening: 0.0, coarse: false, work: None }
}

fn fitted_from(problem: &Problem<'_>, start: &Estimate) -> Option<Fit> {
    let base = Base { b: start.b.value, c: start.c.value.max(0.0), f1: start.f1.value.max(0.0) };
    let effects: Vec<Effect<f64>> =
        start.load.iter().map(|load| Effect::new(Kind::ConstantLoad, &[load.value])).collect();
    let candidate = Candidate { base, effects };
    problem.fit(&candidate, &Free::all(&candidate.effects), None, 15).ok()
}

pub(super) fn weakly_determined(estimate: &Estimate, undetermined: &mut Vec<Undetermined>) {
    for (parameter, value, advice) in [
        ("b", estimate.b, "record faster reversals: a relay experiment with a larger h1"),
        ("c", estimate.c, "record higher speeds, or relay experiments with different h2"),
        ("f1", estimate.f1, "record slower motion in both directions, or relay experiments with different h2"),
    ] {
        if !value.se.is_finite() || value.se > 0.3 * value.value.abs() || value.value < 0.0 {
            undetermined.push(Undetermined {
                parameter,
                advice: format!(
                    "{:.3e} ± {:.1e} is not told from zero or from the other terms: {advice}",
                    value.value, value.se
                ),
            });
        }
    }
}

fn remarks(estimates: &[Estimate], white: bool, ratio: f64) -> Vec<String> {
    let mut remarks = vec![
        "c is back-EMF and viscous friction together (Ke + f2): they act alike, and position data cannot split them"
            .into(),
    ];
    if !white {
        remarks.push(format!(
            "the simulation misses the recording by {ratio:.1} times the noise, so the model misses something; `breakaway \
             discover` looks for it"
        ));
    }
    if let [weak, simulated] = estimates {
        let differ = |a: Value, b: Value| (a.value - b.value).abs() > 3.0 * a.se.hypot(b.se);
        let differ = differ(weak.b, simulated.b) || differ(weak.c, simulated.c) || differ(weak.f1, simulated.f1);
        if differ && white {
            remarks.push(
                "weak_form and output_error differ by more than their errors. The simulation follows the recording down to its \
                 noise, so the weak form is biased, by noise or by reversals within its windows. The output-error numbers are \
                 reported"
                    .into(),
            );
        } else if differ {
            remarks.push(
                "weak_form and output_error differ by more than their errors, because the model misses something. A missing \
                 force biases the simulation over 0.4 s more than the forces over 40 ms. The weak-form numbers are reported"
                    .into(),
            );
        } else {
            remarks.push(format!(
                "weak_form and output_error agree within their errors; b differs by {:+.1} %",
                100.0 * (simulated.b.value / weak.b.value - 1.0)
            ));
        }
    }
    remarks
}
