//! The base plant with a constant load, event-exact: closed form between events, reversals and stick solved for.
//!
//! `b·v̇ = u − f0 − c·v − f1·sgn v` with constant u is linear between reversals (docs/theory.md, section 1):
//! `v(t) = v0·e^(−rt) + (w/b)·t·φ1(rt)`, `x(t) = x0 + v0·t·φ1(rt) + (w/b)·t²·φ2(rt)`, `r = c/b`, `w = u − f0 − f1·sgn v`.

use breakaway_core::plant::Base;

/// The plant and where it is.
#[derive(Clone, Copy, Debug)]
pub struct Exact {
    /// Parameters.
    pub base: Base<f64>,
    /// Constant load f0, drive units; positive resists positive motion.
    pub load: f64,
    /// Position.
    pub x: f64,
    /// Velocity.
    pub v: f64,
}

/// φ1, φ2, φ3 at `z`: `φ1 = (1 − e^(−z))/z`, `φ2 = (1 − φ1)/z`, `φ3 = (½ − φ2)/z`.
fn phi(z: f64) -> (f64, f64, f64) {
    if z.abs() < 0.05 {
        // Alternating series Σ (−z)^k / (k + n)!; eight terms are exact to 1e-17 here.
        let mut sums = [0.0; 3];
        for (n, sum) in sums.iter_mut().enumerate() {
            let mut term = 1.0 / [1.0, 2.0, 6.0][n];
            for k in 0..8 {
                *sum += term;
                term *= -z / (k + n + 2) as f64;
            }
        }
        (sums[0], sums[1], sums[2])
    } else {
        let phi1 = -(-z).exp_m1() / z;
        let phi2 = (1.0 - phi1) / z;
        (phi1, phi2, (0.5 - phi2) / z)
    }
}

/// Free motion under a constant drive from one event to the next.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    x0: f64,
    v0: f64,
    a: f64,
    rate: f64,
    /// Time at which the velocity is zero; infinite if it never is, and for a body at rest.
    pub reversal_s: f64,
}

impl Arc {
    /// Position, velocity and ∫(x) dt after `t` seconds.
    pub fn at(&self, t: f64) -> (f64, f64, f64) {
        let z = self.rate * t;
        let (phi1, phi2, phi3) = phi(z);
        let v = self.v0 * (-z).exp() + self.a * t * phi1;
        let x = self.x0 + t * (self.v0 * phi1 + self.a * t * phi2);
        let integral = t * (self.x0 + t * (self.v0 * phi2 + self.a * t * phi3));
        (x, v, integral)
    }
}

impl Exact {
    /// At rest at `x`.
    pub const fn at_rest(base: Base<f64>, load: f64, x: f64) -> Self {
        Self { base, load, x, v: 0.0 }
    }

    /// The arc that starts here under drive `u`.
    pub fn arc(&self, u: f64) -> Arc {
        let Base { b, c, f1 } = self.base;
        let net = u - self.load;
        let rate = c / b;
        let still = Arc { x0: self.x, v0: 0.0, a: 0.0, rate, reversal_s: f64::INFINITY };
        let sgn = if self.v == 0.0 {
            if net.abs() <= f1 {
                return still;
            }
            net.signum()
        } else {
            self.v.signum()
        };
        let w = net - f1 * sgn;
        let reversal_s = if self.v == 0.0 || w * sgn >= 0.0 {
            f64::INFINITY
        } else if rate > 0.0 {
            (-c * self.v / w).ln_1p() / rate
        } else {
            -self.v * b / w
        };
        Arc { x0: self.x, v0: self.v, a: w / b, rate, reversal_s }
    }

    /// Goes along an arc for `t` seconds, `t ≤ reversal_s`.
    pub fn follow(&mut self, arc: &Arc, t: f64) {
        let (x, v, _) = arc.at(t);
        self.x = x;
        self.v = if t == arc.reversal_s { 0.0 } else { v };
    }

    /// Advances by `dt` seconds under a held drive, exactly.
    pub fn advance(&mut self, u: f64, dt: f64) {
        let mut left = dt;
        // A held drive allows one reversal: afterwards the body moves with the net force, or stays.
        for _ in 0..3 {
            let arc = self.arc(u);
            let t = left.min(arc.reversal_s);
            self.follow(&arc, t);
            left -= t;
            if left <= 0.0 {
                break;
            }
        }
    }
}
