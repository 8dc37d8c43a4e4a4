//! Limits of what the recordings resolve. A model beyond them is not believed, whatever it gains.

use breakaway_core::plant::effect::{ActsIn, Role, Scale, Search};
use breakaway_core::plant::{Effect, MAX_SUB_STEPS, Plant};

use crate::discover::data::Data;
use crate::discover::judge::compliance::LONGEST_STROKE;
use crate::discover::judge::library::MOST_DAMPING;
use crate::discover::screen::{stroke, travel};
use crate::fit::Candidate;

/// Share of a sample's time below which a delay or a lag of the drive is not believed. The solver's own error is as
/// large.
const LEAST_OF_A_SAMPLE: f64 = 0.01;
/// Share of the inertia below which a second body is not believed.
const LEAST_BODY: f64 = 0.02;
/// Largest rise of the friction at rest over the Coulomb friction: three times the largest from which a search starts.
/// Without sliding friction there is nothing to break away from.
const MOST_RISE: f64 = 10.0;

/// Whether `test` holds for a parameter whose role `is` accepts.
fn any(effect: &Effect<f64>, is: impl Fn(Role) -> bool, test: impl Fn(f64) -> bool) -> bool {
    let parameters = effect.kind.definition().parameters.iter().zip(&effect.p);
    parameters.into_iter().any(|(parameter, value)| is(parameter.role) && test(*value))
}

/// Refuses a model that the recordings do not resolve, for one of these reasons. Their order is that of the tests.
///
/// - Dynamics are faster than the solver's steps, or a delay is shorter than the time stamps tell.
/// - No drive of the recordings overcomes the inertia or the friction. Only the starts then move anything.
/// - The friction at rest is many times that of sliding.
/// - Bristles are so long that they never let go. They are a spring, and each segment chooses its rest.
/// - A second body is so light that only its start is left of it, free in every segment; or its spring is all damper.
///
/// `judged` are the effects whose bristles count. The bristles of the others may be too long until the missing effect
/// is there, because they took its share.
pub(super) fn resolved(data: &Data, candidate: &Candidate, judged: &[Effect<f64>]) -> Result<(), String> {
    let plant = Plant { base: candidate.base, effects: &candidate.effects };
    if data.tracks.iter().any(|track| plant.sub_steps(track.ts) >= MAX_SUB_STEPS) {
        return Err("became faster than the recordings resolve".to_owned());
    }
    let sample_s = data.tracks.iter().map(|track| track.ts).fold(0.0, f64::max);
    let late = |role| matches!(role, Role::Delay | Role::TimeConstant);
    let brief = |effect: &Effect<f64>| {
        effect.kind.acts_in() == ActsIn::Drive
            && any(effect, late, |time_s| time_s < (LEAST_OF_A_SAMPLE * sample_s).max(data.unsure_s))
    };
    if candidate.effects.iter().any(brief) {
        return Err("became shorter than the recordings' time stamps tell".to_owned());
    }
    let (base, largest) = (candidate.base, data.problem().largest_base());
    if base.b >= largest.b || base.c >= largest.c || base.f1 >= largest.f1 {
        return Err("its inertia or friction became larger than any drive of the recordings moves".to_owned());
    }
    if judged.iter().any(|effect| effect.breakaway() > MOST_RISE * base.f1) {
        return Err("its friction at rest became many times that of sliding".to_owned());
    }
    let softest = candidate.base.f1 / stroke(data).min(LONGEST_STROKE * travel(data));
    let soft = |effect: &Effect<f64>| {
        let parameters = effect.kind.definition().parameters.iter().zip(&effect.p);
        effect.kind.bristles()
            && parameters.into_iter().any(|(parameter, value)| {
                matches!(parameter.search, Search::Grid(Scale::Presliding, _)) && *value < softest
            })
    };
    if judged.iter().any(soft) {
        return Err("its bristles became longer than the motion".to_owned());
    }
    let share = |role| role == Role::InertiaShare;
    if candidate.effects.iter().any(|effect| any(effect, share, |share| share < LEAST_BODY)) {
        return Err(format!("its body became lighter than {:.0} % of the inertia", 100.0 * LEAST_BODY));
    }
    let damping = |role| role == Role::DampingRatio;
    if candidate.effects.iter().any(|effect| any(effect, damping, |ratio| ratio > MOST_DAMPING)) {
        return Err("the second body does not oscillate: its damping ratio is too large for a coupling, and a backlash may be what is there".to_owned());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::{Base, Kind};

    use super::*;
    use crate::discover::data::FIT_SEGMENT_S;
    use crate::recording::Recording;

    /// An axis that moves by 2 rad, within a segment too. Bristles of .7 rad hardly let go on the way, and those of .6 rad do.
    /// Flexlink's motion was followed by bristles of 63 of 98 counts, which are a spring.
    #[test]
    fn bristles_let_go_within_a_third_of_the_travel() {
        let t: Vec<f64> = (0..4000).map(|k| 1e-3 * f64::from(k)).collect();
        let sine = |size: f64| t.iter().map(|t| size * (4.0 * std::f64::consts::PI * t).sin()).collect();
        let recording = Recording { u: sine(10.0), x: sine(1.0), t: t.clone(), ..Recording::default() };
        let data = Data::new(&[recording], &[], FIT_SEGMENT_S);
        let refusal = |stroke_rad: f64| {
            let bristle = Effect::new(Kind::Dahl, &[1.0 / stroke_rad]);
            let candidate = Candidate { base: Base { b: 0.02, c: 0.1, f1: 1.0 }, effects: vec![bristle] };
            resolved(&data, &candidate, &[bristle]).err()
        };
        assert_eq!(refusal(0.7).as_deref(), Some("its bristles became longer than the motion"));
        assert_eq!(refusal(0.6), None);
    }
}
