//! The judge's names as a model. The simulated motion gives the parameters that are printed, and the ladder. It adds no
//! name; it only takes back names that lower no simulation error.

use breakaway_core::plant::Effect;

use super::candidate_rows;
use super::data::{Data, FIT_SEGMENT_S, SHORT_SEGMENT_S};
use super::engine::{DiscoverError, Request, assembled, prepared};
use super::following::{contradicted, follows, follows_for_longer, off_by_a_tooth, open_loop, told};
use super::inertia;
use super::judge::finding::Finding;
use super::judge::ruling::Ruling;
use super::judge::settings::Settings;
use super::model::Model;
use super::outcome::{Discovery, Force, NamedEffect, Rival, Rung, Verdict};
use super::progress::{Progress, Watch};
use super::ruled::radians;
use super::search::{Ended, parameters, rung, settled};
use crate::fit::{Candidate, Fit, Free, SCORE_ITERATIONS};
use crate::recording::Units;

/// Iterations of the fit of the simulated motion.
const ITERATIONS: usize = 20;

/// The discovery that the judge's ruling gives, and the ruling. The simulated motion decides on small effects. A small name
/// is only seen where the motion follows the open loop less well with it. What is seen is named where the motion follows it
/// better.
///
/// # Errors
/// [`DiscoverError`] where no base can be simulated at all.
pub(super) fn found(
    request: &Request,
    units: &Units,
    ruling: &Ruling,
    progress: Watch<'_>,
) -> Result<(Discovery, Ruling), DiscoverError> {
    let start = prepared(request, FIT_SEGMENT_S, Some(ruling), progress)
        .or_else(|_| prepared(request, SHORT_SEGMENT_S, Some(ruling), progress))?;
    let (data, base) = (&start.data, &start.base);
    progress(Progress::Step("fitting the simulated motion"));
    let rotary = radians(units).is_some();
    let simulated = |ruling: &Ruling| {
        if ruling.findings.is_empty() { (base.clone(), None) } else { simulated(data, base, ruling, rotary) }
    };
    // Where the model without the names in question is off by a tooth, the names are compared beside what repeats over position.
    // A base of another inertia follows by it what it misses, so it does not speak against what is missed.
    let withdrawn = |ruling: &Ruling, ladder: &[Rung], fit: &Fit| {
        let speaks = || !inertia::contradicted(ruling, &base.candidate) && !follows(data, base, fit);
        contradicted(ruling, ladder).filter(|_| speaks()).filter(|_| {
            let Some(repeating) = ruling.repeating() else { return true };
            let without = simulated(&repeating).0;
            !follows(data, &without, fit) && contradicted(ruling, &[rung(data, &without), rung(data, fit)]).is_some()
        })
    };
    let (ruling, (fit, of_forces)) = forward_selection(ruling, simulated, |own, (fit, _), (best, _)| {
        // What would be withdrawn must not take the names of the forces with it.
        let stays = || withdrawn(own, &[rung(data, base), rung(data, fit)], fit).is_none();
        let better = follows(data, best, fit) || follows_for_longer(data, best, fit) || told(data, best, fit);
        (better && stays()).then(|| open_loop(data, fit))
    });
    let mut remarks: Vec<String> = ruling.seen.iter().map(|own| seen(own, units)).collect();
    remarks.extend(ruling.of_recordings.map(|[own, all]| {
        format!("{own} of {all} recordings name it alone and together; the others hold too little of it")
    }));
    remarks.extend(of_forces);
    let errors = data.problem().covariance(&fit);
    let known = base.candidate.effects.len();
    let named = ruling.findings.iter().enumerate().map(|(j, finding)| {
        let mut parameters = parameters(&fit.candidate, known + j, Some(&errors), units);
        if fit.free.is_empty() {
            parameters.iter_mut().zip(finding.errors).for_each(|(parameter, error)| parameter.se = error);
        }
        NamedEffect { kind: finding.effect.kind, parameters, rivals: rivals(finding) }
    });
    let mut ladder = vec![rung(data, base)];
    if !ruling.findings.is_empty() {
        ladder.push(rung(data, &fit));
    }
    if let Some(reason) = withdrawn(&ruling, &ladder, &fit) {
        remarks.push(reason);
        let doubted = ruling.repeating().unwrap_or_else(|| ruling.naming_nothing());
        let (mut found, _) = self::found(request, units, &doubted, progress)?;
        found.remarks.extend(remarks);
        if ruling.explains_of_the_drive() > Settings::default().predictable {
            found.verdict = beside_doubt(&doubted);
        }
        return Ok((found, ruling));
    }
    let ended = Ended {
        verdict: verdict(&ruling),
        named: named.collect(),
        errors,
        fit,
        ladder,
        first_round: ruling.candidates.iter().map(|own| candidate_rows::row(own, &ruling)).collect(),
        closest: None,
        tie: None,
        remarks,
    };
    Ok((assembled(request, &start, units, ended, progress), ruling))
}

