//! Requests and replies over a port, with a thread that reads.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use breakaway_core::link::{
    Command, Decoder, Event, Info, MAX_FRAME, Message, PROTOCOL_VERSION, Reply, Request, SCHEMA, Status, encode,
    peer_version,
};
use serialport::SerialPort;

use super::{DeviceError, port, text};

/// How long the first answer may take: a board that has just been plugged in needs to start.
const HELLO_TIMEOUT: Duration = Duration::from_millis(2500);
/// How often hello is said again meanwhile.
const HELLO_AGAIN: Duration = Duration::from_millis(150);
/// How long an answer may take.
const REPLY_TIMEOUT: Duration = Duration::from_secs(2);
/// How long solving or writing flash may take, on the slowest target.
const LONG_TIMEOUT: Duration = Duration::from_secs(15);
/// How often the reading thread looks whether it should end: what closing a port waits for.
const POLL: Duration = Duration::from_millis(10);
/// The device's guard against a lost link counts from the last command.
const KEEP_ALIVE: Duration = Duration::from_millis(200);

/// What the reading thread hands over.
#[allow(clippy::large_enum_variant)] // Most of them are messages.
enum Incoming {
    Message(Message),
    Peer { id: u16, version: u16, schema: u32 },
    Lost(String),
}

/// What has come over the port since it was opened.
#[derive(Debug, Default)]
pub struct Counters {
    bytes: AtomicU64,
    good: AtomicU64,
    bad: AtomicU64,
}

impl Counters {
    /// Bytes received.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }
    /// Frames received whole.
    pub fn good_frames(&self) -> u64 {
        self.good.load(Ordering::Relaxed)
    }
    /// Frames received damaged.
    pub fn bad_frames(&self) -> u64 {
        self.bad.load(Ordering::Relaxed)
    }
}

/// A board that has introduced itself and speaks our version.
pub struct Client {
    port: Box<dyn SerialPort>,
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
    info: Option<Info>,
}

impl Client {
    /// Opens the port and shakes hands.
    ///
    /// # Errors
    /// [`DeviceError`]: no such port, in use, no permission; no answer, garbage, another version.
    pub fn connect(name: &str, baud: u32) -> Result<(Self, Info), DeviceError> {
        let port = port::open(name, baud)?;
        let not_a_port =
            |error: &dyn std::fmt::Display| DeviceError::NotAPort { port: name.to_owned(), reason: error.to_string() };
        let mut reading = port.try_clone().map_err(|error| not_a_port(&error))?;
        reading.set_timeout(POLL).map_err(|error| not_a_port(&error))?;
        let (sender, incoming) = mpsc::channel();
        let counters = Arc::new(Counters::default());
        let ending = Arc::new(AtomicBool::new(false));
        let reader = std::thread::spawn({
            let (counters, ending) = (Arc::clone(&counters), Arc::clone(&ending));
            move || read(&mut *reading, &sender, &counters, &ending)
        });
        let mut client = Self {
            port,
            name: name.to_owned(),
            baud,
            incoming,
            waiting: VecDeque::new(),
            counters,
            ending,
            reader: Some(reader),
            next_id: 1,
            last_sent: Instant::now(),
            info: None,
        };
        let info = client.hello()?;
        client.info = Some(info.clone());
        Ok((client, info))
    }

    /// The port's name.
    pub fn port(&self) -> &str {
        &self.name
    }

    /// What has come so far.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// Says hello until somebody answers.
    fn hello(&mut self) -> Result<Info, DeviceError> {
        let start = Instant::now();
        let mut first_id = None;
        while start.elapsed() < HELLO_TIMEOUT {
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
        let seconds = HELLO_TIMEOUT.as_secs_f64();
        Err(match (bytes, self.counters.good_frames()) {
            (0, _) => DeviceError::NoAnswer { port, seconds },
            (_, 0) => DeviceError::Garbage { port, bytes, baud: self.baud },
            _ => DeviceError::Silent { port, command: "hello", seconds },
        })
    }

    fn unplugged(&self, reason: String) -> DeviceError {
        DeviceError::Unplugged { port: self.name.clone(), reason }
    }

    /// Sends a command without waiting for its reply; the id under which it will be answered.
    fn send(&mut self, command: Command) -> Result<u16, DeviceError> {
        let id = self.next_id;
        // 0 is left out: it is what a device answers under that could not read the id.
        self.next_id = self.next_id.checked_add(1).unwrap_or(1);
        let name = text::command_name(&command);
        let mut frame = [0; MAX_FRAME + 1];
        let Some((zero, rest)) = frame.split_first_mut() else {
            return Err(DeviceError::Nonsense { command: name });
        };
        // A zero in front ends whatever noise the device has received before.
        *zero = 0;
        let Ok(buffer) = rest.try_into() else { return Err(DeviceError::Nonsense { command: name }) };
        let used = encode(&Request { id, command }, buffer).map_err(|_| DeviceError::Nonsense { command: name })?;
        match self.port.write_all(&frame[..=used]) {
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::TimedOut => {
                return Err(DeviceError::Silent {
                    port: self.name.clone(),
                    command: name,
                    seconds: self.port.timeout().as_secs_f64(),
                });
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
        let name = text::command_name(&command);
        let timeout = match command {
            Command::Identify | Command::Save | Command::ClearFault => LONG_TIMEOUT,
            _ => REPLY_TIMEOUT,
        };
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
        self.ending.store(true, Ordering::Relaxed);
        if let Some(reader) = self.reader.take() {
            // It polls; a reader that panicked has nothing left to say.
            let _ = reader.join();
        }
    }
}

/// Reads until the port is gone or nobody listens.
fn read(port: &mut dyn SerialPort, sender: &Sender<Incoming>, counters: &Counters, ending: &AtomicBool) {
    let mut decoder = Decoder::new();
    let mut buffer = [0; 4096];
    while !ending.load(Ordering::Relaxed) {
        let count = match port.read(&mut buffer) {
            Ok(0) => {
                let _ = sender.send(Incoming::Lost("end of file".into()));
                return;
            }
            Ok(count) => count,
            Err(error) => match error.kind() {
                io::ErrorKind::TimedOut | io::ErrorKind::Interrupted | io::ErrorKind::WouldBlock => continue,
                _ => {
                    let _ = sender.send(Incoming::Lost(error.to_string()));
                    return;
                }
            },
        };
        counters.bytes.fetch_add(count as u64, Ordering::Relaxed);
        for byte in buffer.iter().take(count) {
            let bytes = match decoder.push(*byte) {
                None => continue,
                Some(Err(_)) => {
                    counters.bad.fetch_add(1, Ordering::Relaxed);
                    continue;
                }
                Some(Ok(bytes)) => bytes,
            };
            counters.good.fetch_add(1, Ordering::Relaxed);
            // The version goes first: what follows may not be readable.
            let peer = peer_version(bytes).map(|(id, version, schema)| Incoming::Peer { id, version, schema });
            let message = Message::decode(bytes).map(Incoming::Message);
            for incoming in peer.into_iter().chain(message) {
                if sender.send(incoming).is_err() {
                    return;
                }
            }
        }
    }
}
