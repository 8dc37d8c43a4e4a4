//! Whether encoder and motor agree on what is forwards.
//!
//! From rest, a drive u does two things to an axis of inertia, friction and elasticity, whatever its sequence of signs is:
//! - work `∫u·v dt = kinetic + elastic energy + losses ≥ 0`;
//! - `∫u·dv = f1·|v| + c·v²/2 + b·∫a² dt ≥ 0` where nothing elastic acts (`u = b·a + c·v + f1·sgn v`; docs/theory.md, section 2).
//!
//! With the wrong sign of v both fall below 0 and go on falling. A rightly connected axis keeps one of them positive.
//! For an elastic or a late axis it is the first. For one that a load drives, or that was coasting, it is the second.
//! So both must fall by what the settings call motion against the drive. What changes its sign often, as noise and
//! the drive that answers it, adds to neither.

use super::settings::Guards;
use crate::board::{FULL_SCALE, travel};

/// Sums since the start of the run, in blocks of a 64th of a second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Direction {
    /// Sum of the drive in the block, drive codes.
    impulse: i32,
    /// Ticks left of the block.
    left: u32,
    /// Count at the start of the block.
    start: i32,
    /// Counts and impulse of the block before; none before the first, at whose start the axis may have been coasting.
    before: Option<(i32, i32)>,
    /// ∫u·v dt, drive codes times ticks times counts.
    work: i64,
    /// ∫u·dv, drive codes times ticks times counts per block; twice.
    gained: i64,
    /// Of the work: the drive at which the axis must move, drive codes times ticks.
    unit: i64,
}

/// Speed gained against full drive, counts per block. Noise of two counts either way changes the difference of two
/// blocks by as much, and no more.
const GAINED_COUNTS: i64 = 8;

impl Direction {
    /// From `start`; `drive` is the one at which the axis must move, drive codes, ≥ 1.
    pub(super) fn new(guards: &Guards, start: i32, drive: i32) -> Self {
        let unit = i64::from(drive) * i64::from(guards.block_ticks);
        Self { impulse: 0, left: guards.block_ticks, start, before: None, work: 0, gained: 0, unit }
    }

    /// One tick; the work in counts at the drive at which the axis must move, where it was done the wrong way.
    #[inline]
    pub(super) fn wrong(&mut self, guards: &Guards, count: i32, drive: i16) -> Option<i32> {
        self.impulse += i32::from(drive);
        self.left = self.left.saturating_sub(1);
        if self.left == 0 { self.block(guards, count) } else { None }
    }

    #[inline(never)]
    fn block(&mut self, guards: &Guards, count: i32) -> Option<i32> {
        let (counts, impulse) = (travel(self.start, count), self.impulse);
        let (counts_before, impulse_before) = self.before.unwrap_or((counts, 0));
        // Over both blocks, whose middles the change of speed lies between. At most 2¹⁰ ticks of 2¹⁵: no overflow.
        let drive = i64::from(impulse + impulse_before);
        self.work = self.work.saturating_add(i64::from(impulse) * i64::from(counts));
        self.gained = self.gained.saturating_add(drive * (i64::from(counts) - i64::from(counts_before)));
        self.before = Some((counts, impulse));
        (self.impulse, self.left, self.start) = (0, guards.block_ticks, count);
        let against = self.work <= -i64::from(guards.direction_counts) * self.unit;
        let full = i64::from(FULL_SCALE) * i64::from(guards.block_ticks);
        let faster = self.gained <= -2 * GAINED_COUNTS * full;
        (against && faster).then(|| self.counts())
    }

    #[cold]
    fn counts(&self) -> i32 {
        (self.work / self.unit.max(1)).clamp(i64::from(i32::MIN), 0) as i32
    }
}
