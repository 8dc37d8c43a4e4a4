//! The image of settings and model in flash: never a panic, never values out of range, before and after a save over it.

use std::convert::Infallible;

use breakaway_core::link::{FaultCause, Model, Settings, WireEffect};
use breakaway_core::plant::{Effect, Kind};
use breakaway_firmware::storage::{FlashStore, Loaded, Store};
use embedded_storage::nor_flash::{ErrorType, NorFlash, ReadNorFlash};

/// Bytes of an erase page: small, so that most of an image matters.
pub const PAGE: usize = 512;

/// A flash of two pages that programs words of 8 bytes, as the STM32G4's.
struct Ram(Vec<u8>);

impl ErrorType for &mut Ram {
    type Error = Infallible;
}

impl ReadNorFlash for &mut Ram {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Infallible> {
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
    fn erase(&mut self, from: u32, to: u32) -> Result<(), Infallible> {
        self.0[from as usize..to as usize].fill(0xff);
        Ok(())
    }
    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Infallible> {
        for (cell, byte) in self.0[offset as usize..].iter_mut().zip(bytes) {
            *cell &= byte;
        }
        Ok(())
    }
}

fn open(ram: &mut Ram) -> FlashStore<&mut Ram> {
    FlashStore::new(ram, 0..2 * PAGE as u32).unwrap()
}

/// Loads from the image (erased beyond the input), saves over it, loads again.
///
/// # Panics
/// Where a promise is broken.
pub fn run(bytes: &[u8]) -> bool {
    let mut image = bytes.to_vec();
    image.resize(2 * PAGE, 0xff);
    let mut ram = Ram(image);
    let defaults = Settings { frozen_ticks: 4321, ..Settings::default() };
    let settings = Settings { frozen_ticks: 1234, ..Settings::default() };
    let (loaded, saved) = {
        let mut store = open(&mut ram);
        let loaded = store.load(defaults);
        sound(&loaded, defaults);
        let saved = store.save(&settings, loaded.model.as_ref());
        (loaded, saved)
    };
    let again = open(&mut ram).load(defaults);
    sound(&again, defaults);
    if saved.is_ok() {
        assert_eq!(again, Loaded { settings, model: loaded.model, lost: None });
    }
    loaded.lost.is_none()
}

/// Images of boards that have saved once, with and without a model, and often.
///
/// # Panics
/// Where saving fails.
pub fn images() -> Vec<(&'static str, Vec<u8>)> {
    let effect = Effect::<f64>::new(Kind::Stribeck, &[0.3, 0.5]);
    let model = Model { b: 0.1, c: 0.2, f1: 0.3, effects: [WireEffect::new(&effect)].into_iter().collect() };
    [("settings", 1, None), ("model", 1, Some(&model)), ("often", 9, Some(&model))]
        .into_iter()
        .map(|(name, saves, model)| {
            let mut ram = Ram(vec![0xff; 2 * PAGE]);
            for _ in 0..saves {
                let mut store = open(&mut ram);
                store.load(Settings::default());
                store.save(&Settings::default(), model).unwrap();
            }
            (name, ram.0)
        })
        .collect()
}

/// What the application may rely on.
fn sound(loaded: &Loaded, defaults: Settings) {
    assert_eq!(loaded.settings.validate(), Ok(()));
    assert!(loaded.model.as_ref().is_none_or(|model| model.validate().is_ok()));
    match loaded.lost {
        None => {}
        Some((FaultCause::SettingsLost, _)) => assert_eq!((loaded.settings, &loaded.model), (defaults, &None)),
        Some((FaultCause::ModelLost, _)) => assert_eq!(loaded.model, None),
        Some(other) => panic!("{other:?}"),
    }
}
