//! Identification on recordings of real machines (issue 2, item 5; nothing is committed, see [`measured_data`]).

use std::path::Path;

use breakaway::identify::estimate::{Identification, Remark, identify};
use breakaway::recording::{ReadOptions, Recording};
use breakaway_tests::measured_data;

fn identified(data: &Path, file: &str, [time, input, position]: [&str; 3]) -> Identification {
    let options = ReadOptions {
        time: Some(time.to_owned()),
        input: Some(input.to_owned()),
        position: Some(position.to_owned()),
        ..ReadOptions::default()
    };
    identify(&[Recording::read(&data.join(file), &options).unwrap()]).unwrap()
}

/// Newtons per volt of the EMPS drive.
const EMPS_GAIN: f64 = 35.15065;

/// EMPS against the published inverse model with constant offset (Janot, Gautier, Brunot 2019): M 95.1089 kg,
/// Fv 203.5034 N·s/m, Fc 20.3935 N, offset −3.1648 N. Tolerances are the issue's; measured here: b −0.3 %, c +1.5 %,
/// f1 −0.9 %, load +0.1 %.
#[test]
fn emps_gives_the_published_parameters_and_a_significant_load() {
    let Some(data) = measured_data() else { return };
    let found = identified(&data, "emps/emps_train.csv", ["t_s", "u_V", "x_m"]);
    let load = found.load.expect("the load is significant");
    for (name, value, published, tolerance) in [
        ("inertia", found.best.b, 95.1089, 0.01),
        ("viscous", found.best.c, 203.5034, 0.03),
        ("Coulomb", found.best.f1, 20.3935, 0.03),
        ("load", load, -3.1648, 0.05),
    ] {
        let relative = value.value * EMPS_GAIN / published - 1.0;
        println!("{name}: {:.3} ± {:.3}, {:+.2} %", value.value * EMPS_GAIN, value.se * EMPS_GAIN, 100.0 * relative);
        assert!(relative.abs() < tolerance, "{name}: {value:?}");
    }
    assert!(found.undetermined.is_empty(), "{:?}", found.undetermined);
    // Direction-dependent viscous friction is in this machine (README of the data); the base cannot reach the noise.
    assert!(!found.white);
}

/// LAAS: a clock with 0.2 to 7 ms between rows. The inertia lies between the limits by both estimators. Both
/// are shown, and a remark compares them. The residual is not white, because cogging is missing.
#[test]
fn laas_copes_with_jitter_shows_both_estimators_and_says_that_something_is_missing() {
    let Some(data) = measured_data() else { return };
    let found = identified(&data, "laas-motor/current-sine-2hz.csv", ["t_s", "iq_A", "x_rad"]);
    assert_eq!(found.estimates.iter().map(|e| e.estimator).collect::<Vec<_>>(), ["weak_form", "output_error"]);
    for estimate in &found.estimates {
        println!("{}: b {:.4e} ± {:.1e}", estimate.estimator, estimate.b.value, estimate.b.se);
        assert!((1.8e-4..2.5e-4).contains(&estimate.b.value), "{estimate:?}");
    }
    assert!(!found.white);
    let misses = found.remarks.iter().find(|remark| remark.is_of_a_gap());
    let compared = match misses {
        Some(Remark::ModelMisses { estimators_differ: true, .. }) => true,
        _ => found.remarks.iter().any(|remark| matches!(remark, Remark::EstimatorsAgree { .. })),
    };
    assert!(misses.is_some() && compared, "{:?}", found.remarks);
}
