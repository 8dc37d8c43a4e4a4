//! The direction of the friction at every sample, by an extended Kalman filter with the drive as its input.
//!
//! A velocity that is made of positions alone needs several of them. So it blurs each reversal and each rest, and the
//! blur is as large as a missing effect. The filter predicts the motion from one reading to the next by the drive and
//! the friction. The friction is statistically linearised: E[sgn v] = erf(v/√2σ_v) (Gelb 1974, *Applied Optimal
//! Estimation*, section 6.2). At rest that is the share of f1 that holds against the drive.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_PI};

use breakaway_core::plant::effect::{ActsIn, Held, Instant};
use breakaway_core::plant::{Base, Effect};
use nalgebra::Matrix3;

use super::dataset::Piece;

/// Longest step of the prediction, s: the drive of a slow sensor's interval is taken in such steps.
const STEP_S: f64 = 1e-3;
/// Standard deviation of the first velocity over the largest that counts as rest.
const FIRST: f64 = 20.0;

/// What the filter is told of the machine.
#[derive(Clone, Debug)]
pub(super) struct FrictionObserver {
    /// The base; b and f1 are positive.
    pub base: Base<f64>,
    /// Known effects. Only those that act as a force or on the drive count, and of their past nothing is told.
    pub effects: Vec<Effect<f64>>,
    /// Rms of the force that the base lacks, drive units.
    pub lacking_u: f64,
    /// Rate at which that force changes, 1/s.
    pub rate_per_s: f64,
    /// Velocity that is not told from rest, position units/s.
    pub rest: f64,
}

/// Position, velocity, and the force that the base lacks; and their covariance.
#[derive(Clone, Copy, Debug)]
struct State {
    x: f64,
    v: f64,
    w: f64,
    p: Matrix3<f64>,
}

impl FrictionObserver {
    /// Mean direction of the friction in the half intervals about each sample, −1..1. The drive `u` has arrived.
    pub(super) fn directions(&self, piece: &Piece, u: &[f64]) -> Vec<f64> {
        let halves = ((0.5 * piece.h_s / STEP_S).ceil() as usize).max(1);
        let step_s = 0.5 * piece.h_s / halves as f64;
        let noise = piece.sigma * piece.sigma;
        let first = piece.x.first().copied().unwrap_or(0.0);
        let variances = [noise, (FIRST * self.rest).powi(2), self.lacking_u.powi(2)];
        let p = Matrix3::from_diagonal(&variances.into());
        let mut state = State { x: first, v: 0.0, w: 0.0, p };
        let mut directions = vec![0.0; piece.x.len()];
        for k in 1..piece.x.len() {
            // The drive of a sample is its mean over the half intervals about it.
            for own in [k - 1, k] {
                let sum: f64 = (0..halves).map(|_| self.step(&mut state, (u[own], piece.t[own]), step_s)).sum();
                directions[own] += 0.5 * sum / halves as f64;
            }
            state.correct(piece.x[k], noise);
        }
        // Only one half interval is known of the first and the last sample.
        for end in [0, directions.len().saturating_sub(1)] {
            directions.get_mut(end).into_iter().for_each(|direction| *direction = (2.0 * *direction).clamp(-1.0, 1.0));
        }
        directions
    }

    /// The expected sign of the velocity, and its slope.
    fn sign(&self, state: &State) -> (f64, f64) {
        let deviation = (state.p[(1, 1)].max(0.0) + self.rest * self.rest).sqrt();
        let z = state.v / deviation;
        let slope = FRAC_2_PI.sqrt() / deviation * (-0.5 * z * z).exp();
        (libm::erf(z * FRAC_1_SQRT_2), slope)
    }

