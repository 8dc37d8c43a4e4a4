//! Terms of what happens to the drive on its way to the axis.

use breakaway_core::plant::Kind;

use super::super::term::{Arrival, Term};
use super::{Library, effect};

/// Shares of the drive that a friction by load may take. Gears take more than the least; beyond the most hardly
/// anything would move.
const LEAST_LOAD: f64 = 0.01;
const MOST_LOAD: f64 = 0.9;

impl Library<'_> {
    pub(super) fn of_the_drive(&self) -> Vec<Term> {
        let form = self.form;
        let mut terms = Vec::new();
        let longest_s = 0.06_f64.max(4.0 * form.half_width_s);
        let arriving = |kind: Kind, arrival: Arrival, parameters: &[f64]| {
            let mut term = effect(kind, Vec::new());
            term.parameters = parameters.iter().copied().enumerate().collect();
            term.size = parameters.len();
            term.drive = Some(arrival);
            term
        };
        let has = |test: fn(&Arrival) -> bool| self.model.terms.iter().filter_map(|t| t.drive.as_ref()).any(test);
        if !has(|a| matches!(a, Arrival::Delay(_) | Arrival::Lag(_))) {
            let h_s = form.dataset.pieces.iter().map(|p| p.h_s).fold(0.0, f64::max);
            let mut time_s = 0.25 * h_s;
            while time_s < longest_s {
                terms.push(arriving(Kind::Delay, Arrival::Delay(time_s), &[time_s]));
                terms.push(arriving(Kind::ElectricalLag, Arrival::Lag(time_s), &[time_s]));
                time_s *= 1.3;
            }
        }
        if !self.drive_varies() {
            return terms;
        }
        if !has(|a| matches!(a, Arrival::Load(_))) {
            let mut k = LEAST_LOAD;
            while k < MOST_LOAD {
                terms.push(arriving(Kind::LoadFriction, Arrival::Load(k), &[k]));
                k *= 1.3;
            }
        }
        if has(|a| !matches!(a, Arrival::Delay(_) | Arrival::Lag(_) | Arrival::Load(_))) {
            return terms;
        }
        let largest = self.largest_drive;
        for share in [0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3] {
            let d = share * largest;
            terms.push(arriving(Kind::DeadZone, Arrival::DeadZone(d), &[d]));
            for (edge, emf) in [(0.02, 0.0), (0.02, 0.9), (0.06, 0.0), (0.06, 0.9), (0.15, 0.5)] {
                let own = [d, edge * largest, emf * self.viscous];
                terms.push(arriving(Kind::PwmDeadTime, Arrival::DeadTime(own), &own));
            }
        }
        for share in [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.94, 0.97, 0.99] {
            let limit = share * largest;
            terms.push(arriving(Kind::Saturation, Arrival::Limit(limit), &[limit]));
        }
        terms
    }
}
