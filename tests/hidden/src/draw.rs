//! Random effect parameters, by seed.
//!
//! **Size.** An effect's parameters follow from F = size·A0, with A0 the suite's largest relay level h1 + h2 (V).
//! - Equal to F: bias, stribeck s, stiction s, cogging A, gravity m, time_periodic A, dead_zone d, pwm d.
//!   So are friction_drift s, force_well, torque_bursts, and the peak of velocity_ripple.
//! - load_friction k, position_gain: F at the drive A0.
//! - saturation: u_max = A0 − F.
//! - gain_drift: F is lost at the drive A0 at the end of the session.
//! - position_friction: f1·k = F, with k ≤ 0.9.
//! - asymmetric_viscous, quadratic_drag, spring, end_stop, inertia_step, encoder_eccentricity: a simulation calibrates the
//!   parameter. The largest force over the session's own motion is then F, within d ≤ 0.8c, −0.6 ≤ Δ ≤ 3, A ≤ 0.5 rad.
//! - delay, electrical_lag: ω·τ = size at the high relay's frequency ω. The fundamental of u(t) − u(t−τ) is then F.
//! - backlash: gap = size × peak-to-peak of the high relay's cycle, at least 4 encoder steps. The load has 20–60 % of
//!   b. The contact is nearly plastic (200 Hz, damping ratio 0.8), and friction acts on the motor only.
//! - dahl, lugre: f1/σ0 = size × that peak-to-peak, at least 2 encoder steps. lugre also has s = F/2.
//! - end_stop: 40 to 80 % of the travel are free, and the stop is at either end of the rest.
//! - flexible_coupling: mass ratio 0.05 + 1.2·size, resonance 15–60 Hz.

use crate::law::{Bristle, ForceLaw, Pwm, Second, Stribeck, Wave};
use crate::machine::log_uniform;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{PI, TAU};

/// What the effects are sized against: the motion of the base plant in the same experiments.
#[derive(Clone, Debug)]
pub struct Reference {
    pub amplitude: f64,
    pub omega: f64,
    pub peak_to_peak: f64,
    pub encoder_step: f64,
    pub speed: f64,
    pub acceleration: f64,
    pub positions: Vec<f64>,
    pub travel: f64,
    pub fit_end: f64,
    pub end: f64,
}

impl Reference {
    /// A whole number of cycles per turn, at least 3. The travel covers at least two of these cycles.
    fn waves(&self, rng: &mut ChaCha8Rng) -> f64 {
        let least = (2.0 * TAU / self.travel).ceil().max(3.0);
        log_uniform(rng, least, (3.0 * least).max(24.0)).round()
    }
}

