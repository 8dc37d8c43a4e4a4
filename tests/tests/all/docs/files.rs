//! The files that a command line reads and writes.

use std::path::{Path, PathBuf};

use breakaway::command::{Cli, Command};
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
            Command::Demo(a) => files.writes.push(a.output.clone()),
            Command::Run(a) => {
                if a.experiment != "suite" {
                    files.reads.push(a.experiment.clone().into());
                }
                files.reads.extend(some(&a.model));
                files.writes.push(a.output.clone());
            }
            Command::Simulate(a) => {
                files.reads.extend([a.model.clone(), a.experiment.clone()]);
                files.writes = target(&Some(a.output.clone()));
            }
            Command::Discover(a) => {
                files.reads.extend([a.recordings.clone(), a.holdout.clone(), some(&a.model), some(&a.fleet)].concat());
                files.writes.extend([target(&a.output), target(&a.report)].concat());
            }
            Command::Identify(a) => {
                files.reads.clone_from(&a.recordings);
                files.writes = target(&a.output);
            }
            Command::Sinefit(a) => files.reads.push(a.recording.clone()),
            Command::VirtualBoard(a) => {
                files.reads.extend([some(&a.plant), some(&a.image)].concat());
                files.writes = some(&a.flash);
            }
            Command::Capture(a) => files.writes.push(a.output.clone()),
            Command::Track(a) => {
                files.reads = [vec![a.model.clone()], some(&a.controller), some(&a.plant)].concat();
                if !a.reference.contains(':') {
                    files.reads.push(a.reference.clone().into());
                }
                files.writes = [some(&a.output), target(&a.report)].concat();
            }
            Command::Tune(a) => {
                files.reads.push(a.model.clone());
                files.writes = target(&a.output);
            }
            Command::Man(a) => files.writes = some(&a.output),
            Command::Effects(_) | Command::Monitor(_) | Command::Device(_) | Command::Completions(_) => {}
        }
        files
    }

    /// Whether `path` is one of `written`, or in one of them.
    pub fn covers(written: &[PathBuf], path: &Path) -> bool {
        written.iter().any(|written| path.starts_with(written))
    }
}
