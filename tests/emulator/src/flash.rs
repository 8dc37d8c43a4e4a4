//! The flash's rules of programming (RM0440, embedded flash memory), for the two pages of the settings.

use std::collections::BTreeSet;

use crate::store::Store;

/// Where its registers are.
pub const FLASH: u32 = 0x4002_2000;
/// The settings' pages in memory.
pub const PAGES: std::ops::Range<u32> = 0x0807_f000..0x0808_0000;
/// Bytes of a page, with two banks.
pub const PAGE: u32 = 2048;
/// Number of the first of them in bank 2.
const FIRST_PAGE: u32 = 126;
const ACR: u32 = 0x00;
const KEYR: u32 = 0x08;
const SR: u32 = 0x10;
const CR: u32 = 0x14;
const ECCR: u32 = 0x18;
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];
const BUSY: u32 = 1 << 16;
const PG: u32 = 1;
const PER: u32 = 1 << 1;
const BKER: u32 = 1 << 11;
const START: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;
const DATA_CACHE: u32 = 1 << 10;
const DATA_CACHE_RESET: u32 = 1 << 12;
/// `ECCR`: two bits of a word are wrong.
const ECC_DETECTED: u32 = 1 << 31;
/// Cycles for 8 bytes and for a page: 82 µs and 22 ms (DS12288, flash memory characteristics).
const PROGRAM_CYCLES: u64 = 82 * 170;
const ERASE_CYCLES: u64 = 22_000 * 170;
const ERASED: u8 = 0xff;

/// What is stored, and what has been done to it.
#[derive(Clone, Debug)]
pub struct Cells {
    /// The two pages.
    pub bytes: Vec<u8>,
    /// Offsets of the words of 8 bytes that power has left half programmed.
    pub half_written: BTreeSet<usize>,
}

/// The flash.
#[derive(Debug)]
pub struct Flash {
    /// What a reset leaves.
    pub cells: Cells,
    /// The cells as they would be had power been cut in the middle of each operation, in order.
    pub cuts: Vec<Cells>,
    keys: usize,
    busy_until: u64,
    first_half: Option<(u32, u32)>,
}

impl Cells {
    /// Erased.
    pub fn blank() -> Self {
        Self { bytes: vec![ERASED; PAGES.len()], half_written: BTreeSet::new() }
    }
}

impl Flash {
    /// With these cells.
    pub fn new(cells: Cells) -> Self {
        Self { cells, cuts: Vec::new(), keys: 0, busy_until: 0, first_half: None }
    }

    /// A system reset.
    pub fn reset(&mut self) {
        (self.keys, self.busy_until, self.first_half) = (0, 0, None);
    }

    /// A register.
    pub fn read(&self, offset: u32, now: u64, store: &Store) -> u32 {
        let value = store.get(FLASH + offset);
        if offset == SR && now < self.busy_until { value | BUSY } else { value }
    }

