//! What the guards see and remember during a run.

use breakaway_core::link::{Ending, FaultCause, Limit};

use super::direction::Direction;
use super::settings::Guards;
use crate::app::run::RunLimits;
use crate::board::travel;

/// What the guards are shown, once per tick.
#[derive(Clone, Copy, Debug)]
pub(in crate::app) struct Observation {
    /// Position now, counts.
    pub count: i32,
    /// Counts moved since the last tick.
    pub moved: i32,
    /// Drive applied since the last tick, drive codes.
    pub drive: i16,
    /// A valid command has arrived since the last tick.
    pub alive: bool,
}

/// What the guards say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::app) enum GuardOutcome {
    /// Go on.
    Fine,
    /// End the run.
    End(Ending),
    /// End the run at a stop, where the count is this.
    Stop(i32),
    /// Latch a fault: cause, value, limit.
    Fault(FaultCause, i32, i32),
}

/// What an excitation does when nothing moves.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::app) struct Held {
    /// The drive that it holds, drive codes.
    pub peak: Option<i32>,
    /// The count at the stop that it seeks.
    pub stop_at: Option<i32>,
}

/// What is remembered from the start of a run.
#[derive(Clone, Copy, Debug)]
pub(in crate::app) struct Watch {
    start: i32,
    limits: RunLimits,
    frozen_drive: i32,
    /// Whether an axis that never moves ends the run (a relay below break-away) rather than be a fault.
    may_stick: bool,
    /// Standing still after motion is a stop, where the count is this.
    stop_at: Option<i32>,
    /// Leaky average of the counts in 16 ticks, times 16.
    speed: i32,
    /// Leaky average of |drive|, times 2^shift: below 2¹⁵·2¹⁶.
    mean_drive: u32,
    /// The count at the last motion: the axis moves when it leaves a window around it.
    anchor: i32,
    /// Ticks since then with a drive at which it must move, in all and whichever way. A drive that changes its sign,
    /// or is weaker for a while, is no motion.
    still_ticks: u32,
    silent_ticks: u32,
    direction: Direction,
    /// The axis has moved since the start of the run.
    moved: bool,
}

/// Counts that are motion: a line of the encoder, in which both channels have changed. With one channel dead the count toggles
/// by 1, and an edge that stands under a transition by 1 too.
const MOTION_COUNTS: u32 = 4;

/// Ticks of the speed's average, as a power of two: with it, 16 times the mean counts per tick.
const SPEED_SHIFT: u32 = 4;

impl Watch {
    /// From `start`, within `limits`.
    pub(in crate::app) fn new(guards: &Guards, limits: RunLimits, start: i32, held: Held) -> Self {
        let Held { peak, stop_at } = held;
        let frozen_drive = i32::from(guards.frozen_drive_code);
        // Cut by the limit it must still be seen.
        let held = peak.map_or(i32::MAX, |peak| (peak.min(i32::from(limits.drive_code)) * 3 / 4).max(1));
        Self {
            start,
            limits,
            frozen_drive: frozen_drive.min(held),
            may_stick: held < frozen_drive || stop_at.is_some(),
            stop_at,
            speed: 0,
            mean_drive: 0,
            anchor: start,
            still_ticks: 0,
            silent_ticks: 0,
            direction: Direction::new(guards, start, frozen_drive.min(held)),
            moved: false,
        }
    }

    pub(in crate::app) fn limits(&self) -> RunLimits {
        self.limits
    }

    /// One tick. Faults come before limits: a run that ends for a limit must not hide what is broken.
    #[inline]
    pub(in crate::app) fn check(&mut self, guards: &Guards, seen: Observation) -> GuardOutcome {
        let distance = travel(self.start, seen.count);
        if travel(self.anchor, seen.count).unsigned_abs() >= MOTION_COUNTS {
            self.anchor = seen.count;
            self.moved = true;
            self.still_ticks = 0;
        } else if i32::from(seen.drive).abs() >= self.frozen_drive {
            self.still_ticks = self.still_ticks.saturating_add(1);
            if self.still_ticks >= guards.frozen_ticks {
                return self.frozen(guards);
            }
        }
        if let Some(counts) = self.direction.wrong(guards, seen.count, seen.drive) {
            return GuardOutcome::Fault(FaultCause::WrongDirection, counts, guards.direction_counts);
        }
        self.silent_ticks = if seen.alive { 0 } else { self.silent_ticks.saturating_add(1) };
        if self.silent_ticks >= guards.silent_ticks {
            let limit = guards.ms(guards.silent_ticks);
            return GuardOutcome::Fault(FaultCause::LinkLost, guards.ms(self.silent_ticks), limit);
        }
        self.limit(guards, seen, distance)
    }

    fn limit(&mut self, guards: &Guards, seen: Observation, distance: i32) -> GuardOutcome {
        let end = |limit, value| GuardOutcome::End(Ending::Limit { limit, value });
        if distance.unsigned_abs() > self.limits.travel_counts {
            return end(Limit::Bound, distance);
        }
        if seen.count < self.limits.travel.0 || seen.count > self.limits.travel.1 {
            return end(Limit::Travel, seen.count);
        }
        let speed = self.speed >> SPEED_SHIFT;
        // One tick's counts are bounded by the jump guard only: saturate, do not wrap.
        self.speed = self.speed.saturating_add(seen.moved.saturating_mul(1 << SPEED_SHIFT).saturating_sub(speed));
        let speed = self.speed >> SPEED_SHIFT;
        if speed.unsigned_abs() > guards.counts_in_16_ticks {
            return end(Limit::Speed, guards.counts_per_s(speed));
        }
        let drive = u32::from(seen.drive.unsigned_abs());
        let mean = self.mean_drive >> guards.mean_shift;
        self.mean_drive = self.mean_drive - mean + drive;
        if mean > u32::from(guards.mean_drive_code.unsigned_abs()) {
            return end(Limit::MeanDrive, mean as i32);
        }
        GuardOutcome::Fine
    }

    /// An axis that never moved may simply be stuck below break-away. One that did move, or one under a drive at
    /// which it must move, has lost its encoder.
    #[cold]
    fn frozen(&self, guards: &Guards) -> GuardOutcome {
        if let (Some(at), true) = (self.stop_at, self.moved) {
            return GuardOutcome::Stop(at);
        }
        if self.may_stick && !self.moved {
            return GuardOutcome::End(Ending::NoLimitCycle);
        }
        let ticks = |ticks| i32::try_from(ticks).unwrap_or(i32::MAX);
        GuardOutcome::Fault(FaultCause::EncoderFrozen, ticks(self.still_ticks), ticks(guards.frozen_ticks))
    }
}
