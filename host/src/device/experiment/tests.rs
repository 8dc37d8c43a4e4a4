use breakaway_core::link::{Bounds, DriveUnit, PositionUnit, Text};

use super::*;
use crate::simulate::experiment::Sensor;
use crate::simulate::suite::{self, Machine};

fn scale() -> Scale {
    Scale::new(&Info {
        protocol_version: 1,
        schema: 0,
        firmware: Text::new(),
        build: Text::new(),
        board: Text::new(),
        tick_hz: 10_000,
        counts_per_revolution: 0,
        position_per_count: 0.001,
        position_unit: PositionUnit::Radian,
        drive_full_scale: 24.0,
        drive_unit: DriveUnit::Volt,
        current_range_ma: 0,
    })
    .unwrap()
}

fn suite_of(force: f64) -> Vec<Experiment> {
    let sensor = Sensor { encoder_step: 0.001, noise: 0.0, delay_ticks: 0 };
    let machine = Machine { drive_limit: 5.0, travel: 5.0, tick_s: 1e-4, sensor, seed: 1 };
    suite::suite(force, &machine).into_iter().map(|(_, experiment)| experiment).collect()
}

/// 4 V shared 3 : 1 are 3 V and 1 V: codes 4096 and 1365 of 32767 = 24 V; 6 s are 60 000 ticks; 5 V are code 6826.
#[test]
fn a_relay_becomes_codes_counts_and_ticks() {
    let commands = commands(&suite_of(0.5)[0], &scale()).unwrap();
    let [Command::StartRelay(relay)] = commands.as_slice() else { panic!("{commands:?}") };
    assert_eq!((relay.h1_code, relay.h2_code, relay.hysteresis_counts), (4096, 1365, None));
    assert_eq!(relay.bounds, Bounds { max_ticks: 60_000, drive_max_code: 6826, travel_counts: 0 });
}

#[test]
fn the_whole_suite_fits_a_board() {
    for experiment in suite_of(0.5) {
        for command in commands(&experiment, &scale()).unwrap() {
            assert_eq!(command.validate(), Ok(()), "{}", experiment.name);
        }
    }
}

/// A period of the multisine holds its 64 harmonics of equal power and nothing else; the peak is full scale.
#[test]
fn a_multisine_fills_the_table_with_its_lines() {
    let (parts, period_s) = waveform::multisine(0.25, 16.0, 3).unwrap();
    assert_eq!(period_s, 4.0);
    let points: Vec<f64> = parts.iter().flat_map(|part| part.points.iter().map(|p| f64::from(*p))).collect();
    assert_eq!(points.len(), 512);
    assert_eq!(points.iter().fold(0.0, |peak: f64, p| peak.max(p.abs())), 32_767.0);
    let power = |k: usize| {
        let turn = std::f64::consts::TAU * k as f64 / 512.0;
        let (c, s) = points
            .iter()
            .enumerate()
            .fold((0.0, 0.0), |(c, s), (i, p)| (c + p * (turn * i as f64).cos(), s + p * (turn * i as f64).sin()));
        (c * c + s * s).sqrt() / 256.0
    };
    // Rounding to integers moves a line's amplitude by at most about √(2/512)·0.29 = 0.02 standard deviations.
    let first = power(1);
    for k in 1..=64 {
        assert!((power(k) - first).abs() < 0.2, "line {k}: {} against {first}", power(k));
    }
    assert!(power(0) < 0.2 && power(65) < 0.2 && power(100) < 0.2);
    assert!(waveform::multisine(0.1, 16.0, 3).is_err());
}

#[test]
fn what_a_board_cannot_do_is_named() {
    let relay = |h1, h2| {
        let mut experiment = suite_of(0.5).remove(0);
        experiment.excitation = Excitation::Relay { h1, h2, hysteresis: None, reference: experiment::Reference::Start };
        commands(&experiment, &scale())
    };
    assert!(relay(20.0, 5.0).unwrap_err().to_string().starts_with("excitation.h1 + h2 = 25"));
    assert!(relay(1e-5, 1.0).unwrap_err().to_string().starts_with("excitation.h1 = "));
    // Full drive, both halves of a code: 16384 + 16383.
    let commands = relay(12.0, 12.0).unwrap();
    let [Command::StartRelay(relay)] = commands.as_slice() else { panic!("{commands:?}") };
    assert_eq!((relay.h1_code, relay.h2_code), (16_384, 16_383));
}
