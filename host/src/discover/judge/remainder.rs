//! The force that no effect explains.

use super::dataset::Dataset;
use super::evidence::Rejection;
use super::outcome::Round;
use super::regression::rms;
use super::repetition::Repetition;
use super::search::Judged;
use super::settings::Settings;
use super::sides::Fitted;
use super::term::Name;
use super::tried::Tried;
use super::weak_form::WeakForm;

/// What the force that no effect explains looks like.
#[derive(Clone, Debug, PartialEq)]
pub struct Remainder {
    /// What predicts a part of it on held-out data; `None` if nothing does.
    pub predictable: Option<Name>,
    /// What repeats of it with the drive; `None` where no drive repeats, or too fast for the windows.
    pub repetition: Option<Repetition>,
    /// Its rms, drive units, in windows so wide that the sensor's noise does not count.
    pub rms_u: f64,
    /// The same over the rms of the drive.
    pub share: f64,
    /// Highest frequency that these windows let pass, Hz.
    pub bandwidth_hz: f64,
    /// The rms over what the sensor's noise makes of it.
    pub over_noise: f64,
    /// Largest z over blocks, on the side that tells less, of anything that was tried beside the final model.
    pub significance: f64,
}

/// Half-width of the windows in which the sensor's noise does not count, over that of the narrowest that it allows.
pub(super) const WIDE: f64 = 4.0;

/// What is left in windows so wide that the sensor's noise does not count.
pub(super) fn remainder(
    dataset: &Dataset,
    own: &Judged,
    narrowest: f64,
    predictable: Option<Name>,
    settings: &Settings,
) -> Option<Remainder> {
    let widest = settings.half_widths_s.last().copied()?;
    let wide = settings.half_widths_s.iter().copied().find(|width| *width >= WIDE * narrowest).unwrap_or(widest);
    let form = WeakForm::new(dataset, wide, settings)?;
    let fitted = own.model.refitted(&form, settings)?;
    let observed = form.observed(&own.model, &fitted).and_then(|form| {
        let fitted = own.model.refitted(&form, settings)?;
        Some((form, fitted))
    });
    let less = |own: &Fitted| rms(&own.u.residual) < rms(&fitted.u.residual);
    let (form, fitted) = observed.filter(|(_, own)| less(own)).unwrap_or((form, fitted));
    let own = Judged { fitted, ..own.clone() };
    remainder_of(&form, &own, predictable)
}

/// Largest z, on the side that tells less, in a round. Only terms that were tried alone and gain over all rows count.
fn significance(round: &Round) -> f64 {
    let possible = |t: &&Tried| !matches!(t.rejection(), Some(Rejection::Inertia | Rejection::Amplitude));
    let alone = round.tried.iter().filter(|t| t.terms.len() == 1).filter(possible);
    alone.filter(|t| t.gain > 0.0).map(|t| t.evidence[0].z()).fold(0.0, f64::max)
}

/// Highest frequency that windows of a half-width, s, let pass, Hz. The transform of (1 − s²)³ falls to a half at 2.4
/// radians in a half-width.
pub fn bandwidth_hz(half_width_s: f64) -> f64 {
    2.4 / (std::f64::consts::TAU * half_width_s)
}

pub(super) fn remainder_of(form: &WeakForm<'_>, own: &Judged, predictable: Option<Name>) -> Option<Remainder> {
    let left = rms(&own.fitted.u.residual);
    let share = left / rms(&form.row_u);
    let noise = own.fitted.u.b.abs() * form.noise_a;
    share.is_finite().then_some(Remainder {
        predictable,
        repetition: None,
        rms_u: left,
        share,
        bandwidth_hz: bandwidth_hz(form.half_width_s),
        over_noise: left / noise.max(f64::MIN_POSITIVE),
        significance: own.rounds.last().map_or(0.0, significance),
    })
}
