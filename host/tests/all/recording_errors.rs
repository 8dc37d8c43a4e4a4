//! Each thing that can be wrong with a recording has its own message, with file, line, column and what to do.
#![allow(clippy::format_collect, reason = "ten rows of text; the fold would hide what they are")]

use breakaway::recording::{ReadOptions, Recording, RecordingError, Signal, Warning};
use insta::assert_snapshot;

fn read(text: impl AsRef<[u8]>) -> Result<Recording, RecordingError> {
    Recording::read_from("a.csv", text.as_ref(), &ReadOptions::default())
}

fn message(text: impl AsRef<[u8]>) -> String {
    read(text).unwrap_err().to_string()
}

/// A good file of ten rows, with line `line` (from 1, the header row is 1) replaced.
fn with_line(line: usize, text: &str) -> String {
    let mut lines = vec!["t,u,x".to_owned()];
    lines.extend((0..10).map(|k| format!("{},{},{}", 0.5 * f64::from(k), k % 3, k * k)));
    text.clone_into(&mut lines[line - 1]);
    lines.join("\n") + "\n"
}

#[test]
fn files_that_hold_no_samples() {
    assert_snapshot!(message(""), @"a.csv: the file is empty; a recording has a header row such as `t,u,x` and one row per sample");
    assert_snapshot!(message("# tick: 0.001 s\n\n"), @"a.csv: the file is empty; a recording has a header row such as `t,u,x` and one row per sample");
    assert_snapshot!(message("# note: x\nt,u,x\n"), @"a.csv:2: a header row and no samples below it; was the recording stopped before it began?");
    assert_snapshot!(message("t,u,x\n0,1,2\n"), @"a.csv:2: too short: 1 row(s), and at least 8 are needed; record for longer");
    assert_snapshot!(message("0,1,2\n1,1,3\n"), @"a.csv:1: the first row is numbers (0,1,2), not column names; add a header row such as `t,u,x`");
    let missing = Recording::read("no/such.csv".as_ref(), &ReadOptions::default());
    assert_snapshot!(missing.unwrap_err(), @"no/such.csv: no such file; check the path");
    let folder = Recording::read(".".as_ref(), &ReadOptions::default());
    assert_snapshot!(folder.unwrap_err(), @". is a folder, not a recording; name the files in it, such as ./*.csv");
}

#[test]
fn columns_that_are_not_there() {
    assert_snapshot!(message("t_s,u_V,x_m\n0,1,2\n"), @"a.csv:1: no column `t`; did you mean `t_s`?; name it with --time (or give --fs); columns: t_s, u_V, x_m");
    assert_snapshot!(message("t,u_V,x_m\n0,1,2\n"), @"a.csv:1: no column `u`; did you mean `u_V`?; name it with --input; columns: t, u_V, x_m");
    assert_snapshot!(message("t,u,angle\n0,1,2\n"), @"a.csv:1: no column `x`; name it with --position; columns: t, u, angle");
    assert_snapshot!(message("t,u,x,x\n0,1,2,3\n"), @"a.csv:1: two columns are called `x`; rename one in the header row");
}

#[test]
fn fields_that_are_no_finite_numbers() {
    assert_snapshot!(message(with_line(5, "1.5,NaN,9")), @"a.csv:5: column `u`: `NaN` is not a finite number; remove the row, which leaves a gap, or repair it");
    assert_snapshot!(message(with_line(5, "1.5,1,-inf")), @"a.csv:5: column `x`: `-inf` is not a finite number; remove the row, which leaves a gap, or repair it");
    assert_snapshot!(message(with_line(5, "1e999,1,9")), @"a.csv:5: column `t`: `1e999` is not a finite number; remove the row, which leaves a gap, or repair it");
    assert_snapshot!(message(with_line(5, "1.5,1,9 mm")), @"a.csv:5: column `x`: `9 mm` is not a number; numbers are written like -1.5e-3, with a point");
    assert_snapshot!(message(with_line(5, "1.5,,9")), @"a.csv:5: column `u`: the field is empty; remove the row, which leaves a gap, or repair it");
    assert_snapshot!(message(with_line(10, "4,1")), @"a.csv:10: column `x`: the field is missing: the row has 2 field(s), the header 3; remove the row, which leaves a gap, or repair it");
    assert_snapshot!(message(with_line(5, "1,5,1,9")), @"a.csv:5: the row has 4 fields, the header 3; is there a decimal comma, or an unquoted comma in a text?");
    let latin1 = [with_line(12 - 1, "").as_bytes(), b"4.5,1,\xb5\n"].concat();
    assert_snapshot!(message(latin1), @"a.csv:12: column `x`: not UTF-8 text; save the file as UTF-8 CSV");
    assert_snapshot!(message(b"\xff\xfet\0,\0"), @"a.csv:1: column `number 1`: not UTF-8 text; save the file as UTF-8 CSV");
}

