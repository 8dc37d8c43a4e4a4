//! The smoothed motion at the ends of a recording.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

use crate::fit::MeasuredMotion;
use crate::fit::settings::HALF_WIDTH_S;
use crate::recording::{Recording, Units};

/// The slope at either end of a resting axis has the deviation of a parabola over 21 samples. That is 1.5·σ/h for many
/// samples, and 1.42·σ/h by the sums of these 21. A one-sided cubic over 11 has 10·σ/h. 200 records give it to 10 %,
/// three of its own deviations over 400 ends.
#[test]
fn a_resting_axis_seems_to_rest_at_the_ends_too() {
    const SIGMA: f64 = 1e-3;
    let mut square = 0.0;
    for seed in 0..200 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let noise = Normal::new(0.0, SIGMA).unwrap();
        let t: Vec<f64> = (0..64).map(|k| f64::from(k) * 1e-3).collect();
        let x: Vec<f64> = t.iter().map(|_| noise.sample(&mut rng)).collect();
        let recording = Recording {
            name: "rest".into(),
            u: vec![0.0; t.len()],
            t,
            x,
            units: Units::default(),
            ..Recording::default()
        };
        let track = MeasuredMotion::new(&recording);
        square += track.vs[0].powi(2) + track.vs[63].powi(2);
    }
    let deviation = (square / 400.0).sqrt() / (SIGMA / HALF_WIDTH_S);
    assert!((deviation / 1.42 - 1.0).abs() < 0.1, "{deviation}");
}
