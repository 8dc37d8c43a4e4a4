//! A case by seed, and the recordings the tool may see.

use crate::{
    draw::{Machine, Reference, hide, is_calibrated, rescale},
    effect::{Hidden, UnknownEffect},
    experiment::{Experiment, Kind, Role, Spec, plan},
    law::Law,
    measure::gap_force,
    plant::{Plant, State, TS, sign},
    truth::Truth,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

/// Sub-steps per sample of the delivered recordings, and of the pilots that only set sizes.
const SUBSTEPS: usize = 10;
const SUBSTEPS_FINE: usize = 20;
const SUBSTEPS_PILOT: usize = 4;
/// Rest between two recordings of a session, s.
const PAUSE: f64 = 0.5;

/// One recording. Row k: position at `t[k]`, and the drive held from `t[k]` to the next sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Name of the experiment.
    pub name: &'static str,
    /// Fit or score.
    pub role: Role,
    /// Session time (s), 1 kHz, running on from one recording to the next.
    pub t: Vec<f64>,
    /// Applied drive, V, zero-order held, exact.
    pub u: Vec<f64>,
    /// Encoder position, rad, a multiple of the encoder step.
    pub x: Vec<f64>,
}

/// What the tool may be told.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// The recordings, in the order they were made.
    pub records: Vec<Record>,
    /// Encoder step, rad.
    pub encoder_step: f64,
    /// Standard deviation of the noise before quantisation, rad.
    pub noise_sigma: f64,
    /// Largest drive, V.
    pub drive_limit: f64,
    /// Unit of the drive.
    pub drive_unit: &'static str,
    /// Unit of the position.
    pub position_unit: &'static str,
}

/// A blind case: the same case always gives the same bytes. The machine (base parameters, encoder)
/// depends on the seed alone, so cases of one seed differ only by what is hidden.
#[derive(Clone, Debug)]
pub struct Case {
    /// Seed of everything random.
    pub seed: u64,
    /// What is hidden; empty or [`Hidden::None`] for a clean case.
    pub effects: Vec<Hidden>,
    /// Size of each effect in % of the drive amplitude (definitions: see the crate's `draw` source
    /// and [`crate::EffectTruth`]); meant for 1–30.
    pub size_percent: f64,
    /// The recordings to make.
    pub experiment: Experiment,
}

/// Noise-free traces of one recording, one row per sample plus the end state.
#[derive(Clone, Debug)]
pub struct Trace {
    pub t: Vec<f64>,
    pub u: Vec<f64>,
    /// Shaft position and velocity.
    pub shaft: Vec<f64>,
    pub v: Vec<f64>,
    /// Second body's position.
    pub load: Vec<f64>,
    /// What the encoder would read exactly, and its rate.
    pub y: Vec<f64>,
    pub y_rate: Vec<f64>,
    /// What it read.
    pub measured: Vec<f64>,
}

impl Case {
    /// A case on the standard suite.
    ///
    /// # Errors
    /// [`UnknownEffect`] for a name that is not in the lists.
    pub fn suite(seed: u64, effects: &[&str], size_percent: f64) -> Result<Self, UnknownEffect> {
        Self::new(seed, effects, size_percent, Experiment::Suite)
    }

    /// A case on the given experiment.
    ///
    /// # Errors
    /// [`UnknownEffect`] for a name that is not in the lists.
    pub fn new(seed: u64, effects: &[&str], size_percent: f64, experiment: Experiment) -> Result<Self, UnknownEffect> {
        Ok(Self {
            seed,
            effects: effects.iter().map(|n| Hidden::named(n)).collect::<Result<_, _>>()?,
            size_percent,
            experiment,
        })
    }

    /// The recordings, without the truth.
    pub fn generate(&self) -> Session {
        self.generate_with_truth().0
    }

