//! What a discovery is told, and why there is none.

use crate::fit::Candidate;
use crate::identify::estimate::IdentifyError;
use crate::recording::{Recording, Units};

use super::outcome::Provenance;

/// What a discovery is told.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// Recordings to fit, and to score where there is no `holdout`.
    pub recordings: Vec<Recording>,
    /// Recordings that are only scored.
    pub holdout: Vec<Recording>,
    /// Base model and effects known already; identified if absent.
    pub model: Option<Candidate>,
    /// Inputs, version, command.
    pub provenance: Provenance,
}

impl Request {
    /// The same request for other recordings. Its own are not copied, because an hour of rows is 86 MB.
    pub(super) fn of(&self, recordings: Vec<Recording>, holdout: Vec<Recording>) -> Self {
        Self { recordings, holdout, model: self.model.clone(), provenance: self.provenance.clone() }
    }
}

/// Why there is no discovery.
#[derive(Clone, Debug, PartialEq, thiserror::Error, serde::Serialize)]
#[serde(tag = "kind", content = "at", rename_all = "snake_case")]
pub enum DiscoverError {
    /// The base cannot be identified.
    #[error(transparent)]
    Identify(#[from] IdentifyError),
    /// Recordings of different units.
    #[error(
        "{first} is in {first_units} and {second} in {second_units}: recordings of one session need the same units"
    )]
    Units {
        /// A recording.
        first: String,
        /// Its units.
        first_units: String,
        /// Another.
        second: String,
        /// Its units.
        second_units: String,
    },
    /// The recordings are shorter than a segment.
    #[error("the recordings hold no segment of {0} s to fit and to score: record for longer")]
    TooShort(f64),
    /// The model cannot be of these recordings.
    #[error(
        "the model cannot simulate these recordings: its inertia b = {model:.3e} is {factor:.0} times off the recordings' \
         {data:.3e}. Check the units of drive and position"
    )]
    ModelUnits {
        /// b of the model.
        model: f64,
        /// b of the data.
        data: f64,
        /// Their ratio, ≥ 1.
        factor: f64,
    },
    /// The base cannot be simulated.
    #[error("the base model cannot be fitted by simulation: {0}")]
    Base(String),
}

/// The units of all recordings.
///
/// # Errors
/// [`DiscoverError::Units`] where they are not the same.
pub(super) fn same_units(request: &Request) -> Result<Units, DiscoverError> {
    let mut all = request.recordings.iter().chain(&request.holdout);
    let Some(first) = all.next() else { return Err(IdentifyError::Nothing.into()) };
    let show = |u: &Units| format!("{} and {}", u.u, u.x);
    match all.find(|r| r.units != first.units) {
        Some(other) => Err(DiscoverError::Units {
            first: first.name.clone(),
            first_units: show(&first.units),
            second: other.name.clone(),
            second_units: show(&other.units),
        }),
        None => Ok(first.units.clone()),
    }
}
