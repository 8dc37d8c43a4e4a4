//! The pages, so that they cannot rot. The real readers read the examples of docs/formats.md. The real definition of
//! the command parses every command line, and every file that it needs comes from somewhere. The lines of the README
//! and of the tutorial are run in host/tests/all/walk.rs; those of `cargo xtask` are parsed in xtask.

mod citations;
mod commands;
mod files;
mod releases;
mod sentences;
mod site;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use breakaway::command::Cli;
use breakaway::model::Model;
use breakaway::recording::{ReadOptions, Recording};
use breakaway::simulate::experiment::{Excitation, Experiment};
use clap::Parser;
use commands::{Program, lines, pages, root, shown};
use files::Files;

/// Files that a page takes from its reader, and what it says they are.
const READERS_OWN: [(&str, &str, &str); 13] = [
    ("README.md", "rec.csv", "A recording is a CSV file"),
    ("docs/adding-an-effect.md", "eddy.toml", "`eddy.toml`, on the plant of the papers"),
    ("docs/case-studies.md", "emps_train.csv", "Both recordings are other people's"),
    ("docs/case-studies.md", "current-sine-2hz.csv", "Both recordings are other people's"),
    ("docs/control.md", "model.toml", "from a model to a tracked reference"),
    ("docs/fleet.md", "machines", "`machines` holds one folder per machine"),
    ("docs/formats.md", "rec.csv", "`rec.csv` is a recording of yours"),
    ("docs/logs.md", "axis.dbc", "DBC says which signals they hold"),
    ("docs/logs.md", "frames.log", "Frames are those of `candump -L`"),
    ("docs/logs.md", "robot.mcap", "reads the log that you have"),
    ("docs/tutorial.md", "export", "$ mkdir -p export held"),
    ("docs/tutorial.md", "held", "$ mkdir -p export held"),
    ("docs/virtual-board.md", "model.toml", "--plant MODEL.toml"),
];
/// Effects that a page adds to the catalogue as its example.
const EXAMPLE_EFFECT: &str = "eddy_brake";

/// The page.
fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/formats.md");
    std::fs::read_to_string(path).expect("docs/formats.md is there")
}

/// The fenced blocks of one language, each with its line.
fn blocks(page: &str, language: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let mut open: Option<(usize, String, bool)> = None;
    for (number, line) in page.lines().enumerate() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(info)) => open = Some((number + 1, String::new(), info.trim() == language)),
            (Some(_), Some(_)) => {
                if let Some((at, text, true)) = open.take() {
                    found.push((at, text));
                }
            }
            (Some((_, text, _)), None) => {
                text.push_str(line);
                text.push('\n');
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "a fenced block is not closed");
    found
}

/// Every `toml` example is a model (it has `[base]`) or an experiment, and its reader takes it. Each kind of
/// excitation and of reference has an example.
#[test]
fn toml_examples_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("example.toml");
    let (mut models, mut kinds) = (0, BTreeMap::<&str, u32>::new());
    let mut seen = |name| *kinds.entry(name).or_default() += 1;
    for (line, text) in blocks(&page(), "toml") {
        std::fs::write(&file, &text).unwrap();
        if text.contains("[base]") {
            let model = Model::read(&file).unwrap_or_else(|error| panic!("docs/formats.md:{line}: {error}"));
            // What is written is what was read.
            assert_eq!(Model::parse("again", &model.to_toml()).unwrap(), model, "docs/formats.md:{line}");
            models += 1;
            continue;
        }
        let experiment = Experiment::read(&file).unwrap_or_else(|error| panic!("docs/formats.md:{line}: {error}"));
        seen(match &experiment.excitation {
            Excitation::Relay { .. } => "relay",
            Excitation::Multisine { .. } => "multisine",
            Excitation::Sine { .. } => "sine",
            Excitation::Ramp { .. } => "ramp",
            Excitation::Track { .. } => "track",
        });
    }
    assert!(models >= 1);
    assert_eq!(kinds.keys().copied().collect::<Vec<_>>(), ["multisine", "ramp", "relay", "sine", "track"]);
}

