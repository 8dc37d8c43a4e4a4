//! Discovery on data whose missing effect it does not know. These are the hidden plant (written from the
//! specification, not from this project's simulator) and recordings of real machines. The whole matrix is
//! `cargo xtask blind`; docs/blind.md has its table.
//!
//! Seeds from 901 on are not used for the table there. Of them the slow sines of 903 to 911 and the pair of 902 were
//! looked at while a rule was made (docs/blind-history.md).

use breakaway::discover::engine::discover;
use breakaway::discover::outcome::Verdict;
use breakaway::discover::request::{DiscoverError, Request};
use breakaway::fit::Candidate;
use breakaway::recording::{ReadOptions, Recording, Selection};
use breakaway_core::plant::Base;
use breakaway_hidden::{Case, Experiment, Role, Setting};
use breakaway_tests::blind::{recordings, run};
use breakaway_tests::measured_data;

/// The hidden effect is named, alone, and its main parameter is within 5 % (what was asked of the median over many cases).
fn named(effect: &str, seed: u64) {
    let (scored, _) = run(&Case::suite(seed, &[effect], 10.0).unwrap()).unwrap();
    assert!(scored.right(), "{scored:?}");
    assert!(scored.parameter_error.unwrap() < 0.05, "{scored:?}");
    assert!(scored.shrink < 0.7, "{scored:?}");
}

#[test]
fn cogging_is_named() {
    named("cogging", 901);
}

#[test]
fn delay_is_named() {
    named("delay", 901);
}

#[test]
fn asymmetric_viscous_is_named() {
    named("asymmetric_viscous", 902);
}

#[test]
fn constant_load_is_named() {
    named("constant_load", 902);
}

#[test]
fn dahl_is_named() {
    named("dahl", 903);
}

/// Both of two hidden effects, and nothing else; the machine is followed as well as by the true model (1.3 is asked).
fn both_named(effects: &[&str], seed: u64) {
    let (scored, _) = run(&Case::suite(seed, effects, 10.0).unwrap()).unwrap();
    assert!(scored.right(), "{scored:?}");
    assert!(scored.over_truth < 1.05, "{scored:?}");
}

/// Without the ripple an electrical lag does as well as the delay; with it nothing may be left of the lag.
#[test]
fn a_delay_and_a_ripple_in_time_are_named() {
    both_named(&["time_periodic", "delay"], 902);
}

/// Without the load the bristles become so long that they take its place.
#[test]
fn bristles_and_a_gravity_load_are_named() {
    both_named(&["dahl", "gravity_load"], 902);
}

/// Alone the change of inertia is right and worse on held-out data, which Stribeck friction spoils: one has to look one further. Here
/// and in the next three the seed is one on which the rule was made; before it, a wrong name was given each time.
#[test]
fn an_inertia_step_that_stribeck_friction_spoils_is_named_with_it() {
    both_named(&["stribeck", "inertia_step"], 752);
}

/// A dead zone does as well as the dead time, until the change of inertia is there.
#[test]
fn what_was_tied_is_tried_again_beside_the_second_effect() {
    both_named(&["pwm_dead_time", "inertia_step"], 751);
}

/// A ripple longer than the recording is a load, once the load's share in friction is there.
#[test]
fn a_ripple_without_end_is_a_load() {
    both_named(&["constant_load", "load_friction"], 752);
}

/// With starts of at most 0.6 of the Coulomb level this was called Stribeck friction.
#[test]
fn stiction_far_above_the_coulomb_level_is_named() {
    let (scored, _) = run(&Case::suite(753, &["stiction"], 30.0).unwrap()).unwrap();
    assert!(scored.right() && scored.parameter_error.unwrap() < 0.05, "{scored:?}");
}

/// A delay reads the drive's samples. Where it came after the dead zone in the model, the dead zone was passed over,
/// and a lag was named. On this seed and the next two the rules were made.
#[test]
fn a_delay_beside_a_dead_zone_is_named() {
    both_named(&["dead_zone", "delay"], 807);
}

/// What was dropped beside later effects (the dead zone) may be the law for which another (the dead time) stands.
#[test]
fn what_was_dropped_is_tried_in_the_place_of_what_took_its_share() {
    both_named(&["dead_zone", "gain_drift"], 807);
}

