//! Files of strangers: times in any unit, glitches, torn rows, roll-overs, and what is too much to read.
#![allow(clippy::format_collect, reason = "some rows of text; the fold would hide what they are")]

use std::fmt::Write as _;
use std::io::Read;

use breakaway::recording::{ReadOptions, Recording, RecordingError, TimeUnit, Warning, Wrap};
use insta::assert_snapshot;

/// 600 rows at 1 kHz of a swing of 1 rad at 2 Hz under a drive of 1 V, with the clock called `time`, in units of `unit_s`.
fn swing(time: &str, unit_s: f64, start: f64) -> String {
    let mut text = format!("{time},u,x\n");
    for k in 0..600 {
        let angle = std::f64::consts::TAU * 2e-3 * f64::from(k);
        writeln!(text, "{},{:.3},{:.4}", start + (f64::from(k) * 1e-3 / unit_s).round(), angle.cos(), angle.sin())
            .unwrap();
    }
    text
}

fn with_time(time: &str) -> ReadOptions {
    ReadOptions { time: Some(time.to_owned()), ..ReadOptions::default() }
}

fn read(text: &str, options: &ReadOptions) -> Result<Recording, RecordingError> {
    Recording::read_from("a.csv", text.as_bytes(), options)
}

/// The file with the row on `line` replaced.
fn with_line(text: &str, line: usize, row: &str) -> String {
    let mut lines: Vec<&str> = text.lines().collect();
    lines[line - 1] = row;
    lines.join("\n") + "\n"
}

/// Whatever the column's name says its unit is, the interval is 1 ms.
#[test]
fn the_unit_of_time_is_read_from_its_name() {
    for (name, unit_s) in [("t (us)", 1e-6), ("time [ms]", 1e-3), ("TimeMs", 1e-3), ("t_ns", 1e-9), ("micros", 1e-6)] {
        let recording = read(&swing(name, unit_s, 0.0), &with_time(name)).unwrap();
        assert!((recording.evenly_sampled().unwrap() - 1e-3).abs() < 1e-12, "{name}");
    }
    // The header's word counts more than the name's, and the option more than both.
    let told = format!("# units: t_s=ms\n{}", swing("t_s", 1e-3, 0.0));
    assert!((read(&told, &with_time("t_s")).unwrap().timing().median_s - 1e-3).abs() < 1e-12);
    let option = ReadOptions { time_unit: Some(TimeUnit::Microseconds), ..with_time("t_ms") };
    assert!((read(&swing("t_ms", 1e-6, 0.0), &option).unwrap().timing().median_s - 1e-3).abs() < 1e-12);
}

/// A rate at which no motor is recorded is refused with the unit that is likely, and taken when the unit is told.
#[test]
fn an_implausible_rate_is_refused_with_the_likely_unit() {
    let refused = |name: &str, unit_s: f64, start: f64| {
        read(&swing(name, unit_s, start), &with_time(name)).unwrap_err().to_string()
    };
    assert_snapshot!(refused("time", 1e-3, 0.0), @"a.csv: column `time`, read in s, gives 1 Hz between rows, at which no motor is recorded; it is probably in ms (1000 Hz between rows): give --time-unit ms, or --time-unit s if it is right");
    assert_snapshot!(refused("time", 1e-6, 0.0), @"a.csv: column `time`, read in s, gives 1e-3 Hz between rows, at which no motor is recorded; it is probably in us (1000 Hz between rows): give --time-unit us, or --time-unit s if it is right");
    assert_snapshot!(refused("stamp", 1e-3, 1.7e12), @"a.csv: column `stamp`, read in s, gives 1 Hz between rows, at which no motor is recorded; it is probably in ms since 1970 (1000 Hz between rows): give --time-unit ms, or --time-unit s if it is right");
    assert_snapshot!(refused("%time", 1e-9, 1.7e18), @"a.csv: column `%time`, read in s, gives 1e-6 Hz between rows, past what can be computed with; it is probably in ns since 1970 (1000 Hz between rows): give --time-unit ns");
    assert_snapshot!(refused("t_us", 1e-3, 0.0), @"a.csv: column `t_us`, read in us, gives 1e6 Hz between rows, at which no motor is recorded; it is probably in ms (1000 Hz between rows): give --time-unit ms, or --time-unit us if it is right");
    let slow = ReadOptions { time_unit: Some(TimeUnit::Seconds), ..with_time("time") };
    assert_eq!(read(&swing("time", 1e-3, 0.0), &slow).unwrap().timing().median_s, 1.0);
}

