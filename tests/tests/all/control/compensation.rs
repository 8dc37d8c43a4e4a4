//! A slow sine with reversals, effects at 10 % of the drive's amplitude.

use breakaway_core::plant::{Effect, Kind};

use super::{BASE, STEP, error};

/// 1 rad at 0.25 Hz: v up to 1.57 rad/s, drive f1 + c·v = 0.67 V.
const SINE: &str = "sine:1,0.25";
/// 10 % of the drive's amplitude, V.
const TENTH: f64 = 0.067;

/// The effects, each with 0.067 V at its largest.
fn effects() -> [Effect<f64>; 4] {
    [
        Effect::new(Kind::Cogging, &[TENTH, 7.0, 0.5]),
        Effect::new(Kind::Stribeck, &[TENTH, 0.2]),
        Effect::new(Kind::AsymmetricViscous, &[TENTH / 1.57]),
        Effect::new(Kind::PositionFriction, &[TENTH / BASE.f1, 5.0, 0.3]),
    ]
}

/// What discovery leaves: amplitudes off by 5 %, phases and Stribeck velocity by 0.05.
fn discovered(effect: &Effect<f64>) -> Effect<f64> {
    let mut found = *effect;
    found.p[0] *= 0.95;
    match effect.kind {
        Kind::Cogging | Kind::PositionFriction => found.p[2] += 0.05,
        Kind::Stribeck => found.p[1] *= 1.05,
        _ => {}
    }
    found
}

/// PID alone, base compensated, whole model compensated.
fn ladder(effect: Effect<f64>, model: Effect<f64>, step: f64) -> [f64; 3] {
    let plant = [effect];
    let found = [
        error(&plant, None, SINE, step),
        error(&plant, Some(&[]), SINE, step),
        error(&plant, Some(&[model]), SINE, step),
    ];
    let [pid, base, whole] = found;
    println!(
        "{} at {step:.1e} rad: PID {pid:.2e}, base {base:.2e}, whole {whole:.2e} rad; ratios {:.1}, {:.1}",
        effect.kind.name(),
        pid / whole,
        base / whole
    );
    found
}

/// The whole model compensated, true or as discovered, leaves at most a half of the base model's error and a fifth of
/// the PID's.
///
/// The limit is the encoder: with 8000 counts per turn the loop errs by 1.2e-4 rad (0.15 counts) on a plant without
/// any effect. With the base model, the error of the asymmetric viscous friction is less than twice that, because the
/// integral works on it too. There the whole model does as well as on a plant without the effect. The half needs a
/// finer encoder.
#[test]
fn a_compensated_effect_is_tracked_better() {
    let floor = error(&[], Some(&[]), SINE, STEP);
    println!("without any effect: {floor:.2e} rad");
    assert!(floor < 0.2 * STEP, "{floor}");
    for effect in effects() {
        for model in [effect, discovered(&effect)] {
            let [pid, base, whole] = ladder(effect, model, STEP);
            assert!(whole <= pid / 5.0, "{:?}: {whole} {pid}", effect.kind);
            assert!(whole <= base / 2.0 || whole <= 1.1 * floor, "{:?}: {whole} {base} {floor}", effect.kind);
            let [pid, base, whole] = ladder(effect, model, 0.1 * STEP);
            assert!(whole <= pid / 5.0 && whole <= base / 2.0, "{:?}: {pid} {base} {whole}", effect.kind);
        }
    }
}

/// A constant load is what an integral is for: feed-forward does no worse, to the 5 % that encoder noise makes of either.
#[test]
fn a_constant_load_is_no_worse_than_integral_action() {
    let load = [Effect::new(Kind::ConstantLoad, &[TENTH])];
    for step in [STEP, 0.1 * STEP] {
        let integral = error(&load, Some(&[]), SINE, step);
        let fed = error(&load, Some(&load), SINE, step);
        println!("constant load at {step:.1e} rad: integral {integral:.3e}, fed forward {fed:.3e} rad");
        assert!(fed <= 1.05 * integral, "{fed} {integral}");
    }
}

/// The other effects that the catalogue says can be compensated, drive-path ones by their inverse. In closed loop
/// none is worse for it. Each is at the encoder's floor, or at most two thirds of the base model's error.
#[test]
fn every_compensable_effect_gains_or_stays() {
    let floor = error(&[], Some(&[]), SINE, STEP);
    for effect in [
        Effect::new(Kind::DeadZone, &[TENTH]),
        Effect::new(Kind::PwmDeadTime, &[TENTH, 0.2, 0.05]),
        Effect::new(Kind::LoadFriction, &[0.1]),
        Effect::new(Kind::QuadraticDrag, &[TENTH / 2.46]),
        Effect::new(Kind::Spring, &[TENTH, 0.2]),
        Effect::new(Kind::GravityLoad, &[TENTH, 0.3]),
    ] {
        let [pid, base, whole] = ladder(effect, effect, STEP);
        assert!(whole < pid / 5.0, "{:?}: {whole} {pid}", effect.kind);
        assert!(whole <= base / 1.5 || whole <= 1.2 * floor, "{:?}: {whole} {base} {floor}", effect.kind);
    }
}
