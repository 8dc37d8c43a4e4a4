//! What can go wrong between host and board, each with what to do about it.

use std::io;

use breakaway_core::link::{BAUD, CommandError, PROTOCOL_VERSION, SCHEMA};

use super::text;

/// Why the board could not be reached, or did not do what it was asked.
#[derive(Debug, thiserror::Error)]
pub enum DeviceError {
    /// There is no such port.
    #[error(
        "there is no port {port}: is the board plugged in? (Linux names boards /dev/ttyACM0 or /dev/ttyUSB0; `ls /dev/tty*` lists them)"
    )]
    NoPort {
        /// The port.
        port: String,
    },
    /// Another program has it.
    #[error(
        "{port} is in use by another program: close it (a monitor, a capture, a terminal program), or `fuser {port}` tells which it is"
    )]
    Busy {
        /// The port.
        port: String,
    },
    /// Another process of this program has it, and shares it.
    #[error(
        "another breakaway process holds {port}: end that first. Until then `breakaway monitor --port {port}` watches it and `breakaway device --port {port} stop` stops it"
    )]
    Held {
        /// The port.
        port: String,
    },
    /// A guest may not command that.
    #[error(
        "`{command}` cannot be sent: another breakaway process holds {port}, and beside it one can only watch, stop and clear a fault. End that process first"
    )]
    Watching {
        /// The port.
        port: String,
        /// The command.
        command: &'static str,
    },
    /// The process that holds the port does not answer.
    #[error(
        "another breakaway process holds {port} and does not answer: it hangs. `breakaway device --port {port} stop` stops the axis; then end that process"
    )]
    HolderSilent {
        /// The port.
        port: String,
    },
    /// The process that held the port has ended.
    #[error("the breakaway process that held {port} has ended")]
    HolderGone {
        /// The port.
        port: String,
    },
    /// A stop was sent past the program that holds the port, and nothing came back.
    #[error(
        "{port}: a stop was sent past the program that holds the port, and no answer came; look whether the axis stands, and end that program"
    )]
    StopUnconfirmed {
        /// The port.
        port: String,
    },
    /// The user may not open it.
    #[error(
        "no permission to open {port}: add yourself to its group (`ls -l {port}` shows it; usually `sudo usermod -aG dialout $USER`) and log in again"
    )]
    Permission {
        /// The port.
        port: String,
    },
    /// It is no port.
    #[error("{port} cannot be used as a serial port: {reason}")]
    NotAPort {
        /// The port.
        port: String,
        /// The system's reason.
        reason: String,
    },
    /// Nothing came back.
    #[error(
        "{port}: no answer within {seconds} s, not a single byte: is the board powered and flashed, and is this its port?"
    )]
    NoAnswer {
        /// The port.
        port: String,
        /// How long was waited.
        seconds: f64,
    },
    /// Something came back, but nothing that could be read.
    #[error(
        "{port}: {bytes} bytes came, and no readable frame among them. The baud rate is wrong (tried {baud}, the firmware's own is {BAUD}; see --baud), or this is no breakaway board"
    )]
    Garbage {
        /// The port.
        port: String,
        /// Bytes received.
        bytes: u64,
        /// The baud rate in use.
        baud: u32,
    },
    /// The device speaks another version.
    #[error(
        "{port}: the board speaks link version {version} (schema {schema:08x}), this program version {PROTOCOL_VERSION} (schema {SCHEMA:08x}): flash the firmware of this release, or use the program of the firmware's"
    )]
    OtherVersion {
        /// The port.
        port: String,
        /// The device's version.
        version: u16,
        /// The device's schema.
        schema: u32,
    },
    /// A command got no answer.
    #[error(
        "{port}: no answer to `{command}` within {seconds} s, though the port is open: the board hangs, or the cable is bad (reset the board and try again)"
    )]
    Silent {
        /// The port.
        port: String,
        /// The command.
        command: &'static str,
        /// How long was waited.
        seconds: f64,
    },
    /// The port is gone.
    #[error(
        "{port} went away ({reason}): the board was unplugged or its program ended; plug it in again and repeat the command"
    )]
    Unplugged {
        /// The port.
        port: String,
        /// The system's reason.
        reason: String,
    },
    /// The device started anew.
    #[error("{port}: the board was reset in the middle of it")]
    Restarted {
        /// The port.
        port: String,
    },
    /// The device refuses.
    #[error("the board refuses `{command}`: {}", text::refusal(error))]
    Refused {
        /// The command.
        command: &'static str,
        /// Its reason.
        error: CommandError,
    },
    /// The device answers something else.
    #[error("the board's answer to `{command}` makes no sense; please report this")]
    Nonsense {
        /// The command.
        command: &'static str,
    },
    /// A fault was raised or is latched.
    #[error(
        "the board has a fault: {0}; see `breakaway device --port PORT fault`, and `clear` once its cause is removed"
    )]
    Fault(String),
    /// The device is busy.
    #[error("the board is not idle but in mode `{0}`: `breakaway device --port PORT stop` stops it")]
    NotIdle(&'static str),
    /// What is asked cannot be done on a board.
    #[error("{what} = {value} cannot be run on this board: {need}")]
    Range {
        /// Field.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What can.
        need: String,
    },
    /// The board has no such trajectory.
    #[error(
        "--reference {0} cannot be followed on a board, which makes its references itself: give it a sine (sine:A,HZ), a trapezoid (trapezoid:D,V,A[,REST]) or an S-curve (s_curve:D,V,A,J[,REST])"
    )]
    Reference(String),
    /// A model does not fit the board.
    #[error("the model cannot be loaded: {0}")]
    Model(String),
    /// Something else ended it.
    #[error("{0}")]
    Ended(String),
    /// Ctrl-C.
    #[error("stopped by Ctrl-C; a stop was sent to the board")]
    Interrupted,
    /// The experiment.
    #[error(transparent)]
    Experiment(#[from] crate::simulate::SimulateError),
    /// A file.
    #[error("cannot write {file}: {reason}")]
    Write {
        /// The file.
        file: String,
        /// The system's reason.
        reason: io::Error,
    },
}
