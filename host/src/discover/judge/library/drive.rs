//! Terms of what happens to the drive on its way to the axis.

use breakaway_core::plant::Kind;

use super::super::term::{Arrival, Term};
use super::{Library, effect};

/// Shares of the drive that a friction by load may take. Gears take more than the least; beyond the most hardly
/// anything would move.
const LEAST_LOAD: f64 = 0.01;
const MOST_LOAD: f64 = 0.9;
/// Ratio of the grids of times and of loads.
pub(super) const RATIO: f64 = 1.3;

/// The term of an effect that changes the drive on its way; `None` for another effect, or where a parameter is missing.
pub(super) fn arriving(kind: Kind, parameters: &[f64]) -> Option<Term> {
    let arrival = match (kind, parameters) {
        (Kind::Delay, [time_s]) => Arrival::Delay(*time_s),
        (Kind::ElectricalLag, [time_s]) => Arrival::Lag(*time_s),
        (Kind::LoadFriction, [share]) => Arrival::Load(*share),
        (Kind::DeadZone, [width]) => Arrival::DeadZone(*width),
        (Kind::PwmDeadTime, [d, edge, emf]) => Arrival::DeadTime([*d, *edge, *emf]),
        (Kind::Saturation, [limit]) => Arrival::Limit(*limit),
        _ => return None,
    };
    let mut term = effect(kind, Vec::new());
    term.parameters = parameters.iter().copied().enumerate().collect();
    term.size = parameters.len();
    term.drive = Some(arrival);
    Some(term)
}

impl Library<'_> {
    pub(super) fn of_the_drive(&self) -> Vec<Term> {
        let form = self.form;
        let mut terms = Vec::new();
        let longest_s = 0.06_f64.max(4.0 * form.half_width_s);
        let has = |test: fn(&Arrival) -> bool| self.model.terms.iter().filter_map(|t| t.drive.as_ref()).any(test);
        if !has(|a| matches!(a, Arrival::Delay(_) | Arrival::Lag(_))) {
            let h_s = form.dataset.pieces.iter().map(|p| p.h_s).fold(0.0, f64::max);
            let mut time_s = 0.25 * h_s;
            while time_s < longest_s {
                terms.extend(arriving(Kind::Delay, &[time_s]));
                terms.extend(arriving(Kind::ElectricalLag, &[time_s]));
                time_s *= RATIO;
            }
        }
        if !self.drive_varies() {
            return terms;
        }
        if !has(|a| matches!(a, Arrival::Load(_))) {
            let mut k = LEAST_LOAD;
            while k < MOST_LOAD {
                terms.extend(arriving(Kind::LoadFriction, &[k]));
                k *= RATIO;
            }
        }
        if has(|a| !matches!(a, Arrival::Delay(_) | Arrival::Lag(_) | Arrival::Load(_))) {
            return terms;
        }
        let largest = self.largest_drive;
        for share in [0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3] {
            let d = share * largest;
            terms.extend(arriving(Kind::DeadZone, &[d]));
            for (edge, emf) in [(0.02, 0.0), (0.02, 0.9), (0.06, 0.0), (0.06, 0.9), (0.15, 0.5)] {
                terms.extend(arriving(Kind::PwmDeadTime, &[d, edge * largest, emf * self.viscous]));
            }
        }
        for share in [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.94, 0.97, 0.99] {
            terms.extend(arriving(Kind::Saturation, &[share * largest]));
        }
        terms
    }
}