/// Whole seconds for 100 rows each: it is not the unit that is wrong.
#[test]
fn a_clock_of_whole_seconds_asks_for_the_rate() {
    let mut text = "time,u,x\n".to_owned();
    (0..2000).for_each(|k| writeln!(text, "{},{},{}", 1_700_000_000 + k / 100, k % 3, k * k).unwrap());
    assert_snapshot!(read(&text, &with_time("time")).unwrap_err(), @"a.csv: column `time` is too coarse: about 100 rows have each time stamp, and stamps are 1 s apart; give the sampling rate with --fs");
}

/// Rates past what windows of fixed lengths can hold are refused, whoever says so.
#[test]
fn a_rate_that_cannot_be_computed_with_is_refused() {
    let fs = ReadOptions { fs_hz: Some(1e20), ..ReadOptions::default() };
    assert_snapshot!(read(&swing("t", 1.0, 0.0), &fs).unwrap_err(), @"--fs is 100000000000000000000; it must be a number from 1e-4 to 1e7");
    let tick = format!("# tick: 1e-20 s\n{}", swing("time", 1e-3, 0.0));
    assert_snapshot!(read(&tick, &ReadOptions::default()).unwrap_err(), @"a.csv: header `tick` gives 1e20 Hz, past what can be computed with; give the sampling rate with --fs");
}

/// One sample of 50 rad, and one of all ones: the row is named and left out, and the recording is cut there.
#[test]
fn a_glitch_is_named_and_left_out() {
    let text = swing("t_ms", 1e-3, 0.0);
    let glitch = with_line(&with_line(&text, 102, "100,0.3,50"), 302, "300,-0.8,65535");
    let recording = read(&glitch, &with_time("t_ms")).unwrap();
    assert_eq!((recording.t.len(), recording.gaps.as_slice()), (598, &[100, 299][..]));
    assert!(recording.x.iter().all(|x| x.abs() <= 1.0));
    let said: Vec<String> = recording.found.iter().map(ToString::to_string).collect();
    assert_snapshot!(said.join("\n"), @"lines 102, 302: the position leaps out and back (to 50 first); these rows are left out, and the recording is cut there");
}

/// A glitch that a larger one hides is found after it.
#[test]
fn a_smaller_glitch_is_found_beside_a_larger_one() {
    let text = swing("t_ms", 1e-3, 0.0);
    let text = with_line(&with_line(&text, 102, "100,0.3,1e6"), 302, "300,-0.8,2.5");
    let recording = read(&text, &with_time("t_ms")).unwrap();
    assert_eq!(recording.t.len(), 598);
}

#[test]
fn a_glitch_of_the_drive_is_a_warning() {
    let text = with_line(&swing("t_ms", 1e-3, 0.0), 102, "100,9999,0.9511");
    let recording = read(&text, &with_time("t_ms")).unwrap();
    assert_eq!(recording.t.len(), 600);
    assert_snapshot!(recording.found[0], @"line 102: the drive (9999 first) is far larger than in all other rows (at most 1); remove these rows if it was not applied");
}

/// A power cut leaves half a row, or blocks of zero bytes. An open quote is none: it swallows all rows after it.
#[test]
fn a_torn_last_row_is_left_out_and_an_open_quote_is_refused() {
    let text = swing("t_ms", 1e-3, 0.0);
    for torn in ["600,0.99", "600,", "6", "600,1.0,-", "\0\0\0\0\0\0"] {
        let recording = read(&format!("{text}{torn}"), &with_time("t_ms")).unwrap();
        assert_eq!(recording.t.len(), 600, "{torn}");
        assert!(matches!(recording.found[..], [Warning::Torn { line: 602, .. }]), "{torn}: {:?}", recording.found);
    }
    let recording = read(&format!("{text}600,0.99\n"), &with_time("t_ms")).unwrap();
    assert_snapshot!(recording.found[0], @"line 602: the last row (`600,0.99`) is cut off; it is left out");
    // A row that ends is not torn, and neither is one with rows after it.
    let wrong = |text: String| read(&text, &with_time("t_ms")).unwrap_err().to_string();
    assert_snapshot!(wrong(format!("{text}600,1.0,-\n")), @"a.csv:602: column `x`: `-` is not a number; numbers are written like -1.5e-3, with a point");
    assert_snapshot!(wrong(with_line(&text, 300, "298,0.1")), @"a.csv:300: column `x`: the field is missing: the row has 2 field(s), the header 3; remove the row, which leaves a gap, or repair it");
    assert_snapshot!(wrong(with_line(&text, 300, "298,\"0.1,0.2")), @"a.csv:300: column `u`: the field goes on past the end of its line; is a quote opened and not closed?");
}

