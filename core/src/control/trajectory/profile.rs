//! Moves within limits: trapezoid of velocity and S-curve.

use super::{Setpoint, TrajectoryError, check_tick};
use crate::control::fast::Fast;

/// Most segments of a profile.
const SEGMENTS: usize = 7;

/// A piece of a profile: constant jerk from tick `from` on.
#[derive(Clone, Copy, Debug, Default)]
struct Segment<R> {
    from: u32,
    x: R,
    v: R,
    /// ½·acceleration and ⅙·jerk, as Horner's scheme takes them.
    half_a: R,
    sixth_j: R,
}

/// A move from 0 to a distance within limits: trapezoid of velocity, or S-curve with limited jerk; once, or back and
/// forth with a rest at both ends.
#[derive(Clone, Copy, Debug)]
pub struct Profile<R> {
    segments: [Segment<R>; SEGMENTS],
    used: usize,
    /// Ticks of the move.
    length: u32,
    /// Ticks of the move and the rest after it.
    half_period: u32,
    shuttle: bool,
    distance: R,
    tick: R,
}

impl<R: Fast> Profile<R> {
    /// A trapezoid of velocity: at most `speed` (X/s, > 0) and `acceleration` (X/s², > 0), over `distance` (X, either
    /// sign). Phases are rounded up to whole ticks and the speed lowered to fit, so both limits hold and the distance
    /// is exact.
    ///
    /// # Errors
    /// [`TrajectoryError`] names the parameter.
    pub fn trapezoid(distance: f64, speed: f64, acceleration: f64, tick_s: f64) -> Result<Self, TrajectoryError> {
        Self::check(distance, speed, acceleration, tick_s)?;
        let d = distance.abs();
        let reached = speed.min(libm::sqrt(d * acceleration));
        let cruise = if reached > 0.0 { (d / reached - reached / acceleration).max(0.0) } else { 0.0 };
        Self::from_times(distance, [0.0, reached / acceleration, cruise], tick_s)
    }

    /// An S-curve: at most `speed`, `acceleration` and `jerk` (X/s³, > 0), as [`Self::trapezoid`].
    ///
    /// # Errors
    /// [`TrajectoryError`] names the parameter.
    pub fn s_curve(
        distance: f64,
        speed: f64,
        acceleration: f64,
        jerk: f64,
        tick_s: f64,
    ) -> Result<Self, TrajectoryError> {
        Self::check(distance, speed, acceleration, tick_s)?;
        if !(jerk.is_finite() && jerk > 0.0) {
            return Err(TrajectoryError::Jerk);
        }
        let d = distance.abs();
        // Times of jerk and of constant acceleration that reach a peak speed within the acceleration's limit.
        let times = |peak: f64| {
            if peak * jerk >= acceleration * acceleration {
                (acceleration / jerk, peak / acceleration - acceleration / jerk)
            } else {
                (libm::sqrt(peak / jerk), 0.0)
            }
        };
        // Distance of a move that reaches `peak` and stops at once: it grows with the peak, so bisection finds it.
        let needed = |peak: f64| {
            let (tj, ta) = times(peak);
            peak * (2.0 * tj + ta)
        };
        let mut peak = speed;
        if needed(speed) > d {
            let (mut low, mut high) = (0.0, speed);
            for _ in 0..100 {
                let middle = 0.5 * (low + high);
                if needed(middle) > d { high = middle } else { low = middle }
            }
            peak = low;
        }
        let (tj, ta) = times(peak);
        let cruise = if peak > 0.0 { (d / peak - 2.0 * tj - ta).max(0.0) } else { 0.0 };
        Self::from_times(distance, [tj, ta, cruise], tick_s)
    }

    /// The same move, then back after a rest of `rest_s`, and so on without end.
    ///
    /// # Errors
    /// [`TrajectoryError::Duration`] if the rest is negative or too long.
    pub fn back_and_forth(self, rest_s: f64) -> Result<Self, TrajectoryError> {
        let rest = libm::ceil(rest_s / self.tick.to_f64());
        if !(0.0..1_073_741_824.0).contains(&rest) {
            return Err(TrajectoryError::Duration);
        }
        // Both below 2³⁰ and 2³¹.
        Ok(Self { half_period: (self.length + rest as u32).max(1), shuttle: true, ..self })
    }

