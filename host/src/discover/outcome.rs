//! The result of a discovery, as report and JSON show it.

use breakaway_core::plant::{Base, Kind};

use crate::fit::Candidate;
use crate::recording::Units;
use crate::simulate::experiment::Experiment;

/// The four verdicts (docs/discovery.md, section 10).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Effects are named, and what is left is random or the sensor's noise.
    Explained,
    /// Effects are named, and something predictable is left.
    PartlyExplained,
    /// Something predictable is left that no effect explains, or the recordings cannot tell.
    Unknown,
    /// What is left is random and little, or within the noise.
    NothingMissing,
}

impl Verdict {
    /// The contract's name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Explained => "explained",
            Self::PartlyExplained => "partly_explained",
            Self::Unknown => "unknown",
            Self::NothingMissing => "nothing_missing",
        }
    }
}

/// A fitted parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterValue {
    /// Symbol.
    pub symbol: &'static str,
    /// Unit, written out.
    pub unit: String,
    /// Meaning of the parameter.
    pub meaning: &'static str,
    /// Value.
    pub value: f64,
    /// Standard error; NaN where the parameter is held, or where the fit gives none.
    pub se: f64,
}

/// Another effect that explains the same gap, or nearly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rival {
    /// Which effect.
    pub kind: Kind,
    /// Mean over the segments of log(σ² + mse_rival) − log(σ² + mse_named); > 0 in favour of the named one. It is 0
    /// where the measured forces found the rival.
    pub delta: f64,
    /// z of the named effect's lead, over paired segments or over blocks of the measured forces.
    pub z: f64,
    /// Whether these recordings cannot tell it from the named effect.
    pub tied: bool,
}

/// An effect that was added.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedEffect {
    /// Which.
    pub kind: Kind,
    /// Its parameters.
    pub parameters: Vec<ParameterValue>,
    /// Its rivals, the closest first.
    pub rivals: Vec<Rival>,
}

/// One step of the ladder: base, base + effect 1, base + effect 1 + effect 2, …
#[derive(Clone, Debug, PartialEq)]
pub struct Rung {
    /// Effects of this model.
    pub effects: Vec<Kind>,
    /// Base parameters of this model.
    pub base: Base<f64>,
    /// Simulation error over fitted segments, position units. Each segment's initial state is fitted; a segment has 0.4
    /// s, or 0.1 s where no model follows longer ones.
    pub fit_rmse: f64,
    /// The same over held-out segments.
    pub holdout_rmse: f64,
    /// Held-out simulation error over windows of 1 s, position units. A window's start is fitted over its first segment
    /// length.
    pub holdout_open_loop_rmse: f64,
    /// Measured force that the model leaves, over the drive's rms: fitted and held-out segments. `None` for a second body
    /// and where there are too few windows.
    pub force_residual: Option<[f64; 2]>,
    /// Residual of a curve that does not use the drive, over the windows of the open loop, position units. `None` without
    /// one.
    pub drive_free_rmse: Option<f64>,
}

/// A coordinate, and how the residual force depends on it.
#[derive(Clone, Debug, PartialEq)]
pub struct WhereRow {
    /// Name, e.g. `velocity`, `position`, `position × direction`, `distance since reversal`.
    pub coordinate: &'static str,
    /// Unit of the coordinate.
    pub unit: String,
    /// Block-cross-validated share of the base model's residual force that averages over this coordinate explain; for
    /// `frequency`, the share of its strongest line.
    pub r2: f64,
    /// The same for the residual of the final model.
    pub r2_after: f64,
    /// Binned mean of the base model's residual force: centre, mean, standard error (drive units).
    pub curve: Vec<[f64; 3]>,
    /// The same for the final model.
    pub curve_after: Vec<[f64; 3]>,
}

/// One candidate of the first round.
#[derive(Clone, Debug, PartialEq)]
pub struct CandidateRow {
    /// Which effect.
    pub kind: Kind,
    /// Mean paired improvement of log(σ² + mse) over the base; of the measured forces, the gain of the side that gains
    /// less, nats.
    pub delta: f64,
    /// Its z score.
    pub z: f64,
    /// Effective log-likelihood ratio without its two best segments, nats; NaN for the measured forces.
    pub lambda: f64,
    /// Its fate, in words: named, tied, or why it lost or could not be fitted.
    pub fate: String,
}

