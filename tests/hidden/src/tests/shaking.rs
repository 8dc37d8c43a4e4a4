//! Random torque and supply sag.

use super::close;
use crate::{Case, Sag, Setting, Torque, World, disturbance::Disturbance, law::ForceLaw, machine::stream, run::Trace};
use std::f64::consts::TAU;

/// Traces of a case in its own world, with the law and the case's machine.
fn traces(case: &Case) -> (ForceLaw, Vec<Trace>) {
    let machine = case.machine();
    let law = case.law(&machine, &machine.law());
    let specs = case.plan(&machine, &law);
    let traces = case.run(&machine, &law, &specs, &case.world, 1e-4);
    (law, traces)
}

#[test]
fn torque_has_the_rms_and_the_bandwidth_that_were_drawn() {
    // 200 s at 20 Hz hold α·T/2 = 12600 independent values: the root mean square is known to 0.6 %, the correlation to 0.9 %;
    // four of those. The second step is a third of the time in which it forgets: only an exact transition keeps its figures.
    for h in [1e-4, 2.5e-3] {
        let torque = Torque { rms_percent: 0.5, bandwidth_hz: 20.0 };
        let mut disturbance = Disturbance::new(torque, 5.0, stream(1, 1));
        let values: Vec<f64> = (0..(200.0 / h) as usize).map(|_| disturbance.step(h)).collect();
        let mean = |products: &mut dyn Iterator<Item = f64>, count: usize| products.sum::<f64>() / count as f64;
        let square = mean(&mut values.iter().map(|w| w * w), values.len());
        close(square.sqrt() / 0.025, 1.0, 0.025);
        let lag = (1.0 / (TAU * 20.0 * h)).round() as usize;
        let product = mean(&mut values.windows(lag + 1).map(|w| w[0] * w[lag]), values.len() - lag);
        close(product / square, (-(lag as f64) * h * TAU * 20.0).exp(), 0.036);
    }
}

#[test]
fn torque_acts_in_the_force_balance() {
    for seed in 0..4 {
        let world = Setting::named("unkind:torque,jitter,rate").unwrap().draw(seed);
        let case = Case::suite(seed, &[], 10.0).unwrap().within(world);
        let (law, traces) = traces(&case);
        let mut moving = 0;
        for trace in &traces {
            for k in 0..trace.t.len() - 1 {
                let (v0, v1, duration) = (trace.v[k], trace.v[k + 1], trace.duration[k]);
                // Fast enough not to have turned within the sample.
                if v0 * v1 <= 0.0 || v0.abs().min(v1.abs()) < 5.0 / law.b * duration {
                    continue;
                }
                let way = trace.shaft[k + 1] - trace.shaft[k];
                let force = law.b * (v1 - v0) / duration + law.c * way / duration + law.f1 * v0.signum();
                // The midpoint rule keeps this balance exactly; rounding of v over the shortest sample is 1e-10.
                close(force - trace.u[k], trace.torque[k], 1e-8);
                moving += 1;
            }
        }
        assert!(moving > 1000, "{moving}");
        let rms = (traces.iter().flat_map(|t| &t.torque).map(|w| w * w).sum::<f64>()
            / traces.iter().map(|t| t.torque.len()).sum::<usize>() as f64)
            .sqrt();
        let drawn = case.world.torque.unwrap();
        // Variance of the mean over one tick; 12 s at 5 Hz hold 190 independent values: 5 % standard error, three of those.
        let p = TAU * drawn.bandwidth_hz * case.world.tick_s;
        let share = (2.0 * (p - 1.0 + (-p).exp()) / (p * p)).sqrt();
        close(rms / (0.05 * drawn.rms_percent * share), 1.0, 0.15);
    }
}

#[test]
fn random_torque_and_sag_are_no_part_of_the_gap() {
    // The pilots' coarser sub-steps of the base plant separate the two, as in the kind world.
    let world = Setting::named("unkind:torque,sag,jitter").unwrap().draw(3);
    let (_, truth) = Case::suite(3, &[], 10.0).unwrap().within(world).generate_with_truth();
    assert!(truth.visibility < 0.1 && truth.gap_rms_percent < 0.02, "{truth:?}");
}

#[test]
fn random_torque_hides_what_is_small() {
    // Ten times the torque is ten times what it does to the base plant, which is far above the encoder's noise here.
    // Friction that turns a little of it into rest costs the rest of the band.
    let visibility = |rms_percent: f64| {
        let world = World { torque: Some(Torque { rms_percent, bandwidth_hz: 10.0 }), ..World::default() };
        Case::suite(7, &["cogging"], 3.0).unwrap().within(world).generate_with_truth().1.visibility
    };
    let ratio = visibility(0.5) / visibility(5.0);
    assert!((8.0..=12.0).contains(&ratio), "{ratio}");
}

#[test]
fn a_supply_sags_with_the_drive() {
    let world = World { sag: Some(Sag { share: 0.04, time_s: 5e-3 }), ..World::default() };
    let case = Case::suite(5, &[], 10.0).unwrap().within(world);
    let (_, traces) = traces(&case);
    let relay = &traces[0];
    let mut settled = 0;
    for k in 50..relay.u.len() {
        // 50 ms, ten time constants, after the drive changed its size the loss is share·|u|/limit to 5e-5 of it.
        if relay.u[k - 50..k].iter().all(|u| u.abs() == relay.u[k].abs()) {
            close(relay.supplied[k] / relay.u[k], 1.0 - 0.04 * relay.u[k].abs() / 5.0, 0.04 * 5e-5);
            settled += 1;
        }
    }
    assert!(settled > 100, "{settled}");
    assert!((relay.supplied[0] - relay.u[0]).abs() < 1e-15, "the supply is at rest first");
}
