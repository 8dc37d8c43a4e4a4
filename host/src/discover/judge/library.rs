//! Columns of every effect that the judge knows, and of the decoys that stand for something else.

use std::sync::Arc;

use breakaway_core::plant::Kind;

use super::sides::{Fitted, Model, Weights};
use super::term::{Arrival, Column, Name, Shape, Sign, Term};
use super::wave_numbers::{Over, Peaks, attenuation, audible, coherent, peaks};
use super::weak_form::{Field, Sample, WeakForm, percentile};

/// Lines of the spectrum that are tried.
const LINES: usize = 6;
/// Share of a ripple that must be left in a window for it to show it, and turns that must be shown: what is not seen twice is no
/// ripple.
const LEAST_LEFT: f64 = 0.1;
const LEAST_TURNS: f64 = 2.0;
/// Parts of a session at whose ends the inertia may step.
const INSTANTS: u32 = 24;
/// Angular frequencies of second bodies that are tried.
const BODIES: usize = 27;
/// Shares of the drive that a friction by load may take: less is no friction of gears, and at all of it nothing would move.
const LEAST_LOAD: f64 = 0.01;
const MOST_LOAD: f64 = 0.9;
/// Windows from which a recording may have a phase of its own.
const LEAST_ROWS: usize = 20;
/// Most recordings that may each have a phase of their own.
const MOST_PHASES: usize = 12;

/// Whether columns of a window stand for an effect. What holds at rest, and what strikes, acts in less than a window.
pub const fn weighs(kind: Kind) -> bool {
    !matches!(kind, Kind::Stiction | Kind::Backlash)
}

/// What the columns are made of.
pub struct Library<'a> {
    form: &'a WeakForm<'a>,
    model: &'a Model,
    /// The drive as it arrives, and as side U of the model predicts it.
    arrived: Field,
    predicted: Field,
    /// Side U's residual.
    residual: &'a [f64],
    weights: &'a [f64],
    /// Acceleration that side A of the model predicts in every window.
    predicted_a: Vec<f64>,
    /// Radians in a position unit; `None` where the position is no angle.
    radians: Option<f64>,
    /// Whether the windows are narrow enough for ripples: what is seen best in the narrowest is not sought in wider ones.
    ripples: bool,
    shared_zero: bool,
    travel: f64,
    largest_drive: f64,
    viscous: f64,
}

impl<'a> Library<'a> {
    /// Columns beside a fitted model.
    pub fn new(form: &'a WeakForm<'a>, model: &'a Model, fitted: &'a Fitted, weights: &'a Weights) -> Self {
        let pieces = &form.dataset.pieces;
        let travel = |p: &super::dataset::Piece| {
            let (low, high) = p.x.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
            high - low
        };
        Self {
            form,
            model,
            arrived: model.arrived(form),
            predicted: model.predicted_drive(form, &fitted.u),
            residual: &fitted.u.residual,
            weights: &weights.u,
            predicted_a: fitted.a.target.iter().zip(&fitted.a.residual).map(|(a, r)| a - r).collect(),
            radians: form.radians,
            ripples: form.ripples,
            shared_zero: false,
            travel: pieces.iter().map(travel).fold(0.0, f64::max),
            largest_drive: percentile(pieces.iter().flat_map(|p| &p.u).map(|u| u.abs()).collect(), 0.98),
            viscous: fitted.u.c.max(0.0),
        }
    }

    /// Terms that are cheap and that hide others: tried in pairs.
    pub fn partners(&self) -> Vec<Term> {
        let mut terms = self.of_the_motion();
        terms.retain(|t| t.name != Name::Effect(Kind::Stribeck));
        terms.extend(self.of_the_drive());
        terms.extend(self.bristles());
        terms.retain(|t| !matches!(t.name, Name::Effect(Kind::LuGre | Kind::PwmDeadTime)));
        terms
    }

    /// Every term that may be tried beside the model.
    pub fn terms(&self) -> Vec<Term> {
        let mut terms = self.of_the_motion();
        if self.ripples {
            terms.extend(self.periodic());
        }
        terms.extend(self.bristles());
        terms.extend(self.second_bodies());
        terms.extend(self.of_the_drive());
        terms.extend(self.of_time());
        terms.extend(self.decoys());
        terms
    }

