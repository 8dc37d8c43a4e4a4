//! The period of a limit cycle, in ticks.

/// Times upward crossings of the error. The first cycle starts from standstill and is not counted.
#[derive(Clone, Copy, Debug)]
pub(super) struct CycleTimer {
    hysteresis: i32,
    below: bool,
    crossings: u32,
    since: u32,
}

impl CycleTimer {
    pub(super) fn new(hysteresis_counts: u32) -> Self {
        Self { hysteresis: i32::try_from(hysteresis_counts).unwrap_or(i32::MAX), below: false, crossings: 0, since: 0 }
    }

    /// Takes the error in counts; the cycle's length in ticks when one is complete.
    pub(super) fn push(&mut self, error: i32) -> Option<f32> {
        self.since = self.since.saturating_add(1);
        if error < -self.hysteresis {
            self.below = true;
        }
        if !(self.below && error > self.hysteresis) {
            return None;
        }
        self.below = false;
        self.crossings = self.crossings.saturating_add(1);
        let period = core::mem::take(&mut self.since);
        (self.crossings >= 3).then_some(period as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::CycleTimer;

    #[test]
    fn the_first_cycles_are_passed_over_and_noise_is_not_a_cycle() {
        let mut timer = CycleTimer::new(2);
        let wave = |k: i32| if (k / 10) % 2 == 0 { 3 } else { -3 };
        let found: std::vec::Vec<(i32, f32)> =
            (0..100).filter_map(|k| timer.push(wave(k)).map(|period| (k, period))).collect();
        assert_eq!(found, [(60, 20.0), (80, 20.0)]);
        let mut timer = CycleTimer::new(4);
        assert!((0..1000).all(|k| timer.push(wave(k)).is_none()));
    }
}
