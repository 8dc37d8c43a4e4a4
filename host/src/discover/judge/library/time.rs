//! Columns of effects of session time.

use std::sync::Arc;

use breakaway_core::plant::Kind;

use super::super::term::{Column, Term};
use super::super::wave_numbers::{Over, Peaks, peaks};
use super::super::weak_form::Field;
use super::made::once;
use super::{LINES, Library, effect};

/// Effects of session time.
pub(super) const OF_TIME: [Kind; 4] = [Kind::FrictionDrift, Kind::GainDrift, Kind::TimePeriodic, Kind::InertiaStep];
/// Time constants of a friction's warm-up, as shares of the session. The longest is a straight line to 5 % of its rise.
const WARM_UPS: [f64; 5] = [0.1, 0.2, 0.4, 0.8, 3.0];
/// Parts of a session. The inertia may step where one ends and the next begins.
const INSTANTS: u32 = 24;
/// Largest share of the samples in which a periodic force may be a harmonic of the drive. The others must show it.
const MOST_HARMONIC: f64 = 0.5;

impl Library<'_> {
    /// Effects of session time, where the recordings share a clock.
    pub(super) fn of_time(&self) -> Vec<Term> {
        let form = self.form;
        let mut terms = Vec::new();
        if !form.dataset.shared_clock {
            return terms;
        }
        let times: Vec<f64> = form.rows.iter().map(|r| form.dataset.pieces[r.piece].t[r.centre]).collect();
        let (Some(first), Some(last)) = (times.first(), times.last()) else { return terms };
        let (first, span) = (*first, last - first);
        let drifts = || WARM_UPS.map(|share| self.friction_drift(share * span)).to_vec();
        terms.extend(once(&form.made.drifts, drifts));
        if self.drive_varies() {
            let of = |drive: &Field| self.field(|s| drive[s.piece][s.k] * (s.t - first) / span);
            let mut term = effect(Kind::GainDrift, vec![of(&self.predicted)]);
            term.a = vec![Column::force(of(&self.arrived))];
            term.holds_drive = true;
            terms.push(term);
        }
        let Peaks { lines, of_lines } = peaks(form, self.residual, self.weights, Over::Time, LINES);
        for omega in lines {
            // What repeats with the motion is told from a function of the motion by nothing.
            if form.dataset.harmonic_of_the_drive(omega) > MOST_HARMONIC {
                continue;
            }
            terms.push(Term { chosen_of: of_lines, ..self.time_periodic(omega) });
        }
        for i in 1..INSTANTS {
            let instant = first + span * f64::from(i) / f64::from(INSTANTS);
            let after =
                |values: &[f64]| values.iter().zip(&times).map(|(a, t)| if *t > instant { *a } else { 0.0 }).collect();
            let mut term = effect(Kind::InertiaStep, Vec::new()).with(1, instant);
            term.chosen_of = f64::from(INSTANTS);
            term.u = vec![Column::Windows(Arc::new(after(&form.row_a)))];
            term.a = vec![Column::Windows(Arc::new(after(&self.predicted_a)))];
            terms.push(term);
        }
        terms
    }

    /// Friction that decays with this time constant, counted from the first sample.
    pub(super) fn friction_drift(&self, time_constant_s: f64) -> Term {
        let first_s = self.form.dataset.first_s();
        let decay = self.field(|s| s.direction * (-(s.t - first_s) / time_constant_s).exp());
        effect(Kind::FrictionDrift, vec![decay]).with(1, time_constant_s)
    }

    pub(super) fn time_periodic(&self, omega: f64) -> Term {
        let wave = |shift: f64| self.field(|s| (omega * s.t + shift).sin());
        effect(Kind::TimePeriodic, vec![wave(0.0), wave(std::f64::consts::FRAC_PI_2)]).with(1, omega)
    }
}
