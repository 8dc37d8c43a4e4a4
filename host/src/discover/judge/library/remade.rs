//! A term of the grid with other parameters, and how far they may move.

use std::f64::consts::PI;

use breakaway_core::plant::Kind;

use super::super::term::{Name, Term};
use super::Library;
use super::bodies::MOST_DAMPING;
use super::drive::{RATIO, arriving};

impl Library<'_> {
    /// The same effect with these parameters, in the order of the term's. There is none for a decoy, and none where no
    /// parameter may move.
    pub fn remade(&self, term: &Term, parameters: &[f64]) -> Option<Term> {
        let Name::Effect(kind) = term.name else { return None };
        match (kind, parameters) {
            (Kind::Cogging | Kind::PositionFriction, [k]) => self.ripple_like(term, kind, *k),
            (Kind::TimePeriodic, [omega]) => Some(Term { chosen_of: term.chosen_of, ..self.time_periodic(*omega) }),
            (Kind::FrictionDrift, [time_constant_s]) => Some(self.friction_drift(*time_constant_s)),
            (Kind::Stribeck, [vs]) => Some(self.stribeck(*vs, 2.0)),
            (Kind::Stribeck, [vs, p]) => Some(self.stribeck(*vs, *p)),
            (Kind::EndStop, [side, place]) => Some(self.end_stop(*side, *place)),
            (Kind::Dahl, [stroke]) => Some(self.dahl(*stroke)),
            (Kind::LuGre, [stroke, vs, rise]) => Some(self.lugre(*stroke, *vs, *rise)),
            (Kind::FlexibleCoupling, [omega, zeta]) => Some(self.second_body(*omega, *zeta)),
            _ => arriving(kind, parameters),
        }
    }

    /// The parameters that may move, by index among the term's, and their brackets: to the neighbours on their grid. A
    /// line of a spectrum may move by half of its resolution. The three of a dead time stand for each other, so that none
    /// moves alone.
    pub fn brackets(&self, term: &Term) -> Vec<(usize, [f64; 2])> {
        let Name::Effect(kind) = term.name else { return Vec::new() };
        let of = |i: usize| term.parameters.get(i).map_or(0.0, |(_, value)| *value);
        let times = |i: usize, ratio: f64| (i, [of(i) / ratio, of(i) * ratio]);
        let line = |span: f64| (0, [(of(0) - PI / span).max(0.1 * of(0)), of(0) + PI / span]);
        match kind {
            Kind::Cogging | Kind::PositionFriction => vec![line(self.travel)],
            Kind::TimePeriodic => vec![line(self.session_s())],
            Kind::EndStop => {
                self.places_of_stops().map(|[_, apart]| (1, [of(1) - apart, of(1) + apart])).into_iter().collect()
            }
            Kind::Dahl => self.strokes().map(|[_, ratio]| times(0, ratio)).into_iter().collect(),
            Kind::LuGre => {
                let stroke = self.strokes().map(|[_, ratio]| times(0, ratio));
                stroke.into_iter().chain([times(1, 3.0), times(2, 2.5)]).collect()
            }
            Kind::FlexibleCoupling => {
                let damping = (1, [of(1) / 5.0, (of(1) * 5.0).min(MOST_DAMPING)]);
                vec![times(0, self.frequencies()[1]), damping]
            }
            Kind::Delay | Kind::ElectricalLag | Kind::LoadFriction => vec![times(0, RATIO)],
            Kind::Stribeck => {
                let p = term.parameters.get(1).map_or(2.0, |(_, p)| *p);
                vec![(0, [0.5 * of(0), (2.0 * of(0)).min(self.most_stribeck(p))])]
            }
            Kind::DeadZone | Kind::FrictionDrift => vec![times(0, 2.0)],
            Kind::Saturation => vec![(0, [0.9 * of(0), (1.1 * of(0)).min(self.largest_drive)])],
            _ => Vec::new(),
        }
    }

    /// Time from the first sample to the last, s.
    fn session_s(&self) -> f64 {
        let times =
            || self.form.dataset.pieces.iter().flat_map(|piece| piece.t.first().into_iter().chain(piece.t.last()));
        times().fold(f64::NEG_INFINITY, |last, t| last.max(*t)) - times().fold(f64::INFINITY, |first, t| first.min(*t))
    }
}
