//! A case by seed, and the recordings the tool may see.

use crate::{
    effect::{Hidden, UnknownEffect},
    experiment::{Experiment, Role},
    law::ForceLaw,
    machine::{Machine, stream},
    plan::{Spec, plan},
    truth::Truth,
    world::{Setting, World},
};

/// Sub-step of the delivered recordings, s; contacts and resonances are faster than the rest.
const STEP_S: f64 = 1e-4;
const FINE_STEP_S: f64 = 5e-5;

/// One recording. Row k: position at `t[k]`, and the drive held from `t[k]` to the next sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Name of the experiment.
    pub name: &'static str,
    /// Fit or score.
    pub role: Role,
    /// Session time (s), running on from one recording to the next, strictly increasing.
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
    /// Decimals of the times in a file.
    pub(crate) stamp_decimals: usize,
}

/// A blind case: the same case always gives the same bytes. The machine (base parameters, encoder) depends on the
/// seed and the world alone. So cases of one seed and world differ only by the hidden effects.
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
    /// What surrounds the plant.
    pub world: World,
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
            world: World::default(),
        })
    }

    /// A case on the suite (or its counterpart in closed loop) in the unkind world of that seed.
    ///
    /// # Errors
    /// [`UnknownEffect`] for a name that is not in the lists.
    pub fn unkind(seed: u64, effects: &[&str], size_percent: f64) -> Result<Self, UnknownEffect> {
        Ok(Self::suite(seed, effects, size_percent)?.within(Setting::Unkind.draw(seed)))
    }

    /// The same case in another world; one in closed loop replaces the suite by [`Experiment::Closed`].
    #[must_use]
    pub fn within(self, world: World) -> Self {
        let closed = world.closed && self.experiment == Experiment::Suite;
        let experiment = if closed { Experiment::Closed } else { self.experiment };
        Self { experiment, world, ..self }
    }

    /// The machine of this seed, with the world's encoder.
    pub(crate) fn machine(&self) -> Machine {
        Machine::draw(&mut stream(self.seed, 0), &self.world)
    }

    /// The recordings, without the truth.
    pub fn generate(&self) -> Session {
        self.generate_with_truth().0
    }

    /// The recordings and the sealed truth, for the scorer.
    pub fn generate_with_truth(&self) -> (Session, Truth) {
        let machine = self.machine();
        let base = machine.law();
        let law = self.law(&machine, &base);
        let specs = self.plan(&machine, &law);
        let step_s = if law.second.is_some() { FINE_STEP_S } else { STEP_S };
        let traces = self.run(&machine, &law, &specs, &self.world, step_s);
        let truth = Truth::new(self, &machine, &law, &specs, &traces);
        let records = specs
            .iter()
            .zip(traces)
            .map(|(spec, trace)| Record {
                name: spec.name,
                role: spec.role,
                t: trace.stamp,
                u: trace.u,
                x: trace.measured,
            })
            .collect();
        let session = Session {
            records,
            encoder_step: machine.encoder_step,
            noise_sigma: machine.noise_sigma,
            drive_limit: machine.drive_limit,
            drive_unit: "V",
            position_unit: "rad",
            // A jittered stamp at 10 kHz needs more than the kind world's four.
            stamp_decimals: if self.world.is_kind() { 4 } else { 7 },
        };
        (session, truth)
    }

    pub(crate) fn plan(&self, machine: &Machine, law: &ForceLaw) -> Vec<Spec> {
        plan(self.experiment, machine, law, &self.world, &mut stream(self.seed, 1))
    }
}
