//! The tick.

mod events;
mod faults;
mod orders;

use breakaway_core::excite::waveform::{TABLE_POINTS, Table};
use breakaway_core::link::{Bounds, Ending, FaultCause, FaultRecord, Mode, Sample};

use super::accumulate::Accumulation;
use super::channels::TickEnd;
use super::control::PositionController;
use super::guard::{GuardOutcome, Guards, Observation};
use super::memory::Remembered;
use super::run::{Run, RunLimits, Source};
use crate::board::{Applied, Board, Clock, Drive, Encoder, Protection, Retained, elapsed_us, travel};

/// The tick's own timing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TickSettings {
    /// From one tick to the next, µs, ≥ 2.
    pub period_us: u32,
    /// From a tick's start to its end, µs, below the period.
    pub deadline_us: u32,
}

impl TickSettings {
    /// At `tick_hz` ticks per second, half of a period for each.
    #[must_use]
    pub fn at_rate(tick_hz: u32) -> Self {
        let period_us = (1_000_000 / tick_hz.max(1)).max(2);
        Self { period_us, deadline_us: period_us / 2 }
    }
}

/// The control loop's state.
///
/// [`Tick::tick`] is called once per period from the timer's interrupt, above everything that may take long. Its
/// deadline is [`TickSettings::deadline_us`] after its start. A tick that takes longer, or that starts more than half
/// a period late, does not feed the watchdog. As many of them in a row as the settings say latch
/// [`FaultCause::TickOverrun`] if a run is under way. So do as many that did not come at all, before anything is
/// driven. A core that a debugger has halted therefore does not go on driving.
///
/// It never blocks, never allocates, and cannot panic; experiments use integers only.
pub struct Tick<'q, 'a, B: Board, C: PositionController> {
    board: B,
    controller: C,
    channels: TickEnd<'q, 'a, C::Plan>,
    settings: TickSettings,
    guards: Guards,
    table: Table,
    run: Option<Run>,
    fault: Option<FaultRecord>,
    accumulation: Option<Accumulation<'a>>,
    applied: Applied,
    /// The motor's current in this tick, mA, where it is measured.
    current_ma: Option<i32>,
    /// Added to what the encoder says, counts: where zero is.
    zero_offset: i32,
    now: u32,
    last_count: Option<i32>,
    last_start_us: Option<u32>,
    late_in_a_row: u8,
    overruns: u32,
    unsent: events::Unsent<'a>,
}

impl<'q, 'a, B: Board, C: PositionController> Tick<'q, 'a, B, C> {
    /// Starts with the drive off; in [`Mode::Fault`] if the retained memory holds a fault, or a run that a reset cut
    /// short.
    pub fn new(
        mut board: B,
        controller: C,
        channels: TickEnd<'q, 'a, C::Plan>,
        settings: TickSettings,
        guards: Guards,
    ) -> Self {
        // The power stage is off after reset; a board that cannot even confirm it has a fault.
        let off = board.drive().off();
        board.protection().limit_current(guards.current_ma);
        let remembered = Remembered::from_words(board.retained().read());
        let by_watchdog = board.protection().watchdog_reset();
        let mut tick = Self {
            board,
            controller,
            channels,
            settings,
            guards,
            table: [0; TABLE_POINTS],
            run: None,
            fault: None,
            accumulation: None,
            applied: Applied::default(),
            current_ma: None,
            zero_offset: 0,
            now: 0,
            last_count: None,
            last_start_us: None,
            late_in_a_row: 0,
            overruns: 0,
            unsent: events::Unsent::default(),
        };
        match remembered {
            Remembered::Fault(record) => tick.latch(record),
            Remembered::Panic => tick.fail(FaultCause::Panic, 0, 0),
            Remembered::Running(at) if by_watchdog => tick.fail(FaultCause::Watchdog, clamped(at), 0),
            Remembered::Running(at) => tick.fail(FaultCause::ResetWhileDriven, clamped(at), 0),
            Remembered::Nothing if off.is_err() => tick.fail(FaultCause::DriveStage, 0, 0),
            Remembered::Nothing => tick.board.retained().write(Remembered::Nothing.to_words()),
        }
        tick
    }

    /// What it is doing.
    #[allow(clippy::inline_always, reason = "cheaper than its call, and in every tick of an image built for size")]
    #[inline(always)]
    pub fn mode(&self) -> Mode {
        match (&self.fault, &self.run) {
            (Some(_), _) => Mode::Fault,
            (None, Some(run)) => run.mode,
            (None, None) => Mode::Idle,
        }
    }

    /// The limits in force: those of the settings, tighter during a run that asked for it.
    pub fn limits(&self) -> RunLimits {
        let settings =
            RunLimits::new(&self.guards, Bounds::default(), (self.guards.travel_min, self.guards.travel_max));
        self.run.as_ref().map_or(settings, |run| run.watch.limits())
    }

    /// The board, for what is beside the tick.
    pub fn board(&mut self) -> &mut B {
        &mut self.board
    }