/// The ruling whose small and seen effects the simulated motion bears out, and its fit. Where the motion is better without
/// the small names they go. Else what is seen is added, the best first, as long as the motion is better with it. `error`
/// gives the open-loop error of another ruling's fit, where that is better than the best so far.
fn forward_selection<F>(
    ruling: &Ruling,
    fit: impl Fn(&Ruling) -> F,
    error: impl Fn(&Ruling, &F, &F) -> Option<f64>,
) -> (Ruling, F) {
    let mut best = (ruling.clone(), fit(ruling));
    if let Some(without) = ruling.without_small() {
        let own = fit(&without);
        if error(&without, &own, &best.1).is_some() {
            return (without, own);
        }
    }
    loop {
        let each = best.0.with_each_seen().into_iter().map(|other| {
            let own = fit(&other);
            (error(&other, &own, &best.1), other, own)
        });
        let better = each.filter_map(|(error, other, own)| Some((error?, other, own)));
        let Some((_, other, own)) = better.min_by(|a, b| a.0.total_cmp(&b.0)) else { return best };
        best = (other, own);
    }
}

/// The remark on an effect that is seen, in a few windows or at rest.
fn seen(finding: &Finding, units: &Units) -> String {
    let name = finding.effect.kind.name();
    if let Some(share) = finding.small_share {
        let percent = 100.0 * share;
        return format!("{name} is seen too, with {percent:.0} % of the energy of the gap: too little to be named");
    }
    let (level, unit) = (finding.effect.p[0], &units.u);
    format!(
        "the axis stands under {level:.3} {unit} more than its Coulomb friction. The simulated motion follows no better \
         with {name}: not named"
    )
}

/// The measured forces of a ruling, as the report shows them.
pub(super) fn force(ruling: &Ruling) -> Force {
    Force {
        drive: ruling.residual_u,
        acceleration: ruling.residual_a,
        coherence: ruling.coherence,
        half_width_s: ruling.half_width_s,
        random: ruling.remainder.rms_u,
        random_share: ruling.remainder.share,
        bandwidth_hz: ruling.remainder.bandwidth_hz,
        predictable: ruling.remainder.predictable.map(super::judge::term::Name::text),
    }
}

/// The verdict: by whether something was named, whether the force that is left can be predicted, and whether it is little.
/// An effect that is seen predicts a part of it.
fn verdict(ruling: &Ruling) -> Verdict {
    let predictable = ruling.remainder.predictable.is_some() || !ruling.seen.is_empty();
    match (ruling.findings.is_empty(), predictable) {
        (false, false) if ruling.leaves_little() => Verdict::Explained,
        (false, _) => Verdict::PartlyExplained,
        (true, false) if ruling.tells_nothing_is_missing() => Verdict::NothingMissing,
        (true, _) => Verdict::Unknown,
    }
}

/// The verdict where the simulated motion contradicts names that explain what counts of the drive. Names that stay explain a
/// part of it.
fn beside_doubt(stays: &Ruling) -> Verdict {
    if stays.findings.is_empty() { Verdict::Unknown } else { Verdict::PartlyExplained }
}

