//! What the tick sums for the estimators, in integers.

use breakaway_core::estimate::sine::{BlockSums, StreamingSine};

/// The streaming sine fit of a board, solved in the FPU's numbers.
pub type SineConfig = StreamingSine<f32>;
/// Sums of the streaming sine fit over encoder counts.
pub type Sums = BlockSums<i32, 32>;

/// A stretch of samples being summed. The sums belong to whoever holds them: the thread lends them to the tick by an
/// order and gets them back by an event.
#[derive(Debug)]
pub struct Accumulation<'a> {
    /// The oscillator.
    pub config: SineConfig,
    /// The sums.
    pub sums: &'a mut Sums,
    /// First tick in the sums.
    pub first_tick: u32,
    /// Ticks in the sums; consecutive.
    pub ticks: u32,
}

impl Accumulation<'_> {
    #[inline]
    pub(super) fn push(&mut self, tick: u32, distance: i32) {
        if self.ticks == 0 {
            self.first_tick = tick;
        }
        self.ticks = self.ticks.saturating_add(1);
        self.config.push(self.sums, distance);
    }
}
