//! The stream of samples to the host.

use breakaway_core::link::{Batch, BatchWriter, Sample};

/// A batch is sent at the latest after this many of its samples' ticks, so that slow streams do not look dead.
const LONGEST_TICKS: u32 = 1000;

/// Samples on their way into batches. Holds one finished batch.
pub(super) struct Stream {
    writer: Option<BatchWriter>,
    decimation: u16,
    phase: u16,
    finished: Option<(Batch, u32)>,
    in_batch: u32,
    first_tick: u32,
    last_tick: Option<u32>,
    dropped: u32,
}

impl Stream {
    pub(super) const fn new() -> Self {
        Self {
            writer: None,
            decimation: 0,
            phase: 0,
            finished: None,
            in_batch: 0,
            first_tick: 0,
            last_tick: None,
            dropped: 0,
        }
    }

    /// Every `decimation`-th sample from now on; 0: none.
    pub(super) fn switch(&mut self, decimation: u16) {
        self.writer = (decimation > 0).then(|| BatchWriter::new(decimation));
        self.decimation = decimation;
        self.phase = 0;
        self.in_batch = 0;
        self.finished = None;
    }

    pub(super) fn decimation(&self) -> u16 {
        self.decimation
    }

    /// Samples lost since the reset: on the way from the tick, or because the wire was too slow.
    pub(super) fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Whether a sample can be pushed without losing one.
    pub(super) fn ready(&self) -> bool {
        self.finished.is_none()
    }

    pub(super) fn push(&mut self, sample: Sample) {
        let missing = self.last_tick.map_or(0, |last| sample.tick.wrapping_sub(last).wrapping_sub(1));
        self.last_tick = Some(sample.tick);
        self.dropped = self.dropped.wrapping_add(missing);
        let Some(writer) = &mut self.writer else {
            return;
        };
        if self.phase > 0 {
            self.phase -= 1;
            return;
        }
        self.phase = self.decimation - 1;
        let full = writer.push(sample, self.dropped);
        if let Some(full) = full {
            self.finish(full);
        }
        if self.in_batch == 0 {
            self.first_tick = sample.tick;
        }
        self.in_batch += 1;
        if sample.tick.wrapping_sub(self.first_tick) >= LONGEST_TICKS {
            self.flush();
        }
    }

    /// Makes what is waiting a batch, if there is room for it.
    pub(super) fn flush(&mut self) {
        if self.finished.is_some() {
            return;
        }
        if let Some(batch) = self.writer.as_mut().and_then(|writer| writer.flush(self.dropped)) {
            self.finish(batch);
        }
    }

    pub(super) fn take(&mut self) -> Option<Batch> {
        self.finished.take().map(|(batch, _)| batch)
    }

    fn finish(&mut self, batch: Batch) {
        let samples = core::mem::take(&mut self.in_batch);
        match &mut self.finished {
            // The older one is as good as out; the new one gives way.
            Some(_) => self.dropped = self.dropped.wrapping_add(samples),
            None => self.finished = Some((batch, samples)),
        }
    }
}
