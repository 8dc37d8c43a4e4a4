//! Watches a dual-relay experiment and says how it ended (docs/theory.md, section 2).
//!
//! Fed once per tick with the error and the drive, it measures each cycle between two interpolated upward zero
//! crossings of the error. The amplitude is √2 times the rms about the mean: the fundamental's to 0.1 %, and
//! insensitive to noise. Beside it are period, mean error, mean drive (the load) and the share of time spent above
//! zero. It is settled when three successive cycles agree within the tolerance times (1 − ρ)/ρ. A deviation that
//! shrinks by ρ per cycle changes by ρ/(1 − ρ) times the last change after the last cycle.

mod cycle;

pub use cycle::Cycle;

use crate::says::says;
use crate::scalar::Real;
use cycle::Meter;

/// What is wrong with the detector's configuration; names the parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DetectorError {
    /// `ts` is not finite and positive.
    SamplePeriod,
    /// `h1` is not finite and positive.
    H1,
    /// `h2` is not finite and positive.
    H2,
    /// `hysteresis` is not finite and non-negative.
    Hysteresis,
    /// `f1` is given, but not finite and non-negative.
    F1,
    /// `tolerance` is not within 1e-5 … 0.2.
    Tolerance,
    /// `timeout_s` is below 16 samples, or more than 2³¹ samples.
    Timeout,
    /// `max_error` is not positive (infinity means no limit).
    MaxError,
}

says! { DetectorError:
    Self::SamplePeriod => "the sampling period must be a finite number above 0",
    Self::H1 => "h1 must be a finite number above 0",
    Self::H2 => "h2 must be a finite number above 0",
    Self::Hysteresis => "the hysteresis must be a finite number, 0 or more",
    Self::F1 => "f1 must be a finite number, 0 or more",
    Self::Tolerance => "the tolerance must be from 1e-5 to 0.2",
    Self::Timeout => "the timeout must be 16 samples or more, and at most 2³¹",
    Self::MaxError => "the largest error must be above 0",
}

/// What the experiment is, and its limits. Position units are the caller's (counts, rad, m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectorSettings<R> {
    /// Sample period, s, > 0.
    pub ts: R,
    /// Amplitude of the relay on the error, drive units, > 0.
    pub h1: R,
    /// Amplitude of the relay on the error's integral, drive units, > 0.
    pub h2: R,
    /// How far past zero the error must be for the relay to switch, position units, ≥ 0. With an encoder it is the
    /// hysteresis in counts plus one half, times the count.
    pub hysteresis: R,
    /// Coulomb friction if it is known; otherwise it is taken as 0 in ρ, and the run itself must show the cycle's origin.
    pub f1: Option<R>,
    /// Relative change of period and amplitude still to come that counts as settled; 1e-5 … 0.2, typically 0.005.
    pub tolerance: R,
    /// The longest time to wait for an ending, s.
    pub timeout_s: R,
    /// The largest |error| allowed, position units.
    pub max_error: R,
}

/// A settled limit cycle. Means over the last three cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitCycle<R> {
    /// Period, s.
    pub period_s: R,
    /// Angular frequency, rad/s.
    pub omega: R,
    /// Amplitude, position units.
    pub amplitude: R,
    /// Mean error, position units.
    pub bias: R,
    /// Mean drive, drive units: the constant load, where there is one.
    pub mean_drive: R,
    /// Cycles seen up to here.
    pub cycles: u32,
    /// Observed or assumed contraction ρ per cycle.
    pub contraction: R,
}

/// Why there is no limit cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoLimitCycleReason {
    /// The axis never left the hysteresis: h1 + h2 ≤ f1, or the drive does not reach it.
    DriveBelowBreakaway,
    /// The motion died: h2 ≤ f1, the relay on the integral cannot feed what friction takes.
    MotionDied,
    /// What oscillates is fed by the sampling delay and the hysteresis, not by h2 − f1: h2 ≤ f1, or barely above.
    SustainedByLag,
    /// h2 ≤ f1 for the f1 given.
    H2NotAboveFriction,
}

