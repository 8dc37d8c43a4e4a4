//! Real recordings made worse, as another logger or a cheaper sensor would have made them. The machine is the same, and
//! so is the truth. Nothing in the tool was made with these, so they ask whether an answer hangs on one recording.

use std::fmt;

use breakaway::recording::Recording;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What is done to every recording of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alteration {
    /// Drive and position with the other sign.
    Mirrored,
    /// One row of so many, as a slower log has.
    Slower(usize),
    /// The position of every so-many-th row, held until the next, as a slower sensor has it.
    Held(usize),
    /// The position in steps that are so many times as large.
    Coarser(u32),
    /// Stamps that are off by up to so many per cent of a sample interval, uniformly.
    Jittered(u32),
    /// The rows between two tenths of the time.
    Tenths([usize; 2]),
}

/// Each of them, in the order of the page.
pub const ALTERATIONS: [Alteration; 9] = [
    Alteration::Mirrored,
    Alteration::Slower(2),
    Alteration::Slower(3),
    Alteration::Held(3),
    Alteration::Coarser(4),
    Alteration::Jittered(20),
    Alteration::Tenths([0, 6]),
    Alteration::Tenths([2, 8]),
    Alteration::Tenths([4, 10]),
];

/// Further ones, of other sizes. They were first run after the method was changed by the others. Then it was changed by them.
pub const FURTHER: [Alteration; 8] = [
    Alteration::Slower(4),
    Alteration::Held(2),
    Alteration::Held(5),
    Alteration::Coarser(2),
    Alteration::Coarser(8),
    Alteration::Jittered(40),
    Alteration::Tenths([1, 7]),
    Alteration::Tenths([3, 9]),
];

/// Fresh ones, of other sizes again. No rule was made by them when they were first run, so they told what the others no longer
/// do.
pub const FRESH: [Alteration; 8] = [
    Alteration::Slower(5),
    Alteration::Held(4),
    Alteration::Held(8),
    Alteration::Coarser(3),
    Alteration::Coarser(16),
    Alteration::Jittered(60),
    Alteration::Tenths([0, 8]),
    Alteration::Tenths([3, 7]),
];

impl fmt::Display for Alteration {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mirrored => write!(out, "mirrored"),
            Self::Slower(of) => write!(out, "1 row of {of}"),
            Self::Held(rows) => write!(out, "held {rows} rows"),
            Self::Coarser(times) => write!(out, "step × {times}"),
            Self::Jittered(percent) => write!(out, "jitter {percent} %"),
            Self::Tenths([from, to]) => write!(out, "tenths {} to {to}", from + 1),
        }
    }
}

impl Alteration {
    /// The recording with it. Gaps stay where they are in time.
    pub fn of(self, recording: &Recording) -> Recording {
        let rows = recording.t.len();
        match self {
            Self::Mirrored => {
                let turned = |signal: &[f64]| signal.iter().map(|value| -value).collect();
                Recording { u: turned(&recording.u), x: turned(&recording.x), ..recording.clone() }
            }
            Self::Slower(of) => of_rows(recording, &(0..rows).step_by(of).collect::<Vec<_>>()),
            Self::Held(held) => {
                let x = (0..rows).map(|k| recording.x[k - k % held]).collect();
                Recording { x, ..recording.clone() }
            }
            Self::Coarser(times) => {
                let step = f64::from(times) * step_of(recording);
                let x = recording.x.iter().map(|x| (x / step).round() * step).collect();
                Recording { x, encoder_step: recording.encoder_step.map(|_| step), ..recording.clone() }
            }
            Self::Jittered(percent) => {
                let mut random = ChaCha8Rng::seed_from_u64(u64::from(percent));
                let share = f64::from(percent) / 100.0;
                let mut stamp = |k: usize| {
                    let to = if random.random_bool(0.5) { k.saturating_sub(1) } else { (k + 1).min(rows - 1) };
                    // Half of the way to a neighbour at most, so that stamps stay in order.
                    recording.t[k] + 0.5 * share * random.random::<f64>() * (recording.t[to] - recording.t[k])
                };
                Recording { t: (0..rows).map(&mut stamp).collect(), ..recording.clone() }
            }
            Self::Tenths(tenths) => {
                let [start, end] = tenths.map(|tenth| tenth * rows / 10);
                of_rows(recording, &(start..end).collect::<Vec<_>>())
            }
        }
    }
}

/// The smallest change of the position, or its known step.
fn step_of(recording: &Recording) -> f64 {
    let changes = recording.x.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|change| *change > 0.0);
    recording.encoder_step.unwrap_or_else(|| changes.fold(f64::INFINITY, f64::min))
}

/// These rows of a recording. A gap stays before the first row after it.
fn of_rows(recording: &Recording, rows: &[usize]) -> Recording {
    let taken = |signal: &[f64]| rows.iter().filter_map(|k| signal.get(*k).copied()).collect();
    let gap = |gap: &usize| rows.iter().position(|k| k >= gap).filter(|k| *k > 0);
    let mut gaps: Vec<usize> = recording.gaps.iter().filter_map(gap).collect();
    gaps.dedup();
    Recording {
        t: taken(&recording.t),
        u: taken(&recording.u),
        x: taken(&recording.x),
        current: taken(&recording.current),
        gaps,
        ..recording.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Recording {
        let t: Vec<f64> = (0..10).map(f64::from).collect();
        let x = t.iter().map(|t| 2.0 * t).collect();
        Recording { u: t.clone(), t, x, gaps: vec![4, 5], encoder_step: Some(2.0), ..Recording::default() }
    }

    /// Ten rows with gaps before the fourth and the fifth.
    #[test]
    fn rows_and_gaps_that_are_taken() {
        let slower = Alteration::Slower(3).of(&ramp());
        assert_eq!((slower.t, slower.gaps), (vec![0.0, 3.0, 6.0, 9.0], vec![2]));
        let part = Alteration::Tenths([4, 10]).of(&ramp());
        assert_eq!((part.t, part.gaps), (vec![4.0, 5.0, 6.0, 7.0, 8.0, 9.0], vec![1]));
    }

    #[test]
    fn position_and_stamps_that_are_worse() {
        assert_eq!(Alteration::Held(3).of(&ramp()).x[..5], [0.0, 0.0, 0.0, 6.0, 6.0]);
        let coarser = Alteration::Coarser(4).of(&ramp());
        assert_eq!((&coarser.x[..5], coarser.encoder_step), (&[0.0, 0.0, 8.0, 8.0, 8.0][..], Some(8.0)));
        assert_eq!(Alteration::Mirrored.of(&ramp()).u[..3], [-0.0, -1.0, -2.0]);
        let jittered = Alteration::Jittered(20).of(&ramp());
        let off = |k: usize| (jittered.t[k] - k as f64).abs();
        assert!((0..10).all(|k| off(k) <= 0.1) && (0..10).any(|k| off(k) > 0.01), "{:?}", jittered.t);
    }
}
