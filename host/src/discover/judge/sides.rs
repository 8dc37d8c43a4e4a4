//! The two regressions. Side U explains the drive by the motion, and noise in the acceleration biases it. Side A
//! explains the acceleration by the drive, and noise in the drive biases it. A physical effect improves both, with one
//! force.

use std::borrow::Cow;

use super::arrival::arrive;
use super::body_filter;
use super::regression::{Design, Fit};
use super::settings::Settings;
use super::term::{Column, Term};
use super::weak_form::{Field, WeakForm};
use super::weights::Weights;

/// A model: the base and its terms.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Terms in the order in which they were added.
    pub terms: Vec<Term>,
}

/// One side of a fitted model.
#[derive(Clone, Debug)]
pub struct Side {
    /// Inertia b, drive units · s² / position unit.
    pub b: f64,
    /// Standard error of b, as a share of it.
    pub b_error: f64,
    /// Viscous coefficient c.
    pub c: f64,
    /// Coulomb friction f1, or the first amplitude of the term that replaces it, drive units.
    pub f1: f64,
    /// Standard errors of c and f1.
    pub base_errors: [f64; 2],
    /// Amplitudes of the terms, in drive units and in order.
    pub amplitudes: Vec<Vec<f64>>,
    /// Their standard errors.
    pub errors: Vec<Vec<f64>>,
    /// Force that every term adds in every window, drive units. That of a bristle is without the Coulomb friction in whose
    /// place it comes.
    pub forces: Vec<Vec<f64>>,
    /// Held-out residual in every window, in the unit of the side's target.
    pub residual: Vec<f64>,
    /// The target.
    pub target: Vec<f64>,
}

/// Both sides of a fitted model.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The drive from the motion.
    pub u: Side,
    /// The acceleration from the drive.
    pub a: Side,
}

impl Fitted {
    /// ρ² = b_U/b_A: the share of the acceleration that the drive determines.
    pub fn coherence(&self) -> f64 {
        self.u.b / self.a.b
    }
    /// Standard error of ρ², as if the errors of both sides were independent.
    pub fn coherence_error(&self) -> f64 {
        self.coherence().abs() * self.u.b_error.hypot(self.a.b_error)
    }
}

impl Model {
    /// The model with one more term.
    pub fn with(&self, term: &Term) -> Self {
        let mut terms = self.terms.clone();
        terms.push(term.clone());
        Self { terms }
    }

    /// Whether a term takes the place of the Coulomb friction.
    fn replaced(&self) -> bool {
        self.terms.iter().any(|term| term.replaces_direction)
    }

    /// The drive as it arrives, at every sample.
    pub fn arrived(&self, form: &WeakForm<'_>) -> Field {
        let mut drive: Field = form.dataset.pieces.iter().map(|p| p.u.clone()).collect();
        for arrival in self.terms.iter().filter_map(|term| term.drive) {
            let motion = form.v.iter().zip(&form.direction).zip(&form.dataset.pieces);
            for (u, ((v, direction), piece)) in drive.iter_mut().zip(motion) {
                *u = arrive(u, (v, direction), piece.h_s, arrival);
            }
        }
        drive
    }

    /// Fits both sides; `None` where one of them has no fit.
    pub fn fit(&self, form: &WeakForm<'_>, weights: &Weights, settings: &Settings) -> Option<Fitted> {
        let row_u = self.row_u(form);
        let u = self.fit_u(form, &weights.u, &row_u, settings)?;
        let a = self.fit_a(form, &weights.a, row_u, &u, settings)?;
        Some(Fitted { u, a })
    }

    /// Fits it in windows of another width, with equal weights. The parameters of second bodies and ripples stay as
    /// they are.
    pub fn refitted(&self, form: &WeakForm<'_>, settings: &Settings) -> Option<Fitted> {
        let model = Self { terms: self.terms.iter().map(Term::afresh).collect() };
        model.fit(form, &Weights::equal(form), settings)
    }

    /// Fits side U alone.
    pub(super) fn fit_drive(&self, form: &WeakForm<'_>, weights: &[f64], settings: &Settings) -> Option<Side> {
        self.fit_u(form, weights, &self.row_u(form), settings)
    }

