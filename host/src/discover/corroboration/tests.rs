use super::super::by_force;
use super::super::judge::bar::tests::Axis;
use super::super::judge::ruling::rule;
use super::super::judge::settings::Settings;
use super::super::judge::term::Name;
use super::*;
use crate::recording::{Recording, Units};

/// Near the noise, better in open loop than before and than the curve, and less force left.
const TRUE_NAME: Corroboration = Corroboration {
    over_noise: [11.0, 3.0],
    open_loop: [6e-3, 3e-3],
    drive_free: 2e-2,
    force: Some([1.0, 0.9]),
    explained: None,
    untold: false,
};

#[test]
fn each_witness_may_object() {
    assert!(TRUE_NAME.holds(false));
    let drifts = Corroboration { open_loop: [6e-3, 6.2e-3], ..TRUE_NAME };
    let ignores_the_drive = Corroboration { drive_free: 2e-3, ..TRUE_NAME };
    for own in [drifts, ignores_the_drive] {
        assert!(!own.holds(false) && !own.holds(true), "{own:?}");
    }
    let more_force = Corroboration { force: Some([1.0, 1.03]), ..TRUE_NAME };
    assert!(!more_force.holds(false) && more_force.holds(true));
    assert!(Corroboration { force: None, ..TRUE_NAME }.holds(false));
}

/// Cogging beside a spring (hidden plant, unkind world, seed 8784, 30 %). Both witnesses give the two, and the fit that
/// begins with the parameters of the forces follows no motion.
#[test]
fn what_forces_and_motion_give_needs_no_third_witness() {
    let ruling = Ruling::naming(&[Kind::Spring, Kind::Cogging], [0.06, 40.0]);
    assert!(agree(&ruling, &[Kind::Cogging, Kind::Spring], &[]) && agree(&ruling, &[Kind::Spring], &[]));
    assert!(!agree(&ruling, &[Kind::Cogging, Kind::Delay], &[]));
    assert!(!agree(&ruling, &[Kind::Spring], &[Kind::Spring, Kind::Cogging]));
}

/// A coupling predicts best what the forces leave, and they do not name it: the sides disagree by .31 (hidden plant, unkind
/// world, seed 8849). The motion finds it too.
#[test]
fn what_the_forces_cannot_name_is_a_witness() {
    let mut ruling = Ruling::naming(&[], [0.06, 40.0]);
    assert!(!agree(&ruling, &[Kind::FlexibleCoupling], &[]));
    ruling.remainder.predictable = Some(Name::Effect(Kind::FlexibleCoupling));
    assert!(agree(&ruling, &[Kind::FlexibleCoupling], &[]));
    assert!(!agree(&ruling, &[Kind::FlexibleCoupling, Kind::Delay], &[]));
}

/// A ripple has a spring as a special case. Neither a dead zone nor a lag has what it took the place of.
#[test]
fn a_special_case_stays_at_the_noise() {
    let before = [Kind::Spring, Kind::PositionFriction];
    assert!(generalises(&[Kind::PositionFriction, Kind::Cogging], &before));
    assert!(!generalises(&[Kind::Cogging, Kind::PositionFriction, Kind::Spring], &before));
    assert!(!generalises(&[Kind::DeadZone, Kind::ElectricalLag], &[Kind::PwmDeadTime, Kind::Delay]));
}

/// Backlash, blind case 845 (10 %). The model is at the noise over .1 s, and no model follows its impacts for a
/// second.
#[test]
fn impacts_are_not_followed_for_a_second() {
    let at_the_noise = Corroboration {
        over_noise: [2.72, 1.01],
        open_loop: [1.28e-2, 5.37e-2],
        drive_free: 0.162,
        force: None,
        explained: None,
        untold: true,
    };
    assert!(at_the_noise.holds(false));
    assert!(!Corroboration { over_noise: [2.72, 1.3], ..at_the_noise }.holds(false));
    assert!(!Corroboration { drive_free: 5e-2, ..at_the_noise }.holds(false));
}

