//! Set-points on their way from the input to the board: what waits, what is sent next, what the board has taken.

use std::collections::VecDeque;
use std::sync::mpsc::TryRecvError;
use std::time::{Duration, Instant};

use breakaway_core::link::{Following, SET_POINTS, SetPoint, SetPoints};

use crate::device::set_points::{LineError, Schedule, Source};

/// Set-points that wait here for room on the board.
const WAITING: usize = 2 * SET_POINTS;
/// How often a board without room is asked again: its room for 31 lasts longer down to a set-point each millisecond.
pub(super) const ASK_AGAIN: Duration = Duration::from_millis(4);
/// How long a set-point without a velocity waits at least for the next line.
const LEAST_WAIT: Duration = Duration::from_millis(20);

/// The set-points on their way.
pub(super) struct Feed<'a> {
    pub(super) source: &'a Source,
    schedule: Schedule,
    /// With their lines.
    pub(super) waiting: VecDeque<(u64, SetPoint)>,
    /// The input is at its end, and its last set-point waits or is taken.
    complete: bool,
    /// The board has taken all.
    pub(super) done: bool,
    read_at: Instant,
    asked: Instant,
    /// Since when the board has no run to follow.
    pub(super) over_at: Option<Instant>,
    pub(super) state: Following,
}

impl<'a> Feed<'a> {
    pub(super) fn new(source: &'a Source, tick_hz: f64) -> Self {
        let now = Instant::now();
        Self {
            source,
            schedule: Schedule::new(&source.name, tick_hz),
            waiting: VecDeque::new(),
            complete: false,
            done: false,
            read_at: now,
            asked: now,
            over_at: None,
            state: Following::default(),
        }
    }

    /// Takes what has been read.
    pub(super) fn read(&mut self) -> Result<(), LineError> {
        while self.waiting.len() < WAITING && !self.complete {
            let made = match self.source.points.try_recv() {
                Ok(point) => {
                    self.read_at = Instant::now();
                    self.schedule.push(point?)?
                }
                Err(TryRecvError::Disconnected) => {
                    self.complete = true;
                    self.schedule.flush()?
                }
                Err(TryRecvError::Empty) => {
                    let wait = self.schedule.interval_s().map(|s| Duration::from_secs_f64(s).max(LEAST_WAIT));
                    if wait.is_none_or(|wait| self.read_at.elapsed() <= wait) {
                        return Ok(());
                    }
                    // The next line is late: the axis comes to rest here.
                    self.schedule.flush()?
                }
            };
            self.waiting.extend(made);
        }
        // It was not looked for: what waits in the pipe is not late.
        self.read_at = Instant::now();
        Ok(())
    }

    /// Whether something is to be sent now.
    pub(super) fn is_due(&self) -> bool {
        let wanting = !self.waiting.is_empty() || self.complete;
        !self.done && wanting && (self.state.room > 0 || self.asked.elapsed() > ASK_AGAIN)
    }

    /// The next command.
    pub(super) fn command(&mut self) -> SetPoints {
        self.asked = Instant::now();
        let count = usize::from(self.state.room).min(SET_POINTS);
        let mut sent = SetPoints { sequence: self.state.next, ..SetPoints::default() };
        sent.points.extend(self.waiting.iter().take(count).map(|(_, point)| *point));
        sent.last = self.complete && sent.points.len() == self.waiting.len();
        sent
    }

    /// Takes what the board says of itself, also late: numbers only rise.
    pub(super) fn heard(&mut self, now: Following) {
        let taken = now.next.saturating_sub(self.state.next) as usize;
        if now.next >= self.state.next {
            self.waiting.drain(..taken.min(self.waiting.len()));
            self.state = now;
        }
    }

    /// Takes the answer to `sent`.
    pub(super) fn taken(&mut self, sent: &SetPoints, now: Following) {
        self.heard(now);
        // A board that does not know its start yet has no room, and does not take the last flag either.
        self.done = sent.last && self.waiting.is_empty() && (now.next > 0 || now.room > 0);
    }
}
