//! Control of the axis along a reference. It has trajectories, the PID and its tuning, the feed-forward compensator,
//! the adaptive law, and the watch over the model's validity (docs/theory.md, section 6).
//!
//! Configuration is apart from state: a configuration is built once, in f64, with its checks, and the tick only reads
//! it. A state is plain data. Everything in the tick is generic over [`Fast`] (f32, f64, Q32) and divides by nothing
//! that depends on data. In f32 it calls no libm, with two exceptions. They are a Stribeck exponent other than 2, and
//! the one square root at the end of a calibration.
//!
//! ```
//! use breakaway_core::control::{Controller, ControllerState, Pid, Sine, Trajectory, tune};
//!
//! // The papers' plant, 10 Hz of bandwidth at a tick of 1 ms with one tick of delay.
//! let gains = tune(0.02685, 0.11, 10.0, 1e-3, 1)?;
//! let controller = Controller::pid(Pid::<f32>::new(&gains, 1e-3, 12.0)?);
//! let mut state = ControllerState::start(&controller);
//! let reference = Trajectory::Sine(Sine::<f32>::new(1.0, 0.5, 1e-3).unwrap());
//! let command = controller.tick(&mut state, reference.at(0), 0.0).unwrap();
//! assert!(!command.saturated);
//! # Ok::<(), breakaway_core::control::TuningError>(())
//! ```

mod adaptive;
mod compensator;
mod controller;
mod current;
mod drift;
mod fast;
mod margins;
mod pid;
mod rate;
mod term;
mod trajectory;
mod tuning;

pub use adaptive::{Adaptation, Adaptive, AdaptiveError, AdaptiveState, Estimates, Ideal, least_delta};
pub use compensator::{Compensator, CompensatorError, Feed, lead_s};
pub use controller::{ControlLaw, Controller, ControllerState, LimitedDrive};
pub use current::{CurrentLoop, CurrentLoopError, CurrentLoopState, Winding};
pub use drift::{BINS, Direction, DriftError, DriftSettings, DriftState, DriftWatch, ModelMismatch, Motion};
pub use fast::Fast;
pub use margins::{Margins, margins};
pub use pid::{Pid, PidState};
pub use trajectory::{Cubic, CubicRange, Phases, Profile, Samples, Setpoint, Sine, Trajectory, TrajectoryError};
pub use tuning::{
    Gains, Resolution, TuningError, encoder_bandwidth_hz, largest_bandwidth_hz, largest_rate, tune, tune_behind,
};
