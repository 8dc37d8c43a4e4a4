//! Events on their way to the thread: what finds no room waits for the next tick.

use breakaway_core::link::{CommandError, Ended};

use super::Tick;
use crate::app::accumulate::Accumulation;
use crate::app::channels::TickEvent;
use crate::app::control::PositionController;
use crate::board::Board;

/// What the thread has not been told yet.
#[derive(Debug, Default)]
pub(super) struct Unsent<'a> {
    /// There may be something below.
    pub news: bool,
    pub answer: Option<Result<(), CommandError>>,
    /// Late ticks since the reset, where it has changed.
    pub overruns: Option<u32>,
    pub fault: bool,
    pub ended: Option<Ended>,
    pub sums: Option<Accumulation<'a>>,
}

impl<B: Board, C: PositionController> Tick<'_, '_, B, C> {
    /// Sends one event, if there is one and room for it.
    #[inline]
    pub(super) fn send(&mut self) {
        if self.unsent.news && self.channels.events.ready() {
            self.send_next();
        }
    }

    #[cold]
    fn send_next(&mut self) {
        let unsent = &mut self.unsent;
        // The sums come before the end of their run, so that the end finds everything in place.
        let event = if let Some(answer) = unsent.answer.take() {
            TickEvent::Answer(answer)
        } else if let (true, Some(record)) = (unsent.fault, self.fault) {
            unsent.fault = false;
            TickEvent::Fault(record)
        } else if let Some(sums) = unsent.sums.take() {
            TickEvent::Sums(sums)
        } else if let Some(ended) = unsent.ended.take() {
            TickEvent::Ended(ended)
        } else if let Some(overruns) = unsent.overruns.take() {
            TickEvent::Overruns(overruns)
        } else {
            unsent.news = false;
            return;
        };
        // There was room, and this is the only producer.
        let _ = self.channels.events.enqueue(event);
    }
}
