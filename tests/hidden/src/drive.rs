//! The drive path: what becomes of the recorded, zero-order-held drive before it acts as a force.
//! Order: gain drift, saturation, dead zone, delay, electrical pole.

use crate::law::ForceLaw;

/// Memory of the drive path within one recording (the drive is 0 before it starts).
#[derive(Clone, Debug, Default)]
pub struct Drive {
    shaped: Vec<f64>,
    /// Begin of each sample, ticks after that of the recording.
    starts: Vec<f64>,
    /// Sum of the samples before each one, each times its length in ticks.
    before: Vec<f64>,
    /// End of the last sample, ticks.
    end: f64,
    lagged: f64,
    /// Index of the sample that is being held.
    held: usize,
}

impl ForceLaw {
    /// Static part of the drive path at session time t.
    pub fn shape(&self, u: f64, t: f64) -> f64 {
        let drifted = u * (1.0 - self.gain_drift * t);
        let clipped = self.u_max.map_or(drifted, |limit| drifted.clamp(-limit, limit));
        clipped.signum() * (clipped.abs() - self.dead_zone).max(0.0)
    }
}

impl Drive {
    /// Begins to hold the next sample, for so many ticks.
    pub fn hold(&mut self, law: &ForceLaw, u: f64, t: f64, ticks: f64) {
        let past = match (self.before.last(), self.shaped.last(), self.starts.last()) {
            (Some(before), Some(last), Some(start)) => before + last * (self.end - start),
            _ => 0.0,
        };
        self.before.push(past);
        self.starts.push(self.end);
        self.end += ticks;
        self.held = self.shaped.len();
        self.shaped.push(law.shape(u, t));
    }

    /// Mean delivered drive over the piece `[offset, offset + h]` of the held sample; `ts` is the tick.
    /// The mean is exact for a delay of any fraction of a sample, and for the pole within a piece.
    pub fn deliver(&mut self, law: &ForceLaw, offset: f64, h: f64, ts: f64) -> f64 {
        let delayed = if law.delay > 0.0 {
            let end = (self.starts[self.held] + (offset + h - law.delay) / ts) * ts;
            (self.integral(end, ts) - self.integral(end - h, ts)) / h
        } else {
            self.shaped[self.held]
        };
        if law.lag <= 0.0 {
            return delayed;
        }
        let decay = (-h / law.lag).exp();
        let start = self.lagged;
        self.lagged = delayed + (start - delayed) * decay;
        delayed + (start - delayed) * (1.0 - decay) * law.lag / h
    }

    /// ∫ of the held drive from the start to time `t` of this recording.
    fn integral(&self, t: f64, ts: f64) -> f64 {
        let position = t / ts;
        if position < 0.0 {
            return 0.0;
        }
        // A delay reaches back over a few samples only.
        let later = self.starts[..=self.held].iter().rev().take_while(|start| **start > position).count();
        let index = self.held - later;
        ts * (self.before[index] + (position - self.starts[index]) * self.shaped[index])
    }
}