impl NoLimitCycleReason {
    /// What to do.
    #[must_use]
    pub const fn advice(self) -> &'static str {
        match self {
            Self::DriveBelowBreakaway => {
                "no motion: h1 + h2 does not exceed the breakaway level f1; raise h1 and h2, or check the drive"
            }
            Self::MotionDied => "the motion dies out: h2 ≤ f1; raise h2",
            Self::SustainedByLag => {
                "the oscillation lives on sampling delay and hysteresis: h2 ≤ f1 or barely above; raise h2, sample faster, or give f1"
            }
            Self::H2NotAboveFriction => "h2 ≤ f1: no limit cycle exists; raise h2 above f1",
        }
    }
}

/// Which limit was passed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limit {
    /// The error left ±`max_error`.
    Error,
    /// The error or the drive was not finite.
    NotFinite,
}

/// How a relay experiment ended. There is no default: an experiment that has not ended has no outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RelayOutcome<R> {
    /// A symmetric limit cycle.
    Settled(LimitCycle<R>),
    /// There is none.
    NoLimitCycle {
        /// Why.
        reason: NoLimitCycleReason,
    },
    /// Settled, but the directions differ in the halves' durations, the mean error, or the mean drive. A constant
    /// load, or friction that depends on the direction, does that.
    Asymmetric {
        /// The cycle's numbers, with its bias.
        cycle: LimitCycle<R>,
        /// (Time above zero − time below)/period, −1 … 1.
        asymmetry: R,
    },
    /// No ending within the time given.
    Timeout {
        /// Cycles seen.
        cycles: u32,
        /// Relative change of period or amplitude from the last cycle but one to the last; 1 if there were none.
        last_change: R,
    },
    /// A limit was passed; the drive must be taken away.
    LimitTripped {
        /// Which.
        which: Limit,
        /// The value that passed it.
        value: R,
    },
}

/// Share of h2 that delay and hysteresis may supply before a cycle is ascribed to them (f1 unknown). On the reference
/// plant (1, 0.49) shows 0.10 at 1 kHz with an ideal encoder; (2, 1.5) shows 0.01.
const MAX_LAG_SHARE: f64 = 0.08;
/// Above this a cycle is called asymmetric: difference of the halves' durations over the period, mean error over the
/// amplitude, mean drive over h2.
const MAX_ASYMMETRY: f64 = 0.05;
/// A motion that has fallen to this part of its largest cycle has died.
const DIED: f64 = 0.02;

/// The detector's configuration, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitCycleDetector<R> {
    settings: DetectorSettings<R>,
    timeout: u32,
}

/// What the detector remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DetectorState<R> {
    meter: Meter<R>,
    /// The last three cycles, newest first.
    recent: [Cycle<R>; 3],
    cycles: u32,
    largest: R,
    reach: R,
    moved_tick: u32,
    tick: u32,
    ended: Option<RelayOutcome<R>>,
}

impl<R: Real> LimitCycleDetector<R> {
    /// Checks a configuration.
    ///
    /// # Errors
    /// [`DetectorError`] names the parameter. That h2 ≤ f1 for a known f1 is no error here: the first tick ends with
    /// that outcome.
    pub fn new(settings: DetectorSettings<R>) -> Result<Self, DetectorError> {
        let positive = |value: R| value.is_finite() && value > R::ZERO;
        let not_negative = |value: R| value.is_finite() && value >= R::ZERO;
        let samples = settings.timeout_s / settings.ts;
        let checks = [
            (positive(settings.ts), DetectorError::SamplePeriod),
            (positive(settings.h1), DetectorError::H1),
            (positive(settings.h2), DetectorError::H2),
            (not_negative(settings.hysteresis), DetectorError::Hysteresis),
            (settings.f1.is_none_or(not_negative), DetectorError::F1),
            (
                settings.tolerance >= R::from_f64(1e-5) && settings.tolerance <= R::from_f64(0.2),
                DetectorError::Tolerance,
            ),
            (samples >= R::from_f64(16.0) && samples < R::from_f64(2_147_483_648.0), DetectorError::Timeout),
            (settings.max_error > R::ZERO, DetectorError::MaxError),
        ];
        for (good, error) in checks {
            if !good {
                return Err(error);
            }
        }
        Ok(Self { settings, timeout: samples.to_u32() })
    }