    fn field(&self, f: impl Fn(Sample) -> f64) -> Field {
        self.form.field(f)
    }

    fn of_the_motion(&self) -> Vec<Term> {
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
        if let Some(radians) = self.radians {
            terms.extend(self.waves(Kind::GravityLoad, radians, |_, wave| wave));
        }
        for share in [0.01, 0.02, 0.04, 0.08, 0.15, 0.3, 0.5] {
            let vs = share * self.form.v95;
            for p in [1.0, 2.0] {
                let field = self.field(|s| (-(s.v.abs() / vs).powf(p)).exp() * s.direction);
                let mut term = effect(Kind::Stribeck, vec![field]).signed(Sign::Positive).with(1, vs);
                if p != 2.0 {
                    term.parameters.push((2, p));
                }
                terms.push(term);
            }
        }
        terms
    }

    /// Middle of the positions.
    fn centre(&self) -> f64 {
        percentile(self.form.dataset.pieces.iter().flat_map(|p| p.x.iter().copied()).collect(), 0.5)
    }

    /// Sine and cosine of k·x with its wave number, see [`Self::waves`]; as loud as the samples show it.
    fn ripple(&self, kind: Kind, k: f64, part: impl Fn(Sample, f64) -> f64) -> Vec<Term> {
        let audible_part = |s: Sample, wave: f64| part(s, wave * audible(k * s.v * s.h_s));
        self.waves(kind, k, audible_part).into_iter().map(|term| term.with(1, k)).collect()
    }

    /// The same of one of so many lines, whose wave number was sought: what one recording does not show twice is no ripple of its own.
    fn sought(&self, kind: Kind, (k, of_lines): (f64, f64), part: impl Fn(Sample, f64) -> f64) -> Vec<Term> {
        let mut terms = self.ripple(kind, k, part);
        if self.turns_seen(k) < LEAST_TURNS * self.form.dataset.recordings as f64 {
            terms.truncate(1);
        }
        terms.into_iter().map(|term| Term { chosen_of: of_lines, ..term }).collect()
    }

    /// Sine and cosine of k·x, with one phase, and with one for each recording.
    fn waves(&self, kind: Kind, k: f64, part: impl Fn(Sample, f64) -> f64) -> Vec<Term> {
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

    /// Each of the fields within each recording that moves, and nothing in the others; `None` where that is one recording, or where
    /// they are too many.
    fn of_each_recording(&self, fields: &[Field]) -> Option<Vec<Field>> {
        let dataset = self.form.dataset;
        if !(2..=MOST_PHASES).contains(&dataset.recordings) {
            return None;
        }
        let own = |i: usize, field: &Field| -> Field {
            let pieces = field.iter().zip(&dataset.pieces);
            pieces.map(|(g, p)| if p.recording == i { g.clone() } else { vec![0.0; g.len()] }).collect()
        };
        let rows = |i: usize| self.form.rows.iter().filter(|r| dataset.pieces[r.piece].recording == i).count();
        let moving: Vec<usize> = (0..dataset.recordings).filter(|i| rows(*i) > LEAST_ROWS).collect();
        (moving.len() > 1).then(|| moving.iter().flat_map(|i| fields.iter().map(|f| own(*i, f))).collect())
    }

    /// Turns of a ripple that are seen: places, an eighth of a turn wide, that are passed slowly enough to show it.
    fn turns_seen(&self, k: f64) -> f64 {
        let form = self.form;
        let mut places = std::collections::BTreeSet::new();
        for (row, v) in form.rows.iter().zip(&form.row_v) {
            let piece = &form.dataset.pieces[row.piece];
            if attenuation(k * v * form.half_width_s).abs() * audible(k * v * piece.h_s) > LEAST_LEFT {
                let own = if self.shared_zero { 0 } else { piece.recording };
                places.insert((own, (k * piece.x[row.centre] * 8.0 / std::f64::consts::TAU).floor() as i64));
            }
        }
        places.len() as f64 / 8.0
    }

    /// Whether an angular frequency is a harmonic of the excitation: what repeats with the motion is told from a function of the
    /// motion by nothing.
    fn harmonic_of_the_drive(&self, omega: f64) -> bool {
        self.form.dataset.fundamentals().iter().any(|(fundamental, cycles)| {
            let order = omega / fundamental;
            (order - order.round()).abs() < 1.5 / cycles && order.round() >= 1.0
        })
    }

    fn periodic(&self) -> Vec<Term> {
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
            terms.extend(self.sought(Kind::PositionFriction, (k, of_lines), |s, wave| s.direction * wave));
        }
        terms
    }

