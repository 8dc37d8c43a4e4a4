//! Orders, as the tick takes them: one per tick.

use breakaway_core::link::{Bounds, CommandError, Ended, Ending, FaultCause, Mode};

use super::Tick;
use crate::app::accumulate::Accumulation;
use crate::app::channels::Order;
use crate::app::control::Controller;
use crate::app::excite::Exciter;
use crate::app::guard::Watch;
use crate::app::memory::Remembered;
use crate::app::run::{Run, RunLimits, RunOrder, Source};
use crate::board::{Board, Drive, Retained};

impl<'a, B: Board, C: Controller> Tick<'_, 'a, B, C> {
    #[inline]
    pub(super) fn obey(&mut self, count: i32) {
        if let Some(order) = self.channels.orders.dequeue() {
            self.carry_out(order, count);
        }
    }

    #[cold]
    fn carry_out(&mut self, order: Order<'a, C::Plan>, count: i32) {
        let idle = match self.mode() {
            Mode::Idle => Ok(()),
            Mode::Fault => Err(CommandError::Faulted),
            mode => Err(CommandError::Busy(mode)),
        };
        match order {
            Order::Run(run, bounds) => {
                let answer = idle.and_then(|()| self.start(&run, bounds, count));
                self.answer(answer);
            }
            Order::Stop => {
                self.end(Ending::Stopped);
                self.answer(Ok(()));
            }
            Order::ClearFault => {
                let answer = self.clear();
                self.answer(answer);
            }
            Order::Guards(guards) => {
                if idle.is_ok() {
                    // The sign of the count may change with it.
                    self.last_count = None;
                    self.guards = guards;
                }
                self.answer(idle);
            }
            Order::Waveform(part) => {
                if idle.is_ok() {
                    let points = self.table.iter_mut().skip(usize::from(part.offset));
                    points.zip(&part.points).for_each(|(point, value)| *point = *value);
                }
                self.answer(idle);
            }
            Order::End(ending) => self.end(ending),
            Order::Fault(record) => self.latch(record),
            Order::Accumulate(config, sums) => {
                self.accumulation = Some(Accumulation { config, sums, first_tick: 0, ticks: 0 });
                if self.run.is_none() {
                    self.collect();
                }
            }
            Order::Collect => self.collect(),
        }
    }

    fn answer(&mut self, answer: Result<(), CommandError>) {
        self.unsent.answer = Some(answer);
        self.unsent.news = true;
    }

    fn start(&mut self, order: &RunOrder<C::Plan>, bounds: Bounds, count: i32) -> Result<(), CommandError> {
        if count < self.guards.travel_min || count > self.guards.travel_max {
            return Err(CommandError::OutsideTravel);
        }
        let (source, peak) = match order {
            RunOrder::Excite(excitation) => (Source::Exciter(Exciter::new(*excitation)), excitation.peak()),
            RunOrder::Track(plan) => (self.control(plan, Mode::Track, count), None),
            RunOrder::Hold(plan) => (self.control(plan, Mode::Hold, count), None),
        };
        if self.board.drive().enable().is_err() {
            self.fail(FaultCause::DriveStage, 0, 0);
            return Err(CommandError::Faulted);
        }
        let watch = Watch::new(&self.guards, RunLimits::new(&self.guards, bounds), count, peak);
        self.run = Some(Run { source, watch, start: count, ticks: 0, max_ticks: bounds.max_ticks });
        self.board.retained().write(Remembered::Running(self.now).to_words());
        Ok(())
    }

    fn control(&mut self, plan: &C::Plan, mode: Mode, count: i32) -> Source {
        self.controller.start(plan, count);
        Source::Control(mode)
    }

    /// Ends the run, if there is one: the drive goes off, and everything the run had changed goes with it.
    pub(super) fn end(&mut self, ending: Ending) {
        let mode = self.mode();
        let Some(run) = self.run.take() else {
            return;
        };
        let off = self.switch_off();
        self.board.retained().write(Remembered::Nothing.to_words());
        self.unsent.ended = Some(Ended { mode, ending, tick: self.now, ticks: run.ticks });
        self.unsent.news = true;
        self.collect();
        if off.is_err() {
            self.fail(FaultCause::DriveStage, 0, 0);
        }
    }

    /// Hands the sums back with the next events.
    fn collect(&mut self) {
        // No second one can come before the first is sent: the thread has only one to lend.
        if let Some(done) = self.accumulation.take() {
            self.unsent.sums = Some(done);
            self.unsent.news = true;
        }
    }
}
