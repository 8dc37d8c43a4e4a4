//! Stopping the axis, whoever holds the port.
//!
//! Tried in this order:
//! 1. through the process that shares the port, which has [`HOLDER_TIMEOUT`] to bring the board's answer;
//! 2. over the port itself, if nobody has locked it;
//! 3. over the port past whoever has locked it: the process that holds it hangs, or is another program. Not on Windows,
//!    where a port that is open is closed to others.

use std::time::Duration;

use breakaway_core::link::Command;

use super::{Client, DeviceError};

/// How long a holder that works may take: a few ticks of the board, and a terminal that is redrawn.
const HOLDER_TIMEOUT: Duration = Duration::from_secs(1);

/// How the board was reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Through the process that holds the port.
    Holder,
    /// Over the port.
    Port,
    /// Over the port, past the program that holds it.
    PastHolder,
}

/// Stops what is running on the board.
///
/// # Errors
/// [`DeviceError`]: no such port, no board, no way to reach it.
pub fn stop(port: &str, baud: u32) -> Result<Way, DeviceError> {
    if Client::ask_holder(port, baud, Command::Stop, HOLDER_TIMEOUT) {
        return Ok(Way::Holder);
    }
    match Client::connect_alone(port, baud) {
        Ok((mut client, _)) => client.done(Command::Stop).map(|()| Way::Port),
        Err(DeviceError::Busy { .. } | DeviceError::Held { .. }) => past::stop(port).map(|()| Way::PastHolder),
        Err(error) => Err(error),
    }
}

#[cfg(unix)]
mod past {
    use std::fs::File;
    use std::io::{Read, Write};
    use std::time::{Duration, Instant};

    use breakaway_core::link::{Command, Decoder, MAX_FRAME, Message, Reply, Request, encode};

    use crate::device::{DeviceError, port};

    /// How long the board's answer is looked for, which the other program may read instead.
    const ANSWER: Duration = Duration::from_secs(1);
    /// How often the command is sent meanwhile: one may be lost in what the other program writes.
    const AGAIN: Duration = Duration::from_millis(100);
    /// An id that neither the holder nor a guest of its has: the last one.
    const ID: u16 = u16::MAX;

    pub(super) fn stop(name: &str) -> Result<(), DeviceError> {
        let busy = |_| DeviceError::Busy { port: name.to_owned() };
        let mut port = File::from(port::raw(name).map_err(busy)?);
        let mut frame = [0; MAX_FRAME];
        let request = Request { id: ID, command: Command::Stop };
        let used = encode(&request, &mut frame).map_err(|_| DeviceError::Nonsense { command: "stop" })?;
        let message: Vec<u8> = std::iter::once(0).chain(frame.into_iter().take(used)).collect();
        let (start, mut decoder, mut buffer) = (Instant::now(), Decoder::new(), [0; 1024]);
        let mut sent: Option<Instant> = None;
        while start.elapsed() < ANSWER {
            if sent.is_none_or(|sent| sent.elapsed() > AGAIN) {
                port.write_all(&message).map_err(busy)?;
                sent = Some(Instant::now());
            }
            // Nothing is there, most of the time: it does not wait.
            let count = port.read(&mut buffer).unwrap_or(0);
            if count == 0 {
                std::thread::sleep(Duration::from_millis(2));
            }
            for byte in buffer.iter().take(count) {
                let Some(Ok(bytes)) = decoder.push(*byte) else { continue };
                if let Some(Message::Reply { id, reply: Reply::Done }) = Message::decode(bytes)
                    && id == request.id
                {
                    return Ok(());
                }
            }
        }
        Err(DeviceError::StopUnconfirmed { port: name.to_owned() })
    }
}

#[cfg(not(unix))]
mod past {
    use crate::device::DeviceError;

    pub(super) fn stop(name: &str) -> Result<(), DeviceError> {
        Err(DeviceError::Busy { port: name.to_owned() })
    }
}
