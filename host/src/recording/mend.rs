//! Clocks as loggers write them: a stamp written twice, a stamp out of order, a clock that starts anew inside a file.

use super::MIN_ROWS;
use super::error::{ClockError, Place, RecordingError};
use super::lines::Lines;
use super::quality::Warning;
use super::table::Table;
use super::timing::{GAP_FACTOR, median};

/// Share of rows out of order past which the rows are not in order of time at all.
const DISORDER: f64 = 0.1;

/// What to do with the rows of a clock so that time increases strictly.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Repair {
    /// Rows that carry the stamp of the row before; to be left out.
    pub repeated: Vec<usize>,
    /// Rows whose stamp alone is out of order; to be left out.
    pub stray: Vec<usize>,
    /// Rows at which the clock starts anew.
    pub restarts: Vec<usize>,
}

impl Repair {
    /// Looks through `stamps`, s.
    ///
    /// A row whose stamp goes back is a restart, unless the stamps are in order without that row, or without the row
    /// before it. Then that row is stray. The row before counts as stray only where its stamp leapt by more than
    /// [`GAP_FACTOR`] intervals; else the clock was set back.
    pub(super) fn new(stamps: &[f64]) -> Self {
        let mut repair = Self::default();
        let typical = median(stamps.windows(2).map(|w| w[1] - w[0]).filter(|interval| *interval > 0.0).collect());
        // The rows that are kept: the last one, and the one before it in the same part.
        let (mut before, mut last): (Option<usize>, usize) = (None, 0);
        for (row, &stamp) in stamps.iter().enumerate().skip(1) {
            if stamp == stamps[last] {
                repair.repeated.push(row);
                continue;
            }
            if stamp > stamps[last] {
                before = Some(last);
                last = row;
                continue;
            }
            let goes_on = stamps.get(row + 1).is_none_or(|&next| next > stamps[last]);
            let leapt = |at: usize| stamp > stamps[at] && stamps[last] - stamps[at] > GAP_FACTOR * typical;
            if goes_on {
                repair.stray.push(row);
            } else if before.is_some_and(leapt) {
                repair.stray.push(last);
                last = row;
            } else {
                repair.restarts.push(row);
                before = None;
                last = row;
            }
        }
        repair.stray.sort_unstable();
        repair
    }

    /// Whether the clock is in order as it is.
    pub(super) fn is_needless(&self) -> bool {
        self.repeated.is_empty() && self.stray.is_empty() && self.restarts.is_empty()
    }

    /// Which of `rows` rows are kept.
    pub(super) fn keep(&self, rows: usize) -> Vec<bool> {
        let mut keep = vec![true; rows];
        self.repeated.iter().chain(&self.stray).for_each(|&row| keep[row] = false);
        keep
    }
}

/// Lays the parts of a clock that starts anew at `restarts` one after the other, a median interval apart.
pub(super) fn lay_end_to_end(stamps: &mut [f64], restarts: &[usize]) {
    let interval = median(stamps.windows(2).map(|w| w[1] - w[0]).filter(|interval| *interval > 0.0).collect());
    let ends = restarts.iter().skip(1).copied().chain([stamps.len()]);
    for (start, end) in restarts.iter().copied().zip(ends) {
        let shift = stamps[start - 1] + interval - stamps[start];
        stamps[start..end].iter_mut().for_each(|stamp| *stamp += shift);
    }
}

impl Table {
    /// Leaves out the rows that `keep` does not have. A piece that began at such a row begins at the next one that is kept.
    pub(super) fn retain(&mut self, keep: &[bool]) {
        let filter = |column: &mut Vec<f64>| {
            let mut kept = keep.iter();
            column.retain(|_| kept.next() == Some(&true));
        };
        // New row of every old one, or of the next that is kept.
        let mut rows_before = 0;
        let renumbered: Vec<usize> = keep
            .iter()
            .map(|&kept| {
                rows_before += usize::from(kept);
                rows_before - usize::from(kept)
            })
            .collect();
        for rows in [&mut self.breaks, &mut self.restarts] {
            for row in rows.iter_mut() {
                *row = renumbered.get(*row).copied().unwrap_or(rows_before);
            }
            rows.retain(|&row| row > 0 && row < rows_before);
            rows.dedup();
        }
        filter(&mut self.t);
        self.columns.iter_mut().for_each(filter);
        self.lines = self.lines.retained(keep);
    }

    /// Begins a new piece at each of `rows`.
    pub(super) fn cut(&mut self, rows: impl IntoIterator<Item = usize>) {
        self.breaks.extend(rows);
        self.breaks.sort_unstable();
        self.breaks.dedup();
    }

