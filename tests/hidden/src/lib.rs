//! An independent plant with sealed truths, for blind tests of the discovery tool.
//!
//! Written from the effects table of the discovery specification alone; nothing here uses the
//! controller's or the host's simulators, so a mistake shared by those cannot hide in this one.
//! A [`Case`] (seed, effects, size) becomes a [`Session`] of recordings, which is all that the
//! tool may see, and a [`Truth`], which only the scorer opens.
//!
//! Units: drive in volts (force is expressed in drive units, as in `b·ẍ + c·ẋ + f1·sgn ẋ = u`),
//! position in radians, time in seconds.

mod draw;
mod drive;
mod effect;
mod experiment;
mod friction;
mod law;
mod measure;
mod plant;
mod session;
mod text;
mod truth;

pub use draw::{Base, Machine};
pub use effect::{CATALOGUE, Hidden, OUTSIDE, UnknownEffect};
pub use experiment::{Experiment, Role};
pub use session::{Case, Record, Session};
pub use text::write_session;
pub use truth::{EffectTruth, Truth, TruthRecord};

#[cfg(test)]
mod tests;
