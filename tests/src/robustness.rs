//! Random plants under the tuned controller: stable, still at rest, and back after saturation.

use breakaway::control::design::{Design, Request};
use breakaway::control::tracking::{Bench, track};
use breakaway::model::{BaseSe, EffectEntry, Model};
use breakaway::recording::Units;
use breakaway_core::control::{Profile, Setpoint, Sine};
use breakaway_core::plant::{Base, Effect, Kind};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Control tick of all loops, s.
pub const TICK_S: f64 = 1e-3;

/// A plant, its sensor, and what the controller takes it for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Random {
    /// Number in the series.
    pub number: usize,
    /// The true base.
    pub base: Base<f64>,
    /// The true effect; none in a quarter of the plants.
    pub effect: Option<Effect<f64>>,
    /// The base the controller is tuned for: each parameter off by up to 10 %.
    pub known: Base<f64>,
    /// Encoder counts per turn.
    pub counts: f64,
    /// Ticks from reading to drive.
    pub delay_ticks: u32,
}

/// What came of a plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrialResult {
    /// All three.
    Passed,
    /// No gains for it, or the error does not stay bounded.
    Unstable,
    /// At rest it moves by more than 3 counts.
    LimitCycle,
    /// After saturation it does not come back.
    Saturation,
}

/// The numbers behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// The verdict.
    pub verdict: TrialResult,
    /// Phase margin on the true plant would be near this, degrees.
    pub phase_deg: f64,
    /// RMS of tracking a sine, counts.
    pub rms_counts: f64,
    /// Peak to peak at rest, counts.
    pub rest_counts: f64,
    /// Error after saturation, counts.
    pub left_counts: f64,
    /// Share of the ticks that saturated in the saturating move.
    pub saturated: f64,
    /// How long the integral of that error needs to build up f1, s.
    pub break_away_s: f64,
}

/// The first `count` plants of the series: b, c and f1 log-uniform over two decades, 500 to 20 000 counts per turn, 0
/// to 2 ticks of delay. Three of four plants have one compensable effect at 5 to 30 % of f1.
pub fn plants(count: usize) -> Vec<Random> {
    let mut rng = ChaCha8Rng::seed_from_u64(20_261);
    (0..count)
        .map(|number| {
            let mut log = |from: f64, to: f64| from * (to / from).powf(rng.random_range(0.0..1.0));
            let base = Base { b: log(2e-3, 0.2), c: log(0.01, 1.0), f1: log(0.02, 2.0) };
            let counts = log(500.0, 20_000.0).round();
            let share = log(0.05, 0.3) * base.f1;
            let phase = rng.random_range(-3.0..3.0);
            let effect = match number % 8 {
                1 => Some(Effect::new(Kind::Cogging, &[share, 7.0, phase])),
                2 => Some(Effect::new(Kind::Stribeck, &[share, 0.3])),
                3 => Some(Effect::new(Kind::PositionFriction, &[share / base.f1, 5.0, phase])),
                4 => Some(Effect::new(Kind::ConstantLoad, &[share])),
                5 => Some(Effect::new(Kind::GravityLoad, &[share, phase])),
                7 => Some(Effect::new(Kind::Spring, &[share, 0.2])),
                _ => None,
            };
            let mut off = |value: f64| value * rng.random_range(0.9..1.1);
            let known = Base { b: off(base.b), c: off(base.c), f1: off(base.f1) };
            Random { number, base, effect, known, counts, delay_ticks: rng.random_range(0..3) }
        })
        .collect()
}

fn model(base: Base<f64>, effects: &[Effect<f64>]) -> Model {
    Model {
        base,
        base_se: BaseSe::default(),
        units: Units { u: "V".into(), x: "rad".into() },
        effects: effects.iter().map(|effect| EffectEntry::of(effect, &[])).collect(),
        provenance: Vec::new(),
    }
}

/// Most counts that an axis may move at rest, peak to peak, and be off after saturation.
pub const COUNTS: f64 = 3.0;

