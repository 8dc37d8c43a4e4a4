//! Jittered clocks, held and late positions, and encoders that start anywhere.

use super::close;
use crate::{Case, Encoder, Jitter, Session, Setting, Truth, World};

fn session(seed: u64, world: World) -> (Session, Truth) {
    Case::suite(seed, &["cogging"], 10.0).unwrap().within(world).generate_with_truth()
}

#[test]
fn instants_jitter_as_drawn_and_stamps_increase() {
    for true_stamps in [true, false] {
        let share = 0.2;
        let world = World { jitter: Some(Jitter { share, true_stamps }), ..World::default() };
        let (session, truth) = session(1, world);
        let mut strays = Vec::new();
        for record in &session.records {
            assert!(record.t.windows(2).all(|w| w[1] > w[0]), "{}", record.name);
            strays.extend(record.t.iter().map(|t| 1e3 * t - (1e3 * t).round()));
        }
        let rms = (strays.iter().map(|s| s * s).sum::<f64>() / strays.len() as f64).sqrt();
        // 60000 instants: 0.3 % standard error of the root mean square.
        close(rms, if true_stamps { share } else { 0.0 }, 0.015 * share);
        // The plant knows the true instants only: v·Δt + a·Δt²/2 is the way made, so nominal stamps leave v·stray.
        let exact = &truth.records[0];
        let stamps = &session.records[0].t;
        let misses = (1..exact.x.len()).filter(|k| exact.v[*k].abs() > 1.0 && exact.v[k - 1].abs() > 1.0).map(|k| {
            let mean = 0.5 * (exact.v[k] + exact.v[k - 1]);
            ((exact.x[k] - exact.x[k - 1]) / mean - (stamps[k] - stamps[k - 1])) * 1e3
        });
        let misses: Vec<f64> = misses.collect();
        let rms = (misses.iter().map(|s| s * s).sum::<f64>() / misses.len() as f64).sqrt();
        // Two independent strays differ by √2 of one; 2 % is 4 standard errors of some 4000 of them.
        close(rms, if true_stamps { 0.0 } else { 2f64.sqrt() * share }, 0.02);
    }
}

#[test]
fn positions_are_held() {
    for held_s in [3.7e-3, 20e-3] {
        let (session, truth) = session(2, World { held_s: Some(held_s), ..World::default() });
        for (record, exact) in session.records.iter().zip(&truth.records) {
            let fresh: Vec<usize> = (1..exact.seen.len()).filter(|k| exact.seen[*k] != exact.seen[k - 1]).collect();
            let most = record.t.len() as f64 * 1e-3 / held_s + 1.0;
            assert!(fresh.len() as f64 <= most, "{}: {} of {most}", record.name, fresh.len());
            // Readings are apart by the time held, or by several where the body rests; a reading is repeated until the next.
            let mut single = 0;
            for pair in fresh.windows(2) {
                let apart = (pair[1] - pair[0]) as f64 * 1e-3 / held_s;
                assert!((apart - apart.round()).abs() * held_s <= 1.01e-3, "{apart}");
                if apart < 1.5 {
                    assert!((pair[0]..pair[1]).all(|k| record.x[k] == record.x[pair[0]]));
                    single += 1;
                }
            }
            assert!(2 * single > fresh.len(), "{}: {single} of {}", record.name, fresh.len());
            // A reading is no older than the time held; a turn between two rows adds at most a·T²/8, at 1000 rad/s² 1.3e-4.
            let back = (held_s / 1e-3).ceil() as usize + 1;
            for k in back..exact.seen.len() {
                let span = &exact.x[k - back..=k];
                let low = span.iter().copied().fold(f64::INFINITY, f64::min);
                let high = span.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                assert!((low - 1.3e-4..=high + 1.3e-4).contains(&exact.seen[k]), "{} at {k}", record.name);
            }
        }
    }
}

#[test]
fn positions_come_late() {
    let (session, truth) = session(3, World { sensor_delay_s: 5e-3, ..World::default() });
    for (record, exact) in session.records.iter().zip(&truth.records) {
        for k in 5..record.x.len() {
            close(exact.seen[k], exact.x[k - 5], 1e-9);
        }
        assert_eq!(exact.seen[..5], vec![exact.x[0]; 5]);
    }
}

#[test]
fn a_random_zero_shifts_what_is_reported_and_nothing_else() {
    let plain = session(4, World::default());
    let shifted = session(4, World { zero: true, ..World::default() });
    let mut zeros = Vec::new();
    for (i, (a, b)) in plain.0.records.iter().zip(&shifted.0.records).enumerate() {
        assert_eq!(a.u, b.u);
        assert_eq!(plain.1.records[i].x, shifted.1.records[i].x);
        let zero = b.x[0] - a.x[0];
        assert!(a.x.iter().zip(&b.x).all(|(a, b)| (b - a - zero).abs() < 1e-9));
        close(zero / plain.0.encoder_step, (zero / plain.0.encoder_step).round(), 1e-6);
        zeros.push(zero);
    }
    zeros.sort_by(f64::total_cmp);
    // Eight draws from a turn: no two within 1e-3 of one another here.
    assert!(zeros.windows(2).all(|w| w[1] - w[0] > 1e-3), "{zeros:?}");
}

#[test]
fn what_is_reported_is_what_was_seen_within_the_noise() {
    for seed in 0..8 {
        let case = Case::unkind(seed, &["spring"], 10.0).unwrap();
        let (session, truth) = case.generate_with_truth();
        for (record, exact) in session.records.iter().zip(&truth.records) {
            assert!(record.t.windows(2).all(|w| w[1] > w[0]));
            // Half a step of quantisation and 6 σ of noise, which 120 000 rows exceed once in 4000 sessions.
            let bound = 0.5001 * session.encoder_step + 6.0 * session.noise_sigma;
            assert!(record.x.iter().zip(&exact.seen).all(|(x, seen)| (x - seen).abs() < bound), "{}", record.name);
        }
        let file = session.csv(&session.records[0]);
        let stamps: Vec<f64> =
            file.lines().skip(5).map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
        assert!(stamps.windows(2).all(|w| w[1] > w[0]) && stamps.len() == session.records[0].t.len());
        assert_eq!(case.world, Setting::Unkind.draw(seed));
    }
}

#[test]
fn the_machine_moves_more_than_a_coarse_encoder_resolves() {
    for seed in 0..8 {
        let encoder = Some(Encoder { counts: 500, noise_steps: 0.5 });
        let (session, _) = session(seed, World { encoder, ..World::default() });
        for record in session.records.iter().filter(|r| r.name == "relay_high") {
            let tail = &record.x[record.x.len() / 2..];
            let low = tail.iter().copied().fold(f64::INFINITY, f64::min);
            let high = tail.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // An amplitude of 12 steps is asked of the describing function, which is some tenths off.
            assert!(high - low > 15.0 * session.encoder_step, "{seed}: {}", (high - low) / session.encoder_step);
        }
    }
}
