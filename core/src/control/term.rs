//! One effect as the compensator evaluates it: the catalogue's law with everything that does not change computed
//! beforehand. That each is the law of its file in `plant::effect` is tested against the hooks there.

use super::fast::Fast;
use crate::plant::effect::{Effect, Kind};
use crate::scalar::Real;

const TURNS_PER_RADIAN: f64 = 1.0 / core::f64::consts::TAU;

/// A compensable effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Term<R> {
    /// No effect.
    Nothing,
    /// A force: `constant + linear·x`.
    Linear { constant: R, linear: R },
    /// A force: `by_speed·|v| + by_square·v·|v|`.
    Drag { by_speed: R, by_square: R },
    /// A force: `first·sin(turns·x + phase)`, and a second harmonic unless its amplitude is 0.
    Ripple { turns: R, first: [R; 2], second: [R; 2] },
    /// A friction level: `s·e^(−(|v|/vs)^p)`, p = 2 with `half_p` 1.
    Stribeck { s: R, per_vs: R, p: Option<R> },
    /// A friction level: `amplitude·sin(turns·x + phase)`.
    Wave { amplitude: R, turns: R, phase: R },
    /// A friction level `k·|u|`: 1/(1 − k) and 1/(1 + k).
    Load { with: R, against: R },
    /// Inverse of the dead zone: `u + d·sat(u/band)`.
    DeadZone { d: R, per_band: R },
    /// Inverse of the bridge's dead time, around i = u − Ke·v: gain within ±`edge`, ±`d` beyond.
    DeadTime { d: R, edge: R, gain: R, ke: R },
}

/// What the terms of the balance of forces add.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sum<R> {
    /// Force to apply, drive units.
    pub force: R,
    /// Coulomb level while sliding, drive units.
    pub level: R,
    /// Level at rest at the same place, drive units.
    pub rest: R,
}

impl<R: Fast> Term<R> {
    /// The effect's term; `None` if the catalogue says that it cannot be compensated.
    pub fn new<F: Real>(effect: &Effect<F>, f1: F) -> Option<Self> {
        if !effect.kind.compensated() {
            return None;
        }
        let p = effect.p;
        let real = |value: F| R::from_f64(value.to_f64());
        let turns = |radians: F| real(radians.scale(TURNS_PER_RADIAN));
        let turn = |radians: F| real(turn(radians));
        Some(match effect.kind {
            Kind::ConstantLoad => Self::Linear { constant: real(p[0]), linear: R::ZERO },
            Kind::Spring => Self::Linear { constant: real(-p[0] * p[1]), linear: real(p[0]) },
            Kind::AsymmetricViscous => Self::Drag { by_speed: real(p[0]), by_square: R::ZERO },
            Kind::QuadraticDrag => Self::Drag { by_speed: R::ZERO, by_square: real(p[0]) },
            Kind::Cogging => {
                Self::Ripple { turns: turns(p[1]), first: [real(-p[0]), turn(p[2])], second: [real(-p[3]), turn(p[4])] }
            }
            Kind::GravityLoad => Self::Ripple {
                turns: R::from_f64(TURNS_PER_RADIAN),
                first: [real(-p[0]), turn(p[1])],
                second: [R::ZERO; 2],
            },
            Kind::Stribeck => Self::Stribeck {
                s: real(p[0]),
                per_vs: real(F::ONE / p[1]),
                p: if p[2] == F::ONE + F::ONE { None } else { Some(real(p[2])) },
            },
            Kind::PositionFriction => Self::Wave { amplitude: real(f1 * p[0]), turns: turns(p[1]), phase: turn(p[2]) },
            Kind::LoadFriction => Self::load(p[0]),
            Kind::DeadZone => {
                // Within ±band the inverse is a ramp, or noise around zero would make the drive chatter by ±d. As long
                // as the band is below the break-away force the axis rests there anyway.
                let band = f1.scale(0.5).max(p[0].scale(0.1)).max(F::from_f64(1e-9));
                Self::DeadZone { d: real(p[0]), per_band: real(F::ONE / band) }
            }
            Kind::PwmDeadTime => {
                let [d, i0, ke, ..] = p;
                // i ↦ i − d·sat(i/i0) is invertible for i0 > d; below that the ramp is made as steep as 10.
                let edge = (i0 - d).max(i0.scale(0.1)).max(F::from_f64(1e-9));
                Self::DeadTime { d: real(d), edge: real(edge), gain: real(d / edge), ke: real(ke) }
            }
            _ => return None,
        })
    }

