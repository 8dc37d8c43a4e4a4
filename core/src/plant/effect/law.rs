//! What a physical effect is: a definition, and the hooks through which it acts.

use super::{Compensation, Definition, Effect, Element};
use crate::plant::base::Base;
use crate::scalar::Real;

/// What an effect may depend on, at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Instant<R> {
    /// Session time, s.
    pub t: R,
    /// Position, position units.
    pub x: R,
    /// Velocity, position units/s.
    pub v: R,
    /// Drive as it reaches the motor, after the drive-path effects, drive units.
    pub u: R,
    /// Duration around the instant, s, over which a mean is asked for, since a ripple that passes within it averages
    /// out. 0 for the instant itself.
    pub over_s: f64,
}

impl<R: Real> Instant<R> {
    /// Mean of a ripple of wave number `n` in position, over its value in the middle: sin(a)/a with a = n·v·h/2.
    #[must_use]
    pub fn averaged(&self, n: R) -> R {
        let a = (n * self.v).scale(0.5 * self.over_s);
        if a.abs() < R::from_f64(SMALL_ANGLE) {
            return R::ONE - (a * a).scale(1.0 / 6.0);
        }
        a.sin() / a
    }
}

/// Below this half angle the mean of a ripple comes from its series, which leaves out 2e-5.
const SMALL_ANGLE: f64 = 0.2;

/// The applied drive and its past, zero-order held.
#[derive(Clone, Copy, Debug)]
pub struct Held<'a> {
    /// Drive samples up to and including the present one; never empty.
    pub u: &'a [f64],
    /// Sample period, s.
    pub ts: f64,
    /// Start of the present sub-step, s after the present sample.
    pub from_s: f64,
}

/// Extra state of one effect: bristle, second inertia, filtered drive.
pub type Memory<R> = [R; 3];

/// A physical effect: a definition and the hooks through which it acts. Every hook defaults to "no influence", and
/// only those of the place where the effect [acts](Definition::acts_in) are called. D, F, M and S mark them;
/// `inertia` and `compensation` of any.
///
/// `p` holds the parameters in the order of [`Definition::parameters`].
pub trait Law {
    /// Name, equation, parameters, evidence.
    const DEFINITION: Definition;

    /// D: where along the drive's path the effect acts, whatever its place in the model; the lower acts before the
    /// higher. The computer's delay is first, since it reads the samples. The amplifier follows with its gain, limit,
    /// dead zone and dead time. The winding's lag is last.
    const ALONG_THE_DRIVE: u8 = 0;
    /// D: mean drive over the sub-step `h` from the mean drive `at.u` handed on by the effects before it.
    fn drive<R: Real>(_p: &[R], at: &Instant<R>, _past: Held<'_>, _memory: &mut Memory<R>, _h: f64) -> R {
        at.u
    }
    /// D: the instant within a sample of `ts` seconds at which the drive switches that the effect hands on, s. It is 0
    /// where the drive switches at samples alone.
    fn switches_at<R: Real>(_p: &[R], _ts: f64) -> f64 {
        0.0
    }
    /// D: whether the drive that the effect hands on changes within a sub-step, so that [`Self::lead`] counts.
    const SHAPES_THE_DRIVE: bool = false;
    /// D: `∫(u − ū)·(h − t)dt/h²` over the last sub-step `h`, where ū is the mean that [`Self::drive`] gave. So far the
    /// drive moves a body of inertia b beyond what its mean does, times b/h². Drive units.
    fn lead<R: Real>(_p: &[R], _memory: &Memory<R>) -> R {
        R::ZERO
    }
    /// F: force added to the right-hand side, in drive units.
    fn force<R: Real>(_p: &[R], _at: &Instant<R>) -> R {
        R::ZERO
    }
    /// F: added to the Coulomb level f1 while sliding, in drive units.
    fn level<R: Real>(_p: &[R], _base: &Base<R>, _at: &Instant<R>) -> R {
        R::ZERO
    }
    /// F: added to the sliding level at v = 0 to give the break-away level, in drive units.
    fn breakaway<R: Real>(_p: &[R]) -> R {
        R::ZERO
    }
    /// F: factor on the inertia b.
    fn inertia<R: Real>(_p: &[R], _t: R, _memory: &Memory<R>) -> R {
        R::ONE
    }
    /// M: mean reaction of the extra mechanics on the motor over a sub-step `h` in which the motor moves at `mid.v`
    /// through `mid.x`. Advances the memory.
    fn mechanics<R: Real>(_p: &[R], _base: &Base<R>, _mid: &Instant<R>, _memory: &mut Memory<R>, _h: f64) -> R {
        R::ZERO
    }
    /// Whether the effect has a memory, which must be brought up to date before a segment.
    const REMEMBERS: bool = false;
    /// How many numbers of the memory, from the first, a fit has to find at the start of a segment. They are the
    /// bristle, or the position and velocity of a second body. At most 2.
    const FREE_MEMORY: usize = 0;
    /// Whether a parameter on a grid is a threshold: small steps of it change nothing, so gradients cannot find it.
    const THRESHOLD: bool = false;
    /// M: whether bristles carry the friction (presliding) in place of the Coulomb law.
    const BRISTLES: bool = false;
    /// M: mean bristle force over a sub-step (opposing motion when positive with v) at friction level `level`.
    fn bristle<R: Real>(_p: &[R], _level: R, _v: R, _memory: &mut Memory<R>, _h: f64) -> R {
        R::ZERO
    }
    /// M: impact at the end of a sub-step: may change velocity and position of the motor.
    fn impact<R: Real>(_p: &[R], _x: &mut R, _v: &mut R, _memory: &mut Memory<R>, _h: f64) {}
    /// M: the memory of a body at rest with the motor at position `x`.
    fn at_rest<R: Real>(_p: &[R], _x: R) -> Memory<R> {
        [R::ZERO; 3]
    }
    /// M: the memory at the start of a segment, where the motor is at `x`. The free memory is what the motion before
    /// says, and `more`.
    fn displaced<R: Real>(_p: &[R], _x: R, more: [R; 2], memory: &mut Memory<R>) {
        memory[0] += more[0];
        memory[1] += more[1];
    }
    /// S: added to the position that the sensor reports.
    fn sensor<R: Real>(_p: &[R], _x: R) -> R {
        R::ZERO
    }
    /// What a controller does about the effect; `None` if it cannot compensate it. [`Definition::compensation`] says
    /// the same in words.
    fn compensation<R: Real>(_p: &[R], _base: &Base<R>) -> Option<Compensation<R>> {
        None
    }
    /// What the effect is as a part of a machine, for programs that build the machine elsewhere. [`Element::Other`] is in
    /// none of them.
    fn element(_p: &[f64], _base: &Base<f64>) -> Element {
        Element::Other
    }
    /// The effect with the parameters that give it the law of `other`; `None` where none do. A fit of the effect in the
    /// place of `other` begins there too, so that it ends no worse.
    fn in_the_place_of(_other: &Effect<f64>) -> Option<Effect<f64>> {
        None
    }
    /// Least sub-steps of a sample period.
    const SUB_STEPS: usize = 1;
    /// Highest natural frequency that the effect adds, rad/s. It sets the sub-step.
    fn bandwidth(_p: &[f64], _base: &Base<f64>) -> f64 {
        0.0
    }
}
