//! Random plants (docs/robustness.md): a part of the two hundred.

use breakaway_tests::robustness::{TrialResult, plants, try_plant};

/// Every fifth of the two hundred plants; the whole table is `cargo run --release -p breakaway-tests --example robustness`.
#[test]
fn random_plants_are_stable_still_and_survive_saturation() {
    let mut failed = Vec::new();
    for plant in plants(200).into_iter().step_by(5) {
        let outcome = try_plant(&plant);
        if outcome.verdict != TrialResult::Passed {
            failed.push((plant, outcome));
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}
