//! Which held-out score tells the estimator that is nearer to the truth: the table of docs/theory.md, section 5.

use breakaway_core::plant::{Base, Effect, Kind};

use super::*;
use crate::fit::{median, session};
use crate::identify::choice::{choose, models};
use crate::identify::equation_error::{both_directions, from_weak, solve_base};
use crate::identify::estimate::WHITE_RATIO;
use crate::identify::output_error::{FIT_SEGMENT_S, OUTPUT_ERROR, fitted_from, output_error, sampled_segments};
use crate::identify::weak;
use crate::recording::{Recording, Units};
use crate::simulate::axis::Axis;
use crate::simulate::experiment::{Excitation, Experiment, Reference, Sensor};

const TRUTH: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
/// Predictions, s seen and as long ahead; then the simulation's own 0.4 s, and the weak form's own residual.
const AHEAD_S: [f64; 3] = [0.05, 0.126, 0.4];
const SCORES: [&str; 5] = ["ahead .05 s", "ahead .126 s", "ahead .4 s", "within .4 s", "residual"];

fn effects() -> Vec<(&'static str, Vec<Effect<f64>>)> {
    let one = |kind, p: &[f64]| vec![Effect::new(kind, p)];
    vec![
        ("none", vec![]),
        ("LuGre, 40 V/rad", one(Kind::LuGre, &[40.0, 0.3, 0.25, 0.5])),
        ("LuGre, 100 V/rad", one(Kind::LuGre, &[100.0, 0.3, 0.15, 0.2])),
        ("LuGre, 20 V/rad", one(Kind::LuGre, &[20.0, 0.1, 0.1, 0.3])),
        ("Dahl", one(Kind::Dahl, &[20.0])),
        ("Stribeck", one(Kind::Stribeck, &[0.3, 0.5, 2.0])),
        ("backlash", one(Kind::Backlash, &[0.05, 0.4, 0.3])),
        ("gravity", one(Kind::GravityLoad, &[0.3, 0.0])),
        ("cogging", one(Kind::Cogging, &[0.15, 12.0, 0.0])),
        ("quadratic drag", one(Kind::QuadraticDrag, &[0.01])),
        ("load friction", one(Kind::LoadFriction, &[0.1])),
        ("delay", one(Kind::Delay, &[0.003])),
        ("electrical lag", one(Kind::ElectricalLag, &[0.003])),
    ]
}

/// Two relays, one relay, a multisine, and a relay with a multisine and a slow sine: 14 s each.
fn sessions() -> Vec<Vec<Excitation>> {
    let relay = |h1, h2| Excitation::Relay { h1, h2, hysteresis: Some(0.006), reference: Reference::Start };
    let multisine = Excitation::Multisine { amplitude: 2.0, from_hz: 0.2, to_hz: 8.0, centring: 0.3 };
    let slow = Excitation::Sine { amplitude: 1.0, frequency_hz: 0.4, centring: 0.0 };
    vec![
        vec![relay(2.0, 1.5), relay(1.2, 0.9)],
        vec![relay(2.0, 1.5)],
        vec![multisine.clone()],
        vec![relay(2.0, 1.5), multisine, slow],
    ]
}

fn recorded(effects: &[Effect<f64>], session: &[Excitation], noise: f64, seed: u64) -> Vec<Recording> {
    let mut axis = Axis::new(TRUTH, effects, Units { u: "V".into(), x: "rad".into() });
    let run = |(i, excitation): (usize, &Excitation)| {
        let experiment = Experiment {
            name: format!("r{i}"),
            tick_s: 1e-3,
            duration_s: 14.0,
            seed: 10 * seed + i as u64,
            drive_limit: f64::INFINITY,
            travel_limit: f64::INFINITY,
            excitation: excitation.clone(),
            sensor: Sensor { encoder_step: noise, noise, delay_ticks: 0 },
        };
        axis.run(&experiment).unwrap().recording
    };
    session.iter().enumerate().map(run).collect()
}

fn off(base: Base<f64>) -> f64 {
    let ratios = [base.b / TRUTH.b, base.c / TRUTH.c, base.f1 / TRUTH.f1];
    (ratios.iter().map(|ratio| (ratio - 1.0).powi(2)).sum::<f64>() / 3.0).sqrt()
}

/// What both estimators make of a session.
struct Measured {
    /// Their distance from the truth, weak form first.
    off: [f64; 2],
    /// Whether the simulation's residual is noise.
    white: bool,
    /// What every score says.
    scores: [Option<Comparison>; 5],
}

