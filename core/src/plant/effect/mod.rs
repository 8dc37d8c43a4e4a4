//! The catalogue of named physical effects (docs/effects.md): one file per effect.
//!
//! Each file holds a unit type that implements [`Law`]. Its [`Definition`] has the equation, the parameters with their
//! roles, and where the effect acts. It also says what shows the effect, and how that relates to other effects. The
//! type has only the hooks through which the effect acts and is compensated. Whatever is specific to an effect stands
//! in its file and nowhere else. The list at the end of this file is the catalogue; naming, fitting, reporting and the
//! file format follow from it.
#![allow(clippy::inline_always, reason = "see `motion`: a fifth of a discovery's time")]

mod canonical;
mod compensation;
mod definition;
mod element;
mod law;
mod limits;
mod parameter;
mod role;

pub use compensation::Compensation;
pub use definition::{ActsIn, Definition, Relation};
pub use element::Element;
pub use law::{Held, Instant, Law, Memory};
pub use parameter::{MAX_PARAMETERS, Over, Parameter, Scale, Search};
pub use role::Role;

use super::base::Base;
use crate::scalar::Real;

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
            #[inline]
            pub const fn acts_in(self) -> ActsIn {
                match self { $(Self::$law => <$law as Law>::DEFINITION.acts_in,)* }
            }
            /// See [`Law::ALONG_THE_DRIVE`].
            #[inline]
            pub const fn along_the_drive(self) -> u8 {
                match self { $(Self::$law => <$law as Law>::ALONG_THE_DRIVE,)* }
            }
            /// Whether friction is carried by bristles.
            #[inline]
            pub const fn bristles(self) -> bool {
                match self { $(Self::$law => <$law as Law>::BRISTLES,)* }
            }
            /// See [`Law::FREE_MEMORY`].
            #[inline]
            pub const fn free_memory(self) -> usize {
                match self { $(Self::$law => <$law as Law>::FREE_MEMORY,)* }
            }
            /// Whether a second body, whose position and velocity are not measured, moves with the motor.
            pub const fn second_body(self) -> bool {
                self.free_memory() == 2
            }
            /// See [`Law::SHAPES_THE_DRIVE`].
            #[inline]
            pub const fn shapes_the_drive(self) -> bool {
                match self { $(Self::$law => <$law as Law>::SHAPES_THE_DRIVE,)* }
            }
            /// See [`Law::SUB_STEPS`].
            #[inline]
            pub const fn sub_steps(self) -> usize {
                match self { $(Self::$law => <$law as Law>::SUB_STEPS,)* }
            }
            /// See [`Law::THRESHOLD`].
            pub const fn threshold(self) -> bool {
                match self { $(Self::$law => <$law as Law>::THRESHOLD,)* }
            }
            /// Whether the effect is a force, or a friction level, that repeats over position.
            pub fn periodic_in_position(self) -> bool {
                let along = |search| matches!(search, Search::Spectrum(Over::Position | Over::PositionAndDirection));
                self.definition().parameters.iter().any(|parameter| along(parameter.search))
            }
            /// Whether the effect has a memory that must be brought up to date.
            #[inline]
            pub const fn remembers(self) -> bool {
                match self { $(Self::$law => <$law as Law>::REMEMBERS,)* }
            }
            /// Index of the parameter that is the width of a gap, in which a second body may be anywhere about the
            /// motor. `None` for an effect without one.
            pub const fn gap(self) -> Option<usize> {
                match self { $(Self::$law => const { <$law as Law>::DEFINITION.gap() },)* }
            }
            /// See [`Law::bandwidth`].
            pub fn bandwidth(self, p: &[f64], base: &Base<f64>) -> f64 {
                match self { $(Self::$law => <$law as Law>::bandwidth(p, base),)* }
            }
        }

        impl Effect<f64> {
            /// Another effect with the law of this one. See [`Law::in_the_place_of`].
            pub fn as_kind(&self, kind: Kind) -> Option<Self> {
                match kind { $(Kind::$law => $law::in_the_place_of(self),)* }
            }
            /// See [`Law::element`].
            pub fn element(&self, base: &Base<f64>) -> Element {
                match self.kind { $(Kind::$law => $law::element(&self.p, base),)* }
            }
        }

        impl<R: Real> Effect<R> {
            /// See [`Law::drive`].
            #[inline(always)]
            pub fn drive(&self, at: &Instant<R>, past: Held<'_>, memory: &mut Memory<R>, h: f64) -> R {
                match self.kind { $(Kind::$law => $law::drive(&self.p, at, past, memory, h),)* }
            }
            /// See [`Law::switches_at`].
            #[inline(always)]
            pub fn switches_at(&self, ts: f64) -> f64 {
                match self.kind { $(Kind::$law => $law::switches_at(&self.p, ts),)* }
            }
            /// See [`Law::lead`].
            #[inline(always)]
            pub fn lead(&self, memory: &Memory<R>) -> R {
                match self.kind { $(Kind::$law => $law::lead(&self.p, memory),)* }
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
    end_stop::EndStop,
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
    /// Why `other` cannot stand beside it in one model; `None` if it can. See [`Definition::excludes`].
    pub fn excludes(self, other: Self) -> Option<&'static str> {
        if self == other {
            return (!self.definition().repeats).then_some("a model has it once");
        }
        self.definition().excludes.iter().find(|relation| relation.name == other.name()).map(|relation| relation.why)
    }
    /// Whether `other` is this effect with certain parameters, or in a limit. See [`Definition::generalises`].
    pub fn generalises(self, other: Self) -> bool {
        self.definition().generalises.contains(&other.name())
    }
    /// Whether `other`, though it has more parameters, is a rival of this effect all the same: recordings may lack what tells the two
    /// apart. Other larger effects pay for nothing, or have this one as a special case. See [`Definition::confused_with`].
    pub fn resembles(self, other: Self) -> bool {
        self.definition().confused_with.contains(&other.name()) && !other.generalises(self)
    }
}

#[cfg(test)]
#[path = "../../../tests/example/eddy_brake.rs"]
mod eddy_brake;
#[cfg(test)]
mod tests;
