use std::vec::Vec;

use breakaway_core::link::Settings;
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

use super::{PAGE_BYTES, pages};
use crate::board::pico2::constants::{FLASH_BYTES, SECTOR_BYTES, SETTINGS_AT, SETTINGS_BYTES};
use crate::storage::{FlashStore, Loaded, Store};

/// The flash as the boot ROM programs it: whole pages, which only clear bits, and whole sectors.
struct Paged(Vec<u8>);

impl Paged {
    fn blank() -> Self {
        Self(std::vec![0xff; SETTINGS_BYTES as usize])
    }
    fn program(&mut self, start: u32, page: &[u8; PAGE_BYTES]) {
        assert!(start.is_multiple_of(PAGE_BYTES as u32), "{start}");
        let cells = &mut self.0[start as usize..][..PAGE_BYTES];
        cells.iter_mut().zip(page).for_each(|(cell, byte)| *cell &= byte);
    }
}

impl ErrorType for Paged {
    type Error = core::convert::Infallible;
}
impl ReadNorFlash for Paged {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        bytes.copy_from_slice(&self.0[offset as usize..][..bytes.len()]);
        Ok(())
    }
    fn capacity(&self) -> usize {
        self.0.len()
    }
}
impl NorFlash for Paged {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = SECTOR_BYTES as usize;
    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.0[from as usize..to as usize].fill(0xff);
        Ok(())
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        pages(offset, bytes).for_each(|(start, page)| self.program(start, &page));
        Ok(())
    }
}

/// Whatever is written, from one byte to more than two pages, at any place of a page: it is there, and nothing else is.
#[test]
fn what_is_written_is_there_and_nothing_else() {
    let bytes: Vec<u8> = (0..600_u32).map(|i| (i * 7 + 1) as u8).collect();
    for at in (0..300).step_by(13).chain([255, 256, 257]) {
        for length in [0, 1, 8, 255, 256, 257, 600] {
            let mut flash = Paged::blank();
            flash.write(at, &bytes[..length]).unwrap();
            let (at, end) = (at as usize, at as usize + length);
            assert_eq!(flash.0[at..end], bytes[..length], "{length} at {at}");
            assert!(flash.0[..at].iter().chain(&flash.0[end..]).all(|cell| *cell == 0xff), "{length} at {at}");
        }
    }
}

/// The store on such pages: a record longer than a page, and marks that are programmed into pages that are full.
#[test]
fn settings_are_kept_over_many_saves() {
    let settings = |n: u32| Settings { frozen_ticks: 1 + n, ..Settings::default() };
    let mut store = FlashStore::new(Paged::blank(), 0..SETTINGS_BYTES).expect("two sectors");
    assert_eq!(store.load(settings(0)), Loaded::defaults(settings(0)));
    for n in 1..20 {
        store.save(&settings(n), None).unwrap();
        assert_eq!(store.load(settings(0)).settings, settings(n));
    }
}

/// Whole sectors, inside of the flash, and not the last one, which others write to.
#[test]
fn the_settings_are_before_the_last_sector() {
    assert!(SETTINGS_AT.is_multiple_of(SECTOR_BYTES));
    assert_eq!(SETTINGS_AT + SETTINGS_BYTES, FLASH_BYTES - SECTOR_BYTES);
}
