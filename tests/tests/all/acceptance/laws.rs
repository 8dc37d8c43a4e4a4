//! Laws of the host's identification: units, sign, origin of time.

use breakaway::identify::estimate::{Identification, Value, identify};
use breakaway::recording::Recording;
use proptest::prelude::*;

use super::{PAIR, relay_record, sensor};

/// Seven cycles of each experiment of the pair under a load of 0.1.
fn records(seed: u64) -> Vec<Recording> {
    PAIR.map(|(h1, h2, period)| relay_record(0.1, (h1, h2), 7.0 * period, sensor(1e-3), seed)).to_vec()
}

fn scaled(records: &[Recording], kx: f64, ku: f64) -> Vec<Recording> {
    records
        .iter()
        .map(|record| Recording {
            x: record.x.iter().map(|x| kx * x).collect(),
            u: record.u.iter().map(|u| ku * u).collect(),
            encoder_step: record.encoder_step.map(|step| step * kx.abs()),
            ..record.clone()
        })
        .collect()
}

/// b, c, f1 and, where it is estimated, the load of every estimator.
fn values(found: &Identification) -> Vec<[Option<f64>; 4]> {
    let value = |v: Value| Some(v.value);
    found.estimates.iter().map(|e| [value(e.b), value(e.c), value(e.f1), e.load.and_then(value)]).collect()
}

/// All estimators agree after the expected factors. What differs is rounding, carried through at most 15 iterations.
fn agree(one: &Identification, other: &Identification, factors: [f64; 4]) -> Result<(), TestCaseError> {
    prop_assert_eq!((one.white, one.best.estimator), (other.white, other.best.estimator));
    for (a, b) in values(one).iter().zip(values(other)) {
        for ((a, b), factor) in a.iter().zip(b).zip(factors) {
            prop_assert_eq!(a.is_some(), b.is_some());
            if let (Some(a), Some(b)) = (a, b) {
                prop_assert!((b / (factor * a) - 1.0).abs() < 1e-6, "{a} {b} {factor}");
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    /// x → kx, u → lu: b and c scale with l/k, f1 and the load with l. Powers of two, so that no rounding of the data
    /// moves a sample across a threshold.
    #[test]
    fn units_scale(k in -20_i32..20, l in -12_i32..12, seed in 0_u64..20) {
        let (k, l) = (2.0_f64.powi(k), 2.0_f64.powi(l));
        let records = records(seed);
        let (one, other) = (identify(&records).unwrap(), identify(&scaled(&records, k, l)).unwrap());
        agree(&one, &other, [l / k, l / k, l, l])?;
        prop_assert!((other.noise / (k * one.noise) - 1.0).abs() < 1e-9);
    }

    /// u, x → −u, −x: the same b, c, f1 and the opposite load.
    #[test]
    fn sign_symmetry(seed in 0_u64..20) {
        let records = records(seed);
        let (one, other) = (identify(&records).unwrap(), identify(&scaled(&records, -1.0, -1.0)).unwrap());
        agree(&one, &other, [1.0, 1.0, 1.0, -1.0])?;
    }

    /// A session that begins at another time gives the same.
    #[test]
    fn time_shift(shift in -1e3..1e3_f64, seed in 0_u64..20) {
        let records = records(seed);
        let mut later = records.clone();
        for record in &mut later {
            record.t.iter_mut().for_each(|t| *t += shift);
        }
        agree(&identify(&records).unwrap(), &identify(&later).unwrap(), [1.0; 4])?;
    }
}
