//! What arrives of the drive at the axis.

use super::term::Arrival;

/// The drive as it arrives, of an axis that moves with velocity `v` in `direction`.
pub fn arrive(u: &[f64], (v, direction): (&[f64], &[f64]), h_s: f64, arrival: Arrival) -> Vec<f64> {
    match arrival {
        Arrival::Delay(delay_s) => {
            let (whole, share) = {
                let samples = delay_s / h_s;
                (samples.floor() as i64, samples - samples.floor())
            };
            let last = u.len() as i64 - 1;
            let at = |k: i64| u[k.clamp(0, last) as usize];
            (0..u.len() as i64).map(|k| (1.0 - share) * at(k - whole) + share * at(k - whole - 1)).collect()
        }
        Arrival::Limit(limit) => u.iter().map(|u| u.clamp(-limit, limit)).collect(),
        Arrival::DeadZone(d) => u.iter().map(|u| u - u.clamp(-d, d)).collect(),
        Arrival::Load(k) => u.iter().zip(direction).map(|(u, s)| u - k * u.abs() * s).collect(),
        Arrival::DeadTime([d, edge, emf]) => {
            u.iter().zip(v).map(|(u, v)| u - d * ((u - emf * v) / edge).clamp(-1.0, 1.0)).collect()
        }
        Arrival::Lag(lag_s) => {
            // A mean over an interval, held or not, passes a lag as a line from sample to sample.
            let decay = (-h_s / lag_s).exp();
            let ramp = 1.0 - lag_s / h_s * (1.0 - decay);
            let mut state = u.first().copied().unwrap_or(0.0);
            let mut previous = state;
            u.iter()
                .map(|u| {
                    state = decay * state + (1.0 - decay) * previous + ramp * (u - previous);
                    previous = *u;
                    state
                })
                .collect()
        }
    }
}
