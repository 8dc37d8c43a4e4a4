//! The handshake: who is there, and in which version.

use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use breakaway_core::link::{Command, Event, Info, Message, PROTOCOL_VERSION, Reply, SCHEMA};

use super::reader::Incoming;
use super::{Client, DeviceError};

/// How often hello is said again meanwhile.
const HELLO_AGAIN: Duration = Duration::from_millis(150);

impl Client {
    /// Says hello until somebody answers.
    pub(super) fn hello(&mut self, timeout: Duration) -> Result<Info, DeviceError> {
        let start = Instant::now();
        let mut first_id = None;
        while start.elapsed() < timeout {
            let id = self.send(Command::Hello)?;
            let first = *first_id.get_or_insert(id);
            let until = Instant::now() + HELLO_AGAIN;
            while let Some(left) = until.checked_duration_since(Instant::now()) {
                match self.incoming.recv_timeout(left) {
                    // An answer to an earlier hello is as good; one to somebody before us is not.
                    Ok(Incoming::Peer { id, version, schema }) if (first..self.next_id).contains(&id) => {
                        if (version, schema) != (PROTOCOL_VERSION, SCHEMA) {
                            return Err(DeviceError::OtherVersion { port: self.name.clone(), version, schema });
                        }
                    }
                    Ok(Incoming::Message(Message::Reply { id, reply: Reply::Info(info) }))
                        if (first..self.next_id).contains(&id) =>
                    {
                        // That it has started is what we were waiting for, not news.
                        self.waiting.retain(|message| !matches!(message, Message::Event(Event::Started)));
                        return Ok(info);
                    }
                    Ok(Incoming::Message(message)) => self.waiting.push_back(message),
                    Ok(Incoming::Lost(reason)) => return Err(self.unplugged(reason)),
                    Ok(Incoming::Peer { .. }) | Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => return Err(self.unplugged("the reader ended".into())),
                }
            }
        }
        let (port, bytes) = (self.name.clone(), self.counters.bytes());
        let seconds = timeout.as_secs_f64();
        Err(match (bytes, self.counters.good_frames()) {
            _ if self.is_guest() => DeviceError::HolderSilent { port },
            (0, _) => DeviceError::NoAnswer { port, seconds },
            (_, 0) => DeviceError::Garbage { port, bytes, baud: self.baud },
            _ => DeviceError::Silent { port, command: "hello", seconds },
        })
    }
}