/// Every `csv` example is a recording, and what the page says of it holds: 8 rows and more, the tick, the units, the gap.
#[test]
fn recording_examples_are_read() {
    let page = page();
    let examples = blocks(&page, "csv");
    let [(_, own), (_, strange)] = examples.as_slice() else { panic!("two csv examples") };
    let recording = Recording::read_from("own.csv", own.as_bytes(), &ReadOptions::default()).unwrap();
    assert_eq!((recording.units.u.as_str(), recording.units.x.as_str()), ("V", "rad"));
    assert_eq!(recording.encoder_step, Some(0.001));
    assert_eq!(recording.gaps, [6]);
    assert_eq!(recording.meta.get("experiment").map(String::as_str), Some("relay_high"));
    let mut written = Vec::new();
    recording.write_to(&mut written).unwrap();
    let again = Recording::read_from("own.csv", written.as_slice(), &ReadOptions::default()).unwrap();
    assert_eq!(again, recording);

    let options = ReadOptions {
        time: Some("t_ms".into()),
        input: Some("iq_A".into()),
        position: Some("angle [rad]".into()),
        select: vec!["mode=2".parse().unwrap()],
        ..ReadOptions::default()
    };
    let recording = Recording::read_from("strange.csv", strange.as_bytes(), &options).unwrap();
    assert_eq!((recording.units.u.as_str(), recording.units.x.as_str()), ("A", "rad"));
    assert!((recording.t[1] - recording.t[0] - 0.002).abs() < 1e-12);
    assert_eq!((recording.t.len(), recording.gaps.as_slice()), (8, &[4][..]));
}

/// Every `json` example is JSON with the keys that the commands promise (command-line contract).
#[test]
fn json_examples_have_the_promised_keys() {
    let page = page();
    let examples = blocks(&page, "json");
    let documents: Vec<serde_json::Value> = examples
        .iter()
        .map(|(line, text)| serde_json::from_str(text).unwrap_or_else(|e| panic!("{line}: {e}")))
        .collect();
    let [error, sinefit, identify] = documents.as_slice() else { panic!("three json examples") };
    for key in ["kind", "message", "file", "line", "column", "hint"] {
        assert!(error["error"].get(key).is_some(), "error: {key}");
    }
    for key in ["amplitude", "omega", "phase", "phase_centre", "offset", "rms", "se", "cycles"] {
        assert!(sinefit.get(key).is_some(), "sinefit: {key}");
    }
    for key in
        ["b", "c", "f1", "load", "undetermined", "noise", "estimator", "estimators", "chosen_because", "schema_version"]
    {
        assert!(identify.get(key).is_some(), "identify: {key}");
    }
}

/// Every command line of every page. The command and its options exist, and the effect that it names is in the
/// catalogue. Its files come from the reader, from the page or from an earlier line.
#[test]
fn command_lines_parse_and_their_files_come_from_somewhere() {
    let mut own: BTreeSet<(&str, &str)> = BTreeSet::new();
    let mut seen = 0;
    for (page, text) in pages() {
        let mut there: Vec<PathBuf> = Vec::new();
        for (given, file, words) in READERS_OWN.iter().filter(|row| row.0 == page) {
            assert!(text.contains(words), "{given} no longer says what {file} is: {words}");
            there.push(file.into());
        }
        let shown = shown(&text);
        for line in lines(&page, &text).iter().filter(|line| line.program == Program::Breakaway) {
            let place = &line.place;
            let words = ["breakaway".to_owned()].into_iter().chain(line.words());
            let cli = Cli::try_parse_from(words).unwrap_or_else(|error| panic!("{place}: {error}"));
            there.extend(shown.iter().filter(|file| file.0 < line.index).map(|file| PathBuf::from(&file.1)));
            let files = Files::of(&cli);
            for read in &files.reads {
                let found = Files::covers(&there, read) || root().join(read).exists();
                assert!(found, "{place}: {} comes from nowhere on this page", read.display());
                own.extend(
                    READERS_OWN.iter().filter(|row| row.0 == page && read.starts_with(row.1)).map(|r| (r.0, r.1)),
                );
            }
            there.extend(files.writes);
            if let breakaway::command::CliCommand::Effects(args) = &cli.command
                && let Some(name) = args.name.as_deref().filter(|name| *name != EXAMPLE_EFFECT)
            {
                assert!(breakaway_core::plant::Kind::ALL.iter().any(|kind| kind.name() == name), "{place}: {name}");
            }
            seen += 1;
        }
    }
    for (page, file, _) in READERS_OWN {
        assert!(own.contains(&(page, file)), "{page} no longer reads {file}: take it off the list");
    }
    // The README alone has 18.
    assert!(seen >= 30, "only {seen} command lines were found: is the way they are written still recognised?");
}

