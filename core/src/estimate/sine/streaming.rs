//! The streaming fit: block phasors, the form that runs on the microcontroller (docs/theory.md, section 3).
//!
//! An oscillator at ω0 demodulates the samples into at most `B` blocks, each with Σy·cos, Σy·sin, Σy; the first
//! blocks are a quarter period long. When all are used, neighbours are added in pairs and the length doubles: the
//! oscillator's phase is global, so this is an addition. [`StreamingSine::fit`] then solves for A, ω, θ and d, in f64
//! or (on the microcontroller) in f32. Its time does not depend on the record's length.

use super::sample::Sample;
use super::solve::{self, Block};
use super::{SineError, SineFit};
use crate::scalar::SolverReal;
use crate::scalar::nco::{Nco, NcoError};

/// Fewest samples of a first block: sine, cosine and constant need three to be told apart, four to be so with ease.
const SHORTEST_BLOCK: u64 = 4;
/// Fewest samples of a fit: two blocks, six sums for four parameters.
const FEWEST_SAMPLES: u64 = 2 * SHORTEST_BLOCK;

/// Configuration of a streaming fit: the demodulation frequency and the clock. The state is a [`BlockSums`].
///
/// `R` is the number that the fit is solved in. In f32 a residual below 3e-4 of the amplitude is lost in rounding
/// (standard errors at 60 dB are off by 11 %). A, ω and d are good to 1e-6. The limit cycle of a relay, with 4 % of
/// harmonics, has standard errors good to 1e-3 in 99 of 100 records. In the others the harmonics leave next to
/// nothing between the blocks and the frequency is within 1 % of the given one. There they are good to some per cent,
/// and in one of 6 000 to 30 %. The blocks do not see a small part of the sine (1.5e-6 of its power at 0.13 % off).
/// f32 knows that part, a difference, to 1e-7 of the power, and it decides the source of the noise.
///
/// ```
/// use breakaway_core::estimate::sine::{BlockSums, StreamingSine};
/// let config = StreamingSine::new(12.0, 1e-3)?;
/// let mut sums: BlockSums<i32> = BlockSums::new();
/// for i in 0..5_000 {
///     let t = f64::from(i) * 1e-3;
///     config.push(&mut sums, (900.0 * libm::sin(12.3 * t)) as i32 + 5_000);
/// }
/// let fit = config.fit(&sums)?;
/// assert!((fit.omega_rad_s - 12.3).abs() < 1e-3);
/// # Ok::<(), breakaway_core::estimate::sine::SineError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamingSine<R = f64> {
    nco: Nco,
    sample_period_s: R,
    first_block: u64,
}

/// State of a streaming fit: `B` block phasors of samples of type `S`, below 900 bytes for i32 and f32 at B = 32.
///
/// `B` is even and at least 8 (checked when compiling).
#[derive(Clone, Copy, Debug)]
pub struct BlockSums<S: Sample, const B: usize = 32> {
    blocks: [S::Sums; B],
    full: usize,
    current: S::Sums,
    filled: u64,
    doublings: u32,
    phase: u32,
    reference: Option<S>,
    power: S::Power,
    in_range: bool,
}

impl<S: Sample, const B: usize> BlockSums<S, B> {
    /// No samples yet.
    pub fn new() -> Self {
        const { assert!(B >= 8 && B.is_multiple_of(2)) };
        Self {
            blocks: [S::Sums::default(); B],
            full: 0,
            current: S::Sums::default(),
            filled: 0,
            doublings: 0,
            phase: 0,
            reference: None,
            power: S::Power::default(),
            in_range: true,
        }
    }

    /// Stores the finished block; pairs neighbours when all places are used.
    #[cold]
    fn close_block(&mut self) {
        if let Some(place) = self.blocks.get_mut(self.full) {
            *place = core::mem::take(&mut self.current);
            self.full += 1;
        }
        self.filled = 0;
        if self.full < B {
            return;
        }
        for i in 0..B / 2 {
            if let (Some(mut sum), Some(next)) = (self.blocks.get(2 * i).copied(), self.blocks.get(2 * i + 1).copied())
            {
                self.in_range &= S::merge(&mut sum, &next);
                if let Some(place) = self.blocks.get_mut(i) {
                    *place = sum;
                }
            }
        }
        self.full = B / 2;
        self.doublings += 1;
    }
}

impl<S: Sample, const B: usize> Default for BlockSums<S, B> {
    fn default() -> Self {
        Self::new()
    }
}

impl StreamingSine {
    /// A fit around `omega_rad_s` of samples taken every `sample_period_s` seconds; at least 4 samples per period.
    ///
    /// # Errors
    /// [`SineError::SamplePeriod`], [`SineError::Frequency`].
    pub fn new(omega_rad_s: f64, sample_period_s: f64) -> Result<Self, SineError> {
        let limit = SineError::Frequency { limit_rad_s: core::f64::consts::FRAC_PI_2 / sample_period_s };
        let nco = Nco::new(omega_rad_s, sample_period_s).map_err(|error| match error {
            NcoError::SamplePeriod => SineError::SamplePeriod,
            NcoError::Frequency => limit,
        })?;
        if nco.word() > 1 << 30 {
            return Err(limit);
        }
        Ok(Self::around(nco, sample_period_s))
    }
}

