//! Terms of what happens to the drive on its way to the axis.

use breakaway_core::plant::Kind;

use super::super::term::{Arrival, Term};
use super::made::once;
use super::{Library, effect};

/// Shares of the drive that a friction by load may take. Gears take more than the least; beyond the most hardly
/// anything would move.
const LEAST_LOAD: f64 = 0.01;
const MOST_LOAD: f64 = 0.9;
/// Shares of the largest drive that a dead zone and a dead time may take.
const CUTS: [f64; 8] = [0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3];
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
    /// The ways that the model does not have yet. It may have one that makes the drive late, one that takes a share of it,
    /// and one that cuts it.
    pub(super) fn of_the_drive(&self) -> Vec<Term> {
        let taken: Vec<Way> = self.model.terms.iter().filter_map(|term| term.drive.map(Way::of)).collect();
        let mut terms = once(&self.form.made.arrivals, || self.arrivals());
        terms.extend(self.dead_times());
        if !self.drive_varies() {
            terms.retain(|term| term.drive.map(Way::of) == Some(Way::Late));
        }
        terms.retain(|term| term.drive.is_some_and(|arrival| !taken.contains(&Way::of(arrival))));
        terms
    }

    /// How the drive may arrive, on a grid.
    fn arrivals(&self) -> Vec<Term> {
        let form = self.form;
        let mut terms = Vec::new();
        let longest_s = 0.06_f64.max(4.0 * form.half_width_s);
        let h_s = form.dataset.pieces.iter().map(|p| p.h_s).fold(0.0, f64::max);
        let mut time_s = 0.25 * h_s;
        while time_s < longest_s {
            terms.extend(arriving(Kind::Delay, &[time_s]));
            terms.extend(arriving(Kind::ElectricalLag, &[time_s]));
            time_s *= RATIO;
        }
        let mut k = LEAST_LOAD;
        while k < MOST_LOAD {
            terms.extend(arriving(Kind::LoadFriction, &[k]));
            k *= RATIO;
        }
        let largest = self.largest_drive;
        terms.extend(CUTS.iter().filter_map(|share| arriving(Kind::DeadZone, &[share * largest])));
        for share in [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.94, 0.97, 0.99] {
            terms.extend(arriving(Kind::Saturation, &[share * largest]));
        }
        terms
    }

    /// Dead times of the driver. Their back-EMF is a share of the model's viscous coefficient.
    fn dead_times(&self) -> Vec<Term> {
        let largest = self.largest_drive;
        let edges = [(0.02, 0.0), (0.02, 0.9), (0.06, 0.0), (0.06, 0.9), (0.15, 0.5)];
        let each = CUTS.iter().flat_map(|cut| edges.map(|(edge, emf)| (cut * largest, edge * largest, emf)));
        each.filter_map(|(d, edge, emf)| arriving(Kind::PwmDeadTime, &[d, edge, emf * self.viscous])).collect()
    }
}

/// What is done to the drive.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    Late,
    Loaded,
    Cut,
}

impl Way {
    const fn of(arrival: Arrival) -> Self {
        match arrival {
            Arrival::Delay(_) | Arrival::Lag(_) => Self::Late,
            Arrival::Load(_) => Self::Loaded,
            Arrival::Limit(_) | Arrival::DeadZone(_) | Arrival::DeadTime(_) => Self::Cut,
        }
    }
}
