//! The command line: which command is run, and with which exit code it ends.

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use super::console::{self, Verbosity};
use super::failure::Failure;
use super::output::{self, Output};
use super::{
    UsageError, bode, capture, completions, demo, device, discover, effects, export, identify, look, man, models,
    monitor, simulate, sinefit, track, tune, virtual_board,
};
use crate::device::DeviceError;
use crate::recording::RecordingError;

/// Identify, simulate and discover friction in a servo axis.
#[derive(Debug, Parser)]
#[command(name = "breakaway", version, propagate_version = true)]
#[allow(clippy::struct_excessive_bools, reason = "four switches of a command line, each by itself")]
pub struct Cli {
    /// Print one JSON document on standard output; everything else goes to standard error
    #[arg(long, global = true)]
    pub json: bool,
    /// Replace files that breakaway did not write, and recordings of an earlier session; never an input
    #[arg(long, global = true)]
    pub force: bool,
    /// No progress and no warnings on standard error, only errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Say on standard error what is being done, a line for each step
    #[arg(short, long, global = true)]
    pub verbose: bool,
    /// What to do.
    #[command(subcommand)]
    pub command: CliCommand,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum CliCommand {
    /// Show everything on a simulated axis: relay experiment, sine fit, model
    Demo(demo::Args),
    /// Run an experiment, or the standard suite, on the simulated plant or on a board
    Run(super::run::Args),
    /// Make a recording from a model, with any effects, and an experiment
    Simulate(simulate::Args),
    /// Find where simulation and recordings disagree, name the missing effect, add it to the model
    Discover(discover::Args),
    /// List what is in a log, guess time, drive and position, say what is wrong, print the command to identify
    Look(look::Args),
    /// Identify inertia, viscous and Coulomb friction from recordings, with standard errors
    Identify(identify::Args),
    /// Frequency response from drive to position: gain, phase, coherence, resonances, delay
    Bode(bode::Args),
    /// The catalogue of effects: law, parameters, what shows each, what it is confused with
    Effects(effects::Args),
    /// Write a model for MuJoCo, URDF, SDF, Isaac Lab, Modelica or C, with what is lost
    Export(export::Args),
    /// The motor library: cards of identified machines
    Models(models::Args),
    /// Run the firmware on a virtual board: QEMU with a simulated plant, behind a pseudo-terminal
    VirtualBoard(virtual_board::Args),
    /// Fit a sine: amplitude, frequency, phase, offset, with standard errors
    Sinefit(sinefit::Args),
    /// Record what a board measures, until Ctrl-C
    Capture(capture::Args),
    /// Watch a board live: position, drive, mode, rates, drops, faults
    Monitor(monitor::Args),
    /// Read and command a board: identity, settings, model, faults
    Device(device::Args),
    /// Follow a reference in closed loop, with and without compensation
    Track(track::Args),
    /// Tune a controller from a model: PID gains, compensator, adaptive start values, margins
    Tune(tune::Args),
    /// Write the completions of a shell
    Completions(completions::Args),
    /// Write the manual pages
    Man(man::Args),
}

/// Reads the command line. Exit code 2 and the reason, on standard error and with `--json` as a document, where it is wrong.
///
/// # Errors
/// The exit code, where there is no command to run: wrong usage, or help and version, which are printed.
pub fn parse() -> Result<Cli, ExitCode> {
    Cli::try_parse().map_err(|error| {
        // Nothing can be done where the terminal is gone.
        let _ = error.print();
        if error.use_stderr() && std::env::args_os().any(|argument| argument == "--json") {
            Failure::of_usage(&error).print();
        }
        ExitCode::from(if error.use_stderr() { 2 } else { 0 })
    })
}

/// Runs a command. Exit code 0: done; 1: the work could not be done, the reason is on standard error; 2: wrong usage.
pub fn run(cli: Cli) -> ExitCode {
    console::set(match (cli.quiet, cli.verbose) {
        (true, _) => Verbosity::Quiet,
        (_, true) => Verbosity::Verbose,
        _ => Verbosity::Normal,
    });
    let output = Output { json: cli.json, force: cli.force, taken: false };
    let result = match cli.command {
        CliCommand::Demo(args) => args.run(output),
        CliCommand::Run(args) => args.run(output),
        CliCommand::Simulate(args) => args.run(output),
        CliCommand::Discover(args) => args.run(output),
        CliCommand::Look(args) => args.run(output),
        CliCommand::Identify(args) => args.run(output),
        CliCommand::Bode(args) => args.run(output),
        CliCommand::Effects(args) => args.run(output),
        CliCommand::Export(args) => args.run(output),
        CliCommand::Models(args) => args.run(output),
        CliCommand::Sinefit(args) => args.run(output),
        CliCommand::VirtualBoard(args) => args.run(output),
        CliCommand::Capture(args) => args.run(output),
        CliCommand::Monitor(args) => args.run(output),
        CliCommand::Device(args) => args.run(output),
        CliCommand::Track(args) => args.run(output),
        CliCommand::Tune(args) => args.run(output),
        CliCommand::Completions(args) => args.run(output),
        CliCommand::Man(args) => args.run(output),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // `{:#}` is the whole chain of causes, on one line.
            eprintln!("error: {error:#}");
            if output.json && !output::has_printed() {
                Failure::of(&error).print();
            }
            let interrupted = matches!(error.downcast_ref(), Some(DeviceError::Interrupted));
            ExitCode::from(match () {
                () if error.is::<UsageError>() => 2,
                () if matches!(error.downcast_ref(), Some(RecordingError::WindowReversed { .. })) => 2,
                () if interrupted => crate::interrupt::INTERRUPTED,
                () => 1,
            })
        }
    }
}
