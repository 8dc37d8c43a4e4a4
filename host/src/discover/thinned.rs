//! Recordings with no more rows than a simulation needs.

use crate::fit::median;
use crate::recording::Recording;

/// Interval of the rows that are simulated, s. It is the longest sub-step of a simulation, so that a simulated second
/// takes as long for each machine.
const ROW_S: f64 = 1e-3;
/// Rows are merged where their interval is shorter than this share of [`ROW_S`].
const CLOSE: f64 = 2.0 / 3.0;

/// The recording with rows at about [`ROW_S`]; the recording itself where its rows are no closer. The drive of a row is
/// its mean until the next row. So it moves the axis as far as the recorded drive did.
pub(super) fn thinned(recording: &Recording) -> Recording {
    let intervals = recording.t.windows(2).map(|w| w[1] - w[0]).collect();
    let each = (ROW_S / median(intervals)).round();
    if !(each.is_finite() && each * CLOSE >= 1.0) {
        return recording.clone();
    }
    let each = each as usize;
    let mut own = Recording { t: Vec::new(), u: Vec::new(), x: Vec::new(), gaps: Vec::new(), ..recording.clone() };
    for piece in recording.pieces() {
        if piece.start > 0 {
            own.gaps.push(own.t.len());
        }
        for row in piece.clone().step_by(each) {
            let rows = row..(row + each).min(piece.end);
            let mean = recording.u[rows.clone()].iter().sum::<f64>() / rows.len() as f64;
            own.t.push(recording.t[row]);
            own.x.push(recording.x[row]);
            own.u.push(mean);
        }
    }
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(interval_s: f64) -> Recording {
        let rows = 0..4000_u32;
        Recording {
            t: rows.clone().map(|k| f64::from(k) * interval_s).collect(),
            u: rows.clone().map(|k| f64::from(k).sin()).collect(),
            x: rows.map(f64::from).collect(),
            ..Recording::default()
        }
    }

    /// At 10 kHz one row in ten stays, with the same impulse to the rounding of a sum. At 1 kHz all stay.
    #[test]
    fn a_row_in_a_millisecond_and_the_same_impulse() {
        let (fast, usual) = (recording(1e-4), recording(1e-3));
        let few = thinned(&fast);
        assert_eq!(few.t.len(), 400);
        assert!((few.t[399] - 0.399).abs() < 1e-12 && few.x[399].to_bits() == 3990.0_f64.to_bits());
        let (all, own): (f64, f64) = (fast.u.iter().sum(), few.u.iter().sum());
        assert!((10.0 * own - all).abs() < 1e-9, "{own} {all}");
        assert_eq!(thinned(&usual).t.len(), 4000);
    }
}
