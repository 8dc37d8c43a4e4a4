use super::super::bar::tests::Axis;
use super::*;

/// A drag is slow. The steps of the reading make noise in the acceleration, up to 15 % in the narrowest windows. In
/// wider ones they make less, so that the drag is more evident.
#[test]
fn a_slow_effect_is_judged_in_wide_windows() {
    let mut recording = Axis { f1: 0.1, drag: 0.01, load: 0.0, seed: 1 }.recording();
    recording.x.iter_mut().for_each(|x| *x = (*x / STEP).round() * STEP);
    let settings = Settings::default();
    let ruling = rule(std::slice::from_ref(&recording), None, &settings).unwrap();
    assert_eq!(ruling.findings[0].effect.kind, Kind::QuadraticDrag);
    let narrowest = narrowest(&Dataset::new(&[recording], &settings), &settings).unwrap();
    assert!(ruling.half_width_s > narrowest, "{} {narrowest}", ruling.half_width_s);
}

/// Step of the reading, rad.
const STEP: f64 = 2e-4;

/// The motion is asked for effects that are seen, and for those that nearly hold.
#[test]
fn the_forces_speak_for_what_nearly_holds() {
    let own = |kind, z| Candidacy { kind, gain: 0.01, z, rejection: Some(Rejection::Gain) };
    let ruling = Ruling {
        seen: vec![Finding::of(Kind::Cogging)],
        left: vec![own(Kind::Delay, 3.1), own(Kind::Spring, 2.9)],
        ..Ruling::naming(&[Kind::ConstantLoad], [0.05, 9.0])
    };
    let supported = [Kind::Cogging, Kind::Delay, Kind::Spring].map(|kind| ruling.supports(kind));
    assert_eq!(supported, [true, true, false]);
}

/// Names that repeat over position are kept apart from the others, where there are both.
#[test]
fn what_repeats_over_position_is_told_apart() {
    let repeating = |kinds: &[Kind]| {
        let own = Ruling::naming(kinds, [0.05, 9.0]).repeating()?;
        Some(own.findings.iter().map(|finding| finding.effect.kind).collect::<Vec<_>>())
    };
    assert_eq!(repeating(&[Kind::Delay, Kind::Cogging]), Some(vec![Kind::Cogging]));
    assert_eq!([repeating(&[Kind::Cogging]), repeating(&[Kind::Delay, Kind::Spring])], [None, None]);
}

/// A small finding is seen with its share. The others stay, and so does what was seen.
#[test]
fn small_findings_may_be_seen_only() {
    let mut ruling = Ruling::naming(&[Kind::GravityLoad, Kind::Delay], [0.05, 9.0]);
    assert!(ruling.without_small().is_none());
    ruling.findings[1].small_share = Some(0.03);
    ruling.seen = vec![Finding::of(Kind::Cogging)];
    let less = ruling.without_small().unwrap();
    let kinds = |own: &[Finding]| own.iter().map(|own| own.effect.kind).collect::<Vec<_>>();
    assert_eq!(kinds(&less.findings), [Kind::GravityLoad]);
    assert_eq!(kinds(&less.seen), [Kind::Cogging, Kind::Delay]);
    assert_eq!(less.seen[1].small_share, Some(0.03));
    let [more] = &ruling.with_each_seen()[..] else { panic!() };
    assert_eq!(kinds(&more.findings), [Kind::GravityLoad, Kind::Delay, Kind::Cogging]);
    assert!(more.seen.is_empty() && more.with_each_seen().is_empty());
}

/// A curve over velocity has a z of 5.8 in what a motor's base leaves (LAAS, five rows held).
#[test]
fn something_is_missing_where_a_term_is_significant() {
    let of = |significance: f64| {
        let mut ruling = Ruling::naming(&[], [0.02, 30.0]);
        ruling.remainder.significance = significance;
        ruling.tells_nothing_is_missing()
    };
    assert_eq!([of(3.9), of(5.8)], [true, false]);
}

/// The forces named a saturation of LAAS's motor, of which the motion knows nothing (steps 16 times as large). The names
/// go, and it is not said that nothing is missing.
#[test]
fn names_that_are_taken_back_are_still_significant() {
    let [none, named] = [&[][..], &[Kind::Saturation]].map(|kinds| Ruling::naming(kinds, [0.03, 7.7]));
    let said = [none, named].map(|ruling| ruling.naming_nothing().tells_nothing_is_missing());
    assert_eq!(said, [true, false]);
}

/// Four seconds hold sixteen blocks. Where there are fewer, an effect that is there may have no z of a name.
#[test]
fn few_blocks_tell_of_nothing() {
    let of = |blocks: usize| Ruling { blocks, ..Ruling::naming(&[], [0.05, 9.0]) };
    assert_eq!([15, 16].map(|blocks| of(blocks).tells_nothing_is_missing()), [false, true]);
    assert!(of(4).leaves_nothing());
}

/// What repeats with the drive is predictable, whatever it is, from 2 % of the drive and a z of 4 on. LAAS's motor left 3.3 %
/// with a z of 8.2 where one row of five was kept.
#[test]
fn something_is_missing_where_what_is_left_repeats() {
    let of = |share: f64, z: f64| {
        let mut ruling = Ruling::naming(&[], [0.05, 9.0]);
        ruling.remainder.repetition = Some(Repetition { share, z });
        [ruling.leaves_something_predictable(), ruling.tells_nothing_is_missing()]
    };
    assert_eq!(of(0.033, 8.2), [true, false]);
    assert_eq!([of(0.019, 8.2), of(0.033, 3.9)], [[false, true]; 2]);
}
