//! The settings as the tick needs them: in ticks and counts per tick, nothing left to divide.

use breakaway_core::link::{FULL_SCALE_CODE, Settings};

/// Limits and thresholds of the faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Guards {
    /// Limit: largest drive, drive codes, ≥ 1. Beyond, the drive is cut.
    pub drive_code: i16,
    /// Limit: lowest position, counts. Beyond, the run ends.
    pub travel_min: i32,
    /// Limit: highest position, counts.
    pub travel_max: i32,
    /// Limit: speed over 16 ticks, counts. Beyond, the run ends.
    pub counts_in_16_ticks: u32,
    /// Ticks per second, to report speeds and times.
    pub tick_hz: u32,
    /// Limit: motor current, mA; 0 for none.
    pub current_ma: u32,
    /// Ticks in a row above it that end the run: those of 1 ms. PWM and the edges of a relay are shorter, a winding heats up slower.
    pub current_ticks: u32,
    /// Limit: mean of |drive|, drive codes. Beyond, the run ends.
    pub mean_drive_code: i16,
    /// The mean is a leaky average over 2^shift ticks: about a second.
    pub mean_shift: u8,
    /// Guard: ticks without motion (4 counts) at [`Self::frozen_drive_code`] or more.
    pub frozen_ticks: u32,
    /// Guard: drive at which the axis must move, drive codes.
    pub frozen_drive_code: i16,
    /// Guard: most counts in one tick.
    pub jump_counts: u32,
    /// Guard: work against the drive, in counts at [`Self::frozen_drive_code`].
    pub direction_counts: i32,
    /// Guard: drive and motion are compared over so many ticks: a 64th of a second, 16 ..= 2¹⁰. Long beside the noise of single
    /// counts and short beside the time in which an axis gains speed.
    pub block_ticks: u32,
    /// Guard: late ticks in a row.
    pub overruns: u8,
    /// Guard: ticks without a valid command.
    pub silent_ticks: u32,
    /// The motor is braked after a run.
    pub brake: bool,
    /// The travel limits are referred to a zero that is not known since the reset.
    pub zero_needed: bool,
    /// The encoder counts down when a positive drive moves the axis.
    pub reversed: bool,
}

/// Ticks over which the speed is seen.
pub(super) const SPEED_TICKS: u64 = 16;
/// A reversed encoder shows within hundredths of a revolution; less would be noise or the give of a standing axis.
const LEAST_DIRECTION: u32 = 16;

impl Guards {
    /// From checked settings, at `tick_hz` ticks per second (≥ 1).
    #[must_use]
    pub fn new(settings: &Settings, tick_hz: u32) -> Self {
        let tick_hz = tick_hz.max(1);
        let hz = u64::from(tick_hz);
        let counts_in_16_ticks = (u64::from(settings.speed_max_counts_per_s) * SPEED_TICKS).div_ceil(hz).max(1);
        let silent_ticks = (u64::from(settings.command_timeout_ms) * hz).div_ceil(1000).max(1);
        // The powers of two below them.
        let mean_shift = (u32::BITS - 1 - tick_hz.leading_zeros()).min(16);
        Self {
            drive_code: settings.drive_max_code.clamp(1, FULL_SCALE_CODE),
            travel_min: settings.travel_min_counts,
            travel_max: settings.travel_max_counts,
            counts_in_16_ticks: u32::try_from(counts_in_16_ticks).unwrap_or(u32::MAX),
            tick_hz,
            current_ma: settings.current_max_ma,
            current_ticks: tick_hz.div_ceil(1000),
            mean_drive_code: settings.mean_drive_max_code,
            mean_shift: mean_shift as u8,
            frozen_ticks: settings.frozen_ticks,
            frozen_drive_code: settings.frozen_drive_code,
            jump_counts: settings.jump_counts,
            direction_counts: (settings.counts_per_revolution / 64).max(LEAST_DIRECTION) as i32,
            block_ticks: 1 << mean_shift.saturating_sub(6).max(4),
            overruns: settings.overrun_limit,
            silent_ticks: u32::try_from(silent_ticks).unwrap_or(u32::MAX),
            brake: settings.brake,
            zero_needed: false,
            reversed: settings.encoder_reversed,
        }
    }

    /// These in force of `before`: limits that stay are not known better for it, and new ones count as the axis does now.
    pub(in crate::app) fn after(self, before: &Self) -> Self {
        let same = (self.travel_min, self.travel_max) == (before.travel_min, before.travel_max);
        Self { zero_needed: before.zero_needed && same, ..self }
    }

    /// Ticks as milliseconds, for reports.
    pub(super) fn ms(&self, ticks: u32) -> i32 {
        i32::try_from(u64::from(ticks) * 1000 / u64::from(self.tick_hz.max(1))).unwrap_or(i32::MAX)
    }

    /// Counts in 16 ticks as counts per second, for reports.
    pub(super) fn counts_per_s(&self, counts_in_16_ticks: i32) -> i32 {
        let speed = i64::from(counts_in_16_ticks) * i64::from(self.tick_hz) / SPEED_TICKS as i64;
        speed.clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_speeds_become_ticks() {
        let settings = Settings { speed_max_counts_per_s: 10_000, command_timeout_ms: 250, ..Settings::default() };
        let guards = Guards::new(&settings, 1000);
        assert_eq!((guards.counts_in_16_ticks, guards.silent_ticks, guards.mean_shift), (160, 250, 9));
        assert_eq!((guards.ms(251), guards.counts_per_s(-160)), (251, -10_000));
        // Extremes neither overflow nor become 0.
        let settings = Settings { speed_max_counts_per_s: 1, command_timeout_ms: 3_600_000, ..settings };
        let guards = Guards::new(&settings, u32::MAX);
        assert_eq!((guards.counts_in_16_ticks, guards.silent_ticks), (1, u32::MAX));
        assert_eq!(Guards::new(&settings, 0).mean_shift, 0);
    }
}