    /// A write of a register.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn write(&mut self, offset: u32, value: u32, now: u64, store: &mut Store) -> Result<(), String> {
        let before = store.get(FLASH + offset);
        let locked = store.get(FLASH + CR) & LOCK != 0;
        let value = match offset {
            KEYR => {
                if KEYS.get(self.keys) != Some(&value) || !locked {
                    return Err("the wrong key: the flash stays locked until the next reset".into());
                }
                self.keys = (self.keys + 1) % KEYS.len();
                if self.keys == 0 {
                    store.put(FLASH + CR, LOCK, false);
                }
                return Ok(());
            }
            SR | ECCR => before & !value,
            CR if locked && value & !LOCK != before & !LOCK => {
                return Err("it is written while the flash is locked".into());
            }
            CR if now < self.busy_until => return Err("it is written while the flash is busy".into()),
            CR if value & LOCK != 0 => before & (1 << 30) | LOCK,
            CR => {
                if value & START != 0 {
                    self.erase(value, now, store)?;
                }
                value & !START
            }
            ACR if value & DATA_CACHE_RESET != 0 && value & DATA_CACHE != 0 => {
                return Err("the data cache is reset while it is on".into());
            }
            _ => value,
        };
        store.set(FLASH + offset, value);
        Ok(())
    }

    fn erase(&mut self, control: u32, now: u64, store: &Store) -> Result<(), String> {
        let page = (control >> 3) & 0x7f;
        if control & PER == 0 || control & PG != 0 {
            return Err("erasing starts without PER, or with PG".into());
        }
        if control & BKER == 0 || !(FIRST_PAGE..FIRST_PAGE + 2).contains(&page) {
            return Err(format!("page {page} is erased, which is not one of the settings'"));
        }
        data_cache_off(store)?;
        let from = ((page - FIRST_PAGE) * PAGE) as usize;
        let page = from..from + PAGE as usize;
        // In the middle of it, cells hold anything.
        let mut cut = self.cells.clone();
        cut.bytes[page.clone()]
            .iter_mut()
            .enumerate()
            .for_each(|(i, byte)| *byte |= if i % 3 == 0 { 0xff } else { 0x5a });
        cut.half_written.retain(|at| !page.contains(at));
        self.cuts.push(cut);
        self.cells.bytes[page.clone()].fill(ERASED);
        self.cells.half_written.retain(|at| !page.contains(at));
        self.busy_until = now + ERASE_CYCLES;
        Ok(())
    }

    /// A write to the cells: two words make one operation.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn program(&mut self, address: u32, bytes: u32, value: u32, now: u64, store: &Store) -> Result<(), String> {
        let control = store.get(FLASH + CR);
        if control & LOCK != 0 || control & PG == 0 {
            return Err("the cells are written without unlocking, or without PG".into());
        }
        if now < self.busy_until {
            return Err("the cells are written while the flash is busy".into());
        }
        if bytes != 4 || !address.is_multiple_of(4) {
            return Err("the cells are written in other parts than words".into());
        }
        data_cache_off(store)?;
        let Some((first, low)) = self.first_half.take() else {
            if !address.is_multiple_of(8) {
                return Err("the second half of 8 bytes is written before the first".into());
            }
            self.first_half = Some((address, value));
            return Ok(());
        };
        if address != first + 4 {
            return Err("the second half of 8 bytes is not written after the first".into());
        }
        let at = (first - PAGES.start) as usize;
        if self.cells.bytes[at..at + 8].iter().any(|byte| *byte != ERASED) || self.cells.half_written.contains(&at) {
            return Err(format!("the 8 bytes at {first:#010x} are programmed twice between erases"));
        }
        let word: Vec<u8> = low.to_le_bytes().into_iter().chain(value.to_le_bytes()).collect();
        let mut cut = self.cells.clone();
        cut.bytes[at..at + 8].iter_mut().zip(&word).for_each(|(cell, byte)| *cell = byte | 0x55);
        cut.half_written.insert(at);
        self.cuts.push(cut);
        self.cells.bytes[at..at + 8].copy_from_slice(&word);
        self.busy_until = now + PROGRAM_CYCLES;
        Ok(())
    }

    /// A read of the cells; the second is whether error correction has found more than it can correct, which is an NMI.
    ///
    /// # Errors
    /// The rule that it breaks.
    pub fn fetch(&self, address: u32, bytes: u32, now: u64, store: &mut Store) -> Result<(u32, bool), String> {
        if now < self.busy_until {
            return Err("bank 2 is read while it is busy: the core would stand still".into());
        }
        let at = (address - PAGES.start) as usize;
        let value = (0..bytes as usize).rev().fold(0, |value, i| value << 8 | u32::from(self.cells.bytes[at + i]));
        let wrong = self.cells.half_written.contains(&(at & !7));
        if wrong {
            store.put(FLASH + ECCR, ECC_DETECTED, true);
        }
        Ok((value, wrong))
    }
}

/// The data cache may be corrupted while one bank is read and the other written (errata ES0430).
fn data_cache_off(store: &Store) -> Result<(), String> {
    if store.get(FLASH + ACR) & DATA_CACHE == 0 { Ok(()) } else { Err("the data cache is on (ES0430)".into()) }
}
