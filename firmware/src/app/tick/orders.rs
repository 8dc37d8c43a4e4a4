//! Orders, as the tick takes them: one per tick, and after it a run when none is left.

use breakaway_core::link::{Bounds, CommandError, Ended, Ending, FaultCause, Mode};

use super::Tick;
use crate::app::accumulate::Accumulation;
use crate::app::channels::Order;
use crate::app::control::PositionController;
use crate::app::excite::{Excitation, Exciter};
use crate::app::guard::{Held, Watch};
use crate::app::memory::Remembered;
use crate::app::run::{Run, RunLimits, RunOrder, Source};
use crate::board::{Applied, Board, Drive, Protection, Retained, travel};

impl<B: Board, C: PositionController> Tick<'_, '_, B, C> {
    /// Takes an order, before anything is driven.
    #[allow(clippy::inline_always, reason = "a comparison, in every tick of an image built for size")]
    #[inline(always)]
    pub(super) fn take_order(&mut self, count: i32) {
        if self.channels.orders.ready() {
            self.carry_out(count);
        }
    }

    /// Starts a run, whose first drive is in the next tick: no tick copies a plan and computes a drive.
    #[allow(clippy::inline_always, reason = "two comparisons, in every tick of an image built for size")]
    #[inline(always)]
    pub(super) fn take_run(&mut self, count: i32) {
        if self.channels.runs.ready() && !self.channels.orders.ready() {
            self.begin(count);
        }
    }

    #[cold]
    #[inline(never)]
    fn begin(&mut self, count: i32) {
        let answer = self.mode().idle().and_then(|()| self.start(count));
        let _ = self.channels.runs.dequeue();
        self.answer(answer);
    }

    #[cold]
    #[inline(never)]
    fn carry_out(&mut self, count: i32) {
        let idle = self.mode().idle();
        let Some(order) = self.channels.orders.dequeue() else {
            return;
        };
        match order {
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
                    self.guards = guards.after(&self.guards);
                    self.board.protection().limit_current(self.guards.current_ma);
                }
                self.answer(idle);
            }
            Order::Zero(at) => {
                let answer = idle
                    .and_then(|()| self.last_count.map(|_| self.zero(count, at)).ok_or(CommandError::FaultPersists));
                self.answer(answer);
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

    /// Starts the next run from where it lies: a controller's plan is long, and copied once only.
    fn start(&mut self, count: i32) -> Result<(), CommandError> {
        let Some((order, bounds, current)) = self.channels.runs.peek() else {
            return Ok(());
        };
        let bounds: Bounds = *bounds;
        let guards = &self.guards;
        let mut limits = (guards.travel_min, guards.travel_max);
        let mut held = Held::default();
        let mut push = false;
        if let RunOrder::Excite(excitation) = order {
            (limits, push) = (excitation.travel(guards), matches!(excitation, Excitation::Push { .. }));
            held = Held { peak: excitation.peak(), stop_at: excitation.stop_at() };
        }
        if guards.zero_needed && !push {
            return Err(CommandError::NotZeroed);
        }
        if count < limits.0 || count > limits.1 {
            return Err(CommandError::OutsideTravel);
        }
        let (source, mode) = match order {
            RunOrder::Excite(excitation) => (Source::Exciter(Exciter::new(*excitation)), excitation.mode()),
            RunOrder::Track(plan) => {
                self.controller.start(plan, count);
                (Source::Control, Mode::Track)
            }
            RunOrder::Hold(plan) => {
                self.controller.start(plan, count);
                (Source::Control, Mode::Hold)
            }
        };
        let regulated = current.is_some();
        if let Some(current) = current {
            self.controller.start_current(*current);
        }
        if self.board.drive().enable().is_err() {
            self.fail(FaultCause::DriveStage, 0, 0);
            return Err(CommandError::Faulted);
        }
        self.channels.set_points.clear();
        let watch = Watch::new(&self.guards, RunLimits::new(&self.guards, bounds, limits), count, held);
        self.run = Some(Run {
            source,
            watch,
            start: count,
            ticks: 0,
            max_ticks: bounds.max_ticks,
            mode,
            regulated,
            over_current_ticks: 0,
        });
        self.board.retained().write(Remembered::Running(self.now).to_words());
        Ok(())
    }

    /// Calls the position at `count` `at` from now on.
    #[cold]
    pub(super) fn zero(&mut self, count: i32, at: i32) {
        self.zero_offset = self.zero_offset.wrapping_add(travel(count, at));
        // The count has not moved by it.
        self.last_count = Some(at);
        self.guards.zero_needed = false;
    }

    /// Ends the run, if there is one: the drive goes off, and everything the run had changed goes with it.
    pub(super) fn end(&mut self, ending: Ending) {
        let mode = self.mode();
        let Some(run) = self.run.take() else {
            return;
        };
        let off = if self.brakes(ending) { self.board.drive().brake() } else { self.board.drive().off() };
        self.applied = Applied::default();
        self.board.retained().write(Remembered::Nothing.to_words());
        let saturated = if matches!(run.source, Source::Control) { self.controller.saturated() } else { 0 };
        self.unsent.ended = Some(Ended { mode, ending, tick: self.now, ticks: run.ticks, saturated });
        self.unsent.news = true;
        self.collect();
        if off.is_err() {
            self.fail(FaultCause::DriveStage, 0, 0);
        }
    }

    /// Whether the motor is held after a run that ends so: not by a power stage that has said that it should be off.
    fn brakes(&self, ending: Ending) -> bool {
        let stage = matches!(
            ending,
            Ending::Fault(
                FaultCause::BreakInput
                    | FaultCause::EmergencyStop
                    | FaultCause::OverCurrent
                    | FaultCause::Supply
                    | FaultCause::DriveStage
            )
        );
        self.guards.brake && !stage
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