    /// Ticks of one move, without the rest.
    pub const fn ticks(&self) -> u32 {
        self.length
    }

    /// The reference at tick `k`; it rests at the end.
    pub fn at(&self, k: u32) -> Setpoint<R> {
        if !self.shuttle {
            return self.forward(k);
        }
        // Never 0 by construction; this way no division can panic.
        let turn = k.checked_div(self.half_period).unwrap_or(0);
        let there = self.forward(k.wrapping_sub(turn.wrapping_mul(self.half_period)));
        if turn.is_multiple_of(2) { there } else { Setpoint { x: self.distance - there.x, v: -there.v, a: -there.a } }
    }

    fn forward(&self, k: u32) -> Setpoint<R> {
        if k >= self.length {
            return Setpoint { x: self.distance, v: R::ZERO, a: R::ZERO };
        }
        let mut piece = &self.segments[0];
        for segment in self.segments.iter().take(self.used).skip(1) {
            if k >= segment.from {
                piece = segment;
            }
        }
        // Below 2³¹ by construction.
        let t = R::from_i32(k.wrapping_sub(piece.from) as i32) * self.tick;
        let (half_a, sixth_j) = (piece.half_a, piece.sixth_j);
        let three_j = sixth_j + sixth_j + sixth_j;
        let a = half_a + three_j * t;
        Setpoint { x: piece.x + t * (piece.v + t * (half_a + t * sixth_j)), v: piece.v + t * (half_a + a), a: a + a }
    }

    fn check(distance: f64, speed: f64, acceleration: f64, tick_s: f64) -> Result<(), TrajectoryError> {
        check_tick(tick_s)?;
        if !distance.is_finite() {
            return Err(TrajectoryError::Distance);
        }
        if !(speed.is_finite() && speed > 0.0) {
            return Err(TrajectoryError::Speed);
        }
        if !(acceleration.is_finite() && acceleration > 0.0) {
            return Err(TrajectoryError::Acceleration);
        }
        Ok(())
    }

    /// From the times (s) of jerk, constant acceleration and cruise.
    fn from_times(distance: f64, times: [f64; 3], tick_s: f64) -> Result<Self, TrajectoryError> {
        // Rounded up, but not for the last bit of a quotient that is whole.
        let [tj, ta, tv] = times.map(|t| libm::ceil(t / tick_s - 1e-9).max(0.0));
        // A move needs a tick of acceleration at least.
        let ta = if tj + ta > 0.0 { ta } else { 1.0 };
        let total = 4.0 * tj + 2.0 * ta + tv;
        if total.is_nan() || total >= 1_073_741_824.0 {
            return Err(TrajectoryError::Duration);
        }
        // Speeds and accelerations that cover the distance in these times: none exceeds its limit, as all times grew.
        let v = distance / ((2.0 * tj + ta + tv) * tick_s);
        let a = v / ((tj + ta) * tick_s);
        let j = if tj > 0.0 { a / (tj * tick_s) } else { 0.0 };
        let plan = [(tj, 0.0, j), (ta, a, 0.0), (tj, a, -j), (tv, 0.0, 0.0), (tj, 0.0, -j), (ta, -a, 0.0), (tj, -a, j)];
        let mut segments = [Segment::default(); SEGMENTS];
        let (mut used, mut from, mut x, mut speed) = (0, 0.0, 0.0, 0.0);
        for (ticks, acceleration, jerk) in plan {
            if ticks == 0.0 {
                continue;
            }
            if let Some(slot) = segments.get_mut(used) {
                *slot = Segment {
                    from: from as u32,
                    x: R::from_f64(x),
                    v: R::from_f64(speed),
                    half_a: R::from_f64(0.5 * acceleration),
                    sixth_j: R::from_f64(jerk / 6.0),
                };
                used += 1;
            }
            let t = ticks * tick_s;
            x += t * (speed + t * (0.5 * acceleration + t * jerk / 6.0));
            speed += t * (acceleration + 0.5 * t * jerk);
            from += ticks;
        }
        Ok(Self {
            segments,
            used,
            length: total as u32,
            half_period: total as u32,
            shuttle: false,
            distance: R::from_f64(distance),
            tick: R::from_f64(tick_s),
        })
    }
}
