//! The force laws of the table, with their parameters, on top of the base plant.

/// Every parameter the plant may have; the default has no effect at all.
/// Forces in drive units (V), positions in rad, times in s.
#[derive(Clone, Debug, Default)]
pub struct ForceLaw {
    /// Base inertia b (V·s²/rad), viscous coefficient c (V·s/rad), Coulomb level f1 (V).
    pub b: f64,
    pub c: f64,
    pub f1: f64,
    pub bias: f64,
    pub d_asym: f64,
    pub stribeck: Option<Stribeck>,
    /// Break-away surplus s at rest.
    pub stiction: f64,
    pub bristle: Option<Bristle>,
    pub drag: f64,
    pub k_load: f64,
    /// k of f1·(1 + k·sin(nx + φ)).
    pub friction_wave: Option<Wave>,
    pub cogging: Option<Wave>,
    pub cogging2: Option<Wave>,
    pub gravity: Option<Wave>,
    pub spring: Option<(f64, f64)>,
    /// k and x0: a spring that is pressed above x0 for k > 0, and below it for k < 0.
    pub stop: Option<(f64, f64)>,
    /// A, ω, φ over session time.
    pub periodic: Option<Wave>,
    pub second: Option<Second>,
    pub dead_zone: f64,
    pub u_max: Option<f64>,
    pub pwm: Option<Pwm>,
    pub delay: f64,
    pub lag: f64,
    pub eccentricity: Option<Wave>,
    /// s and T of f1 + s·e^(−t/T).
    pub friction_drift: Option<(f64, f64)>,
    pub gain_drift: f64,
    /// t0 and Δ: b becomes b·(1+Δ) at t0.
    pub inertia_step: Option<(f64, f64)>,
    /// Centre, width, peak force of the local well.
    pub well: Option<(f64, f64, f64)>,
    /// Start, duration, signed amplitude, sorted by start, not overlapping.
    pub bursts: Vec<(f64, f64, f64)>,
    /// A and k of A·sin(k·v).
    pub ripple: Option<(f64, f64)>,
    pub position_gain: Option<Wave>,
}

/// a·sin(n·q + φ) of some coordinate q.
#[derive(Clone, Copy, Debug)]
pub struct Wave {
    pub a: f64,
    pub n: f64,
    pub phi: f64,
}

impl Wave {
    pub fn at(&self, q: f64) -> f64 {
        self.a * (self.n * q + self.phi).sin()
    }
}

/// s·e^(−(|v|/vs)^p).
#[derive(Clone, Copy, Debug)]
pub struct Stribeck {
    pub s: f64,
    pub vs: f64,
    pub p: f64,
}

impl Stribeck {
    pub fn at(&self, v: f64) -> f64 {
        let ratio = v.abs() / self.vs;
        let exponent = if self.p == 2.0 { ratio * ratio } else { ratio.powf(self.p) };
        // e^−40 is below the last bit of any level here, and most of the motion is out there.
        if exponent > 40.0 {
            return 0.0;
        }
        self.s * (-exponent).exp()
    }
}

/// Presliding friction: ż = v − σ0·|v|·z/g(v), F = σ0·z + σ1·ż.
#[derive(Clone, Copy, Debug)]
pub struct Bristle {
    pub sigma0: f64,
    pub sigma1: f64,
    /// Present in LuGre, absent in Dahl.
    pub stribeck: Option<Stribeck>,
}

/// A second inertia b2 = ratio·b (the motor keeps (1−ratio)·b) behind a gap, a spring and a damper.
#[derive(Clone, Copy, Debug)]
pub struct Second {
    pub ratio: f64,
    pub gap: f64,
    pub k: f64,
    pub d: f64,
}

/// −d·sat(i/i0), i = u − Ke·v.
#[derive(Clone, Copy, Debug)]
pub struct Pwm {
    pub d: f64,
    pub i0: f64,
    pub ke: f64,
}

