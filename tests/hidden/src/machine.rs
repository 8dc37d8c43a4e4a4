//! Random machines, by seed.

use crate::{law::ForceLaw, world::World};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{PI, TAU};

/// Least amplitude of the high relay's cycle, encoder steps: with the machine's own encoder, and with the world's. With 500
/// counts the first would leave only the machines whose cycles are a third of a turn.
const OWN_STEPS: f64 = 25.0;
const FOREIGN_STEPS: f64 = 12.0;

/// The base parameters of b·ẍ + c·ẋ + f1·sgn ẋ = u.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Base {
    /// Inertia, V·s²/rad.
    pub b: f64,
    /// Viscous coefficient (with back-EMF), V·s/rad.
    pub c: f64,
    /// Coulomb level, V.
    pub f1: f64,
}

/// A random machine: base plant, encoder and drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Machine {
    /// Base parameters.
    pub base: Base,
    /// Encoder step, rad.
    pub encoder_step: f64,
    /// Standard deviation of the Gaussian noise added before quantisation, rad.
    pub noise_sigma: f64,
    /// Largest drive, V.
    pub drive_limit: f64,
    /// A0, the high relay's h1 + h2, V.
    pub amplitude: f64,
}

/// Independent random stream of one seed.
pub fn stream(seed: u64, number: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    rng
}

/// Uniform in the logarithm.
pub fn log_uniform(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    rng.random_range(low.ln()..=high.ln()).exp()
}

impl Machine {
    /// Around the papers' plant: b and c within ×0.3–3, f1 0.2–1 V, 2000–20000 steps per turn, or the world's encoder.
    /// Drawn again until the relays' cycles are neither lost in the encoder nor too slow to repeat.
    pub(crate) fn draw(rng: &mut ChaCha8Rng, world: &World) -> Self {
        loop {
            let base = Base {
                b: 0.02685 * log_uniform(rng, 0.3, 3.0),
                c: 0.11 * log_uniform(rng, 0.3, 3.0),
                f1: log_uniform(rng, 0.2, 1.0),
            };
            let lines = (log_uniform(rng, 2000.0, 20000.0) / 4.0).round() * 4.0;
            let own = (TAU / lines, rng.random_range(0.3..=1.0), OWN_STEPS);
            let (encoder_step, noise_steps, steps) =
                world.encoder.map_or(own, |e| (TAU / f64::from(e.counts), e.noise_steps, FOREIGN_STEPS));
            let machine = Self {
                base,
                encoder_step,
                noise_sigma: noise_steps * encoder_step,
                drive_limit: 5.0,
                amplitude: (7.0 * base.f1).min(4.9),
            };
            let (omega, a) = machine.relay_cycle();
            let period = TAU / omega;
            if (0.08..1.2).contains(&period) && a > steps * encoder_step && a < 4.0 {
                return machine;
            }
        }
    }

    /// Frequency (rad/s) and amplitude (rad) of the high relay's cycle on the base plant, by the
    /// describing function (docs/theory.md, section 2).
    pub(crate) fn relay_cycle(&self) -> (f64, f64) {
        let Base { b, c, f1 } = self.base;
        let (h1, h2) = (0.75 * self.amplitude, 0.25 * self.amplitude);
        let surplus = h2 - f1;
        (h1 * c / (b * surplus), 4.0 * b * surplus * surplus / (PI * c * c * h1))
    }

    /// The base plant.
    pub(crate) fn law(&self) -> ForceLaw {
        ForceLaw { b: self.base.b, c: self.base.c, f1: self.base.f1, ..ForceLaw::default() }
    }
}
