//! A stretch of each recording on which the identified model does as well as it usually does: for a figure.

use super::output_error::{model_of, output_error};
use super::result::Identification;
use crate::fit::{self, SCORE_ITERATIONS, sampled, segments, session};
use crate::recording::Recording;

/// Length of a stretch, s: as long as the open-loop windows of a discovery (docs/discovery.md, section 8).
const LENGTH_S: f64 = 1.0;
/// Most stretches of a recording that are compared.
const MOST_STRETCHES: usize = 40;

/// A stretch of a recording, measured and simulated on the same drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Typical {
    /// Name of the recording.
    pub name: String,
    /// Time by the session's clock, s.
    pub t: Vec<f64>,
    /// Drive.
    pub u: Vec<f64>,
    /// Measured position.
    pub measured: Vec<f64>,
    /// Position simulated with the identified model, from a fitted initial state.
    pub simulated: Vec<f64>,
}

/// For each recording the stretch of 1 s whose simulation error is the median of its stretches. A recording that is too
/// short for a stretch, or on which the model diverges, has none.
pub fn typical(recordings: &[Recording], identified: &Identification) -> Vec<Typical> {
    let tracks = session(recordings);
    let model = model_of(&identified.best);
    let all = segments(&tracks, LENGTH_S);
    let of_track = |track: usize| {
        let own: Vec<fit::Segment> = all.iter().copied().filter(|segment| segment.track == track).collect();
        let own = sampled(own, MOST_STRETCHES);
        let errors = output_error(&tracks, &own, identified.noise).score(&model);
        let mut order: Vec<(f64, fit::Segment)> =
            errors.into_iter().zip(own).filter(|(error, _)| error.is_finite()).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let segment = order.get(order.len() / 2)?.1;
        let one = [segment];
        let problem = output_error(&tracks, &one, identified.noise);
        let fitted = problem.fit(&model, &[], None, SCORE_ITERATIONS).ok()?;
        let (prepared, range) = (&tracks[track], segment.start..segment.start + segment.len);
        Some(Typical {
            name: prepared.name.clone(),
            t: prepared.t[range.clone()].to_vec(),
            u: prepared.u[range.clone()].to_vec(),
            measured: prepared.x[range].to_vec(),
            simulated: problem.positions(&model, segment, fitted.initial[0]),
        })
    };
    (0..tracks.len()).filter_map(of_track).collect()
}