/// The examples of the help texts, of a command and of the commands below it.
fn help_examples(command: &clap::Command, found: &mut Vec<Vec<String>>) {
    let help = command.get_after_help().map(ToString::to_string).unwrap_or_default();
    // Two blanks stand before an example, and four before a line of a page.
    let text = help.replace("\n  ", "\n    ");
    found.extend(lines(command.get_name(), &text).iter().map(commands::Line::words));
    command.get_subcommands().for_each(|below| help_examples(below, found));
}

/// Every example of the help is a command line that the command takes.
#[test]
fn help_examples_parse() {
    let mut examples = Vec::new();
    help_examples(&<Cli as clap::CommandFactory>::command(), &mut examples);
    assert!(examples.len() >= 30, "only {} examples were found", examples.len());
    for words in examples {
        let all = ["breakaway".to_owned()].into_iter().chain(words.clone());
        Cli::try_parse_from(all).unwrap_or_else(|error| panic!("breakaway {}: {error}", words.join(" ")));
    }
}

/// Links between the pages lead somewhere.
#[test]
fn links_lead_to_files() {
    let mut seen = 0;
    for (page, text) in pages() {
        let folder = root().join(&page).parent().map(Path::to_path_buf).unwrap_or_default();
        for (number, line) in text.lines().enumerate() {
            for target in line.split("](").skip(1).filter_map(|rest| rest.split([')', '#']).next()) {
                if target.is_empty() || target.contains("://") {
                    continue;
                }
                assert!(folder.join(target).exists(), "{page}:{}: {target} is not there", number + 1);
                seen += 1;
            }
        }
    }
    assert!(seen >= 10, "only {seen} links were found");
}

/// Tests, examples and benches that the pages name by `--test`, `--example` and `--bench` are there.
#[test]
fn named_tests_and_examples_exist() {
    let folder = |package: &str| match package {
        "breakaway-core" => "core",
        "breakaway-firmware" => "firmware",
        "breakaway-tests" => "tests",
        "breakaway" => "host",
        other => panic!("package {other}"),
    };
    let mut seen = 0;
    for (page, text) in pages() {
        for command in text.split('`').filter(|part| part.contains("cargo ") && part.contains(" -p ")) {
            let words: Vec<&str> = command.split_whitespace().collect();
            let after = |flag: &str| words.iter().position(|word| *word == flag).and_then(|at| words.get(at + 1));
            let package = root().join(folder(after("-p").unwrap()));
            for (flag, place) in [("--test", "tests"), ("--example", "examples"), ("--bench", "benches")] {
                let Some(name) = after(flag) else { continue };
                let file = package.join(place).join(name);
                let found = file.with_extension("rs").exists() || file.join("main.rs").exists();
                assert!(found, "{page}: `{command}`: no {name} in {}", package.join(place).display());
                // Of a program with all tests a module may be named, right behind it.
                let behind = words.iter().position(|word| *word == flag).and_then(|at| words.get(at + 2));
                let module = behind.filter(|_| *name == "all").and_then(|word| word.strip_suffix("::"));
                let is_there =
                    |module: &str| file.join(module).exists() || file.join(module).with_extension("rs").exists();
                assert!(module.is_none_or(is_there), "{page}: `{command}`: no such module");
                seen += 1;
            }
        }
    }
    assert!(seen >= 8, "only {seen} were found");
}

/// No line of a page is longer than 100 characters, outside of tables and blocks. `BREAKAWAY_BLESS=1` breaks the lines; what
/// has no place for a break (an address, a command in code) stays.
#[test]
fn lines_are_no_longer_than_a_person_reads() {
    for (name, text) in pages() {
        let wrapped = breakaway_tests::markdown::wrapped(&text);
        if std::env::var_os("BREAKAWAY_BLESS").is_some() {
            std::fs::write(root().join(&name), &wrapped).unwrap();
            continue;
        }
        let line = text.lines().zip(wrapped.lines()).position(|(is, should)| is != should);
        assert!(line.is_none(), "{name}:{}: longer than 100 characters, or near it", line.unwrap_or(0) + 1);
    }
}
