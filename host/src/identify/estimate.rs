//! The base model of a set of recordings: every estimator that applies, which one to trust, and what the data cannot
//! determine.

use super::choice;
use super::cycles;
use super::determined::{significant_load, weakly_determined};
use super::equation_error::{WEAK_FORM, both_directions, from_weak, negative, solve_base, unexplained};
use super::gravity;
use super::output_error::{
    FIT_SEGMENT_S, OUTPUT_ERROR, fitted_from, from_fit, output_error, sampled_segments, small_inertia,
};
use super::slow_log;
use super::swapped;
use super::weak;
pub use super::winding::mechanical;
use super::winding::winding;
use crate::fit::{MeasuredMotion, median, session};
use crate::recording::Recording;

pub use super::choice::{Choice, Reason};
pub use super::error::IdentifyError;
pub use super::gravity::GravityTrial;
pub use super::held_out::Comparison;
pub use super::remark::Remark;
pub use super::result::{Identification, ModelEstimate, StartingModel, Undetermined, Value};
pub use super::winding::Winding;

/// Share of the drive that even a model with effects missing explains.
const MOST_UNEXPLAINED: f64 = 0.3;
/// The residual counts as white while the median segment's mean square stays below this multiple of the noise's.
pub(super) const WHITE_RATIO: f64 = 1.5;

/// Identifies (b, c, f1) and a constant load from recordings of one session, by the estimator that predicts held-out blocks better.
///
/// # Errors
/// [`IdentifyError`] says what is missing and which experiment would supply it.
pub fn identify(recordings: &[Recording]) -> Result<Identification, IdentifyError> {
    let (mut identified, prepared) = assuming_held(recordings)?;
    choose(&mut identified, &prepared);
    let mut identified = finished(identified, recordings);
    if !identified.white {
        identified.gravity = gravity::tried(recordings, identified.best.estimator);
    }
    // A drive that is a current or a force has no back-EMF in it.
    if ["A", "mA", "N", "Nm", "mNm"].contains(&recordings[0].units.u.as_str()) {
        identified.remarks.retain(|remark| *remark != Remark::BackEmfInDamping);
    }
    identified.winding = winding(recordings);
    if let Some(Winding { back_emf, .. }) = identified.winding {
        identified = apart(identified, back_emf);
    }
    Ok(identified)
}

/// With c parted by a back-EMF that is known: from the current, or from the name plate, in the units of c.
pub fn apart(mut identified: Identification, back_emf: Value) -> Identification {
    let viscous = mechanical(identified.best.c, back_emf);
    let of_c = |remark: &Remark| matches!(remark, Remark::BackEmfInDamping | Remark::BackEmfApart { .. });
    identified.remarks.retain(|remark| !of_c(remark));
    identified.remarks.insert(0, Remark::BackEmfApart { back_emf, viscous });
    identified
}

/// The same without holding blocks out, in a third of the time: a model to start a fit from.
///
/// # Errors
/// As [`identify`].
pub fn starting_model(recordings: &[Recording]) -> Result<StartingModel, IdentifyError> {
    let Identification { best, remarks, .. } = finished(assuming_held(recordings)?.0, recordings);
    let lasting = remarks.iter().filter(|remark| !remark.is_of_a_gap());
    Ok(StartingModel { best, remarks: lasting.map(Remark::to_string).collect() })
}

/// With the errors that an unknown drive between rows makes, and the load if it is significant then.
fn finished(mut identified: Identification, recordings: &[Recording]) -> Identification {
    if slow_log::is_slow(recordings) {
        identified = slow_log::with_unknown_drive(identified, recordings);
    }
    identified.load = significant_load(&identified.best);
    identified
}

/// Compares both estimators on held-out blocks, and reports the one that predicts them better.
fn choose(identified: &mut Identification, prepared: &Prepared) {
    let found = |name| identified.estimates.iter().find(|estimate| estimate.estimator == name).cloned();
    let (Some(weak), Some(simulated)) = (found(WEAK_FORM), found(OUTPUT_ERROR)) else { return };
    // An inertia that equation error does not find leaves nothing to choose.
    if weak.b.value <= 0.0 {
        return;
    }
    let problem = output_error(&prepared.tracks, &[], identified.noise);
    let comparison = choice::compare(&problem, &prepared.windows, prepared.both);
    identified.choice = choice::choose(comparison, identified.white);
    identified.best = if identified.choice.estimator == OUTPUT_ERROR { simulated } else { weak };
}

/// What the estimators work on.
pub(super) struct Prepared {
    tracks: Vec<MeasuredMotion>,
    windows: Vec<weak::Window>,
    both: bool,
}

/// Identifies with the drive held from row to row; the estimator reported is that of a tie.
pub(super) fn assuming_held(recordings: &[Recording]) -> Result<(Identification, Prepared), IdentifyError> {
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
    let short = Choice { estimator: if white { OUTPUT_ERROR } else { WEAK_FORM }, reason: Reason::Short { white } };
    let (best, choice) = match simulated {
        Some(simulated) if biased => (simulated, Choice { estimator: OUTPUT_ERROR, reason: Reason::Only }),
        Some(simulated) if white => (simulated, short),
        Some(_) => (weak_estimate, short),
        None => (weak_estimate, Choice { estimator: WEAK_FORM, reason: Reason::Only }),
    };
    if best.b.value <= 0.0 {
        let advice = "the axis accelerates too little: record faster reversals, such as a relay experiment";
        return Err(IdentifyError::Undetermined { parameter: "b", advice });
    }
    let mut remarks = remarks(&estimates, white, simulation_error / noise);
    let cycles = cycles::estimates(recordings, &tracks);
    estimates.extend(cycles.estimates);
    remarks.extend(cycles.remarks);
    let identified = Identification {
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
        choice,
        gravity: None,
        winding: None,
    };
    Ok((identified, Prepared { tracks, windows, both }))
}

/// Work of the drive on the motion, drive units times position units. Friction absorbs it, so it is positive, unless
/// drive or position has the wrong sign.
fn work(tracks: &[MeasuredMotion]) -> f64 {
    let of = |track: &MeasuredMotion| {
        let pieces = track.pieces.windows(2).flat_map(|piece| piece[0] + 1..piece[1]);
        pieces.map(|k| track.u[k - 1] * (track.xs[k] - track.xs[k - 1])).sum::<f64>()
    };
    tracks.iter().map(of).sum()
}

fn remarks(estimates: &[ModelEstimate], white: bool, noises: f64) -> Vec<Remark> {
    let mut remarks = vec![Remark::BackEmfInDamping];
    let mut estimators_differ = false;
    if let [weak, simulated] = estimates {
        let differ = |a: Value, b: Value| (a.value - b.value).abs() > 3.0 * a.se.hypot(b.se);
        estimators_differ = differ(weak.b, simulated.b) || differ(weak.c, simulated.c) || differ(weak.f1, simulated.f1);
        if !estimators_differ {
            let b_percent = 100.0 * (simulated.b.value / weak.b.value - 1.0);
            remarks.push(Remark::EstimatorsAgree { b_percent });
        } else if white {
            remarks.push(Remark::WeakFormIsBiased);
        }
    }
    if !white {
        remarks.push(Remark::ModelMisses { noises, estimators_differ });
    }
    remarks
}
