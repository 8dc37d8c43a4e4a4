//! Bytes flipped, lost and made up on the way, and which frames that hits.

use rand::{Rng as _, RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Longest piece of garbage, bytes.
const LONGEST_GARBAGE: usize = 16;

/// What has passed one way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Bytes that were sent.
    pub bytes: u64,
    /// Bytes of them with a bit flipped.
    pub flipped: u64,
    /// Bytes of them that were lost.
    pub dropped: u64,
    /// Pieces of garbage put before one of them.
    pub inserted: u64,
    /// Frames that were sent: bytes up to a zero.
    pub frames: u64,
    /// Of those, how many may not have arrived: hit themselves, or begun in garbage or in one whose end was hit.
    pub hit: u64,
}

impl Counts {
    /// What has come since `before`.
    #[must_use]
    pub fn since(&self, before: Self) -> Self {
        Self {
            bytes: self.bytes - before.bytes,
            flipped: self.flipped - before.flipped,
            dropped: self.dropped - before.dropped,
            inserted: self.inserted - before.inserted,
            frames: self.frames - before.frames,
            hit: self.hit - before.hit,
        }
    }
}

/// The noise of one direction.
pub(super) struct Noise {
    random: ChaCha8Rng,
    /// So far.
    pub(super) counts: Counts,
    /// Bytes of the frame under way.
    length: u64,
    /// The frame under way is hit.
    hit: bool,
}

impl Noise {
    pub(super) fn new(seed: u64) -> Self {
        Self { random: ChaCha8Rng::seed_from_u64(seed), counts: Counts::default(), length: 0, hit: false }
    }

    /// Appends to `out` what arrives of `bytes`; of a million of them `ppm` are hit.
    pub(super) fn transmit(&mut self, bytes: &[u8], ppm: u32, out: &mut Vec<u8>) {
        for &byte in bytes {
            self.counts.bytes += 1;
            let hit = ppm > 0 && self.random.random_range(0..1_000_000) < ppm;
            if hit {
                self.damage(byte, out);
            } else {
                out.push(byte);
            }
            self.hit |= hit;
            if byte != 0 {
                self.length += 1;
                continue;
            }
            if core::mem::take(&mut self.length) > 0 {
                self.counts.frames += 1;
                self.counts.hit += u64::from(self.hit);
            }
            // Without its end a frame takes the next one with it.
            self.hit = hit;
        }
    }

    fn damage(&mut self, byte: u8, out: &mut Vec<u8>) {
        match self.random.random_range(0..3) {
            0 => {
                self.counts.flipped += 1;
                out.push(byte ^ (1 << self.random.random_range(0..8)));
            }
            1 => self.counts.dropped += 1,
            _ => {
                self.counts.inserted += 1;
                let mut garbage = [0; LONGEST_GARBAGE];
                let length = self.random.random_range(1..=LONGEST_GARBAGE);
                self.random.fill_bytes(&mut garbage[..length]);
                out.extend(&garbage[..length]);
                out.push(byte);
            }
        }
    }
}
