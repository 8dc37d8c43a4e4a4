//! Moves within limits: trapezoid of velocity and S-curve.

use super::{Setpoint, TrajectoryError, check_tick};
use crate::control::fast::Fast;
use crate::scalar::Real;

/// Most segments of a profile.
const SEGMENTS: usize = 7;

/// Times of a move in whole ticks: what a board is told of it. The acceleration is that of `acceleration` ticks between two
/// phases of `jerk` ticks each; without jerk phases the velocity is a trapezoid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Phases {
    /// Ticks of each of the four phases in which the acceleration changes.
    pub jerk: u32,
    /// Ticks of constant acceleration, and of constant deceleration.
    pub acceleration: u32,
    /// Ticks of constant speed.
    pub cruise: u32,
}

/// Profiles and rests are shorter than this, ticks.
const LONGEST: u64 = 1 << 30;

impl Phases {
    /// All of them together; `None` where that is too long, or where nothing accelerates.
    pub fn ticks(&self) -> Option<u32> {
        let total = 4 * u64::from(self.jerk) + 2 * u64::from(self.acceleration) + u64::from(self.cruise);
        let moves = self.jerk > 0 || self.acceleration > 0;
        (moves && total < LONGEST).then_some(total as u32)
    }

    /// Largest speed (X/s) and acceleration (X/s²) of a move over `distance` (X), both ≥ 0.
    pub fn peaks(&self, distance: f32, tick_hz: f32) -> (f32, f32) {
        let [jerk, acceleration, cruise] = [self.jerk, self.acceleration, self.cruise].map(|ticks| ticks as f32);
        let ramp = jerk + acceleration;
        let speed = distance.abs() * tick_hz / (ramp + jerk + cruise);
        (speed, speed * tick_hz / ramp)
    }

    /// From the times (s) of jerk, constant acceleration and cruise.
    fn from_times(times: [f64; 3], tick_s: f64) -> Result<Self, TrajectoryError> {
        // Rounded up, but not for the last bit of a quotient that is whole.
        let [jerk, acceleration, cruise] = times.map(|t| libm::ceil(t / tick_s - 1e-9).max(0.0));
        let total = 4.0 * jerk + 2.0 * acceleration + cruise;
        if total.is_nan() || total >= LONGEST as f64 - 2.0 {
            return Err(TrajectoryError::Duration);
        }
        // A move needs a tick of acceleration at least.
        let acceleration = if jerk + acceleration > 0.0 { acceleration } else { 1.0 };
        Ok(Self { jerk: jerk as u32, acceleration: acceleration as u32, cruise: cruise as u32 })
    }
}

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

/// A move from 0 to a distance within limits: trapezoid of velocity, or S-curve with limited jerk. It is made once,
/// or back and forth with a rest at both ends.
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
        Self::in_ticks(distance, Self::trapezoid_phases(distance, speed, acceleration, tick_s)?, tick_s)
    }

    /// The times of [`Self::trapezoid`].
    ///
    /// # Errors
    /// [`TrajectoryError`] names the parameter.
    pub fn trapezoid_phases(
        distance: f64,
        speed: f64,
        acceleration: f64,
        tick_s: f64,
    ) -> Result<Phases, TrajectoryError> {
        Self::check(distance, speed, acceleration, tick_s)?;
        let d = distance.abs();
        let reached = speed.min(libm::sqrt(d * acceleration));
        let cruise = if reached > 0.0 { (d / reached - reached / acceleration).max(0.0) } else { 0.0 };
        Phases::from_times([0.0, reached / acceleration, cruise], tick_s)
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
        Self::in_ticks(distance, Self::s_curve_phases(distance, speed, acceleration, jerk, tick_s)?, tick_s)
    }

    /// The times of [`Self::s_curve`].
    ///
    /// # Errors
    /// [`TrajectoryError`] names the parameter.
    pub fn s_curve_phases(
        distance: f64,
        speed: f64,
        acceleration: f64,
        jerk: f64,
        tick_s: f64,
    ) -> Result<Phases, TrajectoryError> {
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
        Phases::from_times([tj, ta, cruise], tick_s)
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
        Ok(self.shuttle(rest as u32))
    }

    /// The same with the rest in ticks, cut at 2³⁰ of them.
    #[must_use]
    pub fn shuttle(self, rest_ticks: u32) -> Self {
        // Both at most 2³⁰.
        Self { half_period: (self.length + rest_ticks.min(LONGEST as u32)).max(1), shuttle: true, ..self }
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

    /// A move over `distance` (X, either sign) in these phases of ticks of `tick_s` s.
    ///
    /// # Errors
    /// [`TrajectoryError::Tick`], [`TrajectoryError::Distance`], [`TrajectoryError::Duration`].
    pub fn in_ticks<F: Real>(distance: F, phases: Phases, tick_s: F) -> Result<Self, TrajectoryError> {
        check_tick(tick_s)?;
        if !distance.is_finite() {
            return Err(TrajectoryError::Distance);
        }
        let length = phases.ticks().ok_or(TrajectoryError::Duration)?;
        let [tj, ta, tv] = [phases.jerk, phases.acceleration, phases.cruise].map(F::from_u32);
        // Speeds and accelerations that cover the distance in these times: none exceeds its limit, as all times grew.
        let v = distance / ((tj + tj + ta + tv) * tick_s);
        let a = v / ((tj + ta) * tick_s);
        let j = if phases.jerk > 0 { a / (tj * tick_s) } else { F::ZERO };
        // Of each segment: its ticks, and acceleration and jerk as multiples of a and j.
        let (jerk, acceleration) = (phases.jerk, phases.acceleration);
        let plan = [
            (jerk, 0, 1),
            (acceleration, 1, 0),
            (jerk, 1, -1),
            (phases.cruise, 0, 0),
            (jerk, 0, -1),
            (acceleration, -1, 0),
            (jerk, -1, 1),
        ];
        let times = |sign: i8, value: F| match sign {
            0 => F::ZERO,
            1 => value,
            _ => -value,
        };
        let real = |value: F| R::from_f64(value.to_f64());
        let mut segments = [Segment::default(); SEGMENTS];
        let (mut used, mut from, mut x, mut speed) = (0, 0, F::ZERO, F::ZERO);
        for (ticks, by_a, by_j) in plan {
            if ticks == 0 {
                continue;
            }
            let (half_a, sixth_j) = (times(by_a, a).scale(0.5), times(by_j, j).scale(1.0 / 6.0));
            if let Some(slot) = segments.get_mut(used) {
                *slot = Segment { from, x: real(x), v: real(speed), half_a: real(half_a), sixth_j: real(sixth_j) };
                used += 1;
            }
            let t = F::from_u32(ticks) * tick_s;
            x += t * (speed + t * (half_a + t * sixth_j));
            speed += t * (half_a + half_a + t * sixth_j.scale(3.0));
            // Below 2³⁰ in all.
            from += ticks;
        }
        Ok(Self {
            segments,
            used,
            length,
            half_period: length,
            shuttle: false,
            distance: real(distance),
            tick: real(tick_s),
        })
    }
}