    /// The recordings and the sealed truth, for the scorer.
    pub fn generate_with_truth(&self) -> (Session, Truth) {
        let machine = Machine::draw(&mut stream(self.seed, 0));
        let base = machine.law();
        let law = self.law(&machine, &base);
        let specs = self.plan(&machine, &law);
        // Contacts and resonances are faster than the rest.
        let substeps = if law.second.is_some() { SUBSTEPS_FINE } else { SUBSTEPS };
        let traces = self.run(&machine, &law, &specs, substeps);
        let truth = Truth::new(self, &machine, &law, &specs, &traces);
        let records = specs
            .iter()
            .zip(traces)
            .map(|(spec, trace)| Record { name: spec.name, role: spec.role, t: trace.t, u: trace.u, x: trace.measured })
            .collect();
        let session = Session {
            records,
            encoder_step: machine.encoder_step,
            noise_sigma: machine.noise_sigma,
            drive_limit: machine.drive_limit,
            drive_unit: "V",
            position_unit: "rad",
        };
        (session, truth)
    }

    pub(crate) fn plan(&self, machine: &Machine, law: &Law) -> Vec<Spec> {
        plan(self.experiment, machine, law, &mut stream(self.seed, 1))
    }

    pub(crate) fn run(&self, machine: &Machine, law: &Law, specs: &[Spec], substeps: usize) -> Vec<Trace> {
        let mut rng = stream(self.seed, 2);
        let mut t0 = 0.0;
        specs
            .iter()
            .map(|spec| {
                let trace = record(machine, law, spec, t0, substeps, &mut rng);
                t0 = ((t0 + spec.samples as f64 * TS + PAUSE) / TS).round() * TS;
                trace
            })
            .collect()
    }

    /// The law with the effects hidden in it, sized on this machine.
    pub(crate) fn law(&self, machine: &Machine, base: &Law) -> Law {
        let mut law = base.clone();
        let size = self.size_percent / 100.0;
        if self.effects.iter().all(|e| *e == Hidden::None) {
            return law;
        }
        let reference = self.reference(machine, base);
        for effect in &self.effects {
            let name = effect.name();
            let mut rng = stream(self.seed, 16 + effect.index());
            let mut alone = base.clone();
            hide(&mut alone, name, size, &reference, &mut rng.clone());
            hide(&mut law, name, size, &reference, &mut rng);
            if is_calibrated(name) {
                self.calibrate(machine, name, &mut alone, &mut law);
            }
        }
        law
    }

    /// Scales the effect, alone on the base plant, until its largest force is the size asked for.
    fn calibrate(&self, machine: &Machine, name: &str, alone: &mut Law, law: &mut Law) {
        let target = self.size_percent / 100.0 * machine.amplitude;
        // The force grows less than the parameter where it slows the motion: secants in logarithms.
        let (mut slope, mut last) = (1.0_f64, None::<(f64, f64)>);
        for _ in 0..4 {
            let specs = self.plan(machine, alone);
            let peak = self
                .run(machine, alone, &specs, SUBSTEPS_PILOT)
                .iter()
                .flat_map(|trace| gap_force(machine, trace))
                .fold(1e-9, |m: f64, f| m.max(f.abs()));
            if let Some((step, before)) = last {
                slope = (peak / before).ln() / step;
                slope = slope.clamp(0.3, 1.5);
            }
            let step = ((target / peak).ln() / slope).clamp(-1.5, 1.5);
            if step.abs() < 0.01 {
                return;
            }
            rescale(alone, name, step.exp());
            rescale(law, name, step.exp());
            last = Some((step, peak));
        }
    }

    fn reference(&self, machine: &Machine, base: &Law) -> Reference {
        let specs = self.plan(machine, base);
        let traces = self.run(machine, base, &specs, SUBSTEPS_PILOT);
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let positions: Vec<f64> = traces.iter().flat_map(|r| r.shaft.iter().copied()).collect();
        let low = positions.iter().copied().fold(f64::INFINITY, f64::min);
        let high = positions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let ends = |role: Option<Role>| {
            specs
                .iter()
                .zip(&traces)
                .filter(|(spec, _)| role.is_none_or(|r| r == spec.role))
                .filter_map(|(_, trace)| trace.t.last().copied())
                .fold(0.0, f64::max)
        };
        let (omega, a) = machine.relay_cycle();
        Reference {
            amplitude: machine.amplitude,
            omega,
            peak_to_peak: 2.0 * a,
            encoder_step: machine.encoder_step,
            speed: largest(&mut traces.iter().flat_map(|r| r.v.iter().map(|v| v.abs()))),
            acceleration: largest(&mut traces.iter().flat_map(|r| r.v.windows(2).map(|w| (w[1] - w[0]).abs() / TS))),
            positions,
            travel: high - low,
            fit_end: ends(Some(Role::Fit)),
            end: ends(None),
        }
    }
}