/// Tunes for the known model, and follows a sine, a move with a rest, and a move far beyond the drive, all with
/// compensation on.
pub fn try_plant(plant: &Random) -> Outcome {
    let step = std::f64::consts::TAU / plant.counts;
    let Base { b, c, f1 } = plant.base;
    // 1 rad at 0.5 Hz and its acceleration, with a third in hand.
    let (speed, acceleration) = (3.15, 9.9);
    let share = plant.effect.map_or(0.0, |_| 0.3 * f1);
    let limit = 1.5 * (b * acceleration + c * speed + f1 + share);
    let failed = |verdict| Outcome {
        verdict,
        phase_deg: f64::NAN,
        rms_counts: f64::NAN,
        rest_counts: f64::NAN,
        left_counts: f64::NAN,
        saturated: f64::NAN,
        break_away_s: f64::NAN,
    };
    let effects: Vec<Effect<f64>> = plant.effect.into_iter().collect();
    let known = model(plant.known, &effects);
    let request = Request {
        tick_s: TICK_S,
        delay_ticks: plant.delay_ticks,
        bandwidth_hz: None,
        drive_limit: limit,
        encoder_step: step,
        speed: Some(speed),
        acceleration: Some(acceleration),
        adaptation_rate: 1.0,
    };
    let Ok(design) = Design::new(&known, &request) else { return failed(TrialResult::Unstable) };
    let design = Design { compensate: true, ..design };
    let Ok(controller) = design.controller::<f32>() else { return failed(TrialResult::Unstable) };
    let truth = model(plant.base, &effects);
    let bench = Bench {
        tick_s: TICK_S,
        delay_ticks: plant.delay_ticks,
        encoder_step: step,
        noise: 0.2 * step,
        drive_limit: limit,
        seed: plant.number as u64,
    };
    let run = |points: &[Setpoint<f32>], from: usize| track(&truth, &controller, points, &bench, from);
    let ticks = 8_000_u32;
    // From rest at the sine's peak, so that the start is no jump.
    let (Ok(sine), Ok(turn)) = (Sine::<f32>::new(0.5, 0.5, TICK_S), Sine::<f32>::new(0.0, 0.5, TICK_S)) else {
        return failed(TrialResult::Unstable);
    };
    let quarter = (0.25 / (0.5 * TICK_S)) as u32;
    let points: Vec<_> = (0..ticks)
        .map(|k| Setpoint { x: sine.at(k + quarter).x - 0.5 + turn.at(k).x, ..sine.at(k + quarter) })
        .collect();
    let Ok(tracked) = run(&points, 2_000) else { return failed(TrialResult::Unstable) };
    let rms_counts = tracked.rms() / step;
    let largest = |from: usize, to: usize| tracked.error[from..to].iter().fold(0.0_f64, |m, e| m.max(e.abs()));
    let stable = largest(5_000, 8_000) <= 1.5 * largest(1_000, 5_000) + 3.0 * step && largest(5_000, 8_000) < 0.5;

    // A move with a rest of 4 s; the last 2 s count.
    let Ok(profile) = Profile::<f32>::s_curve(1.0, 2.0, 8.0, 200.0, TICK_S) else {
        return failed(TrialResult::Unstable);
    };
    let points: Vec<_> = (0..profile.ticks() + 4_000).map(|k| profile.at(k)).collect();
    let Ok(moved) = run(&points, 0) else { return failed(TrialResult::Unstable) };
    let rest = &moved.error[moved.error.len() - 2_000..];
    let (low, high) = rest.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), e| (l.min(*e), h.max(*e)));
    let rest_counts = (high - low) / step;

    // A move that asks for ten times the drive, then 15 s to come back.
    let beyond = 10.0 * limit / b;
    let Ok(leap) = Profile::<f32>::trapezoid(3.0, 10.0 * limit / c.max(0.05), beyond, TICK_S) else {
        return failed(TrialResult::Unstable);
    };
    let points: Vec<_> = (0..leap.ticks() + 15_000).map(|k| leap.at(k)).collect();
    let Ok(leapt) = run(&points, 0) else { return failed(TrialResult::Saturation) };
    let tail = &leapt.error[leapt.error.len() - 500..];
    let left_counts = tail.iter().fold(0.0_f64, |m, e| m.max(e.abs())) / step;

    let gains = &design.gains;
    let break_away_s = f1 / (gains.b * gains.kv * gains.lambda1 * left_counts * step);
    let verdict = if !stable {
        TrialResult::Unstable
    } else if rest_counts > COUNTS {
        TrialResult::LimitCycle
    } else if left_counts > COUNTS {
        TrialResult::Saturation
    } else {
        TrialResult::Passed
    };
    Outcome {
        verdict,
        phase_deg: design.margins().map_or(f64::NAN, |m| m.phase_deg),
        rms_counts,
        rest_counts,
        left_counts,
        saturated: leapt.saturated as f64 / leapt.error.len() as f64,
        break_away_s,
    }
}
