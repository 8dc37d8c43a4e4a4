//! What the adaptive law does with the settings that `breakaway tune` chooses, and with others: a section of
//! `docs/adaptive.md`.

use std::fmt::Write as _;

use breakaway::control::design::{DEFAULT_ADAPTATION_RATE, Design, Request};
use breakaway::model::{BaseSe, Model};
use breakaway::recording::Units;
use breakaway_core::control::{ControllerState, Estimates, Sine};
use breakaway_core::plant::{Base, Drive, Plant};

/// The papers' plant.
const BASE: Base<f64> = Base { b: 0.02685, c: 0.11, f1: 0.5 };
/// Tick, s.
const TICK_S: f64 = 1e-3;
/// Encoder step, rad.
const STEP: f64 = 1e-3;

/// The law that `tune` writes for the papers' plant behind an encoder of 1 mrad. δ is a multiple of what a count
/// makes of the filtered difference.
///
/// # Panics
/// If the plant cannot be tuned for.
pub fn design(delta: Option<f64>, rate: f64) -> Design {
    let units = Units { u: "V".into(), x: "rad".into() };
    let model = Model { base: BASE, base_se: BaseSe::default(), units, effects: Vec::new(), provenance: Vec::new() };
    let request = Request {
        tick_s: TICK_S,
        delay_ticks: 1,
        bandwidth_hz: None,
        drive_limit: 12.0,
        encoder_step: STEP,
        speed: None,
        acceleration: None,
        adaptation_rate: rate,
    };
    let mut design = Design::new(&model, &request).expect("the papers' plant can be tuned for");
    design.adaptive = true;
    if let Some(jumps) = delta {
        design.adaptation.delta = jumps * STEP * design.gains.rate_of_step(TICK_S);
    }
    design
}

/// A sine of 1 rad at 0.25 Hz followed on the papers' plant.
#[derive(Clone, Debug)]
pub struct Adapted {
    errors: Vec<f64>,
    /// The estimates at the end, over the plant's parameters; f̂ in V.
    pub estimates: Estimates<f64>,
}

impl Adapted {
    /// Follows for so long with f1 a multiple of what the model says.
    ///
    /// # Panics
    /// If the core refuses the design.
    pub fn follow(design: &Design, factor: f64, seconds: u32) -> Self {
        let controller = design.controller::<f32>().expect("a design is a controller");
        let mut state = ControllerState::start(&controller);
        let sine = Sine::<f32>::new(1.0, 0.25, TICK_S).expect("a sine");
        let base = Base { f1: factor * BASE.f1, ..BASE };
        let plant = Plant { base, effects: &[] };
        let mut motion = plant.at_rest(0.0);
        let mut pending = 0.0_f64;
        let errors = (0..1000 * seconds).map(|k| {
            let t = f64::from(k) * TICK_S;
            plant.advance(&mut motion, Drive { u: &[pending], ts: TICK_S, t }, 1);
            let reading = ((motion.x / STEP).round() * STEP) as f32;
            let reference = sine.at(k);
            pending = f64::from(controller.tick(&mut state, reference, reading).expect("a drive").u);
            f64::from(reference.x) - motion.x
        });
        let errors = errors.collect();
        let hat = state.adaptive.estimates;
        let over = |value: f32, of: f64| f64::from(value) / of;
        let estimates = Estimates {
            b: over(hat.b, base.b),
            c: over(hat.c, base.c),
            f1: over(hat.f1, base.f1),
            f: f64::from(hat.f),
        };
        Self { errors, estimates }
    }

    /// RMS of the error between two times (s), rad.
    pub fn rms(&self, from_s: usize, to_s: usize) -> f64 {
        let part = &self.errors[1000 * from_s..1000 * to_s];
        (part.iter().map(|e| e * e).sum::<f64>() / part.len() as f64).sqrt()
    }
}

/// δ in jumps of a count, and the rate (rad/s).
const CHOICES: [(f64, f64); 6] = [(2.0, 5.0), (1.0, 5.0), (0.5, 2.0), (0.5, 5.0), (0.5, 10.0), (0.1, 5.0)];

/// The section.
pub fn section() -> String {
    let mut out = String::from(
        "
## What `breakaway tune` chooses

δ decides whether the law adapts: within δ it does not. A count of the encoder, Δ, makes a jump of Δ/(τ + Ts) in ė filtered over τ. With δ above that jump, an error of f1 by a third stays within the band, and nothing adapts. With δ far below it, the law adapts to the rounding. The rounding has no mean for f̂1. It has one for b̂ (−u_c·s_Δ contains Kv·s·s_Δ) and for ĉ (v·s_Δ contains −ė·s_Δ).

`tune` takes **half the jump**, and lets b̂ adapt at a tenth of the rate of the others. The gains are in proportion to the parameters' squares along a motion of speed f1/c and acceleration f1/b. In that motion inertia, damping and friction need the same drive each. `--speed` and `--acceleration` give another motion. `--adaptation-rate` is 5 rad/s by default. In the table the papers' plant follows 1 rad at 0.25 Hz, behind an encoder step of 1 mrad and one tick of delay. The law is tuned at the default bandwidth. Errors are rms in mrad; the rounding of the encoder alone is 0.29.

| δ, jumps | rate, rad/s | f1 30 % up: 4–12 s | 1–2 min | 4–5 min | f̂1/f1 then | nothing wrong: last of 60 min | b̂/b | ĉ/c | f̂1/f1 |
|---|---|---|---|---|---|---|---|---|---|
",
    );
    for (delta, rate) in CHOICES {
        let design = design(Some(delta), rate);
        let (up, same) = (Adapted::follow(&design, 1.3, 300), Adapted::follow(&design, 1.0, 3600));
        let usual = if (delta, rate) == (0.5, DEFAULT_ADAPTATION_RATE) { " (default)" } else { "" };
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "| {delta}{usual} | {rate} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} |",
            1e3 * up.rms(4, 12),
            1e3 * up.rms(60, 120),
            1e3 * up.rms(240, 300),
            up.estimates.f1,
            1e3 * same.rms(3540, 3600),
            same.estimates.b,
            same.estimates.c,
            same.estimates.f1
        );
    }
    out.push_str(
        "
Choose a faster rate where friction changes within a minute and someone watches. Choose a slower one where the controller runs for days: the last columns show how far rounding leads a fast law in an hour. A finer encoder moves δ, and with it the whole trade. Where a plant changes and the controller runs for good, the drift watch ([control.md](control.md)) and a new identification serve better than a fast law.
",
    );
    out
}
