//! The sine fit's standard errors, residual and phases against the information matrix of the record. The matrix is
//! written out and inverted without any of the fit's own steps.

use breakaway_core::estimate::sine::{
    BlockSums, FrequencySearch, SineFit, SineModel, StreamingSine, even, fit_fixed, fit_free,
};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use std::f64::consts::{PI, TAU};

/// Gauss–Jordan with the largest pivot.
fn inverse(mut a: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let n = a.len();
    for (i, row) in a.iter_mut().enumerate() {
        row.extend((0..n).map(|j| if i == j { 1.0 } else { 0.0 }));
    }
    for i in 0..n {
        let pivot = (i..n).max_by(|j, k| a[*j][i].abs().total_cmp(&a[*k][i].abs())).unwrap();
        a.swap(i, pivot);
        let scale = a[i][i];
        a[i].iter_mut().for_each(|cell| *cell /= scale);
        let row = a[i].clone();
        for (_, other) in a.iter_mut().enumerate().filter(|(j, _)| *j != i) {
            let share = other[i];
            other.iter_mut().zip(&row).for_each(|(cell, own)| *cell -= share * own);
        }
    }
    a.into_iter().map(|row| row[n..].to_vec()).collect()
}

/// The model's columns at time `t` from the centre: sine and cosine, then, where wanted, constant, slope, and those
/// of the harmonics. Each harmonic has its number and its place.
fn columns(model: SineModel, omega: f64, t: f64) -> (Vec<f64>, Vec<(f64, usize)>) {
    let pair = |harmonic: f64| [(harmonic * omega * t).sin(), (harmonic * omega * t).cos()];
    let (mut row, mut harmonics) = (pair(1.0).to_vec(), vec![(1.0, 0)]);
    if model.offset {
        row.push(1.0);
    }
    if model.drift {
        row.push(t);
    }
    for (asked, harmonic) in [(model.third, 3.0), (model.fifth, 5.0)] {
        if asked {
            harmonics.push((harmonic, row.len()));
            row.extend(pair(harmonic));
        }
    }
    (row, harmonics)
}

/// What the fit says of the linear parameters, in the order of the columns.
fn parameters(model: SineModel, fit: &SineFit) -> Vec<f64> {
    let pair = |size: f64, phase: f64| [size * phase.cos(), size * phase.sin()];
    let mut all = pair(fit.amplitude, fit.phase_centre_rad).to_vec();
    if model.offset {
        all.push(fit.offset);
    }
    all.extend(fit.drift_per_s);
    for harmonic in [fit.third, fit.fifth].into_iter().flatten() {
        all.extend(pair(harmonic.amplitude, harmonic.phase_centre_rad));
    }
    all
}

fn close(found: f64, wanted: f64, tolerance: f64) -> bool {
    (found - wanted).abs() <= tolerance * wanted.abs()
}

/// Compares rms, cycles, phase at the start and the standard errors of a fit with those of the record: to `tolerance`, relative.
fn check(record: &[(f64, f64)], model: SineModel, fit: &SineFit, free: bool, tolerance: f64) {
    let (first, last) = (record[0].0, record[record.len() - 1].0);
    let (centre, half) = (0.5 * (first + last), 0.5 * (last - first));
    let theta = parameters(model, fit);
    let n = theta.len() + usize::from(free);
    let mut information = vec![vec![0.0; n]; n];
    let mut squares = 0.0;
    for (t, y) in record {
        let (mut row, harmonics) = columns(model, fit.omega_rad_s, t - centre);
        assert_eq!(row.len(), theta.len());
        squares += (y - row.iter().zip(&theta).map(|(x, p)| x * p).sum::<f64>()).powi(2);
        if free {
            let slope = |(h, i): &(f64, usize)| h * (t - centre) * (theta[*i] * row[i + 1] - theta[i + 1] * row[*i]);
            row.push(harmonics.iter().map(slope).sum());
        }
        for (cells, a) in information.iter_mut().zip(&row) {
            cells.iter_mut().zip(&row).for_each(|(cell, b)| *cell += a * b);
        }
    }
    let covariance = inverse(information);
    // Of a combination of p, q and ω.
    let error = |[p, q, omega]: [f64; 3]| {
        let mut direction = vec![0.0; n];
        (direction[0], direction[1]) = (p, q);
        if free {
            direction[n - 1] = omega;
        }
        let along = |row: &Vec<f64>| row.iter().zip(&direction).map(|(a, b)| a * b).sum::<f64>();
        fit.rms * direction.iter().zip(covariance.iter().map(along)).map(|(a, b)| a * b).sum::<f64>().sqrt()
    };
    let (sin, cos) = fit.phase_centre_rad.sin_cos();
    let across = [-sin / fit.amplitude, cos / fit.amplitude];
    let offset = if model.offset { fit.rms * covariance[2][2].sqrt() } else { 0.0 };
    for (name, found, wanted) in [
        ("rms", fit.rms, (squares / (record.len() - n) as f64).sqrt()),
        ("A", fit.se.amplitude, error([cos, sin, 0.0])),
        ("ω", fit.se.omega_rad_s, error([0.0, 0.0, 1.0])),
        ("θ at the centre", fit.se.phase_centre_rad, error([across[0], across[1], 0.0])),
        ("θ at the start", fit.se.phase_start_rad, error([across[0], across[1], -half])),
        ("d", fit.se.offset, offset),
    ] {
        assert!(close(found, wanted, tolerance), "{model:?}: {name}: {found} for {wanted}");
    }
    let start = fit.phase_centre_rad - fit.omega_rad_s * half;
    let turned = (fit.phase_start_rad - start + PI).rem_euclid(TAU) - PI;
    assert!(turned.abs() < 1e-9 && fit.phase_start_rad.abs() <= PI && fit.phase_centre_rad.abs() <= PI);
    let samples = record.len() as f64;
    assert!(close(fit.cycles, fit.omega_rad_s / TAU * (last - first) * samples / (samples - 1.0), 1e-12));
    assert_eq!(fit.samples, record.len());
}

