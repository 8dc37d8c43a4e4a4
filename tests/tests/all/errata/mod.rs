//! The evidence for the errata of the two documents (docs/theory.md, section 7).
//!
//! One test per erratum that has a number; each says what is printed and what is right. Errata 2, 3, 4, 5 (the listing
//! does not run) and 23 (a definition) have no number.

mod adaptive;
mod formulas;
mod listing;
mod memo_fit;
mod memo_relay;
mod paper_control;
mod paper_relay;
mod paper_units;

use breakaway::simulate::limit_cycle::{ExactCycle, exact_cycle};
use breakaway_core::plant::Base;
use breakaway_tests::papers::RelayExperiment;

/// The documents' plant Gp = 10/(s(0.2685s + 1)), f1 = 0.5, f2 = 0.01: b = 0.2685/10, c = 1/10 + 0.01.
const PLANT: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };

/// The exact limit cycle of the documents' plant.
fn cycle(h1: f64, h2: f64) -> ExactCycle {
    exact_cycle(PLANT, 0.0, h1, h2).expect("a limit cycle exists for h2 > f1")
}

/// An experiment as the documents' formulas take it.
const fn experiment(h1: f64, h2: f64, a: f64, omega: f64) -> RelayExperiment<f64> {
    RelayExperiment { h1, h2, a, omega }
}

/// The exact limit cycle's fundamental as an experiment.
fn exact_experiment(h1: f64, h2: f64) -> RelayExperiment<f64> {
    let cycle = cycle(h1, h2);
    experiment(h1, h2, cycle.fundamental, cycle.omega_rad_s)
}

/// What the describing function predicts for the documents' plant, as an experiment.
fn predicted_experiment(h1: f64, h2: f64) -> RelayExperiment<f64> {
    let found = breakaway_core::estimate::describing_function::predict(&PLANT, h1, h2).expect("a cycle is predicted");
    experiment(h1, h2, found.a, found.omega)
}
