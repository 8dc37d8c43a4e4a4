//! Columns of decoys: they stand for something that no name fits.

use super::super::sides::rows;
use super::super::term::{Column, Name, Term};
use super::super::weak_form::{Field, Sample, percentile};
use super::made::once;
use super::{Library, MOST_PHASES};

/// Classes of the position.
const PLACES: usize = 12;

fn decoy(name: &'static str, fields: Vec<Field>) -> Term {
    Term::force(Name::Decoy(name), fields)
}

/// Edges of `count` classes that hold as many values each.
fn edges(values: &[f64], count: usize) -> Vec<f64> {
    (1..count).map(|i| percentile(values.to_vec(), i as f64 / count as f64)).collect()
}

/// The class of a value.
fn class(edges: &[f64], value: f64) -> usize {
    edges.partition_point(|edge| *edge < value)
}

impl Library<'_> {
    /// The decoys. One with a column that is zero in all windows is left out.
    pub(super) fn decoys(&self) -> Vec<Term> {
        let mut terms = once(&self.form.made.decoys, || self.decoys_of_the_motion());
        if self.drive_varies() {
            terms.push(self.gain_over_position());
        }
        terms.retain(|t| t.u.iter().all(|c| rows(self.form, c).iter().any(|v| *v != 0.0)));
        terms
    }

    /// A gain of the drive in each quarter of the positions but the first.
    fn gain_over_position(&self) -> Term {
        let places = self.places();
        let gain = |drive: &Field, i: usize| {
            self.field(|s| if class(&places, s.x) / (PLACES / 4) == i { drive[s.piece][s.k] } else { 0.0 })
        };
        let mut term = decoy("gain over position", (1..4).map(|i| gain(&self.predicted, i)).collect());
        term.a = (1..4).map(|i| Column::force(gain(&self.arrived, i))).collect();
        term
    }

    /// Edges of classes of the position that hold as many windows each.
    fn places(&self) -> Vec<f64> {
        let form = self.form;
        edges(&form.rows.iter().map(|r| form.dataset.pieces[r.piece].x[r.centre]).collect::<Vec<_>>(), PLACES)
    }

    fn decoys_of_the_motion(&self) -> Vec<Term> {
        let form = self.form;
        let mut terms = Vec::new();
        let speeds = edges(&form.row_v, 8);
        terms.push(decoy(
            "curve over velocity",
            (0..8).map(|i| self.field(|s| f64::from(u8::from(class(&speeds, s.v) == i)))).collect(),
        ));
        let places = self.places();
        terms.push(decoy(
            "curve over position",
            (0..PLACES).map(|i| self.field(|s| f64::from(u8::from(class(&places, s.x) == i)))).collect(),
        ));
        let speed = 0.1 * form.v95;
        terms.push(decoy("soft sign", vec![self.field(|s| (s.v / speed).tanh())]));
        if (2..=MOST_PHASES).contains(&form.dataset.recordings) {
            let own = |i: usize, f: &dyn Fn(Sample) -> f64| {
                self.field(|s| if form.dataset.pieces[s.piece].recording == i { f(s) } else { 0.0 })
            };
            let others = 1..form.dataset.recordings;
            terms.push(decoy("friction of each recording", others.clone().map(|i| own(i, &|s| s.direction)).collect()));
            terms.push(decoy("load of each recording", others.clone().map(|i| own(i, &|_| 1.0)).collect()));
        }
        terms
    }
}
