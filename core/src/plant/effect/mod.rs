//! The catalogue of named physical effects (discovery.md, "The effects"): one file per effect.
//!
//! Each file holds a unit type that implements [`Law`]: its [`Definition`] (equation, parameters, where it acts, what
//! shows it, what it is confused with) and only the hooks through which it acts. The list at the end of this file is
//! the catalogue; naming, fitting, reporting and the file format follow from it.
#![allow(clippy::inline_always, reason = "see `motion`: a fifth of a discovery's time")]

mod canonical;
mod compensation;
mod definition;
mod limits;
mod parameter;
mod role;

pub use compensation::Compensation;
pub use definition::{ActsIn, Definition};
pub use parameter::{MAX_PARAMETERS, Over, Parameter, Scale, Search};
pub use role::Role;

use super::base::Base;
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
    /// Duration around the instant, s, over which a mean is asked for: a ripple that passes within it averages out. 0 for
    /// the instant itself.
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

/// Below this half angle the mean of a ripple is taken from its series; what is left out is 2e-5.
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

/// A physical effect: a definition and the hooks through which it acts. Every hook defaults to "no influence", and only
/// those of the place where the effect [acts](Definition::acts_in) are called: D, F, M, S as marked; `inertia` and
/// `compensation` of any.
///
/// `p` holds the parameters in the order of [`Definition::parameters`].
pub trait Law {
    /// Name, equation, parameters, evidence.
    const DEFINITION: Definition;

    /// D: where along the drive's path the effect acts, whatever its place in the model: the lower before the higher. The
    /// computer's delay is first (it reads the samples), then the amplifier (its gain, limit, dead zone, dead time), and the
    /// winding's lag is last.
    const ALONG_THE_DRIVE: u8 = 0;
    /// D: mean drive over the sub-step `h` from the mean drive `at.u` handed on by the effects before it.
    fn drive<R: Real>(_p: &[R], at: &Instant<R>, _past: Held<'_>, _memory: &mut Memory<R>, _h: f64) -> R {
        at.u
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
    /// M: mean reaction of the extra mechanics on the motor over a sub-step `h` in which the motor moves at
    /// `mid.v` through `mid.x`; advances the memory.
    fn mechanics<R: Real>(_p: &[R], _base: &Base<R>, _mid: &Instant<R>, _memory: &mut Memory<R>, _h: f64) -> R {
        R::ZERO
    }
    /// Whether the effect remembers: its memory must be brought up to date before a segment.
    const REMEMBERS: bool = false;
    /// Numbers of the memory, from the first, that a fit has to find at the start of a segment: the bristle, or position
    /// and velocity of a second body. At most 2.
    const FREE_MEMORY: usize = 0;
    /// Whether a parameter on a grid is a threshold: small steps of it change nothing, so gradients do not find it.
    const THRESHOLD: bool = false;
    /// M: whether friction is carried by bristles (presliding) in place of the Coulomb law.
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
    /// M: the memory at the start of a segment, where the motor is at `x` and the free memory is `more` than what the motion
    /// before says.
    fn displaced<R: Real>(_p: &[R], _x: R, more: [R; 2], memory: &mut Memory<R>) {
        memory[0] += more[0];
        memory[1] += more[1];
    }
    /// S: added to the position that the sensor reports.
    fn sensor<R: Real>(_p: &[R], _x: R) -> R {
        R::ZERO
    }
    /// What a controller does about the effect; `None` if it cannot compensate it, as
    /// [`Definition::compensation`] says in words.
    fn compensation<R: Real>(_p: &[R], _base: &Base<R>) -> Option<Compensation<R>> {
        None
    }
    /// Least sub-steps of a sample period. More than one where what happens within a sample tells the effect from another: a mean
    /// drive over the whole sample moves the motor as far for a delay as for a lag of the same time constant. Below
    /// `MAX_SUB_STEPS`, from where dynamics count as not resolved: those two take one fewer.
    const SUB_STEPS: usize = 1;
    /// Highest natural frequency the effect adds, rad/s: sets the sub-step.
    fn bandwidth(_p: &[f64], _base: &Base<f64>) -> f64 {
        0.0
    }
}

/// One effect with its parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect<R> {
    /// Which effect.
    pub kind: Kind,
    /// Parameters in the order of its definition; the rest is zero.
    pub p: [R; MAX_PARAMETERS],
}

