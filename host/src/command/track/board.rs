//! `breakaway track --port`: the board follows.

use anyhow::Context;

use super::{Args, Course, Followed};
use crate::command::output::Output;
use crate::command::port_args;
use crate::command::progress;
use crate::control::design::{Design, Request};
use crate::control::reference::Reference;
use crate::control::tracking::{Bench, Case, OnBoard};
use crate::device::experiment::{Runner, TrackRun, adaptive, pid};
use crate::device::model::to_wire;
use crate::interrupt::{FinishFirst, finish_first};
use crate::model::Model;

/// Tunes for the board's tick, follows, prints, writes recordings and report.
///
/// # Errors
/// A file; a controller for another tick; whatever board and link report.
pub fn run(args: &Args, port: &str, output: Output) -> anyhow::Result<()> {
    let interrupt = finish_first();
    let model = Model::read(&args.model)?;
    let controller = args.controller.as_deref().map(Design::read).transpose()?;
    let port = &port_args::found(port, args.baud)?;
    let mut runner = Runner::connect(port, args.baud)?;
    port_args::shared(runner.offer(), port);
    let tick_s = runner.scale.tick_s();
    let design = design(args, &model, controller, &runner)?;
    let course = args.course(tick_s)?;
    match course.reference {
        Reference::Sine { amplitude: most, .. } | Reference::Profile { distance: most, .. } => runner.has_room(most)?,
        // The board says that it has no such trajectory.
        Reference::File(_) => {}
    }
    let screen = args.monitor.open(port, args.baud)?;
    let (cases, bench) = cases(&mut runner, &model, &design, &course, &interrupt)?;
    drop(screen);
    let name = format!("{} at {port}", runner.board());
    let units = runner.scale.units.clone();
    args.finish(&course, &cases, &Followed { name: &name, measured: true, units: &units, bench }, output)
}

/// The controller of a file, which is for this board's tick, or one that is tuned for the board.
///
/// # Errors
/// A controller for another tick; a model that cannot be tuned.
pub(super) fn design(
    args: &Args,
    model: &Model,
    controller: Option<Design>,
    runner: &Runner,
) -> anyhow::Result<Design> {
    let (tick_s, encoder_step) = (runner.scale.tick_s(), runner.scale.step);
    if let Some(design) = controller {
        anyhow::ensure!(
            (design.tick_s / tick_s - 1.0).abs() < 1e-6,
            "the controller is for a tick of {} s, the board's is {tick_s} s: tune it with --tick {tick_s}",
            design.tick_s
        );
        return Ok(design);
    }
    let drive_limit = args.tuning.drive_limit.unwrap_or_else(|| runner.drive_limit());
    let request = Request { tick_s, drive_limit, encoder_step, ..args.tuning.request() };
    Design::new(model, &request).with_context(|| args.model.display().to_string())
}

/// Follows the course once with each law: the PID alone, the base model compensated, the whole model compensated if
/// it has effects, the adaptive law.
///
/// # Errors
/// Whatever board and link report.
pub fn cases(
    runner: &mut Runner,
    model: &Model,
    design: &Design,
    course: &Course,
    interrupt: &FinishFirst,
) -> anyhow::Result<(Vec<Case>, Bench)> {
    let (tick_s, encoder_step) = (runner.scale.tick_s(), runner.scale.step);
    let drive_limit = design.drive_limit.min(runner.drive_limit());
    let whole = to_wire(model, &runner.scale)?;
    let base = to_wire(&Model { effects: Vec::new(), ..model.clone() }, &runner.scale)?;
    let law = pid(&design.gains);
    let mut plan = vec![("pid", "PID alone", &base, false, law), ("base", "base model compensated", &base, true, law)];
    if !whole.effects.is_empty() {
        plan.push(("model", "whole model compensated", &whole, true, law));
    }
    plan.push(("adaptive", "adaptive law", &whole, true, adaptive(design, &course.points)));
    let bar = progress::bar("runs", plan.len() as u64);
    let mut cases = Vec::new();
    for (name, title, model, compensate, controller) in plan {
        let run = TrackRun {
            name,
            model,
            compensate,
            controller,
            reference: &course.reference,
            points: &course.points,
            from: course.from,
            drive_limit,
        };
        let followed = runner.follow(&run, interrupt).context(title)?;
        let board = Some(OnBoard { missing: followed.missing, mismatches: followed.mismatches });
        cases.push(Case { name, title, tracked: followed.tracked, board });
        bar.inc(1);
    }
    bar.finish_and_clear();
    let bench = Bench { tick_s, delay_ticks: design.delay_ticks, encoder_step, noise: 0.0, drive_limit, seed: 0 };
    Ok((cases, bench))
}
