//! Position on the board.

/// An incremental encoder with a counter behind it.
pub trait Encoder {
    /// Why a count could not be read; [`core::convert::Infallible`] for a timer in encoder mode.
    type Error;

    /// The position now, in counts; wraps at 2³². Called once per tick: it must not block.
    ///
    /// # Errors
    /// The encoder did not answer, or answered with a bad check sum. The caller must not repeat an old count.
    fn count(&mut self) -> Result<i32, Self::Error>;
}

/// Counts moved from `earlier` to `later`, two readings of one [`Encoder`] less than 2³¹ counts apart. The wrap of the
/// counter between them does not matter.
#[must_use]
pub fn travel(earlier: i32, later: i32) -> i32 {
    later.wrapping_sub(earlier)
}

#[cfg(test)]
mod tests {
    use super::travel;

    #[test]
    fn the_wrap_of_the_counter_does_not_show() {
        assert_eq!(travel(10, -5), -15);
        assert_eq!(travel(i32::MAX - 1, i32::MIN + 2), 4);
        assert_eq!(travel(i32::MIN, i32::MAX), -1);
    }
}
