//! Recordings in and out: what is read is what was written, and a stranger's file needs no editing.
#![allow(clippy::format_collect, reason = "ten rows of text; the fold would hide what they are")]

use std::fmt::Write as _;

use breakaway::recording::{ReadOptions, Recording, Signal, TimeUnit, Units, Warning};
use proptest::collection::vec;
use proptest::prelude::*;

fn read(text: &str, options: &ReadOptions) -> Recording {
    Recording::read_from("dir/a.csv", text.as_bytes(), options).unwrap()
}

/// A row per second is believed if the unit is told.
fn in_seconds() -> ReadOptions {
    ReadOptions { time_unit: Some(TimeUnit::Seconds), ..ReadOptions::default() }
}

#[test]
fn a_file_with_quotes_semicolons_byte_order_mark_and_crlf_is_read() {
    let plain = "t,u,x\n0,1,0.5\n1,-1,0.25\n2,1,0.5\n3,1,0.75\n4,1,0.5\n5,-1,1e-3\n6,1,2\n7,1,3\n";
    let wanted = read(plain, &in_seconds());
    assert_eq!(wanted.name, "a");
    assert_eq!(wanted.x[..3], [0.5, 0.25, 0.5]);
    let quoted = plain.replace("0.25", "\" 0.25\"").replace("x\n", "\"x\"\n");
    let marked = format!("\u{feff}{}\r\n\r\n", plain.replace('\n', "\r\n"));
    for other in [
        quoted,
        marked,
        plain.replace(',', ";"),
        plain.replace(',', "\t"),
        plain.trim_end().to_owned(),
        plain.replace("\n4,", "\n\n# remark\n4,"),
    ] {
        assert_eq!(read(&other, &in_seconds()), wanted, "{other}");
    }
}

#[test]
fn columns_are_mapped_and_units_and_time_follow_their_names() {
    let mut text = "n,t_ms,uq_V,angle (deg)\n".to_owned();
    for k in 0..10 {
        writeln!(text, "{k},{},{},{}", 2 * k, k % 4, 0.3 * f64::from(k * k)).unwrap();
    }
    let mut options = ReadOptions {
        time: Some("t_ms".to_owned()),
        input: Some("uq_V".to_owned()),
        position: Some("angle (deg)".to_owned()),
        ..ReadOptions::default()
    };
    let recording = read(&text, &options);
    assert_eq!(recording.units, Units { u: "V".to_owned(), x: "deg".to_owned() });
    assert!((recording.t[3] - 0.006).abs() < 1e-15);
    assert!((recording.evenly_sampled().unwrap() - 0.002).abs() < 1e-15);
    options.fs_hz = Some(4.0);
    assert_eq!(read(&text, &options).t[..3], [0.0, 0.25, 0.5]);
}

#[test]
fn time_comes_from_the_rate_or_the_tick_where_there_is_no_column() {
    let rows: String = (0..10).map(|k| format!("{},{}\n", k % 3, k * k)).collect();
    let options = ReadOptions { fs_hz: Some(1000.0), ..ReadOptions::default() };
    assert_eq!(read(&format!("u,x\n{rows}"), &options).t[2], 0.002);
    let tick = format!("# tick: 0.5 s\nu,x\n{rows}");
    assert_eq!(read(&tick, &ReadOptions::default()).t[2], 1.0);
}

/// `--where` cuts the record where rows fall out, even a single one, and `segments` gives the pieces on the session's time axis.
#[test]
fn a_selection_cuts_the_record_into_pieces() {
    let mut text = "t,u,x,on\n".to_owned();
    for k in 0..30 {
        let on = if (10..20).contains(&k) || k == 25 { "0" } else { "1.0" };
        writeln!(text, "{},{},{},{on}", 100 + k, k % 3, k * k).unwrap();
    }
    let mut options = ReadOptions { select: vec!["on=1".parse().unwrap()], ..in_seconds() };
    let on = read(&text, &options);
    assert_eq!(on.t.len(), 19);
    assert_eq!(on.gaps, [10, 15]);
    assert_eq!(on.evenly_sampled(), None);
    let segments = on.segments();
    let spans: Vec<(f64, f64)> = segments.iter().map(|s| (s.t[0], s.t[s.t.len() - 1])).collect();
    assert_eq!(spans, [(100.0, 109.0), (120.0, 124.0), (126.0, 129.0)]);
    assert_eq!(segments[1].evenly_sampled(), Some(1.0));
    assert_eq!(segments[1].name, "a part 2");

    options.select = vec!["on=0".parse().unwrap()];
    let off = read(&text, &options);
    assert_eq!(off.gaps, [10]);
    // The second piece is a single sample: nothing moves in it.
    assert_eq!(off.segments().len(), 1);
}

