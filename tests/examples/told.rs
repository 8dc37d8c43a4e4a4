//! Which hidden effects a session tells at all: `cargo run -p breakaway-tests --example told -- --seeds 8801..8821`.
//!
//! The true model is fitted to the motion from the true parameters, and then without each effect in turn. The two are compared
//! as `discover` compares models (docs/discovery.md, section 8), over the same segments. No search can find an effect that does
//! not show here. Each line has z, λ in nats, and the error over the sensor's noise without the effect. The error with it stands
//! first.

use std::f64::consts::FRAC_PI_4;

use breakaway::discover::data::{Data, FIT_SEGMENT_S};
use breakaway::discover::decide::{NAMING, paired};
use breakaway::discover::judge::settings::Settings;
use breakaway::discover::request::Request;
use breakaway::discover::ruled::ruled;
use breakaway::fit::{Candidate, Fit, Free, Problem};
use breakaway_core::plant::{Base, Effect, Kind};
use breakaway_hidden::{Case, EffectTruth, Role, Truth};
use breakaway_tests::blind::recordings;
use breakaway_tests::requests::{Sessions, request};
use clap::Parser;

#[derive(Parser)]
#[command(arg_required_else_help = true)]
struct Asked {
    #[command(flatten)]
    sessions: Sessions,
}

/// Iterations of a fit from the true parameters.
const ITERATIONS: usize = 25;
/// Coefficient of restitution of a stiff contact, which the hidden plant has as a spring and a damper.
const RESTITUTION: f64 = 0.3;

/// A hidden effect in the catalogue's parameters. Signs and phases are still those of the hidden plant. `None` outside the
/// catalogue.
fn effect(own: &EffectTruth, b: f64) -> Option<Effect<f64>> {
    let kind = Kind::from_name(own.hidden.name())?;
    let of = |name: &str| own.parameters.iter().find(|(symbol, _)| *symbol == name).map(|(_, value)| *value);
    let value = |symbol: &str| match (own.hidden.name(), symbol) {
        ("constant_load", "f0") => of("bias"),
        ("dahl" | "lugre", "sigma") => of("sigma0"),
        ("inertia_step", "r") => of("delta"),
        ("flexible_coupling" | "backlash", "mu") => of("ratio"),
        ("flexible_coupling", "omega_r") => Some((of("k")? / (of("ratio")? * b)).sqrt()),
        ("flexible_coupling", "zeta") => Some(0.5 * of("d")? / (of("k")? * of("ratio")? * b).sqrt()),
        ("backlash", "g") => of("gap"),
        ("backlash", "e") => Some(RESTITUTION),
        (_, symbol) => of(symbol),
    };
    let parameters = kind.definition().parameters.iter();
    let p: Option<Vec<f64>> = parameters.map(|own| value(own.symbol).or(own.default)).collect();
    Some(Effect::new(kind, &p?))
}

/// The effect with each sign of its amplitude, or with eight phases.
fn with_signs(own: Effect<f64>) -> Vec<Effect<f64>> {
    let parameters = own.kind.definition().parameters;
    let changed = |i: usize, value: f64| {
        let mut other = own;
        other.p[i] = value;
        other
    };
    match parameters.iter().position(|parameter| parameter.symbol == "phi") {
        Some(i) => (0..8).map(|k| changed(i, own.p[i] + f64::from(k) * FRAC_PI_4)).collect(),
        None => vec![own, changed(0, if parameters[0].min < 0.0 { -own.p[0] } else { own.p[0] })],
    }
}

/// The recordings to fit, counted from the hidden plant's own zero, by the sensor's clock.
fn seen_from_one_zero(case: &Case) -> Option<(Request, Truth)> {
    let (session, truth) = case.generate_with_truth();
    let mut all = recordings(&session, Role::Fit);
    for recording in &mut all {
        let own = truth.records.iter().find(|own| own.name == recording.name)?;
        let off = own.x.iter().zip(&recording.x).map(|(x, seen)| x - seen).sum::<f64>() / recording.x.len() as f64;
        recording.x.iter_mut().for_each(|x| *x += off);
    }
    let own = request(&all);
    let held = truth.world.held_s.is_some();
    let own = if held { ruled(&own, &all.first()?.units, &Settings::default()).request } else { own };
    Some((own, truth))
}

fn fitted(problem: &Problem<'_>, candidate: &Candidate) -> Option<Fit> {
    problem.fit(candidate, &Free::all(&candidate.effects), None, ITERATIONS).ok()
}

/// What the session tells of each hidden effect, in words; `None` where the true model has no fit.
fn told(case: &Case) -> Option<String> {
    let (request, truth) = seen_from_one_zero(case)?;
    let data = Data::new(&request.recordings, &[], FIT_SEGMENT_S);
    let problem = data.problem();
    let base = Base { b: truth.base.b, c: truth.base.c, f1: truth.base.f1 };
    let mut effects: Vec<Effect<f64>> =
        truth.effects.iter().map(|own| effect(own, base.b)).collect::<Option<Vec<_>>>()?;
    let hidden = effects.len();
    // A late sensor of a position that is not held is a delay.
    let late = truth.world.sensor_delay_s > 0.0 && truth.world.held_s.is_none();
    if late && effects.iter().all(|own| own.kind != Kind::Delay) {
        effects.push(Effect::new(Kind::Delay, &[truth.world.sensor_delay_s]));
    }
    let mut candidate = Candidate { base, effects };
    for j in 0..hidden {
        let cost = |own: &Effect<f64>| {
            let mut other = candidate.clone();
            other.effects[j] = *own;
            problem.fit(&other, &[], None, 4).map_or(f64::INFINITY, |fit| fit.cost)
        };
        let best = with_signs(candidate.effects[j]).into_iter().map(|own| (cost(&own), own));
        candidate.effects[j] = best.min_by(|a, b| a.0.total_cmp(&b.0))?.1;
    }
    let full = fitted(&problem, &candidate)?;
    let over_noise = |fit: &Fit| (fit.mse.iter().sum::<f64>() / fit.mse.len() as f64).sqrt() / data.sigma;
    let mut words = vec![format!("{} {} %: {:.2} of the noise", case.seed, truth.size_percent, over_noise(&full))];
    for j in 0..hidden {
        let mut without = full.candidate.clone();
        let own = without.effects.remove(j);
        let without = fitted(&problem, &without)?;
        let found = paired(&without.mse, &full.mse, &full.samples, data.floor());
        let parameters = full.free.len() - without.free.len();
        let (name, z, lambda) = (own.kind.name(), found.z, found.lambda);
        let word = if found.names(parameters, &NAMING) { "told" } else { "not told" };
        words.push(format!("{name} {word}: z {z:.1}, λ {lambda:.0}, {:.2}", over_noise(&without)));
    }
    Some(words.join(" | "))
}

fn main() {
    for case in Asked::parse().sessions.cases().unwrap_or_else(|error| panic!("{error}")) {
        println!("{}", told(&case).unwrap_or_else(|| format!("{}: the true model has no fit", case.seed)));
    }
}
