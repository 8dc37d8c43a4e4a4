//! One port for several processes.
//!
//! The process that holds a port shares it ([`Client::offer`](super::Client::offer)): it listens on a local socket whose
//! name follows from the port's ([`place`]). A **guest** is another process that connects to the socket. It speaks the
//! link's own frames there, so a guest and a holder are the same [`Client`](super::Client).
//!
//! A guest gets every event and every sample that the holder gets. It may ask, stop what is running, and clear a
//! fault ([`may`]); nothing else of it reaches the board. Only the holder keeps the time-out of a moving axis off.
//! Where a guest asks for identity or status, it gets what the holder has heard last.
//!
//! A guest that does not read loses frames, as on a slow link, and never holds up the holder.

mod guest;
mod hub;
mod place;
#[cfg(any(not(unix), test))]
mod tcp;
#[cfg(unix)]
mod unix;

use breakaway_core::link::Command;

pub use hub::Hub;
pub(super) use hub::{FIRST_GUEST_ID, Offer, offer};
pub use place::folder;
pub(super) use place::{make_folder, name};

#[cfg(not(unix))]
use tcp as socket;
#[cfg(unix)]
use unix as socket;

pub(super) use socket::Stream;

/// What a guest may command.
pub fn may(command: &Command) -> bool {
    matches!(
        command,
        Command::Hello
            | Command::Status
            | Command::GetSettings
            | Command::GetModel
            | Command::GetFault
            | Command::ClearFault
            | Command::Stop
            | Command::StreamOn { .. }
            | Command::StreamOff
    )
}

/// A connection to the process that shares the port; `None` if there is none.
pub(super) fn join(port: &str) -> Option<Stream> {
    socket::connect(&place::of(port).ok()?).ok()
}
