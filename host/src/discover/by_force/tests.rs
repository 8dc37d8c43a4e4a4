use breakaway_core::plant::{Base, Effect, Kind};

use super::super::judge::bar::tests::Axis;
use super::super::judge::ruling::rule_within;
use super::super::model::Model;
use super::super::outcome::Verdict;
use super::simulated::ITERATIONS;
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
    let heavy = |ruling: &Ruling| Ruling { base: Base { b: 10.0 * ruling.base.b, ..ruling.base }, ..ruling.clone() };
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