    /// Friction `k·|u|`. At k = 1 no drive moves the axis: the inverse is bounded.
    pub fn load<F: Real>(k: F) -> Self {
        let inverse = |x: F| if x > F::from_f64(0.05) { F::ONE / x } else { F::from_f64(20.0) };
        let real = |x: F| R::from_f64(inverse(x).to_f64());
        Self::Load { with: real(F::ONE - k), against: real(F::ONE + k) }
    }

    /// Adds the term to the balance of forces along the reference.
    #[inline]
    pub fn add(&self, x: R, v: R, sum: &mut Sum<R>) {
        match *self {
            Self::Linear { constant, linear } => sum.force += constant + linear * x,
            Self::Drag { by_speed, by_square } => sum.force += v.abs() * (by_speed + by_square * v),
            Self::Ripple { turns, first: [a, phase], second: [a2, phase2] } => {
                let angle = turns * x;
                sum.force += a * (angle + phase).sin_turns();
                if a2 != R::ZERO {
                    sum.force += a2 * (angle + angle + phase2).sin_turns();
                }
            }
            Self::Stribeck { s, per_vs, p } => {
                let ratio = v.abs() * per_vs;
                let exponent = match p {
                    None => ratio * ratio,
                    // 0^p = 0 for p > 0.
                    Some(p) if ratio > R::ZERO => grown(p * ratio.ln()),
                    Some(_) => R::ZERO,
                };
                sum.level += s * (-exponent).exp_negative();
                sum.rest += s;
            }
            Self::Wave { amplitude, turns, phase } => {
                let level = amplitude * (turns * x + phase).sin_turns();
                sum.level += level;
                sum.rest += level;
            }
            Self::Nothing | Self::Load { .. } | Self::DeadZone { .. } | Self::DeadTime { .. } => {}
        }
    }

    /// The feed-forward drive with friction that grows with it: `u = force + k·|u|·direction`.
    #[inline]
    pub fn with_load_friction(&self, u: R, direction: R) -> R {
        match *self {
            Self::Load { with, against } => {
                let along = u * direction;
                if along > R::ZERO {
                    u * with
                } else if along < R::ZERO {
                    u * against
                } else {
                    u
                }
            }
            _ => u,
        }
    }

    /// The command that makes the drive path hand on `u` at velocity `v`.
    #[inline]
    pub fn inverse(&self, u: R, v: R) -> R {
        match *self {
            Self::DeadZone { d, per_band } => u + d * (u * per_band).min(R::ONE).max(-R::ONE),
            Self::DeadTime { d, edge, gain, ke } => {
                let i = u - ke * v;
                if i > edge {
                    u + d
                } else if i < -edge {
                    u - d
                } else {
                    u + gain * i
                }
            }
            _ => u,
        }
    }
}

/// A phase in turns, −½..½: what is left of a large one keeps its digits.
fn turn<F: Real>(radians: F) -> F {
    let turns = radians.scale(TURNS_PER_RADIAN);
    let size = turns.abs();
    let rest = size - F::from_u32((size + F::from_f64(0.5)).to_u32());
    if turns < F::ZERO { -rest } else { rest }
}

/// e^y with the exponential that the tick has already: that of a negative number. Beyond y = 8, where e^(−e^y) is nothing, it
/// stays at its value there.
fn grown<R: Fast>(y: R) -> R {
    if y > R::ZERO { R::ONE / (-y.min(R::from_f64(8.0))).exp_negative() } else { y.exp_negative() }
}
