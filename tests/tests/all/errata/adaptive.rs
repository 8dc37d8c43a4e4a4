//! The adaptive controller of paper section 5 in closed loop with eq. 10, small and in f64: the Lyapunov evidence.
//!
//! `sgn v` of plant, control and adaptation is `tanh(v/ε)`, ε = 0.01 m/s: the proof needs only that they use the same
//! function. The classical Runge–Kutta integrator is then accurate, so that an increase of V is the law's, not the
//! step's.

use std::f64::consts::TAU;

/// Eq. 10 with the figures' numbers (a = −10.5, b = .1429, f1 = f2 = 10 N = 1.429 V, erratum 25).
pub const A: f64 = -10.5;
pub const B: f64 = 0.1429;
pub const F1: f64 = 1.429;
pub const F2: f64 = 1.429;
/// Bound of f_res.
pub const F: f64 = 0.2;
pub const LAMBDA1: f64 = 100.0;
pub const LAMBDA2: f64 = 20.0;
pub const KV: f64 = 10.0;
pub const DELTA: f64 = 0.02;
/// ka, kb, kf1, kf2, kf: equal speeds for parameters of these sizes.
pub const GAINS: [f64; 5] = [10.0, 0.01, 10.0, 10.0, 10.0];
const STEP_S: f64 = 2e-4;

/// [x, v, ∫e, â, b̂, f̂1, f̂2, f̂].
pub type State = [f64; 8];

/// The laws, and the ways to print them wrong.
#[derive(Clone, Copy, Debug)]
pub struct Laws {
    /// Signs of the five adaptation laws.
    pub signs: [f64; 5],
    /// Eq. 24 and 30 as printed: f̂2·sgn(v)·v.
    pub magnitude: bool,
    /// Eq. 31 as printed: f̂ = kf·|s_Δ|, without the derivative.
    pub algebraic: bool,
}

pub const CORRECT: Laws = Laws { signs: [1.0; 5], magnitude: false, algebraic: false };

/// Eq. 23.
pub fn sat(x: f64) -> f64 {
    x.clamp(-1.0, 1.0)
}

/// Eq. 22 with s_Δ for s_Λ.
pub fn s_delta(s: f64) -> f64 {
    s - DELTA * sat(s / DELTA)
}

pub fn direction(v: f64) -> f64 {
    (v / 0.01).tanh()
}

/// Everything that eq. 24 to 34 speak of, at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Instant {
    pub s: f64,
    pub s_delta: f64,
    pub u_c: f64,
    pub u: f64,
    /// ṡ.
    pub s_rate: f64,
    pub f_res: f64,
    pub rate: State,
}

pub fn instant(laws: &Laws, t: f64, state: &State) -> Instant {
    let [x, v, integral, a, b, f1, f2, f] = *state;
    // Three periods of 0.3 m: speeds up to 1.9 m/s, both directions.
    let w = TAU;
    let (e, e_rate) = (0.3 * (w * t).sin() - x, 0.3 * w * (w * t).cos() - v);
    let reference = -0.3 * w * w * (w * t).sin();
    let s = LAMBDA1 * integral + LAMBDA2 * e + e_rate;
    let inside = s_delta(s);
    let f = if laws.algebraic { GAINS[4] * inside.abs() } else { f };
    let u_c = -LAMBDA1 * e - LAMBDA2 * e_rate - reference - KV * inside;
    let viscous = if laws.magnitude { direction(v) * v } else { v };
    let u = -a * v - b * u_c + f1 * direction(v) + f2 * viscous + f * sat(s / DELTA);
    let f_res = F * (7.0 * t).sin();
    let acceleration = (A * v + u - F1 * direction(v) - F2 * v - f_res) / B;
    let adapt = [-v * inside, -u_c * inside, direction(v) * inside, viscous * inside, inside.abs()];
    let mut rate = [v, acceleration, e, 0.0, 0.0, 0.0, 0.0, 0.0];
    for (i, value) in adapt.into_iter().enumerate() {
        rate[3 + i] = laws.signs[i] * GAINS[i] * value;
    }
    if laws.algebraic {
        rate[7] = 0.0;
    }
    let s_rate = LAMBDA1 * e + LAMBDA2 * e_rate + reference - acceleration;
    Instant { s, s_delta: inside, u_c, u, s_rate, f_res, rate }
}

/// ã, b̃, f̃1, f̃2, f̃.
pub fn errors(laws: &Laws, state: &State, now: &Instant) -> [f64; 5] {
    let f = if laws.algebraic { GAINS[4] * now.s_delta.abs() } else { state[7] };
    [A - state[3], B - state[4], F1 - state[5], F2 - state[6], F - f]
}

/// Eq. 32.
pub fn lyapunov(laws: &Laws, state: &State, now: &Instant) -> f64 {
    let quadratic: f64 = errors(laws, state, now).iter().zip(GAINS).map(|(error, k)| error * error / (2.0 * k)).sum();
    0.5 * B * now.s_delta.powi(2) + quadratic
}

/// At rest, with half of every parameter known.
pub fn start() -> State {
    [0.0, 0.0, 0.0, 0.5 * A, 0.5 * B, 0.5 * F1, 0.5 * F2, 0.0]
}

/// One classical Runge–Kutta step.
pub fn step(laws: &Laws, t: f64, state: &State) -> State {
    let moved = |rate: &State, h: f64| {
        let mut next = *state;
        next.iter_mut().zip(rate).for_each(|(x, r)| *x += h * r);
        next
    };
    let k1 = instant(laws, t, state).rate;
    let k2 = instant(laws, t + 0.5 * STEP_S, &moved(&k1, 0.5 * STEP_S)).rate;
    let k3 = instant(laws, t + 0.5 * STEP_S, &moved(&k2, 0.5 * STEP_S)).rate;
    let k4 = instant(laws, t + STEP_S, &moved(&k3, STEP_S)).rate;
    let mut mean = [0.0; 8];
    for (i, value) in mean.iter_mut().enumerate() {
        *value = (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0;
    }
    moved(&mean, STEP_S)
}

/// Visits every step of `seconds` from `start()`.
pub fn run(laws: &Laws, seconds: f64, mut visit: impl FnMut(f64, &State)) {
    let mut state = start();
    for k in 0..(seconds / STEP_S) as usize {
        let t = k as f64 * STEP_S;
        visit(t, &state);
        state = step(laws, t, &state);
        if !state.iter().all(|value| value.is_finite() && value.abs() < 1e6) {
            break;
        }
    }
}

/// The sum of all increases of V over V(0), 3 s.
pub fn increases(laws: &Laws) -> f64 {
    let (mut first, mut last, mut sum) = (None, f64::INFINITY, 0.0);
    run(laws, 3.0, |t, state| {
        let value = lyapunov(laws, state, &instant(laws, t, state));
        first.get_or_insert(value);
        sum += (value - last).max(0.0);
        last = value;
    });
    sum / first.unwrap_or(f64::NAN)
}
