//! The effects that the judge names, and those that it sees beside them.

use breakaway_core::plant::{Effect, Kind};

use super::bar::best_decoy;
use super::outcome::Outcome;
use super::search::{Bearing, Judged};
use super::settings::Settings;
use super::start::{self, Errors};
use super::weak_form::WeakForm;

/// An effect that is named from the measured forces.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The effect with the parameters of the force fit.
    pub effect: Effect<f64>,
    /// Standard errors of its parameters; NaN where the force fit gives none.
    pub errors: Errors,
    /// Indices of the parameters that are held.
    pub held: Vec<usize>,
    /// Whether each recording has its own phase, or its own place of rest.
    pub own_zeros: bool,
    /// Effects that these recordings do not tell from it. The number is the finding's lead, in standard deviations.
    pub tied: Vec<(Kind, f64)>,
    /// Its share of the energy of the gap, if that is less than [`MATERIAL`]; `None` where it carries more.
    pub small_share: Option<f64>,
    /// Gain of the side that gains less, nats, and its z over blocks.
    pub gain: f64,
    /// See `gain`.
    pub z: f64,
}

/// Least share of the energy of the gap that each name after the first must carry, where something else may be missing.
/// An effect below it is seen, and is not what is missing.
const MATERIAL: f64 = 0.1;

/// What a name after the first needs, beside [`MATERIAL`].
struct Complete {
    /// Share of the drive that it must predict.
    of_the_drive: f64,
    /// Least gain, nats.
    gain: f64,
}

impl Complete {
    /// `None` where the search ended before nothing was left to be tried.
    fn of(own: &Judged, settings: &Settings) -> Option<Self> {
        let last = own.rounds.last().filter(|round| round.outcome == Outcome::Nothing)?;
        let gain = settings.over_decoys * best_decoy(&last.tried, settings);
        Some(Self { of_the_drive: settings.predictable, gain })
    }

    /// Whether a term is named that predicts this share of the drive and gains so many nats.
    fn names(&self, of_the_drive: f64, gain: f64) -> bool {
        of_the_drive >= self.of_the_drive && gain >= self.gain
    }
}

/// The named effects, and the effects that are seen beside them.
pub(super) fn findings(form: &WeakForm<'_>, own: &Judged, settings: &Settings) -> [Vec<Finding>; 2] {
    let complete = Complete::of(own, settings);
    let (mut findings, mut seen) = (Vec::new(), Vec::new());
    // Energy that is left of the base's, by the gains of side U.
    let mut left = 1.0;
    for (index, (term, Bearing { evidence, tied })) in own.model.terms.iter().zip(&own.bearings).enumerate() {
        let after = left * (-2.0 * evidence.u.flat.max(0.0)).exp();
        let share = left - after;
        left = after;
        let of_the_drive = share.sqrt() * own.residual[0][0];
        let material = complete.as_ref().is_some_and(|least| least.names(of_the_drive, evidence.gain()));
        let small_share = (share < MATERIAL && !findings.is_empty()).then_some(share);
        // A delay shorter than the interval at which the position is read belongs to the sensor's clock, and is no
        // name.
        if term.drive.is_some_and(|arrival| arrival.time_s().is_some_and(|time_s| time_s < form.dataset.unsure_s)) {
            continue;
        }
        let Some((effect, errors, held)) = start::effect(form, &own.fitted.u, term, index) else { continue };
        let finding = Finding {
            effect,
            errors,
            held,
            own_zeros: term.own_zeros,
            tied: tied.clone(),
            small_share,
            gain: evidence.gain(),
            z: evidence.z(),
        };
        if small_share.is_some() && !material { seen.push(finding) } else { findings.push(finding) }
    }
    [findings, seen]
}

#[cfg(test)]
impl Finding {
    /// A finding of an effect, of which nothing else is known.
    pub(crate) fn of(kind: Kind) -> Self {
        Self {
            effect: Effect::new(kind, &[1.0]),
            errors: [f64::NAN; _],
            held: Vec::new(),
            own_zeros: false,
            tied: Vec::new(),
            small_share: None,
            gain: 1.0,
            z: 9.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bar::tests::Axis;
    use super::super::ruling::rule;
    use super::*;

    /// A drag beside a constant load. The load leaves less than a tenth of the energy of the gap, so that the drag carries
    /// less. It is named, because nothing else is left.
    #[test]
    fn a_small_effect_is_named_where_nothing_else_is_left() {
        let axis = Axis { f1: 0.1, drag: 0.003, load: 0.2, seed: 1 };
        let recordings = [axis.recording(), Axis { seed: 2, ..axis }.recording()];
        let ruling = rule(&recordings, None, &Settings::default()).unwrap();
        let names: Vec<Kind> = ruling.findings.iter().map(|finding| finding.effect.kind).collect();
        assert_eq!(names, [Kind::ConstantLoad, Kind::QuadraticDrag]);
        let left = (-2.0 * ruling.findings[0].gain).exp();
        assert!(left < MATERIAL, "{left}");
    }

    /// What predicts less than 2 % of the drive is no name, nor is what gains no more than twice what a decoy gains.
    #[test]
    fn a_small_effect_must_be_material() {
        let least = Complete { of_the_drive: 0.02, gain: 0.1 };
        let named = |of_the_drive, gain| least.names(of_the_drive, gain);
        assert_eq!([named(0.03, 0.2), named(0.01, 0.2), named(0.03, 0.05)], [true, false, false]);
    }
}
