//! On-board identification.

use breakaway_core::estimate::modulating::{Block, Modulating, estimate};
use breakaway_core::estimate::sine::{BlockSums, StreamingSine};
use breakaway_core::link::{Command, CommandError, Ending, IdentificationVerdict, Mode, Reply, Sample};
use breakaway_rig::{FULL_SCALE, STEP, relay};

use crate::bench::{Bench, PLANT};

/// The two experiments of the papers' plant, 12 s each, with their samples.
fn identified(bench: &mut Bench) -> (breakaway_core::link::Identified, Vec<Sample>) {
    assert_eq!(bench.command(Command::StreamOn { decimation: 1 }), Reply::Done);
    for (h1, h2) in [(2.0, 1.5), (1.0, 0.7)] {
        bench.events.clear();
        assert_eq!(bench.command(Command::StartRelay(relay(h1, h2, 12_000))), Reply::Done);
        let ended = bench.until_ended(12_100);
        assert_eq!((ended.mode, ended.ending, ended.ticks), (Mode::Relay, Ending::TimeUp, 12_000));
    }
    match bench.command(Command::Identify) {
        Reply::Identified(found) => (found, std::mem::take(&mut bench.samples)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_board_finds_the_plant_by_itself() {
    let mut bench = Bench::new();
    assert_eq!(bench.command(Command::Identify), Reply::Error(CommandError::NothingRecorded));
    let (found, _) = identified(&mut bench);
    assert_eq!(found.verdict, IdentificationVerdict::Determined);
    // Acceptance row 10 with its encoder (tests/tests/all/acceptance/mod.rs): b 1 %, c 0.5 %, f1 1 %.
    for (name, got, truth, allowed) in
        [("b", found.b, PLANT.b, 0.01), ("c", found.c, PLANT.c, 0.005), ("f1", found.f1, PLANT.f1, 0.01)]
    {
        let error = f64::from(got.value) / truth - 1.0;
        assert!(error.abs() < allowed, "{name} = {} is off by {:.2} %", got.value, 100.0 * error);
        assert!(got.se > 0.0 && f64::from(got.se) < 0.02 * truth, "standard error of {name}: {}", got.se);
    }
}

/// The same estimator, run by the host over the samples that came down the link. It sums them in f32 as the board
/// does and solves in f64, where the board solves in f32.
#[test]
fn host_and_board_agree_on_the_same_samples() {
    let mut bench = Bench::new();
    let (found, samples) = identified(&mut bench);
    let mut blocks = Vec::new();
    let mut host_sine = None;
    let mut runs: Vec<Vec<Sample>> = Vec::new();
    for sample in samples {
        match runs.last_mut() {
            Some(run) if run.last().is_some_and(|last| last.mode == sample.mode) => run.push(sample),
            _ => runs.push(vec![sample]),
        }
    }
    for pair in runs.windows(2).filter(|pair| pair[1][0].mode == Mode::Relay) {
        // The tick that takes the order is the last idle one: positions count from there.
        let (start, run) = (pair[0].last().unwrap().count, &pair[1]);
        // The board starts at the third upward crossing of the error, with that cycle's length.
        let error: Vec<i32> = run.iter().map(|sample| sample.reference - sample.count).collect();
        let (mut below, mut crossings) = (false, Vec::new());
        for (k, error) in error.iter().enumerate() {
            below |= *error < -1;
            if below && *error > 1 {
                below = false;
                crossings.push(k);
            }
        }
        let period = (crossings[2] - crossings[1]) as f32;
        let half_width = ((0.01 * period + 0.5) as usize).max(2);
        let form = Modulating::<f32, 1, 128>::new(1e-3, (2.0 * period + 0.5) as u32, half_width, [2], STEP as f32);
        let form = form.unwrap();
        let mut state = form.start();
        for sample in &run[crossings[2] + 1..] {
            let u = f32::from(sample.drive_code) * (FULL_SCALE as f32 / f32::from(i16::MAX));
            form.push(&mut state, (sample.count - start) as f32 * STEP as f32, u);
        }
        blocks.push(state.blocks().map(Block::<f64>::from));
        // The sine fit starts where the period keeps within 2 %; the next tick is the first to sum.
        let lengths: Vec<f32> = crossings.windows(2).map(|pair| (pair[1] - pair[0]) as f32).collect();
        let steady = (2..lengths.len()).find(|k| (lengths[k - 1] - lengths[*k]).abs() <= 0.02 * lengths[*k]).unwrap();
        let first = crossings[steady + 1] + 1;
        let omega = std::f64::consts::TAU * 1e3 / f64::from(lengths[steady]);
        let streaming = StreamingSine::new(omega, 1e-3).unwrap();
        let mut sums = BlockSums::<f64, 32>::new();
        run[first..].iter().for_each(|sample| streaming.push(&mut sums, f64::from(sample.count - start) * STEP));
        host_sine = Some(streaming.fit(&sums).unwrap());
    }
    let slices: Vec<_> = blocks.iter().map(|block| &block[..]).collect();
    let host = estimate(&slices).unwrap();
    for (name, board, host) in [("b", found.b, host.b), ("c", found.c, host.c), ("f1", found.f1, host.f1)] {
        // What is left is the rounding of the result on the wire.
        assert!((f64::from(board.value) / host - 1.0).abs() < 1e-6, "{name}: board {}, host {host}", board.value);
    }
    let (board, host) = (found.sine.expect("a sine fit"), host_sine.unwrap());
    // The board sums integers in Q10 of a count; the result is rounded to f32 on the wire.
    for (name, board, host, se) in [
        ("amplitude", board.amplitude, host.amplitude, host.se.amplitude),
        ("omega", board.omega, host.omega_rad_s, host.se.omega_rad_s),
        ("offset", board.offset, host.offset, host.se.offset),
    ] {
        let apart = (f64::from(board.value) - host).abs();
        assert!(apart < 1e-3 * se + 1e-6 * host.abs(), "{name}: board {board:?}, host {host} ± {se}");
        assert!((f64::from(board.se) / se - 1.0).abs() < 1e-3, "{name}: standard error {} and {se}", board.se);
    }
}
