//! References: position, velocity and acceleration at a tick.
//!
//! All are functions of the tick number alone, so they need no state and do not drift; the caller counts.

use super::fast::Fast;
use crate::estimate::nco::Nco;

/// What the axis should do at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint<R> {
    /// Position, X.
    pub x: R,
    /// Velocity, X/s.
    pub v: R,
    /// Acceleration, X/s².
    pub a: R,
}

/// What is wrong with a trajectory; names the parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrajectoryError {
    /// The tick is not finite and positive.
    Tick,
    /// The amplitude or distance is not finite.
    Distance,
    /// The frequency is not within (0, half the tick rate).
    Frequency,
    /// The largest speed is not finite and positive.
    Speed,
    /// The largest acceleration is not finite and positive.
    Acceleration,
    /// The largest jerk is not finite and positive.
    Jerk,
    /// The profile would take more than 2³⁰ ticks.
    Duration,
    /// No samples.
    Empty,
}

/// `x = A·sin ωt`, from the middle; the velocity at t = 0 is Aω.
#[derive(Clone, Copy, Debug)]
pub struct Sine<R> {
    /// Phase advance per tick, 2⁻³² turns.
    word: u32,
    /// A, Aω, −Aω².
    scale: [R; 3],
    /// A quarter of a turn.
    quarter: R,
}

impl<R: Fast> Sine<R> {
    /// A sine of peak `amplitude` (X) at `frequency_hz`, 0 < f < half the tick rate. The frequency is rounded to a
    /// multiple of 2⁻³² of the tick rate.
    ///
    /// # Errors
    /// [`TrajectoryError`] names the parameter.
    pub fn new(amplitude: f64, frequency_hz: f64, tick_s: f64) -> Result<Self, TrajectoryError> {
        check_tick(tick_s)?;
        if !amplitude.is_finite() {
            return Err(TrajectoryError::Distance);
        }
        let nco = Nco::new(core::f64::consts::TAU * frequency_hz, tick_s).map_err(|_| TrajectoryError::Frequency)?;
        let w = nco.radians_per_sample() / tick_s;
        Ok(Self {
            word: nco.word(),
            scale: [amplitude, amplitude * w, -amplitude * w * w].map(R::from_f64),
            quarter: R::from_f64(0.25),
        })
    }

    /// The reference at tick `k`; it repeats without end.
    pub fn at(&self, k: u32) -> Setpoint<R> {
        let turns = R::from_phase(self.word.wrapping_mul(k));
        let sin = turns.sin_turns();
        let cos = (turns + self.quarter).sin_turns();
        Setpoint { x: self.scale[0] * sin, v: self.scale[1] * cos, a: self.scale[2] * sin }
    }
}

fn check_tick(tick_s: f64) -> Result<(), TrajectoryError> {
    if tick_s.is_finite() && tick_s > 0.0 { Ok(()) } else { Err(TrajectoryError::Tick) }
}

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

/// Positions from a file, one per tick; velocity and acceleration by central differences. It rests at both ends.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a, R> {
    x: &'a [R],
    /// 1/(2·tick), 1/tick².
    per_two_ticks: R,
    per_tick_squared: R,
}

impl<'a, R: Fast> Samples<'a, R> {
    /// Positions (X) at ticks of `tick_s`.
    ///
    /// # Errors
    /// [`TrajectoryError::Tick`] or [`TrajectoryError::Empty`].
    pub fn new(x: &'a [R], tick_s: f64) -> Result<Self, TrajectoryError> {
        check_tick(tick_s)?;
        if x.is_empty() {
            return Err(TrajectoryError::Empty);
        }
        Ok(Self { x, per_two_ticks: R::from_f64(0.5 / tick_s), per_tick_squared: R::from_f64(1.0 / (tick_s * tick_s)) })
    }

    /// The reference at tick `k`; the last position after the end.
    pub fn at(&self, k: u32) -> Setpoint<R> {
        let last = self.x.len().saturating_sub(1);
        let k = (k as usize).min(last);
        let sample = |i: usize| self.x.get(i.min(last)).copied().unwrap_or(R::ZERO);
        let (before, here, after) = (sample(k.saturating_sub(1)), sample(k), sample(k.saturating_add(1)));
        Setpoint {
            x: here,
            v: (after - before) * self.per_two_ticks,
            a: ((after - here) - (here - before)) * self.per_tick_squared,
        }
    }
}

/// A reference of any kind, around the position at which it was started.
#[derive(Clone, Copy, Debug)]
pub enum Trajectory<'a, R> {
    /// Rest at the start.
    Hold,
    /// See [`Sine`].
    Sine(Sine<R>),
    /// See [`Profile`].
    Profile(Profile<R>),
    /// See [`Samples`].
    Samples(Samples<'a, R>),
}

impl<R: Fast> Trajectory<'_, R> {
    /// The reference at tick `k`.
    pub fn at(&self, k: u32) -> Setpoint<R> {
        match self {
            Self::Hold => Setpoint::default(),
            Self::Sine(sine) => sine.at(k),
            Self::Profile(profile) => profile.at(k),
            Self::Samples(samples) => samples.at(k),
        }
    }
}

#[cfg(test)]
mod tests;
