//! Requests and replies over a port, with a thread that reads.

mod connect;
mod hello;
mod reader;

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use breakaway_core::link::{Command, MAX_FRAME, Message, Reply, Request, Status, encode};

pub use reader::Counters;
use reader::Incoming;

use super::share::{self, Hub, Offer};
use super::{DeviceError, port, text};

/// How long the first answer may take: a board that has just been plugged in needs to start.
const HELLO_TIMEOUT: Duration = Duration::from_millis(2500);
/// How long an answer may take.
const REPLY_TIMEOUT: Duration = Duration::from_secs(2);
/// How long solving or writing flash may take, on the slowest target.
const LONG_TIMEOUT: Duration = Duration::from_secs(15);
/// How often the reading thread looks whether it should end: what closing a port waits for.
const POLL: Duration = Duration::from_millis(10);
/// The device's guard against a lost link counts from the last command.
const KEEP_ALIVE: Duration = Duration::from_millis(200);

/// What requests are written to; the threads of other processes that share the port write there, too.
pub(super) type Writer = Arc<Mutex<Box<dyn Write + Send>>>;

/// A board that has introduced itself and speaks our version.
pub struct Client {
    writer: Writer,
    name: String,
    baud: u32,
    incoming: Receiver<Incoming>,
    /// Messages that came while a reply was awaited.
    waiting: VecDeque<Message>,
    counters: Arc<Counters>,
    ending: Arc<AtomicBool>,
    reader: Option<JoinHandle<()>>,
    next_id: u16,
    last_sent: Instant,
    /// What others share the port through; `None` for one that is a guest itself.
    hub: Option<Arc<Hub>>,
    offer: Option<Offer>,
}

impl Client {
    /// Shares the port from now on: other processes find it, watch, and can stop what is running. A guest has nothing to
    /// share.
    ///
    /// # Errors
    /// The socket cannot be made; the port works all the same.
    pub fn offer(&mut self) -> io::Result<()> {
        if let Some(hub) = &self.hub {
            self.offer = Some(share::offer(&self.name, hub)?);
        }
        Ok(())
    }

    /// Whether another process holds the port: this client watches, and can stop what is running.
    pub fn is_guest(&self) -> bool {
        self.hub.is_none()
    }

    /// The port's name.
    pub fn port(&self) -> &str {
        &self.name
    }

    /// What has come so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    fn unplugged(&self, reason: String) -> DeviceError {
        let port = self.name.clone();
        if self.is_guest() { DeviceError::HolderGone { port } } else { DeviceError::Unplugged { port, reason } }
    }

    /// Sends a command without waiting for its reply; the id under which it will be answered.
    fn send(&mut self, command: Command) -> Result<u16, DeviceError> {
        let id = self.next_id;
        // 0 is left out: it is what a device answers under that could not read the id. The upper half is the guests'.
        self.next_id = if id + 1 < share::FIRST_GUEST_ID { id + 1 } else { 1 };
        let name = text::command_name(&command);
        if self.is_guest() && !share::may(&command) {
            return Err(DeviceError::Watching { port: self.name.clone(), command: name });
        }
        let mut frame = [0; MAX_FRAME + 1];
        let Some((zero, rest)) = frame.split_first_mut() else {
            return Err(DeviceError::Nonsense { command: name });
        };
        // A zero in front ends whatever noise the device has received before.
        *zero = 0;
        let Ok(buffer) = rest.try_into() else { return Err(DeviceError::Nonsense { command: name }) };
        let used = encode(&Request { id, command }, buffer).map_err(|_| DeviceError::Nonsense { command: name })?;
        let written = self.writer.lock().unwrap_or_else(PoisonError::into_inner).write_all(&frame[..=used]);
        match written {
            Ok(()) => {}
            Err(error) if matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock) => {
                let (port, seconds) = (self.name.clone(), port::WRITE_TIMEOUT.as_secs_f64());
                return Err(DeviceError::Silent { port, command: name, seconds });
            }
            Err(error) => return Err(self.unplugged(error.to_string())),
        }
        self.last_sent = Instant::now();
        Ok(id)
    }

    /// Sends a command and waits for its reply; what else comes meanwhile is kept for [`Client::receive`].
    ///
    /// # Errors
    /// The port is gone, no answer, or a refusal.
    pub fn request(&mut self, command: Command) -> Result<Reply, DeviceError> {
        let timeout = match command {
            Command::Identify | Command::Save | Command::ClearFault => LONG_TIMEOUT,
            _ => REPLY_TIMEOUT,
        };
        self.request_within(command, timeout)
    }

    /// The same with so much time for the reply.
    pub(super) fn request_within(&mut self, command: Command, timeout: Duration) -> Result<Reply, DeviceError> {
        let name = text::command_name(&command);
        let new_stream = matches!(command, Command::StreamOn { .. });
        let wanted = self.send(command)?;
        let until = Instant::now() + timeout;
        while let Some(left) = until.checked_duration_since(Instant::now()) {
            match self.incoming.recv_timeout(left) {
                Ok(Incoming::Message(Message::Reply { id, reply })) if id == wanted => {
                    if new_stream {
                        // What came before the reply belongs to the stream before.
                        self.waiting.retain(|message| !matches!(message, Message::Samples(_)));
                    }
                    return match reply {
                        Reply::Error(error) => Err(DeviceError::Refused { command: name, error }),
                        reply => Ok(reply),
                    };
                }
                Ok(Incoming::Message(message)) => self.waiting.push_back(message),
                Ok(Incoming::Lost(reason)) => return Err(self.unplugged(reason)),
                Ok(Incoming::Peer { .. }) | Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Err(self.unplugged("the reader ended".into())),
            }
        }
        Err(DeviceError::Silent { port: self.name.clone(), command: name, seconds: timeout.as_secs_f64() })
    }

    /// Sends a command that is answered by `Done`.
    ///
    /// # Errors
    /// As [`Client::request`].
    pub fn done(&mut self, command: Command) -> Result<(), DeviceError> {
        let name = text::command_name(&command);
        match self.request(command)? {
            Reply::Done => Ok(()),
            _ => Err(DeviceError::Nonsense { command: name }),
        }
    }

    /// What the device is doing.
    ///
    /// # Errors
    /// As [`Client::request`].
    pub fn status(&mut self) -> Result<Status, DeviceError> {
        match self.request(Command::Status)? {
            Reply::Status(status) => Ok(status),
            _ => Err(DeviceError::Nonsense { command: "status" }),
        }
    }

    /// The next message that is no reply to [`Client::request`]; `None` after `timeout`. Asks for the status now and
    /// then, so that the device knows somebody is there: those replies come back here.
    ///
    /// # Errors
    /// [`DeviceError::Unplugged`].
    pub fn receive(&mut self, timeout: Duration) -> Result<Option<Message>, DeviceError> {
        if self.last_sent.elapsed() > KEEP_ALIVE {
            self.send(Command::Status)?;
        }
        if let Some(message) = self.waiting.pop_front() {
            return Ok(Some(message));
        }
        match self.incoming.recv_timeout(timeout) {
            Ok(Incoming::Message(message)) => Ok(Some(message)),
            Ok(Incoming::Lost(reason)) => Err(self.unplugged(reason)),
            Ok(Incoming::Peer { .. }) | Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(self.unplugged("the reader ended".into())),
        }
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        // First, so that nobody finds what is about to end.
        self.offer = None;
        self.ending.store(true, Ordering::Relaxed);
        if let Some(reader) = self.reader.take() {
            // It polls; a reader that panicked has nothing left to say.
            let _ = reader.join();
        }
    }
}
