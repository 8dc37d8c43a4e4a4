//! The velocity's sign between two samples, from the central difference at both.

use crate::scalar::Real;

/// A change of sign inside an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge<R> {
    /// Where, as a fraction of the interval.
    pub at: R,
    /// New sign minus old sign.
    pub jump: R,
}

/// The sign over one interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<R> {
    /// Sign at the interval's start.
    pub first: R,
    /// Sign at its end.
    pub last: R,
    /// Integral of the sign times the falling hat function, over an interval of length 1.
    pub weight_before: R,
    /// The same with the rising hat function.
    pub weight_after: R,
    /// The change of sign, if there is one.
    pub edge: Option<Edge<R>>,
}

/// Reads the sign of the straight line from `start` to `end`.
///
/// A difference of exactly 0 (an encoder that does not move around a reversal) has sign 0 as long as it lasts. The
/// edge is then spread over the stay. Noise around 0 makes edges forth and back whose mean is the crossing.
#[inline]
pub fn interval<R: Real>(start: R, end: R) -> Interval<R> {
    let half = R::from_f64(0.5);
    let (first, last) = (start.sgn(), end.sgn());
    if first * last < R::ZERO {
        return crossing(start, end, first, last);
    }
    let sign = if first == R::ZERO { last } else { first };
    Interval { first: sign, last: sign, weight_before: sign * half, weight_after: sign * half, edge: None }
}

fn crossing<R: Real>(start: R, end: R, first: R, last: R) -> Interval<R> {
    let half = R::from_f64(0.5);
    let at = start / (start - end);
    let rising = at * at * half;
    let falling = at - rising;
    Interval {
        first,
        last,
        weight_before: first * falling + last * (half - falling),
        weight_after: first * rising + last * (half - rising),
        edge: Some(Edge { at, jump: last - first }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crossing_in_the_middle_splits_the_hats() {
        // Falling hat: ∫₀^½ (1−t) = 3/8 against 1/8.
        let piece = interval(1.0, -1.0);
        assert_eq!((piece.weight_before, piece.weight_after), (0.25, -0.25));
        assert_eq!(piece.edge, Some(Edge { at: 0.5, jump: -2.0 }));
    }

    #[test]
    fn zero_takes_the_sign_of_the_moving_end() {
        assert_eq!(interval(0.0, 3.0).first, 1.0);
        assert_eq!(interval(-2.0, 0.0).last, -1.0);
        assert_eq!(interval(0.0, 0.0).weight_before, 0.0);
        assert_eq!(interval(f64::NAN, 1.0).edge, None);
    }
}
