//! Damaged model and experiment files: an error with the file's name, or a value that keeps its promises, never a panic.
//!
//! `BREAKAWAY_FUZZ_ITERATIONS` sets the number of files (`cargo xtask fuzz` runs more: each iteration has its own seed).

use std::panic::catch_unwind;

use breakaway::model::Model;
use breakaway::simulate::experiment::Experiment;
use breakaway_core::plant::Base;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const ITERATIONS: u64 = 4_000;

const MODELS: [&str; 2] = [
    "# from a.csv\n\n[base]\nb = 0.0031\nc = 1\nf1 = 0.4\n[base.se]\nb = 1e-5\n[units]\nu = \"V\"\nx = \"rad\"\n[[effect]]\nname = \"stribeck\"\ns = 0.2\nvs = 0.1\n[effect.se]\ns = 0.01\n",
    "base = { b = 1.0, c = 0.0, f1 = 0.0 }\neffect = [{ name = \"backlash\", g = 0.1, mu = 0.3 }, { name = \"cogging\", A = 1, n = 50, phi = 0 }]\n",
];

const EXPERIMENTS: [&str; 3] = [
    "name = \"relay\"\nduration_s = 2.0\nseed = 3\n[excitation]\nkind = \"relay\"\nh1 = 2.0\nh2 = 1.5\n[excitation.reference]\nshape = \"triangle\"\namplitude = 1.0\nperiod_s = 4.0\n[sensor]\nencoder_step = 1e-3\nnoise = 1e-4\ndelay_ticks = 2\n",
    "name = \"m\"\nduration_s = 1.0\ntick_s = 0.002\ntravel_limit = 5.0\n[excitation]\nkind = \"multisine\"\namplitude = 2.0\nfrom_hz = 0.5\nto_hz = 16.0\ncentring = 0.1\n",
    "name = \"t\"\nduration_s = 1\n[excitation]\nkind = \"track\"\nkp = 20.0\nkd = 0.5\nreference = { shape = \"sine\", amplitude = 1.0, period_s = 2.0 }\n",
];

const PIECES: [&str; 24] = [
    "nan",
    "-inf",
    "1e308",
    "-1e308",
    "1e-320",
    "99999999999999999999",
    "0x1F",
    "0",
    "-1",
    "\"",
    "'''",
    "[",
    "]",
    "[[",
    "{",
    "}",
    "=",
    "\n",
    "#",
    "é",
    "\u{0}",
    "b = 1\n",
    "[base]\n",
    "1979-05-27",
];

fn below(rng: &mut ChaCha8Rng, limit: usize) -> usize {
    (rng.next_u64() % limit.max(1) as u64) as usize
}

fn mutate(rng: &mut ChaCha8Rng, seeds: &[&str]) -> String {
    let mut bytes = seeds[below(rng, seeds.len())].as_bytes().to_vec();
    for _ in 0..=below(rng, 3) {
        let at = below(rng, bytes.len() + 1);
        let end = (at + below(rng, 12)).min(bytes.len());
        match below(rng, 6) {
            0 => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << below(rng, 8);
                }
            }
            1 => bytes.truncate(at.max(end)),
            2 => drop(bytes.splice(at..at, PIECES[below(rng, PIECES.len())].bytes())),
            3 => drop(bytes.drain(at..end)),
            // A digit for another keeps the file valid and changes what it says.
            4 => {
                for byte in bytes.iter_mut().filter(|byte| byte.is_ascii_digit()) {
                    if below(rng, 8) == 0 {
                        *byte = b'0' + below(rng, 10) as u8;
                    }
                }
            }
            _ => {
                let copy = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, copy));
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Runs `judge` (true: accepted) on damaged files; both answers must be frequent, or the test tests nothing.
fn fuzz(seeds: &'static [&str], judge: fn(&str) -> bool) {
    let iterations = std::env::var("BREAKAWAY_FUZZ_ITERATIONS")
        .map_or(ITERATIONS, |n| n.parse().expect("BREAKAWAY_FUZZ_ITERATIONS is a number"));
    let mut good = 0;
    for iteration in 0..iterations {
        let text = mutate(&mut ChaCha8Rng::seed_from_u64(iteration), seeds);
        match catch_unwind(|| judge(&text)) {
            Ok(accepted) => good += u64::from(accepted),
            Err(payload) => panic!("iteration {iteration}: {:?}: {text:?}", payload.downcast_ref::<String>()),
        }
    }
    assert!(20 * good > iterations && 20 * (iterations - good) > iterations, "{good} of {iterations} accepted");
}

#[test]
fn a_damaged_model_file_is_refused_or_means_what_it_writes() {
    fuzz(&MODELS, |text| match Model::parse("fuzz.toml", text) {
        Ok(model) => {
            Base::new(model.base.b, model.base.c, model.base.f1).unwrap();
            assert!(model.plant_effects().is_err() || model.effects.iter().all(|entry| entry.effect().is_some()));
            assert_eq!(Model::parse("again.toml", &model.to_toml()).unwrap(), model);
            true
        }
        Err(error) => {
            assert!(error.to_string().starts_with("fuzz.toml:"), "{error}");
            false
        }
    });
}

/// What is accepted can be run: a bounded number of samples is, with an answer or an error.
#[test]
fn a_damaged_experiment_file_is_refused_or_can_be_run() {
    fuzz(&EXPERIMENTS, |text| match Experiment::parse("fuzz.toml", text) {
        Ok(experiment) => {
            if experiment.samples() <= 5_000 && experiment.sensor.delay_ticks <= 5_000 {
                let plant = breakaway::command::run::papers_plant();
                let mut axis = breakaway::simulate::axis::Axis::new(plant.base, &[], plant.units);
                if let Ok(run) = axis.run(&experiment) {
                    assert!(run.recording.x.iter().chain(&run.recording.u).all(|value| value.is_finite()));
                    let ending = breakaway::identify::relay::ending(&run, &experiment, None);
                    assert!(ending.is_none_or(|ending| !ending.text(&run.recording.units).is_empty()));
                }
            }
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    });
}
