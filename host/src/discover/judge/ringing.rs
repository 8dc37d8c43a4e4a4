//! Whether a second body rings. One that only relaxes keeps what it explains under any damping (docs/discovery.md,
//! section 6).

use super::evidence::Rejection;
use super::settings::Settings;
use super::term::Name;
use super::tried::Tried;

/// Gain of the best significant mode with much damping among `singles`, nats; 0 if none is significant. Beside such a mode
/// c and f1 may be negative: it takes a part of them, which little damping leaves there.
pub(super) fn damped_gain(singles: &[Tried], settings: &Settings) -> f64 {
    let damped = singles.iter().filter(|own| matches!(own.terms[0].name, Name::Decoy(_)) && own.has_body());
    let possible = damped.filter(|own| own.rejection() != Some(Rejection::Inertia));
    let significant = possible.filter(|own| own.evidence[0].z() >= settings.least_z(own.terms[0].chosen_of));
    significant.map(|own| own.gain).fold(0.0, f64::max)
}

/// Rejects the couplings, and the pairs with one, that gain too little over the `damped` mode to ring.
pub(super) fn reject_overdamped(all: &mut [Tried], damped: f64, settings: &Settings) {
    let couplings = all.iter_mut().filter(|own| own.has_body() && matches!(own.terms[0].name, Name::Effect(_)));
    for own in couplings.filter(|own| own.rejection().is_none() && own.gain < settings.over_damped * damped) {
        own.evidence[0].rejection = Some(Rejection::Overdamped);
    }
}
