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

/// Whether one amplitude can change the evidence for many: these gain, and the motion is physical with them.
pub(super) fn is_open(own: &Evidence) -> bool {
    own.gain() > 0.0 && !matches!(own.rejection, Some(Rejection::Inertia | Rejection::Base))
}

/// The evidence for waves of recordings that each have their own zero: `own` with an amplitude for each, `one` with one
/// for all. One amplitude must gain nearly as much. The many follow the noise of their side, so that the sides may seem to
/// disagree. Then the one amplitude decides.
pub(super) fn as_one_wave(own: Evidence, one: Evidence, settings: &Settings) -> Evidence {
    if one.gain() < settings.tie * own.gain() {
        return Evidence { rejection: Some(Rejection::Amplitude), ..own };
    }
    match own.rejection {
        Some(Rejection::Coherence | Rejection::Disagreement(_)) if one.rejection.is_none() => {
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
    let mut sum: Field = fields.first()?.iter().map(|_| Vec::new()).collect();
    for (pair, phase) in fields.chunks_exact(2).zip(phases) {
        for (field, weight) in pair.iter().zip(phase) {
            for (sum, own) in sum.iter_mut().zip(*field) {
                sum.resize(sum.len().max(own.len()), 0.0);
                sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += weight * own);
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

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Kind;

    use super::*;
    use crate::discover::judge::gain::Gain;
    use crate::discover::judge::term::Name;

    /// What speaks for a wave of this gain.
    fn evidence(flat: f64, rejection: Option<Rejection>) -> Evidence {
        let gain = Gain { flat, local: flat, z: 9.0 };
        Evidence { u: gain, a: gain, disagreement: 0.1, coherence: 0.9, rejection }
    }

    /// One amplitude that gains less than .7 of what the many gain makes no law. One that gains nearly as much tells that
    /// the sides agree, where the many do not.
    #[test]
    fn one_amplitude_must_gain_nearly_as_much() {
        let of = |own, one| as_one_wave(own, one, &Settings::default()).rejection;
        let many = evidence(1.0, None);
        assert_eq!(of(many, evidence(0.6, None)), Some(Rejection::Amplitude));
        assert_eq!(of(many, evidence(0.8, Some(Rejection::Gain))), None);
        assert_eq!(of(evidence(1.0, Some(Rejection::Gain)), evidence(0.6, None)), Some(Rejection::Amplitude));
        let apart = evidence(1.0, Some(Rejection::Disagreement(0.4)));
        assert_eq!(of(apart, evidence(0.8, None)), None);
        assert_eq!(of(apart, evidence(0.6, None)), Some(Rejection::Amplitude));
        assert_eq!(of(apart, evidence(0.8, Some(Rejection::Gain))), Some(Rejection::Disagreement(0.4)));
    }

    /// A side with these amplitudes of one term, and the same error for each.
    fn side(amplitudes: &[f64], error: f64) -> Side {
        Side {
            b: 1.0,
            b_error: 0.0,
            c: 0.0,
            f1: 0.0,
            base_errors: [0.0; 2],
            amplitudes: vec![amplitudes.to_vec()],
            errors: vec![vec![error; amplitudes.len()]],
            forces: Vec::new(),
            residual: Vec::new(),
            target: Vec::new(),
        }
    }

    /// Two recordings of one sample each. The first wave has the amplitudes 3 and 4, the second 0 and 5. Both have the
    /// size 5, whose mean is 5, and the joined column holds .6·sin + .8·cos of the first and the cosine of the second.
    #[test]
    fn the_phases_stay_and_the_amplitude_is_one() {
        let columns = [[1.0, 0.0], [10.0, 0.0], [0.0, 2.0], [0.0, 20.0]];
        let fields = columns.map(|[first, second]| vec![vec![first], vec![second]]);
        let term = Term {
            own_zeros: true,
            shape: Shape::Wave,
            ..Term::force(Name::Effect(Kind::GravityLoad), fields.to_vec())
        };
        let fitted = Fitted { u: side(&[3.0, 4.0, 0.0, 5.0], 0.1), a: side(&[3.0, 4.0, 0.0, 5.0], 0.1) };
        let one = one_wave(&Model::default().with(&term), 0, &fitted).unwrap();
        let joined = one.u[0].field().unwrap();
        assert!((joined[0][0] - 8.6).abs() < 1e-12 && (joined[1][0] - 20.0).abs() < 1e-12, "{joined:?}");
        assert!((amplitude(&fitted.u, 0) - 5.0).abs() < 1e-12);
        let plain = Term { own_zeros: false, ..term };
        assert!(one_wave(&Model::default().with(&plain), 0, &fitted).is_none());
    }
}
