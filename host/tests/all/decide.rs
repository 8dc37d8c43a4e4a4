//! The paired decision of `host/src/discover/decide.rs`, against numbers worked out by hand.

use breakaway::discover::decide::{FURTHER, NAMING, Paired, Thresholds, paired};

/// Mean squares that are σ²·(e^g − 1): over a model without error they gain g.
fn squares(gains: &[f64], sigma: f64) -> Vec<f64> {
    gains.iter().map(|g| sigma * sigma * g.exp_m1()).collect()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12 * b.abs().max(1.0)
}

const GAINS: [f64; 5] = [0.5, 0.1, 0.4, 0.2, 0.3];
const SAMPLES: [f64; 5] = [10.0, 2.0, 8.0, 4.0, 6.0];

/// Gains .1 to .5: mean .3, variance .1/4, z = .3/√(.025/5) = 3√2. Half of gain times samples is .1, .4, .9, 1.6, 2.5, and
/// without the two best 1.4.
#[test]
fn mean_z_and_likelihood_of_five_segments() {
    let p = paired(&squares(&GAINS, 1.0), &[0.0; 5], &SAMPLES, 1.0);
    assert!(close(p.delta, 0.3) && close(p.z, 3.0 * 2.0_f64.sqrt()) && close(p.lambda, 1.4), "{p:?}");
}

/// Asked the other way round, mean and z change their signs; the two best are then the two least bad: −2.5 − 1.6 − .9.
#[test]
fn the_other_way_round() {
    let p = paired(&[0.0; 5], &squares(&GAINS, 1.0), &SAMPLES, 1.0);
    assert!(close(p.delta, -0.3) && close(p.z, -3.0 * 2.0_f64.sqrt()) && close(p.lambda, -5.0), "{p:?}");
}

/// Neither the unit of the position nor the order of the segments matters.
#[test]
fn units_do_not_matter() {
    let own = paired(&squares(&GAINS, 1.0), &squares(&[0.05; 5], 1.0), &SAMPLES, 1.0);
    let milli = paired(&squares(&GAINS, 1e-3), &squares(&[0.05; 5], 1e-3), &SAMPLES, 1e-3);
    let back = |values: &[f64]| values.iter().rev().copied().collect::<Vec<f64>>();
    let turned = paired(&back(&squares(&GAINS, 1.0)), &squares(&[0.05; 5], 1.0), &back(&SAMPLES), 1.0);
    for other in [milli, turned] {
        assert!(close(other.delta, own.delta) && close(other.z, own.z) && close(other.lambda, own.lambda), "{other:?}");
    }
    assert!(close(own.delta, 0.25), "{own:?}");
}

/// An error below the noise gains next to nothing: ln(1 + r) with r = mse/σ².
#[test]
fn errors_below_the_noise_count_little() {
    let p = paired(&[0.02; 3], &[0.01; 3], &[100.0; 3], 1.0);
    assert!(close(p.delta, (1.02_f64 / 1.01).ln()) && p.delta < 0.01, "{p:?}");
}

/// Two segments have no evidence left without the two best; one and none give no number that is none.
#[test]
fn few_segments_name_nothing() {
    for n in 0..=2 {
        let p = paired(&squares(&GAINS[..n], 1.0), &[0.0; 5][..n], &SAMPLES[..n], 1.0);
        assert!(!p.delta.is_nan() && !p.z.is_nan() && p.lambda == 0.0, "{n}: {p:?}");
        assert!(!p.names(0, &NAMING), "{n}: {p:?}");
    }
    // Gains .5 and .1: mean .3, variance .08, z = .3/√(.08/2).
    let two = paired(&squares(&GAINS[..2], 1.0), &[0.0; 2], &SAMPLES[..2], 1.0);
    assert!(close(two.z, 1.5), "{two:?}");
}

/// Every threshold is reached at its number, and each parameter has its price.
#[test]
fn all_three_thresholds_are_asked() {
    let t = Thresholds { delta: 0.5, z: 2.0, lambda: 25.0, price: 3.5 };
    let at = Paired { delta: 0.5, z: 2.0, lambda: 32.0 };
    assert!(at.names(2, &t));
    assert!(!at.names(3, &t));
    assert!(!Paired { delta: 0.499, ..at }.names(2, &t));
    assert!(!Paired { z: 1.99, ..at }.names(2, &t));
    assert!(!Paired { lambda: 31.99, ..at }.names(2, &t));
    assert!(Paired { delta: 9.0, z: 9.0, lambda: 99.0 }.names(2, &t));
}

/// A likelihood of more than 100, after the price, needs only z above 1.2; the least gain is asked all the same.
#[test]
fn a_likelihood_beyond_doubt_needs_no_vote() {
    let t = Thresholds { delta: 0.5, z: 2.0, lambda: 25.0, price: 3.5 };
    let few = Paired { delta: 0.5, z: 1.3, lambda: 107.5 };
    assert!(few.names(2, &t));
    assert!(!few.names(3, &t));
    assert!(!Paired { lambda: 107.0, ..few }.names(2, &t));
    assert!(!Paired { z: 1.2, ..few }.names(2, &t));
    assert!(!Paired { delta: 0.49, ..few }.names(2, &t));
}

/// A further effect is asked for more than the first, and for nothing less.
#[test]
fn a_further_effect_needs_more() {
    let (first, further) = (NAMING, FURTHER);
    assert!(further.delta > first.delta);
    assert_eq!((FURTHER.z, FURTHER.lambda, FURTHER.price), (NAMING.z, NAMING.lambda, NAMING.price));
}
