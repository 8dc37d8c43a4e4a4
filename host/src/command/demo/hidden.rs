//! The second half of the demo: an effect drawn from the seed and not told, found by discovery.

use std::path::Path;

use breakaway_core::plant::{Effect, Kind};
use schemars::JsonSchema;
use serde::Serialize;

use super::{SENSOR, session, write};
use crate::command::discover::improved;
use crate::command::run::papers_plant;
use crate::discover::engine::discover;
use crate::discover::outcome::Discovery;
use crate::report::discovery;
use crate::report::text::with_error;
use crate::simulate::axis::Axis;
use crate::simulate::suite::{self, Machine};

/// What may be hidden in the axis: effects with their parameters, a tenth to a fifth of the drive in size.
const HIDDEN: [(Kind, &[f64]); 7] = [
    (Kind::Cogging, &[0.3, 7.0, 0.6]),
    (Kind::Stribeck, &[0.3, 0.5]),
    (Kind::AsymmetricViscous, &[0.03]),
    (Kind::Delay, &[0.004]),
    (Kind::PositionFriction, &[0.6, 3.0, 1.0]),
    (Kind::ConstantLoad, &[0.25]),
    (Kind::LoadFriction, &[0.1]),
];

/// What the second half found.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Hunt {
    /// Name of what was hidden.
    pub hidden: &'static str,
    /// Names of what was found.
    pub found: Vec<&'static str>,
    /// Verdict.
    pub verdict: &'static str,
    /// Held-out simulation error before and after, position units.
    pub holdout_rmse: [f64; 2],
    /// Noise floor, position units.
    pub noise_floor: f64,
    /// The report.
    pub report: String,
    /// The improved model.
    pub model: String,
    /// The story in lines.
    #[serde(skip)]
    pub lines: Vec<String>,
}

/// What the seed hides.
pub const fn drawn(seed: u64) -> (Kind, &'static [f64]) {
    HIDDEN[(seed % HIDDEN.len() as u64) as usize]
}

/// Hides an effect, runs the standard suite, discovers, writes recordings, report and improved model into `folder`.
///
/// # Errors
/// A simulation or discovery that fails; files that cannot be written.
pub fn hunt(folder: &Path, seed: u64) -> anyhow::Result<Hunt> {
    let (kind, parameters) = drawn(seed);
    let plant = papers_plant();
    let mut axis = Axis::new(plant.base, &[Effect::new(kind, parameters)], plant.units.clone());
    let machine = Machine { drive_limit: 5.0, travel: 5.0, tick_s: 1e-3, sensor: SENSOR, seed };
    let breakaway = suite::breakaway(&axis, &machine)?;
    let experiments = suite::suite(breakaway.moved_at, &machine);
    let request = session::recorded(folder, format!("breakaway demo --seed {seed}"), experiments, |experiment| {
        Ok(axis.run(experiment)?.recording)
    })?;
    let found = discover(&request, &|_| ())?;
    let (report, model) = (folder.join("discovery.html"), folder.join("improved.toml"));
    write(&report, &discovery::html(&found, &discovery::folds(&request.recordings, &found)))?;
    write(&folder.join("ladder.svg"), &discovery::ladder_figure(&found).file())?;
    improved(&found).write(&model)?;
    let ladder = [&found.ladder[0], &found.ladder[found.ladder.len() - 1]];
    Ok(Hunt {
        hidden: kind.name(),
        found: found.effects.iter().map(|e| e.kind.name()).collect(),
        verdict: found.verdict.name(),
        holdout_rmse: ladder.map(|rung| rung.holdout_rmse),
        noise_floor: found.noise_floor,
        report: report.display().to_string(),
        model: model.display().to_string(),
        lines: in_words(kind, breakaway.force, &found),
    })
}

fn in_words(kind: Kind, force: f64, found: &Discovery) -> Vec<String> {
    let mut lines = vec![
        format!("an effect was hidden in the axis; break-away force found: {force:.3} V; suite of 8 experiments, 60 s"),
        crate::report::discovery::sentence::sentence(found),
    ];
    for effect in &found.effects {
        let values: Vec<String> = effect
            .parameters
            .iter()
            .map(|p| format!("{} = {} {}", p.symbol, with_error(p.value, p.se), p.unit))
            .collect();
        lines.push(format!("{}: {}", effect.kind.definition().law, values.join(", ")));
    }
    lines.push(format!("what was hidden: {}", kind.name()));
    lines
}