impl<R: SolverReal> StreamingSine<R> {
    /// A fit around a period of `samples` samples, at least 4; in integers.
    pub fn of_period(samples: u32, sample_period_s: R) -> Option<Self> {
        (samples >= 4).then(|| Self::around(Nco::of_period(samples), sample_period_s))
    }

    fn around(nco: Nco, sample_period_s: R) -> Self {
        let quarter = ((1_u64 << 30) + u64::from(nco.word()) / 2) / u64::from(nco.word().max(1));
        Self { nco, sample_period_s, first_block: quarter.max(SHORTEST_BLOCK) }
    }

    /// The frequency of the oscillator, rad/s: the one asked for, to 2⁻³³ of the sampling rate.
    pub fn omega_rad_s(&self) -> f64 {
        self.nco.radians_per_sample() / self.sample_period_s.to_f64()
    }

    /// Takes one sample: [`StreamingSine::push_slice`] of one. Bounded time, no division; integers only if `S` is i32.
    #[inline]
    pub fn push<S: Sample, const B: usize>(&self, sums: &mut BlockSums<S, B>, sample: S) {
        let reference = *sums.reference.get_or_insert(sample);
        let (phase, in_range) =
            sample.accumulate_one(reference, sums.phase, self.nco.word(), &mut sums.current, &mut sums.power);
        sums.phase = phase;
        sums.in_range &= in_range;
        sums.filled += 1;
        if sums.filled >= self.block_length(sums) {
            sums.close_block();
        }
    }

    /// Takes the next samples. What is not finite or out of range is found by [`StreamingSine::fit`].
    pub fn push_slice<S: Sample, const B: usize>(&self, sums: &mut BlockSums<S, B>, mut samples: &[S]) {
        let Some(first) = samples.first() else {
            return;
        };
        // Sums are of differences from the first sample: a dc far above the amplitude costs no digits.
        let reference = *sums.reference.get_or_insert(*first);
        while !samples.is_empty() {
            let length = self.block_length(sums);
            let room = usize::try_from(length.saturating_sub(sums.filled)).unwrap_or(usize::MAX);
            let (now, later) = samples.split_at(room.min(samples.len()));
            let (phase, in_range) =
                S::accumulate(now, reference, sums.phase, self.nco.word(), &mut sums.current, &mut sums.power);
            sums.phase = phase;
            sums.in_range &= in_range;
            sums.filled += now.len() as u64;
            if sums.filled >= length {
                sums.close_block();
            }
            samples = later;
        }
    }

    /// The block length in samples. It stays below 2⁶³: 2³⁰ at first, and a doubling takes longer each time.
    fn block_length<S: Sample, const B: usize>(&self, sums: &BlockSums<S, B>) -> u64 {
        self.first_block << sums.doublings.min(32)
    }

    /// Solves for the sine. `sums` is left as it is: more samples may follow.
    ///
    /// Frequencies from half to twice ω0 are searched, as far as the blocks resolve them.
    ///
    /// # Errors
    /// [`SineError`] refuses too few samples or cycles, values that are not finite, saturated integers, and a constant
    /// signal. It also refuses a frequency on the edge of the search range, and an ω0 too far off
    /// ([`SineError::Recentre`], if B < 8·M·|ε|).
    pub fn fit<S: Sample, const B: usize>(&self, sums: &BlockSums<S, B>) -> Result<SineFit<R>, SineError> {
        let length = self.block_length(sums);
        let samples = (sums.full as u64).saturating_mul(length).saturating_add(sums.filled);
        let (Some(reference), false) = (sums.reference, samples < FEWEST_SAMPLES) else {
            return Err(SineError::TooFewSamples { samples: samples as usize, needed: FEWEST_SAMPLES as usize });
        };
        if !sums.in_range {
            return Err(SineError::Saturated);
        }
        // A short last block would be all but singular: it is added to its neighbour.
        let alone = sums.filled >= SHORTEST_BLOCK && 2 * sums.filled >= length;
        let mut blocks = [Block::<R>::default(); B];
        let mut used = 0;
        for (i, (block, stored)) in blocks.iter_mut().zip(&sums.blocks).enumerate() {
            let start = (i as u64).saturating_mul(length);
            if i < sums.full {
                let mut total = *stored;
                let mut size = length;
                if i + 1 == sums.full && !alone {
                    // The sum stays in its range: it is at most that of the record, and the blocks are parts of it.
                    if !S::merge(&mut total, &sums.current) {
                        return Err(SineError::Saturated);
                    }
                    size += sums.filled;
                }
                *block = Block::new(self.nco, start, size, S::read(&total));
            } else if i == sums.full && alone {
                *block = Block::new(self.nco, start, sums.filled, S::read(&sums.current));
            } else {
                break;
            }
            used += 1;
        }
        let record = solve::Record {
            nco: self.nco,
            sample_period_s: self.sample_period_s,
            samples,
            power: S::read_power(&sums.power),
            reference: reference.to_real(),
            capacity: B,
            doubled: sums.doublings > 0,
        };
        solve::fit(&record, blocks.get_mut(..used).unwrap_or_default())
    }
}

#[cfg(test)]
mod tests;
