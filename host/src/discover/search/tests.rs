//! What is named, preferred, tied and listed. The fits are made up, so that every number is known.

use breakaway_core::plant::{Base, Effect, Kind};

use super::add::{Round, Tried};
use super::compare::{as_good, better, names};
use super::contest::confusable;
use crate::discover::data::Data;
use crate::discover::decide::{Paired, paired};
use crate::fit::{Candidate, Fit, Free};

const SEGMENTS: usize = 50;
/// Effective samples of a segment.
const SAMPLES: f64 = 20.0;
/// Logarithm of the current model's mean square and the noise's, over the noise's.
const CURRENT: f64 = 10.0;

fn data() -> Data {
    Data {
        tracks: [].into(),
        fit: Vec::new(),
        score: Vec::new(),
        open_loop: Vec::new(),
        ahead: Vec::new(),
        segment_s: 0.4,
        sigma: 1.0,
        available: SEGMENTS,
        unsure_s: 0.0,
        softening: 0.0,
        work: std::sync::Arc::default(),
    }
}

/// A fit that gains `gain` over the current model in the mean of the logarithm. Segments gain `wobble` more and less
/// than that, in turns. Two fits whose gains differ by g, and wobbles by w > 0, compare with a z of 7·g/w. Without the
/// two best of the fifty segments their likelihood ratio is 10·(48·g − 2·w).
fn fit(effects: Vec<Effect<f64>>, gain: f64, wobble: f64) -> Fit {
    let square = |i: usize| (CURRENT - gain - if i.is_multiple_of(2) { wobble } else { -wobble }).exp() - 1.0;
    Fit {
        free: Free::all(&effects),
        candidate: Candidate { base: Base { b: 1.0, c: 1.0, f1: 1.0 }, effects },
        floor: 1.0,
        mse: (0..SEGMENTS).map(square).collect(),
        samples: vec![SAMPLES; SEGMENTS],
        initial: Vec::new(),
        cost: -gain,
        converged: true,
    }
}

fn current() -> Fit {
    fit(Vec::new(), 0.0, 0.0)
}

const PARAMETERS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// An effect with a value for every parameter that has no default.
fn effect(kind: Kind) -> Effect<f64> {
    let needed = kind.definition().parameters.iter().filter(|p| p.default.is_none()).count();
    Effect::new(kind, &PARAMETERS[..needed])
}

fn tried(kind: Kind, gain: f64, wobble: f64) -> Tried {
    Tried { kind, fit: Ok(fit(vec![effect(kind)], gain, wobble)) }
}

fn failed(kind: Kind) -> Tried {
    Tried { kind, fit: Err("diverges".to_owned()) }
}

fn round(tried: &[Tried]) -> Round {
    Round { data: data(), without: current(), tried: tried.to_vec() }
}

fn kinds(tried: &[Tried]) -> Vec<Kind> {
    let round = round(tried);
    round.preference().iter().map(|i| tried[*i].kind).collect()
}

/// The numbers that the other tests use.
#[test]
fn the_made_up_fits_compare_as_said() {
    let p = paired(&current().mse, &fit(Vec::new(), 0.2, 0.4).mse, &[SAMPLES; SEGMENTS], 1.0);
    let found = [p.delta, p.z, p.lambda];
    assert!(found.iter().zip([0.2, 3.5, 88.0]).all(|(found, wanted)| (found - wanted).abs() < 1e-3), "{p:?}");
    let free = |kind| fit(vec![effect(kind)], 0.0, 0.0).free.len() - 3;
    let parameters = [Kind::Dahl, Kind::Stribeck, Kind::Cogging, Kind::LuGre].map(free);
    assert_eq!(parameters, [1, 2, 3, 4]);
}

/// Two parameters cost 7 nats. A likelihood of 25 + 7 is asked: 31 is too little, and 33 is enough.
#[test]
fn evidence_pays_for_its_parameters() {
    let evidence = |gain| names(&data(), &current(), &fit(vec![effect(Kind::Stribeck)], gain, gain));
    assert!(!evidence(31.0 / 460.0));
    assert!(evidence(33.0 / 460.0));
    assert!(kinds(&[failed(Kind::Stribeck)]).is_empty());
}

/// Past z = 2.5 and λ = 8, and 3.5 for every parameter more; or beyond doubt.
#[test]
fn better_is_by_most_segments_or_beyond_doubt() {
    let better = |z, lambda, extra| better(&Paired { delta: 0.1, z, lambda }, extra);
    assert!(better(2.6, 8.1, 0) && !better(2.6, 8.0, 0) && !better(2.5, 8.1, 0) && !better(2.4, 50.0, 0));
    assert!(better(2.6, 15.1, 2) && !better(2.6, 15.0, 2) && !better(2.6, 1.0, 0));
    assert!(better(1.3, 107.1, 2) && !better(1.3, 107.0, 2) && !better(1.2, 107.1, 2));
}

