use super::*;

/// Σ cos αm and −Σ m·sin αm, m centred, sample by sample.
fn summed(alpha: f64, samples: u64) -> (f64, f64) {
    let centred = |k: u64| k as f64 - 0.5 * (samples as f64 - 1.0);
    let term = |k| (libm::cos(alpha * centred(k)), -centred(k) * libm::sin(alpha * centred(k)));
    (0..samples).map(term).fold((0.0, 0.0), |sum, term| (sum.0 + term.0, sum.1 + term.1))
}

/// Largest errors of the kernel over `samples` samples, the sum's as a share of L and the slope's of L². They cover
/// the power series, its end, and angles far beyond it. Both signs of the angle are tried; the sign leaves the sum
/// and turns the slope.
fn errors<R: SolverReal>(samples: u64) -> (f64, f64) {
    let length = samples as f64;
    let end = R::SMALL_ANGLE.to_f64();
    let (mut of_sum, mut of_slope) = (0.0_f64, 0.0_f64);
    for x in [0.0, 1e-3, 0.1 * end, 0.5 * end, 0.999 * end, 1.001 * end, 2.0 * end, 1.0, 3.0, 7.7, 20.0] {
        let half = libm::round(0.5 * x / length / RADIANS).min(i64::MAX as f64) as i64;
        let alpha = 2.0 * RADIANS * half as f64;
        if alpha >= 1.5 * PI {
            continue;
        }
        let (sum, slope) = summed(alpha, samples);
        for sign in [1, -1] {
            let (d, dd) = dirichlet::<R>((sign * half) as u64, samples);
            of_sum = of_sum.max((d.to_f64() - sum).abs() / length);
            of_slope = of_slope.max((dd.to_f64() - sign as f64 * slope).abs() / (length * length));
        }
    }
    (of_sum, of_slope)
}

/// The kernel is the sum over the samples, and its derivative is that of the sum. The sum is good to some ten
/// roundings of the number type. The slope is good to a hundred, because it is a difference of two that are 1/x
/// larger at the end of the series.
#[test]
fn the_kernel_is_the_sum_over_the_samples() {
    let records = if cfg!(miri) { 2 } else { 4 };
    for samples in [4, 9, 250, 10_001].into_iter().take(records) {
        let (sum, slope) = errors::<f64>(samples);
        assert!(sum < 1e-14 && slope < 1e-12, "{samples}: {sum:e} {slope:e}");
        let (sum, slope) = errors::<f32>(samples);
        assert!(sum < 1e-6 && slope < 1e-5, "{samples} in f32: {sum:e} {slope:e}");
    }
}

/// Power of a model over its samples, against the sum sample by sample: harmonics of the record and what is not one.
#[test]
fn the_models_power_is_the_sum_over_the_samples() {
    for (omega, samples) in [(0.02, 700_u64), (0.3, 33), (1.1, 8), (0.004, 1000)] {
        for theta in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.8, -1.3, 0.4]] {
            let half = libm::round(0.5 * omega / RADIANS) as u64;
            let at = |k: u64| omega * (k as f64 - 0.5 * (samples as f64 - 1.0));
            let value = |k| theta[0] * libm::sin(at(k)) + theta[1] * libm::cos(at(k)) + theta[2];
            let summed: f64 = (0..samples).map(|k| value(k) * value(k)).sum();
            let power = model_power::<f64>(&theta, half, samples);
            assert!((power - summed).abs() < 1e-11 * samples as f64, "{omega} {samples} {theta:?}: {power} {summed}");
        }
    }
}

/// The mean of the two sources is by inverse variance. Where the model hides nothing from the blocks, it is by their
/// freedoms; where it does, by n·n·b/(n·b + 2H) for `within`. Where nothing is within, the blocks' residual alone
/// counts.
#[test]
fn the_noise_is_the_mean_of_two_sources() {
    let of = |within: f64, within_freedom: f64, hidden_model: f64| {
        Noise { within, within_freedom, between: 6.0, between_freedom: 3.0, hidden_model }.variance()
    };
    assert_eq!(of(77.0, 0.5, 0.0), 2.0);
    assert_eq!(of(4.0, 1.0, 0.0), (4.0 + 6.0) / (1.0 + 3.0));
    assert_eq!(of(30.0, 10.0, 0.0), (30.0 + 6.0) / (10.0 + 3.0));
    assert_eq!(of(30.0, 10.0, -1.0), (30.0 + 6.0) / (10.0 + 3.0));
    // Weight 10·(10·2/(10·2 + 2·30)) = 2.5.
    assert_eq!(of(30.0, 10.0, 30.0), (2.5 * 3.0 + 6.0) / (2.5 + 3.0));
}

/// An alias has less than a tenth of its power in the blocks: amplitude² · ½ against what varies within.
#[test]
fn an_alias_is_a_tenth_of_its_power() {
    let point = |p: f64, q: f64| {
        let mut normal = Normal::<f64, N>::EMPTY;
        for k in 0..N {
            let mut row = [0.0; N];
            row[k] = 1.0;
            normal.add(&row, 1.0);
        }
        let factor = normal.factor().unwrap();
        Point { theta: [p, q, 9.0], factor, shadow: [0.0; N], information: 1.0, descent: 0.0, rss: 0.0 }
    };
    assert!(is_alias(&point(3.0, 4.0), 125.5) && !is_alias(&point(3.0, 4.0), 124.5));
    assert!(!is_alias(&point(3.0, 4.0), 125.0));
    assert!(is_alias(&point(0.0, -5.0), 125.5) && !is_alias(&point(-5.0, 0.0), 124.5));
}
