//! Time on the board.

/// A free-running clock.
pub trait Clock {
    /// Microseconds since an arbitrary start; wraps at 2³² (after 71.6 minutes).
    fn now_us(&self) -> u32;
}

/// Microseconds from `earlier` to `later`, two readings of one [`Clock`] less than 2³² µs apart; the wrap of the
/// clock between them does not matter.
#[must_use]
pub fn elapsed_us(earlier: u32, later: u32) -> u32 {
    later.wrapping_sub(earlier)
}

#[cfg(test)]
mod tests {
    use super::elapsed_us;

    #[test]
    fn the_wrap_of_the_clock_does_not_show() {
        assert_eq!(elapsed_us(100, 350), 250);
        assert_eq!(elapsed_us(u32::MAX - 99, 150), 250);
    }
}
