//! The winding, where the current is recorded: u = R·i + Ke·ẋ + L·di/dt + u0 by least squares, which parts back-EMF from
//! viscous friction (docs/theory.md, section 1).
//!
//! Each window of rows gives one equation of integrals, ∫u = R·∫i + Ke·Δx + L·Δi + u0·Δt, in which nothing is differentiated. The
//! factor of Δi also takes what the trapezoid and a delay from reading to drive add. So R and Ke are free of both.

use nalgebra::{Matrix4, Vector4};

use super::result::Value;
use crate::recording::Recording;

/// Root mean square of a window's way, encoder steps: the rounding of its two ends then lowers Ke by 1/(6·32²), 0.02 %.
const WAY_STEPS: f64 = 32.0;
/// Longest window, s: shorter than a cycle of most relay experiments, in whose reversals R and Ke are told apart.
const LONGEST_S: f64 = 0.1;
/// Fewest windows: ten for each unknown.
const FEWEST: usize = 40;
/// Standard errors above which an inductance shows.
const SHOWS: f64 = 3.0;

/// What the recorded current tells of the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Winding {
    /// Resistance from the bridge on, Ω.
    pub resistance: Value,
    /// Back-EMF constant, V per position unit and second; in rad also the torque constant, Nm/A.
    pub back_emf: Value,
    /// Inductance, H, where it shows.
    pub inductance: Option<Value>,
}

/// The winding of recordings of one session. `None` where the current is not recorded, the drive is not in V, or there is
/// too little motion.
pub fn winding(recordings: &[Recording]) -> Option<Winding> {
    let measured = |recording: &Recording| recording.units.u == "V" && recording.current.len() == recording.t.len();
    if recordings.is_empty() || !recordings.iter().all(measured) {
        return None;
    }
    let rows = (2..24).map(|power| 1_usize << power).find(|rows| {
        let long = recordings.iter().any(|recording| *rows as f64 * median_tick(recording) > LONGEST_S);
        long || recordings.iter().all(|recording| moves(recording, *rows))
    })?;
    let windows: Vec<Window> = recordings.iter().flat_map(|recording| windows(recording, rows)).collect();
    let [resistance, back_emf, factor, _] = solve(&windows)?;
    let inductance = inductance(factor, resistance.value * median_tick(&recordings[0]));
    Some(Winding { resistance, back_emf, inductance })
}

/// L from the factor of Δi, where it shows. A current goes to its end exponentially in each tick. So the trapezoid's
/// integral is off by a multiple of its change: the factor is (y/2)·coth(y/(2L)) with y = R·Ts, and y/2 without an L.
fn inductance(factor: Value, y: f64) -> Option<Value> {
    let half = y / 2.0;
    if factor.value - half < SHOWS * factor.se {
        return None;
    }
    let value = half / (half / factor.value).atanh();
    let slope = (half / value / (half / value).sinh()).powi(2);
    let inductance = Value { value, se: factor.se / slope };
    (inductance.se.is_finite() && value > SHOWS * inductance.se).then_some(inductance)
}

/// What is left of c without the back-EMF: viscous friction, in the units of c.
pub fn mechanical(c: Value, back_emf: Value) -> Value {
    Value { value: c.value - back_emf.value, se: c.se.hypot(back_emf.se) }
}

/// One equation: ∫i dt, Δx, Δi, Δt, and ∫u dt; and whether the window before it ends where this one begins.
struct Window {
    row: Vector4<f64>,
    impulse: f64,
    follows: bool,
}

fn median_tick(recording: &Recording) -> f64 {
    let mut ticks: Vec<f64> = recording.t.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = ticks.len() / 2;
    if ticks.is_empty() { f64::INFINITY } else { *ticks.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Whether windows of so many rows are long enough for the encoder.
fn moves(recording: &Recording, rows: usize) -> bool {
    let Some(step) = recording.encoder_step else { return rows >= 16 };
    let ways = recording.x.windows(rows + 1).step_by(rows).map(|x| (x[rows] - x[0]).powi(2));
    let (count, sum) = ways.fold((0_usize, 0.0), |(count, sum), way| (count + 1, sum + way));
    count > 0 && (sum / count as f64).sqrt() >= WAY_STEPS * step
}

fn windows(recording: &Recording, rows: usize) -> Vec<Window> {
    let Recording { t, u, x, current: i, .. } = recording;
    let mut windows = Vec::new();
    for piece in recording.pieces() {
        for start in piece.clone().step_by(rows).take_while(|start| start + rows < piece.end) {
            let end = start + rows;
            let (mut charge, mut impulse) = (0.0, 0.0);
            for k in start..end {
                let tick = t[k + 1] - t[k];
                charge += f64::midpoint(i[k], i[k + 1]) * tick;
                impulse += u[k] * tick;
            }
            let row = Vector4::new(charge, x[end] - x[start], i[end] - i[start], t[end] - t[start]);
            windows.push(Window { row, impulse, follows: start > piece.start });
        }
    }
    windows
}

/// Least squares of R, Ke, the factor of Δi, and u0. Neighbouring windows share a reading at their border, so
/// their residuals are correlated: the errors are those of Newey and West (1987) with one lag.
fn solve(windows: &[Window]) -> Option<[Value; 4]> {
    if windows.len() < FEWEST {
        return None;
    }
    let mut scale = windows.iter().fold(Vector4::zeros(), |sum: Vector4<f64>, w| sum + w.row.component_mul(&w.row));
    scale.apply(|sum| *sum = if *sum > 0.0 { sum.sqrt() } else { 1.0 });
    let row = |window: &Window| window.row.component_div(&scale);
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for window in windows {
        let row = row(window);
        normal += row * row.transpose();
        right += row * window.impulse;
    }
    let inverse = normal.try_inverse()?;
    // Columns of length 1: what is left of each beside the others is at least a thousandth.
    if (0..4).any(|k| inverse[(k, k)] > 1e6) {
        return None;
    }
    let solution = inverse * right;
    let residual = |window: &Window| window.impulse - row(window).dot(&solution);
    let mut meat = Matrix4::zeros();
    for (k, window) in windows.iter().enumerate() {
        let score = row(window) * residual(window);
        meat += score * score.transpose();
        if let Some(before) = k.checked_sub(1).map(|before| &windows[before]).filter(|_| window.follows) {
            let earlier = row(before) * residual(before);
            // Half of each: the weight of the only lag.
            meat += (score * earlier.transpose() + earlier * score.transpose()) * 0.5;
        }
    }
    let free = windows.len() as f64 / (windows.len() - 4) as f64;
    let covariance = inverse * meat * inverse * free;
    let value = |k: usize| Value { value: solution[k] / scale[k], se: covariance[(k, k)].max(0.0).sqrt() / scale[k] };
    let found = [value(0), value(1), value(2), value(3)];
    let physical = found[0].value > 0.0 && found.iter().all(|v| v.value.is_finite() && v.se.is_finite());
    physical.then_some(found)
}

#[cfg(test)]
mod tests;
