//! One run: the recordings are read, the base is identified, and what it misses is discovered.

use breakaway::command::output::versioned;
use breakaway::command::recording_args::RecordingArgs;
use breakaway::command::session::{Read, Session};
use breakaway::command::{discover, identify, look as looking};
use breakaway::discover::progress::{Progress, Watch};
use breakaway::look::look_at;
use breakaway::recording::formats::Log;
use breakaway::recording::{ReadOptions, RecordingError};
use breakaway::report::{discovery, json};
use serde::Serialize;
use serde_json::Value;

/// A file that the user chose.
#[derive(Clone, Debug)]
pub struct File {
    /// Its name, without a folder: a browser tells no more.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// What a run is told.
#[derive(Clone, Debug, Default)]
pub struct Work {
    /// Columns and rows.
    pub columns: RecordingArgs,
    /// Recordings to fit; of them the last third is held out where `holdout` is empty.
    pub fit: Vec<File>,
    /// Recordings to judge by.
    pub holdout: Vec<File>,
}

/// What a run gives.
#[derive(Debug, Serialize)]
pub struct Outcome {
    /// The document of `breakaway identify --json`.
    pub identify: Value,
    /// What `breakaway identify` prints.
    pub identify_text: String,
    /// The document of `breakaway discover --json`.
    pub discover: Value,
    /// What `breakaway discover` prints.
    pub discover_text: String,
    /// The report, an HTML page.
    pub report: String,
    /// The improved model, TOML.
    pub model: String,
}

/// What is in a file, as the document of `breakaway look`.
///
/// # Errors
/// A file that cannot be read as a log at all.
pub fn look(name: &str, bytes: &[u8]) -> anyhow::Result<String> {
    let looks = [look_at(name, &Log::read_from(name, bytes)?, &ReadOptions::default())];
    Ok(serde_json::to_string(&looking::Document::new(&looks))?)
}

impl Work {
    /// Does it; `progress` is called at the start of each step.
    ///
    /// # Errors
    /// Those of the command, in its words.
    pub fn run(&self, progress: Watch<'_>) -> anyhow::Result<Outcome> {
        progress(Progress::Step("reading the recordings"));
        let fit = self.session(&self.fit)?;
        progress(Progress::Step("identifying inertia and friction"));
        let document = identify::find(&fit, None)?.document();
        let (identify, identify_text) = (versioned(&document)?, identify::table(&document));
        let holdout = self.session(&self.holdout)?;
        let (found, folds) = discover::find_in(fit, holdout, None, self.command_line(), progress)?;
        progress(Progress::Step("writing the report"));
        Ok(Outcome {
            identify,
            identify_text,
            discover: versioned(&json::Document::from(&found))?,
            discover_text: discover::in_words(&found),
            report: discovery::html(&found, &folds),
            model: discover::improved(&found).to_toml(),
        })
    }

    fn session(&self, files: &[File]) -> Result<Session, RecordingError> {
        let all = files.iter().map(|file| {
            let (recording, sha256) = self.columns.read_input(&file.name, file.bytes.as_slice())?;
            Ok(Read { file: file.name.clone(), recording, sha256 })
        });
        Session::of(all, self.columns.options().position_column())
    }

    /// The command that gives the same.
    fn command_line(&self) -> String {
        let columns = &self.columns;
        let unit = columns.time_unit.map(|unit| unit.to_string());
        let wrap = columns.wrap.map(|wrap| wrap.to_string());
        let flags = [
            ("--time", columns.time.clone()),
            ("--time-unit", unit),
            ("--input", columns.input.clone()),
            ("--position", columns.position.clone()),
            ("--wrap", wrap),
        ];
        let names = |files: &[File]| files.iter().map(|file| file.name.clone()).collect::<Vec<_>>();
        let mut words = vec!["breakaway".to_owned(), "discover".to_owned()];
        words.extend(names(&self.fit));
        words.extend(
            flags.into_iter().filter_map(|(flag, value)| value.map(|value| [flag.to_owned(), value])).flatten(),
        );
        if !self.holdout.is_empty() {
            words.push("--holdout".to_owned());
            words.extend(names(&self.holdout));
        }
        let quoted = |word: &String| if word.contains([' ', '\'', '(']) { format!("\"{word}\"") } else { word.clone() };
        words.iter().map(quoted).collect::<Vec<_>>().join(" ")
    }
}
