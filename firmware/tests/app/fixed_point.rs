//! The controllers in fixed point beside those in floating point, on the same plant.

use breakaway_core::link::{Command, FULL_SCALE_CODE, Mode, Sample, Trajectory};
use breakaway_core::scalar::Q32;
use breakaway_rig::FULL_SCALE;

use crate::track::{SINE, adaptive, pid, rms, run, track};

/// Largest difference of the references (counts) and of the positions (counts), rms of that of the drives (V).
fn differences(a: &[Sample], b: &[Sample]) -> (i32, i32, f64) {
    assert_eq!(a.len(), b.len());
    let pairs = || a.iter().zip(b);
    let most = |of: fn(&Sample) -> i32| pairs().map(|(a, b)| (of(a) - of(b)).abs()).max().unwrap();
    let volts = |sample: &Sample| f64::from(sample.drive_code) / f64::from(FULL_SCALE_CODE) * FULL_SCALE;
    let squares: f64 = pairs().map(|(a, b)| (volts(a) - volts(b)).powi(2)).sum();
    (most(|sample| sample.reference), most(|sample| sample.count), (squares / a.len() as f64).sqrt())
}

/// Q32 follows as f32 does. The reference is the same to one count, which a rounding may tip over. The position is
/// the same to three, because an encoder's step a tick later makes another drive for as long as the filter lasts. The
/// error's rms is the same to a tenth.
#[test]
fn fixed_point_follows_as_floating_point_does() {
    let triangle = Trajectory::Triangle { amplitude: 0.5, period_s: 2.0 };
    let jerk = Trajectory::MinimumJerk { distance: -2.0, duration_s: 1.5 };
    let runs: [(&str, Command); 7] = [
        ("sine, PID", track(SINE, pid(), false)),
        ("sine, PID compensated", track(SINE, pid(), true)),
        ("sine, adaptive", track(SINE, adaptive(), false)),
        ("sine, adaptive compensated", track(SINE, adaptive(), true)),
        ("triangle, PID compensated", track(triangle, pid(), true)),
        ("move, PID compensated", track(jerk, pid(), true)),
        ("step, PID", track(Trajectory::Step { distance: 0.5 }, pid(), false)),
    ];
    for (name, command) in runs {
        let float = run::<f32>(command.clone(), Mode::Track);
        let fixed = run::<Q32>(command, Mode::Track);
        let (reference, position, drive) = differences(&float, &fixed);
        let errors = (1e3 * rms(&float), 1e3 * rms(&fixed));
        println!("| {name} | {reference} | {position} | {drive:.3} | {:.3} | {:.3} |", errors.0, errors.1);
        assert!(reference <= 1 && position <= 3, "{name}: {reference} {position}");
        assert!((errors.1 - errors.0).abs() < 0.1 * errors.0 + 0.05, "{name}: {errors:?} mrad");
    }
}
