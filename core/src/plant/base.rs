//! The base equation of motion.

use crate::says::says;
use crate::scalar::Real;

/// The three parameters that position data can identify (docs/theory.md, section 1):
///
/// `b·ẍ + c·ẋ + f1·sgn(ẋ) = u`, with `c = Ke + f2`.
///
/// Units follow the recording: with `u` in volts and `x` in radians, `b` is V·s²/rad, `c` V·s/rad, `f1` V.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Base<R> {
    /// Inertia over motor gain, in drive units per (position unit/s²); > 0.
    pub b: R,
    /// Lumped viscous friction and back-EMF, in drive units per (position unit/s); ≥ 0.
    pub c: R,
    /// Coulomb friction, in drive units; ≥ 0.
    pub f1: R,
}

/// Why a set of parameters is not a plant; names the parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlantError {
    /// `b` is not finite and positive.
    B,
    /// `c` is not finite and non-negative.
    C,
    /// `f1` is not finite and non-negative.
    F1,
}

says! { PlantError:
    Self::B => "b must be a finite number above 0",
    Self::C => "c must be a finite number, 0 or more",
    Self::F1 => "f1 must be a finite number, 0 or more",
}

impl<R: Real> Base<R> {
    /// Checks the ranges of [`Base`].
    ///
    /// # Errors
    /// [`PlantError`] names the first parameter that is out of range.
    pub fn new(b: R, c: R, f1: R) -> Result<Self, PlantError> {
        if !(b.is_finite() && b > R::ZERO) {
            return Err(PlantError::B);
        }
        if !(c.is_finite() && c >= R::ZERO) {
            return Err(PlantError::C);
        }
        if !(f1.is_finite() && f1 >= R::ZERO) {
            return Err(PlantError::F1);
        }
        Ok(Self { b, c, f1 })
    }
}
