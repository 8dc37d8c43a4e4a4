//! Drive path, second inertia and sub-steps.

use super::{close, papers};
use crate::{
    Case,
    drive::Drive,
    law::{Second, Wave},
    plant::{Plant, State, TS},
};
use std::f64::consts::{PI, TAU};

#[test]
fn delay_shifts_the_response_by_tau() {
    // τ = 2.7 ms is 54 sub-steps of 50 µs: the delayed plant repeats the undelayed one to rounding.
    let base = papers();
    let mut late = papers();
    late.delay = 2.7e-3;
    let path = |law: &crate::law::ForceLaw| {
        let (mut drive, mut state, mut xs) = (Drive::default(), State::at_rest(0.1), Vec::new());
        for k in 0..400 {
            let u = if (k / 70) % 2 == 0 { 2.0 } else { -1.4 };
            drive.hold(law, u, k as f64 * TS, 1.0);
            for i in 0..20 {
                let offset = i as f64 * TS / 20.0;
                let delivered = drive.deliver(law, offset, TS / 20.0, TS);
                law.advance(&mut state, k as f64 * TS + offset, TS / 20.0, delivered);
                xs.push(state.x);
            }
        }
        xs
    };
    let (now, then) = (path(&base), path(&late));
    assert!(then[..54].iter().all(|x| *x == 0.1));
    for (a, b) in now.iter().zip(&then[54..]) {
        close(*b, *a, 1e-10);
    }
}

#[test]
fn lag_is_a_first_order_pole() {
    let mut law = papers();
    law.lag = 4e-3;
    let mut drive = Drive::default();
    let mut integral = 0.0;
    for _ in 0..10 {
        drive.hold(&law, 2.0, 0.0, 1.0);
        for i in 0..10 {
            integral += drive.deliver(&law, i as f64 * 1e-4, 1e-4, TS) * 1e-4;
        }
    }
    // ∫ 2·(1 − e^(−t/τ)) over 10 ms, exact.
    close(integral, 2.0 * (0.01 - 0.004 * (1.0 - (-2.5_f64).exp())), 1e-12);
}

#[test]
fn flexible_coupling_rings_at_its_resonance() {
    let mut law = papers();
    (law.c, law.f1) = (0.0, 0.0);
    let ratio = 0.3;
    let k = ratio * (1.0 - ratio) * law.b * (TAU * 40.0_f64).powi(2);
    law.second = Some(Second { ratio, gap: 0.0, k, d: 0.0 });
    let mut plant = Plant::new(&law, State::moving(0.0, 1.0), 20);
    plant.state.v2 = 0.0;
    let (mut crossings, mut twist) = (0, 0.0);
    for i in 0..1000 {
        plant.sample(0.0, i as f64 * TS);
        let now = plant.state.x - plant.state.x2;
        crossings += usize::from(twist < 0.0 && now >= 0.0);
        twist = now;
    }
    assert!((39..=40).contains(&crossings), "{crossings} cycles in 1 s");
    let s = plant.state;
    close(0.7 * s.v + 0.3 * s.v2, 0.7, 1e-9);
    let energy = 0.35 * s.v * s.v + 0.15 * s.v2 * s.v2 + 0.5 * k / law.b * (s.x - s.x2).powi(2);
    // The midpoint rule gains (ωh)⁴/8 per step: 3.1e-9 · 20000 = 6e-5 of the energy.
    close(energy, 0.35, 0.35e-3);
}

#[test]
fn backlash_keeps_the_bodies_within_the_gap() {
    for seed in 0..3 {
        let case = Case::suite(seed, &["backlash"], 10.0).unwrap();
        let (session, truth) = case.generate_with_truth();
        let value = |symbol: &str| {
            let list = &truth.effects[0].parameters;
            list.iter().find(|(s, _)| *s == symbol).unwrap().1
        };
        let (mut widest, mut touched) = (0.0_f64, [false; 2]);
        let fastest = truth.records.iter().flat_map(|r| &r.v).fold(0.0_f64, |m, v| m.max(v.abs()));
        for record in &truth.records {
            for (x, load) in record.x.iter().zip(&record.load) {
                let twist = x - load;
                widest = widest.max(twist.abs());
                touched[usize::from(twist > 0.0)] |= twist.abs() > 0.5 * value("gap");
            }
        }
        // A contact at 200 Hz struck at twice the top speed penetrates at most 2v/ω.
        assert!(widest < 0.5 * value("gap") + 2.0 * fastest / (TAU * 200.0));
        assert!(touched == [true, true] && session.records.len() == 8);
    }
}

#[test]
fn inertia_step_and_eccentricity() {
    let mut law = papers();
    law.inertia_step = Some((0.5, 0.25));
    close(law.inertia(0.499), law.b, 0.0);
    close(law.inertia(0.5), 1.25 * law.b, 1e-15);
    law.eccentricity = Some(Wave { a: 0.01, n: 1.0, phi: PI / 2.0 });
    close(law.encoder(PI), PI - 0.01, 1e-15);
}

#[test]
fn half_the_substep_changes_less_than_the_noise() {
    // One of each kind of integration: smooth, break-away, bristle, second body, drive path, session time.
    let names = [
        "none",
        "stribeck",
        "stiction",
        "dahl",
        "lugre",
        "cogging",
        "backlash",
        "flexible_coupling",
        "pwm_dead_time",
        "delay",
        "electrical_lag",
        "inertia_step",
        "encoder_eccentricity",
        "velocity_ripple",
    ];
    for (i, name) in names.iter().enumerate() {
        let case = Case::suite(200 + i as u64, &[name], 10.0).unwrap();
        let (session, truth) = case.generate_with_truth();
        let machine = case.machine();
        let law = case.law(&machine, &machine.law());
        let substeps = if law.second.is_some() { 20 } else { 10 };
        let mut segments = Vec::new();
        for (record, exact) in session.records.iter().zip(&truth.records) {
            let start = State::at_rest(super::sessions::shaft(&law, exact.x[0]));
            let mut plant = Plant::new(&law, start, substeps);
            let mut fine = plant.clone();
            let mut worst = 0.0_f64;
            for (k, (u, t)) in record.u.iter().zip(&record.t).enumerate() {
                if k % 400 == 0 {
                    segments.push(worst / truth.noise_floor);
                    fine = plant.clone();
                    fine.substeps *= 2;
                    worst = 0.0;
                }
                plant.sample(*u, *t);
                fine.sample(*u, *t);
                worst = worst.max((plant.state.x - fine.state.x).abs());
            }
        }
        segments.sort_by(f64::total_cmp);
        // Rattling in a gap is chaotic, because a grazing impact amplifies any difference. There nine segments in ten
        // must agree; everywhere else every segment, with a factor of 20 to spare.
        let (share, bound) = if *name == "backlash" { (0.9, 1.0) } else { (1.0, 0.05) };
        let at = ((segments.len() - 1) as f64 * share) as usize;
        assert!(segments[at] < bound, "{name}: {}", segments[at]);
    }
}
