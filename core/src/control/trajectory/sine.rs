//! A sine.

use super::{Setpoint, TrajectoryError, check_tick};
use crate::control::fast::Fast;
use crate::excite::waveform::phase_step;
use crate::scalar::Real;
use crate::scalar::nco::Nco;

/// `x = A·sin ωt`, from the middle; the velocity at t = 0 is Aω.
#[derive(Clone, Copy, Debug)]
pub struct Sine<R> {
    /// Phase advance per tick, 2⁻³² turns.
    word: u32,
    /// A, Aω, −Aω².
    scale: [R; 3],
}

impl<R: Fast> Sine<R> {
    /// A sine of peak `amplitude` (X) at `frequency_hz`, 0 < f < half the tick rate. The frequency is rounded to a
    /// multiple of 2⁻³² of the tick rate.
    ///
    /// # Errors
    /// [`TrajectoryError`] names the parameter.
    pub fn new(amplitude: f64, frequency_hz: f64, tick_s: f64) -> Result<Self, TrajectoryError> {
        check_tick(tick_s)?;
        let nco = Nco::new(core::f64::consts::TAU * frequency_hz, tick_s).map_err(|_| TrajectoryError::Frequency)?;
        Self::of_word(nco.word(), amplitude, tick_s)
    }

    /// The same by its period, at least 2 ticks: what a board is told.
    ///
    /// # Errors
    /// [`TrajectoryError`] names the parameter.
    pub fn of_period<F: Real>(amplitude: F, period_ticks: F, tick_s: F) -> Result<Self, TrajectoryError> {
        check_tick(tick_s)?;
        Self::of_word(phase_step(period_ticks).ok_or(TrajectoryError::Frequency)?, amplitude, tick_s)
    }

    fn of_word<F: Real>(word: u32, amplitude: F, tick_s: F) -> Result<Self, TrajectoryError> {
        if !amplitude.is_finite() {
            return Err(TrajectoryError::Distance);
        }
        let w = F::from_u32(word).scale(core::f64::consts::TAU / 4_294_967_296.0) / tick_s;
        let scale = [amplitude, amplitude * w, -amplitude * w * w].map(|value| R::from_f64(value.to_f64()));
        Ok(Self { word, scale })
    }

    /// The reference at tick `k`; it repeats without end.
    pub fn at(&self, k: u32) -> Setpoint<R> {
        let (sin, cos) = R::from_phase(self.word.wrapping_mul(k)).sin_cos_turns();
        Setpoint { x: self.scale[0] * sin, v: self.scale[1] * cos, a: self.scale[2] * sin }
    }
}
