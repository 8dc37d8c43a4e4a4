//! The feed-forward compensator: the model's force along the reference.
//!
//! `u_ff = b·a + c·v + level(x, v)·sgn v − Σ forces(x, v)` at the reference a lead time ahead. It has every effect that can
//! be compensated by its catalogue entry. The inverse of drive-path effects (dead zone, PWM dead time) acts on the whole
//! drive. The sign is the reference's, never the measured velocity's, and it is 0 while the reference rests
//! (docs/theory.md, section 6). The friction part stays below the break-away force, so that compensation alone never
//! moves an axis at rest.

use super::fast::Fast;
use super::term::{Sum, Term};
use super::trajectory::Setpoint;
use crate::plant::effect::{Compensation, Effect, Kind};
use crate::plant::{Base, MAX_EFFECTS, PlantError};
use crate::says::says;
use crate::scalar::Real;

/// Why a model cannot be compensated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CompensatorError {
    /// The base model is none.
    Base(PlantError),
    /// More than [`MAX_EFFECTS`] effects.
    TooManyEffects,
    /// A parameter of this effect is not finite.
    Parameter(Kind),
    /// The lead time is not finite and non-negative.
    Lead,
}

says! { CompensatorError:
    Self::Base(error) => "{error}",
    Self::TooManyEffects => "the model has too many effects",
    Self::Parameter(kind) => "a parameter of {} is not a finite number" (kind.name()),
    Self::Lead => "the lead time must be a finite number, 0 or more",
}

/// The parts of a feed-forward drive, drive units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Feed<R> {
    /// b·a of the base model.
    pub inertia: R,
    /// c·v of the base model.
    pub viscous: R,
    /// Friction with its sign, below the break-away force.
    pub friction: R,
    /// What the effects' forces need.
    pub forces: R,
}

/// The share of the break-away force that friction compensation may reach.
const CAP: f64 = 0.98;

/// How far ahead of the reference the drive of a tick acts, s. It is applied `delay_ticks` ticks after its reading
/// and then held for a tick, on average half a tick more.
pub fn lead_s<F: Real>(tick_s: F, delay_ticks: u32) -> F {
    tick_s * (F::from_u32(delay_ticks) + F::from_f64(0.5))
}

/// Configuration of the compensator. Off by default: it must be switched on with [`Compensator::on`].
#[derive(Clone, Copy, Debug)]
pub struct Compensator<R> {
    base: Base<R>,
    /// Effects in the balance of forces, from the front; effects of the drive path from the back, its first the last. A
    /// controller keeps several compensators in a small memory.
    terms: [Term<R>; MAX_EFFECTS],
    used: usize,
    path_used: usize,
    /// Load-dependent friction, all of it.
    load: Term<R>,
    lead_s: R,
    half_lead_s: R,
    cap: R,
    /// Speed of the reference up to which it counts as resting, X/s.
    rest_speed: R,
    enabled: bool,
}

impl<R: Fast> Compensator<R> {
    /// A compensator for a model. Effects that cannot be compensated are left out; [`Compensator::leaves_out`] tells.
    ///
    /// # Errors
    /// [`CompensatorError`].
    pub fn new<F: Real>(base: &Base<F>, effects: &[Effect<F>]) -> Result<Self, CompensatorError> {
        let checked = Base::new(base.b, base.c, base.f1).map_err(CompensatorError::Base)?;
        if effects.len() > MAX_EFFECTS {
            return Err(CompensatorError::TooManyEffects);
        }
        let mut terms = [Term::Nothing; MAX_EFFECTS];
        let (mut used, mut path_used) = (0, 0);
        let mut load_friction = F::ZERO;
        for effect in effects {
            if effect.p.iter().any(|p| !p.is_finite()) {
                return Err(CompensatorError::Parameter(effect.kind));
            }
            let Some(shape) = effect.compensation(&checked) else { continue };
            let slot = match shape {
                Compensation::LevelOfDrive { ratio } => {
                    load_friction += ratio;
                    continue;
                }
                Compensation::DeadZone { .. } | Compensation::DeadTime { .. } => {
                    path_used += 1;
                    terms.iter_mut().rev().nth(path_used - 1)
                }
                _ => {
                    used += 1;
                    terms.get_mut(used - 1)
                }
            };
            // There are not more of both than MAX_EFFECTS.
            if let Some(slot) = slot {
                *slot = Term::new(shape);
            }
        }
        let load = if load_friction == F::ZERO { Term::Nothing } else { Term::load(load_friction) };
        let real = |value: F| R::from_f64(value.to_f64());
        let base = Base { b: real(base.b), c: real(base.c), f1: real(base.f1) };
        Ok(Self {
            base,
            terms,
            used,
            path_used,
            load,
            lead_s: R::ZERO,
            half_lead_s: R::ZERO,
            cap: R::from_f64(CAP),
            rest_speed: R::ZERO,
            enabled: false,
        })
    }

