//! The library and the `breakaway` command from outside, in one program: each further one would link the host anew.

mod axis_commands;
mod command;
mod control_commands;
mod decide;
mod device;
mod effects;
mod fleet;
mod identify_choice;
mod identify_data;
mod inputs;
mod look;
mod measured;
mod messages;
mod model;
mod outputs;
mod recording;
mod recording_clocks;
mod recording_errors;
mod recording_strange;
mod report;
mod session_commands;
mod slow_log;
mod support;
mod walk;