impl ForceLaw {
    /// Drive that acts on the motor, from what the drive path delivers.
    pub fn drive_force(&self, u: f64, x: f64, v: f64) -> f64 {
        let gain = self.position_gain.map_or(1.0, |w| 1.0 + w.at(x));
        let lost = self.pwm.map_or(0.0, |p| p.d * ((u - p.ke * v) / p.i0).clamp(-1.0, 1.0));
        u * gain - lost
    }

    /// Forces other than drive, viscous base, friction and coupling.
    pub fn extra_force(&self, x: f64, v: f64, t: f64) -> f64 {
        let mut force = self.bias - self.d_asym * v.abs() - self.drag * v * v.abs();
        for wave in [self.cogging, self.cogging2, self.gravity].into_iter().flatten() {
            force += wave.at(x);
        }
        if let Some((k, x0)) = self.spring {
            force -= k * (x - x0);
        }
        if let Some((k, x0)) = self.stop {
            let depth = if k > 0.0 { x - x0 } else { x0 - x };
            force -= k * depth.max(0.0);
        }
        if let Some(wave) = self.periodic {
            force += wave.at(t);
        }
        if let Some((centre, width, peak)) = self.well {
            // Scaled so that the largest force of the Gaussian well is `peak`.
            let s = (x - centre) / width;
            force -= peak * s * (0.5 - 0.5 * s * s).exp();
        }
        if let Some((a, k)) = self.ripple {
            force += a * (k * v).sin();
        }
        force + self.burst(t)
    }

    fn burst(&self, t: f64) -> f64 {
        let next = self.bursts.partition_point(|b| b.0 <= t);
        let Some(&(start, duration, a)) = next.checked_sub(1).and_then(|i| self.bursts.get(i)) else {
            return 0.0;
        };
        let s = (t - start) / duration;
        if s < 1.0 { a * (std::f64::consts::PI * s).sin() } else { 0.0 }
    }

    /// Friction level while sliding at v; `u` is the drive delivered by the drive path.
    pub fn sliding_level(&self, x: f64, v: f64, t: f64, u: f64) -> f64 {
        let mut level = self.f1 * (1.0 + self.friction_wave.map_or(0.0, |w| w.at(x)));
        level += self.k_load * u.abs();
        if let Some((s, time)) = self.friction_drift {
            level += s * (-t / time).exp();
        }
        if let Some(stribeck) = self.stribeck {
            level += stribeck.at(v);
        }
        if let Some(stribeck) = self.bristle.and_then(|b| b.stribeck) {
            level += stribeck.at(v);
        }
        level.max(0.0)
    }

    /// Largest friction that holds the body at rest.
    pub fn rest_level(&self, x: f64, t: f64, u: f64) -> f64 {
        self.sliding_level(x, 0.0, t, u) + self.stiction
    }

    /// Whole inertia at session time t.
    pub fn inertia(&self, t: f64) -> f64 {
        match self.inertia_step {
            Some((t0, delta)) if t >= t0 => self.b * (1.0 + delta),
            _ => self.b,
        }
    }

    /// What the encoder would read without noise or quantisation.
    pub fn encoder(&self, x: f64) -> f64 {
        x + self.eccentricity.map_or(0.0, |w| w.at(x))
    }
}

impl Second {
    /// Force on the motor at this twist (motor minus load).
    pub fn coupling(&self, twist: f64, twist_rate: f64) -> f64 {
        let half = 0.5 * self.gap;
        if self.gap == 0.0 {
            return -(self.k * twist + self.d * twist_rate);
        }
        // Contact only pushes: no adhesion while the faces separate.
        if twist > half {
            -(self.k * (twist - half) + self.d * twist_rate).max(0.0)
        } else if twist < -half {
            -(self.k * (twist + half) + self.d * twist_rate).min(0.0)
        } else {
            0.0
        }
    }
}
