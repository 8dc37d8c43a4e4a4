//! What is drawn, what the names of the worlds mean, and what the clock, the encoder and the loop make of it.

use super::{close, papers};
use crate::{
    CATALOGUE, Case, DRAWN, Experiment, Item, Setting, World, drawn,
    plan::Kind,
    plant::{Plant, State},
};
use std::f64::consts::TAU;

#[test]
fn settings_have_names() {
    for name in ["kind", "unkind", "unkind:jitter", "unkind:torque+jitter+closed"] {
        assert_eq!(Setting::named(name).unwrap().name().len(), name.len(), "{name}");
    }
    assert_eq!(Setting::named("unkind:jitter,torque"), Setting::named("unkind:torque+jitter"));
    for name in ["unkindly", "unkind:", "unkind:jitters", "kind:jitter", ""] {
        assert!(Setting::named(name).is_err(), "{name}");
    }
    assert!(Setting::Kind.draw(7).is_kind() && World::default().text().is_empty());
}

#[test]
fn an_item_is_the_same_whatever_else_is_asked_for() {
    for seed in 0..20 {
        let all = Setting::Unkind.draw(seed);
        let one = |item| Setting::Only(vec![item]).draw(seed);
        assert_eq!(all.torque, one(Item::Torque).torque);
        assert_eq!(all.jitter, one(Item::Jitter).jitter);
        assert_eq!(all.encoder, one(Item::Counts).encoder);
        assert_eq!(all.tick_s.to_bits(), one(Item::Rate).tick_s.to_bits());
        assert!(all.sag.is_none() || all.sag == one(Item::Sag).sag);
        assert_eq!(World { zero: true, ..World::default() }, one(Item::Zero));
    }
}

#[test]
fn draws_fill_their_ranges() {
    // The ranges of `tests/hidden/src/world/setting.rs`. Of 400 draws the least and the largest are within a tenth of
    // the range's ends, in the logarithm where it is drawn so. The chance that one of them is not is 0.9^400.
    let worlds: Vec<World> = (0..400).map(|seed| Setting::Unkind.draw(seed)).collect();
    let fills = |low: f64, high: f64, value: &dyn Fn(&World) -> Option<f64>| {
        let values: Vec<f64> = worlds.iter().filter_map(value).collect();
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(0.0, f64::max);
        let tenth = (high / low).powf(0.1);
        assert!(low <= least * (1.0 + 1e-9) && least < low * tenth, "{least} of {low}");
        assert!(most <= high * (1.0 + 1e-9) && most > high / tenth, "{most} of {high}");
        values.len()
    };
    fills(0.02, 1.0, &|w| w.torque.map(|t| t.rms_percent));
    fills(5.0, 200.0, &|w| w.torque.map(|t| t.bandwidth_hz));
    fills(0.02, 0.2, &|w| w.jitter.map(|j| j.share));
    fills(1e-4, 1e-2, &|w| Some(w.tick_s));
    fills(500.0, 65_536.0, &|w| w.encoder.map(|e| f64::from(e.counts)));
    // A half is drawn in 400 cases within 5 standard deviations of 10.
    let half = |n: usize| assert!((150..=250).contains(&n), "{n} of 400");
    half(fills(1e-3, 20e-3, &|w| w.held_s));
    half(fills(0.5e-3, 8e-3, &|w| Some(w.sensor_delay_s).filter(|delay| *delay > 0.0)));
    half(fills(0.005, 0.04, &|w| w.sag.map(|s| s.share)));
    half(worlds.iter().filter(|w| w.closed).count());
    half(worlds.iter().filter(|w| w.jitter.is_some_and(|j| j.true_stamps)).count());
    assert!(worlds.iter().all(|w| w.held_s.is_none_or(|held| held >= (2.0 * w.tick_s).min(20e-3))));
}

#[test]
fn drawn_effects_fit_together() {
    let (mut counts, mut names) = ([0; 4], Vec::new());
    for seed in 0..600 {
        let effects = drawn(seed, seed % 3);
        counts[effects.len()] += 1;
        for pair in [["backlash", "flexible_coupling"], ["dahl", "lugre"]] {
            assert!(!pair.iter().all(|name| effects.contains(name)), "{effects:?}");
        }
        let mut sorted = effects.clone();
        sorted.sort_unstable();
        assert!(sorted.windows(2).all(|w| w[0] != w[1]), "{effects:?}");
        names.extend(effects);
    }
    // 300, 200 and 100 are expected; five standard deviations of a binomial count.
    for (count, (expected, deviation)) in counts.iter().zip([(0, 0), (300, 61), (200, 58), (100, 46)]) {
        assert!((expected - deviation..=expected + deviation).contains(count), "{counts:?}");
    }
    assert!(CATALOGUE[..DRAWN].iter().all(|name| names.contains(name)) && !names.contains(&"end_stop"));
}

