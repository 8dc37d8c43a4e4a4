//! Settings and model through resets and restarts, and an image that was corrupted.

use breakaway_core::link::{Command, FaultCause, Model, Reply};

use crate::bench::Bench;

#[test]
fn settings_and_model_are_kept_and_a_corrupt_image_is_reported() {
    needs_qemu!();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("flash.bin");
    let with_flash = |options: &mut breakaway::device::virtual_board::Options| options.flash = Some(file.clone());
    let mut bench = Bench::new(with_flash);
    let defaults = bench.settings();
    let mut settings = defaults;
    settings.jump_counts = 777;
    let model = Model { b: 0.027, c: 0.11, f1: 0.5, effects: heapless::Vec::new() };
    bench.done(Command::SetSettings(settings));
    bench.done(Command::LoadModel(model.clone()));
    assert!(bench.client.status().unwrap().unsaved);
    bench.done(Command::Save);
    assert!(!bench.client.status().unwrap().unsaved);
    bench.reboot();
    assert_eq!(bench.settings(), settings, "after a reset");
    drop(bench);
    let mut bench = Bench::new(with_flash);
    assert_eq!(bench.settings(), settings, "after power was off");
    assert!(matches!(bench.client.request(Command::GetModel), Ok(Reply::Model(Some(found))) if found == model));
    assert_eq!(bench.fault(), None);
    drop(bench);
    let mut bench = Bench::new(|options| {
        with_flash(options);
        options.faults.push("0:corrupt-flash".parse().unwrap());
    });
    assert_eq!(bench.settings(), defaults);
    assert!(matches!(bench.client.request(Command::GetModel), Ok(Reply::Model(None))));
    assert_eq!(bench.fault().map(|record| record.cause), Some(FaultCause::SettingsLost));
}

/// Travel limits that are saved count from a zero that the reset loses: nothing runs before the axis is zeroed. The limits that the
/// board has anyway do not ask for it.
#[test]
fn saved_travel_limits_ask_for_a_zero() {
    needs_qemu!();
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("flash.bin");
    let mut bench = Bench::new(|options| options.flash = Some(file.clone()));
    assert!(!bench.client.status().unwrap().zero_needed);
    let settings = breakaway_core::link::Settings { travel_max_counts: 5_000, ..bench.settings() };
    bench.done(Command::SetSettings(settings));
    bench.done(Command::Save);
    bench.reboot();
    let run = || Command::StartRelay(breakaway_rig::relay(2.0, 1.5, 100));
    let refused = bench.client.done(run()).unwrap_err();
    assert!(refused.to_string().contains("zero"), "{refused}");
    bench.done(Command::Zero { count: 1_000 });
    let status = bench.client.status().unwrap();
    assert_eq!((status.count, status.zero_needed), (1_000, false));
    bench.done(run());
}
