//! What comes of one experiment while it runs.

use breakaway_core::link::{Batch, Ended, Mismatch, Mode};

use crate::device::stream::{Row, Stream};

/// The samples of one experiment.
#[derive(Default)]
pub(super) struct Record {
    pub(super) stream: Stream,
    pub(super) rows: Vec<Row>,
    pub(super) ended: Option<Ended>,
    pub(super) fault: Option<String>,
    pub(super) mismatches: Vec<Mismatch>,
    /// A sample from after the end has come: there are no more of the experiment.
    pub(super) past_the_end: bool,
}

impl Record {
    pub(super) fn take(&mut self, batch: &Batch) -> Result<(), ()> {
        let mut rows = Vec::new();
        let taken = self.stream.take(batch, &mut rows);
        for row in rows {
            if matches!(row.mode, Mode::Idle | Mode::Fault | Mode::Hold) {
                self.past_the_end |= !self.rows.is_empty();
            } else if !self.past_the_end {
                self.rows.push(row);
            }
        }
        taken.map_err(|_| ())
    }
}