#[test]
fn sessions_of_every_rate_have_manageable_size() {
    for tick_s in [1e-2, 1e-3, 1e-4] {
        let case = Case::suite(2, &[], 10.0).unwrap().within(World { tick_s, ..World::default() });
        let session = case.generate();
        let rows: usize = session.records.iter().map(|r| r.t.len()).sum();
        assert_eq!(rows, ((60.0 / tick_s).round() as usize).min(120_000));
        for record in &session.records {
            assert!(record.t.windows(2).all(|w| (w[1] - w[0] - tick_s).abs() < 1e-9), "{}", record.name);
        }
    }
}

#[test]
fn the_tick_does_not_change_the_plant() {
    // From rest under 2 V for 1 s: x = (w/c)·(t − Tp·(1 − e^(−t/Tp))), w = 1.5 V and Tp = b/c. The sub-steps of 0.1 ms are off
    // by (h/Tp)²/24 of it, 7e-9.
    let law = papers();
    let time = law.b / law.c;
    let expected = 1.5 / law.c * (1.0 - time * (1.0 - (-1.0 / time).exp()));
    for tick_s in [1e-2, 1e-3, 1e-4] {
        let substeps = ((tick_s / 1e-4_f64).round() as usize).max(1);
        let mut plant = Plant::new(&law, State::at_rest(0.0), substeps);
        plant.tick_s = tick_s;
        for k in 0..(1.0 / tick_s).round() as usize {
            plant.sample(2.0, k as f64 * tick_s);
        }
        close(plant.state.x / expected, 1.0, 1e-7);
    }
}

#[test]
fn the_encoder_has_its_counts() {
    for seed in 0..4 {
        let world = Setting::Only(vec![Item::Counts]).draw(seed);
        let counts = f64::from(world.encoder.unwrap().counts);
        let session = Case::suite(seed, &[], 10.0).unwrap().within(world).generate();
        close(session.encoder_step * counts, TAU, 1e-12);
        for x in session.records.iter().flat_map(|r| &r.x) {
            let steps = x * counts / TAU;
            close(steps, steps.round(), 1e-6);
        }
    }
}

#[test]
fn closed_loops_follow_their_reference() {
    for seed in 0..6 {
        // With the latest sensor that is drawn, and without.
        for (held_s, sensor_delay_s) in [(None, 0.0), (Some(20e-3), 8e-3)] {
            let world = World { closed: true, held_s, sensor_delay_s, ..World::default() };
            let case = Case::suite(seed, &[], 10.0).unwrap().within(world);
            assert_eq!(case.experiment, Experiment::Closed);
            let machine = case.machine();
            let specs = case.plan(&machine, &machine.law());
            let session = case.generate();
            for (spec, record) in specs.iter().zip(&session.records) {
                let Kind::Track { kp, course, .. } = &spec.kind else { panic!("{}: not tracked", spec.name) };
                // From 2 s on. The rest is friction and drag over the gain, and the way made in the latency. At each
                // corner of the reference there is a transient of about half of 1/ω.
                let at = |k: usize| course.at(1e-3 * k as f64);
                let rms = |values: &dyn Fn(usize) -> f64| {
                    let all = 2000..record.x.len();
                    (all.clone().map(|k| values(k).powi(2)).sum::<f64>() / all.len() as f64).sqrt()
                };
                let speed = rms(&|k| (at(k) - at(k - 1)) / 1e-3);
                let error = rms(&|k| spec.start + at(k) - record.x[k]);
                let omega = (kp / machine.base.b).sqrt();
                let allowed = (machine.base.f1 + machine.base.c * speed) / kp
                    + (0.5 / omega + case.world.latency_s()) * speed
                    + session.encoder_step;
                assert!(error < allowed, "{seed} {}: {error} of {allowed}", record.name);
            }
        }
    }
}
