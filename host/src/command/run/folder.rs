//! The folder of a run: what it holds already, and what may be replaced.

use std::path::{Path, PathBuf};

use anyhow::Context;

use super::Args;
use crate::command::console;
use crate::command::output::Output;
use crate::file::{FileKind, TargetError, inside, may_write};
use crate::recording::Container;
use crate::simulate::experiment::Experiment;

/// Endings of recordings.
const ENDINGS: [&str; 3] = [Container::Csv.ending(), Container::Mcap.ending(), Container::Parquet.ending()];

impl Args {
    /// Checks before the axis moves what is to be written: the recording of one experiment, or a suite's session.
    pub(super) fn claim(&self, file: Option<&Experiment>, output: Output) -> anyhow::Result<()> {
        let folder = output.folder(&self.output, "a folder")?;
        let Some(experiment) = file else {
            let recordings = self.session().len();
            if recordings > 0 && !output.force {
                return Err(TargetError::Session { folder: folder.display().to_string(), recordings }.into());
            }
            return Ok(());
        };
        let inputs: Vec<&Path> = [Path::new(&self.experiment)].into_iter().chain(self.model.as_deref()).collect();
        let path = inside(folder, &experiment.name, self.format.ending())?;
        if path.exists() {
            output.may_write(&path, FileKind::Recording, &inputs)?;
        }
        Ok(())
    }

    /// The recordings of the session in the folder.
    fn session(&self) -> Vec<PathBuf> {
        let files = ["fit", "score"].into_iter().filter_map(|part| std::fs::read_dir(self.output.join(part)).ok());
        let paths = files.flatten().filter_map(|entry| Some(entry.ok()?.path()));
        let mut found: Vec<PathBuf> = paths
            .filter(|path| ENDINGS.iter().any(|ending| path.extension().is_some_and(|own| own == *ending)))
            .collect();
        found.sort();
        found
    }

    /// Takes away the recordings of an earlier session, now that the next one begins. What breakaway did not write stays.
    pub(super) fn clear(&self) -> anyhow::Result<()> {
        for path in self.session() {
            match may_write(&path, FileKind::Recording, &[], false) {
                Ok(()) => {
                    std::fs::remove_file(&path).with_context(|| format!("{}: cannot be removed", path.display()))?;
                }
                Err(_) => console::warn(format_args!("{} is no recording of breakaway and stays", path.display())),
            }
        }
        Ok(())
    }
}