    /// Inertia, level of the friction, and the force that moves the axis beside friction and viscous force.
    fn forces(&self, state: &State, u: f64, t: f64) -> [f64; 3] {
        let mut at = Instant { t, x: state.x, v: state.v, u, over_s: 0.0 };
        let acting = |place: ActsIn| self.effects.iter().filter(move |effect| effect.kind.acts_in() == place);
        for effect in acting(ActsIn::Drive) {
            let past = Held { u: &[u], ts: STEP_S, from_s: 0.0 };
            at.u = effect.drive(&at, past, &mut [0.0; 3], STEP_S);
        }
        let (mut inertia, mut level, mut force) = (self.base.b, self.base.f1, at.u);
        for effect in acting(ActsIn::Force) {
            inertia *= effect.inertia(t, &[0.0; 3]);
            level += effect.level(&self.base, &at);
            force += effect.force(&at);
        }
        [inertia, level.max(0.0), force]
    }

    /// Predicts the state after a step, and gives the mean direction within it. The velocity is integrated by the
    /// exponential Euler method, because friction near rest is stiff.
    fn step(&self, state: &mut State, (u, t): (f64, f64), step_s: f64) -> f64 {
        let c = self.base.c;
        let [b, f1, u] = self.forces(state, u, t);
        let (sign, slope) = self.sign(state);
        let rate = (c + f1 * slope) / b;
        let acceleration = (u + state.w - c * state.v - f1 * sign) / b;
        let decay = (-rate * step_s).exp();
        let slow = rate * step_s < 1e-6;
        let to_v = if slow { step_s } else { (1.0 - decay) / rate };
        let to_x = if slow { 0.5 * step_s * step_s } else { (step_s - to_v) / rate };
        state.x += state.v * step_s + acceleration * to_x;
        state.v += acceleration * to_v;
        let kept = (-self.rate_per_s * step_s).exp();
        state.w *= kept;
        let fresh = self.lacking_u.powi(2) * (1.0 - kept * kept);
        let transition = Matrix3::new(1.0, to_v, to_x / b, 0.0, decay, to_v / b, 0.0, 0.0, kept);
        state.spread(&transition, fresh);
        0.5 * (sign + self.sign(state).0)
    }
}

impl State {
    /// The covariance after a step with this transition; `fresh` is the new variance of the force.
    fn spread(&mut self, transition: &Matrix3<f64>, fresh: f64) {
        self.p = transition * self.p * transition.transpose();
        self.p[(2, 2)] += fresh;
    }

    /// Takes a position with noise of this variance into account.
    fn correct(&mut self, x: f64, noise: f64) {
        let variance = self.p[(0, 0)] + noise;
        let gain = self.p.column(0) / variance;
        let innovation = x - self.x;
        self.x += gain[0] * innovation;
        self.v += gain[1] * innovation;
        self.w += gain[2] * innovation;
        self.p -= gain * gain.transpose() * variance;
    }
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Kind;

    use super::*;

    /// An axis at rest under a drive of .2 against a load of .1 that is known: a quarter of the friction of .4 holds it. The
    /// linearised friction creeps a little at rest, and the filter takes that for a force. So it is within a tenth. A drive
    /// that drags the axis on makes it 1.
    #[test]
    fn at_rest_friction_holds_what_is_left_of_the_drive() {
        let observer = FrictionObserver {
            base: Base { b: 0.02, c: 0.1, f1: 0.4 },
            effects: vec![Effect::new(Kind::ConstantLoad, &[0.1])],
            lacking_u: 0.01,
            rate_per_s: 10.0,
            rest: 1e-3,
        };
        let t: Vec<f64> = (0..400).map(|k| 5e-3 * f64::from(k)).collect();
        let of = |x: Vec<f64>, u: f64| {
            let piece = Piece { recording: 0, h_s: 5e-3, u: vec![u; x.len()], x, t: t.clone(), sigma: 1e-4 };
            observer.directions(&piece, &piece.u)[390]
        };
        let held = of(vec![0.0; 400], 0.2);
        assert!((held - 0.25).abs() < 0.025, "{held}");
        // .6 V against .1 V of load and .4 V of friction leave 1 rad/s of a viscous .1 V·s/rad.
        let dragged = of(t.clone(), 0.6);
        assert!(dragged > 0.999, "{dragged}");
    }
}
