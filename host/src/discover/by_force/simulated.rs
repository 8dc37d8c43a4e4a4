//! The parameters that are printed: those of the simulated motion, or those of the force fit.

use breakaway_core::plant::Effect;

use super::super::data::Data;
use super::super::following::{off_by_a_tooth, open_loop};
use super::super::inertia;
use super::super::judge::finding::Finding;
use super::super::judge::ruling::Ruling;
use super::super::model::Model;
use super::super::search::{rung, settled};
use crate::fit::{Candidate, Fit, Free, SCORE_ITERATIONS};

/// Iterations of the fit of the simulated motion.
pub(super) const ITERATIONS: usize = 20;

/// The model with the findings, fitted to the simulated motion. The parameters of the force fit are kept in five cases. The
/// motion gives none; or it loses an effect; or it is off by a tooth. Or the forces contradict its inertia; or its
/// parameters follow the open loop less well. Where neither can be simulated the base is returned. The remark says why they
/// are those of the force fit.
pub(super) fn simulated(data: &Data, base: &Fit, ruling: &Ruling, rotary: bool) -> (Fit, Option<String>) {
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

#[cfg(test)]
mod tests {
    use breakaway_core::plant::{Base, Kind};

    use super::*;

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
