//! The store on a NOR flash: two erase pages that take turns.
//!
//! A page holds one record:
//! `mark ‖ version ‖ length ‖ sequence ‖ settings and model (postcard) ‖ CRC-32 of all behind the mark`, numbers
//! little endian. A save writes the whole record to the page that is not in force, and reads it back. Only then it
//! programs the other page's mark, which puts that page out of force. The next save erases it. This has two effects.
//! - A power cut leaves the record from before, or the new one. Of two in force the one with the later sequence number
//!   counts, and reading them marks the other.
//! - A record that is damaged later has none beside it that could pass for it. It is lost, and reported as lost.

use core::ops::Range;

use breakaway_core::link::{FaultCause, Model, Settings, checksum};
use embedded_storage::nor_flash::NorFlash;

use super::{Loaded, Store, StoreError, VERSION};

/// Longest record with its mark: settings, and a model with all its effects.
const RECORD: usize = 288;
/// Bytes of the mark, the flash's widest word: erased while the record is in force.
const MARK: usize = 8;
const IN_FORCE: [u8; MARK] = [0xff; MARK];
/// Version, length of the content, sequence number.
const HEAD: usize = 8;
const CRC: usize = 4;

/// Settings and model in two erase pages of a flash.
pub struct FlashStore<F: NorFlash> {
    flash: F,
    start: u32,
    /// What is in force: page and sequence number.
    kept: Option<(u32, u32)>,
}

/// A record that is whole and in force.
struct Record<'b> {
    version: u16,
    sequence: u32,
    content: &'b [u8],
}

impl<F: NorFlash> FlashStore<F> {
    /// The store in the first two pages of `range` of `flash`. `None` unless `range` begins with two whole erase pages,
    /// each of which takes a record. Also `None` where the flash programs words that do not divide 8 bytes.
    pub fn new(flash: F, range: Range<u32>) -> Option<Self> {
        let page = F::ERASE_SIZE as u32;
        let fits = range.start.is_multiple_of(page) && range.end.checked_sub(range.start)? >= 2 * page;
        let fits = fits && RECORD <= F::ERASE_SIZE && MARK.is_multiple_of(F::WRITE_SIZE);
        fits.then_some(Self { flash, start: range.start, kept: None })
    }

    /// Reads what is kept; where that cannot be used, `defaults` and what was lost.
    #[inline(never)]
    pub fn load(&mut self, defaults: Settings) -> Loaded {
        let lost = |cause, found| Loaded { lost: Some((cause, found)), ..Loaded::defaults(defaults) };
        let mut bytes = [0; RECORD];
        let mut other_version = None;
        self.kept = None;
        for page in [0, 1] {
            let Some(Record { version, sequence, .. }) = self.record(page, &mut bytes) else {
                continue;
            };
            if version != VERSION {
                other_version = Some(version);
                continue;
            }
            match self.kept {
                Some((_, later)) if (sequence.wrapping_sub(later) as i32) <= 0 => self.put_out_of_force(page),
                Some((earlier, _)) => {
                    self.put_out_of_force(earlier);
                    self.kept = Some((page, sequence));
                }
                None => self.kept = Some((page, sequence)),
            }
        }
        let Some((page, _)) = self.kept else {
            return match other_version {
                Some(version) => lost(FaultCause::SettingsLost, i32::from(version)),
                None if self.blank(0) && self.blank(1) => Loaded::defaults(defaults),
                None => lost(FaultCause::SettingsLost, -1),
            };
        };
        let content = self.record(page, &mut bytes).map_or(&[][..], |record| record.content);
        let Some((settings, rest)) = settings(content) else {
            return lost(FaultCause::SettingsLost, -1);
        };
        let zero_needed = !settings.same_travel(&defaults);
        match model(rest) {
            Ok(model) => Loaded { settings, model, lost: None, zero_needed },
            Err(()) => Loaded { settings, zero_needed, ..lost(FaultCause::ModelLost, -1) },
        }
    }

    #[cfg(test)]
    pub(super) fn flash(&mut self) -> &mut F {
        &mut self.flash
    }

    fn at(&self, page: u32) -> u32 {
        self.start + page * F::ERASE_SIZE as u32
    }

