//! Columns of every effect that the judge knows, and of the decoys that stand for something else.

mod bodies;
mod decoys;
mod drive;
mod made;
mod motion;
mod position;
mod remade;
mod time;

use breakaway_core::plant::Kind;
use rayon::prelude::*;

pub use bodies::MOST_DAMPING;
pub use made::Made;

use self::made::once;
use super::sides::{Fitted, Model};
use super::term::{Name, Term};
use super::weak_form::{Field, Sample, WeakForm, percentile};
use super::weights::Weights;

/// Strongest lines of a spectrum that are tried.
const LINES: usize = 6;
/// Windows that a recording must exceed to have a phase of its own.
const LEAST_ROWS: usize = 20;
/// Most recordings that may each have a phase of their own.
const MOST_PHASES: usize = 12;

/// Whether columns of a window stand for an effect. Stiction and backlash act in less than a window, and have none.
pub const fn weighs(kind: Kind) -> bool {
    !matches!(kind, Kind::Stiction | Kind::Backlash)
}

/// Whether the measured forces tell an effect from others. A bristle may bend by less than the sensor's noise, and the
/// measured motion does not tell its force then.
pub fn tells(kind: Kind) -> bool {
    weighs(kind) && !kind.bristles()
}

/// Whether the measured forces tell one effect from another. They do not tell how little a bristle bends.
pub fn tells_apart(one: Kind, other: Kind) -> bool {
    one == other || !(one.bristles() && other.bristles())
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
    /// Acceleration that side A of the model predicts in every window, position units/s².
    predicted_a: Vec<f64>,
    /// Radians in a position unit; `None` where the position is no angle.
    radians: Option<f64>,
    /// Whether ripples are sought: in all windows but the widest. Narrow windows show a ripple best.
    ripples: bool,
    travel: f64,
    largest_drive: f64,
    viscous: f64,
    /// Inertia of side U.
    inertia: f64,
}

/// Makes a family of terms.
type Family = fn(&Library<'_>) -> Vec<Term>;

impl<'a> Library<'a> {
    /// Columns beside a fitted model.
    pub fn new(form: &'a WeakForm<'a>, model: &'a Model, fitted: &'a Fitted, weights: &'a Weights) -> Self {
        let pieces = &form.dataset.pieces;
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
            travel: form.travel(),
            largest_drive: percentile(pieces.iter().flat_map(|p| &p.u).map(|u| u.abs()).collect(), 0.98),
            viscous: fitted.u.c.max(0.0),
            inertia: fitted.u.b,
        }
    }

    /// Terms that are tried as the second of a pair. They may hide another effect. Second bodies are left out, because they
    /// take most of the time.
    pub fn partners(&self) -> Vec<Term> {
        self.of_effects(|kind| {
            !matches!(kind, Kind::Stribeck | Kind::LuGre | Kind::PwmDeadTime | Kind::FlexibleCoupling)
        })
    }

    /// Every term that may be tried beside the model.
    pub fn terms(&self) -> Vec<Term> {
        let mut terms = self.of_effects(|_| true);
        terms.extend(self.decoys());
        terms
    }

    /// The terms of the wanted effects. A family without a wanted effect is not made, because spectra and second bodies
    /// take most of the time.
    pub fn of_effects(&self, wanted: impl Fn(Kind) -> bool) -> Vec<Term> {
        let any = |kinds: &[Kind]| kinds.iter().copied().any(&wanted);
        let without = |part: fn(&Term) -> bool| !self.model.terms.iter().any(part);
        let bristles = any(&[Kind::Dahl, Kind::LuGre]) && without(|term| term.replaces_direction);
        let bodies = any(&[Kind::FlexibleCoupling]) && without(|term| term.body.is_some());
        let families: [(bool, Family); 6] = [
            (true, |own| once(&own.form.made.motion, || own.of_the_motion())),
            (self.ripples && any(&position::SOUGHT), |own| own.periodic()),
            (bristles, |own| once(&own.form.made.bristles, || own.bristles())),
            (bodies, |own| once(&own.form.made.bodies, || own.second_bodies())),
            (true, |own| own.of_the_drive()),
            (any(&time::OF_TIME), |own| own.of_time()),
        ];
        let sought = families.into_par_iter().filter(|(sought, _)| *sought);
        let mut terms: Vec<Term> = sought.flat_map_iter(|(_, make)| make(self)).collect();
        terms.retain(|term| !matches!(term.name, Name::Effect(kind) if !wanted(kind)));
        terms
    }

    pub(super) fn field(&self, f: impl Fn(Sample) -> f64) -> Field {
        self.form.field(f)
    }

    /// Each of the fields within each recording that moves. It has no samples in the others, which counts as 0. `None` where
    /// fewer than two recordings move, or where there are more than [`MOST_PHASES`].
    pub(super) fn of_each_recording(&self, fields: &[Field]) -> Option<Vec<Field>> {
        let dataset = self.form.dataset;
        if !(2..=MOST_PHASES).contains(&dataset.recordings) {
            return None;
        }
        let own = |i: usize, field: &Field| -> Field {
            let pieces = field.iter().zip(&dataset.pieces);
            pieces.map(|(g, p)| if p.recording == i { g.clone() } else { Vec::new() }).collect()
        };
        let rows = |i: usize| self.form.rows.iter().filter(|r| dataset.pieces[r.piece].recording == i).count();
        let moving: Vec<usize> = (0..dataset.recordings).filter(|i| rows(*i) > LEAST_ROWS).collect();
        (moving.len() > 1).then(|| moving.iter().flat_map(|i| fields.iter().map(|f| own(*i, f))).collect())
    }

    /// Whether the drive varies within the recordings. Where it does not, a column that holds it would predict it for
    /// nothing.
    pub(super) fn drive_varies(&self) -> bool {
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
}

/// A force of an effect.
fn effect(kind: Kind, fields: Vec<Field>) -> Term {
    Term::force(Name::Effect(kind), fields)
}
