//! The files that a command line reads and writes.

use std::path::{Path, PathBuf};

use breakaway::command::models::Action;
use breakaway::command::{Cli, CliCommand};
use breakaway::file::Target;

/// Files and folders of a command line, as they stand there.
#[derive(Debug, Default)]
pub struct Files {
    /// Read.
    pub reads: Vec<PathBuf>,
    /// Written; a folder stands for all in it.
    pub writes: Vec<PathBuf>,
}

impl Files {
    /// Those of a command. A new command is a missing arm here.
    pub fn of(cli: &Cli) -> Self {
        let mut files = Self::default();
        let some = |path: &Option<PathBuf>| path.clone().into_iter().collect::<Vec<_>>();
        // Standard output is no file.
        let target = |target: &Option<Target>| match target {
            Some(Target::File(path)) => vec![path.clone()],
            Some(Target::Standard) | None => Vec::new(),
        };
        match &cli.command {
            CliCommand::Demo(a) => files.writes.push(a.output.clone()),
            CliCommand::Run(a) => {
                if a.experiment != "suite" {
                    files.reads.push(a.experiment.clone().into());
                }
                files.reads.extend(some(&a.model));
                files.writes.push(a.output.clone());
            }
            CliCommand::Simulate(a) => {
                files.reads.extend([a.model.clone(), a.experiment.clone()]);
                files.writes = target(&Some(a.output.clone()));
            }
            CliCommand::Discover(a) => {
                files.reads.extend([a.recordings.clone(), a.holdout.clone(), some(&a.model), some(&a.fleet)].concat());
                files.writes.extend([target(&a.output), target(&a.report), some(&a.figures.figures)].concat());
            }
            CliCommand::Identify(a) => {
                files.reads.clone_from(&a.recordings);
                files.writes = [target(&a.output), some(&a.figures.figures)].concat();
            }
            CliCommand::Look(a) => {
                files.reads.clone_from(&a.files);
                files.reads.extend(a.columns.dbc.clone());
                files.writes = [target(&a.figure), some(&a.figures.figures)].concat();
            }
            CliCommand::Bode(a) => {
                files.reads.clone_from(&a.recordings);
                files.reads.extend(a.columns.dbc.clone());
                files.writes = [target(&a.figure), some(&a.figures.figures)].concat();
            }
            CliCommand::Sinefit(a) => {
                files.reads.push(a.recording.clone());
                files.writes = some(&a.figures.figures);
            }
            CliCommand::VirtualBoard(a) => {
                files.reads.extend([some(&a.plant), some(&a.image)].concat());
                files.writes = some(&a.flash);
            }
            CliCommand::Capture(a) => files.writes.push(a.output.clone()),
            CliCommand::Track(a) => {
                files.reads = [vec![a.model.clone()], some(&a.controller), some(&a.plant)].concat();
                if !a.reference.contains(':') {
                    files.reads.push(a.reference.clone().into());
                }
                files.writes = [some(&a.output), target(&a.report), some(&a.figures.figures)].concat();
            }
            CliCommand::Tune(a) => {
                files.reads.push(a.model.clone());
                files.writes = target(&a.output);
            }
            CliCommand::Export(a) => {
                files.reads.push(a.model.clone());
                files.writes = target(&a.output);
            }
            CliCommand::Models(a) => match &a.action {
                Action::Show(a) => files.writes = target(&a.output),
                Action::Add(a) => {
                    files.reads = [a.recordings.clone(), vec![a.model.clone()]].concat();
                    files.writes = target(&Some(a.output.clone()));
                }
                Action::List | Action::Compare(_) => {}
            },
            CliCommand::Man(a) => files.writes = some(&a.output),
            CliCommand::Effects(_) | CliCommand::Monitor(_) | CliCommand::Device(_) | CliCommand::Completions(_) => {}
        }
        files
    }

    /// Whether `path` is one of `written`, or in one of them.
    pub fn covers(written: &[PathBuf], path: &Path) -> bool {
        written.iter().any(|written| path.starts_with(written))
    }
}