    fn bristles(&self) -> Vec<Term> {
        let mut terms = Vec::new();
        let noise = self.form.dataset.pieces.iter().map(|p| p.sigma).fold(0.0, f64::max);
        let (least, most) = (6.0 * noise, 0.7 * self.travel);
        if most <= least || self.model.terms.iter().any(|t| t.replaces_direction) {
            return terms;
        }
        for i in 0..11 {
            let stroke = least * (most / least).powf(f64::from(i) / 10.0);
            let mut term = effect(Kind::Dahl, vec![self.bristle(stroke, None)]).with(0, stroke);
            term.replaces_direction = true;
            terms.push(term.signed(Sign::Positive));
            for (share, rise) in [(0.03, 0.3), (0.03, 0.8), (0.1, 0.3), (0.1, 0.8)] {
                let vs = share * self.form.v95;
                let field = self.bristle(stroke, Some((vs, rise)));
                let mut term = effect(Kind::LuGre, vec![field]).with(0, stroke).with(1, vs).with(2, rise);
                term.replaces_direction = true;
                terms.push(term.signed(Sign::Positive));
            }
        }
        terms
    }

    /// A bristle along the measured path, ±1 where it slides; with a Stribeck curve: its velocity and its rise.
    fn bristle(&self, stroke: f64, stribeck: Option<(f64, f64)>) -> Field {
        let each = self.form.v.iter().zip(&self.form.dataset.pieces).map(|(v, piece)| {
            let mut z = 0.0;
            v.iter()
                .map(|v| {
                    let level = stribeck.map_or(1.0, |(vs, rise)| 1.0 + rise * (-(v / vs).powi(2)).exp());
                    let end = level * v.signum();
                    z = end + (z - end) * (-v.abs() * piece.h_s / (stroke * level)).exp();
                    z
                })
                .collect()
        });
        each.collect()
    }

    fn second_bodies(&self) -> Vec<Term> {
        let mut terms = Vec::new();
        if self.model.terms.iter().any(|t| t.body.is_some()) {
            return terms;
        }
        let longest = self.form.dataset.pieces.iter().map(|p| p.x.len() as f64 * p.h_s).fold(0.0, f64::max);
        let (low, high) = (6.0 / longest, 2.5 / self.form.half_width_s);
        // Within these windows the fastest body is told from the motor by its phase alone: no name for the last of the grid.
        for i in 0..BODIES - 2 {
            let omega = low * (high / low).powf(i as f64 / (BODIES - 1) as f64);
            for zeta in [0.02, 0.1, 0.3, 0.7, 2.0] {
                // Twice the critical damping is no resonance any more, but something that yields.
                let name = if zeta > 1.0 { Name::Decoy("damped mode") } else { Name::Effect(Kind::FlexibleCoupling) };
                let mut term = Term::force(name, Vec::new()).with(0, omega).with(1, zeta);
                term.u = vec![Column::displacement(self.load(omega, zeta))];
                term.body = Some([omega, zeta]);
                terms.push(term.signed(Sign::Positive));
            }
        }
        terms
    }

    /// Position of a load on the measured position by a spring and a damper, by the bilinear transform.
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

    /// Whether the drive varies within the recordings: else a column that holds it predicts it for nothing.
    fn drive_varies(&self) -> bool {
        let (mut varied, mut total) = (0.0, 0.0);
        for recording in 0..self.form.dataset.recordings {
            let rows = || {
                let own = self.form.rows.iter().zip(&self.form.row_u);
                own.filter(move |(r, _)| self.form.dataset.pieces[r.piece].recording == recording).map(|(_, u)| u.abs())
            };
            let count = rows().count().max(1) as f64;
            let mean = rows().sum::<f64>() / count;
            varied += rows().map(|u| (u - mean).powi(2)).sum::<f64>();
            total += rows().map(|u| u * u).sum::<f64>();
        }
        varied > 0.03 * total
    }

