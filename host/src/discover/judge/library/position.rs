//! Columns of waves over position: gravity, ripples, friction over position, eccentricity.

use breakaway_core::plant::Kind;
use rayon::prelude::*;

use super::super::attenuation::{attenuation, audible};
use super::super::term::{Column, Name, Shape, Term};
use super::super::wave_numbers::{Over, Peaks, coherent, peaks};
use super::super::weak_form::{Field, Sample};
use super::made::once;
use super::{LINES, Library, effect};

/// Effects for which the spectra over position are made.
pub(super) const SOUGHT: [Kind; 3] = [Kind::Cogging, Kind::EncoderEccentricity, Kind::PositionFriction];
/// Least share of a ripple that a window must pass to show it, and least turns that must be shown. A ripple that is not
/// seen twice is none.
const LEAST_LEFT: f64 = 0.1;
const LEAST_TURNS: f64 = 2.0;

impl Library<'_> {
    /// Sine and cosine of k·x with its wave number, see [`Self::waves`]. They fade where the samples are too far apart
    /// to show the ripple.
    fn ripple(&self, kind: Kind, k: f64, part: impl Fn(Sample, f64) -> f64) -> Vec<Term> {
        let audible_part = |s: Sample, wave: f64| part(s, wave * audible(k * s.v * s.h_s));
        self.waves(kind, k, audible_part).into_iter().map(|term| term.with(1, k)).collect()
    }

    /// The same for a line of a spectrum of so many lines. Each recording has its own phase only where a recording shows two
    /// turns of the ripple. A recording that shows less than one is fitted by its phase alone, whatever it holds. So such
    /// phases count as parameters.
    fn sought(&self, kind: Kind, (k, of_lines): (f64, f64), part: impl Fn(Sample, f64) -> f64) -> Vec<Term> {
        let mut terms = self.ripple(kind, k, part);
        let turns = self.turns_seen_in_each(k);
        if turns.iter().copied().fold(0.0, f64::max) < LEAST_TURNS {
            terms.truncate(1);
        }
        let partly = turns.iter().filter(|turns| (f64::MIN_POSITIVE..1.0).contains(*turns)).count();
        terms.iter_mut().filter(|term| term.own_zeros).for_each(|term| term.size += partly);
        terms.into_iter().map(|term| Term { chosen_of: of_lines, ..term }).collect()
    }

    /// Sine and cosine of k·x: one term with one phase, and one with a phase for each recording that moves.
    pub(super) fn waves(&self, kind: Kind, k: f64, part: impl Fn(Sample, f64) -> f64) -> Vec<Term> {
        let wave = |shift: f64| self.field(|s| part(s, (k * s.x + shift).sin()));
        let both = [wave(0.0), wave(std::f64::consts::FRAC_PI_2)];
        let make = |fields: Vec<Field>| {
            let columns = fields.into_iter();
            let mut term = effect(kind, Vec::new());
            term.u = if kind == Kind::EncoderEccentricity {
                columns.map(Column::displacement).collect()
            } else {
                columns.map(Column::force).collect()
            };
            // Amplitude and phase, however many recordings have a phase of their own.
            (term.size, term.own_zeros, term.shape) = (2, term.u.len() > 2, Shape::Wave);
            term
        };
        std::iter::once(both.to_vec()).chain(self.of_each_recording(&both)).map(make).collect()
    }

    /// Turns of a ripple that are seen. A turn is eight places; a place counts where the axis passes it slowly enough.
    fn turns_seen(&self, k: f64) -> f64 {
        self.turns_seen_in_each(k).into_iter().sum()
    }

    /// The same in each recording.
    fn turns_seen_in_each(&self, k: f64) -> Vec<f64> {
        let form = self.form;
        let mut places = std::collections::BTreeSet::new();
        for (row, v) in form.rows.iter().zip(&form.row_v) {
            let piece = &form.dataset.pieces[row.piece];
            if attenuation(k * v * form.half_width_s).abs() * audible(k * v * piece.h_s) > LEAST_LEFT {
                places
                    .insert((piece.recording, (k * piece.x[row.centre] * 8.0 / std::f64::consts::TAU).floor() as i64));
            }
        }
        let mut turns = vec![0.0; form.dataset.recordings];
        for (recording, _) in places {
            turns[recording] += 1.0 / 8.0;
        }
        turns
    }

    /// The same ripple over position with another wave number.
    pub(super) fn ripple_like(&self, term: &Term, kind: Kind, k: f64) -> Option<Term> {
        let terms = match kind {
            Kind::PositionFriction => self.ripple(kind, k, |s, wave| s.direction * wave),
            _ => self.ripple(kind, k, |_, wave| wave),
        };
        let like = terms.into_iter().find(|other| other.own_zeros == term.own_zeros)?;
        Some(Term { chosen_of: term.chosen_of, ..like })
    }

    pub(super) fn periodic(&self) -> Vec<Term> {
        let form = self.form;
        let direction = &form.row_direction;
        let signed: Vec<f64> = self.residual.iter().zip(direction).map(|(r, s)| r * s).collect();
        let seen = |k: &f64| self.turns_seen(*k) >= LEAST_TURNS;
        let Peaks { lines, of_lines } = peaks(form, self.residual, self.weights, Over::Position, LINES);
        let ripples = lines.into_par_iter().filter(seen).flat_map_iter(|k| {
            let mut terms = self.sought(Kind::Cogging, (k, of_lines), |_, wave| wave);
            if form.dataset.recordings > 1 {
                let k = coherent(form, self.residual, self.weights, k);
                terms.extend(self.sought(Kind::Cogging, (k, of_lines), |_, wave| wave).into_iter().take(1));
            }
            terms
        });
        let mut terms: Vec<Term> = ripples.collect();
        if let Some(radians) = self.radians {
            let ripple = || self.ripple(Kind::EncoderEccentricity, radians, |_, wave| wave);
            terms.extend(self.by_the_drive(radians, once(&form.made.eccentricity, ripple)));
        }
        let Peaks { lines, of_lines } = peaks(form, &signed, self.weights, Over::Position, LINES);
        // A relay's drive has the sign of the motion. So a motor whose torque per drive ripples over position looks alike.
        let drive_varies = self.drive_varies();
        terms.par_extend(lines.into_par_iter().filter(seen).flat_map_iter(|k| {
            let friction = self.sought(Kind::PositionFriction, (k, of_lines), |s, wave| s.direction * wave);
            let gain = |term: &Term| self.ripple_of_the_gain(k, term);
            let gains: Vec<Term> = friction.iter().filter(|_| drive_varies).map(gain).collect();
            gains.into_iter().chain(friction)
        }));
        terms
    }

    /// The waves of an eccentric encoder, with columns of their own for side A. There the second derivative of sin kx is
    /// k·cos kx·a − k²·sin kx·v², with the acceleration a that the drive gives. The measured acceleration would explain
    /// itself, where the axis turns so little that cos kx is nearly constant.
    fn by_the_drive(&self, k: f64, terms: Vec<Term>) -> Vec<Term> {
        let second_derivative = |shift: f64| {
            self.field(|s| {
                let (sin, cos) = (k * s.x + shift).sin_cos();
                let unexplained = self.arrived[s.piece][s.k] - self.predicted[s.piece][s.k];
                let a = s.a + unexplained / self.inertia;
                (k * cos * a - (k * s.v).powi(2) * sin) * audible(k * s.v * s.h_s)
            })
        };
        let both = [second_derivative(0.0), second_derivative(std::f64::consts::FRAC_PI_2)];
        let with_own = |term: Term| {
            let each = if term.own_zeros { self.of_each_recording(&both) } else { None };
            let a = each.unwrap_or_else(|| both.to_vec()).into_iter().map(Column::force).collect();
            Term { a, ..term }
        };
        terms.into_iter().map(with_own).collect()
    }

    /// A decoy beside a friction over position of wave number `k`: a gain of the drive with that wave.
    fn ripple_of_the_gain(&self, k: f64, friction: &Term) -> Term {
        let times = |drive: &Field| {
            let wave =
                |shift: f64| self.field(|s| drive[s.piece][s.k] * (k * s.x + shift).sin() * audible(k * s.v * s.h_s));
            let both = [wave(0.0), wave(std::f64::consts::FRAC_PI_2)];
            let each = if friction.own_zeros { self.of_each_recording(&both) } else { None };
            each.unwrap_or_else(|| both.to_vec())
        };
        let columns = |drive: &Field| times(drive).into_iter().map(Column::force).collect();
        let name = Name::Decoy("ripple of the gain");
        Term { name, u: columns(&self.predicted), a: columns(&self.arrived), ..friction.clone() }
    }
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Kind;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::super::super::ruling::{Ruling, rule};
    use super::super::super::settings::Settings;
    use super::super::super::term::Name;
    use crate::recording::Recording;

    /// Inertia, Coulomb friction, and waves in a radian of the ripple.
    const B: f64 = 0.02;
    const F1: f64 = 0.3;
    const WAVES: f64 = 7.0;

    /// 12 s at 500 Hz of an axis whose friction and whose torque per drive ripple by these shares. The drive is `size`
    /// times sines of 1 and .6 V at 1.1 and 2.9 Hz. The encoder reads 0 where the ripple has turned by `zero`, rad.
    fn axis([of_friction, of_gain]: [f64; 2], size: f64, zero: f64) -> Recording {
        let (mut x, mut v) = (0.0, 0.0_f64);
        let mut recording = Recording::default();
        for k in 0..6000 {
            let t = 2e-3 * f64::from(k);
            let u = size * ((6.9 * t).sin() + 0.6 * (18.3 * t).sin());
            recording.t.push(t);
            recording.u.push(u);
            recording.x.push(x);
            for _ in 0..20 {
                let wave = (WAVES * x + zero).sin();
                let (drive, friction) = (u * (1.0 + of_gain * wave), F1 * (1.0 + of_friction * wave));
                let free = v + (drive - friction * v.signum() - 0.05 * v) / B * 1e-4;
                // An axis that turns round rests until the drive is larger than the friction.
                v = if free * v < 0.0 && drive.abs() <= friction { 0.0 } else { free };
                x += v * 1e-4;
            }
        }
        recording
    }

    fn ruling(shares: [f64; 2]) -> Ruling {
        rule(&[axis(shares, 1.0, 0.0)], Some(1.0), &Settings::default()).unwrap()
    }

    /// A ripple of the friction by half is named. A ripple of the gain by a fifth is not: without its decoy it would be
    /// friction over position.
    #[test]
    fn a_ripple_of_the_gain_is_no_friction() {
        let friction = ruling([0.5, 0.0]);
        let names: Vec<Kind> = friction.findings.iter().map(|finding| finding.effect.kind).collect();
        assert_eq!(names, [Kind::PositionFriction]);
        let gain = ruling([0.0, 0.2]);
        let names: Vec<Kind> = gain.findings.iter().map(|finding| finding.effect.kind).collect();
        assert!(names.is_empty(), "{names:?}");
        assert!(matches!(gain.remainder.predictable, Some(Name::Decoy(_))), "{:?}", gain.remainder);
    }

    /// Three of four recordings move by a part of a turn of the ripple, each from another zero. The wave number and the share
    /// are the axis's to 2 and 10 %.
    #[test]
    fn a_phase_of_its_own_needs_turns_in_one_recording() {
        let recordings: Vec<Recording> =
            [(1.0, 0.0), (0.5, 2.0), (0.5, 4.0), (0.5, 5.5)].map(|(size, zero)| axis([0.5, 0.0], size, zero)).to_vec();
        let ruling = rule(&recordings, Some(1.0), &Settings::default()).unwrap();
        let names: Vec<(Kind, bool)> = ruling.findings.iter().map(|own| (own.effect.kind, own.own_zeros)).collect();
        assert_eq!(names, [(Kind::PositionFriction, true)]);
        let [share, waves, ..] = ruling.findings[0].effect.p;
        assert!((share - 0.5).abs() < 0.05 && (waves - WAVES).abs() < 0.1, "{share} {waves}");
    }

    /// The axis turns by 1.25 rad, and by .97 rad, before an encoder that is .15 rad off its middle. The drive is random by
    /// .05 V. With the measured acceleration on side A the first has no name, because ρ² falls. The second has none if ρ² may
    /// not fall by its error. The columns leave out what is of second order in .15, a seventh, so the amplitude is told to a
    /// fifth.
    #[test]
    fn an_eccentric_encoder_is_named_by_a_part_of_a_turn() {
        for size in [0.7, 0.6] {
            let mut recording = axis([0.0; 2], size, 0.0);
            recording.x.iter_mut().for_each(|x| *x += 0.15 * (*x + 0.4).sin());
            let mut rng = ChaCha8Rng::seed_from_u64(1);
            for held in recording.u.chunks_mut(10) {
                let error = 0.05 * (rng.random::<f64>() - 0.5);
                for u in held {
                    *u += error;
                }
            }
            let ruling = rule(&[recording], Some(1.0), &Settings::default()).unwrap();
            let names: Vec<Kind> = ruling.findings.iter().map(|finding| finding.effect.kind).collect();
            assert_eq!(names, [Kind::EncoderEccentricity], "{size}");
            let amplitude = ruling.findings[0].effect.p[0];
            assert!((0.12..0.18).contains(&amplitude), "{size}: {amplitude}");
        }
    }
}
