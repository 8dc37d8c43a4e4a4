//! Terms that the windows and the motion alone make, whatever the model. They are made once for a form, and keep their
//! values in its windows.

use std::sync::OnceLock;

use super::super::term::Term;

/// Families of such terms. Each is made at its first use.
#[derive(Clone, Debug, Default)]
pub struct Made {
    /// Loads, springs, and friction over speed.
    pub motion: OnceLock<Vec<Term>>,
    /// An eccentric encoder.
    pub eccentricity: OnceLock<Vec<Term>>,
    /// Dahl and LuGre.
    pub bristles: OnceLock<Vec<Term>>,
    /// Second bodies.
    pub bodies: OnceLock<Vec<Term>>,
    /// How the drive arrives.
    pub arrivals: OnceLock<Vec<Term>>,
    /// A friction that warms up.
    pub drifts: OnceLock<Vec<Term>>,
    /// Decoys without the drive.
    pub decoys: OnceLock<Vec<Term>>,
}

/// A family of terms.
pub(super) fn once(family: &OnceLock<Vec<Term>>, make: impl FnOnce() -> Vec<Term>) -> Vec<Term> {
    family.get_or_init(make).clone()
}
