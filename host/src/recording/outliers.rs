//! Rows that cannot be measurements: a position that leaps out and back within a few rows.
//!
//! A body does not leave its path and return to it within a row or two. How far it does move from row to row, the
//! recording itself shows. A position that leaps more than [`LEAP`] times as far, and comes back, is a fault. The
//! sensor, its transfer or the logger makes it: a row of zeros, a lost digit.

use super::error::{Place, RecordingError};
use super::quality::Warning;
use super::table::Table;
use super::timing;
use super::wrap::{self, RollOver, Wrap};

/// Size of a leap in the largest change between other rows. Ten times the top speed, there and back, is no motion.
const LEAP: f64 = 10.0;
/// Rows that a leap may last. What stays away for longer may be a motion whose edges were lost.
const LASTS: usize = 3;
/// Distance between the rows around a leap, in the size of the leap: it comes back to where it was.
const BACK: f64 = 1.0 / 3.0;
/// Fewest rows that show what is regular.
const SHOWS: usize = 100;
/// Share of leaping rows past which this is what the signal looks like.
const FREQUENT: f64 = 0.01;

/// A leap: the rows from `from` up to `to`, and how far it goes at least, out and back.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Leap {
    from: usize,
    to: usize,
    size: f64,
}

/// A position column, and the rows at which a piece begins.
#[derive(Debug)]
pub(super) struct Path<'a> {
    pub x: &'a [f64],
    begins: Vec<bool>,
}

impl<'a> Path<'a> {
    pub(super) fn new(x: &'a [f64], breaks: &[usize]) -> Self {
        let mut begins = vec![false; x.len() + 1];
        breaks.iter().filter(|&&row| row < x.len()).for_each(|&row| begins[row] = true);
        Self { x, begins }
    }

    /// Change of the position from the row before; 0 where a piece begins.
    pub(super) fn change(&self, row: usize) -> f64 {
        match (row.checked_sub(1).and_then(|before| self.x.get(before)), self.x.get(row)) {
            (Some(before), Some(this)) if !self.begins[row] => this - before,
            _ => 0.0,
        }
    }

    /// Rows that are faults, increasing; a leap by a full turn only if it is known that nothing rolls over.
    fn faults(&self, unit: &str, turns_too: bool) -> Vec<usize> {
        let rows = self.x.len();
        let mut leaps = self.leaps();
        leaps.extend(self.at_the_ends());
        let mut leaping = vec![false; rows + 1];
        for leap in &leaps {
            leaping[leap.from..=leap.to].fill(true);
        }
        let sizes = || (1..rows).map(|row| self.change(row).abs());
        let smallest = sizes().filter(|size| *size > 0.0).fold(f64::INFINITY, f64::min);
        let regular = sizes().zip(leaping.iter().skip(1)).filter(|(_, leaping)| !**leaping).map(|(size, _)| size);
        let mut largest = regular.fold(smallest, f64::max);
        // The small ones are motion: a vibration near half the sampling rate looks like it. They widen what is regular.
        leaps.sort_unstable_by(|a, b| a.size.total_cmp(&b.size));
        let first = leaps.iter().position(|leap| {
            let fault = leap.size > LEAP * largest;
            if !fault {
                largest = largest.max(leap.size);
            }
            fault
        });
        let faults = leaps.get(first.unwrap_or(leaps.len())..).unwrap_or_default();
        let faults = faults.iter().filter(|leap| turns_too || !wrap::is_turn(leap.size, largest, unit));
        let mut found: Vec<usize> = faults.flat_map(|leap| leap.from..leap.to).collect();
        found.sort_unstable();
        found.dedup();
        if found.len() as f64 > (FREQUENT * rows as f64).max(1.0) { Vec::new() } else { found }
    }

    /// Everything that goes out and comes back within [`LASTS`] rows, whatever its size.
    fn leaps(&self) -> Vec<Leap> {
        let x = self.x;
        let mut found: Vec<Leap> = Vec::new();
        let mut row = 1;
        while row < x.len() {
            let end = (row + LASTS).min(x.len() - 1);
            let end = (row..=end).find(|&at| self.begins[at]).map_or(end, |at| at - 1);
            let leap = (row + 1..=end).find_map(|to| {
                let (out, back, net) = (x[row] - x[row - 1], x[to] - x[to - 1], (x[to] - x[row - 1]).abs());
                let size = out.abs().min(back.abs());
                (out * back < 0.0 && net <= BACK * size).then_some(Leap { from: row, to, size })
            });
            row = leap.map_or(row + 1, |leap| leap.to);
            found.extend(leap);
        }
        found
    }

    /// The first and the last row: there is no way back to be seen.
    fn at_the_ends(&self) -> Vec<Leap> {
        let rows = self.x.len();
        if rows < 3 {
            return Vec::new();
        }
        let size = |row| self.change(row).abs();
        vec![Leap { from: 0, to: 1, size: size(1) }, Leap { from: rows - 1, to: rows, size: size(rows - 1) }]
    }
}

