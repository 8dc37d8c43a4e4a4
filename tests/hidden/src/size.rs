//! The sizes of the hidden effects, against the motion of the same experiments in the same world without its noise.

use crate::{
    draw::{Reference, hide, is_calibrated, rescale},
    effect::Hidden,
    experiment::Role,
    law::ForceLaw,
    machine::{Machine, stream},
    measure::gap_force,
    session::Case,
};

/// Sub-step of the pilots that only set sizes, s.
const PILOT_STEP_S: f64 = 2.5e-4;

impl Case {
    /// The law with the effects hidden in it, sized on this machine.
    pub(crate) fn law(&self, machine: &Machine, base: &ForceLaw) -> ForceLaw {
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
    fn calibrate(&self, machine: &Machine, name: &str, alone: &mut ForceLaw, law: &mut ForceLaw) {
        let target = self.size_percent / 100.0 * machine.amplitude;
        // The force grows less than the parameter where it slows the motion: secants in logarithms.
        let (mut slope, mut last) = (1.0_f64, None::<(f64, f64)>);
        for _ in 0..4 {
            let specs = self.plan(machine, alone);
            let peak = self
                .run(machine, alone, &specs, &self.world.calm(), PILOT_STEP_S)
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

    fn reference(&self, machine: &Machine, base: &ForceLaw) -> Reference {
        let specs = self.plan(machine, base);
        let world = self.world.calm();
        let traces = self.run(machine, base, &specs, &world, PILOT_STEP_S);
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
            acceleration: largest(
                &mut traces.iter().flat_map(|r| r.v.windows(2).map(|w| (w[1] - w[0]).abs() / world.tick_s)),
            ),
            positions,
            travel: high - low,
            fit_end: ends(Some(Role::Fit)),
            end: ends(None),
        }
    }
}
