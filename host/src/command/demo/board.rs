//! `breakaway demo --virtual`: the loop on the virtual board, from an axis with something hidden in it to its compensation.

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use anyhow::Context;
use breakaway_core::plant::Effect;
use schemars::JsonSchema;
use serde::Serialize;

use super::{Args, hidden, session, write};
use crate::command::discover::improved;
use crate::command::output::Output;
use crate::command::progress;
use crate::command::run::papers_plant;
use crate::command::track::{Course, board};
use crate::command::virtual_board::settings;
use crate::control::design::{DEFAULT_ADAPTATION_RATE, Design, Request as Tuning};
use crate::control::reference::Reference;
use crate::device::experiment::Runner;
use crate::device::virtual_board::{Machine, Options, VirtualBoard};
use crate::discover::engine::discover;
use crate::discover::request::Request;
use crate::file::make_folder;
use crate::interrupt::{FinishFirst, finish_first};
use crate::report::text::quantity;
use crate::report::{discovery, tracking};
use crate::simulate::experiment::Sensor;
use crate::simulate::suite;

/// The board's axis: 1 kHz, steps of 1 mrad, ±5 V.
const TICK_HZ: u32 = 1000;
const ENCODER_STEP: f64 = 1e-3;
const DRIVE: f64 = 5.0;
/// Virtual over real time.
const SPEED: f64 = 6.0;
/// Crossover of the PID, Hz: a soft one, which leaves something to compensate.
const BANDWIDTH_HZ: f64 = 6.0;
/// A slow sine with its reversals.
const REFERENCE: Reference = Reference::Sine { amplitude: 1.0, frequency_hz: 0.1 };

#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document {
    hidden: &'static str,
    found: Vec<&'static str>,
    verdict: &'static str,
    runs: Vec<Row>,
    encoder_step: f64,
    model: String,
    report: String,
    tracking: String,
    seconds: f64,
    #[serde(skip)]
    sentence: String,
    #[serde(skip)]
    unit: String,
}

#[derive(Debug, Serialize, JsonSchema)]
struct Row {
    name: &'static str,
    #[serde(skip)]
    title: &'static str,
    rms: f64,
    peak: f64,
}