impl<R: Real> Effect<R> {
    /// The effect with the given parameters; missing ones take their default, or zero.
    pub fn new(kind: Kind, parameters: &[R]) -> Self {
        let mut p = [R::ZERO; MAX_PARAMETERS];
        for (i, slot) in p.iter_mut().enumerate() {
            if let Some(value) = parameters.get(i) {
                *slot = *value;
            } else if let Some(default) = kind.definition().parameters.get(i).and_then(|d| d.default) {
                *slot = R::from_f64(default);
            }
        }
        Self { kind, p }
    }
}

macro_rules! catalogue {
    ($($module:ident :: $law:ident,)*) => {
        $(mod $module;)*
        $(pub use $module::$law;)*

        /// An effect of the catalogue.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Kind {
            $(#[doc = concat!("See [`", stringify!($law), "`].")] $law,)*
        }

        impl Kind {
            /// Every effect, in the order of the catalogue.
            pub const ALL: &'static [Self] = &[$(Self::$law,)*];

            /// The effect's definition.
            pub const fn definition(self) -> &'static Definition {
                match self { $(Self::$law => &<$law as Law>::DEFINITION,)* }
            }
            /// Where the effect acts.
            pub const fn acts_in(self) -> ActsIn {
                match self { $(Self::$law => <$law as Law>::DEFINITION.acts_in,)* }
            }
            /// See [`Law::ALONG_THE_DRIVE`].
            pub const fn along_the_drive(self) -> u8 {
                match self { $(Self::$law => <$law as Law>::ALONG_THE_DRIVE,)* }
            }
            /// Whether friction is carried by bristles.
            pub const fn bristles(self) -> bool {
                match self { $(Self::$law => <$law as Law>::BRISTLES,)* }
            }
            /// See [`Law::FREE_MEMORY`].
            pub const fn free_memory(self) -> usize {
                match self { $(Self::$law => <$law as Law>::FREE_MEMORY,)* }
            }
            /// Whether a second body, whose position and velocity are not measured, moves with the motor.
            pub const fn second_body(self) -> bool {
                self.free_memory() == 2
            }
            /// See [`Law::SUB_STEPS`].
            pub const fn sub_steps(self) -> usize {
                match self { $(Self::$law => <$law as Law>::SUB_STEPS,)* }
            }
            /// See [`Law::THRESHOLD`].
            pub const fn threshold(self) -> bool {
                match self { $(Self::$law => <$law as Law>::THRESHOLD,)* }
            }
            /// Whether the effect has a memory that must be brought up to date.
            pub const fn remembers(self) -> bool {
                match self { $(Self::$law => <$law as Law>::REMEMBERS,)* }
            }
            /// Index of the parameter that is the width of a gap, in which a second body may be anywhere about the motor;
            /// `None` for an effect without one.
            pub const fn gap(self) -> Option<usize> {
                match self { $(Self::$law => const { <$law as Law>::DEFINITION.gap() },)* }
            }
            /// See [`Law::bandwidth`].
            pub fn bandwidth(self, p: &[f64], base: &Base<f64>) -> f64 {
                match self { $(Self::$law => <$law as Law>::bandwidth(p, base),)* }
            }
        }

        impl<R: Real> Effect<R> {
            /// See [`Law::drive`].
            #[inline(always)]
            pub fn drive(&self, at: &Instant<R>, past: Held<'_>, memory: &mut Memory<R>, h: f64) -> R {
                match self.kind { $(Kind::$law => $law::drive(&self.p, at, past, memory, h),)* }
            }
            /// See [`Law::force`].
            #[inline(always)]
            pub fn force(&self, at: &Instant<R>) -> R {
                match self.kind { $(Kind::$law => $law::force(&self.p, at),)* }
            }
            /// See [`Law::level`].
            #[inline(always)]
            pub fn level(&self, base: &Base<R>, at: &Instant<R>) -> R {
                match self.kind { $(Kind::$law => $law::level(&self.p, base, at),)* }
            }
            /// See [`Law::breakaway`].
            #[inline(always)]
            pub fn breakaway(&self) -> R {
                match self.kind { $(Kind::$law => $law::breakaway(&self.p),)* }
            }
            /// See [`Law::inertia`].
            #[inline(always)]
            pub fn inertia(&self, t: R, memory: &Memory<R>) -> R {
                match self.kind { $(Kind::$law => $law::inertia(&self.p, t, memory),)* }
            }
            /// See [`Law::mechanics`].
            #[inline(always)]
            pub fn mechanics(&self, base: &Base<R>, mid: &Instant<R>, memory: &mut Memory<R>, h: f64) -> R {
                match self.kind { $(Kind::$law => $law::mechanics(&self.p, base, mid, memory, h),)* }
            }
            /// See [`Law::bristle`].
            #[inline(always)]
            pub fn bristle(&self, level: R, v: R, memory: &mut Memory<R>, h: f64) -> R {
                match self.kind { $(Kind::$law => $law::bristle(&self.p, level, v, memory, h),)* }
            }
            /// See [`Law::impact`].
            #[inline(always)]
            pub fn impact(&self, x: &mut R, v: &mut R, memory: &mut Memory<R>, h: f64) {
                match self.kind { $(Kind::$law => $law::impact(&self.p, x, v, memory, h),)* }
            }
            /// See [`Law::at_rest`].
            pub fn at_rest(&self, x: R) -> Memory<R> {
                match self.kind { $(Kind::$law => $law::at_rest(&self.p, x),)* }
            }
            /// See [`Law::displaced`].
            pub fn displaced(&self, x: R, more: [R; 2], memory: &mut Memory<R>) {
                match self.kind { $(Kind::$law => $law::displaced(&self.p, x, more, memory),)* }
            }
            /// See [`Law::compensation`].
            #[inline(always)]
            pub fn compensation(&self, base: &Base<R>) -> Option<Compensation<R>> {
                match self.kind { $(Kind::$law => $law::compensation(&self.p, base),)* }
            }
            /// See [`Law::sensor`].
            #[inline(always)]
            pub fn sensor(&self, x: R) -> R {
                match self.kind { $(Kind::$law => $law::sensor(&self.p, x),)* }
            }
        }
    };
}

// The catalogue. Drive-path effects act in this order.
catalogue! {
    delay::Delay,
    electrical_lag::ElectricalLag,
    dead_zone::DeadZone,
    saturation::Saturation,
    pwm_dead_time::PwmDeadTime,
    gain_drift::GainDrift,
    constant_load::ConstantLoad,
    asymmetric_viscous::AsymmetricViscous,
    quadratic_drag::QuadraticDrag,
    stribeck::Stribeck,
    stiction::Stiction,
    load_friction::LoadFriction,
    friction_drift::FrictionDrift,
    position_friction::PositionFriction,
    cogging::Cogging,
    gravity_load::GravityLoad,
    spring::Spring,
    time_periodic::TimePeriodic,
    inertia_step::InertiaStep,
    dahl::Dahl,
    lugre::LuGre,
    backlash::Backlash,
    flexible_coupling::FlexibleCoupling,
    encoder_eccentricity::EncoderEccentricity,
}

impl Kind {
    /// The effect of that catalogue name, e.g. `stribeck`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|kind| kind.definition().name == name)
    }
    /// Its catalogue name.
    pub const fn name(self) -> &'static str {
        self.definition().name
    }
}
