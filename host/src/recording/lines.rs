//! Lines of a file: which line a row stands on, and lists of lines for messages.

use std::fmt;

/// Ranges of lines that a message lists before it only counts.
const LISTED: usize = 4;

/// The line on which each kept row begins. Rows that follow each other line by line cost no memory.
#[derive(Clone, Debug, Default)]
pub(super) struct LineOfRow {
    /// (row, its line), for the first row of every stretch of rows on successive lines.
    starts: Vec<(usize, u64)>,
    rows: usize,
}

impl LineOfRow {
    /// Appends a row that begins on `line`.
    pub(super) fn push(&mut self, line: u64) {
        if self.starts.last().is_none_or(|&(row, first)| first + (self.rows - row) as u64 != line) {
            self.starts.push((self.rows, line));
        }
        self.rows += 1;
    }

    /// The line of row `row`; 0 past the last row.
    pub(super) fn of(&self, row: usize) -> u64 {
        let after = self.starts.partition_point(|&(first, _)| first <= row);
        match after.checked_sub(1).and_then(|k| self.starts.get(k)) {
            Some(&(first, line)) if row < self.rows => line + (row - first) as u64,
            _ => 0,
        }
    }

    /// The rows that `keep` has, renumbered.
    pub(super) fn retained(&self, keep: &[bool]) -> Self {
        let mut kept = Self::default();
        (0..self.rows).filter(|&row| keep.get(row) == Some(&true)).for_each(|row| kept.push(self.of(row)));
        kept
    }
}

/// Lines of a file, increasing, for a message: `line 5`, `lines 5, 17 to 19`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lines {
    /// First and last line of every stretch of successive lines.
    ranges: Vec<(u64, u64)>,
}

impl Lines {
    /// Number of lines.
    pub fn count(&self) -> u64 {
        self.ranges.iter().map(|(first, last)| last - first + 1).sum()
    }

    /// Number of stretches of successive lines.
    pub fn stretches(&self) -> usize {
        self.ranges.len()
    }

    /// The first line; 0 if there is none.
    pub fn first(&self) -> u64 {
        self.ranges.first().map_or(0, |&(first, _)| first)
    }
}

impl FromIterator<u64> for Lines {
    fn from_iter<I: IntoIterator<Item = u64>>(lines: I) -> Self {
        let mut ranges: Vec<(u64, u64)> = Vec::new();
        for line in lines {
            match ranges.last_mut() {
                Some((_, last)) if *last + 1 == line => *last = line,
                _ => ranges.push((line, line)),
            }
        }
        Self { ranges }
    }
}

impl fmt::Display for Lines {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(if self.count() == 1 { "line " } else { "lines " })?;
        for (k, (first, last)) in self.ranges.iter().take(LISTED).enumerate() {
            out.write_str(if k == 0 { "" } else { ", " })?;
            if first == last { write!(out, "{first}")? } else { write!(out, "{first} to {last}")? }
        }
        match self.ranges.get(LISTED..) {
            Some(more) if !more.is_empty() => {
                write!(out, " and {} more", more.iter().map(|(first, last)| last - first + 1).sum::<u64>())
            }
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_know_their_lines_when_some_are_left_out() {
        let mut lines = LineOfRow::default();
        // A header on line 1, a comment on line 4, a row over two lines from line 6.
        for line in [2, 3, 5, 6, 8, 9] {
            lines.push(line);
        }
        assert_eq!((0..7).map(|row| lines.of(row)).collect::<Vec<_>>(), [2, 3, 5, 6, 8, 9, 0]);
        assert_eq!(lines.starts.len(), 3);
        let kept = lines.retained(&[true, false, true, true, true, false]);
        assert_eq!((0..5).map(|row| kept.of(row)).collect::<Vec<_>>(), [2, 5, 6, 8, 0]);
    }

    #[test]
    fn a_list_of_lines_stays_short() {
        let list = |lines: &[u64]| lines.iter().copied().collect::<Lines>().to_string();
        assert_eq!(list(&[5]), "line 5");
        assert_eq!(list(&[5, 6, 7, 9]), "lines 5 to 7, 9");
        assert_eq!(list(&[1, 3, 5, 7, 9, 10]), "lines 1, 3, 5, 7 and 2 more");
    }
}
