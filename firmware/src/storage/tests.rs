use breakaway_core::link::{FaultCause, Model, Settings};
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, ReadNorFlash};
use std::vec;
use std::vec::Vec;

use super::{FlashStore, Loaded, Store};

/// Two pages of a flash that programs words of 8 bytes, as the STM32G4's.
#[derive(Clone)]
struct Ram(Vec<u8>);

const PAGE: usize = 2048;

impl ErrorType for &mut Ram {
    type Error = core::convert::Infallible;
}
impl ReadNorFlash for &mut Ram {
    const READ_SIZE: usize = 1;
    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        bytes.copy_from_slice(&self.0[offset as usize..][..bytes.len()]);
        Ok(())
    }
    fn capacity(&self) -> usize {
        self.0.len()
    }
}
impl NorFlash for &mut Ram {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE;
    async fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        self.0[from as usize..to as usize].fill(0xff);
        Ok(())
    }
    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        for (cell, byte) in self.0[offset as usize..].iter_mut().zip(bytes) {
            *cell &= byte;
        }
        Ok(())
    }
}

fn blank() -> Ram {
    Ram(vec![0xff; 2 * PAGE])
}

fn store(ram: &mut Ram) -> FlashStore<&mut Ram> {
    FlashStore::new(ram, 0..2 * PAGE as u32).unwrap()
}

fn settings(n: u32) -> Settings {
    Settings { frozen_ticks: 1 + n, ..Settings::default() }
}

fn model(n: u32) -> Option<Model> {
    (!n.is_multiple_of(3)).then(|| Model { b: 0.1 + n as f32, c: 0.2, f1: 0.3, effects: heapless::Vec::new() })
}

#[test]
fn what_was_saved_last_is_loaded_over_many_saves() {
    let mut ram = blank();
    assert_eq!(store(&mut ram).load(settings(0)), Loaded::defaults(settings(0)));
    // 200 saves of about 150 bytes go round both pages several times.
    for n in 1..200 {
        let mut open = store(&mut ram);
        open.load(settings(0));
        open.save(&settings(n), model(n).as_ref()).unwrap();
        let expected = Loaded { settings: settings(n), model: model(n), lost: None };
        assert_eq!(store(&mut ram).load(settings(0)), expected, "save {n}");
    }
}

#[test]
fn a_damaged_image_is_defaults_and_a_fault_or_what_was_saved() {
    let mut good = blank();
    for n in 1..5 {
        let mut open = store(&mut good);
        open.load(settings(0));
        open.save(&settings(n), model(n).as_ref()).unwrap();
    }
    let saved = Loaded { settings: settings(4), model: model(4), lost: None };
    let mut lost = 0;
    // Each byte of the first page turned over, one at a time: never an older or a wrong value without a word.
    for at in 0..PAGE {
        let mut damaged = good.clone();
        damaged.0[at] ^= 0x5a;
        let loaded = store(&mut damaged).load(settings(0));
        if loaded == saved {
            continue;
        }
        lost += 1;
        match loaded.lost {
            Some((FaultCause::SettingsLost, _)) => assert_eq!((&loaded.settings, &loaded.model), (&settings(0), &None)),
            Some((FaultCause::ModelLost, _)) => assert_eq!((&loaded.settings, &loaded.model), (&settings(4), &None)),
            other => panic!("byte {at}: {other:?} with {loaded:?}"),
        }
    }
    // The three items in force have more than 60 bytes of content between them.
    assert!(lost > 60, "only {lost} bytes matter");
}

#[test]
fn a_blank_flash_and_noise_are_told_apart() {
    let mut noise = Ram((0..2 * PAGE as u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8).collect());
    assert_eq!(store(&mut noise).load(settings(0)).lost, Some((FaultCause::SettingsLost, -1)));
    assert_eq!(store(&mut blank()).load(settings(0)).lost, None);
    assert!(FlashStore::new(&mut blank(), 0..PAGE as u32).is_none(), "one page is not enough");
}