/// The model with the findings, fitted to the simulated motion. The parameters of the force fit are kept in five cases. The
/// motion gives none; or it loses an effect; or it is off by a tooth. Or the forces contradict its inertia; or its
/// parameters follow the open loop less well. Where neither can be simulated the base is returned. The remark says why they
/// are those of the force fit.
fn simulated(data: &Data, base: &Fit, ruling: &Ruling, rotary: bool) -> (Fit, Option<String>) {
    let own = ruling.simulable_base().unwrap_or(base.candidate.base);
    let mut candidate = Candidate { base: own, effects: base.candidate.effects.clone() };
    candidate.effects.extend(ruling.findings.iter().map(|finding| finding.effect));
    let known = base.candidate.effects.len();
    let held = |free: &Free| match *free {
        Free::Effect(j, i) => j >= known && ruling.findings[j - known].held.contains(&i),
        Free::Base(_) => false,
    };
    let mut free = Free::all(&candidate.effects);
    free.retain(|free| !held(free));
    let problem = data.problem();
    let by_force = problem.fit(&candidate, &[], None, SCORE_ITERATIONS);
    let of = |start: &Candidate| problem.fit(start, &free, None, ITERATIONS).map(|fit| settled(data, fit));
    let by_motion = match (of(&candidate), in_whole_waves(&candidate, known, rotary).map(|whole| of(&whole))) {
        (Ok(own), Some(Ok(whole))) if whole.cost < own.cost => Ok(whole),
        (own, _) => own,
    };
    let (by_force, by_motion) = match (by_force, by_motion) {
        (Ok(force), Ok(motion)) => (force, motion),
        (Err(_), Ok(motion)) => return (canonical(motion), None),
        (Ok(force), Err(error)) => {
            return (force, Some(of_the_force_fit(&format!("the simulated motion gives none ({error})"))));
        }
        (Err(_), Err(_)) => return (base.clone(), None),
    };
    let reason = if let Some(name) = lost(&by_motion.candidate, known, ruling) {
        format!("with those of the simulated motion nothing would be left of {name}")
    } else if off_by_a_tooth(ruling, &by_motion.candidate.effects, || rung(data, &by_motion).holdout_rmse) {
        "the simulated motion is off by a tooth".to_owned()
    } else if inertia::contradicted(ruling, &by_motion.candidate) {
        "the measured forces contradict the inertia of the simulated motion".to_owned()
    } else if open_loop(data, &by_force) < open_loop(data, &by_motion) {
        "those of the simulated motion follow the open loop less well".to_owned()
    } else {
        return (canonical(by_motion), None);
    };
    (by_force, Some(of_the_force_fit(&reason)))
}

/// The remark on parameters that are not those of the simulated motion.
fn of_the_force_fit(reason: &str) -> String {
    format!("the parameters are those of the force fit: {reason}")
}

/// The candidate with a whole number of waves in a turn for each effect after the first `known` that is near one.
/// `None` where no effect is, or where the position is no angle. The force fit tells such a number from few turns, so
/// it may be off.
fn in_whole_waves(candidate: &Candidate, known: usize, rotary: bool) -> Option<Candidate> {
    let model = Model::new(candidate);
    let added = known..candidate.effects.len();
    let whole =
        added.fold(None, |whole: Option<Model>, j| whole.as_ref().unwrap_or(&model).in_whole_waves(j).or(whole));
    whole.filter(|_| rotary).map(|whole| whole.candidate())
}

/// The first effect that the simulated motion changes too much. Its main parameter is then below a tenth of the force
/// fit's, or above ten times it.
fn lost(candidate: &Candidate, known: usize, ruling: &Ruling) -> Option<&'static str> {
    let own = candidate.effects.iter().skip(known).zip(&ruling.findings);
    let far = |(effect, finding): &(&Effect<f64>, &Finding)| {
        let ratio = effect.p[0] / finding.effect.p[0];
        !(0.1..=10.0).contains(&ratio.abs())
    };
    own.into_iter().find(far).map(|(effect, _)| effect.kind.name())
}

/// The fit with phases within half a turn.
fn canonical(mut fit: Fit) -> Fit {
    fit.candidate.effects.iter_mut().for_each(|effect| *effect = effect.canonical());
    fit
}

fn rivals(finding: &Finding) -> Vec<Rival> {
    let tied = finding.tied.iter();
    tied.map(|(kind, z)| Rival { kind: *kind, delta: 0.0, z: *z, tied: true }).collect()
}