impl Table {
    /// Joins a position column that rolls over where that is asked for, leaves out its faults, and looks for roll-overs.
    ///
    /// # Errors
    /// [`RecordingError::RollsOver`], if it does and nobody said what to do.
    pub(super) fn clean_position(
        &mut self,
        file: &str,
        (column, name): (usize, &str),
        unit: &str,
        wanted: Option<Wrap>,
    ) -> Result<(), RecordingError> {
        let Some(x) = self.columns.get_mut(column) else { return Ok(()) };
        if let Some(Wrap::Modulus(modulus)) = wanted {
            wrap::unwrap(x, modulus);
        }
        // Without one leap, a smaller one may be the largest.
        while let Some(x) = self.columns.get(column).filter(|x| x.len() >= SHOWS) {
            let breaks = timing::gaps(&self.t, &self.breaks);
            let path = Path::new(x, &breaks);
            let mut faults = path.faults(unit, wanted.is_some());
            if faults.is_empty() && wanted.is_none() {
                if let Some(found) = path.roll_over(unit) {
                    return Err(self.rolls_over(file, name, x, found));
                }
                faults = path.faults(unit, true);
            }
            let Some(&first) = faults.first() else { break };
            let lines = faults.iter().map(|&row| self.lines.of(row)).collect();
            let warning = Warning::Outliers { lines, value: x[first] };
            let mut keep = vec![true; x.len()];
            for &row in &faults {
                keep[row] = false;
            }
            self.found.push(warning);
            self.cut(faults.iter().map(|row| row + 1));
            self.retain(&keep);
        }
        Ok(())
    }

    fn rolls_over(&self, file: &str, name: &str, x: &[f64], found: RollOver) -> RecordingError {
        let RollOver { row, times, modulus } = found;
        let place = Place { file: file.to_owned(), line: self.lines.of(row), column: super::field::shown(name) };
        RecordingError::RollsOver { place, before: x[row - 1], after: x[row], times, modulus }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 s at 1 kHz of a swing of 1 rad at 2 Hz, at most 0.0126 rad a row.
    fn swing() -> Vec<f64> {
        (0..2000).map(|k| (std::f64::consts::TAU * 2e-3 * f64::from(k)).sin()).collect()
    }

    fn faults(x: &[f64]) -> Vec<usize> {
        Path::new(x, &[]).faults("rad", false)
    }

    /// One glitch of 50 rad, two of other sizes, one over three rows, a first row of zero, and a torn last one.
    #[test]
    fn leaps_are_faults_and_motion_is_not() {
        assert_eq!(faults(&swing()), [] as [usize; 0]);
        let mut x = swing();
        (x[300], x[700], x[1200], x[1201], x[1202]) = (50.0, -0.9, 3.0, 3.0, 2.9);
        assert_eq!(faults(&x), [300, 700, 1200, 1201, 1202]);
        let mut x = swing();
        x = x.iter().map(|x| x + 5.0).collect();
        (x[0], x[1999]) = (0.0, 0.5);
        assert_eq!(faults(&x), [0, 1999]);
        // What stays away is no glitch: a sensor that is set to zero, a step.
        let mut x = swing();
        x[1000..].iter_mut().for_each(|x| *x += 7.0);
        assert_eq!(faults(&x), [] as [usize; 0]);
    }

    /// A flicker by one step at rest, a vibration at half the sampling rate, and noise are what the signal looks like.
    #[test]
    fn flicker_and_vibration_are_not_faults() {
        let flicker: Vec<f64> = (0..2000).map(|k| if k % 97 == 0 { 1.0 } else { 0.0 }).collect();
        assert_eq!(faults(&flicker), [] as [usize; 0]);
        let vibration: Vec<f64> = (0..2000).map(|k| f64::from(k % 2) * f64::from(k % 500)).collect();
        assert_eq!(faults(&vibration), [] as [usize; 0]);
        // Every tenth row leaps.
        let frequent: Vec<f64> = swing().iter().enumerate().map(|(k, x)| if k % 10 == 5 { 9.0 } else { *x }).collect();
        assert_eq!(faults(&frequent), [] as [usize; 0]);
    }

    /// All ones in a 16-bit counter are a fault amid the range and a turn next to its end.
    #[test]
    fn a_full_counter_is_a_fault_unless_it_is_a_turn() {
        let counts = |offset: f64| -> Vec<f64> { swing().iter().map(|x| (100.0 * x).round() + offset).collect() };
        let mut x = counts(2000.0);
        x[50] = 65_535.0;
        assert_eq!(Path::new(&x, &[]).faults("counts", false), [50]);
        let mut x = counts(100.0);
        x[1875] = 65_535.0;
        assert_eq!(Path::new(&x, &[]).faults("counts", false), [] as [usize; 0]);
    }
}
