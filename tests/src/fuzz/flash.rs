//! The image of settings and model in flash: never a panic, never values out of range, before and after a save over it.

use breakaway_core::link::{FaultCause, Model, Settings, WireEffect};
use breakaway_core::plant::{Effect, Kind};
use breakaway_firmware::storage::{FlashStore, Loaded, Store};
use breakaway_rig::Ram;

/// Bytes of an erase page: small, so that most of an image matters.
pub const PAGE: usize = 512;

fn open(ram: &mut Ram<PAGE>) -> FlashStore<&mut Ram<PAGE>> {
    FlashStore::new(ram, 0..2 * PAGE as u32).unwrap()
}

/// Loads from the image (erased beyond the input), saves over it, loads again.
///
/// # Panics
/// Where a promise is broken.
pub fn run(bytes: &[u8]) -> bool {
    let mut ram = Ram::new(bytes.to_vec());
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
        assert_eq!(again, Loaded { settings, model: loaded.model, lost: None, zero_needed: false });
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
            let mut ram = Ram::new(Vec::new());
            for _ in 0..saves {
                let mut store = open(&mut ram);
                store.load(Settings::default());
                store.save(&Settings::default(), model).unwrap();
            }
            (name, ram.cells)
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
