//! The judge's ruling over windows of several widths.

use breakaway_core::plant::{Base, Effect, Kind};

use super::bar::best_decoy;
use super::dataset::Dataset;
use super::evidence::Rejection;
use super::regression::rms;
use super::search::{Bearing, Judged, Outcome, Round, Tried, judge};
use super::settings::Settings;
use super::start::{self, Errors};
use super::term::Name;
use super::weak_form::WeakForm;
use crate::recording::Recording;

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
    /// Gain of the side that gains less, nats, and its z over blocks.
    pub gain: f64,
    /// See `gain`.
    pub z: f64,
}

/// A candidate of the first round.
#[derive(Clone, Copy, Debug)]
pub struct Candidacy {
    /// Which effect.
    pub kind: Kind,
    /// Gain of the side that gains less, nats.
    pub gain: f64,
    /// Its z over blocks.
    pub z: f64,
    /// Why it is no name; `None` if it holds.
    pub rejection: Option<Rejection>,
}

/// What the force that no effect explains looks like.
#[derive(Clone, Debug, PartialEq)]
pub struct Remainder {
    /// What predicts a part of it on held-out data; `None` if nothing does.
    pub predictable: Option<Name>,
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

/// What the judge says.
#[derive(Clone, Debug)]
pub struct Ruling {
    /// Base parameters of the force fit.
    pub base: Base<f64>,
    /// Names in the order in which they were found.
    pub findings: Vec<Finding>,
    /// Effects that hold too and are too small to be named, with their share of the energy of the gap.
    pub seen: Vec<(Kind, f64)>,
    /// The first round in the windows that named; in the narrowest, where none did.
    pub candidates: Vec<Candidacy>,
    /// The last round: what was tried beside the names.
    pub left: Vec<Candidacy>,
    /// Gain of the best significant decoy of the first round, nats; 0 if none is significant.
    pub decoy_gain: f64,
    /// Held-out residual of side U over the rms of the drive: base, and final model.
    pub residual_u: [f64; 2],
    /// The same of side A, over the rms of the acceleration.
    pub residual_a: [f64; 2],
    /// ρ²: share of the acceleration that the drive determines.
    pub coherence: f64,
    /// Half-width of the windows that named, s.
    pub half_width_s: f64,
    /// What is left.
    pub remainder: Remainder,
    /// How many recordings give the names, of how many; `None` where all of them together do.
    pub of_recordings: Option<[usize; 2]>,
}

/// Share of the drive below which what is left counts as nothing. A random torque of 1 % of the supply leaves so much,
/// where the drive's rms is a tenth of the supply.
const NOTHING: f64 = 0.1;
/// Least ρ² at which the forces tell the inertia, and that nothing is missing.
const COHERENT: f64 = 0.3;
/// Force that is left, over what the sensor's noise makes of it, below which it may be all noise.
const AT_THE_NOISE: f64 = 2.0;
/// The same ratio, from which random torque shakes the machine.
const SHAKEN: f64 = 5.0;

/// z over blocks, on both sides, from which the forces speak for an effect. Of 24 effects that are not there, one exceeds
/// it by chance on one side in one ruling of thirty.
const SUPPORT: f64 = 3.0;

impl Ruling {
    /// Whether the inertia of the force fit means something.
    pub fn tells_inertia(&self) -> bool {
        self.base.b > 0.0 && self.coherence >= COHERENT
    }
    /// Whether little is left: of the drive, or beyond the sensor's noise. Where more is left and nothing predicts it, the
    /// recordings cannot tell whether it is random. Nor can they where only some of them give the names.
    pub fn leaves_little(&self) -> bool {
        let little = self.remainder.share < NOTHING || self.remainder.over_noise < AT_THE_NOISE;
        little && self.of_recordings.is_none()
    }
    /// Whether nothing is missing: little is left, and the drive tells the inertia.
    pub fn tells_nothing_is_missing(&self) -> bool {
        self.coherence >= COHERENT && self.leaves_little()
    }
    /// Whether the forces tell what is left: they tell the inertia, and more is left than the sensor makes.
    pub fn tells_what_is_left(&self) -> bool {
        self.tells_inertia() && self.remainder.over_noise > SHAKEN
    }
    /// Whether the forces that are left speak for an effect, be it too little for a name.
    pub fn supports(&self, kind: Kind) -> bool {
        let supported = |own: &Candidacy| own.kind == kind && own.gain > 0.0 && own.z >= SUPPORT;
        self.seen.iter().any(|(seen, _)| *seen == kind) || self.left.iter().any(supported)
    }
    /// Whether random torque shakes the machine. The forces have weighed the effects that they can weigh, more is left
    /// than the sensor makes, and nothing predicts it. They have weighed nothing where they hardly tell the inertia, or
    /// where they see an effect that is too small to be named.
    pub fn shaken(&self) -> bool {
        let remainder = &self.remainder;
        self.tells_inertia()
            && self.seen.is_empty()
            && remainder.over_noise > SHAKEN
            && remainder.predictable.is_none()
            && remainder.significance < Settings::default().z
    }
    /// Share of the drive that the names explain, on side U.
    pub fn explains_of_the_drive(&self) -> f64 {
        let [base, left] = self.residual_u;
        (base * base - left * left).max(0.0).sqrt()
    }
    /// The ruling beside effects that are known already: none of them is named again.
    #[must_use]
    pub fn beside(mut self, known: &[Effect<f64>]) -> Self {
        self.findings.retain(|finding| !known.iter().any(|effect| effect.kind == finding.effect.kind));
        self
    }
}

/// Widths that are tried, as multiples of the narrowest that the noise allows. A ripple is sought in all but the last.
const WIDTHS: [f64; 4] = [1.0, 1.3, 2.0, WIDE];
/// See [`WIDTHS`]: the windows in which the sensor's noise does not count.
const WIDE: f64 = 4.0;

/// Rules over `recordings`, whose position unit has so many radians; `None` where they hold too little motion.
pub fn rule(recordings: &[Recording], radians: Option<f64>, settings: &Settings) -> Option<Ruling> {
    rule_from(recordings, radians, 0.0, settings)
}

/// The same in windows of at least this half-width, s. It is that of an earlier ruling on the same motion, counted from
/// other zeros.
pub fn rule_from(
    recordings: &[Recording],
    radians: Option<f64>,
    least_half_width_s: f64,
    settings: &Settings,
) -> Option<Ruling> {
    let dataset = Dataset::new(recordings, settings);
    let narrowest = narrowest(&dataset, settings)?;
    let mut judged: Vec<(WeakForm<'_>, Judged)> = Vec::new();
    for width in widths(narrowest, settings).into_iter().filter(|width| *width >= least_half_width_s) {
        let Some(mut form) = WeakForm::new(&dataset, width, settings) else { continue };
        form.radians = radians;
        form.ripples = width < WIDE * narrowest;
        let Some(own) = judge(&form, settings) else { continue };
        let named = !own.model.terms.is_empty();
        judged.push((form, own));
        if named {
            break;
        }
    }
    let named = judged.iter().position(|(_, j)| !j.model.terms.is_empty());
    let (form, own) = judged.get(named.unwrap_or(0))?;
    let predictable = judged.iter().filter(|_| named.is_none()).chain(named.and_then(|i| judged.get(i)));
    let mut predictable = predictable.filter_map(|(_, j)| match j.rounds.last()?.outcome {
        Outcome::Unknown(name) => Some(name),
        _ => None,
    });
    let (findings, seen) = findings(form, own, settings);
    Some(Ruling {
        base: Base { b: own.inertia(), c: own.fitted.u.c.max(0.0), f1: own.fitted.u.f1.max(0.0) },
        findings,
        seen,
        candidates: own
            .rounds
            .first()
            .map_or_else(Vec::new, |round| round.tried.iter().filter_map(candidacy).collect()),
        left: own.rounds.last().map_or_else(Vec::new, |round| round.tried.iter().filter_map(candidacy).collect()),
        decoy_gain: own.rounds.first().map_or(0.0, |round| best_decoy(&round.tried, settings)),
        residual_u: [own.residual[0][0], own.residual[1][0]],
        residual_a: [own.residual[0][1], own.residual[1][1]],
        coherence: own.fitted.coherence(),
        half_width_s: form.half_width_s,
        of_recordings: None,
        remainder: remainder(&dataset, own, narrowest, predictable.next_back(), settings)
            .or_else(|| remainder_of(form, own, None))?,
    })
}

/// The widths that are tried, from the narrowest.
fn widths(narrowest: f64, settings: &Settings) -> Vec<f64> {
    let next = |multiple: f64| settings.half_widths_s.iter().copied().find(|width| *width >= multiple * narrowest);
    let mut widths: Vec<f64> = WIDTHS.iter().filter_map(|multiple| next(*multiple)).collect();
    widths.dedup();
    widths
}

/// The narrowest windows in which the sensor's noise makes a small enough share of the acceleration; else the widest.
pub(super) fn narrowest(dataset: &Dataset, settings: &Settings) -> Option<f64> {
    let mut last = None;
    for width in settings.half_widths_s {
        let resolved = dataset.pieces.iter().any(|p| width >= settings.least_half_samples as f64 * p.h_s);
        let Some(form) = resolved.then(|| WeakForm::new(dataset, width, settings)).flatten() else { continue };
        last = Some(width);
        if form.noise_share() < settings.noise_share {
            break;
        }
    }
    last
}

fn candidacy(tried: &Tried) -> Option<Candidacy> {
    let [term] = tried.terms.as_slice() else { return None };
    let Name::Effect(kind) = term.name else { return None };
    Some(Candidacy { kind, gain: tried.gain, z: tried.evidence[0].z(), rejection: tried.rejection() })
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

/// The named effects, and the effects that are seen beside them with their shares of the energy of the gap.
fn findings(form: &WeakForm<'_>, own: &Judged, settings: &Settings) -> (Vec<Finding>, Vec<(Kind, f64)>) {
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
        let small = share < MATERIAL && !material;
        if let (false, true, Name::Effect(kind)) = (findings.is_empty(), small, term.name) {
            seen.push((kind, share));
            continue;
        }
        // A delay shorter than the interval at which the position is read belongs to the sensor's clock, and is no
        // name.
        if term.drive.is_some_and(|arrival| arrival.time_s().is_some_and(|time_s| time_s < form.dataset.unsure_s)) {
            continue;
        }
        if let Some((effect, errors, held)) = start::effect(form, &own.fitted.u, term, index) {
            findings.push(Finding {
                effect,
                errors,
                held,
                own_zeros: term.own_zeros,
                tied: tied.clone(),
                gain: evidence.gain(),
                z: evidence.z(),
            });
        }
    }
    (findings, seen)
}

/// What is left in windows so wide that the sensor's noise does not count.
fn remainder(
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

fn remainder_of(form: &WeakForm<'_>, own: &Judged, predictable: Option<Name>) -> Option<Remainder> {
    let left = rms(&own.fitted.u.residual);
    let share = left / rms(&form.row_u);
    let noise = own.fitted.u.b.abs() * form.noise_a;
    share.is_finite().then_some(Remainder {
        predictable,
        rms_u: left,
        share,
        bandwidth_hz: bandwidth_hz(form.half_width_s),
        over_noise: left / noise.max(f64::MIN_POSITIVE),
        significance: own.rounds.last().map_or(0.0, significance),
    })
}

#[cfg(test)]
impl Ruling {
    /// A ruling that names these effects, with nothing predictable left; `share` of the drive and `over_noise` are.
    pub(crate) fn naming(kinds: &[Kind], [share, over_noise]: [f64; 2]) -> Self {
        let finding = |kind: &Kind| Finding {
            effect: Effect::new(*kind, &[1.0]),
            errors: [f64::NAN; _],
            held: Vec::new(),
            own_zeros: false,
            tied: Vec::new(),
            gain: 1.0,
            z: 9.0,
        };
        let remainder =
            Remainder { predictable: None, rms_u: share, share, bandwidth_hz: 1.0, over_noise, significance: 0.0 };
        Self {
            base: Base { b: 1.0, c: 1.0, f1: 1.0 },
            findings: kinds.iter().map(finding).collect(),
            seen: Vec::new(),
            candidates: Vec::new(),
            left: Vec::new(),
            decoy_gain: 0.0,
            residual_u: [1.0, share],
            residual_a: [1.0, share],
            coherence: 1.0,
            half_width_s: 0.1,
            remainder,
            of_recordings: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bar::tests::Axis;
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

    /// The motion is asked for effects that are seen, and for those that nearly hold.
    #[test]
    fn the_forces_speak_for_what_nearly_holds() {
        let own = |kind, z| Candidacy { kind, gain: 0.01, z, rejection: Some(Rejection::Gain) };
        let ruling = Ruling {
            seen: vec![(Kind::Cogging, 0.05)],
            left: vec![own(Kind::Delay, 3.1), own(Kind::Spring, 2.9)],
            ..Ruling::naming(&[Kind::ConstantLoad], [0.05, 9.0])
        };
        let supported = [Kind::Cogging, Kind::Delay, Kind::Spring].map(|kind| ruling.supports(kind));
        assert_eq!(supported, [true, true, false]);
    }
}
