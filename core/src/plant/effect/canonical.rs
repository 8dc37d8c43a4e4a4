//! One form of an effect among those that mean the same.

use core::f64::consts::{PI, TAU};

use super::{Effect, Role};

impl Effect<f64> {
    /// The same effect with every phase in (−π, π] and the amplitude of every phase not negative. A negative one is
    /// turned by adding π to its phase. Forces differ by the rounding of a phase; a canonical effect is returned to
    /// the bit, and so is a phase that is not finite.
    #[must_use]
    pub fn canonical(mut self) -> Self {
        for (index, parameter) in self.kind.definition().parameters.iter().enumerate() {
            let Role::Phase { of } = parameter.role else { continue };
            let turn_by_half = self.p.get(of).is_some_and(|amplitude| *amplitude < 0.0);
            if let Some(amplitude) = self.p.get_mut(of).filter(|_| turn_by_half) {
                *amplitude = -*amplitude;
            }
            if let Some(phase) = self.p.get_mut(index) {
                *phase = within_half_a_turn(*phase);
                if turn_by_half {
                    *phase = if *phase > 0.0 { *phase - PI } else { *phase + PI };
                }
            }
        }
        self
    }
}

/// The phase in (−π, π]. By the remainder, which is exact but for τ's own rounding: 4e-17 of a phase of many turns.
fn within_half_a_turn(phase: f64) -> f64 {
    if !phase.is_finite() || (phase > -PI && phase <= PI) {
        return phase;
    }
    let rest = libm::remainder(phase, TAU);
    if rest <= -PI { PI } else { rest }
}
