//! How much of the truth the base model misses: as a force, and as a position.

use crate::{
    law::ForceLaw,
    machine::Machine,
    plant::{Plant, State},
    run::Trace,
};

/// Segment over which the base plant is run open loop for the visibility, s.
const SEGMENT_S: f64 = 0.4;
/// Longest sub-step of those runs, s.
const STEP_S: f64 = 2.5e-4;

/// Mean force per sample (V) that the true base lacks on the true motion, as seen by the encoder. The random torque
/// and the loss of the supply are not part of it. It is b·Δv/Ts + c·Δx/Ts + friction − u − torque. In samples with a
/// reversal or rest, friction is the value within ±f1 that explains most of it. The last sample has no end and is 0.
pub fn gap_force(machine: &Machine, trace: &Trace) -> Vec<f64> {
    let base = machine.base;
    let mut gap: Vec<f64> = (1..trace.u.len())
        .map(|k| {
            let (v0, v1) = (trace.y_rate[k - 1], trace.y_rate[k]);
            let duration = trace.duration[k - 1];
            let motion = base.b * (v1 - v0) / duration + base.c * (trace.y[k] - trace.y[k - 1]) / duration;
            let needed = motion - (trace.supplied[k - 1] + trace.torque[k - 1]);
            if v0 * v1 > 0.0 { needed + base.f1 * v0.signum() } else { needed + (-needed).clamp(-base.f1, base.f1) }
        })
        .collect();
    gap.push(0.0);
    gap
}

/// RMS of the gap after the base parameters absorbed what they can, and the plain RMS over the same samples. The
/// first is by least squares of the gap on acceleration, velocity and direction over the moving samples.
pub fn gap_rms(traces: &[Trace], gaps: &[Vec<f64>]) -> (f64, f64) {
    let mut normal = [[0.0; 4]; 3];
    let (mut squares, mut count) = (0.0, 0.0_f64);
    for (trace, gap) in traces.iter().zip(gaps) {
        for (k, gap) in gap.iter().enumerate().take(trace.u.len().saturating_sub(1)) {
            let (v0, v1) = (trace.y_rate[k], trace.y_rate[k + 1]);
            if v0 * v1 <= 0.0 {
                continue;
            }
            let row = [(v1 - v0) / trace.duration[k], 0.5 * (v0 + v1), v0.signum(), *gap];
            for i in 0..3 {
                for j in 0..4 {
                    normal[i][j] += row[i] * row[j];
                }
            }
            squares += gap * gap;
            count += 1.0;
        }
    }
    let right = [normal[0][3], normal[1][3], normal[2][3]];
    let solved = solve(normal);
    let absorbed: f64 = solved.iter().zip(right).map(|(p, r)| p * r).sum();
    let count = count.max(1.0);
    (((squares - absorbed).max(0.0) / count).sqrt(), (squares / count).sqrt())
}

/// Gaussian elimination of a positive 3×3 system with its right-hand side as fourth column.
fn solve(mut m: [[f64; 4]; 3]) -> [f64; 3] {
    for i in 0..3 {
        let pivot = m[i];
        for row in m.iter_mut().skip(i + 1) {
            if pivot[i] > 0.0 {
                let factor = row[i] / pivot[i];
                for (value, above) in row.iter_mut().zip(pivot) {
                    *value -= factor * above;
                }
            }
        }
    }
    let mut p = [0.0; 3];
    for i in (0..3).rev() {
        let known: f64 = (i + 1..3).map(|j| m[i][j] * p[j]).sum();
        if m[i][i] > 0.0 {
            p[i] = (m[i][3] - known) / m[i][i];
        }
    }
    p
}

/// RMS difference (rad) between the encoder's exact position and the true base plant run open loop under the same
/// drive and random torque. Segments last 0.4 s, each from the true encoder position and velocity.
pub fn base_error(base: &ForceLaw, traces: &[Trace], tick_s: f64) -> f64 {
    segments_rms(base, traces, tick_s, |plant, _, trace, k| plant.x - trace.y[k])
}

/// RMS difference (rad) that the random torque makes to the true base plant over the same segments.
pub fn torque_error(base: &ForceLaw, traces: &[Trace], tick_s: f64) -> f64 {
    segments_rms(base, traces, tick_s, |shaken, calm, _, _| shaken.x - calm.x)
}

/// RMS of the difference over all samples of the segments; it gets the base plant with and without random torque.
fn segments_rms(
    base: &ForceLaw,
    traces: &[Trace],
    tick_s: f64,
    difference: impl Fn(&State, &State, &Trace, usize) -> f64,
) -> f64 {
    let segment = (SEGMENT_S / tick_s).round() as usize;
    let substeps = ((tick_s / STEP_S).round() as usize).max(1);
    let (mut squares, mut count) = (0.0, 0.0_f64);
    for trace in traces {
        for from in (0..trace.u.len()).step_by(segment) {
            let mut shaken = Plant::new(base, State::moving(trace.y[from], trace.y_rate[from]), substeps);
            shaken.tick_s = tick_s;
            let mut calm = shaken.clone();
            for k in from..(from + segment).min(trace.u.len()) {
                squares += difference(&shaken.state, &calm.state, trace, k).powi(2);
                count += 1.0;
                shaken.state.torque = trace.torque[k];
                for plant in [&mut shaken, &mut calm] {
                    plant.sample_for(trace.supplied[k], trace.t[k], trace.duration[k], |_, _| ());
                }
            }
        }
    }
    (squares / count.max(1.0)).sqrt()
}
