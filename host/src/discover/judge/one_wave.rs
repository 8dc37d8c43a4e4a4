//! Waves of recordings that each have their own zero. They are one law only if one amplitude does for all of them.

use super::evidence::{Evidence, Rejection};
use super::settings::Settings;
use super::sides::{Fitted, Model, Side};
use super::term::{Column, Shape, Term};
use super::weak_form::Field;

/// The `index`-th term of a model with the phases of its fit and one amplitude for all recordings. `None` where it is
/// no wave that has a phase for each recording.
///
/// The term has a sine and a cosine for each recording, with amplitudes p and q. Its wave p·sin + q·cos has the phase
/// atan2(q, p). Noise biases p and q of one side or the other, so the phase is that of both sides' sum.
pub(super) fn one_wave(model: &Model, index: usize, fitted: &Fitted) -> Option<Term> {
    let term = &model.terms[index];
    let own_phases = term.own_zeros && term.shape == Shape::Wave;
    let both = [&fitted.u, &fitted.a].map(|side| &side.amplitudes[index]);
    if !own_phases || both[0].len() != both[1].len() || both[0].len() != term.u.len() {
        return None;
    }
    let sums: Vec<f64> = both[0].iter().zip(both[1]).map(|(u, a)| u + a).collect();
    let phases: Vec<[f64; 2]> = sums.chunks_exact(2).map(|pq| direction(pq[0], pq[1])).collect();
    let joined = |columns: &[Column]| {
        if columns.is_empty() { Some(Vec::new()) } else { join(columns, &phases).map(|own| vec![own]) }
    };
    Some(Term { u: joined(&term.u)?, a: joined(&term.a)?, ..term.clone() })
}

/// The evidence for waves of recordings that each have their own zero: `own` with an amplitude for each, `one` with one
/// for all. One amplitude must gain nearly as much. The many follow the noise of their side, so that the sides may seem to
/// disagree. Then the one amplitude decides.
pub(super) fn as_one_wave(own: Evidence, one: Evidence, settings: &Settings) -> Evidence {
    let differ = one.gain() < settings.tie * own.gain();
    match own.rejection {
        None if differ => Evidence { rejection: Some(Rejection::Amplitude), ..own },
        Some(Rejection::Coherence | Rejection::Disagreement(_)) if !differ && one.rejection.is_none() => {
            Evidence { disagreement: one.disagreement, coherence: one.coherence, rejection: None, ..own }
        }
        _ => own,
    }
}

/// Cosine and sine of the phase atan2(q, p).
fn direction(p: f64, q: f64) -> [f64; 2] {
    let size = p.hypot(q).max(f64::MIN_POSITIVE);
    [p / size, q / size]
}

/// One column of all recordings' sines and cosines; `None` where a column is known in windows alone.
fn join(columns: &[Column], phases: &[[f64; 2]]) -> Option<Column> {
    let fields: Option<Vec<&Field>> = columns.iter().map(Column::field).collect();
    let fields = fields?;
    let mut sum: Field = fields.first()?.iter().map(|piece| vec![0.0; piece.len()]).collect();
    for (pair, phase) in fields.chunks_exact(2).zip(phases) {
        for (field, weight) in pair.iter().zip(phase) {
            for (sum, own) in sum.iter_mut().flatten().zip(field.iter().flatten()) {
                *sum += weight * own;
            }
        }
    }
    Some(match columns.first()? {
        Column::Displacement(_) => Column::displacement(sum),
        _ => Column::force(sum),
    })
}

/// Amplitude of a wave that has a sine and a cosine for each recording: the mean, weighted by the inverse variances.
pub(super) fn amplitude(side: &Side, index: usize) -> f64 {
    let pairs = side.amplitudes[index].chunks_exact(2).zip(side.errors[index].chunks_exact(2));
    let [weighted, weights] = pairs.fold([0.0; 2], |[weighted, weights], (own, error)| {
        let weight = error[0].max(error[1]).max(f64::MIN_POSITIVE).powi(-2).min(f64::MAX);
        [weighted + weight * own[0].hypot(own[1]), weights + weight]
    });
    weighted / weights
}