/// Measured and simulated, for a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Overlay {
    /// Recording and time span.
    pub title: String,
    /// Time, s.
    pub t: Vec<f64>,
    /// Measured position.
    pub measured: Vec<f64>,
    /// Base model.
    pub before: Vec<f64>,
    /// Final model; empty if nothing was added.
    pub after: Vec<f64>,
    /// Drive.
    pub u: Vec<f64>,
}

/// The experiment that would decide between tied effects.
#[derive(Clone, Debug, PartialEq)]
pub struct NextExperiment {
    /// The experiment; `breakaway run` takes it.
    pub experiment: Experiment,
    /// The effects it separates.
    pub separates: Vec<Kind>,
    /// Predicted root mean square difference of the two models over the noise.
    pub difference_over_noise: f64,
}

/// The measured forces: what the base and the final model leave of them, and whether that is random.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Force {
    /// Held-out residual over the rms of the drive, base and final model.
    pub drive: [f64; 2],
    /// The same for the acceleration, over its rms.
    pub acceleration: [f64; 2],
    /// ρ²: share of the acceleration that the drive determines, 0 to 1.
    pub coherence: f64,
    /// Half-width of the windows, s.
    pub half_width_s: f64,
    /// Rms of what is left in windows so wide that the sensor's noise does not count, drive units.
    pub random: f64,
    /// The same over the rms of the drive.
    pub random_share: f64,
    /// Highest frequency that those windows let pass, Hz.
    pub bandwidth_hz: f64,
    /// What predicts a part of it on held-out data: an effect, another term, or the drive's period, with which it repeats.
    /// `None` if nothing does, so that it is random.
    pub predictable: Option<&'static str>,
}

/// Where a discovery comes from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Provenance {
    /// Input files and their SHA-256.
    pub inputs: Vec<(String, String)>,
    /// Version of this program.
    pub version: String,
    /// The command line.
    pub command: String,
}

/// Everything a discovery found.
#[derive(Clone, Debug, PartialEq)]
pub struct Discovery {
    /// Verdict.
    pub verdict: Verdict,
    /// Effects that were added, in order.
    pub effects: Vec<NamedEffect>,
    /// The ladder, the base first.
    pub ladder: Vec<Rung>,
    /// The final model: the base and all effects, also those that were known before.
    pub model: Candidate,
    /// Standard errors of the final model's effect parameters, in their order; NaN where held.
    pub model_se: Vec<Vec<f64>>,
    /// Standard errors of the final model's b, c, f1.
    pub base_se: [f64; 3],
    /// Position noise, position units.
    pub noise_floor: f64,
    /// Coordinates over which the residual force changes, the strongest first.
    pub where_map: Vec<WhereRow>,
    /// The candidates of the first round, the best first.
    pub candidates: Vec<CandidateRow>,
    /// Before and after, on held-out data.
    pub overlays: Vec<Overlay>,
    /// The experiment that would decide between tied effects.
    pub next_experiment: Option<NextExperiment>,
    /// The effect that came closest where none is named, with its parameters and the reason.
    pub nearest: Option<String>,
    /// What the data cannot tell, and problems of the recordings.
    pub remarks: Vec<String>,
    /// Units.
    pub units: Units,
    /// Segments simulated, and segments available.
    pub segments: (usize, usize),
    /// Time taken, s.
    pub seconds: f64,
    /// The measured forces; `None` where the recordings hold no windows in motion.
    pub force: Option<Force>,
    /// Inputs, version, command.
    pub provenance: Provenance,
}

impl Discovery {
    /// Held-out simulation error of the final model over the sensor's noise.
    pub fn over_noise(&self) -> f64 {
        self.ladder.last().map_or(f64::INFINITY, |rung| rung.holdout_rmse / self.noise_floor)
    }

    /// The discovery without the names that the recordings do not bear out. The `known` effects that were given stay.
    #[must_use]
    pub fn without_names(mut self, known: usize) -> Self {
        if let Some(first) = self.ladder.first() {
            self.model.base = first.base;
        }
        self.model.effects.truncate(known);
        self.model_se.truncate(known);
        self.ladder.truncate(1);
        self.effects.clear();
        self.overlays.iter_mut().for_each(|overlay| overlay.after.clear());
        self.verdict = Verdict::Unknown;
        self
    }

    /// Whether the verdict leaves nothing to be explained.
    pub fn down_to_the_noise(&self) -> bool {
        matches!(self.verdict, Verdict::Explained | Verdict::NothingMissing)
    }
}
