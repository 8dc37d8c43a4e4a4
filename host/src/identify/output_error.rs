//! The base model by output error: the simulation fit, started from another estimate.

use breakaway_core::plant::{Base, Effect, Kind};

use super::result::{Estimate, Value};
use crate::fit::{self, Candidate, Fit, Free, Problem, Track};

/// Segments of the output-error fit, s (docs/theory.md, section 5).
pub const FIT_SEGMENT_S: f64 = 0.4;
/// Most segments that are simulated; longer sessions are sampled evenly.
pub const MAX_SEGMENTS: usize = 160;

/// An inertia to start from where equation error gives none: its force is a tenth of the drive.
pub(super) fn small_inertia(tracks: &[Track]) -> f64 {
    let mean_square = |of: fn(&Track) -> &[f64]| tracks.iter().flat_map(of).map(|value| value * value).sum::<f64>();
    0.1 * (mean_square(|track| &track.u) / mean_square(|track| &track.acceleration).max(f64::MIN_POSITIVE)).sqrt()
}

pub(super) fn from_fit(problem: &Problem<'_>, fit: &Fit, both: bool) -> Estimate {
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

pub(super) fn output_error<'a>(tracks: &'a [Track], segments: &'a [fit::Segment], noise: f64) -> Problem<'a> {
    let sigma = noise.max(f64::MIN_POSITIVE);
    Problem { tracks, segments, sigma, warm_up_s: 0.0, softening: 0.0, coarse: false, work: None }
}

pub(super) fn fitted_from(problem: &Problem<'_>, start: &Estimate) -> Option<Fit> {
    let base = Base { b: start.b.value, c: start.c.value.max(0.0), f1: start.f1.value.max(0.0) };
    let effects: Vec<Effect<f64>> =
        start.load.iter().map(|load| Effect::new(Kind::ConstantLoad, &[load.value])).collect();
    let candidate = Candidate { base, effects };
    problem.fit(&candidate, &Free::all(&candidate.effects), None, 15).ok()
}