/// 6 turns at 10 turns per second on an encoder of 12 bits.
fn turning() -> String {
    let mut text = "t_s,u,x_counts\n".to_owned();
    for k in 0..600 {
        let counts = (4096.0 * 0.01 * f64::from(k)).round() % 4096.0;
        writeln!(text, "{},{},{counts}", 1e-3 * f64::from(k), k % 7).unwrap();
    }
    text
}

/// An encoder that rolls over is refused with the row and what to give; told, it is joined or left as it is.
#[test]
fn a_roll_over_is_refused_with_the_option_and_joined_by_it() {
    let options = ReadOptions { position: Some("x_counts".to_owned()), ..with_time("t_s") };
    let refused = read(&turning(), &options).unwrap_err();
    assert_snapshot!(refused, @"a.csv:102: column `x_counts`: the position goes from 4055 to 0 within one row, against the motion around it, and so 5 times. The encoder seems to roll over: give --wrap 4096 to join the turns, or --wrap none if the axis did jump");
    let joined = read(&turning(), &ReadOptions { wrap: "4096".parse().ok(), ..options.clone() }).unwrap();
    // 599 rows of 40.96 counts.
    assert_eq!(joined.x[599], 24_535.0);
    assert!(joined.x.windows(2).all(|w| (w[1] - w[0] - 40.96).abs() < 1.0));
    let left = read(&turning(), &ReadOptions { wrap: Some(Wrap::None), ..options }).unwrap();
    assert!(left.x.iter().all(|x| *x < 4096.0));
    assert!("-4096".parse::<Wrap>().is_err() && "0".parse::<Wrap>().is_err());
}

/// Inputs without an end, and headers without measure: a message of a few lines that names the limit.
#[test]
fn what_is_too_much_is_refused_by_its_limit() {
    let refused =
        |input: &mut dyn Read| Recording::read_from("a.csv", input, &ReadOptions::default()).unwrap_err().to_string();
    assert_snapshot!(refused(&mut std::io::repeat(0)), @"a.csv is binary data, not a recording (CSV with a header row); give the log as CSV, MCAP, WPILOG, ULog, npz, MAT or Parquet");
    assert_snapshot!(refused(&mut std::io::repeat(b'7')), @"a.csv:1: no end of the row within 1024 KiB, the longest row that is read. A recording has one row per sample, and a quote must be closed");
    assert_snapshot!(refused(&mut "# a\n".as_bytes().chain(std::io::repeat(b'#'))), @"a.csv:2: no end of the row within 1024 KiB, the longest row that is read. A recording has one row per sample, and a quote must be closed");
    assert_snapshot!(refused(&mut "t,u,x\n0,1,2\n1,\"".as_bytes().chain(std::io::repeat(b'\n'))), @"a.csv:3: no end of the row within 1024 KiB, the longest row that is read. A recording has one row per sample, and a quote must be closed");
    let names = |count: usize| (0..count).map(|k| format!("c{k},")).collect::<String>() + "c\n1,2\n";
    assert_snapshot!(refused(&mut names(20_000).as_bytes()), @"a.csv:1: the header row has 20001 columns, and at most 16384 are read; leave out those not needed");
    let long = refused(&mut names(9_000).as_bytes());
    assert!(long.len() < 400 && long.ends_with("c22, c23, and 8977 more"), "{long}");
    let long = refused(&mut format!("{},u\n", "x".repeat(500_000)).as_bytes());
    assert!(long.len() < 400, "{long}");
    let few = ReadOptions { max_rows: Some(100), ..with_time("t_ms") };
    assert_snapshot!(read(&swing("t_ms", 1e-3, 0.0), &few).unwrap_err(), @"a.csv:102: the recording goes on past 100 rows, the most that are read; split the file");
}

/// Counts are an angle if it is told, by the option or by the file, how many make a turn; the file's word survives writing.
#[test]
fn counts_per_turn_make_counts_an_angle() {
    let options = ReadOptions { counts_per_turn: Some(4096.0), ..with_time("t_ms") };
    let recording = read(&swing("t_ms", 1e-3, 0.0), &options).unwrap();
    assert_eq!(recording.radians_per_unit(), Some(std::f64::consts::TAU / 4096.0));
    let mut bytes = Vec::new();
    recording.write_to(&mut bytes).unwrap();
    let again = Recording::read_from("a.csv", bytes.as_slice(), &ReadOptions::default()).unwrap();
    assert_eq!(again.radians_per_unit(), recording.radians_per_unit());
    assert_eq!(read(&swing("t_ms", 1e-3, 0.0), &with_time("t_ms")).unwrap().radians_per_unit(), None);
}