/// Puts the named effect into the law, `size` as a fraction of the amplitude.
pub fn hide(law: &mut ForceLaw, name: &str, size: f64, to: &Reference, rng: &mut ChaCha8Rng) {
    let force = size * to.amplitude;
    let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let phi = rng.random_range(-PI..PI);
    let stribeck = |s: f64, rng: &mut ChaCha8Rng| Stribeck {
        s,
        vs: to.speed * log_uniform(rng, 0.02, 0.15),
        p: if rng.random_bool(0.5) { 1.0 } else { 2.0 },
    };
    match name {
        "constant_load" => law.bias = side * force,
        "asymmetric_viscous" => law.d_asym = side * (force / to.speed).min(0.8 * law.c),
        "stribeck" => law.stribeck = Some(stribeck(force, rng)),
        "stiction" => law.stiction = force,
        "dahl" | "lugre" => {
            let slip = (size * to.peak_to_peak).max(2.0 * to.encoder_step);
            let sigma0 = law.f1 / slip;
            let lugre = name == "lugre";
            let damping = rng.random_range(0.2..0.8);
            law.bristle = Some(Bristle {
                sigma0,
                sigma1: if lugre { 2.0 * damping * (sigma0 * law.b).sqrt() } else { 0.0 },
                stribeck: lugre.then(|| Stribeck { p: 2.0, ..stribeck(0.5 * force, rng) }),
            });
        }
        "quadratic_drag" => law.drag = force / (to.speed * to.speed),
        "load_friction" => law.k_load = size,
        "position_friction" => {
            let n = to.waves(rng);
            law.friction_wave = Some(Wave { a: (force / law.f1).min(0.9), n, phi });
        }
        "cogging" => {
            let n = to.waves(rng);
            let second = if rng.random_bool(0.5) { 0.3 } else { 0.0 };
            law.cogging = Some(Wave { a: force, n, phi });
            law.cogging2 =
                (second > 0.0).then(|| Wave { a: second * force, n: 2.0 * n, phi: rng.random_range(-PI..PI) });
        }
        "gravity_load" => {
            law.gravity = Some(Wave { a: force, n: 1.0, phi });
        }
        "spring" => {
            let x0 = 0.3 * to.travel * rng.random_range(-0.5..0.5);
            let reach = to.positions.iter().fold(0.0, |m: f64, x| m.max((x - x0).abs()));
            law.spring = Some((force / reach, x0));
        }
        "end_stop" => {
            let least = to.positions.iter().copied().fold(f64::INFINITY, f64::min);
            let most = to.positions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let free = rng.random_range(0.4..0.8) * (most - least);
            let x0 = if side > 0.0 { least + free } else { most - free };
            law.stop = Some((side * force / (most - least - free), x0));
        }
        "time_periodic" => {
            law.periodic = Some(Wave { a: force, n: TAU * log_uniform(rng, 0.7, 9.0), phi });
        }
        "backlash" => {
            let ratio = rng.random_range(0.2..0.6);
            let gap = (size * to.peak_to_peak).max(4.0 * to.encoder_step);
            law.second = Some(second_body(law.b, ratio, gap, 200.0, 0.8));
        }
        "flexible_coupling" => {
            let frequency = log_uniform(rng, 15.0, 60.0);
            let damping = rng.random_range(0.01..0.08);
            law.second = Some(second_body(law.b, 0.05 + 1.2 * size, 0.0, frequency, damping));
        }
        "dead_zone" => law.dead_zone = force,
        "saturation" => law.u_max = Some(to.amplitude - force),
        "pwm_dead_time" => {
            law.pwm = Some(Pwm {
                d: force,
                i0: to.amplitude * rng.random_range(0.02..0.15),
                ke: law.c * rng.random_range(0.4..0.9),
            });
        }
        "delay" => law.delay = size / to.omega,
        "electrical_lag" => law.lag = size / to.omega,
        "encoder_eccentricity" => {
            // Crude first value; the calibration sets the force.
            law.eccentricity = Some(Wave { a: size.min(0.5), n: 1.0, phi });
        }
        "friction_drift" => law.friction_drift = Some((force, rng.random_range(8.0..30.0))),
        "gain_drift" => law.gain_drift = size / to.end,
        "inertia_step" => {
            let t0 = (rng.random_range(0.3..0.7) * to.fit_end * 1e3).round() / 1e3;
            let delta = side * force / (law.b * to.acceleration);
            law.inertia_step = Some((t0, delta.clamp(-0.6, 3.0)));
        }
        "force_well" => {
            let centre = to.positions[rng.random_range(0..to.positions.len())];
            let width = rng.random_range(0.1..0.4f64).min(0.1 * to.travel);
            law.well = Some((centre, width, force));
        }
        "torque_bursts" => law.bursts = bursts(force, to.end, rng),
        "velocity_ripple" => {
            law.ripple = Some((force, TAU * rng.random_range(1.5..4.0) / to.speed));
        }
        "position_gain" => {
            let n = to.waves(rng).min(12.0);
            law.position_gain = Some(Wave { a: size, n, phi });
        }
        _ => {}
    }
}

/// Load behind a spring whose resonance against the motor is `frequency` (Hz), damping ratio `damping`.
fn second_body(b: f64, ratio: f64, gap: f64, frequency: f64, damping: f64) -> Second {
    let reduced = ratio * (1.0 - ratio) * b;
    let omega = TAU * frequency;
    Second { ratio, gap, k: reduced * omega * omega, d: 2.0 * damping * reduced * omega }
}

/// Half-sine bursts of 30–200 ms, on average one every 0.8 s; the first has the full force.
fn bursts(force: f64, end: f64, rng: &mut ChaCha8Rng) -> Vec<(f64, f64, f64)> {
    let mut list = Vec::new();
    let mut t = 0.5;
    while t < end {
        let duration = log_uniform(rng, 0.03, 0.2);
        let share = if list.is_empty() { 1.0 } else { rng.random_range(0.6..1.0) };
        let side = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
        list.push((t, duration, side * share * force));
        t += duration + rng.random_range(0.1..1.3);
    }
    list
}

/// Whether the largest force of this effect depends on the motion and is set by simulation.
pub fn is_calibrated(name: &str) -> bool {
    matches!(
        name,
        "asymmetric_viscous" | "quadratic_drag" | "spring" | "end_stop" | "inertia_step" | "encoder_eccentricity"
    )
}

/// Multiplies the calibrated parameter, within its cap.
pub fn rescale(law: &mut ForceLaw, name: &str, factor: f64) {
    match name {
        "asymmetric_viscous" => {
            law.d_asym = (law.d_asym * factor).clamp(-0.8 * law.c, 0.8 * law.c);
        }
        "quadratic_drag" => law.drag *= factor,
        "spring" => law.spring = law.spring.map(|(k, x0)| (k * factor, x0)),
        "end_stop" => law.stop = law.stop.map(|(k, x0)| (k * factor, x0)),
        "inertia_step" => {
            law.inertia_step = law.inertia_step.map(|(t0, delta)| (t0, (delta * factor).clamp(-0.6, 3.0)));
        }
        "encoder_eccentricity" => {
            law.eccentricity = law.eccentricity.map(|w| Wave { a: (w.a * factor).min(0.5), ..w });
        }
        _ => {}
    }
}
