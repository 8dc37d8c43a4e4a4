//! What an identification remarks beside its numbers.

use std::fmt;

use super::result::Value;

/// A remark, with the numbers that it is about. Its `Display` is the sentence that a person reads.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Remark {
    /// c holds two parameters that position data cannot split.
    BackEmfInDamping,
    /// c is two parameters, and the back-EMF is known.
    BackEmfApart {
        /// Back-EMF, in the units of c.
        back_emf: Value,
        /// What is left of c: viscous friction.
        viscous: Value,
    },
    /// Weak form and output error agree within their errors.
    EstimatorsAgree {
        /// b of output error over that of the weak form, less one, %.
        b_percent: f64,
    },
    /// They differ, and the simulation follows the recording down to its noise.
    WeakFormIsBiased,
    /// The simulation misses the recording by more than its noise: the base model misses something. A discovery replaces this
    /// remark by what it finds.
    ModelMisses {
        /// Simulation error over the noise.
        noises: f64,
        /// Whether weak form and output error differ by more than their errors, too.
        estimators_differ: bool,
    },
    /// Rows are so far apart that the drive between them is not known.
    DriveBetweenRows {
        /// Largest difference of a parameter between a held drive and a straight one, %.
        percent: f64,
    },
    /// An estimator of relay cycles gives nothing.
    Refused {
        /// Its name.
        estimator: &'static str,
        /// Why, and the experiment that would help.
        advice: &'static str,
    },
}

impl Remark {
    /// Its name in JSON.
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::BackEmfInDamping => "back_emf_in_damping",
            Self::BackEmfApart { .. } => "back_emf_apart",
            Self::EstimatorsAgree { .. } => "estimators_agree",
            Self::WeakFormIsBiased => "weak_form_is_biased",
            Self::ModelMisses { .. } => "model_misses",
            Self::DriveBetweenRows { .. } => "drive_between_rows",
            Self::Refused { .. } => "estimator_refused",
        }
    }
    /// Whether the remark says that the base model misses something.
    pub const fn is_of_a_gap(&self) -> bool {
        matches!(self, Self::ModelMisses { .. })
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::BackEmfInDamping => out.write_str(
                "c is back-EMF and viscous friction together (Ke + f2): they act alike, and position data cannot split them",
            ),
            Self::BackEmfApart { back_emf, viscous } => write!(
                out,
                "c is the back-EMF {:.4e} ± {:.1e} and the viscous friction {:.4e} ± {:.1e}",
                back_emf.value, back_emf.se, viscous.value, viscous.se
            ),
            Self::EstimatorsAgree { b_percent } => {
                write!(out, "weak_form and output_error agree within their errors; b differs by {b_percent:+.1} %")
            }
            Self::WeakFormIsBiased => out.write_str(
                "weak_form and output_error differ by more than their errors. The simulation follows the recording down to its \
                 noise, so the weak form is biased, by noise or by reversals within its windows",
            ),
            Self::ModelMisses { noises, estimators_differ } => {
                let also =
                    if estimators_differ { ", and weak_form and output_error differ by more than their errors" } else { "" };
                write!(
                    out,
                    "the simulation misses the recording by {noises:.1} times the noise{also}, so the model misses something; \
                     `breakaway discover` looks for it"
                )
            }
            Self::DriveBetweenRows { percent } => write!(
                out,
                "the drive between two rows is not recorded, and the rows are far apart. A drive that is held from row to row \
                 and one that is straight between rows give parameters that differ by up to {percent:.1} %; the standard errors \
                 contain that. Record as many rows per second as the controller has ticks"
            ),
            Self::Refused { estimator, advice } => write!(out, "{estimator}: {advice}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A discovery leaves out the one remark that it replaces, whatever its words are.
    #[test]
    fn one_remark_is_of_a_gap() {
        let remarks = [
            Remark::BackEmfInDamping,
            Remark::EstimatorsAgree { b_percent: 0.3 },
            Remark::WeakFormIsBiased,
            Remark::ModelMisses { noises: 3.0, estimators_differ: true },
            Remark::DriveBetweenRows { percent: 2.0 },
            Remark::Refused { estimator: "modulating", advice: "record for longer" },
        ];
        let of_a_gap: Vec<&Remark> = remarks.iter().filter(|remark| remark.is_of_a_gap()).collect();
        assert_eq!(of_a_gap, [&remarks[3]]);
        assert!(remarks[3].to_string().starts_with("the simulation misses the recording by 3.0 times the noise, and "));
    }
}
