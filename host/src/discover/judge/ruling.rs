//! The judge's ruling over windows of several widths.

use std::ops::RangeInclusive;

use breakaway_core::plant::{Base, Effect, Kind};
use rayon::prelude::*;

use super::bar::best_decoy;
use super::break_away::stiction;
use super::dataset::Dataset;
use super::evidence::Rejection;
use super::finding::{Finding, findings};
use super::library::Made;
use super::observation::observed;
use super::outcome::Outcome;
use super::remainder::{Remainder, WIDE, remainder, remainder_of};
use super::repetition::{Repetition, repetition};
use super::search::{Judged, judge};
use super::settings::Settings;
use super::term::Name;
use super::tried::Tried;
use super::weak_form::WeakForm;
use crate::recording::Recording;

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

/// What the judge says.
#[derive(Clone, Debug)]
pub struct Ruling {
    /// Base parameters of the force fit.
    pub base: Base<f64>,
    /// Names in the order in which they were found.
    pub findings: Vec<Finding>,
    /// Effects that hold too and are too small to be named by the forces alone.
    pub seen: Vec<Finding>,
    /// The first round in the windows that named; in the narrowest, where none did.
    pub candidates: Vec<Candidacy>,
    /// The last round: what was tried beside the names.
    pub left: Vec<Candidacy>,
    /// Gain in the first round of what is seen and not named, nats. That is the best significant decoy, or what predicts best
    /// what is left. It is 0 where nothing predictable is left.
    pub unnamed_gain: f64,
    /// Held-out residual of side U over the rms of the drive: base, and final model.
    pub residual_u: [f64; 2],
    /// The same of side A, over the rms of the acceleration.
    pub residual_a: [f64; 2],
    /// ρ²: share of the acceleration that the drive determines.
    pub coherence: f64,
    /// Half-width of the windows that named, s.
    pub half_width_s: f64,
    /// Least stroke of a bristle whose force the motion tells, position units.
    pub least_stroke: f64,
    /// What is left.
    pub remainder: Remainder,
    /// How many recordings give the names, of how many; `None` where all of them together do.
    pub of_recordings: Option<[usize; 2]>,
    /// Blocks over which z is computed.
    pub blocks: usize,
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
    /// The base of the force fit; `None` where its inertia is not positive, so that it cannot be simulated.
    pub fn simulable_base(&self) -> Option<Base<f64>> {
        (self.base.b > 0.0).then_some(self.base)
    }
    /// Whether little is left: of the drive, or beyond the sensor's noise. Where more is left and nothing predicts it, the
    /// recordings cannot tell whether it is random. Nor can they where only some of them give the names.
    pub fn leaves_little(&self) -> bool {
        let little = self.remainder.share < NOTHING || self.remainder.over_noise < AT_THE_NOISE;
        little && self.of_recordings.is_none()
    }
    /// Whether a part of what is left can be predicted: by something that was tried, or because it repeats with the drive.
    pub fn leaves_something_predictable(&self) -> bool {
        self.remainder.predictable.is_some() || self.repeats()
    }
    /// Whether what is left repeats with the drive, and counts. It needs what is asked of anything that predicts a part of it.
    pub fn repeats(&self) -> bool {
        let settings = Settings::default();
        let counts = |own: Repetition| own.z >= settings.z && own.share >= settings.predictable;
        self.remainder.repetition.is_some_and(counts)
    }
    /// Whether what the model leaves is nothing: it is little, and the drive tells the inertia.
    pub fn leaves_nothing(&self) -> bool {
        self.coherence >= COHERENT && self.leaves_little()
    }
    /// Whether nothing is missing. Nothing is left, and an effect would have been seen. Nothing of it repeats with the drive, and
    /// no term has the z of a name in it.
    /// What saves d ± d in a block has a z of √n over n blocks, and a name needs z ≥ 4. Over fewer blocks than 16 hardly
    /// any effect has it.
    pub fn tells_nothing_is_missing(&self) -> bool {
        let z = Settings::default().z;
        self.leaves_nothing() && !self.repeats() && self.remainder.significance < z && self.blocks as f64 >= z * z
    }
    /// Whether the forces tell what is left: they tell the inertia, and more is left than the sensor makes.
    pub fn tells_what_is_left(&self) -> bool {
        self.tells_inertia() && self.remainder.over_noise > SHAKEN
    }
    /// Whether the forces that are left speak for an effect, be it too little for a name.
    pub fn supports(&self, kind: Kind) -> bool {
        let supported = |own: &Candidacy| own.kind == kind && own.gain > 0.0 && own.z >= SUPPORT;
        self.seen.iter().any(|seen| seen.effect.kind == kind) || self.left.iter().any(supported)
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
    /// The ruling with its small findings seen only; `None` where it has none.
    pub fn without_small(&self) -> Option<Self> {
        let (small, findings): (Vec<Finding>, Vec<Finding>) =
            self.findings.iter().cloned().partition(|finding| finding.small_share.is_some());
        let seen = self.seen.iter().cloned().chain(small.iter().cloned()).collect();
        (!small.is_empty()).then(|| Self { findings, seen, ..self.clone() })
    }
    /// The ruling with the names alone that repeat over position; `None` where none does, or where all do.
    pub fn repeating(&self) -> Option<Self> {
        let repeats = |finding: &&Finding| finding.effect.kind.periodic_in_position();
        let findings: Vec<Finding> = self.findings.iter().filter(repeats).cloned().collect();
        let some = (1..self.findings.len()).contains(&findings.len());
        some.then(|| Self { findings, ..self.naming_nothing() })
    }
    /// The ruling without its names. What they explained is left, with the z of a name.
    #[must_use]
    pub fn naming_nothing(&self) -> Self {
        let mut own = Self { findings: Vec::new(), seen: Vec::new(), ..self.clone() };
        if !self.findings.is_empty() {
            own.remainder.significance = own.remainder.significance.max(Settings::default().z);
        }
        own
    }
    /// Rulings with one of the effects that are seen named.
    pub fn with_each_seen(&self) -> Vec<Self> {
        let with = |named: usize| {
            let mut own = self.clone();
            own.findings.push(own.seen.remove(named));
            own
        };
        (0..self.seen.len()).map(with).collect()
    }
    /// The ruling beside effects that are known already: none of them is named again.
    #[must_use]
    pub fn beside(mut self, known: &[Effect<f64>]) -> Self {
        let new = |finding: &Finding| !known.iter().any(|effect| effect.kind == finding.effect.kind);
        self.findings.retain(new);
        self.seen.retain(new);
        self
    }
}

/// Widths that are tried, as multiples of the narrowest that the noise allows. A ripple is sought in all but the last.
const WIDTHS: [f64; 4] = [1.0, 1.3, 2.0, WIDE];

/// Rules over `recordings`, whose position unit has so many radians; `None` where they hold too little motion.
pub fn rule(recordings: &[Recording], radians: Option<f64>, settings: &Settings) -> Option<Ruling> {
    rule_within(recordings, radians, ALL_WIDTHS, settings)
}

/// Every half-width, s.
pub const ALL_WIDTHS: RangeInclusive<f64> = 0.0..=f64::INFINITY;

/// The same in windows of these half-widths alone, s. An earlier ruling on the same motion tells them.
pub fn rule_within(
    recordings: &[Recording],
    radians: Option<f64>,
    half_widths_s: RangeInclusive<f64>,
    settings: &Settings,
) -> Option<Ruling> {
    let dataset = Dataset::new(recordings, settings);
    let narrowest = narrowest(&dataset, settings)?;
    let widths: Vec<f64> =
        widths(narrowest, settings).into_iter().filter(|width| half_widths_s.contains(width)).collect();
    let judged = widths.into_par_iter().filter_map(|width| {
        let mut form = WeakForm::new(&dataset, width, settings)?;
        form.radians = radians;
        form.ripples = width < WIDE * narrowest;
        let own = judge(&form, settings)?;
        // It holds hundreds of fields as long as the session, and other windows make their own.
        form.made = Made::default();
        Some((form, own))
    });
    let judged = judged.collect();
    let judged = with_observed_direction(judged, settings);
    let named = judged.iter().position(|(_, own)| !own.model.terms.is_empty());
    let (form, own) = judged.get(named.unwrap_or(0))?;
    let predictable = judged.iter().filter(|_| named.is_none()).chain(named.and_then(|i| judged.get(i)));
    let mut predictable = predictable.filter_map(|(_, j)| match j.rounds.last()?.outcome {
        Outcome::Unknown(name) => Some(name),
        _ => None,
    });
    let [findings, mut seen] = findings(form, own, settings);
    let mut remainder = remainder(&dataset, own, narrowest, predictable.next_back(), settings)
        .or_else(|| remainder_of(form, own, None))?;
    // The windows of the names show shorter periods of the drive than the wide ones.
    remainder.repetition = repetition(form, &own.fitted.u.residual);
    seen.extend(stiction(form, own, remainder.rms_u, settings));
    Some(Ruling {
        base: Base { b: own.inertia(), c: own.fitted.u.c.max(0.0), f1: own.fitted.u.f1.max(0.0) },
        findings,
        seen,
        candidates: own
            .rounds
            .first()
            .map_or_else(Vec::new, |round| round.tried.iter().filter_map(candidacy).collect()),
        left: own.rounds.last().map_or_else(Vec::new, |round| round.tried.iter().filter_map(candidacy).collect()),
        unnamed_gain: own.rounds.first().zip(remainder.predictable).map_or(0.0, |(round, name)| {
            let of_name = round.tried.iter().filter(|tried| tried.names() == [name]).map(|tried| tried.gain);
            of_name.fold(best_decoy(&round.tried, settings), f64::max)
        }),
        residual_u: [own.residual[0][0], own.residual[1][0]],
        residual_a: [own.residual[0][1], own.residual[1][1]],
        coherence: own.fitted.coherence(),
        half_width_s: form.half_width_s,
        least_stroke: dataset.least_stroke(),
        of_recordings: None,
        blocks: form.blocks,
        remainder,
    })
}

/// The most evident of what was judged, with the direction of the friction that a friction observer gives. Where nothing
/// was named all are observed, from the narrowest windows on until one names something.
fn with_observed_direction<'a>(
    mut judged: Vec<(WeakForm<'a>, Judged)>,
    settings: &Settings,
) -> Vec<(WeakForm<'a>, Judged)> {
    if let Some(most) = most_evident(&judged) {
        let (form, own) = judged.swap_remove(most);
        return vec![observed(form, own, settings)];
    }
    let mut with_direction: Vec<(WeakForm<'a>, Judged)> = Vec::new();
    for (form, own) in judged {
        with_direction.push(observed(form, own, settings));
        if with_direction.last().is_some_and(|(_, own)| !own.model.terms.is_empty()) {
            break;
        }
    }
    with_direction
}

/// The windows whose names are the most evident, of those that name something: their likelihood ratio is the greatest.
/// A slow effect is evident in wide windows, because the sensor's noise is small in them. A fast one is so in narrow ones.
fn most_evident(judged: &[(WeakForm<'_>, Judged)]) -> Option<usize> {
    let evidence = |(form, own): &(WeakForm<'_>, Judged)| form.rows.len() as f64 * own.gain();
    let named = judged.iter().enumerate().filter(|(_, (_, own))| !own.model.terms.is_empty());
    named.max_by(|(_, a), (_, b)| evidence(a).total_cmp(&evidence(b))).map(|(i, _)| i)
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
        let Some(form) = resolved.then(|| WeakForm::sliding(dataset, width, settings)).flatten() else { continue };
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

#[cfg(test)]
impl Ruling {
    /// A ruling that names these effects, with nothing predictable left; `share` of the drive and `over_noise` are.
    pub(crate) fn naming(kinds: &[Kind], [share, over_noise]: [f64; 2]) -> Self {
        let remainder = Remainder {
            predictable: None,
            repetition: None,
            rms_u: share,
            share,
            bandwidth_hz: 1.0,
            over_noise,
            significance: 0.0,
        };
        Self {
            base: Base { b: 1.0, c: 1.0, f1: 1.0 },
            findings: kinds.iter().map(|kind| Finding::of(*kind)).collect(),
            seen: Vec::new(),
            candidates: Vec::new(),
            left: Vec::new(),
            unnamed_gain: 0.0,
            residual_u: [1.0, share],
            residual_a: [1.0, share],
            coherence: 1.0,
            half_width_s: 0.1,
            least_stroke: f64::INFINITY,
            remainder,
            of_recordings: None,
            blocks: 100,
        }
    }
}

#[cfg(test)]
mod tests;