#[test]
fn gaps_are_intervals_of_more_than_five_medians_or_reported_drops() {
    let times = |step: f64| -> String {
        let row = |k: i32| format!("{},{},{}\n", f64::from(k) + if k > 6 { step } else { 0.0 }, k % 3, k * k);
        (0..12).map(row).collect()
    };
    let gaps = |header: &str, step: f64| {
        let text = format!("{header}t,u,x\n{}", times(step));
        read(&text, &in_seconds()).gaps
    };
    assert_eq!(gaps("", 3.9), [] as [usize; 0]);
    assert_eq!(gaps("", 4.1), [7]);
    assert_eq!(gaps("# gaps: 3\n", 4.1), [3, 7]);
}

#[test]
fn jitter_is_measured_and_warned_of() {
    let mut recording = Recording {
        t: vec![0.0, 1.0, 2.0, 3.5, 4.0, 5.0],
        u: vec![1.0, 0.0, 1.0, 1.0, 0.0, 0.0],
        x: vec![0.0, 1.0, 2.0, 3.0, 2.0, 1.0],
        ..Recording::default()
    };
    let timing = recording.timing();
    assert_eq!((timing.min_s, timing.median_s, timing.max_s, timing.even), (0.5, 1.0, 1.5, false));
    assert_eq!(recording.warnings(), [Warning::Jitter { intervals_s: (0.5, 1.0, 1.5) }]);
    recording.t = vec![0.0, 1.0, 2.0, 3.005, 4.0, 5.0];
    assert_eq!(recording.evenly_sampled(), Some(1.0));
    assert_eq!(recording.warnings(), []);
}

#[test]
fn a_signal_needs_no_drive_and_no_position() {
    let text: String = (0..10).map(|k| format!("{k},{}\n", k * k)).collect();
    let signal =
        Signal::read_from("b.csv", format!("t,iq_A\n{text}").as_bytes(), Some("iq_A"), &ReadOptions::default())
            .unwrap();
    assert_eq!((signal.unit.as_deref(), signal.y[3]), (Some("A"), 9.0));
}

fn finite() -> impl Strategy<Value = f64> {
    any::<f64>().prop_filter("finite", |x| x.is_finite())
}

prop_compose! {
    fn recordings()(
        start in -1e6..1e6_f64,
        // From 1 µs to 1000 s; a median past 2.8 hours would be refused.
        samples in vec((-6.0..3.0_f64, finite(), finite(), finite()), 8..60),
        measured in any::<bool>(),
        step in proptest::option::of(1e-300..1e300_f64),
        gap in 1_usize..8,
        units in ("[a-zA-Z%°µ·/]{1,6}", "[a-zA-Z%°µ·/]{1,6}"),
        meta in proptest::collection::btree_map("[a-z]{5,9}( [a-z]{1,5})?", "[a-z0-9][a-z0-9:,=#\"]{0,12}", 0..4),
    ) -> Recording {
        let mut t: Vec<f64> = samples.iter().scan(start, |t, s| { *t += 10_f64.powf(s.0); Some(*t) }).collect();
        t.dedup();
        let count = t.len();
        let mut recording = Recording {
            name: "r".to_owned(),
            t,
            u: samples.iter().map(|s| s.1).take(count).collect(),
            x: samples.iter().map(|s| s.2).take(count).collect(),
            current: samples.iter().map(|s| s.3).take(if measured { count } else { 0 }).collect(),
            // Without a step in the file the reader may infer one.
            encoder_step: Some(step.unwrap_or(1.0)),
            units: Units { u: units.0, x: units.1 },
            counts_per_turn: step.map(f64::abs),
            read_every_s: None,
            seen_every_s: None,
            meta,
            gaps: vec![gap],
            found: Vec::new(),
        };
        recording.meta.remove("units");
        recording
    }
}

