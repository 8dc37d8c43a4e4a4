//! Columns of second bodies that hang on the measured position.

use breakaway_core::plant::Kind;

use super::super::term::{Column, Name, Sign, Term};
use super::super::weak_form::Field;
use super::Library;

/// Damping ratio above which a second body is no coupling. Less than a tenth of an oscillation is then left after a
/// period. Something that yields does that, and so does the contact of a gap.
pub const MOST_DAMPING: f64 = 0.35;
/// Points of the grid of a second body's angular frequencies.
const BODIES: i32 = 27;

impl Library<'_> {
    pub(super) fn second_bodies(&self) -> Vec<Term> {
        let mut terms = Vec::new();
        if self.model.terms.iter().any(|t| t.body.is_some()) {
            return terms;
        }
        let [low, ratio] = self.frequencies();
        // In these windows only the phase tells the fastest bodies from the motor. The last two of the grid are not
        // tried.
        for i in 0..BODIES - 2 {
            let omega = low * ratio.powi(i);
            terms.extend([0.02, 0.1, 0.3, 0.7, 2.0].map(|zeta| self.second_body(omega, zeta)));
        }
        terms
    }

    /// The least angular frequency of the grid, rad/s, and its ratio.
    pub(super) fn frequencies(&self) -> [f64; 2] {
        let longest = self.form.dataset.pieces.iter().map(|p| p.x.len() as f64 * p.h_s).fold(0.0, f64::max);
        let (low, high) = (6.0 / longest, 2.5 / self.form.half_width_s);
        [low, (high / low).powf(1.0 / f64::from(BODIES - 1))]
    }

    pub(super) fn second_body(&self, omega: f64, zeta: f64) -> Term {
        let name = if zeta > MOST_DAMPING { Name::Decoy("damped mode") } else { Name::Effect(Kind::FlexibleCoupling) };
        let mut term = Term::force(name, Vec::new()).with(0, omega).with(1, zeta);
        term.u = vec![Column::displacement(self.load(omega, zeta))];
        term.body = Some([omega, zeta]);
        term.signed(Sign::Positive)
    }

    /// Position of a load that hangs on the measured position by a spring and a damper, by the bilinear transform.
    fn load(&self, omega: f64, zeta: f64) -> Field {
        let each = self.form.dataset.pieces.iter().map(|piece| {
            let k = 2.0 / piece.h_s;
            let (damping, stiffness) = (2.0 * zeta * omega, omega * omega);
            let above = [damping * k + stiffness, 2.0 * stiffness, stiffness - damping * k];
            let below = [k * k + damping * k + stiffness, 2.0 * (stiffness - k * k), k * k - damping * k + stiffness];
            let first = piece.x[0];
            let (mut x1, mut x2, mut y1, mut y2) = (0.0, 0.0, 0.0, 0.0);
            piece
                .x
                .iter()
                .map(|x| {
                    let x = x - first;
                    let y = (above[0] * x + above[1] * x1 + above[2] * x2 - below[1] * y1 - below[2] * y2) / below[0];
                    (x2, x1, y2, y1) = (x1, x, y1, y);
                    y
                })
                .collect()
        });
        each.collect()
    }
}
