//! What is on its way to the host: one frame at a time.

use breakaway_core::link::{Event, MAX_FRAME, Message, Reply, encode};
use heapless::Deque;

use super::stream::Stream;
use crate::board::Wire;

/// Events that wait; more than a run can cause at once.
const EVENTS: usize = 6;

/// The frame being sent, and what comes after it: the reply first, then samples, then events.
pub(super) struct Outbox {
    /// A zero in front: before a reply it ends what a link that was cut off has left of another frame at the host.
    frame: [u8; 1 + MAX_FRAME],
    length: usize,
    sent: usize,
    reply: Option<(u16, Reply)>,
    events: Deque<Event, EVENTS>,
    /// The samples before the first event are on their way.
    flushed: bool,
}

impl Outbox {
    pub(super) const fn new() -> Self {
        Self { frame: [0; 1 + MAX_FRAME], length: 0, sent: 0, reply: None, events: Deque::new(), flushed: false }
    }

    pub(super) fn can_reply(&self) -> bool {
        self.reply.is_none()
    }

    /// Replies to a request; only if [`Self::can_reply`].
    #[inline(never)]
    pub(super) fn reply(&mut self, id: u16, reply: Reply) {
        self.reply = Some((id, reply));
    }

    pub(super) fn event(&mut self, event: Event) {
        // The oldest gives way: faults can be asked for, and the newest state matters most.
        if self.events.is_full() {
            self.events.pop_front();
        }
        let _ = self.events.push_back(event);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.sent == self.length && self.reply.is_none()
    }

    /// Takes the next message, if the frame before is out.
    #[inline(never)]
    pub(super) fn fill(&mut self, stream: &mut Stream) {
        if self.sent < self.length {
            return;
        }
        // Once per event: what was recorded before it goes out before it.
        if !self.events.is_empty() && !self.flushed && stream.ready() {
            stream.flush();
            self.flushed = true;
        }
        let mut first = 1;
        let message = if let Some((id, reply)) = self.reply.take() {
            first = 0;
            Message::Reply { id, reply }
        } else if let Some(batch) = stream.take() {
            Message::Samples(batch)
        } else if let Some(event) = self.events.pop_front() {
            self.flushed = false;
            Message::Event(event)
        } else {
            return;
        };
        let Some(frame) = self.frame.last_chunk_mut::<MAX_FRAME>() else { return };
        self.sent = first;
        // Every message fits (tested in the core); one that did not would be left out.
        self.length = encode(&message, frame).map_or(first, |length| 1 + length);
    }

    pub(super) fn send(&mut self, wire: &mut impl Wire) {
        if let Some(rest @ [_, ..]) = self.frame.get(self.sent..self.length) {
            self.sent += wire.write(rest).min(rest.len());
        }
    }
}