    /// Mean of the drive in every window, as it arrives.
    fn row_u<'a>(&'a self, form: &'a WeakForm<'_>) -> Cow<'a, [f64]> {
        let arriving: Vec<&Term> = self.terms.iter().filter(|term| term.drive.is_some()).collect();
        match arriving[..] {
            [] => Cow::Borrowed(&form.row_u[..]),
            [term] => term.arrived.get_or_init(|| form.means(&self.arrived(form)))[..].into(),
            _ => form.means(&self.arrived(form)).into(),
        }
    }

    fn fit_u(&self, form: &WeakForm<'_>, weights: &[f64], row_u: &[f64], settings: &Settings) -> Option<Side> {
        let mut columns: Vec<Cow<'_, [f64]>> =
            vec![form.row_a[..].into(), form.row_v[..].into(), form.row_direction[..].into()];
        let replaced = self.replaced().then(|| columns.remove(2));
        columns.extend(self.terms.iter().flat_map(|term| &term.u).map(|column| rows(form, column).into()));
        let design = Design { target: row_u, columns };
        let fit = design.fit(form, weights, settings.folds)?;
        let b = fit.coefficients[0];
        Some(self.side((b, 1.0), &design, replaced.as_deref(), fit, |term| term.u.len()))
    }

    fn fit_a(
        &self,
        form: &WeakForm<'_>,
        weights: &[f64],
        row_u: Cow<'_, [f64]>,
        u: &Side,
        settings: &Settings,
    ) -> Option<Side> {
        let body = self.terms.iter().zip(&u.amplitudes).find_map(|(term, amplitudes)| {
            let [omega, zeta] = term.body?;
            Some([omega, zeta, amplitudes.first()? / u.b])
        });
        let terms = self.terms.iter().filter(|term| term.body.is_none());
        let own: Vec<&Column> = terms.flat_map(|term| if term.a.is_empty() { &term.u } else { &term.a }).collect();
        let mut columns: Vec<Cow<'_, [f64]>> = if let Some(body) = body {
            let arrived = self.arrived(form);
            let forces = own.iter().filter_map(|column| column.sampled_force());
            let fields: Vec<&Field> = [&arrived, &form.v, &form.direction].into_iter().chain(forces).collect();
            let mut passed = body_filter::passed(form, &fields, body).into_iter();
            let base: Vec<Vec<f64>> = passed.by_ref().take(3).collect();
            let own = own.into_iter().map(|column| match column.sampled_force() {
                Some(_) => passed.next().unwrap_or_default().into(),
                None => rows(form, column).into(),
            });
            base.into_iter().map(Cow::Owned).chain(own).collect()
        } else {
            let base = [row_u, form.row_v[..].into(), form.row_direction[..].into()];
            base.into_iter().chain(own.into_iter().map(|column| rows(form, column).into())).collect()
        };
        let replaced = self.replaced().then(|| columns.remove(2));
        let design = Design { target: &form.row_a, columns };
        let fit = design.fit(form, weights, settings.folds)?;
        let b = 1.0 / fit.coefficients[0];
        let count = |term: &Term| if term.body.is_some() { 0 } else { term.u.len() };
        Some(self.side((b, -b), &design, replaced.as_deref(), fit, count))
    }

    /// Coefficients as forces. `factor` turns them into drive units with the sign of side U. `replaced` is the direction, where
    /// a bristle takes its place.
    fn side(
        &self,
        (b, factor): (f64, f64),
        design: &Design<'_>,
        replaced: Option<&[f64]>,
        fit: Fit,
        count: impl Fn(&Term) -> usize,
    ) -> Side {
        let known = if replaced.is_some() { 2 } else { 3 };
        let (mut amplitudes, mut errors, mut forces) = (Vec::new(), Vec::new(), Vec::new());
        let mut at = known;
        for term in &self.terms {
            let range = at..at + count(term);
            let own: Vec<f64> = fit.coefficients[range.clone()].iter().map(|c| c * factor).collect();
            errors.push(fit.standard_errors[range.clone()].iter().map(|s| s * factor.abs()).collect());
            let mut force = vec![0.0; design.target.len()];
            for (amplitude, column) in own.iter().zip(&design.columns[range.clone()]) {
                for (force, g) in force.iter_mut().zip(column.iter()) {
                    *force += amplitude * g;
                }
            }
            if let Some(direction) = replaced.filter(|_| term.replaces_direction) {
                let f1 = own.first().copied().unwrap_or(0.0);
                force.iter_mut().zip(direction).for_each(|(force, s)| *force -= f1 * s);
            }
            amplitudes.push(own);
            forces.push(force);
            at = range.end;
        }
        let replacing = self.terms.iter().position(|t| t.replaces_direction);
        let f1 =
            replacing.map_or_else(|| factor * fit.coefficients[2], |j| amplitudes[j].first().copied().unwrap_or(0.0));
        Side {
            b,
            b_error: (fit.standard_errors[0] / fit.coefficients[0]).abs(),
            c: factor * fit.coefficients[1],
            f1,
            base_errors: [1, 2.min(fit.standard_errors.len() - 1)].map(|i| factor.abs() * fit.standard_errors[i]),
            amplitudes,
            errors,
            forces,
            residual: fit.residual,
            target: design.target.to_vec(),
        }
    }

    /// The drive that side U predicts at every sample.
    pub fn predicted_drive(&self, form: &WeakForm<'_>, u: &Side) -> Field {
        let replaced = self.replaced();
        let mut drive = form.field(|s| u.b * s.a + u.c * s.v + if replaced { 0.0 } else { u.f1 * s.direction });
        self.add_forces(&mut drive, u, 1.0);
        drive
    }

    /// Adds the forces of the terms on side U, times `factor`, to a drive at every sample.
    pub(super) fn add_forces(&self, drive: &mut Field, u: &Side, factor: f64) {
        for (term, amplitudes) in self.terms.iter().zip(&u.amplitudes) {
            for (column, amplitude) in term.u.iter().zip(amplitudes) {
                let Column::Force(force) = column else { continue };
                for (u, g) in drive.iter_mut().zip(&force.field).flat_map(|(drive, g)| drive.iter_mut().zip(g)) {
                    *u += factor * amplitude * g;
                }
            }
        }
    }
}

/// A column in every window.
pub fn rows<'a>(form: &WeakForm<'_>, column: &'a Column) -> &'a [f64] {
    match column {
        Column::Force(own) => own.windows.get_or_init(|| form.means(&own.field)),
        Column::Displacement(own) => own.windows.get_or_init(|| form.second_derivatives(&own.field)),
        Column::Windows(values) => values,
    }
}
