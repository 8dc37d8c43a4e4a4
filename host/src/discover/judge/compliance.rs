//! Side C: the displacement that the drive makes, for bristles of an axis whose inertia is not told.
//!
//! Below break-away the drive does not accelerate the axis; it bends the bristles of the friction. Side A then holds
//! nothing but noise. The bristles give a second equation of their own. Side U says u = F·z, with z along the measured
//! path. Its rate is u̇ = σ·y, with y = s·ż the velocity that bends the bristles, s their stroke, and σ = F/s. Side C
//! explains y by u̇: noise in the drive biases it, as noise in the motion biases side U. A bristle says the same
//! stiffness σ on both.

use super::bar::Bar;
use super::evidence::{Evidence, Rejection, floor_ratio, is_physical};
use super::gain::{Gain, gain};
use super::regression::{Design, rms};
use super::settings::Settings;
use super::sides::{Fitted, Model, Side};
use super::term::{Column, Term};
use super::weak_form::WeakForm;
use super::weights::by_speed;

/// Longest stroke of a bristle, as a share of the travel. From one end of it to the other the bristle is then bent to
/// 1 − 2·exp(−3), or 90 %, the other way. A longer one hardly lets go, as a spring does.
pub const LONGEST_STROKE: f64 = 1.0 / 3.0;

/// Whether side C takes the place of side A for a term: a bristle, beside a model whose inertia the drive does not tell.
pub(super) fn takes_the_place(term: &Term, before: &Fitted, settings: &Settings) -> bool {
    let told = before.coherence() >= settings.coherence;
    term.replaces_direction && !told
}

/// What sides U and C say of the bristle that is the `index`-th term of a model. `u` is the gain on side U. Whether it is
/// a name is not decided here. `None` where side C has no fit.
pub(super) fn weigh(
    form: &WeakForm<'_>,
    after: &Fitted,
    (model, index): (&Model, usize),
    u: Gain,
    settings: &Settings,
) -> Option<Evidence> {
    let term = &model.terms[index];
    let (Some(Column::Force(bristle)), Some((_, stroke))) = (term.u.first(), term.parameters.first()) else {
        return None;
    };
    let drive_rate = form.rates(&model.arrived(form));
    let held_out = |target: &[f64], columns: Vec<&[f64]>, weights: &[f64]| {
        let columns = columns.into_iter().map(Into::into).collect();
        Design { target, columns }.fit(form, weights, settings.folds)
    };
    // What the base, and a spring, leave of the velocity. They are no bristles, and the drive may tell it through them.
    let equal = vec![1.0; form.rows.len()];
    let base = held_out(&form.row_v, vec![&form.row_u, &form.row_direction], &equal)?;
    let weights = by_speed(form, &base.residual);
    let spring = held_out(&form.row_v, vec![&drive_rate], &weights)?;
    let weighted = |values: &[f64]| rms(&values.iter().zip(&weights).map(|(v, w)| v * w).collect::<Vec<_>>());
    let left = [&base.residual, &spring.residual].map(|residual| weighted(residual) / weighted(&form.row_v));
    let bends: Vec<f64> = form.rates(&bristle.field).iter().map(|rate| stroke * rate).collect();
    let fit = held_out(&bends, vec![&drive_rate], &weights)?;
    let said: Vec<f64> = bends.iter().zip(&fit.residual).map(|(y, r)| y - r).collect();
    let shrink = left[0].min(left[1]).min(1.0);
    let gain = gain(form, &weights, (&bends, shrink), &fit.residual, &said);
    let stiffness = [after.u.amplitudes[index].first()? / stroke, 1.0 / fit.coefficients[0]];
    let coherence = 1.0 - (weighted(&fit.residual) / weighted(&bends)).powi(2);
    let short = *stroke <= LONGEST_STROKE * form.travel();
    let disagreement = if short { (1.0 - stiffness[1] / stiffness[0]).abs() } else { f64::INFINITY };
    Some(Evidence { u, a: gain, disagreement, coherence, rejection: None })
}

/// Why a bristle cannot be named, by the evidence of sides U and C; `None` if only rivals can speak against it.
pub(super) fn rejection(
    form: &WeakForm<'_>,
    u: &Side,
    (term, index): (&Term, usize),
    evidence: &Evidence,
    bar: &Bar,
    settings: &Settings,
) -> Option<Rejection> {
    let enough = bar.reached_by(evidence) && evidence.z() >= settings.least_z(term.chosen_of);
    if !is_physical(form, u, u) {
        Some(Rejection::Base)
    } else if u.amplitudes[index].first().is_none_or(|force| *force <= 0.0) {
        Some(Rejection::Amplitude)
    } else if evidence.coherence < settings.coherence {
        Some(Rejection::Coherence)
    } else if evidence.disagreement >= settings.disagreement {
        Some(Rejection::Disagreement(evidence.disagreement))
    } else if !enough {
        Some(Rejection::Gain)
    } else {
        (floor_ratio(form, u) >= 0.5).then_some(Rejection::Floor)
    }
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Kind;

    use super::super::ruling::{Ruling, rule};
    use super::super::settings::Settings;
    use crate::recording::Recording;

    const B: f64 = 0.02;
    const STROKE: f64 = 1e-3;
    const FRICTION: f64 = 1.0;

    /// What holds the axis, as a share of [`FRICTION`]: its rate, of the velocity and of that share.
    type Hold = fn(f64, f64) -> f64;

    /// 60 s at 200 Hz of an axis that two slow sines never break away. The encoder's step is a fiftieth of the stroke.
    fn ruling(hold: Hold) -> Ruling {
        let (mut x, mut v, mut z) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut recording = Recording { encoder_step: Some(STROKE / 50.0), ..Recording::default() };
        for k in 0..12_000 {
            let t = 5e-3 * f64::from(k);
            let u = 0.65 * (1.1 * t).sin() + 0.3 * (2.7 * t).sin();
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push((x / STROKE * 50.0).round() * STROKE / 50.0);
            for _ in 0..250 {
                let dt = 2e-5;
                // A critical part of the damping, so that nothing rings at the bristle's own 36 Hz.
                v += (u - FRICTION * z - 4.0 * v) / B * dt;
                z += hold(v, z) / STROKE * dt;
                x += v * dt;
            }
        }
        rule(&[recording], Some(1.0), &Settings::default()).unwrap()
    }

    /// Bristles are named though nothing accelerates, and their stiffness is told within a fifth. The law that is fitted
    /// to it may be the Dahl model's or the LuGre model's, which differ in sliding alone.
    #[test]
    fn bristles_are_named_below_break_away() {
        let found = ruling(|v, z| v - v.abs() * z);
        assert!(!found.tells_inertia(), "{}", found.coherence);
        let first = &found.findings[0];
        assert!(matches!(first.effect.kind, Kind::Dahl | Kind::LuGre), "{:?}", found.findings);
        let stiffness = first.effect.p[0] * STROKE / FRICTION;
        assert!((stiffness - 1.0).abs() < 0.2, "{:?}", first.effect);
    }

    /// A spring lets nothing go: no bristle is named.
    #[test]
    fn a_spring_is_no_bristle() {
        let found = ruling(|v, _| v);
        let bristle = found.findings.iter().any(|finding| finding.effect.kind.bristles());
        assert!(!bristle, "{:?}", found.findings);
    }
}
