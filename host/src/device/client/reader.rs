//! The thread that reads: bytes to frames to messages, for this process and for those that share its port.

use std::io::{self, Read};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::Sender;

use breakaway_core::link::{Decoder, Message, peer_version};

use crate::device::share::Hub;

/// What the reading thread hands over.
#[allow(clippy::large_enum_variant)] // Most of them are messages.
pub(super) enum Incoming {
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

/// Reads until the port is gone or nobody listens.
pub(super) fn read(
    port: &mut dyn Read,
    sender: &Sender<Incoming>,
    counters: &Counters,
    ending: &AtomicBool,
    hub: Option<&Hub>,
) {
    let mut decoder = Decoder::new();
    let mut buffer = [0; 4096];
    let lost = |reason: String| {
        if let Some(hub) = hub {
            hub.close();
        }
        let _ = sender.send(Incoming::Lost(reason));
    };
    while !ending.load(Ordering::Relaxed) {
        let count = match port.read(&mut buffer) {
            Ok(0) => return lost("end of file".into()),
            Ok(count) => count,
            Err(error) => match error.kind() {
                io::ErrorKind::TimedOut | io::ErrorKind::Interrupted | io::ErrorKind::WouldBlock => continue,
                _ => return lost(error.to_string()),
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
            let message = Message::decode(bytes).and_then(|message| match hub {
                Some(hub) => hub.pass(message),
                None => Some(message),
            });
            for incoming in peer.into_iter().chain(message.map(Incoming::Message)) {
                if sender.send(incoming).is_err() {
                    return;
                }
            }
        }
    }
}