    /// A state before the first tick.
    pub fn start(&self) -> DetectorState<R> {
        DetectorState {
            meter: Meter::new(),
            recent: [Cycle::NONE; 3],
            cycles: 0,
            largest: R::ZERO,
            reach: R::ZERO,
            moved_tick: 0,
            tick: 0,
            ended: None,
        }
    }

    /// One tick: the error `r − x` in position units, and the drive applied from now on. Returns the ending, once there
    /// is one, and the same on every later tick.
    pub fn push(&self, state: &mut DetectorState<R>, error: R, drive: R) -> Option<RelayOutcome<R>> {
        if state.ended.is_none() {
            state.ended = self.tick(state, error, drive);
        }
        state.ended
    }

    fn tick(&self, state: &mut DetectorState<R>, error: R, drive: R) -> Option<RelayOutcome<R>> {
        let settings = &self.settings;
        for value in [error, drive] {
            if !value.is_finite() {
                let which = Limit::NotFinite;
                return Some(RelayOutcome::LimitTripped { which, value });
            }
        }
        if error.abs() > settings.max_error {
            let which = Limit::Error;
            return Some(RelayOutcome::LimitTripped { which, value: error });
        }
        if settings.f1.is_some_and(|f1| settings.h2 <= f1) {
            let reason = NoLimitCycleReason::H2NotAboveFriction;
            return Some(RelayOutcome::NoLimitCycle { reason });
        }
        state.tick = state.tick.saturating_add(1);
        state.reach = state.reach.max(error.abs());
        if error.abs() > settings.hysteresis {
            state.moved_tick = state.tick;
        }
        if let Some(cycle) = state.meter.push(error, drive, settings.hysteresis) {
            state.recent = [cycle, state.recent[0], state.recent[1]];
            state.cycles = state.cycles.saturating_add(1);
            state.largest = state.largest.max(cycle.amplitude);
            if let Some(outcome) = self.judge(state) {
                return Some(outcome);
            }
        }
        self.watch(state)
    }

    /// After a cycle: settled, died, or go on.
    fn judge(&self, state: &DetectorState<R>) -> Option<RelayOutcome<R>> {
        let [last, second, third] = state.recent;
        if last.amplitude < state.largest * R::from_f64(DIED) {
            return Some(died());
        }
        // The first cycle starts from standstill: it is not one of the three.
        if state.cycles < 4 {
            return None;
        }
        let one = last.change_from(&second);
        let two = second.change_from(&third);
        let rho = self.contraction(one, two);
        let allowed = self.settings.tolerance * (R::ONE - rho) / rho;
        // Written so that a NaN does not settle.
        if !(one <= allowed && two <= allowed) {
            return None;
        }
        if let Some(outcome) = self.fed_by_lag(&last) {
            return Some(outcome);
        }
        let cycle = self.summary(state, rho);
        let asymmetry = (last.asymmetry + second.asymmetry + third.asymmetry) / R::from_f64(3.0);
        let limit = R::from_f64(MAX_ASYMMETRY);
        if asymmetry.abs() > limit
            || cycle.bias.abs() > limit * cycle.amplitude
            || cycle.mean_drive.abs() > limit * self.settings.h2
        {
            return Some(RelayOutcome::Asymmetric { cycle, asymmetry });
        }
        Some(RelayOutcome::Settled(cycle))
    }

