//! Columns of decoys: they stand for something that no name fits.

use super::super::sides::rows;
use super::super::term::{Column, Name, Term};
use super::super::weak_form::{Field, Sample, percentile};
use super::{Library, MOST_PHASES};

impl Library<'_> {
    /// The decoys. One with a column that is zero in all windows is left out.
    pub(super) fn decoys(&self) -> Vec<Term> {
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
        terms.retain(|t| t.u.iter().all(|c| rows(form, c, None).iter().any(|v| *v != 0.0)));
        terms
    }
}
