//! Columns of waves over position: gravity, ripples, friction over position, eccentricity.

use breakaway_core::plant::Kind;

use super::super::term::{Column, Name, Shape, Term};
use super::super::wave_numbers::{Over, Peaks, attenuation, audible, coherent, peaks};
use super::super::weak_form::{Field, Sample};
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

    /// The same for a line of a spectrum of so many lines. Each recording has its own phase only where two turns of the
    /// ripple are seen for each recording.
    fn sought(&self, kind: Kind, (k, of_lines): (f64, f64), part: impl Fn(Sample, f64) -> f64) -> Vec<Term> {
        let mut terms = self.ripple(kind, k, part);
        if self.turns_seen(k) < LEAST_TURNS * self.form.dataset.recordings as f64 {
            terms.truncate(1);
        }
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
        let form = self.form;
        let mut places = std::collections::BTreeSet::new();
        for (row, v) in form.rows.iter().zip(&form.row_v) {
            let piece = &form.dataset.pieces[row.piece];
            if attenuation(k * v * form.half_width_s).abs() * audible(k * v * piece.h_s) > LEAST_LEFT {
                places
                    .insert((piece.recording, (k * piece.x[row.centre] * 8.0 / std::f64::consts::TAU).floor() as i64));
            }
        }
        places.len() as f64 / 8.0
    }

    pub(super) fn periodic(&self) -> Vec<Term> {
        let form = self.form;
        let direction = &form.row_direction;
        let signed: Vec<f64> = self.residual.iter().zip(direction).map(|(r, s)| r * s).collect();
        let mut terms = Vec::new();
        let seen = |k: &f64| self.turns_seen(*k) >= LEAST_TURNS;
        let Peaks { lines, of_lines } = peaks(form, self.residual, self.weights, Over::Position, LINES);
        for k in lines.into_iter().filter(seen) {
            terms.extend(self.sought(Kind::Cogging, (k, of_lines), |_, wave| wave));
            if form.dataset.recordings > 1 {
                let k = coherent(form, self.residual, self.weights, k);
                terms.extend(self.sought(Kind::Cogging, (k, of_lines), |_, wave| wave).into_iter().take(1));
            }
        }
        if let Some(radians) = self.radians {
            terms.extend(self.ripple(Kind::EncoderEccentricity, radians, |_, wave| wave));
        }
        let Peaks { lines, of_lines } = peaks(form, &signed, self.weights, Over::Position, LINES);
        for k in lines.into_iter().filter(seen) {
            let friction = self.sought(Kind::PositionFriction, (k, of_lines), |s, wave| s.direction * wave);
            if self.drive_varies() {
                // A relay's drive has the sign of the motion. So a motor whose torque per drive ripples over position
                // looks alike.
                terms.extend(friction.iter().map(|term| self.ripple_of_the_gain(k, term)));
            }
            terms.extend(friction);
        }
        terms
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
