//! The direction of the friction in `b·ẍ + c·ẋ + f1·s = u`. Where the axis slides, s is the sign of the motion. Where
//! the axis rests, friction balances the drive, and s is u/f1.

use breakaway_core::plant::Base;

use super::dataset::Piece;
use super::friction_observer::FrictionObserver;
use super::kernels::{Kernels, norm, over};
use super::library::Made;
use super::regression::{Design, rms};
use super::settings::Settings;
use super::sides::{Fitted, Model};
use super::start;
use super::term::Term;
use super::weak_form::{Field, WeakForm};

/// Largest share of the 95th percentile of the speed that the noise of the velocity may make.
const SLOW: f64 = 0.01;
/// Rounds of the friction at rest and the Coulomb friction f1, each of which follows from the other. The second round
/// changes f1 by a tenth of what the first does.
const STICKING: usize = 2;

/// Smoothed sign of the velocity at every sample of a piece, 0 at rest. The velocity is made of the fewest samples in
/// which the sensor's noise makes less than [`SLOW`] of the speed `v95`. At most `most` to either side are used.
pub(super) fn sliding(piece: &Piece, most: usize, v95: f64) -> Vec<f64> {
    let kernel = |half: usize| Kernels::new(half, piece.h_s);
    let noise_v = |kernel: &Kernels| piece.sigma * norm(&kernel.velocity);
    let halves = (2..most.max(3)).map(kernel);
    let fine = halves.into_iter().find(|own| noise_v(own) < SLOW * v95).unwrap_or_else(|| kernel(most.max(2)));
    let slow = 2.0 * noise_v(&fine) + 0.003 * v95;
    over(&fine, &fine.velocity, &piece.x).iter().map(|v| (v / slow).tanh()).collect()
}

impl WeakForm<'_> {
    /// Friction at rest holds against the drive, up to the Coulomb friction f1. There the direction is u/f1, within ±1.
    /// f1 and the direction follow from each other, so that both are found in turn.
    pub(super) fn stick(&mut self, sliding: &Field, settings: &Settings) {
        let weights = vec![1.0; self.rows.len()];
        for _ in 0..STICKING {
            let columns = vec![self.row_a[..].into(), self.row_v[..].into(), self.row_direction[..].into()];
            let design = Design { target: &self.row_u, columns };
            let fitted = design.fit(self, &weights, settings.folds).map(|fit| fit.coefficients[2]);
            let Some(f1) = fitted.filter(|f1| *f1 > 0.0) else { return };
            let pieces = self.direction.iter_mut().zip(sliding).zip(&self.dataset.pieces);
            for ((direction, sliding), piece) in pieces {
                for ((direction, sliding), u) in direction.iter_mut().zip(sliding).zip(&piece.u) {
                    *direction = sliding + (1.0 - sliding.abs()) * (u / f1).clamp(-1.0, 1.0);
                }
            }
            self.row_direction = self.means(&self.direction);
        }
    }
}

/// Velocity that is not told from rest, over the 95th percentile of the speed.
const REST: f64 = 0.002;
/// Least force that a model may lack, over the rms of the drive. A drive is known to about that.
const LEAST_LACKING: f64 = 0.01;

impl WeakForm<'_> {
    /// The same windows with the direction that a [`FrictionObserver`] gives beside a fitted model. `None` where the model
    /// tells no friction, or where its bristles or its second body have states that the observer has not.
    pub(super) fn observed(&self, model: &Model, fitted: &Fitted) -> Option<Self> {
        let side = &fitted.u;
        let foreign = model.terms.iter().any(|term| term.replaces_direction || term.body.is_some());
        if foreign || !(side.b > 0.0 && side.f1 > 0.0) {
            return None;
        }
        let beyond_noise = rms(&side.residual).powi(2) - (side.b * self.noise_a).powi(2);
        let late = |term: &Term| term.drive.is_some_and(|arrival| arrival.time_s().is_some());
        let arrived = Model { terms: model.terms.iter().filter(|term| late(term)).cloned().collect() }.arrived(self);
        let others = model.terms.iter().enumerate().filter(|(_, term)| !term.own_zeros && !late(term));
        let effects = others.filter_map(|(i, term)| Some(start::effect(self, side, term, i)?.0));
        let observer = FrictionObserver {
            base: Base { b: side.b, c: side.c.max(0.0), f1: side.f1 },
            effects: effects.collect(),
            lacking_u: beyond_noise.max(0.0).sqrt().max(LEAST_LACKING * rms(&side.target)),
            rate_per_s: 1.0 / self.half_width_s,
            rest: REST * self.v95,
        };
        let pieces = self.dataset.pieces.iter().zip(&arrived);
        let mut form = self.clone();
        form.made = Made::default();
        form.direction = pieces.map(|(piece, u)| observer.directions(piece, u)).collect();
        form.row_direction = form.means(&form.direction);
        Some(form)
    }
}

