//! Which estimator is reported and why, and whether gravity would help: in sentences.

use super::text::number;
use crate::identify::estimate::{Choice, Comparison, GravityTrial, Reason};

/// The estimator's name and the reason for it.
pub fn choice(choice: &Choice) -> String {
    let name = choice.estimator;
    let otherwise = |white: bool| {
        if white {
            "The simulation follows the recordings down to their noise, and output_error is the more precise then"
        } else {
            "The simulation does not follow the recordings down to their noise, and weak_form is reported then"
        }
    };
    match choice.reason {
        Reason::Predicts(held_out) => format!(
            "{name}, because it predicts held-out blocks better: the other estimator's error is {} % larger ({})",
            larger(&held_out),
            blocks(&held_out)
        ),
        Reason::Tied { comparison, white } => format!(
            "{name}. Held-out blocks do not tell it from the other estimator ({}). {}",
            blocks(&comparison),
            otherwise(white)
        ),
        Reason::Short { white } => {
            format!("{name}. The recordings are too short to hold blocks out. {}", otherwise(white))
        }
        Reason::Only => format!("{name}, because the other estimator gives no axis"),
    }
}

/// What adding gravity does to the prediction, and how to go on.
pub fn gravity(trial: &GravityTrial) -> String {
    let GravityTrial { travel_rad, comparison } = trial;
    let travel = number(*travel_rad, 2);
    if trial.helps() {
        format!(
            "gravity lowers the error of held-out prediction by {} % ({}); the motion covers {travel} rad. Go on with `breakaway \
             discover`, with the same recordings and columns",
            number(100.0 * (1.0 - 1.0 / comparison.ratio()), 2),
            blocks(comparison)
        )
    } else {
        format!(
            "gravity was tried, since the motion covers {travel} rad of an angle: it does not lower the error of held-out \
             prediction ({})",
            blocks(comparison)
        )
    }
}

/// By how much the first model's error is larger, per cent.
fn larger(comparison: &Comparison) -> String {
    number(100.0 * (comparison.ratio() - 1.0), 2)
}

fn blocks(comparison: &Comparison) -> String {
    format!("{} blocks, t = {}", comparison.blocks, number(comparison.t(), 2))
}
