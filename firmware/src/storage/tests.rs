use breakaway_core::link::{EffectId, FaultCause, Model, Settings, WireEffect, checksum};
use breakaway_core::plant::MAX_EFFECTS;
use breakaway_core::plant::effect::MAX_PARAMETERS;
use breakaway_rig::ALWAYS;
use std::vec::Vec;

use super::{FlashStore, Loaded, Store};

const PAGE: usize = 2048;
type Ram = breakaway_rig::Ram<PAGE>;

fn blank() -> Ram {
    Ram::new(Vec::new())
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
    // The pages take turns.
    for n in 1..200 {
        let mut open = store(&mut ram);
        open.load(settings(0));
        open.save(&settings(n), model(n).as_ref()).unwrap();
        let expected = Loaded { settings: settings(n), model: model(n), lost: None, zero_needed: false };
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
    let saved = Loaded { settings: settings(4), model: model(4), lost: None, zero_needed: false };
    let mut lost = 0;
    // Each byte turned over, one at a time: never an older or a wrong value without a word.
    for at in 0..2 * PAGE {
        let mut damaged = good.clone();
        damaged.cells[at] ^= 0x5a;
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
    // The record in force has more than 60 bytes of content.
    assert!(lost > 60, "only {lost} bytes matter");
}

#[test]
fn a_blank_flash_and_noise_are_told_apart() {
    let mut noise = Ram::new((0..2 * PAGE as u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8).collect());
    assert_eq!(store(&mut noise).load(settings(0)).lost, Some((FaultCause::SettingsLost, -1)));
    assert_eq!(store(&mut blank()).load(settings(0)).lost, None);
    assert!(FlashStore::new(&mut blank(), 0..PAGE as u32).is_none(), "one page is not enough");
}

#[test]
fn power_cut_anywhere_in_a_save_leaves_what_was_there_or_what_is_new_and_the_next_save_works() {
    for saves in 1..4 {
        let mut before = blank();
        for n in 1..=saves {
            let mut open = store(&mut before);
            open.load(settings(0));
            open.save(&settings(n), model(n).as_ref()).unwrap();
        }
        let old = Loaded { settings: settings(saves), model: model(saves), lost: None, zero_needed: false };
        let new = Loaded { settings: settings(50), model: model(50), lost: None, zero_needed: false };
        let mut news = 0;
        // A save over a page that was used erases its 2048 bytes, then writes under 200.
        for power in 0..PAGE + 200 {
            let mut ram = before.clone();
            let saved = {
                let mut open = store(&mut ram);
                open.load(settings(0));
                open.flash().power = power;
                open.save(&settings(50), model(50).as_ref())
            };
            ram.power = ALWAYS;
            let found = store(&mut ram).load(settings(0));
            assert!(found == old && saved.is_err() || found == new, "{power}: {saved:?}, {found:?}");
            news += usize::from(found == new);
            // What start-up found it finds again, also where it has put the older record out of force.
            assert_eq!(store(&mut ram).load(settings(0)), found, "{power}");
            let mut open = store(&mut ram);
            open.load(settings(0));
            open.save(&settings(60), None).unwrap();
            let last = Loaded { settings: settings(60), model: None, lost: None, zero_needed: false };
            assert_eq!(store(&mut ram).load(settings(0)), last, "{power}");
        }
        assert!((1..PAGE + 200).contains(&news), "{news} of the cuts were after the record");
    }
}

#[test]
fn a_record_of_another_version_is_lost_and_its_version_said() {
    let mut ram = blank();
    store(&mut ram).save(&settings(1), None).unwrap();
    // Mark, version, length, sequence; the CRC stands behind the content.
    ram.cells[8..10].copy_from_slice(&77_u16.to_le_bytes());
    let end = 16 + usize::from(u16::from_le_bytes([ram.cells[10], ram.cells[11]]));
    let crc = checksum(&ram.cells[8..end]);
    ram.cells[end..end + 4].copy_from_slice(&crc.to_le_bytes());
    assert_eq!(store(&mut ram).load(settings(0)).lost, Some((FaultCause::SettingsLost, 77)));
}

#[test]
fn the_largest_settings_and_model_fit_a_record() {
    // Numbers take as many bytes as they are large.
    let settings = Settings {
        drive_max_code: i16::MIN,
        travel_min_counts: i32::MIN,
        travel_max_counts: i32::MIN,
        speed_max_counts_per_s: u32::MAX,
        current_max_ma: u32::MAX,
        mean_drive_max_code: i16::MIN,
        frozen_ticks: u32::MAX,
        frozen_drive_code: i16::MIN,
        jump_counts: u32::MAX,
        overrun_limit: u8::MAX,
        command_timeout_ms: u32::MAX,
        hysteresis_counts: u32::MAX,
        counts_per_revolution: u32::MAX,
        ..Settings::default()
    };
    let effect = WireEffect { id: EffectId(u32::MAX), parameters: [0.1; MAX_PARAMETERS].into_iter().collect() };
    let effects = core::iter::repeat_n(effect, MAX_EFFECTS).collect();
    let model = Model { b: 0.1, c: 0.2, f1: 0.3, effects };
    assert_eq!(store(&mut blank()).save(&settings, Some(&model)), Ok(()));
}

/// Travel limits that are saved count from a zero that a reset loses; those that the board has anyway do not.
#[test]
fn saved_travel_limits_need_a_zero() {
    for (travel_max_counts, zero_needed) in [(9_000, true), (Settings::default().travel_max_counts, false)] {
        let mut ram = blank();
        let settings = Settings { travel_max_counts, ..settings(3) };
        let mut open = store(&mut ram);
        open.load(Settings::default());
        open.save(&settings, None).unwrap();
        let loaded = store(&mut ram).load(Settings::default());
        assert_eq!((loaded.settings, loaded.zero_needed), (settings, zero_needed));
    }
}
