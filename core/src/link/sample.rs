//! Samples of the stream, in batches.

use crate::says::says;
use heapless::Vec;
use serde::{Deserialize, Serialize};

use super::CommandError;

/// Most bytes of samples in a batch: what [`MAX_MESSAGE`](super::MAX_MESSAGE) leaves beside the batch's own numbers.
pub const BATCH_BYTES: usize = 224;

/// What the device does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// Nothing; the drive is 0.
    #[default]
    Idle,
    /// Dual relay.
    Relay,
    /// Open-loop drive.
    Drive,
    /// Position control along a trajectory.
    Track,
    /// Position control where it is.
    Hold,
    /// A fault is latched; the drive is off.
    Fault,
}

impl Mode {
    /// Whether a command that needs an idle device may be carried out.
    ///
    /// # Errors
    /// [`CommandError::Faulted`] and [`CommandError::Busy`].
    pub const fn idle(self) -> Result<(), CommandError> {
        match self {
            Self::Idle => Ok(()),
            Self::Fault => Err(CommandError::Faulted),
            mode => Err(CommandError::Busy(mode)),
        }
    }

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Relay => "relay",
            Self::Drive => "drive",
            Self::Track => "track",
            Self::Hold => "hold",
            Self::Fault => "fault",
        }
    }
}

/// One tick.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sample {
    /// Ticks since the reset, wraps.
    pub tick: u32,
    /// Position read in this tick, counts.
    pub count: i32,
    /// Drive applied from this tick to the next, drive codes.
    pub drive_code: i16,
    /// Reference of this tick, counts.
    pub reference: i32,
    /// Mode of this tick.
    pub mode: Mode,
    /// Motor current read in this tick, mA; `None` where none is measured.
    pub current_ma: Option<i32>,
}

/// Difference of a sample from the one before (the first: from [`Sample::default`]), as on the wire.
#[derive(Clone, Copy, Serialize, Deserialize)]
struct Step {
    count: i32,
    drive_code: i16,
    reference: i32,
    mode: Mode,
}

/// Bytes of the longest [`Step`]: varints of 32, 16 and 32 bits, and a mode; then the current's varint of 32 bits, where there is one.
const MAX_STEP: usize = 5 + 3 + 5 + 1 + 5;

/// Samples of ticks `first_tick`, `first_tick + decimation`, …, without a gap.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Batch {
    /// Number of the batch since the stream was switched on, wraps. A jump is a lost frame.
    pub sequence: u32,
    /// Tick of the first sample.
    pub first_tick: u32,
    /// Ticks from sample to sample, ≥ 1.
    pub decimation: u16,
    /// Samples dropped on the board since the reset, because the link was too slow; wraps.
    pub dropped: u32,
    /// Each sample has a current.
    pub currents: bool,
    /// The samples, each as the difference from the one before.
    pub steps: Vec<u8, BATCH_BYTES>,
}

/// The samples of a batch are not what they should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BatchError;

says! { BatchError:
    Self => "the batch of samples is damaged",
}

impl Batch {
    /// The samples. An error is the last item.
    pub fn samples(&self) -> impl Iterator<Item = Result<Sample, BatchError>> + '_ {
        let mut rest: &[u8] = &self.steps;
        let mut last = Sample::default();
        let mut tick = self.first_tick;
        core::iter::from_fn(move || {
            if rest.is_empty() {
                return None;
            }
            let read = if self.currents {
                postcard::take_from_bytes::<(Step, i32)>(rest)
            } else {
                postcard::take_from_bytes::<Step>(rest).map(|(step, after)| ((step, 0), after))
            };
            let Ok(((step, current), after)) = read else {
                rest = &[];
                return Some(Err(BatchError));
            };
            rest = after;
            last = Sample {
                tick,
                count: last.count.wrapping_add(step.count),
                drive_code: last.drive_code.wrapping_add(step.drive_code),
                reference: last.reference.wrapping_add(step.reference),
                mode: step.mode,
                current_ma: self.currents.then(|| last.current_ma.unwrap_or(0).wrapping_add(current)),
            };
            tick = tick.wrapping_add(u32::from(self.decimation));
            Some(Ok(last))
        })
    }
}

/// Puts samples together into batches, on the device.
#[derive(Clone, Debug)]
pub struct BatchWriter {
    batch: Batch,
    last: Sample,
}

impl BatchWriter {
    /// A writer for a stream of every `decimation`-th tick (0 is taken as 1), starting at sequence number 0.
    #[must_use]
    pub const fn new(decimation: u16) -> Self {
        let decimation = if decimation == 0 { 1 } else { decimation };
        let batch = Batch { sequence: 0, first_tick: 0, decimation, dropped: 0, currents: false, steps: Vec::new() };
        let last = Sample { tick: 0, count: 0, drive_code: 0, reference: 0, mode: Mode::Idle, current_ma: None };
        Self { batch, last }
    }

    /// Adds a sample; `dropped` is the device's drop counter. Returns the batch before, if this sample did not fit it or
    /// does not follow on it, to be sent.
    pub fn push(&mut self, sample: Sample, dropped: u32) -> Option<Batch> {
        let follows = self.last.tick.wrapping_add(u32::from(self.batch.decimation)) == sample.tick;
        let room = self.batch.steps.len() + MAX_STEP <= BATCH_BYTES;
        let alike = self.batch.currents == sample.current_ma.is_some();
        let full = if follows && room && alike { None } else { self.flush(dropped) };
        if self.batch.steps.is_empty() {
            self.last = Sample::default();
            self.batch.currents = sample.current_ma.is_some();
            self.batch.first_tick = sample.tick;
        }
        let step = Step {
            count: sample.count.wrapping_sub(self.last.count),
            drive_code: sample.drive_code.wrapping_sub(self.last.drive_code),
            reference: sample.reference.wrapping_sub(self.last.reference),
            mode: sample.mode,
        };
        let mut bytes = [0; MAX_STEP];
        // The buffer holds the longest step, and the batch has room for it.
        let current = sample.current_ma.map(|now| now.wrapping_sub(self.last.current_ma.unwrap_or(0)));
        let written = match current {
            Some(current) => postcard::to_slice(&(step, current), &mut bytes),
            None => postcard::to_slice(&step, &mut bytes),
        };
        if let Ok(used) = written {
            let _ = self.batch.steps.extend_from_slice(used);
        }
        self.last = sample;
        full
    }

    /// The samples that are waiting, to be sent now; `None` if there are none.
    pub fn flush(&mut self, dropped: u32) -> Option<Batch> {
        if self.batch.steps.is_empty() {
            return None;
        }
        let mut full = self.batch.clone();
        full.dropped = dropped;
        self.batch.steps.clear();
        self.batch.sequence = self.batch.sequence.wrapping_add(1);
        Some(full)
    }
}
