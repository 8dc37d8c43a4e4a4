//! Settings in flash, on the rules of the flash: saved, kept, and cut off in the middle.

use breakaway_core::link::{Command, FaultCause, Model, Reply, Settings};
use breakaway_emulator::bench::{Bench, axis};
use breakaway_emulator::flash::Cells;

use crate::machine::board;

/// Power comes back, with what is in the cells.
fn after_power(cells: Cells) -> Bench {
    Bench::with(&axis(), cells).unwrap_or_else(|error| panic!("{error}"))
}

fn model() -> Model {
    Model { b: 0.027, c: 0.11, f1: 0.5, effects: heapless::Vec::new() }
}

fn save(bench: &mut Bench, jump_counts: u32) -> Settings {
    let mut settings = bench.settings();
    settings.jump_counts = jump_counts;
    bench.done(Command::SetSettings(settings));
    bench.done(Command::LoadModel(model()));
    bench.done(Command::Save);
    settings
}

#[test]
fn settings_and_model_are_kept() {
    needs_unicorn!();
    let mut bench = board();
    let settings = save(&mut bench, 777);
    bench.done(Command::Reboot);
    bench.started();
    assert_eq!(bench.settings(), settings);
    let cells = bench.machine.bus().flash.cells.clone();
    let mut bench = after_power(cells);
    assert_eq!((bench.settings(), bench.fault()), (settings, None));
    assert!(matches!(bench.request(Command::GetModel), Reply::Model(Some(found)) if found == model()));
}

/// Power is cut in the middle of each operation of the third save. A page is half erased, or a word is half programmed, and
/// reading it raises an NMI. There are the old settings or the new, all of them, and no fault.
#[test]
fn power_that_fails_in_the_middle_of_a_save() {
    needs_unicorn!();
    let mut bench = board();
    save(&mut bench, 700);
    let old = save(&mut bench, 701);
    bench.machine.bus().flash.cuts.clear();
    let new = save(&mut bench, 702);
    let cuts = std::mem::take(&mut bench.machine.bus().flash.cuts);
    assert!(cuts.len() > 8, "{} operations", cuts.len());
    let (mut olds, mut news) = (0, 0);
    for (i, cut) in cuts.iter().enumerate() {
        let mut bench = after_power(cut.clone());
        let found = bench.settings();
        assert!(found == old || found == new, "cut {i}: {found:?}");
        assert_eq!(bench.fault(), None, "cut {i}");
        assert!(matches!(bench.request(Command::GetModel), Reply::Model(Some(found)) if found == model()), "cut {i}");
        if found == old { olds += 1 } else { news += 1 }
    }
    assert!(olds > 0 && news > 0, "{olds} times the old settings, {news} times the new");
    println!("{} cuts: {olds} times the old settings, {news} times the new", cuts.len());
}

/// In the very first save there is nothing older: the defaults, and a fault that says so once there is something to be lost.
#[test]
fn power_that_fails_in_the_first_save() {
    needs_unicorn!();
    let mut bench = board();
    let defaults = bench.settings();
    save(&mut bench, 700);
    let cuts = std::mem::take(&mut bench.machine.bus().flash.cuts);
    let mut bench = after_power(cuts[cuts.len() / 2].clone());
    assert_eq!(bench.settings(), defaults);
    assert_eq!(bench.fault().map(|record| record.cause), Some(FaultCause::SettingsLost));
}

/// A bit in every eighth byte is wrong.
#[test]
fn a_damaged_record_is_reported() {
    needs_unicorn!();
    let mut bench = board();
    let defaults = bench.settings();
    save(&mut bench, 700);
    let mut cells = bench.machine.bus().flash.cells.clone();
    cells.bytes.iter_mut().step_by(8).filter(|byte| **byte != 0xff).for_each(|byte| *byte ^= 0x10);
    let mut bench = after_power(cells);
    assert_eq!(bench.settings(), defaults);
    assert_eq!(bench.fault().map(|record| record.cause), Some(FaultCause::SettingsLost));
}
