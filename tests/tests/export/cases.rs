//! What is simulated: an axis with one effect and a sensor, and the machines of the motor library.

use std::f64::consts::TAU;
use std::path::Path;

use breakaway::export::Motor;
use breakaway::fit::Candidate;
use breakaway::model::{EffectEntry, Model};
use breakaway::models::held_out::{Window, windows};
use breakaway::models::{self, check};
use breakaway_core::plant::{Drive, Effect, Kind, Plant};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// A model, and windows that it did not see.
pub struct Case {
    pub name: &'static str,
    pub what: String,
    pub model: Model,
    pub motor: Motor,
    pub windows: Vec<Window>,
}

/// A case's name, and its effect with its parameters.
type Named = (&'static str, Option<(Kind, &'static [f64])>);

const AXIS: &str = "[base]\nb = 0.02685\nc = 0.11\nf1 = 0.5\n[units]\nu = \"V\"\nx = \"rad\"\n";
/// Windows of an axis, each 1 s from rest.
const WINDOWS: u64 = 6;
/// Tick, s, and samples of a window.
const TICK_S: f64 = 1e-3;
const SAMPLES: usize = 1000;
/// Sub-steps of a tick of the simulation: 20 µs each, where its own error does not count.
const SUB_STEPS: usize = 50;
/// Encoder step, rad.
const STEP: f64 = 1e-3;

/// The axis of the papers with one effect, true and with an encoder of 1 mrad. The model is the truth, so that our error is
/// the sensor's alone, and every other error shows.
pub fn simulated() -> Vec<Case> {
    let all: [Named; 12] = [
        ("base", None),
        ("constant-load", Some((Kind::ConstantLoad, &[0.1]))),
        ("cogging", Some((Kind::Cogging, &[0.2, 7.0, 0.5, 0.05, 1.0]))),
        ("gravity", Some((Kind::GravityLoad, &[0.4, 0.3]))),
        ("spring", Some((Kind::Spring, &[0.4, 0.2]))),
        ("quadratic-drag", Some((Kind::QuadraticDrag, &[0.01]))),
        ("lugre", Some((Kind::LuGre, &[40.0, 0.3, 0.25, 0.5]))),
        ("dahl", Some((Kind::Dahl, &[20.0]))),
        ("flexible-coupling", Some((Kind::FlexibleCoupling, &[0.4, 60.0, 0.05]))),
        ("delay", Some((Kind::Delay, &[0.004]))),
        ("electrical-lag", Some((Kind::ElectricalLag, &[0.004]))),
        ("stribeck", Some((Kind::Stribeck, &[0.25, 0.5]))),
    ];
    let case = |(name, effect): Named| {
        let mut model = Model::parse("axis.toml", AXIS).unwrap();
        let effects: Vec<Effect<f64>> = effect.map(|(kind, p)| Effect::new(kind, p)).into_iter().collect();
        model.effects = effects.iter().map(|effect| EffectEntry::of(effect, &[])).collect();
        let plant = Plant { base: model.base, effects: &effects };
        let windows = (0..WINDOWS).map(|seed| window(&plant, seed)).collect();
        let motor = Motor { drive_gain: Some(0.25), ..Motor::default() };
        let what = format!("simulated, {}", effect.map_or("no effect", |(kind, _)| kind.name()));
        Case { name, what, model, motor, windows }
    };
    all.into_iter().map(case).collect()
}

/// A window from rest under a sum of five sines; the first drive is 0.
fn window(plant: &Plant<'_, f64>, seed: u64) -> Window {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let sines: Vec<[f64; 2]> = (0..5).map(|k| [0.7 + 1.3 * f64::from(k), rng.random_range(0.0..TAU)]).collect();
    let drive = |t: f64| sines.iter().map(|[hz, phase]| 0.9 * (TAU * hz * t + phase).sin()).sum::<f64>();
    let mut window = Window {
        t: Vec::new(),
        u: Vec::new(),
        measured: Vec::new(),
        simulated: Vec::new(),
        start: [0.0; 2],
        memory: plant.effects.iter().map(|effect| effect.at_rest(0.0)).collect(),
    };
    let mut state = plant.at_rest(0.0);
    for k in 0..SAMPLES {
        let t = k as f64 * TICK_S;
        window.t.push(t);
        window.u.push(if k == 0 { 0.0 } else { drive(t) });
        let x = plant.measured(state.x);
        // A reading falls anywhere within a count.
        window.measured.push(((x / STEP + rng.random_range(-0.5..0.5)).round()) * STEP);
        window.simulated.push(x);
        plant.advance(&mut state, Drive { u: &window.u, ts: TICK_S, t }, SUB_STEPS);
    }
    window
}

/// The machines of the motor library, on the held-out part of their recordings. A drive whose force is not known counts as
/// 1 N·m, and a position that is no angle as one of rad: the motion is the same.
pub fn real(data: &Path) -> Vec<Case> {
    let case = |card: models::Card| {
        let recordings = check::recordings(&card, data).unwrap();
        let candidate = Candidate { base: card.model.base, effects: card.model.plant_effects().unwrap() };
        let motor = card.motor.beside(&Motor::default());
        let known = motor.drive_gain.or(motor.motor_constant).is_some();
        let motor = Motor {
            drive_gain: if known { motor.drive_gain } else { Some(1.0) },
            counts_per_turn: motor.counts_per_turn.or(Some(TAU)),
            ..motor
        };
        Case {
            name: models::names().into_iter().find(|name| *name == card.head.name).unwrap(),
            what: format!("{}, {}", card.head.machine, models::page::effects(&card)),
            windows: windows(&candidate, &recordings, card.held_out.window_s),
            model: card.model,
            motor,
        }
    };
    models::all().unwrap().into_iter().map(case).collect()
}
