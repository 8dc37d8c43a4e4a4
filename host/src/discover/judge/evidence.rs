//! The evidence for a term, and the reasons not to believe it.

use super::bar::Bar;
use super::compliance;
use super::gain::{Gain, gain};
use super::regression::rms;
use super::settings::Settings;
use super::sides::{Fitted, Model, Side};
use super::term::{Sign, Term};
use super::weak_form::WeakForm;
use super::weights::Weights;

/// Why a term cannot be named.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rejection {
    /// It gains too little, or not significantly, on a side.
    Gain,
    /// The inertia is not positive with it.
    Inertia,
    /// The viscous coefficient or the Coulomb friction of both sides is negative with it.
    Base,
    /// The drive determines less of the acceleration than without it, or too little.
    Coherence,
    /// The sides do not say the same force.
    Disagreement(f64),
    /// Its amplitude has the wrong sign, or differs from recording to recording.
    Amplitude,
    /// A mean and a direction alone predict the drive as well.
    Floor,
    /// Its body does not ring: one with much damping explains half as much or more.
    Overdamped,
}

/// What speaks for a term beside a model.
#[derive(Clone, Copy, Debug)]
pub struct Evidence {
    /// Side U.
    pub u: Gain,
    /// Side A; for a bristle beside a base that does not tell the inertia, side C.
    pub a: Gain,
    /// ‖F_U − F_A‖/‖F_U‖; 0 where side A has no force of its own. On side C it is that of the stiffnesses.
    pub disagreement: f64,
    /// ρ² with the term. On side C it is the share of the bending that the drive's rate determines.
    pub coherence: f64,
    /// Why it cannot be named; `None` if only rivals can speak against it.
    pub rejection: Option<Rejection>,
}

impl Evidence {
    /// The smaller gain of the two sides.
    pub fn gain(&self) -> f64 {
        self.u.flat.min(self.a.flat)
    }
    /// The smaller z.
    pub fn z(&self) -> f64 {
        self.u.z.min(self.a.z)
    }
    /// Whether side U tells the force without telling the inertia.
    fn needs_no_inertia(&self) -> bool {
        self.u.flat.min(self.u.local) >= 0.5 && self.a.flat.max(self.a.local) >= 0.1 && self.disagreement < 0.25
    }
    /// Whether side U alone tells the force of the motion, and side A confirms it without a z of its own.
    pub(super) fn is_of_side_u(&self, settings: &Settings) -> bool {
        self.needs_no_inertia() && self.a.z < settings.z
    }
    /// The z that decides: that of side U for a force of the motion alone that side A confirms, and the smaller otherwise.
    fn decisive_z(&self, of_motion: bool) -> f64 {
        let confirmed = of_motion && self.needs_no_inertia() && self.a.z >= CONFIRMED;
        if confirmed { self.u.z } else { self.z() }
    }
}

/// Standard errors of ρ² by which a force of the motion alone may lower it. A term that holds the drive may not: it could
/// explain the acceleration by its own noise.
const COHERENCE_ERRORS: f64 = 2.0;
/// Least z on side A of a force that side U tells alone. Side A only confirms it then: one question is asked, with the
/// sign known, so that 2.3 % of the effects that are not there pass. In 120 sessions of the hidden plant no effect that is
/// not there had a z from 2 to 4 (docs/discovery.md, section 5).
const CONFIRMED: f64 = 2.0;
/// Largest difference of the two sides' gains of a second body, as a share of the larger.
const BODY_GAINS: f64 = 0.7;

/// Weighs the `index`-th term of a model: `before` is fitted without it, `after` with it.
pub fn weigh(
    form: &WeakForm<'_>,
    weights: &Weights,
    before: &Fitted,
    after: &Fitted,
    (model, index): (&Model, usize),
    bar: &Bar,
    settings: &Settings,
) -> Evidence {
    let term = &model.terms[index];
    let (lag_u, own_u) = own_force(before, after, term, index, true);
    let u = gain(form, &weights.u, (&before.u.residual, lag_u), &after.u.residual, &own_u);
    if compliance::takes_the_place(term, before, settings)
        && let Some(mut evidence) = compliance::weigh(form, after, (model, index), u, settings)
    {
        evidence.rejection = compliance::rejection(form, &after.u, (term, index), &evidence, bar, settings);
        return evidence;
    }
    let (_, own_a) = own_force(before, after, term, index, false);
    let a = gain(form, &weights.a, (&before.a.residual, 1.0), &after.a.residual, &own_a);
    let difference: Vec<f64> = own_u.iter().zip(&own_a).map(|(u, a)| u - a).collect();
    // Side A has no force of its own for a second body. Its gain must be like side U's instead.
    let disagreement = if term.body.is_some() {
        (1.0 - u.flat.min(a.flat) / u.flat.max(a.flat).max(f64::MIN_POSITIVE)) * settings.disagreement / BODY_GAINS
    } else {
        rms(&difference) / rms(&own_u).max(f64::MIN_POSITIVE)
    };
    let mut evidence = Evidence { u, a, disagreement, coherence: after.coherence(), rejection: None };
    evidence.rejection = rejection(form, before, after, (term, index), &evidence, bar, settings);
    evidence
}

