//! `breakaway discover`.

#[cfg(feature = "command")]
pub mod fleet;

use std::fmt::Write as _;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use anyhow::Context;

use super::console;
#[cfg(feature = "command")]
use super::figures::FiguresArgs;
#[cfg(feature = "command")]
use super::output::Output;
#[cfg(feature = "command")]
use super::progress::Steps;
use super::recording_args::RecordingArgs;
use super::session::Session;
use crate::discover::engine;
use crate::discover::outcome::{Discovery, Provenance};
use crate::discover::progress::Watch;
use crate::discover::request::Request;
#[cfg(feature = "command")]
use crate::file::FileKind;
use crate::file::Target;
use crate::fit::Candidate;
#[cfg(feature = "command")]
use crate::fleet::machine::Inputs;
use crate::model::{BaseSe, EffectEntry, Model};
use crate::recording::{Recording, RecordingError};
use crate::report::discovery::{self, Fold};
#[cfg(feature = "command")]
use crate::report::json;

/// Find where simulation and recordings disagree, name the missing effect, add it to the model
#[derive(clap::Args, Debug)]
#[command(after_help = "Example:
  breakaway discover session/fit/*.csv --holdout session/score/*.csv -o improved.toml --report report.html
  breakaway discover --fleet machines -o found

Without --model the base model is identified first. Without --holdout the last third of every recording is held out.

--fleet works on many machines side by side. DIR holds one folder per machine, with fit/*.csv and score/*.csv (as
`breakaway run suite` writes them) or with *.csv. A model to start from is base.toml or model.toml. The folder of -o gets
MACHINE/improved.toml, report.html and result.json, and over all machines summary.csv and summary.html. A machine is
skipped if its result is there, from the same files, options and version. A machine that fails has a row with the reason,
and the exit code is then 1.

JSON: verdict, effects (name, parameters, rivals), ladder, noise_floor, force, unexplained (before, after, predictable_share,
coordinate), where, candidates, next_experiment, remarks, seconds.
JSON of --fleet: machines (machine, verdict, effects, tied, shrink, noise_factor, noise_floor, base, seconds, skipped,
reason), done, skipped, failed, summary_csv, summary_html.")]
pub struct Args {
    /// Recordings of one session, in the order in which they were made
    #[arg(value_name = "REC", required_unless_present = "fleet", conflicts_with = "fleet")]
    pub recordings: Vec<PathBuf>,
    /// Model so far [default: identified]
    #[arg(long, value_name = "M.toml")]
    pub model: Option<PathBuf>,
    /// Recordings to judge by; the model is not fitted to them
    #[arg(long, value_name = "REC", num_args = 1.., conflicts_with = "fleet")]
    pub holdout: Vec<PathBuf>,
    /// Write the improved model to this file (`-` is standard output); with --fleet, the folder for all results
    #[arg(short, long, value_name = "M2.toml")]
    pub output: Option<Target>,
    /// Write the report to this file; `-` is standard output
    #[arg(long, value_name = "R.html", conflicts_with = "fleet")]
    pub report: Option<Target>,
    /// Figures.
    #[cfg(feature = "command")]
    #[command(flatten)]
    pub figures: FiguresArgs,
    /// Work on all machines of this folder; each has a folder of its own
    #[arg(long, value_name = "DIR", requires = "output", conflicts_with = "figures")]
    pub fleet: Option<PathBuf>,
    /// Machines worked on at a time; they share the cores [default: the number of cores]
    #[arg(long, value_name = "N", requires = "fleet")]
    pub workers: Option<NonZeroUsize>,
    /// Work on every machine, also where a result exists
    #[arg(long, requires = "fleet")]
    pub again: bool,
    /// Columns and rows.
    #[command(flatten)]
    pub columns: RecordingArgs,
}

impl Args {
    /// Reads, discovers, prints, writes model and report.
    ///
    /// # Errors
    /// A file that cannot be read or written; recordings from which nothing can be identified.
    #[cfg(feature = "command")]
    pub fn run(self, output: Output) -> anyhow::Result<()> {
        if let (Some(folder), Some(results)) = (&self.fleet, &self.output) {
            let Target::File(results) = results else { return output.folder("-".as_ref(), "a folder").map(|_| ()) };
            let fleet = fleet::Fleet {
                folder,
                output: results,
                workers: self.workers.map(NonZeroUsize::get),
                again: self.again,
                model: self.model.as_deref(),
                columns: &self.columns,
            };
            return fleet.run(output);
        }
        let targets = self.output.iter().map(|target| (target, FileKind::Model));
        let targets: Vec<_> = targets.chain(self.report.iter().map(|target| (target, FileKind::Page))).collect();
        let read: Vec<_> =
            self.recordings.iter().chain(&self.holdout).chain(&self.model).map(PathBuf::as_path).collect();
        let output = output.claim(&targets, &read)?;
        self.figures.claim(output, &read)?;
        let inputs = Inputs { fit: self.recordings.clone(), score: self.holdout.clone(), model: self.model.clone() };
        let steps = Steps::begin();
        let (found, folds) = find(&self.columns, &inputs, &|what| steps.show(what))?;
        steps.end();
        if let Some(target) = &self.output {
            target.write_text(&improved(&found).to_toml())?;
        }
        if let Some(target) = &self.report {
            target.write_text(&discovery::html(&found, &folds))?;
        }
        self.figures.write(output, &read, || discovery::all_figures(&found, &folds))?;
        output.print(&json::Document::from(&found), |_| in_words(&found))
    }
}

/// Reads the inputs and discovers; `progress` is called at the start of each step. Gives the discovery with the folds
/// of its effects.
///
/// # Errors
/// A file that cannot be read; recordings from which nothing can be identified.
#[cfg(feature = "command")]
pub fn find(columns: &RecordingArgs, inputs: &Inputs, progress: Watch<'_>) -> anyhow::Result<(Discovery, Vec<Fold>)> {
    let (fit, score) = (columns.read_session(&inputs.fit)?, columns.read_session(&inputs.score)?);
    let model = inputs.model.as_deref().map(Model::read).transpose()?;
    let words: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    find_in(fit, score, model, words.join(" "), progress)
}

/// Discovers from sessions that were read: to fit, and to score by. `command` is what the provenance says was called.
///
/// # Errors
/// A recording in both sessions; recordings from which nothing can be identified.
pub fn find_in(
    mut fit: Session,
    mut score: Session,
    mut model: Option<Model>,
    command: String,
    progress: Watch<'_>,
) -> anyhow::Result<(Discovery, Vec<Fold>)> {
    fit.is_apart_from(&score).map_err(RecordingError::from)?;
    if let (Some(model), Some(radians)) = (&mut model, fit.recordings.first().and_then(Recording::radians_per_unit)) {
        model.in_radians(radians);
    }
    let first = fit.first_file();
    let converted = fit.in_radians();
    score.in_radians();
    let request = Request {
        recordings: fit.recordings,
        holdout: score.recordings,
        model: model.map(|m| anyhow::Ok(Candidate { base: m.base, effects: m.plant_effects()? })).transpose()?,
        provenance: Provenance {
            inputs: fit.hashes.into_iter().chain(score.hashes).collect(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command,
        },
    };
    let mut found = engine::discover(&request, progress).context(first)?;
    found.remarks.extend(fit.remarks.into_iter().chain(score.remarks));
    found.remarks.extend(converted.map(|unit| {
        format!("the position was converted from {unit} to rad, because gravity and eccentricity are laws of an angle in rad")
    }));
    let folds = discovery::folds(&request.recordings, &found);
    Ok((found, folds))
}

/// The improved model as a model file has it.
pub fn improved(found: &Discovery) -> Model {
    let [b, c, f1] = found.base_se;
    let known = |se: f64| se.is_finite().then_some(se);
    let effects = found.model.effects.iter().zip(&found.model_se).map(|(effect, se)| {
        let errors: Vec<Option<f64>> = se.iter().map(|se| known(*se)).collect();
        EffectEntry::of(effect, &errors)
    });
    Model {
        base: found.model.base,
        base_se: BaseSe { b: known(b), c: known(c), f1: known(f1) },
        units: found.units.clone(),
        effects: effects.collect(),
        provenance: std::iter::once(format!(
            "discovered by breakaway {}: {}",
            found.provenance.version,
            found.verdict.name()
        ))
        .chain(found.provenance.inputs.iter().map(|(file, hash)| format!("from {file} sha256 {hash}")))
        .collect(),
    }
}

/// The result for people.
pub fn in_words(found: &Discovery) -> String {
    let mut text = format!("{}: {}\n", found.verdict.name().replace('_', " "), discovery::sentence::sentence(found));
    for effect in &found.effects {
        let _ = writeln!(text, "\n{}: {}", effect.kind.name(), effect.kind.definition().law);
        for p in &effect.parameters {
            let error = if p.se.is_finite() { format!("± {:.1e}", p.se) } else { "(held)".to_owned() };
            let _ = writeln!(text, "  {:<8}{:>14.6e} {error:<9} {:<10} {}", p.symbol, p.value, p.unit, p.meaning);
        }
        for rival in effect.rivals.iter().filter(|r| r.tied) {
            let _ = writeln!(text, "  these recordings cannot tell it from {}", rival.kind.name());
        }
    }
    let _ = writeln!(
        text,
        "\nnoise {:.2e} {}; simulation error (fit, held out, held out open loop over 1 s):",
        found.noise_floor, found.units.x
    );
    for rung in &found.ladder {
        let names: Vec<&str> = rung.effects.iter().map(|k| k.name()).collect();
        let name = if names.is_empty() { "base".to_owned() } else { format!("base + {}", names.join(" + ")) };
        let _ = writeln!(
            text,
            "  {name:<44} {:.3e}  {:.3e}  {:.3e}",
            rung.fit_rmse, rung.holdout_rmse, rung.holdout_open_loop_rmse
        );
    }
    text.push_str("\nwhere the gap is (share of the residual force explained, before and after):\n");
    for row in found.where_map.iter().take(5) {
        let _ = writeln!(text, "  {:<26} {:>5.1} %  {:>5.1} %", row.coordinate, 100.0 * row.r2, 100.0 * row.r2_after);
    }
    if console::is_verbose() {
        text.push_str(&comparison(found));
    }
    if let Some(next) = &found.next_experiment {
        let names: Vec<&str> = next.separates.iter().map(|k| k.name()).collect();
        let _ = writeln!(
            text,
            "\nnext experiment: {} would separate {} (predicted difference {:.1} times the noise)",
            next.experiment.name,
            names.join(" and "),
            next.difference_over_noise
        );
    }
    // Which effect came closest is said in numbers.
    let plain = |remark: &&String| console::is_verbose() || Some(*remark) != found.nearest.as_ref();
    for remark in found.remarks.iter().filter(plain) {
        let _ = writeln!(text, "note: {remark}");
    }
    let _ = writeln!(text, "{} of {} segments simulated, {:.1} s", found.segments.0, found.segments.1, found.seconds);
    text
}

/// The numbers of the first round, for the longer text.
fn comparison(found: &Discovery) -> String {
    let mut text = String::from("\ncandidates of the first round:\n");
    for row in found.candidates.iter().take(8) {
        // What did not come to the final has no evidence.
        let evidence = if row.delta.is_finite() {
            let lambda = if row.lambda.is_finite() { format!("  λ {:>9.0}", row.lambda) } else { String::new() };
            format!("Δ {:>8.4}  z {:>6.1}{lambda}", row.delta, row.z)
        } else {
            "–".to_owned()
        };
        let _ = writeln!(text, "  {:<22} {evidence:<33}  {}", row.kind.name(), row.fate);
    }
    text
}
