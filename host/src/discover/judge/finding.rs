//! The effects that the judge names, and those that it sees beside them.

use breakaway_core::plant::{Effect, Kind};

use super::bar::best_decoy;
use super::outcome::Outcome;
use super::search::{self, Bearing, Judged, Stage};
use super::settings::Settings;
use super::sides::Model;
use super::start::{self, Errors};
use super::weak_form::WeakForm;
use super::weights::Weights;

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
    /// Its share of the energy of the gap, if that is less than [`MATERIAL`] and no [`OF_WHAT_IS_LEFT`]; `None` where it
    /// explains more.
    pub small_share: Option<f64>,
    /// Gain of the side that gains less, nats, and its z over blocks.
    pub gain: f64,
    /// See `gain`.
    pub z: f64,
}

/// Least share of the energy of the gap that each name after the first must carry, where something else may be missing.
/// An effect below it is seen, and is not what is missing.
const MATERIAL: f64 = 0.1;

/// Share of the energy that the names before it leave. A name that explains so much, and predicts what counts of the drive, is
/// material, however little that is of the whole gap. In a simulation without noise half of what is left may be nothing.
const OF_WHAT_IS_LEFT: f64 = 0.5;

/// What a name after the first needs, where it carries less than [`MATERIAL`] and less than [`OF_WHAT_IS_LEFT`].
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
    let left = energies_left(form, own, settings);
    for (index, (term, Bearing { evidence, tied })) in own.model.terms.iter().zip(&own.bearings).enumerate() {
        let share = (left[index] - left[index + 1]).max(0.0);
        let of_the_drive = share.sqrt() * own.residual[0][0];
        let material = complete.as_ref().is_some_and(|least| least.names(of_the_drive, evidence.gain()));
        let main = of_the_drive >= settings.predictable && explains_half(evidence.gain());
        let small_share = (share < MATERIAL && !main && !findings.is_empty()).then_some(share);
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

/// Whether an effect that gains so many nats explains half of what the names before it leave.
fn explains_half(gain: f64) -> bool {
    1.0 - (-2.0 * gain).exp() >= OF_WHAT_IS_LEFT
}

/// Energy that side U leaves with the first terms of the model, as a share of what the base leaves. The first entry is that
/// of no term, the next that of one. The gains of a pair are each beside the other, so that they count twice what only both
/// explain.
fn energies_left(form: &WeakForm<'_>, own: &Judged, settings: &Settings) -> Vec<f64> {
    let of = |count: usize| {
        let model = Model { terms: own.model.terms[..count].to_vec() };
        let stage = Stage::new(form, settings, model, &Weights::equal(form))?;
        Some((search::share(form, &stage.fitted)[0] / own.residual[0][0]).powi(2))
    };
    let mut energies = vec![1.0];
    for count in 1..=own.model.terms.len() {
        energies.push(of(count).unwrap_or(energies[count - 1]));
    }
    energies
}

impl Finding {
    /// An effect of which this z alone is known. It has no gain, no errors and no ties.
    pub(in crate::discover) fn of_z(effect: Effect<f64>, z: f64) -> Self {
        Self {
            effect,
            errors: [f64::NAN; _],
            held: Vec::new(),
            own_zeros: false,
            tied: Vec::new(),
            small_share: None,
            gain: 0.0,
            z,
        }
    }
}

#[cfg(test)]
impl Finding {
    /// A finding of an effect, of which nothing else is known.
    pub(crate) fn of(kind: Kind) -> Self {
        Self { gain: 1.0, ..Self::of_z(Effect::new(kind, &[1.0]), 9.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bar::tests::Axis;
    use super::super::dataset::Dataset;
    use super::super::ruling::rule_within;
    use super::super::search::judge;
    use super::super::zeros::tests::with_a_ripple;
    use super::*;

    /// A drag beside a constant load. The load leaves less than a tenth of the energy of the gap, so that the drag carries
    /// less. It is named, because nothing else is left.
    #[test]
    fn a_small_effect_is_named_where_nothing_else_is_left() {
        let axis = Axis { f1: 0.1, drag: 0.003, load: 0.2, seed: 1 };
        let recordings = [axis.recording(), Axis { seed: 2, ..axis }.recording()];
        // The windows that say the most of it.
        let ruling = rule_within(&recordings, None, 0.02..=0.02, &Settings::default()).unwrap();
        let names: Vec<Kind> = ruling.findings.iter().map(|finding| finding.effect.kind).collect();
        assert_eq!(names, [Kind::ConstantLoad, Kind::QuadraticDrag]);
        let left = (-2.0 * ruling.findings[0].gain).exp();
        assert!(left < MATERIAL, "{left}");
    }

    /// Gravity and a ripple of the same size, each recording with its own zero. The energies are left by fits of the first
    /// terms, so the last is that of the whole model, but for the windows' weights. Each of the two carries more than a
    /// tenth of the gap.
    #[test]
    fn energies_are_left_one_term_after_another() {
        let settings = Settings::default();
        let recordings = [(0.0, 7.1), (1.1, 9.7), (-2.0, 5.3)].map(|(zero, beat)| with_a_ripple(zero, beat, 0.6));
        let dataset = Dataset::new(&recordings, &settings);
        let mut form = WeakForm::new(&dataset, 0.03, &settings).unwrap();
        form.radians = Some(1.0);
        let own = judge(&form, &settings).unwrap();
        let names: Vec<Kind> = findings(&form, &own, &settings)[0].iter().map(|own| own.effect.kind).collect();
        assert_eq!(names, [Kind::GravityLoad, Kind::Cogging]);
        let left = energies_left(&form, &own, &settings);
        let [base, last] = own.residual.map(|sides| sides[0]);
        assert!((left[left.len() - 1].sqrt() * base / last - 1.0).abs() < 0.1, "{left:?} {base} {last}");
        assert!(left[0] - left[1] > MATERIAL && left[1] - left[2] > MATERIAL, "{left:?}");
    }

    /// Half of what the others leave is a gain of ½·ln 2 = .347 nats. Without this bound an eccentric encoder of .86 nats was too
    /// little to be named. A ripple in time was ten times as large there (hidden plant, unkind world, seed 8829).
    #[test]
    fn half_of_the_rest_is_material() {
        assert_eq!([0.34, 0.35].map(explains_half), [false, true]);
    }

    /// What predicts less than 2 % of the drive is no name, nor is what gains no more than twice what a decoy gains.
    #[test]
    fn a_small_effect_must_be_material() {
        let least = Complete { of_the_drive: 0.02, gain: 0.1 };
        let named = |of_the_drive, gain| least.names(of_the_drive, gain);
        assert_eq!([named(0.03, 0.2), named(0.01, 0.2), named(0.03, 0.05)], [true, false, false]);
    }
}