/// A second body's start is free in every segment. So it comes after a law that is tied with it, with more parameters
/// or fewer. It also comes after a law that is behind by less than a nat for each of the fifty segments. Two bodies
/// compare as other laws do.
#[test]
fn a_second_body_is_not_preferred_where_another_law_does_as_well() {
    let first = |all: &[Tried]| kinds(all)[0];
    let body = || tried(Kind::Backlash, 0.300, 0.3);
    assert_eq!(first(&[body(), tried(Kind::LuGre, 0.295, 0.2)]), Kind::LuGre);
    assert_eq!(first(&[body(), tried(Kind::Dahl, 0.295, 0.2)]), Kind::Dahl);
    // Behind in every segment alike, by 43 and 53 nats.
    assert_eq!(first(&[body(), tried(Kind::LuGre, 0.210, 0.3)]), Kind::LuGre);
    assert_eq!(first(&[body(), tried(Kind::LuGre, 0.190, 0.3)]), Kind::Backlash);
    assert_eq!(first(&[body(), tried(Kind::FlexibleCoupling, 0.210, 0.3)]), Kind::Backlash);
}

/// The simplest of those tied with the best comes first. The others keep the order of their costs. Effects without
/// evidence are left out, and four are considered at most.
#[test]
fn the_simplest_of_those_tied_is_preferred() {
    let all = [
        tried(Kind::LuGre, 0.300, 0.3),
        failed(Kind::Backlash),
        // It is behind by a z of .35, with two parameters less. The next are behind by likelihoods of 96 and more.
        tried(Kind::Stribeck, 0.295, 0.2),
        tried(Kind::QuadraticDrag, 0.100, 0.3),
        tried(Kind::ConstantLoad, 0.001, 0.3),
        tried(Kind::Dahl, 0.090, 0.3),
        tried(Kind::Spring, 0.085, 0.3),
    ];
    assert_eq!(kinds(&all), [Kind::Stribeck, Kind::LuGre, Kind::QuadraticDrag, Kind::Dahl]);
    assert_eq!(kinds(&all[3..5]), [Kind::QuadraticDrag]);
    assert!(kinds(&all[4..5]).is_empty());
}

/// A law with fewer parameters may be worse by their price. Three of them are worth 10.5 nats beside the 8 of a better
/// model. So a likelihood of 14 behind is as good, and one of 24 is not. Without fewer parameters 14 is too much.
#[test]
fn fewer_parameters_may_be_worse_by_their_price() {
    let first = |gain, kind| {
        let all = [tried(Kind::LuGre, 0.3, 0.3), tried(kind, gain, 0.3)];
        kinds(&all)[0]
    };
    assert_eq!(first(0.3 - 14.0 / 480.0, Kind::Dahl), Kind::Dahl);
    assert_eq!(first(0.3 - 24.0 / 480.0, Kind::Dahl), Kind::LuGre);
    let equal = |behind: f64| as_good(&data(), &fit(vec![], 0.3 - behind / 480.0, 0.3), &fit(vec![], 0.3, 0.3));
    assert!(equal(7.0) && !equal(14.0));
}

/// Beside the preferred model the beam keeps the one that most segments bear out, whatever its likelihood. It is no
/// second body.
#[test]
fn the_second_of_the_beam_has_the_greatest_z() {
    let all = [
        tried(Kind::LuGre, 0.30, 0.6),
        tried(Kind::Backlash, 0.28, 0.1),
        tried(Kind::Spring, 0.20, 0.3),
        tried(Kind::Delay, 0.15, 0.1),
        tried(Kind::Dahl, 0.001, 0.0001),
    ];
    let second = |named| round(&all).second(named).map(|i| all[i].kind);
    assert_eq!(second(Kind::LuGre), Some(Kind::Delay));
    assert_eq!(second(Kind::Delay), Some(Kind::Spring));
    assert_eq!(round(&all[4..]).second(Kind::LuGre), None);
}

/// A law gives its place to what it may be confused with, in either direction. Special cases count, also in either
/// direction. At the noise it gives none to a law that would only fit the noise.
#[test]
fn what_may_be_confused_is_swapped() {
    assert_eq!(confusable(Kind::Delay, true), [Kind::ElectricalLag]);
    assert_eq!(confusable(Kind::Stribeck, true), [Kind::QuadraticDrag, Kind::Stiction]);
    assert!(confusable(Kind::Stribeck, false).contains(&Kind::LuGre));
    assert!(confusable(Kind::Dahl, false).contains(&Kind::Backlash));
    assert!(!confusable(Kind::Dahl, true).contains(&Kind::Backlash));
    assert!(confusable(Kind::Backlash, true).contains(&Kind::FlexibleCoupling));
    assert!(confusable(Kind::Cogging, true).contains(&Kind::ConstantLoad));
    assert!(!confusable(Kind::ConstantLoad, true).contains(&Kind::Cogging));
}

/// A law resembles another that it may be confused with, unless the other has it as a special case.
#[test]
fn what_resembles_is_confused_and_not_more_general() {
    assert!(Kind::Cogging.resembles(Kind::TimePeriodic) && Kind::LuGre.resembles(Kind::Dahl));
    assert!(!Kind::Dahl.resembles(Kind::LuGre) && !Kind::GravityLoad.resembles(Kind::Cogging));
    assert!(!Kind::Dahl.resembles(Kind::Spring) && !Kind::ConstantLoad.resembles(Kind::LuGre));
}

mod said;
