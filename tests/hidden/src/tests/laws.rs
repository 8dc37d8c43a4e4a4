//! Each force and drive law, as the table writes it, against the force found in the simulated motion.

use super::close;
use crate::{
    Base, Case, Truth,
    plant::{Plant, State, TS},
};
use std::f64::consts::PI;

/// Extra force of the table's law at one sample; `p` looks a parameter up by its symbol.
fn expected(name: &str, p: &dyn Fn(&str) -> f64, base: &Base, q: &Sample) -> f64 {
    let Sample { u, x, v, t } = *q;
    let side = v.signum();
    match name {
        "constant_load" => p("bias"),
        "asymmetric_viscous" => -p("d") * v.abs(),
        "stribeck" => -p("s") * (-(v.abs() / p("vs")).powf(p("p"))).exp() * side,
        "stiction" => 0.0,
        "quadratic_drag" => -p("k") * v * v.abs(),
        "load_friction" => -p("k") * u.abs() * side,
        "position_friction" => -base.f1 * p("k") * (p("n") * x + p("phi")).sin() * side,
        "cogging" => p("A") * (p("n") * x + p("phi")).sin() + p("A2") * (p("n2") * x + p("phi2")).sin(),
        "gravity_load" => p("m") * (x + p("phi")).sin(),
        "spring" => -p("k") * (x - p("x0")),
        "end_stop" => -p("k").abs() * if p("k") * (x - p("x0")) > 0.0 { x - p("x0") } else { 0.0 },
        "time_periodic" => p("A") * (p("omega") * t + p("phi")).sin(),
        "dead_zone" => -u.signum() * u.abs().min(p("d")),
        "saturation" => u.clamp(-p("u_max"), p("u_max")) - u,
        "pwm_dead_time" => -p("d") * ((u - p("Ke") * v) / p("i0")).clamp(-1.0, 1.0),
        "friction_drift" => -p("s") * (-t / p("T")).exp() * side,
        "gain_drift" => -p("k") * t * u,
        "velocity_ripple" => p("A") * (p("k") * v).sin(),
        "position_gain" => u * p("g") * (p("n") * x + p("phi")).sin(),
        "force_well" => {
            let s = (x - p("centre")) / p("width");
            -p("peak") * s * (0.5 - 0.5 * s * s).exp()
        }
        other => panic!("no formula for {other}"),
    }
}

struct Sample {
    u: f64,
    x: f64,
    v: f64,
    t: f64,
}

const FORCES: [&str; 20] = [
    "constant_load",
    "asymmetric_viscous",
    "stribeck",
    "stiction",
    "quadratic_drag",
    "load_friction",
    "position_friction",
    "cogging",
    "gravity_load",
    "spring",
    "end_stop",
    "time_periodic",
    "dead_zone",
    "saturation",
    "pwm_dead_time",
    "friction_drift",
    "gain_drift",
    "velocity_ripple",
    "position_gain",
    "force_well",
];

fn lookup(truth: &Truth) -> impl Fn(&str) -> f64 {
    let list = truth.effects[0].parameters.clone();
    move |symbol| list.iter().find(|(s, _)| *s == symbol).map_or(0.0, |(_, value)| *value)
}

#[test]
fn forces_follow_the_table() {
    for (seed, name) in FORCES.iter().enumerate() {
        let case = Case::suite(seed as u64, &[name], 10.0).unwrap();
        let (session, truth) = case.generate_with_truth();
        let p = lookup(&truth);
        let (mut squares, mut count) = (0.0, 0.0_f64);
        for (record, exact) in session.records.iter().zip(&truth.records) {
            for k in 0..record.u.len() - 1 {
                let (v0, v1) = (exact.v[k], exact.v[k + 1]);
                if v0 * v1 <= 0.0 {
                    continue;
                }
                let sample = Sample {
                    u: record.u[k],
                    x: 0.5 * (exact.x[k] + exact.x[k + 1]),
                    v: 0.5 * (v0 + v1),
                    t: record.t[k] + 0.5 * TS,
                };
                let force = expected(name, &p, &truth.base, &sample);
                squares += (exact.gap_force[k] - force).powi(2);
                count += 1.0;
            }
        }
        // The mean over a sample is not the value at its middle, most of all where the velocity just left zero. The
        // tolerance is a hundredth of the effect's 10 %.
        let error = 100.0 * (squares / count).sqrt() / truth.amplitude;
        assert!(error < 0.1, "{name}: {error} % of the amplitude");
        assert!(count > 1000.0, "{name}: too little motion");
    }
}