/// A clock that stands still, and rows in no order of time: nothing that could be mended is left.
#[test]
fn clocks_that_cannot_be_mended() {
    let rows = |t: fn(i32) -> i32| (0..30).map(|k| format!("{},{},{}\n", t(k), k % 3, k * k)).collect::<String>();
    let file = |t| format!("t,u,x\n{}", rows(t));
    assert_snapshot!(message(file(|_| 7)), @"a.csv:3: column `t`: time stands still at 7, 29 rows repeat the stamp of the row before; give the right column with --time, or the sampling rate with --fs");
    assert_snapshot!(message(file(|k| -k)), @"a.csv:3: column `t`: time goes back from 0 to -1, and so 29 times; sort the rows, keep one recording per file, or give the right column with --time");
    assert_snapshot!(message(file(|k| if k % 2 == 0 { k } else { 100 + k })), @"a.csv:4: column `t`: time goes back from 101 to 2, and so 14 times; sort the rows, keep one recording per file, or give the right column with --time");
}

#[test]
fn signals_that_stand_still() {
    let still: String = (0..20).map(|k| format!("{k},{},3.5\n", k % 5)).collect();
    let still = format!("t,u,x\n{still}");
    let signal = Signal::read_from("a.csv", still.as_bytes(), None, &ReadOptions::default());
    assert_snapshot!(signal.unwrap_err(), @"a.csv: column `x` is constant (3.5 in all 20 rows); there is nothing to fit");
}

#[test]
fn rows_and_options_that_do_not_fit() {
    let options = |edit: fn(&mut ReadOptions)| {
        let mut options = ReadOptions::default();
        edit(&mut options);
        Recording::read_from("a.csv", with_line(1, "t,u,x").as_bytes(), &options).unwrap_err().to_string()
    };
    assert_snapshot!(options(|o| o.select = vec!["u=7".parse().unwrap()]), @"a.csv: no row has u=7; the first rows have `0`, `1`, `2`");
    assert_snapshot!(options(|o| o.select = vec!["v=7".parse().unwrap()]), @"a.csv:1: no column `v`; name it with --where; columns: t, u, x");
    assert_snapshot!(options(|o| o.fs_hz = Some(0.0)), @"--fs is 0; it must be a number from 1e-4 to 1e7");
    assert_snapshot!(options(|o| o.encoder_step = Some(f64::NAN)), @"--encoder-step is NaN; it must be a number from 1e-100 to 1e100");
}

#[test]
fn header_lines_that_cannot_be_read() {
    assert_snapshot!(message("# tick: fast\n"), @"a.csv:1: header `tick`: `fast` is not a time in seconds such as `0.001 s`");
    assert_snapshot!(message("# note\n# encoder step: -1\n"), @"a.csv:2: header `encoder step`: `-1` is not a positive step such as `3.14e-4 rad`");
    assert_snapshot!(message("# units: volts\n"), @"a.csv:1: header `units`: `volts` is not a list such as `u=V, x=rad`");
    assert_snapshot!(message("# gaps: 3, x\n"), @"a.csv:1: header `gaps`: `3, x` is not a list of row numbers such as `120, 450`");
}

/// The line is that of the row itself, whatever stands before it: comments, blank lines, CRLF, line breaks inside quotes.
#[test]
fn lines_are_counted_as_an_editor_counts_them() {
    let found = |text: &str| message(text).split(": ").next().unwrap().to_owned();
    let good = "0,1,2\n1,1,3\n";
    assert_eq!(found(&format!("t,u,x\n{good}2,1,?\n")), "a.csv:4");
    assert_eq!(found(&format!("t,u,x\n{good}2,1,?")), "a.csv:4");
    assert_eq!(found(&format!("t,u,x\n{good}# a\n\n# b\n2,1,?\n3,1,2\n")), "a.csv:7");
    assert_eq!(found(&format!("# a: b\n\nt,u,x\n{good}2,1,?\n").replace('\n', "\r\n")), "a.csv:6");
    assert_eq!(found("t,u,x,note\n0,1,2,\"two\nlines\"\n1,1,?,\"three\n\nlines\"\n2,1,3,\n"), "a.csv:4");
}

/// A sine clipped at ±0.98 is a warning; a relay, at its extremes always, has none.
#[test]
fn a_saturated_drive_is_a_warning_and_a_relay_is_not() {
    let t: Vec<f64> = (0..1000).map(|k| 0.001 * f64::from(k)).collect();
    let wave: Vec<f64> = t.iter().map(|t| (20.0 * t).sin()).collect();
    let drive = |u: Vec<f64>| Recording { u, t: t.clone(), x: wave.clone(), ..Recording::default() };
    let clipped = drive(wave.iter().map(|u| u.clamp(-0.98, 0.98)).collect()).warnings();
    let [Warning::Saturated { fraction, .. }] = clipped[..] else { panic!("{clipped:?}") };
    // The record, 20 rad long, holds 6 peaks of 2·acos(0.98) rad: 12.02 %, and each peak is counted within one sample of 1000.
    let wanted = 6.0 * 2.0 * 0.98_f64.acos() / 20.0;
    assert!((fraction - wanted).abs() < 6.0 / 1000.0, "{fraction}");
    assert_snapshot!(clipped[0], @"the drive is saturated in 12.0 % of the samples (limits -0.98 and 0.98); column u must be the drive that was applied, not the one that was commanded");
    assert_eq!(drive(wave.clone()).warnings(), []);
    assert_eq!(drive(wave.iter().map(|u| u.signum()).collect()).warnings(), []);
    assert_eq!(drive(vec![0.5; 1000]).warnings(), [Warning::ConstantDrive { value: 0.5 }]);
}