    /// The record in a page; `None` if there is none that is whole and in force.
    #[inline(never)]
    fn record<'b>(&mut self, page: u32, bytes: &'b mut [u8; RECORD]) -> Option<Record<'b>> {
        self.flash.read(self.at(page), bytes).ok()?;
        let (mark, record) = bytes.split_first_chunk()?;
        let ([v0, v1, l0, l1, s0, s1, s2, s3], rest) = record.split_first_chunk::<HEAD>()?;
        let length = usize::from(u16::from_le_bytes([*l0, *l1]));
        let (content, rest) = rest.split_at_checked(length)?;
        let crc = u32::from_le_bytes(*rest.first_chunk()?);
        let whole = *mark == IN_FORCE && checksum(record.get(..HEAD + length)?) == crc;
        let (version, sequence) = (u16::from_le_bytes([*v0, *v1]), u32::from_le_bytes([*s0, *s1, *s2, *s3]));
        whole.then_some(Record { version, sequence, content })
    }

    /// Where that fails, the record of the later sequence number counts all the same.
    fn put_out_of_force(&mut self, page: u32) {
        let _ = self.flash.write(self.at(page), &[0; MARK]);
    }

    /// Whether nothing is written in a page. What cannot be read is not blank.
    #[inline(never)]
    fn blank(&mut self, page: u32) -> bool {
        let mut word = [0; MARK];
        let page = self.at(page);
        (page..page + F::ERASE_SIZE as u32)
            .step_by(MARK)
            .all(|at| self.flash.read(at, &mut word).is_ok() && word == IN_FORCE)
    }
}

fn settings(content: &[u8]) -> Option<(Settings, &[u8])> {
    let (settings, rest) = postcard::take_from_bytes::<Settings>(content).ok()?;
    settings.validate().ok().map(|()| (settings, rest))
}

fn model(content: &[u8]) -> Result<Option<Model>, ()> {
    let (model, rest) = postcard::take_from_bytes::<Option<Model>>(content).map_err(|_| ())?;
    let usable = rest.is_empty() && model.as_ref().is_none_or(|model| model.validate().is_ok());
    if usable { Ok(model) } else { Err(()) }
}

/// Writes a record; the bytes of it and its mark, as many as whole words take.
#[inline(never)]
fn write(
    bytes: &mut [u8; RECORD],
    settings: &Settings,
    model: Option<&Model>,
    sequence: u32,
) -> Result<usize, StoreError> {
    let (_, record) = bytes.split_first_chunk_mut::<MARK>().ok_or(StoreError)?;
    let (head, room) = record.split_first_chunk_mut::<HEAD>().ok_or(StoreError)?;
    let length = postcard::to_slice(&(settings, model), room).map_err(|_| StoreError)?.len();
    let ([v0, v1], [l0, l1]) = (VERSION.to_le_bytes(), (length as u16).to_le_bytes());
    let [s0, s1, s2, s3] = sequence.to_le_bytes();
    *head = [v0, v1, l0, l1, s0, s1, s2, s3];
    let (covered, rest) = record.split_at_mut_checked(HEAD + length).ok_or(StoreError)?;
    *rest.first_chunk_mut::<CRC>().ok_or(StoreError)? = checksum(covered).to_le_bytes();
    Ok((MARK + HEAD + length + CRC).next_multiple_of(MARK))
}

impl<F: NorFlash> Store for FlashStore<F> {
    #[inline(never)]
    fn save(&mut self, settings: &Settings, model: Option<&Model>) -> Result<(), StoreError> {
        let (page, sequence) = self.kept.map_or((0, 0), |(page, sequence)| (1 - page, sequence.wrapping_add(1)));
        let mut bytes = [0xff; RECORD];
        let used = write(&mut bytes, settings, model, sequence)?;
        let at = self.at(page);
        if !self.blank(page) {
            self.flash.erase(at, at + F::ERASE_SIZE as u32).map_err(|_| StoreError)?;
        }
        let record = bytes.get(MARK..used).ok_or(StoreError)?;
        self.flash.write(at + MARK as u32, record).map_err(|_| StoreError)?;
        // On cells that are not as erased as they look a write ends well and something else stands there.
        let written = bytes.get(..used).ok_or(StoreError)?;
        let mut word = IN_FORCE;
        for (at, expected) in (at..).step_by(MARK).zip(written.chunks(MARK)) {
            self.flash.read(at, &mut word).map_err(|_| StoreError)?;
            if word != *expected {
                return Err(StoreError);
            }
        }
        if let Some((before, _)) = self.kept.replace((page, sequence)) {
            self.put_out_of_force(before);
        }
        Ok(())
    }
}
