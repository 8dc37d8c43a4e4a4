//! Presliding friction (Dahl, LuGre): Strang splitting of kick and drift. The bristle rate |v|·σ0/g
//! can be far above the sub-step's, so the bristle is solved exactly for the drift's constant velocity.

use crate::{
    law::{Bristle, ForceLaw},
    plant::{State, sign},
};

impl ForceLaw {
    pub(crate) fn advance_bristle(&self, bristle: &Bristle, s: &mut State, t: f64, h: f64, u: f64) {
        self.kick(bristle, s, t, 0.5 * h, u);
        s.x += h * s.v;
        s.x2 += h * s.v2;
        let level = self.sliding_level(s.x, s.v, t + 0.5 * h, u);
        s.z = deflect(bristle, s.z, s.v, level, h);
        self.kick(bristle, s, t + 0.5 * h, 0.5 * h, u);
        s.slide = sign(s.v);
    }

    /// Velocity change over h at fixed positions and bristle, by the midpoint rule.
    fn kick(&self, bristle: &Bristle, s: &mut State, t: f64, h: f64, u: f64) {
        let accelerate = |at: &State| {
            let level = self.sliding_level(at.x, at.v, t, u);
            let friction = bristle.sigma0 * at.z + bristle.sigma1 * (at.v - bristle.sigma0 * at.v.abs() / level * at.z);
            self.accelerations(at, t, self.free_force(at, t, u) - friction)
        };
        let (a, a2) = accelerate(s);
        let half = State { v: s.v + 0.5 * h * a, v2: s.v2 + 0.5 * h * a2, ..*s };
        let (a, a2) = accelerate(&half);
        s.v += h * a;
        s.v2 += h * a2;
    }
}

/// Bristle deflection after h at constant v and level: ż = v − σ0·|v|·z/level.
pub fn deflect(bristle: &Bristle, z: f64, v: f64, level: f64, h: f64) -> f64 {
    let steady = level / bristle.sigma0 * sign(v);
    steady + (z - steady) * (-v.abs() * h * bristle.sigma0 / level).exp()
}
