//! The recordings of a case, run one after the other in its world.

use crate::{
    controller::Controller,
    disturbance::Disturbance,
    law::ForceLaw,
    machine::{Machine, stream},
    plan::Spec,
    plant::{Plant, State},
    sensor::Sensor,
    session::Case,
    world::World,
};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::PI;

/// Rest between two recordings of a session, s.
const PAUSE: f64 = 0.5;
/// Random streams of the sensor, of the torque, of the clock and of the encoder's zero; 0 and 1 draw machine and plan.
const SENSOR: u64 = 2;
const TORQUE: u64 = 3;
const CLOCK: u64 = 4;
const ZERO: u64 = 5;

/// Noise-free traces of one recording, one row per sample, with what was recorded.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// True session time of each sample, and for how long its drive is held, s.
    pub t: Vec<f64>,
    pub duration: Vec<f64>,
    /// Time that is logged.
    pub stamp: Vec<f64>,
    /// Drive that is logged, and what the supply makes of it.
    pub u: Vec<f64>,
    pub supplied: Vec<f64>,
    /// Mean random torque over the sample.
    pub torque: Vec<f64>,
    /// Shaft position and velocity.
    pub shaft: Vec<f64>,
    pub v: Vec<f64>,
    /// Second body's position.
    pub load: Vec<f64>,
    /// What the encoder would read exactly, and its rate.
    pub y: Vec<f64>,
    pub y_rate: Vec<f64>,
    /// What the sensor saw exactly (late, held, from its own zero), and what it reported.
    pub seen: Vec<f64>,
    pub measured: Vec<f64>,
}

/// How far each sample instant strays from the grid, s; one more than there are samples.
fn strays(world: &World, samples: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
    // A uniform distribution is √3 standard deviations wide to each side: at 20 % of a tick the instants keep their order.
    let widest = world.jitter.map_or(0.0, |jitter| 3f64.sqrt() * jitter.share * world.tick_s);
    (0..=samples).map(|_| if widest > 0.0 { rng.random_range(-widest..widest) } else { 0.0 }).collect()
}

/// Drive that a supply with sag delivers.
struct Supply<'a> {
    world: &'a World,
    limit: f64,
    /// Low-passed size of the drive.
    level: f64,
}

impl Supply<'_> {
    /// Effective drive over the next sample.
    fn deliver(&mut self, u: f64, duration: f64) -> f64 {
        let Some(sag) = self.world.sag else { return u };
        let effective = u * (1.0 - sag.share * self.level / self.limit);
        self.level += (u.abs() - self.level) * (1.0 - (-duration / sag.time_s).exp());
        effective
    }
}

impl Case {
    /// Runs the recordings in `world`, with sub-steps of at most `step_s`.
    pub(crate) fn run(
        &self,
        machine: &Machine,
        law: &ForceLaw,
        specs: &[Spec],
        world: &World,
        step_s: f64,
    ) -> Vec<Trace> {
        let tick_s = world.tick_s;
        let streams = [SENSOR, TORQUE, CLOCK, ZERO];
        let mut random = Random(streams.map(|number| stream(self.seed, number)));
        let mut t0 = 0.0;
        let mut one = |spec: &Spec| {
            let trace = record(machine, law, spec, world, t0, step_s, &mut random);
            t0 = ((t0 + spec.samples as f64 * tick_s + PAUSE) / tick_s).round() * tick_s;
            trace
        };
        specs.iter().map(&mut one).collect()
    }
}

/// The streams of sensor, torque, clock and zero.
struct Random([ChaCha8Rng; 4]);

fn record(
    machine: &Machine,
    law: &ForceLaw,
    spec: &Spec,
    world: &World,
    t0: f64,
    step_s: f64,
    random: &mut Random,
) -> Trace {
    let tick_s = world.tick_s;
    let Random([sensing, torque, clock, zeros]) = random;
    let strays = strays(world, spec.samples, clock);
    // Multiplied, not accumulated: the clock stays exact over the session.
    let grid = |k: usize| ((t0 / tick_s).round() + k as f64) * tick_s;
    // Not there rather than 0: a sum would turn the −0 of the kind world's files into 0.
    let zero = world.zero.then(|| (zeros.random_range(-PI..PI) / machine.encoder_step).round() * machine.encoder_step);
    let from_zero = |x: f64| zero.map_or(x, |zero| x + zero);
    let start = State::at_rest(spec.start);
    let mut plant = Plant::new(law, start, ((tick_s / step_s).round() as usize).max(1));
    plant.tick_s = tick_s;
    plant.disturbance = world.torque.map(|noise| {
        let seed = torque.random();
        Disturbance::new(noise, machine.drive_limit, stream(seed, TORQUE))
    });
    let mut sensor = Sensor::new(machine, world, grid(0) + strays[0], law.encoder(start.x), sensing);
    let mut controller = Controller::new(machine, spec, tick_s);
    let mut supply = Supply { world, limit: machine.drive_limit, level: 0.0 };
    let mut trace = Trace::with_capacity(spec.samples);
    for (k, stray) in strays.windows(2).enumerate() {
        let t = grid(k) + stray[0];
        let duration = tick_s + (stray[1] - stray[0]);
        let State { x, v, x2, .. } = plant.state;
        let reading = sensor.read(t, sensing);
        let u = controller.drive(k, reading.reported, reading.fresh);
        let supplied = supply.deliver(u, duration);
        let slope = law.eccentricity.map_or(1.0, |w| 1.0 + w.a * w.n * (w.n * x + w.phi).cos());
        trace.t.push(t);
        trace.duration.push(duration);
        trace.stamp.push(if world.jitter.is_some_and(|jitter| jitter.true_stamps) { t } else { grid(k) });
        trace.u.push(u);
        trace.supplied.push(supplied);
        trace.shaft.push(x);
        trace.v.push(v);
        trace.load.push(x2);
        trace.y.push(law.encoder(x));
        trace.y_rate.push(v * slope);
        trace.seen.push(from_zero(reading.exact));
        trace.measured.push(from_zero(reading.reported));
        let pushed = plant.sample_for(supplied, t, duration, |offset, s| sensor.measure(t + offset, law.encoder(s.x)));
        trace.torque.push(pushed);
    }
    trace
}

impl Trace {
    fn with_capacity(samples: usize) -> Self {
        let column = || Vec::with_capacity(samples);
        Self {
            t: column(),
            duration: column(),
            stamp: column(),
            u: column(),
            supplied: column(),
            torque: column(),
            shaft: column(),
            v: column(),
            load: column(),
            y: column(),
            y_rate: column(),
            seen: column(),
            measured: column(),
        }
    }
}
