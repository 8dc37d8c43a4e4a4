//! Clocks as loggers write them: what is mended, what is said of it, and recordings that do not move among others.
#![allow(clippy::format_collect, reason = "some rows of text; the fold would hide what they are")]

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use crate::support::{breakaway, json, keys, text};
use breakaway::recording::{ReadOptions, Recording, Signal};
use insta::assert_snapshot;

/// A file with one row per stamp, a triangular drive and the position k².
fn file(stamps: &[f64]) -> String {
    let mut text = "t,u,x\n".to_owned();
    for (k, t) in stamps.iter().enumerate() {
        writeln!(text, "{t},{},{}", k % 5, k * k).unwrap();
    }
    text
}

/// Time to the microsecond, gaps and the warnings of a file.
fn read(stamps: &[f64]) -> (Vec<i64>, Vec<usize>, String) {
    let recording = Recording::read_from("a.csv", file(stamps).as_bytes(), &ReadOptions::default()).unwrap();
    let said: Vec<String> = recording.found.iter().map(ToString::to_string).collect();
    (recording.t.iter().map(|t| (1e6 * t).round() as i64).collect(), recording.gaps, said.join("; "))
}

/// 12 stamps, 10 ms apart, from `start` on.
fn clock(start: f64) -> Vec<f64> {
    (0..12).map(|k| start + 0.01 * f64::from(k)).collect()
}

#[test]
fn a_stamp_written_twice_leaves_out_the_second_row() {
    let mut stamps = clock(1.0);
    stamps.insert(5, stamps[4]);
    let (t, gaps, said) = read(&stamps);
    assert_eq!(t, (0..12).map(|k| 1_000_000 + 10_000 * k).collect::<Vec<_>>());
    assert_eq!(gaps, [] as [usize; 0]);
    assert_snapshot!(said, @"line 7: the time stamp of the row before is repeated; these rows are left out");
}

/// Stamps of 30 ms on rows of 10 ms: the first row of each stamp is kept, and the rate is offered.
#[test]
fn a_clock_coarser_than_the_rows_offers_the_rate() {
    let stamps: Vec<f64> = (0..36).map(|k| f64::from(k / 3) * 0.03).collect();
    let (t, _, said) = read(&stamps);
    assert_eq!(t, (0..12).map(|k| 30_000 * k).collect::<Vec<_>>());
    assert_snapshot!(said, @"lines 3 to 4, 6 to 7, 9 to 10, 12 to 13 and 16 more: the time stamp of the row before is repeated; these rows are left out (67 % of all). The clock is coarser than the rows are frequent: --fs HZ counts time from the rows");
}

#[test]
fn a_clock_that_starts_anew_is_a_gap() {
    let stamps = [clock(3.0), clock(0.0), clock(0.0)].concat();
    let (t, gaps, said) = read(&stamps);
    // The parts follow each other one interval apart, on the first part's clock.
    assert_eq!(t, (0..36).map(|k| 3_000_000 + 10_000 * k).collect::<Vec<_>>());
    assert_eq!(gaps, [12, 24]);
    assert_snapshot!(said, @"lines 14, 26: the clock starts anew (first from 3.11 s to 0 s); the recording is cut there");
}

#[test]
fn a_single_stamp_out_of_order_leaves_out_its_row() {
    let mut stamps = clock(1.0);
    stamps[5] = 0.0;
    let (t, gaps, said) = read(&stamps);
    assert_eq!((t.len(), t[5], gaps.len()), (11, 1_060_000, 0));
    assert_snapshot!(said, @"line 7: the time stamp is out of order with the rows around it; these rows are left out");
    stamps[5] = 1e6;
    assert_eq!(read(&stamps).0, t);
}

/// What the header says of gaps, and what `--where` leaves out, stays where it was when rows before it are left out.
#[test]
fn gaps_move_with_the_rows_that_are_left_out() {
    let mut stamps = clock(0.0);
    stamps.insert(3, stamps[2]);
    let text = format!("# gaps: 8\n{}", file(&stamps));
    let recording = Recording::read_from("a.csv", text.as_bytes(), &ReadOptions::default()).unwrap();
    // Row 8 of the file is row 7 of what is kept; its time is 70 ms.
    assert_eq!(recording.gaps, [7]);
    assert!((recording.t[7] - 0.07).abs() < 1e-12);
}