/// Independent random stream of one seed.
fn stream(seed: u64, number: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    rng
}

/// The drive's maker during one recording.
struct Controller<'a> {
    spec: &'a Spec,
    limit: f64,
    hysteresis: f64,
    /// Offset of the relay's reference: with none, both relays hang on the first noise and may
    /// oppose each other for good.
    kick: f64,
    relay: f64,
    integral: f64,
    last_error: f64,
    rate: f64,
}

impl Controller<'_> {
    fn drive(&mut self, k: usize, x: f64) -> f64 {
        let t = k as f64 * TS;
        match &self.spec.kind {
            Kind::Open(u) => u.get(k).copied().unwrap_or(0.0),
            Kind::Relay { h1, h2, travel, period } => {
                let e = self.spec.start + self.kick + triangle(t / period) * travel - x;
                if e.abs() > self.hysteresis {
                    self.relay = sign(e);
                }
                self.integral += e * TS;
                h1 * self.relay + h2 * if self.integral < 0.0 { -1.0 } else { 1.0 }
            }
            Kind::Track { kp, kd, sines } => {
                let envelope = 1.0 - (-(t / 0.5).powi(2)).exp();
                let r: f64 = sines.iter().map(|(a, w, p)| a * (w * t + p).sin()).sum();
                let e = envelope * r + self.spec.start - x;
                let raw = (e - self.last_error) / TS;
                self.last_error = e;
                self.rate += (raw - self.rate) * TS / 0.01;
                (kp * e + kd * self.rate).clamp(-self.limit, self.limit)
            }
        }
    }
}

/// Unit triangle of period 1: 0, 1, 0, −1, 0.
fn triangle(phase: f64) -> f64 {
    let p = (phase + 0.25).rem_euclid(1.0);
    1.0 - 4.0 * (p - 0.5).abs()
}

fn record(machine: &Machine, law: &Law, spec: &Spec, t0: f64, substeps: usize, rng: &mut ChaCha8Rng) -> Trace {
    let mut plant = Plant::new(law, State::at_rest(spec.start), substeps);
    let mut controller = Controller {
        spec,
        limit: machine.drive_limit,
        hysteresis: 3.0 * machine.noise_sigma + machine.encoder_step,
        kick: 40.0 * machine.encoder_step,
        relay: 1.0,
        integral: 0.0,
        last_error: 0.0,
        rate: 0.0,
    };
    let column = || Vec::with_capacity(spec.samples);
    let mut trace = Trace {
        t: column(),
        u: column(),
        shaft: column(),
        v: column(),
        load: column(),
        y: column(),
        y_rate: column(),
        measured: column(),
    };
    for k in 0..spec.samples {
        // Multiplied, not accumulated: the clock stays exact over the session.
        let t = ((t0 / TS).round() + k as f64) * TS;
        let noise: f64 = rng.sample(StandardNormal);
        let State { x, v, x2, .. } = plant.state;
        let y = law.encoder(x);
        let step = machine.encoder_step;
        let measured = ((y + noise * machine.noise_sigma) / step).round() * step;
        let u = controller.drive(k, measured);
        let slope = law.eccentricity.map_or(1.0, |w| 1.0 + w.a * w.n * (w.n * x + w.phi).cos());
        trace.t.push(t);
        trace.u.push(u);
        trace.shaft.push(x);
        trace.v.push(v);
        trace.load.push(x2);
        trace.y.push(y);
        trace.y_rate.push(v * slope);
        trace.measured.push(measured);
        plant.sample(u, t);
    }
    trace
}