/// The lag alone does not hold on held-out data, the delay does; beside the change of inertia it is the other way round.
#[test]
fn what_was_refused_is_tried_again_beside_the_second_effect() {
    both_named(&["electrical_lag", "inertia_step"], 808);
}

/// The effect that gained most while two were missing was neither. Begun again with the effect that most segments
/// bear out, the model comes down to the noise. A dead time was named.
#[test]
fn a_model_that_leaves_much_is_begun_again() {
    both_named(&["load_friction", "dead_zone"], 831);
}

/// What gained most was a gap, which halved what was left and left 20 times the noise. A second body is doubted like any other law.
#[test]
fn a_gap_that_leaves_much_is_doubted() {
    both_named(&["saturation", "gain_drift"], 842);
}

/// A weak coupling, whose base leaves 1.01 times the noise. Begun otherwise the model comes down to the noise, too.
/// It does so by an effect that would be withdrawn for leaving most of the gap. That took the coupling's place, and
/// nothing was named.
#[test]
fn what_would_be_withdrawn_takes_no_place() {
    let (scored, _) = run(&Case::suite(876, &["flexible_coupling"], 1.0).unwrap()).unwrap();
    assert!(scored.right(), "{scored:?}");
}

/// A third of a millisecond, a third of a sample: what tells a lag from a delay happens within the sample.
#[test]
fn a_lag_shorter_than_a_sample_is_no_delay() {
    let (scored, _) = run(&Case::suite(834, &["electrical_lag"], 1.0).unwrap()).unwrap();
    assert!(scored.right() && scored.parameter_error.unwrap() < 0.05, "{scored:?}");
}

/// Among impacts the motion before a segment does not say where the load is. Sought all over the gap it is found, and
/// the gap with it. This was unknown: even the true parameters left 18 times the noise.
#[test]
fn a_backlash_of_a_third_of_the_motion_is_named() {
    let (scored, _) = run(&Case::suite(803, &["backlash"], 30.0).unwrap()).unwrap();
    assert!(scored.right() && scored.parameter_error.unwrap() < 0.05, "{scored:?}");
    // 23 times the truth's own before, 1.3 asked of the median over all effects; this one leaves 1.7, and a gap with
    // other impacts may leave some more.
    assert!(scored.over_truth < 5.0, "{scored:?}");
}

/// A weak coupling (1.7 times the noise, mostly absorbed by the base). In open loop the base's own drift is as large,
/// and it was refused for that.
#[test]
fn a_weak_coupling_is_named() {
    let (scored, _) = run(&Case::suite(805, &["flexible_coupling"], 10.0).unwrap()).unwrap();
    assert!(scored.right() && scored.over_truth < 1.01, "{scored:?}");
}

/// A light load on a stiff, lightly damped shaft. The well about its resonance is a few rad/s wide. With starts an
/// eighth apart it was missed (unknown). On these seeds, and the next two, the rule was made.
#[test]
fn a_resonance_between_the_starts_is_found() {
    for seed in [841, 844] {
        let (scored, _) = run(&Case::suite(seed, &["flexible_coupling"], 3.0).unwrap()).unwrap();
        assert!(scored.right() && scored.verdict == Verdict::Explained, "{scored:?}");
        assert!(scored.parameter_error.unwrap() < 0.05, "{scored:?}");
    }
}

/// Over .4 s no model follows the impacts, over .1 s the right gap does. It had to follow a whole second from there,
/// which no model can, and was refused. A strongly damped coupling was named.
#[test]
fn a_gap_is_asked_no_further_than_its_segments_allow() {
    let (scored, _) = run(&Case::suite(845, &["backlash"], 10.0).unwrap()).unwrap();
    assert!(scored.right(), "{scored:?}");
    assert!(scored.parameter_error.unwrap() < 0.05, "{scored:?}");
}

/// What a contact that yields leaves of one that does not looks late: a lag was named beside the gap.
#[test]
fn what_an_impact_leaves_is_no_lag() {
    let (scored, _) = run(&Case::suite(851, &["backlash"], 3.0).unwrap()).unwrap();
    assert!(scored.right(), "{scored:?}");
}

