//! One cycle's numbers, between two interpolated upward zero crossings of the error.

use crate::scalar::Real;

/// One cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle<R> {
    /// Period in samples, interpolated.
    pub period: R,
    /// √2·rms of the error about its mean, position units.
    pub amplitude: R,
    /// Mean error, position units.
    pub bias: R,
    /// Mean drive, drive units.
    pub mean_drive: R,
    /// (Time above zero − time below)/period.
    pub asymmetry: R,
}

impl<R: Real> Cycle<R> {
    pub(super) const NONE: Self =
        Self { period: R::ZERO, amplitude: R::ZERO, bias: R::ZERO, mean_drive: R::ZERO, asymmetry: R::ZERO };

    /// The larger relative change of period and amplitude.
    pub(super) fn change_from(&self, before: &Self) -> R {
        let change = |now: R, then: R| (now - then).abs() / now.max(then);
        change(self.period, before.period).max(change(self.amplitude, before.amplitude))
    }
}

/// Sums over the running cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Meter<R> {
    previous: R,
    drive: R,
    armed: bool,
    running: bool,
    /// Part of the first interval that lies in this cycle.
    head: R,
    falling: R,
    samples: u32,
    sum: R,
    square: R,
    drive_sum: R,
}

impl<R: Real> Meter<R> {
    pub(super) fn new() -> Self {
        Self {
            previous: R::ZERO,
            drive: R::ZERO,
            armed: false,
            running: false,
            head: R::ZERO,
            falling: R::ZERO,
            samples: 0,
            sum: R::ZERO,
            square: R::ZERO,
            drive_sum: R::ZERO,
        }
    }

    /// Takes a sample; returns the cycle that it ends. The crossing is armed by the error leaving `hysteresis` below
    /// zero, so that noise makes no cycles.
    pub(super) fn push(&mut self, error: R, drive: R, hysteresis: R) -> Option<Cycle<R>> {
        let (before, held) = (self.previous, self.drive);
        self.previous = error;
        self.drive = drive;
        let fraction = before.abs() / (before.abs() + error.abs()).max(R::from_f64(1e-30));
        let mut ended = None;
        if self.armed && error >= R::ZERO {
            self.armed = false;
            if self.running {
                ended = Some(self.close(fraction, before, held));
            }
            *self = Self {
                previous: error,
                drive,
                running: true,
                head: R::ONE - fraction,
                drive_sum: held * (R::ONE - fraction),
                ..Self::new()
            };
        } else {
            self.samples = self.samples.saturating_add(1);
            self.sum += before;
            self.square += before * before;
            self.drive_sum += held;
            if !self.armed && error < -hysteresis {
                self.armed = true;
            }
            if before >= R::ZERO && error < R::ZERO {
                self.falling = self.head + (R::from_u32(self.samples) - R::ONE) + fraction;
            }
        }
        ended
    }

    fn close(&self, fraction: R, before: R, held: R) -> Cycle<R> {
        let count = R::from_u32(self.samples) + R::ONE;
        let period = self.head + R::from_u32(self.samples) + fraction;
        let bias = (self.sum + before) / count;
        let power = (self.square + before * before) / count - bias * bias;
        let two = R::ONE + R::ONE;
        Cycle {
            period,
            amplitude: (two * power).sqrt(),
            bias,
            mean_drive: (self.drive_sum + held * fraction) / period,
            asymmetry: (two * self.falling - period) / period,
        }
    }
}