/// By how much the `index`-th term's arrival shrinks the target, and the term's force in every window, drive units. The
/// first is a ratio, 1 unless the term changes the drive.
fn own_force(before: &Fitted, after: &Fitted, term: &Term, index: usize, of_u: bool) -> (f64, Vec<f64>) {
    let (b, a) = if of_u { (&before.u, &after.u) } else { (&before.a, &after.a) };
    let inertia = if of_u { 1.0 } else { after.a.b };
    if term.drive.is_some() || term.body.is_some() {
        // The term's force is what the model says with it, less what it says without it.
        let said = |side: &super::sides::Side, i: usize| side.target[i] - side.residual[i];
        let shrink = if of_u { rms(&a.target) / rms(&b.target) } else { 1.0 };
        let moved = (0..a.target.len()).map(|i| inertia * (said(a, i) - said(b, i)));
        return (shrink, moved.collect());
    }
    (1.0, a.forces[index].clone())
}

/// Whether c and f1 of a side are not below zero by more than three standard errors. Their forces are compared with the
/// target of side U.
pub(super) fn is_physical(form: &WeakForm<'_>, side: &Side, u: &Side) -> bool {
    let little = -0.01 * rms(&u.target);
    let [c_error, f1_error] = side.base_errors.map(|error| 3.0 * error);
    (side.c + c_error) * form.v95 >= little && side.f1 + f1_error >= little
}

/// Whether the base of one side is physical. Noise in the acceleration draws the friction of side U below zero, and noise in
/// the drive that of side A (docs/discovery.md, section 5).
fn has_physical_base(form: &WeakForm<'_>, fitted: &Fitted) -> bool {
    [&fitted.u, &fitted.a].iter().any(|side| is_physical(form, side, &fitted.u))
}

fn rejection(
    form: &WeakForm<'_>,
    before: &Fitted,
    after: &Fitted,
    (term, index): (&Term, usize),
    evidence: &Evidence,
    bar: &Bar,
    settings: &Settings,
) -> Option<Rejection> {
    if [&after.u, &after.a].iter().any(|side| !(side.b > 0.0 && side.b.is_finite())) {
        return Some(Rejection::Inertia);
    }
    if !has_physical_base(form, after) {
        return Some(Rejection::Base);
    }
    if amplitude_is_wrong(after, term, index) {
        return Some(Rejection::Amplitude);
    }
    let coherence = evidence.coherence;
    let holds_drive = term.holds_drive || term.drive.is_some();
    let error = if holds_drive { 0.0 } else { COHERENCE_ERRORS * after.coherence_error() };
    let fell = coherence + error < before.coherence().min(0.99) - 1e-3;
    if fell || coherence < settings.coherence && term.holds_drive {
        return Some(Rejection::Coherence);
    }
    if coherence < settings.coherence && !evidence.needs_no_inertia() {
        return Some(Rejection::Coherence);
    }
    if evidence.disagreement >= settings.disagreement && term.drive.is_none() {
        return Some(Rejection::Disagreement(evidence.disagreement));
    }
    let of_motion = !holds_drive && term.body.is_none();
    if !bar.reached_by(evidence) || evidence.decisive_z(of_motion) < settings.least_z(term.chosen_of) {
        return Some(Rejection::Gain);
    }
    (floor_ratio(form, &after.u) >= 0.5).then_some(Rejection::Floor)
}

fn amplitude_is_wrong(after: &Fitted, term: &Term, index: usize) -> bool {
    let Some(u) = after.u.amplitudes[index].first() else { return false };
    let a = after.a.amplitudes[index].first().unwrap_or(u);
    let within = |value: f64| match term.sign {
        Sign::Any => true,
        Sign::Positive => value > 0.0,
    };
    !within(*u) || !within(*a)
}