/// A slow sine over teeth: equation error makes the inertia negative (−.001 drive units per acceleration), though the sign of the drive
/// is right. That is no reason to refuse the recording.
#[test]
fn cogging_is_named_where_it_hides_the_inertia() {
    let (scored, _) = run(&Case::new(910, &["cogging"], 10.0, Experiment::SlowSine).unwrap()).unwrap();
    assert!(scored.right(), "{scored:?}");
}

/// Nothing is added to the model of a clean machine.
#[test]
fn clean_data_give_no_name() {
    for seed in [901, 902] {
        let (scored, _) = run(&Case::suite(seed, &[], 0.0).unwrap()).unwrap();
        assert!(scored.named.is_empty(), "{scored:?}");
    }
}

/// A force that the catalogue does not have is never "explained".
#[test]
fn an_effect_outside_the_catalogue_is_not_explained() {
    let (scored, _) = run(&Case::suite(901, &["force_well"], 10.0).unwrap()).unwrap();
    assert!(scored.verdict != Verdict::Explained && scored.verdict != Verdict::NothingMissing, "{scored:?}");
}

/// Random torque, held positions and a late sensor hide a backlash beside a drift of the gain (docs/blind-history.md, unkind
/// seed 3308). The forces name the drift, and the rest is random to them. The motion must not doubt the drift. Where it
/// ends its search without the backlash, the drift stays. The sensor is 7.0 ms late, which delays the loop. So a delay
/// may be named beside it, or a lag with which the delay is tied. Which of the two is first changed with a held-out error
/// that is 1.3 % lower (over the noise 9.53, then 9.41).
#[test]
fn the_motion_does_not_doubt_what_the_forces_decided() {
    let case = Case::suite(3308, &["gain_drift", "backlash"], 10.0).unwrap();
    let world = Setting::named("unkind").unwrap().draw(3308);
    assert!(world.sensor_delay_s > 6.9e-3, "{world:?}");
    let (scored, found) = run(&case.within(world)).unwrap();
    assert_eq!(found.effects[0].kind.name(), "gain_drift", "{scored:?}");
    let of_the_sensor =
        |name: &str, tied: &[&str]| name == "delay" || name == "electrical_lag" && tied.contains(&"delay");
    let mut all = scored.named.iter().zip(&scored.tied);
    assert!(all.all(|(name, tied)| scored.hidden.contains(name) || of_the_sensor(name, tied)), "{scored:?}");
}

/// The same request gives the same result, time taken aside.
#[test]
fn discovery_is_deterministic() {
    let case = Case::suite(904, &["time_periodic"], 10.0).unwrap();
    let (one, other) = (run(&case).unwrap().1, run(&case).unwrap().1);
    assert_eq!(
        (one.verdict, one.force, &one.effects, &one.ladder),
        (other.verdict, other.force, &other.effects, &other.ladder)
    );
    assert_eq!(one.model, other.model);
}

/// A model in other units says so instead of being fitted.
#[test]
fn a_model_in_other_units_is_refused() {
    let session = Case::suite(901, &[], 0.0).unwrap().generate();
    let request = Request {
        recordings: recordings(&session, Role::Fit),
        model: Some(Candidate { base: Base { b: 1e3, c: 1e3, f1: 0.5 }, effects: Vec::new() }),
        ..Request::default()
    };
    let refusal = discover(&request, &|_| ()).unwrap_err();
    assert!(matches!(refusal, DiscoverError::ModelUnits { .. }), "{refusal}");
    assert!(refusal.to_string().contains("units"));
}

fn measured(file: &str, input: &str, position: &str) -> Option<Recording> {
    rows_of(file, input, position, Vec::new())
}

fn rows_of(file: &str, input: &str, position: &str, select: Vec<Selection>) -> Option<Recording> {
    let options = ReadOptions {
        time: Some("t_s".into()),
        input: Some(input.into()),
        position: Some(position.into()),
        select,
        ..ReadOptions::default()
    };
    Some(Recording::read(&measured_data()?.join(file), &options).unwrap())
}