fn measured(recordings: &[Recording]) -> Option<Measured> {
    let tracks = session(recordings);
    let windows = weak::windows(&tracks);
    let both = both_directions(&windows);
    let by_force = from_weak(&solve_base(&windows, both).ok()?, both);
    let sigma = median(tracks.iter().map(|t| t.sigma).collect());
    let segments = sampled_segments(&tracks, FIT_SEGMENT_S);
    let problem = output_error(&tracks, &segments, sigma);
    let fit = fitted_from(&problem, &by_force)?;
    let white = median(fit.mse.clone()) < WHITE_RATIO * sigma * sigma;
    let weak_base = Base { b: by_force.b.value, c: by_force.c.value, f1: by_force.f1.value };
    let blocks = blocks(&tracks);
    let fitted = |i| models(&problem, &fold(&tracks, &blocks, &windows, FIT_SEGMENT_S, i), both);
    let models = [fitted(0)?, fitted(1)?];
    let own = |floor: f64, of: &dyn Fn(&Candidate, &Block) -> f64| {
        let each = blocks.iter().enumerate().map(|(i, block)| {
            let [a, b] = &models[1 - i % 2];
            0.5 * ((floor + of(a, block)) / (floor + of(b, block))).ln()
        });
        Comparison::of(&each.filter(|d| d.is_finite()).collect::<Vec<_>>())
    };
    let within = own(sigma * sigma, &|model, block| {
        let track = &tracks[block.track];
        let len = (FIT_SEGMENT_S / track.ts) as usize;
        let starts = (block.start..).step_by(len).take_while(|start| start + len <= block.end);
        let segments: Vec<Segment> = starts.map(|start| Segment { track: block.track, start, len }).collect();
        median(Problem { segments: &segments, ..problem }.score(model))
    });
    let residual = own(0.0, &|model, block| {
        let inside =
            |w: &&Window| w.track == block.track && w.first >= block.start && w.first + w.weights.len() < block.end;
        let load = model.effects.first().map_or(0.0, |effect| effect.p[0]);
        let left = |w: &Window| {
            let Base { b, c, f1 } = model.base;
            w.drive - b * w.acceleration - c * w.velocity - f1 * w.direction - load * w.unit
        };
        windows.iter().filter(inside).map(|w| left(w).powi(2)).sum()
    });
    let [a, b, c] = AHEAD_S.map(|horizon_s| compare_ahead(&problem, &blocks, &models, horizon_s));
    let off = [off(weak_base), off(fit.candidate.base)];
    Some(Measured { off, white, scores: [a, b, c, within, residual] })
}

/// Prints the table. The assertions are the reasons for the score that is used. Of the five it has the largest share
/// of right choices where something is missing. It never prefers the weak form where nothing is, and brings the
/// reported values nearer to the truth.
#[test]
#[ignore = "a minute or two: cargo test -p breakaway --lib held_out -- --ignored --nocapture"]
fn the_table_of_scores() {
    // Right and wrong choices of every score.
    let mut all = [[0; 2]; SCORES.len()];
    // ln of the distance from the truth of what is reported: by the weak form, output error, the tie rule, every score, the nearer one.
    let mut reported = Vec::new();
    for (name, effects) in effects() {
        let (mut nearer, mut sets, mut own) = (0, 0, [[0; 2]; SCORES.len()]);
        for session in sessions() {
            for (seed, noise) in [5e-4, 1e-3, 2e-4].into_iter().enumerate() {
                let recordings = recorded(&effects, &session, noise, seed as u64);
                let Some(Measured { off, white, scores }) = measured(&recordings) else { continue };
                let truth = off[1] < off[0];
                let by = |score: Option<Comparison>| off[usize::from(choose(score, white).estimator == OUTPUT_ERROR)];
                let chosen = [off[0], off[1], by(None)].into_iter().chain(scores.map(by)).chain([off[0].min(off[1])]);
                if !effects.is_empty() {
                    reported.push(chosen.map(f64::ln).collect::<Vec<_>>());
                }
                sets += 1;
                nearer += usize::from(truth);
                for (score, own) in scores.into_iter().zip(&mut own) {
                    let Some(score) = score else { continue };
                    own[0] += usize::from(if truth { score.second_is_better() } else { score.first_is_better() });
                    own[1] += usize::from(if truth { score.first_is_better() } else { score.second_is_better() });
                }
            }
        }
        println!("{name}: output error nearer in {nearer} of {sets}; right, wrong of {SCORES:?}: {own:?}");
        if effects.is_empty() {
            assert_eq!(own[0][1], 0, "the weak form is preferred where nothing is missing");
            continue;
        }
        for (all, own) in all.iter_mut().zip(own) {
            *all = [all[0] + own[0], all[1] + own[1]];
        }
    }
    println!("all with something missing: {all:?}");
    let mean = |i: usize| (reported.iter().map(|row| row[i]).sum::<f64>() / reported.len() as f64).exp();
    let means: Vec<f64> = (0..reported[0].len()).map(mean).collect();
    println!("distance of weak form, output error, tie rule, {SCORES:?}, the nearer one: {means:.4?}");
    // Nearer than either estimator, than the tie rule, and than by what either estimator minimises.
    assert!([0, 1, 2, 6, 7].iter().all(|i| means[*i] > means[3]), "{means:?}");
    let share = |[right, wrong]: [usize; 2]| right as f64 / (right + wrong) as f64;
    assert!(all[1..].iter().all(|other| share(*other) < share(all[0])), "{all:?}");
}