/// A discovery of the simulated motion, with the judge's ties for each name that the judge gave too. Down to the sensor's
/// noise the motion tells what the forces do not. There it has only the ties with effects that it was not compared with.
pub(super) fn with_ties(mut small: Discovery, ruling: Option<&Ruling>) -> Discovery {
    let told = small.down_to_the_noise();
    let findings = ruling.map_or(&[][..], |ruling| &ruling.findings);
    for named in &mut small.effects {
        for tied in findings.iter().filter(|finding| finding.effect.kind == named.kind).flat_map(rivals) {
            if told && named.rivals.iter().any(|rival| rival.kind == tied.kind) {
                continue;
            }
            named.rivals.retain(|rival| rival.kind != tied.kind);
            named.rivals.push(tied);
        }
    }
    small
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::{Base, Kind};

    use super::super::judge::bar::tests::Axis;
    use super::super::judge::ruling::rule_within;
    use super::*;
    use crate::recording::Recording;

    /// Half-width of the windows that say the most of the axis, s. The others take three quarters of the time.
    const WIDTH_S: f64 = 0.02;

    /// An axis with a load and a small drag, and what its forces say with the drag only seen.
    fn axis_with_a_drag() -> (Request, Ruling) {
        let axis = Axis { f1: 0.1, drag: 0.003, load: 0.2, seed: 1 };
        let recordings: Vec<Recording> = (1..=2).map(|seed| Axis { seed, ..axis }.recording()).collect();
        let ruling = rule_within(&recordings, None, WIDTH_S..=WIDTH_S, &Settings::default()).unwrap();
        let ruling = ruling.without_small().unwrap();
        let kinds = |own: &[Finding]| own.iter().map(|own| own.effect.kind).collect::<Vec<_>>();
        assert_eq!([kinds(&ruling.findings), kinds(&ruling.seen)], [[Kind::ConstantLoad], [Kind::QuadraticDrag]]);
        (Request { recordings, ..Request::default() }, ruling)
    }

    fn names(request: &Request, ruling: &Ruling) -> (Vec<Kind>, Vec<String>) {
        let (found, _) = found(request, &Units::default(), ruling, &|_| ()).unwrap();
        (found.effects.iter().map(|own| own.kind).collect(), found.remarks)
    }

    /// Of two effects that are seen, stiction leaves less in open loop, and nothing is better with the curve too. So
    /// stiction is named, and the curve stays seen.
    #[test]
    fn what_is_seen_is_added_the_best_first() {
        let seen = vec![Finding::of(Kind::Stribeck), Finding::of(Kind::Stiction)];
        let ruling = Ruling { seen, ..Ruling::naming(&[Kind::Delay], [0.05, 9.0]) };
        let kinds = |own: &[Finding]| own.iter().map(|own| own.effect.kind).collect::<Vec<_>>();
        let fit = |ruling: &Ruling| match kinds(&ruling.findings)[1..] {
            [Kind::Stiction] => 0.1,
            [Kind::Stribeck] => 0.2,
            _ => 0.3,
        };
        let (own, error) = forward_selection(&ruling, fit, |_, own, best| (own < best).then_some(*own));
        assert_eq!(
            [kinds(&own.findings), kinds(&own.seen)],
            [[Kind::Delay, Kind::Stiction].to_vec(), vec![Kind::Stribeck]]
        );
        assert!((error - 0.1_f64).abs() < 1e-12);
    }

    /// An effect that the forces only see is named where the simulated motion follows better with it.
    #[test]
    fn what_is_seen_is_named_where_the_motion_follows_better() {
        let (request, ruling) = axis_with_a_drag();
        let (named, remarks) = names(&request, &ruling);
        assert_eq!(named, [Kind::ConstantLoad, Kind::QuadraticDrag]);
        assert!(!remarks.iter().any(|remark| remark.contains("is seen too")), "{remarks:?}");
    }

    /// A force fit whose inertia is not positive cannot be simulated. Its names then start from the motion's base.
    #[test]
    fn names_are_simulated_without_the_inertia_of_the_forces() {
        let (request, mut ruling) = axis_with_a_drag();
        ruling.base.b = -1.0;
        assert_eq!(names(&request, &ruling).0.first(), Some(&Kind::ConstantLoad));
    }

    /// Another effect in its place lowers no error of the motion, and stays a remark.
    #[test]
    fn what_is_seen_stays_seen_where_the_motion_is_no_better() {
        let (request, mut ruling) = axis_with_a_drag();
        ruling.seen[0].effect = Effect::new(Kind::Spring, &[1e-4, 0.0]);
        let (named, remarks) = names(&request, &ruling);
        assert_eq!(named, [Kind::ConstantLoad]);
        assert!(remarks.iter().any(|remark| remark.contains("spring is seen too")), "{remarks:?}");
    }

    /// A delay, which the axis has not, lowers no error and is withdrawn. Where the forces say ten times the inertia, the base
    /// without it is no witness. Beside a load the parameters are those of the forces there.
    #[test]
    fn an_inertia_that_the_forces_contradict_says_nothing() {
        let (request, ruling) = axis_with_a_drag();
        let heavy =
            |ruling: &Ruling| Ruling { base: Base { b: 10.0 * ruling.base.b, ..ruling.base }, ..ruling.clone() };
        let delay = Finding { effect: Effect::new(Kind::Delay, &[0.02]), ..Finding::of(Kind::Delay) };
        let late = Ruling { findings: vec![delay], seen: Vec::new(), ..ruling.clone() };
        let named = [late.clone(), heavy(&late)].map(|ruling| names(&request, &ruling).0);
        assert_eq!(named, [vec![], vec![Kind::Delay]]);
        let contradicted = [ruling.clone(), heavy(&ruling)].map(|ruling| {
            let (_, remarks) = names(&request, &ruling);
            remarks.iter().any(|own| own.contains("contradict the inertia"))
        });
        assert_eq!(contradicted, [false, true]);
    }

    /// The fitted segments tell a load beside the base. They do not tell a spring of a thousandth of it beside the load.
    #[test]
    fn the_fitted_segments_tell_what_is_there() {
        let (request, _) = axis_with_a_drag();
        let start = prepared(&request, FIT_SEGMENT_S, None, &|_| ()).unwrap();
        let (data, base) = (&start.data, &start.base);
        let with = |effects: &[Effect<f64>]| {
            let model = effects.iter().fold(Model::of(base), |model, effect| model.with(*effect));
            model.fit(&data.problem(), None, ITERATIONS).unwrap()
        };
        let load = Effect::new(Kind::ConstantLoad, &[0.2]);
        let loaded = with(&[load]);
        assert!(told(data, base, &loaded) && !told(data, &loaded, base) && !told(data, &loaded, &loaded));
        assert!(!told(data, &loaded, &with(&[load, Effect::new(Kind::Spring, &[2e-4, 0.0])])));
    }

    /// Down to the noise the motion keeps the ties of the forces with what it was not compared with. Beside a model that
    /// leaves more, the ties of the forces count.
    #[test]
    fn ties_stay_with_what_was_not_compared() {
        let (request, mut ruling) = axis_with_a_drag();
        ruling.findings[0].tied = vec![(Kind::Spring, 0.3), (Kind::GravityLoad, 0.4)];
        let (mut small, _) = found(&request, &Units::default(), &ruling, &|_| ()).unwrap();
        small.effects[0].rivals = vec![Rival { kind: Kind::Spring, delta: 1.0, z: 9.0, tied: false }];
        let ties = |verdict: Verdict| {
            let own = with_ties(Discovery { verdict, ..small.clone() }, Some(&ruling));
            own.effects[0].rivals.iter().filter(|rival| rival.tied).map(|rival| rival.kind).collect::<Vec<_>>()
        };
        assert_eq!(ties(Verdict::Explained), [Kind::GravityLoad]);
        assert_eq!(ties(Verdict::PartlyExplained), [Kind::Spring, Kind::GravityLoad]);
    }

    /// A tenth of the drive, or twice the sensor's noise, may be left at random where all is explained. Where only some
    /// recordings give the name, nothing is said of the others.
    #[test]
    fn much_that_is_left_is_not_explained() {
        let of = |left: [f64; 2]| verdict(&Ruling::naming(&[Kind::Cogging], left));
        assert_eq!([of([0.09, 50.0]), of([0.3, 1.9])], [Verdict::Explained; 2]);
        assert_eq!(of([0.11, 50.0]), Verdict::PartlyExplained);
        let some = Ruling { of_recordings: Some([2, 5]), ..Ruling::naming(&[Kind::Cogging], [0.01, 50.0]) };
        assert_eq!(verdict(&some), Verdict::PartlyExplained);
    }

    /// A ripple stays where the motion contradicts the delay beside it. What the delay explained is then missing.
    #[test]
    fn doubt_leaves_nothing_explained() {
        let ruling = Ruling::naming(&[Kind::Cogging, Kind::Delay], [0.01, 50.0]);
        let verdicts = [ruling.repeating().unwrap(), ruling.naming_nothing()].map(|stays| beside_doubt(&stays));
        assert_eq!(verdicts, [Verdict::PartlyExplained, Verdict::Unknown]);
    }

    /// An effect that is seen beside the names is predictable, however little it predicts.
    #[test]
    fn what_is_seen_is_not_explained() {
        let seen = Ruling { seen: vec![Finding::of(Kind::Spring)], ..Ruling::naming(&[Kind::Cogging], [0.01, 50.0]) };
        assert_eq!(verdict(&seen), Verdict::PartlyExplained);
    }

    /// A virtual board's forces gave 3.0855 waves for 3. The number becomes whole along an angle; it does not along a
    /// slide, or for an effect that was known before.
    #[test]
    fn waves_near_a_whole_number_are_tried_whole() {
        let ripple = Effect::new(Kind::PositionFriction, &[0.56, 3.0855, 0.97]);
        let load = Effect::new(Kind::ConstantLoad, &[0.1]);
        let candidate = Candidate { base: Base { b: 1.0, c: 1.0, f1: 1.0 }, effects: vec![load, ripple] };
        let whole = in_whole_waves(&candidate, 1, true).unwrap();
        assert_eq!(whole.effects[1].p[1].to_bits(), 3.0_f64.to_bits());
        assert!(in_whole_waves(&candidate, 1, false).is_none() && in_whole_waves(&candidate, 2, true).is_none());
    }
}