/// Residual energy of side U over that of a fit without the motion: a mean and a direction.
pub fn floor_ratio(form: &WeakForm<'_>, u: &Side) -> f64 {
    let direction = &form.row_direction;
    let drive = &u.target;
    let n = drive.len() as f64;
    let (su, sd) = (drive.iter().sum::<f64>() / n, direction.iter().sum::<f64>() / n);
    let (mut cross, mut square, mut total) = (0.0, 0.0, 0.0);
    for (u, d) in drive.iter().zip(direction) {
        cross += (u - su) * (d - sd);
        square += (d - sd).powi(2);
        total += (u - su).powi(2);
    }
    let left = total - if square > 0.0 { cross * cross / square } else { 0.0 };
    u.residual.iter().map(|r| r * r).sum::<f64>() / left.max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Kind;

    use super::super::bar::tests::Axis;
    use super::super::dataset::Dataset;
    use super::super::search::judge;
    use super::super::term::Name;
    use super::*;
    use crate::recording::Recording;

    /// A servo that carries a pendulum (XL330). Its acceleration is mostly its gears', so that side A tells little.
    const SERVO: Evidence = Evidence {
        u: Gain { flat: 1.15, local: 1.12, z: 8.0 },
        a: Gain { flat: 0.15, local: -0.11, z: 2.7 },
        disagreement: 0.19,
        coherence: 0.23,
        rejection: None,
    };

    /// 20 s at 1 kHz of an axis with Dahl friction that two sines move both ways. The stroke is a twentieth of the travel.
    /// What the bristles add to the Coulomb friction is the same force on both sides.
    #[test]
    fn both_sides_tell_the_force_of_bristles() {
        let (mut x, mut v, mut z) = (0.0_f64, 0.0_f64, 0.0_f64);
        let mut recording = Recording { encoder_step: Some(1e-6), ..Recording::default() };
        for k in 0..20_000 {
            let t = 1e-3 * f64::from(k);
            let u = 2.0 * (4.0 * t).sin() + (9.3 * t).sin();
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push((x / 1e-6).round() * 1e-6);
            for _ in 0..20 {
                v += (u - z - 0.3 * v) / 0.1 * 5e-5;
                z += (v - v.abs() * z) / STROKE * 5e-5;
                x += v * 5e-5;
            }
        }
        let settings = Settings::default();
        let dataset = Dataset::new(&[recording], &settings);
        let form = WeakForm::new(&dataset, 0.01, &settings).unwrap();
        assert!((0.04..0.06).contains(&(STROKE / form.travel())), "{}", form.travel());
        let judged = judge(&form, &settings).unwrap();
        let own = judged.rounds[0].tried.iter().find(|own| own.names() == [Name::Effect(Kind::Dahl)]).unwrap();
        let evidence = own.evidence[0];
        assert!(evidence.disagreement < 0.02 && evidence.rejection.is_none(), "{evidence:?}");
    }

    /// Stroke of the bristles, rad.
    const STROKE: f64 = 0.08;

    /// Noise draws the friction of one side below zero. Where both are below, no noise explains it.
    #[test]
    fn one_side_may_have_a_negative_friction() {
        let settings = Settings::default();
        let dataset = Dataset::new(&[Axis { f1: 0.1, drag: 0.0, load: 0.0, seed: 1 }.recording()], &settings);
        let form = WeakForm::new(&dataset, 0.02, &settings).unwrap();
        let fitted = Model::default().fit(&form, &Weights::equal(&form), &settings).unwrap();
        let with = |[u, a]: [f64; 2]| {
            let mut own = fitted.clone();
            (own.u.c, own.a.c) = (u, a);
            has_physical_base(&form, &own)
        };
        assert_eq!([[0.03, 0.03], [-0.03, 0.03], [0.03, -0.03], [-0.03, -0.03]].map(with), [true, true, true, false]);
    }

    /// Side A only confirms what side U tells alone. It decides where the force holds the drive, where it tells nothing,
    /// and where the sides disagree.
    #[test]
    fn side_a_confirms_a_force_of_the_motion() {
        let a = |z: f64| Evidence { a: Gain { z, ..SERVO.a }, ..SERVO };
        let apart = Evidence { disagreement: 0.26, ..SERVO };
        let small = Evidence { u: Gain { flat: 0.4, ..SERVO.u }, ..SERVO };
        let of_motion = [SERVO, a(1.9), apart, small].map(|own| own.decisive_z(true).to_bits());
        assert_eq!(of_motion, [8.0_f64, 1.9, 2.7, 2.7].map(f64::to_bits));
        assert_eq!(SERVO.decisive_z(false).to_bits(), 2.7_f64.to_bits());
    }
}
