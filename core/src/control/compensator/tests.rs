use super::*;
use crate::plant::effect::Instant;
use crate::plant::{Drive, Plant};
use crate::scalar::{Q32, Real};
use proptest::prelude::*;
extern crate std;
use std::vec::Vec;

const BASE: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };

/// An effect of every kind, with parameters that act strongly.
fn effect(kind: Kind) -> Effect<f64> {
    let p: &[f64] = match kind {
        Kind::ConstantLoad | Kind::AsymmetricViscous | Kind::QuadraticDrag | Kind::DeadZone | Kind::LoadFriction => {
            &[0.07]
        }
        Kind::Spring => &[0.3, 0.2],
        Kind::Cogging => &[0.2, 7.0, 30.0, 0.05, -1.0],
        Kind::GravityLoad => &[0.4, 2.0],
        Kind::Stribeck => &[0.2, 0.3, 1.5],
        Kind::PositionFriction => &[0.3, 5.0, 1.0],
        Kind::PwmDeadTime => &[0.1, 0.3, 0.05],
        _ => &[0.1, 1.0, 1.0, 0.1, 0.1],
    };
    Effect::new(kind, p)
}

/// A compensator leaves out what the catalogue calls not compensable, and nothing else.
#[test]
fn the_catalogue_decides() {
    for kind in Kind::ALL {
        let leaves_out = Compensator::<f64>::leaves_out(&[effect(*kind)]).next().is_some();
        assert_eq!(leaves_out, kind.definition().compensation.is_none(), "{kind:?}");
    }
}

