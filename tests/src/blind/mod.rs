//! Blind discovery: a hidden case, discovered without its truth, then scored against it.

pub mod asked;
pub mod limit;
pub mod rows;
pub mod rules;
pub mod table;
pub mod unkind;

use breakaway::discover::engine::discover;
use breakaway::discover::outcome::{CandidateRow, Discovery, Verdict};
use breakaway::discover::progress::Watch;
use breakaway::discover::request::Request;
use breakaway::recording::{Recording, Units};
use breakaway_hidden::{Case, Hidden, Record, Role, Session, Truth};

/// What became of one case.
#[derive(Clone, Debug)]
pub struct Scored {
    /// Seed of the case.
    pub seed: u64,
    /// Hidden effects.
    pub hidden: Vec<&'static str>,
    /// Verdict.
    pub verdict: Verdict,
    /// Named effects.
    pub named: Vec<&'static str>,
    /// Effects listed as tied with each of the named ones.
    pub tied: Vec<Vec<&'static str>>,
    /// Relative error of the first hidden effect's main parameter, if it was named.
    pub parameter_error: Option<f64>,
    /// Held-out error of the final model over that of the base.
    pub shrink: f64,
    /// Held-out error of the final model over the noise floor.
    pub over_noise: f64,
    /// The same over the error that the truth itself has against the held-out measurement.
    pub over_truth: f64,
    /// Visibility of the effect (see the hidden plant).
    pub visibility: f64,
    /// Seconds taken.
    pub seconds: f64,
}

/// The recordings of a session as the tool reads them.
pub fn recordings(session: &Session, role: Role) -> Vec<Recording> {
    session.records.iter().filter(|record| record.role == role).map(|record| recording(session, record)).collect()
}

/// A record of a session as the tool reads it.
pub fn recording(session: &Session, record: &Record) -> Recording {
    Recording {
        name: record.name.to_owned(),
        t: record.t.clone(),
        u: record.u.clone(),
        x: record.x.clone(),
        encoder_step: Some(session.encoder_step),
        units: Units { u: session.drive_unit.to_owned(), x: session.position_unit.to_owned() },
        ..Recording::default()
    }
}

/// Discovers a case blind and scores it.
///
/// # Errors
/// The discovery's own error, in words.
pub fn run(case: &Case) -> Result<(Scored, Discovery), String> {
    run_watched(case, &|_| ())
}

/// The same; `progress` is called as the discovery goes on.
///
/// # Errors
/// The discovery's own error, in words.
pub fn run_watched(case: &Case, progress: Watch<'_>) -> Result<(Scored, Discovery), String> {
    let (session, truth) = case.generate_with_truth();
    let request = Request {
        recordings: recordings(&session, Role::Fit),
        holdout: recordings(&session, Role::Score),
        ..Request::default()
    };
    let found = discover(&request, progress).map_err(|error| error.to_string())?;
    let own = truth.own_error(&session, Role::Score);
    Ok((score(&truth, own, &found), found))
}

/// The candidates of the first round and the remarks, a line each.
pub fn in_words(found: &Discovery) -> Vec<String> {
    let line =
        |c: &CandidateRow| format!("{:22} Δ {:.4} z {:.1} λ {:.0} {}", c.kind.name(), c.delta, c.z, c.lambda, c.fate);
    let model = found.model.effects.iter().zip(&found.model_se).map(|(effect, errors)| {
        let parameters = effect.kind.definition().parameters.iter().zip(effect.p).zip(errors);
        let of = parameters.map(|((p, value), se)| format!("{} {value:.6e} ± {se:.1e}", p.symbol));
        format!("{:22} {}", effect.kind.name(), of.collect::<Vec<_>>().join(", "))
    });
    let rungs = found.ladder.iter().map(|rung| format!("held-out error {:.4e}", rung.holdout_rmse));
    let rows = found.candidates.iter().map(line).chain(model).chain(rungs);
    rows.chain(found.remarks.iter().cloned()).collect()
}

fn score(truth: &Truth, own_error: f64, found: &Discovery) -> Scored {
    let hidden: Vec<&'static str> =
        truth.effects.iter().filter(|e| !matches!(e.hidden, Hidden::None)).map(|e| e.hidden.name()).collect();
    let named: Vec<&'static str> = found.effects.iter().map(|e| e.kind.name()).collect();
    let tied =
        found.effects.iter().map(|e| e.rivals.iter().filter(|r| r.tied).map(|r| r.kind.name()).collect()).collect();
    let (first, last) = (&found.ladder[0], &found.ladder[found.ladder.len() - 1]);
    Scored {
        seed: truth.seed,
        parameter_error: parameter_error(truth, found),
        verdict: found.verdict,
        hidden,
        named,
        tied,
        shrink: last.holdout_rmse / first.holdout_rmse,
        over_noise: last.holdout_rmse / found.noise_floor,
        over_truth: last.holdout_rmse / own_error,
        visibility: truth.visibility,
        seconds: found.seconds,
    }
}

/// The symbol of an effect's size in the hidden plant and in the catalogue.
const MAIN: [(&str, &str, &str); 25] = [
    ("constant_load", "bias", "f0"),
    ("asymmetric_viscous", "d", "d"),
    ("stribeck", "s", "s"),
    ("stiction", "s", "s"),
    ("dahl", "sigma0", "sigma"),
    ("lugre", "sigma0", "sigma"),
    ("quadratic_drag", "k", "k"),
    ("load_friction", "k", "k"),
    ("position_friction", "k", "k"),
    ("cogging", "A", "A"),
    ("gravity_load", "m", "m"),
    ("spring", "k", "k"),
    ("time_periodic", "A", "A"),
    ("backlash", "gap", "g"),
    ("flexible_coupling", "ratio", "mu"),
    ("dead_zone", "d", "d"),
    ("saturation", "u_max", "u_max"),
    ("pwm_dead_time", "d", "d"),
    ("delay", "tau", "tau"),
    ("electrical_lag", "tau", "tau"),
    ("encoder_eccentricity", "A", "A"),
    ("friction_drift", "s", "s"),
    ("gain_drift", "k", "k"),
    ("inertia_step", "delta", "r"),
    ("end_stop", "k", "k"),
];

fn parameter_error(truth: &Truth, found: &Discovery) -> Option<f64> {
    let effect = truth.effects.first()?;
    let (name, theirs, ours) = MAIN.iter().find(|(name, ..)| *name == effect.hidden.name())?;
    let own = effect.parameters.iter().find(|(symbol, _)| symbol == theirs)?.1;
    // A late sensor adds to a delay, and nothing can part the two.
    let true_value = if *name == "delay" { own + truth.world.sensor_delay_s } else { own };
    let named = found.effects.iter().find(|e| e.kind.name() == *name)?;
    let value = named.parameters.iter().find(|p| p.symbol == *ours)?.value;
    // A bias and an asymmetry are signed the other way in one of the two; amplitudes absorb half a turn of phase.
    Some((value.abs() / true_value.abs() - 1.0).abs())
}

impl Scored {
    /// Whether all hidden effects were named, and nothing else.
    pub fn right(&self) -> bool {
        let mut hidden = self.hidden.clone();
        let mut named = self.named.clone();
        hidden.sort_unstable();
        named.sort_unstable();
        // Two lines of one ripple are one effect.
        named.dedup();
        hidden == named
    }
    /// Whether something was named that is not hidden, even if the hidden effect is listed as tied with it.
    pub fn wrong(&self) -> bool {
        self.named.iter().any(|name| !self.hidden.contains(name))
    }
}