#[cfg(test)]
mod tests {
    use super::super::reading_age::reading_age_s;
    use super::super::sides::Model;
    use super::super::weights::Weights;
    use super::*;
    use crate::discover::judge::dataset::Dataset;
    use crate::discover::judge::regression::rms;
    use crate::recording::Recording;

    const B: f64 = 0.02;
    const F1: f64 = 0.3;

    /// 20 s at 1 kHz of an axis with Coulomb friction. Sines of .5 V at 1.1 Hz and .3 V at 4.7 Hz drive it; it rests
    /// for a third of the time. The position is read every `held` rows, and is `late` rows old.
    fn axis(held: usize, late: usize) -> Recording {
        let (h, steps) = (1e-3, 10);
        let (mut x, mut v) = (0.0, 0.0_f64);
        let mut recording = Recording::default();
        let mut seen = vec![0.0; late + 1];
        for k in 0..20_000 {
            let t = k as f64 * h;
            let u = 0.5 * (6.9 * t).sin() + 0.3 * (29.5 * t).sin();
            seen.push(x);
            let read = k / held * held;
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push(seen[read + 1]);
            for _ in 0..steps {
                let dt = h / f64::from(steps);
                let free = v + (u - F1 * v.signum()) / B * dt;
                let stuck = v == 0.0 && u.abs() <= F1;
                let turns = v != 0.0 && free * v < 0.0;
                v = if stuck || turns {
                    0.0
                } else if v == 0.0 {
                    (u - F1 * u.signum()) / B * dt
                } else {
                    free
                };
                x += v * dt;
            }
        }
        recording
    }

    /// The base leaves less than 2 % of the drive in wide windows, of which a third is rest. It would leave 5.6 % if
    /// friction at rest were nil. What is left comes from the 5 ms over which the velocity is smoothed.
    #[test]
    fn friction_at_rest_holds_against_the_drive() {
        let settings = Settings::default();
        let dataset = Dataset::new(&[axis(1, 0)], &settings);
        let form = WeakForm::new(&dataset, 0.15, &settings).unwrap();
        let fitted = Model::default().fit(&form, &Weights::equal(&form), &settings).unwrap();
        let left = rms(&fitted.u.residual) / rms(&form.row_u);
        assert!(left < 0.02, "{left}");
        assert!((fitted.u.f1 / F1 - 1.0).abs() < 0.02 && (fitted.u.b / B - 1.0).abs() < 0.02, "{:?}", fitted.u.f1);
    }

    /// Readings every 8 ms blur the reversals of two sines. In windows of 50 ms the base leaves 4.5 % of the drive with the
    /// velocity's direction, and .7 % with the observer's.
    #[test]
    fn a_reversal_between_two_readings_is_observed() {
        let settings = Settings::default();
        let dataset = Dataset::new(&Recording::refreshed_together(&[axis(8, 0)]), &settings);
        let form = WeakForm::new(&dataset, 0.05, &settings).unwrap();
        let model = Model::default();
        let fitted = |form: &WeakForm<'_>| model.fit(form, &Weights::equal(form), &settings).unwrap();
        let observed = form.observed(&model, &fitted(&form)).unwrap();
        let [before, after] = [&form, &observed].map(|form| rms(&fitted(form).u.residual) / rms(&form.row_u));
        assert!(before > 0.04 && after < 0.01, "{before} {after}");
    }

    /// Positions read every 8 ms are found to be 0, 3 and 6 ms old, as they are, to half a row. A position of every row
    /// has no age.
    #[test]
    fn the_age_of_held_readings_is_found() {
        let settings = Settings::default();
        for late in [0, 3, 6] {
            let fresh = Recording::refreshed_together(&[axis(8, late)]);
            let age_s = reading_age_s(&fresh, &settings).unwrap();
            assert!((age_s - 1e-3 * late as f64).abs() < 0.5e-3, "{late}: {age_s}");
        }
        assert_eq!(reading_age_s(&[axis(1, 3)], &settings), None);
    }
}
