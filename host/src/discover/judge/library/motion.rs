//! Columns of laws of the motion: loads, friction over speed, springs, bristles.

use breakaway_core::plant::Kind;

use super::super::term::{Sign, Term};
use super::super::weak_form::{Field, percentile};
use super::{Library, effect};

/// The fall of a Stribeck curve that is seen, as an exponent: −ln 5 %.
const FALL: f64 = 3.0;
/// Strokes of the grid.
const STROKES: i32 = 11;

/// Places at which a stop may begin. The best one is refined between its neighbours, so that the grid need only come near.
const PLACES: u32 = 15;
/// Least times that a stop is touched. A stop that is touched once is none: the session's time, say, would do as well.
const LEAST_TOUCHES: usize = 3;

impl Library<'_> {
    pub(super) fn of_the_motion(&self) -> Vec<Term> {
        let mut terms = vec![
            effect(Kind::ConstantLoad, vec![self.field(|_| 1.0)]),
            effect(Kind::AsymmetricViscous, vec![self.field(|s| s.v.abs())]),
            effect(Kind::QuadraticDrag, vec![self.field(|s| s.v * s.v.abs())]).signed(Sign::Positive),
        ];
        let centre = self.centre();
        let stretch = self.field(|s| s.x - centre);
        terms.push(effect(Kind::Spring, vec![stretch.clone(), self.field(|_| 1.0)]).signed(Sign::Positive));
        if let Some(own) = self.of_each_recording(&[self.field(|_| 1.0)]) {
            let mut term = effect(Kind::Spring, std::iter::once(stretch).chain(own).collect());
            (term.size, term.own_zeros) = (2, true);
            terms.push(term.signed(Sign::Positive));
        }
        terms.extend(self.end_stops());
        if let Some(radians) = self.radians {
            terms.extend(self.waves(Kind::GravityLoad, radians, |_, wave| wave));
        }
        for share in [0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.5] {
            let vs = share * self.form.v95;
            let seen = [1.0, 2.0].into_iter().filter(|p| vs <= self.most_stribeck(*p));
            terms.extend(seen.map(|p| self.stribeck(vs, p)));
        }
        terms
    }

    /// Stops on either side of places that divide the positions evenly.
    fn end_stops(&self) -> Vec<Term> {
        let Some([first, apart]) = self.places_of_stops() else { return Vec::new() };
        let places = (0..PLACES).map(|i| first + apart * f64::from(i));
        let both = places.flat_map(|place| [1.0, -1.0].map(|side| (side, place)));
        let seen = both.filter(|(side, place)| self.touches(*side, *place, 0.5 * apart) >= LEAST_TOUCHES);
        seen.map(|(side, place)| self.end_stop(side, place)).collect()
    }

    /// The first place of the grid, and how far the places are apart; `None` where the axis does not move.
    pub(super) fn places_of_stops(&self) -> Option<[f64; 2]> {
        let positions = || self.form.dataset.pieces.iter().flat_map(|piece| &piece.x).copied();
        let (least, most) = (positions().fold(f64::INFINITY, f64::min), positions().fold(f64::NEG_INFINITY, f64::max));
        let apart = (most - least) / f64::from(PLACES + 1);
        (apart > 0.0).then_some([least + apart, apart])
    }

    /// A stop that begins at `place`, above it (`side` 1) or below it (−1).
    pub(super) fn end_stop(&self, side: f64, place: f64) -> Term {
        let field = self.field(|s| side * (side * (s.x - place)).max(0.0));
        let term = effect(Kind::EndStop, vec![field]).with(0, side).with(1, place).signed(Sign::Positive);
        // The side is no parameter: the sign of the stiffness says it.
        Term { size: 2, chosen_of: f64::from(2 * PLACES), ..term }
    }

    /// How often the axis comes to that side of a place, from at least `away` on the other side of it.
    fn touches(&self, side: f64, place: f64, away: f64) -> usize {
        let mut touches = 0;
        for piece in &self.form.dataset.pieces {
            let mut was_away = false;
            for depth in piece.x.iter().map(|x| side * (x - place)) {
                touches += usize::from(was_away && depth > 0.0);
                was_away = depth < -away || was_away && depth <= 0.0;
            }
        }
        touches
    }

    /// The largest Stribeck velocity of this exponent that the motion shows. The curve has fallen to 5 % of its rise there
    /// at 95 % of all speeds. A curve that falls less is hardly more than its first powers of v/vs. They are Coulomb and
    /// viscous friction, and a drag.
    pub(super) fn most_stribeck(&self, p: f64) -> f64 {
        self.form.v95 / FALL.powf(1.0 / p)
    }

    /// A Stribeck curve of this velocity and exponent.
    pub(super) fn stribeck(&self, vs: f64, p: f64) -> Term {
        let field = self.field(|s| (-(s.v.abs() / vs).powf(p)).exp() * s.direction);
        let mut term = effect(Kind::Stribeck, vec![field]).signed(Sign::Positive).with(1, vs);
        if p != 2.0 {
            term.parameters.push((2, p));
        }
        term
    }

    /// Middle of the positions.
    fn centre(&self) -> f64 {
        percentile(self.form.dataset.pieces.iter().flat_map(|p| p.x.iter().copied()).collect(), 0.5)
    }

    pub(super) fn bristles(&self) -> Vec<Term> {
        let mut terms = Vec::new();
        let Some([least, ratio]) = self.strokes() else { return terms };
        for i in 0..STROKES {
            let stroke = least * ratio.powi(i);
            terms.push(self.dahl(stroke));
            for (share, rise) in [(0.03, 0.3), (0.03, 0.8), (0.1, 0.3), (0.1, 0.8)] {
                terms.push(self.lugre(stroke, share * self.form.v95, rise));
            }
        }
        terms
    }

    /// The least stroke of the grid, and its ratio; `None` where the travel is not above the noise.
    pub(super) fn strokes(&self) -> Option<[f64; 2]> {
        let (least, most) = (self.form.dataset.least_stroke(), 0.7 * self.travel);
        (most > least).then(|| [least, (most / least).powf(1.0 / f64::from(STROKES - 1))])
    }

    pub(super) fn dahl(&self, stroke: f64) -> Term {
        let term = effect(Kind::Dahl, vec![self.bristle(stroke, None)]).with(0, stroke);
        Term { replaces_direction: true, ..term }.signed(Sign::Positive)
    }

    pub(super) fn lugre(&self, stroke: f64, vs: f64, rise: f64) -> Term {
        let field = self.bristle(stroke, Some((vs, rise)));
        let term = effect(Kind::LuGre, vec![field]).with(0, stroke).with(1, vs).with(2, rise);
        Term { replaces_direction: true, ..term }.signed(Sign::Positive)
    }

    /// A bristle along the measured path, ±1 where it slides. `stribeck` gives a Stribeck curve: its velocity, and its
    /// rise as a share of the sliding force.
    fn bristle(&self, stroke: f64, stribeck: Option<(f64, f64)>) -> Field {
        let each = self.form.v.iter().zip(&self.form.dataset.pieces).map(|(v, piece)| {
            let mut z = 0.0;
            let steps = std::iter::once(0.0).chain(piece.x.windows(2).map(|w| w[1] - w[0]));
            v.iter()
                .zip(steps)
                .map(|(v, step)| {
                    let level = stribeck.map_or(1.0, |(vs, rise)| 1.0 + rise * (-(v / vs).powi(2)).exp());
                    let end = level * step.signum();
                    z = end + (z - end) * (-step.abs() / (stroke * level)).exp();
                    z
                })
                .collect()
        });
        each.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::bar::tests::Axis;
    use super::super::super::dataset::Dataset;
    use super::super::super::search::Stage;
    use super::super::super::settings::Settings;
    use super::super::super::sides::Model;
    use super::super::super::term::Name;
    use super::super::super::weak_form::WeakForm;
    use super::super::super::weights::Weights;
    use super::*;
    use crate::discover::judge::ruling::rule;
    use crate::recording::Recording;

    /// Stiffness of a stop.
    const K: f64 = 3.0;

    /// 16 s at 500 Hz of an axis that two sines and a constant drive move. A stop is its side, 1 above or −1 below, and the
    /// place where it begins.
    fn axis_at(stops: &[(f64, f64)], constant: f64) -> Recording {
        let (mut x, mut v) = (0.0, 0.0_f64);
        let mut recording = Recording::default();
        for k in 0..8000 {
            let t = 2e-3 * f64::from(k);
            let u = constant + 0.8 * (3.1 * t).sin() + 0.5 * (8.3 * t).sin();
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push((x / 1e-4_f64).round() * 1e-4);
            for _ in 0..20 {
                let stop: f64 = stops.iter().map(|(side, place)| side * K * (side * (x - place)).max(0.0)).sum();
                v += (u - stop - 0.1 * v.signum() - 0.1 * v) / 0.02 * 1e-4;
                x += v * 1e-4;
            }
        }
        recording
    }

    /// A stop on either side is named alone, with its stiffness to 5 % and its place to a hundredth of the motion. The one
    /// column has a kink, which the windows round off.
    #[test]
    fn a_stop_is_named_with_its_side() {
        for (side, place) in [(1.0, 0.5), (-1.0, -0.4)] {
            // The drive leads the axis back to the stop.
            let recording = axis_at(&[(side, place)], 0.3 * side);
            let span = 2.0 * recording.x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let ruling = rule(&[recording], Some(1.0), &Settings::default()).unwrap();
            let names: Vec<Kind> = ruling.findings.iter().map(|finding| finding.effect.kind).collect();
            assert_eq!(names, [Kind::EndStop]);
            let [stiffness, begins, ..] = ruling.findings[0].effect.p;
            assert!((stiffness / (side * K) - 1.0).abs() < 0.05, "{stiffness}");
            assert!((begins - place).abs() < 0.01 * span, "{begins} of {span}");
        }
    }

    /// Between two stops. One alone gains less than a spring with gravity, which were named where only terms of two names were
    /// tried as a pair.
    #[test]
    fn two_stops_are_named_as_a_pair() {
        let ruling = rule(&[axis_at(&[(1.0, 0.5), (-1.0, -0.5)], 0.0)], Some(1.0), &Settings::default()).unwrap();
        let names: Vec<Kind> = ruling.findings.iter().map(|finding| finding.effect.kind).collect();
        assert_eq!(names, [Kind::EndStop; 2]);
        let sides = ruling.findings.iter().map(|finding| finding.effect.p[0].signum()).sum::<f64>();
        assert_eq!(sides.to_bits(), 0.0_f64.to_bits(), "one above and one below");
    }

    /// An axis that goes round passes each place once. A stop anywhere would be whatever changes in the session's time.
    #[test]
    fn a_place_that_is_passed_once_is_no_stop() {
        let settings = Settings::default();
        let mut recording = Recording::default();
        for k in 0..4000 {
            let t = 2e-3 * f64::from(k);
            recording.t.push(t);
            recording.u.push(1.0 + 0.3 * (3.0 * t).sin());
            recording.x.push(5.0 * t + 0.2 * (3.0 * t).sin());
        }
        let dataset = Dataset::new(&[recording], &settings);
        let form = WeakForm::new(&dataset, 0.05, &settings).unwrap();
        let base = Stage::new(&form, &settings, Model::default(), &Weights::equal(&form)).unwrap();
        let stops = base.library().of_effects(|kind| kind == Kind::EndStop);
        assert!(!stops.iter().any(|term| term.name == Name::Effect(Kind::EndStop)));
    }

    /// Of twelve drags of the hidden plant six were called Stribeck friction (kind world, 10 %, seeds 871 to 882). The Stribeck
    /// velocity of four was nearly the motion's own. The motion passes that of each curve of the grid, wherever it is moved.
    #[test]
    fn the_motion_shows_the_fall_of_each_stribeck_curve() {
        let settings = Settings::default();
        let dataset = Dataset::new(&[Axis { f1: 0.1, drag: 0.01, load: 0.0, seed: 1 }.recording()], &settings);
        let form = WeakForm::new(&dataset, 0.03, &settings).unwrap();
        let base = Stage::new(&form, &settings, Model::default(), &Weights::equal(&form)).unwrap();
        let library = base.library();
        let curves = library.of_effects(|kind| kind == Kind::Stribeck);
        let curves: Vec<Term> = curves.into_iter().filter(|term| term.name == Name::Effect(Kind::Stribeck)).collect();
        assert!(curves.len() > 8);
        for curve in &curves {
            let p = curve.parameters.get(1).map_or(2.0, |(_, p)| *p);
            let [(_, [_, most])] = *library.brackets(curve) else { panic!("one parameter moves") };
            for vs in [curve.parameters[0].1, most] {
                let left = (-(form.v95 / vs).powf(p)).exp();
                assert!(left < 0.0501, "{left} of the rise is left at 95 % of the speeds: vs {vs}, p {p}");
            }
        }
    }
}
