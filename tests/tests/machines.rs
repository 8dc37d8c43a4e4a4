//! The real machines: their files, their splits, and the names of the quick subset. The whole table is
//! `cargo xtask machines` (docs/machines.md).

use breakaway_core::plant::Kind;
use breakaway_tests::machines::catalogue::{AK80, CICESE, EMPS, MACHINES, SO101};
use breakaway_tests::machines::discovery::Said;
use breakaway_tests::machines::reading::{ReadingError, read};
use breakaway_tests::machines::score::{Score, score};
use breakaway_tests::machines::splits::{Split, harder, splits, taken};
use breakaway_tests::machines::{Machine, discovery, drive_free, named, quick};
use breakaway_tests::measured_data;

/// The files that the catalogue knows are in the folder, and each is a recording; SO-101 logs no drive.
#[test]
fn every_file_is_read() {
    let Some(data) = measured_data() else { return };
    for machine in MACHINES.into_iter().filter(|machine| machine.name != SO101.name) {
        let sources = read(machine, &data).unwrap();
        assert_eq!(sources.len(), machine.files, "{}", machine.name);
        for source in &sources {
            assert!(source.recording.is_some(), "{}, {}: {:?}", machine.name, source.file, source.remark);
        }
    }
    assert!(matches!(read(&SO101, &data), Err(ReadingError::NoDrive)));
}

/// Two files repeat the stamps 38.3375 s and 39.3348 s several times; every row before is kept: 2563 and 2631 of them.
#[test]
fn a_clock_that_stops_costs_only_the_repeated_rows() {
    let Some(data) = measured_data() else { return };
    let sources = read(&CICESE, &data).unwrap();
    let rows = ["est_j1_n05_exp2_gan.csv", "est_j1_n05_exp3_gan.csv"].map(|file| {
        let source = sources.iter().find(|source| source.file == file).unwrap();
        source.recording.as_ref().map_or(0, |recording| recording.t.len())
    });
    assert_eq!(rows, [2563, 2631]);
}

/// Every split has something to fit; folds hold every recording out once; parts of a machine make up the machine. A file
/// alone, and recordings made worse, have no more rows than the machine.
#[test]
fn the_splits_cover_every_machine() {
    let Some(data) = measured_data() else { return };
    let rows = |recordings: &[breakaway::recording::Recording]| recordings.iter().map(|r| r.t.len()).sum::<usize>();
    for machine in MACHINES.into_iter().filter(|machine| machine.name != SO101.name) {
        let sources = read(machine, &data).unwrap();
        let whole = rows(&taken(machine, Split::All, &sources).fit);
        let (mut held, mut halves, mut thirds) = (0, 0, 0);
        for split in splits(machine) {
            let taken = taken(machine, split, &sources);
            assert!(rows(&taken.fit) > 0, "{}, {split}", machine.name);
            match split {
                Split::Without { .. } => {
                    assert_eq!(rows(&taken.fit) + rows(&taken.holdout), whole, "{}, {split}", machine.name);
                    held += rows(&taken.holdout);
                }
                Split::Part { of: 2, .. } => halves += rows(&taken.fit),
                Split::Part { .. } => thirds += rows(&taken.fit),
                _ => assert!(taken.holdout.is_empty()),
            }
            if split != Split::All && !matches!(split, Split::Without { .. }) {
                assert!(rows(&taken.fit) < whole, "{}, {split}", machine.name);
            }
        }
        for split in harder(machine) {
            let taken = taken(machine, split, &sources);
            assert!((1..=whole).contains(&rows(&taken.fit)) && taken.holdout.is_empty(), "{}, {split}", machine.name);
        }
        assert_eq!((halves, thirds), (whole, whole), "{}", machine.name);
        assert_eq!(held, if machine.files > 1 { whole } else { 0 }, "{}", machine.name);
    }
}

/// The quick subset is of the catalogue and of its splits.
#[test]
fn the_quick_subset_is_part_of_the_table() {
    let pairs = quick();
    assert_eq!(pairs.len(), 6);
    for (machine, split) in pairs {
        assert_eq!(named(machine.name).map(|found| found.title), Some(machine.title));
        assert!(splits(machine).contains(&split), "{}, {split}", machine.name);
    }
}

/// What is discovered on all recordings of a machine.
fn discovered(machine: &Machine) -> Option<Said> {
    let sources = read(machine, &measured_data()?).unwrap();
    let said = discovery::run(taken(machine, Split::All, &sources), &|_| ());
    println!("{}: {} {:?}", machine.name, said.verdict, said.named);
    Some(said)
}

/// The asymmetric friction of EMPS.
#[test]
fn emps_is_right() {
    let Some(said) = discovered(&EMPS) else { return };
    assert_eq!(score(&EMPS.truth, &said.verdict, &said.named), Score::Right);
}

/// The gravity load of AK80. The forces speak for a small delay beside it. With the delay the simulated motion is off by
/// .12 rad after a second, and by .024 rad without it (a fifth; half is asked).
#[test]
fn a_small_name_that_the_motion_contradicts_is_not_named() {
    let Some(said) = discovered(&AK80) else { return };
    assert_eq!(said.named.iter().map(|own| own.kind).collect::<Vec<_>>(), [Kind::GravityLoad]);
    let [before, after] = said.open_loop.unwrap();
    assert!(after < 0.06 && after < before, "{before} {after}");
}

/// EMPS follows a smooth reference. Over a second a cubic in time is off by more than the published model (0.4 mm),
/// and by less than the travel (0.25 m).
#[test]
fn the_drive_free_curve_of_emps_is_worse_than_a_model() {
    let Some(data) = measured_data() else { return };
    let error = drive_free::error(&taken(&EMPS, Split::All, &read(&EMPS, &data).unwrap())).unwrap();
    assert!((0.4e-3..0.25).contains(&error), "{error} m");
}