    /// One pass: read encoder → guards → active mode → drive → accumulate estimators → push a sample.
    // One function in every image, so that what is counted in one is what the other takes.
    #[inline(never)]
    pub fn tick(&mut self) {
        let start_us = self.board.clock().now_us();
        let mut in_time = self.on_time(start_us);
        let alive = self.channels.alive();
        if let Ok(count) = self.board.encoder().count() {
            let count = if self.guards.reversed { count.wrapping_neg() } else { count };
            self.take_order(count.wrapping_add(self.zero_offset));
            self.process_reading(count.wrapping_add(self.zero_offset), alive);
            self.take_run(count.wrapping_add(self.zero_offset));
        } else {
            // No sample: a position that was not read must not be recorded.
            self.fail(FaultCause::EncoderError, 0, 0);
            self.last_count = None;
            self.take_order(0);
            self.take_run(0);
        }
        self.send();
        let took_us = elapsed_us(start_us, self.board.clock().now_us());
        in_time &= took_us <= self.settings.deadline_us;
        if in_time {
            self.late_in_a_row = 0;
            self.board.protection().feed_watchdog();
        } else {
            self.overrun();
        }
        self.now = self.now.wrapping_add(1);
    }

    /// Whether this tick starts when it should, up to half a period late.
    fn on_time(&mut self, start_us: u32) -> bool {
        let last = self.last_start_us.replace(start_us);
        let since_us = last.map_or(0, |last| elapsed_us(last, start_us));
        let in_time = since_us <= self.settings.period_us + self.settings.period_us / 2;
        if !in_time {
            self.stood_still(since_us);
        }
        in_time
    }

    fn process_reading(&mut self, count: i32, alive: bool) {
        let moved = self.last_count.map_or(0, |last| travel(last, count));
        self.last_count = Some(count);
        self.current_ma = self.board.protection().current_ma();
        if moved.unsigned_abs() > self.guards.jump_counts {
            self.fail(FaultCause::EncoderJump, moved, clamped(self.guards.jump_counts));
        }
        let mut reference = count;
        if self.run.is_some() {
            self.guard(Observation { count, moved, drive: self.applied.code, alive });
            reference = self.drive(count);
        }
        if let (Some(accumulation), Some(run)) = (&mut self.accumulation, &self.run) {
            accumulation.push(self.now, travel(run.start, count));
        }
        let (drive_code, mode) = (self.applied.code, self.mode());
        let sample = Sample { tick: self.now, count, drive_code, reference, mode, current_ma: self.current_ma };
        // Where the queue is full the sample is lost, and the step in the tick numbers tells.
        let _ = self.channels.samples.enqueue(sample);
    }

    fn guard(&mut self, seen: Observation) {
        if let Some(trip) = self.board.protection().tripped() {
            self.trip(trip);
            return;
        }
        if self.guards.current_ma > 0 {
            self.current();
        }
        let Some(run) = &mut self.run else {
            return;
        };
        match run.watch.check(&self.guards, seen) {
            GuardOutcome::Fine => {}
            GuardOutcome::End(ending) => self.end(ending),
            GuardOutcome::Stop(at) => {
                self.end(Ending::Homed);
                self.zero(seen.count, at);
            }
            GuardOutcome::Fault(cause, value, limit) => self.fail(cause, value, limit),
        }
    }

    /// The controller has no drive: its trajectory is over, or a number is not finite.
    #[cold]
    fn no_drive(&mut self) {
        let Some(ending) = self.controller.ending() else {
            self.fail(FaultCause::NotFinite, 0, 0);
            return;
        };
        if let Some(run) = &mut self.run {
            // This tick was none of it.
            run.ticks = run.ticks.saturating_sub(1);
        }
        self.end(ending);
    }

    /// Applies a drive that is a current, drive codes: by the current loop.
    #[inline(never)]
    fn regulate(&mut self, drive_code: i32) {
        let Some(current_ma) = self.current_ma else {
            self.fail(FaultCause::CurrentSensor, 0, clamped(self.guards.current_ma));
            return;
        };
        let Some(asked) = self.controller.voltage(drive_code, current_ma) else {
            self.fail(FaultCause::NotFinite, 0, 0);
            return;
        };
        match self.board.drive().apply(asked) {
            Ok(applied) => {
                let code = self.controller.applied(asked, applied);
                self.applied = Applied { code, limited: applied.limited };
            }
            Err(_) => self.fail(FaultCause::DriveStage, asked, 0),
        }
    }

    /// Asks the mode for its drive and applies it; the reference in counts.
    fn drive(&mut self, count: i32) -> i32 {
        let Some(run) = &mut self.run else {
            return count;
        };
        if run.max_ticks != 0 && run.ticks >= run.max_ticks {
            self.end(Ending::TimeUp);
            return count;
        }
        run.ticks = run.ticks.saturating_add(1);
        let distance = travel(run.start, count);
        let asked = match &mut run.source {
            Source::Exciter(exciter) => Some(exciter.tick(distance, &self.table)),
            Source::Control => self.controller.tick(distance, &mut self.channels.set_points),
        };
        let limit = i32::from(run.watch.limits().drive_code);
        let (start, regulated) = (run.start, run.regulated);
        let Some((command, reference)) = asked else {
            self.no_drive();
            return count;
        };
        // Not `clamp`, which panics where it cannot see that the limit is positive.
        let cut = command.min(limit).max(-limit);
        if regulated {
            self.regulate(cut);
        } else {
            match self.board.drive().apply(cut) {
                Ok(applied) => self.applied = applied,
                Err(_) => self.fail(FaultCause::DriveStage, command, 0),
            }
        }
        start.wrapping_add(reference)
    }
}

fn clamped(value: u32) -> i32 {
    i32::try_from(value).unwrap_or(i32::MAX)
}
