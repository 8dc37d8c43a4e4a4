//! Ways to a board: the port itself, or the process that holds and shares it.

use std::collections::VecDeque;
use std::io::{self, Read};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, mpsc};
use std::time::{Duration, Instant};

use breakaway_core::link::{Command, Info, Reply};

use super::{Client, Counters, HELLO_TIMEOUT, POLL, Writer, reader};
use crate::device::share::{self, Hub};
use crate::device::{DeviceError, port};

impl Client {
    /// Opens the port and shakes hands. Where another process of this program holds the port and shares it, the client is
    /// its guest ([`Client::is_guest`]). A guest watches, and it can stop what is running.
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
    pub(in crate::device) fn probe(name: &str, baud: u32, timeout: Duration) -> Result<(Self, Info), DeviceError> {
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
    pub(in crate::device) fn ask_holder(name: &str, baud: u32, command: Command, timeout: Duration) -> bool {
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
}