/// Hides an effect in the virtual board's axis, runs the suite on it, discovers, tunes, follows a sine, tells it.
///
/// # Errors
/// QEMU or the image is missing; whatever board, discovery or files report.
pub fn run(args: &Args, output: Output) -> anyhow::Result<()> {
    let (begin, interrupt, folder) = (Instant::now(), finish_first(), args.output.as_path());
    make_folder(folder)?;
    let (kind, parameters) = hidden::drawn(args.seed);
    let plant = papers_plant();
    let machine = Machine {
        base: plant.base,
        effects: vec![Effect::new(kind, parameters)],
        tick_hz: TICK_HZ,
        encoder_step: ENCODER_STEP,
        noise: 0.0,
        drive_full_scale: DRIVE,
        seed: args.seed,
    };
    let mut settings = settings(&machine, &plant, 40.0);
    // The host says something every 0.2 s of its own time; the board's runs ahead.
    settings.command_timeout_ms = 20_000;
    let board = VirtualBoard::start(&Options {
        image: None,
        machine,
        settings,
        speed: SPEED,
        flash: None,
        faults: Vec::new(),
        cable: false,
    })?;
    let mut runner = Runner::connect(&board.port, breakaway_core::link::BAUD)?;

    let request = recorded(&mut runner, folder, args.seed, &interrupt)?;
    let spinner = progress::spinner();
    spinner.set_message("discovering");
    let found = discover(&request, &|_| ())?;
    spinner.finish_and_clear();
    let (report, model_file) = (folder.join("discovery.html"), folder.join("improved.toml"));
    write(&report, &discovery::html(&found, &discovery::folds(&request.recordings, &found)))?;
    let model = improved(&found);
    model.write(&model_file)?;

    let (tick_s, encoder_step) = (runner.scale.tick_s(), runner.scale.step);
    let tuning = Tuning {
        tick_s,
        delay_ticks: 1,
        bandwidth_hz: Some(BANDWIDTH_HZ),
        drive_limit: DRIVE,
        encoder_step,
        speed: None,
        acceleration: None,
        adaptation_rate: DEFAULT_ADAPTATION_RATE,
    };
    let design = Design::new(&model, &tuning)?;
    design.write(&folder.join("controller.toml"))?;
    let course = Course::new(REFERENCE, Some(20.0), Some(5.0), tick_s)?;
    let (cases, bench) = board::cases(&mut runner, &model, &design, &course, &interrupt)?;
    let page = folder.join("track.html");
    let reference = course.reference.to_string();
    let axis = format!("the virtual board, {} hidden in its axis", kind.name());
    let story = tracking::Story {
        cases: &cases,
        reference: &reference,
        plant: &axis,
        measured: true,
        units: &model.units,
        bench: &bench,
    };
    write(&page, &tracking::html(&story))?;
    let row = |case: &crate::control::tracking::Case| Row {
        name: case.name,
        title: case.title,
        rms: case.tracked.rms(),
        peak: case.tracked.peak(),
    };
    let document = Document {
        hidden: kind.name(),
        found: found.effects.iter().map(|effect| effect.kind.name()).collect(),
        verdict: found.verdict.name(),
        runs: cases.iter().map(row).collect(),
        encoder_step,
        model: model_file.display().to_string(),
        report: report.display().to_string(),
        tracking: page.display().to_string(),
        seconds: begin.elapsed().as_secs_f64(),
        sentence: crate::report::discovery::sentence::sentence(&found),
        unit: model.units.x.clone(),
    };
    output.print(&document, text)
}

/// The suite on the board: its recordings, written and as discovery takes them.
fn recorded(runner: &mut Runner, folder: &Path, seed: u64, interrupt: &FinishFirst) -> anyhow::Result<Request> {
    let sensor = Sensor { encoder_step: runner.scale.step, noise: 0.0, delay_ticks: 0 };
    let machine = suite::Machine { drive_limit: DRIVE, travel: 5.0, tick_s: runner.scale.tick_s(), sensor, seed };
    let breakaway = suite::breakaway_by(&machine, |ramp| {
        let outcome = runner.run(ramp, interrupt)?;
        outcome.error.map_or(Ok(outcome.run), Err)
    })?;
    let experiments = suite::suite(breakaway.moved_at, &machine);
    let bar = progress::bar("experiments on the virtual board", experiments.len() as u64);
    let request =
        session::recorded(folder, format!("breakaway demo --virtual --seed {seed}"), experiments, |experiment| {
            let outcome = runner.run(experiment, interrupt).with_context(|| experiment.name.clone())?;
            bar.inc(1);
            outcome.error.map_or(Ok(outcome.run.recording), |error| Err(error.into()))
        })?;
    bar.finish_and_clear();
    Ok(request)
}

/// The result for people.
fn text(document: &Document) -> String {
    let mut out = String::from(
        "The firmware runs on a virtual board, whose axis hides an effect. A suite of 8 experiments over the link, \
         discovery and tuning come first. Then each law follows a sine of 1 rad at 0.1 Hz.\n\n",
    );
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{}\nwhat was hidden: {}\n", document.sentence, document.hidden);
    for run in &document.runs {
        let [rms, peak] = [run.rms, run.peak].map(|error| quantity(error, &document.unit, 3));
        let steps = run.rms / document.encoder_step;
        let _ = writeln!(out, "{:<26} error {rms} rms ({steps:.2} encoder steps), {peak} at the most", run.title);
    }
    let Document { model, report, tracking, seconds, .. } = document;
    let _ = writeln!(out, "\nmodel     {model}\nreport    {report}\ntracking  {tracking}\n({seconds:.1} s)");
    out
}
