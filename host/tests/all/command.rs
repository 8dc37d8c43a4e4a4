//! The binary from outside: exit codes, what goes to which stream, the JSON documents, the messages.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use breakaway::recording::{Recording, Units};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

fn breakaway(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_breakaway")).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

const SIGMA: f64 = 0.02;

/// 10 s of 1.5·sin(2π·1.3·t + 0.7) + 4 rad with noise of 0.02 rad, 1 kHz, its clock starting at 100 s.
fn sine(folder: &Path) -> PathBuf {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let noise = Normal::new(0.0, SIGMA).unwrap();
    let t: Vec<f64> = (0..10_000).map(|k| 100.0 + 1e-3 * f64::from(k)).collect();
    let wave = |t: &f64| 1.5 * (TAU * 1.3 * (t - 100.0) + 0.7).sin() + 4.0;
    let recording = Recording {
        name: "sine".to_owned(),
        u: t.iter().map(|t| 0.1 * (t - 100.0)).collect(),
        x: t.iter().map(|t| wave(t) + noise.sample(&mut rng)).collect(),
        units: Units { u: "V".to_owned(), x: "rad".to_owned() },
        t,
        ..Recording::default()
    };
    let path = folder.join("sine.csv");
    recording.write(&path).unwrap();
    path
}

/// The names are those of docs/formats.md, section "sinefit". The values lie within 5 of their own standard errors.
/// These are those of the Cramér–Rao bound (docs/theory.md, section 3: 2.8e-4 rad for the amplitude, 9.2e-5 rad/s for
/// ω).
#[test]
fn sinefit_prints_the_document_of_the_contract() {
    let folder = tempfile::tempdir().unwrap();
    let path = sine(folder.path());
    let path = path.to_str().unwrap();
    for guess in [&[][..], &["--period", "0.5"], &["--period", "1.2"]] {
        let run = breakaway(&[&["sinefit", path, "--json"], guess].concat());
        assert_eq!((run.status.code(), text(&run.stderr)), (Some(0), ""));
        let document: serde_json::Value = serde_json::from_slice(&run.stdout).unwrap();
        let mut keys: Vec<&str> = document.as_object().unwrap().keys().map(String::as_str).collect();
        keys.sort_unstable();
        assert_eq!(
            keys,
            ["amplitude", "cycles", "offset", "omega", "phase", "phase_centre", "rms", "schema_version", "se"]
        );
        let number = |key: &str| document[key].as_f64().unwrap();
        let error = |key: &str| document["se"][key].as_f64().unwrap();
        let centre = (TAU * 1.3 * 4.9995 + 0.7) % TAU;
        let truth = [
            ("amplitude", 1.5),
            ("omega", TAU * 1.3),
            ("phase", 0.7),
            ("phase_centre", if centre > TAU / 2.0 { centre - TAU } else { centre }),
            ("offset", 4.0),
        ];
        for (key, truth) in truth {
            assert!((number(key) - truth).abs() < 5.0 * error(key), "{key}: {}", number(key));
        }
        // The noise is estimated within 0.7 % (1/√(2N)), and the closed form leaves the offset out, which costs about 1 % at 13 cycles.
        assert!((error("amplitude") / (SIGMA * (2.0 / 1e4_f64).sqrt()) - 1.0).abs() < 0.03);
        let omega = SIGMA / 1.5 * (24.0 / (1e-6 * 1e12_f64)).sqrt();
        assert!((error("omega") / omega - 1.0).abs() < 0.05, "{}", error("omega") / omega);
        // 10 000 samples of noise: the sample deviation is within 5/√(2·10⁴) = 3.5 %.
        assert!((number("rms") / SIGMA - 1.0).abs() < 0.035);
        assert!((number("cycles") - 13.0).abs() < 0.01);
    }
}

#[test]
fn sinefit_takes_a_window_and_prints_a_table_for_people() {
    let folder = tempfile::tempdir().unwrap();
    let path = sine(folder.path());
    let path = path.to_str().unwrap();
    let run = breakaway(&["sinefit", path, "--from", "102", "--to", "104"]);
    assert_eq!(run.status.code(), Some(0));
    let amplitude = text(&run.stdout).lines().next().unwrap();
    assert!(amplitude.starts_with("amplitude") && amplitude.ends_with("rad"), "{amplitude}");
    let outside = breakaway(&["sinefit", path, "--from", "200", "--json"]);
    let document: serde_json::Value = serde_json::from_slice(&outside.stdout).unwrap();
    assert_eq!((outside.status.code(), &document["error"]["kind"]), (Some(1), &"outside_window".into()));
    assert!(
        text(&outside.stderr)
            .ends_with("sine.csv: no row from 200 s to inf s; the recording runs from 100 s to 109.999 s\n"),
        "{}",
        text(&outside.stderr)
    );
}

#[test]
fn work_that_cannot_be_done_is_exit_code_1_with_the_reason_on_standard_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = sine(folder.path());
    let path = path.to_str().unwrap();
    for (arguments, wanted) in [
        (&["sinefit", "no/such.csv"][..], "error: no/such.csv: no such file; check the path\n"),
        (
            &["sinefit", path, "--signal", "X"],
            "no column `X`; did you mean `x`?; name it with --signal; columns: t, u, x\n",
        ),
        (&["sinefit", path, "--period", "1e-3"], "it must be more than 2.0000e-3 s\n"),
        (&["sinefit", path, "--to", "100.3"], "give a better --period, or record more cycles\n"),
        (&["sinefit", folder.path().to_str().unwrap()], "/*.csv\n"),
    ] {
        let run = breakaway(arguments);
        assert_eq!((run.status.code(), text(&run.stdout)), (Some(1), ""), "{arguments:?}");
        assert!(text(&run.stderr).ends_with(wanted), "{}", text(&run.stderr));
    }
}