/// A slow sine over teeth, which move the axis more than the drive does. The base's inertia and friction grew
/// together without a bound. Beside that base only a second body (backlash here) gained anything. Within bounds the
/// teeth are found.
#[test]
fn teeth_are_named_where_they_move_more_than_the_drive() {
    let case = Case::new(909, &["cogging"], 10.0, Experiment::SlowSine).unwrap();
    let (scored, _) = run(&case).unwrap();
    assert!(scored.right() && scored.verdict == Verdict::Explained, "{scored:?}");
    assert!(scored.parameter_error.unwrap() < 0.05, "{scored:?}");
}

/// EMPS: the direction-asymmetric friction is named, and Stribeck, drag and delay are not. The open-loop error over 1 s on the
/// last third, which is not fitted, falls from 3.58 to 0.384 mm; the issue asks for 0.42 mm.
#[test]
fn emps_misses_asymmetric_friction() {
    let Some(recording) = measured("emps/emps_train.csv", "u_V", "x_m") else { return };
    let found = discover(&Request { recordings: vec![recording], ..Request::default() }, &|_| ()).unwrap();
    let names: Vec<&str> = found.effects.iter().map(|e| e.kind.name()).collect();
    assert!(names.contains(&"asymmetric_viscous"), "{names:?}");
    assert!(names.iter().all(|n| ["asymmetric_viscous", "constant_load", "cogging"].contains(n)), "{names:?}");
    // The ripple that is left repeats once in a turn of the motor: 50 000 counts of 50 nm, 2.5 mm. A tenth of a per cent is
    // half of what 62 turns of travel tell apart.
    if let Some(ripple) = found.effects.iter().find(|e| e.kind.name() == "cogging") {
        let turn = std::f64::consts::TAU / 2.5e-3;
        assert!((ripple.parameters[1].value / turn - 1.0).abs() < 1e-3, "{ripple:?}");
    }
    let (first, last) = (&found.ladder[0], &found.ladder[found.ladder.len() - 1]);
    assert!((3.0e-3..4.5e-3).contains(&first.holdout_open_loop_rmse), "{first:?}");
    assert!(last.holdout_open_loop_rmse < 0.42e-3, "{last:?}");
}

/// The motor with cogging, recorded at up to 150 rad/s with a jittered clock. A tooth passes within a sample in all
/// but the slow parts. The measured forces tell it there, with 72 waves in a turn and .183 A (the data's README). The
/// windows' attenuation leaves half of that uncertain to either side. Something else is left, so that it is not
/// explained.
#[test]
fn the_laas_motors_cogging_is_named() {
    let Some(recording) = measured("laas-motor/current-sine-2hz.csv", "iq_A", "x_rad") else { return };
    let found = discover(&Request { recordings: vec![recording], ..Request::default() }, &|_| ()).unwrap();
    assert!(matches!(found.verdict, Verdict::PartlyExplained), "{:?}", found.verdict);
    assert!(found.effects.iter().all(|effect| effect.kind.name() == "cogging"), "{:?}", found.effects);
    let [amplitude, waves, ..] = found.effects[0].parameters.as_slice() else { panic!("{:?}", found.effects) };
    assert!((waves.value - 72.0).abs() < 0.05 && (0.09..0.28).contains(&amplitude.value.abs()), "{:?}", found.effects);
}

/// The same motor with the compensated half of its run at constant speed. Cogging of 12 waves with a friction of 18 was named by the
/// simulated motion; if anything is named, it is the cogging.
#[test]
fn nothing_but_the_cogging_is_named_beside_a_constant_speed() {
    let compensated = Selection { column: "anticog_on".into(), value: "1".into() };
    let Some(dynamic) = measured("laas-motor/current-sine-2hz.csv", "iq_A", "x_rad") else { return };
    let constant = rows_of("laas-motor/speed-control.csv", "iq_A", "x_rad", vec![compensated]).unwrap();
    let recordings = vec![dynamic, constant];
    let found = discover(&Request { recordings, ..Request::default() }, &|_| ()).unwrap();
    assert!(found.effects.iter().all(|effect| effect.kind.name() == "cogging"), "{:?}", found.effects);
}