    /// Switched on.
    #[must_use]
    pub const fn on(self) -> Self {
        Self { enabled: true, ..self }
    }

    /// Whether it is switched on.
    pub const fn is_on(&self) -> bool {
        self.enabled
    }

    /// Evaluates the model `lead_s` s ahead of the reference; [`lead_s`] is what to give it.
    ///
    /// # Errors
    /// [`CompensatorError::Lead`].
    pub fn with_lead<F: Real>(self, lead_s: F) -> Result<Self, CompensatorError> {
        if !(lead_s.is_finite() && lead_s >= F::ZERO) {
            return Err(CompensatorError::Lead);
        }
        let real = |value: F| R::from_f64(value.to_f64());
        Ok(Self { lead_s: real(lead_s), half_lead_s: real(lead_s.scale(0.5)), ..self })
    }

    /// References slower than `speed` (X/s, ≥ 0) count as resting: for those from a file, whose zero is not exact.
    #[must_use]
    pub fn with_rest_speed(self, speed: f64) -> Self {
        Self { rest_speed: R::from_f64(speed).max(R::ZERO), ..self }
    }

    /// The effects of `effects` that this compensator leaves out, as the catalogue has no compensation for them.
    pub fn leaves_out(effects: &[Effect<f64>]) -> impl Iterator<Item = Kind> + '_ {
        effects.iter().map(|effect| effect.kind).filter(|kind| kind.definition().compensation.is_none())
    }

    fn terms(&self) -> impl Iterator<Item = &Term<R>> {
        self.terms.iter().take(self.used)
    }

    /// −1, 0 or 1: the direction of the reference.
    #[inline]
    pub fn direction(&self, v: R) -> R {
        if v.abs() > self.rest_speed { v.sgn() } else { R::ZERO }
    }

    /// The model's force along the reference, in parts, whether switched on or not.
    #[inline]
    pub fn feed(&self, reference: Setpoint<R>) -> Feed<R> {
        let v = reference.v + reference.a * self.lead_s;
        let x = reference.x + (reference.v + reference.a * self.half_lead_s) * self.lead_s;
        // A reference at rest stays at rest, whatever is left of its acceleration.
        let direction = if reference.v == R::ZERO { R::ZERO } else { self.direction(v) };
        let mut sum = Sum { force: R::ZERO, level: self.base.f1, rest: self.base.f1 };
        for term in self.terms() {
            term.add(x, v, &mut sum);
        }
        let friction = sum.level.min(self.cap * sum.rest).max(R::ZERO) * direction;
        Feed { inertia: self.base.b * reference.a, viscous: self.base.c * v, friction, forces: sum.force }
    }

    /// The feed-forward drive of the whole model; 0 when switched off.
    #[inline]
    pub fn drive(&self, reference: Setpoint<R>) -> R {
        if !self.enabled {
            return R::ZERO;
        }
        let feed = self.feed(reference);
        self.loaded(feed.inertia + feed.viscous + feed.friction + feed.forces, reference.v)
    }

    /// The feed-forward drive of the effects alone, beside a law that brings b, c and f1 itself; 0 when switched off.
    #[inline]
    pub fn effects_drive(&self, reference: Setpoint<R>) -> R {
        if !self.enabled || self.used == 0 {
            return R::ZERO;
        }
        let feed = self.feed(reference);
        let coulomb = self.cap * self.base.f1 * feed.friction.sgn();
        feed.friction - coulomb + feed.forces
    }

    /// The drive that the model needs to hold the velocity `v` at `x`, without the cap and whether switched on or
    /// not. The [drift watch](super::DriftWatch) compares it with the applied drive.
    #[inline]
    pub fn balance(&self, x: R, v: R) -> R {
        let mut sum = Sum { force: R::ZERO, level: self.base.f1, rest: self.base.f1 };
        for term in self.terms() {
            term.add(x, v, &mut sum);
        }
        self.loaded(self.base.c * v + sum.level * v.sgn() + sum.force, v)
    }

    fn loaded(&self, u: R, v: R) -> R {
        self.load.with_load_friction(u, self.direction(v))
    }

    /// The command that makes the drive path hand on `u`; `u` itself when switched off.
    #[inline]
    pub fn inverse(&self, u: R, v: R) -> R {
        if !self.enabled {
            return u;
        }
        // The last of the drive path is undone first.
        self.terms.iter().rev().take(self.path_used).rev().fold(u, |u, term| term.inverse(u, v))
    }
}

#[cfg(test)]
mod tests;
