//! The parameters of a term that its columns are made with, found beside all other terms. A grid holds them a step
//! apart, and the line of a spectrum is that of what the model without the ripple leaves. Both leave a part of the force.

use rayon::prelude::*;

use super::bar::Bar;
use super::library::Library;
use super::search::Stage;
use super::tried::Tried;
use crate::fit::golden_section;

/// Steps of a golden section. They narrow the bracket to a hundredth.
const STEPS: usize = 10;
/// Most terms of a round whose parameters are sought, the best.
const CONTENDERS: usize = 3;

impl Stage<'_> {
    /// The best terms of a round with the parameters that gain most; the others as they are. `tried` is in the order of
    /// rank, those that hold first.
    pub(super) fn with_contenders_tuned(&self, library: &Library<'_>, tried: Vec<Tried>) -> Vec<Tried> {
        let holding = tried.iter().take(CONTENDERS).take_while(|own| own.rejection().is_none()).count();
        let each = tried.into_par_iter().enumerate();
        each.map(|(i, own)| if i < holding { self.tuned(library, own) } else { own }).collect()
    }

    /// A pair that is to be named, each term with the parameters that gain most beside the other.
    pub(super) fn with_pair_tuned(&self, mut named: Tried) -> Tried {
        for j in 0..named.terms.len() {
            let others = named.terms.iter().enumerate().filter(|(i, _)| *i != j).map(|(_, term)| term);
            let model = others.fold(self.model.clone(), |model, term| model.with(term));
            let Some(beside) = Stage::new(self.form, self.settings, model, &self.weights) else { continue };
            let Some(own) = beside.weighed(named.terms[j].clone(), &Bar::OPEN) else { continue };
            let tuned = beside.tuned(&beside.library(), own);
            (named.terms[j], named.evidence[j]) = (tuned.terms[0].clone(), tuned.evidence[0]);
        }
        named
    }

    /// A single term with the parameters that gain most beside the model, each by golden section within its bracket. It
    /// stays as it is where they gain no more, and where it would not hold.
    pub(super) fn tuned(&self, library: &Library<'_>, own: Tried) -> Tried {
        let mut best = own;
        for (i, bracket) in library.brackets(&best.terms[0]) {
            let at = |value: f64| {
                let mut parameters: Vec<f64> = best.terms[0].parameters.iter().map(|(_, value)| *value).collect();
                parameters[i] = value;
                self.weighed(library.remade(&best.terms[0], &parameters)?, &Bar::OPEN)
            };
            let value = golden_section(bracket, STEPS, |value| at(value).map_or(f64::INFINITY, |tried| -tried.gain));
            let better = at(value).filter(|other| other.gain > best.gain && other.rejection().is_none());
            best = better.unwrap_or(best);
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Kind;

    use super::super::ruling::rule;
    use super::super::settings::Settings;
    use crate::recording::Recording;

    /// Inertia, viscous and Coulomb friction; ripple in drive units, and its waves in a position unit.
    const BASE: [f64; 3] = [0.02, 0.05, 0.1];
    const RIPPLE: [f64; 2] = [0.1, 2.3];

    /// 12 s at 500 Hz under two sines: the axis passes two waves of the ripple. The spectrum of what the base
    /// leaves is off by 1.5 %, which leaves 2.1 nats in the force. Beside the base they are found within .02 %.
    #[test]
    fn a_ripple_of_few_turns_is_found_beside_the_base() {
        let (mut x, mut v) = (0.0, 0.0_f64);
        let mut recording = Recording::default();
        for k in 0..6000 {
            let t = 2e-3 * f64::from(k);
            let u = 0.5 * (2.1 * t).cos() + 0.3 * (13.3 * t).sin();
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push(x);
            for _ in 0..20 {
                let force = u - RIPPLE[0] * (RIPPLE[1] * x).sin();
                let free = v + (force - BASE[2] * v.signum() - BASE[1] * v) / BASE[0] * 1e-4;
                v = if free * v < 0.0 && force.abs() <= BASE[2] { 0.0 } else { free };
                x += v * 1e-4;
            }
        }
        let ruling = rule(&[recording], None, &Settings::default()).unwrap();
        let ripple = ruling.findings.iter().find(|finding| finding.effect.kind == Kind::Cogging).unwrap();
        assert!((ripple.effect.p[1] / RIPPLE[1] - 1.0).abs() < 1e-3, "{:?}", ripple.effect);
    }
}
