//! The loop on the virtual board, from an unknown effect to its compensation: run suite → identify → discover → tune
//! → load the model over the link → track. One course of it for every effect.

use std::path::Path;

use breakaway::command::run::papers_plant;
use breakaway::command::track::Course;
use breakaway::control::design::Design;
use breakaway::device::experiment::{Runner, TrackRun, pid};
use breakaway::device::model::to_wire;
use breakaway::interrupt::finish_first;
use breakaway::model::Model;
use breakaway_core::link::BAUD;
use serde_json::Value;

use crate::bench::{options, start};
use crate::identify::breakaway;

/// What is hidden, and what is followed afterwards.
#[derive(Clone, Copy, Debug)]
pub struct Hidden {
    /// Name in the catalogue: what discovery has to say.
    pub name: &'static str,
    /// Its parameters, as in a model file.
    pub parameters: &'static str,
    /// A slow sine with its reversals, amplitude (rad) and frequency (Hz).
    pub sine: (f64, f64),
}

/// RMS errors of tracking, rad, against the encoder.
#[derive(Clone, Debug)]
pub struct Closed {
    /// PID alone.
    pub pid: f64,
    /// Base model compensated.
    pub base: f64,
    /// Base and discovered effect.
    pub whole: f64,
    /// The adaptive law beside the discovered effect.
    pub adaptive: f64,
    /// The true plant as the model, same gains.
    pub truth: f64,
    /// Encoder step, rad.
    pub step: f64,
    /// What `breakaway track` said.
    pub tracked: Value,
}

/// The files of a role, after `breakaway run suite`.
fn recordings(suite: &Value, role: &str) -> Vec<String> {
    let all = suite["recordings"].as_array().unwrap().iter();
    all.filter(|one| one["role"] == role).map(|one| one["file"].as_str().unwrap().to_owned()).collect()
}

fn run<'a>(command: &'a [&'a str], files: &'a [String]) -> Vec<&'a str> {
    command.iter().copied().chain(files.iter().map(String::as_str)).collect()
}

/// Errors of a run of `track`, rms, position units.
pub fn rms(tracked: &Value, name: &str) -> f64 {
    let run = tracked["runs"].as_array().unwrap().iter().find(|run| run["name"] == name);
    run.unwrap_or_else(|| panic!("{name} is not in {tracked}"))["rms"].as_f64().unwrap()
}

/// Closes the loop in a folder, which then holds `tracked/` and `track.html`.
///
/// Followed are two periods of the sine, of which the last one and a half count.
pub fn close(hidden: Hidden, folder: &Path) -> Closed {
    let path = |name: &str| folder.join(name).display().to_string();
    papers_plant().write(path("plant.toml").as_ref()).unwrap();
    let effect = format!("\n[[effect]]\nname = \"{}\"\n{}\n", hidden.name, hidden.parameters);
    std::fs::write(path("plant.toml"), std::fs::read_to_string(path("plant.toml")).unwrap() + &effect).unwrap();
    let plant = Model::read(path("plant.toml").as_ref()).unwrap();
    let mut options = options(&plant);
    options.speed = 6.0;
    let board = start(&options);
    let port = board.port.as_str();

    let suite = breakaway(&["run", "suite", "--port", port, "-o", &path("session")]);
    let (fit, score) = (recordings(&suite, "fit"), recordings(&suite, "score"));
    assert_eq!((fit.len(), score.len()), (5, 3), "{suite}");
    breakaway(&run(&["identify", "-o", &path("base.toml")], &fit));
    let discovered = path("discovered.toml");
    let arguments = [fit, vec!["--holdout".into()], score].concat();
    let found = breakaway(&run(&["discover", "-o", &discovered], &arguments));
    let names: Vec<&str> = found["effects"].as_array().unwrap().iter().map(|e| e["name"].as_str().unwrap()).collect();
    assert_eq!(names, [hidden.name], "{found}");

    // 6 Hz, a small part of what the tick allows: a loop that is stiffer leaves less to compensate.
    let controller = path("controller.toml");
    breakaway(&["tune", &discovered, "--bandwidth", "6", "--drive-limit", "5", "-o", &controller]);
    breakaway(&["device", "--port", port, "model", "load", &discovered]);

    let (amplitude, frequency_hz) = hidden.sine;
    let (duration, settle) = (2.0 / frequency_hz, 0.5 / frequency_hz);
    let reference = format!("sine:{amplitude},{frequency_hz}");
    let model = ["track", "--model", &discovered, "--controller", &controller, "--port", port];
    let [long, from] = [duration, settle].map(|time| time.to_string());
    let course = ["--reference", &reference, "--duration", &long, "--settle", &from];
    let files = ["-o", &path("tracked"), "--report", &path("track.html")];
    let tracked = breakaway(&[&model[..], &course, &files].concat());
    assert!(tracked["runs"].as_array().unwrap().iter().all(|run| run["missing"] == 0), "{tracked}");

    let mut runner = Runner::connect(port, BAUD).unwrap();
    let tick_s = runner.scale.tick_s();
    let design = Design::read(controller.as_ref()).unwrap();
    let course = Course::new(reference.parse().unwrap(), Some(duration), Some(settle), tick_s).unwrap();
    let truth = TrackRun {
        name: "truth",
        model: &to_wire(&plant, &runner.scale).unwrap(),
        compensate: true,
        controller: pid(&design.gains),
        reference: &course.reference,
        points: &course.points,
        from: course.from,
        drive_limit: design.drive_limit,
    };
    let truth = runner.follow(&truth, &finish_first()).unwrap();
    assert_eq!(truth.missing, 0);
    let closed = Closed {
        pid: rms(&tracked, "pid"),
        base: rms(&tracked, "base"),
        whole: rms(&tracked, "model"),
        adaptive: rms(&tracked, "adaptive"),
        truth: truth.tracked.rms(),
        step: options.machine.encoder_step,
        tracked,
    };
    let Closed { pid, base, whole, adaptive, truth, step, .. } = closed;
    println!("{}: discovered {}", hidden.name, found["effects"][0]["parameters"]);
    // A line of the table of docs/control.md, mrad.
    let [a, b, c, d, e] = [pid, base, whole, truth, adaptive].map(|error| format!("{:.2}", 1e3 * error));
    println!(
        "| {} | `{reference}` | {a} | {b} | {c} | {d} | {:.1} | {:.1} | {:.2} | {e} |",
        hidden.name,
        base / whole,
        pid / whole,
        whole / truth
    );
    println!("whole model: {:.2} encoder steps", whole / step);
    closed
}
