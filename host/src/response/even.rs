//! Recordings as evenly sampled pieces without gaps.

use super::ResponseError;
use crate::recording::between::{Integral, position};
use crate::recording::{EVEN_WITHIN, Recording};

/// Consecutive samples.
#[derive(Debug)]
pub(super) struct Piece {
    /// Drive, held from each sample to the next.
    pub(super) drive: Vec<f64>,
    /// How far the position moves from each sample to the next. Its spectrum is flatter than that of the position, so that
    /// less of the low frequencies leaks into the high ones.
    pub(super) steps: Vec<f64>,
}

impl Piece {
    pub(super) fn len(&self) -> usize {
        self.steps.len()
    }
}

/// All recordings.
#[derive(Debug)]
pub(super) struct Even {
    /// The pieces.
    pub(super) pieces: Vec<Piece>,
    /// Interval between samples, s.
    pub(super) interval_s: f64,
    /// Some recordings were interpolated.
    pub(super) interpolated: bool,
}

/// Splits recordings at their gaps. Where the clock jitters, the position is interpolated to an even one.
///
/// # Errors
/// [`ResponseError::Rates`].
pub(super) fn of(recordings: &[Recording]) -> Result<Even, ResponseError> {
    let interval_s = recordings.first().map_or(0.0, |first| first.timing().mean_s);
    let mut even = Even { pieces: Vec::new(), interval_s, interpolated: false };
    for recording in recordings {
        let own_s = recording.timing().mean_s;
        if (own_s - interval_s).abs() > EVEN_WITHIN * interval_s {
            return Err(ResponseError::Rates { first_hz: interval_s.recip(), second_hz: own_s.recip() });
        }
        for piece in recording.pieces() {
            let (t, u, x) = (&recording.t[piece.clone()], &recording.u[piece.clone()], &recording.x[piece]);
            let on_the_grid =
                |(k, own): (usize, &f64)| (own - t[0] - k as f64 * interval_s).abs() <= 10.0 * EVEN_WITHIN * interval_s;
            if t.iter().enumerate().all(on_the_grid) {
                let steps = x.windows(2).map(|pair| pair[1] - pair[0]).collect();
                even.pieces.push(Piece { drive: u[..u.len() - 1].to_vec(), steps });
            } else {
                even.interpolated = true;
                even.pieces.push(interpolated(t, u, x, interval_s));
            }
        }
    }
    Ok(even)
}

/// The position by straight lines. The drive is the mean of what is held: it moves the axis as far.
fn interpolated(t: &[f64], u: &[f64], x: &[f64], interval_s: f64) -> Piece {
    let samples = ((t[t.len() - 1] - t[0]) / interval_s + 1e-9) as usize;
    let at: Vec<f64> = (0..=samples).map(|sample| t[0] + sample as f64 * interval_s).collect();
    let positions: Vec<f64> = at.iter().map(|at| position(t, x, *at)).collect();
    let drive = Integral::new(t, |k| u[k]);
    Piece {
        drive: at.windows(2).map(|pair| drive.over(pair[0], pair[1]) / interval_s).collect(),
        steps: positions.windows(2).map(|pair| pair[1] - pair[0]).collect(),
    }
}