#[test]
fn sizes_are_realised() {
    // Effects whose largest force is the size by definition or by calibration. The tolerance is 7 % because the
    // calibration stops after four secants, whose closed-loop motion changes with the parameter.
    let by_definition = [
        "constant_load",
        "stribeck",
        "stiction",
        "load_friction",
        "gravity_load",
        "time_periodic",
        "dead_zone",
        "saturation",
        "pwm_dead_time",
        "friction_drift",
        "torque_bursts",
        "velocity_ripple",
        "position_gain",
        "asymmetric_viscous",
        "quadratic_drag",
        "spring",
        "inertia_step",
        "end_stop",
        "encoder_eccentricity",
    ];
    for (seed, name) in by_definition.iter().enumerate() {
        for size in [1.0, 10.0] {
            let case = Case::suite(100 + seed as u64, &[name], size).unwrap();
            let peak = case.generate_with_truth().1.gap_peak_percent;
            assert!((0.93 * size..=1.07 * size).contains(&peak), "{name} {size} %: {peak} %");
        }
    }
}

#[test]
fn friction_takes_energy() {
    // Coasting: with any friction-like effect the energy (with the bristle's) never grows, and the
    // body stops no later than on the base plant.
    let names = [
        "stribeck",
        "stiction",
        "dahl",
        "lugre",
        "quadratic_drag",
        "load_friction",
        "position_friction",
        "friction_drift",
    ];
    for name in names {
        let case = Case::suite(5, &[name], 10.0).unwrap();
        let machine = case.machine();
        let law = case.law(&machine, &machine.law());
        let mut plant = Plant::new(&law, State::moving(0.0, 3.0), 20);
        let sigma0 = law.bristle.map_or(0.0, |b| b.sigma0);
        let mut last = f64::INFINITY;
        for k in 0..2000 {
            plant.sample(0.0, k as f64 * TS);
            let s = plant.state;
            let energy = 0.5 * law.b * s.v * s.v + 0.5 * sigma0 * s.z * s.z;
            assert!(energy <= last * (1.0 + 1e-6) + 1e-15, "{name} at {k}");
            last = energy;
        }
        // A bristle without damping goes on ringing within the energy that it can store, g²/(2σ0).
        let level = law.rest_level(0.0, 0.0, 0.0);
        let stored = if sigma0 > 0.0 { 0.5 * level * level / sigma0 } else { 0.0 };
        assert!(last <= stored, "{name} still moves");
    }
}

#[test]
fn stiction_acts_only_at_rest() {
    let mut law = super::papers();
    law.stiction = 0.2;
    let mut held = Plant::new(&law, State::at_rest(0.0), 10);
    let mut moving = Plant::new(&law, State::moving(0.0, 0.1), 10);
    for k in 0..1000 {
        held.sample(0.69, k as f64 * TS);
        moving.sample(0.69, k as f64 * TS);
    }
    assert_eq!(held.state.x, 0.0);
    // Sliding towards (0.69 − f1)/c with Tp = b/c = 0.244 s; 4.1 Tp leave 1.7 %.
    close(moving.state.v, 0.19 / 0.11, 0.03);
    held.sample(0.71, 1.0);
    assert!(held.state.v > 0.0);
}

#[test]
fn conservative_forces_keep_energy() {
    let mut law = super::papers();
    (law.c, law.f1) = (0.0, 0.0);
    law.spring = Some((2.0, 0.5));
    let mut plant = Plant::new(&law, State::at_rest(0.0), 10);
    let period = 2.0 * PI * (law.b / 2.0).sqrt();
    let samples = (5.0 * period / TS).round() as usize;
    for k in 0..samples {
        plant.sample(0.0, k as f64 * TS);
    }
    // Five periods later it is at the start again. The second-order steps of 0.1 ms shift the phase by (ωh)²/24 per
    // radian (1e-6), the rounding to whole samples by less than 0.5 ms.
    close(plant.state.x, 0.0, 5e-6 + 0.25 * 2.0 / law.b * 0.25e-6 * 2.0);
    let energy = 0.5 * law.b * plant.state.v.powi(2) + (plant.state.x - 0.5).powi(2);
    close(energy, 0.25, 1e-6);
}