/// Far from the noise a name must halve the open-loop error and take a fifth of the force.
#[test]
fn far_from_the_noise_both_must_fall() {
    let far = Corroboration { over_noise: [85.0, 30.0], open_loop: [0.143, 0.048], drive_free: 0.059, ..TRUE_NAME };
    assert!(!far.holds(false));
    assert!(Corroboration { force: Some([0.125, 0.07]), ..far }.holds(false));
    assert!(!Corroboration { force: None, ..far }.holds(false));
    assert!(!Corroboration { open_loop: [0.093, 0.048], force: Some([0.125, 0.07]), ..far }.holds(false));
}

/// Stiction beside an eccentric encoder (hidden plant, unkind world, seed 3318). The windows show little of it.
#[test]
fn what_acts_in_less_than_a_window_must_halve_both_errors() {
    let stiction = Corroboration {
        over_noise: [65.5, 6.57],
        open_loop: [2.51e-2, 5.56e-3],
        drive_free: 0.158,
        force: Some([3.99e-3, 3.33e-3]),
        explained: None,
        untold: true,
    };
    assert!(stiction.holds(false));
    assert!(!Corroboration { untold: false, ..stiction }.holds(false));
    assert!(!Corroboration { over_noise: [65.5, 40.0], ..stiction }.holds(false));
    assert!(!Corroboration { open_loop: [2.51e-2, 1.5e-2], ..stiction }.holds(false));
    assert!(!Corroboration { force: Some([3.33e-3, 3.99e-3]), ..stiction }.holds(false));
}

/// A friction that drifts explains .01 of what cogging explains of the forces (ODrive, one row of two). Where cogging
/// explains nothing of them there is nothing to lose.
#[test]
fn what_the_forces_named_is_not_lost() {
    let believed = |explained: [f64; 2]| Corroboration { explained: Some(explained), ..TRUE_NAME }.believe(true, true);
    assert!(!believed([1.0, 0.01]) && believed([1.0, 0.6]) && believed([-0.1, -0.2]));
}

/// Names on which forces and motion agree need not close the gap. The model with them must follow better than a curve.
#[test]
fn agreement_does_not_replace_the_drive() {
    let far = Corroboration { over_noise: [85.0, 80.0], force: Some([1.0, 1.1]), ..TRUE_NAME };
    assert!(far.believe(true, false) && !far.believe(false, false));
    assert!(!Corroboration { drive_free: 2e-3, ..far }.believe(true, false));
}

/// An axis under a load. A delay explains nothing of its forces, and the load all that the forces named. Stiction is not
/// asked: it acts in less than a window.
#[test]
fn what_names_explain_of_the_forces() {
    let axis = Axis { f1: 0.1, drag: 0.0, load: 0.2, seed: 1 };
    let recordings: Vec<Recording> = (1..=2).map(|seed| Axis { seed, ..axis }.recording()).collect();
    let ruling = rule(&recordings, None, &Settings::default()).unwrap();
    let request = Request { recordings, ..Request::default() };
    let data = Data::new(&request.recordings, &[], FIT_SEGMENT_S);
    let (before, _) = by_force::found(&request, &Units::default(), &ruling, &|_| ()).unwrap();
    let share = |effect: Effect<f64>| {
        let small = Discovery { model: Candidate { effects: vec![effect], ..before.model.clone() }, ..before.clone() };
        explained(&request, &data, &ruling, &small).map(|[forces, names]| names / forces)
    };
    let load = share(Effect::new(Kind::ConstantLoad, &[-0.2])).unwrap();
    let delay = share(Effect::new(Kind::Delay, &[0.002])).unwrap();
    assert!((load - 1.0).abs() < 0.02 && delay < 0.1, "{load} {delay}");
    assert_eq!(share(Effect::new(Kind::Stiction, &[0.1])), None);
}
