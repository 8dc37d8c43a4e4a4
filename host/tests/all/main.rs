//! The library and the `breakaway` command from outside, in one program: each further one would link the host anew.

mod axis_commands;
mod command;
mod control_commands;
mod decide;
mod device;
mod effects;
mod fleet;
mod identify_data;
mod measured;
mod messages;
mod model;
mod recording;
mod recording_clocks;
mod recording_errors;
mod report;
mod support;
mod walk;
