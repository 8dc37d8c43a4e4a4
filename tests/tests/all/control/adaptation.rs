//! The adaptive law as `breakaway tune` sets it up (docs/adaptive.md): it learns friction, and does not learn the encoder.

use breakaway_core::control::Estimates;
use breakaway_tests::adaptive_default::{Adapted, design};

use breakaway::control::design::DEFAULT_ADAPTATION_RATE;

/// f1 30 % above the model: within two minutes the error is halved and most of the rise is learnt. With δ four times as
/// wide, which once was the default, nothing is.
#[test]
fn friction_that_rose_is_learnt() {
    let usual = Adapted::follow(&design(None, DEFAULT_ADAPTATION_RATE), 1.3, 120);
    let wide = Adapted::follow(&design(Some(2.0), DEFAULT_ADAPTATION_RATE), 1.3, 120);
    println!(
        "{:.2e} to {:.2e} rad, {:?}; wide {:?}",
        usual.rms(4, 12),
        usual.rms(90, 120),
        usual.estimates,
        wide.estimates
    );
    assert!(usual.rms(90, 120) < 0.55 * usual.rms(4, 12));
    assert!(usual.estimates.f1 > 0.89, "{:?}", usual.estimates);
    assert!(wide.estimates.f1 < 0.78 && wide.rms(90, 120) > 0.9 * wide.rms(4, 12), "{:?}", wide.estimates);
}

/// Twenty minutes on the plant of the model: no estimate leaves by more than a tenth, and the error stays below the
/// encoder's rounding (0.29 mrad). That a narrow δ fails this is tested too.
#[test]
fn rounding_is_not_learnt() {
    let off =
        |hat: &Estimates<f64>| [hat.b, hat.c, hat.f1].iter().fold(0.0_f64, |most, one| most.max((one - 1.0).abs()));
    let usual = Adapted::follow(&design(None, DEFAULT_ADAPTATION_RATE), 1.0, 1200);
    let narrow = Adapted::follow(&design(Some(0.02), 2.0 * DEFAULT_ADAPTATION_RATE), 1.0, 1200);
    println!("{:.2e} rad, {:?}; narrow {:?}", usual.rms(1140, 1200), usual.estimates, narrow.estimates);
    assert!(off(&usual.estimates) < 0.1 && usual.rms(1140, 1200) < 0.29e-3, "{:?}", usual.estimates);
    assert!(off(&narrow.estimates) > 0.1, "{:?}", narrow.estimates);
}
