//! A term of the judge as an effect of the catalogue: where the fit of the simulated motion starts.

use breakaway_core::plant::effect::MAX_PARAMETERS;
use breakaway_core::plant::{Effect, Kind};

use super::one_wave;
use super::sides::Side;
use super::term::{Name, Shape, Term};
use super::weak_form::WeakForm;

/// Largest distance of a wave number from the whole one that it is taken for, 1/rad. The teeth of a rotor are counted.
const WHOLE: f64 = 0.02;

/// Waves in a turn of a ripple or a friction over position. `None` where they are no whole number, and where the position is
/// no angle.
pub fn whole_waves(form: &WeakForm<'_>, term: &Term) -> Option<f64> {
    let ripples = matches!(term.name, Name::Effect(Kind::Cogging | Kind::PositionFriction));
    let (_, waves) = term.parameters.iter().find(|(index, _)| ripples && *index == 1)?;
    let whole = waves.round();
    (form.radians.is_some() && whole > 0.0 && (waves - whole).abs() < WHOLE).then_some(whole)
}

/// The effect, the standard errors of its parameters, and the indices of those that are held. An error is NaN where the
/// force fit gives none. Wave numbers are held: the spectrum tells them better than any fit that starts from them.
/// `None` for a decoy, or where a parameter is not finite.
pub fn effect(
    form: &WeakForm<'_>,
    side: &Side,
    term: &Term,
    index: usize,
) -> Option<(Effect<f64>, Errors, Vec<usize>)> {
    let Name::Effect(kind) = term.name else { return None };
    let amplitude = |i: usize| side.amplitudes[index].get(i).copied().unwrap_or(0.0);
    let parameter = |i: usize| term.parameters.iter().find(|p| p.0 == i).map_or(0.0, |p| p.1);
    let times = || form.rows.iter().map(|r| form.dataset.pieces[r.piece].t[r.centre]);
    let span_s = times().fold(0.0, f64::max) - times().fold(f64::INFINITY, f64::min);
    // θ₀·sin + θ₁·cos on the side of the drive is −A·sin(… + φ) of the law.
    // Where each recording has its own zero, the phase is that of the first.
    let own_waves = term.own_zeros && term.shape == Shape::Wave;
    let size = || if own_waves { one_wave::amplitude(side, index) } else { amplitude(0).hypot(amplitude(1)) };
    let wave = || (size(), (-amplitude(1)).atan2(-amplitude(0)));
    let own: Vec<f64> = match kind {
        Kind::Spring => {
            let positions = form.dataset.pieces.iter().flat_map(|p| p.x.iter().copied()).collect();
            vec![amplitude(0), super::weak_form::percentile(positions, 0.5) - amplitude(1) / amplitude(0)]
        }
        Kind::EndStop => vec![parameter(0) * amplitude(0), parameter(1)],
        Kind::GravityLoad => vec![wave().0, wave().1],
        Kind::Cogging | Kind::TimePeriodic => vec![wave().0, parameter(1), wave().1],
        Kind::PositionFriction => {
            let depth = size() / side.f1.max(1e-9);
            vec![depth.min(1.0), parameter(1), amplitude(1).atan2(amplitude(0))]
        }
        Kind::EncoderEccentricity => vec![wave().0 / side.b, wave().1],
        Kind::Stribeck => {
            let exponent = term.parameters.iter().find(|p| p.0 == 2).map_or(2.0, |p| p.1);
            vec![amplitude(0), parameter(1), exponent]
        }
        // The law counts from the session's beginning, the column from the first sample.
        Kind::FrictionDrift => vec![amplitude(0) * (form.dataset.first_s() / parameter(1)).exp(), parameter(1)],
        Kind::GainDrift => vec![amplitude(0) / span_s],
        Kind::InertiaStep => vec![amplitude(0) / side.b, parameter(1)],
        Kind::Dahl => vec![amplitude(0) / parameter(0)],
        Kind::LuGre => {
            let sigma = amplitude(0) / parameter(0);
            vec![sigma, 0.6 * (sigma * side.b).sqrt(), parameter(2) * amplitude(0), parameter(1)]
        }
        Kind::FlexibleCoupling => {
            vec![(amplitude(0) / (side.b + amplitude(0))).clamp(0.0, 0.98), parameter(0), parameter(1)]
        }
        Kind::DeadZone
        | Kind::Saturation
        | Kind::PwmDeadTime
        | Kind::Delay
        | Kind::ElectricalLag
        | Kind::LoadFriction => term.parameters.iter().map(|p| p.1).collect(),
        _ => vec![amplitude(0)],
    };
    let mut effect = Effect::new(kind, &own).canonical();
    let mut held = Vec::new();
    if matches!(kind, Kind::Cogging | Kind::PositionFriction) {
        held.push(1);
        effect.p[1] = whole_waves(form, term).unwrap_or(effect.p[1]);
    }
    for (value, parameter) in effect.p.iter_mut().zip(kind.definition().parameters) {
        *value = value.clamp(parameter.min, parameter.max);
    }
    let errors = errors(side, &effect, index);
    effect.p.iter().all(|p| p.is_finite()).then_some((effect, errors, held))
}

/// Standard errors of an effect's parameters.
pub type Errors = [f64; MAX_PARAMETERS];

/// Standard errors that the force fit gives: of an amplitude, and of its phase; NaN for the others.
fn errors(side: &Side, effect: &Effect<f64>, index: usize) -> Errors {
    let mut errors = [f64::NAN; MAX_PARAMETERS];
    let own = &side.errors[index];
    let (Some(first), Some(amplitude)) = (own.first(), side.amplitudes[index].first()) else { return errors };
    let square = own.iter().take(2).map(|e| e * e).sum::<f64>() / own.len().clamp(1, 2) as f64;
    let size = side.amplitudes[index].iter().take(2).map(|a| a * a).sum::<f64>().sqrt();
    // Relative to the amplitude, because the parameter may have another unit.
    let (relative, phase) = match effect.kind {
        Kind::GravityLoad | Kind::EncoderEccentricity => (square.sqrt() / size, Some(1)),
        Kind::Cogging | Kind::TimePeriodic | Kind::PositionFriction => (square.sqrt() / size, Some(2)),
        _ => (first / amplitude.abs(), None),
    };
    errors[0] = relative * effect.p[0].abs();
    if let Some(phase) = phase {
        errors[phase] = relative;
    }
    errors
}
