//! From a command to what the controller in the tick needs.

use breakaway_core::link::{CommandError, Model, Settings, Track};

use crate::app::control::{Controller, NoController};

/// Makes plans for a [`Controller`].
pub trait Planner {
    /// As [`Controller::Plan`].
    type Plan: Clone;

    /// The plan for a checked command.
    ///
    /// # Errors
    /// What the host is told: a field out of range for this machine, a missing model, or that this build cannot do it.
    fn plan(
        &self,
        track: &Track,
        model: Option<&Model>,
        settings: &Settings,
        tick_hz: u32,
    ) -> Result<Self::Plan, CommandError>;
}

impl Planner for NoController {
    type Plan = <NoController as Controller>::Plan;

    fn plan(&self, _: &Track, _: Option<&Model>, _: &Settings, _: u32) -> Result<Self::Plan, CommandError> {
        Err(CommandError::Unsupported)
    }
}
