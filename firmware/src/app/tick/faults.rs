//! Faults in the tick: the drive goes off first.

use breakaway_core::link::{CommandError, Ending, FaultCause, FaultRecord, Limit};

use super::{Tick, clamped};
use crate::app::control::PositionController;
use crate::app::memory::Remembered;
use crate::board::{Applied, Board, Drive, Protection, Retained, Trip};

impl<B: Board, C: PositionController> Tick<'_, '_, B, C> {
    /// Latches a fault with the numbers that said so.
    #[cold]
    pub(super) fn fail(&mut self, cause: FaultCause, value: i32, limit: i32) {
        let record = FaultRecord {
            cause,
            mode: self.mode(),
            tick: self.now,
            count: self.last_count.unwrap_or(0),
            drive_code: self.applied.code,
            value,
            limit,
        };
        self.latch(record);
    }

    /// Latches a fault. The first stays: what follows from it must not hide it.
    #[cold]
    pub(super) fn latch(&mut self, record: FaultRecord) {
        // Every time, whatever is latched already: this is the one thing that must not be missed.
        let _ = self.switch_off();
        if self.fault.is_some() {
            return;
        }
        // Ended first, so that the fault is what is remembered.
        self.end(Ending::Fault(record.cause));
        self.fault = Some(record);
        self.board.retained().write(Remembered::Fault(record).to_words());
        self.unsent.fault = true;
        self.unsent.news = true;
    }

    #[cold]
    pub(super) fn clear(&mut self) -> Result<(), CommandError> {
        if self.fault.is_none() {
            return Ok(());
        }
        // What has tripped since it was last asked for is forgotten: what lasts is told again.
        let _ = self.board.protection().tripped();
        // A fault that would come back at once is not cleared.
        if self.last_count.is_none() || self.board.protection().tripped().is_some() {
            return Err(CommandError::FaultPersists);
        }
        self.fault = None;
        self.unsent.fault = false;
        self.board.retained().write(Remembered::Nothing.to_words());
        Ok(())
    }

    #[cold]
    pub(super) fn trip(&mut self, trip: Trip) {
        match trip {
            Trip::Break(number) => self.fail(FaultCause::BreakInput, number, 0),
            Trip::EmergencyStop => self.fail(FaultCause::EmergencyStop, 0, 0),
            Trip::OverCurrent(level) => {
                let now = self.current_ma.unwrap_or(0);
                self.fail(FaultCause::OverCurrent, now, clamped(level));
            }
            Trip::Supply(millivolts) => self.fail(FaultCause::Supply, millivolts, 0),
        }
    }

    /// The current is limited: by the time that it may be above the limit.
    #[inline(never)]
    pub(super) fn current(&mut self) {
        let Some(now) = self.current_ma else {
            self.fail(FaultCause::CurrentSensor, 0, clamped(self.guards.current_ma));
            return;
        };
        let above = now.unsigned_abs() > self.guards.current_ma;
        let Some(run) = &mut self.run else { return };
        run.over_current_ticks = if above { run.over_current_ticks.saturating_add(1) } else { 0 };
        if run.over_current_ticks >= self.guards.current_ticks {
            self.end(Ending::Limit { limit: Limit::Current, value: now });
        }
    }

    /// A tick came late: where more than the tolerated number is missing before it, nothing that was going on goes on.
    #[cold]
    pub(super) fn stood_still(&mut self, since_us: u32) {
        let missing = (since_us / self.settings.period_us.max(1)).saturating_sub(1);
        let tolerated = u32::from(self.guards.overruns);
        if missing > tolerated && self.run.is_some() {
            self.fail(FaultCause::TickOverrun, clamped(missing), clamped(tolerated));
        }
    }

    /// A tick came late or took too long.
    #[cold]
    pub(super) fn overrun(&mut self) {
        self.late_in_a_row = self.late_in_a_row.saturating_add(1);
        self.overruns = self.overruns.wrapping_add(1);
        self.unsent.overruns = Some(self.overruns);
        self.unsent.news = true;
        if self.late_in_a_row >= self.guards.overruns && self.run.is_some() {
            self.fail(FaultCause::TickOverrun, i32::from(self.late_in_a_row), i32::from(self.guards.overruns));
        }
    }

    pub(super) fn switch_off(&mut self) -> Result<(), <B::Drive as Drive>::Error> {
        let off = self.board.drive().off();
        self.applied = Applied::default();
        off
    }
}
