//! Which estimator is reported and why, in sentences.

use super::text::number;
use crate::identify::estimate::{Choice, Comparison, Reason};

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

/// By how much the first model's error is larger, per cent.
fn larger(comparison: &Comparison) -> String {
    number(100.0 * (comparison.ratio() - 1.0), 2)
}

fn blocks(comparison: &Comparison) -> String {
    format!("{} blocks, t = {}", comparison.blocks, number(comparison.t(), 2))
}
