//! The JSON of `discover` (docs/formats.md, section "JSON results"): the same content as the report. A number that is not known is `null`.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;

use super::remark::RemarkJson;
use crate::discover::outcome::{Discovery, Force, NamedEffect, NextExperiment, Rung, WhereRow};
use crate::simulate::experiment::Experiment;

/// The JSON document of a discovery.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Document<'a> {
    verdict: &'static str,
    sentence: String,
    effects: Vec<EffectJson<'a>>,
    base: BTreeMap<&'static str, Quantity>,
    ladder: Vec<RungJson>,
    noise_floor: f64,
    force: Option<ForceJson>,
    unexplained: Option<UnexplainedJson>,
    #[serde(rename = "where")]
    where_map: Vec<WhereJson<'a>>,
    candidates: Vec<CandidateJson<'a>>,
    next_experiment: Option<NextJson<'a>>,
    remarks: Vec<RemarkJson>,
    segments: [usize; 2],
    seconds: f64,
    provenance: ProvenanceJson<'a>,
}

/// A number with its standard error and unit.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Quantity {
    pub value: f64,
    pub se: f64,
    pub unit: String,
}

#[derive(Debug, Serialize, JsonSchema)]
struct EffectJson<'a> {
    name: &'static str,
    title: &'static str,
    law: &'static str,
    parameters: BTreeMap<&'a str, Quantity>,
    rivals: Vec<RivalJson>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct RivalJson {
    name: &'static str,
    delta: f64,
    z: f64,
    tied: bool,
}

/// Measured forces; shares are of the rms of the drive and of the acceleration.
#[derive(Debug, Serialize, JsonSchema)]
struct ForceJson {
    drive_before: f64,
    drive_after: f64,
    acceleration_before: f64,
    acceleration_after: f64,
    coherence: f64,
    random: f64,
    random_share: f64,
    bandwidth_hz: f64,
    predictable: Option<&'static str>,
}

impl From<Force> for ForceJson {
    fn from(force: Force) -> Self {
        Self {
            drive_before: force.drive[0],
            drive_after: force.drive[1],
            acceleration_before: force.acceleration[0],
            acceleration_after: force.acceleration[1],
            coherence: force.coherence,
            random: force.random,
            random_share: force.random_share,
            bandwidth_hz: force.bandwidth_hz,
            predictable: force.predictable,
        }
    }
}

/// The measured force that base and final model leave unexplained.
#[derive(Debug, Serialize, JsonSchema)]
struct UnexplainedJson {
    before: UnexplainedForceJson,
    after: UnexplainedForceJson,
    predictable_share: BeforeAfterJson,
    /// The coordinate over which averages explain most of what the base leaves.
    coordinate: Option<&'static str>,
}

#[derive(Debug, Serialize, JsonSchema)]
struct UnexplainedForceJson {
    rms: f64,
    unit: String,
    percent_of_drive: f64,
    bandwidth_hz: f64,
}

/// Largest share of the unexplained force that averages over one coordinate explain, cross-validated, 0 to 1.
#[derive(Debug, Serialize, JsonSchema)]
struct BeforeAfterJson {
    before: Option<f64>,
    after: Option<f64>,
}

fn unexplained(discovery: &Discovery, force: &Force) -> UnexplainedJson {
    let drive_rms = force.random / force.random_share;
    let of = |share: f64| UnexplainedForceJson {
        rms: share * drive_rms,
        unit: discovery.units.u.clone(),
        percent_of_drive: 100.0 * share,
        bandwidth_hz: crate::discover::judge::remainder::bandwidth_hz(force.half_width_s),
    };
    let most = |share: fn(&WhereRow) -> f64| {
        let rows = discovery.where_map.iter();
        rows.max_by(|a, b| share(a).total_cmp(&share(b)))
    };
    let (before, after) = (most(|row| row.r2), most(|row| row.r2_after));
    UnexplainedJson {
        before: of(force.drive[0]),
        after: of(force.drive[1]),
        predictable_share: BeforeAfterJson {
            before: before.map(|row| row.r2.max(0.0)),
            after: after.map(|row| row.r2_after.max(0.0)),
        },
        coordinate: before.map(|row| row.coordinate),
    }
}

#[derive(Debug, Serialize, JsonSchema)]
struct RungJson {
    effects: Vec<&'static str>,
    fit_rmse: f64,
    holdout_rmse: f64,
    holdout_open_loop_rmse: f64,
    force_residual: Option<ShareJson>,
    drive_free_rmse: Option<f64>,
}

/// Shares of the rms of the drive.
#[derive(Debug, Serialize, JsonSchema)]
struct ShareJson {
    fit: f64,
    holdout: f64,
}

#[derive(Debug, Serialize, JsonSchema)]
struct WhereJson<'a> {
    coordinate: &'static str,
    unit: &'a str,
    r2: f64,
    r2_after: f64,
    /// Centre, mean, standard error of each bin.
    curve: &'a [[f64; 3]],
    curve_after: &'a [[f64; 3]],
}

