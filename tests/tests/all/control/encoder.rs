//! The drive and the error of the board's loop by tick rate and encoder: a table of docs/control.md, section "The encoder".

use super::*;
use breakaway_core::control::Gains;

/// What is followed: the model needs 1.22 V rms for it.
const REFERENCE: &str = "sine:1,1";

/// Rms of the drive that the model needs along the reference, V.
fn needed() -> f64 {
    let points = REFERENCE.parse::<Reference>().unwrap().points::<f64>(1e-3, 1000).unwrap();
    let square = |p: &breakaway_core::control::Setpoint<f64>| {
        let u = BASE.b * p.a + BASE.c * p.v + BASE.f1 * p.v.signum();
        u * u
    };
    (points.iter().map(square).sum::<f64>() / 1000.0).sqrt()
}

/// Rms of drive (V) and of error (mrad) of what `track` runs on a board without delay.
fn follow(rate_hz: f64, counts: u32, compensate: bool) -> (Design, f64, f64) {
    let tick_s = 1.0 / rate_hz;
    let step = std::f64::consts::TAU / f64::from(counts);
    let request = Request {
        tick_s,
        delay_ticks: 1,
        bandwidth_hz: None,
        drive_limit: 24.0,
        encoder_step: step,
        speed: None,
        acceleration: None,
        adaptation_rate: 5.0,
    };
    let mut design = Design::new(&model(&[]), &request).unwrap();
    design.gains = Gains { filter_s: 2.0 * tick_s, ..design.gains };
    design.compensate = compensate;
    let controller = design.controller::<f32>().unwrap();
    let bench = Bench { tick_s, delay_ticks: 0, encoder_step: step, noise: 0.0, drive_limit: 24.0, seed: 1 };
    let reference: Reference = REFERENCE.parse().unwrap();
    let points = reference.points(tick_s, (5.0 * rate_hz) as usize).unwrap();
    let tracked = track(&model(&[]), &controller, &points, &bench, rate_hz as usize).unwrap();
    (design, tracked.drive_rms(), 1e3 * tracked.rms())
}

/// With a filter of two ticks the drive is noise at 10 kHz: 18.7 V rms with 4096 counts where the model needs 1.2 V.
#[test]
fn the_drive_is_the_model_s() {
    println!("needed: {:.2} V", needed());
    assert!(follow(10e3, 4096, false).1 > 10.0 * needed());
    for rate_hz in [1e3, 4e3, 10e3] {
        for counts in [1024, 4096, 16_384, 65_536] {
            let (design, drive, error) = follow(rate_hz, counts, false);
            let (_, drive_ff, error_ff) = follow(rate_hz, counts, true);
            let hz = design.margins().map_or(f64::NAN, |m| m.crossover_rad_s / std::f64::consts::TAU);
            println!("| {rate_hz} | {counts} | {hz:.1} | {drive:.2} | {error:.2} | {drive_ff:.2} | {error_ff:.2} |");
        }
    }
}
