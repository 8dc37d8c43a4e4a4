//! `breakaway discover --fleet`.

use std::path::{Path, PathBuf};

use schemars::JsonSchema;
use serde::Serialize;
use serde_json::json;

use super::super::UsageError;
use super::super::output::Output;
use super::super::progress;
use super::super::recording_args::RecordingArgs;
use super::{find, improved};
use crate::file::{FileKind, make_folder};
use crate::fleet::machine::{Machine, machines};
use crate::fleet::page::sentence;
use crate::fleet::result::{Found, Place};
use crate::fleet::row::Row;
use crate::fleet::table::in_words;
use crate::fleet::work::Job;
use crate::report::{discovery, json};

/// A fleet and how it is worked on.
#[derive(Debug)]
pub struct Fleet<'a> {
    /// One folder per machine.
    pub folder: &'a Path,
    /// Folder for results and tables.
    pub output: &'a Path,
    /// Machines at a time; as many as there are cores if absent.
    pub workers: Option<usize>,
    /// Whether results that are there count.
    pub again: bool,
    /// Model of the machines that have none.
    pub model: Option<&'a Path>,
    /// Columns and rows of all recordings.
    pub columns: &'a RecordingArgs,
}

#[derive(Debug, Serialize, JsonSchema)]
pub(in crate::command) struct Document<'a> {
    machines: &'a [Row],
    done: usize,
    skipped: usize,
    failed: usize,
    summary_csv: String,
    summary_html: String,
}

impl Fleet<'_> {
    /// Works on all machines and prints the table.
    ///
    /// # Errors
    /// A folder that is no fleet, tables that cannot be written, or no machine with a result.
    pub fn run(&self, output: Output) -> anyhow::Result<()> {
        self.check_output()?;
        let machines = machines(self.folder)?;
        self.check_results(&machines, output)?;
        let bar = progress::bar("machines", machines.len() as u64);
        let job = Job {
            machines: &machines,
            output: self.output,
            workers: self.workers.unwrap_or_else(rayon::current_num_threads),
            options: self.options(),
            model: self.model,
            again: self.again,
        };
        let rows = job.run(
            |inputs| {
                let (found, folds) = find(self.columns, inputs, &|_| {})?;
                Ok(Found {
                    model: improved(&found),
                    report: discovery::html(&found, &folds),
                    document: serde_json::to_value(json::Document::from(&found))?,
                })
            },
            &|_| bar.inc(1),
        )?;
        bar.finish_and_clear();
        let count = |test: fn(&Row) -> bool| rows.iter().filter(|row| test(row)).count();
        let failed = count(|row| row.reason.is_some());
        let document = Document {
            machines: &rows,
            done: count(|row| row.reason.is_none() && !row.skipped),
            skipped: count(|row| row.skipped),
            failed,
            summary_csv: self.output.join("summary.csv").display().to_string(),
            summary_html: self.output.join("summary.html").display().to_string(),
        };
        output.print(&document, |document| {
            format!(
                "{}\n{}\n{} and {}\n",
                in_words(&rows),
                sentence(&rows),
                document.summary_csv,
                document.summary_html
            )
        })?;
        let machines = rows.len();
        anyhow::ensure!(
            failed < machines,
            "no machine of {} could be worked on; each row says why",
            self.folder.display()
        );
        anyhow::ensure!(
            failed == 0,
            "{failed} of {machines} machines of {} failed; their rows say why, and the others are done",
            self.folder.display()
        );
        Ok(())
    }

    /// Results beside the machines' folders would be machines the next time.
    fn check_output(&self) -> anyhow::Result<()> {
        let whole = |path: &Path| std::fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
        let parent = match self.output.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
            _ => PathBuf::from("."),
        };
        let fleet = whole(self.folder);
        if whole(self.output) == fleet || whole(&parent) == fleet {
            let message = format!(
                "results in {} would be taken for a machine of {}: give an -o outside of it",
                self.output.display(),
                self.folder.display()
            );
            return Err(UsageError(message).into());
        }
        Ok(())
    }

    /// Before hours of work: nothing that is to be written is there as a file of somebody else.
    fn check_results(&self, machines: &[Machine], output: Output) -> anyhow::Result<()> {
        make_folder(self.output)?;
        let tables = [("summary.csv", FileKind::FleetTable), ("summary.html", FileKind::Page)];
        let tables = tables.map(|(name, kind)| (self.output.join(name), kind)).into_iter();
        let results = machines.iter().map(|machine| Place::new(self.output, &machine.name)).flat_map(|place| {
            [
                (place.model(), FileKind::Model),
                (place.report(), FileKind::Page),
                (place.result(), FileKind::FleetResult),
            ]
        });
        for (path, kind) in tables.chain(results).filter(|(path, _)| path.exists()) {
            output.may_write(&path, kind, &[])?;
        }
        Ok(())
    }

    /// The options that decide a result; the models are among its inputs.
    fn options(&self) -> serde_json::Value {
        let options = self.columns.options();
        json!({
            "time": options.time,
            "time_unit": options.time_unit.map(|unit| unit.to_string()),
            "input": options.input,
            "position": options.position,
            "fs_hz": options.fs_hz,
            "encoder_step": options.encoder_step,
            "counts_per_turn": options.counts_per_turn,
            "wrap": options.wrap.map(|wrap| wrap.to_string()),
            "window_s": options.window_s,
            "where": options.select.iter().map(ToString::to_string).collect::<Vec<_>>(),
        })
    }
}