/// The drive that the plant's own definition of the effects needs along (x, v, a). It is found from its balance of
/// forces, by bisection where the drive enters the effects.
fn needed(effects: &[Effect<f64>], x: f64, v: f64, a: f64) -> f64 {
    let plant = Plant { base: BASE, effects };
    let short = |u: f64| {
        let mut state = plant.at_rest(x);
        let missing = plant.effect_force(&mut state, Drive { u: &[u], ts: 1e-3, t: 0.0 }, x, v, a);
        BASE.b * a + BASE.c * v + BASE.f1 * v.signum() - u - missing
    };
    let (mut low, mut high) = (-50.0, 50.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if short(middle) > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

proptest! {
    /// The compensator's drive is what the catalogue's hooks need, for each effect and for several together.
    /// Exceptions are the cap on friction (2 % of the break-away level) and the dead zone's ramp (outside ±0.25 V
    /// here).
    #[test]
    fn the_drive_is_the_models(x in -3.0..3.0_f64, v in 0.01..3.0_f64, backwards in any::<bool>(), a in -20.0..20.0_f64) {
        let v = if backwards { -v } else { v };
        let mut sets: Vec<Vec<Effect<f64>>> =
            Kind::ALL.iter().filter(|k| k.definition().compensation.is_some()).map(|k| std::vec![effect(*k)]).collect();
        sets.push(std::vec![effect(Kind::Cogging), effect(Kind::Stribeck), effect(Kind::Spring)]);
        // Lines of several wave numbers, not all of them harmonics of one.
        let line = |n: f64| Effect::new(Kind::Cogging, &[0.1, n, 0.3 * n]);
        sets.push(std::vec![line(7.0), line(28.0), line(14.0), line(12.0), effect(Kind::Stribeck)]);
        for effects in sets {
            let compensator = Compensator::<f64>::new(&BASE, &effects).unwrap().on();
            let reference = Setpoint { x, v, a };
            let u = compensator.inverse(compensator.drive(reference), v);
            let exact = needed(&effects, x, v, a);
            let at = Instant { t: 0.0, x, v: 0.0, u: exact, over_s: 0.0 };
            let rest = effects.iter().fold(BASE.f1, |level, e| level + e.level(&BASE, &at));
            let ramp = if effects[0].kind == Kind::DeadZone && exact.abs() < 0.35 { 0.1 } else { 0.0 };
            // The slope of the dead time's inverse is 1.5 within its ramp.
            let tolerance = 1.5 * (1.0 - CAP) * rest * 1.1 + ramp + 1e-6;
            prop_assert!((u - exact).abs() <= tolerance, "{:?} at {} {} {}: {} for {}", effects[0].kind, x, v, a, u, exact);
        }
    }

    /// The friction part is below the break-away force wherever the reference is, and 0 where it rests.
    #[test]
    fn friction_stays_below_breakaway(x in -3.0..3.0_f64, v in -3.0..3.0_f64, a in -20.0..20.0_f64) {
        let effects = [effect(Kind::Stribeck), effect(Kind::PositionFriction)];
        let compensator = Compensator::<f64>::new(&BASE, &effects).unwrap().on();
        let at = Instant { t: 0.0, x, v: 0.0, u: 0.0, over_s: 0.0 };
        let rest = effects.iter().fold(BASE.f1, |level, e| level + e.level(&BASE, &at) + e.breakaway());
        let feed = compensator.feed(Setpoint { x, v, a });
        prop_assert!(feed.friction.abs() < rest && feed.friction * v >= 0.0);
        prop_assert_eq!(compensator.feed(Setpoint { x, v: 0.0, a }).friction, 0.0);
    }

    /// f32 and Q32 against f64: the drive is of size 1, angles of up to 4 turns in f32 err by 5e-7 turns.
    #[test]
    fn scalars_agree(x in -3.0..3.0_f64, v in -3.0..3.0_f64, a in -20.0..20.0_f64) {
        let effects: Vec<Effect<f64>> = [Kind::Cogging, Kind::Stribeck, Kind::PositionFriction, Kind::QuadraticDrag, Kind::DeadZone]
            .map(effect).into();
        let exact = Compensator::<f64>::new(&BASE, &effects).unwrap().on();
        let single = Compensator::<f32>::new(&BASE, &effects).unwrap().on();
        let fixed = Compensator::<Q32>::new(&BASE, &effects).unwrap().on();
        // Away from the reversal, where the sign of a rounded velocity may differ.
        prop_assume!(v.abs() > 1e-3);
        let u = exact.inverse(exact.drive(Setpoint { x, v, a }), v);
        let s = single.inverse(single.drive(Setpoint { x: x as f32, v: v as f32, a: a as f32 }), v as f32);
        let q = Q32::from_f64;
        let f = fixed.inverse(fixed.drive(Setpoint { x: q(x), v: q(v), a: q(a) }), q(v));
        prop_assert!((f64::from(s) - u).abs() < 2e-5, "{} {}", s, u);
        prop_assert!((f.to_f64() - u).abs() < 1e-7, "{} {}", f.to_f64(), u);
    }
}

#[test]
fn wrong_models_are_refused() {
    assert_eq!(
        Compensator::<f32>::new(&Base { b: 0.0, ..BASE }, &[]).err(),
        Some(CompensatorError::Base(PlantError::B))
    );
    let many = [effect(Kind::Spring); MAX_EFFECTS + 1];
    assert_eq!(Compensator::<f32>::new(&BASE, &many).err(), Some(CompensatorError::TooManyEffects));
    let bad = [Effect::new(Kind::Spring, &[f64::NAN, 0.0])];
    assert_eq!(Compensator::<f32>::new(&BASE, &bad).err(), Some(CompensatorError::Parameter(Kind::Spring)));
    assert!(Compensator::<f32>::new(&BASE, &[]).unwrap().with_lead(-1.0).is_err());
}

/// The drive of a tick is held from `d` to `d + 1` ticks after its reading. With the lead it is the mean of the
/// model's force over that time, to a twentieth of the error without.
#[test]
fn the_lead_is_the_time_until_the_drive_acts() {
    let cogging = [Effect::new(Kind::Cogging, &[0.2, 7.0, 0.5])];
    let forces = |feed: Feed<f64>| feed.viscous + feed.forces;
    let at = |t: f64| Setpoint { x: libm::sin(3.0 * t), v: 3.0 * libm::cos(3.0 * t), a: -9.0 * libm::sin(3.0 * t) };
    for delay in 0..3 {
        let plain = Compensator::<f64>::new(&BASE, &cogging).unwrap();
        let led = plain.with_lead(lead_s(1e-3, delay)).unwrap();
        let (mut off, mut off_plain) = (0.0, 0.0);
        for k in 0..2000_u32 {
            let tick = |later: f64| 1e-3 * (f64::from(k) + later);
            let parts = (0..16).map(|i| f64::from(delay) + (f64::from(i) + 0.5) / 16.0);
            let needed = parts.map(|later| forces(plain.feed(at(tick(later))))).sum::<f64>() / 16.0;
            let reference = at(tick(0.0));
            off += (forces(led.feed(reference)) - needed).powi(2);
            off_plain += (forces(plain.feed(reference)) - needed).powi(2);
        }
        assert!(libm::sqrt(off) < 0.05 * libm::sqrt(off_plain), "{delay}: {off} {off_plain}");
    }
}
