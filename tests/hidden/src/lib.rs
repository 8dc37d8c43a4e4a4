//! An independent plant with sealed truths, for blind tests of the discovery tool.
//!
//! Written from the effects table of the discovery specification alone. Nothing here uses the controller's or the
//! host's simulators, so a mistake shared by those cannot hide in this one. A [`Case`] has a seed, effects and a size.
//! It becomes a [`Session`] of recordings, which is all that the tool may see. It also becomes a [`Truth`], which only
//! the scorer opens. The [`World`] around the plant is kind (exact clock, no random torque, one sample rate) unless a
//! [`Setting`] draws an unkind one.
//!
//! Units: drive in volts (force is expressed in drive units, as in `b·ẍ + c·ẋ + f1·sgn ẋ = u`),
//! position in radians, time in seconds.

mod break_away;
mod closed;
mod controller;
mod disturbance;
mod draw;
mod drive;
mod effect;
mod experiment;
mod friction;
mod law;
mod machine;
mod measure;
mod plan;
mod plant;
mod run;
mod sensor;
mod session;
mod size;
mod text;
mod truth;
mod world;

pub use effect::{CATALOGUE, DRAWN, Hidden, OUTSIDE, UnknownEffect, drawn};
pub use experiment::{Experiment, Role};
pub use machine::{Base, Machine};
pub use session::{Case, Record, Session};
pub use text::write_session;
pub use truth::{EffectTruth, Truth, TruthRecord};
pub use world::{Encoder, Item, Jitter, Sag, Setting, Torque, UnknownItem, World};

#[cfg(test)]
mod tests;