    fn of_the_drive(&self) -> Vec<Term> {
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
        for share in [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9] {
            let limit = share * largest;
            terms.push(arriving(Kind::Saturation, Arrival::Limit(limit), &[limit]));
        }
        terms
    }

    /// Effects of session time, where the recordings share a clock.
    fn of_time(&self) -> Vec<Term> {
        let form = self.form;
        let mut terms = Vec::new();
        if !form.dataset.shared_clock {
            return terms;
        }
        let times: Vec<f64> = form.rows.iter().map(|r| form.dataset.pieces[r.piece].t[r.centre]).collect();
        let (Some(first), Some(last)) = (times.first(), times.last()) else { return terms };
        let (first, span) = (*first, last - first);
        let drift = self.field(|s| s.direction * (s.t - first) / span);
        terms.push(effect(Kind::FrictionDrift, vec![drift]));
        if self.drive_varies() {
            let of = |drive: &Field| self.field(|s| drive[s.piece][s.k] * (s.t - first) / span);
            let mut term = effect(Kind::GainDrift, vec![of(&self.predicted)]);
            term.a = vec![Column::force(of(&self.arrived))];
            term.holds_drive = true;
            terms.push(term);
        }
        let Peaks { lines, of_lines } = peaks(form, self.residual, self.weights, Over::Time, LINES);
        for omega in lines {
            if self.harmonic_of_the_drive(omega) {
                continue;
            }
            let wave = |shift: f64| self.field(|s| (omega * s.t + shift).sin());
            let term = effect(Kind::TimePeriodic, vec![wave(0.0), wave(std::f64::consts::FRAC_PI_2)]).with(1, omega);
            terms.push(Term { chosen_of: of_lines, ..term });
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

    /// What stands for "something else".
    fn decoys(&self) -> Vec<Term> {
        let form = self.form;
        let decoy = |name, fields| Term::force(Name::Decoy(name), fields);
        let edges = |values: Vec<f64>, count: usize| -> Vec<f64> {
            (1..count).map(|i| percentile(values.clone(), i as f64 / count as f64)).collect()
        };
        let class = |edges: &[f64], value: f64| edges.partition_point(|edge| *edge < value);
        let mut terms = Vec::new();
        let speeds = edges(form.row_v.clone(), 8);
        terms.push(decoy(
            "curve over velocity",
            (0..8).map(|i| self.field(|s| f64::from(u8::from(class(&speeds, s.v) == i)))).collect(),
        ));
        let positions: Vec<f64> = form.rows.iter().map(|r| form.dataset.pieces[r.piece].x[r.centre]).collect();
        let places = edges(positions, 12);
        terms.push(decoy(
            "curve over position",
            (0..12).map(|i| self.field(|s| f64::from(u8::from(class(&places, s.x) == i)))).collect(),
        ));
        let speed = 0.1 * form.v95;
        terms.push(decoy("soft sign", vec![self.field(|s| (s.v / speed).tanh())]));
        if self.drive_varies() {
            let gain = |drive: &Field, i: usize| {
                self.field(|s| if class(&places, s.x) / 3 == i { drive[s.piece][s.k] } else { 0.0 })
            };
            let mut term = decoy("gain over position", (1..4).map(|i| gain(&self.predicted, i)).collect());
            term.a = (1..4).map(|i| Column::force(gain(&self.arrived, i))).collect();
            terms.push(term);
        }
        if (2..=MOST_PHASES).contains(&form.dataset.recordings) {
            let own = |i: usize, f: &dyn Fn(Sample) -> f64| {
                self.field(|s| if form.dataset.pieces[s.piece].recording == i { f(s) } else { 0.0 })
            };
            let others = 1..form.dataset.recordings;
            terms.push(decoy("friction of each recording", others.clone().map(|i| own(i, &|s| s.direction)).collect()));
            terms.push(decoy("load of each recording", others.clone().map(|i| own(i, &|_| 1.0)).collect()));
        }
        terms.retain(|t| t.u.iter().all(|c| super::sides::rows(form, c, None).iter().any(|v| *v != 0.0)));
        terms
    }
}

/// A force of an effect.
fn effect(kind: Kind, fields: Vec<Field>) -> Term {
    Term::force(Name::Effect(kind), fields)
}