    /// Makes time increase strictly. It leaves out rows with a repeated or a stray stamp, cuts where the clock starts
    /// anew, and lays the parts end to end. What was done is added to `found`.
    ///
    /// # Errors
    /// [`ClockError::TimeRepeats`] if next to nothing is left, [`ClockError::TimeDecreases`] if the rows are in no
    /// order of time.
    pub(super) fn mend_clock(&mut self, file: &str, column: &str) -> Result<(), RecordingError> {
        let repair = Repair::new(&self.t);
        if repair.is_needless() {
            return Ok(());
        }
        let Repair { repeated, stray, restarts } = &repair;
        let rows = self.t.len();
        let place = |row: usize| Place { file: file.to_owned(), line: self.lines.of(row), column: column.to_owned() };
        let disorder = (stray.len() as f64 > DISORDER * rows as f64).then_some(stray);
        if let Some(&row) = disorder.or((restarts.len() * MIN_ROWS > rows).then_some(restarts)).and_then(|r| r.first())
        {
            let (before, after) = (self.t[row - 1], self.t[row]);
            let times = (stray.len() + restarts.len()) as u64;
            return Err(ClockError::TimeDecreases { place: place(row), before, after, times }.into());
        }
        if let Some(&row) = repeated.first()
            && rows >= MIN_ROWS
            && rows - repeated.len() - stray.len() < MIN_ROWS
        {
            return Err(ClockError::TimeRepeats { place: place(row), time: self.t[row], rows: repeated.len() }.into());
        }
        let lines = |rows: &[usize]| rows.iter().map(|&row| self.lines.of(row)).collect::<Lines>();
        let mut found = Vec::new();
        if !repeated.is_empty() {
            let share = repeated.len() as f64 / rows as f64;
            found.push(Warning::StampRepeated { lines: lines(repeated), share });
        }
        if !stray.is_empty() {
            found.push(Warning::StampStray { lines: lines(stray) });
        }
        if let Some(&row) = restarts.first() {
            let stamps_s = (self.t[row - 1], self.t[row]);
            found.push(Warning::ClockRestarts { lines: lines(restarts), stamps_s });
        }
        self.found.extend(found);
        self.restarts.clone_from(restarts);
        self.cut(restarts.iter().copied());
        self.retain(&repair.keep(rows));
        lay_end_to_end(&mut self.t, &self.restarts);
        // A shift may round two stamps to one number, and take one past the largest.
        let mut last = f64::NEG_INFINITY;
        let follows = |&t: &f64| {
            let follows = t > last && t.is_finite();
            if follows {
                last = t;
            }
            follows
        };
        let later: Vec<bool> = self.t.iter().map(follows).collect();
        if later.contains(&false) {
            self.retain(&later);
        }
        Ok(())
    }

    /// Keeps the longest part between restarts of the clock; what is left has one clock.
    pub(super) fn keep_longest_part(&mut self) {
        let starts = || std::iter::once(0).chain(self.restarts.iter().copied());
        let ends = self.restarts.iter().copied().chain([self.t.len()]);
        let longest = starts().zip(ends).max_by_key(|(start, end)| end - start);
        if let Some((start, end)) = longest.filter(|_| !self.restarts.is_empty()) {
            let keep: Vec<bool> = (0..self.t.len()).map(|row| (start..end).contains(&row)).collect();
            self.retain(&keep);
            self.restarts.clear();
        }
    }

    /// The refusal of a table with too few rows.
    pub(super) fn too_short(&self, file: &str) -> RecordingError {
        RecordingError::TooShort { file: file.to_owned(), line: self.last_line, rows: self.t.len(), needed: MIN_ROWS }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn repair(stamps: &[f64]) -> (Vec<usize>, Vec<usize>, Vec<usize>) {
        let Repair { repeated, stray, restarts } = Repair::new(stamps);
        (repeated, stray, restarts)
    }

    #[test]
    fn each_fault_of_a_clock_is_told_from_the_others() {
        let none = Vec::new;
        assert_eq!(repair(&[0.0, 1.0, 2.0, 3.0]), (none(), none(), none()));
        // A stamp written twice, and a clock that stops while rows go on.
        assert_eq!(repair(&[0.0, 1.0, 1.0, 2.0, 3.0]), (vec![2], none(), none()));
        assert_eq!(repair(&[0.0, 1.0, 2.0, 2.0, 2.0]), (vec![3, 4], none(), none()));
        // Two rows that changed places; a stamp of zero; a stamp that leaps.
        assert_eq!(repair(&[0.0, 1.0, 3.0, 2.0, 4.0, 5.0]), (none(), vec![3], none()));
        assert_eq!(repair(&[5.0, 6.0, 0.0, 8.0, 9.0]), (none(), vec![2], none()));
        assert_eq!(repair(&[0.0, 1.0, 99.0, 2.0, 3.0, 4.0]), (none(), vec![2], none()));
        // A clock that starts anew, and one that is set back by less than the record is long.
        assert_eq!(repair(&[5.0, 6.0, 7.0, 0.0, 1.0, 2.0]), (none(), none(), vec![3]));
        assert_eq!(repair(&[5.0, 6.0, 7.0, 6.5, 6.9, 7.9]), (none(), none(), vec![3]));
        // The last row alone is no part of its own.
        assert_eq!(repair(&[5.0, 6.0, 7.0, 0.0]), (none(), vec![3], none()));
    }

    #[test]
    fn parts_follow_each_other_a_median_interval_apart() {
        let mut stamps = [5.0, 6.0, 7.0, 0.0, 1.0, 2.0, 0.5, 1.5];
        lay_end_to_end(&mut stamps, &[3, 6]);
        assert_eq!(stamps, [5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0]);
    }
}
