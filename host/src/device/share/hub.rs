//! The holder's side: who is connected, whose answer a reply is, what the board has said last.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use breakaway_core::link::{Command, CommandError, Info, MAX_FRAME, Message, Reply, Request, Status, encode};

use super::guest::Guest;
use super::socket::{self, Listener, Stream};
use super::{may, place};
use crate::device::client::Writer;

/// Requests of guests have ids from here on, those of the holder ids below.
pub(in crate::device) const FIRST_GUEST_ID: u16 = 0x8000;
/// Requests of guests that may wait for an answer; the oldest is forgotten, as a board that hangs answers none.
const MOST_ASKED: usize = 64;

/// A request of a guest that is on its way.
#[derive(Clone, Copy)]
struct Asked {
    /// Its id on the link.
    id: u16,
    guest: u64,
    /// Its id at the guest.
    theirs: u16,
}

/// What the holder's threads share.
#[derive(Default)]
struct Known {
    guests: Vec<Guest>,
    asked: VecDeque<Asked>,
    next_id: u16,
    next_guest: u64,
    info: Option<Info>,
    status: Option<Status>,
}

/// What a port is shared through.
pub struct Hub {
    writer: Writer,
    known: Mutex<Known>,
    closed: AtomicBool,
}

impl Hub {
    pub(in crate::device) fn new(writer: Writer) -> Self {
        Self { writer, known: Mutex::default(), closed: AtomicBool::new(false) }
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes a message of the board: sends it to the guests whom it concerns, and gives it back where it concerns the holder.
    pub(in crate::device) fn pass(&self, message: Message) -> Option<Message> {
        let mut known = self.known();
        match &message {
            Message::Reply { id, reply } => {
                match reply {
                    Reply::Info(info) => known.info = Some(info.clone()),
                    Reply::Status(status) => known.status = Some(*status),
                    _ => {}
                }
                if *id < FIRST_GUEST_ID {
                    return Some(message);
                }
                let at = known.asked.iter().position(|asked| asked.id == *id)?;
                let asked = known.asked.remove(at)?;
                let Message::Reply { reply, .. } = message else { return None };
                known.send(asked.guest, &Message::Reply { id: asked.theirs, reply });
                None
            }
            Message::Event(_) | Message::Samples(_) => {
                if let (Message::Samples(batch), Some(status)) = (&message, &mut known.status)
                    && let Some(Ok(last)) = batch.samples().last()
                {
                    // A holder that sends all the time asks for no status.
                    status.mode = last.mode;
                    (status.tick, status.count, status.drive_code) = (last.tick, last.count, last.drive_code);
                }
                if !known.guests.is_empty() {
                    let frame = frame(&message);
                    known.guests.retain(|guest| guest.send(frame.clone()));
                }
                Some(message)
            }
        }
    }

    /// Takes a request of a guest.
    pub(super) fn request(&self, guest: u64, Request { id, command }: Request) {
        let mut known = self.known();
        let answer = match &command {
            command if !may(command) => Some(Reply::Error(CommandError::Unsupported)),
            // The stream is the holder's.
            Command::StreamOn { .. } | Command::StreamOff => Some(Reply::Done),
            Command::Hello => known.info.clone().map(Reply::Info),
            Command::Status => known.status.map(Reply::Status),
            _ => None,
        };
        if let Some(reply) = answer {
            known.send(guest, &Message::Reply { id, reply });
            return;
        }
        known.next_id = known.next_id.wrapping_add(1) | FIRST_GUEST_ID;
        let asked = Asked { id: known.next_id, guest, theirs: id };
        if known.asked.len() == MOST_ASKED {
            known.asked.pop_front();
        }
        known.asked.push_back(asked);
        drop(known);
        let request = frame(&Request { id: asked.id, command });
        // A port that takes nothing is the holder's to find out; the guest gets no answer.
        let _ = self.writer.lock().unwrap_or_else(PoisonError::into_inner).write_all(&request);
    }

    /// Takes a guest in, unless all is over.
    fn admit(self: &Arc<Self>, stream: Stream) {
        let mut known = self.known();
        if self.closed.load(Ordering::SeqCst) {
            return;
        }
        let number = known.next_guest;
        known.next_guest += 1;
        // A guest whose socket cannot be set up has gone already.
        if let Ok(guest) = Guest::start(number, stream, self) {
            known.guests.push(guest);
        }
    }

    pub(super) fn leave(&self, guest: u64) {
        let mut known = self.known();
        known.guests.retain(|one| one.number != guest);
        known.asked.retain(|asked| asked.guest != guest);
    }

    /// Sends all guests away: the port is gone, or is given up.
    pub(in crate::device) fn close(&self) {
        self.closed.store(true, Ordering::SeqCst);
        self.known().guests.clear();
    }
}

impl Known {
    fn send(&mut self, guest: u64, message: &Message) {
        let frame = frame(message);
        self.guests.retain(|one| one.number != guest || one.send(frame.clone()));
    }
}

/// A message between two zeros, which end whatever noise came before.
fn frame(message: &impl serde::Serialize) -> Arc<[u8]> {
    let mut bytes = [0; MAX_FRAME];
    // What has come in one frame goes out in one.
    let used = encode(message, &mut bytes).unwrap_or(0);
    std::iter::once(0).chain(bytes.into_iter().take(used)).collect()
}

/// The socket, for as long as it lives.
pub(in crate::device) struct Offer {
    hub: Arc<Hub>,
    path: PathBuf,
}

/// Listens for guests of `port`.
///
/// # Errors
/// The folder or the socket cannot be made.
pub(in crate::device) fn offer(port: &str, hub: &Arc<Hub>) -> io::Result<Offer> {
    place::make_folder()?;
    let path = place::of(port)?;
    let listener = Listener::bind(&path)?;
    std::thread::spawn({
        let hub = Arc::clone(hub);
        move || {
            while let Ok(stream) = listener.accept() {
                if hub.closed.load(Ordering::SeqCst) {
                    return;
                }
                hub.admit(stream);
            }
        }
    });
    Ok(Offer { hub: Arc::clone(hub), path })
}

impl Drop for Offer {
    fn drop(&mut self) {
        self.hub.close();
        // The listening thread waits for a guest: this is the last one.
        let _ = socket::connect(&self.path);
        let _ = std::fs::remove_file(&self.path);
    }
}
