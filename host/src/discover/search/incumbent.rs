//! A model with an effect, in whose place others are tried.

use breakaway_core::plant::Kind;

use super::add::excluded;
use super::descend::FINAL_ITERATIONS;
use super::plausible::resolved;
use crate::discover::data::Data;
use crate::discover::model::Model;
use crate::fit::Fit;

/// A model, and which of its effects is contested.
#[derive(Clone, Copy, Debug)]
pub(super) struct Incumbent<'a> {
    /// The model's fit.
    pub fit: &'a Fit,
    /// The effect's place in it.
    pub place: usize,
}

impl Incumbent<'_> {
    /// The fit of an effect in the incumbent's place that begins with the incumbent's law, so that it ends no worse.
    /// `current` is the model without the incumbent. `None` where no parameters give the effect that law, where it cannot stand
    /// beside the others, or where the fit is not believed.
    pub(super) fn successor(self, data: &Data, current: &Fit, kind: Kind, rotary: bool) -> Option<Fit> {
        if excluded(kind, &current.candidate.effects, rotary).is_some() {
            return None;
        }
        let mut values = self.fit.candidate.clone();
        let new = values.effects.remove(self.place).as_kind(kind)?;
        values.effects.push(new);
        let model = Model::of(current).with(new).at(&values);
        let fit = model.fit(&data.problem(), Some(&self.fit.initial), FINAL_ITERATIONS).ok()?;
        resolved(data, &fit.candidate, &fit.candidate.effects).ok().map(|()| fit)
    }
}

#[cfg(test)]
mod tests {
    use breakaway_core::plant::Effect;

    use super::*;
    use crate::discover::data::FIT_SEGMENT_S;
    use crate::discover::judge::bar::tests::Axis;
    use crate::discover::prepared::prepared;
    use crate::discover::request::Request;

    /// A dead time that begins as the dead zone has the dead zone's cost at first, and ends with no more. No parameters of
    /// a load make it a dead zone, and no model has two dead times.
    #[test]
    fn a_dead_time_begins_as_the_dead_zone() {
        let recordings = [1, 2].map(|seed| Axis { f1: 0.1, drag: 0.0, load: 0.0, seed }.recording()).to_vec();
        let request = Request { recordings, ..Request::default() };
        let start = prepared(&request, FIT_SEGMENT_S, None, &|_| ()).unwrap();
        let (data, base) = (&start.data, &start.base);
        let zone = Model::of(base).with(Effect::new(Kind::DeadZone, &[0.02]));
        let fit = zone.fit(&data.problem(), Some(&base.initial), FINAL_ITERATIONS).unwrap();
        let incumbent = Incumbent { fit: &fit, place: 0 };
        let time = incumbent.successor(data, base, Kind::PwmDeadTime, true).unwrap();
        assert_eq!(time.candidate.effects[0].kind, Kind::PwmDeadTime);
        assert!(time.cost <= fit.cost, "{} {}", time.cost, fit.cost);
        assert!(incumbent.successor(data, base, Kind::ConstantLoad, true).is_none());
        assert!(incumbent.successor(data, &time, Kind::PwmDeadTime, true).is_none());
    }
}
