//! The base model by output error: the simulation fit, started from another estimate.

use breakaway_core::plant::{Base, Effect, Kind};

use super::result::{ModelEstimate, Value};
use crate::fit::{self, Candidate, Fit, Free, MeasuredMotion, Problem};

/// The estimator's name.
pub(super) const OUTPUT_ERROR: &str = "output_error";
/// Iterations of its fit: from an estimate that is a few per cent off it converges in fewer.
pub(super) const FIT_ITERATIONS: usize = 15;
/// Segments of the output-error fit, s (docs/theory.md, section 5).
pub(super) const FIT_SEGMENT_S: f64 = 0.4;
/// Most segments that are simulated; longer sessions are sampled evenly.
pub(super) const MAX_SEGMENTS: usize = 160;

/// An inertia to start from where equation error gives none: its force is a tenth of the drive.
pub(super) fn small_inertia(tracks: &[MeasuredMotion]) -> f64 {
    let mean_square =
        |of: fn(&MeasuredMotion) -> &[f64]| tracks.iter().flat_map(of).map(|value| value * value).sum::<f64>();
    0.1 * (mean_square(|track| &track.u) / mean_square(|track| &track.acceleration).max(f64::MIN_POSITIVE)).sqrt()
}

pub(super) fn from_fit(problem: &Problem<'_>, fit: &Fit, both: bool) -> ModelEstimate {
    let errors = problem.covariance(fit);
    let se = |free| errors.standard_error(free).unwrap_or(f64::NAN);
    let Base { b, c, f1 } = fit.candidate.base;
    ModelEstimate {
        estimator: OUTPUT_ERROR,
        b: Value { value: b, se: se(Free::Base(0)) },
        c: Value { value: c, se: se(Free::Base(1)) },
        f1: Value { value: f1, se: se(Free::Base(2)) },
        load: both.then(|| Value { value: fit.candidate.effects[0].p[0], se: se(Free::Effect(0, 0)) }),
    }
}

/// At most [`MAX_SEGMENTS`] segments, evenly taken.
pub(super) fn sampled_segments(tracks: &[MeasuredMotion], length_s: f64) -> Vec<fit::Segment> {
    fit::sampled(fit::segments(tracks, length_s), MAX_SEGMENTS)
}

pub(super) fn output_error<'a>(tracks: &'a [MeasuredMotion], segments: &'a [fit::Segment], noise: f64) -> Problem<'a> {
    let sigma = noise.max(f64::MIN_POSITIVE);
    Problem { tracks, segments, sigma, warm_up_s: 0.0, softening: 0.0, coarse: false, work: None }
}

pub(super) fn fitted_from(problem: &Problem<'_>, start: &ModelEstimate) -> Option<Fit> {
    let candidate = model_of(start);
    problem.fit(&candidate, &Free::all(&candidate.effects), None, FIT_ITERATIONS).ok()
}

/// The model of an estimate; a negative friction is none.
pub(super) fn model_of(estimate: &ModelEstimate) -> Candidate {
    let base = Base { b: estimate.b.value, c: estimate.c.value.max(0.0), f1: estimate.f1.value.max(0.0) };
    let load = estimate.load.iter().map(|load| Effect::new(Kind::ConstantLoad, &[load.value]));
    Candidate { base, effects: load.collect() }
}
