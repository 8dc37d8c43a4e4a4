//! Rivals, the table of the first round, the nearest effect, and the parameters that are listed.

use super::*;
use crate::discover::search::table::{nearest, parameters, rivals, table};
use crate::recording::Units;

/// The closest come first, five at most. The named effect and those without a fit are left out.
#[test]
fn rivals_are_the_closest_five() {
    let all = [
        tried(Kind::Spring, 0.10, 0.3),
        tried(Kind::Dahl, 0.30, 0.3),
        failed(Kind::LuGre),
        tried(Kind::Stiction, 0.27, 0.3),
        tried(Kind::Delay, 0.15, 0.3),
        tried(Kind::Stribeck, 0.20, 0.3),
        tried(Kind::DeadZone, 0.29, 0.3),
        tried(Kind::Backlash, 0.12, 0.3),
    ];
    let found = rivals(&round(&all), all[1].fit.as_ref().unwrap(), Kind::Dahl);
    let order: Vec<Kind> = found.iter().map(|rival| rival.kind).collect();
    assert_eq!(order, [Kind::DeadZone, Kind::Stiction, Kind::Stribeck, Kind::Delay, Kind::Backlash]);
    // Likelihoods of 4.8 and 14.4 behind: the first is tied.
    let tied: Vec<bool> = found.iter().map(|rival| rival.tied).collect();
    assert_eq!(tied, [true, false, false, false, false]);
    assert!((found[0].delta - 0.01).abs() < 1e-5, "{found:?}");
}

/// More parameters that gain less than .001 tie nothing, unless the two effects look alike. As many parameters are
/// tied, and so are more that gain.
#[test]
fn idle_parameters_are_no_rivals() {
    let tied = |named: Kind, other: Kind, gained: f64| {
        let all = [tried(named, 0.3, 0.3), tried(other, 0.3 + gained, 0.3)];
        let listed = rivals(&round(&all), all[0].fit.as_ref().unwrap(), named);
        let rival = listed[0].tied;
        // The table says the same.
        let fate = &table(&round(&all), Some(named), &listed)[1].fate;
        let wanted = if rival {
            "tied: these recordings cannot tell it from the named effect"
        } else {
            "does no better with more parameters"
        };
        assert_eq!(fate, wanted, "{named:?} {other:?} {gained}");
        rival
    };
    assert!(!tied(Kind::Dahl, Kind::Spring, 0.0005) && !tied(Kind::Dahl, Kind::Spring, -0.0005));
    assert!(tied(Kind::Dahl, Kind::Spring, 0.0015));
    assert!(tied(Kind::Dahl, Kind::Delay, -0.0005) && tied(Kind::Stribeck, Kind::Dahl, -0.0005));
    assert!(tied(Kind::Dahl, Kind::Backlash, 0.0005) && tied(Kind::Dahl, Kind::Backlash, -0.0005));
    assert!(!tied(Kind::Dahl, Kind::LuGre, 0.0005));
}

/// Every fate of a candidate. For two parameters 25 + 2·3.5 is asked.
#[test]
fn the_table_says_what_became_of_each() {
    let all = [
        tried(Kind::Dahl, 0.3, 0.3),
        failed(Kind::LuGre),
        tried(Kind::Spring, 31.0 / 460.0, 31.0 / 460.0),
        tried(Kind::Delay, 0.1, 0.2),
        tried(Kind::Stribeck, 0.1, 0.3),
    ];
    let rows = table(&round(&all), Some(Kind::Dahl), &[]);
    let fates: Vec<&str> = rows.iter().map(|row| row.fate.as_str()).collect();
    let wanted = [
        "named",
        "diverges",
        "its gain is not significant (asked: Δ ≥ 0.002, z ≥ 2, λ ≥ 32)",
        // Gains and wobbles differ by .2 and .1.
        "loses to the named effect by Δ 0.200, z 14.0",
    ];
    assert_eq!(fates[..4], wanted);
    assert!(rows[1].delta.is_nan() && rows[1].z.is_nan() && rows[1].lambda.is_nan());
    assert!(
        (rows[0].delta - 0.3).abs() < 1e-4 && (rows[0].z - 7.0).abs() < 1e-3 && (rows[0].lambda - 138.0).abs() < 0.1
    );
    assert!(fates[4].starts_with("does no better") && rows.iter().zip(&all).all(|(row, tried)| row.kind == tried.kind));
    let none = table(&round(&all), None, &[]);
    assert_eq!([0, 3].map(|i| none[i].fate.as_str()), ["not the best"; 2]);
    // A likelihood of 33 is evidence for the spring: two parameters are paid for, not five.
    let enough = [tried(Kind::Dahl, 0.3, 0.3), tried(Kind::Spring, 33.0 / 460.0, 33.0 / 460.0)];
    assert_eq!(table(&round(&enough), None, &[])[1].fate, "not the best");
}

/// The nearest is the simplest of those tied. It is given with its parameters, and with what does not bear it out.
#[test]
fn the_nearest_is_said_with_its_parameters() {
    let said = |all: &[Tried]| nearest(&round(all), &Units::default());
    // A z of 7·.1/.7: few segments show it.
    let alone = [failed(Kind::LuGre), tried(Kind::Stribeck, 0.1, 0.7)];
    assert_eq!(
        said(&alone).as_deref(),
        Some(
            "over segments of 0.4 s stribeck comes closest (s = 0.250 u, vs = 0.500 x/s; λ 34, z 1.0), and is not borne out by most segments"
        )
    );
    let tied = [tried(Kind::LuGre, 0.1, 0.1), tried(Kind::Spring, 0.05, 0.1), tried(Kind::Stribeck, 0.099, 0.1)];
    assert_eq!(
        said(&tied).as_deref(),
        Some(
            "over segments of 0.4 s stribeck comes closest (s = 0.250 u, vs = 0.500 x/s; λ 46, z 6.9; tied with it: lugre), and is not borne out by held-out data"
        )
    );
    // Two parameters: 25 + 7 are asked.
    assert!(said(&[tried(Kind::Stribeck, 31.0 / 460.0, 31.0 / 460.0)]).is_none());
    assert!(said(&[tried(Kind::Stribeck, 33.0 / 460.0, 33.0 / 460.0)]).is_some());
    assert!(said(&[failed(Kind::Stribeck)]).is_none());
}

/// Parameters without a default are listed, and others where they differ from it. A load beside the base has one
/// number.
#[test]
fn parameters_at_their_default_are_not_said() {
    let units = Units { u: "A".to_owned(), x: "rad".to_owned() };
    let symbols = |effect: Effect<f64>| -> Vec<(&str, String, f64)> {
        let model = fit(vec![Effect::new(Kind::ConstantLoad, &[0.1]), effect], 0.0, 0.0).candidate;
        parameters(&model, 1, None, &units).into_iter().map(|p| (p.symbol, p.unit, p.value)).collect()
    };
    let named = |all: &[(&'static str, &str, f64)]| {
        all.iter().map(|(symbol, unit, value)| (*symbol, (*unit).to_owned(), *value)).collect::<Vec<_>>()
    };
    assert_eq!(symbols(Effect::new(Kind::Stribeck, &[0.3, 0.5])), named(&[("s", "A", 0.3), ("vs", "rad/s", 0.5)]));
    assert_eq!(
        symbols(Effect::new(Kind::Stribeck, &[0.3, 0.5, 1.0])),
        named(&[("s", "A", 0.3), ("vs", "rad/s", 0.5), ("p", "1", 1.0)])
    );
}
