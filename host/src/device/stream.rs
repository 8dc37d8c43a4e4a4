//! The stream of samples: ticks unwrapped, gaps found and counted.

use breakaway_core::link::{Batch, Mode};

/// One sample, with its place in the stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// Ticks since the device's reset.
    pub tick: u64,
    /// Position, counts.
    pub count: i32,
    /// Drive applied from this tick on, drive codes.
    pub drive_code: i16,
    /// Reference, counts.
    pub reference: i32,
    /// Mode.
    pub mode: Mode,
    /// Motor current, mA, where the board measures it.
    pub current_ma: Option<i32>,
    /// Samples missing between the one before and this one.
    pub missing: u64,
}

/// What has been seen of a stream.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Totals {
    /// Samples received.
    pub samples: u64,
    /// Samples missing between those received.
    pub missing: u64,
    /// Places where samples are missing.
    pub gaps: u64,
    /// Of the missing ones, those that the board itself dropped because the link was too slow.
    pub dropped: u64,
    /// Frames of samples that were lost on the way.
    pub lost_batches: u64,
}

/// The receiving end of a stream.
#[derive(Clone, Debug, Default)]
pub struct Stream {
    last: Option<Last>,
    /// Totals so far.
    pub totals: Totals,
}

#[derive(Clone, Copy, Debug)]
struct Last {
    tick: u64,
    sequence: u32,
    dropped: u32,
}

/// The ticks went backwards: the device was reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Backwards;

impl Stream {
    /// Takes a batch; its rows are appended to `rows`.
    ///
    /// # Errors
    /// [`Backwards`]: the batch belongs to another run of the device; nothing is appended.
    pub fn take(&mut self, batch: &Batch, rows: &mut Vec<Row>) -> Result<(), Backwards> {
        let decimation = u64::from(batch.decimation.max(1));
        for sample in batch.samples().map_while(Result::ok) {
            let (tick, missing) = match self.last {
                None => (u64::from(sample.tick), 0),
                Some(last) => {
                    let ahead = sample.tick.wrapping_sub(last.tick as u32);
                    if ahead == 0 || ahead > 1 << 31 {
                        return Err(Backwards);
                    }
                    (last.tick + u64::from(ahead), (u64::from(ahead) / decimation).saturating_sub(1))
                }
            };
            if let Some(last) = self.last {
                self.totals.lost_batches += u64::from(batch.sequence.wrapping_sub(last.sequence).saturating_sub(1));
                self.totals.dropped += u64::from(batch.dropped.wrapping_sub(last.dropped));
            }
            self.totals.samples += 1;
            self.totals.missing += missing;
            self.totals.gaps += u64::from(missing > 0);
            self.last = Some(Last { tick, sequence: batch.sequence, dropped: batch.dropped });
            rows.push(Row {
                tick,
                count: sample.count,
                drive_code: sample.drive_code,
                reference: sample.reference,
                mode: sample.mode,
                current_ma: sample.current_ma,
                missing,
            });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use breakaway_core::link::{BatchWriter, Sample};

    use super::*;

    fn batches(ticks: impl IntoIterator<Item = u32>, decimation: u16) -> Vec<Batch> {
        let mut writer = BatchWriter::new(decimation);
        let mut out = Vec::new();
        for tick in ticks {
            let count = tick.cast_signed();
            out.extend(writer.push(Sample { tick, count, ..Sample::default() }, 0));
        }
        out.extend(writer.flush(0));
        out
    }

    #[test]
    fn a_lost_frame_is_a_gap_of_its_samples() {
        let all = batches((0..1000).map(|k| 10 * k), 10);
        let (mut stream, mut rows) = (Stream::default(), Vec::new());
        let lost = all[1].samples().count() as u64;
        for batch in all.iter().enumerate().filter(|(i, _)| *i != 1).map(|(_, batch)| batch) {
            stream.take(batch, &mut rows).unwrap();
        }
        let expected = Totals { samples: 1000 - lost, missing: lost, gaps: 1, dropped: 0, lost_batches: 1 };
        assert_eq!(stream.totals, expected);
        // Nothing is filled in.
        assert!(rows.iter().all(|row| row.count as u64 == row.tick));
        assert_eq!(rows.iter().filter(|row| row.missing > 0).count(), 1);
    }

    #[test]
    fn ticks_wrap_and_go_on() {
        let (mut stream, mut rows) = (Stream::default(), Vec::new());
        for batch in batches([u32::MAX - 1, u32::MAX, 0, 1], 1) {
            stream.take(&batch, &mut rows).unwrap();
        }
        let ticks: Vec<u64> = rows.iter().map(|row| row.tick).collect();
        assert_eq!(ticks, [0xffff_fffe, 0xffff_ffff, 0x1_0000_0000, 0x1_0000_0001]);
        assert_eq!(stream.totals.missing, 0);
        // The device starts anew.
        assert_eq!(stream.take(&batches([0], 1)[0], &mut rows), Err(Backwards));
    }
}
