//! Requests and replies over a port, with a thread that reads.

mod hello;
mod reader;

use std::collections::VecDeque;
use std::io::{self, Read, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use breakaway_core::link::{Command, Info, MAX_FRAME, Message, Reply, Request, Status, encode};

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
    /// Opens the port and shakes hands. Where another process of this program holds the port and shares it, the client is
    /// its guest: it watches, and it can stop what is running ([`Client::is_guest`]).
    ///
    /// # Errors
    /// [`DeviceError`]: no such port, in use, no permission; no answer, garbage, another version.
    pub fn connect(name: &str, baud: u32) -> Result<(Self, Info), DeviceError> {
        match Self::alone(name, baud, HELLO_TIMEOUT) {
            Err(DeviceError::Busy { port }) => match share::join(name) {
                Some(stream) => Self::guest(name, baud, stream, HELLO_TIMEOUT),
                None => Err(DeviceError::Busy { port }),
            },
            other => other,
        }
    }

    /// As [`Client::connect`], but never as a guest: for what drives the axis.
    ///
    /// # Errors
    /// As [`Client::connect`]; [`DeviceError::Held`] where another process shares the port.
    pub fn connect_alone(name: &str, baud: u32) -> Result<(Self, Info), DeviceError> {
        match Self::alone(name, baud, HELLO_TIMEOUT) {
            Err(DeviceError::Busy { port }) if share::join(name).is_some() => Err(DeviceError::Held { port }),
            other => other,
        }
    }

    /// As [`Client::connect`], with so much time for the first answer.
    pub(super) fn probe(name: &str, baud: u32, timeout: Duration) -> Result<(Self, Info), DeviceError> {
        match Self::alone(name, baud, timeout) {
            Err(DeviceError::Busy { port }) => match share::join(name) {
                Some(stream) => Self::guest(name, baud, stream, timeout),
                None => Err(DeviceError::Busy { port }),
            },
            other => other,
        }
    }

    /// Sends a command through the process that shares the port; whether it was done within `timeout`. Without a
    /// handshake, which a holder that hangs would not answer either.
    pub(super) fn ask_holder(name: &str, baud: u32, command: Command, timeout: Duration) -> bool {
        let Some(stream) = share::join(name) else { return false };
        let Ok(mut client) = Self::guest_without_hello(name, baud, stream) else { return false };
        matches!(client.request_within(command, timeout), Ok(Reply::Done))
    }

    fn alone(name: &str, baud: u32, timeout: Duration) -> Result<(Self, Info), DeviceError> {
        let port = port::open(name, baud)?;
        let not_a_port =
            |error: &dyn std::fmt::Display| DeviceError::NotAPort { port: name.to_owned(), reason: error.to_string() };
        let mut reading = port.try_clone().map_err(|error| not_a_port(&error))?;
        reading.set_timeout(POLL).map_err(|error| not_a_port(&error))?;
        let writer: Writer = Arc::new(Mutex::new(Box::new(port)));
        let hub = Arc::new(Hub::new(Arc::clone(&writer)));
        let mut client = Self::on(name, baud, writer, Box::new(reading), Some(hub));
        let info = client.hello(timeout)?;
        Ok((client, info))
    }

    fn guest(name: &str, baud: u32, stream: share::Stream, timeout: Duration) -> Result<(Self, Info), DeviceError> {
        let mut client = Self::guest_without_hello(name, baud, stream)?;
        let info = client.hello(timeout)?;
        Ok((client, info))
    }

    fn guest_without_hello(name: &str, baud: u32, stream: share::Stream) -> Result<Self, DeviceError> {
        let not_a_port = |error: io::Error| DeviceError::NotAPort { port: name.to_owned(), reason: error.to_string() };
        let reading = stream.try_clone().map_err(not_a_port)?;
        reading.set_read_timeout(Some(POLL)).map_err(not_a_port)?;
        stream.set_write_timeout(Some(port::WRITE_TIMEOUT)).map_err(not_a_port)?;
        Ok(Self::on(name, baud, Arc::new(Mutex::new(Box::new(stream))), Box::new(reading), None))
    }

    fn on(name: &str, baud: u32, writer: Writer, mut reading: Box<dyn Read + Send>, hub: Option<Arc<Hub>>) -> Self {
        let (sender, incoming) = mpsc::channel();
        let counters = Arc::new(Counters::default());
        let ending = Arc::new(AtomicBool::new(false));
        let reader = std::thread::spawn({
            let (counters, ending, hub) = (Arc::clone(&counters), Arc::clone(&ending), hub.clone());
            move || reader::read(&mut *reading, &sender, &counters, &ending, hub.as_deref())
        });
        Self {
            writer,
            name: name.to_owned(),
            baud,
            incoming,
            waiting: VecDeque::new(),
            counters,
            ending,
            reader: Some(reader),
            next_id: 1,
            last_sent: Instant::now(),
            hub,
            offer: None,
        }
    }

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