    /// ρ = e^(−2(h2−f1)/h1). Without f1 the observed ratio of two changes, but never less than f1 = 0 gives: that is the
    /// fastest settling there can be. Bounded so that the allowed change stays positive and sensible.
    fn contraction(&self, one: R, two: R) -> R {
        let settings = &self.settings;
        let floor = R::from_f64(0.1);
        let ceiling = R::from_f64(0.95);
        // A known f1 is below h2 here: the exponent is negative.
        let rho = |f1: R| (R::from_f64(-2.0) * (settings.h2 - f1) / settings.h1).exp_negative();
        let value = match settings.f1 {
            Some(f1) => rho(f1),
            // Below the tolerance the changes are noise, and their ratio says nothing.
            None if two > settings.tolerance => rho(R::ZERO).max(one / two),
            None => rho(R::ZERO),
        };
        value.max(floor).min(ceiling)
    }

    /// The relay switches half a sample and one hysteresis late, by the angle ω·Ts/2 + ε/a. In the harmonic balance
    /// that is h1 times this angle more of h2. A known f1 < h2 is proof enough that the cycle has its own supply.
    fn fed_by_lag(&self, cycle: &Cycle<R>) -> Option<RelayOutcome<R>> {
        let settings = &self.settings;
        if settings.f1.is_some() {
            return None;
        }
        let angle = R::from_f64(core::f64::consts::PI) / cycle.period + settings.hysteresis / cycle.amplitude;
        let reason = NoLimitCycleReason::SustainedByLag;
        let share = settings.h1 * angle / settings.h2;
        (share > R::from_f64(MAX_LAG_SHARE)).then_some(RelayOutcome::NoLimitCycle { reason })
    }

    /// Endings that no cycle announces: no motion, motion that stopped, time out.
    fn watch(&self, state: &DetectorState<R>) -> Option<RelayOutcome<R>> {
        let quiet = state.tick.saturating_sub(state.moved_tick);
        // Rest longer than an eighth of the time given, and than five of the last periods.
        let patience = (R::from_f64(5.0) * state.recent[0].period).to_u32();
        if quiet > (self.timeout / 8).max(patience) {
            return Some(if state.cycles == 0 && state.reach <= self.settings.hysteresis {
                let reason = NoLimitCycleReason::DriveBelowBreakaway;
                RelayOutcome::NoLimitCycle { reason }
            } else {
                died()
            });
        }
        if state.tick < self.timeout {
            return None;
        }
        let [last, second, _] = state.recent;
        Some(RelayOutcome::Timeout {
            cycles: state.cycles,
            last_change: if state.cycles < 2 { R::ONE } else { last.change_from(&second) },
        })
    }

    fn summary(&self, state: &DetectorState<R>, contraction: R) -> LimitCycle<R> {
        let mean = |value: fn(&Cycle<R>) -> R| {
            let [a, b, c] = &state.recent;
            (value(a) + value(b) + value(c)) / R::from_f64(3.0)
        };
        let period_s = mean(|cycle| cycle.period) * self.settings.ts;
        LimitCycle {
            period_s,
            omega: R::from_f64(core::f64::consts::TAU) / period_s,
            amplitude: mean(|cycle| cycle.amplitude),
            bias: mean(|cycle| cycle.bias),
            mean_drive: mean(|cycle| cycle.mean_drive),
            cycles: state.cycles,
            contraction,
        }
    }
}

fn died<R>() -> RelayOutcome<R> {
    let reason = NoLimitCycleReason::MotionDied;
    RelayOutcome::NoLimitCycle { reason }
}

impl<R: Real> DetectorState<R> {
    /// The last whole cycle, if there is one.
    pub fn last_cycle(&self) -> Option<Cycle<R>> {
        (self.cycles > 0).then_some(self.recent[0])
    }
}