#[test]
fn wrong_usage_is_exit_code_2() {
    for arguments in [
        &[][..],
        &["sinfit", "a.csv"],
        &["sinefit"],
        &["sinefit", "a.csv", "--fs", "-1"],
        &["sinefit", "a.csv", "--period", "0"],
        &["sinefit", "a.csv", "--where", "on"],
        &["sinefit", "a.csv", "--from", "3", "--to", "-2"],
    ] {
        let run = breakaway(arguments);
        assert_eq!((run.status.code(), text(&run.stdout)), (Some(2), ""), "{arguments:?}");
        assert!(!run.stderr.is_empty());
    }
}

#[test]
fn every_command_has_help_with_an_example() {
    let help = breakaway(&["--help"]);
    assert_eq!(help.status.code(), Some(0));
    let listed = text(&help.stdout).split("Commands:").nth(1).unwrap();
    let commands: Vec<&str> = listed
        .lines()
        .skip(1)
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.split_whitespace().next())
        .filter(|name| *name != "help")
        .collect();
    assert!(commands.contains(&"sinefit"), "{commands:?}");
    for command in commands {
        let help = breakaway(&[command, "--help"]);
        let help = text(&help.stdout);
        assert!(help.contains("Example") && help.contains("--json"), "{command}: {help}");
        assert!(help.contains(&format!("\n  breakaway {command} ")), "{command}: {help}");
    }
}

/// The scripts know every command, and the manual has a page for each one and each of theirs.
#[test]
fn completions_and_manual_pages_cover_every_command() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = breakaway(&["completions", shell]);
        let script = text(&script.stdout);
        for word in ["sinefit", "virtual-board", "holdout", "fleet"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    assert_eq!(breakaway(&["completions", "cmd"]).status.code(), Some(2));
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("man1");
    let run = breakaway(&["man", "-o", pages.to_str().unwrap()]);
    assert_eq!(run.status.code(), Some(0), "{}", text(&run.stderr));
    for (page, words) in [
        ("breakaway", "breakaway\\-sinefit"),
        ("breakaway-discover", "\\-\\-holdout"),
        ("breakaway-device-settings-set", ".TH breakaway-device-settings-set 1"),
    ] {
        let page = std::fs::read_to_string(pages.join(format!("{page}.1"))).unwrap();
        assert!(page.contains(words), "{page}");
    }
    let one = breakaway(&["man"]);
    assert_eq!(text(&one.stdout), std::fs::read_to_string(pages.join("breakaway.1")).unwrap());
}