proptest! {
    /// Every bit of every number, zero's sign and subnormals included, survives a write and a read; so do units, step, gaps and provenance.
    #[test]
    fn written_and_read_back_is_the_same_bit_for_bit(recording in recordings()) {
        prop_assume!(recording.t.len() >= 8);
        let mut bytes = Vec::new();
        recording.write_to(&mut bytes).unwrap();
        let back = Recording::read_from("r.csv", bytes.as_slice(), &ReadOptions::default()).unwrap();
        let bits = |column: &[f64]| column.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&back.t), bits(&recording.t));
        prop_assert_eq!(bits(&back.u), bits(&recording.u));
        prop_assert_eq!(bits(&back.x), bits(&recording.x));
        prop_assert_eq!(bits(&back.current), bits(&recording.current));
        prop_assert_eq!(&back.encoder_step, &recording.encoder_step);
        prop_assert_eq!(&back.counts_per_turn, &recording.counts_per_turn);
        prop_assert_eq!(&back.units, &recording.units);
        prop_assert_eq!(&back.meta, &recording.meta);
        prop_assert!(back.gaps.contains(&recording.gaps[0]));
        // A second trip changes nothing at all.
        let mut again = Vec::new();
        back.write_to(&mut again).unwrap();
        let twice = Recording::read_from("r.csv", again.as_slice(), &ReadOptions::default()).unwrap();
        prop_assert_eq!(twice, back);
    }
}

/// Found by the fuzzer: a key that ended in control characters became another key, one of the reader's own, in writing.
#[test]
fn control_characters_in_a_comment_are_blanks() {
    let rows = "t,u,x\n0,1,0\n.1,1,1\n.2,-1,2\n.3,1,4\n.4,1,5\n.5,-1,6\n.6,1,8\n.7,1,7\n";
    let wrong = format!("# units\0\u{1}: rad\n{rows}");
    let error = Recording::read_from("a.csv", wrong.as_bytes(), &ReadOptions::default()).unwrap_err();
    assert!(error.to_string().contains("such as `u=V, x=rad`"), "{error}");
    let told = read(&format!("#\0motor\u{1}type\0:\0EC\u{7}45\0\n{rows}"), &ReadOptions::default());
    assert_eq!(told.meta["motor type"], "EC 45");
}

#[test]
fn a_recording_that_cannot_be_written_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.csv");
    let good = read("t,u,x\n0,1,0.5\n1,-1,0.25\n2,1,0.5\n3,1,0.75\n4,1,0.5\n5,-1,1\n6,1,2\n7,1,3\n", &in_seconds());
    good.write(&path).unwrap();
    let before = std::fs::read(&path).unwrap();
    let mut bad = good.clone();
    bad.x[5] = f64::NAN;
    let error = bad.write(&path).unwrap_err();
    assert!(error.to_string().contains("r.csv: cannot be written, and nothing was changed: "));
    assert_eq!(std::fs::read(&path).unwrap(), before);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    assert_eq!(Recording::read(&path, &ReadOptions::default()).unwrap().x, good.x);
}

/// A million rows through the file system; `BREAKAWAY_ROWS` asks for another number.
#[test]
fn a_long_recording_is_read_whole() {
    let rows: u32 = std::env::var("BREAKAWAY_ROWS").map_or(1_000_000, |n| n.parse().unwrap());
    let t: Vec<f64> = (0..rows).map(|k| f64::from(k) * 1e-3).collect();
    let recording = Recording {
        name: "long".to_owned(),
        u: t.iter().map(|t| (3.0 * t).sin()).collect(),
        x: t.iter().map(|t| (3.0 * t).cos() * 1e-2).collect(),
        t,
        ..Recording::default()
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.csv");
    recording.write(&path).unwrap();
    let back = Recording::read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(back, recording);
}
