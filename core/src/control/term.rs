//! A [`Compensation`] as the compensator evaluates it: with everything that does not change computed beforehand. Which
//! effect has which is said in the effect's file; that the two agree is tested against the plant.

use super::fast::Fast;
use crate::plant::effect::Compensation;
use crate::scalar::Real;

const TURNS_PER_RADIAN: f64 = 1.0 / core::f64::consts::TAU;

/// A shape of compensation, ready for the tick.
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
    /// The shape with everything that does not change computed.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "fused with the effect's own choice of the shape: 150 bytes of flash")]
    pub fn new<F: Real>(shape: Compensation<F>) -> Self {
        let real = |value: F| R::from_f64(value.to_f64());
        let turns = |radians: F| real(radians.scale(TURNS_PER_RADIAN));
        let turn = |radians: F| real(turn(radians));
        match shape {
            Compensation::Linear { constant, stiffness } => {
                Self::Linear { constant: real(constant), linear: real(stiffness) }
            }
            Compensation::Drag { by_speed, by_square } => {
                Self::Drag { by_speed: real(by_speed), by_square: real(by_square) }
            }
            Compensation::Ripple { wave_number, first, second } => Self::Ripple {
                turns: turns(wave_number),
                first: [real(first[0]), turn(first[1])],
                second: [real(second[0]), turn(second[1])],
            },
            Compensation::Stribeck { rise, speed, exponent } => Self::Stribeck {
                s: real(rise),
                per_vs: real(F::ONE / speed),
                p: if exponent == F::ONE + F::ONE { None } else { Some(real(exponent)) },
            },
            Compensation::LevelRipple { amplitude, wave_number, phase } => {
                Self::Wave { amplitude: real(amplitude), turns: turns(wave_number), phase: turn(phase) }
            }
            Compensation::LevelOfDrive { ratio } => Self::load(ratio),
            Compensation::DeadZone { loss, band } => Self::DeadZone { d: real(loss), per_band: real(F::ONE / band) },
            Compensation::DeadTime { loss, edge, back_emf } => {
                Self::DeadTime { d: real(loss), edge: real(edge), gain: real(loss / edge), ke: real(back_emf) }
            }
        }
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
