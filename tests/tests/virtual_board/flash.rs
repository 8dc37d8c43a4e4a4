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
