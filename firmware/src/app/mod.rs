//! The application: the same on every board, on the virtual board and in unit tests.
//!
//! # Glossary
//! - **tick**: one pass of the control loop, from reading the encoder to queueing the sample ([`Tick::tick`]), in the
//!   timer's interrupt. **Thread**: everything else ([`App::poll`]): link, estimation's solve, flash.
//! - **order**: what the thread asks of the tick; **event**: what the tick tells the thread ([`Channels`]).
//! - **run**: a stretch of driven motion (a relay experiment, a track), from its order to its ending.
//! - **limit**: what a run may use; reaching one cuts the drive or ends the run, and is not a fault.
//! - **fault**: something is broken; the drive is off until a command clears it.
//!
//! Tick and thread share nothing but single-producer queues and one flag, so no lock is ever taken. Messages, modes,
//! samples, settings and faults are those of [`breakaway_core::link`].

mod accumulate;
mod channels;
mod control;
mod current;
mod excite;
mod follow;
mod guard;
mod memory;
mod run;
mod set_points;
mod thread;
mod tick;
mod track;

pub use accumulate::{Accumulation, SineConfig, Sums};
pub use channels::{AppEnd, Channels, Order, RunRequest, SAMPLE_QUEUE, TickEnd, TickEvent};
pub use control::{ControlPlan, NoController, PositionController};
pub use current::CurrentPlan;
pub use excite::Excitation;
pub use follow::{FollowRules, Knot};
pub use guard::Guards;
pub use memory::remember_panic;
pub use run::{RunLimits, RunOrder};
pub use set_points::{SetPointInlet, SetPointOutlet};
pub use thread::{App, Experiment, Identification, Identity, Planner, PowerStage, Wish, guards};
pub use tick::{Tick, TickSettings};
pub use track::{Path, TrackController, TrackPlan};