/// `cycles` cycles in 120 samples, with harmonics, a slope and a disturbance that is none of them. With `jitter` the clock is
/// uneven, by a third of a period at most.
fn record(cycles: f64, phase: f64, jitter: f64) -> Vec<(f64, f64)> {
    let omega = cycles * TAU / 1.2;
    let sample = |i: u32| {
        let t = 5.0 + 0.01 * f64::from(i) + jitter * 0.003 * (1.7 * f64::from(i * i)).sin();
        let angle = omega * t + phase;
        let odd = 0.2 * (3.0 * angle + 0.4).sin() + 0.1 * (5.0 * angle - 1.0).sin();
        (t, 2.0 * angle.sin() + odd + 3.0 + 0.5 * (t - 5.6) + 0.05 * (f64::from(i * i) * 0.7).sin())
    };
    (0..120).map(sample).collect()
}

/// With every combination of columns, at few cycles, where ω, the offset and the sine share most, and at many.
#[test]
fn errors_are_those_of_the_information() {
    for cycles in [1.6, 2.3, 7.0] {
        let omega = cycles * TAU / 1.2;
        for phase in [0.0, 1.0, 2.0, 3.5, 5.0] {
            let record = record(cycles, phase, 1.0);
            for bits in 0..16 {
                let [offset, drift, third, fifth] = [1, 2, 4, 8].map(|bit| bits & bit != 0);
                let model = SineModel { offset, drift, third, fifth };
                let fixed = fit_fixed(record.iter().copied(), omega, model).unwrap();
                check(&record, model, &fixed, false, 1e-7);
                if !offset {
                    continue;
                }
                let search = FrequencySearch::between(0.7 * omega, 1.4 * omega);
                let free = fit_free(record.iter().copied(), search, model).unwrap();
                check(&record, model, &free, true, 1e-7);
            }
        }
    }
}

/// The blocks' sums lose a little of it: at a quarter period per block ω and A less than a hundredth.
#[test]
fn errors_of_the_streaming_fit_are_those_of_the_information() {
    for cycles in [1.1, 2.3, 7.0] {
        for phase in [0.0, 1.0, 2.0, 3.5, 5.0] {
            let angle = |i: u32| cycles * TAU * f64::from(i) / 1200.0 + phase;
            let y: Vec<f64> =
                (0..1200).map(|i| 2.0 * angle(i).sin() + 3.0 + 0.05 * (f64::from(i * i) * 0.7).sin()).collect();
            let config = StreamingSine::new(cycles * TAU, 1.0 / 1200.0).unwrap();
            let mut sums: BlockSums<f64> = BlockSums::new();
            config.push_slice(&mut sums, &y);
            let record: Vec<(f64, f64)> = even(&y, 0.0, 1.0 / 1200.0).collect();
            check(&record, SineModel::default(), &config.fit(&sums).unwrap(), true, 0.03);
        }
    }
}

/// The residual's variance is the noise's in the mean: 4 blocks of 4 samples have 3·4 − 4 degrees of freedom and 16 − 3·4 within.
/// Its standard error over 4 000 records is √(2/12/4000) = .65 %; four parameters too many or too few change it by 40 %.
#[test]
fn the_residual_of_the_shortest_streams_is_the_noise() {
    let mut rng = ChaCha8Rng::seed_from_u64(31);
    let (period, noise, records) = (16, 0.01, 4000);
    let config = StreamingSine::<f64>::of_period(period, 0.01).unwrap();
    let mut sum = 0.0;
    for _ in 0..records {
        let mut sums: BlockSums<f64> = BlockSums::new();
        for i in 0..period {
            let normal: f64 = StandardNormal.sample(&mut rng);
            config.push(&mut sums, (TAU * f64::from(i) / f64::from(period) + 0.3).sin() + noise * normal);
        }
        sum += config.fit(&sums).unwrap().rms.powi(2);
    }
    let over = sum / (f64::from(records) * noise * noise);
    assert!((over - 1.0).abs() < 0.025, "{over}");
}