#[derive(Debug, Serialize, JsonSchema)]
struct CandidateJson<'a> {
    name: &'static str,
    delta: f64,
    z: f64,
    lambda: f64,
    fate: &'a str,
}

#[derive(Debug, Serialize, JsonSchema)]
struct NextJson<'a> {
    /// As in an experiment's file.
    #[schemars(with = "serde_json::Value")]
    experiment: &'a Experiment,
    /// The same as `breakaway run` takes it; JSON has no infinity for a limit that is not set.
    toml: Option<String>,
    separates: Vec<&'static str>,
    difference_over_noise: f64,
}

#[derive(Debug, Serialize, JsonSchema)]
struct InputJson<'a> {
    file: &'a str,
    sha256: &'a str,
}

#[derive(Debug, Serialize, JsonSchema)]
struct ProvenanceJson<'a> {
    inputs: Vec<InputJson<'a>>,
    version: &'a str,
    command: &'a str,
}

impl<'a> From<&'a NamedEffect> for EffectJson<'a> {
    fn from(effect: &'a NamedEffect) -> Self {
        let definition = effect.kind.definition();
        let quantities =
            effect.parameters.iter().map(|p| (p.symbol, Quantity { value: p.value, se: p.se, unit: p.unit.clone() }));
        let rivals =
            effect.rivals.iter().map(|r| RivalJson { name: r.kind.name(), delta: r.delta, z: r.z, tied: r.tied });
        Self {
            name: definition.name,
            title: definition.title,
            law: definition.law,
            parameters: quantities.collect(),
            rivals: rivals.collect(),
        }
    }
}

impl From<&Rung> for RungJson {
    fn from(rung: &Rung) -> Self {
        Self {
            effects: rung.effects.iter().map(|kind| kind.name()).collect(),
            fit_rmse: rung.fit_rmse,
            holdout_rmse: rung.holdout_rmse,
            holdout_open_loop_rmse: rung.holdout_open_loop_rmse,
            force_residual: rung.force_residual.map(|[fit, holdout]| ShareJson { fit, holdout }),
            drive_free_rmse: rung.drive_free_rmse,
        }
    }
}

impl<'a> From<&'a WhereRow> for WhereJson<'a> {
    fn from(row: &'a WhereRow) -> Self {
        Self {
            coordinate: row.coordinate,
            unit: &row.unit,
            r2: row.r2,
            r2_after: row.r2_after,
            curve: &row.curve,
            curve_after: &row.curve_after,
        }
    }
}

impl<'a> From<&'a NextExperiment> for NextJson<'a> {
    fn from(next: &'a NextExperiment) -> Self {
        Self {
            experiment: &next.experiment,
            toml: toml::to_string(&next.experiment).ok(),
            separates: next.separates.iter().map(|kind| kind.name()).collect(),
            difference_over_noise: next.difference_over_noise,
        }
    }
}

impl<'a> From<&'a Discovery> for Document<'a> {
    fn from(discovery: &'a Discovery) -> Self {
        let units = &discovery.units;
        let base = discovery.ladder.last().map_or_else(BTreeMap::new, |rung| {
            let [b, c, f1] = discovery.base_se;
            [
                ("b", Quantity { value: rung.base.b, se: b, unit: units.of_b() }),
                ("c", Quantity { value: rung.base.c, se: c, unit: units.of_c() }),
                ("f1", Quantity { value: rung.base.f1, se: f1, unit: units.of_f1() }),
            ]
            .into()
        });
        let candidates = discovery.candidates.iter().map(|c| CandidateJson {
            name: c.kind.name(),
            delta: c.delta,
            z: c.z,
            lambda: c.lambda,
            fate: &c.fate,
        });
        let inputs = discovery.provenance.inputs.iter().map(|(file, sha256)| InputJson { file, sha256 });
        Self {
            verdict: discovery.verdict.name(),
            sentence: super::discovery::sentence::sentence(discovery),
            effects: discovery.effects.iter().map(EffectJson::from).collect(),
            base,
            ladder: discovery.ladder.iter().map(RungJson::from).collect(),
            noise_floor: discovery.noise_floor,
            force: discovery.force.map(ForceJson::from),
            unexplained: discovery.force.map(|force| unexplained(discovery, &force)),
            where_map: discovery.where_map.iter().map(WhereJson::from).collect(),
            candidates: candidates.collect(),
            next_experiment: discovery.next_experiment.as_ref().map(NextJson::from),
            remarks: discovery.remarks.iter().map(|text| RemarkJson::new("discovery", text)).collect(),
            segments: discovery.segments.into(),
            seconds: discovery.seconds,
            provenance: ProvenanceJson {
                inputs: inputs.collect(),
                version: &discovery.provenance.version,
                command: &discovery.provenance.command,
            },
        }
    }
}