/// A sine has no phase across a restart: the longest part is taken where that is said, and refused where it cannot be.
#[test]
fn a_signal_is_one_part_of_a_clock_that_starts_anew() {
    let text = file(&[clock(3.0), clock(0.0)[..9].to_vec()].concat());
    let options = ReadOptions::default();
    let (signal, found) = Signal::read_mended("a.csv", text.as_bytes(), Some("u"), &options).unwrap();
    assert_eq!((signal.t.len(), signal.gaps.len(), found.len()), (12, 0, 1));
    let refused = Signal::read_from("a.csv", text.as_bytes(), Some("u"), &options).unwrap_err();
    assert_snapshot!(refused, @"a.csv:14: column `t`: time goes back from 3.11 to 0; sort the rows, keep one recording per file, or give the right column with --time");
}

/// The papers' plant under a relay, and beside it a file in which nothing moves and one that flickers by one step.
fn session(folder: &Path) {
    let relay = "name = \"relay\"\nduration_s = 8.0\n[excitation]\nkind = \"relay\"\nh1 = 2.0\nh2 = 1.5\n[sensor]\nencoder_step = 1e-3\n";
    fs::write(folder.join("relay.toml"), relay).unwrap();
    assert!(breakaway(folder, &["run", "relay.toml", "-o", "."]).status.success());
    let rows = |x: fn(i32) -> f64| {
        (0..40).fold(String::new(), |mut rows, k| {
            writeln!(rows, "{},{},{}", f64::from(k) * 1e-3, k % 5, x(k)).unwrap();
            rows
        })
    };
    fs::write(folder.join("still.csv"), format!("# units: u=V, x=rad\nt,u,x\n{}", rows(|_| 3.5))).unwrap();
    let flicker = rows(|k| if k % 7 == 0 { 0.001 } else { 0.0 });
    fs::write(folder.join("flicker.csv"), format!("# units: u=V, x=rad\n# encoder step: 0.001\nt,u,x\n{flicker}"))
        .unwrap();
}

/// One file that does not move does not refuse the others: it is left out with a remark. None that moves is refused.
#[test]
fn a_recording_that_does_not_move_is_left_out_of_a_session() {
    let folder = tempfile::tempdir().unwrap();
    session(folder.path());
    let alone = json(folder.path(), &["identify", "relay.csv"]);
    let among = json(folder.path(), &["identify", "still.csv", "relay.csv", "flicker.csv"]);
    assert_eq!((&alone["b"], &alone["f1"]), (&among["b"], &among["f1"]));
    assert!(keys(&among).contains(&"remarks"));
    let remarks: Vec<&str> = among["remarks"].as_array().unwrap().iter().filter_map(|r| r["text"].as_str()).collect();
    let left: Vec<&str> = remarks.into_iter().filter(|remark| remark.contains("left out")).collect();
    assert_snapshot!(left.join("\n"), @r"
    still.csv is left out: the position does not move: it is 3.5 in all 40 rows
    flicker.csv is left out: the position does not move: it stays within one encoder step (0 to 0.001) in all 40 rows
    ");
    let refused = breakaway(folder.path(), &["identify", "still.csv", "flicker.csv"]);
    assert_eq!((refused.status.code(), text(&refused.stdout)), (Some(1), ""));
    assert_snapshot!(text(&refused.stderr).lines().last().unwrap(), @"error: still.csv: no motion: column `x` is 3.5 in all 40 rows; was the drive on, and large enough to overcome friction?");
    // Of a sine there is nothing to fit.
    let sine = breakaway(folder.path(), &["sinefit", "still.csv"]);
    assert_eq!(sine.status.code(), Some(1));
    assert!(text(&sine.stderr).contains("is constant (3.5 in all 40 rows)"), "{}", text(&sine.stderr));
}

/// `discover` leaves it out of the recordings to fit, and refuses where none of those to score moves. It would
/// otherwise score on other data than the user named.
#[test]
fn discover_leaves_out_what_does_not_move() {
    let folder = tempfile::tempdir().unwrap();
    session(folder.path());
    let found = json(folder.path(), &["discover", "relay.csv", "still.csv"]);
    let remarks = found["remarks"].to_string();
    assert!(remarks.contains("still.csv is left out"), "{remarks}");
    let refused = breakaway(folder.path(), &["discover", "relay.csv", "--holdout", "still.csv"]);
    assert_eq!(refused.status.code(), Some(1));
    assert!(text(&refused.stderr).contains("still.csv: no motion"), "{}", text(&refused.stderr));
}
