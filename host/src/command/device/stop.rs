//! `breakaway device stop`.

use super::documents::Stopped;
use crate::command::output::Output;
use crate::device::stop::{Way, stop};

/// Stops what is running, whoever holds the port.
///
/// # Errors
/// No board can be reached.
pub fn run(port: &str, baud: u32, output: Output) -> anyhow::Result<()> {
    let (name, text) = match stop(port, baud)? {
        Way::Holder => ("holder", "stopped, through the process that holds the port"),
        Way::Port => ("port", "stopped"),
        Way::PastHolder => ("past_holder", "stopped, past the program that holds the port: it does not answer, end it"),
    };
    output.print(&Stopped { done: "stopped", way: name }, |_| text.to_owned())
}
